!> The motion of links and coordinates as it is given to loads.
module mech9_motion_view
  use mech9_kinds, only: wp
  use mech9_rotation, only: identity, turn, cross
  use mech9_call_fault, only: call_fault_type
  implicit none
  private
  public :: motion_view_type, link_motion_type, unlocked

  !> No limit of a motor is chosen yet.
  integer, parameter :: unlocked = 2

  !> Motion of one link: of its own system in the system of link 1.
  type :: link_motion_type
    real(wp) :: r(3, 3) = identity   !< turns components in the link's axes into fixed ones
    real(wp) :: p(3) = 0.0_wp        !< the link's origin [m]
    real(wp) :: omega(3) = 0.0_wp    !< angular velocity, fixed axes [rad/s]
    real(wp) :: v(3) = 0.0_wp        !< velocity of the origin [m/s]
  contains
    procedure :: point_position
    procedure :: point_velocity
    procedure :: fixed_components
  end type link_motion_type

  !> All that a load may depend on. Its procedures are for users: they check the number of the link.
  type :: motion_view_type
    real(wp) :: t = 0.0_wp                            !< [s]
    type(link_motion_type), allocatable :: links(:)   !< (N); only the links requested by loads are up to date
    real(wp), allocatable :: q(:)                     !< (M) coordinates [rad, m]
    real(wp), allocatable :: dq(:)                    !< (M) their rates [rad/s, m/s]
    real(wp), allocatable :: motor(:)                 !< states of the motors; not allocated: they have come to rest
    integer, allocatable :: limited(:)                !< limits at which the motors work: -1, 0, 1 or `unlocked`
    logical, allocatable :: pressed(:, :)             !< (2,stops) ends of compliant stops that push; not allocated: it is not known
    real(wp), allocatable :: friction(:)              !< forces of frictions on their coordinates; not allocated: none is known [N m, N]
    real(wp), allocatable :: contact_force(:, :)      !< (3,contacts) forces on their balls, fixed axes; not allocated: not known [N]
    integer, allocatable :: stretch(:)                !< (contacts) stretch of its profile on which a contact stays; 0: the nearest foot
                                                      !< counts; not allocated: it does for all
    !> Keeps wrong numbers of links while loads are added. It is a pointer because loads may not change the motion.
    type(call_fault_type), pointer :: fault => null()
  contains
    procedure :: note_faults_in
    procedure :: note_no_faults
    procedure :: position
    procedure :: velocity
    procedure :: turned
    procedure :: angular_velocity
    procedure :: coordinate
    procedure :: rate
    procedure, private, non_overridable :: has_link
  end type motion_view_type

contains

  !> Position of a point of the link, in the system of link 1 [m].
  pure function point_position(self, point)
    class(link_motion_type), intent(in) :: self   !< motion of the link
    real(wp), intent(in) :: point(3)              !< in the link's system [m]
    real(wp) :: point_position(3)

    point_position = self%p + turn(self%r, point)
  end function point_position

  !> Velocity of a point of the link, fixed axes [m/s].
  pure function point_velocity(self, point)
    class(link_motion_type), intent(in) :: self   !< motion of the link
    real(wp), intent(in) :: point(3)              !< in the link's system [m]
    real(wp) :: point_velocity(3)

    point_velocity = self%v + cross(self%omega, turn(self%r, point))
  end function point_velocity

  !> A vector given in the axes of the link, in fixed axes.
  pure function fixed_components(self, vector)
    class(link_motion_type), intent(in) :: self   !< motion of the link
    real(wp), intent(in) :: vector(3)             !< in the link's axes, of any unit
    real(wp) :: fixed_components(3)

    fixed_components = turn(self%r, vector)
  end function fixed_components

  !> Position of a point of a link, in the system of link 1 [m]; zero where there is no such link, which is noted.
  function position(self, link, point)
    class(motion_view_type), intent(in) :: self   !< the motion
    integer, intent(in) :: link                   !< its number
    real(wp), intent(in) :: point(3)              !< in the link's system [m]
    real(wp) :: position(3)

    position = 0.0_wp
    if (self%has_link(link, 'position')) position = self%links(link)%point_position(point)
  end function position

  !> Velocity of a point of a link, fixed axes [m/s]; zero where there is no such link, which is noted.
  function velocity(self, link, point)
    class(motion_view_type), intent(in) :: self   !< the motion
    integer, intent(in) :: link                   !< its number
    real(wp), intent(in) :: point(3)              !< in the link's system [m]
    real(wp) :: velocity(3)

    velocity = 0.0_wp
    if (self%has_link(link, 'velocity')) velocity = self%links(link)%point_velocity(point)
  end function velocity

  !> A vector given in the axes of a link, in fixed axes; zero where there is no such link, which is noted.
  function turned(self, link, vector)
    class(motion_view_type), intent(in) :: self   !< the motion
    integer, intent(in) :: link                   !< its number
    real(wp), intent(in) :: vector(3)             !< in the link's axes, of any unit
    real(wp) :: turned(3)

    turned = 0.0_wp
    if (self%has_link(link, 'turned')) turned = self%links(link)%fixed_components(vector)
  end function turned

  !> Angular velocity of a link, fixed axes [rad/s]; zero where there is no such link, which is noted.
  function angular_velocity(self, link)
    class(motion_view_type), intent(in) :: self   !< the motion
    integer, intent(in) :: link                   !< its number
    real(wp) :: angular_velocity(3)

    angular_velocity = 0.0_wp
    if (self%has_link(link, 'angular_velocity')) angular_velocity = self%links(link)%omega
  end function angular_velocity

  !> A coordinate [rad, m]; zero where there is none of this number, which is noted.
  real(wp) function coordinate(self, number)
    class(motion_view_type), intent(in) :: self   !< the motion
    integer, intent(in) :: number                 !< of the coordinate

    coordinate = 0.0_wp
    if (has_coordinate(self, number, 'q')) coordinate = self%q(number)
  end function coordinate

  !> The rate of a coordinate [rad/s, m/s]; zero where there is none of this number, which is noted.
  real(wp) function rate(self, number)
    class(motion_view_type), intent(in) :: self   !< the motion
    integer, intent(in) :: number                 !< of the coordinate

    rate = 0.0_wp
    if (has_coordinate(self, number, 'dq')) rate = self%dq(number)
  end function rate

  !> Whether a coordinate exists. If not, the call is noted where faults are kept.
  logical function has_coordinate(self, number, procedure)
    class(motion_view_type), intent(in) :: self   !< the motion
    integer, intent(in) :: number                 !< of the coordinate
    character(len=*), intent(in) :: procedure     !< name of the procedure that was given the number

    has_coordinate = number >= 1 .and. number <= size(self%q)
    if (.not. has_coordinate .and. associated(self%fault)) call self%fault%note(procedure, 'coordinate', number, size(self%q))
  end function has_coordinate

  !> From now on, until `note_no_faults`, wrong numbers of links are noted in `fault`, which must exist as long.
  subroutine note_faults_in(self, fault)
    class(motion_view_type), intent(inout) :: self          !< the motion
    type(call_fault_type), intent(inout), target :: fault   !< keeps the first wrong number

    self%fault => fault
  end subroutine note_faults_in

  !> Wrong numbers of links are not noted any more.
  subroutine note_no_faults(self)
    class(motion_view_type), intent(inout) :: self   !< the motion

    self%fault => null()
  end subroutine note_no_faults

  !> Whether a link exists. If not, the call is noted where faults are kept.
  logical function has_link(self, link, procedure)
    class(motion_view_type), intent(in) :: self   !< the motion
    integer, intent(in) :: link                   !< its number
    character(len=*), intent(in) :: procedure     !< name of the procedure that was given the number

    has_link = link >= 1 .and. link <= size(self%links)
    if (.not. associated(self%fault)) return
    has_link = has_link .and. link <= self%fault%links
    if (.not. has_link) call self%fault%note(procedure, 'link', link, min(size(self%links), self%fault%links))
  end function has_link
end module mech9_motion_view
