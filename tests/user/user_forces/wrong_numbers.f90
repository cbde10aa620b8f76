!> A user's force that gives the number parameters(2) to the procedure of `state` or `loads` that parameters(1) means.
submodule (mech9_user_force) wrong_numbers
  implicit none

contains

  module subroutine user_force(t, state, parameters, loads)
    real(wp), intent(in) :: t                      !< time [s]
    type(motion_view_type), intent(in) :: state    !< motion of links and coordinates
    real(wp), intent(in) :: parameters(:)          !< of &user
    type(force_sum_type), intent(inout) :: loads   !< forces and torques are added to it
    real(wp), parameter :: x(3) = [1.0_wp, 0.0_wp, 0.0_wp]
    integer :: number

    number = nint(parameters(2))
    select case (nint(parameters(1)))
    case (1)
      call loads%add_force(state, number, x, x)
    case (2)
      call loads%add_torque(number, x)
    case (3)
      call loads%add_generalized(number, 1.0_wp)
    case (4)
      call loads%add_torque(2, state%position(number, x))
    case (5)
      call loads%add_torque(2, state%velocity(number, x))
    case (6)
      call loads%add_torque(2, state%turned(number, x))
    case (7)   ! a second fault, which is not told
      call loads%add_torque(number, x)
      call loads%add_torque(-1, x)
    end select
  end subroutine user_force
end submodule wrong_numbers
