!> The equations of equilibrium of a planar cluster on which nothing acts across its plane: the forces in the plane and the moments
!> across it, with three numbers for each pair in place of six.
!>
!> The equations are those of mech9_cluster_balance. They part into those in the plane and the others where all points of the pairs
!> lie in one plane; if nothing is required across it, the other components of least norm are zero.
module mech9_planar_balance
  use mech9_kinds, only: wp
  use mech9_block_cholesky, only: block_cholesky_type, new_block_cholesky
  use mech9_reaction_plan, only: joined_cluster_type
  implicit none
  private
  public :: planar_balance_type, new_planar_balance

  !> The equations of one cluster in one position, in the axes of the plane.
  type :: planar_balance_type
    type(block_cholesky_type) :: factors           !< of M^T M
    integer, allocatable :: block_of(:)            !< (pairs) block that joins both links; 0 where one is not a node
    logical, allocatable :: turned(:)              !< (pairs) the block's rows are those of the reference link
    real(wp), allocatable :: axis(:, :)            !< (3,pairs) motion along x and y, and turning, of length 1
    real(wp), allocatable :: arm(:, :, :)          !< (2,2,pairs) from the places of moving and reference link, over the size
    real(wp), allocatable :: wrenches(:, :)        !< (3,pairs) force along x and y, moment over the size
    real(wp), allocatable :: required(:, :)        !< (3,nodes) what the links require
    real(wp), allocatable, private :: lacking(:, :)   !< (3,nodes) scratch
  contains
    procedure :: factorize
    procedure :: solve
  end type planar_balance_type

contains

  !> Room for the equations of a cluster.
  pure function new_planar_balance(cluster) result(self)
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    type(planar_balance_type) :: self
    integer :: n, m

    m = size(cluster%pairs)
    n = size(cluster%links)
    self%factors = new_block_cholesky(3, n, cluster%nodes)
    call self%factors%find_blocks(cluster%nodes, self%block_of, self%turned)
    allocate (self%axis(3, m), self%arm(2, 2, m), self%wrenches(3, m), self%required(3, n), self%lacking(3, n), source=0.0_wp)
  end function new_planar_balance

  !> Form M^T M from the axes and arms of the pairs, and factorize it.
  pure subroutine factorize(self, cluster, held)
    class(planar_balance_type), intent(inout) :: self   !< with axes and arms; gets the factors
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    logical, intent(in) :: held(:)                      !< (pairs) only the part across the axis is unknown
    real(wp) :: on(3, 2)
    integer :: i, side

    call self%factors%clear()
    do i = 1, size(cluster%pairs)
      if (cluster%nodes(1, i) == cluster%nodes(2, i)) cycle
      on = 0.0_wp
      if (held(i)) then
        do side = 1, 2
          on(1:2, side) = self%axis(1:2, i)
          on(3, side) = self%axis(3, i) + turning(self%arm(:, side, i), self%axis(1:2, i))
        end do
      end if
      do side = 1, 2
        if (cluster%nodes(side, i) == 0) cycle
        associate (at => self%factors%position(cluster%nodes(side, i)))
          call add_block(1.0_wp, self%arm(:, side, i), self%arm(:, side, i), on(:, side), on(:, side), &
                         self%factors%diagonal(:, :, at))
        end associate
      end do
      if (self%block_of(i) == 0) cycle
      side = merge(2, 1, self%turned(i))
      call add_block(-1.0_wp, self%arm(:, side, i), self%arm(:, 3 - side, i), on(:, side), on(:, 3 - side), &
                     self%factors%blocks(:, :, self%block_of(i)))
    end do
    call self%factors%factorize()
  end subroutine factorize

  !> Moment of a force about the end of its arm.
  pure real(wp) function turning(arm, force)
    real(wp), intent(in) :: arm(2)     !< over the size
    real(wp), intent(in) :: force(2)   !< along x and y

    turning = arm(1)*force(2) - arm(2)*force(1)
  end function turning

  !> Add T_a^T (1 - n n^T) T_b, see mech9_cluster_balance.
  pure subroutine add_block(sign, a, b, on_a, on_b, block)
    real(wp), intent(in) :: sign            !< factor
    real(wp), intent(in) :: a(2)            !< arm of the link in whose rows the block is
    real(wp), intent(in) :: b(2)            !< arm of the link in whose columns it is
    real(wp), intent(in) :: on_a(3)         !< T_a^T n; zero where nothing is held
    real(wp), intent(in) :: on_b(3)         !< T_b^T n; zero where nothing is held
    real(wp), intent(inout) :: block(3, 3)  !< the block
    integer :: i, j

    do j = 1, 3
      do i = 1, 3
        block(i, j) = block(i, j) - sign*on_a(i)*on_b(j)
      end do
      block(j, j) = block(j, j) + sign
    end do
    block(1, 3) = block(1, 3) - sign*b(2)
    block(2, 3) = block(2, 3) + sign*b(1)
    block(3, 1) = block(3, 1) - sign*a(2)
    block(3, 2) = block(3, 2) + sign*a(1)
    block(3, 3) = block(3, 3) + sign*(a(1)*b(1) + a(2)*b(2))
  end subroutine add_block

  !> Complete the wrenches, which do the work of the loads on dependent coordinates at first. `error` is what the links lack
  !> at the end, as a part of the largest number.
  pure subroutine solve(self, cluster, held, error)
    class(planar_balance_type), intent(inout) :: self   !< with the factors, what is required, and wrenches; gets the wrenches
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    logical, intent(in) :: held(:)                      !< (pairs) only the part across the axis is unknown
    real(wp), intent(out) :: error                      !< part of the largest number
    integer, parameter :: most_corrections = 12
    real(wp) :: before, largest
    integer :: i

    before = huge(before)
    do i = 0, most_corrections
      call find_lacking(self, cluster)
      largest = max(maxval(abs(self%wrenches)), maxval(abs(self%required)), tiny(largest))
      error = maxval(abs(self%lacking))/largest
      if (error <= 32.0_wp*epsilon(error) .or. (i > 1 .and. .not. error < 0.5_wp*before)) return
      before = error
      call self%factors%solve(self%lacking)
      call spread_motion(self, cluster, held)
    end do
  end subroutine solve

  !> The wrenches that the links require beside those that they receive.
  pure subroutine find_lacking(self, cluster)
    class(planar_balance_type), intent(inout) :: self   !< with wrenches; gets what is lacking
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    integer :: i, side, node

    self%lacking = self%required
    do i = 1, size(cluster%pairs)
      do side = 1, 2
        node = cluster%nodes(side, i)
        if (node == 0) cycle
        associate (w => self%wrenches(:, i), sign => 2*side - 3)
          self%lacking(1:2, node) = self%lacking(1:2, node) + sign*w(1:2)
          self%lacking(3, node) = self%lacking(3, node) + sign*(w(3) + turning(self%arm(:, side, i), w(1:2)))
        end associate
      end do
    end do
  end subroutine find_lacking

  !> Add M y to the wrenches, for the displacements y of the links in `lacking`.
  pure subroutine spread_motion(self, cluster, held)
    class(planar_balance_type), intent(inout) :: self   !< with displacements; gets the wrenches
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    logical, intent(in) :: held(:)                      !< (pairs) only the part across the axis is unknown
    real(wp) :: motion(3)
    integer :: i, side

    do i = 1, size(cluster%pairs)
      motion = 0.0_wp
      do side = 1, 2
        if (cluster%nodes(side, i) == 0) cycle
        associate (y => self%lacking(:, cluster%nodes(side, i)), arm => self%arm(:, side, i), sign => 3 - 2*side)
          motion(1) = motion(1) + sign*(y(1) - y(3)*arm(2))
          motion(2) = motion(2) + sign*(y(2) + y(3)*arm(1))
          motion(3) = motion(3) + sign*y(3)
        end associate
      end do
      if (held(i)) motion = motion - (self%axis(1, i)*motion(1) + self%axis(2, i)*motion(2) + self%axis(3, i)*motion(3)) &
                                     *self%axis(:, i)
      self%wrenches(:, i) = self%wrenches(:, i) + motion
    end do
  end subroutine spread_motion
end module mech9_planar_balance
