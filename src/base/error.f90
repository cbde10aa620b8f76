!> Failures as values: a code, a message, and where it happened.
!>
!> A procedure that can fail has a last argument `type(error_type), allocatable, intent(out) :: err`;
!> allocated means failed. Places are added on the way up. Only the programs end a run. Numerics fail with
!> numbers, from which `explain` of mech9_explanation forms the message before a user sees it.
module mech9_error
  use mech9_failure, only: failure_type, integration_stop_type
  implicit none
  private
  public :: error_type, place_type, place_words, raise, add_place
  public :: exit_done, exit_internal, exit_usage, exit_data, exit_structure, exit_assembly
  public :: exit_singular, exit_integrator, exit_file, exit_interrupted

  !> Exit codes of the programs, which are the kinds of errors as well.
  integer, parameter :: exit_done = 0
  integer, parameter :: exit_internal = 1        !< a defect of the program itself
  integer, parameter :: exit_usage = 2           !< wrong command line
  integer, parameter :: exit_data = 3            !< wrong data file
  integer, parameter :: exit_structure = 4       !< structure or mobility
  integer, parameter :: exit_assembly = 5        !< the mechanism cannot be assembled
  integer, parameter :: exit_singular = 6        !< singular position, or the branch would change
  integer, parameter :: exit_integrator = 7      !< integration cannot go on
  integer, parameter :: exit_file = 8            !< a file cannot be read or written
  integer, parameter :: exit_interrupted = 130   !< the user interrupted the run

  !> A place in the data file or in a setting; line 0 means none.
  type :: place_type
    integer :: line = 0
    integer :: column = 0
    integer :: source = 1   !< the text that it is in: 1 is the data file, others are settings of --set in their order
  end type place_type

  !> A failure: its kind, its message and its place.
  type :: error_type
    integer :: code = exit_internal                       !< kind of failure, one of the exit_ codes
    character(len=:), allocatable :: message              !< error, place and remedy in words
    type(place_type) :: place                             !< place in the data file; line 0 where none is known
    type(failure_type), allocatable :: failure            !< the failure as numbers, until its message is formed from them
    type(integration_stop_type), allocatable :: stopped   !< the integration that it ended, until the message tells so
  end type error_type

  !> Make a failure, from a message or as a kind with numbers.
  interface raise
    module procedure raise_message, raise_kind
  end interface raise

contains

  !> A place in words, as "line 12", or "an option --set".
  pure function place_words(place) result(words)
    type(place_type), intent(in) :: place   !< line and column of something
    character(len=16) :: words

    words = 'an option --set'
    if (place%source == 1) write (words, '(a, i0)') 'line ', place%line
  end function place_words

  !> Make a failure that has a message.
  pure subroutine raise_message(err, code, message, place)
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer, intent(in) :: code                         !< one of the exit_ codes
    character(len=*), intent(in) :: message             !< error and remedy in words
    type(place_type), intent(in), optional :: place     !< place in the data file that the message points to

    allocate (err)
    err%code = code
    err%message = trim(message)
    if (present(place)) err%place = place
  end subroutine raise_message

  !> Make a failure of a kind; the caller sets the numbers of err%failure that the kind names.
  pure subroutine raise_kind(err, code, kind)
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer, intent(in) :: code                         !< one of the exit_ codes
    integer, intent(in) :: kind                         !< one of the failure_ constants
    character(len=12) :: number

    allocate (err)
    err%code = code
    allocate (err%failure)
    err%failure%kind = kind
    ! no user reads it: `explain` knows a sentence for every kind
    write (number, '(i0)') kind
    err%message = 'failure of kind '//trim(number)
  end subroutine raise_kind

  !> Say where a failure happened; does nothing when all is well.
  !> A place in the data file is kept if the failure has one already.
  pure subroutine add_place(err, text, place)
    type(error_type), allocatable, intent(inout) :: err   !< the failure, which gets the place; not allocated: nothing happens
    character(len=*), intent(in), optional :: text        !< the place in words, put before the message as "text: message"
    type(place_type), intent(in), optional :: place       !< place in the data file that the message points to

    if (.not. allocated(err)) return
    if (present(text)) err%message = text//': '//err%message
    if (present(place)) then
      if (err%place%line == 0) err%place = place
    end if
  end subroutine add_place
end module mech9_error
