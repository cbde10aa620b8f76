!> The starts of a search: choosing the next one to be made, and keeping those that are made. What keeps more than memory, as the
!> file of a program does, extends it.
!>
!> A maker of starts asks for a number (`hand_out`) and gives the designs back when the start is made (`take`). Several
!> may do so at a time, as long as the calls come one after the other.
module mech9_search_starts
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_error, only: error_type, raise, exit_interrupted
  use mech9_simulation, only: interruption_type
  use mech9_design_search, only: found_design_type
  use mech9_synthesis, only: synthesis_type
  implicit none
  private
  public :: search_starts_type, start_type, all_handed_out

  !> Answer in place of the number of a start: there are no more.
  integer, parameter :: all_handed_out = 0

  !> The designs to which a start led; none are allocated before it is made.
  type :: start_type
    type(found_design_type), allocatable :: found(:)
  end type start_type

  type :: search_starts_type
    type(start_type), allocatable :: made(:)         !< all starts; those that were made before have their designs from the beginning
    integer :: part(2) = 1                           !< number of the part that is to be made, and how many parts there are
    type(error_type), allocatable :: stopped         !< allocated where the starts cannot be kept, or the user interrupts
    class(interruption_type), allocatable, private :: interruption
    integer, private :: handed_out = 0               !< starts that were handed out or skipped, the first ones
    integer, private :: missing = 0                  !< how many were to be made at the beginning
    integer, private :: taken = 0                    !< how many of these are made
  contains
    procedure :: begin
    procedure :: hand_out
    procedure :: take
    procedure :: keep => keep_in_memory
    procedure :: tell_progress => tell_nothing
    procedure :: finish
  end type search_starts_type

contains

  !> Begin to make the starts that are missing.
  subroutine begin(self, interruption)
    class(search_starts_type), intent(inout) :: self        !< with room for all starts, and with those that were made before
    class(interruption_type), intent(in) :: interruption    !< is asked before each start whether the search shall stop

    allocate (self%interruption, source=interruption)
    self%missing = count_missing(self)
    call self%tell_progress(0.0_wp)
  end subroutine begin

  !> How many starts of the part are not made.
  pure integer function count_missing(self) result(n)
    class(search_starts_type), intent(in) :: self           !< the starts
    integer :: i

    n = count([(.not. allocated(self%made(i)%found), i=self%part(1), size(self%made), self%part(2))])
  end function count_missing

  !> The number of a start to be made next, or all_handed_out. Starts that were made before are not handed out, nor are those of other
  !> parts.
  integer function hand_out(self) result(number)
    class(search_starts_type), intent(inout) :: self        !< the starts

    number = all_handed_out
    if (allocated(self%stopped)) return
    if (self%interruption%is_wanted()) return
    do while (self%handed_out < size(self%made))
      self%handed_out = self%handed_out + 1
      if (allocated(self%made(self%handed_out)%found) .or. modulo(self%handed_out - self%part(1), self%part(2)) /= 0) cycle
      number = self%handed_out
      return
    end do
  end function hand_out

  !> Take the designs to which a start led.
  subroutine take(self, number, found)
    class(search_starts_type), intent(inout) :: self                     !< the starts
    integer, intent(in) :: number                                        !< of the start, from 1
    type(found_design_type), allocatable, intent(inout) :: found(:)      !< the designs; not allocated on return
    type(error_type), allocatable :: err

    call move_alloc(found, self%made(number)%found)
    self%taken = self%taken + 1
    call self%keep(number, err)
    if (allocated(err) .and. .not. allocated(self%stopped)) call move_alloc(err, self%stopped)
    call self%tell_progress(real(self%taken, wp)/self%missing)
  end subroutine take

  !> Keep a start that is made beyond memory, as in a file.
  subroutine keep_in_memory(self, number, err)
    class(search_starts_type), intent(inout) :: self        !< the starts
    integer, intent(in) :: number                           !< of the start, from 1
    type(error_type), allocatable, intent(out) :: err       !< allocated if it cannot be kept
  end subroutine keep_in_memory

  !> Tell how far the search is.
  subroutine tell_nothing(self, share)
    class(search_starts_type), intent(inout) :: self        !< the starts
    real(wp), intent(in) :: share                           !< of the starts that are made, from 0 to 1
  end subroutine tell_nothing

  !> Add all starts that are made to a synthesis, in the order of their numbers. Where starts are missing and none could not be
  !> kept, the user interrupted.
  subroutine finish(self, synthesis)
    class(search_starts_type), intent(inout) :: self        !< the starts
    type(synthesis_type), intent(inout) :: synthesis        !< gets the designs
    integer :: i, n

    do i = 1, size(self%made)
      if (allocated(self%made(i)%found)) call synthesis%add(i, self%made(i)%found)
    end do
    n = count_missing(self)
    if (n > 0 .and. .not. allocated(self%stopped)) &
      call raise(self%stopped, exit_interrupted, 'interrupted: '//to_text(synthesis%done)//' of '// &
                 counted(synthesis%done + n, 'start')//' are made')
  end subroutine finish
end module mech9_search_starts
