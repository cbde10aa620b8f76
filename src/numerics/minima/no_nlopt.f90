!> The least value of a smooth function within limits in a build without NLopt: it is not found.
module mech9_no_nlopt
  use mech9_kinds, only: wp
  use mech9_smooth_problem, only: smooth_problem_type, smooth_settings_type, smooth_outcome_type
  implicit none
  private
  public :: minimise_within_limits, has_limited_minimum

  logical, parameter :: has_limited_minimum = .false.   !< this build has no NLopt

contains

  !> Leave the place as it is.
  subroutine minimise_within_limits(problem, x, low, high, settings, outcome)
    class(smooth_problem_type), intent(inout), target :: problem   !< the problem
    real(wp), intent(inout) :: x(:)                                !< (n) the start, which stays
    real(wp), intent(in) :: low(:)                                 !< (n) least unknowns
    real(wp), intent(in) :: high(:)                                !< (n) largest unknowns
    type(smooth_settings_type), intent(in) :: settings             !< method and when to end
    type(smooth_outcome_type), intent(out) :: outcome              !< the search ended nowhere

    outcome%evaluations = 0
  end subroutine minimise_within_limits
end module mech9_no_nlopt
