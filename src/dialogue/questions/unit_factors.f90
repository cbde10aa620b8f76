!> The factors that turn the numbers of a draft into those of other units of the data file.
!>
!> The table of names and the kind of a pair tell the unit of a number. A parameter has that of the numbers that it sets, if these
!> change by one factor; laws over a coordinate, a rate or a point have that of their variable.
module mech9_unit_factors
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, lower
  use mech9_units, only: units_type
  use mech9_grammar, only: item_table, item_row_type
  use mech9_item_rows, only: item_row_for_kind
  use mech9_draft, only: draft_type, plain_name, integer_of, unquoted
  use mech9_draft_joints, only: kind_in, number_in, kind_of_coordinate
  implicit none
  private
  public :: find_factors, is_same

  integer, parameter :: unit_length = 24     !< letters of a unit
  integer, parameter :: most_powers = 9      !< coefficients of a polynomial whose units are listed

  !> Numbers of groups that have the unit of the numbers of a parameter.
  character(len=6), parameter :: of_parameters(4) = [character(len=6) :: 'value', 'low', 'high', 'spread']
  !> Numbers of laws that have the unit of their variable, or depend on it.
  character(len=17), parameter :: of_variable(4) = [character(len=17) :: 'times', 'period', 'coefficients', 'angular_frequency']

contains

  !> Whether a factor changes nothing beyond round-off.
  elemental logical function is_same(factor)
    real(wp), intent(in) :: factor   !< factor of the number, of other over present units [1]

    is_same = abs(factor - 1.0_wp) <= 4.0_wp*epsilon(1.0_wp)
  end function is_same

  !> Find the factors of the numbers of an answer: one for each place of a list, the last one for all further places.
  pure recursive subroutine find_factors(draft, g, name, before, after, factors, is_known)
    type(draft_type), intent(in) :: draft                !< groups and names with their values as text
    integer, intent(in) :: g                             !< index of the group
    character(len=*), intent(in) :: name                 !< name of the answer, without subscript
    type(units_type), intent(in) :: before               !< units in which the numbers are
    type(units_type), intent(in) :: after                !< units in which they are to be
    real(wp), allocatable, intent(out) :: factors(:)     !< (numbers) factors of the numbers, of other over present units [1]
    logical, intent(out) :: is_known                     !< they are known
    character(len=unit_length), allocatable :: list(:)
    character(len=:), allocatable :: group, over
    integer :: row, place, i

    allocate (factors(1), source=1.0_wp)
    is_known = .true.
    row = item_row_for_kind(draft%groups(g)%name, name, kind_in(draft, g))
    if (row == 0) return
    group = trim(draft%groups(g)%name)
    place = draft%place_of(g)
    if (group == 'parameter' .and. (any(of_parameters == name) .or. name == 'terms')) then
      call find_factor_of_sets(draft, draft%value(group, place, 'sets'), before, after, factors(1), is_known)
      return
    else if (group == 'branch' .and. any(of_parameters == name)) then
      i = place_named(draft, 'parameter', unquoted(draft%value(group, place, 'parameter')))
      is_known = i > 0
      if (i > 0) call find_factor_of_sets(draft, draft%value('parameter', i, 'sets'), before, after, factors(1), is_known)
      return
    end if
    call find_units(draft, g, item_table(row), list, is_known)
    if (is_known) then
      deallocate (factors)
      allocate (factors(size(list)))
      do i = 1, size(list)
        factors(i) = before%size_of(trim(list(i)))/after%size_of(trim(list(i)))
      end do
    else
      ! no number but mass and inertia has the unit of masses
      is_known = is_same(before%size_of('m')/after%size_of('m')) .and. is_same(before%size_of('rad')/after%size_of('rad')) .and. &
                 is_same(before%size_of('N')/after%size_of('N')) .and. is_same(before%size_of('rad/s')/after%size_of('rad/s'))
      return
    end if
    over = lower(unquoted(draft%value(group, place, 'over')))
    if (all(group /= ['load ', 'motor']) .or. over == '' .or. over == 't' .or. all(of_variable /= name)) return
    call take_variable(draft, unquoted(draft%value(group, place, 'over')), name, before, after, factors, is_known)
  end subroutine find_factors

  !> Take the variable of a law into account, which stands in the place of time.
  pure subroutine take_variable(draft, over, name, before, after, factors, is_known)
    type(draft_type), intent(in) :: draft                !< groups and names with their values as text
    character(len=*), intent(in) :: over                 !< name of the variable
    character(len=*), intent(in) :: name                 !< name of the answer
    type(units_type), intent(in) :: before               !< units in which the numbers are
    type(units_type), intent(in) :: after                !< units in which they are to be
    real(wp), allocatable, intent(inout) :: factors(:)   !< (numbers) factors of a law of time; become those of the law [1]
    logical, intent(out) :: is_known                     !< they are known
    character(len=unit_length) :: unit
    real(wp) :: factor, of_law
    integer :: power

    call find_variable_unit(draft, over, unit, is_known)
    if (.not. is_known) return
    factor = before%size_of(trim(unit))/after%size_of(trim(unit))
    of_law = factors(1)
    select case (name)
    case ('times', 'period')
      factors = [factor]
    case ('coefficients')
      factors = [(of_law/factor**power, power=0, most_powers)]
    case ('angular_frequency')
      factors = [before%size_of('rad')/after%size_of('rad')/factor]
    end select
  end subroutine take_variable

  !> Find the SI unit of the variable of a law: of a coordinate or a rate by number or by the name of its pair, or of a point.
  pure subroutine find_variable_unit(draft, over, unit, is_known)
    type(draft_type), intent(in) :: draft                    !< groups and names with their values as text
    character(len=*), intent(in) :: over                     !< name of the variable
    character(len=unit_length), intent(out) :: unit          !< its unit; empty for a user's own coordinate
    logical, intent(out) :: is_known                         !< it is known
    character(len=:), allocatable :: part, kind
    integer :: dot, number, place

    unit = ''
    dot = index(over, '.', back=.true.)
    if (dot > 0) then
      part = over(dot + 1:)
      if (part /= 'q' .and. part /= 'dq') then
        is_known = place_named(draft, 'point', over(:dot - 1)) > 0 .and. len(part) <= 2 .and. index('xyz', part(len(part):)) > 0
        unit = merge('m/s', 'm  ', part(1:1) == 'v')
        return
      end if
      place = place_named(draft, 'pair', over(:dot - 1))
      number = 0
      if (place > 0) number = number_in(draft, 'pair', place)
    else
      part = over(:verify(over//'1', 'dq') - 1)
      number = integer_of(over(len(part) + 1:))
    end if
    is_known = number > 0 .and. (part == 'q' .or. part == 'dq')
    if (.not. is_known) return
    kind = kind_of_coordinate(draft, number)
    is_known = kind /= ''
    if (kind == 'user') return
    unit = merge('m  ', 'rad', kind == 'prismatic' .or. kind == 'path')
    if (part == 'dq') unit = trim(unit)//'/s'
  end subroutine find_variable_unit

  !> Find the one factor of all numbers that a parameter sets; it is not known where they have several.
  pure recursive subroutine find_factor_of_sets(draft, sets, before, after, factor, is_known)
    type(draft_type), intent(in) :: draft                !< groups and names with their values as text
    character(len=*), intent(in) :: sets                 !< names of the numbers, as the data file writes them; none: the unit is 1
    type(units_type), intent(in) :: before               !< units in which the numbers are
    type(units_type), intent(in) :: after                !< units in which they are to be
    real(wp), intent(out) :: factor                      !< factor of the number, of other over present units [1]
    logical, intent(out) :: is_known                     !< it is known
    character(len=len(sets)), allocatable :: words(:)
    real(wp) :: other
    integer :: i

    factor = 1.0_wp
    is_known = .true.
    call split_names(sets, words)
    do i = 1, size(words)
      call find_factor_of_number(draft, trim(words(i)), before, after, other, is_known)
      if (i == 1) factor = other
      is_known = is_known .and. is_same(other/factor)
      if (.not. is_known) return
    end do
  end subroutine find_factor_of_sets

  !> Split a list of names, with or without quotes, in which commas and blanks stand between names, and may stand within brackets.
  pure subroutine split_names(text, words)
    character(len=*), intent(in) :: text                               !< the list
    character(len=len(text)), allocatable, intent(out) :: words(:)     !< the names
    character(len=len(text)) :: list(len(text))
    integer :: i, n, depth, count
    logical :: ends

    list = ''
    count = 0
    n = 0
    depth = 0
    do i = 1, len(text) + 1
      ends = i > len(text)
      if (.not. ends) then
        if (text(i:i) == '''' .or. text(i:i) == '"') cycle
        if (text(i:i) == '(') depth = depth + 1
        if (text(i:i) == ')') depth = depth - 1
        ends = depth == 0 .and. (text(i:i) == ',' .or. text(i:i) == ' ')
        if (.not. ends) then
          if (n == 0) count = count + 1
          n = n + 1
          list(count)(n:n) = text(i:i)
        end if
      end if
      if (ends) n = 0
    end do
    allocate (words(count))
    words(:) = list(:count)
  end subroutine split_names

  !> Find the factor of one number by its name, as pair(2).point(1).
  pure recursive subroutine find_factor_of_number(draft, name, before, after, factor, is_known)
    type(draft_type), intent(in) :: draft                !< groups and names with their values as text
    character(len=*), intent(in) :: name                 !< the name
    type(units_type), intent(in) :: before               !< units in which the numbers are
    type(units_type), intent(in) :: after                !< units in which they are to be
    real(wp), intent(out) :: factor                      !< factor of the number, of other over present units [1]
    logical, intent(out) :: is_known                     !< it is known
    real(wp), allocatable :: factors(:)
    character(len=:), allocatable :: group, item, key
    integer :: place, position, dot, g

    factor = 1.0_wp
    dot = scan(name, '.', back=.true.)
    group = lower(plain_name(name(:max(dot - 1, 0))))
    item = name(dot + 1:)
    place = 1
    if (index(name(:max(dot - 1, 0)), '(') > 0) then
      key = name(index(name, '(') + 1:dot - 2)
      place = integer_of(key)
      if (place == 0) place = place_named(draft, group, key)
    end if
    position = 1
    if (index(item, '(') > 0) position = integer_of(item(index(item, '(') + 1:len(item) - 1))
    g = 0
    if (place > 0) g = draft%find(group, place)
    is_known = g > 0 .and. position > 0
    if (.not. is_known) return
    is_known = item_row_for_kind(group, lower(plain_name(item)), kind_in(draft, g)) > 0
    if (.not. is_known) return
    call find_factors(draft, g, lower(plain_name(item)), before, after, factors, is_known)
    if (is_known) factor = factors(min(position, size(factors)))
  end subroutine find_factor_of_number

  !> The place of a group by its name, among the groups of its kind; 0 where none has it.
  pure integer function place_named(draft, group, name) result(place)
    type(draft_type), intent(in) :: draft          !< groups and names with their values as text
    character(len=*), intent(in) :: group          !< kind of the groups
    character(len=*), intent(in) :: name           !< value of `name`

    do place = draft%count_of(group), 1, -1
      if (name /= '' .and. unquoted(draft%value(group, place, 'name')) == name) return
    end do
  end function place_named

  !> Find the SI units of the numbers of an answer, as of a law of time: one for each place of a list, the last one for all further
  !> places. That of a plain number is empty.
  pure subroutine find_units(draft, g, row, list, is_known)
    type(draft_type), intent(in) :: draft                                !< groups and names with their values as text
    integer, intent(in) :: g                                             !< index of the group
    type(item_row_type), intent(in) :: row                               !< row of the table of names
    character(len=unit_length), allocatable, intent(out) :: list(:)      !< the units
    logical, intent(out) :: is_known                                     !< they are known
    character(len=:), allocatable :: kind, q
    integer :: place, power
    logical :: slides

    allocate (list(1))
    list = ''
    place = draft%place_of(g)
    is_known = .not. is_of_others(draft, row, place)
    if (.not. is_known) return
    kind = kind_of_coordinate(draft, coordinate_in(draft, trim(row%group), place))
    slides = kind == 'prismatic' .or. kind == 'path'
    q = 'rad'
    if (slides) q = 'm'
    if (kind == 'user') q = ''
    select case (row%unit)
    case ('', 's', 'V', 'ohm', 'H', '1, 1/s, ...')
    case ('angle')
      list = 'rad'
    case ('angle/s')
      list = 'rad/s'
    case ('m', 'kg', 'kg m^2', 'm/s^2', 'N', 'N m', 'N/m', 'N s/m')
      list = row%unit
    case ('m, angle')
      list = [character(len=unit_length) :: 'm', 'rad', 'm', 'rad']
    case ('q', 'q/s', 'q, q/s, ...', '1 or q', '1 or q, /s')
      ! the law of a motor by direct current is a factor, or a voltage
      if (row%unit(1:1) == '1' .and. index(kind_in(draft, g)//' ', 'dc ') == 1) return
      is_known = kind /= ''
      if (q == '') return
      list = [character(len=unit_length) :: q, q//'/s', (q//'/s^'//to_text(power), power=2, most_powers)]
      if (row%unit == 'q' .or. row%unit == '1 or q') list = list(:1)
      if (row%unit == 'q/s') list = list(2:2)
    case ('N m/A, N/A', 'N m, N', 'N m/rad, N/m', 'N m/rad/s', 'N m s, N s/m')
      ! constants, limits and gains of motors; angles count in rad
      is_known = kind /= ''
      list = 'N m'
      if (slides) list = 'N'
      if (slides .and. row%unit /= 'N m/A, N/A' .and. row%unit /= 'N m, N') list = 'N/m'
    case ('N or N m', 'N/m, N m/rad', 'N s/m, N m s', 'N, N m')
      is_known = slides .or. kind == 'revolute' .or. (kind == 'helical' .and. row%group == 'load')
      power = scan(row%unit//',', ',')
      if (row%unit == 'N or N m') power = 2
      list = row%unit(:power - 1)
      if (.not. slides) list = adjustl(row%unit(power + 1:))
      if (.not. slides .and. row%unit == 'N or N m') list = 'N m'
    case default
      is_known = .false.
    end select
  end subroutine find_units

  !> The coordinate that a group names by number, or by the name of its pair; 0 if it names none.
  pure integer function coordinate_in(draft, group, place) result(number)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=*), intent(in) :: group  !< name of the group
    integer, intent(in) :: place           !< place among the groups of that name, from 1
    integer :: pair

    number = number_in(draft, group, place)
    if (number > 0 .or. group == 'pair') return
    pair = place_named(draft, 'pair', unquoted(draft%value(group, place, 'coordinate')))
    if (pair > 0) number = number_in(draft, 'pair', pair)
  end function coordinate_in

  !> Whether a number has the unit of another one, or of results.
  pure logical function is_of_others(draft, row, place)
    type(draft_type), intent(in) :: draft          !< groups and names with their values as text
    type(item_row_type), intent(in) :: row         !< row of the table of names
    integer, intent(in) :: place                   !< place of the group among those of its name, from 1

    is_of_others = .false.
    select case (trim(row%group)//'.'//row%name)
    case ('stop.stiffness', 'stop.damping', 'contact.stiffness', 'contact.damping', 'coupling.constant', 'solver.accuracy', &
          'limit.low', 'limit.high', 'objective.goal', 'objective.weight')
      is_of_others = .true.
    case ('section.value')
      is_of_others = draft%has('section', place, 'column')
    end select
  end function is_of_others
end module mech9_unit_factors
