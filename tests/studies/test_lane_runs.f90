!> Runs of a study side by side: against closed forms of the four-bar linkage, and against the same runs followed alone.
!>
!> Compares the program with itself in part: designs side by side and alone, in other company, with other vectors.
module test_lane_runs
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_done
  use mech9_program_kind, only: kinematics
  use mech9_model, only: model_type
  use mech9_varied_document, only: varied_document_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_study_values, only: values_of_run
  use mech9_lane_starts, only: lane_starts_type
  use mech9_run_maker, only: run_maker_type, made_run_type, most_runs
  use mech9_lane_runs, only: lane_runs_type, lane_failure_type
  use mech9_text_models, only: varied_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character, parameter :: nl = new_line('a')
  !> A four-bar linkage; its ground is coordinate 3's place.
  character(len=*), parameter :: bars = &
    '&mechanism links=4, coordinates=4 /'//nl//'&structure cq=1 /'//nl// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=3, links=1,4, kind=''revolute'', axis=0,0,1, point=0.40,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=4, links=4,3, kind=''revolute'', axis=0,0,1, point=0.30,0,0, moving_point=0.35,0,0 /'//nl// &
    '&initial coordinate=2, position=1.0 /'//nl//'&initial coordinate=3, position=1.8 /'//nl// &
    '&initial coordinate=4, position=-0.8 /'//nl//'&point name=''P'', link=3, position=0.20,0.10,0 /'//nl
  character(len=*), parameter :: turning = '&drive coordinate=1, kind=''polynomial'', coefficients=0,10 /'//nl
  character(len=*), parameter :: one_turn = '&time start=0, end=0.6283185307179586, intervals=90 /'//nl
  !> Quantities of a coordinate and of a point, of all kinds that can be found side by side.
  character(len=*), parameter :: quantities = &
    '&quantity name=''swing'', of=''q3'', take=''range'' /'//nl//'&quantity name=''last'', of=''q3'', take=''end'' /'//nl// &
    '&quantity name=''high'', of=''P.y'', take=''max'' /'//nl//'&quantity name=''speed'', of=''P.vx'', take=''peak'' /'//nl// &
    '&quantity name=''push'', of=''ddq4'', take=''rms'' /'//nl//'&quantity name=''middle'', of=''P.x'', take=''mean'' /'//nl
  character(len=*), parameter :: uniform = ', distribution=''uniform'' /'//nl
  !> All four lengths.
  character(len=*), parameter :: lengths = &
    '&parameter name=''crank'', sets=''pair(2).point(1)'', value=0.15, low=0.12, high=0.16'//uniform// &
    '&parameter name=''ground'', sets=''pair(3).point(1)'', value=0.40, low=0.38, high=0.44'//uniform// &
    '&parameter name=''rocker'', sets=''pair(4).point(1)'', value=0.30, low=0.29, high=0.33'//uniform// &
    '&parameter name=''coupler'', sets=''pair(4).moving_point(1)'', value=0.35, low=0.34, high=0.37'//uniform

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('closed_form')) call closed_form(tester)
    if (tester%runs('four_bars')) call compare(tester, bars//turning//one_turn//quantities//lengths//drawn(27), 'four-bars', 27)
    if (tester%runs('wild_four_bars')) call wild_four_bars(tester)
    if (tester%runs('other_structures')) call other_structures(tester)
    if (tester%runs('starts')) call starts(tester)
    if (tester%runs('any_company')) call any_company(tester)
    if (tester%runs('left_alone')) call left_alone(tester)
  end subroutine run

  !> A study of drawn values.
  function drawn(runs) result(text)
    integer, intent(in) :: runs   !< how many
    character(len=60) :: text

    write (text, '(a,i0,a)') '&study kind=''random'', seed=3, runs=', runs, ' /'
  end function drawn

  !> Swings and last angles of rockers, by the law of cosines.
  subroutine closed_form(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(varied_document_type) :: varied
    type(model_type) :: model
    type(run_maker_type) :: maker
    type(made_run_type) :: made(most_runs)
    real(wp) :: x, y, far
    integer :: i, k

    call varied_from_text(tester, bars//'&drive coordinate=1, kind=''polynomial'', coefficients=0.3,10 /'//nl// &
                          '&time start=0, end=0.7, intervals=360 /'//nl//quantities//lengths//drawn(most_runs), kinematics, &
                          varied, model)
    call maker%begin(model, varied)
    call maker%make_several([(i, i=1, most_runs)], made)
    call tester%is_true(maker%made_at_once() == most_runs, 'all designs were followed side by side')
    do k = 1, most_runs
      associate (crank => made(k)%values(1), ground => made(k)%values(2), rocker => made(k)%values(3), &
                 coupler => made(k)%values(4))
        ! the turning points have errors of the polynomials between outputs; the corrections of positions end at 1e-9 squared
        call tester%near(made(k)%quantities(1), angle(ground, rocker, coupler + crank) - angle(ground, rocker, coupler - crank), &
                         1.0e-9_wp, 'the swing of a rocker')
        ! from the rocker's pivot to the end of the crank
        x = crank*cos(7.3_wp) - ground
        y = crank*sin(7.3_wp)
        far = hypot(x, y)
        call tester%near(made(k)%quantities(2), atan2(y, x) - angle(far, rocker, coupler) + merge(2.0_wp*pi, 0.0_wp, y < 0.0_wp), &
                         1.0e-13_wp, 'the last angle of a rocker')
      end associate
    end do
  end subroutine closed_form

  !> The angle between two sides of a triangle.
  pure real(wp) function angle(a, b, opposite)
    real(wp), intent(in) :: a          !< a side [m]
    real(wp), intent(in) :: b          !< the other one [m]
    real(wp), intent(in) :: opposite   !< the third side [m]

    angle = acos((a**2 + b**2 - opposite**2)/(2.0_wp*a*b))
  end function angle

  !> Compare the runs of a study side by side with the same runs followed alone. Both find positions to round-off; accelerations have
  !> round-off over the least pivot squared, which is above 0.03 of the largest.
  subroutine compare(tester, text, why, at_least, at_most)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of the data file
    character(len=*), intent(in) :: why          !< its name
    integer, intent(in) :: at_least              !< so many of the runs are made side by side
    integer, intent(in), optional :: at_most     !< no more of them are; any number unless given
    type(varied_document_type) :: varied
    type(model_type) :: model
    type(run_maker_type) :: beside, alone
    type(made_run_type) :: made(most_runs), one
    real(wp), parameter :: tol = 1.0e-10_wp
    integer :: first, i, n

    call varied_from_text(tester, text, kinematics, varied, model)
    call beside%begin(model, varied)
    call alone%begin(model, varied, one_by_one=.true.)
    do first = 1, model%request%study%runs, most_runs
      ! the last group has fewer designs than lanes
      n = min(most_runs, model%request%study%runs - first + 1)
      call beside%make_several([(first + i, i=0, n - 1)], made(:n))
      do i = 1, n
        call alone%make(first + i - 1, one)
        call tester%is_true(made(i)%number == first + i - 1, why//': its number')
        call tester%is_true(made(i)%exit_code == one%exit_code, why//': the same exit code')
        call tester%is_true(allocated(made(i)%failure) .eqv. allocated(one%failure), why//': the same end')
        call tester%is_true(.not. any(abs(made(i)%values - one%values) > 0.0_wp), why//': the same values')
        if (one%exit_code /= exit_done) cycle
        call tester%is_true(all(abs(made(i)%quantities - one%quantities) <= tol*max(1.0_wp, abs(one%quantities))), &
                            why//': the same quantities')
      end do
    end do
    call tester%is_true(alone%made_at_once() == 0, why//': one by one, none is made beside others')
    call tester%is_true(beside%made_at_once() >= at_least, why//': runs are made side by side')
    if (present(at_most)) call tester%is_true(beside%made_at_once() <= at_most, why//': others are made alone')
  end subroutine compare

  !> Designs of which many do not close, or come to dead points, each in a group with others that move on.
  subroutine wild_four_bars(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: wild = &
      '&parameter name=''crank'', sets=''pair(2).point(1)'', value=0.15, low=0.05, high=0.4'//uniform// &
      '&parameter name=''ground'', sets=''pair(3).point(1)'', value=0.40, low=0.1, high=0.5'//uniform// &
      '&parameter name=''rocker'', sets=''pair(4).point(1)'', value=0.30, low=0.1, high=0.5'//uniform// &
      '&parameter name=''coupler'', sets=''pair(4).moving_point(1)'', value=0.35, low=0.1, high=0.5'//uniform

    call compare(tester, bars//turning//one_turn//quantities//wild//drawn(120), 'wild four-bars', 20)
    ! near parallelograms, whose branches come near to each other between outputs: no step there can be trusted
    call compare(tester, bars//turning//'&time start=0, end=0.7, intervals=45 /'//nl//quantities// &
                 '&parameter name=''rocker'', sets=''pair(4).point(1)'', value=0.1502, low=0.1501, high=0.1504'//uniform// &
                 '&parameter name=''coupler'', sets=''pair(4).moving_point(1)'', value=0.40, low=0.39995, high=0.40005'//uniform// &
                 drawn(64), 'near parallelograms', 0, at_most=0)
    ! an axis without a direction is refused, and one the other way round turns the other way
    call compare(tester, bars//turning//one_turn//quantities//'&parameter name=''up'', sets=''pair(3).axis(3)'', value=1, '// &
                 'low=-1, high=1, count=7 /'//nl//'&study kind=''grid'' /', 'axes', 3)
    ! backwards in time, from another place, with few outputs
    call compare(tester, bars//'&drive coordinate=1, kind=''harmonic'', mean=0.5, amplitude=1.2, angular_frequency=1 /'//nl// &
                 '&time start=1, end=0, intervals=60 /'//nl//quantities//wild//drawn(60), 'backwards', 10)
  end subroutine wild_four_bars

  !> Other structures, other numbers of coordinates, other planes and units.
  subroutine other_structures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: slider = &
      '&mechanism links=4, coordinates=4 /'//nl//'&structure cq=1 /'//nl// &
      '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
      '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=4, links=1,4, kind=''prismatic'', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /'//nl// &
      '&initial coordinate=4, position=1.2 /'//nl//'&point name=''P'', link=3, position=0.20,0.10,0 /'//nl
    character(len=*), parameter :: swinging = &
      '&mechanism links=4, coordinates=4 /'//nl//'&structure cq=1 /'//nl// &
      '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
      '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=3, links=1,4, kind=''revolute'', axis=0,0,1, point=0.40,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=4, links=4,3, kind=''prismatic'', axis=1,0,0 /'//nl//'&initial coordinate=3, position=3.14 /'//nl// &
      '&initial coordinate=4, position=0.25 /'//nl//'&point name=''P'', link=4, position=0.20,0.10,0 /'//nl
    character(len=*), parameter :: renumbered = &
      '&mechanism links=4, coordinates=4, length_unit=''mm'', angle_unit=''deg'' /'//nl//'&structure cq=4 /'//nl// &
      '&pair coordinate=4, links=1,3, kind=''revolute'', axis=0,-1,0 /'//nl// &
      '&pair coordinate=2, links=3,2, kind=''revolute'', axis=0,-1,0, point=150,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=3, links=1,4, kind=''revolute'', axis=0,-1,0, point=400,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=1, links=4,2, kind=''revolute'', axis=0,-1,0, point=300,0,0, moving_point=350,0,0 /'//nl// &
      '&initial coordinate=2, position=57 /'//nl//'&initial coordinate=3, position=103 /'//nl// &
      '&initial coordinate=1, position=-46 /'//nl//'&point name=''P'', link=2, position=200,0,100 /'//nl// &
      '&drive coordinate=4, kind=''polynomial'', coefficients=0,600 /'//nl//'&time end=0.6, intervals=80 /'//nl// &
      '&parameter name=''crank'', sets=''pair(2).point(1)'', value=150, low=120, high=160'//uniform// &
      '&quantity name=''swing'', of=''q3'', take=''range'' /'//nl//'&quantity name=''push'', of=''ddq1'', take=''rms'' /'//nl// &
      '&quantity name=''high'', of=''P.z'', take=''max'' /'//nl//'&quantity name=''speed'', of=''P.vz'', take=''min'' /'//nl
    character(len=*), parameter :: two_loops = &
      '&mechanism links=6, coordinates=7 /'//nl//'&structure cq=1 /'//nl// &
      '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
      '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=3, links=1,4, kind=''revolute'', axis=0,0,1, point=0.40,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=4, links=4,3, kind=''revolute'', axis=0,0,1, point=0.30,0,0, moving_point=0.35,0,0 /'//nl// &
      '&pair coordinate=5, links=4,5, kind=''revolute'', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=6, links=5,6, kind=''revolute'', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=7, links=1,6, kind=''prismatic'', axis=1,0,0, zero=0,1,0, point=0,-0.1,0, moving_point=0,0,0 /'//nl// &
      '&initial coordinate=2, position=1.0 /'//nl//'&initial coordinate=3, position=1.8 /'//nl// &
      '&initial coordinate=4, position=-0.8 /'//nl//'&initial coordinate=7, position=0.8 /'//nl// &
      '&point name=''P'', link=5, position=0.20,0.10,0 /'//nl

    call compare(tester, slider//'&drive coordinate=1, kind=''polynomial'', coefficients=0.4,10 /'//nl//one_turn//quantities// &
                 '&parameter name=''crank'', sets=''pair(2).point(1)'', value=0.3, low=0.2, high=0.5'//uniform// &
                 '&parameter name=''speed_of_crank'', sets=''drive.coefficients(2)'', value=10, low=8, high=12'//uniform// &
                 drawn(13), 'slider-cranks', 13)
    ! the unit of a slide is the size of the mechanism
    call compare_starts(tester, slider//'&drive coordinate=1, kind=''polynomial'', coefficients=0.1,10 /'//nl// &
                        one_turn//quantities// &
                        '&parameter name=''rod'', sets=''pair(3).point(1)'', value=1.1, low=1.1, high=1.4'//uniform//drawn(13), &
                        'slider-cranks', 5)
    ! a slide on an arm that turns has Coriolis accelerations
    call compare(tester, swinging//turning//'&time start=0, end=0.6283185307179586, intervals=360 /'//nl//quantities// &
                 '&parameter name=''crank'', sets=''pair(2).point(1)'', value=0.15, low=0.1, high=0.2'//uniform//drawn(9), &
                 'slides on arms', 9)
    call compare(tester, renumbered//drawn(11), 'renumbered, in degrees and millimetres', 11)
    call compare(tester, two_loops//turning//one_turn//quantities// &
                 '&quantity name=''stroke'', of=''q7'', take=''range'' /'//nl// &
                 '&parameter name=''crank'', sets=''pair(2).point(1)'', value=0.15, low=0.12, high=0.16'//uniform// &
                 '&parameter name=''rod'', sets=''pair(6).point(1)'', value=0.5, low=0.45, high=0.6'//uniform//drawn(17), &
                 'two chains', 17)
  end subroutine other_structures

  !> Starts of designs that are found in a known plan, against their own assembly.
  subroutine starts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: any_bars = &
      '&parameter name=''crank'', sets=''pair(2).point(1)'', value=0.15, low=0.05, high=0.4'//uniform// &
      '&parameter name=''ground'', sets=''pair(3).point(1)'', value=0.40, low=0.1, high=0.5'//uniform// &
      '&parameter name=''rocker'', sets=''pair(4).point(1)'', value=0.30, low=0.1, high=0.5'//uniform
    !> A linkage that is drawn closed where all coordinates are zero, and begins elsewhere.
    character(len=*), parameter :: drawn_bars = &
      '&mechanism links=4, coordinates=4 /'//nl//'&structure cq=1 /'//nl// &
      '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
      '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=3, links=1,4, kind=''revolute'', axis=0,0,1, point=0.40,0,0, moving_point=0,0,0 /'//nl// &
      '&pair coordinate=4, links=4,3, kind=''revolute'', axis=0,0,1, point=0,0.30,0, moving_point=0.25,0.30,0 /'//nl// &
      '&point name=''P'', link=3, position=0.20,0.10,0 /'//nl
    !> The gap of some of these is above the part of the mechanism's size that counts as closed, that of others below.
    character(len=*), parameter :: with_gaps = &
      '&parameter name=''rocker'', sets=''pair(4).point(2)'', value=0.30, low=0.2994, high=0.3006'//uniform// &
      '&parameter name=''angle'', sets=''drive.coefficients(1)'', value=0.4, low=-0.5, high=0.7'//uniform

    call compare_starts(tester, bars//turning//one_turn//quantities//any_bars//drawn(200), 'four-bars', 10)
    call compare_starts(tester, bars//turning//one_turn//quantities// &
                        '&parameter name=''up'', sets=''pair(3).axis(3)'', value=1, low=-1, high=1, count=7 /'//nl// &
                        '&study kind=''grid'' /', 'axes', 3)
    call compare_starts(tester, drawn_bars//'&drive coordinate=1, kind=''polynomial'', coefficients=0.4,10 /'//nl//one_turn// &
                        quantities//with_gaps//drawn(40), 'drawn closed, or nearly so', 5)
    call compare(tester, drawn_bars//'&drive coordinate=1, kind=''polynomial'', coefficients=0.4,10 /'//nl//one_turn// &
                 quantities//with_gaps//drawn(40), 'drawn closed, or nearly so', 20)
  end subroutine starts

  !> Compare the starts of a study's designs, where they are found in the plan of the data file, with their own: bit for bit.
  subroutine compare_starts(tester, text, why, at_least)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of the data file
    character(len=*), intent(in) :: why          !< its name
    integer, intent(in) :: at_least              !< so many of the starts are found
    type(varied_document_type) :: varied
    type(model_type) :: model, one
    type(plan_type) :: plan
    type(state_type) :: state
    type(lane_starts_type) :: known
    type(error_type), allocatable :: err
    real(wp), allocatable :: values(:)
    integer :: i, s, starts_found
    logical :: found

    call varied_from_text(tester, text, kinematics, varied, model)
    call assemble_model(model, plan, state, err)
    call tester%no_error(err, why//': the design of the data file')
    if (allocated(err)) return
    call known%begin(plan)
    allocate (values(size(model%parameters)))
    starts_found = 0
    do i = 1, model%request%study%runs
      call values_of_run(model%request%study, model%parameters, i, values)
      call varied%at(values, one, err)
      if (allocated(err)) cycle
      call known%find(one, found)
      if (.not. found) cycle
      starts_found = starts_found + 1
      call assemble_model(one, plan, state, err)
      call tester%no_error(err, why//': it closes in its own plan')
      if (allocated(err)) cycle
      call tester%is_true(.not. any(abs(known%state%q - state%q) > 0.0_wp), why//': the same start')
      call tester%is_true(.not. abs(known%plan%length - plan%length) > 0.0_wp .and. &
                          .not. any(abs(known%plan%unit_of - plan%unit_of) > 0.0_wp), why//': the same scales')
      do s = 1, size(plan%planar%steps)
        associate (step => plan%planar%steps(s), other => known%plan%planar%steps(s))
          call tester%is_true(.not. any(abs([step%angle - other%angle, step%place - other%place, step%slide - other%slide]) &
                                        > 0.0_wp), why//': the same numbers of a step')
        end associate
      end do
    end do
    call tester%is_true(starts_found >= at_least, why//': starts are found')
  end subroutine compare_starts

  !> A run has the same bits alone and among others, and by all instructions that the processor has.
  subroutine any_company(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(varied_document_type) :: varied
    type(model_type) :: model, models(most_runs)
    type(run_maker_type) :: maker
    type(made_run_type) :: made(most_runs), one
    type(lane_runs_type) :: widest, narrow
    type(lane_failure_type) :: failures(most_runs)
    type(error_type), allocatable :: err
    real(wp) :: values(4), numbers(6, most_runs), others(6, most_runs)
    logical :: done(most_runs)
    integer :: bits, i

    call varied_from_text(tester, bars//turning//one_turn//quantities//lengths//drawn(40), kinematics, varied, model)
    call maker%begin(model, varied)
    call maker%make_several([(5*i, i=1, most_runs)], made)
    do i = 1, most_runs
      call maker%make(5*i, one)
      call tester%is_true(.not. any(abs(made(i)%quantities - one%quantities) > 0.0_wp), 'alone and among others: the same bits')
      call values_of_run(model%request%study, model%parameters, 5*i, values)
      call varied%at(values, models(i), err)
      call tester%no_error(err, 'a model')
    end do
    call widest%begin(model)
    bits = 128
    do while (bits <= widest%bits)
      call narrow%begin(model)
      narrow%bits = bits
      done = .true.
      call narrow%make(models, others, done, failures)
      call tester%is_true(all(done), 'all are made')
      if (bits == 128) numbers = others
      call tester%is_true(.not. any(abs(numbers - others) > 0.0_wp), 'vectors of other lengths: the same bits')
      bits = 2*bits
    end do
    do i = 1, most_runs
      call tester%is_true(.not. any(abs(numbers(:, i) - made(i)%quantities) > 0.0_wp), 'the widest vectors: the same bits')
    end do
  end subroutine any_company

  !> Studies whose runs are followed one by one: those with stops, and those whose quantities are of other columns.
  subroutine left_alone(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call compare(tester, bars//turning//one_turn//lengths// &
                 '&quantity name=''open'', of=''closure'', take=''end'' /'//nl//drawn(3), 'another column', 0)
    call compare(tester, bars//turning//one_turn//lengths// &
                 '&quantity name=''then'', of=''q3'', take=''at'', at=0.3 /'//nl//drawn(3), 'a time', 0)
    ! steps over a quarter of a radian are too long for a group
    call compare(tester, bars//turning//'&time start=0, end=0.6283185307179586, intervals=20 /'//nl//lengths// &
                 '&quantity name=''swing'', of=''q3'', take=''range'' /'//nl//drawn(3), 'long steps', 0)
  end subroutine left_alone
end module test_lane_runs
