!> The plot of the results of a run. It reads its request before the run, keeps the rows, and lets gnuplot draw them at
!> the end.
module mech9_plot
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text, string_type
  use mech9_path, only: folder_of, name_of, ending_of, with_ending
  use mech9_heading, only: heading_type
  use mech9_result_sink, only: result_sink_type
  use mech9_plot_drawing, only: draw_picture, draw_in_terminal, script_of_plot
  use mech9_terminal_size, only: find_terminal_size
  use mech9_plot_request, only: plot_request_type, read_plot_request, target_of_plot
  use mech9_plot_data, only: plot_data_type, new_plot_data
  use mech9_event_words, only: told_events_type
  use mech9_event_marks, only: turn_hypertexts_into_titles
  use mech9_plot_script, only: picture_script, terminal_script
  implicit none
  private
  public :: plot_type, plot_columns, picture_of_plot

  !> A sink that keeps the rows that the plot needs, and draws when it is closed. The table of results, if there is one,
  !> must be closed before.
  type, extends(result_sink_type) :: plot_type
    private
    character(len=:), allocatable :: title
    character(len=:), allocatable :: picture    !< file of the picture
    character(len=:), allocatable :: table      !< file with all results; empty: none
    character(len=:), allocatable :: said
    type(plot_request_type) :: request
    type(plot_data_type) :: data
    type(told_events_type) :: events            !< marked in plots over the time
    logical :: is_open = .false.
  contains
    procedure :: open => open_plot
    procedure :: write_rows
    procedure :: close => close_plot
    procedure :: mark
    procedure :: call_columns
    procedure :: words
  end type plot_type

contains

  !> Read the request before the run, so that a wrong name costs no time (exit_usage).
  subroutine open_plot(self, text, heading, expected, picture, table, err)
    class(plot_type), intent(inout) :: self            !< request and rows of the plot
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(heading_type), intent(in) :: heading          !< title, and columns of the results, the time first
    integer, intent(in) :: expected                    !< largest number of rows that will come
    character(len=*), intent(in) :: picture            !< file of the picture, unless `text` names one
    character(len=*), intent(in) :: table              !< file with the whole results; empty or '-': none
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    call read_plot_request(text, heading%names, self%request, err)
    if (allocated(err)) return
    self%title = heading%title
    self%picture = picture
    if (self%request%target /= '') self%picture = self%request%target
    self%table = table
    self%said = ''
    self%data = new_plot_data(heading%names, heading%units, self%request%curves, expected)
    self%data%are_points = self%request%of_section
    self%is_open = .true.
  end subroutine open_plot

  !> Call the columns by other names than in the request.
  subroutine call_columns(self, names, labels)
    class(plot_type), intent(inout) :: self            !< open
    type(string_type), intent(in) :: names(:)          !< of all columns, as the table has them
    type(string_type), intent(in) :: labels(:)         !< of all columns, as the picture shows them

    self%data%names = names
    self%data%labels = labels
  end subroutine call_columns

  !> Keep the values of the next rows of results.
  subroutine write_rows(self, rows, err)
    class(plot_type), intent(inout) :: self            !< request and rows of the plot
    real(wp), intent(in), contiguous :: rows(:, :)     !< (columns,rows) rows of the results
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: i

    do i = 1, size(rows, 2)
      call self%data%take(rows(:, i))
    end do
  end subroutine write_rows

  !> Draw the rows that were kept, either in the terminal or as a picture with its script beside it. If gnuplot is not
  !> installed keep the script of a picture all the same.
  subroutine close_plot(self, err)
    class(plot_type), intent(inout) :: self            !< request and rows of the plot
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    if (self%is_open .and. self%data%count > 0) then
      if (self%request%in_terminal) then
        call draw_letters(self, err)
      else
        call draw_curves(self, err)
      end if
    end if
    self%is_open = .false.
  end subroutine close_plot

  !> Take the events of the run, before the plot is closed. A plot in the terminal does not mark them.
  subroutine mark(self, events)
    class(plot_type), intent(inout) :: self            !< request and rows of the plot
    type(told_events_type), intent(in) :: events       !< in the order of time

    self%events = events
  end subroutine mark

  !> The line for the user after the plot is closed.
  function words(self)
    class(plot_type), intent(in) :: self  !< request and rows of the plot
    character(len=:), allocatable :: words

    words = ''
    if (allocated(self%said)) words = self%said
  end function words

  !> Draw the plot in the terminal.
  subroutine draw_letters(self, err)
    class(plot_type), intent(in) :: self               !< request and rows of the plot
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: columns, rows

    call find_terminal_size(columns, rows)
    call draw_in_terminal(terminal_script(self%request%curves, self%data, columns, rows), err)
  end subroutine draw_letters

  !> Draw the plot as a picture. Its script reads the table where that is in the same folder.
  subroutine draw_curves(self, err)
    class(plot_type), intent(inout) :: self            !< request and rows of the plot
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    character(len=:), allocatable :: source

    source = ''
    if (can_be_read(self%table) .and. folder_of(self%table) == folder_of(self%picture)) source = name_of(self%table)
    call draw_picture(self%picture, picture_script(self%title, self%request%curves, self%data, name_of(self%picture), &
                      name_of(script_of_plot(self%picture)), source, self%events), &
                      self%said, self%is_lacking, err)
    if (.not. (allocated(err) .or. self%is_lacking) .and. self%events%count > 0 .and. ending_of(self%picture) == 'svg') &
      call turn_hypertexts_into_titles(self%picture, err)
  end subroutine draw_curves

  !> Whether gnuplot can read a table with this name as it is: a file of columns with blanks between.
  pure logical function can_be_read(table)
    character(len=*), intent(in) :: table  !< file of the table; empty or '-': none

    can_be_read = table /= '' .and. table /= '-' .and. ending_of(table) /= 'csv'
  end function can_be_read

  !> Choose the file of the picture that a plot makes. If no name is given it stands beside the table, or else in the
  !> current folder under the name of the data file.
  pure subroutine picture_of_plot(text, table, data_file, i, picture)
    character(len=*), intent(in) :: text                   !< the argument of --plot
    character(len=*), intent(in) :: table                  !< file with the whole results; empty or '-': none
    character(len=*), intent(in) :: data_file              !< name of the data file
    integer, intent(in) :: i                               !< number of the plot in the run, from 1
    character(len=:), allocatable, intent(out) :: picture  !< file of the picture; '-': the plot is drawn in the terminal

    call target_of_plot(text, picture)
    if (picture /= '') return
    if (table /= '' .and. table /= '-') then
      picture = with_ending(table, '')
    else
      picture = with_ending(name_of(data_file), '')
    end if
    if (i > 1) picture = picture//'-'//to_text(i)
    picture = picture//'.svg'
  end subroutine picture_of_plot

  !> Plot rows that are in memory.
  subroutine plot_columns(text, heading, labels, rows, events, picture, said, err)
    character(len=*), intent(in) :: text                !< request in the form of the argument of --plot
    type(heading_type), intent(in) :: heading           !< title, and columns of the results, the time first
    type(string_type), intent(in) :: labels(:)          !< names of the columns as the plot shows them
    real(wp), intent(in) :: rows(:, :)                  !< (columns,rows) rows of the results
    type(told_events_type), intent(in) :: events        !< those of the run
    character(len=*), intent(in) :: picture             !< file of the picture, unless `text` names one
    character(len=:), allocatable, intent(out) :: said  !< a line for the user; empty: nothing to say
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(plot_type) :: plot

    said = ''
    call plot%open(text, heading, size(rows, 2), picture, '', err)
    if (allocated(err)) return
    call plot%call_columns(heading%names, labels)
    call plot%write_rows(rows, err)
    call plot%mark(events)
    call plot%close(err)
    said = plot%words()
  end subroutine plot_columns
end module mech9_plot
