!> The plots of a study. Each reads its request before the runs, and draws a sample of their rows afterwards.
module mech9_study_plot
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_heading, only: heading_type
  use mech9_path, only: name_of
  use mech9_terminal_size, only: find_terminal_size
  use mech9_plot_drawing, only: draw_picture, draw_in_terminal, script_of_plot
  use mech9_study_request, only: study_request_type, read_study_request
  use mech9_study_script, only: study_script, study_terminal_script
  implicit none
  private
  public :: study_plot_type

  type :: study_plot_type
    character(len=:), allocatable :: said             !< a line for the user after the plot is drawn; empty: nothing to say
    logical :: is_lacking = .false.                   !< the line tells of a picture that could not be made
    type(heading_type), private :: heading
    character(len=:), allocatable, private :: picture
    type(study_request_type), private :: request
  contains
    procedure :: open => open_plot
    procedure :: draw
  end type study_plot_type

contains

  !> Read the request before the runs, so that a wrong name costs no time (exit_usage).
  subroutine open_plot(self, text, heading, n_parameters, picture, err)
    class(study_plot_type), intent(inout) :: self      !< the plot
    character(len=*), intent(in) :: text               !< the argument of --plot
    type(heading_type), intent(in) :: heading          !< title, and names of the parameters, and of the quantities behind them
    integer, intent(in) :: n_parameters                !< how many of them are parameters
    character(len=*), intent(in) :: picture            !< file of the picture, unless `text` names one
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    self%said = ''
    self%heading = heading
    call read_study_request(text, heading%names, n_parameters, self%request, err)
    if (allocated(err)) return
    self%picture = picture
    if (self%request%target /= '') self%picture = self%request%target
  end subroutine open_plot

  !> Draw rows of a study.
  subroutine draw(self, rows, err)
    class(study_plot_type), intent(inout) :: self      !< the plot
    real(wp), intent(in) :: rows(:, :)                 !< (columns,runs) parameters and quantities of runs that went to their end
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    integer :: columns, lines

    if (size(rows, 2) == 0) then
      self%said = 'plot: none, because no run went to its end'
      return
    end if
    associate (names => self%heading%names, units => self%heading%units)
      if (self%request%in_terminal) then
        call find_terminal_size(columns, lines)
        call draw_in_terminal(study_terminal_script(self%request%panels, names, units, rows, columns, lines), err)
      else
        call draw_picture(self%picture, study_script(self%heading%title, self%request%panels, names, units, rows, &
                          name_of(self%picture), name_of(script_of_plot(self%picture))), self%said, self%is_lacking, err)
      end if
    end associate
  end subroutine draw
end module mech9_study_plot
