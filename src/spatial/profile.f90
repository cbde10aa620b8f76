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

  !> The nearest foot of a point.
  pure function foot(self, point)
    class(profile_type), intent(in) :: self   !< prepared
    real(wp), intent(in) :: point(2)          !< in the plane of the profile [m]
    type(foot_type) :: foot
    real(wp) :: distances(size(self%reach)), nearest, bound, u, distance
    integer :: i, piece, part, number

    do i = 1, size(distances)
      distances(i) = hypot(point(1) - self%middle(1, i), point(2) - self%middle(2, i))
    end do
    bound = minval(distances)
    nearest = huge(1.0_wp)
    piece = 0
    part = 0
    number = 0
    u = 0.0_wp
    do i = 1, size(distances)
      if (distances(i) - self%reach(i) > bound) cycle
      distance = nearest
      call search_part(self%pieces(self%of_piece(i)), self%of_piece(i), self%of_part(i), point, nearest, piece, part, u)
      if (nearest < distance) number = i
      bound = min(bound, nearest)
    end do
    call search_corners(self, point, nearest, i, distance)
    if (i > 0) then
      foot = foot_on_corner(self, i, point)
      foot%part = -i
    else
      foot = foot_on_piece(self, self%pieces(piece), part, u, point)
      foot%part = number
    end if
  end function foot

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
