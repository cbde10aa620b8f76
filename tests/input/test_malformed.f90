!> Reads every file that tests/input/malformed/expected.txt lists, in that folder, and holds the exit code
!> and what is printed against the list.
program test_malformed
  use mech9_text, only: to_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_input_support, only: printed
  use mech9_testing, only: tester_type
  implicit none
  type(tester_type) :: tester
  character(len=1000) :: line
  integer :: unit, status, files

  files = 0
  open (newunit=unit, file='expected.txt', action='read', status='old')
  do
    read (unit, '(a)', iostat=status) line
    if (status /= 0) exit
    if (line == '' .or. line(1:1) == '#') cycle
    files = files + 1
    call check_file(trim(line))
  end do
  close (unit)
  call tester%is_true(files >= 40, 'at least forty files are tried')
  call tester%finish()

contains

  !> One line of the list: file | exit code | text | text ...
  subroutine check_file(expected)
    character(len=*), intent(in) :: expected   !< the line of the list
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(model_type) :: model
    character(len=:), allocatable :: name, fragment, answer
    integer :: at, code

    at = 1
    call next_field(expected, at, name)
    call next_field(expected, at, fragment)
    read (fragment, *) code
    call read_document(name, document, diagnostics)
    call read_model(document, .true., model, diagnostics)
    answer = printed(diagnostics)
    call tester%is_true(diagnostics%code() == code, name//': exit code '//to_text(code)//', not '// &
                        to_text(diagnostics%code()))
    call tester%is_true(diagnostics%failed() .eqv. len(answer) > 0, name//': something is printed where something is wrong')
    do while (at <= len(expected))
      call next_field(expected, at, fragment)
      call tester%is_true(index(answer, fragment) > 0, name//': the message holds: '//fragment)
      if (index(answer, fragment) == 0) print '(a)', answer
    end do
  end subroutine check_file

  subroutine next_field(text, at, field)
    character(len=*), intent(in) :: text                  !< the line of the list
    integer, intent(inout) :: at                          !< place of the field; then of the next one
    character(len=:), allocatable, intent(out) :: field   !< without blanks around it
    integer :: bar

    bar = index(text(at:)//' | ', ' | ')
    field = text(at:min(at + bar - 2, len(text)))
    at = at + bar + 2
  end subroutine next_field
end program test_malformed
