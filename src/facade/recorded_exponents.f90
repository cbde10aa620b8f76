!> Lyapunov exponents as the library's users find them.
module mech9_recorded_exponents
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_explanation, only: explain
  use mech9_exponents, only: exponents_found_type, find_exponents
  use mech9_data_file, only: data_file_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: exponents_found_type, find_motion_exponents, recorded_exponents_type

  !> The exponents of the motion of a data file.
  type, extends(exponents_found_type) :: recorded_exponents_type
  contains
    procedure :: find
    procedure :: list_rows
  end type recorded_exponents_type

contains

  !> Find the first Lyapunov exponents of a motion under forces. Fails with exit_data where nothing is free to move or where they are not
  !> known, with exit_usage where there are not so many, and as a run does.
  subroutine find_motion_exponents(mechanism, count, found, err, interruption)
    type(checked_mechanism_type), intent(in) :: mechanism            !< with free coordinates, bodies and loads
    integer, intent(in) :: count                                     !< how many exponents are found
    type(exponents_found_type), intent(out) :: found                 !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop
    type(model_type) :: model

    call mechanism%take_request(dynamics, model, err)
    if (.not. allocated(err)) call find_exponents(model, count, found, err, interruption)
    if (allocated(err)) call explain(err)
    call mechanism%point_at(err)
  end subroutine find_motion_exponents

  !> Find the first exponents of the motion of a data file. Fails as find_motion_exponents does; the error is not explained.
  subroutine find(self, given, count, err, interruption)
    class(recorded_exponents_type), intent(inout) :: self            !< new ones
    class(data_file_type), intent(in) :: given                       !< the data file
    integer, intent(in) :: count                                     !< how many exponents are found
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop

    call find_exponents(given%model, count, self%exponents_found_type, err, interruption)
  end subroutine find

  !> List the running means over time as rows.
  pure subroutine list_rows(self, names, units, rows)
    class(recorded_exponents_type), intent(in) :: self         !< the exponents
    type(string_type), allocatable, intent(out) :: names(:)    !< (columns) the time first
    type(string_type), allocatable, intent(out) :: units(:)    !< (columns)
    real(wp), allocatable, intent(out) :: rows(:, :)           !< (columns,times)
    integer :: k

    allocate (names(size(self%exponents) + 1), units(size(self%exponents) + 1))
    names(1)%text = 't'
    units(1)%text = 's'
    do k = 1, size(self%exponents)
      names(k + 1)%text = 'L'//to_text(k)
      units(k + 1)%text = '1/s'
    end do
    allocate (rows(size(names), size(self%times)))
    rows(1, :) = self%times
    rows(2:, :) = self%history
  end subroutine list_rows
end module mech9_recorded_exponents
