!> SDF in the neutral form: links, joints with frames, axes and ranges, chains that close, and models that nothing holds.
module test_sdf_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type, fixed_joint, revolute_joint, prismatic_joint, helical_joint, free_joint
  use mech9_sdf_frames, only: sdf_frames_type, list_frames
  use mech9_sdf_joints, only: read_joints
  use mech9_sdf_reader, only: read_sdf
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, near_matrix, has_message
  use xml_texts, only: read_lines, symmetric
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_sdf_reader.xml'
  real(wp), parameter :: tol = 1.0e-14_wp   ! a few rotations and sums of numbers of order one
  character(len=*), parameter :: two_links = '<link name="a"/><link name="b"><pose>0 0 1 0 0 0</pose></link>'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('masses')) call masses(tester)
    if (tester%runs('joints')) call joints(tester)
    if (tester%runs('axes')) call axes(tester)
    if (tester%runs('ranges')) call ranges(tester)
    if (tester%runs('followers')) call followers(tester)
    if (tester%runs('closed_chain')) call closed_chain(tester)
    if (tester%runs('held_models')) call held_models(tester)
    if (tester%runs('joints_alone')) call joints_alone(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  subroutine read_robot(tester, lines, robot, err)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: lines(:)             !< the elements in the model
    type(robot_type), intent(out) :: robot               !< the robot
    type(error_type), allocatable, intent(out) :: err    !< failure of the reader
    type(xml_tree_type) :: tree

    call read_lines(tester, path, [character(len=140) :: '<sdf><world><gravity>0 0 -3</gravity><model name="m">', lines, &
                                   '</model></world></sdf>'], tree)
    call robot%begin('SDF')
    call read_sdf(tree, robot, err)
  end subroutine read_robot

  !> A link is 1 kg with moments of 1 kg m^2 unless the file tells it.
  subroutine masses(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=120) :: '<link name="a"/><link name="b"><inertial><mass>2</mass>', &
      '<pose degrees="1">1 2 3 0 0 90</pose><inertia><ixx>4</ixx><iyz>0.5</iyz></inertia></inertial></link>'], robot, err)
    call tester%no_error(err, 'two links')
    call tester%is_true(robot%n_links == 3 .and. robot%links(1)%name == 'world', 'the world is link 1')
    call near_vector(tester, robot%gravity, [0.0_wp, 0.0_wp, -3.0_wp], 0.0_wp, 'gravity of the world')
    call tester%near(robot%links(2)%mass, 1.0_wp, 0.0_wp, 'the mass that is not told')
    call near_matrix(tester, robot%links(2)%inertia, symmetric([1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]), 0.0_wp, &
                     'the inertia that is not told')
    call near_vector(tester, [robot%links(3)%mass, robot%links(3)%centre], [2.0_wp, 1.0_wp, 2.0_wp, 3.0_wp], 0.0_wp, 'a mass')
    call near_matrix(tester, robot%links(3)%inertia, symmetric([1.0_wp, 4.0_wp, 1.0_wp, 0.0_wp, -0.5_wp, 0.0_wp]), tol, &
                     'a tensor whose axes are turned')
  end subroutine masses

  subroutine joints(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=120) :: two_links, &
      '<joint name="w" type="fixed"><parent>world</parent><child>a</child></joint>', &
      '<joint name="j" type="screw"><parent>a</parent><child>b</child><pose>2 0 0 0 0 0</pose>', &
      '<axis><xyz>0 0 5</xyz></axis><screw_thread_pitch>0.25</screw_thread_pitch></joint>'], robot, err)
    call tester%no_error(err, 'two joints')
    call tester%is_true(robot%n_joints == 2, 'a model that is held needs no other joint')
    if (robot%n_joints /= 2) return
    call tester%is_true(robot%joints(1)%kind == fixed_joint .and. all(robot%joints(1)%links == [1, 2]), 'the world as parent')
    associate (j => robot%joints(2))
      call tester%is_true(j%kind == helical_joint .and. all(j%links == [2, 3]), 'a screw')
      call near_vector(tester, j%frames(1)%p, [2.0_wp, 0.0_wp, 1.0_wp], tol, 'its frame in the parent')
      call near_vector(tester, j%frames(2)%p, [2.0_wp, 0.0_wp, 0.0_wp], tol, 'its frame in the child')
      call near_vector(tester, [j%axis, j%pitch], [0.0_wp, 0.0_wp, 1.0_wp, 0.25_wp], 0.0_wp, 'axis and pitch')
    end associate
  end subroutine joints

  !> The frame of a joint turns with its child; the axis may be told in another frame.
  subroutine axes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err
    character(len=*), parameter :: ends = '<parent>a</parent><child>b</child>'

    call read_robot(tester, [character(len=140) :: '<link name="a"/><link name="b">', &
      '<pose degrees="1">0 0 0 0 0 90</pose></link>', &
      '<joint name="j" type="revolute">'//ends//'<axis><xyz expressed_in="__model__">1 0 0</xyz></axis></joint>', &
      '<joint name="k" type="revolute">'//ends//'<axis><xyz>1 0 0</xyz></axis></joint>', &
      '<joint name="l" type="revolute">'//ends//'</joint>'], robot, err)
    call tester%no_error(err, 'three axes')
    if (robot%n_joints < 3) return
    call near_vector(tester, robot%joints(1)%axis, [0.0_wp, -1.0_wp, 0.0_wp], tol, 'an axis that is told in the model')
    call near_vector(tester, robot%joints(2)%axis, [1.0_wp, 0.0_wp, 0.0_wp], tol, 'an axis that is told in the joint')
    call near_vector(tester, robot%joints(3)%axis, [0.0_wp, 0.0_wp, 1.0_wp], 0.0_wp, 'an axis that is not told')
  end subroutine axes

  !> A joint starts at zero, or in the middle of a range without zero, or at its end where the range has one end.
  subroutine ranges(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call starts_at('<lower>-1</lower><upper>2</upper>', .true., 0.0_wp)
    call starts_at('<lower>1</lower><upper>2</upper>', .true., 1.5_wp)
    call starts_at('<lower>1</lower>', .true., 1.0_wp)
    call starts_at('<upper>-2</upper>', .true., -2.0_wp)
    call starts_at('<lower>-1e16</lower><upper>1e16</upper>', .false., 0.0_wp)
  contains
    subroutine starts_at(limits, has_range, start)
      character(len=*), intent(in) :: limits   !< elements in <limit>
      logical, intent(in) :: has_range         !< whether the joint has a range
      real(wp), intent(in) :: start            !< its start [m]
      type(robot_type) :: robot
      type(error_type), allocatable :: err

      call read_robot(tester, [character(len=120) :: two_links, '<joint name="j" type="prismatic"><parent>a</parent>', &
        '<child>b</child><axis><limit>'//limits//'</limit><dynamics><damping>3</damping>', &
        '<spring_stiffness>4</spring_stiffness><spring_reference>5</spring_reference></dynamics></axis></joint>'], robot, err)
      call tester%no_error(err, 'a joint with a range')
      associate (j => robot%joints(1))
        call tester%is_true(j%kind == prismatic_joint .and. (j%has_range .eqv. has_range), 'whether there is a range')
        call near_vector(tester, [j%start, j%damping, j%stiffness, j%rest], [start, 3.0_wp, 4.0_wp, 5.0_wp], 0.0_wp, 'its numbers')
      end associate
    end subroutine starts_at
  end subroutine ranges

  !> The coordinate is multiplier (leader - reference) + offset.
  subroutine followers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=120) :: two_links, '<joint name="j" type="revolute"><parent>a</parent>', &
      '<child>b</child><axis><mimic joint="k"><multiplier>2</multiplier><offset>5</offset><reference>3</reference>', &
      '</mimic></axis></joint>'], robot, err)
    call tester%no_error(err, 'a joint that follows')
    call tester%is_true(robot%joints(1)%leader == 'k', 'its leader')
    call near_vector(tester, [robot%joints(1)%ratio, robot%joints(1)%offset], [2.0_wp, -1.0_wp], 0.0_wp, 'ratio and offset')
  end subroutine followers

  !> A joint whose child has a parent already closes a chain.
  subroutine closed_chain(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=120) :: two_links, &
      '<joint name="j" type="revolute"><parent>world</parent><child>a</child></joint>', &
      '<joint name="k" type="revolute"><parent>a</parent><child>b</child></joint>', &
      '<joint name="l" type="ball"><parent>world</parent><child>b</child></joint>'], robot, err)
    call tester%no_error(err, 'a closed chain')
    call tester%is_true(all(robot%joints(:3)%closes .eqv. [.false., .false., .true.]), 'the last joint closes it')
  end subroutine closed_chain

  !> Each group of links that no joint holds moves freely, or is fixed in a static model.
  subroutine held_models(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call read_robot(tester, [character(len=120) :: '<pose>7 0 0 0 0 0</pose>', two_links, '<link name="c"/>', &
      '<joint name="j" type="revolute"><parent>b</parent><child>a</child></joint>'], robot, err)
    call tester%no_error(err, 'links that nothing holds')
    call tester%is_true(robot%n_joints == 3 .and. all(robot%joints(2:3)%kind == free_joint), 'two groups move freely')
    if (robot%n_joints /= 3) return
    call tester%is_true(all(robot%joints(2)%links == [1, 2]) .and. all(robot%joints(3)%links == [1, 4]), 'by their first links')
    call near_vector(tester, robot%joints(2)%frames(1)%p, [7.0_wp, 0.0_wp, 0.0_wp], tol, 'in their places')
    call read_robot(tester, [character(len=120) :: '<static>true</static>', two_links], robot, err)
    call tester%is_true(robot%n_joints == 2 .and. all(robot%joints(:2)%kind == fixed_joint), 'a static model')
    call near_vector(tester, robot%joints(2)%frames(1)%p, [0.0_wp, 0.0_wp, 1.0_wp], tol, 'the place of its second link')
  end subroutine held_models

  !> The joints of a model, read without its links: each side must be a link that is known.
  subroutine joints_alone(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(robot_type) :: robot
    type(xml_tree_type) :: tree
    type(sdf_frames_type) :: frames
    type(error_type), allocatable :: err

    call read_lines(tester, path, [character(len=120) :: '<sdf><model name="m">', two_links, &
      '<joint name="g" type="gearbox"/><joint name="j" type="revolute"><parent>a</parent><child>b</child></joint>', &
      '</model></sdf>'], tree)
    call list_frames(tree, 2, frames, err)
    call robot%begin('SDF')
    call robot%add_link(tree, 2, 'world', err)
    call robot%add_link(tree, 3, 'a', err)
    call robot%add_link(tree, 4, 'b', err)
    call read_joints(tree, 2, '', frames, robot, err)
    call tester%no_error(err, 'joints of links that are known')
    call tester%is_true(robot%n_joints == 1 .and. robot%joints(1)%kind == revolute_joint, 'a gearbox is not taken over')
    call tester%is_true(robot%n_notes == 1, 'a note tells so')
  end subroutine joints_alone

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused('<joint name="j" type="hinge"/>', "4:1: unknown type 'hinge' of a joint")
    call refused('<joint name="j" type="ball"><parent>a</parent></joint>', '4:1: ')
    call refused('<joint name="j" type="ball"><child>b</child></joint>', "4:1: joint 'j' has no <parent>")
    call refused('<joint name="j" type="ball"><parent>c</parent><child>b</child></joint>', "4:29: there is no link 'c', which")
    call refused('<joint name="j" type="ball"><parent>b</parent><child>b</child></joint>', "joint 'j' joins a link with itself")
    call refused('<joint name="j" type="screw"><parent>a</parent><child>b</child></joint>', &
                 "the screw 'j' needs <screw_thread_pitch>")
    call refused('<include/>', '<include> in a model is not followed')
    call refused('<link name="c"><inertial><mass>-1</mass></inertial></link>', "the mass of link 'c' is negative")
    call refused('<link name="a"/>', "there are two links 'a'")
  contains
    subroutine refused(line, words)
      character(len=*), intent(in) :: line    !< fourth line of the document
      character(len=*), intent(in) :: words   !< part of the message
      type(robot_type) :: robot
      type(error_type), allocatable :: err

      call read_robot(tester, [character(len=120) :: '<pose/>', two_links, line], robot, err)
      call has_message(tester, err, exit_data, words, 'a refusal')
    end subroutine refused
  end subroutine refusals
end module test_sdf_reader
