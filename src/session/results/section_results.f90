!> The results of the section of a run or a study: its table, and its plots.
module mech9_section_results
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type
  use mech9_data_file, only: data_file_type
  use mech9_heading, only: heading_type, new_heading
  use mech9_plot_request, only: plot_request_type, read_plot_request, is_of_section
  use mech9_plot, only: plot_type, picture_of_plot
  use mech9_command_line, only: command_line_type
  use mech9_answer_files, only: save_table
  use mech9_written_files, only: list_plot_requests
  implicit none
  private
  public :: check_section_plots, write_section_files

contains

  !> Fail with exit_usage where --plot asks for a section that is not requested, or for a column that it does not have.
  subroutine check_section_plots(options, given, err, names)
    type(command_line_type), intent(in) :: options                         !< the command line
    type(data_file_type), intent(in) :: given                              !< the data file
    type(error_type), allocatable, intent(out) :: err                      !< allocated if it failed
    character(len=*), intent(in), optional :: names(:)                     !< columns of the section; absent: there is none
    type(string_type), allocatable :: requests(:)
    type(plot_request_type) :: request
    integer :: i

    call list_plot_requests(options, given%model%mechanism%names, requests)
    do i = 1, size(requests)
      if (.not. is_of_section(requests(i)%text)) cycle
      if (present(names)) then
        call read_plot_request(requests(i)%text, texts_of(names), request, err)
      else
        call raise(err, exit_usage, '--plot: the data file has no section; give a group &section, or leave ''section:'' out')
      end if
      if (allocated(err)) return
    end do
  end subroutine check_section_plots

  !> Write the table and the plots of a section, after the run or the study.
  subroutine write_section_files(options, given, names, units, points, table_path, err)
    type(command_line_type), intent(in) :: options            !< the command line
    type(data_file_type), intent(in) :: given                 !< the data file
    character(len=*), intent(in) :: names(:)                  !< (columns) of the section
    character(len=*), intent(in) :: units(:)                  !< (columns)
    real(wp), intent(in), contiguous :: points(:, :)          !< (columns,points)
    character(len=*), intent(in) :: table_path                !< path of the table of the results; '-' or empty: no file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(error_type), allocatable :: of_plots
    type(heading_type) :: heading

    heading = new_heading(given%model%mechanism%title, texts_of(names), texts_of(units))
    if (.not. options%has('no-write')) call save_table(given%model%request%section%table, options, given, heading, points, err)
    call draw_plots(options, given, heading, points, table_path, of_plots)
    if (.not. allocated(err)) call move_alloc(of_plots, err)
  end subroutine write_section_files

  !> Draw the plots, and print a line about each.
  subroutine draw_plots(options, given, heading, points, table_path, err)
    type(command_line_type), intent(in) :: options            !< the command line
    type(data_file_type), intent(in) :: given                 !< the data file
    type(heading_type), intent(in) :: heading                 !< title and columns of the section
    real(wp), intent(in) :: points(:, :)                      !< (columns,points)
    character(len=*), intent(in) :: table_path                !< path of the table of the run; '-' or empty: no file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(string_type), allocatable :: requests(:)
    real(wp), allocatable :: drawn(:, :)
    type(heading_type) :: labels
    integer :: i

    call list_plot_requests(options, given%model%mechanism%names, requests)
    labels = heading
    call labels%call_by_names(given%model%mechanism%names)
    do i = 1, size(requests)
      if (.not. is_of_section(requests(i)%text) .or. size(points, 2) == 0) cycle
      if (.not. allocated(drawn)) call take_points(given, heading, points, drawn)
      call draw_plot(requests(i)%text, i, options, heading, labels%names, table_path, drawn, err)
      if (allocated(err)) return
    end do
  end subroutine draw_plots

  !> Draw a plot.
  subroutine draw_plot(request, number, options, heading, labels, table_path, points, err)
    character(len=*), intent(in) :: request                   !< argument of --plot
    integer, intent(in) :: number                             !< of this argument
    type(command_line_type), intent(in) :: options            !< the command line
    type(heading_type), intent(in) :: heading                 !< title and columns of the section
    type(string_type), intent(in) :: labels(:)                !< names of the columns as the plot shows them
    character(len=*), intent(in) :: table_path                !< path of the table of the run; '-' or empty: no file
    real(wp), intent(in), contiguous :: points(:, :)          !< (columns,points)
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(plot_type) :: plot
    character(len=:), allocatable :: picture, words

    call picture_of_plot(request, table_path, options%file, number, picture)
    call plot%open(request, heading, size(points, 2), picture, '', err)
    if (.not. allocated(err)) call plot%call_columns(heading%names, labels)
    if (.not. allocated(err)) call plot%write_rows(points, err)
    if (.not. allocated(err)) call plot%close(err)
    if (allocated(err)) return
    words = plot%words()
    if (words /= '' .and. (plot%is_lacking .or. .not. options%has('quiet'))) write (error_unit, '(a)') words
  end subroutine draw_plot

  !> Texts without the blanks at their ends.
  pure function texts_of(list) result(texts)
    character(len=*), intent(in) :: list(:)   !< the texts, of one length
    type(string_type) :: texts(size(list))
    integer :: i

    do i = 1, size(list)
      texts(i)%text = trim(list(i))
    end do
  end function texts_of

  !> Take the points as they are drawn: angles within one turn, where this is requested.
  pure subroutine take_points(given, heading, points, drawn)
    type(data_file_type), intent(in) :: given                 !< the data file
    type(heading_type), intent(in) :: heading                 !< columns of the section
    real(wp), intent(in) :: points(:, :)                      !< (columns,points)
    real(wp), allocatable, intent(out) :: drawn(:, :)         !< (columns,points)
    real(wp) :: turn
    integer :: i

    drawn = points
    if (.not. given%model%request%section%reduce_angles) return
    do i = 1, size(points, 1)
      turn = 8.0_wp*atan(1.0_wp)
      if (heading%units(i)%text == 'deg') turn = 360.0_wp
      if (any(heading%units(i)%text == ['rad', 'deg'])) drawn(i, :) = points(i, :) - turn*anint(points(i, :)/turn)
    end do
  end subroutine take_points
end module mech9_section_results
