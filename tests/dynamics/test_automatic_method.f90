!> The method that goes over from an explicit method to an implicit one where equations are stiff, and back.
module test_automatic_method
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_integrator, only: integrator_type, integration_statistics_type, step_tolerance_type
  use mech9_testing, only: tester_type
  use mech9_integration_problems, only: orbit_type, orbit_start, stiff_type, fading_type, integrate
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_not_stiff')) call check_not_stiff(test)
    if (test%runs('check_stiff_loose')) call check_stiff(test, 1.0e-6_wp)
    if (test%runs('check_stiff_tight')) call check_stiff(test, 1.0e-10_wp)
    if (test%runs('check_there_and_back')) call check_there_and_back(test)
    if (test%runs('check_inside_steps')) call check_inside_steps(test)
    if (test%runs('check_restart')) call check_restart(test)
  end subroutine run

  !> Equations that are not stiff get the steps of the explicit method, to the last bit.
  subroutine check_not_stiff(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(orbit_type), target :: orbit
    type(integration_statistics_type) :: explicit, by_turns
    type(error_type), allocatable :: err
    real(wp) :: y(4), z(4)
    integer :: k

    do k = 3, 11, 4
      y = orbit_start(0.5_wp)
      z = y
      call integrate(orbit, 'prince-dormand', 10.0_wp**(-k), 20.0_wp, y, explicit, err)
      call integrate(orbit, 'auto', 10.0_wp**(-k), 20.0_wp, z, by_turns, err)
      call test%no_error(err, 'orbits are integrated by both methods')
      call test%is_true(maxval(abs(y - z)) <= 0.0_wp, 'an orbit has the same end by the explicit method alone')
      call test%is_true(by_turns%rate_evaluations == explicit%rate_evaluations, &
                        'an orbit takes the evaluations of the explicit method alone')
      call test%is_true(by_turns%method_changes == 0 .and. by_turns%implicit_steps == 0, &
                        'an orbit takes no change of the method')
    end do
  end subroutine check_not_stiff

  !> Stiff equations cost little more than by the implicit method alone, and are as accurate.
  subroutine check_stiff(test, tolerance)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: tolerance          !< relative and absolute
    type(stiff_type), target :: stiff
    type(integration_statistics_type) :: implicit, by_turns
    type(error_type), allocatable :: err
    real(wp) :: y(2), z(2)

    y = 1.0_wp
    z = y
    call integrate(stiff, 'bdf', tolerance, 10.0_wp, y, implicit, err)
    call integrate(stiff, 'auto', tolerance, 10.0_wp, z, by_turns, err)
    call test%no_error(err, 'stiff equations are integrated')
    ! the explicit method needs about 2e5
    call test%is_true(by_turns%rate_evaluations < 1.2_wp*implicit%rate_evaluations + 300.0_wp, &
                      'stiff equations take hardly more evaluations than by the implicit method alone')
    call test%is_true(by_turns%method_changes == 1, 'stiff equations take one change of the method')
    call test%is_true(by_turns%implicit_steps > 0.8_wp*by_turns%steps, &
                      'the method changes soon after the start of stiff equations')
    call test%near(maxval(abs(z - cos(10.0_wp))), 0.0_wp, 10.0_wp*tolerance, 'the end of stiff equations is right')
  end subroutine check_stiff

  !> The explicit method goes on where the stiffness fades, the implicit one where it comes back.
  subroutine check_there_and_back(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(fading_type), target :: fading
    type(integration_statistics_type) :: explicit, implicit, by_turns
    type(error_type), allocatable :: err
    real(wp) :: y(2)

    y = 1.0_wp
    call integrate(fading, 'prince-dormand', 1.0e-8_wp, 40.0_wp*pi, y, explicit, err)
    y = 1.0_wp
    call integrate(fading, 'bdf', 1.0e-8_wp, 40.0_wp*pi, y, implicit, err)
    y = 1.0_wp
    call integrate(fading, 'auto', 1.0e-8_wp, 40.0_wp*pi, y, by_turns, err)
    call test%no_error(err, 'equations whose stiffness fades are integrated')
    call test%near(maxval(abs(y - 1.0_wp)), 0.0_wp, 1.0e-7_wp, &
                   'the end of equations whose stiffness fades is right')
    call test%is_true(by_turns%method_changes >= 4, &
                      'the method changes there and back as stiffness comes and fades')
    call test%is_true(by_turns%rate_evaluations < explicit%rate_evaluations .and. &
                      by_turns%rate_evaluations < implicit%rate_evaluations, &
                      'changes of the method cost less than either method alone')
  end subroutine check_there_and_back

  !> Values within a step come from the method that made it, also after it was decided that the other one goes on.
  subroutine check_inside_steps(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(fading_type), target :: fading
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: t, from, inside, y(2), between(2), worst
    integer :: told
    logical :: found

    t = 0.0_wp
    y = 1.0_wp
    worst = 0.0_wp
    told = 0
    call integrator%create(fading, 'auto', step_tolerance_type(1.0e-8_wp, [1.0e-8_wp, 1.0e-8_wp]), t, y, err)
    do while (t < 40.0_wp*pi .and. .not. allocated(err))
      from = t
      call integrator%step(40.0_wp*pi, t, y, err)
      inside = 0.5_wp*(from + t)
      call integrator%interpolate(inside, between, found)
      if (.not. found) cycle
      told = told + 1
      worst = max(worst, maxval(abs(between - cos(inside))))
    end do
    call test%no_error(err, 'an integration with values within steps succeeds')
    call test%is_true(told > 100, 'most steps are made by the implicit method')
    call test%near(worst, 0.0_wp, 1.0e-7_wp, 'values within steps of the implicit method are right')
    call integrator%destroy()
  end subroutine check_inside_steps

  !> A restart within a stiff part goes on there.
  subroutine check_restart(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(stiff_type), target :: stiff
    type(integrator_type) :: integrator
    type(integration_statistics_type) :: counts
    type(error_type), allocatable :: err
    real(wp) :: t, y(2)

    t = 0.0_wp
    y = 1.0_wp
    call integrator%create(stiff, 'auto', step_tolerance_type(1.0e-7_wp, [1.0e-7_wp, 1.0e-7_wp]), t, y, err)
    do while (t < 1.0_wp .and. .not. allocated(err))
      call integrator%step(1.0_wp, t, y, err)
    end do
    call integrator%restart(4.0_wp, [cos(4.0_wp), cos(4.0_wp)], err)
    do while (t < 5.0_wp .and. .not. allocated(err))
      call integrator%step(5.0_wp, t, y, err)
    end do
    counts = integrator%statistics()
    call test%no_error(err, 'an integration goes on after a restart')
    call test%near(maxval(abs(y - cos(5.0_wp))), 0.0_wp, 1.0e-6_wp, 'the end after a restart is right')
    call test%is_true(counts%method_changes == 1, 'the implicit method goes on after a restart')
    call integrator%destroy()
  end subroutine check_restart
end module test_automatic_method
