!> A text file with some numbers in each line.
module mech9_number_file
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_source, only: source_type, span_type, read_source
  use mech9_diagnostics, only: diagnostics_type, printable
  implicit none
  private
  public :: number_file_type, read_number_file

  !> Characters between numbers.
  character(len=*), parameter :: gaps = ' ,;'//achar(9)//achar(13)//achar(10)

  !> The lines of a file that have numbers.
  type :: number_file_type
    integer :: source = 0                      !< number of the file as a source, for spans
    real(wp), allocatable :: numbers(:, :)     !< (widest,lines) the first numbers of each line
    integer, allocatable :: counts(:)          !< (lines) how many numbers each line has
    type(span_type), allocatable :: spans(:)   !< (lines) places of these lines
  end type number_file_type

contains

  !> Read the numbers of a file. A # begins a comment. Words that are no numbers are reported, and their lines are left out.
  subroutine read_number_file(path, widest, lines, diagnostics, err)
    character(len=*), intent(in) :: path                  !< of the file
    integer, intent(in) :: widest                         !< how many numbers of a line are kept
    type(number_file_type), intent(out) :: lines          !< the lines that have numbers
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(error_type), allocatable, intent(out) :: err     !< allocated if the file cannot be read
    type(source_type) :: source
    integer :: line, first, last, n, count
    logical :: is_good

    call read_source(path, source, err)
    if (allocated(err)) return
    call diagnostics%add_source(source, lines%source)
    associate (most => size(source%line_start))
      allocate (lines%numbers(widest, most), lines%counts(most), lines%spans(most))
    end associate
    n = 0
    do line = 1, size(source%line_start)
      call source%line_bounds(line, first, last)
      if (index(source%text(first:last), '#') > 0) last = first + index(source%text(first:last), '#') - 2
      call read_line(source%text, span_type(lines%source, first, last), lines%numbers(:, n + 1), count, diagnostics, is_good)
      if (count == 0 .or. .not. is_good) cycle
      n = n + 1
      lines%counts(n) = count
      lines%spans(n) = span_type(lines%source, first, max(first, last))
    end do
    lines%numbers = lines%numbers(:, :n)
    lines%counts = lines%counts(:n)
    lines%spans = lines%spans(:n)
  end subroutine read_number_file

  !> Read the numbers of a line.
  pure subroutine read_line(text, line, numbers, count, diagnostics, is_good)
    character(len=*), intent(in) :: text                  !< of the file
    type(span_type), intent(in) :: line                   !< place of the line, without its comment
    real(wp), intent(inout) :: numbers(:)                 !< gets the first ones
    integer, intent(out) :: count                         !< how many there are
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the error
    logical, intent(out) :: is_good                       !< all of them are numbers
    type(numeral_type) :: numeral
    integer :: at, length

    is_good = .false.
    count = 0
    at = line%first
    do while (at <= line%last)
      length = verify(text(at:line%last), gaps)
      if (length == 0) exit
      at = at + length - 1
      length = scan(text(at:line%last)//' ', gaps) - 1
      count = count + 1
      call read_numeral(text(at:at + length - 1), numeral)
      if (allocated(numeral%problem)) then
        call diagnostics%add(span_type(line%source, at, at + length - 1), &
                             ''''//printable(text(at:at + length - 1))//''' '//numeral%problem)
        return
      end if
      if (count <= size(numbers)) numbers(count) = numeral%number
      at = at + length
    end do
    is_good = .true.
  end subroutine read_line
end module mech9_number_file
