!> Text for people, in lines that fit a terminal of 80 columns.
module mech9_paragraph
  implicit none
  private
  public :: print_paragraph

  integer, parameter :: line_width = 79

contains

  !> Print a text from a column on, broken at blanks. Line ends within the text are kept.
  subroutine print_paragraph(unit, text, indent)
    integer, intent(in) :: unit           !< number of the output unit
    character(len=*), intent(in) :: text  !< words with blanks between, any number of lines
    integer, intent(in) :: indent         !< number of columns left free
    integer :: first, line_end, last, cut

    first = 1
    do while (first <= len(text))
      line_end = first + index(text(first:)//achar(10), achar(10)) - 2
      last = line_end
      if (last - first + 1 > line_width - indent) then
        cut = index(text(first:first + line_width - indent), ' ', back=.true.)
        last = first + line_width - indent - 1
        if (cut > 1) last = first + cut - 2
      end if
      write (unit, '(2a)') repeat(' ', indent), text(first:last)
      first = last + 1
      if (first > line_end) then
        first = line_end + 2
      else if (text(first:first) == ' ') then
        first = first + 1
      end if
    end do
  end subroutine print_paragraph
end module mech9_paragraph
