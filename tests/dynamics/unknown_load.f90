!> A load whose formula the program does not know, as a user's procedure is: it does not give its own derivatives.
module mech9_unknown_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: unknown_load_type

  !> A curved spring and damper of one link, a torque on the other, and a force on coordinate 1.
  type, extends(load_type) :: unknown_load_type
    integer :: links(2) = 0                                !< numbers of two links
    real(wp) :: point(3) = [0.2_wp, -0.3_wp, 0.5_wp]       !< of the first link [m]
  contains
    procedure :: mark_links
    procedure :: apply
    procedure :: potential
  end type unknown_load_type

contains

  !> Both links.
  pure subroutine mark_links(self, needed)
    class(unknown_load_type), intent(in) :: self   !< the load
    logical, intent(inout) :: needed(:)            !< (N) becomes true for the two links

    needed(self%links) = .true.
  end subroutine mark_links

  !> Smooth forces that depend on positions, directions, velocities, coordinates and rates.
  subroutine apply(self, state, sum, err)
    class(unknown_load_type), intent(in) :: self        !< the load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: x(3), v(3), axis(3)

    x = state%position(self%links(1), self%point)
    v = state%velocity(self%links(1), self%point)
    axis = state%turned(self%links(2), [0.0_wp, 0.6_wp, 0.8_wp])
    call sum%add_force(state, self%links(1), self%point, -4.0_wp*sin(x) - (1.0_wp + 0.3_wp*x(2))*v)
    call sum%add_torque(self%links(2), 2.0_wp*cos(axis) - 0.5_wp*state%links(self%links(2))%omega)
    call sum%add_generalized(1, sin(state%q(1)) - 0.4_wp*state%dq(1)*abs(1.0_wp + 0.1_wp*state%dq(1)))
  end subroutine apply

  !> Its work counts as put in.
  pure real(wp) function potential(self, state)
    class(unknown_load_type), intent(in) :: self    !< the load
    type(motion_view_type), intent(in) :: state     !< present motion of links and coordinates

    potential = 0.0_wp
  end function potential
end module mech9_unknown_load
