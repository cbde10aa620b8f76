!> MJCF in the neutral form: nested bodies, frames, joints with their references, defaults, and refusals.
module test_mjcf_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, fixed_joint, revolute_joint, prismatic_joint, free_joint
  use mech9_mjcf_reader, only: read_mjcf
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, has_message
  use xml_texts, only: read_lines
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_mjcf_reader.xml'
  real(wp), parameter :: pi = acos(-1.0_wp)
  real(wp), parameter :: tol = 1.0e-14_wp   ! a rotation and two products

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('bodies')) call bodies(tester)
    if (tester%runs('siblings')) call siblings(tester)
    if (tester%runs('several_joints')) call several_joints(tester)
    if (tester%runs('references')) call references(tester)
    if (tester%runs('frames_and_sites')) call frames_and_sites(tester)
    if (tester%runs('ranges')) call ranges(tester)
    if (tester%runs('options_and_actuators')) call options_and_actuators(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  subroutine read_robot(tester, lines, robot, err)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: lines(:)             !< the elements in <mujoco>
    type(robot_type), intent(out) :: robot               !< the robot
    type(error_type), allocatable, intent(out) :: err    !< failure of the reader
    type(xml_tree_type) :: tree

    call read_lines(tester, path, [character(len=110) :: '<mujoco model="m">', lines, '</mujoco>'], tree)
    call robot%begin('MJCF')
    call read_mjcf(tree, robot, err)
  end subroutine read_robot

  subroutine bodies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: '<worldbody><body name="a" pos="1 0 0">', &
      '<body name="b" pos="0 2 0" euler="0 0 90"><joint name="j" pos="0 0 3" axis="0 4 0"/></body>', &
      '<body><freejoint/></body></body></worldbody>'], robot, err)
    call tester%no_error(err, 'nested bodies')
    call tester%is_true(robot%n_links == 4 .and. robot%links(1)%name == 'world' .and. robot%name == 'm', 'the world is link 1')
    if (robot%n_joints /= 3) return
    call tester%is_true(robot%joints(1)%kind == fixed_joint .and. all(robot%joints(1)%links == [1, 2]), 'a body without joint')
    call near_vector(tester, robot%joints(1)%frames(1)%p, [1.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'it is fixed in its place')
    associate (j => robot%joints(2))
      call tester%is_true(j%kind == revolute_joint .and. all(j%links == [2, 3]), 'a joint is a hinge unless it says otherwise')
      call near_vector(tester, j%axis, [0.0_wp, 1.0_wp, 0.0_wp], 0.0_wp, 'its axis')
      call near_vector(tester, j%frames(1)%p, [0.0_wp, 2.0_wp, 3.0_wp], tol, 'its place in the body around it')
      call near_vector(tester, j%frames(2)%p, [0.0_wp, 0.0_wp, 3.0_wp], 0.0_wp, 'its place in its own body')
      call near_vector(tester, j%frames(1)%r(:, 1), [0.0_wp, 1.0_wp, 0.0_wp], tol, 'angles are in degrees')
    end associate
    call tester%is_true(robot%joints(3)%kind == free_joint .and. robot%joints(3)%links(2) == 4, 'a free joint')
  end subroutine bodies

  !> Each of several bodies in a body hangs on that body, whatever stands in the bodies before it.
  subroutine siblings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: '<worldbody><body name="a"><joint name="ja"/>', &
      '<body name="b"><joint name="jb"/><body name="c"><joint name="jc"/></body></body>', &
      '<body name="d"><joint name="jd"/></body>', &
      '<site name="s"/><inertial mass="5" pos="0 0 0"/></body></worldbody>'], robot, err)
    call tester%no_error(err, 'a tree of bodies')
    if (robot%n_joints /= 4) return
    call tester%is_true(all(robot%joints(2)%links == [2, 3]) .and. all(robot%joints(3)%links == [3, 4]), 'the first branch')
    call tester%is_true(all(robot%joints(4)%links == [2, 5]), 'the second branch begins at the body around it')
    call tester%is_true(robot%points(1)%link == 2, 'a site behind the bodies is in the body around it')
    call near_vector(tester, robot%links(:5)%mass, [0.0_wp, 5.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'and so is a mass')
  end subroutine siblings

  !> Links without mass stand between the joints of a body.
  subroutine several_joints(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: '<worldbody><body name="a" pos="1 0 0">', &
      '<joint name="x" type="slide" axis="1 0 0"/><joint name="z"/>', &
      '<inertial mass="3" pos="0 0 0"/></body></worldbody>'], robot, err)
    call tester%no_error(err, 'a body with two joints')
    call tester%is_true(robot%n_links == 3 .and. robot%n_joints == 2, 'three links')
    if (robot%n_joints /= 2) return
    call tester%is_true(robot%joints(1)%kind == prismatic_joint .and. all(robot%joints(1)%links == [1, 2]), 'the first joint')
    call tester%is_true(robot%joints(2)%kind == revolute_joint .and. all(robot%joints(2)%links == [2, 3]), 'the second joint')
    call near_vector(tester, robot%joints(2)%frames(1)%p, [0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'the body is placed once')
    call near_vector(tester, robot%links(:3)%mass, [0.0_wp, 0.0_wp, 3.0_wp], 0.0_wp, 'the last link has the mass')
    call tester%is_true(robot%links(3)%name == 'a', 'the last link has the name')
  end subroutine several_joints

  !> The body stands as placed where the coordinate is the reference.
  subroutine references(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: '<worldbody><body name="a"><joint name="j" ref="30" springref="60" ', &
      'stiffness="2" damping="3"/></body>', &
      '<body name="b" pos="0 0 5"><joint name="k" type="slide" ref="2"/></body></worldbody>'], robot, err)
    call tester%no_error(err, 'joints with references')
    if (robot%n_joints /= 2) return
    associate (j => robot%joints(1), k => robot%joints(2))
      call near_vector(tester, [j%start, j%rest, j%stiffness, j%damping], [pi/6.0_wp, pi/3.0_wp, 2.0_wp, 3.0_wp], tol, 'a spring')
      call near_vector(tester, j%frames(1)%r(:, 1), [cos(pi/6.0_wp), -sin(pi/6.0_wp), 0.0_wp], tol, 'zero of a hinge lies back')
      call near_vector(tester, k%frames(1)%p, [0.0_wp, 0.0_wp, 3.0_wp], tol, 'zero of a slide lies back by the reference')
      call tester%near(k%start, 2.0_wp, 0.0_wp, 'a slide starts at its reference, in metres')
    end associate
  end subroutine references

  !> Frames are no bodies: what stands in them belongs to the body around.
  subroutine frames_and_sites(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: '<compiler angle="radian"/><worldbody><body name="a">', &
      '<frame pos="1 0 0" euler="0 0 1.5707963267948966"><site name="s" pos="2 0 0"/><site pos="9 9 9"/>', &
      '<body name="b" pos="3 0 0"/></frame></body></worldbody>'], robot, err)
    call tester%no_error(err, 'a frame in a body')
    call tester%is_true(robot%n_points == 1 .and. robot%n_links == 3, 'a site with a name is a point')
    call near_vector(tester, robot%points(1)%position, [1.0_wp, 2.0_wp, 0.0_wp], tol, 'its place in the body')
    call near_vector(tester, robot%joints(2)%frames(1)%p, [1.0_wp, 3.0_wp, 0.0_wp], tol, 'the place of a body in a frame')
  end subroutine frames_and_sites

  subroutine ranges(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: '<default><joint range="-90 180"/>', &
      '<default class="free"><joint limited="false"/></default></default>', &
      '<worldbody><body name="a"><joint name="j"/></body><body name="b"><joint name="k" class="free"/></body>', &
      '<body name="c" childclass="free"><joint name="l" limited="true"/></body></worldbody>'], robot, err)
    call tester%no_error(err, 'ranges from defaults')
    if (robot%n_joints /= 3) return
    call tester%is_true(all(robot%joints(:3)%has_range .eqv. [.true., .false., .true.]), 'a range limits unless it says otherwise')
    call near_vector(tester, robot%joints(1)%range, [-0.5_wp*pi, pi], tol, 'a range in degrees')
    call near_vector(tester, robot%joints(3)%range, [-0.5_wp*pi, pi], tol, 'a range from the class around')
  end subroutine ranges

  subroutine options_and_actuators(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=110) :: '<option gravity="1 2 3"/><worldbody><body name="a"><joint name="j"/>', &
      '</body></worldbody><actuator><motor joint="j"/></actuator>'], robot, err)
    call near_vector(tester, robot%gravity, [1.0_wp, 2.0_wp, 3.0_wp], 0.0_wp, 'gravity')
    call tester%is_true(robot%joints(1)%is_preferred, 'a joint with a motor had better be independent')
    call read_robot(tester, [character(len=110) :: '<option gravity="1 2 3"><flag gravity="disable"/></option>'], robot, err)
    call near_vector(tester, robot%gravity, [0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'no gravity')
  end subroutine options_and_actuators

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused('<worldbody><replicate/></worldbody>', path//':2:12: <replicate> is not followed')
    call refused('<worldbody><body><joint type="hing"/></body></worldbody>', ":2:18: unknown type 'hing' of a joint")
    call refused('<worldbody><body><joint axis="0 0 0"/></body></worldbody>', ':2:18: the axis has no direction')
    call refused('<worldbody><body childclass="x"/></worldbody>', ":2:12: there is no class 'x' of defaults")
    call refused('<worldbody><body name="a"/><body name="a"/></worldbody>', ":2:28: there are two ")
    call refused('<worldbody><body quat="0 0 0 0"/></worldbody>', ':2:12: the orientation has no direction')
  contains
    subroutine refused(line, words)
      character(len=*), intent(in) :: line    !< the elements in <mujoco>
      character(len=*), intent(in) :: words   !< part of the message
      type(robot_type) :: robot
      type(error_type), allocatable :: err

      call read_robot(tester, [line], robot, err)
      call has_message(tester, err, exit_data, words, 'a refusal')
    end subroutine refused
  end subroutine refusals
end module test_mjcf_reader
