!> Planar mechanisms with closed forms, for tests of branches and special positions.
module mech9_planar_mechanisms
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame
  implicit none
  private
  public :: four_bar_type, random_crank, four_bar_angle, four_bar_guess, four_bar_limit, two_circles
  public :: slider_crank, watt_six_bar

  real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], x(3) = [1.0_wp, 0.0_wp, 0.0_wp]
  real(wp), parameter :: origin(3) = 0.0_wp

  type :: four_bar_type
    real(wp) :: ground, crank, coupler, rocker
  end type four_bar_type

contains

  !> A four-bar whose crank turns fully: it or the ground is the shortest link, and shortest and longest are
  !> together shorter than the other two by `excess`.
  function random_crank(random, excess) result(bar)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp), intent(in) :: excess               !< by which the other two are longer [m]
    type(four_bar_type) :: bar
    real(wp) :: shortest, longest, middle, other

    shortest = 0.3_wp + 0.1_wp*random%symmetric()
    middle = 0.9_wp + 0.1_wp*random%symmetric()
    longest = 1.3_wp + 0.1_wp*random%symmetric()
    other = shortest + longest - middle + excess
    if (random%symmetric() > 0.0_wp) then
      bar = four_bar_type(ground=longest, crank=shortest, coupler=middle, rocker=other)
    else
      bar = four_bar_type(ground=shortest, crank=longest, coupler=middle, rocker=other)
    end if
    if (random%symmetric() > 0.0_wp) bar = four_bar_type(bar%ground, bar%crank, bar%rocker, bar%coupler)
  end function random_crank

  !> Angle of the rocker from the triangle of coupler, rocker and the diagonal between them.
  pure real(wp) function four_bar_angle(bar, angle, branch)
    type(four_bar_type), intent(in) :: bar   !< lengths of the four-bar
    real(wp), intent(in) :: angle            !< of the crank
    integer, intent(in) :: branch            !< +1 or -1
    real(wp) :: pin(2)

    pin = two_circles(bar%crank*[cos(angle), sin(angle)], bar%coupler, [bar%ground, 0.0_wp], bar%rocker, branch)
    four_bar_angle = atan2(pin(2), pin(1) - bar%ground)
  end function four_bar_angle

  !> Coordinates of a closed position: crank, coupler, rocker to coupler, rocker.
  pure function four_bar_guess(bar, angle, branch) result(q)
    type(four_bar_type), intent(in) :: bar   !< lengths of the four-bar
    real(wp), intent(in) :: angle            !< of the crank [rad]
    integer, intent(in) :: branch            !< +1 or -1: which side of the diagonal
    real(wp) :: q(4), pin(2), coupler

    pin = two_circles(bar%crank*[cos(angle), sin(angle)], bar%coupler, [bar%ground, 0.0_wp], bar%rocker, branch)
    coupler = atan2(pin(2) - bar%crank*sin(angle), pin(1) - bar%crank*cos(angle))
    q(1) = angle
    q(2) = coupler - angle
    q(4) = four_bar_angle(bar, angle, branch)
    q(3) = q(4) - coupler
  end function four_bar_guess

  !> Crank angle between 0 and pi at which coupler and rocker are in line: stretched out, or folded.
  pure real(wp) function four_bar_limit(bar, stretched) result(angle)
    type(four_bar_type), intent(in) :: bar   !< lengths of the four-bar
    logical, intent(in) :: stretched         !< coupler and rocker are stretched out, not folded
    real(wp) :: diagonal

    diagonal = merge(bar%coupler + bar%rocker, bar%coupler - bar%rocker, stretched)
    angle = acos((bar%ground**2 + bar%crank**2 - diagonal**2)/(2.0_wp*bar%ground*bar%crank))
  end function four_bar_limit

  !> The point where circles about two points meet; the branch +1 lies left of the way from the first to the second.
  pure function two_circles(a, radius_a, b, radius_b, branch) result(c)
    real(wp), intent(in) :: a(2)       !< centre of the first [m]
    real(wp), intent(in) :: radius_a   !< of the first [m]
    real(wp), intent(in) :: b(2)       !< centre of the second [m]
    real(wp), intent(in) :: radius_b   !< of the second [m]
    integer, intent(in) :: branch      !< +1 or -1: left or right of the way
    real(wp) :: c(2), d(2), length, along, across

    d = b - a
    length = norm2(d)
    d = d/length
    along = (radius_a**2 - radius_b**2 + length**2)/(2.0_wp*length)
    across = sqrt(max((radius_a - along)*(radius_a + along), 0.0_wp))
    c = a + along*d + branch*across*[-d(2), d(1)]
  end function two_circles

  !> Crank, coupler and a slider along x at the height `offset`; coordinates crank, coupler, slider pin, slider.
  subroutine slider_crank(crank, coupler, offset, angle, branch, model)
    real(wp), intent(in) :: crank                    !< its length [m]
    real(wp), intent(in) :: coupler                  !< its length [m]
    real(wp), intent(in) :: offset                   !< height of the guide above the crank's pivot [m]
    real(wp), intent(in) :: angle                    !< of the crank, for the guesses
    integer, intent(in) :: branch                    !< +1: the slider is right of the crank's pin
    type(model_type), intent(out) :: model           !< the model
    integer, parameter :: links(2, 4) = reshape([1, 2, 2, 3, 3, 4, 1, 4], [2, 4])
    real(wp) :: across, along, direction

    call new_mechanism(4, links, [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(model, 2, 2, 3, frame(crank*x, z), frame(origin, z))
    call add_revolute(model, 3, 3, 4, frame(coupler*x, z), frame(origin, z))
    call add_prismatic(model, 4, 1, 4, frame([0.0_wp, offset, 0.0_wp], x), frame(origin, x))
    across = offset - crank*sin(angle)
    along = branch*sqrt(max(coupler**2 - across**2, 0.0_wp))
    direction = atan2(across, along)
    model%problem%initial%position = [angle, direction - angle, -direction, crank*cos(angle) + along]
  end subroutine slider_crank

  !> A four-bar, and two more links from a point of its coupler to a pivot; coordinates of the four-bar, then
  !> the new ones outwards, the last at the pivot.
  subroutine watt_six_bar(bar, at, pivot, lengths, angle, branch, second, model)
    type(four_bar_type), intent(in) :: bar           !< lengths of the four-bar
    real(wp), intent(in) :: at(2)                    !< the point in the coupler
    real(wp), intent(in) :: pivot(2)                 !< of the last link in the frame [m]
    real(wp), intent(in) :: lengths(2)               !< of the two links [m]
    real(wp), intent(in) :: angle                    !< of the crank, for the guesses
    integer, intent(in) :: branch                    !< of the four-bar, +1 or -1
    integer, intent(in) :: second                    !< branch of the two links, +1 or -1
    type(model_type), intent(out) :: model           !< the model
    integer, parameter :: links(2, 7) = reshape([1, 2, 2, 3, 3, 4, 1, 4, 3, 5, 5, 6, 1, 6], [2, 7])
    real(wp) :: q(7), swing, point(2), pin(2), link_5, link_6

    call new_mechanism(6, links, [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(model, 2, 2, 3, frame(bar%crank*x, z), frame(origin, z))
    call add_revolute(model, 3, 3, 4, frame(bar%coupler*x, z), frame(bar%rocker*x, z))
    call add_revolute(model, 4, 1, 4, frame(bar%ground*x, z), frame(origin, z))
    call add_revolute(model, 5, 3, 5, frame([at, 0.0_wp], z), frame(origin, z))
    call add_revolute(model, 6, 5, 6, frame(lengths(1)*x, z), frame(lengths(2)*x, z))
    call add_revolute(model, 7, 1, 6, frame([pivot, 0.0_wp], z), frame(origin, z))
    q(:4) = four_bar_guess(bar, angle, branch)
    swing = q(1) + q(2)
    point = bar%crank*[cos(angle), sin(angle)] + at(1)*[cos(swing), sin(swing)] + at(2)*[-sin(swing), cos(swing)]
    pin = two_circles(point, lengths(1), pivot, lengths(2), second)
    link_5 = atan2(pin(2) - point(2), pin(1) - point(1))
    link_6 = atan2(pin(2) - pivot(2), pin(1) - pivot(1))
    q(5:) = [link_5 - swing, link_6 - link_5, link_6]
    model%problem%initial%position = q
  end subroutine watt_six_bar
end module mech9_planar_mechanisms
