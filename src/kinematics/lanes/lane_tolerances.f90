!> Tolerances of designs side by side, each with its reason.
module mech9_lane_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: clear_start, closed, least_square, least_volume, least_way, longest_change, longest_way, most_iterations, small_sine

  !> Corrections by Newton's method; the branch stepper, which may make more, follows a lane that needs more.
  integer, parameter :: most_iterations = 6
  !> At the start the least pivot exceeds this part of the longest column: far above a singular position.
  real(wp), parameter :: clear_start = 1.0e-3_wp
  !> Largest residual of a closed chain [rad, lengths of the mechanism]: the last correction squared, and round-off of long chains.
  real(wp), parameter :: closed = 1.0e-12_wp
  !> Determinants that can be divided by.
  real(wp), parameter :: least_volume = 1.0e-100_wp
  !> Squares of lengths of rows of an inverse that can be divided by.
  real(wp), parameter :: least_square = 1.0e-200_wp
  !> Largest change of a coordinate in a correction, in its unit; all steps that are accepted have smaller ones.
  real(wp), parameter :: longest_change = 0.5_wp
  !> Longest step of an independent coordinate between positions, in its unit: half of the longest that is ever trusted, since lanes
  !> cannot try shorter ones.
  real(wp), parameter :: longest_way = 0.125_wp
  !> After a shorter step, in the unit of the coordinate, no polynomial predicts: it would only hold round-off.
  real(wp), parameter :: least_way = 1.0e-9_wp
  !> Sines below this have angles by four terms of the series of the arc sine.
  real(wp), parameter :: small_sine = 1.0e-2_wp
end module mech9_lane_tolerances
