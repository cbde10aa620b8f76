!> The search for the best design: from many starts to the distinct designs, their files and their report.
module mech9_optimum_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_data, exit_assembly
  use mech9_text, only: string_type
  use mech9_clock, only: seconds
  use mech9_command_line, only: command_line_type
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_explanation, only: explain
  use mech9_user_calls, only: calls_user_procedures
  use mech9_study_threads, only: threads_of_machine
  use mech9_start_threads, only: make_in_threads
  use mech9_starts, only: starts_type
  use mech9_held_start, only: held_start_type, hold_start
  use mech9_synthesis, only: synthesis_type, new_synthesis
  use mech9_optimum_check, only: check_synthesis
  use mech9_optimum_results, only: open_starts, write_results, table_of
  use mech9_optimum_pictures, only: optimum_pictures_type
  use mech9_optimum_words, only: print_differences, print_optimum, save_optimum_report
  implicit none
  private
  public :: work_on_optimum

  integer, parameter :: most_threads = 1024   !< the system may refuse more

contains

  !> Carry out the search that a data file describes.
  subroutine work_on_optimum(options, document, variable, model, diagnostics, reported)
    type(command_line_type), intent(in) :: options                  !< the command line
    type(document_type), intent(in) :: document                     !< the data file
    class(variable_model_type), intent(inout), target :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                           !< the model with the values of the data file
    type(diagnostics_type), intent(inout) :: diagnostics            !< gets the errors
    logical, intent(out) :: reported                                !< a report was asked for, and it is written
    type(synthesis_type), allocatable, target :: synthesis
    type(held_start_type), target :: held
    class(variable_model_type), pointer :: searched
    type(model_type) :: present
    type(starts_type) :: starts
    type(optimum_pictures_type) :: pictures
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err
    real(wp) :: clock

    reported = .false.
    allocate (synthesis)
    clock = seconds()
    searched => variable
    present = model
    call check_request(options, model, err)
    if (.not. allocated(err)) call pictures%open(options, model, err)
    if (.not. allocated(err) .and. model%program == dynamics) then
      ! runs follow from forces; the search itself knows the mechanism at their start
      allocate (held%moving, source=variable)
      searched => held
      call hold_start(present, err)
    end if
    if (.not. allocated(err)) call assemble_model(present, plan, start, err)
    if (.not. allocated(err)) call new_synthesis(searched, present, plan, synthesis, err)
    if (.not. allocated(err)) call check_synthesis(variable, model, start, options%has('quiet'), synthesis, err)
    if (.not. allocated(err)) call open_starts(options, document, model, synthesis, starts, err)
    if (allocated(err)) then
      call explain(err)
      call diagnostics%add_error(err)
      return
    end if
    if (.not. options%has('quiet')) call print_differences(error_unit, start, synthesis)
    call make_starts(options, searched, model, synthesis, starts, err)
    call synthesis%keep_verified()
    if (.not. options%has('quiet')) call print_optimum(error_unit, model, synthesis, seconds() - clock)
    if (size(synthesis%optima) == 0 .and. .not. allocated(err)) &
      call raise(err, exit_assembly, 'no start led to a design that can be assembled and that moves through the whole run'// &
                 trim(merge(' within all limits', '                  ', size(model%request%limits) > 0))// &
                 '; give more starts in &optimum, or other ranges of the parameters'// &
                 trim(merge(' and limits', '           ', size(model%request%limits) > 0)))
    if (allocated(err)) call diagnostics%add_error(err)
    call write_results(options, document, model, synthesis, starts, diagnostics)
    call pictures%draw(options, variable, synthesis, diagnostics)
    if (.not. options%has('report')) return
    call save_optimum_report(options%argument('report'), model, synthesis, table_of(options, model), diagnostics, err)
    reported = .true.
    if (allocated(err)) call diagnostics%add_error(err)
  end subroutine work_on_optimum

  !> Report a search that cannot be made.
  subroutine check_request(options, model, err)
    type(command_line_type), intent(in) :: options        !< the command line
    type(model_type), intent(in) :: model                 !< the model with the values of the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if it cannot

    if (size(model%request%objectives) == 0) then
      call raise(err, exit_usage, '--optimize meets the groups &objective as well as possible, and this file has none')
    else if (.not. any(model%parameters%has_range)) then
      call raise(err, exit_data, 'no parameter is varied: give ''low'' and ''high'' in at least one &parameter', &
                 model%request%objectives(1)%place)
    else if (.not. abs(model%request%time%end - model%request%time%start) > 0.0_wp) then
      call raise(err, exit_data, 'the run has no length, so that no motion can meet the objective; change &time', &
                 model%request%objectives(1)%place)
    else if (options%has('out') .and. changes_design(options)) then
      call raise(err, exit_usage, '--out writes the data file with the best values, and would not have the changes by --set; '// &
                 'write them into the data file, or leave --out out')
    end if
  end subroutine check_request

  !> Whether --set changes anything but the search itself.
  logical function changes_design(options)
    type(command_line_type), intent(in) :: options        !< the command line
    type(string_type), allocatable :: settings(:)
    integer :: i

    call options%arguments('set', settings)
    changes_design = .false.
    do i = 1, size(settings)
      if (index(adjustl(settings(i)%text), 'optimum') /= 1) changes_design = .true.
    end do
  end function changes_design

  !> Make all starts that are missing. Fail where the user interrupts; the starts so far then count.
  subroutine make_starts(options, variable, model, synthesis, starts, err)
    type(command_line_type), intent(in) :: options           !< the command line
    class(variable_model_type), intent(in) :: variable       !< the model as a function of its parameters
    type(model_type), intent(in) :: model                    !< the model
    type(synthesis_type), intent(inout) :: synthesis         !< gets the optima
    type(starts_type), intent(inout) :: starts               !< about to be made
    type(error_type), allocatable, intent(out) :: err        !< allocated if the user interrupts, or the file cannot be written
    integer :: threads

    threads = threads_of_machine()
    ! a user's procedures may keep numbers from call to call
    if (calls_user_procedures(model)) threads = 1
    threads = min(options%number('threads', threads), most_threads)
    call starts%begin(model%program, options%has('quiet'))
    call make_in_threads(variable, synthesis, model%request%optimum%seed, threads, starts)
    call starts%finish(synthesis)
    if (allocated(starts%stopped)) err = starts%stopped
  end subroutine make_starts
end module mech9_optimum_task
