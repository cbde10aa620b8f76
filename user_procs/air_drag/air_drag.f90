!> Air drag on points of links: a force k |v| v against the velocity v of each point.
!>
!> The parameters are five numbers for each point: number of the link, coordinates x, y, z of the point in the link [m],
!> and k [N s^2/m^2]. For a plate across the wind k is half the product of the density of air, the drag coefficient and
!> the area.
submodule (mech9_user_force) air_drag
  implicit none

contains

  module subroutine user_force(t, state, parameters, loads)
    real(wp), intent(in) :: t                      !< time [s]
    type(motion_view_type), intent(in) :: state    !< motion of links and coordinates: see docs/how-to/user-procedures.md
    real(wp), intent(in) :: parameters(:)          !< five numbers for each point
    type(force_sum_type), intent(inout) :: loads   !< forces and torques are added to it
    real(wp) :: point(3), v(3)
    integer :: i, link

    do i = 1, size(parameters) - 4, 5
      link = nint(parameters(i))
      point = parameters(i + 1:i + 3)
      v = state%velocity(link, point)
      call loads%add_force(state, link, point, -parameters(i + 4)*norm2(v)*v)
    end do
  end subroutine user_force
end submodule air_drag
