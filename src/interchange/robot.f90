!> A robot in neutral form: links with their masses, joints with a frame in each of their two links. The readers of all formats
!> make it, and one writer turns it into a data file.
!>
!> Joints with several freedoms stay whole here. Link 1 is the frame.
module mech9_robot
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_printable, only: printable
  use mech9_rotation, only: cross
  use mech9_pose, only: pose_type
  use mech9_xml_tree, only: xml_tree_type
  implicit none
  private
  public :: robot_type, robot_link_type, robot_joint_type, robot_point_type, note_type, note_of_ranges, most_links, most_joints
  public :: fixed_joint, revolute_joint, prismatic_joint, helical_joint, cylindrical_joint, universal_joint, spherical_joint, &
            planar_joint, free_joint

  !> Larger numbers of links and joints are no robot for these programs; more different notes help nobody.
  integer, parameter :: most_links = 1000, most_joints = 2000, most_notes = 200

  !> Kinds of joints.
  integer, parameter :: fixed_joint = 0, revolute_joint = 1, prismatic_joint = 2, helical_joint = 3, cylindrical_joint = 4, &
                        universal_joint = 5, spherical_joint = 6, planar_joint = 7, free_joint = 8

  !> Axes of a universal joint are parallel below this sine of their angle.
  real(wp), parameter :: least_sine = 1.0e-6_wp
  !> The note for joints that have ranges.
  character(len=*), parameter :: note_of_ranges = &
    'ranges of joints, which comments of the data file tell; write a &stop to keep one'

  !> A link.
  type :: robot_link_type
    character(len=:), allocatable :: name     !< as the file has it
    character(len=:), allocatable :: place    !< file and line, for notes
    real(wp) :: mass = 0.0_wp                 !< [kg]
    real(wp) :: centre(3) = 0.0_wp            !< mass centre, in the frame of the link [m]
    real(wp) :: inertia(3, 3) = 0.0_wp        !< tensor about the mass centre, in the axes of the link [kg m^2]
  end type robot_link_type

  !> A joint. Its two frames coincide where all its coordinates are zero.
  type :: robot_joint_type
    character(len=:), allocatable :: name     !< as the file has it
    character(len=:), allocatable :: place    !< file, line and column, for messages
    integer :: kind = fixed_joint             !< one of the kinds above
    integer :: links(2) = 0                   !< numbers of the reference link and the moving link
    type(pose_type) :: frames(2)              !< pose of the joint's frame in each of the two links
    real(wp) :: axis(3) = [1.0_wp, 0.0_wp, 0.0_wp]     !< direction, in the joint's frame, of length one
    real(wp) :: second(3) = [0.0_wp, 1.0_wp, 0.0_wp]   !< direction of the second turn of a universal joint, in the same frame
    real(wp) :: pitch = 0.0_wp                !< advance of a helical joint per turn [m]
    logical :: has_range = .false.            !< whether its coordinate is limited
    real(wp) :: range(2) = 0.0_wp             !< smallest and largest coordinate [rad or m]
    real(wp) :: start = 0.0_wp                !< coordinate at the start [rad or m]
    real(wp) :: stiffness = 0.0_wp            !< of a spring on each of its coordinates [N m/rad or N/m]
    real(wp) :: rest = 0.0_wp                 !< coordinate at which this spring is at rest [rad or m]
    real(wp) :: damping = 0.0_wp              !< [N m s/rad or N s/m]
    character(len=:), allocatable :: leader   !< name of a joint that its coordinate follows; not allocated: none
    real(wp) :: ratio = 1.0_wp                !< its change per change of the coordinate of the leader
    real(wp) :: offset = 0.0_wp               !< its coordinate where that of the leader is zero [rad or m]
    logical :: is_preferred = .false.         !< the file wants its coordinate independent
    logical :: closes = .false.               !< it closes a chain: better not independent
    character(len=:), allocatable :: remark   !< a change of the joint, in words; not allocated where there is none
  end type robot_joint_type

  !> A point of a link that is worth recording.
  type :: robot_point_type
    character(len=:), allocatable :: name     !< as the file has it
    integer :: link = 0                       !< number of its link
    real(wp) :: position(3) = 0.0_wp          !< in the frame of the link [m]
  end type robot_point_type

  !> Something that is not taken over.
  type :: note_type
    character(len=:), allocatable :: place    !< file and line of its first occurrence
    character(len=:), allocatable :: text     !< in words
    integer :: times = 1                      !< how often it occurs
  end type note_type

  !> The robot.
  type :: robot_type
    character(len=:), allocatable :: name              !< name or title
    character(len=:), allocatable :: format            !< URDF, MJCF or SDF
    type(robot_link_type), allocatable :: links(:)     !< the first `n_links` are in use
    type(robot_joint_type), allocatable :: joints(:)   !< the first `n_joints` are in use
    type(robot_point_type), allocatable :: points(:)   !< the first `n_points` are in use
    type(note_type), allocatable :: notes(:)           !< the first `n_notes` are in use
    integer :: n_links = 0
    integer :: n_joints = 0
    integer :: n_points = 0
    integer :: n_notes = 0
    real(wp) :: gravity(3) = [0.0_wp, 0.0_wp, -9.81_wp]   !< in the axes of the frame [m/s^2]
  contains
    procedure :: begin
    procedure :: add_link
    procedure :: add_joint
    procedure :: add_point
    procedure :: find_link
    procedure :: find_joint
    procedure :: leader_of
    procedure :: judge_leaders
    procedure :: note
    procedure :: note_at
    procedure :: finish
  end type robot_type

contains

  !> Make an empty robot.
  subroutine begin(self, format)
    class(robot_type), intent(inout) :: self  !< the robot
    character(len=*), intent(in) :: format    !< URDF, MJCF or SDF

    self%name = ''
    self%format = format
    allocate (self%links(16), self%joints(16), self%points(16), self%notes(16))
  end subroutine begin

  !> Add a link without mass.
  subroutine add_link(self, tree, element, name, err)
    class(robot_type), intent(inout) :: self             !< the robot
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element of the link
    character(len=*), intent(in) :: name                 !< its name
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(robot_link_type), allocatable :: longer(:)

    if (self%n_links == most_links) &
      call tree%fail(element, 'the robot has more than '//to_text(most_links)//' links, which are too many', err)
    if (self%find_link(name) > 0) call tree%fail(element, "there are two links '"//name//"'", err)
    if (allocated(err)) return
    if (self%n_links == size(self%links)) then
      allocate (longer(2*self%n_links + 8))
      longer(:self%n_links) = self%links
      call move_alloc(longer, self%links)
    end if
    self%n_links = self%n_links + 1
    self%links(self%n_links)%name = name
    self%links(self%n_links)%place = tree%line_place(element)
  end subroutine add_link

  !> Add a joint.
  subroutine add_joint(self, tree, element, joint, err)
    class(robot_type), intent(inout) :: self             !< the robot
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element of the joint
    type(robot_joint_type), intent(in) :: joint          !< the joint, with its name
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(robot_joint_type), allocatable :: longer(:)

    if (allocated(err)) return
    if (self%n_joints == most_joints) &
      call tree%fail(element, 'the robot has more than '//to_text(most_joints)//' joints, which are too many', err)
    if (self%find_joint(joint%name) > 0) call tree%fail(element, "there are two joints '"//joint%name//"'", err)
    if (joint%has_range .and. joint%range(1) > joint%range(2)) &
      call tree%fail(element, "the range of joint '"//joint%name//"' begins above its end: the lower limit is "// &
                     'greater than the upper one', err)
    if (joint%kind == universal_joint .and. norm2(cross(joint%axis, joint%second)) <= least_sine) &
      call tree%fail(element, "the two axes of joint '"//joint%name//"' are parallel; give the second one another direction", err)
    if (allocated(err)) return
    if (self%n_joints == size(self%joints)) then
      allocate (longer(2*self%n_joints + 8))
      longer(:self%n_joints) = self%joints
      call move_alloc(longer, self%joints)
    end if
    self%n_joints = self%n_joints + 1
    self%joints(self%n_joints) = joint
    self%joints(self%n_joints)%place = tree%place(element)
  end subroutine add_joint

  !> Add a point.
  subroutine add_point(self, name, link, position)
    class(robot_type), intent(inout) :: self  !< the robot
    character(len=*), intent(in) :: name      !< its name
    integer, intent(in) :: link               !< number of its link
    real(wp), intent(in) :: position(3)       !< in the frame of the link [m]
    type(robot_point_type), allocatable :: longer(:)

    if (self%n_points == size(self%points)) then
      allocate (longer(2*self%n_points + 8))
      longer(:self%n_points) = self%points
      call move_alloc(longer, self%points)
    end if
    self%n_points = self%n_points + 1
    associate (point => self%points(self%n_points))
      point%name = name
      point%link = link
      point%position = position
    end associate
  end subroutine add_point

  !> The number of the link of a name; 0 where there is none.
  pure integer function find_link(self, name) result(number)
    class(robot_type), intent(in) :: self  !< the robot
    character(len=*), intent(in) :: name   !< the name that is looked for

    do number = self%n_links, 1, -1
      if (self%links(number)%name == name) return
    end do
  end function find_link

  !> The number of the joint of a name; 0 where there is none.
  pure integer function find_joint(self, name) result(number)
    class(robot_type), intent(in) :: self  !< the robot
    character(len=*), intent(in) :: name   !< the name that is looked for

    do number = self%n_joints, 1, -1
      if (self%joints(number)%name == name) return
    end do
  end function find_joint

  !> The number of the joint that a joint follows; 0 where it follows none, or one or the other has not one freedom.
  pure integer function leader_of(self, number) result(leader)
    class(robot_type), intent(in) :: self  !< the robot
    integer, intent(in) :: number          !< number of the joint
    integer, parameter :: single(3) = [revolute_joint, prismatic_joint, helical_joint]

    leader = 0
    if (.not. allocated(self%joints(number)%leader)) return
    leader = self%find_joint(self%joints(number)%leader)
    if (leader == number) leader = 0
    if (leader == 0) return
    if (all(single /= self%joints(number)%kind) .or. all(single /= self%joints(leader)%kind)) leader = 0
  end function leader_of

  !> Fail where a joint follows one that is not there, itself, or one that does not move it.
  subroutine judge_leaders(self, err)
    class(robot_type), intent(in) :: self              !< the robot with all its joints
    type(error_type), allocatable, intent(out) :: err  !< allocated if there is such a joint
    character(len=:), allocatable :: problem
    integer :: k

    do k = 1, self%n_joints
      associate (joint => self%joints(k))
        if (.not. allocated(joint%leader)) cycle
        problem = ''
        if (self%find_joint(joint%leader) == 0) then
          problem = "there is no joint '"//joint%leader//"', which joint '"//joint%name//"' follows"
        else if (joint%leader == joint%name) then
          problem = "joint '"//joint%name//"' follows itself; let it follow another joint"
        else if (.not. abs(joint%ratio) > 0.0_wp) then
          problem = "joint '"//joint%name//"' follows joint '"//joint%leader//"' with the factor 0 and cannot move; make it "// &
                    'a fixed joint, or give another factor'
        end if
        if (problem == '') cycle
        call raise(err, exit_data, printable(joint%place//': '//problem))
        return
      end associate
    end do
  end subroutine judge_leaders

  !> Note that something about an element is not taken over.
  subroutine note(self, tree, element, text)
    class(robot_type), intent(inout) :: self  !< the robot
    type(xml_tree_type), intent(in) :: tree   !< the document
    integer, intent(in) :: element            !< number of the element that is meant
    character(len=*), intent(in) :: text      !< the thing that is not taken over

    call self%note_at(tree%line_place(element), text)
  end subroutine note

  !> Note that something is not taken over. Equal notes are counted, and the place of the first one is kept.
  subroutine note_at(self, place, text)
    class(robot_type), intent(inout) :: self  !< the robot
    character(len=*), intent(in) :: place     !< file and line
    character(len=*), intent(in) :: text      !< the thing that is not taken over
    type(note_type), allocatable :: longer(:)
    integer :: i

    do i = 1, self%n_notes
      if (self%notes(i)%text /= text .and. i < most_notes) cycle
      self%notes(i)%times = self%notes(i)%times + 1
      if (i == most_notes) self%notes(i)%text = 'other things, which are not listed'
      return
    end do
    if (self%n_notes == size(self%notes)) then
      allocate (longer(2*self%n_notes + 8))
      longer(:self%n_notes) = self%notes
      call move_alloc(longer, self%notes)
    end if
    self%n_notes = self%n_notes + 1
    self%notes(self%n_notes)%text = text
    self%notes(self%n_notes)%place = place
  end subroutine note_at

  !> Cut the lists of links, joints and points to their parts in use.
  subroutine finish(self)
    class(robot_type), intent(inout) :: self  !< the robot
    type(robot_link_type), allocatable :: links(:)
    type(robot_joint_type), allocatable :: joints(:)
    type(robot_point_type), allocatable :: points(:)

    ! gfortran 12 frees too much where an array is cut to a part of itself by one assignment
    allocate (links(self%n_links), joints(self%n_joints), points(self%n_points))
    links(:) = self%links(:self%n_links)
    joints(:) = self%joints(:self%n_joints)
    points(:) = self%points(:self%n_points)
    call move_alloc(links, self%links)
    call move_alloc(joints, self%joints)
    call move_alloc(points, self%points)
  end subroutine finish
end module mech9_robot
