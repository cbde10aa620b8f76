!> Motors: their forces and the rates of their states by their formulas, with all derivatives against differences.
module test_motors
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_motor, only: motor_type, motor_motion_type, motor_action_type, motor_change_type
  use mech9_dc_motor, only: dc_motor_type
  use mech9_pid_motor, only: pid_motor_type
  use mech9_mechanism, only: mechanism_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: h = 1.0_wp/64.0_wp
  !> Formulas are of second order at most, so that differences are exact but for the round-off of rates up to some hundred, times 2/h.
  real(wp), parameter :: round_off = 1.0e-10_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('direct_current')) call direct_current(test)
    if (test%runs('without_inductance')) call without_inductance(test)
    if (test%runs('controller')) call controller(test)
    if (test%runs('at_limit')) call at_limit(test)
    if (test%runs('at_rest')) call at_rest(test)
    if (test%runs('numbers_of_dc')) call numbers_of(test, new_dc(0.05_wp), 5)
    if (test%runs('numbers_of_pid')) call numbers_of(test, new_pid(), 4)
  end subroutine run

  !> A motor whose voltage grows with time: 12 (0.5 + 0.3 t) V.
  function new_dc(inductance) result(motor)
    real(wp), intent(in) :: inductance   !< [H]
    type(dc_motor_type) :: motor
    type(polynomial_law_type) :: law

    motor = dc_motor_type(coordinate=1, voltage=12.0_wp, resistance=0.6_wp, inductance=inductance, constant=0.3_wp, &
                          gear_ratio=4.0_wp)
    law%coefficients = [0.5_wp, 0.3_wp]
    allocate (motor%law, source=law)
  end function new_dc

  !> A controller with the setpoint 0.5 + 0.3 t.
  function new_pid() result(motor)
    type(pid_motor_type) :: motor
    type(polynomial_law_type) :: law

    motor = pid_motor_type(coordinate=1, proportional=5.0_wp, integral=3.0_wp, derivative=2.0_wp, limit=4.0_wp)
    law%coefficients = [0.5_wp, 0.3_wp]
    allocate (motor%law, source=law)
  end function new_pid

  !> A controller at rest exerts a force by its integral alone, up to its limit. A mechanism has forces by its motors alone.
  subroutine at_rest(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(motor_motion_type) :: motion
    type(motor_action_type) :: action
    type(error_type), allocatable :: err
    logical :: links(2), coordinates(3)

    allocate (mechanism%loads(0), mechanism%motors(2), mechanism%stops(0))
    allocate (mechanism%motors(1)%motor, source=new_dc(0.05_wp))
    allocate (mechanism%motors(2)%motor, source=new_pid())
    mechanism%motors(2)%motor%coordinate = 3
    motion%q = 0.5_wp
    motion%dq = 0.3_wp
    associate (dc => mechanism%motors(1)%motor, pid => mechanism%motors(2)%motor)
      call test%is_true(pid%holds_setpoint() .and. .not. dc%holds_setpoint(), 'the controller rests at its setpoint only')
      motion%value = pid%state_for(-3.6_wp)
      call pid%act(motion, action, err)
      call test%no_error(err, 'a controller without deviation')
      call test%near(action%force, -3.6_wp, 4.0_wp*epsilon(1.0_wp), 'the integral exerts the force')
      call test%near(pid%excess_of(-4.75_wp), -0.75_wp, 0.0_wp, 'a force beyond the limit')
    end associate
    links = .false.
    coordinates = .false.
    call mechanism%mark_loaded_links(links)
    call mechanism%mark_loaded_coordinates(coordinates)
    call test%is_true(mechanism%has_forces() .and. size(mechanism%acting_loads()) == 0, 'motors are no loads, but have forces')
    call test%is_true(.not. any(links) .and. all(coordinates .eqv. [.true., .false., .true.]), 'they act on coordinates alone')
  end subroutine at_rest

  !> L i' = U - R i - n c dq, and the torque n c i.
  subroutine direct_current(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(motor_motion_type) :: motion
    type(motor_action_type) :: action
    type(dc_motor_type) :: motor
    type(error_type), allocatable :: err
    real(wp) :: rate

    motor = new_dc(0.05_wp)
    motion = motor_motion_type(t=2.0_wp, q=0.7_wp, dq=1.5_wp, ddq=-0.4_wp, value=3.0_wp, limited=0)
    call motor%act(motion, action, err)
    call test%no_error(err, 'the motor acts')
    call test%is_true(motor%has_state() .and. motor%has_input() .and. .not. motor%has_limit(), 'its current is a state')
    rate = (12.0_wp*1.1_wp - 0.6_wp*3.0_wp - 1.2_wp*1.5_wp)/0.05_wp
    call test%near(action%force, 1.2_wp*3.0_wp, 1.0e-15_wp, 'the torque')
    call test%near(action%rate, rate, 1.0e-14_wp, 'the rate of the current')
    call test%near(action%second, (12.0_wp*0.3_wp - 0.6_wp*rate + 1.2_wp*0.4_wp)/0.05_wp, 1.0e-14_wp, 'its second derivative')
    call check_slopes(test, motor, motion, action)
  end subroutine direct_current

  !> Without inductance the current follows at once.
  subroutine without_inductance(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(motor_motion_type) :: motion
    type(motor_action_type) :: action
    type(dc_motor_type) :: motor
    type(error_type), allocatable :: err

    motor = new_dc(0.0_wp)
    motion = motor_motion_type(t=2.0_wp, q=0.7_wp, dq=1.5_wp, limited=0)
    call motor%act(motion, action, err)
    call test%no_error(err, 'the motor acts')
    call test%is_true(.not. motor%has_state(), 'it has no state')
    call test%near(action%value, (12.0_wp*1.1_wp - 1.2_wp*1.5_wp)/0.6_wp, 1.0e-14_wp, 'the current')
    call test%near(action%force, 1.2_wp*action%value, 1.0e-14_wp, 'the torque')
    call check_slopes(test, motor, motion, action)
  end subroutine without_inductance

  !> F = P e + I s + D e' with the deviation e from the setpoint, s' = e.
  subroutine controller(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(motor_motion_type) :: motion
    type(motor_action_type) :: action
    type(pid_motor_type) :: motor
    type(error_type), allocatable :: err
    real(wp) :: e, de, demand

    motor = new_pid()
    motion = motor_motion_type(t=2.0_wp, q=0.7_wp, dq=0.5_wp, ddq=-0.4_wp, value=-0.2_wp)
    call motor%act(motion, action, err)
    call test%no_error(err, 'the controller acts')
    call test%is_true(motor%has_state() .and. motor%has_limit() .and. .not. motor%has_input(), 'its integral is a state')
    e = 1.1_wp - 0.7_wp
    de = 0.3_wp - 0.5_wp
    demand = 5.0_wp*e - 3.0_wp*0.2_wp + 2.0_wp*de
    call test%near(action%force, demand, 1.0e-15_wp, 'the force')
    call test%near(action%demand, demand/4.0_wp, 1.0e-15_wp, 'as a part of the limit')
    call test%near(action%rate, e, 1.0e-15_wp, 'the integral grows by the deviation')
    call test%near(action%second, de, 1.0e-15_wp, 'its second derivative')
    call test%near(action%demand_rate, (5.0_wp*de + 3.0_wp*e + 2.0_wp*0.4_wp)/4.0_wp, 1.0e-15_wp, 'the rate of the demand')
    call check_slopes(test, motor, motion, action)
  end subroutine controller

  !> At its limit the force is constant, and the excess of the demand leads the integral back within the tracking time, which is
  !> sqrt(P/I D/P).
  subroutine at_limit(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(motor_motion_type) :: motion
    type(motor_action_type) :: action
    type(pid_motor_type) :: motor
    type(error_type), allocatable :: err
    real(wp) :: demand

    motor = new_pid()
    motion = motor_motion_type(t=2.0_wp, q=-0.7_wp, dq=0.5_wp, ddq=-0.4_wp, value=0.3_wp)
    call motor%act(motion, action, err)
    call test%no_error(err, 'the controller acts')
    demand = 5.0_wp*1.8_wp + 3.0_wp*0.3_wp - 2.0_wp*0.2_wp
    call test%near(action%force, 4.0_wp, 0.0_wp, 'the force is at its limit')
    call test%near(action%demand, demand/4.0_wp, 1.0e-15_wp, 'more is demanded')
    call test%near(motor%tracking_time(), sqrt(2.0_wp/3.0_wp), 1.0e-15_wp, 'the tracking time')
    call test%near(action%rate, 1.8_wp - (demand - 4.0_wp)/(3.0_wp*sqrt(2.0_wp/3.0_wp)), 1.0e-14_wp, 'the integral is led back')
    call check_slopes(test, motor, motion, action)
  end subroutine at_limit

  !> Derivatives of force and rate by coordinate, rate and state, and the second derivative of the state in time.
  subroutine check_slopes(test, motor, motion, action)
    type(tester_type), intent(inout) :: test            !< counts the checks
    class(motor_type), intent(in) :: motor              !< the motor
    type(motor_motion_type), intent(in) :: motion       !< of its coordinate
    type(motor_action_type), intent(in) :: action       !< of the motor there
    type(motor_motion_type) :: moved
    type(motor_action_type) :: beside
    type(error_type), allocatable :: err
    real(wp) :: forces(-half_width:half_width), rates(-half_width:half_width), slopes(2), second, error
    integer :: i, what

    do what = 1, 4
      do i = -half_width, half_width
        moved = motion
        if (what == 1) moved%q = motion%q + 0.1_wp*i*h
        if (what == 2) moved%dq = motion%dq + 0.1_wp*i*h
        if (what == 3) moved%value = motion%value + 0.1_wp*i*h
        if (what == 4) then
          ! along the motion, with the state at its rate
          moved%t = motion%t + 0.1_wp*i*h
          moved%q = motion%q + 0.1_wp*i*h*motion%dq
          moved%dq = motion%dq + 0.1_wp*i*h*motion%ddq
          moved%value = motion%value + 0.1_wp*i*h*action%rate
        end if
        call motor%act(moved, beside, err)
        call test%no_error(err, 'the motor acts beside')
        forces(i) = beside%force
        rates(i) = beside%rate
      end do
      call derivatives_from_stencil(forces, 0.1_wp*h, slopes(1), second, error)
      call derivatives_from_stencil(rates, 0.1_wp*h, slopes(2), second, error)
      select case (what)
      case (1)
        call test%near(maxval(abs(slopes - [action%force_by_q, action%rate_by_q])), 0.0_wp, round_off, 'by the coordinate')
      case (2)
        call test%near(maxval(abs(slopes - [action%force_by_dq, action%rate_by_dq])), 0.0_wp, round_off, 'by its rate')
      case (3)
        call test%near(maxval(abs(slopes - [action%force_by_value, action%rate_by_value])), 0.0_wp, round_off, 'by the state')
      case default
        if (motor%has_state()) call test%near(slopes(2), action%second, round_off, 'the second derivative in time')
      end select
    end do
  end subroutine check_slopes

  !> Derivatives by the numbers of a motor and by those of its law, with coordinate, rate and state changing, too.
  subroutine numbers_of(test, motor, n)
    type(tester_type), intent(inout) :: test   !< counts the checks
    class(motor_type), intent(in) :: motor     !< the motor
    integer, intent(in) :: n                   !< of its numbers
    type(motor_motion_type) :: motion, moved
    type(motor_change_type) :: change
    type(motor_action_type) :: beside
    type(error_type), allocatable :: err
    class(motor_type), allocatable :: other
    real(wp) :: numbers(n + 2), forces(-half_width:half_width), rates(-half_width:half_width), slopes(2), second, error
    integer :: i, p

    motion = motor_motion_type(t=2.0_wp, q=0.7_wp, dq=0.5_wp, value=-0.2_wp, limited=0)
    moved = motor_motion_type(t=0.0_wp, q=0.3_wp, dq=-0.8_wp, value=0.6_wp, limited=0)
    do p = 1, n + 2
      ! a limit that is not reached has no effect
      if (n == 4 .and. p == 4) cycle
      numbers = 0.0_wp
      numbers(p) = 1.0_wp
      call motor%vary_act(motion, moved, numbers, change, err)
      call test%no_error(err, 'there are derivatives')
      do i = -half_width, half_width
        if (allocated(other)) deallocate (other)
        allocate (other, source=motor)
        call change_number(other, p, 0.01_wp*i*h)
        beside = motor_action_type()
        call other%act(motor_motion_type(t=motion%t, q=motion%q + 0.01_wp*i*h*moved%q, dq=motion%dq + 0.01_wp*i*h*moved%dq, &
                                         value=motion%value + 0.01_wp*i*h*moved%value, limited=0), beside, err)
        forces(i) = beside%force
        rates(i) = beside%rate
      end do
      call derivatives_from_stencil(forces, 0.01_wp*h, slopes(1), second, error)
      call derivatives_from_stencil(rates, 0.01_wp*h, slopes(2), second, error)
      ! round-off 2/(0.01 h) of rates up to some hundred, some thousand for the derivative by the inductance
      call test%near(slopes(1), change%force, 1.0e-9_wp, 'the derivative of the force')
      call test%near(slopes(2), change%rate, 1.0e-9_wp, 'the derivative of the rate')
    end do
  end subroutine numbers_of

  !> Change one of the numbers of a motor, or of its law.
  subroutine change_number(motor, p, by)
    class(motor_type), intent(inout) :: motor   !< the motor
    integer, intent(in) :: p                    !< its own numbers come first
    real(wp), intent(in) :: by                  !< the change
    integer :: own

    own = 0
    select type (motor)
    type is (dc_motor_type)
      own = 5
      if (p == 1) motor%voltage = motor%voltage + by
      if (p == 2) motor%resistance = motor%resistance + by
      if (p == 3) motor%inductance = motor%inductance + by
      if (p == 4) motor%constant = motor%constant + by
      if (p == 5) motor%gear_ratio = motor%gear_ratio + by
    type is (pid_motor_type)
      own = 4
      if (p == 1) motor%proportional = motor%proportional + by
      if (p == 2) motor%integral = motor%integral + by
      if (p == 3) motor%derivative = motor%derivative + by
    end select
    if (p <= own) return
    select type (law => motor%law)
    type is (polynomial_law_type)
      law%coefficients(p - own) = law%coefficients(p - own) + by
    end select
  end subroutine change_number
end module test_motors
