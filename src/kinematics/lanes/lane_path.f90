!> Positions of one planar mechanism side by side: in each lane the independent coordinates move along a straight line from a
!> position that is known, and stop where positions are asked for.
!>
!> The length x of the way is that of a drive with the rate that is given: q = from + way x. A lane that comes near a singular position,
!> or that would need a shorter step, no longer goes on; its positions are then to be found alone.
module mech9_lane_path
  use mech9_kinds, only: wp
  use mech9_processor, only: vector_bits
  use mech9_plan, only: plan_type
  use mech9_lane_group, only: lane_group_type, lanes, new_lane_group, fits_lanes, renew_lane, copy_lane
  use mech9_lane_motion, only: begin_group, go_on_with_group, renew_rates_of_group
  use mech9_lane_tolerances, only: least_way, longest_way
  implicit none
  private
  public :: lane_path_type

  !> The lanes, their lines, and the places on these.
  type :: lane_path_type
    logical :: used = .false.                            !< the mechanism can be moved in lanes
    integer :: bits = 128                                !< of the vector registers
    logical :: goes_on(lanes) = .false.                  !< the lane is on its way
    real(wp) :: x(lanes) = 0.0_wp                        !< length of the way to the last position of the lane
    type(lane_group_type), private :: group
    integer, allocatable, private :: steps(:)            !< (D) of the coordinates that move
    real(wp), allocatable, private :: from(:, :)         !< (lanes,D) coordinates at x = 0 [rad, m]
    real(wp), allocatable, private :: way(:, :)          !< (lanes,D) their change per unit of x [rad, m]
    real(wp), private :: speed(lanes) = 0.0_wp           !< largest change of one per unit of x, in its unit
  contains
    procedure :: begin
    procedure :: place
    procedure :: lead
    procedure :: start
    procedure :: go_to
    procedure :: leave
    procedure :: change_speed
    procedure :: renew_rates
    procedure :: take
  end type lane_path_type

  !> Steps towards the next position at most.
  integer, parameter :: most_parts = 1000

contains

  !> Prepare for the positions of a mechanism; `used` is false where it can't be moved in lanes.
  subroutine begin(self, plan, driven)
    class(lane_path_type), intent(out) :: self   !< the lanes, empty
    type(plan_type), intent(in) :: plan          !< plan of the mechanism
    integer, intent(in) :: driven(:)             !< (D) numbers of all independent coordinates
    integer :: i

    self%used = fits_lanes(plan)
    if (.not. self%used) return
    call new_lane_group(plan, self%group)
    self%steps = [(plan%step_of(driven(i)), i=1, size(driven))]
    allocate (self%from(lanes, size(driven)), self%way(lanes, size(driven)), source=0.0_wp)
    self%bits = vector_bits()
  end subroutine begin

  !> Place a lane at a closed position.
  pure subroutine place(self, plan, q, largest_pivots, lane)
    class(lane_path_type), intent(inout) :: self   !< the lanes
    type(plan_type), intent(in) :: plan            !< plan of the mechanism, or of its requested part
    real(wp), intent(in) :: q(:)                   !< (M) the position [rad, m]
    real(wp), intent(in) :: largest_pivots(:)      !< (blocks) largest least pivot on the way to it [1]
    integer, intent(in) :: lane                    !< number of the lane

    self%goes_on(lane) = plan%n_coordinates == size(self%group%steps) .and. size(plan%blocks) == size(self%group%blocks)
    if (.not. self%goes_on(lane)) return
    call renew_lane(plan, q, lane, self%group, self%goes_on(lane))
    self%group%blocks(:)%largest_pivot(lane) = largest_pivots
  end subroutine place

  !> Lead a lane along a line on which it is placed.
  pure subroutine lead(self, lane, from, way, x)
    class(lane_path_type), intent(inout) :: self   !< the lanes
    integer, intent(in) :: lane                    !< number of the lane
    real(wp), intent(in) :: from(:)                !< (D) independent coordinates at x = 0 [rad, m]
    real(wp), intent(in) :: way(:)                 !< (D) their change per unit of x [rad, m]
    real(wp), intent(in) :: x                      !< length of the way to its position [rad, m]
    integer :: i

    self%from(lane, :) = from
    self%way(lane, :) = way
    self%x(lane) = x
    self%speed(lane) = 0.0_wp
    do i = 1, size(self%steps)
      self%speed(lane) = max(self%speed(lane), abs(way(i))/self%group%steps(self%steps(i))%unit(lane))
    end do
  end subroutine lead

  !> Start from the positions at which lanes were placed.
  pure subroutine start(self)
    class(lane_path_type), intent(inout) :: self   !< the lanes, at least one of which was placed

    call fill_idle(self)
    call drive(self, self%x)
    call begin_group(self%bits, self%group)
    call leave_refused(self)
  end subroutine start

  !> Go to the next positions: of all lanes that go on, each to its own one. Lanes that could not get there no longer go on.
  pure subroutine go_to(self, x)
    class(lane_path_type), intent(inout) :: self   !< the lanes, started
    real(wp), intent(in) :: x(:)                   !< (lanes) lengths of the ways to them [rad, m]
    real(wp) :: ways(lanes), from(lanes), to(lanes), h(lanes)
    logical :: refused(lanes)
    integer :: i, l, parts

    refused = .false.
    do l = 1, lanes
      ! a lane that does not go on moves as the one of which it is a copy
      ways(l) = merge(x(l), self%x(l), self%goes_on(l)) - self%x(l)
      refused(l) = self%goes_on(l) .and. .not. abs(ways(l))*self%speed(l) < most_parts*longest_way
    end do
    if (any(refused)) call self%leave(refused)
    parts = 1
    do l = 1, lanes
      if (self%goes_on(l)) parts = max(parts, ceiling(abs(ways(l))*self%speed(l)/longest_way))
    end do
    from = self%x
    do i = 1, parts
      l = findloc(self%goes_on, .true., dim=1)
      if (l == 0) return
      to = from + (real(i, wp)/real(parts, wp))*ways
      if (i == parts) to = x
      where (.not. self%goes_on) to = to(l)
      h = to - self%x
      where (abs(h)*self%speed < least_way) h = 0.0_wp
      call drive(self, to)
      call go_on_with_group(self%bits, h, self%group)
      where (abs(h) > 0.0_wp) self%x = to
      call leave_refused(self)
    end do
  end subroutine go_to

  !> Leave lanes: they no longer go on.
  pure subroutine leave(self, left)
    class(lane_path_type), intent(inout) :: self   !< the lanes
    logical, intent(in) :: left(:)                 !< (lanes) those that are left

    self%goes_on = self%goes_on .and. .not. left
    call fill_idle(self)
  end subroutine leave

  !> Leave the lanes whose step was refused.
  pure subroutine leave_refused(self)
    class(lane_path_type), intent(inout) :: self   !< the lanes

    if (any(self%group%refused > 0.0_wp)) call self%leave(self%group%refused > 0.0_wp)
  end subroutine leave_refused

  !> Let lanes that do not go on copy one that does, so that their numbers stay harmless.
  pure subroutine fill_idle(self)
    type(lane_path_type), intent(inout) :: self   !< the lanes
    integer :: first, l

    first = findloc(self%goes_on, .true., dim=1)
    if (first == 0) return
    do l = 1, lanes
      if (self%goes_on(l)) cycle
      call copy_lane(first, l, self%group)
      self%from(l, :) = self%from(first, :)
      self%way(l, :) = self%way(first, :)
      self%speed(l) = self%speed(first)
      self%x(l) = self%x(first)
    end do
  end subroutine fill_idle

  !> Set the independent coordinates, which move along their lines with constant rates.
  pure subroutine drive(self, x)
    class(lane_path_type), intent(inout) :: self   !< the lanes
    real(wp), intent(in) :: x(lanes)               !< (lanes) places on the lines [rad, m]
    integer :: i

    do i = 1, size(self%steps)
      associate (step => self%group%steps(self%steps(i)))
        step%q = self%from(:, i) + self%way(:, i)*x
        step%dq = self%way(:, i)
        step%ddq = 0.0_wp
      end associate
    end do
  end subroutine drive

  !> Give the motion along the lines other speeds at the present positions, by the chain rule.
  pure subroutine change_speed(self, speed, acceleration)
    class(lane_path_type), intent(inout) :: self   !< the lanes
    real(wp), intent(in) :: speed(lanes)           !< rate of x [1/s]
    real(wp), intent(in) :: acceleration(lanes)    !< its rate [1/s^2]
    integer :: s

    do s = 1, size(self%group%steps)
      associate (step => self%group%steps(s))
        step%ddq = step%ddq*speed**2 + step%dq*acceleration
        step%dq = step%dq*speed
      end associate
    end do
  end subroutine change_speed

  !> Find rates and accelerations at the present positions, for given ones of the independent coordinates.
  pure subroutine renew_rates(self, rates, accelerations)
    class(lane_path_type), intent(inout) :: self   !< the lanes
    real(wp), intent(in) :: rates(:, :)            !< (lanes,D) of the independent coordinates [rad/s, m/s]
    real(wp), intent(in) :: accelerations(:, :)    !< (lanes,D) of them [rad/s^2, m/s^2]
    integer :: i

    do i = 1, size(self%steps)
      self%group%steps(self%steps(i))%dq = rates(:, i)
      self%group%steps(self%steps(i))%ddq = accelerations(:, i)
    end do
    call renew_rates_of_group(self%bits, self%group)
  end subroutine renew_rates

  !> Take the coordinates of all lanes that go on, their rates or accelerations.
  pure subroutine take(self, order, units, places, numbers)
    class(lane_path_type), intent(in) :: self    !< the lanes
    integer, intent(in) :: order                 !< 0: coordinates; 1: rates; 2: accelerations
    real(wp), intent(in) :: units(:)             !< (M) their units in the results [rad, m, rad/s, m/s]
    integer, intent(in) :: places(:)             !< (lanes) numbers of the positions that lanes have reached
    real(wp), intent(inout) :: numbers(:, :)     !< (M,n) of all positions; those of these get them [rad, m, per s]
    real(wp) :: taken(lanes)
    integer :: k, l, s

    do s = 1, size(self%group%steps)
      associate (step => self%group%steps(s))
        k = step%coordinate
        select case (order)
        case (0)
          taken = step%q/units(k)
        case (1)
          taken = step%dq/units(k)
        case default
          taken = step%ddq/units(k)
        end select
      end associate
      do l = 1, lanes
        if (self%goes_on(l)) numbers(k, places(l)) = taken(l)
      end do
    end do
  end subroutine take
end module mech9_lane_path
