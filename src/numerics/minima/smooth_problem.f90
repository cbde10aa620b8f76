!> The problem of the least value of a smooth function between bounds and within limits, and how a search for it ended.
module mech9_smooth_problem
  use mech9_kinds, only: wp
  implicit none
  private
  public :: smooth_problem_type, smooth_settings_type, smooth_outcome_type
  public :: ended_converged, ended_after_count, ended_infeasible, ended_nowhere

  integer, parameter :: ended_converged = 1     !< steps or reductions have become too small to matter
  integer, parameter :: ended_after_count = 2   !< as many evaluations as are allowed were made
  integer, parameter :: ended_infeasible = 3    !< no place that was evaluated is within all limits
  integer, parameter :: ended_nowhere = 4       !< the function has no value at the start, or there is no such method

  !> A function with limits, both with exact derivatives. A place is within a limit where its number is not negative.
  type, abstract :: smooth_problem_type
    integer :: n = 0          !< number of unknowns
    integer :: n_limits = 0   !< number of limits
  contains
    procedure(evaluate_interface), deferred :: evaluate
    procedure(is_stopped_interface), deferred :: is_stopped
  end type smooth_problem_type

  !> When to end.
  type :: smooth_settings_type
    character(len=20) :: method = 'slsqp'      !< slsqp, mma, ccsaq or auglag
    integer :: most_evaluations = 500          !< number of evaluations
    real(wp) :: short = 1.0e-11_wp             !< change of the unknowns that is too small
    real(wp) :: flat = 1.0e-14_wp              !< change of the value that is too small, as a part of it
    real(wp) :: margin = 1.0e-9_wp             !< the limits are kept with this margin, so that round-off breaks none
  end type smooth_settings_type

  !> How a search ended. Its place is the best of all that are within all limits.
  type :: smooth_outcome_type
    integer :: kind = ended_nowhere             !< one of the kinds above
    integer :: evaluations = 0                  !< number of evaluations
    real(wp) :: value = huge(1.0_wp)            !< the function there
  end type smooth_outcome_type

  abstract interface
    !> The function, the limits and their derivatives. Without `has_value` they do not exist there.
    subroutine evaluate_interface(self, x, value, gradient, limits, slopes, has_value)
      import :: smooth_problem_type, wp
      class(smooth_problem_type), intent(inout) :: self   !< the problem
      real(wp), intent(in) :: x(:)                        !< (n) the place
      real(wp), intent(out) :: value                      !< the function
      real(wp), intent(out) :: gradient(:)                !< (n) its derivatives
      real(wp), intent(out) :: limits(:)                  !< (limits) not negative where they are kept
      real(wp), intent(out) :: slopes(:, :)               !< (n,limits) their derivatives
      logical, intent(out) :: has_value                   !< all these exist
    end subroutine evaluate_interface

    !> Whether the search should end at once.
    logical function is_stopped_interface(self)
      import :: smooth_problem_type
      class(smooth_problem_type), intent(in) :: self   !< the problem
    end function is_stopped_interface
  end interface
end module mech9_smooth_problem
