!> An elliptic trammel: a link whose point A slides along the x axis and whose point B slides along
!> the y axis of the reference link. Every other point of the line AB runs on an ellipse.
!>
!> Parameter 1 is the length a of AB [m]. The coordinate q is the angle of AB:
!> A = (a cos q, 0, 0), B = (0, a sin q, 0). The moving link has its origin in A, x towards B, and z parallel to that of
!> the reference link.
submodule (mech9_user_pair) trammel
  implicit none

contains

  module subroutine user_pair(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate       !< number of the pair's coordinate, which tells pairs apart
    type(taylor), intent(in) :: q           !< angle of AB [rad]
    real(wp), intent(in) :: parameters(:)   !< length of AB [m]
    type(taylor), intent(out) :: r1(3)      !< origin of the moving link, in the reference link [m]
    type(taylor), intent(out) :: r2(3)      !< a point on its x axis [m]
    type(taylor), intent(out) :: r3(3)      !< a third point: y is along (r2 - r1) x (r3 - r1) [m]
    type(taylor) :: nought

    nought = constant(0.0_wp)
    r1 = [parameters(1)*cos(q), nought, nought]
    r2 = [nought, parameters(1)*sin(q), nought]
    r3 = r1 - [0.0_wp, 0.0_wp, 1.0_wp]   ! below A, never in line with A and B
  end subroutine user_pair
end submodule trammel
