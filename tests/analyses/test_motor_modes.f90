!> Modes of mechanisms with motors: roots against characteristic polynomials, stability of a controlled pendulum against Routh's
!> criterion, and setpoints that an integral part holds.
module test_motor_modes
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_assembly
  use mech9_text, only: to_text
  use mech9_random, only: random_type
  use mech9_eigenmodes, only: eigenmodes_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_motor_modes, only: find_motor_modes
  use mech9_resting_motors, only: motor_coupling_type, couple_motors
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_equilibria, only: find_equilibrium
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Moment of inertia, and weight times length, of the pendulum.
  real(wp), parameter :: inertia = 2.0_wp*0.8_wp**2, weight = 2.0_wp*9.81_wp*0.8_wp
  character(len=*), parameter :: pendulum = '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&body link=2, mass=2, centre=0,-0.8,0 / &gravity acceleration=0,-9.81,0 / '

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('one_coordinate')) call one_coordinate(tester)
    if (tester%runs('several_coordinates')) call several_coordinates(tester)
    if (tester%runs('idle_motor')) call idle_motor(tester)
    if (tester%runs('free_rotor')) call free_rotor(tester)
    if (tester%runs('direct_current')) call direct_current(tester)
    if (tester%runs('setpoint')) call setpoint(tester)
    if (tester%runs('limit')) call limit(tester)
  end subroutine run

  !> One coordinate and one state: (r^2 + c r + k)(r - s) = g (q + f r).
  subroutine one_coordinate(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(eigenmodes_type) :: modes
    type(random_type) :: random
    real(wp) :: k, c, g, q, f, s
    complex(wp) :: r
    integer :: trial, i, roots

    do trial = 1, 20
      k = random%symmetric() + 2.0_wp
      c = random%symmetric() + 1.0_wp
      g = random%symmetric()
      q = random%symmetric()
      f = random%symmetric()
      s = -1.0_wp + 0.5_wp*random%symmetric()
      call find_motor_modes(reshape([k], [1, 1]), reshape([c], [1, 1]), reshape([g], [1, 1]), reshape([q], [1, 1]), &
                            reshape([f], [1, 1]), [s], modes)
      roots = 0
      do i = 1, modes%count
        r = modes%roots(i)
        roots = roots + merge(2, 1, aimag(r) > 0.0_wp)
        ! eigenvalues of a matrix of three rows of order one
        call tester%near(abs((r**2 + c*r + k)*(r - s) - g*(q + f*r)), 0.0_wp, 1.0e-12_wp, 'a root of the characteristic polynomial')
      end do
      call tester%is_true(roots == 3, 'three states have three roots')
      call tester%near(modes%growth, maxval(real(modes%roots(:modes%count), wp)), 0.0_wp, 'growth is the largest real part')
    end do
  end subroutine one_coordinate

  !> Each shape x satisfies (r^2 + r C + K) x = G (r - S)^-1 (Q + r R) x, and the sum of all roots is the trace -tr C + tr S.
  subroutine several_coordinates(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 3, states = 2
    type(eigenmodes_type) :: modes
    type(random_type) :: random
    real(wp) :: k(n, n), c(n, n), g(n, states), q(states, n), f(states, n), s(states), trace
    complex(wp) :: left(n), right(states)
    integer :: trial, i, j

    do trial = 1, 20
      call fill(random, k)
      call fill(random, c)
      call fill(random, g)
      call fill(random, q)
      call fill(random, f)
      do i = 1, states
        s(i) = random%symmetric() - 2.0_wp
      end do
      call find_motor_modes(k, c, g, q, f, s, modes)
      trace = sum(s)
      do i = 1, n
        trace = trace - c(i, i)
      end do
      do i = 1, modes%count
        associate (r => modes%roots(i), x => modes%shapes(:, i))
          trace = trace - merge(2.0_wp, 1.0_wp, aimag(r) > 0.0_wp)*real(r, wp)
          left = r**2*x + r*matmul(c, x) + matmul(k, x)
          right = matmul(q + (0.0_wp, 0.0_wp), x) + r*matmul(f, x)
          do j = 1, states
            right(j) = right(j)/(r - s(j))
          end do
          ! a shape is a null vector to the accuracy of its root, some 1e-14 of order one
          call tester%near(maxval(abs(left - matmul(g, right))), 0.0_wp, 1.0e-11_wp, 'a shape satisfies the equations')
          call tester%near(norm2(abs(x)), 1.0_wp, 1.0e-12_wp, 'it is of length one')
        end associate
      end do
      call tester%near(trace, 0.0_wp, 1.0e-11_wp, 'the sum of the roots is the trace of the system')
    end do
  end subroutine several_coordinates

  !> Numbers between -1 and 1 at random.
  subroutine fill(random, matrix)
    type(random_type), intent(inout) :: random   !< source of the numbers
    real(wp), intent(out) :: matrix(:, :)        !< gets them
    integer :: i, j

    do j = 1, size(matrix, 2)
      do i = 1, size(matrix, 1)
        matrix(i, j) = random%symmetric()
      end do
    end do
  end subroutine fill

  !> A motor that neither feels nor moves the mechanism has a root of its own, which moves nothing.
  subroutine idle_motor(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(eigenmodes_type) :: modes
    real(wp), parameter :: none(1, 1) = 0.0_wp
    integer :: i

    call find_motor_modes(reshape([4.0_wp], [1, 1]), none, none, none, none, [-3.0_wp], modes)
    call tester%is_true(modes%count == 2, 'a vibration, and the root of the motor')
    do i = 1, modes%count
      associate (r => modes%roots(i))
        if (aimag(r) > 0.0_wp) then
          call tester%near(abs(r - (0.0_wp, 2.0_wp)), 0.0_wp, 1.0e-14_wp, 'the vibration is that of the mechanism')
        else
          call tester%near(abs(r + 3.0_wp), 0.0_wp, 1.0e-14_wp, 'the root of the motor')
          call tester%near(abs(modes%shapes(1, i)), 0.0_wp, 0.0_wp, 'nothing moves')
        end if
      end associate
    end do
  end subroutine idle_motor

  !> Without stiffness the angle of a rotor is free: a root is zero, and stays so beside the motor's roots.
  subroutine free_rotor(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(eigenmodes_type) :: modes
    real(wp), parameter :: none(1, 1) = 0.0_wp
    integer :: i

    ! the torque 5 i, the current i' = -3 i - 2 r x: r (r (r + 3) + 10) = 0
    call find_motor_modes(none, none, reshape([5.0_wp], [1, 1]), none, reshape([-2.0_wp], [1, 1]), [-3.0_wp], modes)
    call tester%is_true(count(abs(modes%roots(:modes%count)) <= 0.0_wp) == 1, 'one root is zero')
    do i = 1, modes%count
      associate (r => modes%roots(i))
        call tester%near(abs(r*(r*(r + 3.0_wp) + 10.0_wp)), 0.0_wp, 1.0e-12_wp, 'a root of the characteristic polynomial')
      end associate
    end do
  end subroutine free_rotor

  !> The equilibrium of a mechanism from its text.
  subroutine rest(tester, text, model, found, err)
    type(tester_type), intent(inout) :: tester          !< counts the checks
    character(len=*), intent(in) :: text                !< of a data file
    type(model_type), intent(out) :: model              !< the model
    type(equilibrium_type), intent(out) :: found        !< its equilibrium
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none
    type(plan_type) :: plan
    type(state_type) :: state

    call model_from_text(tester, text, dynamics, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=.true.))
    if (.not. allocated(err)) call find_equilibrium(model%mechanism, model%problem%partition, plan, state, found, err)
  end subroutine rest

  !> A motor with inductance L at voltage zero: (J r^2 + m g l)(L r + R) + c^2 r = 0 with the constant c, which counts the gear twice.
  subroutine direct_current(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(equilibrium_type) :: found
    type(motor_coupling_type) :: coupling
    type(error_type), allocatable :: err
    real(wp), parameter :: c = 0.3_wp*4.0_wp, resistance = 0.6_wp, inductance = 0.05_wp
    integer :: i

    call rest(tester, pendulum//'&motor coordinate=1, kind=''dc'', voltage=0, resistance=0.6, inductance=0.05, constant=0.3, '// &
              'gear_ratio=4 /', model, found, err)
    call tester%no_error(err, 'a pendulum with a motor hangs')
    if (allocated(err)) return
    call tester%is_true(found%is_stable, 'it is stable')
    do i = 1, found%modes%count
      associate (r => found%modes%roots(i))
        call tester%near(abs((inertia*r**2 + weight)*(inductance*r + resistance) + c**2*r)/weight, 0.0_wp, 1.0e-11_wp, &
                         'a root of the motor and the pendulum')
      end associate
    end do
    call couple_motors(model%mechanism, found%resting, coupling, err)
    call tester%no_error(err, 'the motor is coupled')
    call tester%near(coupling%force_by_state(1, 1), c, 1.0e-14_wp, 'the torque is the constant times the current')
    call tester%near(coupling%rate_by_dq(1, 1), -c/inductance, 1.0e-13_wp, 'the voltage of the rotation')
    call tester%near(coupling%rate_by_state(1), -resistance/inductance, 1.0e-13_wp, 'the voltage of the resistance')
    call tester%near(coupling%rate_by_input(1, 1), 1.0_wp/inductance, 1.0e-13_wp, 'the voltage of the source')
    call tester%near(coupling%rate_by_q(1, 1), 0.0_wp, 0.0_wp, 'the position has no voltage')
  end subroutine direct_current

  !> A controller with an integral part holds the pendulum at its setpoint q. The polynomial is
  !> J r^3 + D r^2 + (m g l cos q + P) r + I, whose roots are stable where D (m g l cos q + P) > J I (Routh).
  subroutine setpoint(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(equilibrium_type) :: found
    type(error_type), allocatable :: err
    real(wp), parameter :: q = 0.4_wp, p = 5.0_wp, d = 2.0_wp
    real(wp) :: least, integral
    integer :: i, side

    least = d*(weight*cos(q) + p)/inertia
    do side = -1, 1, 2
      integral = least*(1.0_wp + 0.01_wp*side)
      call rest(tester, pendulum//'&motor coordinate=1, kind=''pid'', setpoint=0.4, proportional=5, derivative=2, integral='// &
                to_text(integral, 17)//' /', model, found, err)
      call tester%no_error(err, 'a pendulum is held')
      if (allocated(err)) return
      call tester%near(found%resting%state%q(1), q, 1.0e-12_wp, 'it is held at its setpoint')
      call tester%near(found%stiffness(1, 1), weight*cos(q) + p, 1.0e-10_wp, 'stiffness of weight and controller')
      call tester%near(found%damping(1, 1), d, 1.0e-12_wp, 'damping of the controller')
      do i = 1, found%modes%count
        associate (r => found%modes%roots(i))
          call tester%near(abs(inertia*r**3 + d*r**2 + (weight*cos(q) + p)*r + integral)/weight, 0.0_wp, 1.0e-11_wp, &
                           'a root of pendulum and controller')
        end associate
      end do
      call tester%is_true(found%is_stable .eqv. side < 0, 'it is stable by Routh''s criterion')
    end do
  end subroutine setpoint

  !> A controller whose force has a limit below the torque of the weight, m g l sin q, does not hold its setpoint.
  subroutine limit(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(equilibrium_type) :: found
    type(error_type), allocatable :: err
    character(len=*), parameter :: held = &
      '&motor coordinate=1, kind=''pid'', setpoint=1, proportional=5, derivative=2, integral=1, '

    call rest(tester, pendulum//held//'limit='//to_text(1.01_wp*weight*sin(1.0_wp))//' /', model, found, err)
    call tester%no_error(err, 'a force above the torque of the weight holds')
    call rest(tester, pendulum//held//'limit='//to_text(0.99_wp*weight*sin(1.0_wp))//' /', model, found, err)
    call tester%has_error(err, exit_assembly, 'a force below the torque of the weight does not')
  end subroutine limit
end module test_motor_modes
