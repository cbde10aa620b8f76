!> Lines that a person or a script gives as answers to prompts.
!>
!> On a terminal lines can be edited, recalled and completed. From a pipe or a file, and on a terminal that
!> cannot move its cursor, they are read without editing. Prompts are written to standard error.
module mech9_line_input
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_text, only: string_type, lower
  use mech9_system, only: is_terminal, standard_input, standard_error, catch_interrupts
  use mech9_input_bytes, only: input_bytes_type, line_read => input_read, line_ended => input_ended, &
                               line_interrupted => input_interrupted
  use mech9_line_editor, only: line_editor_type
  implicit none
  private
  public :: line_input_type, line_read, line_ended, line_interrupted

  character, parameter :: line_feed = achar(10), carriage_return = achar(13)

  !> Standard input as lines. It must be closed, so that the memory of the editor is freed.
  type :: line_input_type
    private
    type(input_bytes_type) :: bytes
    type(line_editor_type) :: editor
    logical :: edits = .false.
    logical :: echoes = .false.  !< the reader of the prompts sees the answers beside them
  contains
    procedure :: open => open_input
    procedure :: read_line
    procedure :: close => close_input
  end type line_input_type

contains

  !> Open the input. After this call Ctrl-C and a closed terminal are results of `read_line` and do not end
  !> the program.
  subroutine open_input(self, program_name)
    class(line_input_type), intent(inout) :: self  !< standard input as lines
    character(len=*), intent(in) :: program_name   !< name for the user's settings of libedit

    call catch_interrupts()
    self%echoes = is_terminal(standard_input)
    self%edits = .false.
    if (dumb_terminal() .or. .not. self%echoes) return
    if (is_terminal(standard_error)) call self%editor%start(program_name, self%edits)
  end subroutine open_input

  !> Show the prompt and wait for a line. A last line without a line end is a line too.
  subroutine read_line(self, prompt, words, line, status)
    class(line_input_type), intent(inout) :: self       !< standard input as lines
    character(len=*), intent(in) :: prompt              !< text before the line; it may have several lines
    type(string_type), intent(in) :: words(:)           !< words offered for completion
    character(len=:), allocatable, intent(out) :: line  !< the line without its end, of any bytes
    integer, intent(out) :: status                      !< line_read, line_ended or line_interrupted
    integer :: last_line

    if (self%edits) then
      last_line = index(prompt, line_feed, back=.true.)
      call say(prompt(:last_line))
      call self%editor%read_line(prompt(last_line + 1:), words, line, status)
      ! the line on the screen has no end yet
      if (status /= line_read) call say(line_feed)
    else
      call say(prompt)
      call read_plain(self%bytes, line, status)
      if (status /= line_read .or. .not. self%echoes) call say(line_feed)
    end if
  end subroutine read_line

  !> End the reading of lines.
  subroutine close_input(self)
    class(line_input_type), intent(inout) :: self  !< standard input as lines

    if (self%edits) call self%editor%stop()
    self%edits = .false.
  end subroutine close_input

  !> Whether the terminal is of unknown kind, or cannot move its cursor.
  logical function dumb_terminal()
    character(len=8) :: name
    integer :: status

    call get_environment_variable('TERM', name, status=status)
    dumb_terminal = name == '' .or. lower(name) == 'dumb'
    ! status is not zero for a longer name, which is another one
    if (status == -1) dumb_terminal = .false.
  end function dumb_terminal

  !> Read a line of any length without editing.
  subroutine read_plain(bytes, line, status)
    type(input_bytes_type), intent(inout) :: bytes      !< standard input
    character(len=:), allocatable, intent(out) :: line  !< the line without its end
    integer, intent(out) :: status                      !< line_read, line_ended or line_interrupted
    character(len=:), allocatable :: grown
    character :: byte
    integer :: n

    allocate (character(len=256) :: line)
    n = 0
    do
      call bytes%next_byte(byte, status)
      if (status /= line_read .or. byte == line_feed) exit
      if (n == len(line)) then
        allocate (character(len=2*n) :: grown)
        grown(:n) = line
        call move_alloc(grown, line)
      end if
      n = n + 1
      line(n:n) = byte
    end do
    if (n > 0 .and. status == line_ended) status = line_read
    if (n > 0) then
      if (line(n:n) == carriage_return) n = n - 1
    end if
    line = line(:n)
  end subroutine read_plain

  !> Write a text to standard error. A failure is ignored: there is no other place for a message.
  subroutine say(text)
    character(len=*), intent(in) :: text  !< the text, without a line end
    integer :: status

    if (len(text) == 0) return
    write (error_unit, '(a)', advance='no', iostat=status) text
    flush (error_unit, iostat=status)
  end subroutine say
end module mech9_line_input
