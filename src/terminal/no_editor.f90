!> The line editor of a program built without libedit: there is none.
module mech9_no_editor
  use mech9_text, only: string_type
  use mech9_input_bytes, only: input_ended
  implicit none
  private
  public :: line_editor_type

  !> An editor that is never ready.
  type :: line_editor_type
  contains
    procedure, nopass :: start
    procedure, nopass :: read_line
    procedure, nopass :: stop => stop_editor
  end type line_editor_type

contains

  !> Answer that lines cannot be edited.
  subroutine start(program_name, ready)
    character(len=*), intent(in) :: program_name  !< not used
    logical, intent(out) :: ready                 !< always false

    ready = .false.
  end subroutine start

  !> Return the end of the input; this procedure is not called, since the editor is never ready.
  subroutine read_line(prompt, words, line, status)
    character(len=*), intent(in) :: prompt              !< not used
    type(string_type), intent(in) :: words(:)           !< not used
    character(len=:), allocatable, intent(out) :: line  !< always empty
    integer, intent(out) :: status                      !< always input_ended

    line = ''
    status = input_ended
  end subroutine read_line

  !> Do nothing: the editor holds no resources.
  subroutine stop_editor()
  end subroutine stop_editor
end module mech9_no_editor
