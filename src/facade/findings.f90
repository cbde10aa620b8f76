!> The errors of a mechanism as values: each with its place, and all of them as one failure.
module mech9_findings
  use mech9_error, only: error_type, place_type, raise
  use mech9_source, only: span_type
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: finding_type, fail_as

  !> One of the errors of a mechanism.
  type :: finding_type
    character(len=:), allocatable :: message   !< the error in words, without its place
    character(len=:), allocatable :: file      !< path of the data file; empty: the error is in no file
    integer :: line = 0                        !< in the file; 0: no place is known
    integer :: column = 0                      !< in the line
  end type finding_type

  !> Errors that are told together.
  integer, parameter :: most_told = 20

contains

  !> All errors of reading as one failure; none where there are none.
  subroutine fail_as(diagnostics, err, findings)
    type(diagnostics_type), intent(in) :: diagnostics                              !< the errors, and the texts that they stand in
    type(error_type), allocatable, intent(out) :: err                              !< allocated if there is an error
    type(finding_type), allocatable, intent(out), optional :: findings(:)          !< all errors, by place
    character(len=:), allocatable :: text, message
    integer, allocatable :: order(:)
    integer :: i

    if (present(findings)) then
      order = diagnostics%sorted()
      allocate (findings(size(order)))
      do i = 1, size(order)
        call find_place(diagnostics, order(i), findings(i))
      end do
    end if
    if (.not. diagnostics%failed()) return
    message = ''
    do i = 1, min(diagnostics%known(), most_told)
      call diagnostics%render(i, text)
      if (i > 1) message = message//new_line('a')
      message = message//text
    end do
    call raise(err, diagnostics%code(), message)
  end subroutine fail_as

  !> One error with its file, line and column.
  subroutine find_place(diagnostics, number, finding)
    type(diagnostics_type), intent(in) :: diagnostics   !< the errors, and the texts that they stand in
    integer, intent(in) :: number                       !< of the error
    type(finding_type), intent(out) :: finding          !< the error
    type(place_type) :: place
    type(span_type) :: span

    call diagnostics%get(number, finding%message, span)
    finding%file = ''
    if (span%source == 0) return
    if (.not. diagnostics%sources(span%source)%is_file) return
    place = diagnostics%place(span)
    finding%file = diagnostics%sources(span%source)%name
    finding%line = place%line
    finding%column = place%column
  end subroutine find_place
end module mech9_findings
