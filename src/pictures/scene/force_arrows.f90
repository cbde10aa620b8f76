!> Arrows of the forces in pairs, in films and sketches. An arrow begins where the force acts on the moving link; the longest one
!> of a film is a part of the mechanism's size.
!>
!> The tip and the two barbs of an arrow are drawn as points of additional links, which the film gets. These links move
!> from frame to frame as the force does.
module mech9_force_arrows
  use mech9_kinds, only: wp
  use mech9_rotation, only: identity, cross, unit
  use mech9_mechanism, only: mechanism_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes
  use mech9_film, only: film_type
  use mech9_projection, only: projection_type
  use mech9_scene, only: scene_type, segments, in_force
  implicit none
  private
  public :: find_tips, take_arrows, add_force_arrows

  !> Length of the longest arrow, as a part of the mechanism's size.
  real(wp), parameter :: longest = 0.22_wp
  !> Length of the barbs [px], their largest part of the arrow, and their slope.
  real(wp), parameter :: barb = 9.0_wp, largest_part = 0.4_wp, slope = 0.4_wp

contains

  !> Compute the tips of all arrows; none where a film has no forces.
  subroutine find_tips(mechanism, film, size_drawn, tips)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    type(film_type), intent(in) :: film                    !< poses, values and forces at the outputs of the run
    real(wp), intent(in) :: size_drawn                     !< the mechanism's size [m]
    real(wp), allocatable, intent(out) :: tips(:, :, :)    !< (3,pairs,frames) in the system of link 1 [m]
    type(pair_axes_type), allocatable :: axes(:)
    real(wp) :: scale
    integer :: i, frame

    if (.not. allocated(film%forces)) then
      allocate (tips(3, 0, 0))
      return
    end if
    allocate (tips(3, size(film%force_pairs), film%n_frames))
    axes = pair_axes(mechanism%pairs)
    scale = 0.0_wp
    if (maxval(abs(film%forces)) > 0.0_wp) scale = longest*size_drawn/sqrt(maxval(sum(film%forces**2, 1)))
    do frame = 1, film%n_frames
      do i = 1, size(film%force_pairs)
        tips(:, i, frame) = foot_of(film, axes(film%force_pairs(i)), frame) + scale*film%forces(:, i, frame)
      end do
    end do
  end subroutine find_tips

  !> The place in a frame where the force of a pair acts on its moving link, in the system of link 1 [m].
  pure function foot_of(film, axes, frame) result(foot)
    type(film_type), intent(in) :: film        !< poses at the outputs of the run
    type(pair_axes_type), intent(in) :: axes   !< axis and points of the pair
    integer, intent(in) :: frame               !< number of the frame
    real(wp) :: foot(3)

    foot = film%position(frame, axes%links(2), axes%points(:, 2))
  end function foot_of

  !> Form the film with three more links for each arrow: its tip and its barbs.
  subroutine take_arrows(mechanism, film, tips, projection, with_arrows)
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(film_type), intent(in) :: film               !< poses, values and forces at the outputs of the run
    real(wp), intent(in) :: tips(:, :, :)             !< (3,pairs,frames) tips of the arrows [m]
    type(projection_type), intent(in) :: projection   !< from space to the page
    type(film_type), intent(out) :: with_arrows       !< the film with more links
    type(pair_axes_type), allocatable :: axes(:)
    real(wp), allocatable :: r(:, :, :, :), p(:, :, :)
    integer :: i, n, frame

    n = size(film%p, 2)
    with_arrows = film
    allocate (r(3, 3, n + 3*size(film%force_pairs), size(film%p, 3)), p(3, n + 3*size(film%force_pairs), size(film%p, 3)))
    r(:, :, :n, :) = film%r
    p(:, :n, :) = film%p
    axes = pair_axes(mechanism%pairs)
    do frame = 1, film%n_frames
      do i = 1, size(film%force_pairs)
        r(:, :, n + 3*i - 2:n + 3*i, frame) = spread(identity, 3, 3)
        call place_arrow(foot_of(film, axes(film%force_pairs(i)), frame), tips(:, i, frame), projection, &
                         p(:, n + 3*i - 2:n + 3*i, frame))
      end do
    end do
    call move_alloc(r, with_arrows%r)
    call move_alloc(p, with_arrows%p)
  end subroutine take_arrows

  !> Compute the tip and the ends of the barbs of one arrow; the barbs lie across the view.
  pure subroutine place_arrow(foot, tip, projection, places)
    real(wp), intent(in) :: foot(3)                  !< its beginning, in the system of link 1 [m]
    real(wp), intent(in) :: tip(3)                   !< its end [m]
    type(projection_type), intent(in) :: projection  !< from space to the page
    real(wp), intent(out) :: places(3, 3)            !< of the tip and the ends of the barbs [m]
    real(wp) :: way(3), along(3), across(3), length

    places = spread(tip, 2, 3)
    way = tip - foot
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
  subroutine add_force_arrows(mechanism, film, scene)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(film_type), intent(in) :: film            !< with the links of the arrows
    type(scene_type), intent(inout) :: scene       !< nodes and items of the picture
    real(wp), parameter :: origin(3) = 0.0_wp
    type(pair_axes_type), allocatable :: axes(:)
    integer :: i, j, k, foot, ends(3), first

    axes = pair_axes(mechanism%pairs)
    first = size(film%p, 2) - 3*size(film%force_pairs)
    do i = 1, size(film%force_pairs)
      k = film%force_pairs(i)
      call scene%add_node(axes(k)%links(2), axes(k)%points(:, 2), foot)
      do j = 1, 3
        call scene%add_node(first + 3*(i - 1) + j, origin, ends(j))
      end do
      call scene%add_item(segments, in_force, [foot, ends(1), ends(1), ends(2), ends(1), ends(3)])
    end do
  end subroutine add_force_arrows
end module mech9_force_arrows
