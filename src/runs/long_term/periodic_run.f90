!> The run that records one period of a periodic motion.
module mech9_periodic_run
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motor_states, only: start_motors
  use mech9_model, only: model_type
  use mech9_model_motion, only: model_motion_type
  use mech9_periodic_motion, only: periodic_motion_type
  implicit none
  private
  public :: take_periodic, start_periodic

  !> The least tolerance of a run over a motion from which its neighbours part.
  real(wp), parameter :: least_tolerance = 1.0e-13_wp

contains

  !> Let a model record one period of a motion: its times, and the values at its start.
  subroutine take_periodic(motion, model)
    type(periodic_motion_type), intent(in) :: motion    !< the motion
    type(model_type), intent(inout) :: model            !< gets them

    model%request%time%end = model%request%time%start + motion%period
    ! errors of steps grow within the period
    associate (solver => model%request%solver)
      solver%relative_tolerance = min(solver%relative_tolerance, max(least_tolerance, solver%relative_tolerance/motion%growth))
      solver%absolute_tolerance = min(solver%absolute_tolerance, max(least_tolerance, solver%absolute_tolerance/motion%growth))
    end associate
    associate (initial => model%problem%initial)
      initial%position = motion%q
      initial%velocity = motion%dq
      initial%position_given = .true.
      initial%velocity_given = .true.
    end associate
  end subroutine take_periodic

  !> Let an assembled run begin with the states that motors have in the motion.
  subroutine start_periodic(motion, model, run, err)
    type(periodic_motion_type), intent(in) :: motion    !< the motion
    type(model_type), intent(in) :: model               !< of the run
    type(model_motion_type), intent(inout) :: run       !< assembled with its values, not yet prepared
    type(error_type), allocatable, intent(out) :: err   !< allocated if the law of a motor has no value

    if (size(motion%motor) == 0) return
    call start_motors(model%mechanism, run%start)
    run%start%motor = motion%motor
  end subroutine start_periodic
end module mech9_periodic_run
