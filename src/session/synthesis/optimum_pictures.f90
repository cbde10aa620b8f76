!> Pictures of the best design of a synthesis: plots of targets and result, and drawings and films of it with the targets.
module mech9_optimum_pictures
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, to_text
  use mech9_path, only: name_of
  use mech9_system, only: asked_to_end
  use mech9_command_line, only: command_line_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_point, only: point_type
  use mech9_objective, only: path_objective, function_objective, pose_objective
  use mech9_variable_model, only: variable_model_type
  use mech9_film, only: film_type
  use mech9_picture_requests, only: picture_requests_type, read_picture_requests
  use mech9_written_files, only: result_paths_type, find_result_paths
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_plot, only: picture_of_plot
  use mech9_plot_drawing, only: draw_picture, draw_in_terminal, script_of_plot
  use mech9_terminal_size, only: find_terminal_size
  use mech9_fit_request, only: fit_request_type, read_fit_request
  use mech9_fit_script, only: fit_panel_type, fit_script, fit_terminal_script
  use mech9_synthesis, only: synthesis_type
  use mech9_design_motion, only: design_motion_type, new_design_motion
  use mech9_fit_panels, only: append_panels
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
  subroutine open_pictures(self, options, model, err)
    class(optimum_pictures_type), intent(inout) :: self   !< the pictures
    type(command_line_type), intent(in) :: options        !< the command line
    type(model_type), intent(in) :: model                 !< with its objectives
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(string_type), allocatable :: requests(:)
    type(string_type) :: names(size(model%request%objectives))
    type(result_paths_type) :: paths
    integer :: i

    call read_picture_requests(options, model, self%drawings, err)
    if (allocated(err)) return
    call find_result_paths(options, model%request%output, paths)
    do i = 1, size(names)
      names(i)%text = name_of_objective(model, i)
    end do
    call options%arguments('plot', requests)
    if (model%program == dynamics .and. (size(requests) > 0 .or. self%drawings%any_wanted())) then
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

  !> The name of an objective with targets; empty where it has none.
  function name_of_objective(model, number) result(name)
    type(model_type), intent(in) :: model    !< with its objectives
    integer, intent(in) :: number            !< of the objective
    character(len=:), allocatable :: name

    associate (objective => model%request%objectives(number))
      select case (objective%kind)
      case (path_objective)
        name = model%mechanism%points(objective%point)%name
      case (function_objective)
        name = 'q'//to_text(objective%coordinate)
      case (pose_objective)
        name = 'link'//to_text(objective%link)
      case default
        name = ''
      end select
    end associate
  end function name_of_objective

  !> Draw all pictures of the best design, and tell where they are. An interrupted program draws none, which would take too long.
  subroutine draw(self, options, variable, synthesis, diagnostics)
    class(optimum_pictures_type), intent(in) :: self            !< the pictures
    type(command_line_type), intent(in) :: options              !< the command line
    class(variable_model_type), intent(inout) :: variable       !< the model as a function of its parameters
    type(synthesis_type), intent(in) :: synthesis               !< with its optima, best first
    type(diagnostics_type), intent(inout) :: diagnostics        !< gets the errors
    class(design_motion_type), allocatable, target :: motion
    type(error_type), allocatable :: err

    if (asked_to_end() .or. size(synthesis%optima) == 0) return
    if (size(self%plots) == 0 .and. .not. self%drawings%any_wanted()) return
    allocate (motion)
    call new_design_motion(variable, synthesis%space%model, synthesis%values_of(1), synthesis%optima(1)%q, motion, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
      return
    end if
    call self%draw_plots(motion, synthesis, options%has('quiet'), diagnostics)
    if (self%drawings%any_wanted()) call self%draw_film(motion, synthesis, options%has('quiet'), diagnostics)
  end subroutine draw

  !> Draw the plots of targets and result.
  subroutine draw_plots(self, motion, synthesis, quiet, diagnostics)
    class(optimum_pictures_type), intent(in) :: self            !< the pictures
    type(design_motion_type), intent(inout), target :: motion   !< of the best design
    type(synthesis_type), intent(in) :: synthesis               !< with its optima, best first
    logical, intent(in) :: quiet                                !< only a picture that could not be made is told
    type(diagnostics_type), intent(inout) :: diagnostics        !< gets the errors
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
          call append_panels(motion, synthesis, k, name_of_objective(motion%model, k), panels, err)
      end do
      said = ''
      is_lacking = .false.
      if (allocated(err)) then
        call diagnostics%add_error(err)
      else if (self%plots(i)%in_terminal) then
        call find_terminal_size(columns, lines)
        call draw_in_terminal(fit_terminal_script(panels, columns, lines), err)
      else
        associate (picture => self%pictures(i)%text)
          call draw_picture(picture, fit_script(motion%model%mechanism%title, panels, name_of(picture), &
                                                name_of(script_of_plot(picture))), said, is_lacking, err)
        end associate
      end if
      if (allocated(err)) call diagnostics%add_error(err)
      if (said /= '' .and. (is_lacking .or. .not. quiet)) write (error_unit, '(a)') said
    end do
  end subroutine draw_plots

  !> Make sketch and film of the best design, with its targets.
  subroutine draw_film(self, motion, synthesis, quiet, diagnostics)
    class(optimum_pictures_type), intent(in) :: self            !< the pictures
    type(design_motion_type), intent(inout), target :: motion   !< of the best design
    type(synthesis_type), intent(in) :: synthesis               !< with its targets
    logical, intent(in) :: quiet                                !< nothing is told
    type(diagnostics_type), intent(inout) :: diagnostics        !< gets the errors
    type(picture_requests_type) :: drawings
    type(model_type) :: shown
    type(film_type) :: film
    type(signal_interruption_type), target :: interruption
    type(error_type), allocatable :: err

    shown = motion%model
    drawings = self%drawings
    call add_targets(synthesis, shown, drawings)
    call motion%make_film(shown, interruption, film, err)
    if (.not. allocated(err)) call drawings%save(shown, film, err)
    if (allocated(err)) then
      call diagnostics%add_error(err)
    else if (.not. quiet) then
      call drawings%print_words(error_unit)
    end if
  end subroutine draw_film

  !> Add the places of targets to a model as points of link 1, named by their numbers within their objective, and the poses to the drawings.
  subroutine add_targets(synthesis, shown, drawings)
    type(synthesis_type), intent(in) :: synthesis        !< with its targets
    type(model_type), intent(inout) :: shown             !< the model of a drawing
    type(picture_requests_type), intent(inout) :: drawings   !< get the poses
    type(point_type) :: point
    integer :: i, number, objective

    objective = 0
    do i = 1, min(most_targets, size(synthesis%targets))
      associate (target => synthesis%targets(i))
        number = merge(number + 1, 1, target%objective == objective)
        objective = target%objective
        if (shown%request%objectives(objective)%kind == function_objective) cycle
        point%name = to_text(number)
        point%link = 1
        point%position = target%place
        shown%mechanism%points = [shown%mechanism%points, point]
        if (shown%request%objectives(objective)%kind == pose_objective) &
          call drawings%mark_pose(target%link, number, target%place, target%turn)
      end associate
    end do
  end subroutine add_targets
end module mech9_optimum_pictures
