!> The results of a run, opened in one place by the options and the data file.
module mech9_results
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_data_file, only: data_file_type
  use mech9_result_sink, only: result_sink_type, sink_slot_type, append_sink
  use mech9_heading, only: heading_type, heading_of
  use mech9_table, only: table_type
  use mech9_plot, only: plot_type, picture_of_plot
  use mech9_plot_request, only: is_of_section
  use mech9_hdf5_sink, only: hdf5_sink_type
  use mech9_facts, only: facts_type
  use mech9_fact_layout, only: put_diagnostics
  use mech9_xdmf, only: new_xdmf
  use mech9_command_line, only: command_line_type
  use mech9_written_files, only: result_paths_type, find_result_paths, list_plot_requests
  use mech9_run_record, only: write_run_origin
  use mech9_version, only: name_and_version
  implicit none
  private
  public :: results_type

  !> The open results of one run.
  type :: results_type
    character(len=:), allocatable :: table_path     !< '-' is standard output; empty: no table
    character(len=:), allocatable :: hdf5_path      !< empty: no such file
    type(sink_slot_type), allocatable :: sinks(:)
    integer, private :: n_columns = 0               !< without those of poses
  contains
    procedure :: open => open_results
    procedure :: write_rows
    procedure :: flush => flush_results
    procedure :: close => close_results
    procedure :: print_words
    procedure :: hdf5
    procedure :: write_facts
    procedure, private :: open_plots, open_table, open_hdf5
  end type results_type

contains

  !> Open all requested results. After an error none is open.
  subroutine open_results(self, options, given, err)
    class(results_type), intent(out) :: self            !< the results
    type(command_line_type), intent(in) :: options      !< the command line
    type(data_file_type), intent(in) :: given           !< the data file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(result_paths_type) :: paths
    type(error_type), allocatable :: at_close
    type(sink_slot_type), allocatable :: plots(:)
    integer :: i

    allocate (self%sinks(0))
    self%n_columns = given%run%source%columns%count
    call find_result_paths(options, paths, given)
    self%table_path = paths%table
    self%hdf5_path = paths%hdf5
    ! a wrong name in a plot is found before a file is touched
    call self%open_plots(options, given, plots, err)
    if (.not. allocated(err) .and. self%table_path /= '') call self%open_table(options, given, err)
    if (.not. allocated(err) .and. self%hdf5_path /= '') &
      call self%open_hdf5(given, err)
    if (allocated(err)) then
      call self%close(at_close)
      return
    end if
    do i = 1, size(plots)
      call append_sink(self%sinks, plots(i)%sink)
    end do
  end subroutine open_results

  !> Open the requested plots.
  subroutine open_plots(self, options, given, plots, err)
    class(results_type), intent(in) :: self                      !< the results
    type(command_line_type), intent(in) :: options               !< the command line
    type(data_file_type), intent(in) :: given                    !< the data file
    type(sink_slot_type), allocatable, intent(out) :: plots(:)   !< one sink for each plot
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    type(string_type), allocatable :: requests(:)
    type(plot_type), allocatable :: plot
    character(len=:), allocatable :: picture
    type(heading_type) :: heading, labels
    class(result_sink_type), allocatable :: sink
    integer :: i

    allocate (plots(0))
    call list_plot_requests(options, given%model%mechanism%names, requests)
    heading = heading_of(given%model%mechanism%title, given%run%source%columns)
    labels = heading
    call labels%call_by_names(given%model%mechanism%names)
    if (options%has('names')) heading = labels
    do i = 1, size(requests)
      if (is_of_section(requests(i)%text)) cycle
      call picture_of_plot(requests(i)%text, self%table_path, options%file, i, picture)
      allocate (plot)
      call plot%open(requests(i)%text, heading_of(given%model%mechanism%title, given%run%source%columns), &
                     given%model%request%time%intervals + 1, picture, self%table_path, err)
      if (.not. allocated(err)) call plot%call_columns(heading%names, labels%names)
      if (allocated(err)) then
        if (leaves_out(given)) err%message = err%message//' (&output coordinates, derivatives or energies leave some out)'
        return
      end if
      call move_alloc(plot, sink)
      call append_sink(plots, sink)
    end do
  end subroutine open_plots

  !> Whether the results have fewer columns than they could have.
  pure logical function leaves_out(given)
    type(data_file_type), intent(in) :: given   !< the data file

    associate (output => given%model%request%output)
      leaves_out = output%derivatives < 2 .or. .not. (output%energies .and. all(output%recorded(size(given%model%mechanism%pairs))))
    end associate
  end function leaves_out

  subroutine open_table(self, options, given, err)
    class(results_type), intent(inout) :: self          !< the results
    type(command_line_type), intent(in) :: options      !< the command line
    type(data_file_type), intent(in) :: given           !< the data file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(table_type), allocatable :: table
    class(result_sink_type), allocatable :: sink
    type(heading_type) :: heading
    integer, allocatable :: order(:)

    allocate (table)
    heading = heading_of(given%model%mechanism%title, given%run%source%columns)
    if (options%has('names')) call heading%call_by_names(given%model%mechanism%names)
    if (given%run%source%columns%sensitivities > 0) order = given%run%source%columns%order_in_table()
    call table%open(self%table_path, heading, name_and_version(given%model%program), err, order)
    if (allocated(err)) return
    call move_alloc(table, sink)
    call append_sink(self%sinks, sink)
  end subroutine open_table

  subroutine open_hdf5(self, given, err)
    class(results_type), intent(inout) :: self          !< the results
    type(data_file_type), intent(in) :: given           !< the data file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(hdf5_sink_type), allocatable :: file
    class(result_sink_type), allocatable :: sink
    integer :: i

    allocate (file)
    call file%open(self%hdf5_path, given%model%mechanism, given%model%request, &
                   given%run%source%columns, err)
    if (allocated(err)) return
    call write_run_origin(file, given, err)
    call move_alloc(file, sink)
    call append_sink(self%sinks, sink)
    if (given%run%source%columns%poses%n_links == 0) return
    associate (time => given%model%request%time, poses => given%run%source%columns%poses)
      allocate (sink, source=new_xdmf(self%hdf5_path, given%model%mechanism%title, [(time%time(i), i=0, time%intervals)], &
                                      size(poses%vertex_link), size(poses%lines, 2)))
    end associate
    call append_sink(self%sinks, sink)
  end subroutine open_hdf5

  !> Write rows to all results, up to the first error.
  subroutine write_rows(self, rows, err)
    class(results_type), intent(inout) :: self          !< the results
    real(wp), intent(in), contiguous :: rows(:, :)      !< (columns, rows), those of poses at the end
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i

    do i = 1, size(self%sinks)
      associate (sink => self%sinks(i)%sink)
        if (sink%takes_poses .or. size(rows, 1) == self%n_columns) then
          call sink%write_rows(rows, err)
        else
          call sink%write_rows(rows(:self%n_columns, :), err)
        end if
      end associate
      if (allocated(err)) return
    end do
  end subroutine write_rows

  !> Write the rows that are held back, in all results; the first error is returned.
  subroutine flush_results(self, err)
    class(results_type), intent(inout) :: self          !< the results
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(error_type), allocatable :: one
    integer :: i

    do i = 1, size(self%sinks)
      call self%sinks(i)%sink%flush(one)
      if (.not. allocated(err)) call move_alloc(one, err)
    end do
  end subroutine flush_results

  !> Close all results, also after errors; the first error is returned.
  subroutine close_results(self, err)
    class(results_type), intent(inout) :: self          !< the results
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(error_type), allocatable :: one
    integer :: i

    do i = 1, size(self%sinks)
      call self%sinks(i)%sink%close(one)
      if (.not. allocated(err)) call move_alloc(one, err)
    end do
  end subroutine close_results

  !> The HDF5 file among the results, for data besides rows; null where there is none.
  function hdf5(self)
    class(results_type), intent(in), target :: self   !< the results
    type(hdf5_sink_type), pointer :: hdf5
    integer :: i

    hdf5 => null()
    do i = 1, size(self%sinks)
      select type (sink => self%sinks(i)%sink)
      type is (hdf5_sink_type)
        hdf5 => sink
      end select
    end do
  end function hdf5

  !> Write the facts about the run to the HDF5 file, if there is one: before the run, and again after it. Failures are
  !> those of the file, returned with the next rows or when it is closed.
  subroutine write_facts(self, facts, exit_code)
    class(results_type), intent(in), target :: self   !< the results
    type(facts_type), intent(in) :: facts             !< named numbers and texts about the run
    integer, intent(in), optional :: exit_code        !< of the run; not given before its end is known
    type(hdf5_sink_type), pointer :: hdf5

    hdf5 => self%hdf5()
    if (associated(hdf5)) call put_diagnostics(facts, hdf5%file, exit_code)
  end subroutine write_facts

  !> Print which files were written, after all are closed; with `quiet`, only those that could not be made.
  subroutine print_words(self, unit, quiet)
    class(results_type), intent(in) :: self   !< the results
    integer, intent(in) :: unit               !< the output unit
    logical, intent(in) :: quiet              !< only failures are told
    character(len=:), allocatable :: words
    integer :: i

    do i = 1, size(self%sinks)
      words = ''
      if (self%sinks(i)%sink%is_lacking .or. .not. quiet) words = self%sinks(i)%sink%words()
      if (words /= '') write (unit, '(a)') words
    end do
  end subroutine print_words
end module mech9_results
