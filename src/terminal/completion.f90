!> Completion of a typed word: which words begin with it, and the longest beginning that they have in common.
module mech9_completion
  use mech9_text, only: string_type, starts_with
  implicit none
  private
  public :: find_completions, beginning_of_word, completions, common_beginning, in_columns

  !> The characters between words at a prompt.
  character(len=*), parameter :: quotes = achar(39)//achar(34), separators = ' ,='//achar(9)//quotes
  !> The characters between names in a formula.
  character(len=*), parameter :: operators = '(+-*/^'

contains

  !> Find what can follow the text before the cursor: the words that begin as its end does, how much of them is typed, and what
  !> stands behind a word that is complete. Within a formula a name begins behind its last operator.
  pure subroutine find_completions(text, words, found, typed, ending)
    character(len=*), intent(in) :: text                     !< the line up to the cursor
    type(string_type), intent(in) :: words(:)                !< the words offered
    type(string_type), allocatable, intent(out) :: found(:)  !< those that fit, in their order
    integer, intent(out) :: typed                            !< letters of them that stand before the cursor
    character, intent(out) :: ending                         !< a blank, or the quote that stands before the word
    character(len=:), allocatable :: beginning
    integer :: before

    beginning = beginning_of_word(text)
    call completions(words, beginning, found)
    if (size(found) == 0 .and. scan(beginning, operators) > 0) then
      beginning = beginning(scan(beginning, operators, back=.true.) + 1:)
      call completions(words, beginning, found)
    end if
    typed = len(beginning)
    ending = ' '
    before = len(text) - typed
    if (before < 1) return
    if (scan(text(before:before), quotes) == 1) ending = text(before:before)
  end subroutine find_completions

  !> The word being typed at the end of a text; empty where none is.
  pure function beginning_of_word(text) result(beginning)
    character(len=*), intent(in) :: text  !< the line up to the cursor
    character(len=:), allocatable :: beginning

    beginning = text(scan(text, separators, back=.true.) + 1:)
  end function beginning_of_word

  !> List the words with the same beginning, in their order.
  pure subroutine completions(words, beginning, found)
    type(string_type), intent(in) :: words(:)                !< the words offered
    character(len=*), intent(in) :: beginning                !< the beginning of the word that is typed
    type(string_type), allocatable, intent(out) :: found(:)  !< those that begin with it, in their order
    integer :: i, n

    n = 0
    do i = 1, size(words)
      if (starts_with(words(i)%text, beginning)) n = n + 1
    end do
    allocate (found(n))
    n = 0
    do i = 1, size(words)
      if (.not. starts_with(words(i)%text, beginning)) cycle
      n = n + 1
      found(n)%text = words(i)%text
    end do
  end subroutine completions

  !> The longest text with which all of the words begin; empty where there are none.
  pure function common_beginning(words) result(text)
    type(string_type), intent(in) :: words(:)  !< the words offered
    character(len=:), allocatable :: text
    integer :: i, n

    text = ''
    if (size(words) == 0) return
    text = words(1)%text
    do i = 2, size(words)
      n = min(len(text), len(words(i)%text))
      do while (n > 0)
        if (text(:n) == words(i)%text(:n)) exit
        n = n - 1
      end do
      text = text(:n)
    end do
  end function common_beginning

  !> The words side by side in columns, as whole lines.
  pure function in_columns(words, width) result(text)
    type(string_type), intent(in) :: words(:)  !< the words offered
    integer, intent(in) :: width               !< letters in a line
    character(len=:), allocatable :: text
    integer :: i, column, columns

    column = 2
    do i = 1, size(words)
      column = max(column, len(words(i)%text) + 2)
    end do
    columns = max(1, width/column)
    text = ''
    do i = 1, size(words)
      text = text//words(i)%text
      if (mod(i, columns) == 0 .or. i == size(words)) then
        text = text//achar(10)
      else
        text = text//repeat(' ', column - len(words(i)%text))
      end if
    end do
  end function in_columns
end module mech9_completion
