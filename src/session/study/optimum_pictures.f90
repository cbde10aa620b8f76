!> Pictures of the best design of a synthesis: plots of targets and result, and drawings and films of it with the targets.
module mech9_optimum_pictures
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type
  use mech9_path, only: name_of
  use mech9_system, only: asked_to_end
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_written_files, only: result_paths_type, find_result_paths
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_plot, only: picture_of_plot
  use mech9_plot_drawing, only: draw_picture, draw_in_terminal, script_of_plot
  use mech9_terminal_size, only: find_terminal_size
  use mech9_fit_request, only: fit_request_type, read_fit_request
  use mech9_fit_script, only: fit_panel_type, fit_script, fit_terminal_script
  use mech9_kept_search, only: kept_search_type
  use mech9_fit_panels, only: append_panels, name_of_objective
  implicit none
  private
  public :: optimum_pictures_type

  type :: optimum_pictures_type
    private
    type(picture_requests_type) :: drawings                   !< sketch and film
    type(fit_request_type), allocatable :: plots(:)
    type(string_type), allocatable :: pictures(:)             !< (plots) file of each
  contains
    procedure :: open => open_pictures
    procedure :: draw
    procedure, private :: draw_plots, draw_film
  end type optimum_pictures_type

  !> Most targets whose places a drawing shows.
  integer, parameter :: most_targets = 100

contains

  !> Read the requests before the search. A wrong one is an error of the command line, or of the data file.
  subroutine open_pictures(self, options, given, err)
    class(optimum_pictures_type), intent(inout) :: self   !< the pictures
    type(command_line_type), intent(in) :: options        !< the command line
    type(data_file_type), intent(in) :: given             !< the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(string_type), allocatable :: requests(:)
    type(string_type) :: names(size(given%model%request%objectives))
    type(result_paths_type) :: paths
    integer :: i

    call read_picture_requests(options, given, self%drawings, err)
    if (allocated(err)) return
    call find_result_paths(options, paths, given)
    do i = 1, size(names)
      names(i)%text = name_of_objective(given%model, i)
    end do
    call options%arguments('plot', requests)
    if (given%model%program == dynamics .and. (size(requests) > 0 .or. self%drawings%any_wanted())) then
      call raise(err, exit_usage, 'mech9d --optimize draws no pictures; write the best design by --out FILE.nml, and '// &
                 'give --plot, --sketch and --animate to its run')
      return
    end if
    allocate (self%plots(size(requests)), self%pictures(size(requests)))
    do i = 1, size(requests)
      call read_fit_request(requests(i)%text, names, self%plots(i), err)
      if (allocated(err)) return
      call picture_of_plot(requests(i)%text, paths%table, options%file, i, self%pictures(i)%text)
    end do
  end subroutine open_pictures

  !> Draw all pictures of the best design, and tell where they are. An interrupted program draws none, which would take too long.
  subroutine draw(self, options, given, found)
    class(optimum_pictures_type), intent(in) :: self            !< the pictures
    type(command_line_type), intent(in) :: options              !< the command line
    type(data_file_type), intent(inout), target :: given        !< the data file; it gets the errors
    type(kept_search_type), intent(inout), target :: found      !< made
    type(error_type), allocatable :: err

    if (asked_to_end() .or. size(found%search%synthesis%optima) == 0) return
    if (size(self%plots) == 0 .and. .not. self%drawings%any_wanted()) return
    call found%move_best(given, err)
    if (allocated(err)) then
      call given%fail(err)
      return
    end if
    call self%draw_plots(given, found, options%has('quiet'))
    if (self%drawings%any_wanted()) call self%draw_film(given, found, options%has('quiet'))
  end subroutine draw

  !> Draw the plots of targets and result.
  subroutine draw_plots(self, given, found, quiet)
    class(optimum_pictures_type), intent(in) :: self            !< the pictures
    type(data_file_type), intent(inout) :: given                !< the data file; it gets the errors
    type(kept_search_type), intent(inout), target :: found      !< made, with the motion of the best design
    logical, intent(in) :: quiet                                !< only a picture that could not be made is told
    type(fit_panel_type), allocatable :: panels(:)
    type(error_type), allocatable :: err
    character(len=:), allocatable :: said
    logical :: is_lacking
    integer :: i, k, columns, lines

    do i = 1, size(self%plots)
      if (allocated(panels)) deallocate (panels)
      allocate (panels(0))
      do k = 1, size(self%plots(i)%wanted)
        if (self%plots(i)%wanted(k) .and. .not. allocated(err)) &
          call append_panels(found%best, found%search%synthesis, k, name_of_objective(given%model, k), panels, err)
      end do
      said = ''
      is_lacking = .false.
      if (allocated(err)) then
        call given%fail(err)
      else if (self%plots(i)%in_terminal) then
        call find_terminal_size(columns, lines)
        call draw_in_terminal(fit_terminal_script(panels, columns, lines), err)
      else
        associate (picture => self%pictures(i)%text)
          call draw_picture(picture, fit_script(found%best%model%mechanism%title, panels, name_of(picture), &
                                                name_of(script_of_plot(picture))), said, is_lacking, err)
        end associate
      end if
      call given%fail(err)
      if (said /= '' .and. (is_lacking .or. .not. quiet)) write (error_unit, '(a)') said
    end do
  end subroutine draw_plots

  !> Make sketch and film of the best design, with its targets: places as points of link 1, and poses.
  subroutine draw_film(self, given, found, quiet)
    class(optimum_pictures_type), intent(in) :: self            !< the pictures
    type(data_file_type), intent(inout) :: given                !< the data file; it gets the errors
    type(kept_search_type), intent(inout), target :: found      !< made, with the motion of the best design
    logical, intent(in) :: quiet                                !< nothing is told
    type(picture_requests_type) :: drawings
    type(signal_interruption_type), target :: interruption
    type(error_type), allocatable :: err
    integer :: i

    drawings = self%drawings
    call found%best%show_targets(found%search%synthesis, most_targets)
    do i = 1, min(most_targets, size(found%search%synthesis%targets))
      associate (synthesis => found%search%synthesis, target => found%search%synthesis%targets(i))
        if (target%length > 0.0_wp) &
          call drawings%mark_pose(target%link, synthesis%number_in_objective(i), target%place, target%turn)
      end associate
    end do
    call found%best%make_film(interruption, err)
    if (.not. allocated(err)) call drawings%save(found%best%shown, found%best%film, err)
    if (allocated(err)) then
      call given%fail(err)
    else if (.not. quiet) then
      call drawings%print_words(error_unit)
    end if
  end subroutine draw_film
end module mech9_optimum_pictures
