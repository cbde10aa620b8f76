!> A direct-current motor with permanent magnets.
module mech9_dc_motor
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motor, only: motor_type, motor_motion_type, motor_action_type, motor_change_type, motor_state_type
  implicit none
  private
  public :: dc_motor_type

  !> inductance di/dt = voltage - resistance i - constant gear_ratio dq/dt; the force is gear_ratio constant i.
  type, extends(motor_type) :: dc_motor_type
    real(wp) :: voltage = 0.0_wp      !< multiplied by the law of time, where there is one [V]
    real(wp) :: resistance = 1.0_wp   !< [ohm]
    real(wp) :: inductance = 0.0_wp   !< zero: the current follows at once [H]
    real(wp) :: constant = 1.0_wp     !< torque per current, and voltage per speed [N m/A = V s/rad, N/A = V s/m]
    real(wp) :: gear_ratio = 1.0_wp   !< turns of the motor per turn of the coordinate
  contains
    procedure :: act
    procedure :: vary_act
    procedure :: numbers
    procedure :: take_numbers
    procedure :: has_state
    procedure :: has_limit
    procedure :: has_input
    procedure :: kind_of_state
  end type dc_motor_type

contains

  !> The torque by the current, and the rate of the current by the voltage that is left. Fails where the voltage has no value.
  subroutine act(self, motion, action, err)
    class(dc_motor_type), intent(in) :: self             !< the motor
    type(motor_motion_type), intent(in) :: motion        !< of its coordinate, and its current
    type(motor_action_type), intent(out) :: action       !< its force, the rate of its current, and derivatives
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    real(wp) :: factor, factor_rate, unused, slope, bending, coupling

    call self%find_law(motion, factor, factor_rate, unused, slope, bending, err)
    if (allocated(err)) return
    coupling = self%gear_ratio*self%constant
    if (motion%steady .or. .not. self%has_state()) then
      action%value = (self%voltage*factor - coupling*motion%dq)/self%resistance
      action%force_by_dq = -coupling**2/self%resistance
      action%force_by_input = coupling/self%resistance
    else
      action%value = motion%value
      action%rate = (self%voltage*factor - self%resistance*motion%value - coupling*motion%dq)/self%inductance
      action%second = (self%voltage*factor_rate - self%resistance*action%rate - coupling*motion%ddq)/self%inductance
      action%force_by_value = coupling
      action%rate_by_dq = -coupling/self%inductance
      action%rate_by_value = -self%resistance/self%inductance
      action%rate_by_input = 1.0_wp/self%inductance
      action%rate_by_x = self%voltage*slope/self%inductance
    end if
    action%force = coupling*action%value
  end subroutine act

  !> Voltage, resistance, inductance, constant and gear ratio.
  pure subroutine numbers(self, values)
    class(dc_motor_type), intent(in) :: self          !< the motor
    real(wp), allocatable, intent(out) :: values(:)   !< (5) the numbers

    values = [self%voltage, self%resistance, self%inductance, self%constant, self%gear_ratio]
  end subroutine numbers

  !> Take other numbers.
  pure subroutine take_numbers(self, values, are_taken)
    class(dc_motor_type), intent(inout) :: self   !< the motor
    real(wp), intent(in) :: values(:)    !< (5) as of `numbers`
    logical, intent(out) :: are_taken    !< true

    self%voltage = values(1)
    self%resistance = values(2)
    self%inductance = values(3)
    self%constant = values(4)
    self%gear_ratio = values(5)
    are_taken = .true.
  end subroutine take_numbers

  !> The derivative of the action by a parameter. Fails where the voltage has no value.
  subroutine vary_act(self, motion, moved, numbers, change, err)
    class(dc_motor_type), intent(in) :: self             !< the motor
    type(motor_motion_type), intent(in) :: motion        !< of its coordinate, and its current
    type(motor_motion_type), intent(in) :: moved         !< derivatives of rate and current
    real(wp), intent(in) :: numbers(:)                   !< (5 and those of the law) derivatives; of size 0: all are zero
    type(motor_change_type), intent(out) :: change       !< the derivative
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(motor_action_type) :: action
    real(wp) :: changes(5), factor, factor_change, rate, second, slope, bending, coupling, coupling_change, drop_change

    call self%act(motion, action, err)
    if (.not. allocated(err)) call self%find_law(motion, factor, rate, second, slope, bending, err)
    if (.not. allocated(err)) call self%vary_law(motion, moved, numbers(min(6, size(numbers) + 1):), factor_change, rate, err)
    if (allocated(err)) return
    changes = 0.0_wp
    if (size(numbers) > 0) changes = numbers(:5)
    coupling = self%gear_ratio*self%constant
    coupling_change = changes(5)*self%constant + self%gear_ratio*changes(4)
    ! of the voltage that is left for resistance and inductance
    drop_change = changes(1)*factor + self%voltage*factor_change - coupling_change*motion%dq - coupling*moved%dq
    if (motion%steady .or. .not. self%has_state()) then
      change%value = (drop_change - changes(2)*action%value)/self%resistance
    else
      change%value = moved%value
      change%rate = (drop_change - changes(2)*motion%value - self%resistance*moved%value - changes(3)*action%rate)/self%inductance
    end if
    change%force = coupling_change*action%value + coupling*change%value
  end subroutine vary_act

  !> Whether its current has a rate.
  pure logical function has_state(self)
    class(dc_motor_type), intent(in) :: self   !< the motor

    has_state = self%inductance > 0.0_wp
  end function has_state

  !> Its current has no limit but its resistance.
  pure logical function has_limit(self)
    class(dc_motor_type), intent(in) :: self   !< the motor

    has_limit = .false.
  end function has_limit

  !> Its voltage is an input.
  pure logical function has_input(self)
    class(dc_motor_type), intent(in) :: self   !< the motor

    has_input = .true.
  end function has_input

  !> Its state is its current.
  pure function kind_of_state(self) result(kind)
    class(dc_motor_type), intent(in) :: self   !< the motor
    type(motor_state_type) :: kind

    kind = motor_state_type('current', 'current', 'A')
  end function kind_of_state
end module mech9_dc_motor
