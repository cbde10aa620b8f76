!> The wrenches of a cluster of closed chains that equilibrium alone determines, at a cost in proportion to its pairs.
!>
!> Each chain is cut at its closing frame. The links then stand on each other like those of open chains, and the wrench that the frame
!> requires from its link is unknown: it must be such that each dependent coordinate requires the loads on it and no more. By
!> virtual work these are the transposed equations of the motion, J_d^T y = -(what the dependent coordinates lack), with J_d of
!> the blocks from the last one to the first. What the coordinates lack afterwards is round-off; if it is more, the same
!> equations correct it.
module mech9_loop_balance
  use mech9_kinds, only: wp
  use mech9_reaction_tolerances, only: balanced, regular_balance
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_block_equations, only: constraint_wrench
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_force_sum, only: force_sum_type
  use mech9_reaction_plan, only: reaction_plan_type, joined_cluster_type
  use mech9_joint_geometry, only: joint_geometry_type
  use mech9_required_wrenches, only: required_wrenches_type
  implicit none
  private
  public :: loop_balance_type, new_loop_balance, balance_loops, show_loops

  !> Equations and wrenches of all clusters that equilibrium determines. Wrenches are those that the frame of a step requires from
  !> the frame before, about its origin.
  type :: loop_balance_type
    type(block_work_type), allocatable, private :: blocks(:)   !< (blocks of the plan) with the factors of their Jacobians
    real(wp), allocatable, private :: force(:, :)    !< (3,M) by steps [N]
    real(wp), allocatable, private :: moment(:, :)   !< (3,M) by steps [N m]
  end type loop_balance_type

contains

  !> Room for the equations of a mechanism in space.
  pure function new_loop_balance(plan, reactions) result(self)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< its plan of inverse dynamics
    type(loop_balance_type) :: self
    integer :: i, c

    allocate (self%blocks(size(plan%blocks)))
    allocate (self%force(3, plan%n_coordinates), self%moment(3, plan%n_coordinates), source=0.0_wp)
    if (plan%planar%used) return
    do c = 1, size(reactions%clusters)
      if (.not. reactions%clusters(c)%determined) cycle
      do i = 1, size(reactions%clusters(c)%blocks)
        associate (b => reactions%clusters(c)%blocks(i))
          self%blocks(b) = new_block_work(plan%blocks(b), plan)
        end associate
      end do
    end do
  end function new_loop_balance

  !> Find the wrenches of a cluster. `done` is false where corrections do not lead to balance, as beside singular positions.
  subroutine balance_loops(plan, reactions, cluster, state, links, self, done)
    type(plan_type), intent(in) :: plan                        !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions          !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster           !< the cluster
    type(state_type), intent(in) :: state                      !< the position
    type(required_wrenches_type), intent(in) :: links          !< requirements of the links, and loads on coordinates
    type(loop_balance_type), intent(inout) :: self             !< equations and scratch; gets the wrenches
    logical, intent(out) :: done                               !< the wrenches are found
    integer, parameter :: most_corrections = 6
    real(wp) :: error, before
    integer :: i, j

    do i = 1, size(cluster%blocks)
      call factorize_block(plan, plan%blocks(cluster%blocks(i)), state, self%blocks(cluster%blocks(i)))
    end do
    call carry_within(plan, reactions, cluster, links, self)
    before = huge(before)
    do i = 0, most_corrections
      error = imbalance(reactions, cluster, links%geometry, links%loads, self)
      ! the first solution shows whether the position is singular, also where nothing is lacking
      if ((i > 0 .and. error <= 32.0_wp*epsilon(error)) .or. (i > 1 .and. .not. error < 0.5_wp*before)) exit
      before = error
      do j = size(cluster%blocks), 1, -1
        call close_block_loops(plan, cluster%blocks(j), state, links%geometry, links%loads, self, done)
        if (.not. done) return
      end do
    end do
    done = error <= balanced
  end subroutine balance_loops

  !> Take the links of the cut chains from their ends inwards: each requires what it and all beyond it do.
  pure subroutine carry_within(plan, reactions, cluster, links, self)
    type(plan_type), intent(in) :: plan                        !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions          !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster           !< the cluster
    type(required_wrenches_type), intent(in) :: links          !< requirements of each link, about the origin of its first frame
    type(loop_balance_type), intent(inout) :: self             !< gets the wrenches of the cut chains
    integer :: i, s

    do i = 1, size(cluster%pairs)
      s = reactions%pairs(cluster%pairs(i))%step
      self%force(:, s) = 0.0_wp
      self%moment(:, s) = 0.0_wp
      if (plan%frame_of(plan%steps(s)%link) /= s) cycle
      self%force(:, s) = links%force(:, plan%steps(s)%link)
      self%moment(:, s) = links%moment(:, plan%steps(s)%link)
    end do
    do i = size(cluster%pairs), 1, -1
      s = reactions%pairs(cluster%pairs(i))%step
      if (reactions%begins(s)) cycle
      associate (onto => plan%steps(s)%parent, geometry => links%geometry)
        call add_at(1.0_wp, self%force(:, s), self%moment(:, s), geometry%reached(:, s), geometry%reached(:, onto), &
                    self%force(:, onto), self%moment(:, onto))
      end associate
    end do
  end subroutine carry_within

  !> Add a wrench that is given about one place to another about its own.
  pure subroutine add_at(sign, f, m, from, place, force, moment)
    real(wp), intent(in) :: sign            !< factor
    real(wp), intent(in) :: f(3)            !< force that is added [N]
    real(wp), intent(in) :: m(3)            !< its moment [N m]
    real(wp), intent(in) :: from(3)         !< place about which that is given [m]
    real(wp), intent(in) :: place(3)        !< place of the sum [m]
    real(wp), intent(inout) :: force(3)     !< the sum [N]
    real(wp), intent(inout) :: moment(3)    !< the sum [N m]
    real(wp) :: x, y, z

    x = from(1) - place(1)
    y = from(2) - place(2)
    z = from(3) - place(3)
    force = force + sign*f
    moment(1) = moment(1) + sign*(m(1) + y*f(3) - z*f(2))
    moment(2) = moment(2) + sign*(m(2) + z*f(1) - x*f(3))
    moment(3) = moment(3) + sign*(m(3) + x*f(2) - y*f(1))
  end subroutine add_at

  !> The generalized force that a dependent coordinate requires beside the loads on it [N m, N].
  pure real(wp) function lacking_at(k, s, geometry, loads, self) result(lacking)
    integer, intent(in) :: k                            !< number of the coordinate
    integer, intent(in) :: s                            !< its step
    type(joint_geometry_type), intent(in) :: geometry   !< of the position
    type(force_sum_type), intent(in) :: loads           !< with the loads on coordinates
    type(loop_balance_type), intent(in) :: self         !< with the wrenches

    lacking = geometry%spin(1, s)*self%moment(1, s) + geometry%spin(2, s)*self%moment(2, s) &
              + geometry%spin(3, s)*self%moment(3, s) + geometry%slide(1, s)*self%force(1, s) &
              + geometry%slide(2, s)*self%force(2, s) + geometry%slide(3, s)*self%force(3, s)
    if (loads%any_generalized) lacking = lacking - loads%generalized(k)
  end function lacking_at

  !> The largest force that a dependent coordinate of a cluster requires beside the loads on it, as a part of the largest wrench.
  pure real(wp) function imbalance(reactions, cluster, geometry, loads, self) result(error)
    type(reaction_plan_type), intent(in) :: reactions    !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster     !< the cluster
    type(joint_geometry_type), intent(in) :: geometry    !< of the position
    type(force_sum_type), intent(in) :: loads            !< with the loads on coordinates
    type(loop_balance_type), intent(in) :: self          !< with the wrenches
    real(wp) :: lacking, largest, per_length
    integer :: i, j, k, s

    per_length = 1.0_wp/reactions%length
    error = 0.0_wp
    largest = tiny(largest)
    do i = 1, size(cluster%pairs)
      k = cluster%pairs(i)
      s = reactions%pairs(k)%step
      do j = 1, 3
        largest = max(largest, abs(self%force(j, s)), abs(self%moment(j, s))*per_length)
      end do
      if (.not. reactions%pairs(k)%dependent) cycle
      lacking = abs(lacking_at(k, s, geometry, loads, self))
      if (lacking > error*geometry%length(k)) error = lacking/geometry%length(k)
    end do
    error = error/largest
  end function imbalance

  !> Let the closing frames of a block require what its dependent coordinates lack. The steps of their loops pass it on.
  subroutine close_block_loops(plan, b, state, geometry, loads, self, regular)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: b                            !< number of the block
    type(state_type), intent(in) :: state               !< the position
    type(joint_geometry_type), intent(in) :: geometry   !< of the position
    type(force_sum_type), intent(in) :: loads           !< with the loads on coordinates
    type(loop_balance_type), intent(inout) :: self      !< with the factors; its wrenches are corrected
    logical, intent(out) :: regular                     !< the position is not near a singular one
    real(wp) :: force(3), moment(3), regularity
    integer :: c, i, k, n, s, row

    associate (block => plan%blocks(b), work => self%blocks(b))
      do i = 1, size(block%unknowns)
        k = block%coordinates(i)
        work%change(i) = -lacking_at(k, block%unknowns(i), geometry, loads, self)*plan%unit_of(k)
      end do
      call work%equations%solve_transposed(work%change, work%right, regularity)
      regular = regularity > regular_balance
      if (.not. regular) return
      row = 0
      do c = block%first_closure, block%last_closure
        n = plan%constraints(c)%item%equations
        call constraint_wrench(plan, c, state, work%right(row + 1:row + n), force, moment)
        row = row + n
        associate (loop => plan%closures(c)%loop, place => geometry%reached(:, plan%closures(c)%closing))
          do i = 1, size(loop%steps)
            s = loop%steps(i)
            call add_at(loop%signs(i), force, moment, place, geometry%reached(:, s), self%force(:, s), self%moment(:, s))
          end do
        end associate
      end do
    end associate
  end subroutine close_block_loops

  !> The wrenches of the pairs of a cluster: from reference to moving link, about the origin of the pair's frame in the moving link.
  pure subroutine show_loops(reactions, cluster, geometry, self, force, moment)
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster      !< the cluster
    type(joint_geometry_type), intent(in) :: geometry     !< of the position
    type(loop_balance_type), intent(in) :: self           !< with the wrenches
    real(wp), intent(inout), contiguous :: force(:, :)    !< (3,M) gets the forces of the cluster's pairs [N]
    real(wp), intent(inout), contiguous :: moment(:, :)   !< (3,M) gets their moments [N m]
    integer :: i, k, s

    do i = 1, size(cluster%pairs)
      k = cluster%pairs(i)
      s = reactions%pairs(k)%step
      force(:, k) = 0.0_wp
      moment(:, k) = 0.0_wp
      call add_at(reactions%pairs(k)%direction, self%force(:, s), self%moment(:, s), geometry%reached(:, s), geometry%point(:, k), &
                  force(:, k), moment(:, k))
    end do
  end subroutine show_loops
end module mech9_loop_balance
