!> Services of the operating system: ending the program with an exit code, telling a terminal from a file, catching Ctrl-C,
!> noticing that standard output is lost.
module mech9_system
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_intptr_t, c_ptr, c_null_ptr, c_funptr, c_funloc, c_null_funptr
  use mech9_error, only: error_type, raise, exit_file
  use mech9_system_error, only: error_number, clear_error_number, reason
  implicit none
  private
  public :: exit_program, take_argument, is_terminal, standard_input, standard_output, standard_error
  public :: catch_interrupts, catch_size_limit, leave_quit_alone, interrupted, asked_to_end, hung_up, flush_output

  !> The three standard files, for `is_terminal`.
  integer, parameter :: standard_input = 0, standard_output = 1, standard_error = 2

  ! The numbers of signals on POSIX systems.
  integer(c_int), parameter :: signal_file_size = 25, signal_hang_up = 1, signal_interrupt = 2, signal_quit = 3, &
                               signal_broken_pipe = 13, signal_alarm = 14, signal_terminate = 15
  !> The timer of setitimer that counts real time, and the time after which a signal that nobody noticed ends the program [us].
  integer(c_int), parameter :: real_timer = 0
  integer(c_long), parameter :: patience = 800000
  !> SIG_DFL and SIG_IGN as addresses.
  integer(c_intptr_t), parameter :: default_action = 0, ignore_action = 1

  !> The number of the signal that came, 0 before. The signal handler sets it; `interrupted` reads it and makes it
  !> negative as a sign that it was noticed. A signal handler is given nothing but the number of the signal, so that it
  !> can only reach a module variable: this is the one exception of the project to its rule that no module variable
  !> changes. An interrupt concerns the whole process, hence every mechanism running in it.
  integer(c_int), volatile, bind(c, name='mech9_interrupt_flag') :: interrupt_flag = 0

  interface
    subroutine c_exit(code) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: code   !< exit code
    end subroutine c_exit

    integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
      import :: c_int
      integer(c_int), value :: descriptor   !< an open file
    end function c_isatty

    integer(c_int) function c_abs(number) bind(c, name='abs')
      import :: c_int
      integer(c_int), value :: number   !< any but the least integer
    end function c_abs

    type(c_funptr) function c_signal(number, action) bind(c, name='signal')
      import :: c_int, c_funptr
      integer(c_int), value :: number   !< of the signal
      type(c_funptr), value :: action   !< address of the handler, or of SIG_DFL or SIG_IGN
    end function c_signal

    integer(c_int) function c_raise(number) bind(c, name='raise')
      import :: c_int
      integer(c_int), value :: number   !< of the signal that this process gets
    end function c_raise

    ! sets the alarm
    integer(c_int) function c_setitimer(timer, times, previous) bind(c, name='setitimer')
      import :: c_int, c_long, c_ptr
      integer(c_int), value :: timer            !< real_timer
      integer(c_long), intent(in) :: times(4)   !< seconds and microseconds between two alarms, then those until the first one
      type(c_ptr), value :: previous            !< null: the setting before is not wanted
    end function c_setitimer
  end interface

contains

  !> Take an argument of the command line, or with the number 0 the name of the program.
  subroutine take_argument(i, text)
    integer, intent(in) :: i                             !< its number
    character(len=:), allocatable, intent(out) :: text   !< the argument
    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(len=length) :: text)
    if (length > 0) call get_command_argument(i, text)
  end subroutine take_argument

  !> End the program with an exit code, after all units are flushed. `stop` with a code would print
  !> it, `error stop` a backtrace.
  subroutine exit_program(code)
    integer, intent(in) :: code   !< one of the exit_ codes of mech9_error
    integer :: status

    ! failures are ignored here: all results were written and checked before
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

  !> From now on the first Ctrl-C, request to terminate or closing of the terminal is only noted, and `interrupted`
  !> tells it, so that a loop can end in order. A second one ends the program at once, and so does the first
  !> one where the program does not notice it within a second: in a step that does not end, at a pipe that nobody reads.
  !> A reader that goes away (`mech9k ... | head`) causes an error of writing and does not kill the program, as
  !> in `catch_size_limit`. Called again, this procedure forgets the signals caught before: a session that outlives an
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

  !> From now on a file that may not grow (ulimit -f) causes an error of writing and does not kill the program.
  subroutine catch_size_limit()
    type(c_funptr) :: previous

    previous = c_signal(signal_file_size, action(ignore_action))
  end subroutine catch_size_limit

  !> From now on Ctrl-\ ends the program as it ends others. Otherwise gfortran's runtime library catches it and prints a backtrace.
  subroutine leave_quit_alone()
    type(c_funptr) :: previous

    previous = c_signal(signal_quit, action(default_action))
  end subroutine leave_quit_alone

  !> Catch one signal, unless the program was started with the signal ignored (nohup, a job in the background).
  subroutine catch(number)
    integer(c_int), intent(in) :: number   !< of the signal
    type(c_funptr) :: previous

    previous = c_signal(number, c_funloc(note_signal))
    if (transfer(previous, 0_c_intptr_t) == ignore_action) &
      previous = c_signal(number, action(ignore_action))
  end subroutine catch

  !> Whether the user wants the run to end. Takes a nanosecond or two.
  logical function interrupted()
    ! gfortran 12 takes a function that only reads a module variable for pure, even if that is volatile: its
    ! callers may then move the call out of the loop that polls it. The call of a C function, of which the
    ! compiler knows nothing, prevents this.
    interrupted = c_abs(interrupt_flag) /= 0
    if (interrupted) call take_notice()
  end function interrupted

  !> Whether the signal asks the whole program to end soon, and not only its present run, as Ctrl-C does.
  logical function asked_to_end()
    asked_to_end = any(c_abs(interrupt_flag) == [signal_terminate, signal_hang_up])
  end function asked_to_end

  !> Whether the signal tells that the terminal was closed, so that nobody can answer questions.
  logical function hung_up()
    hung_up = c_abs(interrupt_flag) == signal_hang_up
  end function hung_up

  !> Mark the signal as noticed. After Ctrl-C there is time for an end in order, pictures included: users who do not want
  !> to wait press it again. Other signals leave time to write the results computed so far.
  subroutine take_notice()
    if (interrupt_flag <= 0) return
    interrupt_flag = -interrupt_flag
    call set_alarm(merge(patience, 0_c_long, asked_to_end()))
  end subroutine take_notice

  !> The handler of signals. It may do very little: it notes the signal, gives the next one its default
  !> action, which is to end the program, and sets an alarm, so that the program ends in any case.
  subroutine note_signal(number) bind(c)
    integer(c_int), value :: number   !< of the signal that came
    type(c_funptr) :: previous

    interrupt_flag = number
    previous = c_signal(number, action(default_action))
    call set_alarm(patience)
  end subroutine note_signal

  !> The handler of the alarm: it ends the program by the signal that was not noticed.
  subroutine end_at_once(number) bind(c)
    integer(c_int), value :: number     !< of the alarm itself
    integer(c_int) :: cause, status
    type(c_funptr) :: previous

    cause = abs(interrupt_flag)
    if (cause == 0) cause = number
    previous = c_signal(cause, action(default_action))
    status = c_raise(cause)
  end subroutine end_at_once

  !> Set an alarm, or cancel the one that is set.
  subroutine set_alarm(microseconds)
    integer(c_long), intent(in) :: microseconds   !< until the alarm [us]; 0: no alarm
    integer(c_int) :: status

    status = c_setitimer(real_timer, [0_c_long, 0_c_long, 0_c_long, microseconds], c_null_ptr)
  end subroutine set_alarm

  !> An action of signals by its address.
  type(c_funptr) function action(address)
    integer(c_intptr_t), intent(in) :: address   !< default_action or ignore_action

    action = transfer(address, c_null_funptr)
  end function action
end module mech9_system
