!> Pictures of the mechanism itself that a run is asked for: a sketch.
!> Uses error, mechanism, plan, state, the pictures floor, command_line.
module mech9_picture_requests
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_usage, exit_data
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_film, only: film_type, new_film
  use mech9_view, only: view_type, read_view
  use mech9_skeleton, only: skeleton_type, make_skeleton
  use mech9_slide_places, only: place_slides
  use mech9_view_choice, only: choose_view
  use mech9_projection, only: projection_type, fit_projection
  use mech9_scene, only: scene_type
  use mech9_scene_making, only: make_scene
  use mech9_svg_picture, only: save_sketch
  use mech9_command_line, only: command_line_type
  implicit none
  private
  public :: picture_requests_type, read_picture_requests

  !> What is asked for. A path that is empty asks for nothing.
  type :: picture_requests_type
    character(len=:), allocatable :: sketch
    type(view_type), allocatable :: view      !< unless the best one is to be found
    logical :: with_masses = .false.          !< bodies count in this program
  contains
    procedure :: any_wanted
    procedure :: film_for
    procedure :: save => save_pictures
    procedure :: save_start
  end type picture_requests_type

contains

  !> What the options ask for, and the data file where they do not. Errors are those of a view or of the name of a
  !> file that cannot be meant.
  subroutine read_picture_requests(options, mechanism, program_name, requests, err)
    type(command_line_type), intent(in) :: options
    type(mechanism_type), intent(in) :: mechanism
    character(len=*), intent(in) :: program_name
    type(picture_requests_type), intent(out) :: requests
    type(error_type), allocatable, intent(out) :: err

    requests%sketch = mechanism%output%sketch
    if (options%has('sketch')) requests%sketch = options%argument('sketch')
    requests%with_masses = program_name == 'mech9d'
    if (options%has('view')) then
      allocate (requests%view)
      call read_view(options%argument('view'), exit_usage, requests%view, err)
    else if (mechanism%output%view /= '') then
      allocate (requests%view)
      call read_view(mechanism%output%view, exit_data, requests%view, err)
    end if
  end subroutine read_picture_requests

  !> Whether any picture is asked for.
  pure logical function any_wanted(self)
    class(picture_requests_type), intent(in) :: self

    any_wanted = self%sketch /= ''
  end function any_wanted

  !> An empty film for a run of so many outputs.
  pure function film_for(self, mechanism, outputs) result(film)
    class(picture_requests_type), intent(in) :: self
    type(mechanism_type), intent(in) :: mechanism
    integer, intent(in) :: outputs
    type(film_type) :: film

    film = new_film(mechanism, outputs)
  end function film_for

  !> Make the sketch of an assembled position, without a run. Errors are exit_file.
  subroutine save_start(self, mechanism, plan, start, err)
    class(picture_requests_type), intent(in) :: self
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: start
    type(error_type), allocatable, intent(out) :: err
    type(film_type) :: film

    film = new_film(mechanism, 1)
    call film%take(mechanism, plan, start)
    call self%save(mechanism, film, err)
  end subroutine save_start

  !> Make the pictures of a film that has a frame at least. Errors are exit_file.
  subroutine save_pictures(self, mechanism, film, err)
    class(picture_requests_type), intent(in) :: self
    type(mechanism_type), intent(in) :: mechanism
    type(film_type), intent(in) :: film
    type(error_type), allocatable, intent(out) :: err
    type(skeleton_type) :: skeleton
    type(projection_type) :: projection
    type(scene_type) :: scene
    type(view_type) :: view
    logical :: planar

    if (film%n_frames == 0) return
    call make_skeleton(mechanism, film, skeleton)
    call place_slides(mechanism, film, skeleton)
    call choose_view(mechanism, film, skeleton, view, planar)
    if (allocated(self%view)) then
      planar = planar .and. abs(dot_product(self%view%toward, view%toward)) > 1.0_wp - 1.0e-6_wp
      view = self%view
    end if
    call fit_projection(mechanism, film, skeleton, view, .false., projection)
    call make_scene(mechanism, film, skeleton, projection, planar, self%with_masses, scene)
    if (self%sketch /= '') call save_sketch(self%sketch, mechanism%title, scene, film, projection, 1, err)
  end subroutine save_pictures
end module mech9_picture_requests
