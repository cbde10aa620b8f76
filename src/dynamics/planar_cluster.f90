!> Articulated bodies of a closed cluster in planar arithmetic. The formulas are those of mech9_cluster_bodies, with motions and
!> wrenches of three numbers in the plane's axes, as in mech9_planar_articulated.
module mech9_planar_cluster
  use mech9_kinds, only: wp
  use mech9_cluster_bodies, only: hold_columns, divide_columns
  use mech9_planar_articulated, only: add_to_parent
  implicit none
  private
  public :: eliminate_cluster, move_cluster, add_column

contains

  !> Eliminate the accelerations of a cluster; its base gets the inertia and the wrench that are left. `found` is false where A is
  !> not positive definite beyond round-off.
  pure subroutine eliminate_cluster(n, n_held, held, n_frames, frames, base, m, n_entries, first, local, s, f, inertia, &
                                    wrench, amount, factors, column, rest, rigid, found)
    integer, intent(in) :: n                       !< number of independent coordinates of the cluster
    integer, intent(in) :: n_held                  !< number of those of them that are driven
    integer, intent(in) :: held(n_held)            !< these
    integer, intent(in) :: n_frames                !< number of its frames that carry anything
    integer, intent(in) :: frames(n_frames)        !< these frames
    integer, intent(in) :: base                    !< frame on which the cluster stands; nothing passes to frame 0
    integer, intent(in) :: m                       !< number of steps of the plan
    integer, intent(in) :: n_entries               !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)          !< first entry of each frame
    integer, intent(in) :: local(n_entries)        !< place of each entry's coordinate in the cluster
    real(wp), intent(in) :: s(3, n_entries)        !< angular velocity, velocity of the origin per unit rate, relative to the base
    real(wp), intent(in) :: f(4, 0:m)              !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(inout) :: inertia(6, 0:m)     !< J, H, M of each frame with all links beyond it outside the cluster
    real(wp), intent(inout) :: wrench(3, 0:m)      !< torque_0 and force_0 in the same way [N m, N]
    real(wp), intent(inout) :: amount(4, 0:m)      !< mass, moment and inertia in the same way, as if rigid
    real(wp), intent(out) :: factors(n, n)         !< L, lower triangle
    real(wp), intent(out) :: column(3, n)          !< Y
    real(wp), intent(inout) :: rest(n)             !< Q in, z out
    real(wp), intent(out) :: rigid(n)              !< bound of the diagonal of A, if all links beyond were rigid
    logical, intent(out) :: found                  !< whether the coordinates have inertia
    real(wp) :: x, y
    integer :: i, k, e, j

    factors = 0.0_wp
    column = 0.0_wp
    rigid = 0.0_wp
    do i = 1, n_frames
      k = frames(i)
      x = f(3, k) - f(3, base)
      y = f(4, k) - f(4, base)
      do e = first(k), first(k + 1) - 1
        j = local(e)
        call add_column(n, j, e, first(k + 1) - 1, n_entries, local, s, inertia(:, k), wrench(:, k), amount(:, k), x, y, &
                        factors, column(:, j), rest(j), rigid(j))
      end do
      if (base == 0) cycle
      call add_to_parent(x, y, inertia(:, k), wrench(:, k), amount(:, k), inertia(:, base), wrench(:, base), amount(:, base))
    end do
    if (n_held > 0) call hold_columns(n, held, 3, factors, column, rest, rigid)
    call divide_columns(m, n, 3, factors, column, rest, rigid, found)
    if (base == 0 .or. .not. found) return
    do j = 1, n
      inertia(1:3, base) = inertia(1:3, base) - column(1, j)*column(:, j)
      inertia(4, base) = inertia(4, base) - column(2, j)*column(2, j)
      inertia(5, base) = inertia(5, base) - column(2, j)*column(3, j)
      inertia(6, base) = inertia(6, base) - column(3, j)*column(3, j)
      wrench(:, base) = wrench(:, base) + column(:, j)*rest(j)
    end do
  end subroutine eliminate_cluster

  !> Add what a frame contributes to the sums for one coordinate of its cluster.
  pure subroutine add_column(n, j, e, last, n_entries, local, s, inertia, wrench, amount, x, y, factors, column, rest, rigid)
    integer, intent(in) :: n                   !< number of independent coordinates of the cluster
    integer, intent(in) :: j                   !< number of the coordinate among them
    integer, intent(in) :: e                   !< entry of the frame for it
    integer, intent(in) :: last                !< last entry of the frame
    integer, intent(in) :: n_entries           !< number of entries of all frames
    integer, intent(in) :: local(n_entries)    !< place of each entry's coordinate in the cluster
    real(wp), intent(in) :: s(3, n_entries)    !< angular velocity, velocity of the origin per unit rate, relative to the base
    real(wp), intent(in) :: inertia(6)         !< J, H, M of the frame with all links beyond it outside the cluster
    real(wp), intent(in) :: wrench(3)          !< torque_0 and force_0 in the same way [N m, N]
    real(wp), intent(in) :: amount(4)          !< mass, moment and inertia in the same way, as if rigid
    real(wp), intent(in) :: x                  !< from the base's origin to the frame's, along the first axis [m]
    real(wp), intent(in) :: y                  !< the same along the second axis [m]
    real(wp), intent(inout) :: factors(n, n)   !< A, lower triangle
    real(wp), intent(inout) :: column(3)       !< U of the coordinate
    real(wp), intent(inout) :: rest            !< Q - S^T p of the coordinate
    real(wp), intent(inout) :: rigid           !< bound of A_jj as if rigid
    real(wp) :: u(3)
    integer :: d

    u(1) = inertia(1)*s(1, e) + inertia(2)*s(2, e) + inertia(3)*s(3, e)
    u(2) = inertia(2)*s(1, e) + inertia(4)*s(2, e) + inertia(5)*s(3, e)
    u(3) = inertia(3)*s(1, e) + inertia(5)*s(2, e) + inertia(6)*s(3, e)
    rest = rest - s(1, e)*wrench(1) - s(2, e)*wrench(2) - s(3, e)*wrench(3)
    rigid = rigid + amount(4)*s(1, e)**2 + amount(1)*(s(2, e)**2 + s(3, e)**2) &
            + 2.0_wp*abs(s(1, e)*(amount(2)*s(3, e) - amount(3)*s(2, e)))
    do d = e, last
      factors(local(d), j) = factors(local(d), j) + s(1, d)*u(1) + s(2, d)*u(2) + s(3, d)*u(3)
    end do
    column(1) = column(1) + u(1) + x*u(3) - y*u(2)
    column(2) = column(2) + u(2)
    column(3) = column(3) + u(3)
  end subroutine add_column

  !> Move the frames of a cluster on which others stand by the accelerations of its base and of its coordinates.
  pure subroutine move_cluster(n, n_feet, feet, base, m, n_entries, first, local, s, f, ddq, motion)
    integer, intent(in) :: n                     !< number of independent coordinates of the cluster
    integer, intent(in) :: n_feet                !< number of frames on which others stand
    integer, intent(in) :: feet(n_feet)          !< these frames
    integer, intent(in) :: base                  !< frame on which the cluster stands
    integer, intent(in) :: m                     !< number of steps of the plan
    integer, intent(in) :: n_entries             !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)        !< first entry of each frame
    integer, intent(in) :: local(n_entries)      !< place of each entry's coordinate in the cluster
    real(wp), intent(in) :: s(3, n_entries)      !< angular velocity, velocity of the origin per unit rate, relative to the base
    real(wp), intent(in) :: f(4, 0:m)            !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: ddq(n)               !< accelerations of the cluster's independent coordinates [rad/s^2, m/s^2]
    real(wp), intent(inout) :: motion(3, 0:m)    !< accelerations less those that rates alone give; gets those of these frames
    real(wp) :: d(3)
    integer :: i, k, e

    do i = 1, n_feet
      k = feet(i)
      d = motion(:, base)
      d(2) = d(2) - d(1)*(f(4, k) - f(4, base))
      d(3) = d(3) + d(1)*(f(3, k) - f(3, base))
      do e = first(k), first(k + 1) - 1
        d = d + ddq(local(e))*s(:, e)
      end do
      motion(:, k) = d
    end do
  end subroutine move_cluster
end module mech9_planar_cluster
