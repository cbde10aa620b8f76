!> A film of the slider-crank, turned in equal steps, and its scene, for the tests of pictures.
module crank_film
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_film, only: film_type, new_film
  use mech9_skeleton, only: skeleton_type, make_skeleton
  use mech9_slide_places, only: place_slides
  use mech9_view, only: view_type
  use mech9_view_choice, only: choose_view
  use mech9_projection, only: projection_type, fit_projection
  use mech9_scene, only: scene_type
  use mech9_scene_making, only: make_scene
  use mech9_pose_marks, only: pose_mark_type
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: take_film, set_scene

contains

  !> Frames of a turn: the crank goes from 0 to a full turn, in one second for each step.
  subroutine take_film(tester, steps, model, film)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, intent(in) :: steps                 !< of the turn
    type(model_type), intent(out) :: model       !< the model
    type(film_type), intent(out) :: film         !< its frames
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: i

    call model_from_text(tester, slider_crank//"&drive coordinate=1, kind='polynomial', coefficients=0, 1 /"//eol, &
                         kinematics, model)
    film = new_film(model%mechanism, model%problem%partition%independent(), steps + 1)
    do i = 0, steps
      model%problem%initial%position(1) = 8.0_wp*atan(1.0_wp)*i/steps
      call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
      call tester%no_error(err, 'a position of the crank')
      state%t = i
      call film%take(model%mechanism, plan, state, [state%t])
    end do
  end subroutine take_film

  !> The scene of a film as pictures show it.
  subroutine set_scene(model, film, projection, scene)
    type(model_type), intent(in) :: model                !< the model
    type(film_type), intent(in) :: film                  !< its frames
    type(projection_type), intent(out) :: projection     !< from space to the page
    type(scene_type), intent(out) :: scene               !< nodes and items
    type(skeleton_type) :: skeleton
    type(view_type) :: view

    call make_skeleton(model%mechanism, film, skeleton)
    call place_slides(model%mechanism, film, skeleton)
    call choose_view(model%mechanism, film, skeleton, view)
    call fit_projection(model%mechanism, film, skeleton, view, .false., reshape([real(wp) ::], [3, 0, 0]), projection)
    call make_scene(model%mechanism, film, skeleton, projection, .false., [pose_mark_type ::], scene)
  end subroutine set_scene
end module crank_film
