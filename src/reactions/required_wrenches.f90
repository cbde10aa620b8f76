!> The wrench that each link requires from its pairs: inertia less gravity and loads.
module mech9_required_wrenches
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_frame_motion, only: link_motion, link_turning, point_motion
  use mech9_reaction_plan, only: reaction_plan_type
  use mech9_joint_geometry, only: joint_geometry_type, new_joint_geometry
  implicit none
  private
  public :: required_wrenches_type, new_required_wrenches, find_required

  !> The requirements of the links in one position, with its geometry and loads. Components are along the axes of link 1, moments about
  !> the places of the links.
  type :: required_wrenches_type
    type(joint_geometry_type) :: geometry           !< of the position
    type(motion_view_type) :: view                  !< the motion as loads read it
    type(force_sum_type) :: loads                   !< sums of the loads
    real(wp), allocatable :: force(:, :)            !< (3,N) what each link requires [N]
    real(wp), allocatable :: moment(:, :)           !< (3,N) [N m]
    real(wp), allocatable :: total_force(:, :)      !< (3,N) the same with all links beyond [N]
    real(wp), allocatable :: total_moment(:, :)     !< (3,N) [N m]
  end type required_wrenches_type

contains

  !> Room for the requirements of a mechanism.
  pure function new_required_wrenches(plan) result(self)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(required_wrenches_type) :: self

    associate (m => plan%n_coordinates, n => plan%n_links)
      allocate (self%force(3, n), self%moment(3, n), self%total_force(3, n), self%total_moment(3, n), source=0.0_wp)
      allocate (self%view%links(n))
      allocate (self%view%q(m), self%view%dq(m), source=0.0_wp)
      self%loads = new_force_sum(n, m)
    end associate
    self%geometry = new_joint_geometry(plan)
  end function new_required_wrenches

  !> The force that each link requires, and the moment about its place.
  pure subroutine find_required(mechanism, plan, reactions, state, self)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(state_type), intent(in) :: state                 !< with the accelerations of the frames
    type(required_wrenches_type), intent(inout) :: self   !< with geometry and loads; gets forces and moments
    real(wp) :: arm(3), turning(3)
    integer :: i, k

    self%force = 0.0_wp
    self%moment = 0.0_wp
    do i = 1, size(reactions%bodies)
      k = mechanism%bodies(reactions%bodies(i))%link
      call add_body(mechanism, plan, reactions%bodies(i), state, self%geometry%place(:, k), self%force(:, k), self%moment(:, k))
    end do
    associate (sum => self%loads)
      do i = 1, size(reactions%loaded)
        k = reactions%loaded(i)
        ! the sums are about the origins of the links' own systems
        arm = self%view%links(k)%p - plan%origin - self%geometry%place(:, k)
        turning = sum%torque(:, k) + cross(arm, sum%force(:, k))
        self%force(:, k) = self%force(:, k) - sum%force(:, k)
        self%moment(:, k) = self%moment(:, k) - turning
      end do
    end associate
  end subroutine find_required

  !> Add what the inertia and the weight of one body require.
  pure subroutine add_body(mechanism, plan, number, state, place, force, moment)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< its plan
    integer, intent(in) :: number                   !< of the body
    type(state_type), intent(in) :: state           !< with the accelerations of the frames
    real(wp), intent(in) :: place(3)                !< from the origin of frame 0 [m]
    real(wp), intent(inout) :: force(3)             !< [N]
    real(wp), intent(inout) :: moment(3)            !< about `place` [N m]
    real(wp), dimension(3) :: p, omega, v, alpha, centre, velocity, acceleration, needed, arm, spin, momentum
    real(wp) :: r(3, 3)

    associate (body => mechanism%bodies(number))
      call point_motion(plan, state, body%link, body%centre, centre, velocity, acceleration)
      needed = body%mass*(acceleration - mechanism%gravity)
      arm = centre - plan%origin - place
      force = force + needed
      moment = moment + cross(arm, needed)
      if (.not. any(abs(body%inertia) > 0.0_wp)) return
      call link_motion(plan, state, body%link, r, p, omega, v)
      call link_turning(plan, state, body%link, alpha)
      spin = turn_back(r, omega)
      momentum = turn(body%inertia, spin)
      moment = moment + turn(r, turn(body%inertia, turn_back(r, alpha)) + cross(spin, momentum))
    end associate
  end subroutine add_body
end module mech9_required_wrenches
