!> Tests of completion: words that fit, what they have in common, the list of them.
module test_completion
  use mech9_text, only: string_type
  use mech9_completion, only: find_completions, beginning_of_word, completions, common_beginning, in_columns
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_beginning')) call test_beginning(tester)
    if (tester%runs('test_completions')) call test_completions(tester)
    if (tester%runs('test_formulas')) call test_formulas(tester)
    if (tester%runs('test_columns')) call test_columns(tester)
  end subroutine run

  subroutine test_beginning(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(beginning_of_word('') == '', 'no word begins where nothing is typed')
    call tester%is_true(beginning_of_word('rev') == 'rev', 'the first word is begun')
    call tester%is_true(beginning_of_word('a bc') == 'bc', 'a second word is begun')
    call tester%is_true(len(beginning_of_word('a ')) == 0, 'no word begins behind a blank')
    call tester%is_true(beginning_of_word('kind=''re') == 're', 'a word begins behind a quote')
    call tester%is_true(beginning_of_word('q1,q2') == 'q2', 'a word begins behind a comma')
  end subroutine test_beginning

  subroutine test_completions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: words(4)
    type(string_type), allocatable :: found(:)

    words(1)%text = 'prismatic'
    words(2)%text = 'prism'
    words(3)%text = 'revolute'
    words(4)%text = 'point'
    call completions(words, 'p', found)
    call tester%is_true(size(found) == 3, 'three words begin with p')
    call tester%is_true(common_beginning(found) == 'p', 'the three words have one letter in common')
    call completions(words, 'pr', found)
    call tester%is_true(common_beginning(found) == 'prism', 'two words have five letters in common')
    call completions(words, 'r', found)
    call tester%is_true(common_beginning(found) == 'revolute', 'the one word that is left is meant')
    call completions(words, 'revolutes', found)
    call tester%is_true(size(found) == 0 .and. len(common_beginning(found)) == 0, 'no word begins with more than itself')
    call completions(words, '', found)
    call tester%is_true(size(found) == 4 .and. len(common_beginning(found)) == 0, 'all words begin with nothing')
  end subroutine test_completions

  !> Names in formulas, in numbers that a parameter sets, and within quotes.
  subroutine test_formulas(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: words(3)

    words(1)%text = 'diagonal'
    words(2)%text = 'pair(B).point(1)'
    words(3)%text = 'pair(B).axis(1)'
    call expect('sqrt(2*di', 1, 2, ' ')
    call expect('2^', 3, 0, ' ')
    call expect('pair(B).p', 1, 9, ' ')
    call expect('a=pair(', 2, 5, ' ')
    call expect('links = 1, ''di', 1, 2, '''')
    call expect('links = "di', 1, 2, '"')
    call expect('sqrt(x', 0, 1, ' ')
  contains
    !> Expect words that fit a text.
    subroutine expect(text, count, letters, end)
      character(len=*), intent(in) :: text   !< before the cursor
      integer, intent(in) :: count           !< how many words fit
      integer, intent(in) :: letters         !< of a word that are typed
      character, intent(in) :: end           !< behind a whole word
      type(string_type), allocatable :: found(:)
      character :: ending
      integer :: typed

      call find_completions(text, words, found, typed, ending)
      call tester%is_true(size(found) == count .and. typed == letters .and. ending == end, 'names that fit '//text)
    end subroutine expect
  end subroutine test_formulas

  subroutine test_columns(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: words(3)
    character, parameter :: eol = achar(10)

    words(1)%text = 'a'
    words(2)%text = 'bcd'
    words(3)%text = 'ef'
    call tester%is_true(in_columns(words, 79) == 'a    bcd  ef'//eol, 'short words stand in one line')
    call tester%is_true(in_columns(words, 12) == 'a    bcd'//eol//'ef'//eol, 'two words stand in a line with room for two')
    call tester%is_true(in_columns(words, 3) == 'a'//eol//'bcd'//eol//'ef'//eol, 'a word wider than the line stands alone')
  end subroutine test_columns
end module test_completion
