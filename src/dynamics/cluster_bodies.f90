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
  use mech9_articulated_bodies, only: articulated_body_type, add_to_parent, rigid_inertia
  use mech9_frame_columns, only: frame_entries_type
  use mech9_tree_stages, only: stage_type
  use mech9_driven_equations, only: hold
  implicit none
  private
  public :: cluster_work_type, new_cluster_work, find_rest, divide_columns, find_accelerations, add_frames, eliminate_cluster, &
    move_cluster

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
  pure subroutine find_rest(stage, entries, b, generalized, rest)
    type(stage_type), intent(in) :: stage             !< the cluster
    type(frame_entries_type), intent(in) :: entries   !< of all frames
    real(wp), intent(in) :: b(:)               !< (entries) rate of the step's coordinate per unit rate of an independent one
    real(wp), intent(in) :: generalized(:)     !< (M) generalized force on each coordinate [N m or N]
    real(wp), intent(inout) :: rest(:)         !< (n) gets them, added
    integer :: i, e, s

    do i = 1, size(stage%steps)
      s = stage%steps(i)
      do e = entries%first(s), entries%first(s + 1) - 1
        rest(entries%local(e)) = rest(entries%local(e)) + b(e)*generalized(stage%coordinates(i))
      end do
    end do
  end subroutine find_rest

  !> Add the frames of a cluster to the sums A, U and Q - S^T p, and to what its base carries.
  pure subroutine add_frames(stage, entries, w, v, p, bodies, cluster)
    type(stage_type), intent(in) :: stage                       !< the cluster; nothing passes to frame 0
    type(frame_entries_type), intent(in) :: entries             !< of all frames
    real(wp), intent(in) :: w(3, *)                             !< (3,entries) angular velocity per unit rate, relative to the base, fixed axes [1, rad/m]
    real(wp), intent(in) :: v(3, *)                             !< (3,entries) velocity of the origin per unit rate, relative to the same frame, fixed axes [m/rad, 1]
    real(wp), intent(in) :: p(3, 0:*)                           !< origin of each frame [m]
    type(articulated_body_type), intent(inout) :: bodies(0:*)   !< each frame with all links beyond it outside the cluster
    type(cluster_work_type), intent(inout) :: cluster           !< A, U, Q - S^T p and the bound of A grow
    integer :: n

    n = size(stage%places)
    call add_each(entries%first, entries%local, bodies, cluster%factors, cluster%column, cluster%rest, cluster%rigid)

  contains

    !> The same from plain arrays.
    pure subroutine add_each(first, local, bodies, factors, column, rest, rigid)
      integer, intent(in) :: first(0:*)                           !< first entry of each frame
      integer, intent(in) :: local(*)                             !< (entries) place of the coordinate in the cluster
      type(articulated_body_type), intent(inout) :: bodies(0:*)   !< each frame with all links beyond it outside the cluster
      real(wp), intent(inout) :: factors(n, *)                    !< (n,n) A, lower triangle [kg m^2, kg m, kg]
      real(wp), intent(inout) :: column(6, *)                     !< (6,n) U, fixed axes [kg m^2, kg m, kg]
      real(wp), intent(inout) :: rest(*)                          !< (n) Q - S^T p [N m, N]
      real(wp), intent(inout) :: rigid(*)                         !< (n) bound of the diagonal of A, if all links beyond were rigid [kg m^2, kg]
      real(wp) :: torque(3), force(3), arm(3)
      integer :: base, i, f, e, d, j

      base = stage%base
      do i = 1, size(stage%frames)
        f = stage%frames(i)
        arm = p(:, f) - p(:, base)
        associate (body => bodies(f))
          do e = first(f), first(f + 1) - 1
            j = local(e)
            torque = turn(body%inertia(:, 1:3), w(:, e)) + turn(body%inertia(:, 4:6), v(:, e))
            force = turn_back(body%inertia(:, 4:6), w(:, e)) + turn(body%inertia(:, 7:9), v(:, e))
            rest(j) = rest(j) - dot_product(w(:, e), body%wrench(1:3)) - dot_product(v(:, e), body%wrench(4:6))
            rigid(j) = rigid(j) + rigid_inertia(body%amount, w(:, e), v(:, e))
            do d = e, first(f + 1) - 1
              factors(local(d), j) = factors(local(d), j) + dot_product(w(:, d), torque) + dot_product(v(:, d), force)
            end do
            if (base == 0) cycle
            column(1:3, j) = column(1:3, j) + torque + cross(arm, force)
            column(4:6, j) = column(4:6, j) + force
          end do
        end associate
        if (base > 0) call add_to_parent(arm, bodies(f), bodies(base))
      end do
    end subroutine add_each
  end subroutine add_frames

  !> Eliminate the accelerations of a cluster; what is left passes to its base. `found` is false where A is not positive definite
  !> beyond round-off.
  pure subroutine eliminate_cluster(m, stage, body, cluster, found)
    integer, intent(in) :: m                             !< number of steps of the plan
    type(stage_type), intent(in) :: stage                !< the cluster; nothing passes to frame 0
    type(articulated_body_type), intent(inout) :: body   !< the base with all links beyond it
    type(cluster_work_type), intent(inout) :: cluster    !< with its sums; gets L, Y, z
    logical, intent(out) :: found                        !< whether the coordinates have inertia

    call divide_columns(m, 6, stage%held, cluster, found)
    if (stage%base > 0 .and. found) call pass_to_base(size(stage%places), cluster%column, cluster%rest, body)
  end subroutine eliminate_cluster

  !> Take from the base of a cluster what the cluster's own motion gives way.
  pure subroutine pass_to_base(n, column, rest, body)
    integer, intent(in) :: n                             !< number of independent coordinates of the cluster
    real(wp), intent(in) :: column(6, n)                 !< (dimensions,n) Y, by which accelerations of the base act [1, rad/m, m/rad]
    real(wp), intent(in) :: rest(n)                      !< (n) z, accelerations where the base has none [rad/s^2, m/s^2]
    type(articulated_body_type), intent(inout) :: body   !< the base with all links beyond it
    integer :: i, j

    do j = 1, n
      do i = 1, 3
        body%inertia(:, i) = body%inertia(:, i) - column(1:3, j)*column(i, j)
        body%inertia(:, 3 + i) = body%inertia(:, 3 + i) - column(1:3, j)*column(3 + i, j)
        body%inertia(:, 6 + i) = body%inertia(:, 6 + i) - column(4:6, j)*column(3 + i, j)
      end do
      body%wrench = body%wrench + column(:, j)*rest(j)
    end do
  end subroutine pass_to_base

  !> Leave the accelerations of driven coordinates as they are given, so that nothing of them is eliminated. Factorize A = L L^T,
  !> and divide by L: Y = U L^-T, z = L^-1 (Q - S^T p). `found` is false where A is not positive definite beyond round-off, which
  !> is that of the inertia as if rigid.
  pure subroutine divide_columns(m, dimensions, held, cluster, found)
    integer, intent(in) :: m                            !< number of steps of the plan
    integer, intent(in) :: dimensions                   !< of a motion: 6 in space, 3 in a plane
    integer, intent(in), contiguous :: held(:)          !< numbers of the cluster's driven coordinates
    type(cluster_work_type), intent(inout) :: cluster   !< with its sums; gets L, Y, z and least pivots that count
    logical, intent(out) :: found                       !< whether A is positive definite
    integer :: n

    n = size(cluster%rest)
    call divide(cluster%factors, cluster%column, cluster%rest, cluster%rigid, found)

  contains

    !> The same from plain arrays.
    pure subroutine divide(factors, column, rest, rigid, found)
      real(wp), intent(inout) :: factors(n, n)             !< (n,n) A in [kg m^2, kg m, kg], its Cholesky factor L out, lower triangle
      real(wp), intent(inout) :: column(dimensions, n)     !< (dimensions,n) U in [kg m^2, kg m, kg], Y out
      real(wp), intent(inout) :: rest(n)                   !< (n) Q - S^T p in [N m, N], z out
      real(wp), intent(inout) :: rigid(n)                  !< (n) bound of A_jj as if rigid in, least pivots that count out [kg m^2, kg]
      logical, intent(out) :: found                        !< whether A is positive definite
      integer :: failed_at, j, k

      if (size(held) > 0) then
        call hold(n, held, factors, rest)
        column(:, held) = 0.0_wp
        rigid(held) = 0.0_wp
      end if
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
    end subroutine divide
  end subroutine divide_columns

  !> The accelerations of a cluster's independent coordinates for a motion of its base, ddq = L^-T (z - Y^T (motion of the base)).
  pure subroutine find_accelerations(places, motion, cluster, accelerations)
    integer, intent(in), contiguous :: places(:)        !< (n) places of the coordinates among all independent ones
    real(wp), intent(in), contiguous :: motion(:)       !< (6, in a plane 3) accelerations of the base less those by rates alone
    type(cluster_work_type), intent(inout) :: cluster   !< with L, Y, z; gets `ddq`
    real(wp), intent(inout) :: accelerations(*)         !< (independent) accelerations of all independent coordinates; gets those of the cluster [rad/s^2, m/s^2]
    integer :: n, dimensions

    n = size(places)
    dimensions = size(motion)
    call divide(cluster%factors, cluster%column, cluster%rest, cluster%ddq, accelerations)

  contains

    !> The same from plain arrays.
    pure subroutine divide(factors, column, rest, ddq, accelerations)
      real(wp), intent(in) :: factors(n, n)             !< (n,n) Cholesky factor L of A, lower triangle
      real(wp), intent(in) :: column(dimensions, n)     !< (dimensions,n) Y, by which accelerations of the base act [1, rad/m, m/rad]
      real(wp), intent(in) :: rest(n)                   !< (n) z, accelerations where the base has none [rad/s^2, m/s^2]
      real(wp), intent(out) :: ddq(n)                   !< accelerations [rad/s^2, m/s^2]
      real(wp), intent(inout) :: accelerations(*)       !< (independent) accelerations of all independent coordinates [rad/s^2, m/s^2]
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
    end subroutine divide
  end subroutine find_accelerations

  !> Move the frames of a cluster on which others stand by the accelerations of its base and of its coordinates.
  pure subroutine move_cluster(stage, entries, w, v, p, ddq, motion)
    type(stage_type), intent(in) :: stage             !< the cluster
    type(frame_entries_type), intent(in) :: entries   !< of all frames
    real(wp), intent(in) :: w(3, *)                   !< (3,entries) angular velocity per unit rate, relative to the base, fixed axes [1, rad/m]
    real(wp), intent(in) :: v(3, *)                   !< (3,entries) velocity of the origin per unit rate, relative to the same frame, fixed axes [m/rad, 1]
    real(wp), intent(in) :: p(3, 0:*)                 !< origin of each frame [m]
    real(wp), intent(in) :: ddq(*)                    !< accelerations of the cluster's independent coordinates [rad/s^2, m/s^2]
    real(wp), intent(inout) :: motion(6, 0:*)   !< (6,0:M) accelerations less those that rates alone give, fixed axes; gets those of these frames [rad/s^2, m/s^2]
    real(wp) :: dw(3), dv(3)
    integer :: i, f, e

    do i = 1, size(stage%feet)
      f = stage%feet(i)
      dw = motion(1:3, stage%base)
      dv = motion(4:6, stage%base) + cross(dw, p(:, f) - p(:, stage%base))
      do e = entries%first(f), entries%first(f + 1) - 1
        dw = dw + ddq(entries%local(e))*w(:, e)
        dv = dv + ddq(entries%local(e))*v(:, e)
      end do
      motion(1:3, f) = dw
      motion(4:6, f) = dv
    end do
  end subroutine move_cluster
end module mech9_cluster_bodies
