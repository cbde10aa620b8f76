!> The times within a stride of a motion at which a value passes levels, by a polynomial through its ends and false position on the
!> motion itself.
module mech9_section_search
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_false_position, only: false_position_type, new_false_position
  use mech9_hermite, only: hermite_type, build_hermite, cubic_between
  implicit none
  private
  public :: watched_type, known_value_type, passing_type, levels_type, find_passings

  !> Points within a stride at which a value with known derivatives, and one without, is looked at; the last one is the end.
  integer, parameter :: looks = 24, looks_without = 6
  !> Trials of the search for a time.
  integer, parameter :: most_trials = 100
  !> A polynomial by rates alone is wrong by this part of its range at most: it is of fourth order in the length of the stride.
  real(wp), parameter :: error_by_rates = 0.05_wp

  !> A value with its derivatives in time, as far as these are known.
  type :: known_value_type
    real(wp) :: t = 0.0_wp                !< time [s]
    real(wp) :: numbers(0:2) = 0.0_wp     !< the value, its rate and its second derivative
    integer :: derivatives = 0            !< how many derivatives are known
  end type known_value_type

  !> Levels that are passed: one at zero, or many at equal distances. Cell i lies between levels i and i + 1.
  type :: levels_type
    real(wp) :: distance = 0.0_wp         !< between two levels; 0: there is one
    real(wp) :: round_off = 0.0_wp        !< values that are so near to a level belong to the cell in which the motion was
  contains
    procedure :: cell
    procedure :: level
    procedure :: is_near
    procedure, private :: nearest_level
  end type levels_type

  !> A value that is watched, with its levels: who finds it at a time within the present stride.
  type, abstract :: watched_type
    type(levels_type) :: levels           !< those that it passes
  contains
    procedure(value_interface), deferred :: value_at
  end type watched_type

  !> The passing of a level.
  type :: passing_type
    real(wp) :: t = 0.0_wp      !< time [s]
    integer :: before = 0       !< cell before
    integer :: behind = 0       !< cell behind
  end type passing_type

  abstract interface
    !> The value at a time within the stride.
    subroutine value_interface(self, t, value, err)
      import :: watched_type, wp, error_type
      class(watched_type), intent(inout) :: self          !< who finds it
      real(wp), intent(in) :: t                           !< the time [s]
      real(wp), intent(out) :: value                      !< the value
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine value_interface
  end interface

contains

  !> The cell of a value. A value at a level within round-off is in the cell where the motion was.
  pure integer function cell(self, value, before)
    class(levels_type), intent(in) :: self     !< the levels
    real(wp), intent(in) :: value              !< the value
    integer, intent(in), optional :: before    !< cell in which the motion was; absent: it does not matter

    if (self%distance > 0.0_wp) then
      cell = floor(value/self%distance)
    else
      cell = merge(0, -1, value > 0.0_wp)
    end if
    if (.not. present(before)) return
    if (self%is_near(value) .and. abs(cell - before) <= 1) cell = before
  end function cell

  !> Whether a value is at a level within round-off.
  pure logical function is_near(self, value)
    class(levels_type), intent(in) :: self     !< the levels
    real(wp), intent(in) :: value              !< the value

    is_near = abs(value - self%nearest_level(value)) <= self%round_off
  end function is_near

  !> The level nearest to a value.
  pure real(wp) function nearest_level(self, value) result(level)
    class(levels_type), intent(in) :: self     !< the levels
    real(wp), intent(in) :: value              !< the value

    level = 0.0_wp
    if (self%distance > 0.0_wp) level = self%distance*anint(value/self%distance)
  end function nearest_level

  !> The level between two neighbouring cells.
  pure real(wp) function level(self, one, other)
    class(levels_type), intent(in) :: self   !< the levels
    integer, intent(in) :: one               !< a cell
    integer, intent(in) :: other             !< its neighbour

    level = self%distance*max(one, other)
  end function level

  !> Find all passings of levels within a stride, in the order of time. One that is not met on the motion itself is left out.
  subroutine find_passings(watched, first, last, from_cell, passings, to_cell, err)
    class(watched_type), intent(inout) :: watched                   !< finds values within the stride
    type(known_value_type), intent(in) :: first                     !< the value at the start of the stride
    type(known_value_type), intent(in) :: last                      !< the value at its end
    integer, intent(in) :: from_cell                                !< cell at the start
    type(passing_type), allocatable, intent(out) :: passings(:)     !< the passings
    integer, intent(out) :: to_cell                                 !< cell at the end
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed
    type(known_value_type), allocatable :: seen(:)
    type(passing_type) :: passing
    integer :: i, next
    logical :: passed

    allocate (passings(0))
    to_cell = from_cell
    call look_within(watched, first, last, seen, err)
    if (allocated(err)) return
    do i = 1, size(seen) - 1
      next = watched%levels%cell(seen(i + 1)%numbers(0), to_cell)
      do while (to_cell /= next)
        passing%before = to_cell
        passing%behind = to_cell + sign(1, next - to_cell)
        call find_time(watched, seen, i, passing, passed, err)
        if (allocated(err)) return
        if (passed) passings = [passings, passing]
        to_cell = passing%behind
      end do
    end do
    call remove_unmet_pairs(passings, from_cell)
  end subroutine find_passings

  !> Remove passings that lead from where the motion was not: their counterparts were not met.
  pure subroutine remove_unmet_pairs(passings, from_cell)
    type(passing_type), allocatable, intent(inout) :: passings(:)   !< the passings
    integer, intent(in) :: from_cell                                !< cell at the start
    logical :: follows(size(passings))
    integer :: i, present_cell

    present_cell = from_cell
    do i = 1, size(passings)
      follows(i) = passings(i)%before == present_cell
      if (follows(i)) present_cell = passings(i)%behind
    end do
    passings = pack(passings, follows)
  end subroutine remove_unmet_pairs

  !> Look at the value at times within a stride: by a polynomial where derivatives are known, and else on the motion. Where it turns near a
  !> level, the motion is asked.
  subroutine look_within(watched, first, last, seen, err)
    class(watched_type), intent(inout) :: watched                     !< finds values within the stride
    type(known_value_type), intent(in) :: first                       !< the value at the start
    type(known_value_type), intent(in) :: last                        !< the value at the end
    type(known_value_type), allocatable, intent(out) :: seen(:)       !< values at times, both ends included
    type(error_type), allocatable, intent(out) :: err                 !< allocated if it failed
    real(wp) :: h, margin, slopes(2)
    integer :: i, n

    h = last%t - first%t
    n = merge(looks, looks_without, first%derivatives > 0)
    allocate (seen(n + 1))
    seen(1) = first
    seen(n + 1) = last
    margin = 0.0_wp
    do i = 2, n
      seen(i)%t = first%t + h*real(i - 1, wp)/n
      if (first%derivatives == 0) then
        call watched%value_at(seen(i)%t, seen(i)%numbers(0), err)
        if (allocated(err)) return
      end if
    end do
    if (first%derivatives > 0) call take_polynomial(first, last, seen, margin)
    do i = 2, n
      associate (a => seen(i - 1)%numbers(0), b => seen(i)%numbers(0), c => seen(i + 1)%numbers(0))
        if ((b - a)*(c - b) >= 0.0_wp) cycle
        ! the parabola through three looks turns there
        call look_at_turn(watched, h/n, [b, 0.5_wp*(c - a), 0.5_wp*(a - 2.0_wp*b + c)], margin, seen(i), err)
      end associate
      if (allocated(err)) return
    end do
    slopes = 0.5_wp*[4.0_wp*seen(2)%numbers(0) - 3.0_wp*seen(1)%numbers(0) - seen(3)%numbers(0), &
                     3.0_wp*seen(n + 1)%numbers(0) - 4.0_wp*seen(n)%numbers(0) + seen(n - 1)%numbers(0)]
    if (first%derivatives > 0) slopes = h/n*[first%numbers(1), last%numbers(1)]
    call look_near_end(watched, -h/n, -slopes(2), margin, seen, n + 1, err)
    if (.not. allocated(err)) call look_near_end(watched, h/n, slopes(1), margin, seen, 1, err)
  end subroutine look_within

  !> Look at the value where a parabola turns near a level, in place of a look.
  subroutine look_at_turn(watched, h, parabola, margin, look, err)
    class(watched_type), intent(inout) :: watched         !< finds values within the stride
    real(wp), intent(in) :: h                             !< unit of time of the parabola [s]
    real(wp), intent(in) :: parabola(0:2)                 !< its value at the look, its slope there and half its second derivative
    real(wp), intent(in) :: margin                        !< error of values at looks
    type(known_value_type), intent(inout) :: look         !< the look; its time and value are those of the turn where it is near a level
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp) :: height, nearest

    height = parabola(0) - 0.25_wp*parabola(1)**2/parabola(2)
    nearest = watched%levels%nearest_level(height)
    if (abs(height - nearest) > margin + 2.0_wp*abs(height - parabola(0)) + watched%levels%round_off .and. &
        (height - nearest)*(parabola(0) - nearest) > 0.0_wp) return
    look%t = look%t - 0.5_wp*parabola(1)/parabola(2)*h
    call watched%value_at(look%t, look%numbers(0), err)
  end subroutine look_at_turn

  !> Look at the value where it turns between an end of the stride and the look next to it, if it does so near a level.
  subroutine look_near_end(watched, h, slope, margin, seen, place, err)
    class(watched_type), intent(inout) :: watched                       !< finds values within the stride
    real(wp), intent(in) :: h                                           !< time from the end to the look beside it [s]
    real(wp), intent(in) :: slope                                       !< of the value at the end, towards the look, in this time
    real(wp), intent(in) :: margin                                      !< error of values at looks
    type(known_value_type), allocatable, intent(inout) :: seen(:)       !< gets one look more
    integer, intent(in) :: place                                        !< of the end there: the first or the last one
    type(error_type), allocatable, intent(out) :: err                   !< allocated if it failed
    type(known_value_type) :: look
    real(wp) :: curvature, at, end_time
    integer :: beside

    beside = place + merge(1, -1, place == 1)
    at = seen(place)%numbers(0)
    end_time = seen(place)%t
    curvature = seen(beside)%numbers(0) - at - slope
    ! the parabola turns between both
    if (slope*(slope + 2.0_wp*curvature) >= 0.0_wp) return
    look%t = end_time
    call look_at_turn(watched, h, [at, slope, curvature], margin, look, err)
    if (allocated(err) .or. .not. abs(look%t - end_time) > 0.0_wp) return
    beside = max(place, beside)
    seen = [seen(:beside - 1), look, seen(beside:)]
  end subroutine look_near_end

  !> Take values from the polynomial through both ends of a stride.
  subroutine take_polynomial(first, last, seen, margin)
    type(known_value_type), intent(in) :: first           !< the value at the start
    type(known_value_type), intent(in) :: last            !< the value at the end
    type(known_value_type), intent(inout) :: seen(:)      !< gets values between them
    real(wp), intent(out) :: margin                       !< bound of their error
    type(hermite_type) :: polynomial
    real(wp) :: h, x, by_rates, value(1), rate(1), second(1)
    integer :: i

    h = last%t - first%t
    margin = 0.0_wp
    if (first%derivatives > 1) &
      call build_hermite([0.0_wp, 1.0_wp], reshape([first%numbers(0), last%numbers(0)], [1, 2]), &
                         reshape(h*[first%numbers(1), last%numbers(1)], [1, 2]), &
                         reshape(h**2*[first%numbers(2), last%numbers(2)], [1, 2]), polynomial)
    do i = 2, size(seen) - 1
      x = real(i - 1, wp)/(size(seen) - 1)
      by_rates = cubic_between(first%numbers(0), h*first%numbers(1), last%numbers(0), h*last%numbers(1), x)
      seen(i)%numbers(0) = by_rates
      if (first%derivatives == 1) cycle
      call polynomial%evaluate(x, value, rate, second)
      seen(i)%numbers(0) = value(1)
      margin = max(margin, abs(value(1) - by_rates))
    end do
    if (first%derivatives == 1) margin = error_by_rates*(maxval(seen%numbers(0)) - minval(seen%numbers(0)))
  end subroutine take_polynomial

  !> Find the time at which a level is passed between two looks, or near them where the polynomial was wrong.
  subroutine find_time(watched, seen, i, passing, passed, err)
    class(watched_type), intent(inout) :: watched           !< finds values within the stride
    type(known_value_type), intent(in) :: seen(:)           !< values at times
    integer, intent(in) :: i                                !< the passing is seen behind this one
    type(passing_type), intent(inout) :: passing            !< with its cells; gets the time
    logical, intent(out) :: passed                          !< the motion itself passes there
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(false_position_type) :: search
    real(wp) :: before, behind, value, level
    integer :: low, high, trial, step
    logical :: found

    passed = .false.
    level = watched%levels%level(passing%before, passing%behind)
    step = passing%behind - passing%before
    passing%t = seen(i)%t
    low = i
    do
      call value_seen(low, before)
      if (allocated(err)) return
      if (before <= 0.0_wp .or. low == 1) exit
      low = low - 1
    end do
    high = i + 1
    do
      call value_seen(high, behind)
      if (allocated(err)) return
      if (behind >= 0.0_wp .or. high == size(seen)) exit
      high = high + 1
    end do
    if (behind < 0.0_wp) return
    passed = .true.
    passing%t = seen(low)%t
    if (before >= 0.0_wp) return
    passing%t = seen(high)%t
    if (.not. behind > 0.0_wp) return
    search = new_false_position(seen(low)%t, before, seen(high)%t, behind)
    do trial = 1, most_trials
      call search%next(passing%t, found)
      if (.not. found) return
      call watched%value_at(passing%t, value, err)
      if (allocated(err)) return
      value = step*(value - level)
      if (.not. abs(value) > 0.0_wp) return
      call search%take(passing%t, value)
    end do
  contains
    !> The distance from the level at a look, on the motion itself.
    subroutine value_seen(look, distance)
      integer, intent(in) :: look         !< its number
      real(wp), intent(out) :: distance   !< below zero before the passing

      distance = seen(look)%numbers(0)
      if (look > 1 .and. look < size(seen)) call watched%value_at(seen(look)%t, distance, err)
      distance = step*(distance - level)
    end subroutine value_seen
  end subroutine find_time
end module mech9_section_search
