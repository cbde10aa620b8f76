!> Inverse dynamics: the wrenches of all pairs, and the generalized forces that the independent coordinates need, in a state with
!> known positions, rates and accelerations.
!>
!> A wrench is what the reference link of a pair passes to its moving link: a force, and a moment about the origin of the
!> pair's frame in the moving link. It includes the loads on the pair's coordinate and the force of a drive. Where closed chains
!> leave wrenches undetermined, those of least norm over all pairs are given (mech9_cluster_balance).
module mech9_reactions
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_reaction_failures, only: failure_unbalanced
  use mech9_tolerances, only: rank_tolerance_for, planar_round_off
  use mech9_reaction_tolerances, only: balanced, balanced_singular
  use mech9_block_cholesky, only: clearly_positive
  use mech9_rotation, only: cross, turn_back
  use mech9_structure, only: structure_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_generalized_forces, only: sum_forces
  use mech9_reaction_plan, only: reaction_plan_type, joined_cluster_type
  use mech9_required_wrenches, only: required_wrenches_type, new_required_wrenches, find_required
  use mech9_joint_geometry, only: find_geometry
  use mech9_cluster_balance, only: cluster_balance_type, new_cluster_balance
  use mech9_loop_balance, only: loop_balance_type, new_loop_balance, balance_loops, show_loops
  use mech9_coupling_forces, only: coupling_forces_type, new_coupling_forces, add_couplings
  use mech9_planar_wrenches, only: planar_wrenches_type, new_planar_wrenches, balance_in_plane, show_wrenches, &
    show_needed
  use mech9_planar_balance, only: planar_balance_type, new_planar_balance
  use mech9_singular_cluster, only: singular_cluster_type, decompose_cluster
  implicit none
  private
  public :: reactions_type, new_reactions, find_reactions

  !> Wrenches and needed forces in one state, and scratch. Components are along the axes of link 1.
  type :: reactions_type
    real(wp), allocatable :: force(:, :)          !< (3,M) of each pair [N]
    real(wp), allocatable :: moment(:, :)         !< (3,M) of each pair, about the origin of its frame in the moving link [N m]
    !> (M) generalized force that an independent coordinate needs beside the loads on it: of its drive, or zero where it moves
    !> freely and the accelerations satisfy the equations of motion; zero for dependent coordinates [N m, N]
    real(wp), allocatable :: needed(:)
    type(required_wrenches_type) :: links         !< requirements of the links, with clusters that stand on them
    type(coupling_forces_type) :: couplings       !< forces of the couplings
    type(planar_wrenches_type) :: flat            !< of a flat mechanism
    type(loop_balance_type) :: loops              !< of the clusters that equilibrium determines
    type(cluster_balance_type), allocatable :: balances(:)   !< of the clusters
    type(planar_balance_type), allocatable :: in_plane(:)    !< of the clusters of a planar mechanism
    real(wp), allocatable :: wrenches(:, :)       !< (6,M) scratch: scaled, of the pairs of one cluster
    real(wp), allocatable :: changes(:, :)        !< (6,M) scratch
    real(wp), allocatable :: required(:, :)       !< (6,N) scratch: scaled, of the links of one cluster
    real(wp), allocatable :: lacking(:, :)        !< (6,N) scratch: scaled, what they do not receive
  end type reactions_type

contains

  !> Room for the wrenches of a mechanism; nothing is allocated afterwards, but in singular positions.
  pure function new_reactions(plan, reactions) result(self)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< its plan of inverse dynamics
    type(reactions_type) :: self
    integer :: c

    associate (m => plan%n_coordinates, n => plan%n_links)
      allocate (self%force(3, m), self%moment(3, m), self%needed(m), source=0.0_wp)
      allocate (self%wrenches(6, m), self%changes(6, m), self%required(6, n), self%lacking(6, n), source=0.0_wp)
    end associate
    self%links = new_required_wrenches(plan)
    if (reactions%flat) self%flat = new_planar_wrenches(plan)
    self%loops = new_loop_balance(plan, reactions)
    self%couplings = new_coupling_forces(plan)
    allocate (self%balances(size(reactions%clusters)), self%in_plane(merge(size(reactions%clusters), 0, plan%planar%used)))
    do c = 1, size(reactions%clusters)
      self%balances(c) = new_cluster_balance(reactions, reactions%clusters(c))
      if (plan%planar%used) self%in_plane(c) = new_planar_balance(reactions%clusters(c))
    end do
  end function new_reactions

  !> The wrenches of all pairs, and the forces that independent coordinates need, in a state whose frames have their
  !> accelerations. Fails where a load fails, and with exit_singular in singular positions in which the wrenches are infinite.
  subroutine find_reactions(mechanism, plan, reactions, state, self, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< its plan, with all blocks
    type(reaction_plan_type), intent(in) :: reactions   !< its plan of inverse dynamics
    type(state_type), intent(in) :: state               !< positions, rates and accelerations of coordinates and frames
    type(reactions_type), intent(inout) :: self         !< gets the wrenches
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: c
    logical :: done

    if (size(reactions%acting) > 0 .or. size(mechanism%motors) > 0) then
      call sum_forces(mechanism, plan, reactions%acting, reactions%loaded, state, self%links%view, self%links%loads, err)
      if (allocated(err)) return
    else if (size(plan%couplings) > 0) then
      call self%links%loads%clear()
    end if
    if (reactions%flat) then
      call balance_in_plane(plan, reactions, state, self%links%view, self%links%loads, self%flat, done)
      if (done) then
        call show_wrenches(plan, reactions, state, self%flat, self%force, self%moment)
        call show_needed(plan, state, self%links%loads, self%flat, self%needed)
        call show_joints(mechanism%structure, self)
        return
      end if
    end if
    call find_geometry(plan, reactions, state, self%links%geometry)
    call find_required(mechanism, plan, reactions, state, self%links)
    call carry_inwards(plan, reactions, self)
    call add_couplings(plan, reactions, state, self%links, self%couplings)
    do c = 1, size(reactions%clusters)
      call leave_unloaded(reactions%clusters(c), self, done)
      if (.not. done) then
        if (plan%planar%used) then
          call solve_in_plane(plan, reactions, reactions%clusters(c), self%balances(c)%held, self%in_plane(c), self, done)
        else if (reactions%clusters(c)%determined) then
          call solve_loops(plan, reactions, reactions%clusters(c), state, self, done)
        end if
      end if
      if (done) cycle
      call solve_cluster(plan, reactions, reactions%clusters(c), self%balances(c), self, err)
      if (allocated(err)) then
        err%failure%t = state%t
        return
      end if
    end do
    call find_needed(plan, reactions, self)
    call show_joints(mechanism%structure, self)
  end subroutine find_reactions

  !> Give the first coordinate of each joint with several freedoms the wrench of its last pair, which leads to the moving link. All
  !> pairs of the joint pass on the same force, since the links between them have neither mass nor loads.
  pure subroutine show_joints(structure, self)
    type(structure_type), intent(in) :: structure   !< links and joints
    type(reactions_type), intent(inout) :: self     !< with the wrenches of all pairs
    integer :: j

    if (.not. allocated(structure%joints)) return
    do j = 1, size(structure%joints)
      associate (joint => structure%joints(j))
        self%force(:, joint%numbers(1)) = self%force(:, joint%numbers(joint%freedoms))
        self%moment(:, joint%numbers(1)) = self%moment(:, joint%numbers(joint%freedoms))
      end associate
    end do
  end subroutine show_joints

  !> Take the links from the ends of chains inwards: each passes what it and all beyond it require on to the link on which it
  !> stands. This is the wrench of a pair outside closed chains.
  pure subroutine carry_inwards(plan, reactions, self)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(reactions_type), intent(inout) :: self         !< with what each link requires; gets wrenches of open chains
    real(wp) :: moment(3), arm(3)
    integer :: i, k, s, link, onto

    associate (links => self%links, place => self%links%geometry%place)
      links%total_force = links%force
      links%total_moment = links%moment
      do i = 1, size(reactions%inwards)
        s = reactions%inwards(i)
        k = plan%steps(s)%coordinate
        link = plan%steps(s)%link
        onto = 1
        if (plan%steps(s)%parent > 0) onto = plan%steps(plan%steps(s)%parent)%link
        associate (force => links%total_force(:, link))
          arm = place(:, link) - place(:, onto)
          moment = links%total_moment(:, link) + cross(arm, force)
          links%total_force(:, onto) = links%total_force(:, onto) + force
          links%total_moment(:, onto) = links%total_moment(:, onto) + moment
          if (.not. reactions%begins(s)) cycle
          links%force(:, onto) = links%force(:, onto) + force
          links%moment(:, onto) = links%moment(:, onto) + moment
          if (.not. reactions%alone(s)) cycle
          arm = place(:, link) - links%geometry%point(:, k)
          self%force(:, k) = reactions%pairs(k)%direction*force
          moment = links%total_moment(:, link) + cross(arm, force)
          self%moment(:, k) = reactions%pairs(k)%direction*moment
        end associate
      end do
    end associate
  end subroutine carry_inwards

  !> The wrenches of a cluster whose links require nothing are zero; `done` is whether this is so.
  pure subroutine leave_unloaded(cluster, self, done)
    type(joined_cluster_type), intent(in) :: cluster   !< the cluster
    type(reactions_type), intent(inout) :: self        !< with what its links require; gets the wrenches
    logical, intent(out) :: done                       !< nothing is required
    integer :: i, k

    done = .not. self%links%loads%any_generalized
    do i = 1, size(cluster%links)
      k = cluster%links(i)
      if (done) done = .not. (any(abs(self%links%force(:, k)) > 0.0_wp) .or. any(abs(self%links%moment(:, k)) > 0.0_wp))
    end do
    if (.not. done) return
    do i = 1, size(cluster%pairs)
      self%force(:, cluster%pairs(i)) = 0.0_wp
      self%moment(:, cluster%pairs(i)) = 0.0_wp
    end do
  end subroutine leave_unloaded

  !> The wrenches of the pairs of a cluster that equilibrium alone determines. `done` is false beside singular positions.
  subroutine solve_loops(plan, reactions, cluster, state, self, done)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    type(state_type), intent(in) :: state               !< the position
    type(reactions_type), intent(inout) :: self         !< with what its links require; gets the wrenches
    logical, intent(out) :: done                        !< the wrenches are found

    call balance_loops(plan, reactions, cluster, state, self%links, self%loops, done)
    if (done) call show_loops(reactions, cluster, self%links%geometry, self%loops, self%force, self%moment)
  end subroutine solve_loops

  !> The wrenches of the pairs of a planar cluster across whose plane nothing acts. `done` is false where something does, and
  !> beside singular positions.
  pure subroutine solve_in_plane(plan, reactions, cluster, held, balance, self, done)
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions       !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster        !< the cluster
    logical, intent(in) :: held(:)                          !< (pairs) the coordinate is dependent
    type(planar_balance_type), intent(inout) :: balance     !< its equations in the plane
    type(reactions_type), intent(inout) :: self             !< with what its links require; gets the wrenches
    logical, intent(out) :: done                            !< the wrenches are found
    real(wp) :: error
    integer :: i, k

    call lay_in_plane(plan%planar%axes, reactions, cluster, held, self, balance, done)
    if (.not. done) return
    call balance%factorize(cluster, held)
    done = balance%factors%least_part > clearly_positive
    if (done) call balance%solve(cluster, held, error)
    if (done) done = error <= balanced
    if (.not. done) return
    associate (axes => plan%planar%axes)
      do i = 1, size(cluster%pairs)
        k = cluster%pairs(i)
        self%force(:, k) = balance%wrenches(1, i)*axes(:, 1) + balance%wrenches(2, i)*axes(:, 2)
        self%moment(:, k) = (reactions%length*balance%wrenches(3, i))*axes(:, 3)
      end do
    end associate
  end subroutine solve_in_plane

  !> The axes, arms and requirements of a cluster in the axes of its plane. `flat` is false where some of them are across it, by
  !> more than round-off.
  pure subroutine lay_in_plane(axes, reactions, cluster, held, self, balance, flat)
    real(wp), intent(in) :: axes(3, 3)                      !< of the plane; the third is its normal
    type(reaction_plan_type), intent(in) :: reactions       !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster        !< the cluster
    logical, intent(in) :: held(:)                          !< (pairs) the coordinate is dependent
    type(reactions_type), intent(in) :: self                !< with geometry, requirements and loads
    type(planar_balance_type), intent(inout) :: balance     !< gets axes, arms, requirements, and the wrenches of loads
    logical, intent(out) :: flat                            !< nothing is across the plane
    real(wp) :: d(3), f(3), m(3), across, largest
    integer :: i, k, side

    across = 0.0_wp
    largest = 0.0_wp
    do i = 1, size(cluster%links)
      f = turn_back(axes, self%links%force(:, cluster%links(i)))
      m = turn_back(axes, self%links%moment(:, cluster%links(i)))/reactions%length
      balance%required(:, i) = [f(1), f(2), m(3)]
      across = max(across, abs(f(3)), abs(m(1)), abs(m(2)))
      largest = max(largest, abs(f(1)), abs(f(2)), abs(m(3)))
    end do
    flat = across <= planar_round_off*largest
    do i = 1, size(cluster%pairs)
      if (.not. flat) return
      k = cluster%pairs(i)
      f = turn_back(axes, self%links%geometry%axis(1:3, k))
      m = turn_back(axes, self%links%geometry%axis(4:6, k))
      balance%axis(:, i) = [f(1), f(2), m(3)]
      across = max(abs(f(3)), abs(m(1)), abs(m(2)))
      do side = 1, 2
        d = self%links%geometry%point(:, k) - self%links%geometry%place(:, reactions%pairs(k)%links(side))
        d = turn_back(axes, d)/reactions%length
        balance%arm(:, side, i) = d(1:2)
        across = max(across, abs(d(3)))
      end do
      flat = across <= planar_round_off
      balance%wrenches(:, i) = 0.0_wp
      if (held(i) .and. self%links%loads%any_generalized) &
        balance%wrenches(:, i) = (self%links%loads%generalized(k)/self%links%geometry%length(k))*balance%axis(:, i)
    end do
  end subroutine lay_in_plane

  !> The wrenches of the pairs of a cluster.
  subroutine solve_cluster(plan, reactions, cluster, balance, self, err)
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions       !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster        !< the cluster
    type(cluster_balance_type), intent(inout) :: balance    !< its equations
    type(reactions_type), intent(inout) :: self             !< with what its links require; gets the wrenches
    type(error_type), allocatable, intent(out) :: err       !< allocated if the wrenches are infinite
    type(singular_cluster_type) :: singular
    real(wp) :: loads, largest
    integer :: i, k, n, m
    logical :: regular

    n = size(cluster%links)
    m = size(cluster%pairs)
    call balance%set_position(cluster, self%links%geometry, reactions, reactions%length, regular)
    do i = 1, n
      self%required(1:3, i) = self%links%force(:, cluster%links(i))
      self%required(4:6, i) = self%links%moment(:, cluster%links(i))/reactions%length
    end do
    call hold_loads(cluster, balance, self)
    loads = largest_load(plan, cluster, balance, self)
    associate (wrenches => self%wrenches(:, :m), required => self%required(:, :n), lacking => self%lacking(:, :n))
      if (regular) call balance%complete(required, wrenches, lacking, regular, size_of_all=loads)
      if (.not. regular) then
        call hold_loads(cluster, balance, self)
        call decompose_cluster(cluster, balance, rank_tolerance_for(plan%data_tolerance), singular)
        call singular%hold_motions(cluster, balance)
        call balance%find_lacking(required, wrenches, lacking)
        call singular%solve(lacking, self%changes(:, :m))
        wrenches = wrenches + self%changes(:, :m)
        call balance%find_lacking(required, wrenches, lacking)
        largest = max(maxval(abs(wrenches)), maxval(abs(required)), loads)
        if (maxval(abs(lacking)) > balanced_singular*largest) then
          call raise(err, exit_singular, failure_unbalanced)
          err%failure%coordinates = pack([(k, k=1, plan%n_coordinates)], [(any(cluster%pairs == k), k=1, plan%n_coordinates)])
          return
        end if
      end if
      do i = 1, m
        k = cluster%pairs(i)
        self%force(:, k) = wrenches(1:3, i)
        self%moment(:, k) = wrenches(4:6, i)*reactions%length
      end do
    end associate
  end subroutine solve_cluster

  !> Begin with the wrenches that do the work of the loads on the dependent coordinates.
  pure subroutine hold_loads(cluster, balance, self)
    type(joined_cluster_type), intent(in) :: cluster       !< the cluster
    type(cluster_balance_type), intent(in) :: balance      !< its equations
    type(reactions_type), intent(inout) :: self            !< with the loads; gets the wrenches of the cluster
    integer :: i, k

    do i = 1, size(cluster%pairs)
      k = cluster%pairs(i)
      self%wrenches(:, i) = 0.0_wp
      if (.not. (self%links%loads%any_generalized .and. balance%held(i))) cycle
      if (self%links%geometry%length(k) > 0.0_wp) &
        self%wrenches(:, i) = (self%links%loads%generalized(k)/self%links%geometry%length(k))*self%links%geometry%axis(:, k)
    end do
  end subroutine hold_loads

  !> The largest of the loads and forces of couplings on the dependent coordinates of a cluster, scaled. Their sums may be small, and
  !> have the round-off of the largest.
  pure real(wp) function largest_load(plan, cluster, balance, self) result(largest)
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(joined_cluster_type), intent(in) :: cluster       !< the cluster
    type(cluster_balance_type), intent(in) :: balance      !< its equations
    type(reactions_type), intent(in) :: self               !< with the loads
    integer :: i, k

    largest = 0.0_wp
    if (size(plan%couplings) == 0) return
    do i = 1, size(cluster%pairs)
      k = cluster%pairs(i)
      if (balance%held(i) .and. self%links%geometry%length(k) > 0.0_wp) &
        largest = max(largest, self%couplings%largest(k)/self%links%geometry%length(k))
    end do
  end function largest_load

  !> The generalized forces that independent coordinates need beside the loads on them.
  pure subroutine find_needed(plan, reactions, self)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(reactions_type), intent(inout) :: self         !< with the wrenches; gets the forces
    integer :: k

    self%needed = 0.0_wp
    do k = 1, plan%n_coordinates
      if (reactions%pairs(k)%dependent) cycle
      associate (axis => self%links%geometry%axis(:, k))
        self%needed(k) = self%links%geometry%length(k)*(dot_product(axis(1:3), self%force(:, k)) &
                                                  + dot_product(axis(4:6), self%moment(:, k))/reactions%length)
      end associate
      if (self%links%loads%any_generalized) self%needed(k) = self%needed(k) - self%links%loads%generalized(k)
    end do
  end subroutine find_needed
end module mech9_reactions
