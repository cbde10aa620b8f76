!> The wrenches of a cluster in or beside a singular position, from the singular values of its equations of equilibrium.
!>
!> In a singular position the links can move while all independent coordinates stand still. The pairs cannot balance what
!> the links require along such a motion, unless that is zero.
module mech9_singular_cluster
  use mech9_kinds, only: wp
  use mech9_lapack, only: dgesvd
  use mech9_tolerances, only: least_rate
  use mech9_reaction_tolerances, only: balanced_singular
  use mech9_reaction_plan, only: joined_cluster_type
  use mech9_cluster_balance, only: cluster_balance_type
  implicit none
  private
  public :: singular_cluster_type, decompose_cluster

  !> Singular values and vectors of A, the equations of equilibrium.
  type :: singular_cluster_type
    integer :: rank = 0                      !< singular values that count
    real(wp), allocatable :: values(:)       !< (6 nodes) not increasing
    real(wp), allocatable :: forces(:, :)    !< (6 nodes,6 nodes) left vectors, by columns
    real(wp), allocatable :: wrenches(:, :)  !< (6 nodes,6 pairs) right vectors, by rows
    real(wp), allocatable :: root(:)         !< (pairs) by which wrenches are divided for the norm to count joints once
  contains
    procedure :: solve
    procedure :: complete
    procedure :: remove_determined
    procedure :: hold_motions
  end type singular_cluster_type

contains

  !> Decompose the equations of a cluster. Singular values below a part of the largest count as zero.
  subroutine decompose_cluster(cluster, balance, tolerance, singular)
    type(joined_cluster_type), intent(in) :: cluster        !< the cluster
    type(cluster_balance_type), intent(in) :: balance       !< its equations in a position
    real(wp), intent(in) :: tolerance                       !< part of the largest singular value
    type(singular_cluster_type), intent(out) :: singular    !< its singular values and vectors
    real(wp), allocatable :: a(:, :), work(:), one(:, :), motion(:, :)
    integer :: n, m, i, j, info

    n = 6*size(cluster%links)
    m = 6*size(cluster%pairs)
    allocate (a(n, m), one(6, size(cluster%links)), motion(6, size(cluster%pairs)), work(5*(n + m)))
    do j = 1, n
      one = 0.0_wp
      one(1 + mod(j - 1, 6), 1 + (j - 1)/6) = 1.0_wp
      motion = 0.0_wp
      call balance%spread(one, motion)
      ! of the unknowns that are divided by the roots of the parts in which they count
      do i = 1, size(cluster%pairs)
        motion(:, i) = motion(:, i)/sqrt(balance%parts(i))
      end do
      a(j, :) = reshape(motion, [m])
    end do
    singular%root = sqrt(balance%parts)
    allocate (singular%values(n), singular%forces(n, n), singular%wrenches(n, m))
    call dgesvd('S', 'S', n, m, a, n, singular%values, singular%forces, n, singular%wrenches, n, work, size(work), info)
    singular%rank = count(singular%values > tolerance*singular%values(1))
    if (info /= 0) singular%rank = 0
  end subroutine decompose_cluster

  !> The wrenches of least norm that balance the links, as far as they can.
  pure subroutine solve(self, required, wrenches)
    class(singular_cluster_type), intent(in) :: self        !< singular values and vectors
    real(wp), intent(in) :: required(:, :)                  !< (6,nodes) scaled
    real(wp), intent(out), contiguous :: wrenches(:, :)     !< (6,pairs) scaled
    real(wp) :: parts(self%rank)
    integer :: i

    do i = 1, self%rank
      parts(i) = dot_product(self%forces(:, i), reshape(required, [size(required)]))/self%values(i)
    end do
    wrenches = reshape(matmul(parts, self%wrenches(:self%rank, :)), shape(wrenches))
    do i = 1, size(wrenches, 2)
      wrenches(:, i) = self%root(i)*wrenches(:, i)
    end do
  end subroutine solve

  !> Complete the wrenches as far as they can balance the links. `converged` is false where something is left.
  subroutine complete(self, balance, required, wrenches, converged, displacements, size_of_all)
    class(singular_cluster_type), intent(in) :: self         !< singular values and vectors
    type(cluster_balance_type), intent(in) :: balance        !< the equations of the position
    real(wp), intent(in), contiguous :: required(:, :)       !< (6,nodes) scaled
    real(wp), intent(inout), contiguous :: wrenches(:, :)    !< (6,pairs) scaled: those that are given; complete
    logical, intent(out) :: converged                        !< the links are in balance
    real(wp), intent(out), optional :: displacements(:, :)   !< (6,nodes) of least norm that belong to the wrenches, scaled
    real(wp), intent(in), optional :: size_of_all            !< by which balance is judged where wrenches are smaller; 0 unless given
    real(wp) :: lacking(size(required, 1), size(required, 2)), changes(size(wrenches, 1), size(wrenches, 2))
    real(wp) :: parts(self%rank), largest
    integer :: i, round

    if (present(displacements)) displacements = 0.0_wp
    ! the second round removes the round-off of the first
    do round = 1, 2
      call balance%find_lacking(required, wrenches, lacking)
      call self%solve(lacking, changes)
      wrenches = wrenches + changes
      if (.not. present(displacements)) cycle
      do i = 1, self%rank
        parts(i) = dot_product(self%forces(:, i), reshape(lacking, [size(lacking)]))/self%values(i)**2
      end do
      displacements = displacements + reshape(matmul(self%forces(:, :self%rank), parts), shape(displacements))
    end do
    call balance%find_lacking(required, wrenches, lacking)
    largest = max(maxval(abs(wrenches)), maxval(abs(required)))
    if (present(size_of_all)) largest = max(largest, size_of_all)
    converged = maxval(abs(lacking)) <= balanced_singular*largest
  end subroutine complete

  !> Remove from wrenches the part that the balance of the links determines.
  pure subroutine remove_determined(self, wrenches)
    class(singular_cluster_type), intent(in) :: self        !< singular values and vectors
    real(wp), intent(inout), contiguous :: wrenches(:, :)   !< (6,pairs) scaled
    real(wp) :: parts(self%rank)
    integer :: i

    do i = 1, size(wrenches, 2)
      wrenches(:, i) = wrenches(:, i)/self%root(i)
    end do
    parts = matmul(self%wrenches(:self%rank, :), reshape(wrenches, [size(wrenches)]))
    wrenches = wrenches - reshape(matmul(parts, self%wrenches(:self%rank, :)), shape(wrenches))
    do i = 1, size(wrenches, 2)
      wrenches(:, i) = self%root(i)*wrenches(:, i)
    end do
  end subroutine remove_determined

  !> Let the equations hold one dependent coordinate for each motion that links can make while all independent coordinates stand
  !> still: those that move most, by elimination with pivots. A cluster with couplings has such motions in every position, and the same
  !> coordinates serve in others; where they do not, corrections do not lead to balance.
  subroutine hold_motions(self, cluster, balance)
    class(singular_cluster_type), intent(in) :: self        !< singular values and vectors of a position
    type(joined_cluster_type), intent(in) :: cluster        !< the cluster
    type(cluster_balance_type), intent(inout) :: balance    !< its equations; those of other positions hold the coordinates
    real(wp) :: along(size(cluster%pairs), size(self%values) - self%rank), direction(size(along, 2))
    integer :: i, j, n

    balance%stands = .false.
    if (.not. cluster%coupled) return
    along = 0.0_wp
    n = size(cluster%links)
    do j = 1, size(along, 2)
      do i = 1, size(cluster%pairs)
        if (balance%held(i)) along(i, j) = &
          dot_product(balance%axis(:, i), balance%find_motion(i, reshape(self%forces(:, self%rank + j), [6, n])))
      end do
    end do
    do j = 1, size(along, 2)
      i = maxloc(sum(along**2, dim=2), dim=1)
      if (.not. norm2(along(i, :)) > least_rate) return
      balance%stands(i) = .true.
      direction = along(i, :)/norm2(along(i, :))
      along = along - spread(matmul(along, direction), 2, size(along, 2))*spread(direction, 1, size(along, 1))
    end do
  end subroutine hold_motions
end module mech9_singular_cluster
