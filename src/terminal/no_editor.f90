!> The line editor of a program built without libedit: there is none.
module mech9_no_editor
  use mech9_text, only: string_type
  use mech9_input_bytes, only: input_ended
  implicit none
  private
  public :: line_editor_type

  !> An editor that never is ready.
  type :: line_editor_type
  contains
    procedure, nopass :: start
    procedure, nopass :: read_line
    procedure, nopass :: stop => stop_editor
  end type line_editor_type

contains

  !> There is nothing to begin with.
  subroutine start(program_name, ready)
    character(len=*), intent(in) :: program_name
    logical, intent(out) :: ready

    ready = .false.
  end subroutine start

  !> Not called, since it was never ready.
  subroutine read_line(prompt, words, line, status)
    character(len=*), intent(in) :: prompt
    type(string_type), intent(in) :: words(:)
    character(len=:), allocatable, intent(out) :: line
    integer, intent(out) :: status

    line = ''
    status = input_ended
  end subroutine read_line

  !> There is nothing to give back.
  subroutine stop_editor()
  end subroutine stop_editor
end module mech9_no_editor
