!> Pictures of a mechanism in files: a sketch, and a moving picture.
module mech9_mechanism_pictures
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type
  use mech9_path, only: ending_of
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_arrow, only: arrow_type
  use mech9_force_arrows, only: find_arrows
  use mech9_arrow_drawing, only: ends_of, take_arrows, add_arrows
  use mech9_film, only: film_type, new_film
  use mech9_view, only: view_type, read_view
  use mech9_skeleton, only: skeleton_type, make_skeleton
  use mech9_slide_places, only: place_slides
  use mech9_wheel_figures, only: find_figures
  use mech9_cam_figures, only: find_cam_figures
  use mech9_view_choice, only: choose_view
  use mech9_projection, only: projection_type, fit_projection
  use mech9_scene, only: scene_type
  use mech9_scene_making, only: make_scene
  use mech9_svg_picture, only: save_sketch
  use mech9_html_film, only: save_html_film
  use mech9_svg_film, only: save_svg_film
  use mech9_gif_film, only: save_gif_film
  use mech9_mp4_film, only: save_mp4_film
  use mech9_pose_marks, only: pose_mark_type
  implicit none
  private
  public :: mechanism_pictures_type, kind_of_picture, is_moving_kind, moving_endings

  !> The endings of moving pictures, in words for messages.
  character(len=*), parameter :: moving_endings = '.html, .svg, .gif or .mp4'

  !> The pictures to make. An empty path means no picture.
  type :: mechanism_pictures_type
    character(len=:), allocatable :: sketch
    type(string_type), allocatable :: animations(:)   !< moving pictures; not allocated: none
    character(len=:), allocatable :: plot     !< columns that a page plots at first, as for --plot; not allocated: some coordinates
    type(view_type), allocatable :: view      !< unless the best one is to be found
    logical :: with_masses = .false.          !< bodies count in this program
    type(pose_mark_type), allocatable :: poses(:)     !< poses that links should take; not allocated: none
  contains
    procedure :: any_wanted
    procedure :: take_view
    procedure :: mark_pose
    procedure :: save => save_pictures
    procedure :: save_start
  end type mechanism_pictures_type

contains

  !> Whether any picture is wanted.
  pure logical function any_wanted(self)
    class(mechanism_pictures_type), intent(in) :: self   !< the pictures

    any_wanted = self%sketch /= ''
    if (allocated(self%animations)) any_wanted = any_wanted .or. size(self%animations) > 0
  end function any_wanted

  !> Take the view from which the pictures show the mechanism. Fails where the words are not those of a view.
  subroutine take_view(self, words, code, err)
    class(mechanism_pictures_type), intent(inout) :: self   !< the pictures
    character(len=*), intent(in) :: words                   !< as those of --view
    integer, intent(in) :: code                             !< exit code of a failure
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed

    if (.not. allocated(self%view)) allocate (self%view)
    call read_view(words, code, self%view, err)
  end subroutine take_view

  !> Mark a pose that a link should take.
  subroutine mark_pose(self, link, number, place, turn)
    class(mechanism_pictures_type), intent(inout) :: self   !< the pictures
    integer, intent(in) :: link                             !< number of the link
    integer, intent(in) :: number                           !< of the pose
    real(wp), intent(in) :: place(3)                        !< of its point, in the frame [m]
    real(wp), intent(in) :: turn(3, 3)                      !< rotation of the link

    if (.not. allocated(self%poses)) allocate (self%poses(0))
    self%poses = [self%poses, pose_mark_type(link, number, place, turn)]
  end subroutine mark_pose

  !> Make the sketch of an assembled position, without a run. Errors are exit_file.
  subroutine save_start(self, model, plan, start, err)
    class(mechanism_pictures_type), intent(in) :: self  !< the pictures
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(state_type), intent(in) :: start               !< assembled position
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(mechanism_pictures_type) :: sketch_only
    type(film_type) :: film

    film = new_film(model%mechanism, model%problem%partition%independent(), 1)
    call film%take(model%mechanism, plan, start, [start%t])
    sketch_only%sketch = self%sketch
    if (allocated(self%view)) allocate (sketch_only%view, source=self%view)
    sketch_only%with_masses = self%with_masses
    call sketch_only%save(model, film, err)
  end subroutine save_start

  !> Make the pictures of a film; a film without frames gives none. Errors are exit_file.
  subroutine save_pictures(self, model, film, err)
    class(mechanism_pictures_type), intent(in) :: self  !< the pictures
    type(model_type), intent(in) :: model               !< the model
    type(film_type), intent(in) :: film                 !< poses and columns at some outputs
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(skeleton_type) :: skeleton
    type(view_type) :: view
    logical :: along_normal
    integer :: i

    if (film%n_frames == 0) return
    call make_skeleton(model%mechanism, film, skeleton)
    call place_slides(model%mechanism, film, skeleton)
    call find_figures(model%mechanism, film, skeleton)
    if (allocated(model%request%cams)) call find_cam_figures(model%request%cams, film, skeleton)
    call choose_view(model%mechanism, film, skeleton, view)
    if (allocated(self%view)) then
      along_normal = view%along_normal .and. abs(dot_product(self%view%toward, view%toward)) > 1.0_wp - 1.0e-6_wp
      view = self%view
      view%along_normal = along_normal
    end if
    if (self%sketch /= '') call save_one(self, model, film, skeleton, view, 0, err)
    if (.not. allocated(self%animations)) return
    do i = 1, size(self%animations)
      if (.not. allocated(err)) call save_one(self, model, film, skeleton, view, i, err)
    end do
  end subroutine save_pictures

  !> Make one picture. The mechanism on a page can be turned unless it is planar; its projection leaves room for that.
  subroutine save_one(self, model, film, skeleton, view, number, err)
    class(mechanism_pictures_type), intent(in) :: self  !< the pictures
    type(model_type), intent(in) :: model               !< the model
    type(film_type), intent(in) :: film                 !< poses and columns at some outputs
    type(skeleton_type), intent(in) :: skeleton         !< places of the pairs on their axes
    type(view_type), intent(in) :: view                 !< direction of the view
    integer, intent(in) :: number                       !< of the moving picture; 0: the sketch
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(projection_type) :: projection
    type(scene_type) :: scene
    type(film_type) :: shown
    type(arrow_type), allocatable :: arrows(:)
    type(pose_mark_type), allocatable :: poses(:)
    character(len=:), allocatable :: path, plot
    logical :: page

    if (number == 0) then
      path = self%sketch
    else
      path = self%animations(number)%text
    end if
    page = number > 0 .and. kind_of_picture(path) == 'html'
    call find_arrows(model%mechanism, film, skeleton%size, view%toward, arrows)
    call fit_projection(model%mechanism, film, skeleton, view, page .and. .not. view%along_normal, ends_of(arrows, film, view), &
                        projection)
    allocate (poses(0))
    if (allocated(self%poses)) poses = self%poses
    call make_scene(model%mechanism, film, skeleton, projection, self%with_masses .or. allocated(film%forces), poses, scene)
    shown = film
    if (size(arrows) > 0) then
      call take_arrows(arrows, film, projection, shown)
      call add_arrows(arrows, shown, projection, scene)
    end if
    if (number == 0) then
      call save_sketch(path, model%mechanism%title, scene, shown, projection, 1, err)
    else if (page) then
      plot = ''
      if (allocated(self%plot)) plot = self%plot
      call save_html_film(path, model%mechanism, scene, shown, projection, plot, err)
    else if (kind_of_picture(path) == 'gif') then
      call save_gif_film(path, model%mechanism%title, scene, shown, projection, err)
    else if (kind_of_picture(path) == 'mp4') then
      call save_mp4_film(path, model%mechanism%title, scene, shown, projection, err)
    else
      call save_svg_film(path, model%mechanism%title, scene, shown, projection, err)
    end if
  end subroutine save_one

  !> Whether a moving picture can have this name.
  pure logical function is_moving_kind(path)
    character(len=*), intent(in) :: path   !< name of the file

    is_moving_kind = any(kind_of_picture(path) == [character(len=4) :: 'html', 'svg', 'gif', 'mp4'])
  end function is_moving_kind

  !> The kind of picture by the name of its file: the ending in lower case; htm counts as html.
  pure function kind_of_picture(path) result(kind)
    character(len=*), intent(in) :: path   !< name of the file
    character(len=len(ending_of(path)) + 1) :: kind

    kind = ending_of(path)
    if (kind == 'htm') kind = 'html'
  end function kind_of_picture
end module mech9_mechanism_pictures
