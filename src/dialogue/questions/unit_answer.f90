!> The units of a data file in one answer, such as "mm deg" or "in lbf rpm".
module mech9_unit_answer
  use mech9_text, only: lower
  use mech9_grammar, only: item_table, item_row_type, rows_of_group, words_of
  use mech9_diagnostics, only: printable
  use mech9_draft, only: draft_type, unquoted
  use mech9_short_answers, only: word_meant
  implicit none
  private
  public :: is_unit_row, prompt_of_units, all_unit_words, give_units

  integer, parameter :: longest_list = 100   !< letters of an answer

  !> Words for units, and the units that they mean.
  character(len=12), parameter :: long_words(2, 15) = reshape([character(len=12) :: &
    'metre', 'm', 'metres', 'm', 'meter', 'm', 'meters', 'm', 'millimetre', 'mm', 'millimetres', 'mm', 'millimeter', 'mm', &
    'millimeters', 'mm', 'inch', 'in', 'inches', 'in', 'degree', 'deg', 'degrees', 'deg', 'radian', 'rad', 'radians', 'rad', &
    'newton', 'N'], [2, 15])

contains

  !> Whether a row of the table of names is a unit of the data file.
  pure logical function is_unit_row(row)
    type(item_row_type), intent(in) :: row  !< row of the table of names

    is_unit_row = row%group == 'mechanism' .and. index(row%name, '_unit') > 0
  end function is_unit_row

  !> The prompt: the units of lengths and angles of a draft, and others that it names, such as "length_unit [m], angle_unit [rad]".
  pure function prompt_of_units(draft) result(text)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    character(len=:), allocatable :: text, word
    integer, allocatable :: rows(:)
    integer :: i

    rows = unit_rows()
    text = ''
    do i = 1, size(rows)
      associate (row => item_table(rows(i)))
        word = unquoted(draft%value('mechanism', 1, trim(row%name)))
        if (word == '' .and. any(row%name == [character(len=11) :: 'length_unit', 'angle_unit'])) word = unquoted(trim(row%default))
        if (word /= '') text = text//', '//trim(row%name)//' ['//word//']'
      end associate
    end do
    text = text(3:)
  end function prompt_of_units

  !> All words that the answer takes, with blanks between.
  pure function all_unit_words() result(text)
    character(len=:), allocatable :: text
    integer, allocatable :: rows(:)
    integer :: i

    rows = unit_rows()
    text = ''
    do i = 1, size(rows)
      text = text//trim(item_table(rows(i))%words)//' '
    end do
  end function all_unit_words

  !> Give a draft the units of an answer. Units of kinds that the answer does not name stay; `default` takes all away.
  pure subroutine give_units(line, draft, problem)
    character(len=*), intent(in) :: line                   !< the answer, without blanks around it
    type(draft_type), intent(inout) :: draft               !< changed where the answer is right
    character(len=:), allocatable, intent(out) :: problem  !< the reason why it is no answer; empty: it is one
    type(draft_type) :: changed
    character(len=:), allocatable :: plain, named
    integer, allocatable :: rows(:)
    integer :: i, row

    problem = ''
    rows = unit_rows()
    if (lower(line(:min(len(line), 8))) == 'default') then
      do i = 1, size(rows)
        call draft%take_away('mechanism', 1, trim(item_table(rows(i))%name))
      end do
      return
    end if
    plain = line(:min(len(line), longest_list))
    do i = 1, len(plain)
      if (scan(plain(i:i), ','//achar(9)) > 0) plain(i:i) = ' '
    end do
    changed = draft
    named = ' '
    associate (words => words_of(plain))
      do i = 1, size(words)
        call find_unit(trim(words(i)), rows, row, plain)
        if (row == 0) then
          problem = "'"//printable(trim(words(i)), 40)//"' is none of the units of a data file: "//all_unit_words()// &
                    '- units such as cm may stand in later answers, which are converted: 8 cm'
        else if (index(named, ' '//trim(item_table(row)%name)//' ') > 0) then
          problem = 'two units of one kind are named: '//trim(item_table(row)%words)
        end if
        if (problem /= '') return
        named = named//trim(item_table(row)%name)//' '
        call changed%give('mechanism', 1, trim(item_table(row)%name), "'"//plain//"'")
      end do
    end associate
    draft = changed
  end subroutine give_units

  !> Find the unit that a word means: a unit, its long name, or the only one of lengths and angles that begins with it.
  pure subroutine find_unit(word, rows, row, unit)
    character(len=*), intent(in) :: word                !< a word of the answer
    integer, intent(in) :: rows(:)                      !< rows of the units in item_table
    integer, intent(out) :: row                         !< row of the name that takes the unit; 0: the word is none
    character(len=:), allocatable, intent(out) :: unit  !< the unit as the table of names has it
    character(len=:), allocatable :: sought
    integer :: i, j

    sought = lower(word)
    do i = 1, size(long_words, 2)
      if (sought == long_words(1, i)) sought = lower(trim(long_words(2, i)))
    end do
    if (word_meant(sought, [character(len=5) :: 'deg', 'in', 'm', 'mm', 'rad']) /= '') &
      sought = word_meant(sought, [character(len=5) :: 'deg', 'in', 'm', 'mm', 'rad'])
    do i = 1, size(rows)
      row = rows(i)
      associate (words => words_of(trim(item_table(row)%words)))
        do j = 1, size(words)
          unit = trim(words(j))
          if (lower(unit) == sought) return
        end do
      end associate
    end do
    row = 0
  end subroutine find_unit

  !> Rows in item_table of the units of a data file, that of lengths first.
  pure function unit_rows() result(rows)
    integer, allocatable :: rows(:)
    integer :: i

    rows = rows_of_group('mechanism')
    rows = pack(rows, [(is_unit_row(item_table(rows(i))), i=1, size(rows))])
    rows = [pack(rows, item_table(rows)%name == 'length_unit'), pack(rows, item_table(rows)%name /= 'length_unit')]
  end function unit_rows
end module mech9_unit_answer
