!> Ends of stops as contacts: the gap that is left to each, and whether it is closed.
!>
!> A rigid end that is closed holds its coordinate like a drive that does not move, as long as its force pushes. A compliant end is a
!> load; its contact begins and ends where its force is not smooth.
module mech9_stop_contacts
  use mech9_kinds, only: wp
  use mech9_stop, only: stop_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: stop_contact_type, stop_contacts_type, find_contacts

  !> One end of a stop.
  type :: stop_contact_type
    integer :: stop = 0                  !< number of the stop
    integer :: coordinate = 0            !< number of its coordinate
    integer :: direction = 1             !< of the force on the coordinate: 1 at the low end, -1 at the high one
    real(wp) :: limit = 0.0_wp           !< value of the coordinate at the end [rad, m]
    real(wp) :: restitution = 0.0_wp     !< of impacts
    logical :: is_rigid = .true.         !< it cannot be pressed in
    logical :: closed = .false.          !< a rigid end touches and pushes; a compliant one is pressed in
    logical :: held = .false.            !< the coordinate is driven at the limit; a closed rigid end that is not is held by others
  contains
    procedure :: gap
  end type stop_contact_type

  !> All ends of all stops, and their motion at the start of a step.
  type :: stop_contacts_type
    type(stop_contact_type), allocatable :: ends(:)
    real(wp), allocatable :: q(:)        !< (ends) coordinates at the start of the step [rad, m]
    real(wp), allocatable :: dq(:)       !< (ends) rates there, those of the last evaluation before it [rad/s, m/s]
    real(wp), allocatable :: force(:)    !< (ends) forces of those that are held there, positive while they push [N m, N]
    integer :: corrections = 0           !< how often the time of the event that lies ahead was corrected
  contains
    procedure :: note
    procedure :: show_pressed
    procedure :: any_held
    procedure :: held_coordinates
    procedure :: in_doubt
  end type stop_contacts_type

  !> A polynomial of the third degree through the ends of a step may be wrong by this part of its range within the step.
  real(wp), parameter :: doubtful_part = 0.1_wp

contains

  !> The gap that is left to the end; negative: the penetration [rad, m].
  pure real(wp) function gap(self, q)
    class(stop_contact_type), intent(in) :: self   !< the end
    real(wp), intent(in) :: q                      !< the coordinate [rad, m]

    gap = self%direction*(q - self%limit)
  end function gap

  !> All ends of some stops, open.
  pure subroutine find_contacts(stops, contacts)
    type(stop_type), intent(in) :: stops(:)               !< the stops
    type(stop_contacts_type), intent(out) :: contacts     !< their ends
    integer :: i, end, n

    n = 0
    do i = 1, size(stops)
      n = n + count([(stops(i)%has_end(end), end=1, 2)])
    end do
    allocate (contacts%ends(n))
    allocate (contacts%q(n), contacts%dq(n), contacts%force(n), source=0.0_wp)
    n = 0
    do i = 1, size(stops)
      do end = 1, 2
        if (.not. stops(i)%has_end(end)) cycle
        n = n + 1
        contacts%ends(n) = stop_contact_type(i, stops(i)%coordinate, 3 - 2*end, stops(i)%ends(end), stops(i)%restitution, &
                                             stops(i)%is_rigid)
      end do
    end do
  end subroutine find_contacts

  !> Note the motion from which the next step begins.
  pure subroutine note(self, state)
    class(stop_contacts_type), intent(inout) :: self   !< the ends
    type(state_type), intent(in) :: state              !< the state there; rates of dependent coordinates may be a little older
    integer :: i

    do i = 1, size(self%ends)
      self%q(i) = state%q(self%ends(i)%coordinate)
      self%dq(i) = state%dq(self%ends(i)%coordinate)
      if (allocated(state%stop_force)) self%force(i) = self%ends(i)%direction*state%stop_force(self%ends(i)%stop)
    end do
  end subroutine note

  !> Show a state which compliant ends push. Does nothing where there are none.
  pure subroutine show_pressed(self, state)
    class(stop_contacts_type), intent(in) :: self   !< the ends
    type(state_type), intent(inout) :: state        !< gets them
    integer :: i, n

    if (count(.not. self%ends%is_rigid) == 0) return
    n = self%ends(size(self%ends))%stop
    if (.not. allocated(state%pressed)) allocate (state%pressed(2, n))
    state%pressed = .false.
    do i = 1, size(self%ends)
      if (self%ends(i)%closed) state%pressed((3 - self%ends(i)%direction)/2, self%ends(i)%stop) = .not. self%ends(i)%is_rigid
    end do
  end subroutine show_pressed

  !> Whether any end holds its coordinate.
  pure logical function any_held(self)
    class(stop_contacts_type), intent(in) :: self   !< the ends

    any_held = any(self%ends%held)
  end function any_held

  !> Whether an end holds each coordinate.
  pure function held_coordinates(self, n) result(held)
    class(stop_contacts_type), intent(in) :: self   !< the ends
    integer, intent(in) :: n                        !< number of coordinates
    logical :: held(n)
    integer :: i

    held = .false.
    do i = 1, size(self%ends)
      if (self%ends(i)%held) held(self%ends(i)%coordinate) = .true.
    end do
  end function held_coordinates

  !> Whether any end that is not held may have been passed within a step. The answer costs no evaluation.
  pure logical function in_doubt(self, plan, state, h)
    class(stop_contacts_type), intent(in) :: self   !< the ends, with the motion at the start of the step
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(state_type), intent(in) :: state           !< positions at the end of the step, with the rates of the last evaluation
    real(wp), intent(in) :: h                       !< length of the step, with its sign [s]
    real(wp) :: values(4)
    integer :: i

    in_doubt = .true.
    do i = 1, size(self%ends)
      associate (end => self%ends(i), k => self%ends(i)%coordinate)
        if (end%held) cycle
        ! the polynomial at the ends of the step and where its control points lie: it does not leave their hull
        values = end%direction*([self%q(i), self%q(i) + h*self%dq(i)/3.0_wp, state%q(k) - h*state%dq(k)/3.0_wp, state%q(k)] &
                                - end%limit)
        if (end%closed) values = -values
        if (minval(values) < doubtful_part*(maxval(values) - minval(values)) + 1.0e-9_wp*plan%unit_of(k)) return
      end associate
    end do
    in_doubt = .false.
  end function in_doubt
end module mech9_stop_contacts
