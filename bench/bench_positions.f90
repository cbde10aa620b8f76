!> Time per position of driven mechanisms, against the closed form of the four-bar linkage in the same run.
!>
!> usage: bench_positions TREE full|quick
!> Prints a line of names and a row for each mechanism: its name, microseconds a position for positions
!> only and for velocities and accelerations too, each with one point, and the ratios of both to the closed form.
program bench_positions
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_clock, only: seconds
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_requested, only: requested_type, requested_by_results, leave_out_unrequested
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_driven_simulation, only: assemble_driven
  use mech9_closed_four_bar, only: four_bar_position, four_bar_motion
  use mech9_bench_support, only: read_data_file, stop_at
  use mech9_bench_basics, only: median, argument
  use mech9_frame_motion, only: point_motion
  implicit none
  call run()
contains

  subroutine run()
    character(len=:), allocatable :: tree
    integer :: passes, positions
    real(wp) :: closed(2)

    tree = argument(1)
    passes = merge(3, 15, argument(2) == 'quick')
    positions = merge(500, 10000, argument(2) == 'quick')
    print '(a)', 'mechanism position_us motion_us position_ratio motion_ratio error'
    call time_closed_form(passes, positions, closed)
    print '(a,2f12.5,2f10.2,a)', 'closed_form', closed, 1.0, 1.0, ' 0'
    call time_mechanism('four_bar', tree//'/bench/data/four_bar.nml', passes, positions, closed)
    call time_mechanism('six_bar', tree//'/bench/data/six_bar.nml', passes, positions, closed)
    call time_mechanism('fig1', tree//'/examples/fig1/fig1.nml', passes, positions, closed)
    call time_mechanism('rsur', tree//'/examples/rsur/rsur.nml', passes, positions, closed)
    call time_mechanism('stewart_gough', tree//'/examples/stewart_gough/stewart_gough.nml', passes, positions/4, closed)
    call time_mechanism('legs', tree//'/bench/data/legs_step.nml', passes, positions/4, closed)
  end subroutine run

  !> Median times of the closed form [us]: position, and position, velocity and acceleration.
  subroutine time_closed_form(passes, positions, times)
    integer, intent(in) :: passes       !< repetitions for a median
    integer, intent(in) :: positions    !< in a turn
    real(wp), intent(out) :: times(2)   !< of a position; of position, velocity and acceleration [us]
    real(wp) :: each(2, passes), begin, angle, point(2), velocity(2), acceleration(2), total
    integer :: pass, i

    total = 0.0_wp
    do pass = 1, passes
      begin = seconds()
      do i = 0, positions - 1
        angle = 2.0_wp*acos(-1.0_wp)*i/positions
        call four_bar_position(angle, point)
        total = total + point(1)
      end do
      each(1, pass) = seconds() - begin
      begin = seconds()
      do i = 0, positions - 1
        angle = 2.0_wp*acos(-1.0_wp)*i/positions
        call four_bar_motion(angle, 10.0_wp, point, velocity, acceleration)
        total = total + acceleration(1)
      end do
      each(2, pass) = seconds() - begin
    end do
    times = [median(each(1, :)), median(each(2, :))]/positions*1.0e6_wp
    ! the sum is used, so that the loops are not optimised away
    if (total > huge(total)) times = 0.0_wp
  end subroutine time_closed_form

  subroutine time_mechanism(name, path, passes, positions, closed)
    character(len=*), intent(in) :: name   !< of the mechanism in the printed row
    character(len=*), intent(in) :: path   !< of its data file
    integer, intent(in) :: passes          !< repetitions for a median
    integer, intent(in) :: positions       !< in a cycle
    real(wp), intent(in) :: closed(2)      !< times of the closed form: of a position; with derivatives [us]
    type(model_type) :: model
    type(plan_type) :: plan, lean
    type(requested_type) :: requested
    type(state_type) :: start
    type(error_type), allocatable :: err
    real(wp) :: each(2, passes), error
    integer :: pass

    call read_data_file(path, kinematics, model)
    model%request%time%intervals = positions
    call assemble_driven(model, plan, start, err)
    call stop_at(err, name)
    lean = plan
    requested = requested_by_results(model%mechanism, model%request%output)
    call leave_out_unrequested(plan, requested)
    requested%derivatives = 0
    call leave_out_unrequested(lean, requested)
    do pass = 1, passes
      call time_positions(model, lean, start, each(1, pass))
      call time_motion(model, plan, start, name == 'four_bar', each(2, pass), error)
    end do
    each = each/positions*1.0e6_wp
    print '(a,2f12.5,2f10.2,es10.2)', name, median(each(1, :)), median(each(2, :)), median(each(1, :))/closed(1), &
      median(each(2, :))/closed(2), error
  end subroutine time_mechanism

  !> Time for the positions of all coordinates and of the last point, with all checks of the branch.
  subroutine time_positions(model, plan, start, time)
    type(model_type), intent(in) :: model           !< the model
    type(plan_type), intent(in) :: plan             !< its plan, without the parts that positions do not need
    type(state_type), intent(in) :: start           !< assembled position at the start
    real(wp), intent(out) :: time                   !< of all positions together [s]
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: begin, positions(3, model%request%time%intervals)
    integer :: i

    call start_driven_motion(model%problem%drives, plan, start, model%request%time%start, driven, err, derivatives=0)
    call stop_at(err, model%mechanism%title)
    begin = seconds()
    do i = 1, model%request%time%intervals
      call advance(model%problem%drives, plan, driven, model%request%time%time(i), err)
      if (allocated(err)) exit
      associate (point => model%mechanism%points(size(model%mechanism%points)))
        call point_motion(plan, driven%state, point%link, point%position, positions(:, i))
      end associate
    end do
    time = seconds() - begin
    call stop_at(err, model%mechanism%title)
  end subroutine time_positions

  !> Time for positions, velocities and accelerations of all coordinates and of the last point, with all checks of the branch.
  subroutine time_motion(model, plan, start, compare, time, error)
    type(model_type), intent(in) :: model       !< the model
    type(plan_type), intent(in) :: plan             !< its plan
    type(state_type), intent(in) :: start           !< assembled position at the start
    logical, intent(in) :: compare                  !< with the closed form, after the clock has stopped
    real(wp), intent(out) :: time                   !< of all positions together [s]
    real(wp), intent(out) :: error   !< largest one of the accelerations over the largest acceleration; 0 where not compared
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: begin, motions(3, 3, 0:model%request%time%intervals), exact(2, 3), largest
    integer :: i

    call start_driven_motion(model%problem%drives, plan, start, model%request%time%start, driven, err)
    call stop_at(err, model%mechanism%title)
    associate (point => model%mechanism%points(size(model%mechanism%points)))
      call point_motion(plan, driven%state, point%link, point%position, motions(:, 1, 0), motions(:, 2, 0), motions(:, 3, 0))
      begin = seconds()
      do i = 1, model%request%time%intervals
        call advance(model%problem%drives, plan, driven, model%request%time%time(i), err)
        if (allocated(err)) exit
        call point_motion(plan, driven%state, point%link, point%position, motions(:, 1, i), motions(:, 2, i), motions(:, 3, i))
      end do
      time = seconds() - begin
    end associate
    call stop_at(err, model%mechanism%title)
    error = 0.0_wp
    if (.not. compare) return
    largest = 0.0_wp
    do i = 0, model%request%time%intervals
      call four_bar_motion(10.0_wp*model%request%time%time(i), 10.0_wp, exact(:, 1), exact(:, 2), exact(:, 3))
      error = max(error, maxval(abs(motions(:2, 3, i) - exact(:, 3))))
      largest = max(largest, maxval(abs(exact(:, 3))))
    end do
    error = error/largest
  end subroutine time_motion
end program bench_positions
