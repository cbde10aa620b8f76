!> Numbers of errors, short waits, the size of the terminal, and whether a descriptor is one.
module test_system_calls
  use mech9_kinds, only: wp
  use mech9_clock, only: seconds
  use mech9_pause, only: pause_for
  use mech9_system, only: is_terminal, standard_output
  use mech9_system_error, only: error_number, clear_error_number, reason, no_such_file
  use mech9_terminal_size, only: find_terminal_size
  use mech9_same_file, only: same_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('errors')) call errors(tester)
    if (tester%runs('waits')) call waits(tester)
    if (tester%runs('terminal')) call terminal(tester)
  end subroutine run

  subroutine errors(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    logical :: same

    call clear_error_number()
    call tester%is_true(error_number() == 0, 'no error after it is cleared')
    same = same_file('there_is_no_such_folder/a', 'there_is_no_such_folder/b')
    call tester%is_true(.not. same, 'there are no such files')
    call tester%is_true(error_number() == no_such_file, 'a call that failed leaves its number')
    call tester%is_true(reason(no_such_file) == 'No such file or directory', 'its words: '//reason(no_such_file))
    call tester%is_true(index(reason(123456), '123456') > 0, 'a number without words is told: '//reason(123456))
  end subroutine errors

  !> A wait is not shorter than asked for; no signal comes here.
  subroutine waits(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp) :: before

    before = seconds()
    call pause_for(0.02_wp)
    ! the clock has a resolution of a nanosecond, and its differences are rounded
    call tester%is_true(seconds() - before > 0.0199_wp, 'a wait of 20 ms')
  end subroutine waits

  subroutine terminal(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: columns, rows

    call find_terminal_size(columns, rows)
    if (is_terminal(standard_output)) then
      call tester%is_true(columns >= 40 .and. rows >= 12, 'a terminal has at least 40 columns and 12 lines')
    else
      call tester%is_true(columns == 79 .and. rows == 23, 'without terminal there are 79 columns and 23 lines')
    end if
  end subroutine terminal
end module test_system_calls
