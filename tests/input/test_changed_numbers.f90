!> A model as a function of its parameters: it is the same, bit for bit, whatever values it had before; so are its errors. Derivatives
!> of its constants by parameters: against closed forms, and how many models they take.
module counting_model
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_varied_document, only: varied_document_type
  implicit none
  private
  public :: counting_model_type

  !> A model that counts how often it is evaluated.
  type, extends(variable_model_type) :: counting_model_type
    type(varied_document_type) :: varied
    integer :: evaluations = 0
  contains
    procedure :: at => counted_at
  end type counting_model_type

contains

  !> The model at some values, counted.
  subroutine counted_at(self, values, model, err)
    class(counting_model_type), intent(inout) :: self    !< the model as a function
    real(wp), intent(in) :: values(:)                    !< of the parameters
    type(model_type), intent(out) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    self%evaluations = self%evaluations + 1
    call self%varied%at(values, model, err)
  end subroutine counted_at
end module counting_model

module test_changed_numbers
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_model, only: model_type
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use counting_model, only: counting_model_type
  use mech9_plan, only: plan_type
  use mech9_spanning_tree, only: lay_out_frames
  use mech9_mechanism_constants, only: gather_constants, renew_constants
  use mech9_tangent, only: tangent_type, find_tangent
  use mech9_testing, only: tester_type
  use mech9_input_support, only: slider_crank, eol
  implicit none
  private
  public :: run

  !> Numbers of many groups, some of which need the whole document. The last but one may not be negative, the last one not be zero.
  integer, parameter :: n = 14
  character(len=*), parameter :: targets(n) = [character(len=28) :: 'pair(2).point(1)', 'pair(3).point(1)', 'pair(4).point(2)', &
    'point.position(2)', 'drive.coefficients(2)', 'initial.position', 'load(1).stiffness', 'load(2).amplitude', &
    'gravity.acceleration(2)', 'body(2).centre(1)', 'time.end', 'coupling.phase', 'body(1).mass', 'pair(5).axis(3)']
  real(wp), parameter :: values(n) = [0.3_wp, 1.0_wp, 0.1_wp, 0.0_wp, 10.0_wp, 1.2_wp, 20.0_wp, 1.5_wp, -9.81_wp, 0.5_wp, 0.5_wp, &
                                      0.2_wp, 1.5_wp, 1.0_wp]

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('models_do_not_remember')) call models_do_not_remember(tester)
    if (tester%runs('constants_are_differentiated')) call constants_are_differentiated(tester)
  end subroutine run

  !> A data file with many groups, and a parameter for each of its targets.
  function whole_file() result(text)
    character(len=:), allocatable :: text
    character(len=24) :: number
    integer :: i

    ! a wheel beside the slider-crank turns with the crank
    text = "&structure cq=1 /"//eol//slider_crank(index(slider_crank, '&pair'):)// &
           "&pair coordinate=5, links=1,5, kind='revolute', axis=0,0,1, point=0.5,0,0 /"//eol// &
           "&coupling coordinates=1,5, kind='gear', ratio=2, phase=0.2 /"//eol// &
           "&body link=2, mass=1.5, centre=0.15,0,0, inertia=0,0,0.01,0,0,0 /"//eol// &
           "&body link=3, mass=2, centre=0.5,0,0, inertia=0,0,0.2,0,0,0 /"//eol// &
           "&load kind='spring', links=1,4, stiffness=20 /"//eol// &
           "&load kind='force', link=4, force=1,0,0, law='harmonic', amplitude=1.5, angular_frequency=3 /"//eol// &
           "&gravity acceleration=0,-9.81,0 /"//eol
    do i = 1, n
      write (number, '(i0)') i
      text = text//"&parameter name='p"//trim(number)//"', sets='"//trim(targets(i))//"'"
      if (targets(i) == 'point.position(2)') text = text//", value=0"
      text = text//" /"//eol
    end do
  end function whole_file

  !> The model of a text as a function of its parameters.
  subroutine new_varied(text, varied)
    character(len=*), intent(in) :: text                !< of the data file
    type(varied_document_type), intent(out) :: varied   !< the model
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('f.nml', text), document, diagnostics)
    call new_varied_document(document, diagnostics%sources, kinematics, varied)
  end subroutine new_varied

  !> A model that has had many other values, wrong ones among them, against one that is read for the first time.
  subroutine models_do_not_remember(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(varied_document_type) :: long_used, fresh
    type(model_type) :: model, expected
    type(error_type), allocatable :: err, expected_err
    type(random_type) :: random
    character(len=:), allocatable :: text
    real(wp) :: now(n)
    integer :: trial, i

    text = whole_file()
    call new_varied(text, long_used)
    now = values
    do trial = 1, 300
      ! few numbers change at a time
      i = 1 + int(n*0.5_wp*(1.0_wp + random%symmetric())*0.999999_wp)
      now(i) = values(i) + 0.3_wp*random%symmetric()*max(abs(values(i)), 0.1_wp)
      if (mod(trial, 7) == 0) now(13) = -now(13)
      if (mod(trial, 11) == 0) now(14) = 0.0_wp
      if (mod(trial, 13) == 0) now = values
      call long_used%at(now, model, err)
      call new_varied(text, fresh)
      call fresh%at(now, expected, expected_err)
      call tester%is_true(allocated(err) .eqv. allocated(expected_err), 'a model fails where it would fail at first')
      if (allocated(err) .and. allocated(expected_err)) then
        call tester%is_true(err%message == expected_err%message .and. err%code == expected_err%code .and. &
                            err%place%line == expected_err%place%line .and. err%place%column == expected_err%place%column, &
                            'the error is the same: '//err%message)
      else if (.not. allocated(expected_err)) then
        call compare(tester, model, expected)
      end if
      if (now(13) < 0.0_wp) now(13) = -now(13)
      if (.not. abs(now(14)) > 0.0_wp) now(14) = values(14)
    end do
  end subroutine models_do_not_remember

  !> Two models have the same bits.
  subroutine compare(tester, model, expected)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type), intent(in) :: model        !< a model
    type(model_type), intent(in) :: expected     !< the same model by another way
    real(wp), parameter :: origin(3) = [0.1_wp, 0.2_wp, 0.3_wp]
    real(wp), allocatable :: row(:), expected_row(:)
    integer :: i

    call gather_constants(model, 1.0_wp, origin, row)
    call gather_constants(expected, 1.0_wp, origin, expected_row)
    row = [row, model%mechanism%gravity, model%problem%initial%position, model%request%time%end]
    expected_row = [expected_row, expected%mechanism%gravity, expected%problem%initial%position, expected%request%time%end]
    do i = 1, size(model%mechanism%bodies)
      row = [row, model%mechanism%bodies(i)%mass, model%mechanism%bodies(i)%centre]
      expected_row = [expected_row, expected%mechanism%bodies(i)%mass, expected%mechanism%bodies(i)%centre]
    end do
    call append_loads(model, row)
    call append_loads(expected, expected_row)
    call tester%is_true(size(row) == size(expected_row), 'both models have as many numbers')
    if (size(row) /= size(expected_row)) return
    call tester%is_true(all(transfer(row, [0_long]) == transfer(expected_row, [0_long])), 'the numbers have the same bits')
    call tester%is_true(all(model%problem%partition%kind == expected%problem%partition%kind), 'the same coordinates are driven')
    call tester%is_true(all(abs(model%parameters%value - expected%parameters%value) <= 0.0_wp), 'the parameters have their values')
  end subroutine compare

  !> Append the numbers of the loads.
  subroutine append_loads(model, row)
    use mech9_spring_load, only: spring_load_type
    use mech9_harmonic_law, only: harmonic_law_type
    type(model_type), intent(in) :: model            !< the model
    real(wp), allocatable, intent(inout) :: row(:)   !< the row so far
    integer :: i

    do i = 1, size(model%mechanism%loads)
      select type (load => model%mechanism%loads(i)%load)
      type is (spring_load_type)
        row = [row, load%stiffness, load%free_length]
      end select
      if (.not. allocated(model%mechanism%loads(i)%load%law)) cycle
      select type (law => model%mechanism%loads(i)%load%law)
      type is (harmonic_law_type)
        row = [row, law%amplitude, law%angular_frequency]
      end select
    end do
  end subroutine append_loads

  !> The derivatives of linear constants take four models, those of others eight, and they are those of closed forms.
  subroutine constants_are_differentiated(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(counting_model_type) :: variable
    type(model_type) :: model
    type(plan_type) :: plan
    type(tangent_type) :: tangent
    type(error_type), allocatable :: err
    real(wp), allocatable :: row(:), renewed(:)
    real(wp) :: x

    call new_varied(slider_crank// &
                    "&parameter name='crank', sets='pair(2).point(1)' /"//eol// &
                    "&parameter name='tilt', sets='pair(4).axis(2)', value=0.25 /"//eol, variable%varied)
    call variable%at([0.3_wp, 0.25_wp], model, err)
    if (allocated(err)) call tester%is_true(.false., 'the model is read: '//err%message)
    if (allocated(err)) return
    call lay_out_frames(model%mechanism, model%problem%partition, model%problem%initial%position, plan)
    variable%evaluations = 0
    call find_tangent(variable, model, plan, 1, tangent, err)
    call tester%is_true(.not. allocated(err) .and. variable%evaluations == 4, 'a linear parameter takes four models')
    call tester%near(norm2(tangent%before), 1.0_wp, 1e-14_wp, 'the end of the crank moves as the crank grows')
    variable%evaluations = 0
    call find_tangent(variable, model, plan, 2, tangent, err)
    call tester%is_true(.not. allocated(err) .and. variable%evaluations == 8, 'a direction takes eight models')
    ! the direction (1, x, 0) turns by 1/(1 + x^2)
    x = 0.25_wp
    call tester%near(maxval(abs(tangent%before(1:3, 4))), 1.0_wp/(1.0_wp + x**2), 1e-13_wp, 'a direction turns')

    call gather_constants(model, plan%length, plan%origin, row)
    call variable%at([0.4_wp, 0.3_wp], model, err)
    call renew_constants(model, plan, renewed)
    call gather_constants(model, plan%length, plan%origin, row)
    call tester%is_true(all(transfer(row, [0_long]) == transfer(renewed, [0_long])), 'frames get their numbers as in a new plan')
  end subroutine constants_are_differentiated
end module test_changed_numbers
