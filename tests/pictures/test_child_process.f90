!> Tests of mech9_child_process against what every Unix has: sh, true, pwd.
module test_child_process
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_child_process, only: child_outcome_type, run_child
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_codes')) call test_codes(tester)
    if (tester%runs('test_no_start')) call test_no_start(tester)
    if (tester%runs('test_words')) call test_words(tester)
    if (tester%runs('test_much_input')) call test_much_input(tester)
    if (tester%runs('test_dropped_output')) call test_dropped_output(tester)
  end subroutine run

  !> sh -c SCRIPT NAME WORD, with an input.
  subroutine run_shell(script, word, input, outcome, err, folder, drop_output)
    character(len=*), intent(in) :: script              !< of sh
    character(len=*), intent(in) :: word                !< its first argument
    character(len=*), intent(in) :: input               !< its standard input
    type(child_outcome_type), intent(out) :: outcome    !< code and words of the shell
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    character(len=*), intent(in), optional :: folder    !< in which it runs; the current one unless given
    logical, intent(in), optional :: drop_output        !< its standard output is dropped
    type(string_type) :: words(5)

    words(1)%text = 'sh'
    words(2)%text = '-c'
    words(3)%text = script
    words(4)%text = 'name'
    words(5)%text = word
    call run_child(words, input, outcome, err, folder, drop_output)
  end subroutine run_shell

  subroutine test_codes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(child_outcome_type) :: outcome
    type(error_type), allocatable :: err
    type(string_type) :: words(1)

    call run_shell('exit 3', '', '', outcome, err)
    call tester%no_error(err, 'a program that fails is no error')
    call tester%is_true(outcome%found .and. outcome%code == 3, 'the exit code of a program is told')
    call run_shell('kill -9 $$', '', '', outcome, err)
    call tester%is_true(outcome%found .and. outcome%code == 128 + 9, &
                        'a program that a signal ended has the code 128 and its number')
    call run_shell('pwd >&2', '', '', outcome, err, folder='/')
    call tester%is_true(outcome%error_output(1:1) == '/' .and. outcome%code == 0, 'a program works in the folder that is asked for')
    words(1)%text = 'true'
    call run_child(words, '', outcome, err)
    call tester%is_true(outcome%found .and. outcome%code == 0 .and. outcome%error_output == '', &
                        'a program that succeeds has the code 0 and says nothing')
    words(1)%text = 'no such program; true'
    call run_child(words, '', outcome, err)
    call tester%no_error(err, 'a program that is not there is no error')
    call tester%is_true(.not. outcome%found, 'a program that is not there is not found, and no shell reads its name')
  end subroutine test_codes

  !> A file that is there and cannot be started is an error with its name and why; a program that ends with 127 itself,
  !> as one does that misses a library, was started.
  subroutine test_no_start(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(child_outcome_type) :: outcome
    type(error_type), allocatable :: err
    type(string_type) :: words(1)
    integer :: unit

    call run_shell('echo no library >&2; exit 127', '', '', outcome, err)
    call tester%no_error(err, 'a program that ends with 127 is no error')
    call tester%is_true(outcome%found .and. outcome%code == 127, 'a program that ends with 127 was found')
    words(1)%text = './not_executable'
    open (newunit=unit, file=words(1)%text, status='replace')
    call run_child(words, '', outcome, err)
    close (unit, status='delete')
    call tester%is_true(allocated(err), 'a file that may not be executed is an error')
    if (allocated(err)) call tester%is_true(index(err%message, 'cannot start ./not_executable: Permission denied') > 0, &
                                            'the message tells why a file cannot be started: '//err%message)
  end subroutine test_no_start

  !> A word arrives as it is, whatever a shell would make of it.
  subroutine test_words(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(child_outcome_type) :: outcome
    type(error_type), allocatable :: err
    character(len=*), parameter :: hostile = '`exit 1`; $(exit 1) "''\ *'//achar(10)//'| & < > #'

    call run_shell('printf %s "$1" >&2', hostile, '', outcome, err)
    call tester%is_true(outcome%error_output == hostile, 'a word full of signs arrives as it is')
    call run_shell('printf "<%s>" "$1" >&2', '', '', outcome, err)
    call tester%is_true(outcome%error_output == '<>', 'an empty word arrives, too')
  end subroutine test_words

  !> More than a pipe holds goes in, and more than a pipe holds is said: nothing blocks.
  subroutine test_much_input(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(child_outcome_type) :: outcome
    type(error_type), allocatable :: err

    call run_shell('cat >&2; cat | wc -c >&2', '', repeat('0123456789', 100000), outcome, err)
    call tester%no_error(err, 'a program that reads a million bytes is no error')
    call tester%is_true(outcome%error_output == repeat('0123456789', 409)//'012345', 'the beginning of a long error output is kept')
    call run_shell('wc -c >&2', '', repeat('0123456789', 100000), outcome, err)
    call tester%is_true(verify(outcome%error_output, ' 1000000'//achar(10)) == 0 .and. index(outcome%error_output, '1000000') > 0, &
                        'all of the input arrives at the program')
  end subroutine test_much_input

  !> Standard output that is dropped goes to another file than that of this program, and blocks nothing.
  subroutine test_dropped_output(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(child_outcome_type) :: outcome
    type(error_type), allocatable :: err
    character(len=*), parameter :: script = &
      'if [ /proc/self/fd/1 -ef /proc/$PPID/fd/1 ]; then echo same >&2; else cat; echo other >&2; fi'

    call run_shell(script, '', repeat('0123456789', 100000), outcome, err, drop_output=.true.)
    call tester%no_error(err, 'a program whose output is dropped is no error')
    call tester%is_true(index(outcome%error_output, 'other') > 0, 'dropped output is not that of this program')
    call run_shell(script, '', '', outcome, err)
    call tester%is_true(index(outcome%error_output, 'same') > 0, 'output that is not dropped is that of this program')
  end subroutine test_dropped_output
end module test_child_process
