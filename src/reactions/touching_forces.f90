!> The forces of stops, dry friction and contacts, one by one, for pictures.
!>
!> Stops and frictions work on a coordinate; a coordinate whose pair turns has a torque about the axis, one whose pair slides, or follows
!> a curve, a force along it. A user's pair is judged in each position: it has a torque where its link turns, else a force. Friction in
!> a thread has both: it acts along the thread, whose mean radius is known. Both are part of the wrench of their pair (mech9_reactions). Contacts act between links that no pair needs to join; their forces begin where the bodies
!> touch.
module mech9_touching_forces
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, unit
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning, sliding, screwing, free
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion, step_screw
  implicit none
  private
  public :: touching_force_type, touching_forces_type, new_touching_forces, from_stop, from_friction, from_contact

  !> A user's pair slides where it turns by less than this part of a radian for each metre.
  real(wp), parameter :: least_turn = 1.0e-9_wp

  !> Sources of a force.
  integer, parameter :: from_stop = 1, from_friction = 2, from_contact = 3

  !> One force or torque on a link.
  type :: touching_force_type
    integer :: source = from_stop       !< from_stop, from_friction or from_contact
    integer :: number = 0               !< of the stop, the friction, or the contact in the mechanism
    logical :: is_torque = .false.      !< a torque [N m], no force [N]
    integer :: link = 1                 !< on which it acts
    real(wp) :: foot(3) = 0.0_wp        !< the point at which it acts, in the link's system; not of contacts [m]
    logical :: of_user = .false.        !< in a user's pair: zero where that turns and this is a force, and the other way round
    real(wp) :: share = 1.0_wp          !< vector by the force on the coordinate; of a contact 1 on the ball, -1 on the surface
  end type touching_force_type

  !> All of them. They are listed whether they are zero or not.
  type :: touching_forces_type
    type(touching_force_type), allocatable :: items(:)
    type(pair_axes_type), allocatable, private :: axes(:)   !< of all pairs
  contains
    procedure :: find
  end type touching_forces_type

contains

  !> List the forces of stops, frictions and contacts, in the order of the data file.
  subroutine new_touching_forces(mechanism, self)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(touching_forces_type), intent(out) :: self     !< gets the list
    integer :: i, side

    allocate (self%items(0))
    self%axes = pair_axes(mechanism%pairs)
    do i = 1, size(mechanism%stops)
      call append_of_coordinate(mechanism, from_stop, i, mechanism%stops(i)%coordinate, self)
    end do
    if (mechanism%has_frictions()) then
      do i = 1, size(mechanism%frictions)
        call append_of_coordinate(mechanism, from_friction, i, mechanism%frictions(i)%coordinate, self)
      end do
    end if
    if (.not. mechanism%has_contacts()) return
    do i = 1, size(mechanism%contacts)
      do side = 1, 2
        associate (link => mechanism%contacts(i)%links(side))
          if (link > 1) call append(touching_force_type(from_contact, i, .false., link, &
                                                        share=merge(1.0_wp, -1.0_wp, side == 1)), self)
        end associate
      end do
    end do
  end subroutine new_touching_forces

  !> Append the force of a stop or a friction on the moving link of its pair. A user's pair has a torque and a force, of which one is
  !> zero in each position.
  subroutine append_of_coordinate(mechanism, source, number, coordinate, self)
    type(mechanism_type), intent(in) :: mechanism           !< the mechanism
    integer, intent(in) :: source                           !< from_stop or from_friction
    integer, intent(in) :: number                           !< number of the stop or friction
    integer, intent(in) :: coordinate                       !< its coordinate
    type(touching_forces_type), intent(inout) :: self       !< the list, with the axes of pairs
    real(wp) :: square

    associate (axes => self%axes(coordinate), link => self%axes(coordinate)%links(2))
      select case (axes%kind)
      case (turning)
        call append(touching_force_type(source, number, .true., link, axes%points(:, 2)), self)
      case (screwing)
        if (source == from_friction) then
          associate (friction => mechanism%frictions(number))
            square = friction%radius**2 + friction%lead**2
            call append(touching_force_type(source, number, .true., link, axes%points(:, 2), &
                                          share=friction%radius**2/square), self)
            call append(touching_force_type(source, number, .false., link, axes%points(:, 2), &
                                          share=friction%lead/square), self)
          end associate
        else
          call append(touching_force_type(source, number, .true., link, axes%points(:, 2)), self)
        end if
      case (sliding)
        call append(touching_force_type(source, number, .false., link, axes%points(:, 2)), self)
      case (free)
        if (size(axes%guide, 2) > 0) then
          call append(touching_force_type(source, number, .false., link, axes%points(:, 2)), self)
        else
          call append(touching_force_type(source, number, .true., link, axes%points(:, 2), of_user=.true.), self)
          call append(touching_force_type(source, number, .false., link, axes%points(:, 2), of_user=.true.), self)
        end if
      end select
    end associate
  end subroutine append_of_coordinate

  !> Append an item to a list.
  subroutine append(item, self)
    type(touching_force_type), intent(in) :: item         !< the item
    type(touching_forces_type), intent(inout) :: self     !< the list
    type(touching_force_type), allocatable :: longer(:)

    allocate (longer(size(self%items) + 1))
    longer(:size(self%items)) = self%items
    longer(size(longer)) = item
    call move_alloc(longer, self%items)
  end subroutine append

  !> The forces and torques in a state, in the axes of link 1, and where those of contacts begin.
  subroutine find(self, mechanism, plan, state, vectors, feet)
    class(touching_forces_type), intent(in) :: self     !< the list
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< its plan, with all blocks
    type(state_type), intent(in) :: state               !< positions and rates, with the forces of stops, frictions and contacts
    real(wp), intent(out) :: vectors(:, :)              !< (3,items) [N, N m]
    real(wp), intent(out) :: feet(:, :)                 !< (3,items) where forces of contacts begin, in the system of link 1 [m]
    integer :: i

    feet = 0.0_wp
    do i = 1, size(self%items)
      associate (item => self%items(i))
        select case (item%source)
        case (from_stop)
          vectors(:, i) = stop_force(mechanism, item%number, state)
          call turn_along(self%axes(mechanism%stops(item%number)%coordinate), plan, state, &
                          mechanism%stops(item%number)%coordinate, item, vectors(:, i))
        case (from_friction)
          vectors(:, i) = 0.0_wp
          if (allocated(state%friction)) vectors(:, i) = state%friction(item%number)
          call turn_along(self%axes(mechanism%frictions(item%number)%coordinate), plan, state, &
                          mechanism%frictions(item%number)%coordinate, item, vectors(:, i))
        case default
          call find_contact(mechanism, item%number, plan, state, vectors(:, i), feet(:, i))
          vectors(:, i) = item%share*vectors(:, i)
        end select
      end associate
    end do
  end subroutine find

  !> The force of a stop on its coordinate [N m, N].
  pure real(wp) function stop_force(mechanism, number, state) result(force)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: number                   !< number of the stop
    type(state_type), intent(in) :: state           !< the state, with the forces of rigid stops

    force = 0.0_wp
    associate (stop => mechanism%stops(number))
      if (stop%is_rigid) then
        if (allocated(state%stop_force)) force = state%stop_force(number)
      else if (allocated(state%pressed)) then
        force = stop%force(state%q(stop%coordinate), state%dq(stop%coordinate), state%pressed(:, number))
      else
        force = stop%force(state%q(stop%coordinate), state%dq(stop%coordinate))
      end if
    end associate
  end function stop_force

  !> Turn the force on a coordinate, in each component at first, into the force or torque on the moving link of its pair. Both do the
  !> same work, also where a user's coordinate is no angle and no length.
  pure subroutine turn_along(axes, plan, state, coordinate, item, vector)
    type(pair_axes_type), intent(in) :: axes        !< of the pair
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(state_type), intent(in) :: state           !< with the poses of the frames
    integer, intent(in) :: coordinate               !< number of the coordinate
    type(touching_force_type), intent(in) :: item   !< a force or a torque, with its share
    real(wp), intent(inout) :: vector(3)            !< the force on the coordinate; then [N, N m], in the axes of link 1
    real(wp) :: r(3, 3), p(3), omega(3), v(3), w(3), along(3)
    integer :: s

    call link_motion(plan, state, axes%links(2), r, p, omega, v)
    if (axes%kind /= free) then
      along = turn(r, axes%axes(:, 2))
    else if (any(abs(axes%tangent) > 0.0_wp)) then
      along = turn(r, axes%tangent)
    else
      ! a link that does not turn moves with all its points in one direction
      s = findloc(plan%steps%coordinate, coordinate, dim=1)
      call step_screw(plan, state, s, w, v, p)
      if (plan%steps(s)%reversed) then
        w = -w
        v = -v
      end if
      along = unit(v)
      if (item%of_user) along = of_same_work(w, v, item%is_torque)
    end if
    vector = item%share*vector*along
  end subroutine turn_along

  !> The torque, or the force, that works as a force of one unit on a user's coordinate does: a torque where the link turns.
  pure function of_same_work(w, v, is_torque) result(along)
    real(wp), intent(in) :: w(3)          !< angular velocity per unit rate [rad per unit of q]
    real(wp), intent(in) :: v(3)          !< velocity per unit rate [m per unit of q]
    logical, intent(in) :: is_torque      !< the torque is asked for
    real(wp) :: along(3)
    real(wp) :: square
    logical :: turns

    along = 0.0_wp
    turns = norm2(w) > least_turn*norm2(v)
    if (turns .neqv. is_torque) return
    along = merge(w, v, turns)
    square = sum(along**2)
    if (square > 0.0_wp) along = along/square
  end function of_same_work

  !> The force of a contact on its ball, and where the bodies touch; no force where it is open.
  subroutine find_contact(mechanism, number, plan, state, force, at)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: number                   !< number of the contact in the mechanism
    type(plan_type), intent(in) :: plan             !< its plan
    type(state_type), intent(in) :: state           !< positions and rates
    real(wp), intent(out) :: force(3)               !< [N]
    real(wp), intent(out) :: at(3)                  !< in the system of link 1 [m]
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface

    associate (contact => mechanism%contacts(number))
      call link_motion(plan, state, contact%links(1), ball%r, ball%p, ball%omega, ball%v)
      call link_motion(plan, state, contact%links(2), surface%r, surface%p, surface%omega, surface%v)
      place = contact%find_place(ball, surface)
      at = place%at
      if (allocated(state%contact_force)) then
        force = state%contact_force(:, number)
      else
        force = contact%normal_force(place)*place%normal
      end if
    end associate
  end subroutine find_contact
end module mech9_touching_forces
