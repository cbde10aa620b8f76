!> Times of targets that are free but in order, as unknowns between bounds.
!>
!> The unknowns are the gaps between neighbouring targets of an objective, each as a part of the run and not negative. One gap of each
!> objective, the largest at the beginning, follows from the others: times before it are sums of gaps from the start of the run, times
!> after it from the end. Targets that meet in time are then a bound like any other, and a minimum within the order is found
!> there.
module mech9_free_times
  use mech9_kinds, only: wp
  use mech9_objective, only: timing_free
  use mech9_targets, only: target_type
  implicit none
  private
  public :: free_times_type, new_free_times, choose_pivots, has_good_pivots, gaps_of, parts_of, part_by_gap, &
    are_in_order

  type :: free_times_type
    integer :: n = 0                       !< number of targets with free times
    integer, allocatable :: target(:)      !< (n) their numbers
    integer, allocatable :: first(:)       !< (n) first of the free targets of the same objective
    integer, allocatable :: last(:)        !< (n) last of them
    logical, allocatable :: from_end(:)    !< (n) the time is counted from the end of the run
  end type free_times_type

  !> A gap that follows from the others is large enough while it is no smaller than this part of the largest one.
  real(wp), parameter :: large_enough = 0.2_wp

contains

  !> The free times of some targets, all counted from the start.
  pure subroutine new_free_times(targets, free)
    type(target_type), intent(in) :: targets(:)     !< all targets; those of an objective stand together
    type(free_times_type), intent(out) :: free      !< their free times
    integer :: i

    free%target = pack([(i, i=1, size(targets))], targets%timing == timing_free)
    free%n = size(free%target)
    allocate (free%first(free%n), free%last(free%n))
    allocate (free%from_end(free%n), source=.false.)
    do i = 1, free%n
      associate (same => targets(free%target)%objective == targets(free%target(i))%objective)
        free%first(i) = findloc(same, .true., dim=1)
        free%last(i) = findloc(same, .true., dim=1, back=.true.)
      end associate
    end do
  end subroutine new_free_times

  !> Let the largest gap of each objective follow from the others.
  pure subroutine choose_pivots(parts, free)
    real(wp), intent(in) :: parts(:)               !< (n) times as parts of the run, in order
    type(free_times_type), intent(inout) :: free   !< the free times
    integer :: i, first, last
    real(wp) :: largest

    i = 1
    do while (i <= free%n)
      first = i
      last = free%last(i)
      largest = maxval([parts(first:last), 1.0_wp] - [0.0_wp, parts(first:last)])
      do i = first, last
        if (.not. parts(i) - before(parts, free, i) < largest) exit
      end do
      free%from_end(first:i - 1) = .false.
      free%from_end(i:last) = .true.
      i = last + 1
    end do
  end subroutine choose_pivots

  !> Whether the gap of each objective that follows from the others is among the large ones.
  pure logical function has_good_pivots(parts, free)
    real(wp), intent(in) :: parts(:)               !< (n) times as parts of the run, in order
    type(free_times_type), intent(in) :: free      !< the free times
    integer :: first, last, i
    real(wp) :: largest, pivot

    has_good_pivots = .true.
    first = 1
    do while (first <= free%n)
      last = free%last(first)
      largest = maxval([parts(first:last), 1.0_wp] - [0.0_wp, parts(first:last)])
      pivot = 1.0_wp - parts(last)
      do i = first, last
        if (.not. free%from_end(i)) cycle
        pivot = parts(i) - before(parts, free, i)
        exit
      end do
      has_good_pivots = has_good_pivots .and. pivot >= large_enough*largest
      first = last + 1
    end do
  end function has_good_pivots

  !> The time before a free one: that of the target before it, or the start of the run.
  pure real(wp) function before(parts, free, i)
    real(wp), intent(in) :: parts(:)            !< (n) times as parts of the run, in order
    type(free_times_type), intent(in) :: free   !< the free times
    integer, intent(in) :: i                    !< number of the free time

    before = 0.0_wp
    if (i > free%first(i)) before = parts(i - 1)
  end function before

  !> The gaps of times.
  pure function gaps_of(parts, free) result(gaps)
    real(wp), intent(in) :: parts(:)            !< (n) times as parts of the run, in order
    type(free_times_type), intent(in) :: free   !< the free times
    real(wp) :: gaps(size(parts))
    integer :: i

    do i = 1, size(parts)
      if (.not. free%from_end(i)) then
        gaps(i) = parts(i) - before(parts, free, i)
      else if (i < free%last(i)) then
        gaps(i) = parts(i + 1) - parts(i)
      else
        gaps(i) = 1.0_wp - parts(i)
      end if
    end do
  end function gaps_of

  !> The times of gaps.
  pure function parts_of(gaps, free) result(parts)
    real(wp), intent(in) :: gaps(:)             !< (n) the gaps
    type(free_times_type), intent(in) :: free   !< the free times
    real(wp) :: parts(size(gaps))
    integer :: i

    do i = 1, size(gaps)
      if (free%from_end(i)) cycle
      parts(i) = before(parts, free, i) + gaps(i)
    end do
    do i = size(gaps), 1, -1
      if (.not. free%from_end(i)) cycle
      parts(i) = 1.0_wp - gaps(i)
      if (i < free%last(i)) parts(i) = parts(i + 1) - gaps(i)
    end do
  end function parts_of

  !> Whether times are in order within the run. Some may be the same.
  pure logical function are_in_order(parts, free)
    real(wp), intent(in) :: parts(:)            !< (n) times as parts of the run
    type(free_times_type), intent(in) :: free   !< the free times
    integer :: i

    are_in_order = all(parts >= 0.0_wp .and. parts <= 1.0_wp)
    do i = 1, size(parts)
      are_in_order = are_in_order .and. parts(i) >= before(parts, free, i)
    end do
  end function are_in_order

  !> The derivative of a time by a gap: 1, 0 or -1.
  pure real(wp) function part_by_gap(free, i, j)
    type(free_times_type), intent(in) :: free   !< the free times
    integer, intent(in) :: i                    !< number of the time
    integer, intent(in) :: j                    !< number of the gap

    part_by_gap = 0.0_wp
    if (free%first(i) /= free%first(j) .or. (free%from_end(i) .neqv. free%from_end(j))) return
    if (.not. free%from_end(i) .and. j <= i) part_by_gap = 1.0_wp
    if (free%from_end(i) .and. j >= i) part_by_gap = -1.0_wp
  end function part_by_gap
end module mech9_free_times
