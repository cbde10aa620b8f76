!> The cams of groups &cam in a picture of a run: the profile for a roller, which the film gives by itself, and the roller.
module mech9_cam_figures
  use mech9_kinds, only: wp, pi
  use mech9_rotation, only: cross, unit
  use mech9_pose, only: default_zero
  use mech9_request, only: cam_request_type
  use mech9_film, only: film_type
  use mech9_skeleton, only: skeleton_type, append_figure, cam_figure
  implicit none
  private
  public :: find_cam_figures

  integer, parameter :: corners = 36          !< of a roller
  integer, parameter :: fewest = 24           !< frames that show the shape of a cam
  !> A curve that ends within this multiple of its mean step from its beginning is closed.
  real(wp), parameter :: near = 1.5_wp

contains

  !> Add the first roller on each cam and the profile on which it runs, where the run turns the cam once. Faces are not
  !> drawn.
  subroutine find_cam_figures(cams, film, skeleton)
    type(cam_request_type), intent(in) :: cams(:)   !< in the order of the data file
    type(film_type), intent(in) :: film             !< poses and values at the outputs of the run
    type(skeleton_type), intent(inout) :: skeleton  !< gets the figures
    real(wp), allocatable :: pitch(:, :), profile(:, :)
    integer :: i

    do i = 1, size(cams)
      associate (cam => cams(i))
        if (cam%flat .or. cam%outer .or. any(cams(:i - 1)%link == cam%link .and. .not. cams(:i - 1)%flat)) cycle
        call find_pitch_curve(cam, film, pitch)
        if (size(pitch, 2) == 0) cycle
        call move_inwards(pitch, cam%axis, cam%roller, profile)
        call append_figure(cam%link, profile, cam_figure, skeleton)
        if (cam%roller > 0.0_wp) call add_roller(cam, film, skeleton)
      end associate
    end do
  end subroutine find_cam_figures

  !> Find the places of the centre of the roller in the system of the cam, one turn without its last point. There are
  !> none where the run is not one turn.
  subroutine find_pitch_curve(cam, film, pitch)
    type(cam_request_type), intent(in) :: cam           !< the cam
    type(film_type), intent(in) :: film                 !< poses and values at the outputs of the run
    real(wp), allocatable, intent(out) :: pitch(:, :)   !< (3,n) [m]
    real(wp) :: length
    integer :: frame, n

    n = film%n_frames
    if (n < fewest) then
      allocate (pitch(3, 0))
      return
    end if
    allocate (pitch(3, n - 1))
    do frame = 1, n - 1
      pitch(:, frame) = place(frame)
    end do
    length = sum(norm2(pitch(:, 2:) - pitch(:, :n - 2), dim=1))
    if (norm2(place(n) - pitch(:, 1)) <= near*length/n .and. length > 0.0_wp) return
    deallocate (pitch)
    allocate (pitch(3, 0))

  contains

    !> The place of the centre in a frame [m].
    pure function place(frame)
      integer, intent(in) :: frame   !< its number
      real(wp) :: place(3)

      place = film%local(frame, cam%link, film%position(frame, cam%follower, cam%point))
    end function place
  end subroutine find_pitch_curve

  !> Move a closed plane curve towards its inside. Points at which it stands still are left out.
  pure subroutine move_inwards(curve, axis, distance, moved)
    real(wp), intent(in) :: curve(:, :)                 !< (3,n) its points in turn [m]
    real(wp), intent(in) :: axis(3)                     !< unit normal of its plane
    real(wp), intent(in) :: distance                    !< by which it is moved [m]
    real(wp), allocatable, intent(out) :: moved(:, :)   !< (3,n) points of the curve that is moved [m]
    real(wp) :: along(3), area, step
    integer :: i, n, used

    n = size(curve, 2)
    area = 0.0_wp
    do i = 1, n
      area = area + dot_product(axis, cross(curve(:, i), curve(:, 1 + modulo(i, n))))
    end do
    step = sum(norm2(curve(:, 2:) - curve(:, :n - 1), dim=1))/n
    allocate (moved(3, n))
    used = 0
    do i = 1, n
      along = curve(:, 1 + modulo(i, n)) - curve(:, 1 + modulo(i - 2, n))
      if (norm2(along) <= 1.0e-3_wp*step) cycle
      used = used + 1
      moved(:, used) = curve(:, i) + sign(distance, area)*cross(axis, unit(along))
    end do
    moved = moved(:, :used)
  end subroutine move_inwards

  !> Add the circle of a roller to its follower.
  subroutine add_roller(cam, film, skeleton)
    type(cam_request_type), intent(in) :: cam       !< the cam
    type(film_type), intent(in) :: film             !< poses and values at the outputs of the run
    type(skeleton_type), intent(inout) :: skeleton  !< gets the circle
    real(wp) :: points(3, corners), axis(3), first(3), angle
    integer :: i

    axis = film%local(1, cam%follower, film%position(1, cam%link, cam%axis)) &
           - film%local(1, cam%follower, film%position(1, cam%link, [0.0_wp, 0.0_wp, 0.0_wp]))
    first = default_zero(axis)
    first = unit(first - dot_product(first, axis)*axis)
    do i = 1, corners
      angle = 2.0_wp*pi*i/corners
      points(:, i) = cam%point + cam%roller*(cos(angle)*first + sin(angle)*cross(axis, first))
    end do
    call append_figure(cam%follower, points, cam_figure, skeleton)
  end subroutine add_roller
end module mech9_cam_figures
