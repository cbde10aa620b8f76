!> A spring, damper and actuator on a coordinate, independent or not.
module mech9_coordinate_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: coordinate_load_type

  !> -stiffness (q - rest) - damping dq/dt + force, on q.
  type, extends(load_type) :: coordinate_load_type
    integer :: coordinate = 0        !< number of the coordinate
    real(wp) :: stiffness = 0.0_wp   !< [N m/rad, N/m]
    real(wp) :: rest = 0.0_wp        !< [rad, m]
    real(wp) :: damping = 0.0_wp     !< [N m s/rad, N s/m]
    real(wp) :: force = 0.0_wp       !< [N m, N]
  contains
    procedure :: mark_links
    procedure :: is_idle
    procedure :: mark_coordinates
    procedure :: apply
    procedure :: potential
    procedure :: vary
    procedure :: knows_slopes
    procedure :: add_slopes
    procedure :: numbers
    procedure :: take_numbers
    procedure :: vary_by_numbers
    procedure :: varied_potential
  end type coordinate_load_type

contains

  !> Whether all its numbers are zero.
  pure logical function is_idle(self)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load

    is_idle = .not. (abs(self%stiffness) > 0.0_wp .or. abs(self%damping) > 0.0_wp .or. abs(self%force) > 0.0_wp)
  end function is_idle

  !> The load acts on a coordinate and requests no link.
  pure subroutine mark_links(self, needed)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load
    logical, intent(inout) :: needed(:)               !< (N) unchanged
  end subroutine mark_links

  !> Mark its coordinate.
  pure subroutine mark_coordinates(self, needed)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load
    logical, intent(inout) :: needed(:)               !< (M) becomes true for the coordinate

    needed(self%coordinate) = .true.
  end subroutine mark_coordinates

  !> Add the generalized force on the coordinate.
  subroutine apply(self, state, sum, err)
    class(coordinate_load_type), intent(in) :: self     !< the coordinate load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    real(wp) :: factor

    factor = 1.0_wp
    if (allocated(self%law)) call self%find_factor(state%t, factor, err)
    if (allocated(err)) return
    associate (k => self%coordinate)
      call sum%add_generalized(k, factor*(self%force - self%stiffness*(state%q(k) - self%rest) - self%damping*state%dq(k)))
    end associate
  end subroutine apply

  !> Add the derivative of the generalized force by a parameter.
  subroutine vary(self, state, change, changes, err)
    class(coordinate_load_type), intent(in) :: self     !< the coordinate load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    real(wp) :: factor

    factor = 1.0_wp
    if (allocated(self%law)) call self%find_factor(state%t, factor, err)
    if (allocated(err)) return
    associate (k => self%coordinate)
      call changes%add_generalized(k, -factor*(self%stiffness*change%q(k) + self%damping*change%dq(k)))
    end associate
  end subroutine vary

  !> The derivatives of its power are known.
  pure logical function knows_slopes(self)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load

    knows_slopes = .true.
  end function knows_slopes

  !> Add the derivatives of the power in a virtual motion.
  subroutine add_slopes(self, state, virtual, slopes, err)
    class(coordinate_load_type), intent(in) :: self     !< the coordinate load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: virtual     !< the virtual motion
    type(motion_change_type), intent(inout) :: slopes   !< derivatives so far; those of the load are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: factor

    factor = 1.0_wp
    if (allocated(self%law)) call self%find_factor(state%t, factor, err)
    if (allocated(err)) return
    associate (k => self%coordinate)
      slopes%q(k) = slopes%q(k) - factor*self%stiffness*virtual%q(k)
      slopes%dq(k) = slopes%dq(k) - factor*self%damping*virtual%q(k)
    end associate
  end subroutine add_slopes

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

  !> The derivative of the energy of the spring by a parameter.
  pure real(wp) function varied_potential(self, state, change, derivatives) result(energy)
    class(coordinate_load_type), intent(in) :: self  !< the coordinate load
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by the parameter
    real(wp), intent(in) :: derivatives(:)           !< derivatives of its numbers and those of its law; of size 0: all are zero
    real(wp) :: stretch, stretch_change

    energy = 0.0_wp
    if (allocated(self%law)) return
    stretch = state%q(self%coordinate) - self%rest
    stretch_change = change%q(self%coordinate)
    if (size(derivatives) > 0) then
      stretch_change = stretch_change - derivatives(2)
      energy = 0.5_wp*derivatives(1)*stretch**2
    end if
    energy = energy + self%stiffness*stretch*stretch_change
  end function varied_potential

  !> Energy of the spring [J]; the work of the actuator counts as put in.
  pure real(wp) function potential(self, state)
    class(coordinate_load_type), intent(in) :: self   !< the coordinate load
    type(motion_view_type), intent(in) :: state       !< present motion of links and coordinates

    potential = 0.0_wp
    if (.not. allocated(self%law)) potential = 0.5_wp*self%stiffness*(state%q(self%coordinate) - self%rest)**2
  end function potential
end module mech9_coordinate_load
