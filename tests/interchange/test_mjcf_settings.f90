!> Settings of MJCF: units of angles, forms of orientations, and classes of defaults.
module test_mjcf_settings
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_pose, only: pose_type
  use mech9_xml_tree, only: xml_tree_type
  use mech9_mjcf_settings, only: mjcf_settings_type, read_settings
  use mech9_testing, only: tester_type
  use mech9_checks, only: near_vector, near_matrix, has_message
  use xml_texts, only: read_lines
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_mjcf_settings.xml'
  real(wp), parameter :: tol = 1.0e-14_wp   ! products of three rotations

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('classes')) call classes(tester)
    if (tester%runs('orientations')) call orientations(tester)
    if (tester%runs('own_form_first')) call own_form_first(tester)
    if (tester%runs('compiler')) call compiler(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  !> A default of the class itself goes before one of the class around it.
  subroutine classes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(mjcf_settings_type) :: settings
    type(error_type), allocatable :: err
    integer :: joint, class

    call read_lines(tester, path, [character(len=110) :: '<mujoco><default><joint range="1 1" damping="1"/>', &
      '<default class="c"><joint range="2 2"/><default class="d"><joint axis="3 3 3"/></default></default></default>', &
      '<default><joint armature="4"/></default><joint stiffness="5"/></mujoco>'], tree)
    call read_settings(tree, settings, err)
    call tester%no_error(err, 'classes of defaults')
    call tester%is_true(settings%n_classes == 4, 'four elements of defaults')
    joint = tree%child(1, 'joint')
    class = settings%class_of(tree, 'd', joint, err)
    call tester%is_true(value('stiffness') == '5' .and. value('axis') == '3 3 3', 'the element itself, and its class')
    call tester%is_true(value('range') == '2 2' .and. value('damping') == '1', 'the classes around it')
    call tester%is_true(value('armature') == '4', 'another element of the main class')
    call tester%is_true(settings%holder(tree, joint, class, 'ref') == 0, 'none')
    class = settings%class_of(tree, 'main', joint, err)
    call tester%is_true(value('range') == '1 1' .and. value('axis') == '', 'the main class')
    class = settings%class_of(tree, 'e', joint, err)
    call has_message(tester, err, exit_data, "there is no class 'e' of defaults", 'a class that is not there')
  contains
    function value(name)
      character(len=*), intent(in) :: name   !< name of the attribute
      character(len=:), allocatable :: value

      value = tree%attribute(settings%holder(tree, joint, class, name), name)
    end function value
  end subroutine classes

  !> One turn about (1, 1, 1) by 120 degrees, which takes x to y and y to z, in all forms.
  subroutine orientations(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(mjcf_settings_type) :: settings
    type(error_type), allocatable :: err
    type(pose_type) :: pose
    real(wp), parameter :: r(3, 3) = reshape([0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp], [3, 3])
    integer :: e

    call read_lines(tester, path, [character(len=110) :: '<mujoco><g quat="1 1 1 1"/><g axisangle="2 2 2 120"/>', &
      '<g xyaxes="0 3 0 0 1 1"/><g euler="90 90 0"/></mujoco>'], tree)
    e = tree%first_child(1)
    do while (e > 0)
      call settings%get_pose(tree, e, 0, pose, err)
      call near_matrix(tester, pose%r, r, tol, 'a third of a turn about the diagonal')
      e = tree%next_sibling(e)
    end do
    call tester%no_error(err, 'all forms are good')
    call read_lines(tester, path, [character(len=110) :: '<mujoco><g zaxis="0 5 0" pos="1 2 3"/></mujoco>'], tree)
    call settings%get_pose(tree, 2, 0, pose, err)
    call near_vector(tester, [pose%p, pose%r(:, 3)], [1.0_wp, 2.0_wp, 3.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], tol, 'the axis z')
  end subroutine orientations

  subroutine own_form_first(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(mjcf_settings_type) :: settings
    type(error_type), allocatable :: err
    type(pose_type) :: pose

    call read_lines(tester, path, [character(len=110) :: '<mujoco><default><geom euler="90 0 0"/></default>', &
      '<geom quat="1 0 0 1"/><geom/></mujoco>'], tree)
    call read_settings(tree, settings, err)
    call settings%get_pose(tree, tree%child(1, 'geom'), 0, pose, err)
    call near_vector(tester, pose%r(:, 1), [0.0_wp, 1.0_wp, 0.0_wp], tol, 'the form of the element goes before another default')
    call settings%get_pose(tree, tree%next_named(tree%child(1, 'geom'), 'geom'), 0, pose, err)
    call near_vector(tester, pose%r(:, 2), [0.0_wp, 0.0_wp, 1.0_wp], tol, 'the default, where the element has no form')
  end subroutine own_form_first

  subroutine compiler(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(mjcf_settings_type) :: settings
    type(error_type), allocatable :: err

    call read_lines(tester, path, [character(len=110) :: '<mujoco><compiler angle="radian" eulerseq="ZYx" ', &
      'autolimits="false" inertiafromgeom="true"/></mujoco>'], tree)
    call read_settings(tree, settings, err)
    call tester%near(settings%angle_unit, 1.0_wp, 0.0_wp, 'angles in radians')
    call tester%is_true(settings%eulerseq == 'ZYx' .and. .not. settings%autolimits, 'order of turns, and limits')
    call tester%is_true(settings%from_geoms .and. .not. settings%never_from_geoms, 'inertia from shapes')
    call read_lines(tester, path, ['<mujoco><compiler inertiafromgeom="false"/></mujoco>'], tree)
    call read_settings(tree, settings, err)
    call tester%is_true(settings%never_from_geoms .and. .not. settings%from_geoms, 'no inertia from shapes')
    call tester%is_true(settings%eulerseq == 'xyz' .and. settings%autolimits, 'the defaults of the format')
  end subroutine compiler

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused('angle="grad"', "unknown unit of angles 'grad'")
    call refused('coordinate="global"', "coordinate='global' is of versions of MuJoCo before 2.3")
    call refused('eulerseq="xy"', "'eulerseq' must be three of the letters")
    call refused('eulerseq="xyw"', "'eulerseq' must be three of the letters")
  contains
    subroutine refused(attribute, words)
      character(len=*), intent(in) :: attribute   !< of <compiler>
      character(len=*), intent(in) :: words       !< part of the message
      type(xml_tree_type) :: tree
      type(mjcf_settings_type) :: settings
      type(error_type), allocatable :: err

      call read_lines(tester, path, [character(len=110) :: '<mujoco>', '<compiler '//attribute//'/></mujoco>'], tree)
      call read_settings(tree, settings, err)
      call has_message(tester, err, exit_data, path//':2:1: ', 'the place of a refusal')
      call has_message(tester, err, exit_data, words, 'its reason')
    end subroutine refused
  end subroutine refusals
end module test_mjcf_settings
