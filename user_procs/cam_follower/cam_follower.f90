!> A link that runs along the edge of a disc cam, always tangent to it. The submodule wraps the old fixed-form
!> subroutines of oldcam.f, which are linked as they are.
!>
!> The parameters are base radius [m], lift [m] and number of lobes. The coordinate q is the polar angle on
!> the cam. The moving link has its origin on the edge, x along the tangent, and z parallel to that of the cam.
submodule (mech9_user_pair_values) cam_follower
  implicit none

  ! the old routines have no interface of their own, so that the compiler cannot check these
  interface
    subroutine campt(phi, x, y, tx, ty)
      import :: wp
      real(wp), intent(in) :: phi   !< polar angle on the cam [rad]
      real(wp), intent(out) :: x    !< of the point on the edge [m]
      real(wp), intent(out) :: y    !< of the point on the edge [m]
      real(wp), intent(out) :: tx   !< of the tangent at this point, not of length one
      real(wp), intent(out) :: ty   !< of the tangent at this point, not of length one
    end subroutine campt

    subroutine camset(rb0, h0, n0)
      import :: wp
      real(wp), intent(in) :: rb0   !< base radius [m]
      real(wp), intent(in) :: h0    !< lift [m]
      integer, intent(in) :: n0     !< number of lobes
    end subroutine camset
  end interface

contains

  module subroutine user_pair_values(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate       !< number of the pair's coordinate, which tells pairs apart
    real(wp), intent(in) :: q               !< polar angle on the cam [rad]
    real(wp), intent(in) :: parameters(:)   !< base radius [m], lift [m], number of lobes
    real(wp), intent(out) :: r1(3)          !< origin of the moving link, in the reference link [m]
    real(wp), intent(out) :: r2(3)          !< a point on its x axis [m]
    real(wp), intent(out) :: r3(3)          !< a third point: y is along (r2 - r1) x (r3 - r1) [m]
    real(wp) :: x, y, tx, ty

    ! set anew in each call, so that numbers left in the COMMON block by another call cannot do harm
    call camset(parameters(1), parameters(2), nint(parameters(3)))
    call campt(q, x, y, tx, ty)
    r1 = [x, y, 0.0_wp]
    r2 = r1 + [tx, ty, 0.0_wp]
    r3 = r1 - [0.0_wp, 0.0_wp, 1.0_wp]
  end subroutine user_pair_values
end submodule cam_follower
