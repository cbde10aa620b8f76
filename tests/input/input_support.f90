!> Tools that the tests of the input floor share: documents from texts, and the text that diagnostics print.
module mech9_input_support
  use mech9_program_kind, only: kinematics
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  implicit none
  private
  public :: printed, mechanism_from_text, count_of, eol, slider_crank

  character(len=*), parameter :: eol = achar(10)

  !> A right data file, the offset slider-crank, for tests to vary.
  character(len=*), parameter :: slider_crank = &
    "&mechanism title='Slider-crank', links=4, coordinates=4 /"//eol// &
    "&structure c(1,:)=0,1,0,4  c(2,:)=1,0,2,0  c(3,:)=0,2,0,3  c(4,:)=4,0,3,0  cq=1 /"//eol// &
    "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"//eol// &
    "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /"//eol// &
    "&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, point=0,0.1,0, zero=0,1,0, moving_point=0,0,0 /"//eol// &
    "&initial coordinate=4, position=1.2 /"//eol// &
    "&point name='B', link=4 /"//eol// &
    "&drive coordinate=1, kind='polynomial', coefficients=0.4, 10 /"//eol// &
    "&time start=0, end=0.5, intervals=10 /"//eol

contains

  !> All that diagnostics print.
  function printed(diagnostics) result(text)
    type(diagnostics_type), intent(in) :: diagnostics   !< of an input
    character(len=:), allocatable :: text
    integer :: unit, length

    open (newunit=unit, status='scratch', access='stream', form='formatted', action='readwrite')
    call diagnostics%report(unit)
    inquire (unit=unit, pos=length)
    length = length - 1
    allocate (character(len=length) :: text)
    call read_back(unit, text)
    close (unit)
  end function printed

  !> The whole text of an open file of lines.
  subroutine read_back(unit, text)
    integer, intent(in) :: unit             !< of the file
    character(len=*), intent(out) :: text   !< its lines, with the ends of lines
    character(len=256) :: piece
    integer :: n, at, status

    rewind (unit)
    at = 1
    text = ''
    do
      read (unit, '(a)', advance='no', size=n, iostat=status) piece
      if (is_iostat_end(status)) exit
      text(at:at + n - 1) = piece(:n)
      at = at + n
      if (.not. is_iostat_eor(status)) cycle
      if (at > len(text)) exit
      text(at:at) = eol
      at = at + 1
    end do
  end subroutine read_back

  !> The mechanism that the text of a data file describes.
  subroutine mechanism_from_text(text, model, diagnostics)
    character(len=*), intent(in) :: text                 !< of a data file
    type(model_type), intent(out) :: model               !< the mechanism that it describes
    type(diagnostics_type), intent(out) :: diagnostics   !< errors in it
    type(document_type) :: document

    call parse_document(source_from_text('test.nml', text), document, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
  end subroutine mechanism_from_text

  !> How often a piece occurs in a text.
  pure integer function count_of(piece, text) result(n)
    character(len=*), intent(in) :: piece   !< not empty
    character(len=*), intent(in) :: text    !< in which it is counted
    integer :: at, found

    n = 0
    at = 1
    do
      found = index(text(at:), piece)
      if (found == 0) return
      n = n + 1
      at = at + found
    end do
  end function count_of
end module mech9_input_support
