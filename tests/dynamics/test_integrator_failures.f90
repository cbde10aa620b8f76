!> Integrations that cannot go on: what is tried, and what is said.
module test_integrator_failures
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_internal, exit_data, exit_singular, exit_integrator
  use mech9_integration_methods, only: integration_method_type, integration_methods, method_index, runge_kutta, no_table
  use mech9_stepper, only: refused
  use mech9_sundials_system, only: system_box_type
  use mech9_sundials_runge_kutta, only: runge_kutta_type, new_runge_kutta
  use mech9_integrator, only: integrator_type, integration_statistics_type, step_tolerance_type
  use mech9_integration_problems, only: explosion_type, obstacle_type, rotation_type, orbit_type, &
    orbit_start, integrate
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks
    integer :: i

    do i = 1, size(integration_methods)
      if (test%runs(trim(integration_methods(i)%name))) call check_method(test, trim(integration_methods(i)%name))
    end do
    if (test%runs('check_settings')) call check_settings(test)
    if (test%runs('check_tables')) call check_tables(test)
  end subroutine run

  !> Check one method.
  subroutine check_method(test, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: name       !< of the method

    call check_explosion(test, name)
    call check_obstacles(test, name)
    call check_start(test, name)
    call check_refused_settling(test, name)
    call check_many_steps(test, name)
    call check_accuracy(test, name)
  end subroutine check_method

  !> y' = y**2 is infinite at t = 1, and there it ends.
  subroutine check_explosion(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(explosion_type), target :: explosion
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: y(1), t

    t = 0.0_wp
    y = 1.0_wp
    call integrator%create(explosion, method, step_tolerance_type(1.0e-8_wp, [1.0e-8_wp]), t, y, err)
    do while (t < 2.0_wp .and. .not. allocated(err))
      call integrator%step(2.0_wp, t, y, err)
    end do
    call test%has_error(err, exit_integrator, method//' ends where the motion explodes')
    ! each step of a thousand or fewer moves the place by a part of the tolerance
    call test%near(t, 1.0_wp, 1.0e-6_wp, method//' ends at the time of the explosion')
    call check_words(test, err, ['t = 1 s   ', 't = 0.9999', 't = 1.0000'], method//' says when', any_of=.true.)
    call integrator%destroy()
  end subroutine check_explosion

  !> A wall in time or in y is approached by ever smaller steps, then told with its own words and code.
  subroutine check_obstacles(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(obstacle_type), target :: obstacle
    type(integrator_type) :: integrator
    type(integration_statistics_type) :: statistics
    type(error_type), allocatable :: err
    integer, parameter :: codes(4) = [exit_singular, exit_integrator, 0, exit_internal]
    integer, parameter :: answers(4) = [exit_singular, exit_integrator, exit_integrator, exit_internal]
    real(wp) :: y(2), t
    integer :: i, k

    do k = 1, 2
      do i = 1, size(codes)
        obstacle%in_time = k == 1
        obstacle%code = codes(i)
        obstacle%edge = merge(0.5_wp, sin(0.5_wp), k == 1)   ! y = sin t
        t = 0.0_wp
        y = 0.0_wp
        call integrator%create(obstacle, method, step_tolerance_type(1.0e-6_wp, [1.0e-6_wp, 1.0e-6_wp]), t, y, err)
        do while (t < 2.0_wp .and. .not. allocated(err))
          call integrator%step(2.0_wp, t, y, err)
        end do
        call test%has_error(err, answers(i), method//' hands on the failure of a system')
        statistics = integrator%statistics()
        if (codes(i) == exit_internal) then
          call test%is_true(statistics%refusals == 0, method//' tries nothing where nothing helps')
          call check_words(test, err, ['the wall is in the way'], method//' says why')
        else
          ! the wall in y is met within the error of y, 1e-6 at a rate of some 0.9; the wall in time exactly
          call test%near(t, 0.5_wp, merge(1.0e-9_wp, 3.0e-5_wp, k == 1), method//' comes up to the wall')
          call test%near(y(1), sin(t), 3.0e-5_wp, method//' keeps its last good values')
          call test%is_true(statistics%rate_evaluations < 20000, method//' does not run against the wall for ever')
          if (codes(i) == 0) then
            call check_words(test, err, ['variable 2 is not finite', 't = 0.                  '], &
                             method//' says which number, and when')
          else
            call check_words(test, err, ['the wall is in the way', 't = 0.                '], method//' says why, and when')
          end if
        end if
      end do
    end do
    call integrator%destroy()
  end subroutine check_obstacles

  !> A system that fails at the start ends the integration at once.
  subroutine check_start(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(obstacle_type), target :: obstacle
    type(integration_statistics_type) :: statistics
    type(error_type), allocatable :: err
    real(wp) :: y(2)

    obstacle%edge = -1.0_wp
    y = 0.0_wp
    call integrate(obstacle, method, 1.0e-6_wp, 1.0_wp, y, statistics, err)
    call test%has_error(err, exit_singular, method//' hands on a failure at the start')
    call check_words(test, err, ['t = 0 s'], method//' says that it is the start')
    call test%is_true(statistics%rate_evaluations <= 2, method//' does not try the start again')
  end subroutine check_start

  !> A step after which the system cannot settle is made again, smaller; where nothing helps, it ends.
  subroutine check_refused_settling(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(rotation_type), target :: rotation
    type(integration_statistics_type) :: statistics
    type(error_type), allocatable :: err
    real(wp) :: y(2)

    rotation%settles = .true.
    rotation%refuse_longer_than = 0.02_wp
    y = [1.0_wp, 0.0_wp]
    call integrate(rotation, method, 1.0e-4_wp, 1.0_wp, y, statistics, err)
    call test%no_error(err, method//' makes steps smaller until the system can settle')
    call test%is_true(statistics%refusals > 0, method//' counts what was refused')
    ! at most 1/0.02 steps and those made again, each with an error of the tolerance
    call test%near(norm2(y - [cos(1.0_wp), sin(1.0_wp)]), 0.0_wp, 1.0e-2_wp, method//' is right all the same')

    rotation%refuse_longer_than = -1.0_wp
    y = [1.0_wp, 0.0_wp]
    call integrate(rotation, method, 1.0e-4_wp, 1.0_wp, y, statistics, err)
    call test%has_error(err, exit_singular, method//' ends where the system never settles')
    call check_words(test, err, ['too far to settle'], method//' says why')
  end subroutine check_refused_settling

  !> More steps than allowed to one stop: said so, and one may go on by asking for less.
  subroutine check_many_steps(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: y(4), t
    integer :: steps

    t = 0.0_wp
    y = orbit_start(0.5_wp)
    call integrator%create(orbit, method, step_tolerance_type(1.0e-8_wp, spread(1.0e-8_wp, 1, 4)), t, y, err)
    call integrator%limit(err, maximum_steps=20)
    steps = 0
    do while (t < 100.0_wp .and. .not. allocated(err))
      call integrator%step(100.0_wp, t, y, err)
      if (.not. allocated(err)) steps = steps + 1
    end do
    call test%has_error(err, exit_integrator, method//' ends when it takes too many steps')
    call test%is_true(steps == 20, method//' takes the steps it may')
    call check_words(test, err, ['20 steps'], method//' says that there are too many steps')
    call integrator%step(t + 1.0e-3_wp, t, y, err)
    call test%no_error(err, method//' goes on to another stop')
    call integrator%destroy()
  end subroutine check_many_steps

  !> More digits than there are.
  subroutine check_accuracy(test, method)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: method     !< name of the method
    type(orbit_type), target :: orbit
    type(integration_statistics_type) :: statistics
    type(error_type), allocatable :: err
    real(wp) :: y(4)

    y = orbit_start(0.5_wp)
    call integrate(orbit, method, 1.0e-19_wp, 1.0_wp, y, statistics, err)
    call test%has_error(err, exit_integrator, method//' ends where tolerances ask for too much')
    call check_words(test, err, ['tolerances'], method//' says that it is the tolerances')
  end subroutine check_accuracy

  !> Settings that mean nothing.
  subroutine check_settings(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(orbit_type), target :: orbit
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: y(4)

    y = orbit_start(0.5_wp)
    call integrator%create(orbit, 'fehlbreg', step_tolerance_type(1.0e-6_wp, [1.0e-6_wp]), 0.0_wp, y, err)
    call test%has_error(err, exit_data, 'an unknown method is refused')
    call check_words(test, err, ['''fehlbreg''', '''fehlberg''', 'merson    '], &
                     'the message about an unknown method names it and those there are')
    call integrator%create(orbit, '', step_tolerance_type(1.0e-6_wp, [1.0e-6_wp]), 0.0_wp, y, err)
    call test%has_error(err, exit_internal, 'one absolute tolerance for four variables is refused')
    call integrator%create(orbit, '', step_tolerance_type(0.0_wp, spread(1.0e-6_wp, 1, 4)), 0.0_wp, y, err)
    call test%has_error(err, exit_data, 'a relative tolerance of zero is refused')
    call integrator%create(orbit, '', step_tolerance_type(1.0e-6_wp, spread(0.0_wp, 1, 4)), 0.0_wp, y, err)
    call test%has_error(err, exit_data, 'an absolute tolerance of zero is refused')
    call integrator%create(orbit, '', step_tolerance_type(1.0e-6_wp, spread(1.0e-6_wp, 1, 4)), 0.0_wp, y, err)
    call test%no_error(err, 'where no method is named the first one is taken')
    call integrator%destroy()
  end subroutine check_settings

  !> Each Runge-Kutta method has a table of its own. A method without one is refused, not taken for another.
  subroutine check_tables(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(integration_method_type) :: method
    type(system_box_type), pointer :: box
    type(orbit_type), target :: orbit
    type(runge_kutta_type) :: stepper
    integer :: i, outcome

    do i = 1, size(integration_methods)
      associate (row => integration_methods(i))
        call test%is_true((row%family == runge_kutta) .eqv. (row%table /= no_table), row%name//' has a table if it needs one')
        call test%is_true(row%table == no_table .or. count(integration_methods%table == row%table) == 1, &
                          row%name//' does not share its table')
      end associate
    end do
    method = integration_methods(method_index('prince-dormand'))
    method%table = no_table
    allocate (box)
    box%system => orbit
    call new_runge_kutta(method, box, step_tolerance_type(1.0e-6_wp, spread(1.0e-6_wp, 1, 4)), &
                         0.0_wp, orbit_start(0.5_wp), stepper, outcome)
    call test%is_true(outcome == refused, 'a method without a table is refused')
    call stepper%close()
    deallocate (box)
  end subroutine check_tables

  !> Check that a message holds some words (trailing blanks do not count).
  subroutine check_words(test, err, words, why, any_of)
    type(tester_type), intent(inout) :: test           !< counts the checks
    type(error_type), allocatable, intent(in) :: err   !< the failure
    character(len=*), intent(in) :: words(:)           !< of its message
    character(len=*), intent(in) :: why                !< the statement that is checked, printed where it is wrong
    logical, intent(in), optional :: any_of            !< one of them is enough
    logical :: found(size(words))
    integer :: i

    if (.not. allocated(err)) return
    do i = 1, size(words)
      found(i) = index(message_of(err), trim(words(i))) > 0
    end do
    if (present(any_of)) found = any(found)
    do i = 1, size(words)
      call test%is_true(found(i), why//': "'//trim(words(i))//'" in "'//message_of(err)//'"')
    end do
  end subroutine check_words
end module test_integrator_failures
