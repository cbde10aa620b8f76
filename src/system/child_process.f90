!> Another program run to its end: gnuplot, dot.
!>
!> It is started with a list of words, without a shell: no word means anything but itself. Its standard input comes
!> from a file in memory and its standard error goes to another one, so that neither can block the other.
module mech9_child_process
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_size_t, c_char, c_ptr, c_null_ptr, c_null_char, c_loc, &
                                         c_sizeof
  use mech9_error, only: error_type, raise, exit_file
  use mech9_text, only: string_type
  use mech9_system_error, only: error_number, reason, interrupted_call
  implicit none
  private
  public :: child_outcome_type, run_child

  !> The end of a program.
  type :: child_outcome_type
    logical :: found = .false.                      !< there is a program of that name, and it was started
    integer :: code = 0                             !< its exit code; 128 + the signal's number where one ended it
    character(len=:), allocatable :: error_output   !< beginning of what the program wrote to standard error
  end type child_outcome_type

  integer(c_int), parameter :: standard_input = 0, standard_output = 1, standard_error = 2
  !> The setting of prctl that lets a child end with its parent, and by which signal.
  integer(c_int), parameter :: end_with_parent = 1
  integer(c_long), parameter :: signal_terminate = 15
  !> The exit code of the child where the program cannot be started, as shells have it. A program that was started may
  !> end with it too, for want of a library: the reason why one could not be started is told in a file of its own.
  integer(c_int), parameter :: not_started = 127
  !> A file in memory that a started program does not see (MFD_CLOEXEC).
  integer(c_int), parameter :: closed_by_exec = 1
  !> Bytes of its standard error that are kept.
  integer, parameter :: most_error_output = 4096

  interface
    ! the process calls of POSIX: pid_t is a C int on Linux
    integer(c_int) function c_fork() bind(c, name='fork')
      import :: c_int
    end function c_fork

    integer(c_int) function c_execvp(file, words) bind(c, name='execvp')
      import :: c_int, c_ptr
      type(c_ptr), value :: file   !< the program's name, looked for in PATH; ends with a byte of zero
      type(c_ptr), intent(in) :: words(*)   !< the name again and the arguments, each ending with a byte of zero, and a null pointer
    end function c_execvp

    ! a setting of this process: here the signal that it gets when its parent ends
    integer(c_int) function c_prctl(option, signal, none, nothing, no_more) bind(c, name='prctl')
      import :: c_int, c_long
      integer(c_int), value :: option     !< number of the setting (PR_SET_PDEATHSIG)
      integer(c_long), value :: signal    !< number of the signal that the process gets when its parent ends
      integer(c_long), value :: none      !< unused, 0
      integer(c_long), value :: nothing   !< unused, 0
      integer(c_long), value :: no_more   !< unused, 0
    end function c_prctl

    subroutine c_exit_at_once(code) bind(c, name='_exit')
      import :: c_int
      integer(c_int), value :: code   !< exit code
    end subroutine c_exit_at_once

    integer(c_int) function c_waitpid(process, status, options) bind(c, name='waitpid')
      import :: c_int
      integer(c_int), value :: process        !< number of the process
      integer(c_int), value :: options        !< 0: wait for the end
      integer(c_int), intent(out) :: status   !< how the process ended, as `judge` reads it
    end function c_waitpid

    integer(c_int) function c_chdir(path) bind(c, name='chdir')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: path(*)   !< the folder; ends with a byte of zero
    end function c_chdir

    ! a file in memory only, gone with its last descriptor
    integer(c_int) function c_memfd_create(name, flags) bind(c, name='memfd_create')
      import :: c_int, c_char
      character(kind=c_char), intent(in) :: name(*)   !< shown by the system for the file; ends with a byte of zero
      integer(c_int), value :: flags                  !< 0 or MFD_CLOEXEC
    end function c_memfd_create

    integer(c_int) function c_dup2(descriptor, other) bind(c, name='dup2')
      import :: c_int
      integer(c_int), value :: descriptor   !< an open file
      integer(c_int), value :: other        !< the number under which it is open afterwards
    end function c_dup2

    integer(c_int) function c_close(descriptor) bind(c, name='close')
      import :: c_int
      integer(c_int), value :: descriptor   !< an open file
    end function c_close

    integer(c_long) function c_pwrite(descriptor, bytes, count, place) bind(c, name='pwrite')
      import :: c_int, c_long, c_size_t, c_char
      integer(c_int), value :: descriptor              !< an open file
      character(kind=c_char), intent(in) :: bytes(*)   !< the bytes to be written
      integer(c_size_t), value :: count                !< of the bytes
      integer(c_long), value :: place                  !< offset of the first byte in the file
    end function c_pwrite

    integer(c_long) function c_pread(descriptor, bytes, count, place) bind(c, name='pread')
      import :: c_int, c_long, c_size_t, c_char
      integer(c_int), value :: descriptor               !< an open file
      character(kind=c_char), intent(out) :: bytes(*)   !< the bytes read
      integer(c_size_t), value :: count                 !< of the bytes
      integer(c_long), value :: place                   !< offset of the first byte in the file
    end function c_pread
  end interface

contains

  !> Run a program and wait for its end. A program that is not there, or that fails, is no error: the outcome
  !> says so. A program that is there and cannot be started is an error. Its standard output is that of this program,
  !> unless it is dropped.
  subroutine run_child(words, input, outcome, err, folder, drop_output)
    type(string_type), intent(in) :: words(:)           !< the program, looked for in PATH, and its arguments
    character(len=*), intent(in) :: input               !< contents of its standard input
    type(child_outcome_type), intent(out) :: outcome    !< how the program ended
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    character(len=*), intent(in), optional :: folder    !< its working folder; the present one unless given
    logical, intent(in), optional :: drop_output        !< nobody sees its standard output
    integer(c_int) :: from, to, drop, failure, process, status, ignored

    outcome%error_output = ''
    drop = standard_output
    if (present(drop_output)) then
      if (drop_output) drop = c_memfd_create('dropped'//c_null_char, 0_c_int)
    end if
    from = c_memfd_create('input'//c_null_char, 0_c_int)
    to = c_memfd_create('errors'//c_null_char, 0_c_int)
    failure = c_memfd_create('failure'//c_null_char, closed_by_exec)
    process = -1
    if (min(from, to, drop, failure) >= 0) then
      call fill(from, input, err)
      if (.not. allocated(err)) call start(words, from, to, drop, failure, process, folder)
    end if
    if (process < 0 .and. .not. allocated(err)) &
      call raise(err, exit_file, 'cannot start '//words(1)%text//': '//reason(error_number()))
    if (process >= 0) then
      do while (c_waitpid(process, status, 0_c_int) < 0)
        if (error_number() /= interrupted_call) exit
      end do
      call judge(status, outcome)
      call read_back(to, outcome%error_output)
      call judge_start(words(1)%text, failure, outcome, err)
    end if
    if (from >= 0) ignored = c_close(from)
    if (to >= 0) ignored = c_close(to)
    if (failure >= 0) ignored = c_close(failure)
    if (drop > standard_error) ignored = c_close(drop)
  end subroutine run_child

  !> Write the input from the beginning of its file; the place where the child reads stays there.
  subroutine fill(descriptor, input, err)
    integer(c_int), intent(in) :: descriptor            !< file that the child reads as its standard input
    character(len=*), intent(in) :: input               !< contents of the file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: done
    integer(c_long) :: written

    done = 0
    do while (done < len(input))
      written = c_pwrite(descriptor, input(done + 1:), int(len(input) - done, c_size_t), int(done, c_long))
      if (written > 0) then
        done = done + int(written)
      else if (error_number() /= interrupted_call) then
        call raise(err, exit_file, 'no memory for the input of another program: '//reason(error_number()))
        return
      end if
    end do
  end subroutine fill

  !> Start the second process, which becomes the program. Everything it needs is made before it begins: between
  !> fork and exec only system calls are safe.
  subroutine start(words, from, to, drop, failure, process, folder)
    type(string_type), intent(in) :: words(:)          !< the program and its arguments
    integer(c_int), intent(in) :: from                 !< its standard input
    integer(c_int), intent(in) :: to                   !< its standard error
    integer(c_int), intent(in) :: drop                 !< its standard output
    integer(c_int), intent(in) :: failure              !< file that gets the number of the error where it cannot be started
    integer(c_int), intent(out) :: process             !< negative: it could not be made
    character(len=*), intent(in), optional :: folder   !< its working folder; the present one unless given
    character(kind=c_char, len=:), allocatable, target :: letters
    character(len=:), allocatable :: place
    type(c_ptr), allocatable :: list(:)
    integer(c_int) :: status
    integer(c_long) :: written
    integer :: i, at

    letters = ''
    do i = 1, size(words)
      letters = letters//words(i)%text//c_null_char
    end do
    allocate (list(size(words) + 1))
    at = 1
    do i = 1, size(words)
      list(i) = c_loc(letters(at:at))
      at = at + len(words(i)%text) + 1
    end do
    list(size(list)) = c_null_ptr
    place = '.'//c_null_char
    if (present(folder)) place = folder//c_null_char
    process = c_fork()
    if (process /= 0) return
    status = c_prctl(end_with_parent, signal_terminate, 0_c_long, 0_c_long, 0_c_long)
    status = min(c_dup2(from, standard_input), c_dup2(to, standard_error), c_dup2(drop, standard_output), c_chdir(place))
    if (status >= 0) status = c_execvp(list(1), list)
    written = c_pwrite(failure, transfer(error_number(), [c_null_char]), c_sizeof(status), 0_c_long)
    call c_exit_at_once(not_started)
  end subroutine start

  !> The end of the program, from the status of waitpid: the low seven bits are the signal that ended it, the next byte
  !> is its exit code.
  pure subroutine judge(status, outcome)
    integer(c_int), intent(in) :: status                 !< as waitpid gives it
    type(child_outcome_type), intent(inout) :: outcome   !< gets the exit code

    outcome%code = ibits(status, 8, 8)
    if (ibits(status, 0, 7) /= 0) outcome%code = 128 + ibits(status, 0, 7)
    outcome%found = .true.
  end subroutine judge

  !> Whether the program could be started. Without success, a program that is nowhere in PATH is one that was not
  !> found; one that is there is an error.
  subroutine judge_start(name, failure, outcome, err)
    character(len=*), intent(in) :: name                 !< of the program, as it was called
    integer(c_int), intent(in) :: failure                !< file with the number of the error, empty where it was started
    type(child_outcome_type), intent(inout) :: outcome   !< `found` becomes false where there is no such program
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    character(kind=c_char) :: bytes(c_sizeof(failure))
    character(len=:), allocatable :: path

    if (c_pread(failure, bytes, c_sizeof(failure), 0_c_long) < size(bytes)) return
    path = place_in_path(name)
    outcome%found = path /= ''
    if (outcome%found) call raise(err, exit_file, 'cannot start '//path//': '//trim(reason(transfer(bytes, failure)))// &
                                  '; install it anew, or put another one before it in PATH')
  end subroutine judge_start

  !> The first file of this name in the folders of PATH; empty where there is none.
  function place_in_path(name) result(place)
    character(len=*), intent(in) :: name   !< of the program, with a folder or without
    character(len=:), allocatable :: place, folders
    integer :: length, first, last
    logical :: there

    place = name
    inquire (file=name, exist=there)
    if (index(name, '/') > 0 .and. there) return
    call get_environment_variable('PATH', length=length)
    allocate (character(len=length) :: folders)
    call get_environment_variable('PATH', folders)
    folders = folders//':'
    first = 1
    do while (first <= len(folders))
      last = first + index(folders(first:), ':') - 2
      place = folders(first:last)//'/'//name
      inquire (file=place, exist=there)
      if (there) return
      first = last + 2
    end do
    place = ''
  end function place_in_path

  !> The beginning of what the program wrote to standard error.
  subroutine read_back(descriptor, text)
    integer(c_int), intent(in) :: descriptor             !< file with the child's standard error
    character(len=:), allocatable, intent(out) :: text   !< the beginning of its contents
    character(len=most_error_output) :: buffer
    integer(c_long) :: count

    count = c_pread(descriptor, buffer, int(most_error_output, c_size_t), 0_c_long)
    text = trim(buffer(:max(int(count), 0)))
  end subroutine read_back
end module mech9_child_process
