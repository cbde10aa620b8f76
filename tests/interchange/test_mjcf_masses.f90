!> Masses of links in MJCF: told by <inertial>, or of shapes that are put together, against closed forms.
module test_mjcf_masses
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, robot_link_type
  use mech9_mjcf_settings, only: mjcf_settings_type, read_settings
  use mech9_mjcf_masses, only: mjcf_around_type, read_inertial, add_geom
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, near_matrix, has_message
  use xml_texts, only: read_lines, symmetric
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_mjcf_masses.xml'
  real(wp), parameter :: pi = acos(-1.0_wp)
  real(wp), parameter :: tol = 1.0e-13_wp   ! some twenty products and sums of numbers of order one

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('inertial')) call inertial(tester)
    if (tester%runs('two_halves')) call two_halves(tester)
    if (tester%runs('from_to')) call from_to(tester)
    if (tester%runs('densities')) call densities(tester)
    if (tester%runs('no_mass')) call no_mass(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  !> The mass of all elements <geom> in the root.
  subroutine add_all(tester, lines, link, robot, err)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: lines(:)             !< the elements in <mujoco>
    type(robot_link_type), intent(out) :: link           !< the link
    type(robot_type), intent(out) :: robot               !< gets notes
    type(error_type), allocatable, intent(out) :: err    !< the failure
    type(mjcf_settings_type) :: settings
    type(xml_tree_type) :: tree
    integer :: e

    call read_lines(tester, path, [character(len=110) :: '<mujoco>', lines, '</mujoco>'], tree)
    call robot%begin('MJCF')
    call read_settings(tree, settings, err)
    e = tree%child(1, 'geom')
    do while (e > 0)
      call add_geom(tree, e, settings, mjcf_around_type(), robot, err)
      e = tree%next_named(e, 'geom')
    end do
    link = robot%links(1)
  end subroutine add_all

  subroutine inertial(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(mjcf_settings_type) :: settings
    type(robot_link_type) :: link
    type(error_type), allocatable :: err

    link%name = 'a'
    call read_lines(tester, path, [character(len=110) :: '<mujoco><inertial mass="2" pos="1 2 3" axisangle="0 0 1 90" ', &
      'diaginertia="1 2 3"/><inertial mass="2" fullinertia="1 2 3 0.1 0.2 0.3"/><inertial mass="-2"/></mujoco>'], tree)
    call read_inertial(tree, 2, settings, link, err)
    call near_vector(tester, [link%mass, link%centre], [2.0_wp, 1.0_wp, 2.0_wp, 3.0_wp], 0.0_wp, 'mass and mass centre')
    call near_matrix(tester, link%inertia, symmetric([2.0_wp, 1.0_wp, 3.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]), tol, &
                     'a quarter turn about z exchanges the moments about x and y')
    call read_inertial(tree, 3, settings, link, err)
    call near_matrix(tester, link%inertia, symmetric([1.0_wp, 2.0_wp, 3.0_wp, 0.1_wp, 0.2_wp, 0.3_wp]), 0.0_wp, 'a full tensor')
    call tester%no_error(err, 'both are good')
    call read_inertial(tree, 4, settings, link, err)
    call has_message(tester, err, exit_data, "the mass of link 'a' is negative", 'a negative mass')
  end subroutine inertial

  !> Two boxes side by side, one of them turned, are one box.
  subroutine two_halves(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_link_type) :: whole, halves
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call add_all(tester, ['<geom type="box" size="0.4 0.2 0.3" mass="6" pos="1 1 1"/>'], whole, robot, err)
    call tester%near(whole%inertia(1, 1), 6.0_wp*(0.2_wp**2 + 0.3_wp**2)/3.0_wp, tol, 'a moment of a box')
    call add_all(tester, [character(len=110) :: '<geom type="box" size="0.2 0.2 0.3" mass="3" pos="0.8 1 1"/>', &
      '<geom type="box" size="0.2 0.3 0.2" mass="3" pos="1.2 1 1" euler="90 0 0"/>'], halves, robot, err)
    call tester%no_error(err, 'two boxes')
    call tester%near(halves%mass, whole%mass, tol, 'masses add up')
    call near_vector(tester, halves%centre, whole%centre, tol, 'the mass centre')
    call near_matrix(tester, halves%inertia, whole%inertia, tol, 'the tensor about it')
  end subroutine two_halves

  !> A rod between two points: its moment about its own axis is small, its centre is in the middle.
  subroutine from_to(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_link_type) :: link
    type(robot_type) :: robot
    type(error_type), allocatable :: err
    real(wp), parameter :: r = 0.1_wp, h = 4.0_wp
    real(wp) :: across

    call add_all(tester, ['<geom type="cylinder" size="0.1" fromto="1 0 0 5 0 0" mass="2"/>'], link, robot, err)
    call tester%no_error(err, 'a cylinder between two points')
    across = 2.0_wp*(3.0_wp*r**2 + h**2)/12.0_wp
    call near_vector(tester, link%centre, [3.0_wp, 0.0_wp, 0.0_wp], tol, 'its centre')
    call near_matrix(tester, link%inertia, symmetric([r**2, across, across, 0.0_wp, 0.0_wp, 0.0_wp]), tol, 'its tensor')
    call add_all(tester, ['<geom type="box" size="0.1" fromto="0 0 -1 0 0 1" density="3"/>'], link, robot, err)
    call tester%near(link%mass, 3.0_wp*0.2_wp*0.2_wp*2.0_wp, tol, 'a box is as deep as it is wide')
  end subroutine from_to

  !> A shape is a sphere of density 1000 unless it says otherwise, and defaults may say so.
  subroutine densities(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_link_type) :: link
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call add_all(tester, ['<geom size="0.5"/>'], link, robot, err)
    call tester%near(link%mass, 1000.0_wp*pi/6.0_wp, tol, 'a sphere of water')
    call add_all(tester, ['<default><geom type="cylinder" density="2"/></default><geom size="1 0.5"/>'], link, robot, err)
    call tester%near(link%mass, 2.0_wp*pi, tol, 'a cylinder by the defaults')
    call add_all(tester, ['<default><geom type="cylinder" density="2"/></default><geom size="1 0.5" mass="7"/>'], link, robot, err)
    call tester%near(link%mass, 7.0_wp, tol, 'a mass goes before a density')
  end subroutine densities

  subroutine no_mass(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_link_type) :: link
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call add_all(tester, [character(len=110) :: '<geom size="1" mass="0"/><geom size="1" density="0"/>', &
      '<geom type="plane" size="1 1 1"/><geom type="mesh" mesh="m"/><geom mesh="m"/>'], link, robot, err)
    call tester%no_error(err, 'shapes without mass')
    call near_vector(tester, [link%mass, link%centre], [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'the link has no mass')
    call tester%is_true(robot%n_notes == 1 .and. robot%notes(1)%times == 2, 'meshes are not taken over')
  end subroutine no_mass

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_link_type) :: link
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call add_all(tester, ['<geom/>'], link, robot, err)
    call has_message(tester, err, exit_data, path//":2:1: 'size' must hold numbers above 0", 'a shape without size')
    call add_all(tester, ['<geom size="1 -1" type="capsule"/>'], link, robot, err)
    call has_message(tester, err, exit_data, "'size' must hold numbers above 0", 'a negative size')
  end subroutine refusals
end module test_mjcf_masses
