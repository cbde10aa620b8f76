!> Two bars between a moving and a fixed pin in the plane, in closed form, with derivatives by the angle of a crank: the parts of
!> mechanisms that are derived by hand.
module mech9_two_bars
  use mech9_kinds, only: wp
  implicit none
  private
  public :: point_type, bar_type, turning_point, meet

  !> A point with its derivatives by the crank's angle.
  type :: point_type
    real(wp) :: x(2)    !< place [m]
    real(wp) :: d(2)    !< first derivative [m]
    real(wp) :: dd(2)   !< second derivative [m]
  end type point_type

  !> A bar: its vector, and its angle's derivatives by the crank's angle.
  type :: bar_type
    real(wp) :: r(2)    !< from its first pin to its second one [m]
    real(wp) :: w       !< first derivative of the angle
    real(wp) :: dw      !< second derivative of the angle
  end type bar_type

contains

  !> A point of the crank, whose bearing is the origin.
  pure function turning_point(x) result(point)
    real(wp), intent(in) :: x(2)   !< its place [m]
    type(point_type) :: point

    point%x = x
    point%d = [-x(2), x(1)]
    point%dd = -x
  end function turning_point

  !> Two bars from a moving and a fixed pin to one where two circles meet.
  pure subroutine meet(moving, fixed, first_length, second_length, side, first, second)
    type(point_type), intent(in) :: moving     !< first pin of the first bar
    real(wp), intent(in) :: fixed(2)           !< first pin of the second bar [m]
    real(wp), intent(in) :: first_length       !< [m]
    real(wp), intent(in) :: second_length      !< [m]
    real(wp), intent(in) :: side               !< 1: the pin lies to the left of the line from the moving to the fixed one; -1: right
    type(bar_type), intent(out) :: first       !< from the moving pin to the common one
    type(bar_type), intent(out) :: second      !< from the fixed pin to the common one
    real(wp) :: line(2), square, s, h, reciprocal, cosine, p, q

    line = fixed - moving%x
    square = line(1)**2 + line(2)**2
    reciprocal = 1.0_wp/square
    s = 0.5_wp*(1.0_wp + (first_length**2 - second_length**2)*reciprocal)
    h = side*sqrt(first_length**2*reciprocal - s**2)
    first%r = [s*line(1) - h*line(2), s*line(2) + h*line(1)]
    second%r = first%r - line
    ! the derivative of moving + first = fixed + second, along both bars; the product of the bars across each other divides
    reciprocal = 1.0_wp/(first%r(2)*second%r(1) - first%r(1)*second%r(2))
    cosine = first%r(1)*second%r(1) + first%r(2)*second%r(2)
    p = first%r(1)*moving%d(1) + first%r(2)*moving%d(2)
    q = second%r(1)*moving%d(1) + second%r(2)*moving%d(2)
    second%w = p*reciprocal
    first%w = q*reciprocal
    p = first%r(1)*moving%dd(1) + first%r(2)*moving%dd(2)
    q = second%r(1)*moving%dd(1) + second%r(2)*moving%dd(2)
    second%dw = (p + second%w**2*cosine - first%w**2*first_length**2)*reciprocal
    first%dw = (q - first%w**2*cosine + second%w**2*second_length**2)*reciprocal
  end subroutine meet
end module mech9_two_bars
