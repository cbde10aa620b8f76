!> The elliptic trammel of trammel.f90 in plain real numbers: the same points, and the program finds
!> their derivatives.
submodule (mech9_user_pair_values) trammel_values
  implicit none

contains

  module subroutine user_pair_values(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate       !< number of the pair's coordinate, which tells pairs apart
    real(wp), intent(in) :: q               !< angle of AB [rad]
    real(wp), intent(in) :: parameters(:)   !< length of AB [m]
    real(wp), intent(out) :: r1(3)          !< origin of the moving link, in the reference link [m]
    real(wp), intent(out) :: r2(3)          !< a point on its x axis [m]
    real(wp), intent(out) :: r3(3)          !< a third point: y is along (r2 - r1) x (r3 - r1) [m]

    r1 = [parameters(1)*cos(q), 0.0_wp, 0.0_wp]
    r2 = [0.0_wp, parameters(1)*sin(q), 0.0_wp]
    r3 = r1 - [0.0_wp, 0.0_wp, 1.0_wp]   ! below A, never in line with A and B
  end subroutine user_pair_values
end submodule trammel_values
