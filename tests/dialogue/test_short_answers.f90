!> Short answers become what a data file holds in full; what only looks like one stays as it is.
module test_short_answers
  use mech9_grammar, only: item_table
  use mech9_item_rows, only: item_row_for_kind
  use mech9_short_answers, only: full_form, word_meant
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('words')) call words(tester)
    if (tester%runs('directions')) call directions(tester)
    if (tester%runs('links')) call links(tester)
  end subroutine run

  !> Compare the full form of an answer with what it should be.
  subroutine becomes(tester, group, name, kind, typed, full)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: group        !< the group that is asked about
    character(len=*), intent(in) :: name         !< the item that is asked about
    character(len=*), intent(in) :: kind         !< of the group; empty: of any
    character(len=*), intent(in) :: typed        !< the short answer
    character(len=*), intent(in) :: full         !< text that a data file should hold

    call tester%is_true(full_form(item_table(item_row_for_kind(group, name, kind)), typed) == full, &
                        group//' '//name//': '//typed//' is '//full)
  end subroutine becomes

  !> The beginning of one word is that word; of several or of none, it stays.
  subroutine words(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call becomes(tester, 'pair', 'kind', '', 'rev', 'revolute')
    call becomes(tester, 'pair', 'kind', '', 'P', 'prismatic')
    call becomes(tester, 'pair', 'kind', '', 'pa', 'path')
    call becomes(tester, 'pair', 'kind', '', 'Wire', 'path')
    call becomes(tester, 'pair', 'kind', '', 'hinge', 'revolute')
    call becomes(tester, 'pair', 'kind', '', 'Slider', 'prismatic')
    call becomes(tester, 'pair', 'kind', '', 'screw', 'helical')
    call becomes(tester, 'drive', 'kind', '', 'hinge', 'hinge')
    call becomes(tester, 'pair', 'kind', '', 'revolutte', 'revolutte')
    call becomes(tester, 'pair', 'kind', '', 'x', 'x')
    call becomes(tester, 'solver', 'method', '', 'v', 'verner')
    call becomes(tester, 'mechanism', 'title', '', 'rev', 'rev')
    call tester%is_true(word_meant('ma', [character(len=6) :: 'mass', 'matrix']) == '', &
                        'the common beginning of two words means neither')
    call tester%is_true(word_meant('mass', [character(len=7) :: 'masses', 'mass']) == 'mass', &
                        'a word that begins another one means itself')
  end subroutine words

  subroutine directions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call becomes(tester, 'pair', 'axis', 'revolute', 'z', '0, 0, 1')
    call becomes(tester, 'pair', 'axis', 'prismatic', '-X', '-1, 0, 0')
    call becomes(tester, 'pair', 'moving_zero', 'revolute', '+y', '0, 1, 0')
    call becomes(tester, 'pair', 'axis', 'revolute', 'xy', 'xy')
    call becomes(tester, 'pair', 'axis', 'revolute', 'x y z', 'x y z')
    call becomes(tester, 'pair', 'point', 'revolute', 'z', 'z')
    call becomes(tester, 'gravity', 'acceleration', '', '-y', '0, -9.81, 0')
    call becomes(tester, 'gravity', 'acceleration', '', 'none', '0, 0, 0')
    call becomes(tester, 'load', 'force', 'force', '-y', '-y')
  end subroutine directions

  subroutine links(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call becomes(tester, 'pair', 'links', '', '1-2', '1, 2')
    call becomes(tester, 'load', 'links', 'spring', '10 - 12', '10, 12')
    call becomes(tester, 'pair', 'links', '', '1 -2', '1, 2')
    call becomes(tester, 'pair', 'links', '', '-2', '-2')
    call becomes(tester, 'pair', 'links', '', '1-', '1-')
    call becomes(tester, 'pair', 'links', '', '1-2-3', '1-2-3')
    call becomes(tester, 'pair', 'links', '', '1 2', '1 2')
    call becomes(tester, 'time', 'end', '', '1-2', '1-2')
  end subroutine links
end module test_short_answers
