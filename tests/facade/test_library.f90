!> The library's motions: bad calls are answered by values, energies of a driven motion, motions one after the other.
module test_library
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9, only: wp, mechanism_type, motion_type, error_type, read_text, coordinate_change_type, &
    motion_event_type, simulation_statistics_type, &
    interruption_type, exit_usage, exit_file, exit_integrator, exit_interrupted, read_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A body of 3 kg, 0.5 m from its axis, that turns against gravity.
  character(len=*), parameter :: turning = '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&body link=2, mass=3, centre=0.5,0,0, inertia=0,0,0.1,0,0,0 / &gravity acceleration=0,-9.81,0 /'
  character(len=*), parameter :: driven = turning//' &drive coordinate=1, kind=''polynomial'', coefficients=0.2,2.0 /'
  character(len=*), parameter :: free = turning//' &initial coordinate=1, position=0.2, velocity=2.0 /'

  !> Stops a motion once, where it asks for the twelfth time.
  type, extends(interruption_type) :: twelfth_time_type
    integer, pointer :: asked => null()   !< how often it was asked; not owned
  contains
    procedure :: is_wanted => is_twelfth
  end type twelfth_time_type

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_nothing_started')) call check_nothing_started(test)
    if (test%runs('check_driven_energies')) call check_driven_energies(test)
    if (test%runs('check_all_driven')) call check_all_driven(test)
    if (test%runs('check_one_after_the_other')) call check_one_after_the_other(test)
    if (test%runs('check_accuracy')) call check_accuracy(test)
    if (test%runs('check_change_after_a_stop')) call check_change_after_a_stop(test)
  end subroutine run

  !> Questions to a motion that was never started have no numbers, and do no harm.
  subroutine check_nothing_started(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err
    type(coordinate_change_type), allocatable :: changes(:)
    type(motion_event_type), allocatable :: events(:)
    real(wp) :: kinetic, potential, t, q, closure

    call read_file('no such file', mechanism, err)
    call test%has_error(err, exit_file, 'a data file that is not there is refused')
    call motion%start_kinematics(mechanism, err)
    call test%has_error(err, exit_usage, 'no motion starts while no mechanism was read')
    call motion%advance(1.0_wp, err)
    call test%has_error(err, exit_usage, 'no motion goes on while none was started')
    call motion%point('P', err)
    call test%has_error(err, exit_usage, 'no point is found while no motion was started')
    call motion%energies(kinetic, potential)
    call motion%coordinate_changes(changes)
    call motion%events(events)
    t = motion%t()
    q = motion%q(1)
    closure = motion%closure()
    call test%is_true(all(ieee_is_nan([t, q, closure, kinetic, potential])), 'a motion that was not started has no numbers')
    call test%is_true(motion%coordinates() == 0 .and. size(changes) == 0 .and. size(events) == 0, &
                      'a motion that was not started has no coordinates and no events')
    call motion%close()
  end subroutine check_nothing_started

  !> Kinetic energy is half of (0.1 + 3*0.5**2) dq**2, potential energy is 3*9.81 times the height.
  subroutine check_driven_energies(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err
    type(simulation_statistics_type) :: counts
    real(wp) :: kinetic, potential

    call read_text(driven, mechanism, err)
    call test%no_error(err, 'a mechanism of a body that is turned is accepted')
    call motion%start_kinematics(mechanism, err)
    call motion%advance(0.75_wp, err)
    call test%no_error(err, 'the driven motion advances')
    call motion%energies(kinetic, potential)
    call test%near(kinetic, 0.5_wp*0.85_wp*4.0_wp, 1e-13_wp, 'the kinetic energy of a driven motion is that of its closed form')
    call test%near(potential, 3.0_wp*9.81_wp*0.5_wp*sin(1.7_wp), 1e-13_wp, &
                   'the potential energy of a driven motion is that of its closed form')
    call test%is_true(all(ieee_is_nan([motion%q(0), motion%q(2)])), 'a coordinate that the mechanism does not have is no number')
    counts = motion%statistics()
    call test%is_true(counts%positions == 2 .and. counts%evaluations == 0, &
                      'a driven motion at two times takes two positions and no evaluation')
    call motion%advance(0.5_wp, err)
    call test%has_error(err, exit_usage, 'a time before the present one is refused')
    call test%is_true(index(err%message, 'cannot go back to t = 0.5 s') > 0, 'the message about an earlier time names it')
    call test%near(motion%q(1), 1.7_wp, 1e-15_wp, 'the motion stays where it is when an earlier time is refused')
    call motion%close()
  end subroutine check_driven_energies

  !> Dynamics of a body whose only coordinate is driven: it has the motion of the drive, its energies, and no steps of an integrator.
  subroutine check_all_driven(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err
    type(simulation_statistics_type) :: counts
    real(wp) :: kinetic, potential

    call read_text(driven, mechanism, err)
    call motion%start_dynamics(mechanism, err)
    call motion%advance(1.0_wp, err)
    call test%no_error(err, 'a motion starts that drives determine')
    call test%near(motion%q(1), 2.2_wp, 1e-15_wp, 'it is that of its drive')
    call motion%energies(kinetic, potential)
    call test%near(kinetic, 0.5_wp*0.85_wp*4.0_wp, 1e-14_wp, 'it has its kinetic energy')
    counts = motion%statistics()
    call test%is_true(counts%evaluations == 0, 'nothing is integrated where all is driven')
    call motion%close()
  end subroutine check_all_driven

  !> One variable holds a driven motion, then a free one, then nothing.
  subroutine check_one_after_the_other(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: with_drive, without
    type(motion_type) :: motion, beside
    type(error_type), allocatable :: err
    real(wp) :: kinetic, potential

    call read_text(driven, with_drive, err)
    call read_text(free, without, err)
    call test%no_error(err, 'a mechanism of the same body without a drive is accepted')
    call motion%start_kinematics(with_drive, err)
    call motion%start_dynamics(without, err)
    call test%no_error(err, 'a free motion starts after a driven one')
    call beside%start_kinematics(with_drive, err)
    call test%near(motion%q(1), beside%q(1), 1e-15_wp, 'two motions of one mechanism start at the same angle')
    call motion%advance(1.0_wp, err)
    call test%no_error(err, 'the free motion advances')
    call motion%energies(kinetic, potential)
    ! a second of some 50 steps, each with an error of 1e-8 of a state of size 5
    call test%near(kinetic + potential, 0.5_wp*0.85_wp*4.0_wp + 3.0_wp*9.81_wp*0.5_wp*sin(0.2_wp), 1e-5_wp, &
                   'the energy of a free motion stays what it was')
    call motion%start_kinematics(without, err)
    call test%is_true(allocated(err), 'a mechanism without a drive has no driven motion')
    call test%is_true(ieee_is_nan(motion%q(1)), 'the motion before a refused one is closed')
    call motion%close()
    call beside%close()
  end subroutine check_one_after_the_other

  !> An accuracy gives tolerances for all of the motion; one below round-off is refused.
  subroutine check_accuracy(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: loose, accurate, truth, impossible
    type(motion_type) :: motion
    type(error_type), allocatable :: err
    real(wp) :: q(3)

    call read_text(free//'&solver relative_tolerance=1e-3, absolute_tolerance=1e-3 / &time end=5 /', loose, err)
    call read_text(free//'&solver accuracy=1e-9 / &time end=5 /', accurate, err)
    call read_text(free//'&solver relative_tolerance=1e-13, absolute_tolerance=1e-13 / &time end=5 /', truth, err)
    call read_text(free//'&solver accuracy=1e-17 / &time end=5 /', impossible, err)
    call test%no_error(err, 'mechanisms of a body that swings are accepted')
    call ride(test, loose, q(1))
    call ride(test, accurate, q(2))
    call ride(test, truth, q(3))
    call test%is_true(abs(q(1) - q(3)) > 1e-6_wp, 'loose tolerances change the motion visibly')
    call test%near(q(2), q(3), 1e-9_wp, 'the accuracy that was set is kept for five seconds')
    call motion%start_dynamics(impossible, err)
    call test%has_error(err, exit_integrator, 'an accuracy below round-off is refused')
    call motion%close()
  end subroutine check_accuracy

  !> The angle of a free motion after five seconds.
  subroutine ride(test, mechanism, q)
    type(tester_type), intent(inout) :: test        !< counts the checks
    type(mechanism_type), intent(in) :: mechanism   !< of one coordinate
    real(wp), intent(out) :: q                      !< its value [rad]
    type(motion_type) :: motion
    type(error_type), allocatable :: err

    call motion%start_dynamics(mechanism, err)
    call motion%advance(5.0_wp, err)
    call test%no_error(err, 'the motion comes to its end')
    q = motion%q(1)
    call motion%close()
  end subroutine ride

  !> Whether this is the twelfth question.
  logical function is_twelfth(self)
    class(twelfth_time_type), intent(in) :: self   !< the interruption

    self%asked = self%asked + 1
    is_twelfth = self%asked == 12
  end function is_twelfth

  !> 2 kg under 4 N are stopped amid the steps to 100 s, where they are at t^2; from there on 8 N act.
  subroutine check_change_after_a_stop(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), parameter :: cart = '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''prismatic'', axis=1,0,0 / '// &
      '&body link=2, mass=2 / &load kind=''force'', link=2, force=4,0,0 / &initial coordinate=1, position=0, velocity=0 / '// &
      '&time end=100 /'
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(twelfth_time_type) :: interruption
    type(error_type), allocatable :: err
    integer, target :: asked
    real(wp) :: t

    asked = 0
    interruption%asked => asked
    call read_text(cart, mechanism, err)
    call test%no_error(err, 'a cart')
    call motion%start_dynamics(mechanism, err, interruption)
    call motion%advance(100.0_wp, err)
    call test%has_error(err, exit_interrupted, 'the motion is stopped')
    t = motion%t()
    call test%is_true(t > 0.01_wp .and. t < 100.0_wp, 'amid its steps')
    ! 1e-6 of the way: the tolerances are 1e-8, and a constant force makes no errors of the method
    call test%near(motion%q(1), t**2, 1e-6_wp*max(1.0_wp, t**2), 'time and position belong together')
    call motion%set('load(1).force(1)', 8.0_wp, err)
    call test%no_error(err, 'the force is changed there')
    call motion%advance(t + 1.0_wp, err)
    call test%no_error(err, 'the motion goes on from there')
    call test%near(motion%q(1), t**2 + 2.0_wp*t + 2.0_wp, 1e-6_wp*(1.0_wp + t)**2, 'with the new force for one second')
    call motion%close()
  end subroutine check_change_after_a_stop
end module test_library
