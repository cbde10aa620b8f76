!> --set: values replaced, added, refused, each time seen in the mechanism that comes out.
module test_setting
  use mech9_kinds, only: wp
  use mech9_program_kind, only: kinematics
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_setting, only: apply_setting
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_testing, only: tester_type
  use mech9_input_support, only: printed, slider_crank, eol
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('what_is_set')) call what_is_set(tester)
    if (tester%runs('what_is_refused')) call what_is_refused(tester)
  end subroutine run

  subroutine set(setting, model, answer)
    character(len=*), intent(in) :: setting                !< argument of --set
    type(model_type), intent(out) :: model                 !< with it
    character(len=:), allocatable, intent(out) :: answer   !< text that is printed
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('f.nml', slider_crank), document, diagnostics)
    call apply_setting(document, setting, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
    answer = printed(diagnostics)
  end subroutine set

  subroutine what_is_set(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m
    character(len=:), allocatable :: answer

    call set('time.intervals=7', m, answer)
    call tester%is_true(answer == '' .and. m%request%time%intervals == 7, 'a number is replaced')
    call set(' Time.END = 2.5d0 ', m, answer)
    call tester%is_true(answer == '', 'case and blanks of a setting do not matter')
    call tester%near(m%request%time%end, 2.5_wp, 0.0_wp, 'a real is replaced')
    call set('mechanism.title=O''Brien''s engine, "the" second', m, answer)
    call tester%is_true(answer == '' .and. m%mechanism%title == 'O''Brien''s engine, "the" second', 'a text needs no quotes')
    call set('mechanism.title=''quoted''', m, answer)
    call tester%is_true(answer == '' .and. m%mechanism%title == 'quoted', 'a text may have quotes')
    call set('output.table=/tmp/a b.dat', m, answer)
    call tester%is_true(answer == '' .and. m%request%output%table == '/tmp/a b.dat', 'a group that is not there is added')
    call set('user.parameters=1,2,3', m, answer)
    call tester%is_true(answer == '' .and. size(m%mechanism%parameters) == 3, 'a list is replaced')
    call set('pair(2).point=0.4,0,0', m, answer)
    call tester%is_true(answer == '', 'the second &pair is chosen by its number')
    call set('pair(4).zero(2)=2', m, answer)
    call tester%is_true(answer == '', 'an element of a list is replaced')
    call set('drive.coefficients=0.1, 2*0.5', m, answer)
    call tester%is_true(answer == '', 'the only &drive needs no number')
    call set('structure.c(1,:)=0,1,0,4', m, answer)
    call tester%is_true(answer == '', 'a row of c is replaced')
    call set("point(2).name=Q", m, answer)
    call tester%is_true(index(answer, "--set: &point needs 'link'") == 1, 'a second &point is begun')
  end subroutine what_is_set

  subroutine what_is_refused(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused(tester, 'time.interval=7', "--set: unknown name 'interval' in &time; did you mean 'intervals'?"//eol// &
                 'time.interval=7'//eol//'     ^^^^^^^^')
    call refused(tester, 'tmie.end=7', '--set: unknown group tmie; did you mean &time?')
    call refused(tester, 'time.intervals=many', "--set: 'intervals' takes whole numbers, and many is none"//eol// &
                 'time.intervals=many'//eol//'               ^^^^')
    call refused(tester, 'time.end=1e999', "--set: '1e999' is too large for a number")
    call refused(tester, 'intervals=7', '--set: write --set group.name=value')
    call refused(tester, 'time.intervals', '--set: write --set group.name=value')
    call refused(tester, '', '--set: write --set group.name=value')
    call refused(tester, '.=', '--set: write --set group.name=value')
    call refused(tester, 'time(1:2).end=1', '--set: write --set group.name=value')
    call refused(tester, 'time(', '--set: write --set group.name=value')
    call refused(tester, 'pair.kind=helical', '--set: there are 4 groups &pair; say which one: pair(2)')
    call refused(tester, 'pair(9).kind=helical', '--set: this file has 4 groups &pair only')
    call refused(tester, 'time.end=1 start=0', '--set: the setting ends before this; give one --set for each name')
    call refused(tester, 'time.end=1 /', '--set: the setting ends before this; give one --set for each name')
    call refused(tester, 'time.end=', "--set: a value is missing after this; an empty text is written ''"//eol// &
                 'time.end='//eol//'        ^')
    call refused(tester, "output.table=''", '')
    call refused(tester, 'pair(1).axis=0,0,0', '--set: the axis of pair 1 is zero')
    call refused(tester, 'structure.cq=9', '--set: cq names coordinate 9')
  end subroutine what_is_refused

  !> Each message is the first one that is printed; an empty one means that all is well.
  subroutine refused(tester, setting, message)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: setting      !< argument of --set
    character(len=*), intent(in) :: message      !< the right first message; empty: none
    type(model_type) :: m
    character(len=:), allocatable :: answer

    call set(setting, m, answer)
    if (message == '') then
      call tester%is_true(answer == '', setting//': is accepted')
    else
      call tester%is_true(index(answer, message) == 1, setting//': the message begins with: '//message)
      if (index(answer, message) /= 1) print '(a)', answer
    end if
  end subroutine refused
end module test_setting
