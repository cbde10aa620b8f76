!> A smooth curve through points in space, with its arc length as parameter, and a frame that moves along it.
!>
!> The curve is a quintic spline, whose parameter is the length of its pieces (docs/explanation/theory.md). Arc lengths are
!> integrals by Gauss's rule over parts so short that they are exact to round-off, and are inverted by Newton's method. The x axis
!> of the frame is the tangent; its other axes do not turn about the tangent (Bishop's frame), but evenly where a closed
!> curve would else end with other axes than those at its beginning.
module mech9_space_curve
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_singular
  use mech9_failure, only: failure_off_curve
  use mech9_curve_failures, only: failure_sharp_curve
  use mech9_rotation, only: cross, unit, combine, about_axis
  use mech9_quintic_spline, only: quintic_spline_type, build_quintic
  implicit none
  private
  public :: space_curve_type, curve_place_type, build_curve

  !> The curve.
  type :: space_curve_type
    logical :: closed = .false.           !< it has no ends, and repeats after its length
    logical :: flat = .false.             !< it lies in a plane z = constant, exactly
    real(wp) :: length = 0.0_wp           !< the whole arc length [m]
    real(wp) :: twist = 0.0_wp            !< turning of the frame about the tangent per arc length [rad/m]
    type(quintic_spline_type) :: spline   !< the curve over its own parameter [m]
    integer, allocatable :: piece(:)      !< (parts) piece of the spline in which a part lies
    real(wp), allocatable :: u(:)         !< (0:parts) parameter of the spline between the parts [m]
    real(wp), allocatable :: s(:)         !< (0:parts) arc length between the parts [m]
    real(wp), allocatable :: r(:, :, :)   !< (3,3,0:parts) frames between the parts
  contains
    procedure :: check_ends
    procedure :: locate
    procedure :: frame_at
    procedure :: second_curvature_rate
  end type space_curve_type

  !> A place on the curve, with derivatives by the arc length.
  type :: curve_place_type
    integer :: part = 0                     !< the part of the curve
    real(wp) :: u = 0.0_wp                  !< parameter of the spline [m]
    real(wp) :: s = 0.0_wp                  !< arc length from the first point, within the first turn [m]
    real(wp) :: point(3) = 0.0_wp           !< position [m]
    real(wp) :: tangent(3) = 0.0_wp         !< unit vector along the curve, the derivative of the position
    real(wp) :: curvature(3) = 0.0_wp       !< derivative of the tangent [1/m]
    real(wp) :: curvature_rate(3) = 0.0_wp  !< second derivative of the tangent [1/m^2]
  end type curve_place_type

  integer, parameter :: order = 10   !< places of Gauss's rule
  integer, parameter :: refits = 2   !< times that the spline is laid again over the arc lengths of the one before
  real(wp), parameter :: at_end = 1.0e-9_wp   !< part of its length by which an arc length may miss an end, for lack of digits
  integer, parameter :: most_halvings = 12   !< of a piece into parts; more are needed only where the curve turns back
  !> Places and weights of Gauss's rule on 0 .. 1; the other half lies symmetrically.
  real(wp), parameter :: half_places(5) = [0.013046735741414139961_wp, 0.067468316655507744634_wp, 0.16029521585048779688_wp, &
                                           0.28330230293537640460_wp, 0.42556283050918439456_wp]
  real(wp), parameter :: half_weights(5) = [0.033335672154344068797_wp, 0.074725674575290296573_wp, &
                                            0.10954318125799102200_wp, 0.13463335965499817755_wp, 0.14776211235737643509_wp]
  real(wp), parameter :: places(order) = [half_places, 1.0_wp - half_places(5:1:-1)]
  real(wp), parameter :: weights(order) = [half_weights, half_weights(5:1:-1)]

contains

  !> The curve through points. A closed one has its first point again at the end. Fails where there are too few points, or the
  !> curve turns back on itself.
  subroutine build_curve(points, closed, curve, err)
    real(wp), intent(in) :: points(:, :)                !< (3,n) the points, neighbours different [m]
    logical, intent(in) :: closed                       !< the curve has no ends
    type(space_curve_type), intent(out) :: curve        !< the curve
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: x(size(points, 2))
    integer :: i, fit, n

    n = size(points, 2)
    curve%closed = closed
    curve%flat = .not. any(abs(points(3, 2:) - points(3, 1)) > 0.0_wp)
    x(1) = 0.0_wp
    do i = 2, n
      x(i) = x(i - 1) + norm2(points(:, i) - points(:, i - 1))
    end do
    do fit = 0, refits
      call build_quintic(x, points, closed, curve%spline, err)
      if (.not. allocated(err)) call divide(curve, err)
      if (allocated(err)) return
      do i = 1, size(curve%piece)
        x(curve%piece(i) + 1) = curve%s(i)
      end do
    end do
    curve%length = curve%s(size(curve%piece))
    call carry_frame(curve)
  end subroutine build_curve

  !> Divide the curve into parts on each of which Gauss's rule gives its length to round-off, and the tangent turns by
  !> less than 60 degrees; find their lengths.
  subroutine divide(curve, err)
    type(space_curve_type), intent(inout) :: curve      !< with its spline; gets its parts
    type(error_type), allocatable, intent(out) :: err   !< allocated where the curve turns back
    integer :: halvings(size(curve%spline%x) - 1), i, k, m
    real(wp) :: h

    do i = 1, size(halvings)
      halvings(i) = 0
      do while (.not. parts_are_even(curve%spline, i, 2**halvings(i)))
        halvings(i) = halvings(i) + 1
        if (halvings(i) <= most_halvings) cycle
        call raise(err, exit_data, failure_sharp_curve)
        err%failure%number = i
        return
      end do
    end do
    m = sum(2**halvings)
    if (allocated(curve%u)) deallocate (curve%u, curve%s, curve%piece)
    allocate (curve%u(0:m), curve%s(0:m), curve%piece(m))
    curve%u(0) = curve%spline%x(1)
    curve%s(0) = 0.0_wp
    m = 0
    do i = 1, size(halvings)
      h = (curve%spline%x(i + 1) - curve%spline%x(i))/2**halvings(i)
      do k = 1, 2**halvings(i)
        m = m + 1
        curve%piece(m) = i
        curve%u(m) = curve%spline%x(i) + k*h
        if (k == 2**halvings(i)) curve%u(m) = curve%spline%x(i + 1)
        curve%s(m) = curve%s(m - 1) + arc_length(curve%spline, i, curve%u(m - 1), curve%u(m))
      end do
    end do
  end subroutine divide

  !> Whether a number of equal parts of a piece are short enough.
  pure logical function parts_are_even(spline, piece, parts)
    type(quintic_spline_type), intent(in) :: spline   !< the curve over its own parameter
    integer, intent(in) :: piece                      !< number of a piece
    integer, intent(in) :: parts                      !< number of the parts
    real(wp) :: from, to, middle, whole, first(3), last(3), between(3)
    integer :: k

    parts_are_even = .false.
    do k = 1, parts
      from = spline%x(piece) + (k - 1)*((spline%x(piece + 1) - spline%x(piece))/parts)
      to = spline%x(piece) + k*((spline%x(piece + 1) - spline%x(piece))/parts)
      middle = 0.5_wp*(from + to)
      first = unit(spline%velocity(piece, from))
      between = unit(spline%velocity(piece, middle))
      last = unit(spline%velocity(piece, to))
      if (.not. min(dot_product(first, between), dot_product(first, last)) > 0.5_wp) return
      whole = arc_length(spline, piece, from, to)
      ! a sum of ten terms has roundings of this size
      if (.not. abs(whole - arc_length(spline, piece, from, middle) - arc_length(spline, piece, middle, to)) &
          <= 16.0_wp*epsilon(whole)*whole) return
    end do
    parts_are_even = .true.
  end function parts_are_even

  !> Length of the curve between two values of its parameter in one part.
  pure real(wp) function arc_length(spline, piece, from, to)
    type(quintic_spline_type), intent(in) :: spline   !< the curve over its own parameter
    integer, intent(in) :: piece                      !< number of the piece
    real(wp), intent(in) :: from                      !< parameter at the beginning
    real(wp), intent(in) :: to                        !< parameter at the end
    integer :: i

    arc_length = 0.0_wp
    do i = 1, order
      arc_length = arc_length + weights(i)*norm2(spline%velocity(piece, from + places(i)*(to - from)))
    end do
    arc_length = arc_length*(to - from)
  end function arc_length

  !> Carry a frame along the curve without turning it about the tangent. At the first point its z axis is as near to z as it can be,
  !> or to x where the tangent is within some 6 degrees of z. If a closed curve ends with other axes, the frames are turned
  !> about the tangent in proportion to the arc length until they are the same.
  pure subroutine carry_frame(curve)
    type(space_curve_type), intent(inout) :: curve   !< with its parts; gets its frames
    real(wp) :: tangent(3), normal(3), missing
    integer :: i, m

    m = size(curve%piece)
    allocate (curve%r(3, 3, 0:m))
    tangent = unit(curve%spline%velocity(1, curve%u(0)))
    normal = [0.0_wp, 0.0_wp, 1.0_wp]
    if (norm2(cross(tangent, normal)) < 0.1_wp) normal = [1.0_wp, 0.0_wp, 0.0_wp]
    curve%r(:, :, 0) = frame_of(tangent, normal)
    curve%twist = 0.0_wp
    do i = 1, m
      tangent = unit(curve%spline%velocity(curve%piece(i), curve%u(i)))
      curve%r(:, :, i) = carried(curve, i, curve%u(i), tangent, 0.0_wp)
    end do
    if (.not. curve%closed .or. curve%flat) return
    associate (first => curve%r(:, :, 0), last => curve%r(:, :, m))
      missing = atan2(-dot_product(last(:, 3), first(:, 2)), dot_product(last(:, 3), first(:, 3)))
    end associate
    curve%twist = -missing/curve%length
    do i = 1, m
      curve%r(:, :, i) = combine(curve%r(:, :, i), about_axis([1.0_wp, 0.0_wp, 0.0_wp], curve%twist*curve%s(i)))
    end do
  end subroutine carry_frame

  !> The frame with a tangent as its x axis and its z axis near a normal.
  pure function frame_of(tangent, normal) result(r)
    real(wp), intent(in) :: tangent(3)   !< unit vector
    real(wp), intent(in) :: normal(3)    !< another direction, of any length
    real(wp) :: r(3, 3)

    r(:, 1) = tangent
    r(:, 2) = unit(cross(normal, tangent))
    r(:, 3) = cross(tangent, r(:, 2))
  end function frame_of

  !> The frame at a place of a part, carried from the beginning of the part: by the least rotation between the tangents, which turns
  !> about the tangent at the rate that the integral takes away.
  pure function carried(curve, part, u, tangent, extra) result(r)
    type(space_curve_type), intent(in) :: curve   !< with the frame at the beginning of the part
    integer, intent(in) :: part                   !< number of the part
    real(wp), intent(in) :: u                     !< parameter of the spline [m]
    real(wp), intent(in) :: tangent(3)            !< unit tangent there
    real(wp), intent(in) :: extra                 !< further angle about the tangent [rad]
    real(wp) :: r(3, 3), axis(3), start(3), angle, first(3), second(3), third(3), point(3), along(3)
    integer :: i

    start = curve%r(:, 1, part - 1)
    angle = extra
    if (.not. curve%flat) then
      do i = 1, order
        call curve%spline%evaluate(curve%piece(part), curve%u(part - 1) + places(i)*(u - curve%u(part - 1)), &
                                   point, first, second, third)
        along = first/norm2(first)
        angle = angle + weights(i)*(u - curve%u(part - 1))*dot_product(cross(start, along), second/norm2(first)) &
                        /(1.0_wp + dot_product(start, along))
      end do
    end if
    axis = cross(start, tangent)
    r = combine(curve%r(:, :, part - 1), about_axis([1.0_wp, 0.0_wp, 0.0_wp], angle))
    do i = 2, 3
      ! the least rotation from start to tangent, applied to a vector across start
      r(:, i) = r(:, i) + cross(axis, r(:, i)) + cross(axis, cross(axis, r(:, i)))/(1.0_wp + dot_product(start, tangent))
    end do
    r = frame_of(tangent, r(:, 3))
  end function carried

  !> Fail for an arc length beyond an end, by more than round-off. The caller adds the coordinate and the time.
  pure subroutine check_ends(self, s, err)
    class(space_curve_type), intent(in) :: self         !< the curve
    real(wp), intent(in) :: s                           !< arc length [m]
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is no curve

    if (self%closed .or. (s >= -at_end*self%length .and. s <= (1.0_wp + at_end)*self%length)) return
    call raise(err, exit_singular, failure_off_curve)
    err%failure%values = reshape([s, self%length], [2, 1])
  end subroutine check_ends

  !> The place at an arc length from the first point, with its derivatives. Those of a closed curve repeat; an open one is continued
  !> by its end pieces, which is meant for round-off only.
  pure subroutine locate(self, s, place)
    class(space_curve_type), intent(in) :: self    !< the curve
    real(wp), intent(in) :: s                      !< arc length [m]
    type(curve_place_type), intent(out) :: place   !< the place
    real(wp) :: first(3), second(3), third(3), speed, speed_rate, across(3), across_rate(3)

    place%s = s
    if (self%closed) place%s = modulo(s, self%length)
    place%part = part_at(self, place%s)
    place%u = parameter_at(self, place%part, place%s)
    call self%spline%evaluate(self%piece(place%part), place%u, place%point, first, second, third)
    speed = norm2(first)
    place%tangent = first/speed
    speed_rate = dot_product(second, place%tangent)
    across = second - speed_rate*place%tangent
    place%curvature = across/speed**2
    ! derivatives by the parameter of the spline
    across_rate = third - dot_product(third, place%tangent)*place%tangent &
                  - speed*dot_product(second, place%curvature)*place%tangent - speed*speed_rate*place%curvature
    place%curvature_rate = (across_rate/speed**2 - 2.0_wp*across*speed_rate/speed**3)/speed
  end subroutine locate

  !> The frame at a place: its x axis is the tangent. By the arc length it turns with tangent x curvature + twist tangent.
  pure function frame_at(self, place) result(r)
    class(space_curve_type), intent(in) :: self   !< the curve
    type(curve_place_type), intent(in) :: place   !< the place
    real(wp) :: r(3, 3)

    r = carried(self, place%part, place%u, place%tangent, self%twist*(place%s - self%s(place%part - 1)))
  end function frame_at

  !> The third derivative of the tangent by the arc length [1/m^3]. The parameter u of the spline is a function of the arc length,
  !> whose derivatives follow from the length 1 of the tangent.
  pure function second_curvature_rate(self, place) result(rate)
    class(space_curve_type), intent(in) :: self   !< the curve
    type(curve_place_type), intent(in) :: place   !< the place
    real(wp) :: rate(3)
    real(wp), dimension(3) :: point, first, second, third, fourth
    real(wp) :: speed, u1, u2, u3, u4

    call self%spline%evaluate(self%piece(place%part), place%u, point, first, second, third)
    fourth = self%spline%fourth_derivative(self%piece(place%part), place%u)
    associate (t => place%tangent, k => place%curvature)
      speed = norm2(first)
      u1 = 1.0_wp/speed
      u2 = -dot_product(t, second)*u1**3
      u3 = -(dot_product(k, k) + dot_product(t, third*u1**3 + 3.0_wp*u1*u2*second))*u1
      rate = fourth*u1**4 + 6.0_wp*u1**2*u2*third + (4.0_wp*u1*u3 + 3.0_wp*u2**2)*second
      u4 = -(3.0_wp*dot_product(k, place%curvature_rate) + dot_product(t, rate))*u1
      rate = rate + u4*first
    end associate
  end function second_curvature_rate

  !> Number of the part in which an arc length lies; the first or the last one outside.
  pure integer function part_at(self, s) result(part)
    class(space_curve_type), intent(in) :: self   !< the curve
    real(wp), intent(in) :: s                     !< arc length [m]
    integer :: low, middle

    low = 0
    part = size(self%piece)
    do while (part - low > 1)
      middle = (low + part)/2
      if (self%s(middle) > s) then
        part = middle
      else
        low = middle
      end if
    end do
  end function part_at

  !> Parameter of the spline at an arc length of a part, by Newton's method.
  pure real(wp) function parameter_at(self, part, s) result(u)
    class(space_curve_type), intent(in) :: self   !< the curve
    integer, intent(in) :: part                   !< number of the part
    real(wp), intent(in) :: s                     !< arc length [m]
    real(wp) :: wanted, change, width
    integer :: iteration

    associate (piece => self%piece(part), from => self%u(part - 1))
      wanted = s - self%s(part - 1)
      width = self%u(part) - from
      u = from + width*(wanted/(self%s(part) - self%s(part - 1)))
      do iteration = 1, 20
        change = (wanted - arc_length(self%spline, piece, from, u))/norm2(self%spline%velocity(piece, u))
        change = max(-width, min(width, change))
        u = u + change
        ! Newton's method squares the error: the next change would be round-off
        if (abs(change) <= 1.0e-9_wp*width) exit
      end do
    end associate
  end function parameter_at
end module mech9_space_curve
