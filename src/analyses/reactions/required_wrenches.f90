!> The wrench that each link requires from its pairs: inertia less gravity and loads.
module mech9_required_wrenches
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_frame_motion, only: link_motion, link_turning, point_motion
  use mech9_reaction_plan, only: reaction_plan_type
  implicit none
  private
  public :: find_required

contains

  !> The force that each link requires, and the moment about a place of its own.
  pure subroutine find_required(mechanism, plan, reactions, state, places, view, sum, force, moment)
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(plan_type), intent(in) :: plan                   !< its plan
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(state_type), intent(in) :: state                 !< with the accelerations of the frames
    real(wp), intent(in), contiguous :: places(:, :)      !< (3,N) from the origin of frame 0 [m]
    type(motion_view_type), intent(in) :: view            !< the motion that the loads read
    type(force_sum_type), intent(in) :: sum               !< the sums of the loads
    real(wp), intent(out), contiguous :: force(:, :)      !< (3,N) axes of link 1 [N]
    real(wp), intent(out), contiguous :: moment(:, :)     !< (3,N) about `places`, axes of link 1 [N m]
    real(wp) :: arm(3), turning(3)
    integer :: i, k

    force = 0.0_wp
    moment = 0.0_wp
    do i = 1, size(reactions%bodies)
      k = mechanism%bodies(reactions%bodies(i))%link
      call add_body(mechanism, plan, reactions%bodies(i), state, places(:, k), force(:, k), moment(:, k))
    end do
    do i = 1, size(reactions%loaded)
      k = reactions%loaded(i)
      ! the sums are about the origins of the links' own systems
      arm = view%links(k)%p - plan%origin - places(:, k)
      turning = sum%torque(:, k) + cross(arm, sum%force(:, k))
      force(:, k) = force(:, k) - sum%force(:, k)
      moment(:, k) = moment(:, k) - turning
    end do
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
