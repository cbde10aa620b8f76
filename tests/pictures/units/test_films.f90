!> Films in files: SVG and pages are whole documents that show all frames.
module test_films
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_file
  use mech9_film, only: film_type
  use mech9_model, only: model_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type
  use mech9_svg_film, only: save_svg_film, duration_of
  use mech9_svg_picture, only: save_sketch
  use mech9_html_film, only: save_html_film
  use mech9_test_files, only: remove_file, text_of_file, count_of
  use mech9_testing, only: tester_type
  use crank_film, only: take_film, set_scene
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_films.out', title = 'a <b> & c'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('durations')) call durations(tester)
    if (tester%runs('pictures')) call pictures(tester)
    if (tester%runs('failures')) call failures(tester)
  end subroutine run

  !> A film plays as long as its motion takes, from 3 s to 15 s.
  subroutine durations(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(film_type) :: film
    type(model_type) :: model

    call take_film(tester, 4, model, film)
    call tester%near(duration_of(film), 4.0_wp, 0.0_wp, 'a motion of 4 s')
    film%times = 0.25_wp*film%times
    call tester%near(duration_of(film), 3.0_wp, 0.0_wp, 'a shorter motion')
    film%times = -100.0_wp*film%times
    call tester%near(duration_of(film), 15.0_wp, 0.0_wp, 'a longer motion, backwards')
  end subroutine durations

  subroutine pictures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(film_type) :: film
    type(projection_type) :: projection
    type(scene_type) :: scene
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text

    call take_film(tester, 8, model, film)
    call set_scene(model, film, projection, scene)
    call save_sketch(path, title, scene, film, projection, 1, err)
    call tester%no_error(err, 'a sketch')
    call text_of_file(tester, path, text)
    call tester%is_true(index(text, '<?xml') == 1 .and. index(text, 'a &lt;b&gt; &amp; c') > 0, 'the title has no markup')
    call tester%is_true(count_of('<svg', text) == count_of('</svg>', text) .and. count_of('<g', text) == count_of('</g>', text), &
                        'elements end')
    call tester%is_true(count_of('<animate', text) == 0, 'a sketch does not move')
    call save_svg_film(path, title, scene, film, projection, err)
    call text_of_file(tester, path, text)
    call tester%is_true(count_of('<svg', text) == count_of('</svg>', text) .and. count_of('<g', text) == count_of('</g>', text), &
                        'elements of a film end')
    call tester%is_true(count_of('<animate', text) > 0 .and. index(text, 'dur="8s"') > 0, 'a film moves, for 8 s')
    call tester%is_true(index(text, 'NaN') == 0 .and. index(text, '***') == 0, 'all numbers are numbers')
    model%mechanism%title = title
    call save_html_film(path, model%mechanism, scene, film, projection, '', err)
    call text_of_file(tester, path, text)
    call tester%is_true(index(text, '<!DOCTYPE html>') == 1 .and. index(text, '</html>') > 0, 'a page is whole')
    call tester%is_true(index(text, 'a <b>') == 0, 'its title has no markup')
    call remove_file(path)
  end subroutine pictures

  subroutine failures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(film_type) :: film
    type(projection_type) :: projection
    type(scene_type) :: scene
    type(error_type), allocatable :: err

    call take_film(tester, 1, model, film)
    call set_scene(model, film, projection, scene)
    call save_svg_film('there_is_no_such_folder/a.svg', title, scene, film, projection, err)
    call tester%has_error(err, exit_file, 'a folder that is not there')
  end subroutine failures
end module test_films
