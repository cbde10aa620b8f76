!> What only the system can do: end the program with an exit code, tell a terminal from a file, take Ctrl-C, notice that
!> standard output is lost.
module mech9_system
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_intptr_t, c_ptr, c_null_ptr, c_funptr, c_funloc, c_null_funptr
  use mech9_error, only: error_type, raise, exit_file
  use mech9_system_error, only: error_number, clear_error_number, reason
  implicit none
  private
  public :: exit_program, is_terminal, standard_input, standard_output, standard_error
  public :: catch_interrupts, catch_size_limit, leave_quit_alone, interrupted, asked_to_end, hung_up, flush_output

  !> The three standard files, for `is_terminal`.
  integer, parameter :: standard_input = 0, standard_output = 1, standard_error = 2

  ! Numbers of POSIX systems.
  integer(c_int), parameter :: signal_file_size = 25, signal_hang_up = 1, signal_interrupt = 2, signal_quit = 3, &
                               signal_broken_pipe = 13, signal_alarm = 14, signal_terminate = 15
  !> The timer of setitimer that counts real time, and how long a signal may go unnoticed [us].
  integer(c_int), parameter :: real_timer = 0
  integer(c_long), parameter :: patience = 800000
  !> SIG_DFL and SIG_IGN as addresses.
  integer(c_intptr_t), parameter :: default_action = 0, ignore_action = 1

  !> The number of the signal that came, 0 before; set by the signal handler, read by `interrupted`, which makes it
  !> negative when it is noticed. A signal handler is given nothing but the number of the signal, so that it can only
  !> reach a module variable: this is the one exception of the project to its rule that no module variable changes. An
  !> interrupt means the whole process, hence every mechanism running in it.
  integer(c_int), volatile, bind(c, name='mech9_interrupt_flag') :: interrupt_flag = 0

  interface
    subroutine c_exit(code) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: code
    end subroutine c_exit

    integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
      import :: c_int
      integer(c_int), value :: descriptor
    end function c_isatty

    integer(c_int) function c_abs(number) bind(c, name='abs')
      import :: c_int
      integer(c_int), value :: number
    end function c_abs

    type(c_funptr) function c_signal(number, action) bind(c, name='signal')
      import :: c_int, c_funptr
      integer(c_int), value :: number
      type(c_funptr), value :: action
    end function c_signal

    integer(c_int) function c_raise(number) bind(c, name='raise')
      import :: c_int
      integer(c_int), value :: number
    end function c_raise

    ! two times of seconds and microseconds: between two alarms, until the first one
    integer(c_int) function c_setitimer(timer, times, previous) bind(c, name='setitimer')
      import :: c_int, c_long, c_ptr
      integer(c_int), value :: timer
      integer(c_long), intent(in) :: times(4)
      type(c_ptr), value :: previous
    end function c_setitimer
  end interface

contains

  !> End the program with an exit code, after all units are flushed. `stop` with a code would print
  !> it, `error stop` a backtrace.
  subroutine exit_program(code)
    integer, intent(in) :: code   !< one of the exit_ codes of mech9_error
    integer :: status

    ! failures are of no use any more: what matters was written and checked elsewhere
    flush (output_unit, iostat=status)
    flush (error_unit, iostat=status)
    call c_exit(int(code, c_int))
  end subroutine exit_program

  !> Hand to the system what Fortran has written to standard output. gfortran's runtime library loses the
  !> failure of that (a full disk); only the system's number of the error tells it. Fails with exit_file.
  subroutine flush_output(err)
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: status

    call clear_error_number()
    flush (output_unit, iostat=status)
    if (error_number() /= 0) &
      call raise(err, exit_file, 'cannot write to standard output: '//reason(error_number()))
  end subroutine flush_output

  !> Whether a standard file is a terminal that a person looks at.
  logical function is_terminal(descriptor)
    integer, intent(in) :: descriptor   !< standard_input, standard_output or standard_error

    is_terminal = c_isatty(int(descriptor, c_int)) == 1
  end function is_terminal

  !> From now on the first Ctrl-C, request to terminate or closing of the terminal only sets what
  !> `interrupted` tells, so that a loop can end in order; a second one ends the program at once, and so does the first
  !> one where nobody takes notice of it within a second: a step that does not end, a pipe that nobody reads. A reader
  !> that goes away (`mech9k ... | head`) becomes an error of writing instead of the death of the program, as
  !> in `catch_size_limit`. Called again, it forgets what was caught: a session that outlives an
  !> interrupted run is ready for the next.
  subroutine catch_interrupts()
    type(c_funptr) :: previous

    call set_alarm(0_c_long)
    interrupt_flag = 0
    previous = c_signal(signal_alarm, c_funloc(end_at_once))
    call catch(signal_interrupt)
    call catch(signal_terminate)
    call catch(signal_hang_up)
    previous = c_signal(signal_broken_pipe, action(ignore_action))
    call catch_size_limit()
  end subroutine catch_interrupts

  !> From now on a file that may not grow (ulimit -f) is an error of writing instead of the death of the program.
  subroutine catch_size_limit()
    type(c_funptr) :: previous

    previous = c_signal(signal_file_size, action(ignore_action))
  end subroutine catch_size_limit

  !> From now on Ctrl-\ ends the program as it ends others. gfortran's runtime library takes it, and prints a backtrace.
  subroutine leave_quit_alone()
    type(c_funptr) :: previous

    previous = c_signal(signal_quit, action(default_action))
  end subroutine leave_quit_alone

  !> Catch one signal, unless whoever started the program had it ignored (nohup, a job in the background).
  subroutine catch(number)
    integer(c_int), intent(in) :: number
    type(c_funptr) :: previous

    previous = c_signal(number, c_funloc(note_signal))
    if (transfer(previous, 0_c_intptr_t) == ignore_action) &
      previous = c_signal(number, action(ignore_action))
  end subroutine catch

  !> Whether the user wants the run to end. Takes a nanosecond or two.
  logical function interrupted()
    ! A function that only reads a module variable gfortran 12 takes for pure, volatile or not: its
    ! callers may then move the call out of the loop that polls it. Through a C function, of which the
    ! compiler knows nothing, it is what it should be.
    interrupted = c_abs(interrupt_flag) /= 0
    if (interrupted) call take_notice()
  end function interrupted

  !> Whether the whole program is to end, soon, and not only what it is doing: it was not Ctrl-C.
  logical function asked_to_end()
    asked_to_end = any(c_abs(interrupt_flag) == [signal_terminate, signal_hang_up])
  end function asked_to_end

  !> Whether it was the terminal that went away, so that nobody is there to be asked.
  logical function hung_up()
    hung_up = c_abs(interrupt_flag) == signal_hang_up
  end function hung_up

  !> The signal is noticed. After Ctrl-C there is time for an end in order, pictures included: who does not want to wait
  !> presses it again. Other signals leave time to write what was computed.
  subroutine take_notice()
    if (interrupt_flag <= 0) return
    interrupt_flag = -interrupt_flag
    call set_alarm(merge(patience, 0_c_long, asked_to_end()))
  end subroutine take_notice

  !> The handler of signals. It may do very little: note the signal, give the next one its default
  !> action, which is to end the program, and see to it that the program ends in any case.
  subroutine note_signal(number) bind(c)
    integer(c_int), value :: number
    type(c_funptr) :: previous

    interrupt_flag = number
    previous = c_signal(number, action(default_action))
    call set_alarm(patience)
  end subroutine note_signal

  !> The handler of the alarm: end the program by the signal that nobody took notice of.
  subroutine end_at_once(number) bind(c)
    integer(c_int), value :: number     !< of the alarm itself
    integer(c_int) :: cause, status
    type(c_funptr) :: previous

    cause = abs(interrupt_flag)
    if (cause == 0) cause = number
    previous = c_signal(cause, action(default_action))
    status = c_raise(cause)
  end subroutine end_at_once

  !> An alarm after a time; none for 0.
  subroutine set_alarm(microseconds)
    integer(c_long), intent(in) :: microseconds
    integer(c_int) :: status

    status = c_setitimer(real_timer, [0_c_long, 0_c_long, 0_c_long, microseconds], c_null_ptr)
  end subroutine set_alarm

  type(c_funptr) function action(address)
    integer(c_intptr_t), intent(in) :: address

    action = transfer(address, c_null_funptr)
  end function action
end module mech9_system
