!> Titles in lines: nothing of them is lost but what has no room, whatever bytes they hold.
module test_title_lines
  use mech9_text, only: string_type
  use mech9_title_lines, only: title_lines, letters_of
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: more = char(226)//char(128)//char(166)
  !> A letter of four bytes, a face.
  character(len=*), parameter :: face = char(240)//char(159)//char(153)//char(130)

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('short_titles')) call short_titles(test)
    if (test%runs('long_titles')) call long_titles(test)
    if (test%runs('other_letters')) call other_letters(test)
  end subroutine run

  subroutine short_titles(test)
    type(tester_type), intent(inout) :: test   !< counts the checks

    call expect(test, 'Fig. 1', 20, 2, ['Fig. 1'])
    call expect(test, '', 20, 2, [' '])
    call expect(test, 'just as long', 12, 1, ['just as long'])
    call expect(test, '  a'//char(9)//'b  ', 12, 1, ['a b'])
  end subroutine short_titles

  subroutine long_titles(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(string_type), allocatable :: lines(:)
    integer :: i

    ! a blank is half as wide as a letter
    call expect(test, 'aaaaa bbb ccc dddd', 9, 2, ['aaaaa bbb', 'ccc dddd '])
    call expect(test, 'aaaaa bbb ccc dddd', 8, 3, ['aaaaa  ', 'bbb ccc', 'dddd   '])
    call expect(test, repeat('nado', 5), 8, 3, ['nadonado', 'nadonado', 'nado    '])
    call expect(test, 'aaaaa bbb ccc dddd', 6, 2, [character(len=8) :: 'aaaaa', 'bbb c'//more])
    lines = title_lines(repeat('x', 2000), 60, 3)
    call test%is_true(size(lines) == 3, 'two thousand letters are put into three lines')
    call test%is_true(all([(letters_of(lines(i)%text) <= 61, i=1, 3)]), 'none of the three lines is longer than its room')
  end subroutine long_titles

  !> Characters stay whole, and wide ones count twice.
  subroutine other_letters(test)
    type(tester_type), intent(inout) :: test   !< counts the checks

    call expect(test, repeat(face, 4), 4, 2, [repeat(face, 2), repeat(face, 2)])
    call expect(test, repeat(face, 2), 2, 2, [face, face])
    call expect(test, char(255)//'a', 4, 1, ['?a'])
    call expect(test, 'WWWW', 4, 2, ['WW', 'WW'])
  end subroutine other_letters

  subroutine expect(test, title, room, most, expected)
    type(tester_type), intent(inout) :: test      !< counts the checks
    character(len=*), intent(in) :: title         !< the title
    character(len=*), intent(in) :: expected(:)   !< the right lines
    integer, intent(in) :: room                   !< letters in a line
    integer, intent(in) :: most                   !< lines at most
    type(string_type), allocatable :: lines(:)
    integer :: i

    lines = title_lines(title, room, most)
    call test%is_true(size(lines) == size(expected), 'the number of lines is right for the title '//title)
    if (size(lines) /= size(expected)) return
    do i = 1, size(lines)
      call test%is_true(lines(i)%text == trim(expected(i)), 'each line is right of the title '//title//': '//lines(i)%text)
    end do
  end subroutine expect
end module test_title_lines
