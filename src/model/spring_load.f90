!> A spring and damper between points of two links.
module mech9_spring_load
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_integrator
  use mech9_text, only: to_text
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: spring_load_type

  !> A spring that pulls its ends together with stiffness (length - free length) + damping d(length)/dt.
  type, extends(load_type) :: spring_load_type
    integer :: links(2) = 0                !< numbers of the links of its ends
    real(wp) :: positions(3, 2) = 0.0_wp   !< of its ends, each in its link's system [m]
    real(wp) :: stiffness = 0.0_wp         !< [N/m]
    real(wp) :: free_length = 0.0_wp       !< [m]
    real(wp) :: damping = 0.0_wp           !< [N s/m]
  contains
    procedure :: mark_links
    procedure :: is_idle
    procedure :: apply
    procedure :: potential
    procedure, private :: span
  end type spring_load_type

contains

  !> Whether stiffness and damping are zero.
  pure logical function is_idle(self)
    class(spring_load_type), intent(in) :: self   !< the spring load

    is_idle = .not. (abs(self%stiffness) > 0.0_wp .or. abs(self%damping) > 0.0_wp)
  end function is_idle

  !> Mark the links of its ends.
  pure subroutine mark_links(self, needed)
    class(spring_load_type), intent(in) :: self   !< the spring load
    logical, intent(inout) :: needed(:)           !< (N) becomes true for the two links

    needed(self%links) = .true.
  end subroutine mark_links

  !> Vector from the first end to the second, fixed axes [m].
  pure function span(self, state)
    class(spring_load_type), intent(in) :: self   !< the spring load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates
    real(wp) :: span(3)

    span = state%links(self%links(2))%point_position(self%positions(:, 2)) &
           - state%links(self%links(1))%point_position(self%positions(:, 1))
  end function span

  !> Add the pull at both ends. Fails for a spring with a free length whose ends meet.
  subroutine apply(self, state, sum, err)
    class(spring_load_type), intent(in) :: self         !< the spring load
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates
    type(force_sum_type), intent(inout) :: sum          !< forces so far; the load is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: d(3), rate(3), pull(3), length

    d = self%span(state)
    rate = state%links(self%links(2))%point_velocity(self%positions(:, 2)) &
           - state%links(self%links(1))%point_velocity(self%positions(:, 1))
    length = norm2(d)
    if (length > 0.0_wp) then
      pull = (self%stiffness*(length - self%free_length) + self%damping*dot_product(d, rate)/length)/length*d
    else if (abs(self%free_length) > 0.0_wp) then
      call raise(err, exit_integrator, 'a spring of free length '//to_text(self%free_length)// &
                 ' m has shrunk to nothing, where its direction is not defined', self%place)
      return
    else
      pull = self%damping*rate
    end if
    call sum%add_force(state, self%links(1), self%positions(:, 1), pull)
    call sum%add_force(state, self%links(2), self%positions(:, 2), -pull)
  end subroutine apply

  !> Energy of the spring [J].
  pure real(wp) function potential(self, state)
    class(spring_load_type), intent(in) :: self   !< the spring load
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates

    potential = 0.5_wp*self%stiffness*(norm2(self%span(state)) - self%free_length)**2
  end function potential
end module mech9_spring_load
