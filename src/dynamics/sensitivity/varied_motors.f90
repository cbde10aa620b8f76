!> The exact derivatives by all parameters of the motors' states, in time and as they are shown, and of their forces.
module mech9_varied_motors
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motor, only: motor_motion_type, motor_change_type
  use mech9_model, only: model_type
  use mech9_motor_states, only: motion_of_state
  use mech9_varied_motion, only: varied_motion_type
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
    integer :: i, p

    do i = 1, size(changes, 2)
      associate (motor => model%mechanism%motors(i)%motor)
        do p = 1, motion%n_parameters
          moved = motor%change_of_motion(motion%q(p, 0, :), motion%q(p, 1, :))
          moved%value = motion%motor(p, i)
          associate (part => motion%tangents(p)%motors(i), present => motion_of_state(motor, i, motion%state))
            if (part%varies) then
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
