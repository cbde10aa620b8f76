!> Failures of splines: points through which no curve runs.
module mech9_spline_failures
  implicit none
  private
  public :: failure_few_points, failure_points_order, failure_no_spline, last_spline_failure

  !> Too few points for a spline: number (of them).
  integer, parameter :: failure_few_points = 101
  !> A point does not lie behind the one before it: number (of the one before).
  integer, parameter :: failure_points_order = 102
  !> No smooth curve runs through points, some of which are too close together.
  integer, parameter :: failure_no_spline = 103
  integer, parameter :: last_spline_failure = failure_no_spline
end module mech9_spline_failures
