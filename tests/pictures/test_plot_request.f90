!> Tests of mech9_plot_request and mech9_plot_panels: what the words of --plot mean, by the rules in docs/how-to/pictures.md.
module test_plot_request
  use mech9_error, only: error_type, exit_usage
  use mech9_text, only: string_type
  use mech9_plot_request, only: plot_request_type, read_plot_request
  use mech9_plot_panels, only: panels_of, axis_label
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_curves')) call test_curves(tester)
    if (tester%runs('test_targets')) call test_targets(tester)
    if (tester%runs('test_refusals')) call test_refusals(tester)
    if (tester%runs('test_panels')) call test_panels(tester)
  end subroutine run

  !> Columns: 1 t, 2 q1, 3 q2, 4 dq1, 5 P.x, 6 P.y, 7 a,b.x, 8 a, 9 a:P.x, 10 q12.x, 11 closure
  subroutine set_columns(names, units)
    type(string_type), allocatable, intent(out) :: names(:)   !< of the columns
    type(string_type), allocatable, intent(out) :: units(:)   !< of the columns
    character(len=8), parameter :: columns(2, 11) = reshape([character(len=8) :: &
      't', 's', 'q1', 'rad', 'q2', 'm', 'dq1', 'rad/s', 'P.x', 'm', 'P.y', 'm', 'a,b.x', 'm', 'a', 'm', &
      'a:P.x', 'm', 'q12.x', 'm', 'closure', 'm'], [2, 11])
    integer :: i

    allocate (names(size(columns, 2)), units(size(columns, 2)))
    do i = 1, size(names)
      names(i)%text = trim(columns(1, i))
      units(i)%text = trim(columns(2, i))
    end do
  end subroutine set_columns

  subroutine read_text(text, request, err)
    character(len=*), intent(in) :: text                !< argument of --plot
    type(plot_request_type), intent(out) :: request     !< read from it
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(string_type), allocatable :: names(:), units(:)

    call set_columns(names, units)
    call read_plot_request(text, names, request, err)
  end subroutine read_text

  subroutine check_curves(tester, text, x, y)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< argument of --plot
    integer, intent(in) :: x(:)                  !< right columns along the first axis
    integer, intent(in) :: y(:)                  !< right columns along the second axis
    type(plot_request_type) :: request
    type(error_type), allocatable :: err

    call read_text(text, request, err)
    call tester%no_error(err, text//': the request is accepted')
    if (allocated(err)) return
    call tester%is_true(size(request%curves) == size(x), text//': the number of curves is right')
    if (size(request%curves) /= size(x)) return
    call tester%is_true(all(request%curves%x == x) .and. all(request%curves%y == y), text//': the columns of the curves are right')
  end subroutine check_curves

  subroutine test_curves(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call check_curves(tester, 'q1', [1], [2])
    call check_curves(tester, 'q1,P.x', [1, 1], [2, 5])
    call check_curves(tester, 'P.x:P.y', [5], [6])
    call check_curves(tester, 'q1,P.x:P.y,t:dq1', [1, 5, 1], [2, 6, 4])
    ! the names behind a pair are drawn over its first column, too
    call check_curves(tester, 'q1:P.x,P.y', [2, 2], [5, 6])
    call check_curves(tester, 'q2,q1:P.x,P.y,t:dq1,q2', [1, 2, 2, 1, 1], [3, 5, 6, 4, 3])
    call check_curves(tester, ' q1 , P.x : P.y ', [1, 5], [2, 6])
    call check_curves(tester, 'q1:q1', [2], [2])
    ! a point may be named so that its columns hold a comma or a colon
    call check_curves(tester, 'a,b.x', [1], [7])
    call check_curves(tester, 'a,q1', [1, 1], [8, 2])
    call check_curves(tester, 'a:P.x', [1], [9])
    call check_curves(tester, 'a : P.x', [8], [5])
  end subroutine test_curves

  subroutine test_targets(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(plot_request_type) :: request
    type(error_type), allocatable :: err

    call check_curves(tester, 'term', [1, 1], [2, 3])
    call check_curves(tester, 'term:', [1, 1], [2, 3])
    call check_curves(tester, 'some where/a:b.PNG:P.x', [1], [5])
    call check_curves(tester, 'a.svg', [1, 1], [2, 3])
    call read_text('a:b.svg:q1', request, err)
    call tester%is_true(request%target == 'a:b.svg' .and. .not. request%in_terminal, 'a name of a file may hold a colon')
    call read_text('x.pdf', request, err)
    call tester%is_true(request%target == 'x.pdf', 'a picture may be asked for without names of columns')
    call read_text('term:q1', request, err)
    call tester%is_true(request%in_terminal .and. request%target == '', 'the terminal may be asked for')
    call read_text('q1', request, err)
    call tester%is_true(.not. request%in_terminal .and. request%target == '', 'a request without a target names none')
  end subroutine test_targets

  subroutine test_refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call check_refusal(tester, 'q3', "did you mean 'q1'?")
    call check_refusal(tester, 'p.x', "did you mean 'P.x'?")
    call check_refusal(tester, 'P.x:P.w', "did you mean 'P.x'?")
    call check_refusal(tester, 'nonsense', 'the columns are t q1 q2 dq1 P.x')
    call check_refusal(tester, 'q1,', 'a name of a column is missing')
    call check_refusal(tester, ',q1', 'a name of a column is missing')
    call check_refusal(tester, 'q1:', 'a name of a column is missing')
    call check_refusal(tester, ' ', 'a name of a column is missing')
    call check_refusal(tester, 'q1 q2', "a comma is missing before 'q2'")
    call check_refusal(tester, 'P.x:P.y:q1', "a comma is missing before ':q1'")
    call check_refusal(tester, 'a.gif:q1', "named 'a.gif'")
  end subroutine test_refusals

  subroutine check_refusal(tester, text, words)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< argument of --plot
    character(len=*), intent(in) :: words        !< of the message
    type(plot_request_type) :: request
    type(error_type), allocatable :: err

    call read_text(text, request, err)
    call tester%has_error(err, exit_usage, text//': the request is refused')
    if (allocated(err)) call tester%is_true(index(err%message, words) > 0, text//': the message is: '//err%message)
  end subroutine check_refusal

  subroutine test_panels(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type), allocatable :: names(:), units(:)
    type(plot_request_type) :: request
    type(error_type), allocatable :: err

    call set_columns(names, units)
    call read_plot_request('q1,q2,P.x,dq1,P.x:P.y,a:q12.x,t:closure', names, request, err)
    call tester%is_true(all(panels_of(request%curves, names, units) == [1, 2, 2, 3, 4, 4, 5]), &
                        'equal units share a panel, over time and over a column; the closure stands alone')
    call tester%is_true(axis_label([2], names, units) == 'q1 [rad]', 'the label of one column is its name and unit')
    call tester%is_true(axis_label([3, 5], names, units) == 'position [m]', 'the label of several columns tells their quantity')
    units(4)%text = 'deg/s^2'
    call tester%is_true(axis_label([4], names, units) == 'dq1 [deg/s'//char(194)//char(178)//']', &
                        'a unit with a square has a raised two')
    units(4)%text = '1'
    call tester%is_true(axis_label([4], names, units) == 'dq1', 'a plain number has no unit')
  end subroutine test_panels
end module test_plot_request
