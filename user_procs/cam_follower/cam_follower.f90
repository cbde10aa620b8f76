!> A link that runs along the edge of a disc cam, always tangent to it: wraps the old fixed-form
!> subroutines of oldcam.f, which are linked as they are.
!>
!> Parameters: base radius [m], lift [m], number of lobes. The coordinate q is the polar angle on
!> the cam. Moving link: origin on the edge, x along the tangent, z stays z.
submodule (mech9_user_pair_values) cam_follower
  implicit none

  ! the old routines have no interface of their own; these are checked by no one but you
  interface
    subroutine campt(phi, x, y, tx, ty)
      import :: wp
      real(wp), intent(in) :: phi
      real(wp), intent(out) :: x, y, tx, ty
    end subroutine campt

    subroutine camset(rb0, h0, n0)
      import :: wp
      real(wp), intent(in) :: rb0, h0
      integer, intent(in) :: n0
    end subroutine camset
  end interface

contains

  module subroutine user_pair_values(coordinate, q, parameters, r1, r2, r3)
    integer, intent(in) :: coordinate
    real(wp), intent(in) :: q
    real(wp), intent(in) :: parameters(:)
    real(wp), intent(out) :: r1(3), r2(3), r3(3)
    real(wp) :: x, y, tx, ty

    ! set anew in each call: what is left in a COMMON block from elsewhere cannot do harm
    call camset(parameters(1), parameters(2), nint(parameters(3)))
    call campt(q, x, y, tx, ty)
    r1 = [x, y, 0.0_wp]
    r2 = r1 + [tx, ty, 0.0_wp]
    r3 = r1 - [0.0_wp, 0.0_wp, 1.0_wp]
  end subroutine user_pair_values
end submodule cam_follower
