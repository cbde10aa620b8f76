!> Reads every file that tests/input/malformed/expected.txt lists, and holds the exit code
!> and what is printed against the list.
module test_malformed
  use mech9_program_kind, only: kinematics
  use mech9_text, only: to_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_input_support, only: printed
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: folder = '/tests/input/malformed/'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('listed_files')) call listed_files(tester)
  end subroutine run

  !> Every line of the list.
  subroutine listed_files(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=1000) :: line
    integer :: unit, status, files

    files = 0
    open (newunit=unit, file=tester%tree//folder//'expected.txt', action='read', status='old')
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (line == '' .or. line(1:1) == '#') cycle
      files = files + 1
      call check_file(tester, trim(line))
    end do
    close (unit)
    call tester%is_true(files >= 40, 'at least forty files are tried')
  end subroutine listed_files

  !> One line of the list: file | exit code | text | text ...
  subroutine check_file(tester, expected)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: expected     !< the line of the list
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(model_type) :: model
    character(len=:), allocatable :: name, fragment, answer
    integer :: at, code

    at = 1
    call next_field(expected, at, name)
    call next_field(expected, at, fragment)
    read (fragment, *) code
    call read_document(tester%tree//folder//name, document, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
    answer = without(printed(diagnostics), tester%tree//folder)
    call tester%is_true(diagnostics%code() == code, name//': exit code '//to_text(code)//', not '// &
                        to_text(diagnostics%code()))
    call tester%is_true(diagnostics%failed() .eqv. len(answer) > 0, name//': something is printed where something is wrong')
    do while (at <= len(expected))
      call next_field(expected, at, fragment)
      call tester%is_true(index(answer, fragment) > 0, name//': the message holds: '//fragment)
      if (index(answer, fragment) == 0) print '(a)', answer
    end do
  end subroutine check_file

  !> A text without the occurrences of a part.
  pure function without(text, part) result(rest)
    character(len=*), intent(in) :: text   !< text that was printed
    character(len=*), intent(in) :: part   !< a folder
    character(len=:), allocatable :: rest
    integer :: at

    rest = text
    do
      at = index(rest, part)
      if (at == 0) return
      rest = rest(:at - 1)//rest(at + len(part):)
    end do
  end function without

  subroutine next_field(text, at, field)
    character(len=*), intent(in) :: text                  !< the line of the list
    integer, intent(inout) :: at                          !< place of the field; then of the next one
    character(len=:), allocatable, intent(out) :: field   !< without blanks around it
    integer :: bar

    bar = index(text(at:)//' | ', ' | ')
    field = text(at:min(at + bar - 2, len(text)))
    at = at + bar + 2
  end subroutine next_field
end module test_malformed
