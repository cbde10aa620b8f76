!> A pair that leads its moving link along a curve, whose arc length is the coordinate.
!>
!> The moving link keeps its orientation, or turns with the curve: then the x axis of the pair's frame in the moving link is the
!> tangent. Pose and derivatives follow exactly from the curve.
module mech9_path_pair
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_pose, only: pose_type, inverse
  use mech9_space_curve, only: space_curve_type, curve_place_type
  use mech9_pair, only: pair_type, pair_motion_type, pair_guide_type, pair_thirds_type, screw_factors_type, kind_name_length
  implicit none
  private
  public :: path_pair_type, path_pair

  !> A pair along a curve.
  type, extends(pair_type) :: path_pair_type
    type(pose_type) :: before        !< pose of the curve's axes in the reference link
    type(pose_type) :: after         !< pose of the moving link in the pair's frame
    logical :: along = .false.       !< the moving link turns with the tangent
    real(wp) :: scale = 1.0_wp       !< size of the curve, as a multiple of that in its file
    type(space_curve_type) :: curve  !< the curve in this size, in its axes
  contains
    procedure :: evaluate
    procedure :: as_screw
    procedure :: kind_name
    procedure :: user_calls
    procedure :: guide => find_guide
    procedure :: thirds => find_thirds
    procedure :: constants
    procedure :: vary
  end type path_pair_type

  integer, parameter :: places_per_part = 4   !< places of the guide for each part of the curve

contains

  !> A pair along a curve in its reference link.
  pure function path_pair(curve, scale, along, frame_in_reference, frame_in_moving) result(pair)
    type(space_curve_type), intent(in) :: curve          !< the curve
    real(wp), intent(in) :: scale                        !< its size, as a multiple of that in its file
    logical, intent(in) :: along                         !< the moving link turns with the tangent
    type(pose_type), intent(in) :: frame_in_reference    !< pose of the curve's axes in the reference link
    type(pose_type), intent(in) :: frame_in_moving       !< pose of the frame that follows the curve, in the moving link
    type(path_pair_type) :: pair

    pair%angular = .false.
    pair%curve = curve
    pair%scale = scale
    pair%along = along
    pair%before = frame_in_reference
    pair%after = inverse(frame_in_moving)
  end function path_pair

  !> The motion along the curve. Fails beyond the ends of an open one.
  subroutine evaluate(self, q, motion, err)
    class(path_pair_type), intent(in) :: self           !< the pair
    real(wp), intent(in) :: q                           !< arc length from the first point [m]
    type(pair_motion_type), intent(out) :: motion       !< pose of the moving frame and its derivatives in q
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(curve_place_type) :: place

    call self%curve%check_ends(q, err)
    if (allocated(err)) then
      err%failure%coordinates = [self%coordinate]
      err%place = self%place
      return
    end if
    call self%curve%locate(q, place)
    motion%pose%p = place%point
    motion%v = place%tangent
    motion%v_rate = place%curvature
    if (.not. self%along) return
    motion%pose%r = self%curve%frame_at(place)
    motion%w = cross(place%tangent, place%curvature) + self%curve%twist*place%tangent
    motion%w_rate = cross(place%tangent, place%curvature_rate) + self%curve%twist*place%curvature
  end subroutine evaluate

  !> The frames of the pair; it has no fixed axis.
  pure subroutine as_screw(self, factors, is_screw)
    class(path_pair_type), intent(in) :: self          !< the pair
    type(screw_factors_type), intent(out) :: factors   !< the frames of the pair
    logical, intent(out) :: is_screw                   !< false

    factors%before = self%before
    factors%after = self%after
    is_screw = .false.
  end subroutine as_screw

  !> The name of the kind in the data file.
  pure function kind_name(self) result(name)
    class(path_pair_type), intent(in) :: self   !< the pair
    character(len=kind_name_length) :: name

    name = 'path'
  end function kind_name

  !> No user's procedure is called.
  pure integer function user_calls(self)
    class(path_pair_type), intent(in) :: self   !< the pair

    user_calls = 0
  end function user_calls

  !> Third derivatives of the motion along the curve. Those beyond the end of an open curve are those of its end piece.
  pure subroutine find_thirds(self, q, thirds)
    class(path_pair_type), intent(in) :: self          !< the pair
    real(wp), intent(in) :: q                          !< arc length from the first point [m]
    type(pair_thirds_type), intent(out) :: thirds      !< the third derivatives
    type(curve_place_type) :: place

    call self%curve%locate(q, place)
    thirds%known = .true.
    thirds%v = place%curvature_rate
    if (.not. self%along) return
    thirds%w = cross(place%curvature, place%curvature_rate) + cross(place%tangent, self%curve%second_curvature_rate(place)) &
                  + self%curve%twist*place%curvature_rate
  end subroutine find_thirds

  !> The number on which the motion along the curve depends: the size of the curve.
  pure subroutine constants(self, values)
    class(path_pair_type), intent(in) :: self          !< the pair
    real(wp), allocatable, intent(out) :: values(:)    !< (1) the multiple of the size in the file

    values = [self%scale]
  end subroutine constants

  !> The motion by a change of the curve's size, at a held arc length. A curve of size a is c(s) = a c1(s/a), and its frame turns with
  !> s/a: the derivatives of a place by a are (c - s c')/a, those of the frame a rotation by -s/a times its rate.
  subroutine vary(self, change, q, twist)
    class(path_pair_type), intent(in) :: self   !< the pair
    real(wp), intent(in) :: change(:)           !< (1) derivative of the size by a parameter
    real(wp), intent(in) :: q                   !< arc length from the first point [m]
    real(wp), intent(out) :: twist(6, 0:2)      !< rotation, and shift of the origin, of the moving frame by the parameter [rad, m],
                                                !< and two derivatives in q
    type(pair_motion_type) :: motion
    type(pair_thirds_type) :: thirds
    type(error_type), allocatable :: err

    ! the motion has been evaluated at this arc length: it is not beyond an end
    call self%evaluate(q, motion, err)
    call self%thirds(q, thirds)
    associate (p => motion%pose%p, w => motion%w, v => motion%v, w_rate => motion%w_rate, v_rate => motion%v_rate)
      twist(1:3, 0) = -q*w
      twist(1:3, 1) = -(w + q*w_rate)
      twist(1:3, 2) = -(2.0_wp*w_rate + q*thirds%w)
      twist(4:6, 0) = p - q*v - cross(twist(1:3, 0), p)
      twist(4:6, 1) = -q*v_rate - cross(twist(1:3, 1), p) - cross(twist(1:3, 0), v)
      twist(4:6, 2) = -(v_rate + q*thirds%v) - cross(twist(1:3, 2), p) - 2.0_wp*cross(twist(1:3, 1), v) &
                      - cross(twist(1:3, 0), v_rate)
    end associate
    twist = change(1)/self%scale*twist
  end subroutine vary

  !> The curve as many places on it.
  pure subroutine find_guide(self, guide)
    class(path_pair_type), intent(in) :: self     !< the pair
    type(pair_guide_type), intent(out) :: guide   !< its length, and places
    type(curve_place_type) :: place
    real(wp) :: s
    integer :: i, k, n

    guide%closed = self%curve%closed
    guide%length = self%curve%length
    guide%turns = self%along
    n = size(self%curve%piece)
    allocate (guide%points(3, places_per_part*n + 1))
    do i = 0, places_per_part*n
      k = min(i/places_per_part, n - 1)
      s = self%curve%s(k) + real(i - places_per_part*k, wp)/places_per_part*(self%curve%s(k + 1) - self%curve%s(k))
      call self%curve%locate(s, place)
      guide%points(:, i + 1) = place%point
    end do
  end subroutine find_guide
end module mech9_path_pair
