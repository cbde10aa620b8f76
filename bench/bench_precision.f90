!> Work and precision of integrated motions: wall time and evaluations of the motion against the error at the end, for
!> all methods of integration over tolerances from 1e-3 to 1e-13.
!>
!> usage: bench_precision TREE PROBLEM full|quick
!> Prints a line of names and a row for each method and tolerance that came to the end. The error is the largest difference of
!> coordinates or of a point's position [rad, m] from tests/reference; where there is no reference, from a run at 1e-13
!> by another method. For Andrews' mechanism, rows of the method `by-hand` are for its equation in one coordinate, derived by hand,
!> by prince-dormand.
program bench_precision
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_clock, only: seconds
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_integration_methods, only: integration_methods
  use mech9_integrator, only: integrator_type, integration_statistics_type
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  use mech9_free_start, only: assemble_free
  use mech9_row_source, only: row_source_type, new_row_source
  use mech9_closed_andrews, only: closed_andrews_type, andrews_angles
  use mech9_bench_support, only: read_data_file, stop_at
  use mech9_bench_basics, only: median, argument
  implicit none

  !> A motion, and the file that holds its true end.
  type :: problem_type
    character(len=14) :: name
    character(len=56) :: data_file
    character(len=36) :: reference     !< empty: none
    real(wp) :: end                    !< [s]
    character(len=72) :: columns       !< of the results, in the order of the reference's columns after the time
  end type problem_type

  type(problem_type), parameter :: problems(7) = [ &
    problem_type('andrews', 'examples/andrews/andrews.nml', 'a03_andrews_ivp.csv', 0.03_wp, 'q1 q2 q3 q4 q5 q6 q7'), &
    problem_type('governor', 'examples/flyball_governor/flyball_governor.nml', 'a05_flyball.csv', 10.0_wp, 'q2'), &
    problem_type('two_windows', 'examples/n_four_bar/n_four_bar_2.nml', 'a02_nfourbar_N2.csv', 10.0_wp, 'B0.x B0.y'), &
    problem_type('forty_windows', 'examples/n_four_bar/n_four_bar_40.nml', 'a02_nfourbar_N40.csv', 10.0_wp, 'B0.x B0.y'), &
    problem_type('bricard', 'examples/bricard/bricard.nml', 'a04_bricard.csv', 9.0_wp, 'P3.x P3.y P3.z'), &
    problem_type('legs', 'bench/data/legs_fall.nml', 'legs_fall.csv', 0.5_wp, &
                 'left_toe.x left_toe.y left_toe.z right_toe.x right_toe.y right_toe.z'), &
    problem_type('slider_crank', 'tests/reference/dynamics_spatial_slider_crank.nml', '', 1.0_wp, 'q1 q5 q7')]

  !> The list of a method ends when its runs have taken this time together, since tighter tolerances would take longer
  !> still [s].
  real(wp), parameter :: patience = 6.0_wp
  !> Runs are repeated for a median until they have taken this time together [s].
  real(wp), parameter :: long_enough = 0.05_wp
  integer, parameter :: most_repetitions = 9

  call run()
contains

  subroutine run()
    type(model_type), target :: model
    real(wp), allocatable :: exact(:), other(:)
    integer :: p, m
    logical :: quick

    do p = size(problems), 1, -1
      if (problems(p)%name == argument(2)) exit
    end do
    if (p == 0) then
      write (error_unit, '(a)') 'no problem of that name'
      stop 1
    end if
    quick = argument(3) == 'quick'
    call read_data_file(argument(1)//'/'//trim(problems(p)%data_file), dynamics, model)
    model%request%time%end = problems(p)%end
    ! the reference holds times from the start on: a quick run ends early
    if (quick) model%request%time%end = problems(p)%end/20
    if (problems(p)%reference /= '') then
      call read_reference(argument(1)//'/tests/reference/'//trim(problems(p)%reference), model%request%time%end, exact)
      other = exact
    else
      call tight_run(model, problems(p), 'prince-dormand', exact)
      call tight_run(model, problems(p), 'verner', other)
    end if
    print '(a)', 'method tolerance error seconds evaluations steps'
    do m = 1, size(integration_methods)
      if (integration_methods(m)%name == 'prince-dormand') then
        call time_method(model, problems(p), trim(integration_methods(m)%name), other, quick)
      else
        call time_method(model, problems(p), trim(integration_methods(m)%name), exact, quick)
      end if
    end do
    if (problems(p)%name == 'andrews') call time_by_hand(model, exact, quick)
  end subroutine run

  subroutine tight_run(model, problem, method, values)
    type(model_type), intent(inout), target :: model   !< the model, whose method and tolerances are set
    type(problem_type), intent(in) :: problem          !< the motion
    character(len=*), intent(in) :: method             !< name of the method
    real(wp), allocatable, intent(out) :: values(:)    !< columns of the problem at the end [rad, m]
    type(error_type), allocatable :: err
    type(integration_statistics_type) :: counts
    real(wp) :: time

    call set_method(model, method, 1.0e-13_wp)
    call integrate(model, problem, values, counts, time, err)
    call stop_at(err, 'the run at 1e-13 by '//method)
  end subroutine tight_run

  subroutine set_method(model, method, tolerance)
    type(model_type), intent(inout), target :: model   !< the model, whose method and tolerances are set
    character(len=*), intent(in) :: method             !< name of the method
    real(wp), intent(in) :: tolerance                  !< relative, and absolute [rad, m, per s]

    model%request%solver%method = method
    model%request%solver%relative_tolerance = tolerance
    model%request%solver%absolute_tolerance = tolerance
  end subroutine set_method

  !> The rows of one method.
  subroutine time_method(model, problem, method, exact, quick)
    type(model_type), intent(inout), target :: model   !< the model, whose method and tolerances are set
    type(problem_type), intent(in) :: problem          !< the motion
    character(len=*), intent(in) :: method             !< name of the method
    real(wp), intent(in) :: exact(:)                   !< columns of the problem at the end [rad, m]
    logical, intent(in) :: quick                       !< a few tolerances, one run each
    type(error_type), allocatable :: err
    type(integration_statistics_type) :: counts
    real(wp), allocatable :: values(:)
    real(wp) :: times(most_repetitions), tolerance, spent
    integer :: power, n

    spent = 0.0_wp
    do power = 3, 13, merge(5, 1, quick)
      tolerance = 10.0_wp**(-power)
      call set_method(model, method, tolerance)
      n = 0
      do
        n = n + 1
        call integrate(model, problem, values, counts, times(n), err)
        if (allocated(err) .or. quick .or. n == most_repetitions .or. sum(times(:n)) > long_enough) exit
      end do
      if (allocated(err)) then
        write (error_unit, '(5a,es7.0,2a)') trim(problem%name), ', ', method, ',', ' tolerance', tolerance, ': ', err%message
        cycle
      end if
      print '(a,2es12.3,es14.5,2i10)', method, tolerance, maxval(abs(values - exact(:size(values)))), median(times(:n)), &
        counts%rate_evaluations, counts%steps
      spent = spent + sum(times(:n))
      if (spent > patience) exit
    end do
  end subroutine time_method

  !> The rows of Andrews' mechanism in one coordinate.
  subroutine time_by_hand(model, exact, quick)
    type(model_type), intent(in) :: model   !< the mechanism, with the crank's start and the times
    real(wp), intent(in) :: exact(:)        !< the seven angles at the end [rad]
    logical, intent(in) :: quick            !< a few tolerances, one run each
    type(integration_statistics_type) :: counts
    real(wp), parameter :: turn = 2.0_wp*acos(-1.0_wp)
    real(wp) :: times(most_repetitions), tolerance, beta, difference(7)
    integer :: power, n

    do power = 3, 13, merge(5, 1, quick)
      tolerance = 10.0_wp**(-power)
      n = 0
      do
        n = n + 1
        call integrate_by_hand(model, tolerance, beta, counts, times(n))
        if (quick .or. n == most_repetitions .or. sum(times(:n)) > long_enough) exit
      end do
      difference = andrews_angles(beta) - exact(:7)
      ! the closed form does not count the turns of the angles after beta
      difference(2:) = difference(2:) - turn*anint(difference(2:)/turn)
      print '(a,2es12.3,es14.5,2i10)', 'by-hand', tolerance, maxval(abs(difference)), median(times(:n)), &
        counts%rate_evaluations, counts%steps
    end do
  end subroutine time_by_hand

  !> Andrews' mechanism in one coordinate from start to end.
  subroutine integrate_by_hand(model, tolerance, beta, counts, time)
    type(model_type), intent(in) :: model                      !< the mechanism, with the crank's start and the times
    real(wp), intent(in) :: tolerance                          !< relative, and absolute [rad, rad/s]
    real(wp), intent(out) :: beta                              !< angle of the crank at the end [rad]
    type(integration_statistics_type), intent(out) :: counts   !< work of the integrator
    real(wp), intent(out) :: time                              !< of the run [s]
    type(closed_andrews_type), target :: system
    type(integrator_type) :: integrator
    type(error_type), allocatable :: err
    real(wp) :: t, y(2), begin

    t = model%request%time%start
    y = [model%problem%initial%position(1), model%problem%initial%velocity(1)]
    begin = seconds()
    call integrator%create(system, 'prince-dormand', tolerance, [tolerance, tolerance], t, y, err)
    do while (.not. allocated(err) .and. t < model%request%time%end)
      call integrator%step(model%request%time%end, t, y, err)
    end do
    time = seconds() - begin
    call stop_at(err, 'Andrews'' mechanism by hand')
    counts = integrator%statistics()
    call integrator%destroy()
    beta = y(1)
  end subroutine integrate_by_hand

  !> One run from start to end: the values there, and the time it took besides reading and planning.
  subroutine integrate(model, problem, values, counts, time, err)
    type(model_type), intent(in), target :: model              !< the model, with method and tolerances
    type(problem_type), intent(in) :: problem                  !< the motion
    real(wp), allocatable, intent(out) :: values(:)            !< columns of the problem at the end [rad, m]
    type(integration_statistics_type), intent(out) :: counts   !< work of the integrator
    real(wp), intent(out) :: time                              !< besides reading and planning [s]
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(plan_type) :: plan
    type(state_type) :: start
    type(free_simulation_type), target :: simulation
    type(row_source_type) :: rows
    real(wp), allocatable :: row(:)
    real(wp) :: begin

    time = 0.0_wp
    call assemble_free(model, plan, start, err)
    if (.not. allocated(err)) call new_free_simulation(model, plan, start, simulation, err)
    if (.not. allocated(err)) then
      call new_row_source(simulation, rows)
      allocate (row(rows%columns%count), source=0.0_wp)
      begin = seconds()
      call rows%row_at(model%request%time%start, row, err)
      if (.not. allocated(err)) call rows%row_at(model%request%time%end, row, err)
      time = seconds() - begin
      call pick(rows%columns%names(:rows%columns%count), row, problem%columns, values)
      counts = simulation%motion%statistics()
    end if
    call simulation%close()
  end subroutine integrate

  !> The columns of these names.
  subroutine pick(names, row, wanted, values)
    type(string_type), intent(in) :: names(:)         !< of all columns
    real(wp), intent(in) :: row(:)                    !< values of all columns
    character(len=*), intent(in) :: wanted            !< names of columns, separated by blanks
    real(wp), allocatable, intent(out) :: values(:)   !< values of these columns
    integer :: at, next, i

    allocate (values(0))
    at = 1
    do while (at <= len_trim(wanted))
      next = at + index(wanted(at:)//' ', ' ') - 1
      do i = 1, size(names)
        if (names(i)%text == wanted(at:next - 1)) values = [values, row(i)]
      end do
      at = next + 1
    end do
  end subroutine pick

  !> The numbers after the time in the row of a time, from lines separated by commas below a line of names. Rows at rounded times
  !> are found within a millionth.
  subroutine read_reference(path, time, values)
    character(len=*), intent(in) :: path              !< of the file
    real(wp), intent(in) :: time                      !< of the row [s]
    real(wp), allocatable, intent(out) :: values(:)   !< the numbers behind the time in that row
    character(len=2000) :: line
    integer :: unit, status, i
    real(wp) :: found

    open (newunit=unit, file=path, action='read', status='old', iostat=status)
    do while (status == 0)
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (verify(line(1:1), '0123456789') /= 0) cycle
      read (line, *) found
      if (abs(found - time) > 1.0e-6_wp*time) cycle
      i = count([(line(i:i) == ',', i=1, len_trim(line))])
      allocate (values(i))
      read (line, *) found, values
      exit
    end do
    close (unit, iostat=status)
    if (allocated(values)) return
    write (error_unit, '(3a,g0)') 'no row in ', path, ' at t = ', time
    stop 1
  end subroutine read_reference
end program bench_precision
