!> Steps of an integration: stops met exactly, settling and corrections, restarts, limits, no memory per step.
!>
!> Compares the program with itself in part: integrations alone and side by side; orbits have closed forms.
module test_integrator_steps
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_integration_methods, only: integration_methods
  use mech9_integrator, only: integrator_type, integration_statistics_type, step_tolerance_type
  use mech9_integration_problems, only: orbit_type, orbit_start, orbit_at, power_type, rotation_type, stiff_type, &
    integrate
  use mech9_testing, only: tester_type
  use mech9_counted_memory, only: calls
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks
    integer :: i

    do i = 1, size(integration_methods)
      if (test%runs(trim(integration_methods(i)%name))) call check_method(test, i, trim(integration_methods(i)%name))
    end do
    if (test%runs('first_choice_dormand-prince')) call check_first_choice(test, 'dormand-prince', 4)
    if (test%runs('first_choice_verner')) call check_first_choice(test, 'verner', 5)
    if (test%runs('first_choice_prince-dormand')) call check_first_choice(test, 'prince-dormand', 7)
    if (test%runs('check_side_by_side')) call check_side_by_side(test)
  end subroutine run

  !> Check one method.
  subroutine check_method(test, i, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: i                   !< number of the method
    character(len=*), intent(in) :: name       !< its name

    call check_stops(test, name)
    call check_inside_steps(test, name)
    call check_short_rest(test, name)
    call check_turning_back(test, name)
    call check_settling(test, i)
    call check_corrections(test, i)
    call check_restart(test, name)
    call check_limits(test, name)
    call check_memory(test, name)
  end subroutine check_method

  !> Stops at numbers that are no sums of steps are met to the last bit, forward and backward; on the way
  !> no step passes one. The solution is as good as without them.
  subroutine check_stops(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: y(4), t, t_stop, direction
    integer :: i, k
    logical :: passed

    do k = 1, 2
      direction = merge(1.0_wp, -1.0_wp, k == 1)
      t = 0.3_wp
      y = orbit_at(0.5_wp, t)
      call integrator%create(orbit, method, step_tolerance_type(1.0e-9_wp, spread(1.0e-9_wp, 1, 4)), t, y, err)
      call test%no_error(err, 'an integration is created')
      passed = .false.
      do i = 1, 50
        t_stop = 0.3_wp + direction*(i/7.0_wp + 0.01_wp*sin(9.0_wp*i))
        do while (abs(t - t_stop) > 0.0_wp)
          call integrator%step(t_stop, t, y, err)
          if (allocated(err)) exit
          passed = passed .or. (t - t_stop)*direction > 0.0_wp
        end do
        call test%no_error(err, method//' reaches a stop exactly')
      end do
      call test%is_true(.not. passed, method//' never passes a stop')
      ! an orbit and some, early errors grow some ten times; the multistep methods make ten times larger ones
      call test%near(maxval(abs(y - orbit_at(0.5_wp, t))), 0.0_wp, 1.0e-5_wp, method//' is accurate at stops')
      call integrator%destroy()
    end do
  end subroutine check_stops

  !> Steps may pass a stop, up to where they are told. The values that a method gives inside a step are as good as the
  !> ends of the step, but for ten times the error that a step may make, relative and absolute.
  subroutine check_inside_steps(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp), parameter :: tolerance = 1.0e-8_wp
    real(wp) :: y(4), inside(4), t, t_before, error, error_before, worst
    logical :: found, passed
    integer :: i

    t = 0.0_wp
    y = orbit_at(0.5_wp, t)
    call integrator%create(orbit, method, step_tolerance_type(tolerance, spread(tolerance, 1, 4)), t, y, err)
    call test%no_error(err, 'an integration is created')
    passed = .false.
    worst = 0.0_wp
    error = 0.0_wp
    do while (t < 6.0_wp .and. .not. allocated(err))
      t_before = t
      error_before = error
      call integrator%step(t + 1.0e-9_wp, t, y, err, farthest=10.0_wp)
      passed = passed .or. t > t_before + 1.0e-3_wp
      error = maxval(abs(y - orbit_at(0.5_wp, t)))
      do i = 1, 4
        call integrator%interpolate(t - 0.2_wp*i*(t - t_before), inside, found)
        if (.not. found) exit
        worst = max(worst, maxval(abs(inside - orbit_at(0.5_wp, t - 0.2_wp*i*(t - t_before)))) - max(error, error_before))
      end do
    end do
    call test%no_error(err, method//' steps beyond a stop')
    call test%is_true(passed, method//' passes a stop where it may')
    call test%is_true(found .eqv. (method == 'adams' .or. method == 'bdf'), method//' tells what is inside steps or does not')
    call test%near(max(worst, 0.0_wp), 0.0_wp, 20.0_wp*tolerance, method//' is as accurate inside steps')
    call integrator%interpolate(t, inside, found)
    call test%is_true(found .and. .not. any(abs(inside - y) > 1.0e-15_wp), method//' tells the end of a step')
    call integrator%destroy()
  end subroutine check_inside_steps

  !> A stop just behind a natural step does not lead to a very short step, from which a method would need
  !> many to recover.
  subroutine check_short_rest(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp), parameter :: rests(4) = [1.0e-15_wp, 1.0e-13_wp, 1.0e-9_wp, 1.0e-4_wp]
    real(wp) :: y(4), t, t_before, t_stop, shortest
    integer :: i, k

    do k = 1, size(rests)
      t = 0.0_wp
      y = orbit_start(0.5_wp)
      call integrator%create(orbit, method, step_tolerance_type(1.0e-9_wp, spread(1.0e-9_wp, 1, 4)), t, y, err)
      call integrator%limit(err, first_step=1.0e-4_wp)   ! the steps would otherwise depend on the stop
      do i = 1, 60
        call integrator%step(1.0e3_wp, t, y, err)
      end do
      t_stop = t + rests(k)
      t = 0.0_wp
      y = orbit_start(0.5_wp)
      call integrator%create(orbit, method, step_tolerance_type(1.0e-9_wp, spread(1.0e-9_wp, 1, 4)), t, y, err)
      call integrator%limit(err, first_step=1.0e-4_wp)   ! the steps would otherwise depend on the stop
      shortest = huge(1.0_wp)
      i = 0
      do while (abs(t - t_stop) > 0.0_wp .and. .not. allocated(err))
        t_before = t
        call integrator%step(t_stop, t, y, err)
        if (t > 0.5_wp*t_stop) shortest = min(shortest, t - t_before)
        i = i + 1
      end do
      call test%no_error(err, method//' takes its steps')
      call test%is_true(shortest > 1.0e-4_wp, method//' takes no very short step to a stop')
      ! one step more if the last but one is halved, and one more if the last one is
      call test%is_true(i <= 62, method//' takes hardly more steps to meet a stop')
    end do
    call integrator%destroy()
  end subroutine check_short_rest

  !> Forth and back again: the start is met in time exactly, and otherwise as well as the steps are.
  subroutine check_turning_back(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: y(4), t

    t = 0.0_wp
    y = orbit_start(0.5_wp)
    call integrator%create(orbit, method, step_tolerance_type(1.0e-10_wp, spread(1.0e-10_wp, 1, 4)), t, y, err)
    do while (t < 3.0_wp .and. .not. allocated(err))
      call integrator%step(3.0_wp, t, y, err)
    end do
    do while (t > 0.0_wp .and. .not. allocated(err))
      call integrator%step(0.0_wp, t, y, err)
    end do
    call test%no_error(err, method//' turns back')
    call test%is_true(abs(t) <= 0.0_wp, method//' comes back to the time of the start')
    ! a thousand steps at most, each with an error of 1e-10, of which the early ones grow some ten times
    call test%near(maxval(abs(y - orbit_start(0.5_wp))), 0.0_wp, 1.0e-6_wp, method//' comes back to the start')
    call integrator%destroy()
  end subroutine check_turning_back

  !> A system that settles is asked once per step; what it gives is what the steps give; and it costs no
  !> accuracy and no steps: projecting the circle on itself leaves the order as it is.
  subroutine check_settling(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: method              !< its number among all methods
    type(rotation_type), target :: rotation
    type(integration_statistics_type) :: free, settled
    type(error_type), allocatable :: err
    real(wp) :: y(2), free_error, settled_error
    integer :: k

    associate (m => integration_methods(method))
      do k = 6, 12, 3
        rotation%settles = .false.
        y = [1.0_wp, 0.0_wp]
        call integrate(rotation, m%name, 10.0_wp**(-k), 20.0_wp, y, free, err)
        free_error = norm2(y - [cos(20.0_wp), sin(20.0_wp)])
        rotation%settles = .true.
        rotation%settled = 0
        rotation%t_settled = 0.0_wp
        rotation%largest_correction = 0.0_wp
        y = [1.0_wp, 0.0_wp]
        call integrate(rotation, m%name, 10.0_wp**(-k), 20.0_wp, y, settled, err)
        settled_error = norm2(y - [cos(20.0_wp), sin(20.0_wp)])
        call test%no_error(err, trim(m%name)//' goes on with settling')
        call test%is_true(rotation%settled == settled%steps, trim(m%name)//' settles once per step')
        call test%near(norm2(y), 1.0_wp, 4.0_wp*epsilon(1.0_wp), trim(m%name)//' gives what was settled')
        call test%is_true(rotation%largest_correction < 1.0e2_wp*10.0_wp**(-k), &
                          trim(m%name)//': corrections are about as large as the tolerance')
        if (k == 6) call test%is_true(rotation%largest_correction > 1.0e-10_wp, trim(m%name)//' needs corrections')
        call test%is_true(settled_error < 2.0_wp*free_error + 0.1_wp*10.0_wp**(-k), &
                          trim(m%name)//' loses nothing by settling')
        call test%is_true(settled%rate_evaluations <= 1.2_wp*free%rate_evaluations + 2, &
                          trim(m%name)//' works out no more rates with settling')
        call test%is_true(settled%last_order >= free%last_order - 1, trim(m%name)//' keeps its order with settling')
      end do
    end associate
  end subroutine check_settling

  !> The same correction made by the caller after each step.
  subroutine check_corrections(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: method              !< its number among all methods
    type(rotation_type), target :: rotation
    type(integrator_type) :: integrator
    type(integration_statistics_type) :: free, corrected
    type(error_type), allocatable :: err
    real(wp) :: y(2), t, free_error, error

    associate (m => integration_methods(method))
      y = [1.0_wp, 0.0_wp]
      call integrate(rotation, m%name, 1.0e-9_wp, 20.0_wp, y, free, err)
      free_error = norm2(y - [cos(20.0_wp), sin(20.0_wp)])
      t = 0.0_wp
      y = [1.0_wp, 0.0_wp]
      call integrator%create(rotation, m%name, step_tolerance_type(1.0e-9_wp, spread(1.0e-9_wp, 1, 2)), t, y, err)
      do while (t < 20.0_wp .and. .not. allocated(err))
        call integrator%step(20.0_wp, t, y, err)
        if (allocated(err)) exit
        y = y/norm2(y)
        call integrator%correct(y, err)
      end do
      corrected = integrator%statistics()
      error = norm2(y - [cos(20.0_wp), sin(20.0_wp)])
      call test%no_error(err, trim(m%name)//' goes on with corrections')
      call test%is_true(error < 2.0_wp*free_error, trim(m%name)//' loses nothing by corrections')
      call test%is_true(corrected%steps <= 1.1_wp*free%steps + 2, trim(m%name)//' takes the same steps with corrections')
      call test%is_true(corrected%last_order >= free%last_order - 1, trim(m%name)//' keeps its order with corrections')
      ! y with half the length is carried on, not forgotten
      call integrator%correct(0.5_wp*y, err)
      call integrator%step(20.001_wp, t, y, err)
      ! a part of the old length, 1, that came in from steps before would be seen: the motion turns by 1e-3 in this step
      call test%near(norm2(y), 0.5_wp, 1.0e-4_wp, trim(m%name)//' goes on from what it was given')
      call integrator%destroy()
    end associate
  end subroutine check_corrections

  !> After an event the motion goes on from new values; what was counted stays.
  subroutine check_restart(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(integration_statistics_type) :: before, after
    type(error_type), allocatable :: err
    real(wp) :: y(4), t

    t = 0.0_wp
    y = orbit_start(0.2_wp)
    call integrator%create(orbit, method, step_tolerance_type(1.0e-9_wp, spread(1.0e-9_wp, 1, 4)), t, y, err)
    do while (t < 1.0_wp .and. .not. allocated(err))
      call integrator%step(1.0_wp, t, y, err)
    end do
    before = integrator%statistics()
    call integrator%restart(5.0_wp, orbit_start(0.5_wp), err)
    do while (t < 7.0_wp .and. .not. allocated(err))
      call integrator%step(7.0_wp, t, y, err)
    end do
    after = integrator%statistics()
    call test%no_error(err, method//' goes on after a restart')
    ! a thousand steps at most, each with an error of 1e-9, of which the early ones grow some ten times
    call test%near(maxval(abs(y - orbit_at(0.5_wp, 2.0_wp))), 0.0_wp, 1.0e-5_wp, method//' goes on from a restart')
    call test%is_true(after%steps > before%steps .and. after%rate_evaluations > before%rate_evaluations .and. &
                      after%error_test_failures >= before%error_test_failures, method//' counts on after a restart')
    call integrator%destroy()
  end subroutine check_restart

  !> The longest step, the first step and the number of steps can be limited.
  subroutine check_limits(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: y(4), t, t_before, longest, first

    t = 0.0_wp
    y = orbit_start(0.0_wp)
    first = -1.0_wp
    longest = 0.0_wp
    call integrator%create(orbit, method, step_tolerance_type(1.0e-5_wp, spread(1.0e-5_wp, 1, 4)), t, y, err)
    call integrator%limit(err, largest_step=0.02_wp, first_step=1.0e-5_wp)
    do while (t < 3.0_wp .and. .not. allocated(err))
      t_before = t
      call integrator%step(3.0_wp, t, y, err)
      longest = max(longest, t - t_before)
      if (first < 0.0_wp) first = t
    end do
    call test%no_error(err, method//' goes on with limits')
    call test%near(first, 1.0e-5_wp, 1.0e-14_wp, method//' takes the first step it is told')
    call test%is_true(longest <= 0.02_wp*(1.0_wp + 1.0e-12_wp), method//' takes no step longer than it may')
    call integrator%destroy()
  end subroutine check_limits

  !> Neither the method nor what stands around it asks for memory once the first steps are made.
  !> (CVODE does for each Jacobian by differences, now and then: here the system has its own.)
  subroutine check_memory(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(rotation_type), target :: rotation
    type(stiff_type), target :: stiff
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: y(2), t
    integer :: i, before

    t = 0.0_wp
    y = [1.0_wp, 0.0_wp]
    rotation%settles = .true.
    stiff%has_jacobian = .true.
    if (method == 'bdf') then
      call integrator%create(stiff, method, step_tolerance_type(1.0e-8_wp, [1.0e-8_wp, 1.0e-8_wp]), t, y, err)
    else
      call integrator%create(rotation, method, step_tolerance_type(1.0e-8_wp, [1.0e-8_wp, 1.0e-8_wp]), t, y, err)
    end if
    do i = 1, 5
      call integrator%step(100.0_wp, t, y, err)
    end do
    before = calls
    do i = 1, 200
      call integrator%step(100.0_wp, t, y, err)
    end do
    call test%is_true(calls == before, method//' asks for no memory in its steps')
    call integrator%destroy()
  end subroutine check_memory

  !> The error of a step for y' = t**p, p the order of the embedded formula, is the same multiple of h**(p+1) everywhere:
  !> with the right exponent the error of the first step tells the length of all others, and none is made again. (Of
  !> the other two the embedded formula of Merson's is of higher order for such equations, and Fehlberg's is exact.)
  subroutine check_first_choice(test, method, order)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    integer, intent(in) :: order               !< of the embedded formula
    type(power_type), target :: system
    type(integrator_type) :: integrator
    type(integration_statistics_type) :: statistics
    type(error_type), allocatable :: err
    real(wp) :: y(1), t, ends(0:6)
    integer :: i

    system%power = order
    t = 0.0_wp
    y = 0.0_wp
    ends(0) = t
    ! relative errors count for nothing beside 1e-6
    call integrator%create(system, method, step_tolerance_type(1.0e-14_wp, [1.0e-6_wp]), t, y, err)
    call integrator%limit(err, first_step=0.1_wp)
    do i = 1, 6
      call integrator%step(1.0e3_wp, t, y, err)
      call test%no_error(err, method//' makes a step')
      ends(i) = t
    end do
    statistics = integrator%statistics()
    call test%is_true(statistics%error_test_failures == 0, method//': no step is made again')
    call test%is_true(ends(2) - ends(1) > 1.5_wp*(ends(1) - ends(0)), method//': the first step was a short one')
    ! the error of the first step stands out of round-off by some digits
    do i = 3, 6
      call test%near((ends(i) - ends(i - 1))/(ends(2) - ends(1)), 1.0_wp, 1.0e-3_wp, method//': all others are of one length')
    end do
    call integrator%destroy()
  end subroutine check_first_choice

  !> Two integrations step by turns and give what each gives alone, to the last bit.
  subroutine check_side_by_side(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(orbit_type), target :: orbits(2)
    type(integrator_type) :: integrators(2)
    type(integration_statistics_type) :: statistics
    type(error_type), allocatable :: err
    real(wp) :: y(4, 2), alone(4, 2), t(2)
    character(len=14), parameter :: methods(2) = ['adams         ', 'dormand-prince']
    integer :: i

    t = 0.0_wp
    do i = 1, 2
      alone(:, i) = orbit_start(0.1_wp*i)
      call integrate(orbits(i), methods(i), 1.0e-8_wp, 6.0_wp, alone(:, i), statistics, err)
      y(:, i) = orbit_start(0.1_wp*i)
      call integrators(i)%create(orbits(i), methods(i), step_tolerance_type(1.0e-8_wp, spread(1.0e-8_wp, 1, 4)), t(i), y(:, i), err)
    end do
    do while (any(t < 6.0_wp))
      do i = 1, 2
        call integrators(i)%step(6.0_wp, t(i), y(:, i), err)
      end do
    end do
    call test%is_true(all(abs(y - alone) <= 0.0_wp), 'integrations side by side do not meet')
    do i = 1, 2
      call integrators(i)%destroy()
    end do
  end subroutine check_side_by_side
end module test_integrator_steps
