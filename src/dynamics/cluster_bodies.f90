!> Articulated bodies of a closed cluster: its independent accelerations are eliminated together, as those of an open step are one
!> by one (constraint embedding: Jain; Chignoli and others in docs/reference/bibliography.md).
!>
!> With the columns S_f = d(motion of frame f relative to the base)/d(rates of the cluster's independent coordinates), in which
!> the dependent coordinates are eliminated already, the inertia I_f of all that frame f carries, and its wrench p_f, about the
!> origin of the frame, with X_f the motion of the frame per motion of the base:
!>   A = sum S_f^T I_f S_f,   U = sum X_f^T I_f S_f,   ddq = A^-1 (Q - sum S_f^T p_f - U^T (motion of the base)),
!> so that the inertia sum X_f^T I_f X_f - U A^-1 U^T passes to the base. Only A, of the cluster's own freedoms, is factorized:
!> A = L L^T, with Y = U L^-T and z = L^-1 (Q - sum S_f^T p_f). All vectors are in fixed axes.
module mech9_cluster_bodies
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_cholesky, only: cholesky_factorize
  use mech9_articulated_bodies, only: add_to_parent, rigid_inertia
  use mech9_driven_equations, only: hold
  implicit none
  private
  public :: cluster_work_type, new_cluster_work, find_rest, hold_columns, divide_columns, find_accelerations, &
    add_frames, eliminate_cluster, move_cluster

  !> Scratch of one closed cluster with n independent coordinates, sized once.
  type :: cluster_work_type
    real(wp), allocatable :: factors(:, :)      !< (n,n) A, then L, lower triangle
    real(wp), allocatable :: column(:, :)       !< (6,n), in a plane (3,n): U, then Y
    real(wp), allocatable :: rest(:)            !< (n) Q - S^T p, then z
    real(wp), allocatable :: rigid(:)           !< (n) diagonal of A at most, if all links beyond were rigid
    real(wp), allocatable :: ddq(:)             !< (n) accelerations of the independent coordinates [rad/s^2, m/s^2]
  end type cluster_work_type

contains

  !> Room for a cluster.
  pure function new_cluster_work(dimensions, n) result(work)
    integer, intent(in) :: dimensions   !< of a motion: 6 in space, 3 in a plane
    integer, intent(in) :: n            !< number of independent coordinates
    type(cluster_work_type) :: work

    allocate (work%factors(n, n), work%column(dimensions, n), work%rest(n), work%rigid(n), work%ddq(n), source=0.0_wp)
  end function new_cluster_work

  !> The generalized forces on the independent coordinates of a cluster by those on all its coordinates.
  pure subroutine find_rest(steps, coordinates, first, local, b, generalized, rest)
    integer, intent(in) :: steps(:)            !< steps of the cluster
    integer, intent(in) :: coordinates(:)      !< coordinates of these steps
    integer, intent(in) :: first(0:)           !< (0:M+1) first entry of each frame
    integer, intent(in) :: local(:)            !< (entries) place of each entry's coordinate in the cluster
    real(wp), intent(in) :: b(:)               !< (entries) rate of the step's coordinate per unit rate of an independent one
    real(wp), intent(in) :: generalized(:)     !< (M) generalized force on each coordinate [N m or N]
    real(wp), intent(inout) :: rest(:)         !< (n) gets them, added
    integer :: i, e

    do i = 1, size(steps)
      do e = first(steps(i)), first(steps(i) + 1) - 1
        rest(local(e)) = rest(local(e)) + b(e)*generalized(coordinates(i))
      end do
    end do
  end subroutine find_rest

  !> Add the frames of a cluster to the sums A, U and Q - S^T p, and to the inertia and the wrench of its base.
  pure subroutine add_frames(n, n_frames, frames, base, m, n_entries, first, local, w, v, p, inertia, wrench, amount, factors, &
                             column, rest, rigid)
    integer, intent(in) :: n                        !< number of independent coordinates of the cluster
    integer, intent(in) :: n_frames                 !< number of its frames that carry anything
    integer, intent(in) :: frames(n_frames)         !< these frames
    integer, intent(in) :: base                     !< frame on which the cluster stands; nothing passes to frame 0
    integer, intent(in) :: m                        !< number of steps of the plan
    integer, intent(in) :: n_entries                !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)           !< first entry of each frame
    integer, intent(in) :: local(n_entries)         !< place of each entry's coordinate in the cluster
    real(wp), intent(in) :: w(3, n_entries)         !< angular velocity per unit rate, relative to the base
    real(wp), intent(in) :: v(3, n_entries)         !< velocity of the origin per unit rate, relative to the base
    real(wp), intent(in) :: p(3, 0:m)               !< origin of each frame [m]
    real(wp), intent(inout) :: inertia(3, 9, 0:m)   !< J, H, M of each frame with all links beyond it outside the cluster
    real(wp), intent(inout) :: wrench(6, 0:m)       !< torque_0 and force_0 in the same way [N m, N]
    real(wp), intent(inout) :: amount(5, 0:m)       !< mass, moment and sum of m r^2 in the same way, as if rigid
    real(wp), intent(inout) :: factors(n, n)        !< A, lower triangle
    real(wp), intent(inout) :: column(6, n)         !< U
    real(wp), intent(inout) :: rest(n)              !< Q - S^T p
    real(wp), intent(inout) :: rigid(n)             !< bound of the diagonal of A, if all links beyond were rigid
    real(wp) :: torque(3), force(3), arm(3)
    integer :: i, f, e, d, j

    do i = 1, n_frames
      f = frames(i)
      arm = p(:, f) - p(:, base)
      do e = first(f), first(f + 1) - 1
        j = local(e)
        torque = turn(inertia(:, 1:3, f), w(:, e)) + turn(inertia(:, 4:6, f), v(:, e))
        force = turn_back(inertia(:, 4:6, f), w(:, e)) + turn(inertia(:, 7:9, f), v(:, e))
        rest(j) = rest(j) - dot_product(w(:, e), wrench(1:3, f)) - dot_product(v(:, e), wrench(4:6, f))
        rigid(j) = rigid(j) + rigid_inertia(amount(:, f), w(:, e), v(:, e))
        do d = e, first(f + 1) - 1
          factors(local(d), j) = factors(local(d), j) + dot_product(w(:, d), torque) + dot_product(v(:, d), force)
        end do
        if (base == 0) cycle
        column(1:3, j) = column(1:3, j) + torque + cross(arm, force)
        column(4:6, j) = column(4:6, j) + force
      end do
      if (base == 0) cycle
      call add_to_parent(arm, inertia(:, :, f), wrench(:, f), amount(:, f), inertia(:, :, base), wrench(:, base), &
                         amount(:, base))
    end do
  end subroutine add_frames

  !> Eliminate the accelerations of a cluster; its base gets the inertia and the wrench that are left. `found` is false where A is
  !> not positive definite beyond round-off.
  pure subroutine eliminate_cluster(m, n, n_held, held, base, inertia, wrench, factors, column, rest, rigid, found)
    integer, intent(in) :: m                    !< number of steps of the plan
    integer, intent(in) :: n                    !< number of independent coordinates of the cluster
    integer, intent(in) :: n_held               !< number of those of them that are driven
    integer, intent(in) :: held(n_held)         !< these
    integer, intent(in) :: base                 !< frame on which the cluster stands; nothing passes to frame 0
    real(wp), intent(inout) :: inertia(3, 9)    !< J, H, M of the base with all links beyond it
    real(wp), intent(inout) :: wrench(6)        !< torque_0 and force_0 in the same way [N m, N]
    real(wp), intent(inout) :: factors(n, n)    !< A in, L out, lower triangle
    real(wp), intent(inout) :: column(6, n)     !< U in, Y out
    real(wp), intent(inout) :: rest(n)          !< Q - S^T p in, z out
    real(wp), intent(inout) :: rigid(n)         !< bound of the diagonal of A in; least pivots that count out
    logical, intent(out) :: found               !< whether the coordinates have inertia
    integer :: i, j

    if (n_held > 0) call hold_columns(n, held, 6, factors, column, rest, rigid)
    call divide_columns(m, n, 6, factors, column, rest, rigid, found)
    if (base == 0 .or. .not. found) return
    do j = 1, n
      do i = 1, 3
        inertia(:, i) = inertia(:, i) - column(1:3, j)*column(i, j)
        inertia(:, 3 + i) = inertia(:, 3 + i) - column(1:3, j)*column(3 + i, j)
        inertia(:, 6 + i) = inertia(:, 6 + i) - column(4:6, j)*column(3 + i, j)
      end do
      wrench = wrench + column(:, j)*rest(j)
    end do
  end subroutine eliminate_cluster

  !> Leave the accelerations of driven coordinates as they are given: nothing of them is eliminated.
  pure subroutine hold_columns(n, held, dimensions, factors, column, rest, rigid)
    integer, intent(in) :: n                             !< number of independent coordinates of the cluster
    integer, intent(in) :: held(:)                       !< those of them that are driven
    integer, intent(in) :: dimensions                    !< of a motion: 6 in space, 3 in a plane
    real(wp), intent(inout) :: factors(n, n)             !< A, lower triangle
    real(wp), intent(inout) :: column(dimensions, n)     !< U
    real(wp), intent(inout) :: rest(n)                   !< Q - S^T p
    real(wp), intent(inout) :: rigid(n)                  !< bound of A_jj as if rigid

    call hold(n, held, factors, rest)
    column(:, held) = 0.0_wp
    rigid(held) = 0.0_wp
  end subroutine hold_columns

  !> Factorize A = L L^T, and divide by L: Y = U L^-T, z = L^-1 (Q - S^T p). `found` is false where A is not positive definite
  !> beyond round-off, which is that of the inertia as if rigid.
  pure subroutine divide_columns(m, n, dimensions, factors, column, rest, rigid, found)
    integer, intent(in) :: m                             !< number of steps of the plan
    integer, intent(in) :: n                             !< number of independent coordinates of the cluster
    integer, intent(in) :: dimensions                    !< of a motion: 6 in space, 3 in a plane
    real(wp), intent(inout) :: factors(n, n)             !< A in, L out, lower triangle
    real(wp), intent(inout) :: column(dimensions, n)     !< U in, Y out
    real(wp), intent(inout) :: rest(n)                   !< Q - S^T p in, z out
    real(wp), intent(inout) :: rigid(n)                  !< bound of A_jj as if rigid in, least pivots that count out
    logical, intent(out) :: found                        !< whether A is positive definite
    integer :: failed_at, j, k

    ! a pivot within round-off counts as zero, as for an open step
    rigid = 8.0_wp*m*epsilon(1.0_wp)*rigid
    call cholesky_factorize(n, factors, failed_at, least=rigid)
    found = failed_at == 0
    if (.not. found) return
    do j = 1, n
      do k = 1, j - 1
        column(:, j) = column(:, j) - factors(j, k)*column(:, k)
        rest(j) = rest(j) - factors(j, k)*rest(k)
      end do
      column(:, j) = column(:, j)/factors(j, j)
      rest(j) = rest(j)/factors(j, j)
    end do
  end subroutine divide_columns

  !> The accelerations of a cluster's independent coordinates for a motion of its base, ddq = L^-T (z - Y^T (motion of the base)).
  pure subroutine find_accelerations(n, places, dimensions, factors, column, rest, motion, ddq, accelerations)
    integer, intent(in) :: n                          !< number of independent coordinates of the cluster
    integer, intent(in) :: places(n)                  !< their places among all independent coordinates
    integer, intent(in) :: dimensions                 !< of a motion: 6 in space, 3 in a plane
    real(wp), intent(in) :: factors(n, n)             !< L, lower triangle
    real(wp), intent(in) :: column(dimensions, n)     !< Y
    real(wp), intent(in) :: rest(n)                   !< z
    real(wp), intent(in) :: motion(dimensions)        !< accelerations of the base less those that rates alone give
    real(wp), intent(out) :: ddq(n)                   !< accelerations [rad/s^2, m/s^2]
    real(wp), intent(inout) :: accelerations(*)       !< of all independent coordinates; gets those of the cluster
    integer :: i, j

    do j = n, 1, -1
      ddq(j) = rest(j)
      do i = 1, dimensions
        ddq(j) = ddq(j) - column(i, j)*motion(i)
      end do
      do i = j + 1, n
        ddq(j) = ddq(j) - factors(i, j)*ddq(i)
      end do
      ddq(j) = ddq(j)/factors(j, j)
      accelerations(places(j)) = ddq(j)
    end do
  end subroutine find_accelerations

  !> Move the frames of a cluster on which others stand by the accelerations of its base and of its coordinates.
  pure subroutine move_cluster(n, n_feet, feet, base, m, n_entries, first, local, w, v, p, ddq, motion)
    integer, intent(in) :: n                     !< number of independent coordinates of the cluster
    integer, intent(in) :: n_feet                !< number of frames on which others stand
    integer, intent(in) :: feet(n_feet)          !< these frames
    integer, intent(in) :: base                  !< frame on which the cluster stands
    integer, intent(in) :: m                     !< number of steps of the plan
    integer, intent(in) :: n_entries             !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)        !< first entry of each frame
    integer, intent(in) :: local(n_entries)      !< place of each entry's coordinate in the cluster
    real(wp), intent(in) :: w(3, n_entries)      !< angular velocity per unit rate, relative to the base
    real(wp), intent(in) :: v(3, n_entries)      !< velocity of the origin per unit rate, relative to the base
    real(wp), intent(in) :: p(3, 0:m)            !< origin of each frame [m]
    real(wp), intent(in) :: ddq(n)               !< accelerations of the cluster's independent coordinates [rad/s^2, m/s^2]
    real(wp), intent(inout) :: motion(6, 0:m)    !< accelerations less those that rates alone give; gets those of these frames
    real(wp) :: dw(3), dv(3)
    integer :: i, f, e

    do i = 1, n_feet
      f = feet(i)
      dw = motion(1:3, base)
      dv = motion(4:6, base) + cross(dw, p(:, f) - p(:, base))
      do e = first(f), first(f + 1) - 1
        dw = dw + ddq(local(e))*w(:, e)
        dv = dv + ddq(local(e))*v(:, e)
      end do
      motion(1:3, f) = dw
      motion(4:6, f) = dv
    end do
  end subroutine move_cluster
end module mech9_cluster_bodies
