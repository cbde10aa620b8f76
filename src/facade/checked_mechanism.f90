!> A mechanism as the library's users hold it: read from a data file or a text of the same form, and checked.
module mech9_checked_mechanism
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_model, only: model_type
  use mech9_explanation, only: explain
  use mech9_source, only: source_type, source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document, parse_document
  use mech9_reader, only: read_model
  implicit none
  private
  public :: checked_mechanism_type, read_file, read_text

  type :: checked_mechanism_type
    private
    type(document_type) :: document
    logical :: is_read = .false.      !< the document is without errors
  contains
    procedure :: take
    procedure :: point_at
  end type checked_mechanism_type

  !> Errors that are told together.
  integer, parameter :: most_told = 20

contains

  !> Read a data file. Fails with exit_file, exit_data or exit_structure; the message holds all errors, each with its line.
  subroutine read_file(path, mechanism, err)
    character(len=*), intent(in) :: path                        !< of the data file
    type(checked_mechanism_type), intent(out) :: mechanism      !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(diagnostics_type) :: diagnostics

    call read_document(path, mechanism%document, diagnostics)
    call check(mechanism, diagnostics, err)
  end subroutine read_file

  !> Read a text that has the form of a data file. Fails as read_file does.
  subroutine read_text(text, mechanism, err)
    character(len=*), intent(in) :: text                        !< groups of the data file
    type(checked_mechanism_type), intent(out) :: mechanism      !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(diagnostics_type) :: diagnostics
    type(source_type) :: source

    source = source_from_text('text', text)
    call parse_document(source, mechanism%document, diagnostics)
    call check(mechanism, diagnostics, err)
  end subroutine read_text

  !> Hold a document against everything that the reader checks.
  subroutine check(mechanism, diagnostics, err)
    type(checked_mechanism_type), intent(inout) :: mechanism    !< with its document
    type(diagnostics_type), intent(inout) :: diagnostics        !< errors of reading the document
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(model_type) :: unused

    call read_model(mechanism%document, dynamics, unused, diagnostics)
    call fail_as(diagnostics, err)
    mechanism%is_read = .not. allocated(err)
  end subroutine check

  !> The model of a driven or of a free motion, with all coordinates and their derivatives requested. Fails with exit_data
  !> where drives are missing for the former.
  subroutine take(self, program, model, err)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    integer, intent(in) :: program                         !< kinematics, where all independent coordinates have drives, or dynamics
    type(model_type), intent(out) :: model                 !< in m, rad, kg, s
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(diagnostics_type) :: diagnostics
    integer :: number

    if (.not. self%is_read) then
      call raise(err, exit_usage, 'there is no mechanism: read one, or finish a design, before its motion is started')
      return
    end if
    call diagnostics%add_source(self%document%source, number)
    call read_model(self%document, program, model, diagnostics)
    call fail_as(diagnostics, err)
    if (allocated(err)) return
    if (allocated(model%request%output%coordinates)) deallocate (model%request%output%coordinates)
    model%request%output%derivatives = 2
  end subroutine take

  !> Complete the message of an error, with the line of the data file where it knows its place.
  subroutine point_at(self, err)
    class(checked_mechanism_type), intent(in) :: self             !< the mechanism
    type(error_type), allocatable, intent(inout) :: err           !< nothing happens where it is not allocated
    type(diagnostics_type) :: diagnostics
    integer :: number

    if (.not. allocated(err)) return
    call explain(err)
    if (err%place%line == 0) return
    call diagnostics%add_source(self%document%source, number)
    call diagnostics%add_error(err)
    call diagnostics%render(1, err%message)
  end subroutine point_at

  !> All errors of reading as one failure; none where there are none.
  subroutine fail_as(diagnostics, err)
    type(diagnostics_type), intent(in) :: diagnostics   !< the errors, and the texts that they stand in
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is an error
    character(len=:), allocatable :: text, message
    integer :: i

    if (.not. diagnostics%failed()) return
    message = ''
    do i = 1, min(diagnostics%known(), most_told)
      call diagnostics%render(i, text)
      if (i > 1) message = message//new_line('a')
      message = message//text
    end do
    call raise(err, diagnostics%code(), message)
  end subroutine fail_as
end module mech9_checked_mechanism
