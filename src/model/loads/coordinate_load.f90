!> A spring, damper and actuator on a coordinate, independent or not.
module mech9_coordinate_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_factored_load, only: factored_load_type
  implicit none
  private
  public :: coordinate_load_type

  !> -stiffness (q - rest) - damping dq/dt + force, on q.
  type, extends(factored_load_type) :: coordinate_load_type
    integer :: coordinate = 0        !< number of the coordinate
    real(wp) :: stiffness = 0.0_wp   !< [N m/rad, N/m]
    real(wp) :: rest = 0.0_wp        !< [rad, m]
    real(wp) :: damping = 0.0_wp     !< [N m s/rad, N s/m]
    real(wp) :: force = 0.0_wp       !< [N m, N]
  contains
    procedure :: mark_own_links
    procedure :: is_idle
    procedure :: mark_own_coordinates
    procedure :: apply_times
    procedure :: potential
    procedure :: vary_times
    procedure :: add_slopes_times
    procedure :: find_power
    procedure :: numbers
    procedure :: take_numbers
    procedure :: vary_by_numbers
    procedure :: varied_potential
    procedure, non_overridable :: has_potential
  end type coordinate_load_type

contains

  !> Whether all its numbers are zero.
  pure logical function is_idle(self)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load

    is_idle = .not. (abs(self%stiffness) > 0.0_wp .or. abs(self%damping) > 0.0_wp .or. abs(self%force) > 0.0_wp)
  end function is_idle

  !> The load acts on a coordinate and requests no link.
  pure subroutine mark_own_links(self, needed)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load
    logical, intent(inout) :: needed(:)               !< (N) unchanged
  end subroutine mark_own_links

  !> Mark its coordinate.
  pure subroutine mark_own_coordinates(self, needed)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load
    logical, intent(inout) :: needed(:)               !< (M) becomes true for the coordinate

    needed(self%coordinate) = .true.
  end subroutine mark_own_coordinates

  !> Add the generalized force on the coordinate.
  subroutine apply_times(self, factor, state, sum, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(coordinate_load_type), intent(in) :: self     !< the coordinate load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    associate (k => self%coordinate)
      call sum%add_generalized(k, factor*(self%force - self%stiffness*(state%q(k) - self%rest) - self%damping*state%dq(k)))
    end associate
  end subroutine apply_times

  !> Add the derivative of the generalized force by a parameter.
  subroutine vary_times(self, factor, state, change, changes, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(coordinate_load_type), intent(in) :: self     !< the coordinate load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    associate (k => self%coordinate)
      call changes%add_generalized(k, -factor*(self%stiffness*change%q(k) + self%damping*change%dq(k)))
    end associate
  end subroutine vary_times

  !> Add the derivatives of the power in a virtual motion.
  subroutine add_slopes_times(self, factor, state, virtual, slopes, err)
    real(wp), intent(in) :: factor                      !< by which its forces are multiplied
    class(coordinate_load_type), intent(in) :: self     !< the coordinate load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    type(motion_change_type), intent(inout) :: slopes   !< derivatives so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    associate (k => self%coordinate)
      slopes%q(k) = slopes%q(k) - factor*self%stiffness*virtual%q(k)
      slopes%dq(k) = slopes%dq(k) - factor*self%damping*virtual%q(k)
    end associate
  end subroutine add_slopes_times

  !> The power in a virtual motion.
  subroutine find_power(self, state, virtual, power, err)
    class(coordinate_load_type), intent(in) :: self     !< the coordinate load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    real(wp), intent(out) :: power                      !< per unit of the motion [J]
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    associate (k => self%coordinate)
      power = (self%force - self%stiffness*(state%q(k) - self%rest) - self%damping*state%dq(k))*virtual%q(k)
    end associate
  end subroutine find_power

  !> Stiffness, rest position, damping and force.
  pure subroutine numbers(self, values)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load
    real(wp), allocatable, intent(out) :: values(:)   !< (4) the numbers

    values = [self%stiffness, self%rest, self%damping, self%force]
  end subroutine numbers

  !> Take other numbers.
  pure subroutine take_numbers(self, values, are_taken)
    class(coordinate_load_type), intent(inout) :: self   !< the coordinate load
    real(wp), intent(in) :: values(:)           !< (4) as of `numbers`
    logical, intent(out) :: are_taken           !< true

    self%stiffness = values(1)
    self%rest = values(2)
    self%damping = values(3)
    self%force = values(4)
    are_taken = .true.
  end subroutine take_numbers

  !> Add the derivative of the generalized force by a parameter on which its numbers depend.
  subroutine vary_by_numbers(self, change, factor, state, changes, err)
    class(coordinate_load_type), intent(in) :: self     !< the coordinate load
    real(wp), intent(in) :: change(:)                   !< (4) derivatives of the numbers
    real(wp), intent(in) :: factor                      !< of its law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    associate (k => self%coordinate)
      call changes%add_generalized(k, factor*(change(4) - change(1)*(state%q(k) - self%rest) + self%stiffness*change(2) &
                                              - change(3)*state%dq(k)))
    end associate
  end subroutine vary_by_numbers

  !> Whether a potential has the forces of the load but for its damper: a law over another variable than the coordinate has none.
  pure logical function has_potential(self)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load

    has_potential = .not. allocated(self%law)
    if (allocated(self%over)) has_potential = self%over%is_over(self%coordinate)
  end function has_potential

  !> The derivative of the potential energy by a parameter.
  pure real(wp) function varied_potential(self, state, change, derivatives) result(energy)
    class(coordinate_load_type), intent(in) :: self  !< the coordinate load
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by the parameter
    real(wp), intent(in) :: derivatives(:)           !< derivatives of its numbers and those of its law; of size 0: all are zero
    real(wp) :: of_numbers(4), stretch, x, value, first, second, first_change, second_change

    energy = 0.0_wp
    if (.not. self%has_potential()) return
    of_numbers = 0.0_wp
    if (size(derivatives) > 0) of_numbers = derivatives(:4)
    stretch = state%q(self%coordinate) - self%rest
    if (.not. allocated(self%over)) then
      energy = 0.5_wp*of_numbers(1)*stretch**2 + self%stiffness*stretch*(change%q(self%coordinate) - of_numbers(2))
      return
    end if
    associate (unit => self%over%unit)
      x = self%over%variable(state)
      call self%over%law%integrals(x, value, first, second)
      energy = value*(self%stiffness*stretch - self%force)*change%q(self%coordinate) &
               - (of_numbers(4) + of_numbers(1)*self%rest + self%stiffness*of_numbers(2))*unit*first &
               + of_numbers(1)*unit**2*(x*first - second)
      if (size(derivatives) <= 4) return
      call self%over%law%vary_integrals(derivatives(5:), x, first_change, second_change)
      energy = energy - (self%force + self%stiffness*self%rest)*unit*first_change &
               + self%stiffness*unit**2*(x*first_change - second_change)
    end associate
  end function varied_potential

  !> Energy of the spring [J]; with a law over the coordinate itself the work of spring and force from 0 back to it. The work of
  !> a constant force, and of other laws, counts as put in.
  pure real(wp) function potential(self, state)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load
    type(motion_view_type), intent(in) :: state       !< present motion of links and coordinates
    real(wp) :: x, value, first, second

    potential = 0.0_wp
    if (.not. self%has_potential()) return
    if (.not. allocated(self%over)) then
      potential = 0.5_wp*self%stiffness*(state%q(self%coordinate) - self%rest)**2
      return
    end if
    ! the integral of factor(x) (stiffness (x - rest) - force) by parts
    associate (unit => self%over%unit)
      x = self%over%variable(state)
      call self%over%law%integrals(x, value, first, second)
      potential = self%stiffness*unit**2*(x*first - second) - (self%force + self%stiffness*self%rest)*unit*first
    end associate
  end function potential
end module mech9_coordinate_load
