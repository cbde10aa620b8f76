!> Whole runs, from the data file to the rows, that share nothing: what several threads are given.
module many_runs
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_driven_simulation, only: driven_simulation_type, new_driven_simulation, assemble_driven
  use mech9_free_simulation, only: free_simulation_type, new_free_simulation
  use mech9_free_start, only: assemble_free
  use mech9_simulation, only: simulation_type
  use mech9_row_source, only: row_source_type, new_row_source
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_run_maker, only: run_maker_type, made_run_type
  use mech9_variable_model, only: variable_model_type
  use mech9_held_start, only: held_start_type, hold_start
  use mech9_exponents, only: exponents_found_type, find_exponents
  use mech9_synthesis, only: synthesis_type, new_synthesis
  use mech9_closed_search, only: found_design_type
  use mech9_search_check, only: check_synthesis
  use mech9_signal_interruption, only: signal_interruption_type
  implicit none
  private
  public :: run_type, list_runs, carry_out, same

  !> One run and its results.
  type :: run_type
    character(len=:), allocatable :: file
    integer :: program = kinematics
    real(wp), allocatable :: rows(:, :)     !< (columns, outputs); none of a data file that is refused
    character(len=:), allocatable :: said    !< of such a data file
    logical :: done = .false.                !< ended as it should
  end type run_type

contains

  !> Runs of the data files under `folder`, in turn; some of them are to be refused.
  subroutine list_runs(folder, count, runs)
    character(len=*), intent(in) :: folder                !< of the data files
    integer, intent(in) :: count                          !< of runs
    type(run_type), allocatable, intent(out) :: runs(:)   !< still to be carried out
    character(len=*), parameter :: names(*) = [character(len=40) :: 'reference/kinematics_fig1', &
      'reference/dynamics_fig1', 'input/malformed/errors_together', 'reference/kinematics_general_7r', &
      'reference/dynamics_fivebar', 'reference/kinematics_bennett', 'reference/dynamics_open_chain', &
      'reference/kinematics_fig1_driven_at_q1', 'input/malformed/links_apart', &
      'reference/dynamics_spatial_slider_crank', 'reference/kinematics_slider_crank', 'threads/study', 'threads/search', &
      'threads/forced_search', 'threads/exponents']
    integer :: i, which

    allocate (runs(count))
    do i = 1, count
      which = 1 + modulo(i - 1, size(names))
      runs(i)%file = folder//'/'//trim(names(which))//'.nml'
      if (index(names(which), '/dynamics') > 0 .or. index(names(which), '/forced') > 0 .or. &
          index(names(which), '/exponents') > 0) runs(i)%program = dynamics
    end do
  end subroutine list_runs

  !> Read, plan, assemble, and follow or integrate the motion.
  subroutine carry_out(run)
    type(run_type), intent(inout) :: run   !< gets its rows, or its failure
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    type(model_type), target :: model
    type(error_type), allocatable :: err

    call read_document(run%file, document, diagnostics)
    call read_model(document, run%program, model, diagnostics)
    if (diagnostics%failed()) then
      call diagnostics%render(1, run%said)
      run%done = index(run%file, 'malformed') > 0
      return
    end if
    if (model%request%study%kind /= '') then
      call make_study(document, diagnostics, model, run%rows)
      run%done = .true.
      return
    end if
    if (size(model%request%objectives) > 0) then
      call search(document, diagnostics, model, run%rows, err)
      run%done = .not. allocated(err)
      return
    end if
    if (model%request%exponents%time > 0.0_wp) then
      call find_means(model, run%rows, err)
      run%done = .not. allocated(err)
      return
    end if
    ! short, so that the threads begin and end often
    model%request%time%intervals = 20
    if (run%program == dynamics) then
      call integrate(model, run%rows, err)
    else
      call follow(model, run%rows, err)
    end if
    run%done = .not. allocated(err)
  end subroutine carry_out

  !> Find the exponents of a motion from three starts.
  subroutine find_means(model, rows, err)
    type(model_type), intent(in) :: model                !< the model
    real(wp), allocatable, intent(out) :: rows(:, :)     !< a column for each start
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(model_type), allocatable :: moved
    type(exponents_found_type) :: found
    integer :: i

    allocate (rows(4, 3))
    do i = 1, size(rows, 2)
      allocate (moved, source=model)
      moved%problem%initial%position(1) = 0.3_wp*i
      call find_exponents(moved, 2, found, err)
      deallocate (moved)
      if (allocated(err)) return
      rows(:, i) = [found%exponents, found%errors]
    end do
  end subroutine find_means

  !> Make the runs of a study, some of which fail.
  subroutine make_study(document, diagnostics, model, rows)
    type(document_type), intent(in) :: document          !< the data file
    type(diagnostics_type), intent(in) :: diagnostics    !< of its reading
    type(model_type), intent(in) :: model                !< with the values of the data file
    real(wp), allocatable, intent(out) :: rows(:, :)     !< a column for each run: exit code, values, quantities
    type(varied_document_type) :: varied
    type(run_maker_type) :: maker
    type(made_run_type) :: made
    integer :: i

    call new_varied_document(document, diagnostics%sources, kinematics, varied)
    call maker%begin(model, varied)
    allocate (rows(1 + size(model%parameters) + size(model%request%quantities), model%request%study%runs))
    do i = 1, size(rows, 2)
      call maker%make(i, made)
      rows(1, i) = made%exit_code
      rows(2:1 + size(made%values), i) = made%values
      rows(2 + size(made%values):, i) = made%quantities
    end do
  end subroutine make_study

  !> Search for a design from some starts.
  subroutine search(document, diagnostics, model, rows, err)
    type(document_type), intent(in) :: document          !< the data file
    type(diagnostics_type), intent(in) :: diagnostics    !< of its reading
    type(model_type), intent(in) :: model                !< with the values of the data file
    real(wp), allocatable, intent(out) :: rows(:, :)     !< a column for each start: value and parameters of its best design
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(varied_document_type), target :: varied
    type(held_start_type), target :: held
    class(variable_model_type), pointer :: searched
    type(model_type) :: present
    type(plan_type) :: plan
    type(state_type) :: start
    type(synthesis_type), target :: synthesis
    type(found_design_type), allocatable :: found(:)
    integer :: i, best

    call new_varied_document(document, diagnostics%sources, model%program, varied)
    searched => varied
    present = model
    if (model%program == dynamics) then
      allocate (held%moving, source=varied)
      searched => held
      call hold_start(present, err)
      if (allocated(err)) return
    end if
    call assemble_driven(present, plan, start, err)
    if (.not. allocated(err)) call new_synthesis(searched, present, plan, synthesis, err)
    if (.not. allocated(err)) call check_synthesis(varied, model, start, signal_interruption_type(), synthesis, err)
    if (allocated(err)) return
    allocate (rows(1 + size(synthesis%space%varied), model%request%optimum%starts), source=0.0_wp)
    do i = 1, size(rows, 2)
      call synthesis%make_start(synthesis%space, model%request%optimum%seed, i, found)
      best = minloc(found%value, dim=1)
      rows(1, i) = found(best)%value
      if (found(best)%found) rows(2:, i) = found(best)%x
    end do
  end subroutine search

  subroutine follow(model, rows, err)
    type(model_type), intent(in), target :: model       !< the model
    real(wp), allocatable, intent(out) :: rows(:, :)    !< of the results, one in each column
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(plan_type) :: plan
    type(state_type) :: start
    type(driven_simulation_type) :: simulation

    call assemble_driven(model, plan, start, err)
    if (allocated(err)) return
    call new_driven_simulation(model, plan, start, simulation)
    call fill(simulation, model, rows, err)
  end subroutine follow

  subroutine integrate(model, rows, err)
    type(model_type), intent(in), target :: model       !< the model
    real(wp), allocatable, intent(out) :: rows(:, :)    !< of the results, one in each column
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(plan_type) :: plan
    type(state_type) :: start
    type(free_simulation_type) :: simulation

    call assemble_free(model, plan, start, err)
    if (.not. allocated(err)) call new_free_simulation(model, plan, start, simulation, err)
    if (.not. allocated(err)) call fill(simulation, model, rows, err)
    call simulation%close()
  end subroutine integrate

  subroutine fill(simulation, model, rows, err)
    class(simulation_type), intent(inout), target :: simulation   !< about to start
    type(model_type), intent(in), target :: model                 !< the model
    real(wp), allocatable, intent(out) :: rows(:, :)              !< of the results, one in each column
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    type(row_source_type) :: source
    integer :: i

    call new_row_source(simulation, source)
    allocate (rows(source%columns%count, 0:model%request%time%intervals), source=0.0_wp)
    do i = 0, model%request%time%intervals
      call source%row_at(model%request%time%time(i), rows(:, i), err)
      if (allocated(err)) return
    end do
  end subroutine fill

  !> Did both end as they should, with the same numbers in every bit, or the same words?
  pure logical function same(a, b)
    type(run_type), intent(in) :: a   !< first run
    type(run_type), intent(in) :: b   !< second run

    same = a%done .and. b%done
    if (.not. same) return
    if (allocated(a%said) .or. allocated(b%said)) then
      same = allocated(a%said) .and. allocated(b%said)
      if (same) same = a%said == b%said
    else
      same = all(shape(a%rows) == shape(b%rows))
      if (same) same = all(transfer(a%rows, [0]) == transfer(b%rows, [0]))
    end if
  end function same
end module many_runs
