!> The numbers of a draft in other units of the data file.
!>
!> A number is converted where the table of names and the kind of its pair tell its unit. Nothing is converted where one number has the
!> unit of another, as a parameter has, or stands in a file beside the data file.
module mech9_converted_numbers
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, lower
  use mech9_units, only: units_type
  use mech9_grammar, only: item_table, item_row_type
  use mech9_item_rows, only: item_row_for_kind
  use mech9_draft, only: draft_type, plain_name, unquoted
  use mech9_draft_joints, only: kind_in, number_in, kind_of_coordinate
  implicit none
  private
  public :: convert_numbers, changed_units

  integer, parameter :: unit_length = 24     !< letters of a unit
  integer, parameter :: most_powers = 9      !< coefficients of a drive whose units are listed

  !> Groups whose numbers have the units of others, or of results.
  character(len=9), parameter :: of_others(4) = [character(len=9) :: 'parameter', 'limit', 'objective', 'branch']

  !> Numbers of laws that have the unit of the variable.
  character(len=17), parameter :: of_variable(4) = [character(len=17) :: 'times', 'coefficients', 'angular_frequency', 'period']

contains

  !> The units that differ, such as "m" and "mm", or "m, rad" and "mm, deg"; both are empty where none does.
  pure subroutine changed_units(before, after, old, new)
    type(units_type), intent(in) :: before                !< units of the data file
    type(units_type), intent(in) :: after                 !< the other ones
    character(len=:), allocatable, intent(out) :: old     !< those before
    character(len=:), allocatable, intent(out) :: new     !< those after

    old = ''
    new = ''
    call append(trim(before%length_name), trim(after%length_name), old, new)
    call append(trim(before%angle_name), trim(after%angle_name), old, new)
    call append(trim(before%force_name), trim(after%force_name), old, new)
    call append(trim(before%mass_name), trim(after%mass_name), old, new)
    call append(trim(before%rate_name), trim(after%rate_name), old, new)
    old = old(3:)
    new = new(3:)
  end subroutine changed_units

  !> Append the names of a unit to two lists where they differ.
  pure subroutine append(one, other, old, new)
    character(len=*), intent(in) :: one                       !< name before
    character(len=*), intent(in) :: other                     !< name after
    character(len=:), allocatable, intent(inout) :: old       !< names before, with commas between
    character(len=:), allocatable, intent(inout) :: new       !< names after

    if (one == other) return
    old = old//', '//one
    new = new//', '//other
  end subroutine append

  !> Convert all numbers of a draft. Where any cannot be, the draft stays as it is.
  pure subroutine convert_numbers(before, after, draft, count, left)
    type(units_type), intent(in) :: before                !< units in which the numbers are
    type(units_type), intent(in) :: after                 !< units in which they are to be
    type(draft_type), intent(inout) :: draft              !< groups and names with their values as text
    integer, intent(out) :: count                         !< how many answers have numbers that change, or that cannot be converted
    character(len=:), allocatable, intent(out) :: left    !< answers that cannot be converted, with commas between; empty: none
    type(draft_type) :: converted
    character(len=:), allocatable :: text
    logical :: is_known
    integer :: g, e

    count = 0
    left = ''
    converted = draft
    do g = 1, size(draft%groups)
      do e = 1, size(draft%groups(g)%entries)
        text = draft%groups(g)%entries(e)%text
        call convert_entry(draft, g, e, before, after, text, is_known)
        if (is_known .and. text == draft%groups(g)%entries(e)%text) cycle
        count = count + 1
        converted%groups(g)%entries(e)%text = text
        if (.not. is_known) left = left//', '//draft%groups(g)%name//' '//to_text(draft%place_of(g))//' '// &
                                   draft%groups(g)%entries(e)%name
      end do
    end do
    left = left(3:)
    if (left == '') draft = converted
  end subroutine convert_numbers

  !> Convert the numbers of one answer.
  pure subroutine convert_entry(draft, g, e, before, after, text, is_known)
    type(draft_type), intent(in) :: draft                    !< groups and names with their values as text
    integer, intent(in) :: g                                 !< index of the group
    integer, intent(in) :: e                                 !< number of the answer in it
    type(units_type), intent(in) :: before                   !< units in which the numbers are
    type(units_type), intent(in) :: after                    !< units in which they are to be
    character(len=:), allocatable, intent(inout) :: text     !< the answer; becomes the converted one
    logical, intent(out) :: is_known                         !< the units are known
    character(len=unit_length), allocatable :: list(:)
    character(len=:), allocatable :: name
    integer :: row

    is_known = .true.
    name = plain_name(draft%groups(g)%entries(e)%name)
    row = item_row_for_kind(draft%groups(g)%name, name, kind_in(draft, g))
    if (row == 0) return
    if (item_table(row)%type == 'text') then
      is_known = name /= 'file' .and. name /= 'formula'
      return
    else if (item_table(row)%type /= 'real') then
      return
    end if
    call find_units(draft, g, item_table(row), list, is_known)
    if (.not. is_known) return
    ! an element of a list, as in point(2), has the unit of the list where this has one
    if (name /= draft%groups(g)%entries(e)%name .and. any(list /= list(1))) is_known = .false.
    if (is_known) call convert_list(list, before, after, text, is_known)
  end subroutine convert_entry

  !> Find the SI units of the numbers of an answer: one for each place of a list, the last one for all further places. That of a plain
  !> number is empty.
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
    kind = kind_of_coordinate(draft, number_in(draft, trim(row%group), place))
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
    case ('q', 'q/s', 'q, q/s, ...')
      is_known = kind /= ''
      if (q == '') return
      list = [character(len=unit_length) :: q, q//'/s', (q//'/s^'//to_text(power), power=2, most_powers)]
      if (row%unit == 'q') list = list(:1)
      if (row%unit == 'q/s') list = list(2:2)
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

  !> Whether a number has the unit of another one, of results, or of the variable of a law.
  pure logical function is_of_others(draft, row, place)
    type(draft_type), intent(in) :: draft          !< groups and names with their values as text
    type(item_row_type), intent(in) :: row         !< row of the table of names
    integer, intent(in) :: place                   !< place of the group among those of its name, from 1
    character(len=:), allocatable :: over

    is_of_others = any(of_others == row%group) .and. row%unit == ''
    select case (trim(row%group)//'.'//row%name)
    case ('stop.stiffness', 'stop.damping', 'contact.stiffness', 'contact.damping', 'coupling.constant', 'solver.accuracy')
      is_of_others = .true.
    case ('section.value')
      is_of_others = draft%has('section', place, 'column')
    case ('objective.weight')
      is_of_others = .false.
    end select
    over = lower(unquoted(draft%value(trim(row%group), place, 'over')))
    if (over /= '' .and. over /= 't') is_of_others = is_of_others .or. any(row%name == of_variable)
  end function is_of_others

  !> Convert the numbers of a list.
  pure subroutine convert_list(list, before, after, text, is_known)
    character(len=*), intent(in) :: list(:)                  !< SI units of the numbers in turn, the last one of all further ones
    type(units_type), intent(in) :: before                   !< units in which the numbers are
    type(units_type), intent(in) :: after                    !< units in which they are to be
    character(len=:), allocatable, intent(inout) :: text     !< the numbers; become the converted ones
    logical, intent(out) :: is_known                         !< they are plain numbers
    character(len=:), allocatable :: new, word
    real(wp) :: factor, value
    integer :: at, last, i, k, iostat
    logical :: changes

    is_known = .true.
    changes = .false.
    new = ''
    at = 1
    i = 0
    do
      at = at - 1 + verify(text(at:)//'x', ' ,'//achar(9))
      if (at > len(text)) exit
      last = at - 2 + scan(text(at:)//' ', ' ,'//achar(9))
      word = text(at:last)
      i = i + 1
      k = min(i, size(list))
      factor = before%size_of(trim(list(k)))/after%size_of(trim(list(k)))
      if (abs(factor - 1.0_wp) > 4.0_wp*epsilon(1.0_wp)) then
        read (word, *, iostat=iostat) value
        is_known = iostat == 0 .and. verify(word, '0123456789+-.eEdD') == 0
        if (.not. is_known) return
        changes = changes .or. abs(value) > 0.0_wp
        word = to_text(value*factor, 15)
      else if (index(word, '*') > 0) then
        ! 3*0.5 stands for three numbers, of which the units may differ
        is_known = all(list == list(1))
        if (.not. is_known) return
      end if
      new = new//', '//word
      at = last + 1
    end do
    if (changes) text = new(3:)
  end subroutine convert_list
end module mech9_converted_numbers
