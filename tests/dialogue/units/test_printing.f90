!> Text of a conversation: paragraphs that fit the terminal, and structures as chains of links and pairs.
module test_printing
  use mech9_program_kind, only: dynamics
  use mech9_model, only: model_type
  use mech9_paragraph, only: print_paragraph
  use mech9_structure_sketch, only: print_sketch
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_test_files, only: text_of_unit
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_printing.txt'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('paragraphs')) call paragraphs(tester)
    if (tester%runs('own_lines')) call own_lines(tester)
    if (tester%runs('sketches')) call sketches(tester)
  end subroutine run

  subroutine printed(tester, words, indent, text)
    type(tester_type), intent(inout) :: tester             !< counts the checks
    character(len=*), intent(in) :: words                  !< of the paragraph
    integer, intent(in) :: indent                          !< columns left free
    character(len=:), allocatable, intent(out) :: text     !< its lines
    integer :: unit

    open (newunit=unit, file=path)
    call print_paragraph(unit, words, indent)
    call text_of_unit(tester, unit, text)
  end subroutine printed

  !> No line is longer than 79 letters, none could take the next word, and no word is lost.
  subroutine paragraphs(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: words, text, joined, line
    integer :: indent, i, first, last
    logical :: fits

    words = 'one'
    do i = 2, 120
      words = words//' '//repeat(achar(97 + mod(i, 26)), 1 + mod(7*i, 11))
    end do
    do indent = 0, 12, 4
      call printed(tester, words, indent, text)
      joined = ''
      fits = .true.
      first = 1
      do while (first <= len(text))
        last = first + index(text(first:), eol) - 2
        line = text(first:last)
        fits = fits .and. len(line) <= 79 .and. line(:indent) == repeat(' ', indent)
        if (joined /= '') joined = joined//' '
        joined = joined//line(indent + 1:)
        first = last + 2
      end do
      call tester%is_true(fits, 'lines fit behind their indentation')
      call tester%is_true(joined == words, 'all words are there, with one blank between')
    end do
  end subroutine paragraphs

  !> Ends of lines stay, empty lines too; a word that is too long is cut.
  subroutine own_lines(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text

    call printed(tester, 'a'//eol//eol//'b', 2, text)
    call tester%is_true(text == '  a'//eol//'  '//eol//'  b'//eol, 'lines of the text: '//text)
    call printed(tester, repeat('x', 100), 0, text)
    call tester%is_true(text == repeat('x', 79)//eol//repeat('x', 21)//eol, 'a long word: '//text)
    call printed(tester, '', 4, text)
    call tester%is_true(text == '', 'no words, no lines')
    call printed(tester, repeat('y', 79)//' z', 0, text)
    call tester%is_true(text == repeat('y', 79)//eol//'z'//eol, 'a full line: '//text)
  end subroutine own_lines

  !> The chain of a slider-crank, and its mobility by the count: 4 - 3 in a plane, 4 - 6 in space.
  subroutine sketches(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    character(len=:), allocatable :: text
    integer :: unit

    call model_from_text(tester, slider_crank, dynamics, model)
    open (newunit=unit, file=path)
    call print_sketch(unit, model%mechanism%structure, model%problem%partition)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, ' =1= ') > 0, 'the independent coordinate: '//text)
    call tester%is_true(index(text, ' -2- ') > 0 .and. index(text, ' -3- ') > 0 .and. index(text, ' -4- ') > 0, 'the others')
    call tester%is_true(index(text, '1 = 4 - 1 x 3 in a plane, -2 = 4 - 1 x 6 in space;') > 0, 'the mobility by the count')
    call tester%is_true(index(text, 'Independent now: 1.') > 0, 'the number of independent coordinates')
    call model_from_text(tester, '&mechanism links=3, coordinates=4 /'//eol//'&structure cq=1,2,3,4 /'//eol// &
      "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
      "&pair coordinates=2,3,4, links=2,3, kind='spherical' /"//eol, dynamics, model)
    open (newunit=unit, file=path)
    call print_sketch(unit, model%mechanism%structure, model%problem%partition)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, '    1 =1= 2 =2,3,4= 3  (open)'//eol) > 0, 'an open chain with a ball joint: '//text)
    call tester%is_true(index(text, 'the mobility is 4.') > 0, 'its mobility')
  end subroutine sketches
end module test_printing
