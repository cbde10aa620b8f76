!> The force of a contact without friction that is sought: a given force and a spring, as far as they press.
module mech9_pressing_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_motion_view, only: motion_view_type, link_motion_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_contact, only: contact_type, contact_place_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: pressing_load_type

  !> The force max(0, f - k g), or f - k g, along the normal, at the gap g. It acts at the centre of the ball, through which its line goes.
  type, extends(load_type) :: pressing_load_type
    type(contact_type) :: contact          !< the contact
    real(wp) :: preload = 0.0_wp           !< f, the force without a gap [N]
    real(wp) :: stiffness = 0.0_wp         !< k [N/m]
    logical :: pulls = .false.              !< the force may be below zero, too
  contains
    procedure :: mark_links
    procedure :: apply
    procedure :: potential
    procedure :: vary
    procedure :: size_at
  end type pressing_load_type

contains

  !> Mark both links.
  pure subroutine mark_links(self, needed)
    class(pressing_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)             !< (N) becomes true for both links

    needed(self%contact%links) = .true.
  end subroutine mark_links

  !> Add the force to both links.
  subroutine apply(self, state, sum, err)
    class(pressing_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< never allocated
    type(contact_place_type) :: place
    real(wp) :: force(3), center(3)
    integer :: side

    associate (links => self%contact%links)
      place = self%contact%find_place(state%links(links(1)), state%links(links(2)))
      force = self%size_at(place%gap)*place%normal
      center = state%links(links(1))%point_position(self%contact%center)
      do side = 1, 2
        associate (k => links(side))
          sum%force(:, k) = sum%force(:, k) + (3 - 2*side)*force
          sum%torque(:, k) = sum%torque(:, k) + (3 - 2*side)*cross(center - state%links(k)%p, force)
        end associate
      end do
    end associate
  end subroutine apply

  !> The force at a gap [N].
  pure real(wp) function size_at(self, gap) result(size)
    class(pressing_load_type), intent(in) :: self   !< the load
    real(wp), intent(in) :: gap                     !< [m]

    size = self%preload - self%stiffness*gap
    if (.not. self%pulls) size = max(0.0_wp, size)
  end function size_at

  !> The energy counts as put in.
  pure real(wp) function potential(self, state)
    class(pressing_load_type), intent(in) :: self   !< the load
    type(motion_view_type), intent(in) :: state     !< present motion of links and coordinates

    potential = 0.0_wp
  end function potential

  !> Add the derivative of the force by a parameter on which the motion depends. Gap and normal change as in a motion whose velocities are
  !> the changes.
  subroutine vary(self, state, change, changes, err)
    class(pressing_load_type), intent(in) :: self       !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< never allocated
    type(link_motion_type) :: moved(2)
    type(contact_place_type) :: place
    real(wp) :: force(3), force_change(3), center(3), size
    integer :: side

    associate (links => self%contact%links)
      do side = 1, 2
        moved(side) = state%links(links(side))
        moved(side)%omega = change%links(links(side))%turn
        moved(side)%v = change%links(links(side))%shift
      end do
      place = self%contact%find_place(moved(1), moved(2))
      size = self%size_at(place%gap)
      if (.not. (self%pulls .or. size > 0.0_wp)) return
      force = size*place%normal
      force_change = size*place%normal_rate - self%stiffness*place%gap_rate()*place%normal
      center = moved(1)%point_position(self%contact%center)
      do side = 1, 2
        associate (k => links(side), center_change => moved(1)%point_velocity(self%contact%center) - moved(side)%v)
          changes%force(:, k) = changes%force(:, k) + (3 - 2*side)*force_change
          changes%torque(:, k) = changes%torque(:, k) &
                                 + (3 - 2*side)*(cross(center_change, force) + cross(center - moved(side)%p, force_change))
        end associate
      end do
    end associate
  end subroutine vary
end module mech9_pressing_load
