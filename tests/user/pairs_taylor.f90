!> User pairs for the tests, in Taylor arithmetic; pairs_values.f90 holds the same in plain real numbers.
submodule (mech9_user_pair) test_pairs
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none

contains

  module subroutine user_pair(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate       !< selects the pair
    type(taylor), intent(in) :: q           !< its coordinate
    real(wp), intent(in) :: parameters(:)   !< of the pair
    type(taylor), intent(out) :: r1(3)      !< origin of the moving link [m]
    type(taylor), intent(out) :: r2(3)      !< a point on its x axis [m]
    type(taylor), intent(out) :: r3(3)      !< a third point [m]

    select case (coordinate)
    case (1)   ! a screw: its frame by columns, its origin, its advance per radian
      r1 = parameters(10:12) + parameters(13)*q*parameters(7:9)
      r2 = r1 + 2.0_wp*(cos(q)*parameters(1:3) + sin(q)*parameters(4:6))
      r3 = r1 + 0.25_wp*(r2 - r1) - 1.5_wp*parameters(7:9)
    case (2)   ! a body that runs along a curve and turns about all axes
      r1 = [2.0_wp*cos(q), sin(q), 0.3_wp*q**2]
      r2 = r1 + [1.0_wp + 0.2_wp*sin(2.0_wp*q), 0.3_wp*q, 0.2_wp*cos(q)]
      r3 = r1 + [0.1_wp*q, constant(0.4_wp), -1.0_wp - 0.2_wp*q]
    case (3)   ! all points in one line
      r1 = [q, 2.0_wp*q, constant(1.0_wp)]
      r2 = r1 + [1.0_wp, 1.0_wp, 1.0_wp]
      r3 = r1 + [2.0_wp, 2.0_wp, 2.0_wp]
    case (4)   ! ends at q = 1
      r1 = constant(ieee_value(1.0_wp, ieee_quiet_nan))
      if (q < 1.0_wp) r1 = [sqrt(1.0_wp - q), q, 0.0_wp*q]
      r2 = r1 + [1.0_wp, 0.0_wp, 0.0_wp]
      r3 = r1 + [0.0_wp, 0.0_wp, -1.0_wp]
    case (5)   ! changes fast
      r1 = [sin(8.0_wp*q), cos(8.0_wp*q), exp(-2.0_wp*q)]
      r2 = r1 + [cos(5.0_wp*q), sin(5.0_wp*q), constant(0.5_wp)]
      r3 = r1 + [constant(0.0_wp), 0.3_wp*sin(q), constant(-1.0_wp)]
    case default   ! a third point close to the line of the others
      r1 = [sin(q), cos(q), q]
      r2 = r1 + [cos(q), sin(q), 0.3_wp*q]
      r3 = r1 + 0.8_wp*(r2 - r1) + parameters(1)*[0.6_wp, 0.5_wp, -1.0_wp]
    end select
  end subroutine user_pair
end submodule test_pairs
