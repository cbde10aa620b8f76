!> The components of wrenches, and the forces of couplings, that equilibrium determines.
!>
!> A component is unique exactly where it is zero in all wrenches that balance nothing, do no work on any coordinate and need no
!> drive: in the null space of the equations of equilibrium. A random wrench of this space shows it, since its components are
!> zero only where those of the whole space are. Three of them leave no chance to an accident. Forces of couplings that have
!> no effect together are part of it.
module mech9_uniqueness
  use mech9_kinds, only: wp
  use mech9_tolerances, only: rank_tolerance_for
  use mech9_random, only: random_type
  use mech9_rotation, only: identity, turn_back, combine
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion
  use mech9_generic_position, only: generic_position_type, find_generic_position
  use mech9_reaction_plan, only: reaction_plan_type, joined_cluster_type
  use mech9_joint_geometry, only: joint_geometry_type, new_joint_geometry, find_geometry
  use mech9_cluster_balance, only: cluster_balance_type, new_cluster_balance
  use mech9_coupling_forces, only: coupling_forces_type, new_coupling_forces, draw_idle_couplings
  use mech9_singular_cluster, only: singular_cluster_type, decompose_cluster
  implicit none
  private
  public :: uniqueness_type, find_unique, component_names

  !> Components of a wrench, in the axes of the pair's frame in its moving link.
  character(len=2), parameter :: component_names(6) = ['fx', 'fy', 'fz', 'mx', 'my', 'mz']

  !> Forces that equilibrium determines.
  type :: uniqueness_type
    logical, allocatable :: pairs(:, :)     !< (6,M) components of the wrench of each pair, in the axes of its frame in its moving link
    logical, allocatable :: fixed(:, :)     !< (6,M) the same along the axes of link 1
    logical, allocatable :: moving(:, :)    !< (6,M) the same along the axes of its moving link
    logical, allocatable :: couplings(:)    !< (couplings) the force of each
  contains
    procedure :: shown
  end type uniqueness_type

  !> Number of random wrenches.
  integer, parameter :: samples = 3

contains

  !> Find whether each component fx, fy, fz, mx, my, mz of each pair's wrench is unique: in a generic position, or at the start where none is found.
  subroutine find_unique(plan, reactions, start, unique)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism, with all blocks
    type(reaction_plan_type), intent(in) :: reactions    !< its plan of inverse dynamics
    type(state_type), intent(in) :: start                !< an assembled position
    type(uniqueness_type), intent(out) :: unique         !< components and forces that are unique
    type(generic_position_type) :: generic
    type(joint_geometry_type) :: geometry
    type(state_type) :: state
    real(wp) :: forces(plan%n_coordinates, samples)
    integer :: c
    logical :: found

    allocate (unique%pairs(6, plan%n_coordinates), unique%couplings(size(plan%couplings)), source=.true.)
    allocate (unique%fixed, unique%moving, source=unique%pairs)
    if (size(reactions%clusters) == 0 .and. size(plan%couplings) == 0) return
    call find_generic_position(plan, plan%blocks, start, generic, found)
    state = start
    if (found) state = generic%state
    geometry = new_joint_geometry(plan)
    call find_geometry(plan, reactions, state, geometry)
    call judge_couplings(plan, state, unique%couplings, forces)
    do c = 1, size(reactions%clusters)
      call judge_cluster(plan, reactions, reactions%clusters(c), state, geometry, forces, unique)
    end do
  end subroutine find_unique

  !> The components that are unique along the axes of the results.
  pure function shown(self, in_links) result(unique)
    class(uniqueness_type), intent(in) :: self   !< the components
    logical, intent(in) :: in_links              !< these are the axes of the moving links; else of link 1
    logical :: unique(size(self%pairs, 1), size(self%pairs, 2))

    unique = self%fixed
    if (in_links) unique = self%moving
  end function shown

  !> The couplings whose forces are unique, and random forces of the others that have no effect together.
  subroutine judge_couplings(plan, state, unique, forces)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism, with all blocks
    type(state_type), intent(in) :: state       !< the position
    logical, intent(inout) :: unique(:)         !< (couplings) becomes false where the force is not unique
    real(wp), intent(out) :: forces(:, :)       !< (M,samples) on the coordinates [N m, N]
    type(coupling_forces_type) :: couplings
    type(random_type) :: random
    real(wp) :: multipliers(size(unique))
    integer :: sample

    couplings = new_coupling_forces(plan)
    do sample = 1, samples
      call draw_idle_couplings(plan, state, random, couplings, multipliers, forces(:, sample))
      unique = unique .and. abs(multipliers) <= rank_tolerance_for(plan%data_tolerance)
    end do
    ! round-off would count as forces
    if (all(unique)) forces = 0.0_wp
  end subroutine judge_couplings

  !> The unique components of the pairs of one cluster.
  subroutine judge_cluster(plan, reactions, cluster, state, geometry, forces, unique)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster      !< the cluster
    type(state_type), intent(in) :: state                 !< the position
    type(joint_geometry_type), intent(in) :: geometry     !< of the position
    real(wp), intent(in) :: forces(:, :)                  !< (M,samples) of couplings on the coordinates [N m, N]
    type(uniqueness_type), intent(inout) :: unique        !< becomes false where a component is not unique
    type(cluster_balance_type) :: balance
    type(singular_cluster_type) :: singular
    type(random_type) :: random
    real(wp) :: wrenches(6, size(cluster%pairs)), tolerance
    integer :: sample, i
    logical :: regular, removed

    tolerance = rank_tolerance_for(plan%data_tolerance)
    balance = new_cluster_balance(reactions, cluster)
    call balance%set_position(cluster, geometry, reactions, reactions%length, regular)
    if (.not. regular) call decompose_cluster(cluster, balance, tolerance, singular)
    do sample = 1, samples
      call draw(balance, cluster, geometry, forces(:, sample), random, wrenches)
      removed = .false.
      if (regular) call balance%remove_determined(wrenches, removed)
      if (regular .and. .not. removed) then
        regular = .false.
        call decompose_cluster(cluster, balance, tolerance, singular)
      end if
      if (.not. regular) then
        call singular%remove_determined(wrenches)
        call hold(balance, cluster, geometry, forces(:, sample), wrenches)
      end if
      do i = 1, size(cluster%pairs)
        call judge_pair(plan, reactions, cluster%pairs(i), state, wrenches(:, i), tolerance, unique)
      end do
    end do
  end subroutine judge_cluster

  !> Random wrenches that do no work on dependent coordinates beside that of the couplings.
  subroutine draw(balance, cluster, geometry, forces, random, wrenches)
    type(cluster_balance_type), intent(in) :: balance   !< the equations of the cluster
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    type(joint_geometry_type), intent(in) :: geometry   !< of the position
    real(wp), intent(in) :: forces(:)                   !< (M) of couplings on the coordinates [N m, N]
    type(random_type), intent(inout) :: random          !< source of the numbers
    real(wp), intent(out) :: wrenches(:, :)             !< (6,pairs) scaled
    integer :: i, j

    do i = 1, size(wrenches, 2)
      do j = 1, 6
        wrenches(j, i) = random%symmetric()
      end do
    end do
    call hold(balance, cluster, geometry, forces, wrenches)
  end subroutine draw

  !> Let wrenches do no work on dependent coordinates beside that of the couplings. Singular vectors of small values have parts along the
  !> axes, of round-off over the value.
  pure subroutine hold(balance, cluster, geometry, forces, wrenches)
    type(cluster_balance_type), intent(in) :: balance   !< the equations of the cluster
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    type(joint_geometry_type), intent(in) :: geometry   !< of the position
    real(wp), intent(in) :: forces(:)                   !< (M) of couplings on the coordinates [N m, N]
    real(wp), intent(inout) :: wrenches(:, :)           !< (6,pairs) scaled
    integer :: i, k

    do i = 1, size(wrenches, 2)
      if (.not. balance%held(i)) cycle
      k = cluster%pairs(i)
      wrenches(:, i) = wrenches(:, i) - dot_product(balance%axis(:, i), wrenches(:, i))*balance%axis(:, i)
      if (geometry%length(k) > 0.0_wp) &
        wrenches(:, i) = wrenches(:, i) + (forces(k)/geometry%length(k))*balance%axis(:, i)
    end do
  end subroutine hold

  !> Mark the components of a pair's wrench that are not zero, in all axes.
  pure subroutine judge_pair(plan, reactions, k, state, wrench, tolerance, unique)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions    !< the plan of inverse dynamics
    integer, intent(in) :: k                             !< coordinate of the pair
    type(state_type), intent(in) :: state                !< the position
    real(wp), intent(in) :: wrench(6)                    !< axes of link 1, scaled
    real(wp), intent(in) :: tolerance                    !< smaller components are zero
    type(uniqueness_type), intent(inout) :: unique       !< becomes false where a component is not zero
    real(wp) :: r(3, 3), p(3), omega(3), v(3)

    call link_motion(plan, state, reactions%pairs(k)%links(1), r, p, omega, v)
    call judge_along(identity, wrench, tolerance, unique%fixed(:, k))
    call judge_along(r, wrench, tolerance, unique%moving(:, k))
    call judge_along(combine(r, reactions%pairs(k)%frame%r), wrench, tolerance, unique%pairs(:, k))
  end subroutine judge_pair

  !> Mark the components of a wrench that are not zero along some axes.
  pure subroutine judge_along(r, wrench, tolerance, unique)
    real(wp), intent(in) :: r(3, 3)              !< turns components in these axes into those in the axes of link 1
    real(wp), intent(in) :: wrench(6)            !< axes of link 1, scaled
    real(wp), intent(in) :: tolerance            !< smaller components are zero
    logical, intent(inout) :: unique(6)          !< becomes false where a component is not zero

    unique(1:3) = unique(1:3) .and. abs(turn_back(r, wrench(1:3))) <= tolerance
    unique(4:6) = unique(4:6) .and. abs(turn_back(r, wrench(4:6))) <= tolerance
  end subroutine judge_along
end module mech9_uniqueness
