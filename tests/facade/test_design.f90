!> Designs: values set in code arrive to the bit, and are checked as those of a data file are.
module test_design
  use mech9, only: wp, design_type, mechanism_type, motion_type, error_type, read_text, exit_data, exit_usage
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_bits')) call check_bits(test)
    if (test%runs('check_refusals')) call check_refusals(test)
    if (test%runs('check_everything_else')) call check_everything_else(test)
    if (test%runs('check_path')) call check_path(test)
    if (test%runs('check_couplings')) call check_couplings(test)
    if (test%runs('check_compound_joint')) call check_compound_joint(test)
  end subroutine run

  !> A pendulum of length 1/3 that turns about y.
  subroutine pendulum(design)
    type(design_type), intent(out) :: design   !< gets the pendulum

    call design%independent([1])
    call design%pair(1, 'revolute', [1, 2], axis=[0.0_wp, 1.0_wp, 0.0_wp])
    call design%point('tip', 2, [0.0_wp, 0.0_wp, -1.0_wp/3.0_wp])
  end subroutine pendulum

  !> The start, the drive and a point of the pendulum are as they were set.
  subroutine check_bits(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(design_type) :: design
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err
    real(wp) :: p(3)

    call pendulum(design)
    call design%drive(1, [0.0_wp, 0.1_wp])
    call design%time(0.3_wp, 2.0_wp)
    call design%finish(mechanism, err)
    call test%no_error(err, 'a design of a pendulum is accepted')
    call motion%start_kinematics(mechanism, err)
    call test%no_error(err, 'a driven motion of the pendulum starts')
    call test%is_true(abs(motion%t() - 0.3_wp) <= 0.0_wp, 'the motion starts at the time that was set, to the bit')
    call test%is_true(abs(motion%q(1) - 0.1_wp*0.3_wp) <= spacing(0.03_wp), 'the coordinate follows the polynomial of its drive')
    call test%is_true(abs(motion%dq(1) - 0.1_wp) <= 0.0_wp, 'the coordinate has the rate that was set, to the bit')
    call motion%point('tip', err, position=p)
    call test%no_error(err, 'a point of the pendulum is found by its name')
    call test%near(p(3), -cos(0.03_wp)/3.0_wp, 1e-15_wp, 'the point of the pendulum lies on its circle')
    call motion%point('top', err)
    call test%has_error(err, exit_usage, 'a name that no point has is refused')
    call motion%close()
  end subroutine check_bits

  !> Two wheels and a rack: the couplings arrive, and their forces are those that turn the wheel and push the rack.
  subroutine check_couplings(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], x(3) = [1.0_wp, 0.0_wp, 0.0_wp]
    type(design_type) :: design
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err
    real(wp) :: force

    call design%independent([1])
    call design%pair(1, 'revolute', [1, 2], axis=z)
    call design%pair(2, 'revolute', [1, 3], axis=z, point=x)
    call design%pair(3, 'prismatic', [1, 4], axis=x)
    call design%coupling('gear', [1, 2], ratio=-1.0_wp/3.0_wp, phase=0.2_wp)
    call design%coupling('rack', [2, 3], radius=0.3_wp)
    call design%body(3, 1.0_wp, centre=x, inertia=[0.0_wp, 0.0_wp, 0.6_wp, 0.0_wp, 0.0_wp, 0.0_wp])
    call design%body(4, 2.0_wp)
    call design%drive(1, [0.0_wp, 0.0_wp, 1.5_wp])
    call design%add('output', 'reactions=.true.')
    call design%finish(mechanism, err)
    call test%no_error(err, 'a design with couplings is accepted')
    call motion%coupling_force(1, force, err)
    call test%has_error(err, exit_usage, 'forces of a motion that has not started are refused')
    call motion%start_kinematics(mechanism, err)
    call motion%advance(1.0_wp, err)
    call test%no_error(err, 'its motion runs')
    call test%near(motion%q(2), 0.2_wp - 0.5_wp, 1.0e-15_wp, 'the second wheel follows the first one')
    call test%near(motion%ddq(3), -0.3_wp, 1.0e-15_wp, 'the rack follows the second wheel')
    call motion%coupling_force(2, force, err)
    call test%no_error(err, 'the force of the rack is found')
    call test%near(force, -0.6_wp, 1.0e-14_wp, 'it pushes the rack: 2 kg times -0.3 m/s^2')
    call motion%coupling_force(1, force, err)
    call test%near(force, -0.6_wp - 0.18_wp, 1.0e-14_wp, 'the torque of the gear turns the wheel and pushes the rack')
    call motion%coupling_force(3, force, err)
    call test%has_error(err, exit_usage, 'a coupling that does not exist is refused')
    call motion%close()
  end subroutine check_couplings

  !> A bead on a straight wire through the points of a file, which is looked for in the current folder.
  subroutine check_path(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(design_type) :: design
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err
    real(wp) :: p(3)
    integer :: unit, i

    open (newunit=unit, file='wire.dat', status='replace', action='write')
    do i = 0, 4
      write (unit, '(2(es24.16e3,1x))') 0.3_wp*i, 0.4_wp*i
    end do
    close (unit)
    call design%independent([1])
    call design%pair(1, 'path', [1, 2], file='wire.dat', orientation='tangent')
    call design%drive(1, [0.25_wp, 1.0_wp])
    call design%point('bead', 2, [0.0_wp, 0.1_wp, 0.0_wp])
    call design%finish(mechanism, err)
    call test%no_error(err, 'a design with a path is accepted')
    call motion%start_kinematics(mechanism, err)
    call test%no_error(err, 'a motion along a path starts')
    call motion%point('bead', err, position=p)
    call test%near(p(1), 0.25_wp*0.6_wp - 0.1_wp*0.8_wp, 1e-14_wp, 'the bead stands beside its wire')
    call test%near(p(2), 0.25_wp*0.8_wp + 0.1_wp*0.6_wp, 1e-14_wp, 'the bead turns with its wire')
    call motion%close()
    open (newunit=unit, file='wire.dat', status='old')
    close (unit, status='delete')
  end subroutine check_path

  !> A shaft that drives another one at an angle beta by a universal joint: tan(q4) = cos(beta) tan(q1), with q1 and q4 counted from
  !> the position in which the fork of the first shaft stands across the plane of both.
  subroutine check_compound_joint(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: beta = 0.5_wp, angle = 0.7_wp, ahead(3) = [cos(beta), sin(beta), 0.0_wp], &
      across(3) = [-sin(beta), cos(beta), 0.0_wp], x(3) = [1.0_wp, 0.0_wp, 0.0_wp], y(3) = [0.0_wp, 1.0_wp, 0.0_wp], &
      z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    type(design_type) :: design
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err

    call design%independent([1])
    call design%pair(1, 'revolute', [1, 2], axis=x, zero=y)
    call design%pair(4, 'revolute', [1, 3], axis=ahead, zero=across)
    call design%pair([2, 3], 'universal', [2, 3], axis=z, moving_axis=across, point=[0.0_wp, 0.0_wp, 0.0_wp])
    call design%drive(1, [angle])
    call design%finish(mechanism, err)
    call test%no_error(err, 'a design with a universal joint is accepted')
    call motion%start_kinematics(mechanism, err)
    call test%no_error(err, 'a motion with a universal joint starts')
    call test%near(motion%q(4), atan2(cos(beta)*sin(angle), cos(angle)), 1e-14_wp, 'the shaft turns by the law of the joint')
    call motion%close()
    call design%pair([5, 6], 'spherical', [1, 3], moving_point=z)
    call design%finish(mechanism, err)
    call test%has_error(err, exit_data, 'a joint with too few coordinates is refused')
  end subroutine check_compound_joint

  subroutine check_refusals(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(design_type) :: design, empty
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err

    call empty%finish(mechanism, err)
    call test%has_error(err, exit_data, 'a design without anything is refused')
    call motion%start_dynamics(mechanism, err)
    call test%has_error(err, exit_usage, 'a mechanism that was refused has no motion')
    call pendulum(design)
    call design%pair(2, 'revolutte', [2, 3], axis=[0.0_wp, 1.0_wp, 0.0_wp])
    call design%body(2, -1.0_wp)
    call design%finish(mechanism, err)
    call test%has_error(err, exit_data, 'an unknown kind of pair is refused')
    call test%is_true(index(err%message, 'did you mean ''revolute''?') > 0, 'the message about an unknown kind names the known one')
    call test%is_true(index(err%message, '&body link=') > 0, 'the message about an unknown kind tells of the negative mass, too')
    call pendulum(design)
    call design%point('it''s', 2, [0.0_wp, 0.0_wp, 0.0_wp])
    call design%finish(mechanism, err)
    call test%has_error(err, exit_data, 'a name with a quote is refused')
    call test%is_true(index(err%message, 'not ''it''s''') > 0, 'the message shows the name with a quote as it was given')
    call pendulum(design)
    call design%finish(mechanism, err)
    call test%no_error(err, 'a design without a drive is accepted')
    call motion%start_kinematics(mechanism, err)
    call test%has_error(err, exit_data, 'a mechanism without a drive has no driven motion')
    call motion%start_dynamics(mechanism, err)
    call test%has_error(err, exit_data, 'a mechanism without an initial position has no free motion')
    call test%is_true(index(err%message, '&pair') > 0, 'the message about a missing initial position shows the pair')
    call design%drive(1, [0.0_wp, 0.1_wp])
    call design%finish(mechanism, err)
    call motion%start_dynamics(mechanism, err)
    call test%no_error(err, 'a mechanism whose only coordinate is driven has a motion in dynamics, too')
    call motion%advance(0.5_wp, err)
    call test%no_error(err, 'the motion of a mechanism whose only coordinate is driven goes on')
    call test%near(motion%q(1), 0.1_wp*0.5_wp, 1.0e-15_wp, 'the only coordinate follows its drive in dynamics')
    call motion%close()
    call read_text('&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,0 /', mechanism, err)
    call test%has_error(err, exit_data, 'a text with an axis of length zero is refused')
    call read_text('&structure cq=1,2 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /', mechanism, err)
    call test%is_true(allocated(err), 'a structure with an unknown coordinate is refused')
  end subroutine check_refusals

  !> Groups without a procedure of their own: a spring on a sliding mass. Its motion is a cosine.
  subroutine check_everything_else(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(design_type) :: design
    type(mechanism_type) :: mechanism
    type(motion_type) :: motion
    type(error_type), allocatable :: err
    real(wp) :: kinetic, potential

    call design%independent([1])
    call design%pair(1, 'prismatic', [1, 2], axis=[1.0_wp, 0.0_wp, 0.0_wp])
    call design%body(2, 2.0_wp)
    call design%add('load', 'kind=''coordinate'', coordinate=1, stiffness=8')
    call design%initial(1, 0.25_wp)
    call design%tolerances(1e-10_wp, 1e-12_wp)
    call design%finish(mechanism, err)
    call motion%start_dynamics(mechanism, err)
    call test%no_error(err, 'a design of a mass on a spring is accepted')
    call motion%advance(3.0_wp, err)
    call test%no_error(err, 'the mass moves beyond the end that was set')
    ! 3 s at 2 rad/s are some 100 steps, with an error of 1e-10 in each
    call test%near(motion%q(1), 0.25_wp*cos(6.0_wp), 1e-8_wp, 'the position of the mass is a cosine')
    call test%near(motion%dq(1), -0.5_wp*sin(6.0_wp), 1e-8_wp, 'the rate of the mass is the derivative of a cosine')
    call motion%energies(kinetic, potential)
    call test%near(kinetic, 0.25_wp*sin(6.0_wp)**2, 1e-8_wp, 'the kinetic energy of the mass is that of its closed form')
    call test%near(potential, 0.25_wp*cos(6.0_wp)**2, 1e-8_wp, 'the energy of the spring is that of its closed form')
    call motion%close()
  end subroutine check_everything_else
end module test_design
