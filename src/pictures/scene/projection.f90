!> The projection of a mechanism onto a page: view, scale and margins, so that the whole motion is seen.
module mech9_projection
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_spring_load, only: spring_load_type
  use mech9_contact, only: ball_surface, profile_surface
  use mech9_film, only: film_type
  use mech9_pair_axes, only: free
  use mech9_skeleton, only: skeleton_type, place_type
  use mech9_view, only: view_type
  implicit none
  private
  public :: projection_type, fit_projection

  !> Pages are measured in px, x to the right and y down, as browsers do.
  type :: projection_type
    type(view_type) :: view
    real(wp) :: centre(3) = 0.0_wp     !< place in the middle of the picture, in the system of link 1 [m]
    real(wp) :: scale = 1.0_wp         !< scale of the picture [px/m]
    real(wp) :: width = 640.0_wp, height = 480.0_wp
    real(wp) :: middle(2) = 0.0_wp     !< place of the centre on the page [px]
    real(wp) :: length = 1.0_wp        !< unit of lengths at the bar of the scale [m]
    character(len=2) :: length_name = 'm'   !< its name
    real(wp) :: symbol = 1.0_wp        !< scale of symbols: 1 at full size, less where there is little room
  contains
    procedure :: on_page
    procedure :: metres
  end type projection_type

  !> Room for the mechanism, and around it for symbols, title and scale [px].
  real(wp), parameter :: widest = 600.0_wp, highest = 480.0_wp, margin = 44.0_wp, above = 34.0_wp, below = 56.0_wp
  real(wp), parameter :: least_width = 400.0_wp, least_height = 150.0_wp
  !> Symbols have their full size where the pairs of one link are at least this far apart [px].
  real(wp), parameter :: roomy = 55.0_wp
  !> The room for a mechanism that can be turned, as a part of its diagonal; few mechanisms are as long as that from every
  !> side.
  real(wp), parameter :: wide = 0.85_wp
  !> The largest number of frames of a film that are examined.
  integer, parameter :: most_looked_at = 60

  !> The box around everything that has to be seen, in the directions of a view [m].
  type :: box_type
    real(wp) :: low(3) = huge(1.0_wp), high(3) = -huge(1.0_wp)
  end type box_type

contains

  !> Choose the projection in which the whole motion fits the page. A picture that can be `turned` has room for the
  !> mechanism as it is seen from every side.
  subroutine fit_projection(mechanism, film, skeleton, view, turned, ends, projection)
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(film_type), intent(in) :: film               !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton       !< places at which the pairs are drawn
    type(view_type), intent(in) :: view               !< direction from which the mechanism is seen
    logical, intent(in) :: turned                     !< the reader of the picture can turn the mechanism
    real(wp), intent(in) :: ends(:, :, :)             !< (3,ends,frames) ends of arrows, which are seen too [m]
    type(projection_type), intent(out) :: projection  !< from space to the page
    type(box_type) :: box
    real(wp) :: middle(3), extent(2), diagonal
    integer :: i, frame

    call enclose_motion(mechanism, film, skeleton, view, box)
    do frame = 1, size(ends, 3)
      do i = 1, size(ends, 2)
        call enclose(view, ends(:, i, frame), box)
      end do
    end do
    middle = 0.5_wp*(box%low + box%high)
    extent = box%high(:2) - box%low(:2)
    diagonal = norm2(box%high - box%low)
    ! a motion without extent gets as much room as the mechanism is large
    if (diagonal < 1.0e-6_wp*skeleton%size) then
      diagonal = skeleton%size
      extent = diagonal
    end if
    if (turned) extent = max(extent, wide*diagonal)
    projection%view = view
    projection%length = mechanism%units%length
    projection%length_name = mechanism%units%length_name
    projection%centre = middle(1)*view%right + middle(2)*view%up + middle(3)*view%toward
    ! a mechanism that is seen as one point still has a scale
    extent = max(extent, 0.001_wp*diagonal)
    projection%scale = min(widest/extent(1), highest/extent(2))
    projection%width = max(least_width, projection%scale*extent(1)) + 2.0_wp*margin
    projection%height = max(least_height, projection%scale*extent(2)) + above + below + 2.0_wp*margin
    projection%middle = [0.5_wp*projection%width, 0.5_wp*(projection%height + above - below)]
    projection%symbol = max(0.25_wp, min(1.0_wp, projection%scale*usual_distance(film, skeleton, view)/roomy))
  end subroutine fit_projection

  !> Enclose pairs, points, springs and paths in a box, in frames that represent the film.
  subroutine enclose_motion(mechanism, film, skeleton, view, box)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(film_type), intent(in) :: film            !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton    !< places at which the pairs are drawn
    type(view_type), intent(in) :: view            !< direction from which the mechanism is seen
    type(box_type), intent(out) :: box             !< bounds of what is seen, in the directions of the view [m]
    integer :: frame, k, side, i

    do frame = 1, film%n_frames, max(1, film%n_frames/most_looked_at)
      do k = 1, size(skeleton%places)
        associate (place => skeleton%places(k))
          side = place%carrier
          call enclose(view, film%position(frame, place%links(side), place%points(:, side)), box)
          if (place%telescopic) cycle
          if (place%kind == free) call enclose_curve(film, view, place, frame, box)
          ! the guide reaches to every place of the block
          side = 3 - side
          call enclose(view, film%position(frame, place%links(side), &
                                           place%points(:, side) + place%least*place%axes(:, side)), box)
          call enclose(view, film%position(frame, place%links(side), &
                                           place%points(:, side) + place%most*place%axes(:, side)), box)
        end associate
      end do
      do i = 1, size(skeleton%figures)
        do k = 1, size(skeleton%figures(i)%points, 2)
          call enclose(view, film%position(frame, skeleton%figures(i)%link, skeleton%figures(i)%points(:, k)), box)
        end do
      end do
      do i = 1, size(mechanism%points)
        call enclose(view, film%position(frame, mechanism%points(i)%link, mechanism%points(i)%position), box)
      end do
      if (mechanism%has_contacts()) call enclose_contacts(mechanism, film, view, frame, box)
      do i = 1, size(mechanism%bodies)
        call enclose(view, film%position(frame, mechanism%bodies(i)%link, mechanism%bodies(i)%centre), box)
      end do
      do i = 1, size(mechanism%loads)
        select type (load => mechanism%loads(i)%load)
        type is (spring_load_type)
          call enclose(view, film%position(frame, load%links(1), load%positions(:, 1)), box)
          call enclose(view, film%position(frame, load%links(2), load%positions(:, 2)), box)
        end select
      end do
    end do
    do i = 1, film%n_path_points
      do k = 1, size(film%paths, 2)
        call enclose(view, film%paths(:, k, i), box)
      end do
    end do
  end subroutine enclose_motion

  !> Enlarge the box by the balls of contacts.
  pure subroutine enclose_contacts(mechanism, film, view, frame, box)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(film_type), intent(in) :: film            !< poses and values at the outputs of the run
    type(view_type), intent(in) :: view            !< direction from which the mechanism is seen
    integer, intent(in) :: frame                   !< number of the frame in the film
    type(box_type), intent(inout) :: box           !< bounds of what is seen, in the directions of the view [m]
    real(wp), allocatable :: points(:, :)
    integer :: i, k, sense

    do i = 1, size(mechanism%contacts)
      associate (contact => mechanism%contacts(i))
        if (contact%surface == profile_surface) then
          points = contact%outline()
          do k = 1, size(points, 2)
            call enclose(view, film%position(frame, contact%links(2), points(:, k)), box)
          end do
        end if
        do sense = -1, 1, 2
          call enclose(view, film%position(frame, contact%links(1), contact%center) + &
                       sense*contact%radius*(view%right + view%up), box)
          if (contact%surface == ball_surface) call enclose(view, film%position(frame, contact%links(2), contact%origin) + &
                                                   sense*contact%other_radius*(view%right + view%up), box)
        end do
      end associate
    end do
  end subroutine enclose_contacts

  !> Enlarge the box by the curve on which a pair guides its moving link, at the place that the curve has in a frame.
  pure subroutine enclose_curve(film, view, place, frame, box)
    type(film_type), intent(in) :: film   !< poses and values at the outputs of the run
    type(view_type), intent(in) :: view   !< direction from which the mechanism is seen
    type(place_type), intent(in) :: place !< place of the pair
    integer, intent(in) :: frame          !< number of the frame in the film
    type(box_type), intent(inout) :: box  !< bounds of what is seen, in the directions of the view [m]
    integer :: other

    do other = 1, size(place%guide, 2)
      call enclose(view, film%position(frame, place%links(1), place%guide(:, other)), box)
    end do
    if (size(place%guide, 2) > 0) return
    do other = 1, film%n_frames, max(1, film%n_frames/most_looked_at)
      call enclose(view, film%position(frame, place%links(1), &
                                       film%local(other, place%links(1), film%p(:, place%links(2), other))), box)
    end do
  end subroutine enclose_curve

  !> Enlarge the box by a place.
  pure subroutine enclose(view, place, box)
    type(view_type), intent(in) :: view   !< direction from which the mechanism is seen
    real(wp), intent(in) :: place(3)      !< place in the system of link 1 [m]
    type(box_type), intent(inout) :: box  !< bounds of what is seen, in the directions of the view [m]

    box%low = min(box%low, view%seen(place))
    box%high = max(box%high, view%seen(place))
  end subroutine enclose

  !> The usual extent of a link: the median of the largest distances between pairs of one link, as seen [m].
  pure real(wp) function usual_distance(film, skeleton, view)
    type(film_type), intent(in) :: film          !< poses and values at the outputs of the run
    type(skeleton_type), intent(in) :: skeleton  !< places at which the pairs are drawn
    type(view_type), intent(in) :: view          !< direction from which the mechanism is seen
    real(wp), allocatable :: largest(:)
    real(wp) :: apart(3)
    logical, allocatable :: left(:)
    integer :: link, i, j, n

    associate (graph => skeleton%graph, places => skeleton%places)
      allocate (largest(graph%n_links), source=0.0_wp)
      do link = 2, graph%n_links
        do i = graph%first(link), graph%first(link + 1) - 1
          do j = graph%first(link), i - 1
            apart = place_of(film, places(graph%pair_at(i))) - place_of(film, places(graph%pair_at(j)))
            apart = view%seen(apart)
            largest(link) = max(largest(link), norm2(apart(:2)))
          end do
        end do
      end do
    end associate
    ! the median is taken over links with pairs at more than one place
    allocate (left(size(largest)), source=largest > 0.01_wp*skeleton%size)
    n = min(count(left), count(left)/2 + 1)
    usual_distance = skeleton%size
    do i = 1, n
      j = minloc(largest, dim=1, mask=left)
      usual_distance = largest(j)
      left(j) = .false.
    end do
  end function usual_distance

  !> The place of a pair in the first frame, in the system of link 1 [m].
  pure function place_of(film, place) result(at)
    type(film_type), intent(in) :: film     !< poses and values at the outputs of the run
    class(place_type), intent(in) :: place  !< place and axes of the pair
    real(wp) :: at(3)

    at = film%position(1, place%links(place%carrier), place%points(:, place%carrier))
  end function place_of

  !> Compute the place on the page [px] of a place in the system of link 1, and its distance towards the viewer [m].
  pure subroutine on_page(self, place, xy, depth)
    class(projection_type), intent(in) :: self  !< from space to the page
    real(wp), intent(in) :: place(3)            !< place in the system of link 1 [m]
    real(wp), intent(out) :: xy(2)              !< place on the page, to the right and down [px]
    real(wp), intent(out) :: depth              !< distance from the centre towards the viewer [m]
    real(wp) :: seen(3)

    seen = self%view%seen(place - self%centre)
    xy = self%middle + self%scale*[seen(1), -seen(2)]
    depth = seen(3)
  end subroutine on_page

  !> The length in the mechanism of a symbol that has a given length on the page [m].
  pure real(wp) function metres(self, length)
    class(projection_type), intent(in) :: self  !< from space to the page
    real(wp), intent(in) :: length              !< length on the page at full size of symbols [px]

    metres = length*self%symbol/self%scale
  end function metres
end module mech9_projection
