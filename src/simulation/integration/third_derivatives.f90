!> Third derivatives of the coordinates of a motion, by differences.
module mech9_third_derivatives
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_integration_tolerances, only: third_derivative_step
  use mech9_integrated_vector, only: pack_rates
  use mech9_motion_system, only: motion_system_type
  implicit none
  private
  public :: find_third_derivatives

contains

  !> The third derivatives of the independent coordinates at the present state, to about 1e-10, by a central difference of the
  !> accelerations; those of the others are zero. The system stands at the same state afterwards.
  subroutine find_third_derivatives(system, dddq, err)
    type(motion_system_type), intent(inout) :: system  !< the motion system, with the motion of its state
    real(wp), intent(out) :: dddq(:)                    !< (M) [rad/s^3, m/s^3]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), dimension(system%size_of_vector()) :: y, ydot
    real(wp) :: t, dt

    t = system%state%t
    y = system%vector()
    dddq = 0.0_wp
    call pack_rates(system%plan, system%state, system%state%ddq(system%plan%independent), ydot)
    dt = third_derivative_step/max(maxval(abs(system%state%dq)/system%plan%unit_of), &
                                   sqrt(maxval(abs(system%state%ddq)/system%plan%unit_of)), tiny(dt)/epsilon(dt))
    call system%move_to(t + dt, y + dt*ydot, err)
    if (allocated(err)) return
    dddq(system%plan%independent) = system%state%ddq(system%plan%independent)
    call system%move_to(t - dt, y - dt*ydot, err)
    if (allocated(err)) return
    dddq(system%plan%independent) = (dddq(system%plan%independent) - system%state%ddq(system%plan%independent))/(2.0_wp*dt)
    call system%move_to(t, y, err)
  end subroutine find_third_derivatives
end module mech9_third_derivatives
