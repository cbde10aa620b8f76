!> Tolerances of motions in time, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_simulation_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: largest_closure, hidden_part, trusted_closing, trusted_between_steps, doubtful_conditioning, &
    worthwhile_improvement, regular_conditioning, refused_conditioning, short_way, locked, locked_together, &
    short_part, long_part, many_short, nearly_singular, surely_singular, least_part, nearly_locked, &
    round_off_of_jumps, round_off_of_limit, steepest_slope, third_derivative_step, drawn_near_by

  ! The start.

  !> Coordinates of a position that is drawn closed change by less than this, in their units, when its chains are closed exactly:
  !> points with three digits are off by 1e-3 of the size.
  real(wp), parameter :: drawn_near_by = 0.05_wp

  ! Closed chains.

  !> Chains count as closed up to this part of the mechanism's size: a thousand times above the worst round-off that was
  !> measured, far below any accuracy that users need.
  real(wp), parameter :: largest_closure = 1.0e-9_wp
  !> Chains count as closed up to this part of the shortest link, too: where lengths differ by more than 1e11, the round-off of the
  !> largest ones hides the motion of the shortest.
  real(wp), parameter :: hidden_part = 1.0e-4_wp
  !> Largest change of a coordinate, in its unit, when the chains are closed at the integrator's result, whose error is far
  !> smaller: after a larger change they might be closed on another branch.
  real(wp), parameter :: trusted_closing = 0.02_wp
  !> The same for a position within a step, which is known as well as the ends of the step.
  real(wp), parameter :: trusted_between_steps = 1.0e-3_wp

  ! Other independent coordinates near singular positions.

  !> Below this conditioning other independent coordinates are tried ...
  real(wp), parameter :: doubtful_conditioning = 0.08_wp
  !> ... and taken if they are so many times better conditioned; otherwise they are tried again when the conditioning is so many
  !> times worse.
  real(wp), parameter :: worthwhile_improvement = 4.0_wp
  !> Above this conditioning a step may go beyond the next output: it will not reach a singular position unnoticed.
  real(wp), parameter :: regular_conditioning = 0.14_wp
  !> A step from a well conditioned state is repeated with a shorter length if it meets a conditioning below this.
  real(wp), parameter :: refused_conditioning = 0.03_wp

  ! Other angles of ball joints, and gimbal lock.

  !> Longest way of a ball joint's third axis over which its angles are continued at once, in parts of its distance from gimbal
  !> lock. They cannot change by half a turn while this is below 1; ways are bounded by twice the greater speed of both ends.
  real(wp), parameter :: short_way = 0.5_wp
  !> An integration that cannot go on stands in gimbal lock if the least singular value of the coefficients of motion is below
  !> this part of that at the start: integrations come to 1e-6 rad of it, and the value is about the square of the distance.
  real(wp), parameter :: locked = 1.0e-6_wp
  !> Coordinates have a part in gimbal lock that is at least this part of the largest.
  real(wp), parameter :: locked_together = 0.1_wp

  ! Motions that need ever shorter steps.

  !> Steps are short below this part of the longest one of the motion, or of a step that is this part of its duration.
  real(wp), parameter :: short_part = 1.0e-3_wp, long_part = 1.0e-2_wp
  !> So many short steps in a row ask for their cause. A motion that passes a singular position at a distance needs far fewer: steps in
  !> proportion to the distance, some ten for each power of ten.
  integer, parameter :: many_short = 1000
  !> Conditioning of closed chains below which these are the cause, if it is also below this part of their best one in the motion:
  !> motions that did not come on had some 1e-5. Some began there: below the second number their best one does not count.
  real(wp), parameter :: nearly_singular = 1.0e-3_wp, surely_singular = 1.0e-5_wp, least_part = 0.1_wp
  !> Distance of a ball joint from gimbal lock below which this is the cause [rad]: such motions stood at some 1e-4.
  real(wp), parameter :: nearly_locked = 1.0e-3_wp

  ! Drives and outputs.

  !> A change of the rate of a drive at a joint of its law is round-off of the law where it moves the coordinate by less than this in
  !> the whole run, in its unit: laws that come to rest leave some 1e-14 of their greatest rate.
  real(wp), parameter :: round_off_of_jumps = 1.0e-9_wp
  !> Excess of a motor's force over its limit that is round-off, in parts of the limit.
  real(wp), parameter :: round_off_of_limit = 1.0e-12_wp
  !> Steepest slope between two neighbouring triple zeros, times their distance, against the height: 3.4.
  real(wp), parameter :: steepest_slope = 4.0_wp
  !> Distance in time of two evaluations whose difference gives third derivatives, over the time that the motion takes for
  !> 1 rad: the square of this and round-off over it are both the error, about 1e-10.
  real(wp), parameter :: third_derivative_step = 1.0e-5_wp
end module mech9_simulation_tolerances
