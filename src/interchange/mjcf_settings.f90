!> The settings of an MJCF file that hold for all its elements: units and forms of angles, classes of defaults, inertia from shapes.
module mech9_mjcf_settings
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: identity, unit, cross, about_axis
  use mech9_pose, only: pose_type
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: get_numbers, is_true
  use mech9_orientations, only: from_quaternion, orientation_from_z, from_euler
  implicit none
  private
  public :: mjcf_settings_type, read_settings

  real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
  integer, parameter :: most_classes = 1000

  !> The settings, with the elements <default> by their numbers.
  type :: mjcf_settings_type
    real(wp) :: angle_unit = degree                 !< unit of angles [rad]
    character(len=3) :: eulerseq = 'xyz'            !< axes of Euler angles; small letters turn with the frame, capitals do not
    logical :: autolimits = .true.                  !< a range limits a joint unless it says otherwise
    logical :: from_geoms = .false.                 !< shapes give the inertia of links that have one, too
    logical :: never_from_geoms = .false.           !< shapes give no inertia
    integer :: n_classes = 0                        !< number of elements <default>
    integer, private :: classes(most_classes) = 0   !< numbers of these elements
  contains
    procedure :: class_of
    procedure :: holder
    procedure :: get_pose
    procedure :: get_rotation
  end type mjcf_settings_type

contains

  !> Read the elements <compiler> and <default> of a document.
  subroutine read_settings(tree, settings, err)
    type(xml_tree_type), intent(in) :: tree             !< the document
    type(mjcf_settings_type), intent(out) :: settings   !< the settings
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: e

    e = tree%first_child(1)
    do while (e > 0 .and. .not. allocated(err))
      if (tree%name(e) == 'compiler') call read_compiler(tree, e, settings, err)
      if (tree%name(e) == 'default') call list_classes(tree, e, settings, err)
      e = tree%next_sibling(e)
    end do
  end subroutine read_settings

  !> Read an element <compiler>.
  subroutine read_compiler(tree, element, settings, err)
    type(xml_tree_type), intent(in) :: tree               !< the document
    integer, intent(in) :: element                        !< number of the element
    type(mjcf_settings_type), intent(inout) :: settings   !< gets its attributes
    type(error_type), allocatable, intent(inout) :: err   !< the failure
    character(len=:), allocatable :: word

    word = tree%attribute(element, 'angle')
    if (word == 'radian') settings%angle_unit = 1.0_wp
    if (word == 'degree') settings%angle_unit = degree
    if (all(word /= [character(len=6) :: '', 'radian', 'degree'])) &
      call tree%fail(element, "unknown unit of angles '"//word//"'", err)
    if (tree%attribute(element, 'coordinate') == 'global') &
      call tree%fail(element, "coordinate='global' is of versions of MuJoCo before 2.3; let one of them write the model anew", err)
    if (tree%has(element, 'eulerseq')) then
      word = tree%attribute(element, 'eulerseq')
      if (len(word) /= 3 .or. verify(word, 'xyzXYZ') > 0) &
        call tree%fail(element, "'eulerseq' must be three of the letters x, y, z, X, Y, Z, not '"//word//"'", err)
      if (.not. allocated(err)) settings%eulerseq = word
    end if
    if (tree%has(element, 'autolimits')) settings%autolimits = is_true(tree%attribute(element, 'autolimits'))
    if (tree%has(element, 'inertiafromgeom')) then
      settings%from_geoms = tree%attribute(element, 'inertiafromgeom') == 'true'
      settings%never_from_geoms = tree%attribute(element, 'inertiafromgeom') == 'false'
    end if
  end subroutine read_compiler

  !> List an element <default> and those in it.
  recursive subroutine list_classes(tree, element, settings, err)
    type(xml_tree_type), intent(in) :: tree               !< the document
    integer, intent(in) :: element                        !< number of the element
    type(mjcf_settings_type), intent(inout) :: settings   !< gets the elements
    type(error_type), allocatable, intent(inout) :: err   !< the failure
    integer :: e

    if (settings%n_classes == most_classes) call tree%fail(element, 'there are too many classes of defaults', err)
    if (allocated(err)) return
    settings%n_classes = settings%n_classes + 1
    settings%classes(settings%n_classes) = element
    e = tree%child(element, 'default')
    do while (e > 0)
      call list_classes(tree, e, settings, err)
      e = tree%next_named(e, 'default')
    end do
  end subroutine list_classes

  !> The element <default> of a class; 0 for the main class, and where there is none of the name.
  integer function class_of(self, tree, name, element, err) result(class)
    class(mjcf_settings_type), intent(in) :: self        !< the settings
    type(xml_tree_type), intent(in) :: tree              !< the document
    character(len=*), intent(in) :: name                 !< name of the class; empty: the main class
    integer, intent(in) :: element                       !< number of the element that names it, for messages
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    integer :: i

    class = 0
    if (name == '' .or. name == 'main') return
    do i = 1, self%n_classes
      class = self%classes(i)
      if (tree%attribute(class, 'class') == name) return
    end do
    class = 0
    call tree%fail(element, "there is no class '"//name//"' of defaults", err)
  end function class_of

  !> The element that holds an attribute of an element: itself, or a default of its class or of a class around that; 0: none.
  integer function holder(self, tree, element, class, attribute)
    class(mjcf_settings_type), intent(in) :: self  !< the settings
    type(xml_tree_type), intent(in) :: tree        !< the document
    integer, intent(in) :: element                 !< number of the element
    integer, intent(in) :: class                   !< number of its element <default>; 0: the main class
    character(len=*), intent(in) :: attribute      !< name of the attribute
    integer :: level, i

    holder = element
    if (tree%has(element, attribute)) return
    level = class
    do while (level > 1)
      holder = tree%child(level, tree%name(element))
      if (tree%has(holder, attribute)) return
      level = tree%parent(level)
    end do
    ! the main class may stand in several elements of the root
    do i = self%n_classes, 1, -1
      if (tree%parent(self%classes(i)) /= 1) cycle
      holder = tree%child(self%classes(i), tree%name(element))
      if (tree%has(holder, attribute)) return
    end do
    holder = 0
  end function holder

  !> The pose that an element tells by `pos` and one of the forms of orientation.
  subroutine get_pose(self, tree, element, class, pose, err)
    class(mjcf_settings_type), intent(in) :: self        !< the settings
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    integer, intent(in) :: class                         !< number of its element <default>; 0: the main class
    type(pose_type), intent(out) :: pose                 !< its frame in that of the element around it
    type(error_type), allocatable, intent(inout) :: err  !< the failure

    call get_numbers(tree, self%holder(tree, element, class, 'pos'), 'pos', pose%p, err)
    call self%get_rotation(tree, element, class, pose%r, err)
  end subroutine get_pose

  !> The orientation that an element tells by a quaternion, axis and angle, axes, or Euler angles.
  subroutine get_rotation(self, tree, element, class, r, err)
    class(mjcf_settings_type), intent(in) :: self        !< the settings
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    integer, intent(in) :: class                         !< number of its element <default>; 0: the main class
    real(wp), intent(out) :: r(3, 3)                     !< turns components in its frame into those in the frame around it
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=9), parameter :: forms(5) = [character(len=9) :: 'quat', 'axisangle', 'xyaxes', 'zaxis', 'euler']
    real(wp) :: quat(4), axisangle(4), xyaxes(6), zaxis(3), euler(3)
    integer :: holders(5), i

    r = identity
    holders = [(self%holder(tree, element, class, trim(forms(i))), i=1, 5)]
    quat = 0.0_wp
    axisangle = 0.0_wp
    xyaxes = 0.0_wp
    zaxis = 0.0_wp
    euler = 0.0_wp
    call get_numbers(tree, holders(1), 'quat', quat, err)
    call get_numbers(tree, holders(2), 'axisangle', axisangle, err)
    call get_numbers(tree, holders(3), 'xyaxes', xyaxes, err)
    call get_numbers(tree, holders(4), 'zaxis', zaxis, err)
    call get_numbers(tree, holders(5), 'euler', euler, err)
    if (allocated(err)) return
    ! a form that the element itself has goes before one from its defaults
    if (any(holders == element)) where (holders /= element) holders = 0
    if (holders(1) > 0) r = from_quaternion(quat)
    if (holders(2) > 0) r = about_axis(unit(axisangle(:3)), axisangle(4)*self%angle_unit)
    if (holders(3) > 0) then
      r(:, 1) = unit(xyaxes(:3))
      r(:, 2) = unit(xyaxes(4:) - dot_product(xyaxes(4:), r(:, 1))*r(:, 1))
      r(:, 3) = cross(r(:, 1), r(:, 2))
      if (norm2(r(:, 3)) < 0.5_wp) call tree%fail(element, "'xyaxes' must be two directions", err)
    end if
    if (holders(4) > 0) r = orientation_from_z(zaxis)
    if (holders(5) > 0) r = from_euler(euler*self%angle_unit, self%eulerseq)
    if ((holders(1) > 0 .and. .not. any(abs(quat) > 0.0_wp)) .or. &
        (holders(2) > 0 .and. .not. any(abs(axisangle(:3)) > 0.0_wp)) .or. &
        (holders(4) > 0 .and. .not. any(abs(zaxis) > 0.0_wp))) &
      call tree%fail(element, 'the orientation has no direction: its numbers are all zero', err)
  end subroutine get_rotation
end module mech9_mjcf_settings
