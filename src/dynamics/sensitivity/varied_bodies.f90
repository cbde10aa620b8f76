!> The bodies of a motion in their present positions, and the changes of their inertia by a parameter.
module mech9_varied_bodies
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, cross, combine
  use mech9_inertia, only: inertia_in_axes
  use mech9_model, only: model_type
  use mech9_parameter_twists, only: inertia_type
  use mech9_varied_motion, only: varied_motion_type
  implicit none
  private
  public :: place_body, change_of_body, change_of_momentum

contains

  !> The inertia of a body in its present position.
  subroutine place_body(model, number, motion, r, body)
    type(model_type), intent(in) :: model               !< the model
    integer, intent(in) :: number                       !< of the body
    type(varied_motion_type), intent(in) :: motion      !< with the present motion
    real(wp), intent(out) :: r(3, 3)                    !< rotation of its link
    type(inertia_type), intent(out) :: body             !< the inertia
    integer :: f

    associate (given => model%mechanism%bodies(number), plan => motion%plan, state => motion%state)
      f = plan%frame_of(given%link)
      r = combine(state%r(:, :, f), plan%link_in_frame(given%link)%r)
      body%mass = given%mass
      body%centre = state%p(:, f) + turn(state%r(:, :, f), plan%link_in_frame(given%link)%p) + turn(r, given%centre)
      body%tensor = inertia_in_axes(r, given%inertia)
    end associate
  end subroutine place_body

  !> The change of a body's inertia in fixed axes, with its link held.
  pure function change_of_body(change, r) result(changed)
    real(wp), intent(in) :: change(:)            !< (13) of mass, centre and inertia, in the link's axes
    real(wp), intent(in) :: r(3, 3)              !< rotation of the link
    type(inertia_type) :: changed
    real(wp) :: tensor(3, 3)

    tensor = reshape(change(5:13), [3, 3])
    changed%mass = change(1)
    changed%centre = turn(r, change(2:4))
    changed%tensor = inertia_in_axes(r, tensor)
  end function change_of_body

  !> The change of a momentum with the inertia.
  pure function change_of_momentum(body, changed, twist) result(h)
    type(inertia_type), intent(in) :: body      !< the body
    type(inertia_type), intent(in) :: changed   !< the change of its inertia
    real(wp), intent(in) :: twist(6)            !< of the body
    real(wp) :: h(6), p(3)

    p = body%mass*(twist(4:6) + cross(twist(1:3), body%centre))
    h(4:6) = changed%mass*(twist(4:6) + cross(twist(1:3), body%centre)) + body%mass*cross(twist(1:3), changed%centre)
    h(1:3) = turn(changed%tensor, twist(1:3)) + cross(changed%centre, p) + cross(body%centre, h(4:6))
  end function change_of_momentum
end module mech9_varied_bodies
