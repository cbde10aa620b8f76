!> The files by which Dakota asks for one evaluation of a model, and gets its answer.
!>
!> The parameters file has its standard form, in which each line is a value and a tag, or that of APREPRO, `{ tag =
!> value }`. It lists the variables, the active set vector, and the variables of the derivatives, each list with its
!> length before it. See "Parameters file format" and "Results file format" in the manual of Dakota.
module mech9_dakota_file
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_data
  use mech9_text, only: string_type, to_text, lower
  use mech9_counted, only: counted
  use mech9_source, only: source_type, read_source
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_printable, only: printable
  use mech9_number_format, only: number_format_type, number_width
  use mech9_text_file, only: replace_text
  implicit none
  private
  public :: dakota_request_type, read_dakota, write_dakota_failure, write_dakota_results

  !> One evaluation that Dakota asks for.
  type :: dakota_request_type
    type(string_type), allocatable :: variables(:)    !< their descriptors
    real(wp), allocatable :: values(:)                !< (variables)
    type(string_type), allocatable :: responses(:)    !< their descriptors
    integer, allocatable :: active(:)                 !< (responses) sum of 1 for the value, 2 for the gradient, 4 for the Hessian
    integer, allocatable :: by(:)                     !< numbers of the variables by which gradients are taken
  contains
    procedure :: wants
  end type dakota_request_type

  character, parameter :: line_end = achar(10), tab = achar(9)
  integer, parameter :: most_entries = 100000   !< of a list; a larger length is a mistake

contains

  !> Whether a value (1), gradient (2) or Hessian (4) of a response is asked for.
  pure elemental logical function asks_for(active, what)
    integer, intent(in) :: active   !< of the response
    integer, intent(in) :: what     !< 1, 2 or 4

    asks_for = iand(active, what) /= 0
  end function asks_for

  !> Whether values (1), gradients (2) or Hessians (4) of any response are asked for.
  pure logical function wants(self, what)
    class(dakota_request_type), intent(in) :: self   !< the request
    integer, intent(in) :: what                      !< 1, 2 or 4

    wants = any(asks_for(self%active, what))
  end function wants

  !> Read a parameters file. Errors name it with the line.
  subroutine read_dakota(path, request, err)
    character(len=*), intent(in) :: path                !< of the parameters file
    type(dakota_request_type), intent(out) :: request   !< the evaluation
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(source_type) :: source
    type(string_type), allocatable :: tags(:)
    real(wp), allocatable :: numbers(:)
    integer :: line

    call read_source(path, source, err)
    call add_place(err, printable(path))
    if (allocated(err)) return
    line = 1
    call read_list(source, line, ['variables  ', 'dakota_vars'], request%values, request%variables, err)
    if (.not. allocated(err)) call read_list(source, line, ['functions ', 'dakota_fns'], numbers, tags, err)
    if (.not. allocated(err)) call take_responses(source, line, numbers, tags, request, err)
    if (.not. allocated(err)) call read_list(source, line, ['derivative_variables', 'dakota_der_vars     '], numbers, tags, err)
    if (.not. allocated(err)) call take_derivatives(source, line, numbers, request, err)
  end subroutine read_dakota

  !> Read a list: a line with its length, and a line for each entry.
  subroutine read_list(source, line, names, numbers, tags, err)
    type(source_type), intent(in) :: source                      !< the parameters file
    integer, intent(inout) :: line                               !< to be read next
    character(len=*), intent(in) :: names(2)                     !< tag of the length, in each of the two forms
    real(wp), allocatable, intent(out) :: numbers(:)             !< (entries)
    type(string_type), allocatable, intent(out) :: tags(:)       !< (entries)
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    character(len=:), allocatable :: tag
    real(wp) :: length
    integer :: i

    call read_entry(source, line, length, tag, err)
    if (.not. allocated(err) .and. all(names /= lower(tag))) &
      call fail_at(source, line - 1, "the number of "//trim(names(1))//" is expected here, and not '"//printable(tag)//"'", err)
    if (.not. allocated(err) .and. .not. (length >= 0.0_wp .and. length <= most_entries)) &
      call fail_at(source, line - 1, 'this is no length of a list', err)
    if (allocated(err)) return
    allocate (numbers(nint(length)), tags(nint(length)))
    do i = 1, size(numbers)
      call read_entry(source, line, numbers(i), tags(i)%text, err)
      if (allocated(err)) return
    end do
  end subroutine read_list

  !> Read a line with a number and a tag.
  subroutine read_entry(source, line, number, tag, err)
    type(source_type), intent(in) :: source                  !< the parameters file
    integer, intent(inout) :: line                           !< to be read; afterwards the next one
    real(wp), intent(out) :: number                          !< its number
    character(len=:), allocatable, intent(out) :: tag        !< its tag
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    character(len=:), allocatable :: text, value
    type(numeral_type) :: numeral
    integer :: first, last, equals

    number = 0.0_wp
    tag = ''
    if (line > size(source%line_start)) then
      call fail_at(source, line - 1, 'the file ends before its lists of variables, functions and derivative variables do', err)
      return
    end if
    call source%line_bounds(line, first, last)
    line = line + 1
    text = without_tabs(source%text(first:last))
    if (text(1:min(1, len(text))) == '{') then
      equals = index(text, '=')
      if (equals > 1) tag = trim(adjustl(text(2:equals - 1)))
      value = trim(adjustl(text(equals + 1:)))
      if (value(max(1, len(value)):) == '}') value = trim(value(:len(value) - 1))
    else
      equals = index(text, ' ', back=.true.)
      tag = text(equals + 1:)
      value = trim(text(:equals))
    end if
    call read_numeral(value, numeral)
    if (tag == '' .or. value == '') then
      call fail_at(source, line - 1, 'a value and a tag are expected, as in "0.3 crank" or "{ crank = 0.3 }"', err)
    else if (allocated(numeral%problem)) then
      call fail_at(source, line - 1, "'"//printable(value)//"' "//numeral%problem, err)
    else
      number = numeral%number
    end if
  end subroutine read_entry

  !> A line with blanks in place of tabs and ends of lines, without those around it.
  pure function without_tabs(line) result(text)
    character(len=*), intent(in) :: line   !< as it is read
    character(len=:), allocatable :: text
    integer :: i

    text = line
    do i = 1, len(text)
      if (scan(text(i:i), tab//line_end//achar(13)) > 0) text(i:i) = ' '
    end do
    text = trim(adjustl(text))
  end function without_tabs

  !> Take what is asked of each response, and its descriptor, which stands behind a colon: `ASV_1:stroke`.
  subroutine take_responses(source, line, numbers, tags, request, err)
    type(source_type), intent(in) :: source               !< the parameters file
    integer, intent(in) :: line                           !< behind the list
    real(wp), intent(in) :: numbers(:)                    !< (responses)
    type(string_type), intent(in) :: tags(:)              !< (responses)
    type(dakota_request_type), intent(inout) :: request   !< gets the responses
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: i

    allocate (request%active(size(tags)), request%responses(size(tags)))
    do i = 1, size(tags)
      if (.not. any(abs(numbers(i) - [0, 1, 2, 3, 4, 5, 6, 7]) <= 0.0_wp)) then
        call fail_at(source, line - 1 - size(tags) + i, 'the active set vector has numbers from 0 to 7', err)
        return
      end if
      request%active(i) = nint(numbers(i))
      request%responses(i)%text = tags(i)%text(index(tags(i)%text, ':') + 1:)
    end do
  end subroutine take_responses

  !> Take the variables by which gradients are asked for.
  subroutine take_derivatives(source, line, numbers, request, err)
    type(source_type), intent(in) :: source               !< the parameters file
    integer, intent(in) :: line                           !< behind the list
    real(wp), intent(in) :: numbers(:)                    !< (derivative variables) their numbers among the variables
    type(dakota_request_type), intent(inout) :: request   !< gets these numbers
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    integer :: i

    do i = 1, size(numbers)
      if (numbers(i) >= 1.0_wp .and. numbers(i) <= size(request%variables) .and. &
          abs(numbers(i) - anint(numbers(i))) <= 0.0_wp) cycle
      call fail_at(source, line - 1 - size(numbers) + i, trim(merge('there is ', 'there are', size(request%variables) == 1))// &
                   ' '//counted(size(request%variables), 'variable')//', and this is the number of none', err)
      return
    end do
    request%by = nint(numbers)
  end subroutine take_derivatives

  !> Fail at a line of the parameters file.
  pure subroutine fail_at(source, line, message, err)
    type(source_type), intent(in) :: source              !< the parameters file
    integer, intent(in) :: line                          !< its line
    character(len=*), intent(in) :: message              !< of the failure
    type(error_type), allocatable, intent(out) :: err    !< the failure

    call raise(err, exit_data, printable(source%name)//':'//to_text(line)//': '//message)
  end subroutine fail_at

  !> Write a results file that tells Dakota that the evaluation failed.
  subroutine write_dakota_failure(path, message, err)
    character(len=*), intent(in) :: path                !< of the results file
    character(len=*), intent(in) :: message             !< of the run that failed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it cannot be written

    call replace_text(path, 'fail '//printable(message)//line_end, err)
  end subroutine write_dakota_failure

  !> Write a results file: the values with their descriptors, then the gradients.
  subroutine write_dakota_results(path, request, numbers, gradient, err)
    character(len=*), intent(in) :: path                   !< of the results file
    type(dakota_request_type), intent(in) :: request       !< the evaluation
    real(wp), intent(in) :: numbers(:)                     !< (responses)
    real(wp), intent(in) :: gradient(:, :)                 !< (derivative variables,responses); of use where one is asked for
    type(error_type), allocatable, intent(out) :: err      !< allocated if it cannot be written
    type(number_format_type) :: format
    character(len=number_width) :: word
    character(len=:), allocatable :: text
    integer :: i, k

    format = number_format_type()
    text = ''
    do i = 1, size(numbers)
      if (.not. asks_for(request%active(i), 1)) cycle
      call format%put(numbers(i), word)
      text = text//word//' '//request%responses(i)%text//line_end
    end do
    do i = 1, size(numbers)
      if (.not. asks_for(request%active(i), 2)) cycle
      text = text//'['
      do k = 1, size(request%by)
        call format%put(gradient(k, i), word)
        text = text//word
      end do
      text = text//' ]'//line_end
    end do
    call replace_text(path, text, err)
  end subroutine write_dakota_results
end module mech9_dakota_file
