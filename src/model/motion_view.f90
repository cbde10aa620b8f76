!> The motion of links and coordinates as loads see it. Uses kinds, rotation.
module mech9_motion_view
  use mech9_kinds, only: wp
  use mech9_rotation, only: identity, turn, cross
  implicit none
  private
  public :: motion_view_type, link_motion_type

  !> One link: its own system in the system of link 1.
  type :: link_motion_type
    real(wp) :: r(3, 3) = identity      !< turns components in the link's axes into fixed ones
    real(wp) :: p(3) = 0.0_wp           !< the link's origin [m]
    real(wp) :: omega(3) = 0.0_wp       !< angular velocity, fixed axes [rad/s]
    real(wp) :: v(3) = 0.0_wp           !< velocity of the origin [m/s]
  end type link_motion_type

  !> All that a load may depend on.
  type :: motion_view_type
    real(wp) :: t = 0.0_wp                               !< [s]
    type(link_motion_type), allocatable :: links(:)      !< (N); only those that a load asked for are kept
    real(wp), allocatable :: q(:)                        !< (M) coordinates [rad, m]
    real(wp), allocatable :: dq(:)                       !< (M) their rates
  contains
    procedure :: position
    procedure :: velocity
    procedure :: turned
  end type motion_view_type

contains

  !> Where a point of a link is, in the system of link 1 [m].
  pure function position(self, link, point)
    class(motion_view_type), intent(in) :: self
    integer, intent(in) :: link
    real(wp), intent(in) :: point(3)      !< in the link's system [m]
    real(wp) :: position(3)

    position = self%links(link)%p + turn(self%links(link)%r, point)
  end function position

  !> Velocity of a point of a link [m/s].
  pure function velocity(self, link, point)
    class(motion_view_type), intent(in) :: self
    integer, intent(in) :: link
    real(wp), intent(in) :: point(3)      !< in the link's system [m]
    real(wp) :: velocity(3), arm(3)

    arm = turn(self%links(link)%r, point)
    velocity = self%links(link)%v + cross(self%links(link)%omega, arm)
  end function velocity

  !> A vector given in the axes of a link, in fixed axes.
  pure function turned(self, link, vector)
    class(motion_view_type), intent(in) :: self
    integer, intent(in) :: link
    real(wp), intent(in) :: vector(3)
    real(wp) :: turned(3)

    turned = turn(self%links(link)%r, vector)
  end function turned
end module mech9_motion_view
