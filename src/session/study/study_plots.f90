!> The plots that --plot requests of a study.
module mech9_study_plots
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_plot, only: picture_of_plot
  use mech9_plot_request, only: is_of_section
  use mech9_study_plot, only: study_plot_type
  use mech9_heading, only: new_heading
  use mech9_kept_study, only: kept_study_type
  implicit none
  private
  public :: study_plots_type

  type :: study_plots_type
    private
    type(study_plot_type), allocatable :: plots(:)
  contains
    procedure :: open => open_plots
    procedure :: draw => draw_plots
  end type study_plots_type

contains

  !> Read the requests before the runs. A wrong one is an error of the command line.
  subroutine open_plots(self, options, given, table, err)
    class(study_plots_type), intent(inout) :: self         !< the plots
    type(command_line_type), intent(in) :: options         !< the command line
    type(data_file_type), intent(in) :: given              !< the data file
    character(len=*), intent(in) :: table                  !< file of the table; empty or '-': none
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(string_type), allocatable :: requests(:), names(:), units(:)
    character(len=:), allocatable :: picture
    integer :: i, k, n

    n = size(given%model%parameters)
    allocate (names(n + size(given%model%request%quantities)), units(n + size(given%model%request%quantities)))
    do i = 1, n
      names(i)%text = given%model%parameters(i)%name
      units(i)%text = ''
    end do
    do i = 1, size(given%model%request%quantities)
      names(n + i)%text = given%model%request%quantities(i)%name
      units(n + i)%text = given%quantities%unit_of(i)
    end do
    call options%arguments('plot', requests)
    ! the points of a section are drawn with them
    allocate (self%plots(count([(.not. is_of_section(requests(i)%text), i=1, size(requests))])))
    k = 0
    do i = 1, size(requests)
      if (is_of_section(requests(i)%text)) cycle
      k = k + 1
      call picture_of_plot(requests(i)%text, table, options%file, i, picture)
      call self%plots(k)%open(requests(i)%text, new_heading(given%model%mechanism%title, names, units), n, picture, err)
      if (allocated(err)) return
    end do
  end subroutine open_plots

  !> Draw all plots, and print a line about each. Return the first failure; the other plots are drawn all the same.
  subroutine draw_plots(self, study, unit, quiet, err)
    class(study_plots_type), intent(inout) :: self          !< the plots
    type(kept_study_type), intent(in) :: study              !< made, with a sample of the runs
    integer, intent(in) :: unit                             !< Fortran unit to write to
    logical, intent(in) :: quiet                            !< only a picture that could not be made is told
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: own
    integer :: i

    do i = 1, size(self%plots)
      associate (plot => self%plots(i), sample => study%runs%statistics%sample)
        call plot%draw(sample%rows(:, :sample%kept), own)
        if (.not. allocated(err)) call move_alloc(own, err)
        if (plot%said /= '' .and. (plot%is_lacking .or. .not. quiet)) write (unit, '(a)') plot%said
      end associate
    end do
  end subroutine draw_plots
end module mech9_study_plots
