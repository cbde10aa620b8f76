!> Motors that reach or leave the limits of their forces.
!>
!> Between two such times each motor works at one limit or at none, so that the equations of motion are smooth. After each step
!> the forces that the motors would have without limits show whether one was passed within the step; they are interpolated between
!> the ends of the step, so that a short visit is seen, too.
module mech9_limit_watch
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_hermite, only: cubic_between
  use mech9_motor, only: motor_action_type
  use mech9_event_tolerances, only: round_off_of_limit
  use mech9_motor_states, only: find_action, has_limits
  use mech9_motion_system, only: motion_system_type
  implicit none
  private
  public :: limit_watch_type, find_excess

  !> The demands on the motors at the end of the last step that was judged.
  type :: limit_watch_type
    real(wp), allocatable, private :: demand(:)   !< (motors) in parts of the limit
    real(wp), allocatable, private :: rate(:)     !< (motors) [1/s]
  contains
    procedure :: is_needed
    procedure :: note
    procedure :: find_passing
  end type limit_watch_type

  !> Points within a step at which demands are looked at; the last one is its end.
  integer, parameter :: looks = 8

contains

  !> Whether any motor of a system has a limit.
  pure logical function is_needed(self, system)
    class(limit_watch_type), intent(in) :: self      !< the watch
    type(motion_system_type), intent(in) :: system   !< the motion system

    is_needed = has_limits(system%model%mechanism)
  end function is_needed

  !> Keep the demands of the system's state, from which the next step begins.
  subroutine note(self, system, err)
    class(limit_watch_type), intent(inout) :: self      !< the watch
    type(motion_system_type), intent(in) :: system      !< the motion system, with all accelerations
    type(error_type), allocatable, intent(out) :: err   !< allocated if the law of a motor has no value

    if (.not. self%is_needed(system)) return
    call find_demands(system, self%demand, self%rate, err)
  end subroutine note

  !> The demands on all motors in the present state.
  subroutine find_demands(system, demand, rate, err)
    type(motion_system_type), intent(in) :: system        !< the motion system, with all accelerations
    real(wp), allocatable, intent(out) :: demand(:)       !< (motors) in parts of the limit
    real(wp), allocatable, intent(out) :: rate(:)         !< (motors) [1/s]
    type(error_type), allocatable, intent(out) :: err     !< allocated if the law of a motor has no value
    type(motor_action_type) :: action
    integer :: i

    allocate (demand(size(system%model%mechanism%motors)), rate(size(system%model%mechanism%motors)), source=0.0_wp)
    do i = 1, size(demand)
      call find_action(system%model%mechanism, system%plan, i, system%state, action, err)
      if (allocated(err)) return
      demand(i) = action%demand
      rate(i) = action%demand_rate
    end do
  end subroutine find_demands

  !> The motor that passes its limit first within a step, as far as interpolated demands show; 0: none does.
  subroutine find_passing(self, system, h, motor, part, err)
    class(limit_watch_type), intent(in) :: self         !< with the demands at the start of the step
    type(motion_system_type), intent(in) :: system      !< the motion system at the end of the step, with all accelerations
    real(wp), intent(in) :: h                           !< length of the step, with its sign [s]
    integer, intent(out) :: motor                       !< its number; 0: no motor passes its limit
    real(wp), intent(out) :: part                       !< part of the step after which it has passed, 0 to 1
    type(error_type), allocatable, intent(out) :: err   !< allocated if the law of a motor has no value
    real(wp), allocatable :: demand(:), rate(:)
    real(wp) :: x
    integer :: i, k

    motor = 0
    part = 1.0_wp
    call find_demands(system, demand, rate, err)
    if (allocated(err)) return
    do k = 1, looks
      x = real(k, wp)/looks
      do i = 1, size(demand)
        if (excess(system%state%limited(i), cubic_between(self%demand(i), h*self%rate(i), demand(i), h*rate(i), x)) &
            <= round_off_of_limit) cycle
        motor = i
        part = x
        return
      end do
    end do
  end subroutine find_passing

  !> How far a demand is beyond the range of the present limit: above zero where the motor should work at another one.
  pure real(wp) function excess(limited, demand)
    integer, intent(in) :: limited     !< the limit at which the motor works: -1, 0 for none, 1
    real(wp), intent(in) :: demand     !< in parts of the limit

    excess = abs(demand) - 1.0_wp
    if (limited /= 0) excess = 1.0_wp - limited*demand
  end function excess

  !> How far the demand on a motor is beyond the range of its present limit, in the state of the system.
  subroutine find_excess(system, motor, beyond, err)
    type(motion_system_type), intent(in) :: system      !< the motion system, with all rates
    integer, intent(in) :: motor                        !< number of the motor
    real(wp), intent(out) :: beyond                     !< above zero: it should work at another one
    type(error_type), allocatable, intent(out) :: err   !< allocated if the law of the motor has no value
    type(motor_action_type) :: action

    beyond = 0.0_wp
    call find_action(system%model%mechanism, system%plan, motor, system%state, action, err)
    if (.not. allocated(err)) beyond = excess(system%state%limited(motor), action%demand)
  end subroutine find_excess
end module mech9_limit_watch
