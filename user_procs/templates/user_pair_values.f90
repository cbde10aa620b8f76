!> Template of a pair of your own, in plain real numbers; the program differentiates it, which costs
!> 18 calls and more for each evaluation. As it stands it is a prismatic pair along x.
submodule (mech9_user_pair_values) user_pair_values_template
  implicit none

contains

  module subroutine user_pair_values(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate       !< number of the pair's coordinate, which tells pairs apart
    real(wp), intent(in) :: q               !< value of the coordinate [rad or m]
    real(wp), intent(in) :: parameters(:)   !< the numbers of &user parameters = ... /
    real(wp), intent(out) :: r1(3)          !< origin of the moving link, in the reference link [m]
    real(wp), intent(out) :: r2(3)          !< a point on its x axis [m]
    real(wp), intent(out) :: r3(3)          !< a third point: y is along (r2 - r1) x (r3 - r1) [m]

    r1 = [q, 0.0_wp, 0.0_wp]
    r2 = r1 + [1.0_wp, 0.0_wp, 0.0_wp]
    r3 = r1 - [0.0_wp, 0.0_wp, 1.0_wp]        ! 1 m below the origin, so that y and z keep their directions
  end subroutine user_pair_values
end submodule user_pair_values_template
