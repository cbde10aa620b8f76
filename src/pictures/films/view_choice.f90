!> The choice of the view that shows a mechanism best. A planar mechanism is seen along the normal of its plane. A
!> spatial one is seen from a direction in which its links are long and its pairs lie apart.
module mech9_view_choice
  use mech9_kinds, only: wp, pi
  use mech9_rotation, only: cross, unit, turn, turn_back
  use mech9_mechanism, only: mechanism_type
  use mech9_film, only: film_type
  use mech9_pair_axes, only: turning, sliding, screwing
  use mech9_skeleton, only: skeleton_type
  use mech9_view, only: view_type, view_from, view_of_axes
  implicit none
  private
  public :: choose_view, is_planar

  !> Directions are parallel, or perpendicular, if the sine, or cosine, of their angle is at most this.
  real(wp), parameter :: aligned = 1.0e-6_wp
  !> The largest number of pairs that are examined.
  integer, parameter :: most_looked_at = 60
  !> The number of frames that are examined.
  integer, parameter :: looks = 4

contains

  !> Choose the view that is taken unless the user asks for another one.
  pure subroutine choose_view(mechanism, film, skeleton, view)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(film_type), intent(in) :: film            !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton    !< places at which the pairs are drawn
    type(view_type), intent(out) :: view           !< direction from which the mechanism is seen
    real(wp) :: normal(3), upward(3)
    logical :: planar

    upward = [0.0_wp, 0.0_wp, 1.0_wp]
    if (maxval(abs(mechanism%gravity)) > 0.0_wp) upward = -unit(mechanism%gravity)
    call is_planar(film, skeleton, planar, normal)
    if (.not. planar) then
      view = best_view(film, skeleton, upward)
    else if (abs(normal(3)) > 1.0_wp - aligned) then
      view = view_of_axes(1, 2)
    else if (abs(normal(2)) > 1.0_wp - aligned) then
      view = view_of_axes(1, 3)
    else if (abs(normal(1)) > 1.0_wp - aligned) then
      view = view_of_axes(2, 3)
    else
      if (normal(maxloc(abs(normal), dim=1)) < 0.0_wp) normal = -normal
      view = view_from(normal, upward)
    end if
    view%along_normal = planar
  end subroutine choose_view

  !> Find whether all links move parallel to one plane. Then every pair turns about the normal of the plane or slides in
  !> the plane. This holds for every user's pair in all frames of the film.
  pure subroutine is_planar(film, skeleton, planar, normal)
    type(film_type), intent(in) :: film      !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton !< places at which the pairs are drawn
    logical, intent(out) :: planar           !< all links move parallel to one plane
    real(wp), intent(out) :: normal(3)       !< normal of the plane in the axes of link 1, of unit length; zero where none was found
    real(wp) :: axis(3)
    integer :: k

    call find_normal(film, skeleton, normal)
    planar = norm2(normal) > 0.5_wp
    if (.not. planar) return
    do k = 1, size(skeleton%places)
      associate (place => skeleton%places(k))
        axis = film%direction(1, place%links(1), place%axes(:, 1))
        select case (place%kind)
        case (turning)
          if (norm2(cross(axis, normal)) > aligned) planar = .false.
        case (sliding)
          if (abs(dot_product(axis, normal)) > aligned) planar = .false.
        case (screwing)
          planar = .false.
        case default
          if (.not. moves_in_plane(film, place%links, normal, skeleton%size)) planar = .false.
        end select
      end associate
    end do
  end subroutine is_planar

  !> Find a possible normal of the plane of motion: the axis of a turning pair, or zero. If no pair turns it is the
  !> normal of two sliding directions.
  pure subroutine find_normal(film, skeleton, normal)
    type(film_type), intent(in) :: film          !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    real(wp), intent(out) :: normal(3)           !< possible normal in the axes of link 1, of unit length; zero where there is none
    real(wp) :: axis(3), first(3)
    integer :: k

    first = 0.0_wp
    normal = 0.0_wp
    do k = 1, size(skeleton%places)
      axis = film%direction(1, skeleton%places(k)%links(1), skeleton%places(k)%axes(:, 1))
      if (skeleton%places(k)%kind == turning) then
        normal = axis
        return
      else if (skeleton%places(k)%kind == sliding) then
        if (norm2(first) <= 0.0_wp) first = axis
        if (norm2(cross(first, axis)) > 0.01_wp) normal = unit(cross(first, axis))
      end if
    end do
    if (norm2(normal) > 0.0_wp) return
    ! a single sliding direction, or users' pairs alone, leave a choice: the plane of x and y, if it holds that direction
    normal = [0.0_wp, 0.0_wp, 1.0_wp]
    if (abs(first(3)) > aligned) normal = [0.0_wp, 1.0_wp, 0.0_wp]
    if (abs(dot_product(first, normal)) > aligned) normal = 0.0_wp
  end subroutine find_normal

  !> Whether the second link moves relative to the first one parallel to a plane, in all frames.
  pure logical function moves_in_plane(film, links, normal, size) result(planar)
    type(film_type), intent(in) :: film  !< poses and values at the outputs of the run
    integer, intent(in) :: links(2)      !< the reference link and the moving link
    real(wp), intent(in) :: normal(3)    !< normal of the plane, in the axes of link 1 in the first frame
    real(wp), intent(in) :: size         !< size of the mechanism at the start [m]
    real(wp) :: in_first(3), in_second(3), start(3), now(3)
    integer :: frame

    in_first = turn_back(film%r(:, :, links(1), 1), normal)
    in_second = turn_back(film%r(:, :, links(2), 1), normal)
    start = film%local(1, links(1), film%p(:, links(2), 1))
    planar = .true.
    do frame = 2, film%n_frames
      now = turn_back(film%r(:, :, links(1), frame), turn(film%r(:, :, links(2), frame), in_second))
      if (norm2(now - in_first) > 1.0e-5_wp) planar = .false.
      now = film%local(frame, links(1), film%p(:, links(2), frame))
      if (abs(dot_product(now - start, in_first)) > 1.0e-5_wp*size) planar = .false.
    end do
  end function moves_in_plane

  !> The view with the best score among views from all sides and a little above.
  pure function best_view(film, skeleton, upward) result(best)
    type(film_type), intent(in) :: film          !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    real(wp), intent(in) :: upward(3)            !< direction that points up in the picture, in the axes of link 1, of unit length
    type(view_type) :: best
    type(view_type) :: view
    real(wp) :: ahead(3), aside(3), azimuth, elevation, score, highest
    integer :: i, j, n, frame

    ! the expected view has x to the right and a little towards the viewer
    ahead = [0.0_wp, -1.0_wp, 0.0_wp]
    if (norm2(cross(ahead, upward)) < 0.5_wp) ahead = [0.0_wp, 0.0_wp, 1.0_wp]
    ahead = unit(ahead - dot_product(ahead, upward)*upward)
    aside = cross(upward, ahead)
    highest = -huge(highest)
    do j = 1, 2
      elevation = (12.0_wp + 12.0_wp*j)*pi/180.0_wp
      do i = -8, 9
        azimuth = (20.0_wp*i + 10.0_wp)*pi/180.0_wp
        view = view_from(cos(elevation)*(cos(azimuth)*ahead + sin(azimuth)*aside) + sin(elevation)*upward, upward)
        score = 0.08_wp*cos(azimuth - 0.5_wp)
        do n = 1, looks
          frame = 1 + (n - 1)*(film%n_frames - 1)/looks
          score = score + score_of(film, skeleton, view, frame)/looks
        end do
        if (score <= highest) cycle
        highest = score
        best = view
      end do
    end do
  end function best_view

  !> The score of a view: the part of the links' length that is seen, and the distance between the two nearest pairs.
  pure real(wp) function score_of(film, skeleton, view, frame) result(score)
    type(film_type), intent(in) :: film          !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    type(view_type), intent(in) :: view          !< direction from which the mechanism is seen
    integer, intent(in) :: frame                 !< number of the frame in the film
    real(wp) :: at(3, most_looked_at), apart(3), seen(3), length, seen_length, least
    integer :: n, i, j

    n = min(size(skeleton%places), most_looked_at)
    do i = 1, n
      associate (place => skeleton%places(i))
        at(:, i) = film%position(frame, place%links(place%carrier), place%points(:, place%carrier))
      end associate
    end do
    length = tiny(length)
    seen_length = 0.0_wp
    least = skeleton%size
    do i = 1, n
      do j = 1, i - 1
        apart = at(:, i) - at(:, j)
        if (norm2(apart) < 0.01_wp*skeleton%size) cycle
        seen = view%seen(apart)
        least = min(least, norm2(seen(:2)))
        if (.not. share_link(skeleton%places(i)%links, skeleton%places(j)%links)) cycle
        length = length + norm2(apart)
        seen_length = seen_length + norm2(seen(:2))
      end do
    end do
    score = seen_length/length + 2.0_wp*min(0.15_wp, least/skeleton%size)
  end function score_of

  !> Whether two pairs share a link other than the frame.
  pure logical function share_link(a, b)
    integer, intent(in) :: a(2)  !< links of the first pair
    integer, intent(in) :: b(2)  !< links of the second pair

    share_link = (any(a(1) == b) .and. a(1) /= 1) .or. (any(a(2) == b) .and. a(2) /= 1)
  end function share_link
end module mech9_view_choice
