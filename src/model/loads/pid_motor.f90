!> A motor whose force a PID controller sets.
!>
!> While the force is at its limit, the integral is led back (back-calculation, Astrom and Hagglund in
!> docs/reference/bibliography.md): the excess of the force without limit decays within the tracking time. Its rate has a kink at
!> the limit and no jump, so that the motion is unique and never slides along the limit.
module mech9_pid_motor
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: unlocked
  use mech9_motor, only: motor_type, motor_motion_type, motor_action_type, motor_change_type, motor_state_type
  implicit none
  private
  public :: pid_motor_type

  !> The deviation is e = setpoint - q; the force is proportional e + integral (time integral of e) + derivative de/dt, within
  !> the limit. The law of the motor is its setpoint.
  type, extends(motor_type) :: pid_motor_type
    real(wp) :: proportional = 0.0_wp   !< [N m/rad, N/m]
    real(wp) :: integral = 0.0_wp       !< [N m/(rad s), N/(m s)]
    real(wp) :: derivative = 0.0_wp     !< [N m s/rad, N s/m]
    real(wp) :: limit = huge(1.0_wp)    !< largest magnitude of the force; huge: none [N m, N]
  contains
    procedure :: act
    procedure :: vary_act
    procedure :: numbers
    procedure :: has_state
    procedure :: has_limit
    procedure :: has_input
    procedure :: kind_of_state
    procedure :: holds_setpoint => has_state
    procedure :: state_for
    procedure :: excess_of
    procedure :: tracking_time
  end type pid_motor_type

contains

  !> The force by the deviation, its integral and its rate. Fails where the setpoint has no value.
  subroutine act(self, motion, action, err)
    class(pid_motor_type), intent(in) :: self            !< the controller
    type(motor_motion_type), intent(in) :: motion        !< of its coordinate, and the integral of its deviation
    type(motor_action_type), intent(out) :: action       !< its force, the rate of the integral, and derivatives
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    real(wp) :: e, de, dde, slope, bending, demand, demand_rate
    integer :: limited

    call self%find_law(motion, e, de, dde, slope, bending, err)
    if (allocated(err)) return
    e = e - motion%q
    de = de - motion%dq
    dde = dde - motion%ddq
    if (self%has_state() .and. .not. motion%steady) action%value = motion%value
    demand = self%proportional*e + self%integral*action%value + self%derivative*de
    limited = motion%limited
    if (limited == unlocked) limited = limit_of(demand, self%limit)
    if (limited == 0) then
      action%force = demand
      action%force_by_q = -self%proportional
      action%force_by_dq = -self%derivative
      action%force_by_value = self%integral
    else
      action%force = limited*self%limit
    end if
    if (self%has_state()) then
      action%rate = e
      action%rate_by_q = -1.0_wp
      if (limited /= 0) call lead_back()
      ! the setpoint counts in the deviation against the coordinate
      action%rate_by_x = -action%rate_by_q*slope - action%rate_by_dq*bending*motion%dx
      action%rate_by_dx = -action%rate_by_dq*slope
    end if
    demand_rate = self%proportional*de + self%integral*action%rate + self%derivative*dde
    if (self%has_state()) then
      action%second = de
      if (limited /= 0) action%second = de - demand_rate/(self%integral*self%tracking_time())
    end if
    if (.not. self%has_limit()) return
    action%demand = demand/self%limit
    action%demand_rate = demand_rate/self%limit
  contains
    !> Let the excess of the demand reduce the integral.
    subroutine lead_back()
      real(wp) :: per_excess

      per_excess = 1.0_wp/(self%integral*self%tracking_time())
      action%rate = e - (demand - limited*self%limit)*per_excess
      action%rate_by_q = -1.0_wp + self%proportional*per_excess
      action%rate_by_dq = self%derivative*per_excess
      action%rate_by_value = -self%integral*per_excess
    end subroutine lead_back
  end subroutine act

  !> Proportional, integral and derivative part, and the limit: 0 for none.
  pure subroutine numbers(self, values)
    class(pid_motor_type), intent(in) :: self         !< the controller
    real(wp), allocatable, intent(out) :: values(:)   !< (4) the numbers

    values = [self%proportional, self%integral, self%derivative, merge(self%limit, 0.0_wp, self%has_limit())]
  end subroutine numbers

  !> The derivative of the action by a parameter. Fails where the setpoint has no value.
  subroutine vary_act(self, motion, moved, numbers, change, err)
    class(pid_motor_type), intent(in) :: self            !< the controller
    type(motor_motion_type), intent(in) :: motion        !< of its coordinate, and the integral of its deviation
    type(motor_motion_type), intent(in) :: moved         !< derivatives of coordinate, rate and integral
    real(wp), intent(in) :: numbers(:)                   !< (4 and those of the law) derivatives; of size 0: all are zero
    type(motor_change_type), intent(out) :: change       !< the derivative
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(motor_action_type) :: action
    real(wp) :: changes(4), e, de, e_change, de_change, unused, slope, bending, demand, demand_change, excess, per_excess
    integer :: limited

    call self%act(motion, action, err)
    if (.not. allocated(err)) call self%find_law(motion, e, de, unused, slope, bending, err)
    if (.not. allocated(err)) call self%vary_law(motion, moved, numbers(min(5, size(numbers) + 1):), e_change, de_change, err)
    if (allocated(err)) return
    changes = 0.0_wp
    if (size(numbers) > 0) changes = numbers(:4)
    e = e - motion%q
    de = de - motion%dq
    e_change = e_change - moved%q
    de_change = de_change - moved%dq
    if (self%has_state() .and. .not. motion%steady) change%value = moved%value
    demand = self%proportional*e + self%integral*action%value + self%derivative*de
    demand_change = changes(1)*e + changes(2)*action%value + changes(3)*de &
                    + self%proportional*e_change + self%integral*change%value + self%derivative*de_change
    limited = motion%limited
    if (limited == unlocked) limited = limit_of(demand, self%limit)
    change%force = demand_change
    if (limited /= 0) change%force = limited*changes(4)
    if (.not. self%has_state()) return
    change%rate = e_change
    if (limited == 0) return
    excess = demand - limited*self%limit
    per_excess = 1.0_wp/(self%integral*self%tracking_time())
    change%rate = e_change - (demand_change - limited*changes(4))*per_excess + excess*per_excess*relative_change(self, changes)
  end subroutine vary_act

  !> The derivative of the logarithm of the integral part times the tracking time: of the proportional part, or of the square root of
  !> the integral part times the derivative part.
  pure real(wp) function relative_change(self, changes)
    class(pid_motor_type), intent(in) :: self   !< the controller, with an integral part
    real(wp), intent(in) :: changes(4)          !< derivatives of its numbers

    if (self%derivative > 0.0_wp) then
      relative_change = 0.5_wp*(changes(2)/self%integral + changes(3)/self%derivative)
    else
      relative_change = changes(1)/self%proportional
    end if
  end function relative_change

  !> The limit that a demand exceeds.
  pure integer function limit_of(demand, limit)
    real(wp), intent(in) :: demand   !< force without limit [N m, N]
    real(wp), intent(in) :: limit    !< of its magnitude [N m, N]

    limit_of = 0
    if (abs(demand) > limit) limit_of = nint(sign(1.0_wp, demand))
  end function limit_of

  !> Time in which the integral is led back at the limit: the square root of the product of integral time proportional/integral
  !> and derivative time derivative/proportional; without a derivative part the integral time [s].
  pure real(wp) function tracking_time(self)
    class(pid_motor_type), intent(in) :: self   !< the controller, with an integral part

    tracking_time = self%proportional/self%integral
    if (self%derivative > 0.0_wp) tracking_time = sqrt(self%derivative/self%integral)
  end function tracking_time

  !> Whether it has an integral part.
  pure logical function has_state(self)
    class(pid_motor_type), intent(in) :: self   !< the controller

    has_state = self%integral > 0.0_wp
  end function has_state

  !> Whether its force has a limit.
  pure logical function has_limit(self)
    class(pid_motor_type), intent(in) :: self   !< the controller

    has_limit = self%limit < huge(self%limit)
  end function has_limit

  !> It has no voltage.
  pure logical function has_input(self)
    class(pid_motor_type), intent(in) :: self   !< the controller

    has_input = .false.
  end function has_input

  !> Its state is the integral of its deviation.
  pure function kind_of_state(self) result(kind)
    class(pid_motor_type), intent(in) :: self   !< the controller
    type(motor_state_type) :: kind

    kind = motor_state_type('integral', 'time integral of the deviation', 's', by_coordinate=.true.)
  end function kind_of_state

  !> The integral that exerts a force without deviation.
  pure real(wp) function state_for(self, force) result(value)
    class(pid_motor_type), intent(in) :: self   !< the controller, with an integral part
    real(wp), intent(in) :: force               !< on the coordinate [N m, N]

    value = force/self%integral
  end function state_for

  !> How far a force is beyond the limit, with its sign [N m, N].
  pure real(wp) function excess_of(self, force) result(excess)
    class(pid_motor_type), intent(in) :: self   !< the controller, with a limit
    real(wp), intent(in) :: force               !< on the coordinate, beyond the limit [N m, N]

    excess = force - sign(self%limit, force)
  end function excess_of
end module mech9_pid_motor
