!> Runs of designs: the quantities of a motion, their derivatives or the columns, where they are wanted, without any files.
module mech9_design_run
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_simulation, only: interruption_type
  use mech9_run, only: run_type
  use mech9_run_columns, only: find_columns, find_section
  use mech9_section_record, only: section_record_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_text, only: to_text
  use mech9_result_units, only: unit_of, rate_unit_of
  use mech9_columns, only: columns_type
  use mech9_force_record, only: force_record_type
  use mech9_link_record, only: link_record_type
  use mech9_quantity_record, only: quantity_record_type
  implicit none
  private
  public :: run_design, run_ending_type, find_design_gradient, find_quantities, columns_of_runs, section_of_runs

  !> The ending of a run, and its points: what is kept beside its quantities.
  type :: run_ending_type
    real(wp), allocatable :: points(:, :)       !< (columns,points) of its section; without one it is not allocated
    real(wp) :: range(2) = [huge(1.0_wp), -huge(1.0_wp)]   !< least and greatest difference from the value of the section
    real(wp), allocatable :: position(:)        !< (M) coordinates at the end [rad, m]
    real(wp), allocatable :: velocity(:)        !< (M) their rates there [rad/s, m/s]
    real(wp), allocatable :: states(:, :)       !< (2 M,points) coordinates at the points of the section, and rates times the mean time
                                                !< between points; without two points those at the end, and their way at these rates
                                                !< in the time of the run [rad, m]
    real(wp), allocatable :: unit(:)            !< (2 M) that counts as one of them: 1 rad, or the length of the mechanism [rad, m]
  end type run_ending_type

contains

  !> Make the run of a model and take its quantities. Fails as the run would; the quantities are then of no use, and rows have
  !> their numbers up to the failure.
  subroutine run_design(model, numbers, err, rows, interruption, ending)
    type(model_type), intent(inout), target :: model      !< gets the tolerances where an accuracy is requested
    real(wp), intent(out) :: numbers(:)                   !< (quantities)
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp), allocatable, intent(inout), optional :: rows(:, :)   !< (columns,outputs) gets the columns of all outputs that are
                                                          !< reached, where it is allocated
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop
    type(run_ending_type), intent(out), optional :: ending   !< the points of the section and the state at the end
    class(run_type), allocatable, target :: run

    allocate (run)
    call make_run(model, run, err, rows=rows, interruption=interruption, ending=ending)
    if (.not. allocated(err) .and. size(numbers) > 0) numbers = run%source%quantities%numbers
  end subroutine run_design

  !> Make the run of a model with its derivatives and take its quantities. Fails as a run with derivatives would.
  subroutine find_design_gradient(model, variable, numbers, gradient, err, interruption)
    type(model_type), intent(inout), target :: model        !< with quantities; gets the tolerances where an accuracy is requested
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    real(wp), intent(out) :: numbers(:)                     !< (quantities)
    real(wp), intent(out) :: gradient(:, :)                 !< (parameters,quantities); NaN where a number has no derivative
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop
    class(run_type), allocatable, target :: run

    model%request%output%gradients = .true.
    allocate (run)
    call make_run(model, run, err, variable, interruption=interruption)
    if (allocated(err)) return
    numbers = run%source%quantities%numbers
    gradient = run%source%quantities%gradient
  end subroutine find_design_gradient

  !> Make a run from its assembly to its end.
  subroutine make_run(model, run, err, variable, rows, interruption, ending)
    type(model_type), intent(inout), target :: model      !< gets the tolerances where an accuracy is requested
    type(run_type), intent(inout), target :: run          !< made anew, and closed on return
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    class(variable_model_type), intent(inout), optional, target :: variable     !< the model as a function of its parameters
    real(wp), allocatable, intent(inout), optional :: rows(:, :)   !< (columns,outputs) gets the columns of all outputs that are
                                                          !< reached, where it is allocated
    class(interruption_type), intent(inout), optional, target :: interruption   !< is asked whether the run shall stop
    type(run_ending_type), intent(inout), optional :: ending   !< gets the points of the section and the state at the end

    if (present(interruption)) call interruption%begin_run()
    call run%motion%assemble(model, err)
    if (.not. allocated(err)) call run%prepare(model, err, variable)
    if (present(ending) .and. .not. allocated(err)) call run%source%begin_section(err)
    if (.not. allocated(err)) call run%motion%find_tolerances(model, err, interruption=interruption)
    if (.not. allocated(err)) call run%make(err, rows, interruption)
    if (present(ending) .and. .not. allocated(err)) call keep_ending(run, ending)
    call run%close()
  end subroutine make_run

  !> Keep the ending of a run.
  subroutine keep_ending(run, ending)
    type(run_type), intent(in) :: run                       !< at its end
    type(run_ending_type), intent(inout) :: ending          !< gets it
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    call run%motion%simulation%present(plan, state)
    ending%position = state%q
    ending%velocity = state%dq
    call keep_states(run, plan, ending)
    if (.not. allocated(run%source%section)) return
    ending%points = run%source%section%points(:, :run%source%section%count)
    ending%range = run%source%section%range
  end subroutine keep_ending

  !> Keep the states by which ends of motions are told apart.
  subroutine keep_states(run, plan, ending)
    type(run_type), intent(in) :: run                       !< at its end
    type(plan_type), intent(in) :: plan                     !< of the mechanism
    type(run_ending_type), intent(inout) :: ending          !< with the state at the end; gets the states
    real(wp) :: time
    integer :: k, m, n

    m = plan%n_coordinates
    ending%unit = [(plan%unit_of(k), k=1, m), (plan%unit_of(k), k=1, m)]
    n = 0
    if (allocated(run%source%section)) n = run%source%section%count
    associate (model => run%motion%simulation%model)
      if (n < 2) then
        time = abs(model%request%time%end - model%request%time%start)
        ending%states = reshape([ending%position, ending%velocity*time], [2*m, 1])
        return
      end if
      allocate (ending%states(2*m, n))
      associate (section => run%source%section)
        time = abs(section%points(column_of('t'), n) - section%points(column_of('t'), 1))/(n - 1)
        do k = 1, m
          ending%states(k, :) = section%points(column_of('q'//to_text(k)), :n)*unit_of(model%mechanism, k)
          ending%states(m + k, :) = section%points(column_of('dq'//to_text(k)), :n)*(rate_unit_of(model%mechanism, k)*time)
        end do
      end associate
    end associate
  contains
    !> Number of a column of the section.
    pure integer function column_of(name) result(column)
      character(len=*), intent(in) :: name   !< its heading

      do column = 1, size(run%source%section%names) - 1
        if (run%source%section%names(column) == name) return
      end do
    end function column_of
  end subroutine keep_states

  !> Find the columns of the quantities that the runs of a model will have. Fails with exit_data where one is not recorded.
  subroutine find_quantities(model, quantities, err)
    type(model_type), intent(in) :: model                   !< the model
    type(quantity_record_type), intent(out) :: quantities   !< with their columns
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(columns_type) :: columns

    call columns_of_runs(model, columns)
    call quantities%begin(model, columns, err)
  end subroutine find_quantities

  !> Find the columns that the runs of a model will have.
  subroutine columns_of_runs(model, columns)
    type(model_type), intent(in) :: model                   !< the model
    type(columns_type), intent(out) :: columns              !< of each run
    class(force_record_type), allocatable :: forces
    type(link_record_type) :: links

    allocate (forces)
    call find_columns(model, model%program == dynamics .and. model%request%output%energies, &
                      model%request%solver%accuracy > 0.0_wp .and. .not. model%is_driven(), columns, forces, links)
  end subroutine columns_of_runs

  !> The section that the runs of a model will have, without points. Fails with exit_data where the column of its value is not recorded.
  subroutine section_of_runs(model, section, err)
    type(model_type), intent(in) :: model                   !< the model
    class(section_record_type), allocatable, intent(out) :: section   !< not allocated: the model requests none
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(columns_type) :: columns

    if (.not. model%request%section%is_wanted) return
    call columns_of_runs(model, columns)
    call find_section(model, columns, model%request%solver%accuracy > 0.0_wp .and. .not. model%is_driven(), section, err)
  end subroutine section_of_runs
end module mech9_design_run
