!> Parameters: the numbers that they set, their values by --set, what is refused, and the model at other values.
module test_parameters
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_setting, only: apply_setting
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_pair, only: screw_factors_type
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_testing, only: tester_type
  use mech9_input_support, only: printed, slider_crank, eol
  implicit none
  private
  public :: run

  !> The slider-crank with masses; the crank's length is that of point(1) of the second pair.
  character(len=*), parameter :: bodies = slider_crank// &
    "&body link=2, mass=1.5, centre=0.15,0,0 /"//eol// &
    "&load kind='spring', links=1,4, stiffness=20 /"//eol
  character(len=*), parameter :: crank = &
    "&parameter name='crank', sets='pair(2).point(1)','body.centre(1)', factors=1,0.5, value=0.4 /"

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('numbers_are_set')) call numbers_are_set(tester)
    if (tester%runs('the_later_decides')) call the_later_decides(tester)
    if (tester%runs('wrong_parameters_are_refused')) call wrong_parameters_are_refused(tester)
    if (tester%runs('models_at_other_values')) call models_at_other_values(tester)
  end subroutine run

  !> The model of a data file with groups added to it, and up to two settings.
  subroutine read_with(groups, model, answer, first, second)
    character(len=*), intent(in) :: groups                 !< added to the data file
    type(model_type), intent(out) :: model                 !< its model
    character(len=:), allocatable, intent(out) :: answer   !< text that is printed
    character(len=*), intent(in), optional :: first        !< argument of the first --set
    character(len=*), intent(in), optional :: second       !< argument of the second one
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('f.nml', bodies//groups), document, diagnostics)
    if (present(first)) call apply_setting(document, first, diagnostics)
    if (present(second)) call apply_setting(document, second, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
    answer = printed(diagnostics)
  end subroutine read_with

  subroutine numbers_are_set(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    character(len=:), allocatable :: answer
    real(wp) :: by_hand

    call read_with('', model, answer, 'pair(2).point(1)=0.4')
    by_hand = crank_of(model)
    call read_with(crank, model, answer)
    call tester%is_true(answer == '', 'a parameter that sets two numbers is read: '//answer)
    call tester%near(crank_of(model), by_hand, 0.0_wp, 'the point of the pair is that of a file with this number')
    call tester%near(model%mechanism%bodies(1)%centre(1), 0.2_wp, 0.0_wp, 'the centre is half of it')
    call tester%near(model%parameters(1)%value, 0.4_wp, 0.0_wp, 'the value is kept')

    call read_with("&parameter name='a', sets='pair(2).point(1)', factors=2, terms=0.1 /", model, answer)
    call tester%near(model%parameters(1)%value, 0.1_wp, 1e-16_wp, 'without value, 0.3 stays: 2 x 0.1 + 0.1')
    call read_with("&parameter name='a', sets='load.damping' /", model, answer)
    call tester%is_true(answer == '' .and. abs(model%parameters(1)%value) <= 0.0_wp, 'a default can be varied')
    call read_with("&parameter name='a', sets='pair(2).moving_point(2)', value=0.1, low=0, high=1, count=5 /", model, answer)
    call tester%is_true(answer == '' .and. model%parameters(1)%has_range .and. model%parameters(1)%count == 5, 'a range is read')
    call read_with("&parameter name='a', sets='pair(2).point(1)', spread=0.1, distribution='uniform' /", model, answer)
    call tester%is_true(answer == '' .and. model%parameters(1)%uniform, 'a distribution is read')
  end subroutine numbers_are_set

  !> The place of the second pair in the crank: the length of the crank [m].
  real(wp) function crank_of(model)
    type(model_type), intent(in) :: model   !< of the slider-crank
    type(screw_factors_type) :: factors
    logical :: is_screw

    call model%mechanism%pairs(2)%pair%as_screw(factors, is_screw)
    crank_of = factors%before%p(1)
  end function crank_of

  subroutine the_later_decides(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    character(len=:), allocatable :: answer

    call read_with(crank, model, answer, 'parameter.value=0.5')
    call tester%near(crank_of(model), 0.5_wp, 0.0_wp, '--set gives the value of a parameter')
    call read_with(crank, model, answer, 'parameter(1).value=0.5', 'pair(2).point(1)=0.6')
    call tester%near(crank_of(model), 0.6_wp, 0.0_wp, 'a later --set for one of its numbers decides')
    call tester%near(model%mechanism%bodies(1)%centre(1), 0.25_wp, 0.0_wp, 'and the parameter sets the others')
    call tester%is_true(model%parameters(1)%note == "--set pair(2).point(1)=0.6 decides, not parameter 'crank'", 'this is told')
    call read_with(crank, model, answer, 'pair(2).point(1)=0.6', 'parameter(1).value=0.5')
    call tester%near(crank_of(model), 0.5_wp, 0.0_wp, 'a later value of the parameter decides')
    call tester%is_true(model%parameters(1)%note == '--set parameter(1).value=0.5 stands after --set pair(2).point(1)=0.6 '// &
                        'and decides', 'this is told, too')
    call read_with("&parameter name='a', sets='pair(2).point(1)', value=0.4 /", model, answer, 'pair(2).point=0.6,0,0')
    call tester%near(model%parameters(1)%value, 0.6_wp, 0.0_wp, 'a parameter takes its value from the only number that it sets')
    call read_with(crank, model, answer, 'pair(2).point(1)=0.6', 'body.centre(1)=0.1')
    call tester%is_true(index(answer, 'and none is left') > 0, 'a parameter that sets nothing is refused')
  end subroutine the_later_decides

  subroutine wrong_parameters_are_refused(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call refused(tester, "sets='bodi(1).mass'", "f.nml:13:27: unknown group 'bodi'; did you mean 'body'?")
    call refused(tester, "sets='pair(2).piont(1)'", "unknown name 'piont' in &pair; did you mean 'point'?")
    call refused(tester, "sets='pair(9).point(1)'", 'this file has 4 groups &pair only')
    call refused(tester, "sets='body(2).mass'", 'this file has 1 group &body only')
    call refused(tester, "sets='pair.point(1)'", 'there are 4 groups &pair; say which one: pair(2).point')
    call refused(tester, "sets='gravity.acceleration(2)'", 'there is no &gravity in this file')
    call refused(tester, "sets='pair(2).point'", "'point' has 3 numbers; say which one: 'point(2)'")
    call refused(tester, "sets='pair(2).point(4)'", "'point' has 3 numbers only")
    call refused(tester, "sets='pair(2).kind'", "'kind' is a word, and a parameter is a real number")
    call refused(tester, "sets='pair(2).coordinate'", "'coordinate' takes whole numbers, and a parameter is a real number")
    call refused(tester, "sets='output.poses'", "there is no &output in this file")
    call refused(tester, "sets='pair(2).pitch'", "'pitch' does not belong to this kind of &pair")
    call refused(tester, "sets='pair(1).moving_point(1)'", "this &pair does not give 'moving_point'; write it")
    call refused(tester, "sets='parameter.low'", 'not of &parameter')
    call refused(tester, "sets='pair'", 'write the name of a number as group.name, or group(2).name(3)')
    call refused(tester, "sets='pair(2)point(1)'", 'write the name of a number as group.name, or group(2).name(3)')
    call refused(tester, "sets='pair(2).point(1:2)'", 'write the name of a number as group.name, or group(2).name(3)')
    call refused(tester, "sets=''", 'write the name of a number')
    call refused(tester, "sets='pair(2).point(1)','pair(2).point(2)'", "parameter 'a' sets 2 numbers; give its 'value'")
    call refused(tester, "sets='pair(2).point(1)', factors=1,2", "'sets' names 1 numbers, and 'factors' has 2")
    call refused(tester, "sets='pair(2).point(1)', factors=0", 'a factor of 0 takes the effect from the parameter')
    call refused(tester, "sets='pair(2).point(1)', low=1", "a parameter has both 'low' and 'high', or neither")
    call refused(tester, "sets='pair(2).point(1)', low=1, high=1", "'high' must be greater than 'low'")
    call refused(tester, "sets='load.stiffness', value=-3", "parameter 'a' sets load.stiffness to -3, and 'stiffness' must be >=0")
    call refused(tester, "sets='pair(2).point(1)', value=1e99, factors=1e9", 'which is too large or too small')
    call refused(tester, "sets='pair(2).point(1)','pair( 2 ).point(1)', value=1", "this number is named twice")
    call refused(tester, "sets='pair(2).point(1)' / &parameter name='b', sets='PAIR(2).Point(1)'", &
                 "parameter 'a' sets this number already")
    call refused(tester, "sets='pair(2).point(1)' / &parameter name='a', sets='pair(2).point(2)'", &
                 "a second &parameter for name 'a'")
    call refused(tester, "sets='pair(2).point(1)' / &parameter name='b c', sets='pair(2).point(2)'", "'name' must be of letters")
  end subroutine wrong_parameters_are_refused

  !> Expect a message for a parameter.
  subroutine refused(tester, names, message)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: names        !< of the group &parameter, but its name
    character(len=*), intent(in) :: message      !< a part of what is printed
    type(model_type) :: model
    character(len=:), allocatable :: answer

    call read_with("&parameter name='a', "//names//' /', model, answer)
    call tester%is_true(index(answer, message) > 0, names//' says: '//message//'; it said '//answer)
  end subroutine refused

  subroutine models_at_other_values(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(varied_document_type) :: varied
    type(model_type) :: model
    type(error_type), allocatable :: err

    call parse_document(source_from_text('f.nml', bodies//crank//" &parameter name='k', sets='load.stiffness' /"), document, &
                        diagnostics)
    call new_varied_document(document, diagnostics%sources, kinematics, varied)
    call varied%at([0.6_wp, 30.0_wp], model, err)
    call tester%is_true(.not. allocated(err), 'a model at other values is made')
    call tester%near(crank_of(model), 0.6_wp, 0.0_wp, 'its crank is longer')
    call tester%near(model%mechanism%bodies(1)%centre(1), 0.3_wp, 0.0_wp, 'its centre follows')
    call tester%near(model%parameters(2)%value, 30.0_wp, 0.0_wp, 'its parameters have these values')
    call varied%at([0.6_wp, -30.0_wp], model, err)
    call tester%is_true(allocated(err), 'a number outside its range is refused')
    if (allocated(err)) call tester%is_true(index(err%message, 'must be >=0') > 0, 'with its range: '//err%message)
    call varied%at([0.3_wp, 0.0_wp], model, err)
    call tester%is_true(.not. allocated(err), 'and the next values are taken')
    call tester%near(crank_of(model), 0.3_wp, 0.0_wp, 'with their crank')
  end subroutine models_at_other_values
end module test_parameters
