!> Methods of integration against closed forms: orders, tolerances, and each other.
module test_integrator
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_ode_system, only: ode_system_type
  use mech9_integration_methods, only: integration_methods, runge_kutta, multistep
  use mech9_integrator, only: integrator_type, integration_statistics_type, step_tolerance_type
  use mech9_integration_problems, only: orbit_type, orbit_start, orbit_at, pendulum_type, pendulum_quarter_period, &
    swing_type, push_type, stiff_type, integrate
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks
    integer :: i

    do i = 1, size(integration_methods)
      if (test%runs(trim(integration_methods(i)%name))) call check_method(test, i)
    end do
    if (test%runs('check_agreement')) call check_agreement(test)
    if (test%runs('check_stiff')) call check_stiff(test)
  end subroutine run

  !> Check one method.
  subroutine check_method(test, i)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: i                   !< its number

    if (integration_methods(i)%family == runge_kutta) call check_order(test, i)
    call check_tolerances(test, i)
    call check_pendulum(test, i)
    call check_push(test, i)
    call check_late(test, i)
  end subroutine check_method

  !> Equal steps, halved: on an orbit of eccentricity 0.5 the error falls by 2**order. The steps are so short
  !> that the next terms are some percent, and so long that the errors (1e-12 and more) stand out of round-off.
  subroutine check_order(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: method              !< its number among all methods
    type(orbit_type), target :: orbit
    type(integration_statistics_type) :: statistics
    real(wp) :: error(2), error_there, order, h
    integer :: k, t_end, steps

    associate (m => integration_methods(method))
      h = 2.0_wp**(-6)
      if (m%order == 4) h = 2.0_wp**(-7)
      if (m%order == 8) h = 2.0_wp**(-4)
      do k = 1, 2
        error(k) = 0.0_wp
        do t_end = 1, 6   ! at one place alone an error may pass through zero
          steps = nint(t_end/h)
          call go(test, orbit, orbit_start(0.5_wp), real(t_end, wp), method, 1.0e6_wp, &
                  orbit_at(0.5_wp, real(t_end, wp)), error_there, statistics, h)
          error(k) = error(k) + error_there
          call test%is_true(statistics%steps == steps, trim(m%name)//' makes equal steps when it must')
          ! all stages of all steps but those the last one gave, and a few evaluations at the start
          call test%is_true(statistics%rate_evaluations <= steps*(m%stages - merge(1, 0, m%reuses_last)) + 4, &
                            trim(m%name)//' works out no more rates than its stages')
        end do
        h = 0.5_wp*h
      end do
      order = log(error(1)/error(2))/log(2.0_wp)
      call test%near(order/m%order, 1.0_wp, 0.1_wp, 'the order is that of the method '//m%name)
    end associate
  end subroutine check_order

  !> An orbit does not depend on the time at which it begins: from 0 and from 2**36 s, where times have five digits left behind the
  !> point, it has the same end after as many steps.
  subroutine check_late(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: method              !< its number among all methods
    real(wp) :: early(4), late(4)
    integer :: early_steps, late_steps

    associate (m => integration_methods(method))
      call orbit_from(test, m%name, 0.0_wp, early, early_steps)
      call orbit_from(test, m%name, 2.0_wp**36, late, late_steps)
      call test%is_true(maxval(abs(late - early)) <= 0.0_wp, trim(m%name)//': an orbit that begins late is the same')
      call test%is_true(late_steps == early_steps, trim(m%name)//': an orbit that begins late takes as many steps')
    end associate
  end subroutine check_late

  !> Integrate an orbit for eight seconds.
  subroutine orbit_from(test, name, start, y, steps)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: name       !< of the method
    real(wp), intent(in) :: start              !< time of the start [s]
    real(wp), intent(out) :: y(4)              !< the values at the end
    integer, intent(out) :: steps              !< number of steps
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(integration_statistics_type) :: statistics
    type(error_type), allocatable :: err
    real(wp) :: t

    t = start
    y = orbit_start(0.5_wp)
    call integrator%create(orbit, name, step_tolerance_type(1.0e-6_wp, spread(1.0e-6_wp, 1, 4)), t, y, err)
    do while (.not. allocated(err) .and. t < start + 8.0_wp)
      call integrator%step(start + 8.0_wp, t, y, err)
    end do
    call test%no_error(err, trim(name)//' makes its steps')
    call test%is_true(abs(t - (start + 8.0_wp)) <= 0.0_wp, trim(name)//' ends at its stop')
    statistics = integrator%statistics()
    steps = int(statistics%steps)
    call integrator%destroy()
  end subroutine orbit_from

  !> The error at the end of an orbit follows the tolerance, in the mean as its power one, a little unevenly where the order
  !> varies: down to 1e-12, or 1e-10 of multistep methods, whose steps are judged by a thousandth of it and less. An orbit takes
  !> ten to some thousand steps, and makes early
  !> errors some ten times larger: at 1e-12, below 2e-8.
  subroutine check_tolerances(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: method              !< its number among all methods
    type(orbit_type), target :: orbit
    type(integration_statistics_type) :: statistics
    real(wp) :: error, first_error, last_error, slope
    integer :: k, least

    associate (m => integration_methods(method))
      call go(test, orbit, orbit_start(0.5_wp), 2.0_wp*pi, method, 1.0e-4_wp, orbit_start(0.5_wp), first_error, &
              statistics)
      last_error = first_error
      least = merge(10, 12, m%family == multistep)
      do k = 6, least, 2
        call go(test, orbit, orbit_start(0.5_wp), 2.0_wp*pi, method, 10.0_wp**(-k), orbit_start(0.5_wp), error, &
                statistics)
        call test%is_true(error < 0.3_wp*last_error, &
                          m%name//': a hundredth of the tolerance makes the error much smaller')
        last_error = error
      end do
      slope = log10(first_error/last_error)/(least - 4)
      call test%is_true(slope > 0.75_wp .and. slope < 1.25_wp, m%name//': the error is proportional to the tolerance')
      call test%is_true(last_error < 2.0e-8_wp, m%name//': the error at the least tolerance is small')
    end associate
  end subroutine check_tolerances

  !> A pendulum let go at 2 radians is at the lowest point after K(sin 1), at the rate of its energy.
  subroutine check_pendulum(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: method              !< its number among all methods
    type(pendulum_type), target :: pendulum
    type(integration_statistics_type) :: statistics
    real(wp) :: error

    call go(test, pendulum, [2.0_wp, 0.0_wp], pendulum_quarter_period(2.0_wp), method, 1.0e-10_wp, &
            [0.0_wp, -2.0_wp*sin(1.0_wp)], error, statistics)
    ! some ten to some hundred steps, each with an error of the tolerance, which grow little on the way
    call test%is_true(error < 100.0e-10_wp, integration_methods(method)%name//': a quarter period of a pendulum is right')
  end subroutine check_pendulum

  !> The error estimates of some methods see less than elsewhere where time alone acts; Fehlberg's sees
  !> nothing at all, as its coefficients tell, and is told not to be used.
  subroutine check_push(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: method              !< its number among all methods
    type(push_type), target :: push
    type(integration_statistics_type) :: statistics
    real(wp) :: error

    if (integration_methods(method)%name == 'fehlberg') return
    call go(test, push, [0.0_wp, 0.0_wp], 3.0_wp, method, 1.0e-8_wp, &
            [(1.0_wp - cos(60.0_wp))/400.0_wp, sin(60.0_wp)/20.0_wp], error, statistics)
    ! some hundred steps, each with an error of the tolerance
    call test%is_true(error < 1.0e-6_wp, integration_methods(method)%name//': a force of time alone is integrated')
  end subroutine check_push

  !> Without a closed form: all methods come closer to each other as the tolerance falls.
  subroutine check_agreement(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(swing_type), target :: swing
    type(integration_statistics_type) :: statistics
    type(error_type), allocatable :: err
    real(wp) :: y(2, size(integration_methods)), spread, last_spread
    integer :: i, k

    last_spread = huge(1.0_wp)
    do k = 4, 12, 4
      do i = 1, size(integration_methods)
        y(:, i) = [1.0_wp, 0.0_wp]
        call integrate(swing, integration_methods(i)%name, 10.0_wp**(-k), 20.0_wp, y(:, i), statistics, err)
        call test%no_error(err, 'a driven pendulum is integrated by '//integration_methods(i)%name)
      end do
      spread = maxval(maxval(y, 2) - minval(y, 2))
      call test%is_true(spread < 0.01_wp*last_spread, 'the methods agree better at smaller tolerances')
      last_spread = spread
    end do
    ! some hundred steps with an error of the tolerance each
    call test%is_true(spread < 1.0e-9_wp, 'the methods agree at the tolerance 1e-12')
  end subroutine check_agreement

  !> An explicit method needs steps of some 3/stiffness, more than 30000 here. Backward differences follow
  !> the slow solution, with differences as with the system's own Jacobian.
  subroutine check_stiff(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(stiff_type), target :: stiff
    type(integration_statistics_type) :: statistics(2)
    real(wp) :: error
    integer :: i, bdf

    bdf = findloc(integration_methods%name, 'bdf', 1)
    do i = 1, 2
      stiff%has_jacobian = i == 2
      call go(test, stiff, [1.0_wp, 1.0_wp], 10.0_wp, bdf, 1.0e-8_wp, [cos(10.0_wp), cos(10.0_wp)], error, &
              statistics(i))
      call test%is_true(error < 1.0e-7_wp, 'a stiff equation is solved by backward differences')
      call test%is_true(statistics(i)%steps < 2000, 'a stiff equation does not hold backward differences up')
    end do
    call test%is_true(all(statistics%jacobian_evaluations > 0), 'Jacobians are counted, whether by differences or not')
    call test%is_true(statistics(2)%rate_evaluations < statistics(1)%rate_evaluations, &
                      'a Jacobian spares evaluations of the rate')
  end subroutine check_stiff

  !> The largest error at the end of an integration.
  subroutine go(test, system, start, t_end, method, tolerance, expected, error, statistics, equal_step)
    type(tester_type), intent(inout) :: test                       !< counts the checks
    class(ode_system_type), intent(inout), target :: system        !< system that is integrated
    real(wp), intent(in) :: start(:)                               !< vector at the start
    real(wp), intent(in) :: t_end                                  !< end of the integration [s]
    real(wp), intent(in) :: tolerance                              !< relative and absolute
    real(wp), intent(in) :: expected(:)                            !< vector at the end
    integer, intent(in) :: method                                  !< its number among all methods
    real(wp), intent(out) :: error                                 !< largest difference at the end
    type(integration_statistics_type), intent(out) :: statistics   !< work of the integrator
    real(wp), intent(in), optional :: equal_step                   !< length of all steps [s]; the integrator chooses unless given
    type(error_type), allocatable :: err
    real(wp) :: y(size(start))

    y = start
    call integrate(system, integration_methods(method)%name, tolerance, t_end, y, statistics, err, equal_step)
    call test%no_error(err, 'an equation is integrated by '//integration_methods(method)%name)
    error = maxval(abs(y - expected))
  end subroutine go
end module test_integrator
