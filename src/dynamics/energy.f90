!> Kinetic energy (20) and potential energy of a mechanism in a state.
module mech9_energy
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_mechanism, only: mechanism_type
  use mech9_motion_view, only: motion_view_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion
  implicit none
  private
  public :: kinetic_energy, potential_energy

contains

  !> Kinetic energy: the sum over the bodies of half m v^2 of the centre and half omega . I omega [J].
  pure real(wp) function kinetic_energy(mechanism, plan, state) result(energy)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(state_type), intent(in) :: state           !< position and motion of the mechanism
    real(wp) :: r(3, 3), p(3), omega(3), v(3)
    integer :: i

    energy = 0.0_wp
    do i = 1, size(mechanism%bodies)
      associate (body => mechanism%bodies(i))
        if (body%link == 1) cycle
        call link_motion(plan, state, body%link, r, p, omega, v)
        v = v + cross(omega, turn(r, body%centre))
        omega = turn_back(r, omega)
        energy = energy + 0.5_wp*(body%mass*dot_product(v, v) + dot_product(omega, turn(body%inertia, omega)))
      end associate
    end do
  end function kinetic_energy

  !> Potential energy of gravity, which is zero where all centres are in the origin of link 1, and of the springs [J].
  pure real(wp) function potential_energy(mechanism, plan, state, view) result(energy)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(state_type), intent(in) :: state           !< position and motion of the mechanism
    type(motion_view_type), intent(in) :: view      !< the motion of the same state as loads read it
    real(wp) :: r(3, 3), p(3), omega(3), v(3)
    integer :: i

    energy = 0.0_wp
    do i = 1, size(mechanism%bodies)
      associate (body => mechanism%bodies(i))
        if (body%link == 1) cycle
        call link_motion(plan, state, body%link, r, p, omega, v)
        energy = energy - body%mass*dot_product(mechanism%gravity, p + turn(r, body%centre))
      end associate
    end do
    do i = 1, size(mechanism%loads)
      energy = energy + mechanism%loads(i)%load%potential(view)
    end do
  end function potential_energy
end module mech9_energy
