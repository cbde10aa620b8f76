!> Pictures of a mechanism as the library's users ask for them: a sketch of its start, and a film of a run.
module mech9_drawn_mechanism
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: interruption_type
  use mech9_explained_assembly, only: assemble_model
  use mech9_view, only: read_view
  use mech9_mechanism_pictures, only: mechanism_pictures_type, kind_of_picture, is_moving_kind, moving_endings
  use mech9_checked_mechanism, only: checked_mechanism_type
  use mech9_recorded_run, only: recorded_run_type
  implicit none
  private
  public :: draw_sketch, draw_film

contains

  !> Draw the assembled start in a file. Fails with exit_usage for a wrong name or view, with exit_data, exit_structure or
  !> exit_assembly where the mechanism cannot be put together, and with exit_file.
  subroutine draw_sketch(mechanism, path, view, err)
    type(checked_mechanism_type), intent(in) :: mechanism      !< the mechanism
    character(len=*), intent(in) :: path                       !< of the picture; it ends with .svg
    character(len=*), intent(in) :: view                       !< as for the option --view; empty: the best one
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(mechanism_pictures_type) :: pictures
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: start

    pictures%sketch = path
    if (kind_of_picture(path) /= 'svg') call raise(err, exit_usage, 'the name of a sketch must end in .svg')
    if (.not. allocated(err)) call choose_view(view, pictures, err)
    if (.not. allocated(err)) call mechanism%take_standing(model, err)
    if (.not. allocated(err)) call assemble_model(model, plan, start, err)
    if (.not. allocated(err)) call pictures%save_start(model, plan, start, err)
    call mechanism%point_at(err)
  end subroutine draw_sketch

  !> Make a run over the outputs of &time, and draw it as a moving picture. The positions before a failure are drawn. Fails as
  !> draw_sketch does, and as the run.
  subroutine draw_film(mechanism, program, path, view, err, interruption)
    type(checked_mechanism_type), intent(in) :: mechanism            !< the mechanism
    integer, intent(in) :: program                                   !< kinematics or dynamics
    character(len=*), intent(in) :: path                             !< of the picture; it ends with .html, .svg, .gif or .mp4
    character(len=*), intent(in) :: view                             !< as for the option --view; empty: the best one
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the run shall stop
    type(mechanism_pictures_type) :: pictures
    type(recorded_run_type) :: run
    type(error_type), allocatable :: failure
    character(len=:), allocatable :: names(:)
    real(wp), allocatable :: rows(:, :)
    integer :: count

    pictures%sketch = ''
    allocate (pictures%animations(1))
    pictures%animations(1)%text = path
    pictures%with_masses = program == dynamics
    if (.not. is_moving_kind(path)) call raise(err, exit_usage, 'the name of a moving picture must end in '//moving_endings)
    if (.not. allocated(err)) call choose_view(view, pictures, err)
    if (.not. allocated(err)) call run%begin_film(mechanism, program, err, interruption)
    if (allocated(err)) return
    call run%columns(names)
    allocate (rows(size(names), run%outputs()))
    call run%take_rows(rows, count, err)
    call run%draw(pictures, failure)
    if (.not. allocated(err) .and. allocated(failure)) call move_alloc(failure, err)
    call run%close()
  end subroutine draw_film

  !> Take a view, where one is named.
  subroutine choose_view(view, pictures, err)
    character(len=*), intent(in) :: view                        !< as for the option --view; empty: the best one
    type(mechanism_pictures_type), intent(inout) :: pictures    !< gets the view
    type(error_type), allocatable, intent(out) :: err           !< allocated if it is no view

    if (view == '') return
    allocate (pictures%view)
    call read_view(view, exit_usage, pictures%view, err)
  end subroutine choose_view
end module mech9_drawn_mechanism
