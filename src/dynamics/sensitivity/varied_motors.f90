!> The exact derivatives by all parameters of the motors' states, in time and as they are shown, and of their forces.
module mech9_varied_motors
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motor, only: motor_motion_type, motor_change_type
  use mech9_model, only: model_type
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type, new_motion_change
  use mech9_generalized_forces, only: show_links
  use mech9_motor_states, only: motion_of_state
  use mech9_varied_motion, only: varied_motion_type, link_twists
  use mech9_varied_forces, only: show_change
  implicit none
  private
  public :: find_varied_motors

contains

  !> Find the derivatives in the present motion, after find_varied_motion for this motion. Fails where the law of a motor has no value.
  subroutine find_varied_motors(model, motion, changes, err)
    type(model_type), intent(in) :: model                      !< the model
    type(varied_motion_type), intent(in) :: motion             !< derivatives of its motion, with those of the motors' states
    type(motor_change_type), intent(out) :: changes(:, :)      !< (P,motors) of states and forces
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(motor_motion_type) :: moved
    type(motion_view_type) :: view
    type(motion_change_type) :: change
    logical :: marked(motion%plan%n_links)
    integer, allocatable :: links(:)
    real(wp), allocatable :: twists(:, :, :, :)
    integer :: i, p

    if (size(changes) == 0) return
    marked = .false.
    do i = 1, size(changes, 2)
      call model%mechanism%motors(i)%motor%mark_links(marked)
    end do
    links = pack([(i, i=2, size(marked))], marked(2:))
    associate (n => merge(motion%plan%n_links, 0, size(links) > 0), m => motion%plan%n_coordinates)
      allocate (view%links(n), view%q(m), view%dq(m))
      change = new_motion_change(n, m)
    end associate
    allocate (twists(motion%n_parameters, 6, 0:2, size(links)))
    do i = 1, size(links)
      call link_twists(motion, links(i), twists(:, :, :, i))
    end do
    call show_links(motion%plan, links, motion%state, view)
    do i = 1, size(changes, 2)
      associate (motor => model%mechanism%motors(i)%motor)
        do p = 1, motion%n_parameters
          call show_change(p, twists, motion, links, view, change)
          moved = motor%change_of_motion(view, change)
          associate (part => motion%tangents(p)%motors(i), present => motion_of_state(motor, motion%plan, i, motion%state))
            if (part%varies) then
              call motor%add_shift(view, part%change, moved)
              call motor%vary_act(present, moved, part%change, changes(p, i), err)
            else
              call motor%vary_act(present, moved, [real(wp) ::], changes(p, i), err)
            end if
          end associate
          if (allocated(err)) return
        end do
      end associate
    end do
  end subroutine find_varied_motors
end module mech9_varied_motors
