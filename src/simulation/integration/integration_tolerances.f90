!> Tolerances of the integration of a motion, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_integration_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: trusted_closing, trusted_between_steps, worthwhile_improvement, short_way, round_off_of_jumps, &
    steepest_slope, third_derivative_step, slip_of_errors, blocked_part

  ! Closed chains.

  !> Largest change of a coordinate, in its unit, when the chains are closed at the integrator's result, whose error is far
  !> smaller: after a larger change they might be closed on another branch.
  real(wp), parameter :: trusted_closing = 0.02_wp
  !> The same for a position within a step, which is known as well as the ends of the step.
  real(wp), parameter :: trusted_between_steps = 1.0e-3_wp

  ! Other independent coordinates near singular positions.

  !> ... and taken if they are so many times better conditioned; otherwise they are tried again when the conditioning is so many
  !> times worse.
  real(wp), parameter :: worthwhile_improvement = 4.0_wp

  ! Other angles of ball joints, and gimbal lock.

  !> Longest way of a ball joint's third axis over which its angles are continued at once, in parts of its distance from gimbal
  !> lock. They cannot change by half a turn while this is below 1; ways are bounded by twice the greater speed of both ends.
  real(wp), parameter :: short_way = 0.5_wp

  ! Drives and outputs.

  !> A change of the rate of a drive at a joint of its law is round-off of the law where it moves the coordinate by less than this in
  !> the whole run, in its unit: laws that come to rest leave some 1e-14 of their greatest rate.
  real(wp), parameter :: round_off_of_jumps = 1.0e-9_wp
  !> Steepest slope between two neighbouring triple zeros, times their distance, against the height: 3.4.
  real(wp), parameter :: steepest_slope = 4.0_wp
  !> Distance in time of two evaluations whose difference gives third derivatives, over the time that the motion takes for
  !> 1 rad: the square of this and round-off over it are both the error, about 1e-10.
  real(wp), parameter :: third_derivative_step = 1.0e-5_wp

  ! Contacts.

  !> The direction of a slip below this part of the speeds from which it comes is an error of integration; its direction does not change then.
  real(wp), parameter :: slip_of_errors = 1.0e-8_wp
  !> Contacts hold the coordinate of a pair if they leave this part of its mobility: the square root of the round-off of mobilities.
  real(wp), parameter :: blocked_part = 1.0e-8_wp
end module mech9_integration_tolerances
