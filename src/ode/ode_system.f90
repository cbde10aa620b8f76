!> A system of ordinary differential equations as an integrator uses it: its rate of change, and the projection of an
!> accepted step.
module mech9_ode_system
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_internal, exit_singular, exit_integrator
  use mech9_ode_failures, only: failure_no_jacobian
  implicit none
  private
  public :: ode_system_type, is_recoverable

  !> A system of ordinary differential equations y' = f(t, y), with its data.
  type, abstract :: ode_system_type
    !> Whether `project` is to be called after each accepted step.
    logical :: projects = .false.
    !> Whether `jacobian` can be called; otherwise methods that need a Jacobian take differences of the rate.
    logical :: has_jacobian = .false.
  contains
    procedure(rate_interface), deferred :: rate
    procedure :: project => no_projection
    procedure :: jacobian => no_jacobian
  end type ode_system_type

  abstract interface
    !> The rate of change of y at time t.
    !>
    !> A failure with exit_singular or exit_integrator, and numbers that are not finite, mean that a trial
    !> went too far: the step is made again, smaller, and the integration ends only where that does not
    !> help. Any other failure ends it at once.
    subroutine rate_interface(self, t, y, ydot, err)
      import :: ode_system_type, wp, error_type
      class(ode_system_type), intent(inout) :: self       !< the equations, with their data and scratch
      real(wp), intent(in) :: t                           !< [s]
      real(wp), intent(in) :: y(:)                        !< values at t
      real(wp), intent(out) :: ydot(:)                    !< derivatives of y in time
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine rate_interface
  end interface

contains

  !> Project y after an accepted step onto conditions that the equations do not keep exactly, by a change not much
  !> larger than the tolerance. After a failure the step is made again, smaller, by the rule of `rate`. (This procedure,
  !> for systems without such conditions, does nothing.)
  subroutine no_projection(self, t, y, err)
    class(ode_system_type), intent(inout) :: self       !< the equations, with their data and scratch
    real(wp), intent(in) :: t                           !< [s]
    real(wp), intent(inout) :: y(:)                     !< values at t; the projected ones afterwards
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
  end subroutine no_projection

  !> Derivatives of the rate: jac(i, j) = d ydot(i)/d y(j). Fails by the rule of `rate`. (This procedure, for systems
  !> without a Jacobian, always fails.)
  subroutine no_jacobian(self, t, y, ydot, jac, err)
    class(ode_system_type), intent(inout) :: self       !< the equations, with their data and scratch
    real(wp), intent(in) :: t                           !< [s]
    real(wp), intent(in) :: y(:)                        !< values at t
    real(wp), intent(in) :: ydot(:)                     !< the rate at (t, y)
    real(wp), intent(out) :: jac(:, :)                  !< derivatives of ydot in y
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    jac = 0.0_wp
    call raise(err, exit_internal, failure_no_jacobian)
  end subroutine no_jacobian

  !> Whether a smaller step may help against this failure.
  pure logical function is_recoverable(err)
    type(error_type), intent(in) :: err   !< the failure

    is_recoverable = err%code == exit_singular .or. err%code == exit_integrator
  end function is_recoverable
end module mech9_ode_system
