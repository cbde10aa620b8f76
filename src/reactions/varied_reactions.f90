!> The exact derivatives of the wrenches of all pairs by all parameters.
!>
!> The wrench of a pair outside closed chains is the sum of those that the links beyond it require; wrenches of closed chains have the
!> equations of mech9_varied_cluster. Sums are about the origin of frame 0, which does not move; the moment that is recorded is about
!> the pair's own point, which does.
module mech9_varied_reactions
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_singular
  use mech9_sensitivity_failures, only: failure_singular_sensitivity
  use mech9_reaction_failures, only: failure_shared_force
  use mech9_tolerances, only: rank_tolerance_for
  use mech9_random, only: random_type
  use mech9_rotation, only: cross
  use mech9_structure, only: structure_type
  use mech9_model, only: model_type
  use mech9_varied_motion, only: varied_motion_type
  use mech9_link_requirements, only: link_requirements_type
  use mech9_reaction_plan, only: reaction_plan_type, joined_cluster_type, make_reaction_plan
  use mech9_joint_geometry, only: new_joint_geometry, find_geometry
  use mech9_coupling_forces, only: coupling_forces_type, new_coupling_forces, draw_idle_couplings
  use mech9_varied_geometry, only: new_varied_geometry, find_varied_geometry
  use mech9_varied_cluster, only: varied_position_type, equations_type, new_equations, vary_cluster
  implicit none
  private
  public :: varied_reactions_type, new_varied_reactions, find_varied_reactions

  !> The derivatives, and what finds them. Components are along the axes of link 1.
  type :: varied_reactions_type
    real(wp), allocatable :: force(:, :, :)    !< (P,3,M) of the force in each pair [N per unit of the parameter]
    real(wp), allocatable :: moment(:, :, :)   !< (P,3,M) of its moment, about the origin of its frame in the moving link [N m per unit]
    type(reaction_plan_type), private :: plan                          !< of inverse dynamics, in space
    type(varied_position_type), private :: position                    !< with its derivatives
    type(equations_type), allocatable, private :: equations(:)         !< of the clusters
  end type varied_reactions_type

contains

  !> Room for the derivatives of a model. Fails with exit_data where equilibrium does not determine the force of a coupling.
  subroutine new_varied_reactions(model, motion, self, err)
    type(model_type), intent(in) :: model                !< the model
    type(varied_motion_type), intent(in) :: motion       !< derivatives of its motion, in a position
    type(varied_reactions_type), intent(out) :: self     !< gets its room
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    integer :: c

    call make_reaction_plan(model%mechanism, motion%plan, self%plan)
    self%position%geometry = new_joint_geometry(motion%plan)
    self%position%changes = new_varied_geometry(motion)
    allocate (self%equations(size(self%plan%clusters)))
    do c = 1, size(self%equations)
      self%equations(c) = new_equations(self%plan, self%plan%clusters(c), rank_tolerance_for(motion%plan%data_tolerance))
    end do
    associate (n => motion%n_parameters, m => motion%plan%n_coordinates)
      allocate (self%force(n, 3, m), self%moment(n, 3, m), source=0.0_wp)
    end associate
    if (size(motion%plan%couplings) > 0) call check_couplings(motion, err)
  end subroutine new_varied_reactions

  !> Fail where forces of couplings, perhaps with those of closed chains, have no effect together, so that equilibrium does not
  !> determine them.
  subroutine check_couplings(motion, err)
    type(varied_motion_type), intent(in) :: motion       !< with the position
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(coupling_forces_type) :: couplings
    type(random_type) :: random
    real(wp) :: multipliers(size(motion%plan%couplings)), forces(motion%plan%n_coordinates)

    couplings = new_coupling_forces(motion%plan)
    call draw_idle_couplings(motion%plan, motion%state, random, couplings, multipliers, forces)
    if (all(abs(multipliers) <= rank_tolerance_for(motion%plan%data_tolerance))) return
    call raise(err, exit_data, failure_shared_force)
    err%failure%number = maxloc(abs(multipliers), dim=1)
    err%place = motion%plan%couplings(err%failure%number)%coupling%place
  end subroutine check_couplings

  !> Find the derivatives in the present motion, from those of what links require. Fails with exit_singular beside singular
  !> positions.
  subroutine find_varied_reactions(model, motion, required, self, err)
    type(model_type), intent(in) :: model                    !< the model
    type(varied_motion_type), intent(in) :: motion           !< derivatives of its motion
    type(link_requirements_type), intent(in) :: required     !< wrenches that links require, and loads, with their derivatives
    type(varied_reactions_type), intent(inout) :: self       !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    integer :: c
    logical :: regular

    call find_geometry(motion%plan, self%plan, motion%state, self%position%geometry)
    call find_varied_geometry(motion, self%plan, self%position%geometry, self%position%changes)
    self%position%sizes = motion%tangents%size
    self%position%links = required
    call carry_inwards(motion, self)
    do c = 1, size(self%equations)
      call vary_cluster(self%plan, self%position, self%equations(c), self%force, self%moment, regular)
      if (regular) cycle
      call raise(err, exit_singular, failure_singular_sensitivity)
      err%failure%chains = chains_of(motion, self%plan%clusters(c))
      err%failure%t = motion%state%t
      return
    end do
    call show_joints(model%mechanism%structure, self)
  end subroutine find_varied_reactions

  !> Take the links from the ends of chains inwards: each passes what it and all beyond it require on to the link on which it stands.
  subroutine carry_inwards(motion, self)
    type(varied_motion_type), intent(in) :: motion           !< derivatives of the motion
    type(varied_reactions_type), intent(inout) :: self       !< with the requirements of each link, which get those of
                                                             !< all that stands on it; gets the derivatives of open chains
    real(wp), allocatable :: wrench(:, :), wrenches(:, :, :)
    integer :: i, s, link, onto

    wrench = self%position%links%wrench
    wrenches = self%position%links%wrenches
    associate (plan => motion%plan)
      do i = 1, size(self%plan%inwards)
        s = self%plan%inwards(i)
        link = plan%steps(s)%link
        onto = 1
        if (plan%steps(s)%parent > 0) onto = plan%steps(plan%steps(s)%parent)%link
        wrench(:, onto) = wrench(:, onto) + wrench(:, link)
        wrenches(:, :, onto) = wrenches(:, :, onto) + wrenches(:, :, link)
        if (.not. self%plan%begins(s)) cycle
        associate (links => self%position%links)
          links%wrench(:, onto) = links%wrench(:, onto) + wrench(:, link)
          links%wrenches(:, :, onto) = links%wrenches(:, :, onto) + wrenches(:, :, link)
        end associate
        if (self%plan%alone(s)) call vary_pair(plan%steps(s)%coordinate, wrench(:, link), wrenches(:, :, link), self)
      end do
    end associate
  end subroutine carry_inwards

  !> The derivative of the wrench of a pair outside closed chains, about its own point.
  pure subroutine vary_pair(k, wrench, wrenches, self)
    integer, intent(in) :: k                                 !< coordinate of the pair
    real(wp), intent(in) :: wrench(6)                        !< of all beyond it, about the origin of frame 0 [N m, N]
    real(wp), intent(in) :: wrenches(:, :)                   !< (P,6) its derivatives
    type(varied_reactions_type), intent(inout) :: self       !< gets the derivative
    real(wp) :: force(3), lever(3)
    integer :: p

    associate (direction => self%plan%pairs(k)%direction, point => self%position%geometry%point(:, k))
      do p = 1, size(wrenches, 1)
        force = wrenches(p, 4:6)
        lever = self%position%changes%point(p, :, k)
        self%force(p, :, k) = direction*force
        self%moment(p, :, k) = direction*(wrenches(p, 1:3) - cross(point, force) - cross(lever, wrench(4:6)))
      end do
    end associate
  end subroutine vary_pair

  !> The closed chains of a cluster.
  pure function chains_of(motion, cluster) result(chains)
    type(varied_motion_type), intent(in) :: motion           !< with the plan
    type(joined_cluster_type), intent(in) :: cluster         !< the cluster
    integer, allocatable :: chains(:)
    integer :: i

    allocate (chains(0))
    do i = 1, size(cluster%blocks)
      chains = [chains, motion%plan%blocks(cluster%blocks(i))%chains]
    end do
  end function chains_of

  !> Give the first coordinate of each joint with several freedoms the derivatives of its last pair, which leads to the moving link.
  pure subroutine show_joints(structure, self)
    type(structure_type), intent(in) :: structure            !< links and joints
    type(varied_reactions_type), intent(inout) :: self       !< with the derivatives of all pairs
    integer :: j

    if (.not. allocated(structure%joints)) return
    do j = 1, size(structure%joints)
      associate (joint => structure%joints(j))
        self%force(:, :, joint%numbers(1)) = self%force(:, :, joint%numbers(joint%freedoms))
        self%moment(:, :, joint%numbers(1)) = self%moment(:, :, joint%numbers(joint%freedoms))
      end associate
    end do
  end subroutine show_joints
end module mech9_varied_reactions
