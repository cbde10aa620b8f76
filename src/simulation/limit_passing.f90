!> The time within a step at which a motor passes the limit of its force. The motion goes back to the start of the step and
!> stops there, as at a joint of a law of time.
module mech9_limit_passing
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_limit_watch, only: find_excess
  use mech9_integrated_motion, only: integrated_motion_type
  implicit none
  private
  public :: stop_at_limits

  !> Trials of the search for the time.
  integer, parameter :: most_trials = 100

contains

  !> Judge the last step: where a motor passed its limit within it, the motion is at the start of the step afterwards, and a stop
  !> lies at the passing.
  subroutine stop_at_limits(motion, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: from, part, t, y(size(motion%y))
    integer :: motor
    logical :: passed

    if (.not. motion%limits%is_needed(motion%system)) return
    call motion%system%move_to(motion%t, motion%y, err)
    if (allocated(err) .or. motion%system%interval%is_end(motion%t)) return
    call motion%dense_output%start_of_step(from, y)
    call motion%limits%find_passing(motion%system, motion%t - from, motor, part, err)
    if (allocated(err)) return
    passed = motor > 0
    if (passed) call locate(motion, motor, from, part, t, passed, err)
    if (allocated(err)) return
    if (passed) then
      call motion%step_back(t, err)
      call motion%system%interval%end_at_limit(t, motor)
    else
      if (motor > 0) call motion%system%move_to(motion%t, motion%y, err)
      if (.not. allocated(err)) call motion%limits%note(motion%system, err)
    end if
  end subroutine stop_at_limits

  !> Find the time at which a motor passes its limit, by false position with halved values (Illinois) on the motion within the step.
  subroutine locate(motion, motor, from, part, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: motor                            !< number of the motor
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(in) :: part                            !< part of the step after which the limit is passed, by interpolation
    real(wp), intent(out) :: t                              !< time of the passing [s]
    logical, intent(out) :: passed                          !< the motion itself passes the limit
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: a, b, value_a, value_b, value
    integer :: trial, side

    a = from
    b = motion%t
    if (part < 1.0_wp) b = from + part*(motion%t - from)
    t = b
    call excess_at(motion, motor, b, value_b, err)
    if (.not. allocated(err) .and. part < 1.0_wp .and. .not. value_b > 0.0_wp) then
      b = motion%t
      call excess_at(motion, motor, b, value_b, err)
    end if
    passed = value_b > 0.0_wp
    if (.not. passed .or. allocated(err)) return
    call excess_at(motion, motor, a, value_a, err)
    if (allocated(err)) return
    t = a
    side = 0
    do trial = 1, most_trials
      if (value_a >= 0.0_wp .or. abs(b - a) <= 4.0_wp*spacing(b)) exit
      t = b - value_b*(b - a)/(value_b - value_a)
      if (.not. (t - a)*(b - t) > 0.0_wp) exit
      call excess_at(motion, motor, t, value, err)
      if (allocated(err) .or. abs(value) <= epsilon(value)) return
      if (value > 0.0_wp) then
        b = t
        value_b = value
        if (side > 0) value_a = 0.5_wp*value_a
        side = 1
      else
        a = t
        value_a = value
        if (side < 0) value_b = 0.5_wp*value_b
        side = -1
      end if
    end do
  end subroutine locate

  !> How far the demand on a motor is beyond the range of its limit, at a time within the last step. Where the motion there cannot
  !> be found, it is that of the end of the step.
  subroutine excess_at(motion, motor, t, value, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: motor                            !< number of the motor
    real(wp), intent(in) :: t                               !< time within the step [s]
    real(wp), intent(out) :: value                          !< in parts of the limit
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: from, y(size(motion%y))
    logical :: found

    call motion%dense_output%start_of_step(from, y)
    found = .false.
    if (.not. abs(t - from) > 0.0_wp) then
      call motion%system%move_to(from, y, err)
      found = .true.
    else if (abs(t - motion%t) > 0.0_wp) then
      call motion%look_between(t, found)
    end if
    if (.not. found) call motion%system%move_to(motion%t, motion%y, err)
    if (.not. allocated(err)) call find_excess(motion%system, motor, value, err)
  end subroutine excess_at
end module mech9_limit_passing
