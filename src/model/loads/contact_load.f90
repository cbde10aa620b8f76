!> The force of a contact on both of its links. That of a compliant one follows from the motion; that of a rigid one, and friction, are found
!> elsewhere, and the motion tells them.
module mech9_contact_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_contact, only: contact_type, contact_place_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: contact_load_type

  !> The load of a contact.
  type, extends(load_type) :: contact_load_type
    type(contact_type) :: contact   !< the contact
    integer :: number = 0           !< its number
  contains
    procedure :: mark_links
    procedure :: apply
    procedure :: potential
  end type contact_load_type

contains

  !> Mark both links.
  pure subroutine mark_links(self, needed)
    class(contact_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)            !< (N) becomes true for both links

    needed(self%contact%links) = .true.
  end subroutine mark_links

  !> Add the force to both links, at the place where they touch.
  subroutine apply(self, state, sum, err)
    class(contact_load_type), intent(in) :: self        !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< never allocated
    type(contact_place_type) :: place
    real(wp) :: force(3)
    integer :: side

    if (.not. allocated(state%contact_force) .and. self%contact%is_rigid) return
    associate (links => self%contact%links)
      if (allocated(state%contact_force)) then
        if (.not. any(abs(state%contact_force(:, self%number)) > 0.0_wp)) return
      end if
      place = self%contact%find_place(state%links(links(1)), state%links(links(2)))
      if (allocated(state%contact_force)) then
        force = state%contact_force(:, self%number)
      else
        force = self%contact%normal_force(place)*place%normal
      end if
      do side = 1, 2
        associate (k => links(side))
          sum%force(:, k) = sum%force(:, k) + (3 - 2*side)*force
          sum%torque(:, k) = sum%torque(:, k) + (3 - 2*side)*cross(place%at - state%links(k)%p, force)
        end associate
      end do
    end associate
  end subroutine apply

  !> Energy of a compliant contact without its damping [J].
  pure real(wp) function potential(self, state)
    class(contact_load_type), intent(in) :: self    !< the load
    type(motion_view_type), intent(in) :: state     !< present motion of links and coordinates

    potential = self%contact%energy(self%contact%find_place(state%links(self%contact%links(1)), state%links(self%contact%links(2))))
  end function potential
end module mech9_contact_load
