!> Columns of results: their names, their order, and their numbers for a slider-crank whose motion is known.
module test_columns
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_text, only: string_type
  use mech9_columns, only: columns_type, kinematic_columns
  use mech9_checks, only: near_vector
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('names')) call names(tester)
    if (tester%runs('families')) call families(tester)
    if (tester%runs('derivatives')) call derivatives(tester)
    if (tester%runs('numbers')) call numbers(tester)
    if (tester%runs('forces')) call forces(tester)
    if (tester%runs('poses')) call poses(tester)
  end subroutine run

  !> The slider-crank with some settings of its results.
  subroutine with_output(tester, output, model, columns)
    type(tester_type), intent(inout) :: tester     !< counts the checks
    character(len=*), intent(in) :: output         !< items of &output
    type(model_type), intent(out) :: model         !< the model
    type(columns_type), intent(out) :: columns     !< of a run

    call model_from_text(tester, "&mechanism angle_unit='deg', "//slider_crank(11:)// &
      "&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol//"&output "//output//" /"//eol, kinematics, model)
    columns = kinematic_columns(model%mechanism, model%request%output)
  end subroutine with_output

  !> The headings with a blank between them.
  pure function headings(columns) result(text)
    type(columns_type), intent(in) :: columns   !< the columns
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, columns%count
      if (i > 1) text = text//' '
      text = text//columns%names(i)%text
    end do
  end function headings

  subroutine names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(columns_type) :: columns

    call with_output(tester, 'coordinates=4, 1, derivatives=1', model, columns)
    call tester%is_true(headings(columns) == 't q1 q4 dq1 dq4 B.x B.y B.z B.vx B.vy B.vz', 'names: '//headings(columns))
    call tester%is_true(columns%units(2)%text == 'deg' .and. columns%units(3)%text == 'm' .and. columns%units(4)%text == 'deg/s' &
                        .and. columns%units(9)%text == 'm/s', 'units of coordinates, rates and points')
    call with_output(tester, 'derivatives=0', model, columns)
    call tester%is_true(headings(columns) == 't q1 q2 q3 q4 B.x B.y B.z', 'all coordinates by default: '//headings(columns))
    call tester%is_true(columns%count == columns%motion .and. columns%width() == columns%count, 'all of them belong to the motion')
  end subroutine names

  !> A family is a name without its order: the headings of its members differ by dd, d or by a letter behind the point.
  subroutine families(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(columns_type) :: columns
    integer :: i, order, family(0:2)
    character(len=:), allocatable :: name

    call with_output(tester, 'derivatives=2', model, columns)
    do i = 2, columns%count
      call columns%family_of(i, family, order)
      name = columns%names(i)%text
      call tester%is_true(family(order) == i, name//' is in its own family')
      if (any(family < 1) .or. any(family > columns%count)) cycle
      associate (p => columns%names(family(0))%text, v => columns%names(family(1))%text, a => columns%names(family(2))%text)
        if (p(1:1) == 'q') then
          call tester%is_true(v == 'd'//p .and. a == 'dd'//p, 'the family of '//name)
        else
          call tester%is_true(v == p(:2)//'v'//p(3:) .and. a == p(:2)//'a'//p(3:), 'the family of '//name)
        end if
      end associate
    end do
    call columns%family_of(1, family, order)
    call tester%is_true(all(family == 0), 'time has no family')
    call with_output(tester, 'derivatives=1', model, columns)
    call columns%family_of(2, family, order)
    call tester%is_true(all(family == 0), 'without accelerations there are no families')
  end subroutine families

  !> In a file the derivatives of a column by all parameters stand together, in a table those by one parameter.
  subroutine derivatives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(columns_type) :: columns
    type(string_type) :: parameters(2), units_of(2)
    integer, allocatable :: order(:)
    integer :: i, found(2)

    parameters(1)%text = 'a'
    parameters(2)%text = 'b'
    units_of(1)%text = 'kg'
    units_of(2)%text = ''
    call with_output(tester, 'coordinates=1, 4, derivatives=0', model, columns)
    call columns%append_sensitivities(parameters, units_of, .true.)
    call check_units(tester, columns)
    call tester%is_true(columns%count == 16 .and. columns%width() == 16, 'six columns and time, and twelve derivatives less two')
    do i = 2, 6
      found = columns%derivatives_of(i)
      call tester%is_true(columns%names(found(1))%text == 'd('//columns%names(i)%text//')/d(a)' .and. &
                          columns%names(found(2))%text == 'd('//columns%names(i)%text//')/d(b)', 'derivatives of a column')
    end do
    call tester%is_true(all(columns%derivatives_of(1) == 0) .and. all(columns%derivatives_of(8) == 0), 'others have none')
    order = columns%order_in_table()
    call tester%is_true(all([(count(order == i) == 1, i=1, columns%count)]), 'each column comes once in a table')
    call tester%is_true(columns%names(order(7))%text == 'd(q1)/d(a)' .and. columns%names(order(8))%text == 'd(q4)/d(a)', &
                        'the first parameter first')
    call with_output(tester, 'coordinates=1, 4, derivatives=0, poses=.true.', model, columns)
    call columns%append_sensitivities(parameters, units_of, .false.)
    found = columns%derivatives_of(2)
    call tester%is_true(columns%count == 6 .and. all(found == columns%count + columns%poses%width() + [1, 2]), &
                        'derivatives that are not recorded stand behind the poses')
    call tester%is_true(columns%width() == columns%count + columns%poses%width() + 10, 'they have room')
  end subroutine derivatives

  !> Units of derivatives: by a mass, and by a parameter of unknown unit; then by others.
  subroutine check_units(tester, columns)
    type(tester_type), intent(inout) :: tester      !< counts the checks
    type(columns_type), intent(in) :: columns       !< with derivatives
    type(columns_type) :: others

    others = columns
    call check_unit(tester, others, 'm', 1, 'm/kg')
    call check_unit(tester, others, 'm', 2, 'm/b')
    others%parameter_units(1)%text = '1'
    others%parameter_units(2)%text = 'N m'
    call check_unit(tester, others, 'rad/s', 1, 'rad/s')
    call check_unit(tester, others, 'rad/s', 2, 'rad/s/(N m)')
  end subroutine check_units

  !> The unit of a derivative by a parameter.
  subroutine check_unit(tester, columns, unit, parameter, expected)
    type(tester_type), intent(inout) :: tester      !< counts the checks
    type(columns_type), intent(in) :: columns       !< with derivatives
    character(len=*), intent(in) :: unit            !< of what has the derivative
    integer, intent(in) :: parameter                !< number of the parameter
    character(len=*), intent(in) :: expected        !< unit of the derivative
    character(len=:), allocatable :: text

    call columns%find_unit_per(unit, parameter, text)
    call tester%is_true(text == expected, 'unit of a derivative: '//text)
  end subroutine check_unit

  !> At a right angle of the crank the rod lies at sin = -0.3: the slider stands at sqrt(1 - 0.09), and its rate is -0.3 of that of
  !> the crank; the angles are in degrees.
  subroutine numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: pi = acos(-1.0_wp), tol = 1.0e-12_wp   ! chains are closed to round-off
    type(model_type) :: model
    type(columns_type) :: columns
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp) :: row(8)

    call with_output(tester, 'coordinates=1, 2, 4, derivatives=0', model, columns)
    model%problem%initial%position(1) = 0.5_wp*pi
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call tester%no_error(err, 'a plan')
    state%t = 3.0_wp
    call columns%fill(model%mechanism, plan, state, row(:7))
    call columns%convert(row(:7))
    call near_vector(tester, row(:2), [3.0_wp, 90.0_wp], tol, 'time and the crank')
    call tester%near(row(3), -90.0_wp - asin(0.3_wp)*180.0_wp/pi, 1.0e-10_wp, 'the rod against the crank [deg]')
    call near_vector(tester, row(4:7), [sqrt(0.91_wp), sqrt(0.91_wp), 0.0_wp, 0.0_wp], tol, 'the slide and its point')
  end subroutine numbers

  subroutine forces(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(columns_type) :: columns
    real(wp) :: row(15), force(3, 4), moment(3, 4)
    integer :: i

    call with_output(tester, 'coordinates=4, derivatives=0', model, columns)
    call columns%append_forces(model%mechanism, [1], [3])
    call columns%append_energies()
    call tester%is_true(headings(columns) == 't q4 B.x B.y B.z F1 R3.fx R3.fy R3.fz R3.mx R3.my R3.mz E.kinetic E.potential '// &
                        'E.total', 'names: '//headings(columns))
    call tester%is_true(columns%forces() == 7 .and. columns%units(6)%text == 'N m' .and. columns%units(7)%text == 'N', 'units')
    row = 0.0_wp
    force = reshape([(10.0_wp*i, i=1, 12)], [3, 4])
    moment = -force
    call columns%fill_forces([5.0_wp, 6.0_wp, 7.0_wp, 8.0_wp], force, moment, [real(wp) ::], row)
    call near_vector(tester, row(6:12), [5.0_wp, 70.0_wp, 80.0_wp, 90.0_wp, -70.0_wp, -80.0_wp, -90.0_wp], 0.0_wp, 'forces')
    call tester%is_true(all(abs(row([1, 2, 3, 4, 5, 13, 14, 15])) <= 0.0_wp), 'other columns stay')
  end subroutine forces

  !> Origins and rotations of the links, then vertices: the crank is turned, the slider is moved.
  subroutine poses(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: pi = acos(-1.0_wp), tol = 1.0e-12_wp   ! chains are closed to round-off
    type(model_type) :: model
    type(columns_type) :: columns
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: row(:)

    call with_output(tester, 'derivatives=0, poses=.true.', model, columns)
    model%problem%initial%position(1) = 0.5_wp*pi
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    allocate (row(columns%width()), source=0.0_wp)
    ! two vertices of each pair, and one of the point
    call tester%is_true(columns%poses%n_links == 4 .and. columns%poses%width() == 4*12 + 3*(2*4 + 1), 'numbers of poses')
    call columns%fill_poses(plan, state, row)
    associate (origins => row(columns%count + 1:), rotations => row(columns%count + 13:))
      call near_vector(tester, origins(4:9), [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.3_wp, 0.0_wp], tol, 'origins of crank and rod')
      call near_vector(tester, origins(10:12), [sqrt(0.91_wp), 0.0_wp, 0.0_wp], tol, 'the origin of the slider')
      call near_vector(tester, rotations(10:18), [0.0_wp, -1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], tol, &
                       'the rotation of the crank, by rows')
    end associate
    call tester%is_true(all(columns%poses%lines >= 1) .and. all(columns%poses%lines <= 9), 'lines join vertices')
    call tester%is_true(all(columns%poses%vertex_link(columns%poses%lines(1, :)) == &
                            columns%poses%vertex_link(columns%poses%lines(2, :))), 'of one link')
  end subroutine poses
end module test_columns
