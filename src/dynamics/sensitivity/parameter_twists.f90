!> Twists and wrenches by all parameters at once: one row for each parameter. Twists are a rotation, then a shift, wrenches a moment,
!> then a force, both at the origin of frame 0 and in its axes.
module mech9_parameter_twists
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, turn
  implicit none
  private
  public :: inertia_type, momentum, momenta, crossed, add_bracket, add_cross, add_turned_wrench

  !> A body's inertia in its present position.
  type :: inertia_type
    real(wp) :: mass = 0.0_wp              !< [kg]
    real(wp) :: centre(3) = 0.0_wp         !< from the origin of frame 0 [m]
    real(wp) :: tensor(3, 3) = 0.0_wp      !< about the centre [kg m^2]
  end type inertia_type

contains

  !> The momentum of a body with a twist: its moment about the origin, then the linear momentum.
  pure function momentum(body, twist) result(h)
    type(inertia_type), intent(in) :: body   !< the body
    real(wp), intent(in) :: twist(6)         !< its velocity, or any other twist
    real(wp) :: h(6)

    h(4:6) = body%mass*(twist(4:6) + cross(twist(1:3), body%centre))
    h(1:3) = turn(body%tensor, twist(1:3)) + cross(body%centre, h(4:6))
  end function momentum

  !> The momenta of a body with several twists.
  pure subroutine momenta(body, twists, h)
    type(inertia_type), intent(in) :: body   !< the body
    real(wp), intent(in) :: twists(:, :)     !< (P,6)
    real(wp), intent(out) :: h(:, :)         !< (P,6)
    integer :: j

    associate (m => body%mass, c => body%centre, w => twists(:, 1:3), v => twists(:, 4:6))
      h(:, 4) = m*(v(:, 1) + w(:, 2)*c(3) - w(:, 3)*c(2))
      h(:, 5) = m*(v(:, 2) + w(:, 3)*c(1) - w(:, 1)*c(3))
      h(:, 6) = m*(v(:, 3) + w(:, 1)*c(2) - w(:, 2)*c(1))
      h(:, 1) = c(2)*h(:, 6) - c(3)*h(:, 5)
      h(:, 2) = c(3)*h(:, 4) - c(1)*h(:, 6)
      h(:, 3) = c(1)*h(:, 5) - c(2)*h(:, 4)
      do j = 1, 3
        h(:, j) = h(:, j) + body%tensor(j, 1)*w(:, 1) + body%tensor(j, 2)*w(:, 2) + body%tensor(j, 3)*w(:, 3)
      end do
    end associate
  end subroutine momenta

  !> The rate of change of a wrench that is fixed in a body with a twist.
  pure function crossed(twist, wrench) result(rate)
    real(wp), intent(in) :: twist(6)    !< of the body
    real(wp), intent(in) :: wrench(6)   !< a wrench or a momentum
    real(wp) :: rate(6)

    rate(1:3) = cross(twist(1:3), wrench(1:3)) + cross(twist(4:6), wrench(4:6))
    rate(4:6) = cross(twist(1:3), wrench(4:6))
  end function crossed

  !> Add the rates of change of a wrench that is fixed in bodies with several twists.
  pure subroutine add_turned_wrench(twists, wrench, rates)
    real(wp), intent(in) :: twists(:, :)     !< (P,6) of the bodies
    real(wp), intent(in) :: wrench(6)        !< a wrench or a momentum
    real(wp), intent(inout) :: rates(:, :)   !< (P,6) the sums

    call add_cross(twists(:, 1:3), wrench(1:3), rates(:, 1:3))
    call add_cross(twists(:, 4:6), wrench(4:6), rates(:, 1:3))
    call add_cross(twists(:, 1:3), wrench(4:6), rates(:, 4:6))
  end subroutine add_turned_wrench

  !> Add the rates of change of a twist that is fixed in bodies with several twists.
  pure subroutine add_bracket(twists, twist, rates)
    real(wp), intent(in) :: twists(:, :)     !< (P,6) of the bodies
    real(wp), intent(in) :: twist(6)         !< the twist
    real(wp), intent(inout) :: rates(:, :)   !< (P,6) the sums

    call add_cross(twists(:, 1:3), twist(1:3), rates(:, 1:3))
    call add_cross(twists(:, 1:3), twist(4:6), rates(:, 4:6))
    call add_cross(twists(:, 4:6), twist(1:3), rates(:, 4:6))
  end subroutine add_bracket

  !> Add the products of several vectors with one.
  pure subroutine add_cross(a, b, sums)
    real(wp), intent(in) :: a(:, :)         !< (P,3)
    real(wp), intent(in) :: b(3)            !< the second factor
    real(wp), intent(inout) :: sums(:, :)   !< (P,3) the sums

    sums(:, 1) = sums(:, 1) + a(:, 2)*b(3) - a(:, 3)*b(2)
    sums(:, 2) = sums(:, 2) + a(:, 3)*b(1) - a(:, 1)*b(3)
    sums(:, 3) = sums(:, 3) + a(:, 1)*b(2) - a(:, 2)*b(1)
  end subroutine add_cross
end module mech9_parameter_twists
