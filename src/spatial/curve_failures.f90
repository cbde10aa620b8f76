!> Failures of curves in space.
module mech9_curve_failures
  implicit none
  private
  public :: failure_sharp_curve, last_curve_failure

  !> A curve through points turns back on itself: number (of the point before the place).
  integer, parameter :: failure_sharp_curve = 201
  integer, parameter :: last_curve_failure = failure_sharp_curve
end module mech9_curve_failures
