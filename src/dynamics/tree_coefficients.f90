!> Coefficients of motion and forces on independent coordinates of a tree of clusters, by sums over the frames.
!>
!> A column of the coefficients is the set of generalized forces that accelerate one independent coordinate alone, without other
!> motion: the columns of the frames give the accelerations of all links outward, and collect the wrenches that these require
!> inward. Each column goes through the frames within reach of its coordinate only. In a chain of n links all columns cost n^2;
!> accelerations do not require them.
module mech9_tree_coefficients
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, cross
  implicit none
  private
  public :: find_reach, accelerate_in_space, collect_in_space, accelerate_in_plane, collect_in_plane

contains

  !> The frames within reach of each independent coordinate: its first frame, and the last frame that stands on one of its frames.
  pure subroutine find_reach(m, n_entries, first, column, support, n, reach)
    integer, intent(in) :: m                   !< number of steps
    integer, intent(in) :: n_entries           !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)      !< first entry of each frame
    integer, intent(in) :: column(n_entries)   !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)          !< frame on which the cluster of each step stands
    integer, intent(in) :: n                   !< number of independent coordinates
    integer, intent(out) :: reach(2, n)        !< first and last frame of each; an empty range where it moves none
    integer :: last(0:m), s, e

    last = [(s, s=0, m)]
    reach(1, :) = m + 1
    reach(2, :) = 0
    do s = m, 1, -1
      last(support(s)) = max(last(support(s)), last(s))
      do e = first(s), first(s + 1) - 1
        reach(1, column(e)) = s
        reach(2, column(e)) = max(reach(2, column(e)), last(s))
      end do
    end do
  end subroutine find_reach

  !> The wrench that each frame's own bodies require for the acceleration 1 of one independent coordinate. Vectors are in fixed
  !> axes.
  pure subroutine accelerate_in_space(place, reach, m, n_entries, first, column, support, w, v, p, inertia, motion, wrench)
    integer, intent(in) :: place                  !< place of the coordinate among the independent ones
    integer, intent(in) :: reach(2)               !< first and last frame within its reach
    integer, intent(in) :: m                      !< number of steps
    integer, intent(in) :: n_entries              !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)         !< first entry of each frame
    integer, intent(in) :: column(n_entries)      !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)             !< frame on which the cluster of each step stands
    real(wp), intent(in) :: w(3, n_entries)       !< angular velocity per unit rate, relative to the support
    real(wp), intent(in) :: v(3, n_entries)       !< velocity of the origin per unit rate, relative to the support
    real(wp), intent(in) :: p(3, 0:m)             !< origin of each frame [m]
    real(wp), intent(in) :: inertia(3, 9, 0:m)    !< J, H, M of each frame's own bodies
    real(wp), intent(inout) :: motion(6, 0:m)     !< gets the accelerations of these frames; zero for all before them
    real(wp), intent(inout) :: wrench(6, 0:m)     !< gets the wrenches of these frames
    real(wp) :: dw(3), dv(3)
    integer :: s, e

    do s = reach(1), reach(2)
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

  !> The generalized forces on the independent coordinates by the wrenches on some frames. Vectors are in fixed axes.
  pure subroutine collect_in_space(reach, m, n_entries, first, column, support, w, v, p, wrench, n, values)
    integer, intent(in) :: reach(2)            !< first and last of these frames; no other frame stands on them
    integer, intent(in) :: m                   !< number of steps
    integer, intent(in) :: n_entries           !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)      !< first entry of each frame
    integer, intent(in) :: column(n_entries)   !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)          !< frame on which the cluster of each step stands
    real(wp), intent(in) :: w(3, n_entries)    !< angular velocity per unit rate, relative to the support
    real(wp), intent(in) :: v(3, n_entries)    !< velocity of the origin per unit rate, relative to the support
    real(wp), intent(in) :: p(3, 0:m)          !< origin of each frame [m]
    real(wp), intent(inout) :: wrench(6, 0:m)  !< on each of the frames; then on all links beyond it, too [N m, N]
    integer, intent(in) :: n                   !< number of independent coordinates
    real(wp), intent(out) :: values(n)         !< generalized forces [N m or N]
    integer :: s, e, f

    values = 0.0_wp
    if (reach(1) > reach(2)) return
    call clear_below(reach(1), m, support, wrench)
    ! the frames within reach, then those on which they stand
    s = reach(2)
    do while (s > 0)
      do e = first(s), first(s + 1) - 1
        values(column(e)) = values(column(e)) + dot_product(w(:, e), wrench(1:3, s)) + dot_product(v(:, e), wrench(4:6, s))
      end do
      f = support(s)
      wrench(1:3, f) = wrench(1:3, f) + wrench(1:3, s) + cross(p(:, s) - p(:, f), wrench(4:6, s))
      wrench(4:6, f) = wrench(4:6, f) + wrench(4:6, s)
      s = merge(s - 1, support(s), s > reach(1))
    end do
  end subroutine collect_in_space

  !> The wrench that each frame's own bodies require for the acceleration 1 of one independent coordinate. Vectors are in the
  !> plane's axes.
  pure subroutine accelerate_in_plane(place, reach, m, n_entries, first, column, support, columns, f, inertia, motion, wrench)
    integer, intent(in) :: place                    !< place of the coordinate among the independent ones
    integer, intent(in) :: reach(2)                 !< first and last frame within its reach
    integer, intent(in) :: m                        !< number of steps
    integer, intent(in) :: n_entries                !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)           !< first entry of each frame
    integer, intent(in) :: column(n_entries)        !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)               !< frame on which the cluster of each step stands
    real(wp), intent(in) :: columns(3, n_entries)   !< angular velocity, velocity of the origin per unit rate, relative to it
    real(wp), intent(in) :: f(4, 0:m)               !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: inertia(6, 0:m)         !< J, Hx, Hy, Mxx, Mxy, Myy of each frame's own bodies
    real(wp), intent(inout) :: motion(3, 0:m)       !< gets the accelerations of these frames; zero for all before them
    real(wp), intent(inout) :: wrench(3, 0:m)       !< gets the wrenches of these frames
    real(wp) :: d(3)
    integer :: s, e, k

    do s = reach(1), reach(2)
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

  !> The generalized forces on the independent coordinates by the wrenches on some frames. Vectors are in the plane's axes.
  pure subroutine collect_in_plane(reach, m, n_entries, first, column, support, columns, f, wrench, n, values)
    integer, intent(in) :: reach(2)                 !< first and last of these frames; no other frame stands on them
    integer, intent(in) :: m                        !< number of steps
    integer, intent(in) :: n_entries                !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)           !< first entry of each frame
    integer, intent(in) :: column(n_entries)        !< place of each entry's coordinate among the independent ones
    integer, intent(in) :: support(m)               !< frame on which the cluster of each step stands
    real(wp), intent(in) :: columns(3, n_entries)   !< angular velocity, velocity of the origin per unit rate, relative to it
    real(wp), intent(in) :: f(4, 0:m)               !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(inout) :: wrench(3, 0:m)       !< on each of the frames; then on all links beyond it, too [N m, N]
    integer, intent(in) :: n                        !< number of independent coordinates
    real(wp), intent(out) :: values(n)              !< generalized forces [N m or N]
    integer :: s, e, k

    values = 0.0_wp
    if (reach(1) > reach(2)) return
    call clear_below(reach(1), m, support, wrench)
    ! the frames within reach, then those on which they stand
    s = reach(2)
    do while (s > 0)
      do e = first(s), first(s + 1) - 1
        values(column(e)) = values(column(e)) + dot_product(columns(:, e), wrench(:, s))
      end do
      k = support(s)
      wrench(1, k) = wrench(1, k) + wrench(1, s) + (f(3, s) - f(3, k))*wrench(3, s) - (f(4, s) - f(4, k))*wrench(2, s)
      wrench(2:3, k) = wrench(2:3, k) + wrench(2:3, s)
      s = merge(s - 1, support(s), s > reach(1))
    end do
  end subroutine collect_in_plane

  !> Set the wrenches to zero on the frames on which a frame stands. Link 1 keeps its wrench, which nothing reads.
  pure subroutine clear_below(frame, m, support, wrench)
    integer, intent(in) :: frame                              !< number of the frame
    integer, intent(in) :: m                                  !< number of steps
    integer, intent(in) :: support(m)                         !< frame on which the cluster of each step stands
    real(wp), contiguous, intent(inout) :: wrench(:, 0:)      !< on each frame [N m, N]
    integer :: s

    s = support(frame)
    do while (s > 0)
      wrench(:, s) = 0.0_wp
      s = support(s)
    end do
  end subroutine clear_below
end module mech9_tree_coefficients
