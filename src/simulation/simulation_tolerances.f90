!> Tolerances of motions in time, each with its reason.
!>
!> Rotations count in rad, translations in lengths of the mechanism, coordinates in their units (1 rad, or that length).
module mech9_simulation_tolerances
  use mech9_kinds, only: wp
  implicit none
  private
  public :: largest_closure, hidden_part, doubtful_conditioning, regular_conditioning, refused_conditioning, locked, &
    locked_together, short_part, long_part, many_short, nearly_singular, surely_singular, least_part, nearly_locked, &
    drawn_near_by, shortest_step, longest_stick, least_motion

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

  ! Other independent coordinates near singular positions.

  !> Below this conditioning other independent coordinates are tried ...
  real(wp), parameter :: doubtful_conditioning = 0.08_wp
  !> Above this conditioning a step may go beyond the next output: it will not reach a singular position unnoticed.
  real(wp), parameter :: regular_conditioning = 0.14_wp
  !> A step from a well conditioned state is repeated with a shorter length if it meets a conditioning below this.
  real(wp), parameter :: refused_conditioning = 0.03_wp

  ! Other angles of ball joints, and gimbal lock.

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

  ! Events.

  !> Times within a step that is shorter than this, in parts of the round-off of time, are its end: round-off hides what is between.
  real(wp), parameter :: shortest_step = 1000.0_wp
  !> Longest step while a pair sticks, in parts of the duration of the motion: with three looks in each, slow changes of loads are seen.
  real(wp), parameter :: longest_stick = 0.005_wp
  !> A pair that drives alone move begins to move where it would come this far in the whole motion, in its unit.
  real(wp), parameter :: least_motion = 1.0e-9_wp
end module mech9_simulation_tolerances
