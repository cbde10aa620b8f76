!> The equations of equilibrium of a cluster of closed chains, and their solution of least norm.
!>
!> The unknowns are the wrenches of all pairs, scaled: force, moment over the mechanism's size. Those of dependent coordinates do
!> the work of the loads on these coordinates, so that only their part across the axis is unknown. Each link must be in
!> balance: A r = b. With M = A^T restricted to what is unknown, the wrenches of least norm are r = M y, (M^T M) y = b: y are
!> the displacements that the links of an elastic mechanism would take whose pairs are all equally stiff. M^T M has one block
!> for each link and each pair, and is factorized by Cholesky's method; a correction from the balance of the links removes
!> the error that squaring M makes.
!>
!> Links of a cluster with couplings can move where the coordinates do not satisfy these; the forces of couplings are known and count
!> as loads, so that M^T M is singular while a solution exists. It becomes regular where M^T M holds one dependent coordinate for each
!> such motion, as it holds independent ones: nothing is required along these motions, so that y does not move the held coordinates and
!> M y stays what it is (mech9_singular_cluster chooses them).
!>
!> All pairs of a joint with several freedoms pass on the same wrench, since the links between them have neither mass nor loads. Their
!> wrenches are taken about one point, that of the last pair, and the square of each is divided by the number of the joint's pairs:
!> the joint counts once. All turns of such a joint are about lines through this point, so that the moments about them stay the same.
module mech9_cluster_balance
  use mech9_kinds, only: wp
  use mech9_reaction_tolerances, only: balanced
  use mech9_rotation, only: cross
  use mech9_block_cholesky, only: block_cholesky_type, new_block_cholesky, clearly_positive
  use mech9_reaction_plan, only: reaction_plan_type, joined_cluster_type
  use mech9_joint_geometry, only: joint_geometry_type
  implicit none
  private
  public :: cluster_balance_type, new_cluster_balance

  !> The equations of one cluster in one position. Nodes are its links but the one on which it stands.
  type :: cluster_balance_type
    type(block_cholesky_type) :: factors          !< of M^T M
    integer, allocatable :: nodes(:, :)           !< (2,pairs) nodes of moving and reference link of each pair; 0: none
    integer :: n_nodes = 0                        !< how many nodes there are
    integer, allocatable :: block_of(:)           !< (pairs) block that joins both links; 0 where one is not a node
    logical, allocatable :: turned(:)             !< (pairs) the block's rows are those of the reference link
    logical, allocatable :: held(:)               !< (pairs) only the part across the axis is unknown
    logical, allocatable :: stands(:)             !< (pairs) M^T M holds the dependent coordinate, since a coupling does
    real(wp), allocatable :: parts(:)             !< (pairs) number of pairs that count as one together
    real(wp), allocatable :: axis(:, :)           !< (6,pairs) of length 1
    real(wp), allocatable :: arm(:, :, :)         !< (3,2,pairs) from the places of moving and reference link, over the size
  contains
    procedure :: set_position
    procedure :: spread
    procedure :: find_motion
    procedure :: find_lacking
    procedure :: complete
    procedure :: remove_determined
  end type cluster_balance_type

contains

  !> Room for the equations of a cluster.
  pure function new_cluster_balance(reactions, cluster) result(self)
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    type(cluster_balance_type) :: self
    integer :: n

    n = size(cluster%pairs)
    self%nodes = cluster%nodes
    self%n_nodes = size(cluster%links)
    self%factors = new_block_cholesky(6, size(cluster%links), cluster%nodes)
    call self%factors%find_blocks(cluster%nodes, self%block_of, self%turned)
    self%held = reactions%pairs(cluster%pairs)%dependent
    allocate (self%stands(n), source=.false.)
    self%parts = real(reactions%pairs(cluster%pairs)%in_joint, wp)
    allocate (self%axis(6, n), self%arm(3, 2, n), source=0.0_wp)
  end function new_cluster_balance

  !> The equations of a position, factorized. `regular` is false where M^T M is singular but for round-off.
  pure subroutine set_position(self, cluster, geometry, reactions, length, regular)
    class(cluster_balance_type), intent(inout) :: self   !< gets the factors
    type(joined_cluster_type), intent(in) :: cluster     !< the cluster
    type(joint_geometry_type), intent(in) :: geometry    !< of the position
    type(reaction_plan_type), intent(in) :: reactions    !< the plan of inverse dynamics
    real(wp), intent(in) :: length                       !< the mechanism's size [m]
    logical, intent(out) :: regular                      !< the factors can be used
    integer :: i, k, side

    call self%factors%clear()
    do i = 1, size(cluster%pairs)
      k = cluster%pairs(i)
      self%axis(:, i) = geometry%axis(:, k)
      do side = 1, 2
        self%arm(:, side, i) = (geometry%point(:, reactions%pairs(k)%last) &
                                - geometry%place(:, reactions%pairs(k)%links(side)))/length
      end do
      call add_pair(self, cluster%nodes(:, i), i)
    end do
    call self%factors%factorize()
    regular = self%factors%least_part > clearly_positive
  end subroutine set_position

  !> Add the blocks of a pair to M^T M.
  pure subroutine add_pair(self, nodes, i)
    type(cluster_balance_type), intent(inout) :: self   !< the equations
    integer, intent(in) :: nodes(2)                     !< of moving and reference link
    integer, intent(in) :: i                            !< place of the pair in the cluster
    real(wp) :: work_on(6, 2)
    integer :: side

    do side = 1, 2
      work_on(1:3, side) = self%axis(1:3, i)
      work_on(4:6, side) = self%axis(4:6, i) + cross(self%arm(:, side, i), self%axis(1:3, i))
    end do
    if (self%stands(i) .or. .not. self%held(i)) work_on = 0.0_wp
    if (nodes(1) == nodes(2)) return
    do side = 1, 2
      if (nodes(side) == 0) cycle
      associate (at => self%factors%position(nodes(side)))
        call add_block(self%parts(i), self%arm(:, side, i), self%arm(:, side, i), work_on(:, side), work_on(:, side), &
                       self%factors%diagonal(:, :, at))
      end associate
    end do
    if (self%block_of(i) == 0) return
    side = merge(2, 1, self%turned(i))
    call add_block(-self%parts(i), self%arm(:, side, i), self%arm(:, 3 - side, i), work_on(:, side), work_on(:, 3 - side), &
                   self%factors%blocks(:, :, self%block_of(i)))
  end subroutine add_pair

  !> Add T_a^T (1 - n n^T) T_b, where T carries a motion from the place of a link to the point of the pair, n is its axis, and
  !> T^T n are given.
  pure subroutine add_block(sign, a, b, on_a, on_b, block)
    real(wp), intent(in) :: sign            !< factor
    real(wp), intent(in) :: a(3)            !< arm of the link in whose rows the block is
    real(wp), intent(in) :: b(3)            !< arm of the link in whose columns it is
    real(wp), intent(in) :: on_a(6)         !< T_a^T n; zero where nothing is held
    real(wp), intent(in) :: on_b(6)         !< T_b^T n; zero where nothing is held
    real(wp), intent(inout) :: block(6, 6)  !< the block
    real(wp) :: both
    integer :: i, j

    do j = 1, 6
      do i = 1, 6
        block(i, j) = block(i, j) - sign*on_a(i)*on_b(j)
      end do
    end do
    both = 1.0_wp + a(1)*b(1) + a(2)*b(2) + a(3)*b(3)
    do j = 1, 3
      block(j, j) = block(j, j) + sign
      block(3 + j, 3 + j) = block(3 + j, 3 + j) + sign*both
      do i = 1, 3
        block(3 + i, 3 + j) = block(3 + i, 3 + j) - sign*b(i)*a(j)
      end do
    end do
    block(1, 5) = block(1, 5) + sign*b(3)
    block(1, 6) = block(1, 6) - sign*b(2)
    block(2, 4) = block(2, 4) - sign*b(3)
    block(2, 6) = block(2, 6) + sign*b(1)
    block(3, 4) = block(3, 4) + sign*b(2)
    block(3, 5) = block(3, 5) - sign*b(1)
    block(4, 2) = block(4, 2) - sign*a(3)
    block(4, 3) = block(4, 3) + sign*a(2)
    block(5, 1) = block(5, 1) + sign*a(3)
    block(5, 3) = block(5, 3) - sign*a(1)
    block(6, 1) = block(6, 1) - sign*a(2)
    block(6, 2) = block(6, 2) + sign*a(1)
  end subroutine add_block

  !> Add M y to the wrenches, for displacements y of the links.
  pure subroutine spread(self, y, wrenches)
    class(cluster_balance_type), intent(in) :: self       !< the equations of a position
    real(wp), intent(in) :: y(:, :)                       !< (6,nodes) displacements, scaled
    real(wp), intent(inout), contiguous :: wrenches(:, :) !< (6,pairs) scaled
    real(wp) :: motion(6)
    integer :: i

    do i = 1, size(self%nodes, 2)
      motion = self%find_motion(i, y)
      if (self%held(i)) motion = motion - dot_product(self%axis(:, i), motion)*self%axis(:, i)
      wrenches(:, i) = wrenches(:, i) + self%parts(i)*motion
    end do
  end subroutine spread

  !> The motion of the moving link of a pair in its reference link at the point of the pair, for displacements y of the links.
  pure function find_motion(self, i, y) result(motion)
    class(cluster_balance_type), intent(in) :: self       !< the equations of a position
    integer, intent(in) :: i                              !< place of the pair in the cluster
    real(wp), intent(in) :: y(:, :)                       !< (6,nodes) displacements, scaled
    real(wp) :: motion(6)
    integer :: side

    motion = 0.0_wp
    do side = 1, 2
      if (self%nodes(side, i) == 0) cycle
      associate (d => y(:, self%nodes(side, i)), sign => 3 - 2*side)
        motion(1:3) = motion(1:3) + sign*(d(1:3) + cross(d(4:6), self%arm(:, side, i)))
        motion(4:6) = motion(4:6) + sign*d(4:6)
      end associate
    end do
  end function find_motion

  !> Complete the wrenches in a regular position. `converged` is false where corrections do not lead to balance.
  pure subroutine complete(self, required, wrenches, lacking, converged, displacements, size_of_all)
    class(cluster_balance_type), intent(inout) :: self       !< the equations, factorized
    real(wp), intent(in), contiguous :: required(:, :)       !< (6,nodes) scaled
    real(wp), intent(inout), contiguous :: wrenches(:, :)    !< (6,pairs) scaled: those that are given; complete
    real(wp), intent(inout), contiguous :: lacking(:, :)     !< (6,nodes) scratch
    logical, intent(out) :: converged                        !< the links are in balance
    real(wp), intent(out), optional :: displacements(:, :)   !< (6,nodes) y of all corrections together, scaled
    real(wp), intent(in), optional :: size_of_all            !< by which balance is judged where wrenches are smaller; 0 unless given
    integer, parameter :: most_corrections = 12
    real(wp) :: error, before, largest
    integer :: i

    before = huge(before)
    if (present(displacements)) displacements = 0.0_wp
    do i = 0, most_corrections
      call self%find_lacking(required, wrenches, lacking)
      error = maxval(abs(lacking))
      largest = max(maxval(abs(wrenches)), maxval(abs(required)))
      converged = error <= 32.0_wp*epsilon(error)*largest
      ! the balance does not improve any more when it is round-off
      if (converged .or. (i > 1 .and. .not. error < 0.5_wp*before)) exit
      before = error
      call self%factors%solve(lacking)
      call self%spread(lacking, wrenches)
      if (present(displacements)) displacements = displacements + lacking
    end do
    if (present(size_of_all)) largest = max(largest, size_of_all)
    converged = error <= balanced*largest
  end subroutine complete

  !> Remove from wrenches in a regular position the part that the balance of the links determines. `removed` is false where removals
  !> do not end in round-off: components of the rest that are zero could count as others.
  pure subroutine remove_determined(self, wrenches, removed)
    class(cluster_balance_type), intent(inout) :: self       !< the equations, factorized
    real(wp), intent(inout), contiguous :: wrenches(:, :)    !< (6,pairs) scaled
    logical, intent(out), optional :: removed                !< the rest balances nothing but for round-off
    !> Each removal leaves a part of the round-off of the one before it.
    integer, parameter :: most_removals = 12
    real(wp) :: lacking(6, self%n_nodes), nothing(6, self%n_nodes), before(6, size(self%nodes, 2)), largest
    logical :: is_round_off
    integer :: i

    nothing = 0.0_wp
    largest = maxval(abs(wrenches))
    do i = 1, most_removals
      before = wrenches
      call self%find_lacking(nothing, wrenches, lacking)
      call self%factors%solve(lacking)
      call self%spread(lacking, wrenches)
      is_round_off = maxval(abs(wrenches - before)) <= balanced*largest
      if (is_round_off) exit
    end do
    if (present(removed)) removed = is_round_off
  end subroutine remove_determined

  !> The wrench about its place that each link requires beside those that it receives from its pairs.
  pure subroutine find_lacking(self, required, wrenches, lacking)
    class(cluster_balance_type), intent(in) :: self       !< the equations of a position
    real(wp), intent(in), contiguous :: required(:, :)    !< (6,nodes) scaled
    real(wp), intent(in), contiguous :: wrenches(:, :)    !< (6,pairs) scaled
    real(wp), intent(out), contiguous :: lacking(:, :)    !< (6,nodes) scaled
    integer :: i, side

    lacking = required
    do i = 1, size(self%nodes, 2)
      do side = 1, 2
        if (self%nodes(side, i) == 0) cycle
        associate (sum => lacking(:, self%nodes(side, i)), sign => 2*side - 3)
          sum(1:3) = sum(1:3) + sign*wrenches(1:3, i)
          sum(4:6) = sum(4:6) + sign*(wrenches(4:6, i) + cross(self%arm(:, side, i), wrenches(1:3, i)))
        end associate
      end do
    end do
  end subroutine find_lacking
end module mech9_cluster_balance
