!> From space to the page: scales, axes, the whole motion on the page, and the view of a plane mechanism.
module test_projection
  use mech9_kinds, only: wp
  use mech9_body, only: body_type
  use mech9_film, only: film_type
  use mech9_model, only: model_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, item_type, segments, open_path, in_damper, in_pairs, mark, as_dot
  use mech9_drawing, only: drawing_type, draw_frame, drawing_order
  use mech9_xml_text, only: xml_text, decimal
  use mech9_checks, only: near_vector
  use mech9_small_models, only: crank, rod
  use mech9_testing, only: tester_type
  use crank_film, only: take_film, set_scene
  implicit none
  private
  public :: run

  real(wp), parameter :: tol = 1.0e-10_wp   ! places in px, of closed chains to round-off

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('film')) call film_of_turn(tester)
    if (tester%runs('page')) call page(tester)
    if (tester%runs('far_mass')) call far_mass(tester)
    if (tester%runs('nodes')) call nodes(tester)
    if (tester%runs('lists')) call lists(tester)
    if (tester%runs('texts')) call texts(tester)
  end subroutine run

  !> The film has the positions of the formulas: at a right angle of the crank the slider is at sqrt(l^2 - r^2).
  subroutine film_of_turn(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(film_type) :: film

    call take_film(tester, 4, model, film)
    call tester%is_true(film%n_frames == 5, 'five frames')
    call near_vector(tester, film%times(:5), [0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp], 0.0_wp, 'their times')
    call near_vector(tester, film%position(1, 4, [0.0_wp, 0.0_wp, 0.0_wp]), [rod + crank, 0.0_wp, 0.0_wp], tol, 'stretched')
    call near_vector(tester, film%position(2, 4, [0.0_wp, 0.0_wp, 0.0_wp]), [sqrt(rod**2 - crank**2), 0.0_wp, 0.0_wp], tol, &
                     'the slider at a right angle')
    call near_vector(tester, film%position(2, 2, [crank, 0.0_wp, 0.0_wp]), [0.0_wp, crank, 0.0_wp], tol, 'the crank upright')
    call near_vector(tester, film%direction(3, 2, [1.0_wp, 0.0_wp, 0.0_wp]), [-1.0_wp, 0.0_wp, 0.0_wp], tol, 'the crank back')
    call near_vector(tester, film%local(2, 2, [0.0_wp, crank, 0.0_wp]), [crank, 0.0_wp, 0.0_wp], tol, 'a place seen by the crank')
  end subroutine film_of_turn

  !> The page shows x to the right and y up; all places of the motion are on it.
  subroutine page(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(film_type) :: film
    type(projection_type) :: projection
    type(scene_type) :: scene
    real(wp) :: a(2), b(2), depth
    integer :: i

    call take_film(tester, 12, model, film)
    call set_scene(model, film, projection, scene)
    call tester%is_true(projection%view%along_normal, 'the mechanism is plane')
    call near_vector(tester, projection%view%toward, [0.0_wp, 0.0_wp, 1.0_wp], 0.0_wp, 'it is seen along the normal of its plane')
    call projection%on_page(projection%centre, a, depth)
    call near_vector(tester, [a, depth], [projection%middle, 0.0_wp], tol, 'the centre is in the middle')
    call projection%on_page(projection%centre + [0.5_wp, 0.25_wp, 2.0_wp], b, depth)
    call near_vector(tester, b - a, projection%scale*[0.5_wp, -0.25_wp], tol, 'x goes to the right and y up, by the scale')
    call tester%near(depth, 2.0_wp, tol, 'z comes to the viewer')
    call tester%near(projection%metres(10.0_wp)*projection%scale, 10.0_wp*projection%symbol, tol, 'the size of symbols')
    do i = 1, film%n_frames
      call projection%on_page(film%position(i, 2, [crank, 0.0_wp, 0.0_wp]), a, depth)
      call tester%is_true(all(a > 0.0_wp) .and. a(1) < projection%width .and. a(2) < projection%height, 'the crank is on the page')
      call projection%on_page(film%position(i, 4, [0.0_wp, 0.0_wp, 0.0_wp]), a, depth)
      call tester%is_true(all(a > 0.0_wp) .and. a(1) < projection%width .and. a(2) < projection%height, 'the slider is on the page')
    end do
  end subroutine page

  !> A centre of mass far from all pairs is on the page, too, wherever the crank carries it.
  subroutine far_mass(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(film_type) :: film
    type(projection_type) :: projection
    type(scene_type) :: scene
    real(wp) :: at(2), depth
    integer :: i

    call take_film(tester, 12, model, film)
    model%mechanism%bodies = [body_type(link=2, mass=1.0_wp, centre=[-10.0_wp*rod, 0.0_wp, 0.0_wp])]
    call set_scene(model, film, projection, scene)
    do i = 1, film%n_frames
      call projection%on_page(film%position(i, 2, model%mechanism%bodies(1)%centre), at, depth)
      call tester%is_true(all(at > 0.0_wp) .and. at(1) < projection%width .and. at(2) < projection%height, 'the mass is seen')
    end do
  end subroutine far_mass

  !> The places of nodes on the page are those of their links.
  subroutine nodes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(film_type) :: film
    type(projection_type) :: projection
    type(scene_type) :: scene
    type(drawing_type) :: drawing
    integer, allocatable :: order(:)
    real(wp), allocatable :: places(:, :)
    real(wp) :: xy(2), depth, far
    integer :: i

    call take_film(tester, 4, model, film)
    call set_scene(model, film, projection, scene)
    drawing = draw_frame(scene, film, projection, 2)
    places = scene%places_at(film, 2)
    far = 0.0_wp
    do i = 1, scene%n_nodes
      far = max(far, maxval(abs(places(:, i) - film%position(2, scene%node_link(i), scene%node_at(:, i)))))
      call projection%on_page(places(:, i), xy, depth)
      far = max(far, maxval(abs(drawing%xy(:, i) - xy)))
    end do
    call tester%near(far, 0.0_wp, tol, 'all nodes are where their links are')
    order = drawing_order(scene, drawing)
    call tester%is_true(size(order) == scene%n_items .and. all([(count(order == i) == 1, i=1, scene%n_items)]), &
                        'each item is drawn once')
  end subroutine nodes

  !> Lists of nodes and items grow and keep what they have.
  subroutine lists(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(scene_type) :: scene
    type(item_type) :: item
    integer :: i, node
    logical :: right

    do i = 1, 200
      call scene%add_node(i, [1.0_wp*i, 0.0_wp, 0.0_wp], node)
      call scene%add_item(mark, as_dot, [node], link=i, text='node')
    end do
    right = scene%n_nodes == 200 .and. scene%n_items == 200
    do i = 1, 200
      right = right .and. scene%node_link(i) == i .and. all(scene%items(i)%nodes == [i]) .and. scene%items(i)%text == 'node'
    end do
    call tester%is_true(right, 'two hundred nodes and items')
    call tester%is_true(.not. in_pairs(scene%items(1)), 'a mark has no pairs of corners')
    item%shape = segments
    call tester%is_true(in_pairs(item), 'segments have')
    item%shape = open_path
    item%style = in_damper
    call tester%is_true(in_pairs(item), 'dampers have')
  end subroutine lists

  subroutine texts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(xml_text('a<b> & "c" ''d''') == 'a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;', 'letters with a meaning')
    call tester%is_true(decimal(12.5_wp) == '12.5' .and. decimal(-0.25_wp) == '-0.25' .and. decimal(7.0_wp) == '7', 'decimals')
    call tester%is_true(decimal(-0.001_wp) == '0' .and. decimal(0.996_wp) == '1' .and. decimal(0.05_wp) == '0.05', 'rounding')
    call tester%is_true(decimal(1.0e30_wp) == '20000000' .and. decimal(-1.0e30_wp) == '-20000000', 'the largest numbers')
  end subroutine texts
end module test_projection
