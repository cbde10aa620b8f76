!> The work of the programs for --branch: positions over a parameter, with table, HDF5 file, plots and report.
module mech9_branch_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_heading, only: heading_of
  use mech9_plot, only: picture_of_plot
  use mech9_branch_plot, only: branch_rows_type, draw_branch_plot, read_branch_plot
  use mech9_plot_request, only: plot_request_type
  use mech9_answer_files, only: save_table
  use mech9_program_kind, only: program_names, dynamics
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_written_files, only: result_paths_type, find_result_paths, list_plot_requests
  use mech9_recorded_branches, only: recorded_branches_type, list_columns
  use mech9_answer_record, only: save_branches
  use mech9_answer_report, only: save_branches_report
  use mech9_branch_words, only: print_branches
  use mech9_friction_text, only: print_left_out
  use mech9_signal_interruption, only: signal_interruption_type, answer_progress_type
  implicit none
  private
  public :: work_on_branches

contains

  !> Find the branches that --branch asks for, and write them.
  subroutine work_on_branches(options, given, reported)
    type(command_line_type), intent(in) :: options                  !< the command line
    type(data_file_type), intent(inout), target :: given            !< the data file; it gets the errors
    logical, intent(out) :: reported                                !< the report is written
    type(recorded_branches_type) :: found
    type(result_paths_type) :: paths
    type(answer_progress_type), target :: progress
    type(signal_interruption_type) :: interruption
    type(error_type), allocatable :: err, of_files

    reported = .false.
    call given%check_times(given%model%program == dynamics)
    if (given%failed()) return
    call find_result_paths(options, paths, given)
    call check_plots(options, given, err)
    interruption%progress => progress
    call progress%line%start(program_names(given%model%program), options%has('quiet'))
    if (.not. allocated(err)) &
      call found%find(given, options%argument('branch'), err, interruption)
    call progress%line%finish()
    if (found%count() > 0) then
      if (.not. options%has('quiet')) call tell(given, found)
      call save_table(paths%table, options, given, heading_of(given%model%mechanism%title, found%columns), found%rows, of_files)
      if (paths%hdf5 /= '' .and. .not. allocated(of_files)) &
        call save_branches(paths%hdf5, given, found, of_files)
      if (.not. allocated(of_files)) call draw_plots(options, given, found, paths%table, of_files)
    end if
    call given%fail(err)
    call given%fail(of_files)
    if (.not. options%has('report')) return
    call save_branches_report(options%argument('report'), given, paths%table, found, err)
    reported = .not. allocated(err)
    call given%fail(err)
  end subroutine work_on_branches

  !> Print what was found.
  subroutine tell(given, found)
    type(data_file_type), intent(in) :: given               !< the data file
    type(recorded_branches_type), intent(in) :: found       !< the branches

    if (given%model%mechanism%title /= '') write (error_unit, '(a)') given%model%mechanism%title
    call print_branches(error_unit, found%branches_found_type, given%model%mechanism%names)
    if (any(found%of == 'equilibrium')) call print_left_out(error_unit, given%model%mechanism)
  end subroutine tell

  !> Draw the plots, and print a line about each.
  subroutine draw_plots(options, given, found, table, err)
    type(command_line_type), intent(in) :: options       !< the command line
    type(data_file_type), intent(in) :: given            !< the data file
    type(recorded_branches_type), intent(in) :: found       !< the branches
    character(len=*), intent(in) :: table                !< path of the table; empty: none
    type(error_type), allocatable, intent(out) :: err    !< allocated if a plot cannot be made
    type(branch_rows_type) :: branches
    type(string_type), allocatable :: requests(:)
    character(len=:), allocatable :: picture, said
    logical :: is_lacking
    integer :: i

    call list_plot_requests(options, given%model%mechanism%names, requests)
    if (size(requests) == 0) return
    branches%heading = heading_of(given%model%mechanism%title, found%columns)
    branches%labels = branches%heading
    call branches%labels%call_by_names(given%model%mechanism%names)
    branches%rows = found%rows
    branches%stable = found%stable
    do i = 1, size(requests)
      call picture_of_plot(requests(i)%text, table, options%file, i, picture)
      call draw_branch_plot(requests(i)%text, branches, picture, said, is_lacking, err)
      if (allocated(err)) return
      if (said /= '' .and. (is_lacking .or. .not. options%has('quiet'))) write (error_unit, '(a)') said
    end do
  end subroutine draw_plots

  !> Fail with exit_usage where --plot asks for a column that the branches do not have.
  subroutine check_plots(options, given, err)
    type(command_line_type), intent(in) :: options       !< the command line
    type(data_file_type), intent(in) :: given            !< the data file
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    type(plot_request_type) :: request
    type(string_type), allocatable :: requests(:), names(:)
    integer :: i

    call list_columns(given, options%argument('branch'), names)
    if (size(names) == 0) return
    call list_plot_requests(options, given%model%mechanism%names, requests)
    do i = 1, size(requests)
      call read_branch_plot(requests(i)%text, names, request, err)
      if (allocated(err)) return
    end do
  end subroutine check_plots
end module mech9_branch_task
