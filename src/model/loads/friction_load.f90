!> Dry friction as a load on its coordinate. Its force follows from the reactions of the pair, which are found elsewhere: the motion tells it.
module mech9_friction_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: friction_load_type

  !> The load of a friction.
  type, extends(load_type) :: friction_load_type
    integer :: coordinate = 0   !< number of the coordinate
    integer :: number = 0       !< of the friction
  contains
    procedure :: mark_links
    procedure :: mark_coordinates
    procedure :: apply
    procedure :: potential
    procedure :: vary
    procedure :: knows_slopes
    procedure :: add_slopes
  end type friction_load_type

contains

  !> The load acts on a coordinate and requests no link.
  pure subroutine mark_links(self, needed)
    class(friction_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)             !< (N) unchanged
  end subroutine mark_links

  !> Mark its coordinate.
  pure subroutine mark_coordinates(self, needed)
    class(friction_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)             !< (M) becomes true for the coordinate

    needed(self%coordinate) = .true.
  end subroutine mark_coordinates

  !> Add the force on the coordinate. It is zero in a motion that does not tell it.
  subroutine apply(self, state, sum, err)
    class(friction_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    if (allocated(state%friction)) call sum%add_generalized(self%coordinate, state%friction(self%number))
  end subroutine apply

  !> Friction has no energy.
  pure real(wp) function potential(self, state)
    class(friction_load_type), intent(in) :: self   !< the load
    type(motion_view_type), intent(in) :: state     !< present motion of links and coordinates

    potential = 0.0_wp
  end function potential

  !> The force does not change with a motion that is given.
  pure subroutine vary(self, state, change, changes, err)
    class(friction_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< unchanged
    type(error_type), allocatable, intent(out) :: err   !< never allocated
  end subroutine vary

  !> The derivatives of its power are known where it is zero: in an equilibrium.
  pure logical function knows_slopes(self)
    class(friction_load_type), intent(in) :: self   !< the load

    knows_slopes = .true.
  end function knows_slopes

  !> Its power has no derivatives by a motion that is given.
  subroutine add_slopes(self, state, virtual, slopes, err)
    class(friction_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    type(motion_change_type), intent(inout) :: slopes   !< unchanged
    type(error_type), allocatable, intent(out) :: err   !< never allocated
  end subroutine add_slopes
end module mech9_friction_load
