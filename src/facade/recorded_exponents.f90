!> Lyapunov exponents as the library's users find them.
module mech9_recorded_exponents
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_explanation, only: explain
  use mech9_exponents, only: exponents_found_type, find_exponents
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: exponents_found_type, find_motion_exponents

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
end module mech9_recorded_exponents
