!> The force of a contact on both of its links. That of a compliant one follows from the motion; that of a rigid one, and friction, are found
!> elsewhere, and the motion tells them.
module mech9_contact_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type, link_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_contact, only: contact_type, contact_place_type
  use mech9_contact_change, only: contact_change_type, change_of_contact, numbers_of_contact, vary_normal_force
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
    procedure :: vary
    procedure :: numbers
    procedure :: vary_by_numbers
    procedure :: varied_potential
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
      place = self%contact%find_place(state%links(links(1)), state%links(links(2)), present_stretch(self, state))
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

  !> Add the derivative of the force by a parameter on which the motion depends. The normal force of a rigid contact is held, but turns
  !> with the normal, and friction stays at right angles to it.
  subroutine vary(self, state, change, changes, err)
    class(contact_load_type), intent(in) :: self        !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    associate (links => self%contact%links)
      call add_change(self, state, change%links(links(1)), change%links(links(2)), [real(wp) ::], changes)
    end associate
  end subroutine vary

  !> Its numbers.
  pure subroutine numbers(self, values)
    class(contact_load_type), intent(in) :: self      !< the load
    real(wp), allocatable, intent(out) :: values(:)   !< (numbers) the numbers, SI units

    values = numbers_of_contact(self%contact)
  end subroutine numbers

  !> Add the derivative of the force by a parameter on which its numbers depend.
  subroutine vary_by_numbers(self, change, factor, state, changes, err)
    class(contact_load_type), intent(in) :: self        !< the load
    real(wp), intent(in) :: change(:)                   !< (numbers) derivatives of the numbers by one parameter, SI units
    real(wp), intent(in) :: factor                      !< 1, since it has no law [1]
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    call add_change(self, state, link_change_type(), link_change_type(), factor*change, changes)
  end subroutine vary_by_numbers

  !> Add the derivative of the force by a change of the motion of both links, or of the numbers.
  pure subroutine add_change(self, state, ball_change, surface_change, own, changes)
    type(contact_load_type), intent(in) :: self             !< the load
    type(motion_view_type), intent(in) :: state             !< present motion of links and coordinates
    type(link_change_type), intent(in) :: ball_change       !< change of the motion of the ball's link
    type(link_change_type), intent(in) :: surface_change    !< change of that of the surface's link
    real(wp), intent(in) :: own(:)                          !< (numbers) derivatives of the numbers by one parameter, SI units; of size 0: all are zero
    type(force_sum_type), intent(inout) :: changes          !< derivatives of forces so far; those of the load are added
    type(contact_place_type) :: place
    type(contact_change_type) :: varied
    real(wp), dimension(3) :: force, force_change, at_change, arm_change
    real(wp) :: size_of_force
    integer :: side

    associate (links => self%contact%links)
      place = self%contact%find_place(state%links(links(1)), state%links(links(2)), present_stretch(self, state))
      if (.not. self%contact%is_rigid) then
        size_of_force = self%contact%normal_force(place)
      else if (allocated(state%contact_force)) then
        size_of_force = dot_product(place%normal, state%contact_force(:, self%number))
      else
        size_of_force = 0.0_wp
      end if
      if (.not. abs(size_of_force) > 0.0_wp) return
      varied = change_of_contact(self%contact, state%links(links(1)), state%links(links(2)), ball_change, surface_change, own, &
                                 present_stretch(self, state))
      force = size_of_force*place%normal
      force_change = size_of_force*varied%normal &
                     + vary_normal_force(self%contact, place%gap, place%gap_rate(), varied, own)*place%normal
      if (allocated(state%contact_force) .and. self%contact%has_friction()) then
        force = state%contact_force(:, self%number)
        force_change = force_change - dot_product(force - size_of_force*place%normal, varied%normal)*place%normal
      end if
      at_change = varied%centre - self%contact%radius*varied%normal
      if (size(own) > 0) at_change = at_change - own(4)*place%normal
      do side = 1, 2
        arm_change = at_change - merge(ball_change%shift, surface_change%shift, side == 1)
        associate (k => links(side))
          changes%force(:, k) = changes%force(:, k) + (3 - 2*side)*force_change
          changes%torque(:, k) = changes%torque(:, k) &
                                 + (3 - 2*side)*(cross(arm_change, force) + cross(place%at - state%links(k)%p, force_change))
        end associate
      end do
    end associate
  end subroutine add_change

  !> The stretch of its profile on which the contact stays; 0: the nearest foot counts.
  pure integer function present_stretch(self, state) result(stretch)
    type(contact_load_type), intent(in) :: self     !< the load
    type(motion_view_type), intent(in) :: state     !< present motion of links and coordinates

    stretch = 0
    if (allocated(state%stretch)) stretch = state%stretch(self%number)
  end function present_stretch

  !> Energy of a compliant contact without its damping [J].
  pure real(wp) function potential(self, state)
    class(contact_load_type), intent(in) :: self    !< the load
    type(motion_view_type), intent(in) :: state     !< present motion of links and coordinates

    potential = self%contact%energy(self%contact%find_place(state%links(self%contact%links(1)), state%links(self%contact%links(2))))
  end function potential

  !> The derivative of this energy by a parameter.
  pure real(wp) function varied_potential(self, state, change, derivatives) result(energy)
    class(contact_load_type), intent(in) :: self     !< the load
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by the parameter
    real(wp), intent(in) :: derivatives(:)           !< (numbers) derivatives of its numbers by one parameter, SI units; of size 0: all are zero
    type(contact_place_type) :: place
    type(contact_change_type) :: varied

    energy = 0.0_wp
    associate (contact => self%contact, links => self%contact%links)
      if (contact%is_rigid) return
      place = contact%find_place(state%links(links(1)), state%links(links(2)))
      if (.not. place%gap < 0.0_wp) return
      varied = change_of_contact(contact, state%links(links(1)), state%links(links(2)), change%links(links(1)), &
                                 change%links(links(2)), derivatives)
      associate (depth => -place%gap, n => contact%exponent + 1.0_wp)
        energy = -contact%stiffness*depth**contact%exponent*varied%gap
        if (size(derivatives) > 0) energy = energy + depth**n/n*(derivatives(18) &
                                                                 + contact%stiffness*(log(depth) - 1.0_wp/n)*derivatives(20))
      end associate
    end associate
  end function varied_potential
end module mech9_contact_load
