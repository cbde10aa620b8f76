!> Pictures that a run is asked for: by options or the data file, with an ending that tells the kind and a view.
module test_picture_requests
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data, exit_usage
  use mech9_command_line, only: command_line_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_data_file, only: data_file_type
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_checks, only: has_message
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_test_files, only: remove_file, text_of_file, text_of_unit
  use mech9_testing, only: tester_type
  use option_words, only: options_of
  implicit none
  private
  public :: run

  character(len=*), parameter :: driven = slider_crank// &
    "&drive coordinate=1, kind='polynomial', coefficients=0.2, 3 /"//eol//'&time end=2, intervals=30 /'//eol

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('options_first')) call options_first(tester)
    if (tester%runs('endings')) call endings(tester)
    if (tester%runs('views')) call views(tester)
    if (tester%runs('start')) call start(tester)
  end subroutine run

  !> The requests of a command line and the lines of a data file.
  subroutine ask(tester, line, more, requests, err)
    type(tester_type), intent(inout) :: tester             !< counts the checks
    character(len=*), intent(in) :: line                   !< command line
    character(len=*), intent(in) :: more                   !< further groups of the data file
    type(picture_requests_type), intent(out) :: requests   !< pictures
    type(error_type), allocatable, intent(out) :: err      !< allocated if they are refused
    type(data_file_type) :: given
    type(command_line_type) :: options

    call model_from_text(tester, driven//more, kinematics, given%model)
    call options_of(tester, line, options)
    call read_picture_requests(options, given, requests, err)
  end subroutine ask

  !> Options come before names of the data file.
  subroutine options_first(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: groups = "&output sketch='a.svg', animation='a.html' /"//eol
    type(picture_requests_type) :: requests
    type(error_type), allocatable :: err

    call ask(tester, 'a.nml', '', requests, err)
    call tester%is_true(.not. requests%any_wanted() .and. .not. allocated(requests%view), 'no picture')
    call ask(tester, 'a.nml', groups, requests, err)
    call tester%is_true(requests%sketch == 'a.svg' .and. requests%animations(1)%text == 'a.html', 'those of the data file')
    call ask(tester, 'a.nml --animate b.gif', groups, requests, err)
    call tester%no_error(err, 'a film of the options')
    call tester%is_true(requests%sketch == 'a.svg' .and. requests%animations(1)%text == 'b.gif', 'an option takes the place of one')
    call tester%is_true(requests%any_wanted(), 'pictures')
  end subroutine options_first

  !> The ending tells the kind, in capitals too; a wrong one is an error of its place.
  subroutine endings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: right(*) = [character(len=9) :: 'b.html', 'b.htm', 'b.HTML', 'b.svg', 'b.gif', 'd.x/b.Gif']
    type(picture_requests_type) :: requests
    type(error_type), allocatable :: err
    integer :: i

    do i = 1, size(right)
      call ask(tester, 'a.nml --animate '//trim(right(i)), '', requests, err)
      call tester%no_error(err, trim(right(i)))
    end do
    call ask(tester, 'a.nml --animate b.avi', '', requests, err)
    call has_message(tester, err, exit_usage, "'b.avi' is no name of a moving picture", 'a film of another kind')
    call ask(tester, 'a.nml --sketch b.gif', '', requests, err)
    call tester%has_error(err, exit_usage, 'a sketch of another kind')
    call ask(tester, 'a.nml', "&output sketch='svg' /"//eol, requests, err)
    call has_message(tester, err, exit_data, 'it must end in .svg', 'a sketch without an ending')
  end subroutine endings

  !> A view is a unit vector towards the eye; a wrong one is an error of its place.
  subroutine views(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(picture_requests_type) :: requests
    type(error_type), allocatable :: err

    call ask(tester, 'a.nml --sketch b.svg --view 0,0,2', '', requests, err)
    call tester%no_error(err, 'a view along z')
    call tester%is_true(allocated(requests%view), 'the view')
    if (allocated(requests%view)) call tester%near(requests%view%toward(3), 1.0_wp, 1.0e-15_wp, 'its direction')
    call ask(tester, 'a.nml --sketch b.svg --view nowhere', '', requests, err)
    call tester%has_error(err, exit_usage, 'no view')
    call ask(tester, 'a.nml --sketch b.svg', "&output view='nowhere' /"//eol, requests, err)
    call tester%has_error(err, exit_data, 'no view in the data file')
  end subroutine views

  !> The assembled position gives the sketch and no film.
  subroutine start(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: sketch = 'test_picture_requests.svg', film = 'test_picture_requests.html'
    type(data_file_type) :: given
    type(command_line_type) :: options
    type(picture_requests_type) :: requests
    type(plan_type) :: plan
    type(state_type) :: position
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer :: unit
    logical :: exists

    call remove_file(sketch)
    call remove_file(film)
    call model_from_text(tester, driven, kinematics, given%model)
    call options_of(tester, 'a.nml --sketch '//sketch//' --animate '//film, options)
    call read_picture_requests(options, given, requests, err)
    call assemble_model(given%model, plan, position, err)
    call tester%no_error(err, 'the start')
    call requests%save_start(given%model, plan, position, err)
    call tester%no_error(err, 'the sketch is saved')
    inquire (file=film, exist=exists)
    call tester%is_true(.not. exists, 'no film')
    call text_of_file(tester, sketch, text)
    call tester%is_true(index(text, '<svg') > 0 .and. index(text, '</svg>') > 0 .and. index(text, 'Slider-crank') > 0, 'the sketch')
    call remove_file(sketch)
    open (newunit=unit, file='test_picture_words.txt')
    call requests%print_words(unit)
    call text_of_unit(tester, unit, text)
    call tester%is_true(text == 'sketch: '//sketch//eol//'animation: '//film//eol, 'the words name both')
  end subroutine start
end module test_picture_requests
