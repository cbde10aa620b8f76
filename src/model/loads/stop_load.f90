!> The force of a compliant stop, as a load on its coordinate.
module mech9_stop_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_stop, only: stop_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: stop_load_type

  !> The load of a compliant stop.
  type, extends(load_type) :: stop_load_type
    type(stop_type) :: stop   !< the stop, which is compliant
    integer :: number = 0     !< its number
  contains
    procedure :: mark_links
    procedure :: mark_coordinates
    procedure :: apply
    procedure :: potential
    procedure :: vary
    procedure :: knows_slopes
    procedure :: add_slopes
    procedure :: numbers
    procedure :: vary_by_numbers
    procedure :: varied_potential
  end type stop_load_type

contains

  !> The load acts on a coordinate and requests no link.
  pure subroutine mark_links(self, needed)
    class(stop_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)         !< (N) unchanged
  end subroutine mark_links

  !> Mark its coordinate.
  pure subroutine mark_coordinates(self, needed)
    class(stop_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)         !< (M) becomes true for the coordinate

    needed(self%stop%coordinate) = .true.
  end subroutine mark_coordinates

  !> Add the generalized force on the coordinate.
  subroutine apply(self, state, sum, err)
    class(stop_load_type), intent(in) :: self           !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    associate (k => self%stop%coordinate)
      call sum%add_generalized(k, force_in(self, state))
    end associate
  end subroutine apply

  !> The force in a motion, by the ends that push in it where it tells.
  pure real(wp) function force_in(self, state) result(force)
    type(stop_load_type), intent(in) :: self      !< the load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates

    associate (k => self%stop%coordinate)
      if (allocated(state%pressed)) then
        force = self%stop%force(state%q(k), state%dq(k), state%pressed(:, self%number))
      else
        force = self%stop%force(state%q(k), state%dq(k))
      end if
    end associate
  end function force_in

  !> The derivatives of the force in a motion.
  pure function slopes_in(self, state) result(slopes)
    type(stop_load_type), intent(in) :: self      !< the load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates
    real(wp) :: slopes(7)

    associate (k => self%stop%coordinate)
      if (allocated(state%pressed)) then
        slopes = self%stop%slopes(state%q(k), state%dq(k), state%pressed(:, self%number))
      else
        slopes = self%stop%slopes(state%q(k), state%dq(k))
      end if
    end associate
  end function slopes_in

  !> Add the derivative of the generalized force by a parameter.
  subroutine vary(self, state, change, changes, err)
    class(stop_load_type), intent(in) :: self           !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< never allocated
    real(wp) :: slopes(7)

    associate (k => self%stop%coordinate)
      slopes = slopes_in(self, state)
      call changes%add_generalized(k, slopes(1)*change%q(k) + slopes(2)*change%dq(k))
    end associate
  end subroutine vary

  !> The derivatives of its power are known.
  pure logical function knows_slopes(self)
    class(stop_load_type), intent(in) :: self   !< the load

    knows_slopes = .true.
  end function knows_slopes

  !> Add the derivatives of the power in a virtual motion.
  subroutine add_slopes(self, state, virtual, slopes, err)
    class(stop_load_type), intent(in) :: self           !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    type(motion_change_type), intent(inout) :: slopes   !< derivatives so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< never allocated
    real(wp) :: by(7)

    associate (k => self%stop%coordinate)
      by = slopes_in(self, state)
      slopes%q(k) = slopes%q(k) + by(1)*virtual%q(k)
      slopes%dq(k) = slopes%dq(k) + by(2)*virtual%q(k)
    end associate
  end subroutine add_slopes

  !> Both ends, stiffness, damping and exponent.
  pure subroutine numbers(self, values)
    class(stop_load_type), intent(in) :: self         !< the load
    real(wp), allocatable, intent(out) :: values(:)   !< (5) the numbers

    values = [self%stop%ends, self%stop%stiffness, self%stop%damping, self%stop%exponent]
  end subroutine numbers

  !> Add the derivative of the generalized force by a parameter on which its numbers depend.
  subroutine vary_by_numbers(self, change, factor, state, changes, err)
    class(stop_load_type), intent(in) :: self           !< the load
    real(wp), intent(in) :: change(:)                   !< (5) derivatives of the numbers
    real(wp), intent(in) :: factor                      !< 1, since it has no law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< never allocated
    real(wp) :: slopes(7)

    associate (k => self%stop%coordinate)
      slopes = slopes_in(self, state)
      call changes%add_generalized(k, factor*dot_product(slopes(3:), change))
    end associate
  end subroutine vary_by_numbers

  !> Energy of the stop without its damping [J].
  pure real(wp) function potential(self, state)
    class(stop_load_type), intent(in) :: self     !< the load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates
    integer :: end

    potential = 0.0_wp
    associate (power => self%stop%exponent + 1.0_wp)
      do end = 1, 2
        potential = potential + self%stop%stiffness*max(0.0_wp, -self%stop%gap(end, state%q(self%stop%coordinate)))**power/power
      end do
    end associate
  end function potential

  !> The derivative of this energy by a parameter.
  pure real(wp) function varied_potential(self, state, change, derivatives) result(energy)
    class(stop_load_type), intent(in) :: self        !< the load
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by the parameter
    real(wp), intent(in) :: derivatives(:)           !< derivatives of its numbers; of size 0: all are zero
    real(wp) :: depth, depth_change, by_power
    integer :: end

    energy = 0.0_wp
    associate (n => self%stop%exponent + 1.0_wp, k => self%stop%coordinate)
      do end = 1, 2
        depth = -self%stop%gap(end, state%q(k))
        if (.not. depth > 0.0_wp) cycle
        depth_change = (2*end - 3)*change%q(k)
        if (size(derivatives) > 0) then
          depth_change = depth_change - (2*end - 3)*derivatives(end)
          by_power = depth**n/n*(log(depth) - 1.0_wp/n)
          energy = energy + derivatives(3)*depth**n/n + self%stop%stiffness*by_power*derivatives(5)
        end if
        energy = energy + self%stop%stiffness*depth**(n - 1.0_wp)*depth_change
      end do
    end associate
  end function varied_potential
end module mech9_stop_load
