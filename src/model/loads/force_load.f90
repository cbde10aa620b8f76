!> A force at a point of a link, or a torque, constant but for a law of time.
module mech9_force_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_factored_load, only: factored_load_type
  implicit none
  private
  public :: force_load_type

  !> A force and a torque with components in fixed axes, or in the axes of the link, with which they turn.
  type, extends(factored_load_type) :: force_load_type
    integer :: link = 0                    !< number of the link
    real(wp) :: position(3) = 0.0_wp       !< point at which the force acts, in the link's system [m]
    real(wp) :: force(3) = 0.0_wp          !< [N]
    real(wp) :: torque(3) = 0.0_wp         !< [N m]
    logical :: turns_with_link = .false.   !< components in the axes of the link, not fixed ones
  contains
    procedure :: mark_own_links
    procedure :: is_idle
    procedure :: apply_times
    procedure :: potential
    procedure :: vary_times
    procedure :: add_slopes_times
    procedure :: find_power
    procedure :: numbers
    procedure :: take_numbers
    procedure :: vary_by_numbers
  end type force_load_type

contains

  !> Whether it acts on link 1, which does not move, or is zero.
  pure logical function is_idle(self)
    class(force_load_type), intent(in) :: self   !< the force load

    is_idle = self%link == 1 .or. .not. (any(abs(self%force) > 0.0_wp) .or. any(abs(self%torque) > 0.0_wp))
  end function is_idle

  !> Mark its link.
  pure subroutine mark_own_links(self, needed)
    class(force_load_type), intent(in) :: self   !< the force load
    logical, intent(inout) :: needed(:)          !< (N) becomes true for the link

    needed(self%link) = .true.
  end subroutine mark_own_links

  !> Add force and torque on the link.
  subroutine apply_times(self, factor, state, sum, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(force_load_type), intent(in) :: self          !< the force load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (self%turns_with_link) then
      call sum%add_force(state, self%link, self%position, state%links(self%link)%fixed_components(factor*self%force))
      call sum%add_torque(self%link, state%links(self%link)%fixed_components(factor*self%torque))
    else
      if (any(abs(self%force) > 0.0_wp)) call sum%add_force(state, self%link, self%position, factor*self%force)
      call sum%add_torque(self%link, factor*self%torque)
    end if
  end subroutine apply_times

  !> Add the derivative of the forces by a parameter: the arm of the force turns, and components in the link's axes turn, too.
  subroutine vary_times(self, factor, state, change, changes, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(force_load_type), intent(in) :: self          !< the force load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    associate (link => state%links(self%link), of_link => change%links(self%link))
      if (self%turns_with_link) then
        call change%add_force(state, self%link, self%position, link%fixed_components(factor*self%force), &
                              of_link%of_arm(link, factor*self%force), changes)
        call changes%add_torque(self%link, of_link%of_arm(link, factor*self%torque))
      else
        call change%add_force(state, self%link, self%position, factor*self%force, [0.0_wp, 0.0_wp, 0.0_wp], changes)
      end if
    end associate
  end subroutine vary_times

  !> Add the derivatives of the power in a virtual motion: the arm of the force turns, and components in the link's axes turn, too.
  subroutine add_slopes_times(self, factor, state, virtual, slopes, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(force_load_type), intent(in) :: self          !< the force load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    type(motion_change_type), intent(inout) :: slopes   !< derivatives so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: force(3)

    associate (link => state%links(self%link), given => virtual%links(self%link), by_link => slopes%links(self%link))
      force = factor*self%force
      if (self%turns_with_link) then
        call by_link%add_slope_of_arm(link, force, given%of_position(link, self%position))
        call by_link%add_slope_of_arm(link, factor*self%torque, given%turn)
        force = link%fixed_components(force)
      end if
      call by_link%add_slope_of_arm(link, self%position, cross(force, given%turn))
    end associate
  end subroutine add_slopes_times

  !> The power in a virtual motion: of the force by the shift of its point, of the torque by the turn of the link.
  subroutine find_power(self, state, virtual, power, err)
    class(force_load_type), intent(in) :: self          !< the force load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    real(wp), intent(out) :: power                      !< per unit of the motion [J]
    type(error_type), allocatable, intent(out) :: err   !< never allocated
    real(wp) :: force(3), torque(3)

    associate (link => state%links(self%link), given => virtual%links(self%link))
      force = self%force
      torque = self%torque
      if (self%turns_with_link) then
        force = link%fixed_components(force)
        torque = link%fixed_components(torque)
      end if
      power = dot_product(force, given%of_position(link, self%position)) + dot_product(torque, given%turn)
    end associate
  end subroutine find_power

  !> The point of the force, the force and the torque.
  pure subroutine numbers(self, values)
    class(force_load_type), intent(in) :: self        !< the force load
    real(wp), allocatable, intent(out) :: values(:)   !< (9) the numbers

    values = [self%position, self%force, self%torque]
  end subroutine numbers

  !> Take other numbers.
  pure subroutine take_numbers(self, values, are_taken)
    class(force_load_type), intent(inout) :: self   !< the force load
    real(wp), intent(in) :: values(:)      !< (9) as of `numbers`
    logical, intent(out) :: are_taken      !< true

    self%position = values(1:3)
    self%force = values(4:6)
    self%torque = values(7:9)
    are_taken = .true.
  end subroutine take_numbers

  !> Add the derivatives of the forces by a parameter on which the point, the force and the torque depend.
  subroutine vary_by_numbers(self, change, factor, state, changes, err)
    class(force_load_type), intent(in) :: self          !< the force load
    real(wp), intent(in) :: change(:)                   !< (9) derivatives of the numbers
    real(wp), intent(in) :: factor                      !< of its law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< never allocated
    real(wp) :: force(3), force_change(3), torque_change(3)

    associate (link => state%links(self%link))
      force = factor*self%force
      force_change = factor*change(4:6)
      torque_change = factor*change(7:9)
      if (self%turns_with_link) then
        force = link%fixed_components(force)
        force_change = link%fixed_components(force_change)
        torque_change = link%fixed_components(torque_change)
      end if
      call changes%add_force(state, self%link, self%position, force_change)
      call changes%add_torque(self%link, torque_change + cross(link%fixed_components(change(1:3)), force))
    end associate
  end subroutine vary_by_numbers

  !> Zero: the work of a given force counts as put in.
  pure real(wp) function potential(self, state)
    class(force_load_type), intent(in) :: self    !< the force load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates

    potential = 0.0_wp
  end function potential
end module mech9_force_load
