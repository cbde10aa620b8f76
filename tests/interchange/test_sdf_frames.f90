!> Frames of SDF: poses relative to each other, nested models, placement frames, and frames that stand in themselves.
module test_sdf_frames
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_pose, only: pose_type
  use mech9_xml_tree, only: xml_tree_type
  use mech9_robot, only: robot_type
  use mech9_sdf_frames, only: sdf_frames_type, list_frames, own_pose
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, has_message
  use xml_texts, only: read_lines
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_sdf_frames.xml'
  real(wp), parameter :: tol = 1.0e-14_wp   ! three rotations and sums of numbers of order one

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('poses')) call poses(tester)
    if (tester%runs('chain_of_frames')) call chain_of_frames(tester)
    if (tester%runs('nested_models')) call nested_models(tester)
    if (tester%runs('placement_frame')) call placement_frame(tester)
    if (tester%runs('links_of_frames')) call links_of_frames(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  !> Read the frames of a model, whose element is number 2.
  subroutine frames_of(tester, lines, tree, frames, err)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: lines(:)             !< element of the model
    type(xml_tree_type), intent(out) :: tree             !< the document
    type(sdf_frames_type), intent(out) :: frames         !< its frames
    type(error_type), allocatable, intent(out) :: err    !< the failure

    call read_lines(tester, path, [character(len=110) :: '<sdf version="1.9">', lines, '</sdf>'], tree)
    call list_frames(tree, 2, frames, err)
  end subroutine frames_of

  !> The same pose in all its forms.
  subroutine poses(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err
    type(pose_type) :: pose
    integer :: e

    call read_lines(tester, path, [character(len=110) :: '<sdf><a><pose>1 2 3 0 0 1.5707963267948966</pose></a>', &
      '<a><pose degrees="true">1 2 3 0 0 90</pose></a>', &
      '<a><pose rotation_format="quat_xyzw">1 2 3 0 0 2 2</pose></a></sdf>'], tree)
    e = tree%first_child(1)
    do while (e > 0)
      call own_pose(tree, e, pose, err)
      call near_vector(tester, [pose%p, pose%r(:, 1)], [1.0_wp, 2.0_wp, 3.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], tol, 'a quarter turn')
      e = tree%next_sibling(e)
    end do
    call own_pose(tree, 1, pose, err)
    call tester%no_error(err, 'all forms are good')
    call near_vector(tester, [pose%p, pose%r(:, 1)], [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'no pose')
  end subroutine poses

  !> f stands in b, which stands in a, each a step along x and a quarter turn about z further.
  subroutine chain_of_frames(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(sdf_frames_type) :: frames
    type(error_type), allocatable :: err
    type(pose_type) :: pose
    character(len=*), parameter :: step = '<pose degrees="1" relative_to="'

    call frames_of(tester, [character(len=110) :: '<model name="m"><pose>0 0 7 0 0 0</pose>', &
      '<frame name="f">'//step//'b">1 0 0 0 0 90</pose></frame>', &
      '<link name="b">'//step//'a">1 0 0 0 0 90</pose></link>', &
      '<link name="a">'//step//'">1 0 0 0 0 90</pose></link>', &
      '<joint name="j"><parent>a</parent><child>b</child></joint></model>'], tree, frames, err)
    call tester%no_error(err, 'frames in any order')
    call frames%in_model(tree, 2, '', 'f', pose, err)
    call near_vector(tester, pose%p, [0.0_wp, 1.0_wp, 0.0_wp], tol, 'three steps on three sides of a square')
    call near_vector(tester, pose%r(:, 1), [0.0_wp, -1.0_wp, 0.0_wp], tol, 'three quarter turns')
    call frames%in_model(tree, 2, '', 'j', pose, err)
    call near_vector(tester, pose%p, [1.0_wp, 1.0_wp, 0.0_wp], tol, 'a joint stands in its child')
    call frames%in_model(tree, 2, '', '__model__', pose, err)
    call near_vector(tester, pose%p, [0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'the model stands in itself')
    call near_vector(tester, frames%model%p, [0.0_wp, 0.0_wp, 7.0_wp], 0.0_wp, 'the model stands in the world')
    call tester%no_error(err, 'all frames are found')
  end subroutine chain_of_frames

  subroutine nested_models(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(sdf_frames_type) :: frames
    type(error_type), allocatable :: err
    type(pose_type) :: pose

    call frames_of(tester, [character(len=110) :: '<model name="m"><link name="a"/><model name="n"><pose>1 0 0 0 0 0</pose>', &
      '<link name="a"><pose>0 2 0 0 0 0</pose></link><frame name="g" attached_to="a"/></model>', &
      '<frame name="h"><pose relative_to="n::g">0 0 3 0 0 0</pose></frame></model>'], tree, frames, err)
    call tester%no_error(err, 'a model in a model')
    call frames%in_model(tree, 2, '', 'h', pose, err)
    call near_vector(tester, pose%p, [1.0_wp, 2.0_wp, 3.0_wp], tol, 'a frame in a frame of the nested model')
    call frames%in_model(tree, 2, 'n::', 'a', pose, err)
    call near_vector(tester, pose%p, [1.0_wp, 2.0_wp, 0.0_wp], tol, 'a name in the nested model')
    call frames%in_model(tree, 2, 'n::', '', pose, err)
    call near_vector(tester, pose%p, [1.0_wp, 0.0_wp, 0.0_wp], tol, 'the frame of the nested model')
    call tester%no_error(err, 'all frames are found')
  end subroutine nested_models

  !> The pose of a model places the frame that it names.
  subroutine placement_frame(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(sdf_frames_type) :: frames
    type(error_type), allocatable :: err
    type(pose_type) :: pose

    call frames_of(tester, [character(len=110) :: '<model name="m" placement_frame="a"><pose>5 0 0 0 0 0</pose>', &
      '<link name="a"><pose>1 0 0 0 0 0</pose></link>', '<model name="n" placement_frame="b"><pose>0 3 0 0 0 0</pose>', &
      '<link name="b"><pose degrees="1">0 1 0 0 0 90</pose></link></model></model>'], tree, frames, err)
    call tester%no_error(err, 'models placed by frames')
    call near_vector(tester, frames%model%p, [4.0_wp, 0.0_wp, 0.0_wp], tol, 'the model stands back by the place of its frame')
    call frames%in_model(tree, 2, 'n::', 'b', pose, err)
    call near_vector(tester, [pose%p, pose%r(:, 1)], [0.0_wp, 3.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp], tol, 'the frame is placed')
  end subroutine placement_frame

  subroutine links_of_frames(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(sdf_frames_type) :: frames
    type(robot_type) :: robot
    type(error_type), allocatable :: err

    call frames_of(tester, [character(len=110) :: '<model name="m"><link name="a"/><frame name="f" attached_to="g"/>', &
      '<frame name="g" attached_to="n"/><model name="n"><link name="b"/></model></model>'], tree, frames, err)
    call robot%begin('SDF')
    call robot%add_link(tree, 2, 'a', err)
    call robot%add_link(tree, 2, 'n::b', err)
    call tester%is_true(frames%find_link(robot, '', 'f') == 2, 'a frame is attached to a frame of a model, which has a first link')
    call tester%is_true(frames%find_link(robot, 'n::', 'b') == 2 .and. frames%find_link(robot, '', 'a') == 1, 'links themselves')
    call tester%is_true(frames%find_link(robot, '', 'b') == 0, 'a name of the nested model is not known outside')
  end subroutine links_of_frames

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(sdf_frames_type) :: frames
    type(error_type), allocatable :: err
    type(pose_type) :: pose

    call frames_of(tester, [character(len=110) :: '<model name="m"><link name="a"><pose relative_to="b"/></link>', &
      '<link name="b"><pose relative_to="a"/></link><link name="c"><pose relative_to="d"/></link></model>'], tree, frames, err)
    call frames%in_model(tree, 2, '', 'a', pose, err)
    call has_message(tester, err, exit_data, path//":2:1: the frame 'a' stands in itself", 'a circle of frames')
    deallocate (err)
    call frames%in_model(tree, 2, '', 'c', pose, err)
    call has_message(tester, err, exit_data, "there is no frame 'd'", 'a frame that is not there')
    call refused('<pose rotation_format="quat_xyzw">0 0 0 0 0 0 0</pose>', 'the quaternion of <pose> is zero')
    call refused('<pose rotation_format="quat_xyzw" degrees="true">0 0 0 0 0 0 1</pose>', 'a quaternion has no degrees')
    call refused('<pose rotation_format="matrix">0</pose>', "unknown rotation_format 'matrix'")
    call refused('<pose>1 2 3</pose>', '<pose> must hold 6 numbers, not 3')
    call frames_of(tester, ['<model name="m"><pose relative_to="table"/><link name="a"/></model>'], tree, frames, err)
    call has_message(tester, err, exit_data, "the model stands in the frame 'table' of the world", 'a frame of the world')
  contains
    subroutine refused(line, words)
      character(len=*), intent(in) :: line    !< element of a pose
      character(len=*), intent(in) :: words   !< part of the message

      call frames_of(tester, [character(len=110) :: '<model name="m"><link name="a">', line, '</link></model>'], tree, frames, err)
      call has_message(tester, err, exit_data, path//':3:1: '//words, 'a pose that is refused')
    end subroutine refused
  end subroutine refusals
end module test_sdf_frames
