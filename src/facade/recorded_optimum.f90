!> A search for the best design as the library's users make it: the distinct designs as a table, best first, and their mechanisms.
module mech9_recorded_optimum
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, texts_of_one_length
  use mech9_result_units, only: name_parameters
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_user_calls, only: calls_user_procedures
  use mech9_search_starts, only: search_starts_type
  use mech9_processes, only: processes_type
  use mech9_search, only: optimum_search_type, check_request
  use mech9_varied_document, only: varied_document_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: recorded_optimum_type

  !> The distinct designs to which the starts led, best first.
  type :: recorded_optimum_type
    character(len=:), allocatable :: parameter_names(:)   !< (parameters) all of the data file
    character(len=:), allocatable :: parameter_units(:)   !< (parameters) blank where none is known
    real(wp), allocatable :: values(:)                    !< (designs) of the objective: the less the better
    real(wp), allocatable :: parameters(:, :)             !< (parameters,designs) in the units of the data file
    real(wp), allocatable :: q(:, :)                      !< (M,designs) coordinates at the start [rad, m]
    integer, allocatable :: starts(:)                     !< (designs) how many starts led to each
    integer :: made = 0                                   !< starts that were made
  contains
    procedure :: make
    procedure :: take_design
  end type recorded_optimum_type

  !> Starts that tell how many of them are made.
  type, extends(search_starts_type) :: told_starts_type
    class(interruption_type), allocatable :: listener   !< learns it
  contains
    procedure :: tell_progress
  end type told_starts_type

contains

  !> Search for the best design. Fails with exit_usage where the mechanism has no &objective, with exit_assembly where no start leads
  !> to a design, and with exit_interrupted where the search is stopped; the designs that were found before are then there.
  subroutine make(self, mechanism, program, threads, interruption, err)
    class(recorded_optimum_type), intent(inout) :: self      !< the optimum, found anew
    type(checked_mechanism_type), intent(in) :: mechanism    !< with parameters and objectives
    integer, intent(in) :: program                           !< kinematics or dynamics
    integer, intent(in) :: threads                           !< how many make the starts
    class(interruption_type), intent(in) :: interruption     !< is asked whether the search shall stop
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    type(model_type) :: model
    type(varied_document_type), target :: variable
    type(optimum_search_type), allocatable, target :: search
    type(told_starts_type) :: starts
    type(processes_type) :: alone
    integer :: made_by

    call forget(self)
    call mechanism%take_request(program, model, err)
    if (.not. allocated(err)) call check_request(model, err)
    if (.not. allocated(err)) then
      call mechanism%take_variable(program, variable)
      allocate (search)
      call search%prepare(variable, model, interruption, err)
    end if
    if (.not. allocated(err)) then
      allocate (starts%made(model%request%optimum%starts))
      allocate (starts%listener, source=interruption)
      call starts%begin(interruption)
      ! a user's procedures may keep numbers from call to call
      made_by = max(1, threads)
      if (calls_user_procedures(model)) made_by = 1
      call search%make(model, alone, made_by, starts, err)
      call take_designs(self, model, search)
    end if
    call mechanism%point_at(err)
  end subroutine make

  !> Tell how far the search is.
  subroutine tell_progress(self, share)
    class(told_starts_type), intent(inout) :: self   !< the starts
    real(wp), intent(in) :: share                    !< of the starts that are made, from 0 to 1

    call self%listener%tell(share)
  end subroutine tell_progress

  !> Forget all designs.
  subroutine forget(self)
    type(recorded_optimum_type), intent(inout) :: self   !< the optimum
    type(string_type) :: none(0)

    call texts_of_one_length(none, self%parameter_names)
    call texts_of_one_length(none, self%parameter_units)
    self%values = [real(wp) ::]
    self%parameters = reshape([real(wp) ::], [0, 0])
    self%q = reshape([real(wp) ::], [0, 0])
    self%starts = [integer ::]
    self%made = 0
  end subroutine forget

  !> Take the designs of a search.
  subroutine take_designs(self, model, search)
    type(recorded_optimum_type), intent(inout) :: self   !< gets them
    type(model_type), intent(in) :: model                !< the model
    type(optimum_search_type), intent(in) :: search      !< made
    type(string_type), allocatable :: names(:), units(:)
    integer :: i

    call name_parameters(model%mechanism, model%parameters, names, units)
    call texts_of_one_length(names, self%parameter_names)
    call texts_of_one_length(units, self%parameter_units)
    associate (found => search%synthesis)
      self%made = found%done
      self%values = found%optima%value
      self%starts = found%optima%starts
      deallocate (self%parameters, self%q)
      allocate (self%parameters(size(names), size(found%optima)), self%q(size(model%mechanism%pairs), size(found%optima)))
      do i = 1, size(found%optima)
        self%parameters(:, i) = found%values_of(i)
        self%q(:, i) = found%optima(i)%q
      end do
    end associate
  end subroutine take_designs

  !> The mechanism of a design, in its assembly. Fails with exit_usage where there is no such design.
  subroutine take_design(self, mechanism, program, number, design, err)
    class(recorded_optimum_type), intent(in) :: self         !< the optimum
    type(checked_mechanism_type), intent(in) :: mechanism    !< the mechanism of the search
    integer, intent(in) :: program                           !< kinematics or dynamics
    integer, intent(in) :: number                            !< its place among the designs, from 1
    type(checked_mechanism_type), intent(out) :: design      !< the mechanism with the values of the design
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed

    if (number < 1 .or. number > size(self%values)) then
      call raise(err, exit_usage, 'there is no such design')
      return
    end if
    call mechanism%take_design(program, self%parameters(:, number), self%q(:, number), design, err)
  end subroutine take_design
end module mech9_recorded_optimum
