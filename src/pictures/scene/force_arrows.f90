!> Arrows in films and sketches: of the forces in pairs, and of velocities and accelerations of points. A force begins where it acts on the
!> moving link; the longest arrow of each kind in a film is a part of the mechanism's size. Velocity poles of links are marks that move
!> from frame to frame in the same way.
!>
!> The tip and the two barbs of an arrow are drawn as points of additional links, which the film gets. These links move
!> from frame to frame as the force does.
module mech9_force_arrows
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_rotation, only: identity, cross, unit
  use mech9_mechanism, only: mechanism_type
  use mech9_point, only: point_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes
  use mech9_film, only: film_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, segments, mark, in_force, in_velocity, in_acceleration, as_pole
  implicit none
  private
  public :: arrow_type, find_arrows, tips_of, take_arrows, add_arrows

  !> One arrow.
  type :: arrow_type
    integer :: style = in_force               !< style of its kind
    character(len=:), allocatable :: text     !< meaning, such as velocity of P
    integer :: link = 1                       !< link where it begins
    real(wp) :: foot(3) = 0.0_wp              !< place in the link where it begins [m]
    real(wp), allocatable :: ways(:, :)       !< (3,frames) from its foot to its tip, in the axes of link 1; N, m/s or m/s^2 at first, then m
  end type arrow_type

  !> Length of the longest arrow, as a part of the mechanism's size.
  real(wp), parameter :: longest = 0.22_wp
  !> Length of the barbs [px], their largest part of the arrow, and their slope.
  real(wp), parameter :: barb = 9.0_wp, largest_part = 0.4_wp, slope = 0.4_wp
  !> Poles farther away than this multiple of the mechanism's size are at infinity.
  real(wp), parameter :: farthest = 1.0e3_wp

contains

  !> List all arrows with their lengths on the mechanism's scale; none where a film keeps nothing to be shown by arrows.
  subroutine find_arrows(mechanism, film, size_drawn, arrows)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    type(film_type), intent(in) :: film                          !< poses, values and forces at the outputs of the run
    real(wp), intent(in) :: size_drawn                           !< the mechanism's size [m]
    type(arrow_type), allocatable, intent(out) :: arrows(:)      !< in the order in which they are drawn
    integer, parameter :: kinds(*) = [in_force, in_velocity, in_acceleration]
    type(pair_axes_type), allocatable :: axes(:)
    integer :: i, k

    allocate (arrows(0))
    if (allocated(film%accelerations)) then
      do i = 1, size(mechanism%points)
        call append_motion(mechanism%points(i), 'acceleration', in_acceleration, film%accelerations(:, i, :film%n_frames), arrows)
      end do
    end if
    if (allocated(film%velocities)) then
      do i = 1, size(mechanism%points)
        call append_motion(mechanism%points(i), 'velocity', in_velocity, film%velocities(:, i, :film%n_frames), arrows)
      end do
    end if
    if (allocated(film%forces)) then
      axes = pair_axes(mechanism%pairs)
      do i = 1, size(film%force_pairs)
        k = film%force_pairs(i)
        call append_arrow(in_force, 'force in pair '//to_text(k), axes(k)%links(2), axes(k)%points(:, 2), &
                          film%forces(:, i, :film%n_frames), arrows)
      end do
    end if
    do i = 1, size(kinds)
      call scale_kind(kinds(i), size_drawn, arrows)
    end do
    call append_poles(mechanism, film, farthest*size_drawn, arrows)
  end subroutine find_arrows

  !> Append the velocity poles that have columns. Axes without a column are those across the plane of the motion.
  subroutine append_poles(mechanism, film, most, arrows)
    type(mechanism_type), intent(in) :: mechanism                !< the mechanism
    type(film_type), intent(in) :: film                          !< with the columns
    real(wp), intent(in) :: most                                 !< largest distance from the origin of link 1 [m]
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets the poles
    character(len=*), parameter :: middle = '.pole.'
    real(wp) :: ways(3, film%n_frames)
    integer :: first, last, at, axis

    first = 1
    do while (first <= size(film%names))
      associate (name => film%names(first)%text)
        at = index(name, middle)
        ! derivatives of such columns have longer names
        if (at > 1) at = merge(at, 0, name(1:1) == 'L' .and. verify(name(2:at - 1), '0123456789') == 0)
        last = first
        if (at > 0) then
          ways = 0.0_wp
          do while (last <= size(film%names))
            if (index(film%names(last)%text, name(:at + len(middle) - 1)) /= 1) exit
            axis = index('xyz', film%names(last)%text(at + len(middle):))
            ways(axis, :) = film%values(last, :film%n_frames)
            last = last + 1
          end do
          where (ieee_is_finite(ways)) ways = ways*mechanism%units%length
          call append_arrow(as_pole, 'velocity pole of link '//name(2:at - 1), 1, [0.0_wp, 0.0_wp, 0.0_wp], ways, arrows)
          call mark_far(most, arrows(size(arrows))%ways)
          last = last - 1
        end if
      end associate
      first = last + 1
    end do
  end subroutine append_poles

  !> Mark the frames in which a pole is too far away by a huge first component.
  subroutine mark_far(most, ways)
    real(wp), intent(in) :: most             !< largest distance from the origin of link 1 [m]
    real(wp), intent(inout) :: ways(:, :)    !< (3,frames) places, with infinite ones and ones that are no numbers
    integer :: frame

    do frame = 1, size(ways, 2)
      if (all(ieee_is_finite(ways(:, frame)))) then
        if (maxval(abs(ways(:, frame))) <= most) cycle
      end if
      ways(:, frame) = 0.0_wp
      ways(1, frame) = huge(1.0_wp)
    end do
  end subroutine mark_far

  !> Whether a pole is near enough in a frame.
  pure logical function is_near(way)
    real(wp), intent(in) :: way(3)   !< its place as mark_far leaves it

    is_near = way(1) < huge(1.0_wp)
  end function is_near

  !> Append the arrow of the motion of a point, unless it belongs to link 1.
  subroutine append_motion(point, kind, style, ways, arrows)
    type(point_type), intent(in) :: point                        !< the point
    character(len=*), intent(in) :: kind                         !< velocity or acceleration
    integer, intent(in) :: style                                 !< style of its kind
    real(wp), intent(in) :: ways(:, :)                           !< (3,frames) the vectors
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets the arrow

    if (point%link > 1) call append_arrow(style, kind//' of '//point%name, point%link, point%position, ways, arrows)
  end subroutine append_motion

  !> Append an arrow.
  subroutine append_arrow(style, text, link, foot, ways, arrows)
    integer, intent(in) :: style                                 !< style of its kind
    character(len=*), intent(in) :: text                         !< meaning, such as velocity of P
    integer, intent(in) :: link                                  !< link where it begins
    real(wp), intent(in) :: foot(3)                              !< place in the link where it begins [m]
    real(wp), intent(in) :: ways(:, :)                           !< (3,frames) the vectors
    type(arrow_type), allocatable, intent(inout) :: arrows(:)    !< gets the arrow
    type(arrow_type), allocatable :: longer(:)
    integer :: n

    n = size(arrows)
    allocate (longer(n + 1))
    longer(:n) = arrows
    longer(n + 1)%style = style
    longer(n + 1)%text = text
    longer(n + 1)%link = link
    longer(n + 1)%foot = foot
    longer(n + 1)%ways = ways
    call move_alloc(longer, arrows)
  end subroutine append_arrow

  !> Scale the arrows of one kind so that the longest one is a part of the mechanism's size.
  subroutine scale_kind(style, size_drawn, arrows)
    integer, intent(in) :: style                     !< of the kind
    real(wp), intent(in) :: size_drawn               !< the mechanism's size [m]
    type(arrow_type), intent(inout) :: arrows(:)     !< all arrows
    real(wp) :: greatest
    integer :: i, frame

    greatest = 0.0_wp
    do i = 1, size(arrows)
      if (arrows(i)%style /= style) cycle
      do frame = 1, size(arrows(i)%ways, 2)
        greatest = max(greatest, norm2(arrows(i)%ways(:, frame)))
      end do
    end do
    do i = 1, size(arrows)
      if (arrows(i)%style == style .and. greatest > 0.0_wp) &
        arrows(i)%ways = (longest*size_drawn)*(arrows(i)%ways/greatest)
    end do
  end subroutine scale_kind

  !> The tips of all arrows, in the system of link 1 [m].
  function tips_of(arrows, film) result(tips)
    type(arrow_type), intent(in) :: arrows(:)        !< all arrows
    type(film_type), intent(in) :: film              !< poses at the outputs of the run
    real(wp), allocatable :: tips(:, :, :)           !< (3,arrows,frames)
    integer :: i, frame

    allocate (tips(3, count(arrows%style /= as_pole), film%n_frames))
    ! poles come last; they may be far away, and the picture is not made for them
    do frame = 1, film%n_frames
      do i = 1, size(tips, 2)
        tips(:, i, frame) = film%position(frame, arrows(i)%link, arrows(i)%foot) + arrows(i)%ways(:, frame)
      end do
    end do
  end function tips_of

  !> Form the film with three more links for each arrow: its tip and its barbs.
  subroutine take_arrows(arrows, film, projection, with_arrows)
    type(arrow_type), intent(in) :: arrows(:)         !< all arrows
    type(film_type), intent(in) :: film               !< poses at the outputs of the run
    type(projection_type), intent(in) :: projection   !< from space to the page
    type(film_type), intent(out) :: with_arrows       !< the film with more links
    real(wp), allocatable :: r(:, :, :, :), p(:, :, :)
    integer :: i, n, frame

    n = size(film%p, 2)
    with_arrows = film
    allocate (r(3, 3, n + 3*size(arrows), size(film%p, 3)), p(3, n + 3*size(arrows), size(film%p, 3)))
    r(:, :, :n, :) = film%r
    p(:, :n, :) = film%p
    do frame = 1, film%n_frames
      do i = 1, size(arrows)
        r(:, :, n + 3*i - 2:n + 3*i, frame) = spread(identity, 3, 3)
        if (arrows(i)%style == as_pole) then
          p(:, n + 3*i - 2:n + 3*i, frame) = 0.0_wp
          if (is_near(arrows(i)%ways(:, frame))) p(:, n + 3*i - 2:n + 3*i, frame) = spread(arrows(i)%ways(:, frame), 2, 3)
          cycle
        end if
        call place_arrow(film%position(frame, arrows(i)%link, arrows(i)%foot), arrows(i)%ways(:, frame), projection, &
                         p(:, n + 3*i - 2:n + 3*i, frame))
      end do
    end do
    call move_alloc(r, with_arrows%r)
    call move_alloc(p, with_arrows%p)
  end subroutine take_arrows

  !> Compute the tip and the ends of the barbs of one arrow; the barbs lie across the view.
  pure subroutine place_arrow(foot, way, projection, places)
    real(wp), intent(in) :: foot(3)                  !< its beginning, in the system of link 1 [m]
    real(wp), intent(in) :: way(3)                   !< from there to its end [m]
    type(projection_type), intent(in) :: projection  !< from space to the page
    real(wp), intent(out) :: places(3, 3)            !< of the tip and the ends of the barbs [m]
    real(wp) :: along(3), across(3), length

    places = spread(foot + way, 2, 3)
    if (.not. norm2(way) > 0.0_wp) return
    along = unit(way)
    across = cross(projection%view%toward, along)
    if (.not. norm2(across) > 1.0e-3_wp) return
    across = unit(across)
    length = min(projection%metres(barb), largest_part*norm2(way))
    places(:, 2) = places(:, 1) - length*(along + slope*across)
    places(:, 3) = places(:, 1) - length*(along - slope*across)
  end subroutine place_arrow

  !> Add the arrows to the scene.
  subroutine add_arrows(arrows, film, projection, scene)
    type(arrow_type), intent(in) :: arrows(:)      !< all arrows
    type(film_type), intent(in) :: film            !< with the links of the arrows
    type(projection_type), intent(in) :: projection   !< from space to the page
    type(scene_type), intent(inout) :: scene       !< nodes and items of the picture
    real(wp), parameter :: origin(3) = 0.0_wp
    integer :: i, j, foot, ends(3), first

    first = size(film%p, 2) - 3*size(arrows)
    do i = 1, size(arrows)
      if (arrows(i)%style == as_pole) then
        call scene%add_node(first + 3*i - 2, origin, foot)
        call scene%add_item(mark, as_pole, [foot], text=arrows(i)%text)
        call scene%show_while([(is_on_page(arrows(i)%ways(:, j), projection), j=1, film%n_frames)])
        cycle
      end if
      call scene%add_node(arrows(i)%link, arrows(i)%foot, foot)
      do j = 1, 3
        call scene%add_node(first + 3*(i - 1) + j, origin, ends(j))
      end do
      call scene%add_item(segments, arrows(i)%style, [foot, ends(1), ends(1), ends(2), ends(1), ends(3)], text=arrows(i)%text)
    end do
  end subroutine add_arrows

  !> Whether a pole is on the page.
  pure logical function is_on_page(way, projection)
    real(wp), intent(in) :: way(3)                    !< its place as mark_far leaves it
    type(projection_type), intent(in) :: projection   !< from space to the page
    real(wp) :: xy(2), depth

    is_on_page = is_near(way)
    if (.not. is_on_page) return
    call projection%on_page(way, xy, depth)
    is_on_page = all(xy > 0.0_wp) .and. all(xy < [projection%width, projection%height])
  end function is_on_page
end module mech9_force_arrows
