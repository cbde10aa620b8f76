!> The grammar as text for users: plain for the terminal, and Markdown for the documentation.
module mech9_data_help
  use mech9_program_kind, only: both_programs, program_names
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: to_text, nearest_name
  use mech9_grammar_rows, only: refers_to
  use mech9_grammar, only: group_table, item_table, item_row_type, group_row_type, unlimited, find_group_row, &
    rows_of_group, names_of_groups, names_in_group, for_forces
  use mech9_item_rows, only: find_item_rows
  implicit none
  private
  public :: write_data_help, write_data_tables
  public :: values_text, default_text, takes_text, meaning_text, use_text

  character(len=*), parameter :: indent = '      '

contains

  !> Help on a group with all of its names, or on one name of it; without a group, a short list of all groups.
  subroutine write_data_help(unit, subject, err)
    integer, intent(in) :: unit                        !< Fortran unit to write to
    character(len=*), intent(in) :: subject            !< GROUP or GROUP.NAME, with or without &; empty: all groups
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: group, name
    integer, allocatable :: rows(:)
    integer :: row, dot, i

    if (subject == '') then
      call list_groups(unit)
      return
    end if
    group = trim(subject)
    if (group(1:1) == '&') group = group(2:)
    dot = index(group//'.', '.')
    name = group(min(dot, len(group)) + 1:)
    group = group(:dot - 1)
    row = find_group_row(group)
    if (row == 0) then
      call raise(err, exit_usage, 'there is no group '''//group//''' in a data file'// &
                 hint(group, names_of_groups(), '--help-data lists the groups'))
      return
    end if
    rows = rows_of_group(group)
    if (name /= '') rows = find_item_rows(group, name)
    if (size(rows) == 0) then
      call raise(err, exit_usage, 'there is no name '''//name//''' in &'//trim(group_table(row)%name)// &
                 hint(name, names_in_group(group), '--help-data '//trim(group_table(row)%name)//' lists its names'))
      return
    end if
    write (unit, '(3a)') '&', trim(group_table(row)%name), ': '//trim(group_table(row)%help)
    write (unit, '(2a)') indent(:2), use_text(group_table(row))
    do i = 1, size(rows)
      call describe_item(unit, item_table(rows(i)))
    end do
  end subroutine write_data_help

  !> The question whether the known word nearest to a misspelled one is meant; other advice where none is near.
  pure function hint(word, known, otherwise) result(text)
    character(len=*), intent(in) :: word       !< the unknown word of the user
    character(len=*), intent(in) :: known(:)   !< the words that exist
    character(len=*), intent(in) :: otherwise  !< the advice where no known word is near
    character(len=:), allocatable :: text

    text = nearest_name(word, known)
    if (text == '') then
      text = '; '//otherwise
    else
      text = '; did you mean '//text//'?'
    end if
  end function hint

  !> Write a line for each group.
  subroutine list_groups(unit)
    integer, intent(in) :: unit  !< Fortran unit to write to
    integer :: i

    write (unit, '(a)') 'The groups of a data file, in any order; --help-data GROUP explains one, GROUP.NAME a name in it:'
    do i = 1, size(group_table)
      write (unit, '(2x,a,a12,a)') '&', group_table(i)%name//'   ', trim(group_table(i)%help)
    end do
  end subroutine list_groups

  !> Write the example, the meaning and the values of one name.
  subroutine describe_item(unit, row)
    integer, intent(in) :: unit             !< Fortran unit to write to
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table

    write (unit, '(a)')
    write (unit, '(2a)') indent(:2), trim(row%name)//' = '//trim(row%example)
    write (unit, '(2a)') indent, meaning_text(row)
    write (unit, '(2a)') indent, takes_text(row)
  end subroutine describe_item

  !> The groups one after the other, each with a Markdown table of its names.
  subroutine write_data_tables(unit)
    integer, intent(in) :: unit  !< Fortran unit to write to
    integer, allocatable :: rows(:)
    integer :: i, j

    do i = 1, size(group_table)
      write (unit, '(/,3a,/)') '### `&', trim(group_table(i)%name), '`'
      write (unit, '(a,/)') capital(trim(group_table(i)%help))//'. '//capital(use_text(group_table(i)))//'.'
      write (unit, '(a)') '| name | values | unit | if not given | meaning | example |'
      write (unit, '(a)') '| --- | --- | --- | --- | --- | --- |'
      rows = rows_of_group(group_table(i)%name)
      do j = 1, size(rows)
        call write_table_row(unit, item_table(rows(j)))
      end do
    end do
  end subroutine write_data_tables

  !> Write the row of a name in a Markdown table.
  subroutine write_table_row(unit, row)
    integer, intent(in) :: unit             !< Fortran unit to write to
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table

    write (unit, '(*(a))') '| `', trim(row%name), '` | ', values_text(row), ' | ', unit_text(row), ' | ', &
      default_text(row), ' | ', meaning_text(row), ' | `', trim(row%example), '` |'
  end subroutine write_table_row

  !> The text with its first letter raised.
  pure function capital(text) result(raised)
    character(len=*), intent(in) :: text  !< a text that is not empty
    character(len=len(text)) :: raised

    raised = text
    if (text(1:1) >= 'a' .and. text(1:1) <= 'z') raised(1:1) = achar(iachar(text(1:1)) - 32)
  end function capital

  !> The rule how often a group may stand, and the program that uses it.
  pure function use_text(row) result(text)
    type(group_row_type), intent(in) :: row  !< the group, as a row of group_table
    character(len=:), allocatable :: text

    text = 'stands at most once'
    if (row%repeats) text = 'may be repeated'
    if (row%key /= '') text = 'may be repeated, each with another '//trim(row%key)
    if (row%program == for_forces) then
      text = text//'; used by mech9d, and by mech9k for the forces of reactions, drive_forces and force_arrows'
    else if (row%program /= both_programs) then
      text = text//'; used by '//program_names(row%program)
    end if
  end function use_text

  !> The values that a name takes: "2 whole numbers, >=1", "a text: fixed or link".
  pure function values_text(row) result(text)
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table
    character(len=:), allocatable :: text

    select case (row%type)
    case ('integer')
      text = 'whole number'
    case ('real')
      text = 'number'
    case ('logical')
      text = '.true. or .false.'
    case default
      text = 'text'
    end select
    if (row%high == unlimited) then
      text = text//'s'
    else if (row%high > 1) then
      text = to_text(row%high)//' '//text//'s'
    end if
    if (row%range /= '') text = text//', '//trim(row%range)
    if (refers_to(trim(row%group), trim(row%name)) > 0) text = text//', or '//trim(merge('names', 'name ', row%high > 1))
    if (row%words /= '') text = text//': '//word_list(trim(row%words))
  end function values_text

  !> "a b c" as "a, b or c".
  pure function word_list(words) result(text)
    character(len=*), intent(in) :: words  !< the words, with one blank between two of them
    character(len=:), allocatable :: text
    integer :: i, last

    last = index(words, ' ', back=.true.)
    text = ''
    do i = 1, len(words)
      if (words(i:i) /= ' ') then
        text = text//words(i:i)
      else if (i == last) then
        text = text//' or '
      else
        text = text//', '
      end if
    end do
  end function word_list

  !> The unit in words; the grammar writes `q` for the unit of a coordinate.
  pure function unit_text(row) result(text)
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table
    character(len=:), allocatable :: text

    select case (row%unit)
    case ('q')
      text = 'angle or m'
    case ('q/s')
      text = 'angle/s or m/s'
    case ('q, q/s, ...')
      text = 'angle or m, per s, ...'
    case ('s, q')
      text = 's, angle or m'
    case default
      text = trim(row%unit)
    end select
  end function unit_text

  !> The values that a name takes, their unit, and the default.
  pure function takes_text(row) result(text)
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table
    character(len=:), allocatable :: text

    text = values_text(row)
    if (row%unit /= '') text = text//' ['//unit_text(row)//']'
    if (row%needed) then
      text = text//'; must be given'
    else
      text = text//'; if not given: '//default_text(row)
    end if
  end function takes_text

  !> The value that holds where the name is not given.
  pure function default_text(row) result(text)
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table
    character(len=:), allocatable :: text

    if (row%needed) then
      text = 'must be given'
    else if (row%default == '''''') then
      text = 'none'
    else if (index(row%default, '(') == 1) then
      text = row%default(2:len_trim(row%default) - 1)
    else
      text = trim(row%default)
    end if
  end function default_text

  !> The meaning of a name, after the kinds of the group that it belongs to.
  pure function meaning_text(row) result(text)
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table
    character(len=:), allocatable :: text

    text = trim(row%help)
    if (index(row%kinds, 'law:') == 1) then
      text = '(law '//word_list(kinds_of_laws(trim(row%kinds)))//') '//text
    else if (row%kinds /= '') then
      text = '('//word_list(trim(row%kinds))//') '//text
    end if
  end function meaning_text

  !> Kinds of laws without the word in front of each: "table segments" of "law:table law:segments".
  pure function kinds_of_laws(kinds) result(words)
    character(len=*), intent(in) :: kinds   !< with blanks between
    character(len=:), allocatable :: words
    character(len=*), parameter :: mark = 'law:'
    integer :: at

    words = kinds
    do
      at = index(words, mark)
      if (at == 0) return
      words = words(:at - 1)//words(at + len(mark):)
    end do
  end function kinds_of_laws
end module mech9_data_help
