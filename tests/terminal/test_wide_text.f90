!> Tests of text as bytes and as code points: encodings from the tables of Unicode, and there and back.
module test_wide_text
  use mech9_wide_text, only: to_wide, to_bytes, code_point, unknown_character
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_known')) call test_known(tester)
    if (tester%runs('test_round_trip')) call test_round_trip(tester)
    if (tester%runs('test_no_text')) call test_no_text(tester)
  end subroutine run

  !> One character of each length, and the first and the last of each.
  subroutine test_known(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call one(tester, [65], 65, 'A')
    call one(tester, [195, 169], int(z'E9'), 'e with an acute')
    call one(tester, [228, 184, 173], int(z'4E2D'), 'the middle')
    call one(tester, [240, 159, 166, 128], int(z'1F980'), 'a crab')
    call one(tester, [194, 128], int(z'80'), 'the first of two bytes')
    call one(tester, [223, 191], int(z'7FF'), 'the last of two bytes')
    call one(tester, [224, 160, 128], int(z'800'), 'the first of three bytes')
    call one(tester, [239, 191, 191], int(z'FFFF'), 'the last of three bytes')
    call one(tester, [240, 144, 128, 128], int(z'10000'), 'the first of four bytes')
    call one(tester, [244, 143, 191, 191], int(z'10FFFF'), 'the last of all')
  end subroutine test_known

  subroutine one(tester, bytes, point, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, intent(in) :: bytes(:)              !< of one character in UTF-8
    integer, intent(in) :: point                 !< its code point
    character(len=*), intent(in) :: why          !< the statement that is checked, printed where it is wrong
    character(len=size(bytes)) :: text
    integer :: i

    do i = 1, size(bytes)
      text(i:i) = char(bytes(i))
    end do
    call tester%is_true(code_point(text) == point, why//': the number of the character is right')
    call tester%is_true(to_bytes([point]) == text, why//': the bytes of the character are right')
  end subroutine one

  !> Every code point, but for the halves of pairs, which are no characters.
  subroutine test_round_trip(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: point, wrong

    wrong = 0
    do point = 1, int(z'10FFFF')
      if (point >= int(z'D800') .and. point <= int(z'DFFF')) cycle
      if (code_point(to_bytes([point])) /= point) wrong = wrong + 1
    end do
    call tester%is_true(wrong == 0, 'every character comes back from its bytes')
  end subroutine test_round_trip

  subroutine test_no_text(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, allocatable :: points(:)

    points = to_wide('a'//char(255)//'b'//char(195))
    call tester%is_true(size(points) == 5 .and. all(points(:4) == [97, unknown_character, 98, unknown_character]), &
                        'each byte that is no text becomes one unknown character')
    call tester%is_true(points(5) == 0, 'a zero ends the text, as C wants it')
    call tester%is_true(size(to_wide('')) == 1, 'an empty text is a zero alone')
    call tester%is_true(code_point('') == unknown_character, 'an empty text holds no character')
  end subroutine test_no_text
end module test_wide_text
