!> The axes of plots: their ranges, and marks whose numbers do not overlap. Angles of a quarter turn or more are marked at parts and
!> multiples of a turn.
module mech9_plot_axes
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  implicit none
  private
  public :: axis_step, axis_commands

  character, parameter :: line_end = achar(10)
  !> Room of a letter, between numbers, and of a line [px]; letters of the longest number; most spaces between marks.
  integer, parameter :: letter = 9, gap = 14, line = 26, most_letters = 12, finest = 10
  !> Steps of marks: of usual numbers, times a power of ten; of angles in degrees, and in parts of pi, the turns times a power of ten.
  real(wp), parameter :: usual(*) = [1.0_wp, 2.0_wp, 5.0_wp], degrees(*) = [15.0_wp, 30.0_wp, 45.0_wp, 90.0_wp, 180.0_wp], &
                         of_pi(*) = [0.25_wp, 0.5_wp, 1.0_wp]
  !> Angles that span less than this are marked as usual numbers: a quarter turn in degrees, a half turn in radians.
  real(wp), parameter :: least_degrees = 90.0_wp, least_radians = pi
  !> A bound that differs from a mark by less than this part of the step is on it.
  real(wp), parameter :: near = 1.0e-6_wp
  !> Values beyond this leave the axis to gnuplot.
  real(wp), parameter :: largest = 1.0e100_wp
  !> The letter pi in UTF-8.
  character(len=*), parameter :: pi_letter = char(207)//char(128)

contains

  !> The distance of the numbers below a horizontal axis, for a script. It is empty where all values are equal.
  pure function axis_step(ends, width, unit) result(text)
    real(wp), intent(in) :: ends(2)                  !< least and greatest value on the axis
    integer, intent(in) :: width                     !< length of the axis [px]
    character(len=*), intent(in), optional :: unit   !< of the values
    character(len=:), allocatable :: text
    real(wp) :: step

    step = 0.0_wp
    if (present(unit)) then
      if (unit == 'deg') step = step_of(ends, unit, width, .false.)
    end if
    if (.not. step > 0.0_wp) step = step_of(ends, '', width, .false.)
    text = ''
    if (step > 0.0_wp) text = to_text(step, 3)
  end function axis_step

  !> The commands for the range and the marks of an axis. Unless the range is kept, it ends at marks.
  pure function axis_commands(name, ends, unit, length, keep) result(text)
    character, intent(in) :: name          !< x or y
    real(wp), intent(in) :: ends(2)        !< least and greatest value on the axis
    character(len=*), intent(in) :: unit   !< of the values
    integer, intent(in) :: length          !< of the axis [px]
    logical, intent(in) :: keep            !< the axis goes from the least to the greatest value
    character(len=:), allocatable :: text
    real(wp) :: step, low, high

    step = step_of(ends, unit, length, name == 'y')
    if (.not. step > 0.0_wp) then
      text = 'set autoscale '//name//line_end//'set '//name//'tics autofreq'//line_end
      return
    end if
    low = ends(1)
    high = ends(2)
    if (.not. keep) then
      low = min(low, step*floor_of(low/step + near))
      high = max(high, -step*floor_of(-high/step + near))
    end if
    text = 'set '//name//'range ['//bound(low, ends(1), -1)//':'//bound(high, ends(2), 1)//']'//line_end//'set '//name//'tics '
    if (in_parts_of_pi(ends, unit)) then
      text = text//marks_of_pi(low, high, step)//line_end
    else
      text = text//to_text(step, 3)//line_end
    end if
  end function axis_commands

  !> The largest whole number not above another one, without the limits of integers.
  pure real(wp) function floor_of(x)
    real(wp), intent(in) :: x   !< the number

    floor_of = aint(x)
    if (floor_of > x) floor_of = floor_of - 1.0_wp
  end function floor_of

  !> A bound of a range, with few digits if no value is outside then, else with all digits.
  pure function bound(value, extreme, sense) result(text)
    real(wp), intent(in) :: value     !< the bound
    real(wp), intent(in) :: extreme   !< the value nearest to it
    integer, intent(in) :: sense      !< -1: it is the lower bound, 1: the upper one
    character(len=:), allocatable :: text
    integer, parameter :: few = 9, all_digits = 17
    real(wp) :: short
    integer :: status

    text = to_text(value, few)
    read (text, *, iostat=status) short
    if (status /= 0 .or. sense*(short - extreme) < 0.0_wp) text = to_text(value, all_digits)
  end function bound

  !> Whether the marks of an axis are parts or multiples of pi.
  pure logical function in_parts_of_pi(ends, unit)
    real(wp), intent(in) :: ends(2)        !< least and greatest value on the axis
    character(len=*), intent(in) :: unit   !< of the values

    in_parts_of_pi = unit == 'rad' .and. ends(2) - ends(1) >= least_radians*(1.0_wp - near)
  end function in_parts_of_pi

  !> The distance of the marks of an axis, which is the least whose numbers stand apart. It is 0 where all values are equal, or huge.
  pure real(wp) function step_of(ends, unit, length, upwards)
    real(wp), intent(in) :: ends(2)        !< least and greatest value on the axis
    character(len=*), intent(in) :: unit   !< of the values
    integer, intent(in) :: length          !< of the axis [px]
    logical, intent(in) :: upwards         !< the axis goes upwards, so that numbers need less room
    real(wp), allocatable :: steps(:)
    real(wp) :: span, room
    integer :: i

    step_of = 0.0_wp
    span = ends(2) - ends(1)
    if (maxval(abs(ends)) > largest .or. .not. span > epsilon(span)*maxval(abs(ends))) return
    steps = steps_for(ends, unit)
    do i = 1, size(steps)
      step_of = steps(i)
      room = line
      if (.not. upwards) room = letters_of(ends, unit, steps(i))*letter + gap
      if (span <= finest*steps(i) .and. (span/steps(i) + 1.0_wp)*room <= length) return
    end do
  end function step_of

  !> The steps among which that of an axis is chosen, ascending.
  pure function steps_for(ends, unit) result(steps)
    real(wp), intent(in) :: ends(2)        !< least and greatest value on the axis
    character(len=*), intent(in) :: unit   !< of the values
    real(wp), allocatable :: steps(:)
    real(wp) :: span
    integer :: first, power, i

    span = ends(2) - ends(1)
    allocate (steps(0))
    first = floor(log10(span)) - 1
    if (unit == 'deg' .and. span >= least_degrees*(1.0_wp - near)) then
      steps = degrees
      do power = 0, first
        steps = [steps, 360.0_wp*usual*10.0_wp**power]
      end do
    else if (in_parts_of_pi(ends, unit)) then
      steps = pi*of_pi
      do power = 0, first + 2
        steps = [steps, pi*[2.0_wp, 4.0_wp, 10.0_wp]*10.0_wp**power]
      end do
    else
      steps = [((usual(i)*10.0_wp**power, i=1, size(usual)), power=first, first + 2)]
    end if
  end function steps_for

  !> The number of letters of the longest number of an axis.
  pure integer function letters_of(ends, unit, step) result(letters)
    real(wp), intent(in) :: ends(2)        !< least and greatest value on the axis
    character(len=*), intent(in) :: unit   !< of the values
    real(wp), intent(in) :: step           !< distance of the marks
    integer :: power

    if (in_parts_of_pi(ends, unit)) then
      letters = 4
      if (step >= pi) letters = 2 + max(0, floor(log10(maxval(abs(ends))/pi)))
    else
      letters = max(1, floor(log10(maxval(abs(ends)))) + 1)
      power = floor(log10(step) + near)
      if (power < 0) letters = letters + 1 - power
    end if
    if (any(ends < 0.0_wp)) letters = letters + 1
    letters = min(letters, most_letters)
  end function letters_of

  !> The marks of an axis as texts like 3pi/2, each with its place.
  pure function marks_of_pi(low, high, step) result(text)
    real(wp), intent(in) :: low    !< least value on the axis [rad]
    real(wp), intent(in) :: high   !< greatest value on the axis [rad]
    real(wp), intent(in) :: step   !< distance of the marks, quarters or multiples of pi [rad]
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = ceiling(low/step - near), floor(high/step + near)
      text = text//', '''//name_of_mark(nint(4.0_wp*step/pi)*i)//''' '//to_text(i*step, 9)
    end do
    text = '('//text(min(3, len(text) + 1):)//')'
  end function marks_of_pi

  !> The name of a mark, such as -3pi/4.
  pure function name_of_mark(quarters) result(name)
    integer, intent(in) :: quarters   !< of pi
    character(len=:), allocatable :: name
    integer :: over, under

    over = quarters
    under = 4
    do while (under > 1 .and. mod(over, 2) == 0)
      over = over/2
      under = under/2
    end do
    name = to_text(abs(over))
    if (abs(over) == 1) name = ''
    name = name//pi_letter
    if (under > 1) name = name//'/'//to_text(under)
    if (over < 0) name = '-'//name
    if (over == 0) name = '0'
  end function name_of_mark
end module mech9_plot_axes
