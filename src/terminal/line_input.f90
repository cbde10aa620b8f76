!> Lines that a person or a script answers to prompts.
!>
!> On a terminal lines can be edited, recalled and completed. From a pipe or a file, and on a terminal that
!> cannot move its cursor, they are read as they come. Prompts go to standard error.
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

  !> Standard input as lines. It must be closed, so that the terminal's memory is given back.
  type :: line_input_type
    private
    type(input_bytes_type) :: bytes
    type(line_editor_type) :: editor
    logical :: edits = .false.
    logical :: echoes = .false.    !< whoever reads the prompts sees the answers beside them
  contains
    procedure :: open => open_input
    procedure :: read_line
    procedure :: close => close_input
  end type line_input_type

contains

  !> Begin. From now on Ctrl-C and a closed terminal are answers of `read_line` instead of the
  !> program's end.
  subroutine open_input(self, program_name)
    class(line_input_type), intent(inout) :: self   !< the line input
    character(len=*), intent(in) :: program_name

    call catch_interrupts()
    self%echoes = is_terminal(standard_input)
    self%edits = .false.
    if (dumb_terminal() .or. .not. self%echoes) return
    if (is_terminal(standard_error)) call self%editor%start(program_name, self%edits)
  end subroutine open_input

  !> Ask for a line and wait for it. A last line without an end counts as one.
  subroutine read_line(self, prompt, words, line, status)
    class(line_input_type), intent(inout) :: self   !< the line input
    character(len=*), intent(in) :: prompt             !< may have several lines
    type(string_type), intent(in) :: words(:)          !< what may be completed here
    character(len=:), allocatable, intent(out) :: line !< without its end; whatever bytes it has
    integer, intent(out) :: status                     !< line_read, line_ended or line_interrupted
    integer :: last_line

    if (self%edits) then
      last_line = index(prompt, line_feed, back=.true.)
      call say(prompt(:last_line))
      call self%editor%read_line(prompt(last_line + 1:), words, line, status)
      ! nobody ended that line
      if (status /= line_read) call say(line_feed)
    else
      call say(prompt)
      call read_plain(self%bytes, line, status)
      if (status /= line_read .or. .not. self%echoes) call say(line_feed)
    end if
  end subroutine read_line

  !> No more lines are asked for.
  subroutine close_input(self)
    class(line_input_type), intent(inout) :: self   !< the line input

    if (self%edits) call self%editor%stop()
    self%edits = .false.
  end subroutine close_input

  !> A terminal of which nothing is known, or that can only type on.
  logical function dumb_terminal()
    character(len=8) :: name
    integer :: status

    call get_environment_variable('TERM', name, status=status)
    dumb_terminal = name == '' .or. lower(name) == 'dumb'
    ! a longer name than this one is another one
    if (status == -1) dumb_terminal = .false.
  end function dumb_terminal

  !> A line of any length, as it comes.
  subroutine read_plain(bytes, line, status)
    type(input_bytes_type), intent(inout) :: bytes
    character(len=:), allocatable, intent(out) :: line
    integer, intent(out) :: status
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

  !> To standard error. Where nobody listens any more, nothing can be done about it.
  subroutine say(text)
    character(len=*), intent(in) :: text
    integer :: status

    if (len(text) == 0) return
    write (error_unit, '(a)', advance='no', iostat=status) text
    flush (error_unit, iostat=status)
  end subroutine say
end module mech9_line_input
