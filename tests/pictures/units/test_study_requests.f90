!> The argument of --plot beside --study and --optimize: panels, names, and refusals.
module test_study_requests
  use mech9_error, only: error_type, exit_usage
  use mech9_text, only: string_type
  use mech9_fit_request, only: fit_request_type, read_fit_request
  use mech9_study_request, only: study_request_type, read_study_request
  use mech9_checks, only: has_message
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('panels')) call panels(tester)
    if (tester%runs('refusals')) call refusals(tester)
    if (tester%runs('objectives')) call objectives(tester)
  end subroutine run

  !> Two parameters a, b and two quantities s, u.
  subroutine read_request(text, request, err)
    character(len=*), intent(in) :: text                 !< the argument
    type(study_request_type), intent(out) :: request     !< request for the plots
    type(error_type), allocatable, intent(out) :: err    !< the failure
    type(string_type) :: names(4)

    names(1)%text = 'a'
    names(2)%text = 'b'
    names(3)%text = 's'
    names(4)%text = 'u'
    call read_study_request(text, names, 2, request, err)
  end subroutine read_request

  subroutine panels(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(study_request_type) :: request
    type(error_type), allocatable :: err

    call read_request('x.svg:s,a:u,a:b:s', request, err)
    call tester%no_error(err, 'three panels')
    call tester%is_true(request%target == 'x.svg' .and. .not. request%in_terminal, 'the picture')
    if (size(request%panels) /= 3) return
    call tester%is_true(all(request%panels%n == [1, 2, 3]), 'histogram, scatter and map')
    call tester%is_true(request%panels(1)%columns(1) == 3 .and. all(request%panels(2)%columns(:2) == [1, 4]) .and. &
                        all(request%panels(3)%columns == [1, 2, 3]), 'their columns')
    call read_request('', request, err)
    call tester%is_true(size(request%panels) == 2 .and. all(request%panels%n == 1), 'all quantities without names')
    call read_request('term:a:s', request, err)
    call tester%no_error(err, 'a scatter in the terminal')
    call tester%is_true(request%in_terminal, 'it is shown in the terminal')
  end subroutine panels

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused('term:a:b:s', 'a terminal cannot show a map')
    call refused('a:b:s:u', 'and here are more')
    call refused('x', 'x')
    call refused('s,,u', '--plot')
    call refused('s,u,', '--plot')
    call refused('a,b,s,u,a,b,s,u,a,b,s,u,a', 'at most 12 plots')
  contains
    subroutine refused(text, words)
      character(len=*), intent(in) :: text    !< the argument
      character(len=*), intent(in) :: words   !< part of the message
      type(study_request_type) :: request
      type(error_type), allocatable :: err

      call read_request(text, request, err)
      call has_message(tester, err, exit_usage, words, 'a refusal of '//text)
    end subroutine refused
  end subroutine refusals

  !> Objectives without targets are never drawn.
  subroutine objectives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(string_type) :: names(3)
    type(fit_request_type) :: request
    type(error_type), allocatable :: err

    names(1)%text = 'B'
    names(2)%text = ''
    names(3)%text = 'q4'
    call read_fit_request('', names, request, err)
    call tester%is_true(all(request%wanted .eqv. [.true., .false., .true.]), 'all that have targets')
    call read_fit_request('fit.svg: q4', names, request, err)
    call tester%is_true(all(request%wanted .eqv. [.false., .false., .true.]) .and. request%target == 'fit.svg', 'one of them')
    call read_fit_request('B,C', names, request, err)
    call has_message(tester, err, exit_usage, "none is about 'C'; there are B q4", 'an unknown one')
    call read_fit_request('', names(2:2), request, err)
    call has_message(tester, err, exit_usage, 'no &objective of this file has any', 'no targets')
  end subroutine objectives
end module test_study_requests
