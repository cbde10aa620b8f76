!> A table of names: numbers come back by their names, as from a search through all names.
module test_name_table
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_random, only: random_type
  use mech9_name_table, only: name_table_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('few names')) call few_names(tester)
    if (tester%runs('many names')) call many_names(tester)
  end subroutine run

  !> Names that are there, that are not, and that are added again.
  subroutine few_names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(name_table_type) :: table

    call tester%is_true(table%find('a') == 0, 'an empty table has no name')
    call table%add('a', 7)
    call table%add('', 3)
    call table%add('A', 5)
    call table%add('a', 9)
    call tester%is_true(table%find('a') == 7, 'a name keeps its first number')
    call tester%is_true(table%find('') == 3, 'the empty name is a name')
    call tester%is_true(table%find('A') == 5, 'large and small letters differ')
    call tester%is_true(table%find('a  ') == 7, 'blanks at the end do not count')
    call tester%is_true(table%find(' a') == 0, 'blanks at the beginning count')
    call table%set('a', 9)
    call table%set('b', 2)
    call tester%is_true(table%find('a') == 9 .and. table%find('b') == 2, 'set gives a name another number')
  end subroutine few_names

  !> Many names with random parts, each of which comes twice or more, against the first place in a list.
  subroutine many_names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: names(3000)
    type(name_table_type) :: table
    type(random_type) :: random
    logical :: right
    integer :: i, j

    right = .true.
    do i = 1, size(names)
      names(i)%text = 'n'//to_text(int(500.0_wp*(1.0_wp + random%symmetric())))
      if (mod(i, 3) == 0) names(i)%text = names(i)%text//repeat('x', 1 + mod(i, 90))
      call table%add(names(i)%text, i)
      do j = 1, i
        if (names(j)%text == names(i)%text) exit
      end do
      right = right .and. table%find(names(i)%text) == j
    end do
    call tester%is_true(right, 'each name has its first number')
    do i = 1, size(names)
      right = right .and. table%find('m'//names(i)%text) == 0
    end do
    call tester%is_true(right, 'other names have none')
  end subroutine many_names
end module test_name_table
