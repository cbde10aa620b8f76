!> The work of the programs on a mechanism: a run, or an answer in its place.
module mech9_task
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type
  use mech9_command_line, only: command_line_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_data_file, only: data_file_type
  use mech9_equilibrium_task, only: find_rest
  use mech9_linear_task, only: work_on_linear_motion
  use mech9_exponents_task, only: work_on_exponents
  use mech9_periodic_task, only: work_on_periodic
  use mech9_branch_task, only: work_on_branches
  use mech9_cam_task, only: work_on_cams
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_assemblies_text, only: print_assemblies
  use mech9_structure_graph, only: save_structure_graph
  use mech9_structure_text, only: print_mobility, print_mobility_of
  use mech9_check_text, only: print_given, print_start
  use mech9_range_text, only: print_ranges
  use mech9_plan_text, only: print_plan, print_plan_of_results
  use mech9_free_run_text, only: print_coefficients
  use mech9_run_task, only: carry_out
  implicit none
  private
  public :: work_on_mechanism, answers_only

contains

  !> Carry out the options. Errors are added to `diagnostics`, which knows the places in the data file.
  subroutine work_on_mechanism(options, given, reported, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout), target :: given    !< the data file; it gets the errors
    logical, intent(out) :: reported                        !< a report was asked for, and it is written: there was a run
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows as well, for a look at them after the run

    reported = .false.
    if (options%rest() /= '') then
      call find_rest(options, given, reported, kept)
    else if (options%has('at')) then
      call work_on_linear_motion(options, given)
    else if (options%has('exponents')) then
      call work_on_exponents(options, given, reported)
    else if (options%has('periodic')) then
      call work_on_periodic(options, given, reported, kept)
    else if (options%has('branch')) then
      call work_on_branches(options, given, reported)
    else
      call work_on_motion(options, given, reported, kept)
    end if
  end subroutine work_on_mechanism

  !> Make the plan, assemble the mechanism, and run it unless only an answer is requested.
  subroutine work_on_motion(options, given, reported, kept)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout), target :: given    !< the data file; it gets the errors
    logical, intent(inout) :: reported                      !< the run has written the report
    type(kept_rows_type), intent(inout), optional :: kept   !< gets the rows as well, for a look at them after the run
    type(picture_requests_type) :: pictures
    type(error_type), allocatable :: err

    if (options%has('check') .or. options%has('cam') .or. .not. answers_only(options)) &
      call given%check_times(given%model%program == dynamics .or. given%model%request%output%with_forces())
    if (given%failed()) return
    call read_picture_requests(options, given, pictures, err)
    if (.not. allocated(err)) call given%assemble(err)
    if (.not. (allocated(err) .or. answers_only(options))) then
      call given%run%prepare(given%model, err, given%variable, pictures%any_wanted())
    else if (.not. (allocated(err) .or. given%model%is_driven())) then
      call given%run%motion%prepare(given%model, err, pictures%any_wanted())
    end if
    if (allocated(err)) then
      if (options%has('check')) call print_given(output_unit, given%model, given%model%program == dynamics)
      call given%fail(err)
    else if (answers_only(options)) then
      call answer(options, pictures, given, reported)
    else
      call carry_out(options, pictures, given, reported, kept)
    end if
    call given%close_run()
  end subroutine work_on_motion

  !> Whether the options request an answer instead of a run.
  pure logical function answers_only(options)
    type(command_line_type), intent(in) :: options   !< the command line

    answers_only = options%has('check') .or. options%has('plan') .or. options%has('branches') &
                   .or. options%has('graph') .or. options%has('range') .or. options%has('cam')
  end function answers_only

  !> Give the answers that are requested about an assembled mechanism.
  subroutine answer(options, pictures, given, reported)
    type(command_line_type), intent(in) :: options                  !< the command line
    type(picture_requests_type), intent(in) :: pictures             !< the pictures of the mechanism that are requested
    type(data_file_type), intent(inout), target :: given            !< the data file; it gets the errors
    logical, intent(inout) :: reported                              !< the report of cams is written
    type(error_type), allocatable :: err

    call print_check(options, pictures, given)
    if (.not. given%model%is_driven() .and. (options%has('check') .or. options%has('plan'))) &
      call print_coefficients(output_unit, given%model, given%run%motion)
    if (options%has('range')) call print_ranges(output_unit, given%model, given%run%motion%plan, given%run%motion%start)
    if (options%has('check')) call given%run%check(given%model, err, given%variable)
    if (options%has('cam') .and. .not. allocated(err)) &
      call work_on_cams(options, given, reported, err)
    call given%fail(err)
  end subroutine answer

  !> Carry out --check, --plan, --branches and --graph, and --sketch beside them.
  subroutine print_check(options, pictures, given)
    type(command_line_type), intent(in) :: options         !< the command line
    type(picture_requests_type), intent(in) :: pictures    !< the pictures of the mechanism that are requested
    type(data_file_type), intent(inout), target :: given   !< the data file; it gets the errors
    type(error_type), allocatable :: err

    associate (motion => given%run%motion, plan => given%run%motion%plan, start => given%run%motion%start)
      if (options%has('check')) then
        call print_mobility_of(output_unit, given%model%mechanism, motion)
      else if (options%has('plan')) then
        call print_mobility(output_unit, given%model%mechanism, plan)
      end if
      if (options%has('plan')) then
        if (allocated(motion%simulation)) then
          call print_plan(output_unit, given%model%mechanism, plan, motion%simulation%requested)
        else
          call print_plan_of_results(output_unit, given%model, plan, pictures%any_wanted())
        end if
      end if
      if (options%has('branches')) &
        call print_assemblies(output_unit, given%model%mechanism, plan, start, options%number('starts', 100))
      if (options%has('graph')) call draw_graph(options, given)
      if (options%has('check')) then
        call print_given(output_unit, given%model, pictures%with_masses)
        call print_start(output_unit, given%model, plan, start, motion%way)
      end if
      if (options%has('sketch')) call pictures%save_start(given%model, plan, start, err)
      call given%fail(err)
    end associate
  end subroutine print_check

  !> Carry out --graph.
  subroutine draw_graph(options, given)
    type(command_line_type), intent(in) :: options         !< the command line
    type(data_file_type), intent(inout), target :: given   !< the data file; it gets the errors
    type(error_type), allocatable :: err
    character(len=:), allocatable :: said
    logical :: drawn

    call save_structure_graph(options%argument('graph'), given%model%mechanism, given%run%motion%plan, drawn, said, err)
    if (allocated(err)) then
      call given%fail(err)
    else if (.not. (drawn .and. options%has('quiet'))) then
      write (error_unit, '(a)') said
    end if
  end subroutine draw_graph
end module mech9_task
