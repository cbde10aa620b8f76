!> Work of an objective of eighteen timed points and of its gradient by nine parameters, beside positions of the same linkage.
!>
!> usage: bench_synthesis TREE COUNT PART
!> PART is positions, values or gradients: COUNT of them are found, so that their instructions can be counted; a position is one of the
!> run of 360 in the file. Prints the microseconds of each.
program bench_synthesis
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
  use mech9_driven_simulation, only: assemble_driven
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_bounded_least_squares, only: residual_values_type
  use mech9_synthesis, only: synthesis_type, new_synthesis
  use mech9_design_space, only: design_type, new_design
  use mech9_open_position, only: open_position_type, new_open_position
  use mech9_exact_fit, only: exact_fit_type, new_exact_fit
  use mech9_bench_support, only: stop_at
  use mech9_bench_basics, only: argument
  implicit none
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
    character(len=:), allocatable :: number
    integer :: count

    number = argument(2)
    read (number, *) count
    call read_document(argument(1)//'/examples/timed_path/timed_path.nml', document, diagnostics)
    call read_model(document, .true., model, diagnostics)
    if (diagnostics%failed()) stop 1
    ! nine parameters: the angle at which the crank starts is held
    model%parameters(size(model%parameters))%has_range = .false.
    call new_varied_document(document, diagnostics%sources, .true., variable)
    call assemble_driven(model, plan, start, err)
    if (.not. allocated(err)) call new_synthesis(variable, model, plan, synthesis, err)
    call stop_at(err, 'the synthesis')
    if (argument(3) == 'positions') then
      call find_positions(model, plan, start, count)
    else
      call find_values(synthesis, start, count, argument(3) == 'gradients')
    end if
  end subroutine run

  !> Find positions of the linkage, with all checks of the branch.
  subroutine find_positions(model, plan, start, count)
    type(model_type), intent(in) :: model    !< the model
    type(plan_type), intent(in) :: plan      !< its plan
    type(state_type), intent(in) :: start    !< assembled position at the start
    integer, intent(in) :: count             !< how many
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: begin
    integer :: i

    call start_driven_motion(model%problem%drives, plan, start, 0.0_wp, driven, err, derivatives=0)
    begin = seconds()
    do i = 1, count
      if (.not. allocated(err)) call advance(model%problem%drives, plan, driven, &
                                             model%request%time%start + (model%request%time%end - model%request%time%start) &
                                             *modulo(i, 360)/360.0_wp, err)
    end do
    call stop_at(err, 'the motion')
    print '(a,f10.3)', 'position_us', (seconds() - begin)*1.0e6_wp/count
  end subroutine find_positions

  !> Find values of the objective, each of a design a little beside the last one, and gradients.
  subroutine find_values(synthesis, start, count, with_gradients)
    type(synthesis_type), intent(in), target :: synthesis   !< prepared
    type(state_type), intent(in) :: start                   !< assembled position at the start
    integer, intent(in) :: count                            !< how many
    logical, intent(in) :: with_gradients                   !< gradients are found too
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
    fit%q_start = start%q
    allocate (y(0, fit%groups), values%r(fit%rows, fit%groups), values%by_x(fit%rows, fit%n, fit%groups), &
              values%by_y(fit%rows, 0, fit%groups))
    associate (space => synthesis%space)
      x = (space%values(space%varied) - space%low)/(space%high - space%low)
    end associate
    total = 0.0_wp
    begin = seconds()
    do i = 1, count
      fit%work = 0
      call fit%evaluate(x*(1.0_wp + 1.0e-6_wp*modulo(i, 100)), y, .false., values, has_value)
      if (.not. has_value) stop 'a design has no value'
      if (with_gradients) call fit%evaluate(x, y, .true., values, has_value)
      total = total + values%r(1, 1)
    end do
    print '(a,f10.3)', 'value_us', (seconds() - begin)*1.0e6_wp/count
    if (total > huge(total)) stop 1
  end subroutine find_values
end program bench_synthesis
