!> Files by which Dakota asks for an evaluation and gets its answer: both forms of the first, refusals with their lines, and the
!> second.
module test_dakota_file
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_dakota_file, only: dakota_request_type, read_dakota, write_dakota_failure, write_dakota_results
  use mech9_checks, only: near_vector, has_message
  use mech9_test_files, only: save_lines, remove_file, text_of_file
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_dakota_file.in', output = 'test_dakota_file.out'
  character(len=40), parameter :: standard(8) = [character(len=40) :: '        2 variables', '  0.3 crank', '  1.5e0 rod', &
    ' 2 functions', '  3 ASV_1:stroke', '  1 ASV_2:speed', ' 1 derivative_variables', '  2 DVV_1:rod']
  character(len=40), parameter :: aprepro(8) = [character(len=40) :: '{ DAKOTA_VARS = 2 }', '{ crank = 0.3 }', '{ rod = 1.5e0 }', &
    '{ DAKOTA_FNS = 2 }', '{ ASV_1:stroke = 3 }', '{ ASV_2:speed = 1 }', '{ DAKOTA_DER_VARS = 1 }', '{ DVV_1:rod = 2 }']

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('both_forms')) call both_forms(tester)
    if (tester%runs('refusals')) call refusals(tester)
    if (tester%runs('answers')) call answers(tester)
  end subroutine run

  subroutine read_lines(tester, lines, request, err)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: lines(:)             !< parameters file
    type(dakota_request_type), intent(out) :: request    !< the evaluation
    type(error_type), allocatable, intent(out) :: err    !< the failure

    call save_lines(tester, path, lines)
    call read_dakota(path, request, err)
    call remove_file(path)
  end subroutine read_lines

  subroutine both_forms(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call check_form(standard)
    call check_form(aprepro)
    call check_form(of_windows(standard))
    call check_form(of_windows(aprepro))
  contains
    !> The same lines with ends as Windows writes them.
    pure function of_windows(lines) result(ended)
      character(len=*), intent(in) :: lines(:)   !< parameters file
      character(len=len(lines) + 1) :: ended(size(lines))
      integer :: i

      do i = 1, size(lines)
        ended(i) = trim(lines(i))//achar(13)
      end do
    end function of_windows

    subroutine check_form(lines)
      character(len=*), intent(in) :: lines(:)   !< parameters file
      type(dakota_request_type) :: request
      type(error_type), allocatable :: err

      call read_lines(tester, lines, request, err)
      call tester%no_error(err, 'an evaluation')
      if (allocated(err)) return
      call near_vector(tester, request%values, [0.3_wp, 1.5_wp], 0.0_wp, 'values')
      call tester%is_true(request%variables(1)%text == 'crank' .and. request%variables(2)%text == 'rod', 'variables')
      call tester%is_true(request%responses(1)%text == 'stroke' .and. request%responses(2)%text == 'speed', 'responses')
      call tester%is_true(all(request%active == [3, 1]) .and. all(request%by == [2]), 'what is asked for')
      call tester%is_true(request%wants(1) .and. request%wants(2) .and. .not. request%wants(4), 'values and gradients')
    end subroutine check_form
  end subroutine both_forms

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused(1, '2 functions', ':1: the number of variables is expected here')
    call refused(1, '-1 variables', ':1: this is no length of a list')
    call refused(1, '3 variables', ':5: the number of functions is expected here')
    call refused(2, '0.3', ':2: a value and a tag are expected')
    call refused(3, 'x rod', ":3: 'x' ")
    call refused(5, '8 ASV_1:stroke', ':5: the active set vector has numbers from 0 to 7')
    call refused(6, '1.5 ASV_2:speed', ':6: the active set vector has numbers from 0 to 7')
    call refused(8, '3 DVV_1:none', ':8: there are 2 variables, and this is the number of none')
    call refused(8, '1.5 DVV_1:none', ':8: there are 2 variables, and this is the number of none')
    call refused(7, '2 derivative_variables', ':9: a value and a tag are expected')
  contains
    subroutine refused(line, text, words)
      integer, intent(in) :: line            !< number of the line that is changed
      character(len=*), intent(in) :: text   !< its new text
      character(len=*), intent(in) :: words  !< part of the message
      character(len=40) :: lines(8)
      type(dakota_request_type) :: request
      type(error_type), allocatable :: err

      lines = standard
      lines(line) = text
      call read_lines(tester, lines, request, err)
      call has_message(tester, err, exit_data, path//words, 'a refusal')
    end subroutine refused
  end subroutine refusals

  !> Values with their descriptors, then gradients in brackets, of those that are asked for.
  subroutine answers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(dakota_request_type) :: request
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    character(len=80) :: words(4)
    real(wp) :: numbers(3)

    call read_lines(tester, standard, request, err)
    call write_dakota_results(output, request, [0.25_wp, -4.0_wp], reshape([1.0_wp/3.0_wp, 9.0_wp], [1, 2]), err)
    call tester%no_error(err, 'an answer')
    call text_of_file(tester, output, text)
    read (text, *) numbers(1), words(1), numbers(2), words(2), words(3), numbers(3), words(4)
    call near_vector(tester, numbers, [0.25_wp, -4.0_wp, 1.0_wp/3.0_wp], 1.0e-15_wp, 'values and the gradient of the first one')
    call tester%is_true(words(1) == 'stroke' .and. words(2) == 'speed' .and. words(3) == '[' .and. words(4) == ']', 'their form')
    call tester%is_true(index(text, '9.0') == 0, 'the gradient that is not asked for is not written')
    call write_dakota_failure(output, 'a bar'//achar(10)//'breaks', err)
    call text_of_file(tester, output, text)
    call tester%is_true(index(text, 'fail a bar') == 1 .and. index(text, achar(10)) == len(text), 'a failure is one line')
    call remove_file(output)
  end subroutine answers
end module test_dakota_file
