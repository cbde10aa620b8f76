!> The sums of all loads as forces and torques on links and generalized forces on coordinates.
module mech9_force_sum
  use mech9_kinds, only: wp
  use mech9_zero, only: make_zero
  use mech9_rotation, only: turn, cross
  use mech9_call_fault, only: call_fault_type
  use mech9_motion_view, only: motion_view_type
  implicit none
  private
  public :: force_sum_type, new_force_sum

  !> Resultants with components in fixed axes. The torque on each link is about the origin of the link's own system.
  type :: force_sum_type
    real(wp), allocatable :: force(:, :)      !< (3,N) [N]
    real(wp), allocatable :: torque(:, :)     !< (3,N) [N m]
    real(wp), allocatable :: generalized(:)   !< (M) [N m or N]
    logical :: any_generalized = .false.      !< a generalized force was added since the last `clear`
    logical :: unanswered = .false.           !< no user's procedure is linked
    type(call_fault_type) :: fault            !< the first call with a number that does not exist, since the last `clear`
  contains
    procedure :: clear
    procedure :: add_force
    procedure :: add_torque
    procedure :: add_generalized
    procedure, private, non_overridable :: has_link
  end type force_sum_type

contains

  !> Sums that are zero, for a mechanism with a given number of links and coordinates.
  pure function new_force_sum(n_links, n_coordinates) result(sum)
    integer, intent(in) :: n_links         !< N
    integer, intent(in) :: n_coordinates   !< M
    type(force_sum_type) :: sum

    allocate (sum%force(3, n_links), sum%torque(3, n_links), source=0.0_wp)
    allocate (sum%generalized(n_coordinates), source=0.0_wp)
  end function new_force_sum

  !> Make the sums zero again.
  pure subroutine clear(self)
    class(force_sum_type), intent(inout) :: self   !< the force sum

    call make_zero(size(self%force), self%force)
    call make_zero(size(self%torque), self%torque)
    if (self%any_generalized) call make_zero(size(self%generalized), self%generalized)
    self%any_generalized = .false.
    self%fault%found = .false.
  end subroutine clear

  !> A force at a point of a link. A number that no link has is noted in `fault`, and nothing is added.
  pure subroutine add_force(self, state, link, point, force)
    class(force_sum_type), intent(inout) :: self   !< the force sum
    type(motion_view_type), intent(in) :: state    !< in which the force acts
    integer, intent(in) :: link                    !< its number
    real(wp), intent(in) :: point(3)               !< in the link's system [m]
    real(wp), intent(in) :: force(3)               !< fixed axes [N]
    real(wp) :: arm(3)
    logical :: exists

    call self%has_link(link, 'add_force', exists)
    if (.not. exists) return
    arm = turn(state%links(link)%r, point)
    self%force(:, link) = self%force(:, link) + force
    self%torque(:, link) = self%torque(:, link) + cross(arm, force)
  end subroutine add_force

  !> A torque on a link. A number that no link has is noted in `fault`, and nothing is added.
  pure subroutine add_torque(self, link, torque)
    class(force_sum_type), intent(inout) :: self   !< the force sum
    integer, intent(in) :: link                    !< its number
    real(wp), intent(in) :: torque(3)              !< fixed axes [N m]
    logical :: exists

    call self%has_link(link, 'add_torque', exists)
    if (exists) self%torque(:, link) = self%torque(:, link) + torque
  end subroutine add_torque

  !> A generalized force on a coordinate: a torque about the axis of a revolute pair, a force along
  !> that of a prismatic one; it acts on the moving link and back on the reference link. A number that no
  !> coordinate has is noted in `fault`, and nothing is added.
  pure subroutine add_generalized(self, coordinate, value)
    class(force_sum_type), intent(inout) :: self   !< the force sum
    integer, intent(in) :: coordinate              !< its number
    real(wp), intent(in) :: value                  !< [N m, N]

    if (coordinate < 1 .or. coordinate > size(self%generalized)) then
      call self%fault%note('add_generalized', 'coordinate', coordinate, size(self%generalized))
      return
    end if
    self%generalized(coordinate) = self%generalized(coordinate) + value
    self%any_generalized = .true.
  end subroutine add_generalized

  !> Whether a link exists. If not, the call is noted.
  pure subroutine has_link(self, link, procedure, exists)
    class(force_sum_type), intent(inout) :: self   !< the force sum
    integer, intent(in) :: link                    !< its number
    character(len=*), intent(in) :: procedure      !< name of the procedure to which the number was given
    logical, intent(out) :: exists                 !< there is a link of this number

    exists = link >= 1 .and. link <= min(size(self%force, 2), self%fault%links)
    if (.not. exists) call self%fault%note(procedure, 'link', link, min(size(self%force, 2), self%fault%links))
  end subroutine has_link
end module mech9_force_sum
