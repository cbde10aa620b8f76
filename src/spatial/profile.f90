!> A profile: a plane curve of smooth pieces that a ball or a point may touch from one side.
!>
!> The pieces meet at corners that stand out towards the free side, about which a ball can roll; a corner that stands in ends a profile,
!> since a ball would touch both of its sides. Near the foot C of a point P on a piece, with the tangent t, the normal n towards the free
!> side and the curvature k against n, P = C + d n. A velocity v of P turns the normal at the rate -k/(1 - k d) (v . t) t. About a corner
!> d is the distance to it, and the rate is (v . t) t/d.
module mech9_profile
  use mech9_kinds, only: wp
  use mech9_space_curve, only: space_curve_type
  implicit none
  private
  public :: profile_type, foot_type

  !> A profile in the plane of x and y.
  type :: profile_type
    type(space_curve_type), allocatable :: pieces(:)   !< in order; each begins where the one before ends
    logical :: closed = .false.                        !< the last piece ends where the first one begins
    logical :: ends_freely(2) = .false.                !< its beginning and its end are no corners: a point may go round them
    real(wp) :: side = 1.0_wp                          !< the free side: 1 to the left of the direction of the curve, -1 to the right
    real(wp), allocatable :: middle(:, :)              !< (2,parts) a point of each part of all pieces [m]
    real(wp), allocatable :: reach(:)                  !< (parts) the part lies within this distance of its point [m]
    integer, allocatable :: of_piece(:)                !< (parts) number of the piece
    integer, allocatable :: of_part(:)                 !< (parts) number of the part in its piece
  contains
    procedure :: prepare
    procedure :: foot
    procedure :: neighbours
    procedure :: is_divided
    procedure :: stretch_of
    procedure :: next_stretch
    procedure :: normal_at_end
    procedure :: stands_out
    procedure :: trace
  end type profile_type

  !> The foot of a point on a profile.
  type :: foot_type
    real(wp) :: distance = 0.0_wp    !< of the point from the profile; negative behind it [m]
    real(wp) :: normal(2) = 0.0_wp   !< of the profile at the foot, towards the free side
    real(wp) :: tangent(2) = 0.0_wp  !< at right angles to the normal, which turned to the right
    real(wp) :: turning = 0.0_wp     !< rate of the normal along the tangent per velocity of the point along it [1/m]
    real(wp) :: turning_slope = 0.0_wp   !< derivative of `turning` by the way of the point along the tangent [1/m^2]
    integer :: part = 0              !< number of its part among those of all pieces; negative: minus the number of the corner or end
    real(wp) :: past = 0.0_wp        !< how far the point is past the nearest end of the stretch that was asked for; negative: before it [m]
    real(wp) :: past_slope(2) = 0.0_wp   !< derivative of `past` by the point
  end type foot_type

  !> Sine of the angle up to which two pieces that meet are one smooth curve: a tangent through few points errs by so much.
  real(wp), parameter :: smooth_joint = 1.0e-4_wp

  integer, parameter :: divisions = 4   !< of a part, in which feet are sought
  integer, parameter :: most_steps = 60 !< of Newton's method with bisection, which needs no more than the bits of a number

contains

  !> Prepare the search for feet.
  pure subroutine prepare(self)
    class(profile_type), intent(inout) :: self   !< with its pieces
    integer :: i, k, n

    n = sum([(size(self%pieces(i)%piece), i=1, size(self%pieces))])
    allocate (self%middle(2, n), self%reach(n), self%of_piece(n), self%of_part(n))
    n = 0
    do i = 1, size(self%pieces)
      associate (curve => self%pieces(i))
        do k = 1, size(curve%piece)
          n = n + 1
          self%of_piece(n) = i
          self%of_part(n) = k
          self%middle(:, n) = position(curve, k, 0.5_wp*(curve%u(k - 1) + curve%u(k)))
          ! no point of the part is further along the curve than its length
          self%reach(n) = curve%s(k) - curve%s(k - 1)
        end do
      end associate
    end do
  end subroutine prepare

  !> The nearest foot of a point, or that on one stretch.
  pure function foot(self, point, stretch)
    class(profile_type), intent(in) :: self      !< prepared
    real(wp), intent(in) :: point(2)             !< in the plane of the profile [m]
    integer, intent(in), optional :: stretch     !< number of a piece, or minus that of a corner or an end; 0 or absent: the nearest foot
    type(foot_type) :: foot, within
    real(wp) :: distances(size(self%reach)), nearest, bound, u, distance
    integer :: i, piece, part, number, only

    only = 0
    if (present(stretch)) only = stretch
    if (only < 0) then
      foot = foot_on_corner(self, -only, point)
      foot%part = only
      call find_past_corner(self, -only, point, foot)
      return
    end if
    do i = 1, size(distances)
      distances(i) = hypot(point(1) - self%middle(1, i), point(2) - self%middle(2, i))
    end do
    bound = minval(distances, mask=only == 0 .or. self%of_piece == only)
    nearest = huge(1.0_wp)
    piece = 0
    part = 0
    number = 0
    u = 0.0_wp
    do i = 1, size(distances)
      if (distances(i) - self%reach(i) > bound) cycle
      if (only > 0 .and. self%of_piece(i) /= only) cycle
      distance = nearest
      call search_part(self%pieces(self%of_piece(i)), self%of_piece(i), self%of_part(i), point, nearest, piece, part, u)
      if (nearest < distance) number = i
      bound = min(bound, nearest)
    end do
    if (only > 0) then
      if (number > 0) within = foot_on_piece(self, self%pieces(piece), part, u, point)
      call find_on_piece(self, only, point, within, number, nearest, foot)
      return
    end if
    call search_corners(self, point, nearest, i, distance)
    if (i > 0) then
      foot = foot_on_corner(self, i, point)
      foot%part = -i
    else
      foot = foot_on_piece(self, self%pieces(piece), part, u, point)
      foot%part = number
    end if
  end function foot

  !> Whether the profile has several stretches.
  pure logical function is_divided(self)
    class(profile_type), intent(in) :: self   !< prepared

    is_divided = .not. (self%closed .and. size(self%pieces) == 1)
    if (.not. is_divided) is_divided = .not. self%pieces(1)%closed
  end function is_divided

  !> The stretch of a part: number of a piece, or minus that of a corner or an end.
  pure integer function stretch_of(self, part)
    class(profile_type), intent(in) :: self   !< prepared
    integer, intent(in) :: part               !< `part` of a foot

    stretch_of = part
    if (part > 0) stretch_of = self%of_piece(part)
  end function stretch_of

  !> The stretch that follows where a point goes past the end of one. A corner that does not stand out there is passed by.
  pure integer function next_stretch(self, stretch, point)
    class(profile_type), intent(in) :: self   !< prepared
    integer, intent(in) :: stretch            !< on which the point was
    real(wp), intent(in) :: point(2)          !< past its end, in the plane of the profile [m]
    integer :: corner, piece
    logical :: ahead

    if (stretch < 0) then
      ahead = way_into(self, -stretch, .true., point) > way_into(self, -stretch, .false., point)
      next_stretch = piece_beside(self, -stretch, ahead)
      return
    end if
    ahead = ends_nearer(self, stretch, point)
    corner = stretch + merge(1, 0, ahead)
    if (corner > size(self%pieces) .and. self%closed) corner = 1
    next_stretch = -corner
    piece = piece_beside(self, corner, ahead)
    if (way_into(self, corner, ahead, point) > 0.0_wp) next_stretch = piece
  end function next_stretch

  !> Whether a point is nearer to the end of a piece than to its beginning. Where both are one corner, the normals tell.
  pure logical function ends_nearer(self, piece, point)
    type(profile_type), intent(in) :: self   !< the profile
    integer, intent(in) :: piece             !< number of the piece
    real(wp), intent(in) :: point(2)         !< in the plane of the profile [m]
    real(wp), dimension(2) :: from_beginning, from_end

    from_beginning = point - end_point(self, piece)
    from_end = point - end_point(self, piece + 1)
    if (self%closed .and. size(self%pieces) == 1) then
      ends_nearer = dot_product(from_end, self%normal_at_end(piece, .true.)) > &
                    dot_product(from_beginning, self%normal_at_end(piece, .false.))
    else
      ends_nearer = norm2(from_end) < norm2(from_beginning)
    end if
  end function ends_nearer

  !> The piece that begins in a corner or an end, or the one that ends there; 0: there is none.
  pure integer function piece_beside(self, corner, ahead) result(piece)
    type(profile_type), intent(in) :: self   !< the profile
    integer, intent(in) :: corner            !< its number
    logical, intent(in) :: ahead             !< the piece that begins there is asked for

    piece = corner - merge(0, 1, ahead)
    if (piece > size(self%pieces)) piece = 0
    if (piece == 0 .and. self%closed) piece = size(self%pieces)
  end function piece_beside

  !> The direction in which a point leaves a piece at one of its ends.
  pure function way_out(self, piece, at_end)
    type(profile_type), intent(in) :: self   !< the profile
    integer, intent(in) :: piece             !< number of the piece
    logical, intent(in) :: at_end            !< at its end, and at its beginning otherwise
    real(wp) :: way_out(2), normal(2)

    normal = self%normal_at_end(piece, at_end)
    way_out = merge(1.0_wp, -1.0_wp, at_end)*self%side*[normal(2), -normal(1)]
  end function way_out

  !> How far a point at a corner is within a piece beside it; far outside where there is no piece [m].
  pure real(wp) function way_into(self, corner, ahead, point)
    type(profile_type), intent(in) :: self   !< the profile
    integer, intent(in) :: corner            !< its number
    logical, intent(in) :: ahead             !< the piece begins there, and ends there otherwise
    real(wp), intent(in) :: point(2)         !< in the plane of the profile [m]
    integer :: piece

    way_into = -huge(1.0_wp)
    piece = piece_beside(self, corner, ahead)
    if (piece > 0) way_into = -dot_product(point - end_point(self, corner), way_out(self, piece, .not. ahead))
  end function way_into

  !> Find how far a point at a corner is past it: within one of the pieces beside it.
  pure subroutine find_past_corner(self, corner, point, foot)
    type(profile_type), intent(in) :: self     !< the profile
    integer, intent(in) :: corner              !< its number
    real(wp), intent(in) :: point(2)           !< in the plane of the profile [m]
    type(foot_type), intent(inout) :: foot     !< gets the way past it
    logical :: ahead

    ahead = way_into(self, corner, .true., point) > way_into(self, corner, .false., point)
    foot%past = way_into(self, corner, ahead, point)
    foot%past_slope = -way_out(self, piece_beside(self, corner, ahead), .not. ahead)
  end subroutine find_past_corner

  !> The foot on a given piece, or beyond its nearer end.
  pure subroutine find_on_piece(self, piece, point, within, number, nearest, foot)
    type(profile_type), intent(in) :: self     !< the profile
    integer, intent(in) :: piece               !< number of the piece
    real(wp), intent(in) :: point(2)           !< in the plane of the profile [m]
    type(foot_type), intent(in) :: within      !< nearest foot within the piece
    integer, intent(in) :: number              !< of its part; 0: there is none
    real(wp), intent(in) :: nearest            !< distance of the point from it [m]
    type(foot_type), intent(out) :: foot       !< the foot
    real(wp) :: out(2), from_end(2), way
    logical :: at_end

    at_end = ends_nearer(self, piece, point)
    out = way_out(self, piece, at_end)
    from_end = point - end_point(self, piece + merge(1, 0, at_end))
    way = dot_product(from_end, out)
    if (number > 0 .and. nearest <= norm2(from_end)) then
      foot = within
      foot%part = number
      foot%past = -abs(way)
      foot%past_slope = -sign(1.0_wp, way)*out
    else
      foot = foot_beyond(self, piece, at_end, from_end)
      foot%part = merge(findloc(self%of_piece, piece, dim=1, back=.true.), findloc(self%of_piece, piece, dim=1), at_end)
      foot%past = way
      foot%past_slope = out
    end if
  end subroutine find_on_piece

  !> The foot on the circle, or the line, as which a piece goes on beyond one of its ends. With the curvature k, and the ways x along it and
  !> y across, its distance is (2 y - k (x^2 + y^2))/(1 + w), w^2 = (k x)^2 + (1 - k y)^2.
  pure function foot_beyond(self, piece, at_end, from_end) result(foot)
    type(profile_type), intent(in) :: self   !< the profile
    integer, intent(in) :: piece             !< number of the piece
    logical, intent(in) :: at_end            !< beyond its end, and before its beginning otherwise
    real(wp), intent(in) :: from_end(2)      !< from this end to the point, in the plane of the profile [m]
    type(foot_type) :: foot
    real(wp), dimension(3) :: at, first, second, third
    real(wp) :: normal(2), tangent(2), curvature, x, y, w
    integer :: k

    associate (curve => self%pieces(piece))
      k = merge(size(curve%piece), 1, at_end)
      call curve%spline%evaluate(curve%piece(k), curve%u(merge(k, 0, at_end)), at, first, second, third)
    end associate
    normal = self%normal_at_end(piece, at_end)
    tangent = [normal(2), -normal(1)]
    curvature = dot_product(second(:2), normal)/norm2(first(:2))**2
    x = dot_product(from_end, tangent)
    y = dot_product(from_end, normal)
    w = hypot(curvature*x, 1.0_wp - curvature*y)
    foot%distance = (2.0_wp*y - curvature*(x**2 + y**2))/(1.0_wp + w)
    foot%normal = normal
    if (w > 0.0_wp) then
      foot%normal = ((1.0_wp - curvature*y)*normal - curvature*x*tangent)/w
      foot%turning = -curvature/w
    end if
    foot%tangent = [foot%normal(2), -foot%normal(1)]
  end function foot_beyond

  !> Whether two feet are on the same corner, or on one part or two of a smooth piece that follow each other.
  pure logical function neighbours(self, first, second)
    class(profile_type), intent(in) :: self   !< prepared
    integer, intent(in) :: first              !< `part` of one foot
    integer, intent(in) :: second             !< `part` of the other one

    neighbours = first == second
    if (neighbours .or. min(first, second) < 1) return
    neighbours = self%of_piece(first) == self%of_piece(second) .and. abs(first - second) == 1
    ! in a smooth closed curve the first part follows the last one
    if (self%closed .and. size(self%pieces) == 1) &
      neighbours = neighbours .or. abs(first - second) == size(self%of_part) - 1 .and. self%pieces(1)%closed
  end function neighbours

  !> Search one part of a piece for a nearer foot at which the curve is at right angles to the line to the point.
  pure subroutine search_part(curve, number, k, point, nearest, piece, part, u)
    type(space_curve_type), intent(in) :: curve   !< the piece
    integer, intent(in) :: number                 !< its number
    integer, intent(in) :: k                      !< number of the part
    real(wp), intent(in) :: point(2)              !< in the plane of the profile [m]
    real(wp), intent(inout) :: nearest            !< distance of the nearest foot so far [m]
    integer, intent(inout) :: piece               !< its piece; 0: none so far
    integer, intent(inout) :: part                !< its part
    real(wp), intent(inout) :: u                  !< its parameter [m]
    real(wp) :: from, to, slope_from, slope_to
    integer :: i

    from = curve%u(k - 1)
    slope_from = slope(from)
    ! a foot between two parts may be none of either, by round-off
    if ((k > 1 .or. curve%closed) .and. slope_from > 0.0_wp) &
      call take(from, nearest, piece, part, u)
    do i = 1, divisions
      to = curve%u(k - 1) + i*((curve%u(k) - curve%u(k - 1))/divisions)
      if (i == divisions) to = curve%u(k)
      slope_to = slope(to)
      if (slope_from <= 0.0_wp .and. slope_to >= 0.0_wp) then
        call take(root(from, to), nearest, piece, part, u)
      end if
      from = to
      slope_from = slope_to
    end do
  contains
    !> Take a point of the part if it is nearer.
    pure subroutine take(x, least, piece, part, u)
      real(wp), intent(in) :: x             !< its parameter [m]
      real(wp), intent(inout) :: least      !< distance of the nearest foot so far [m]
      integer, intent(inout) :: piece       !< its piece
      integer, intent(inout) :: part        !< its part
      real(wp), intent(inout) :: u          !< its parameter [m]
      real(wp) :: distance

      distance = norm2(position(curve, k, x) - point)
      if (distance >= least) return
      least = distance
      piece = number
      part = k
      u = x
    end subroutine take

    !> Half the derivative of the squared distance by the parameter.
    pure real(wp) function slope(x)
      real(wp), intent(in) :: x   !< parameter [m]
      real(wp) :: first(3)

      first = curve%spline%velocity(curve%piece(k), x)
      slope = dot_product(position(curve, k, x) - point, first(:2))
    end function slope

    !> The parameter between two where the slope vanishes, by Newton's method within a shrinking interval.
    pure real(wp) function root(low, high) result(x)
      real(wp), intent(in) :: low    !< parameter at which the slope is not positive [m]
      real(wp), intent(in) :: high   !< parameter at which it is not negative [m]
      real(wp), dimension(3) :: at, first, second, third
      real(wp) :: a, b, f, change
      integer :: step

      a = low
      b = high
      x = 0.5_wp*(a + b)
      do step = 1, most_steps
        call curve%spline%evaluate(curve%piece(k), x, at, first, second, third)
        f = dot_product(at(:2) - point, first(:2))
        if (f <= 0.0_wp) a = x
        if (f >= 0.0_wp) b = x
        if (.not. b > a) return
        change = dot_product(first(:2), first(:2)) + dot_product(at(:2) - point, second(:2))
        if (change > 0.0_wp) then
          change = f/change
        else
          change = 2.0_wp*(b - a)
        end if
        if (x - change <= a .or. x - change >= b) change = x - 0.5_wp*(a + b)
        if (.not. abs(change) > 0.5_wp*spacing(max(abs(a), abs(b)))) return
        x = x - change
      end do
    end function root
  end subroutine search_part

  !> Search the corners and the ends for one that is nearer than a foot.
  pure subroutine search_corners(self, point, nearest, corner, distance)
    class(profile_type), intent(in) :: self   !< the profile
    real(wp), intent(in) :: point(2)          !< in the plane of the profile [m]
    real(wp), intent(in) :: nearest           !< distance of the nearest foot [m]
    integer, intent(out) :: corner            !< number of the piece that begins there, one more for the last end; 0: none is nearer
    real(wp), intent(out) :: distance         !< of the point from it [m]
    real(wp) :: d
    integer :: i

    corner = 0
    distance = nearest
    if (self%closed .and. size(self%pieces) == 1 .and. self%pieces(1)%closed) return
    do i = 1, size(self%pieces) + merge(0, 1, self%closed)
      d = norm2(end_point(self, i) - point)
      if (d >= distance) cycle
      distance = d
      corner = i
    end do
  end subroutine search_corners

  !> The point in which a piece begins, or the last one ends.
  pure function end_point(self, number)
    class(profile_type), intent(in) :: self   !< the profile
    integer, intent(in) :: number             !< of the piece; one more than there are: the last end
    real(wp) :: end_point(2)

    if (number <= size(self%pieces)) then
      end_point = position(self%pieces(number), 1, self%pieces(number)%u(0))
    else
      associate (curve => self%pieces(size(self%pieces)))
        end_point = position(curve, size(curve%piece), curve%u(size(curve%piece)))
      end associate
    end if
  end function end_point

  !> The normal of a piece at one of its ends.
  pure function normal_at_end(self, number, at_end) result(normal)
    class(profile_type), intent(in) :: self   !< the profile
    integer, intent(in) :: number             !< of the piece
    logical, intent(in) :: at_end             !< at its end, and at its beginning otherwise
    real(wp) :: normal(2)
    real(wp) :: first(3)

    associate (curve => self%pieces(number))
      if (at_end) then
        first = curve%spline%velocity(curve%piece(size(curve%piece)), curve%u(size(curve%piece)))
      else
        first = curve%spline%velocity(curve%piece(1), curve%u(0))
      end if
    end associate
    normal = self%side*[-first(2), first(1)]/norm2(first)
  end function normal_at_end

  !> Whether the corner between two pieces stands out towards the free side.
  pure logical function stands_out(self, before, behind)
    class(profile_type), intent(in) :: self   !< the profile, with its side
    integer, intent(in) :: before             !< number of the piece that ends in the corner
    integer, intent(in) :: behind             !< number of the piece that begins there
    real(wp) :: first(2), second(2)

    first = self%normal_at_end(before, .true.)
    second = self%normal_at_end(behind, .false.)
    ! the normal turns to the right where the free side is to the left
    stands_out = self%side*(first(1)*second(2) - first(2)*second(1)) <= smooth_joint
  end function stands_out

  !> Points along the profile, for drawings.
  pure function trace(self) result(points)
    class(profile_type), intent(in) :: self   !< prepared
    real(wp), allocatable :: points(:, :)     !< (2,n) [m]
    integer :: i, k, step, n

    allocate (points(2, divisions*size(self%of_part) + 1))
    n = 1
    points(:, 1) = end_point(self, 1)
    do i = 1, size(self%of_part)
      associate (curve => self%pieces(self%of_piece(i)))
        k = self%of_part(i)
        do step = 1, divisions
          n = n + 1
          points(:, n) = position(curve, k, curve%u(k - 1) + step*((curve%u(k) - curve%u(k - 1))/divisions))
        end do
      end associate
    end do
  end function trace

  !> The foot on a corner or an end.
  pure function foot_on_corner(self, number, point) result(foot)
    class(profile_type), intent(in) :: self   !< the profile
    integer, intent(in) :: number             !< of the piece that begins there; one more than there are: the last end
    real(wp), intent(in) :: point(2)          !< in the plane of the profile [m]
    type(foot_type) :: foot
    real(wp) :: toward(2), facing(2), length
    logical :: is_free

    toward = point - end_point(self, number)
    length = norm2(toward)
    is_free = .false.
    if (number > size(self%pieces)) then
      is_free = self%ends_freely(2)
      facing = self%normal_at_end(number - 1, .true.)
    else if (number == 1 .and. .not. self%closed) then
      is_free = self%ends_freely(1)
      facing = self%normal_at_end(1, .false.)
    else
      facing = self%normal_at_end(number, .false.) + &
               self%normal_at_end(merge(size(self%pieces), number - 1, number == 1), .true.)
    end if
    foot%distance = length
    if (dot_product(toward, facing) < 0.0_wp .and. .not. is_free) foot%distance = -length
    if (length > 0.0_wp) then
      foot%normal = toward/foot%distance
      foot%turning = 1.0_wp/foot%distance
    else
      foot%normal = facing/norm2(facing)
    end if
    foot%tangent = [foot%normal(2), -foot%normal(1)]
  end function foot_on_corner

  !> The foot within a piece.
  pure function foot_on_piece(self, curve, part, u, point) result(foot)
    class(profile_type), intent(in) :: self       !< the profile
    type(space_curve_type), intent(in) :: curve   !< the piece
    integer, intent(in) :: part                   !< number of the part
    real(wp), intent(in) :: u                     !< parameter of the foot [m]
    real(wp), intent(in) :: point(2)              !< in the plane of the profile [m]
    type(foot_type) :: foot
    real(wp), dimension(3) :: at, first, second, third
    real(wp) :: speed, curvature, left, slope

    call curve%spline%evaluate(curve%piece(part), u, at, first, second, third)
    speed = norm2(first(:2))
    foot%normal = self%side*[-first(2), first(1)]/speed
    foot%tangent = [foot%normal(2), -foot%normal(1)]
    foot%distance = dot_product(point - at(:2), foot%normal)
    curvature = dot_product(second(:2), foot%normal)/speed**2
    left = 1.0_wp - curvature*foot%distance
    if (.not. abs(left) > 0.0_wp) return
    foot%turning = -curvature/left
    ! the tangent has the direction of the curve where the free side is to its left
    slope = self%side*(dot_product(third(:2), foot%normal)/speed**3 &
                       - 3.0_wp*curvature*dot_product(first(:2), second(:2))/speed**3)
    foot%turning_slope = -slope/left**3
  end function foot_on_piece

  !> A point of a piece in the plane.
  pure function position(curve, part, u)
    type(space_curve_type), intent(in) :: curve   !< the piece
    integer, intent(in) :: part                   !< number of the part
    real(wp), intent(in) :: u                     !< parameter [m]
    real(wp) :: position(2)
    real(wp), dimension(3) :: at, first, second, third

    call curve%spline%evaluate(curve%piece(part), u, at, first, second, third)
    position = at(:2)
  end function position
end module mech9_profile
