!> The results of the section of a run: its table, its plots, its data sets, and lines about it.
module mech9_section_results
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, to_text
  use mech9_counted, only: counted
  use mech9_part_names, only: part_names_type, add_names
  use mech9_model, only: model_type
  use mech9_heading, only: heading_type, new_heading
  use mech9_table, only: table_type
  use mech9_hdf5_sink, only: hdf5_sink_type
  use mech9_plot_request, only: plot_request_type, read_plot_request, is_of_section
  use mech9_plot, only: plot_type, picture_of_plot
  use mech9_section_record, only: section_record_type
  use mech9_section_layout, only: write_section
  use mech9_version, only: name_and_version
  use mech9_command_line, only: command_line_type
  use mech9_written_files, only: list_plot_requests
  implicit none
  private
  public :: check_section_plots, write_section_files, write_section_results, print_section

contains

  !> Fail with exit_usage where --plot asks for a section that is not requested, or for a column that it does not have.
  subroutine check_section_plots(options, model, section, err)
    type(command_line_type), intent(in) :: options                         !< the command line
    type(model_type), intent(in) :: model                                  !< the model
    class(section_record_type), allocatable, intent(in) :: section         !< the section; not allocated: there is none
    type(error_type), allocatable, intent(out) :: err                      !< allocated if it failed
    type(string_type), allocatable :: requests(:)
    type(plot_request_type) :: request
    integer :: i

    call list_plot_requests(options, model%mechanism%names, requests)
    do i = 1, size(requests)
      if (.not. is_of_section(requests(i)%text)) cycle
      if (allocated(section)) then
        call read_plot_request(requests(i)%text, texts_of(section%names), request, err)
      else
        call raise(err, exit_usage, '--plot: the data file has no section; give a group &section, or leave ''section:'' out')
      end if
      if (allocated(err)) return
    end do
  end subroutine check_section_plots

  !> Write the table, the plots and the data sets of a section, after the run.
  subroutine write_section_results(options, model, section, table_path, hdf5, err)
    type(command_line_type), intent(in) :: options            !< the command line
    type(model_type), intent(in) :: model                     !< the model
    class(section_record_type), intent(in) :: section         !< the section
    character(len=*), intent(in) :: table_path                !< path of the table of the run; '-' or empty: no file
    type(hdf5_sink_type), pointer, intent(in) :: hdf5         !< the open HDF5 file; null: there is none
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    if (associated(hdf5)) call write_section(section, hdf5%file)
    call write_section_files(options, model, section, table_path, err)
  end subroutine write_section_results

  !> Write the table and the plots of a section, after the run or the study.
  subroutine write_section_files(options, model, section, table_path, err)
    type(command_line_type), intent(in) :: options            !< the command line
    type(model_type), intent(in) :: model                     !< the model
    class(section_record_type), intent(in) :: section         !< the section
    character(len=*), intent(in) :: table_path                !< path of the table of the results; '-' or empty: no file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(error_type), allocatable :: of_plots

    if (section%wanted%table /= '' .and. .not. options%has('no-write')) call write_table(options%has('names'), model, section, err)
    call draw_plots(options, model, section, table_path, of_plots)
    if (.not. allocated(err)) call move_alloc(of_plots, err)
  end subroutine write_section_files

  !> Write the table.
  subroutine write_table(by_names, model, section, err)
    logical, intent(in) :: by_names                           !< columns are called by the names of pairs and links
    type(model_type), intent(in) :: model                     !< the model
    class(section_record_type), intent(in) :: section         !< the section
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(error_type), allocatable :: at_close
    type(table_type) :: table
    type(heading_type) :: heading

    heading = new_heading(model%mechanism%title, texts_of(section%names), texts_of(section%units))
    if (by_names) call heading%call_by_names(model%mechanism%names)
    call table%open(section%wanted%table, heading, name_and_version(model%program), err)
    if (allocated(err)) return
    call table%write_rows(section%points(:, :section%count), err)
    call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine write_table

  !> Draw the plots, and print a line about each.
  subroutine draw_plots(options, model, section, table_path, err)
    type(command_line_type), intent(in) :: options            !< the command line
    type(model_type), intent(in) :: model                     !< the model
    class(section_record_type), intent(in) :: section         !< the section
    character(len=*), intent(in) :: table_path                !< path of the table of the run; '-' or empty: no file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(string_type), allocatable :: requests(:)
    real(wp), allocatable :: points(:, :)
    type(heading_type) :: heading, labels
    integer :: i

    call list_plot_requests(options, model%mechanism%names, requests)
    do i = 1, size(requests)
      if (.not. is_of_section(requests(i)%text) .or. section%count == 0) cycle
      if (.not. allocated(points)) call take_points(section, points)
      heading = new_heading(model%mechanism%title, texts_of(section%names), texts_of(section%units))
      labels = heading
      call labels%call_by_names(model%mechanism%names)
      call draw_plot(requests(i)%text, i, options, heading, labels%names, table_path, points, err)
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
  pure subroutine take_points(section, points)
    class(section_record_type), intent(in) :: section         !< the section
    real(wp), allocatable, intent(out) :: points(:, :)        !< (columns,points)
    real(wp) :: turn
    integer :: i

    points = section%points(:, :section%count)
    if (.not. section%wanted%reduce_angles) return
    do i = 1, size(points, 1)
      turn = 8.0_wp*atan(1.0_wp)
      if (section%units(i) == 'deg') turn = 360.0_wp
      if (any(section%units(i) == ['rad', 'deg'])) points(i, :) = points(i, :) - turn*anint(points(i, :)/turn)
    end do
  end subroutine take_points

  !> Print how many points there are; where there are none, the range of the value that was not met.
  subroutine print_section(unit, section, writes, names)
    integer, intent(in) :: unit                               !< Fortran unit to write to
    class(section_record_type), intent(in) :: section         !< the section
    logical, intent(in) :: writes                             !< files are written
    type(part_names_type), intent(in) :: names                !< of links and pairs
    character(len=:), allocatable :: words

    if (section%count > 0) then
      write (unit, '(a)') 'section: '//counted(section%count, 'point')
      if (writes .and. section%wanted%table /= '' .and. section%wanted%table /= '-') &
        write (unit, '(2a)') 'table of the section: ', section%wanted%table
    else if (section%range(1) > section%range(2) .and. .not. section%wanted%period > 0.0_wp) then
      write (unit, '(a)') 'the section has no point: the motion ends before its transient'
    else if (section%wanted%period > 0.0_wp) then
      write (unit, '(a)') 'the section has no point: the motion, or what follows the transient, is shorter than the period'
    else
      words = ' '//words_of_value(section)
      call add_names(names, words)
      write (unit, '(a)') 'the section has no point:'//words//' is never met'// &
        trim(merge(' in this direction', '                  ', section%wanted%direction /= 0))//'; it went from '// &
        to_text(section%wanted%value + section%range(1), 6)//' to '//to_text(section%wanted%value + section%range(2), 6)
    end if
  end subroutine print_section

  !> The value of a section in words.
  pure function words_of_value(section) result(words)
    class(section_record_type), intent(in) :: section         !< the section
    character(len=:), allocatable :: words

    if (section%wanted%coordinate > 0) then
      words = 'q'//to_text(section%wanted%coordinate)
    else
      words = section%wanted%column
    end if
    words = words//' = '//to_text(section%wanted%value, 6)
  end function words_of_value
end module mech9_section_results
