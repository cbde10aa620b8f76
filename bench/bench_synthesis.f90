!> Time of an objective of eighteen timed points, and of its gradient by nine parameters, beside positions of a four-bar linkage.
!>
!> usage: bench_synthesis TREE full|quick
!> Prints a line of names and a row: microseconds of a position of the four-bar linkage of bench_positions, of a value and of a
!> gradient, and the ratios of both to the position.
!>
!> usage: bench_synthesis TREE COUNT PART
!> PART is positions, values, gradients or followed: COUNT of them are found once, so that their instructions can be counted. A
!> gradient is found together with the value before it; followed are values of designs whose runs are followed from their starts.
!> Prints the microseconds of each, and the positions that were closed for it.
program bench_synthesis
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_clock, only: seconds
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_reader, only: read_model
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_requested, only: requested_type, requested_by_results, leave_out_unrequested
  use mech9_frame_motion, only: point_motion
  use mech9_driven_simulation, only: assemble_driven
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_bounded_least_squares, only: residual_values_type
  use mech9_synthesis, only: synthesis_type, new_synthesis
  use mech9_design_space, only: design_type, new_design
  use mech9_open_position, only: open_position_type, new_open_position
  use mech9_exact_fit, only: exact_fit_type, new_exact_fit, begin_at
  use mech9_bench_support, only: read_data_file, stop_at
  use mech9_bench_basics, only: median, argument
  implicit none
  !> Changes of the parameters from one design to the next, as parts of them.
  real(wp), parameter :: step = 1.0e-3_wp
  call run()
contains

  subroutine run()
    type(varied_document_type), target :: variable
    type(synthesis_type), target :: synthesis
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err
    character(len=:), allocatable :: part
    integer :: count

    call read_document(argument(1)//'/examples/timed_path/timed_path.nml', document, diagnostics)
    call read_model(document, kinematics, model, diagnostics)
    if (diagnostics%failed()) stop 1
    ! nine parameters: the angle at which the crank starts is held
    model%parameters(size(model%parameters))%has_range = .false.
    call new_varied_document(document, diagnostics%sources, kinematics, variable)
    call assemble_driven(model, plan, start, err)
    if (.not. allocated(err)) call new_synthesis(variable, model, plan, synthesis, err)
    call stop_at(err, 'the synthesis')
    part = argument(2)
    if (part == 'full' .or. part == 'quick') then
      call compare(synthesis, start, argument(1)//'/bench/data/four_bar.nml', merge(15, 3, part == 'full'), &
                   merge(2000, 100, part == 'full'))
    else
      read (part, *) count
      call find_once(synthesis, start, argument(1)//'/bench/data/four_bar.nml', count, argument(3))
    end if
  end subroutine run

  !> Print median times and their ratios.
  subroutine compare(synthesis, start, path, passes, count)
    type(synthesis_type), intent(in), target :: synthesis   !< prepared
    type(state_type), intent(in) :: start                   !< assembled position at the start
    character(len=*), intent(in) :: path                    !< of the data file of the four-bar linkage
    integer, intent(in) :: passes                           !< repetitions for a median
    integer, intent(in) :: count                            !< values in a pass
    real(wp) :: each(4, passes), times(4)
    integer :: pass, i, positions

    do pass = 1, passes
      call time_positions(path, 10*count, each(1, pass))
      call time_values(synthesis, start, count, .false., .false., each(2, pass), positions)
      call time_values(synthesis, start, count, .true., .false., each(3, pass), positions)
      call time_values(synthesis, start, max(1, count/10), .false., .true., each(4, pass), positions)
    end do
    each(3, :) = each(3, :) - each(2, :)
    times = [(median(each(i, :)), i=1, 4)]
    print '(a)', 'position_us value_us gradient_us value_ratio gradient_ratio followed_us'
    print '(6f12.4)', times(1:3), times(2:3)/times(1), times(4)
  end subroutine compare

  !> Find some of one kind, and print the time of each.
  subroutine find_once(synthesis, start, path, count, part)
    type(synthesis_type), intent(in), target :: synthesis   !< prepared
    type(state_type), intent(in) :: start                   !< assembled position at the start
    character(len=*), intent(in) :: path                    !< of the data file of the four-bar linkage
    integer, intent(in) :: count                            !< how many
    character(len=*), intent(in) :: part                    !< one of the parts
    real(wp) :: time
    integer :: positions

    positions = 1
    if (part == 'positions') then
      call time_positions(path, count, time)
    else
      call time_values(synthesis, start, count, part == 'gradients', part == 'followed', time, positions)
    end if
    print '(f10.3,a,i0)', time, ' us, positions: ', positions
  end subroutine find_once

  !> Time of a position of the four-bar linkage and its point [us], with all checks of the branch, as in bench_positions.
  subroutine time_positions(path, count, time)
    character(len=*), intent(in) :: path   !< of its data file
    integer, intent(in) :: count           !< how many, in a turn
    real(wp), intent(out) :: time          !< of each [us]
    type(model_type) :: model
    type(plan_type) :: plan
    type(requested_type) :: requested
    type(state_type) :: start
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: begin, place(3), total
    integer :: i

    call read_data_file(path, kinematics, model)
    model%request%time%intervals = count
    call assemble_driven(model, plan, start, err)
    call stop_at(err, 'the four-bar linkage')
    requested = requested_by_results(model%mechanism, model%request%output)
    requested%derivatives = 0
    call leave_out_unrequested(plan, requested)
    call start_driven_motion(model%problem%drives, plan, start, model%request%time%start, driven, err, derivatives=0)
    total = 0.0_wp
    begin = seconds()
    do i = 1, count
      if (.not. allocated(err)) call advance(model%problem%drives, plan, driven, model%request%time%time(i), err)
      if (allocated(err)) exit
      associate (point => model%mechanism%points(1))
        call point_motion(plan, driven%state, point%link, point%position, place)
      end associate
      total = total + place(1)
    end do
    time = (seconds() - begin)*1.0e6_wp/count
    call stop_at(err, 'the four-bar linkage')
    if (total > huge(total)) stop 1
  end subroutine time_positions

  !> Time of values of the objective, each of a design beside one whose gradient was found, and of gradients [us].
  subroutine time_values(synthesis, start, count, with_gradients, all_followed, time, positions)
    type(synthesis_type), intent(in), target :: synthesis   !< prepared
    type(state_type), intent(in) :: start                   !< assembled position at the start
    integer, intent(in) :: count                            !< how many
    logical, intent(in) :: with_gradients                   !< gradients are found too
    logical, intent(in) :: all_followed                     !< all runs are followed from their starts
    real(wp), intent(out) :: time                           !< of each [us]
    integer, intent(out) :: positions                       !< number that was closed for each value, on average
    type(design_type) :: design
    type(open_position_type) :: position
    type(exact_fit_type) :: fit
    type(residual_values_type) :: values
    real(wp), allocatable :: x(:), y(:, :)
    real(wp) :: begin, total
    logical :: has_value
    integer :: i

    call new_design(synthesis%space, design)
    call new_open_position(design, position)
    call new_exact_fit(synthesis%space, design, position, synthesis%targets, fit)
    call begin_at(start%q, fit)
    allocate (y(0, fit%groups), values%r(fit%rows, fit%groups), values%by_x(fit%rows, fit%n, fit%groups), &
              values%by_y(fit%rows, 0, fit%groups))
    associate (space => synthesis%space)
      x = (space%values(space%varied) - space%low)/(space%high - space%low)
    end associate
    call fit%evaluate(x, y, .false., values, has_value)
    if (has_value) call fit%evaluate(x, y, .true., values, has_value)
    fit%must_follow = all_followed
    total = 0.0_wp
    positions = 0
    begin = seconds()
    do i = 1, count
      fit%work = 0
      call fit%evaluate(x + changes_of(synthesis, i), y, .false., values, has_value)
      if (.not. has_value) stop 'a design has no value'
      if (with_gradients) call fit%evaluate(x, y, .true., values, has_value)
      total = total + values%r(1, 1)
      positions = positions + int(fit%work)
    end do
    time = (seconds() - begin)*1.0e6_wp/count
    positions = positions/count
    if (total > huge(total)) stop 1
  end subroutine time_values

  !> Changes of all parameters from the first design, as parts of their ranges.
  pure function changes_of(synthesis, i) result(parts)
    type(synthesis_type), intent(in) :: synthesis                !< prepared
    integer, intent(in) :: i                                     !< number of the design
    real(wp) :: parts(size(synthesis%space%varied))
    integer :: p

    associate (space => synthesis%space)
      parts = [(step*space%values(space%varied(p))*(modulo(7*i + 3*p, 11) - 5)/5.0_wp, p=1, size(parts))]/(space%high - space%low)
    end associate
  end function changes_of
end program bench_synthesis
