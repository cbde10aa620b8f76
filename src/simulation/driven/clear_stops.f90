!> Coordinates of a driven motion that stay far from the ends of their stops: the test that costs least where a stop is never met.
!>
!> From a position at which all gaps of a coordinate are g at least, it may move by g/4 to either side, and change within a step by rates of
!> g/4 a step: both gaps of the step and the points by which its rates bend the cubic polynomial between them then lie between 2/3 g and
!> 4/3 g, so that `in_doubt` is false.
module mech9_clear_stops
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_stop_contacts, only: stop_contacts_type
  implicit none
  private
  public :: clear_stops_type

  !> The coordinates with stops, and the ranges in which they are clear of these.
  type :: clear_stops_type
    integer :: n = 0                            !< number of these coordinates; 0: none, or contacts of links are watched, too
    integer, allocatable :: coordinates(:)      !< (n) their numbers
    !> (4,n) of each: its value in the middle of the range, how far the range goes to both sides (negative: there is none), its value at the
    !> last position, and its rate there [rad, m, rad/s, m/s]
    real(wp), allocatable :: ranges(:, :)
  contains
    procedure :: begin
    procedure :: renew
    procedure :: recall
    procedure :: go_on
  end type clear_stops_type

  !> Part of the least gap by which a coordinate may move.
  real(wp), parameter :: movable_part = 0.25_wp
  !> Gaps below this, in the unit of the coordinate, are never clear: `in_doubt` allows for a part of the unit, too.
  real(wp), parameter :: near = 1.0e-8_wp

contains

  !> Begin at a position whose gaps are noted. A motion that may bring links into contact is left to `in_doubt` altogether.
  pure subroutine begin(self, contacts, plan, state)
    class(clear_stops_type), intent(inout) :: self     !< the coordinates
    type(stop_contacts_type), intent(in) :: contacts   !< all ends
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(state_type), intent(in) :: state              !< the position, with its rates
    logical :: bounded(plan%n_coordinates)
    integer :: i

    bounded = .false.
    if (contacts%n_stops == size(contacts%ends)) bounded(contacts%ends%coordinate) = .true.
    self%coordinates = pack([(i, i=1, size(bounded))], bounded)
    self%n = size(self%coordinates)
    if (allocated(self%ranges)) deallocate (self%ranges)
    allocate (self%ranges(4, self%n))
    call self%renew(contacts, plan, state)
  end subroutine begin

  !> Begin anew at a position whose gaps are noted.
  pure subroutine renew(self, contacts, plan, state)
    class(clear_stops_type), intent(inout) :: self     !< the coordinates
    type(stop_contacts_type), intent(in) :: contacts   !< all ends
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(state_type), intent(in) :: state              !< the position, with its rates
    real(wp) :: gap
    integer :: i

    do i = 1, self%n
      associate (c => self%coordinates(i))
        gap = minval(contacts%gap, mask=contacts%ends%coordinate == c) - near*plan%unit_of(c)
        self%ranges(:, i) = [state%q(c), movable_part*gap, state%q(c), state%dq(c)]
      end associate
    end do
  end subroutine renew

  !> Note the gaps of the last position, from which a step is judged that is not clear.
  pure subroutine recall(self, contacts)
    class(clear_stops_type), intent(in) :: self           !< the coordinates
    type(stop_contacts_type), intent(inout) :: contacts   !< all ends
    integer :: i, k

    do i = 1, self%n
      do k = 1, size(contacts%ends)
        if (contacts%ends(k)%coordinate /= self%coordinates(i)) cycle
        contacts%gap(k) = contacts%ends(k)%gap(self%ranges(3, i))
        contacts%rate(k) = contacts%ends(k)%direction*self%ranges(4, i)
      end do
    end do
  end subroutine recall

  !> Go on to a position, if the step to it is clear of all ends. Does nothing else where it is not.
  pure subroutine go_on(self, state, h, clear)
    class(clear_stops_type), intent(inout) :: self   !< the coordinates, at the last position; then at this one
    type(state_type), intent(in) :: state            !< the position, with its rates
    real(wp), intent(in) :: h                        !< length of the step, with its sign [s]
    logical, intent(out) :: clear                    !< no end was passed within the step

    clear = .false.
    if (self%n > 0) call step(self%n, self%coordinates, state%q, state%dq, abs(h), self%ranges, clear)
  end subroutine go_on

  !> The same with explicit shapes, so that the loops need no strides. The last positions stay where a coordinate is not clear.
  pure subroutine step(n, coordinates, q, dq, h, ranges, clear)
    integer, intent(in) :: n                    !< number of the coordinates
    integer, intent(in) :: coordinates(n)       !< their numbers
    real(wp), intent(in) :: q(*)                !< (M) values of all coordinates [rad, m]
    real(wp), intent(in) :: dq(*)               !< (M) their rates [rad/s, m/s]
    real(wp), intent(in) :: h                   !< length of the step [s]
    real(wp), intent(inout) :: ranges(4, n)     !< as in the type
    logical, intent(out) :: clear               !< no end was passed
    integer :: i, c

    do i = 1, n
      c = coordinates(i)
      clear = abs(q(c) - ranges(1, i)) <= ranges(2, i) .and. max(abs(dq(c)), abs(ranges(4, i)))*h <= ranges(2, i)
      if (.not. clear) return
    end do
    do i = 1, n
      c = coordinates(i)
      ranges(3, i) = q(c)
      ranges(4, i) = dq(c)
    end do
  end subroutine step
end module mech9_clear_stops
