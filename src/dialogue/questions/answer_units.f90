!> Units in answers: 80 mm, 25 rad/s, 3000 rpm, 0.5 kg. They are converted into the units of the data file.
module mech9_answer_units
  use mech9_kinds, only: wp, pi, radians_per_degree
  use mech9_text, only: to_text, lower
  use mech9_units, only: units_type
  implicit none
  private
  public :: in_file_units, part_length

  integer, parameter :: part_length = 24        !< letters of a unit
  integer, parameter :: most_numbers = 64       !< longer lists have no units
  character(len=*), parameter :: of_numbers = '0123456789+-.'

  real(wp), parameter :: pound = 0.45359237_wp, gravity = 9.80665_wp

  !> Powers of length, force, mass, time and angle, and one unit in SI.
  type :: known_unit_type
    character(len=5) :: name
    integer :: powers(5)
    real(wp) :: size
  end type known_unit_type

  type(known_unit_type), parameter :: known(*) = [ &
    known_unit_type('m', [1, 0, 0, 0, 0], 1.0_wp), known_unit_type('mm', [1, 0, 0, 0, 0], 1.0e-3_wp), &
    known_unit_type('cm', [1, 0, 0, 0, 0], 1.0e-2_wp), known_unit_type('km', [1, 0, 0, 0, 0], 1.0e3_wp), &
    known_unit_type('in', [1, 0, 0, 0, 0], 0.0254_wp), known_unit_type('ft', [1, 0, 0, 0, 0], 0.3048_wp), &
    known_unit_type('N', [0, 1, 0, 0, 0], 1.0_wp), known_unit_type('kN', [0, 1, 0, 0, 0], 1.0e3_wp), &
    known_unit_type('lbf', [0, 1, 0, 0, 0], pound*gravity), known_unit_type('J', [1, 1, 0, 0, 0], 1.0_wp), &
    known_unit_type('Nm', [1, 1, 0, 0, 0], 1.0_wp), known_unit_type('Nmm', [1, 1, 0, 0, 0], 1.0e-3_wp), &
    known_unit_type('kNm', [1, 1, 0, 0, 0], 1.0e3_wp), known_unit_type('W', [1, 1, 0, -1, 0], 1.0_wp), &
    known_unit_type('kg', [0, 0, 1, 0, 0], 1.0_wp), known_unit_type('g', [0, 0, 1, 0, 0], 1.0e-3_wp), &
    known_unit_type('t', [0, 0, 1, 0, 0], 1.0e3_wp), known_unit_type('lb', [0, 0, 1, 0, 0], pound), &
    known_unit_type('s', [0, 0, 0, 1, 0], 1.0_wp), known_unit_type('ms', [0, 0, 0, 1, 0], 1.0e-3_wp), &
    known_unit_type('min', [0, 0, 0, 1, 0], 60.0_wp), known_unit_type('rad', [0, 0, 0, 0, 1], 1.0_wp), &
    known_unit_type('deg', [0, 0, 0, 0, 1], radians_per_degree), known_unit_type('rpm', [0, 0, 0, -1, 1], pi/30.0_wp), &
    known_unit_type('1', [0, 0, 0, 0, 0], 1.0_wp)]

contains

  !> An answer with its units converted into those of the file. An answer without units, or of another form, stays as it is. A unit
  !> behind the last number alone holds for all of its kind.
  pure subroutine in_file_units(line, wanted, units, text, problem)
    character(len=*), intent(in) :: line                    !< the answer, without blanks around it
    character(len=*), intent(in) :: wanted(:)               !< SI unit of each number in turn, the last one of all further ones; empty: none
    type(units_type), intent(in) :: units                   !< of the data file
    character(len=:), allocatable, intent(out) :: text      !< the answer in the units of the file
    character(len=:), allocatable, intent(out) :: problem   !< why a unit cannot stand there; empty: nothing is wrong
    character(len=part_length) :: given(most_numbers)
    character(len=part_length) :: numbers(most_numbers)
    integer :: n, i

    text = line
    problem = ''
    call split(line, numbers, given, n)
    if (n == 0) return
    if (all(given(:n) == '')) return
    if (all(given(:n - 1) == '')) then
      do i = 1, n - 1
        if (wanted(min(i, size(wanted))) == wanted(min(n, size(wanted)))) given(i) = given(n)
      end do
    end if
    text = ''
    do i = 1, n
      if (i > 1) text = text//', '
      call append_number(numbers(i), trim(given(i)), trim(wanted(min(i, size(wanted)))), units, text, problem)
      if (problem /= '') return
    end do
  end subroutine in_file_units

  !> Append one number in the unit of the file.
  pure subroutine append_number(number, given, wanted, units, text, problem)
    character(len=*), intent(in) :: number                  !< as it was typed
    character(len=*), intent(in) :: given                   !< its unit; empty: that of the file
    character(len=*), intent(in) :: wanted                  !< SI unit of its kind; empty: a plain number, or not known
    type(units_type), intent(in) :: units                   !< of the data file
    character(len=:), allocatable, intent(inout) :: text    !< the answer so far
    character(len=:), allocatable, intent(inout) :: problem !< stays empty where the unit is right
    integer :: powers(5), of_wanted(5), iostat
    real(wp) :: size_given, size_wanted, value
    logical :: is_known

    if (given == '' .or. given == trim(units%name_of(wanted))) then
      text = text//trim(number)
      return
    end if
    call read_unit(given, powers, size_given, is_known)
    if (.not. is_known) then
      problem = 'the unit '''//given//''' is not known; units of answers are such as mm, m, in, kg, N, kN, N m, rad/s, rpm, deg'
      return
    end if
    if (wanted == '') then
      problem = 'this number has no unit, or its unit depends on other answers; give it without '//given
      return
    end if
    call read_unit(wanted, of_wanted, size_wanted, is_known)
    if (.not. is_known .or. any(powers /= of_wanted)) then
      problem = given//' does not fit here; the unit is '//trim(units%name_of(wanted))
      return
    end if
    read (number, *, iostat=iostat) value
    if (iostat /= 0) then
      problem = ''''//trim(number)//''' is not a number'
      return
    end if
    text = text//to_text(value*(size_given/units%size_of(wanted)), 15)
  end subroutine append_number

  !> Split an answer into numbers and their units. There are none where it has another form.
  pure subroutine split(line, numbers, given, n)
    character(len=*), intent(in) :: line           !< the answer
    character(len=*), intent(out) :: numbers(:)    !< as they were typed
    character(len=*), intent(out) :: given(:)      !< the unit behind each; empty: none
    integer, intent(out) :: n                      !< how many numbers there are; 0: another form
    integer :: at, last

    n = 0
    at = 1
    numbers = ''
    given = ''
    do while (at <= len_trim(line))
      if (line(at:at) == ' ' .or. line(at:at) == ',' .or. line(at:at) == achar(9)) then
        at = at + 1
        cycle
      end if
      last = end_of_number(line, at)
      if (last < at .or. n == size(numbers) .or. last - at >= len(numbers)) then
        n = 0
        return
      end if
      n = n + 1
      numbers(n) = line(at:last)
      at = last + 1
      call take_unit(line, at, given(n), last)
      if (last < at - 1) then
        n = 0
        return
      end if
      at = last + 1
    end do
  end subroutine split

  !> The last letter of a number that begins at a place; before the place where none does.
  pure integer function end_of_number(line, at) result(last)
    character(len=*), intent(in) :: line   !< the answer
    integer, intent(in) :: at              !< place of the first letter
    integer :: next

    last = at - 1
    if (scan(line(at:at), of_numbers) == 0) return
    last = at
    do while (last < len(line))
      next = last + 1
      if (scan(line(next:next), '0123456789.') > 0) then
        last = next
      else if (scan(line(next:next), 'eEdD') > 0 .and. next < len(line)) then
        ! an exponent has a digit or a sign behind its letter
        if (scan(line(next + 1:next + 1), '0123456789+-') == 0) exit
        last = next + 1
      else
        exit
      end if
    end do
    ! a sign or a point alone is no number: -y
    if (scan(line(at:last), '0123456789') == 0) last = at - 1
  end function end_of_number

  !> Take the unit at a place, up to the next comma or number.
  pure subroutine take_unit(line, at, unit, last)
    character(len=*), intent(in) :: line     !< the answer
    integer, intent(in) :: at                !< place behind a number
    character(len=*), intent(out) :: unit    !< the unit; empty: none
    integer, intent(out) :: last             !< its last letter; less than at - 1 where something else stands there
    integer :: i, first

    unit = ''
    last = at - 1
    if (at > len(line)) return
    first = at - 1 + verify(line(at:), ' '//achar(9))
    if (first < at) return
    if (line(first:first) == ',' .or. scan(line(first:first), of_numbers) > 0) return
    do i = first, len(line)
      if (line(i:i) == ',') exit
      if (i > first) then
        if (line(i - 1:i - 1) == ' ' .and. scan(line(i:i), of_numbers) > 0) exit
      end if
      if (verify(line(i:i), 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ/^ 0123456789*') > 0) last = -1
      if (last == -1) return
      last = i
    end do
    ! formulas of numbers are not units
    if (scan(line(first:first), '*/^') > 0 .or. last - first >= len(unit)) then
      last = at - 2
      return
    end if
    unit = line(first:last)
    if (any(lower(trim(unit)) == [character(len=8) :: 'nan', 'inf', 'infinity'])) last = at - 2
  end subroutine take_unit

  !> Find powers and size of a unit such as N mm/rad.
  pure subroutine read_unit(unit, powers, size_of_unit, is_known)
    character(len=*), intent(in) :: unit             !< the unit
    integer, intent(out) :: powers(5)                !< of length, force, mass, time and angle
    real(wp), intent(out) :: size_of_unit            !< one of it in SI
    logical, intent(out) :: is_known                 !< all its parts are known
    integer :: first, last, mark, power, i

    powers = 0
    size_of_unit = 1.0_wp
    is_known = .true.
    first = 1
    do while (first <= len_trim(unit))
      if (scan(unit(first:first), ' /*') > 0) then
        first = first + 1
        cycle
      end if
      last = first - 2 + scan(unit(first:)//' ', ' /*')
      mark = first - 1 + index(unit(first:last)//'^', '^')
      power = 1
      if (mark < last) power = index('123456789', unit(mark + 1:last))
      if (first > 1) then
        if (index(unit(:first - 1), '/', back=.true.) == len_trim(unit(:first - 1))) power = -power
      end if
      i = findloc(known%name == unit(first:mark - 1), .true., dim=1)
      is_known = is_known .and. i > 0 .and. power /= 0
      if (.not. is_known) return
      powers = powers + power*known(i)%powers
      size_of_unit = size_of_unit*known(i)%size**power
      first = last + 1
    end do
  end subroutine read_unit
end module mech9_answer_units
