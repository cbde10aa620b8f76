!> A small change of the motion of links and coordinates as loads read it: the derivative of that motion by some parameter.
module mech9_motion_change
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, cross, about_axis, combine
  use mech9_motion_view, only: motion_view_type, link_motion_type
  use mech9_force_sum, only: force_sum_type
  implicit none
  private
  public :: motion_change_type, link_change_type, new_motion_change

  !> Change of the motion of one link, per unit of the parameter, in the axes of link 1.
  type :: link_change_type
    real(wp) :: turn(3) = 0.0_wp    !< rotation [rad]
    real(wp) :: shift(3) = 0.0_wp   !< of the link's origin [m]
    real(wp) :: omega(3) = 0.0_wp   !< of the angular velocity [rad/s]
    real(wp) :: v(3) = 0.0_wp       !< of the velocity of the origin [m/s]
  contains
    procedure :: of_arm
    procedure :: of_position
    procedure :: of_velocity
    procedure :: add_slope_of_arm
    procedure :: add_slope_of_position
    procedure :: add_slope_of_velocity
  end type link_change_type

  !> Change of all that a load may depend on.
  type :: motion_change_type
    type(link_change_type), allocatable :: links(:)   !< (N); only the links requested by loads are up to date
    real(wp), allocatable :: q(:)                     !< (M) coordinates [rad, m]
    real(wp), allocatable :: dq(:)                    !< (M) their rates [rad/s, m/s]
    real(wp), allocatable :: motor(:)                 !< states of the motors; not allocated where these are held
  contains
    procedure :: add_force
    procedure :: moved
  end type motion_change_type

contains

  !> A change that is zero, for a mechanism with a given number of links and coordinates.
  pure function new_motion_change(n_links, n_coordinates) result(change)
    integer, intent(in) :: n_links         !< N
    integer, intent(in) :: n_coordinates   !< M
    type(motion_change_type) :: change

    allocate (change%links(n_links))
    allocate (change%q(n_coordinates), change%dq(n_coordinates), source=0.0_wp)
  end function new_motion_change

  !> Change of a vector that is fixed in the link, in fixed axes, in the unit of the vector.
  pure function of_arm(self, link, arm) result(change)
    class(link_change_type), intent(in) :: self   !< the change of the link's motion
    type(link_motion_type), intent(in) :: link    !< the motion that changes
    real(wp), intent(in) :: arm(3)                !< the vector, in the link's axes
    real(wp) :: change(3), fixed(3)

    fixed = turn(link%r, arm)
    change = cross(self%turn, fixed)
  end function of_arm

  !> Change of the position of a point of the link [m].
  pure function of_position(self, link, point) result(change)
    class(link_change_type), intent(in) :: self   !< the change of the link's motion
    type(link_motion_type), intent(in) :: link    !< the motion that changes
    real(wp), intent(in) :: point(3)              !< in the link's system [m]
    real(wp) :: change(3)

    change = self%shift + self%of_arm(link, point)
  end function of_position

  !> Change of the velocity of a point of the link [m/s].
  pure function of_velocity(self, link, point) result(change)
    class(link_change_type), intent(in) :: self   !< the change of the link's motion
    type(link_motion_type), intent(in) :: link    !< the motion that changes
    real(wp), intent(in) :: point(3)              !< in the link's system [m]
    real(wp) :: change(3), arm(3), arm_change(3)

    arm = turn(link%r, point)
    arm_change = cross(self%turn, arm)
    change = self%v + cross(self%omega, arm) + cross(link%omega, arm_change)
  end function of_velocity

  !> Add a derivative by a vector that is fixed in the link to those by the link's motion.
  pure subroutine add_slope_of_arm(self, link, arm, slope)
    class(link_change_type), intent(inout) :: self   !< derivatives by the link's motion
    type(link_motion_type), intent(in) :: link       !< this motion
    real(wp), intent(in) :: arm(3)                   !< the vector, in the link's axes
    real(wp), intent(in) :: slope(3)                 !< derivative by the vector, fixed axes, in 1 over its unit

    self%turn = self%turn + cross(turn(link%r, arm), slope)
  end subroutine add_slope_of_arm

  !> Add a derivative by the position of a point of the link to those by the link's motion.
  pure subroutine add_slope_of_position(self, link, point, slope)
    class(link_change_type), intent(inout) :: self   !< derivatives by the link's motion
    type(link_motion_type), intent(in) :: link       !< this motion
    real(wp), intent(in) :: point(3)                 !< in the link's system [m]
    real(wp), intent(in) :: slope(3)                 !< derivative by the point's position, fixed axes [1/m]

    self%shift = self%shift + slope
    call self%add_slope_of_arm(link, point, slope)
  end subroutine add_slope_of_position

  !> Add a derivative by the velocity of a point of the link to those by the link's motion.
  pure subroutine add_slope_of_velocity(self, link, point, slope)
    class(link_change_type), intent(inout) :: self   !< derivatives by the link's motion
    type(link_motion_type), intent(in) :: link       !< this motion
    real(wp), intent(in) :: point(3)                 !< in the link's system [m]
    real(wp), intent(in) :: slope(3)                 !< derivative by the point's velocity, fixed axes [s/m]
    real(wp) :: arm(3)

    arm = turn(link%r, point)
    self%v = self%v + slope
    self%omega = self%omega + cross(arm, slope)
    self%turn = self%turn + cross(arm, cross(slope, link%omega))
  end subroutine add_slope_of_velocity

  !> Add the change of a force at a point of a link to the changes of the loads' sums.
  pure subroutine add_force(self, state, link, point, force, force_change, changes)
    class(motion_change_type), intent(in) :: self     !< the change of the motion
    type(motion_view_type), intent(in) :: state       !< the motion that changes
    integer, intent(in) :: link                       !< number of the link
    real(wp), intent(in) :: point(3)                  !< in the link's system [m]
    real(wp), intent(in) :: force(3)                  !< fixed axes [N]
    real(wp), intent(in) :: force_change(3)           !< change of the force, fixed axes [N]
    type(force_sum_type), intent(inout) :: changes    !< gets the change of the force and of its torque
    real(wp) :: arm_change(3)

    arm_change = self%links(link)%of_arm(state%links(link), point)
    call changes%add_force(state, link, point, force_change)
    call changes%add_torque(link, cross(arm_change, force))
  end subroutine add_force

  !> The motion after so many times the change. The rotation of each link is about one axis.
  function moved(self, state, times) result(other)
    class(motion_change_type), intent(in) :: self   !< the change of the motion
    type(motion_view_type), intent(in) :: state     !< the motion that changes
    real(wp), intent(in) :: times                   !< number of times the change is made
    type(motion_view_type) :: other
    real(wp) :: angle
    integer :: i

    other = state
    other%q = state%q + times*self%q
    other%dq = state%dq + times*self%dq
    do i = 1, size(self%links)
      associate (change => self%links(i), link => other%links(i))
        link%p = link%p + times*change%shift
        link%v = link%v + times*change%v
        link%omega = link%omega + times*change%omega
        angle = norm2(change%turn)
        if (angle > 0.0_wp) link%r = combine(about_axis(change%turn/angle, times*angle), link%r)
      end associate
    end do
  end function moved
end module mech9_motion_change
