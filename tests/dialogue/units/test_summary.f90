!> The numbered answers of a draft, and the words by which users name them.
module test_summary
  use mech9_draft, only: draft_type
  use mech9_summary, only: print_summary, number_of_entry, entry_meant, title_of
  use mech9_test_files, only: text_of_unit
  use mech9_text, only: to_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('titles')) call titles(tester)
    if (tester%runs('numbers')) call numbers(tester)
    if (tester%runs('words')) call words(tester)
    if (tester%runs('nothing')) call nothing(tester)
    if (tester%runs('list')) call list(tester)
  end subroutine run

  !> Two pairs, of which the first in the file has coordinate 3, two loads, and the time.
  subroutine make(draft)
    type(draft_type), intent(out) :: draft   !< the draft

    call draft%clear()
    call draft%give('mechanism', 1, 'name', '''crank''')
    call draft%give('pair', 1, 'coordinate', '3')
    call draft%give('pair', 1, 'kind', '''revolute''')
    call draft%give('pair', 2, 'coordinate', '1')
    call draft%give('pair', 2, 'kind', '''prismatic''')
    call draft%give('load', 1, 'link', '2')
    call draft%give('load', 2, 'link', '3')
    call draft%give('time', 1, 'end', '2.5')
  end subroutine make

  !> The index of a group.
  integer function at(draft, group, place)
    type(draft_type), intent(in) :: draft    !< the draft
    character(len=*), intent(in) :: group    !< its name
    integer, intent(in) :: place             !< among the groups of that name

    at = draft%find(group, place)
  end function at

  !> Pairs have the numbers of their coordinates, loads count from 1, and the time is the only one.
  subroutine titles(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(draft_type) :: draft

    call make(draft)
    call tester%is_true(title_of(draft, at(draft, 'pair', 1)) == 'pair 3', 'the pair with coordinate 3')
    call tester%is_true(title_of(draft, at(draft, 'pair', 2)) == 'pair 1', 'the pair with coordinate 1')
    call tester%is_true(title_of(draft, at(draft, 'load', 2)) == 'load 2', 'the second load')
    call tester%is_true(title_of(draft, at(draft, 'time', 1)) == 'time', 'the time')
  end subroutine titles

  !> The answers have the numbers 1, 2, ... without gaps; a coordinate in the title of its group has none. The number names the
  !> same answer again.
  subroutine numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(draft_type) :: draft
    character(len=:), allocatable :: group, name
    integer :: i, j, k, n, place
    logical :: by_number

    call make(draft)
    n = 0
    do i = 1, size(draft%groups)
      do j = 1, size(draft%groups(i)%entries)
        k = number_of_entry(draft, i, j)
        if (draft%groups(i)%entries(j)%name == 'coordinate') then
          call tester%is_true(k == 0, 'coordinates have no number')
          cycle
        end if
        n = n + 1
        call tester%is_true(k == n, 'number '//to_text(n))
        call entry_meant(draft, to_text(n), group, place, name, by_number)
        call tester%is_true(by_number .and. group == draft%groups(i)%name .and. place == draft%place_of(i) .and. &
                            name == draft%groups(i)%entries(j)%name, 'and back')
      end do
    end do
    call tester%is_true(n == 6, 'six answers')
    call tester%is_true(number_of_entry(draft, 0, 1) == 0 .and. number_of_entry(draft, 1, 0) == 0, 'no entry, no number')
  end subroutine numbers

  !> Words name a group by its title, in any case of letters, and one of its names.
  subroutine words(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(draft_type) :: draft

    call make(draft)
    call names('pair 3 kind', 'pair', 1, 'kind')
    call names('PAIR 1 Kind', 'pair', 2, 'kind')
    call names('load 2', 'load', 2, '')
    call names('load link', 'load', 1, 'link')
    call names('  time   end ', 'time', 1, 'end')
    call names('time', 'time', 1, '')

  contains

    subroutine names(line, group, place, name)
      character(len=*), intent(in) :: line    !< the words
      character(len=*), intent(in) :: group   !< name of the group meant
      integer, intent(in) :: place            !< its place among those of its name
      character(len=*), intent(in) :: name    !< the name in it; empty: the group as a whole
      character(len=:), allocatable :: found, found_name
      integer :: found_place
      logical :: by_number

      call entry_meant(draft, line, found, found_place, found_name, by_number)
      call tester%is_true(found == group .and. found_place == place .and. found_name == name .and. .not. by_number, line)
    end subroutine names
  end subroutine words

  !> Numbers beyond the list, unknown groups, groups that are not there, and too many words name nothing.
  subroutine nothing(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: lines(*) = [character(len=20) :: '0', '7', '-1', '1.5', '', 'wheel', 'pair 2', 'pair 9 kind', &
                                               'load 3', 'load 1 link 2', 'time end end', 'time 5', 'time 5 end']
    type(draft_type) :: draft
    character(len=:), allocatable :: group, name
    integer :: i, place

    call make(draft)
    do i = 1, size(lines)
      call entry_meant(draft, trim(lines(i)), group, place, name)
      call tester%is_true(group == '' .and. name == '', 'nothing: '//trim(lines(i)))
    end do
    call entry_meant(draft, 'time '//repeat('x', 1000), group, place, name)
    call tester%is_true(group == '', 'a long text')
  end subroutine nothing

  !> Every answer stands in the list behind its number, without quotes, in lines that fit the terminal.
  subroutine list(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: eol = achar(10)
    type(draft_type) :: draft
    character(len=:), allocatable :: text
    integer :: unit, first, last

    call make(draft)
    call draft%give('mechanism', 1, 'links', repeat('1 ', 20)//'1')
    call draft%give('mechanism', 1, 'pairs', repeat('2 ', 20)//'2')
    open (newunit=unit, file='test_summary.txt')
    call print_summary(unit, draft)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, '  pair 3:  [4] kind revolute'//eol) > 0, 'the pair with coordinate 3')
    call tester%is_true(index(text, '  time:  [8] end 2.5'//eol) > 0, 'the time')
    call tester%is_true(index(text, 'name crank') > 0 .and. index(text, '''') == 0, 'no quotes')
    first = 1
    do while (first <= len(text))
      last = first + index(text(first:), eol) - 2
      if (last < first) exit
      call tester%is_true(last - first + 1 <= 79, 'a line that fits')
      first = last + 2
    end do
    call tester%is_true(first > len(text), 'no empty line')
  end subroutine list
end module test_summary
