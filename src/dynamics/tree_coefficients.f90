!> Coefficients of motion and forces on independent coordinates of a tree of clusters, by sums over the frames.
!>
!> A column of the coefficients is the set of generalized forces that accelerate one independent coordinate alone, without other
!> motion: the columns of the frames give the accelerations of all links outward, and collect the wrenches that these require
!> inward. All n columns cost n times the number of links; accelerations do not require them.
module mech9_tree_coefficients
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, cross
  implicit none
  private
  public :: accelerate_in_space, collect_in_space, accelerate_in_plane, collect_in_plane

contains

  !> The wrench that each frame's own bodies require for the acceleration 1 of one independent coordinate. Vectors are in fixed
  !> axes.
  pure subroutine accelerate_in_space(place, m, n_entries, first, column, support, w, v, p, inertia, motion, wrench)
    integer, intent(in) :: place                  !< place of the coordinate among the independent ones
    integer, intent(in) :: m                      !< number of steps
    integer, intent(in) :: n_entries              !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)         !< first entry of each frame
    integer, intent(in) :: column(n_entries)      !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)             !< frame on which the cluster of each step stands
    real(wp), intent(in) :: w(3, n_entries)       !< angular velocity per unit rate, relative to the support
    real(wp), intent(in) :: v(3, n_entries)       !< velocity of the origin per unit rate, relative to the support
    real(wp), intent(in) :: p(3, 0:m)             !< origin of each frame [m]
    real(wp), intent(in) :: inertia(3, 9, 0:m)    !< J, H, M of each frame's own bodies
    real(wp), intent(inout) :: motion(6, 0:m)     !< gets the accelerations of the frames; zero for frame 0
    real(wp), intent(inout) :: wrench(6, 0:m)     !< gets the wrenches
    real(wp) :: dw(3), dv(3)
    integer :: s, e

    do s = 1, m
      dw = motion(1:3, support(s))
      dv = motion(4:6, support(s)) + cross(dw, p(:, s) - p(:, support(s)))
      do e = first(s), first(s + 1) - 1
        if (column(e) /= place) cycle
        dw = dw + w(:, e)
        dv = dv + v(:, e)
      end do
      motion(1:3, s) = dw
      motion(4:6, s) = dv
      wrench(1:3, s) = turn(inertia(:, 1:3, s), dw) + turn(inertia(:, 4:6, s), dv)
      wrench(4:6, s) = turn_back(inertia(:, 4:6, s), dw) + turn(inertia(:, 7:9, s), dv)
    end do
  end subroutine accelerate_in_space

  !> The generalized forces on the independent coordinates by the wrenches on all frames. Vectors are in fixed axes.
  pure subroutine collect_in_space(m, n_entries, first, column, support, w, v, p, wrench, n, values)
    integer, intent(in) :: m                   !< number of steps
    integer, intent(in) :: n_entries           !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)      !< first entry of each frame
    integer, intent(in) :: column(n_entries)   !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)          !< frame on which the cluster of each step stands
    real(wp), intent(in) :: w(3, n_entries)    !< angular velocity per unit rate, relative to the support
    real(wp), intent(in) :: v(3, n_entries)    !< velocity of the origin per unit rate, relative to the support
    real(wp), intent(in) :: p(3, 0:m)          !< origin of each frame [m]
    real(wp), intent(inout) :: wrench(6, 0:m)  !< on each frame; then on all links beyond it, too [N m, N]
    integer, intent(in) :: n                   !< number of independent coordinates
    real(wp), intent(out) :: values(n)         !< generalized forces [N m or N]
    integer :: s, e, f

    values = 0.0_wp
    do s = m, 1, -1
      do e = first(s), first(s + 1) - 1
        values(column(e)) = values(column(e)) + dot_product(w(:, e), wrench(1:3, s)) + dot_product(v(:, e), wrench(4:6, s))
      end do
      f = support(s)
      wrench(1:3, f) = wrench(1:3, f) + wrench(1:3, s) + cross(p(:, s) - p(:, f), wrench(4:6, s))
      wrench(4:6, f) = wrench(4:6, f) + wrench(4:6, s)
    end do
  end subroutine collect_in_space

  !> The wrench that each frame's own bodies require for the acceleration 1 of one independent coordinate. Vectors are in the
  !> plane's axes.
  pure subroutine accelerate_in_plane(place, m, n_entries, first, column, support, columns, f, inertia, motion, wrench)
    integer, intent(in) :: place                    !< place of the coordinate among the independent ones
    integer, intent(in) :: m                        !< number of steps
    integer, intent(in) :: n_entries                !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)           !< first entry of each frame
    integer, intent(in) :: column(n_entries)        !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)               !< frame on which the cluster of each step stands
    real(wp), intent(in) :: columns(3, n_entries)   !< angular velocity, velocity of the origin per unit rate, relative to it
    real(wp), intent(in) :: f(4, 0:m)               !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: inertia(6, 0:m)         !< J, Hx, Hy, Mxx, Mxy, Myy of each frame's own bodies
    real(wp), intent(inout) :: motion(3, 0:m)       !< gets the accelerations of the frames; zero for frame 0
    real(wp), intent(inout) :: wrench(3, 0:m)       !< gets the wrenches
    real(wp) :: d(3)
    integer :: s, e, k

    do s = 1, m
      k = support(s)
      d = motion(:, k)
      d(2) = d(2) - d(1)*(f(4, s) - f(4, k))
      d(3) = d(3) + d(1)*(f(3, s) - f(3, k))
      do e = first(s), first(s + 1) - 1
        if (column(e) == place) d = d + columns(:, e)
      end do
      motion(:, s) = d
      wrench(1, s) = inertia(1, s)*d(1) + inertia(2, s)*d(2) + inertia(3, s)*d(3)
      wrench(2, s) = inertia(2, s)*d(1) + inertia(4, s)*d(2) + inertia(5, s)*d(3)
      wrench(3, s) = inertia(3, s)*d(1) + inertia(5, s)*d(2) + inertia(6, s)*d(3)
    end do
  end subroutine accelerate_in_plane

  !> The generalized forces on the independent coordinates by the wrenches on all frames. Vectors are in the plane's axes.
  pure subroutine collect_in_plane(m, n_entries, first, column, support, columns, f, wrench, n, values)
    integer, intent(in) :: m                        !< number of steps
    integer, intent(in) :: n_entries                !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)           !< first entry of each frame
    integer, intent(in) :: column(n_entries)        !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)               !< frame on which the cluster of each step stands
    real(wp), intent(in) :: columns(3, n_entries)   !< angular velocity, velocity of the origin per unit rate, relative to it
    real(wp), intent(in) :: f(4, 0:m)               !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(inout) :: wrench(3, 0:m)       !< on each frame; then on all links beyond it, too [N m, N]
    integer, intent(in) :: n                        !< number of independent coordinates
    real(wp), intent(out) :: values(n)              !< generalized forces [N m or N]
    integer :: s, e, k

    values = 0.0_wp
    do s = m, 1, -1
      do e = first(s), first(s + 1) - 1
        values(column(e)) = values(column(e)) + dot_product(columns(:, e), wrench(:, s))
      end do
      k = support(s)
      wrench(1, k) = wrench(1, k) + wrench(1, s) + (f(3, s) - f(3, k))*wrench(3, s) - (f(4, s) - f(4, k))*wrench(2, s)
      wrench(2:3, k) = wrench(2:3, k) + wrench(2:3, s)
    end do
  end subroutine collect_in_plane
end module mech9_tree_coefficients
