!> Failures of driven motions: starts that cannot be left, and motions that end.
module mech9_tracking_failures
  implicit none
  private
  public :: failure_start_at_dead_point, failure_start_on_branches, failure_start_unclear, failure_start_locked, &
    failure_start_not_left, failure_escape, failure_dead_point, failure_lost_branch, last_tracking_failure

  !> A start at a dead point: chains and coordinates of the block; the same for the following three.
  integer, parameter :: failure_start_at_dead_point = 501
  !> A start where two branches meet: values (unknown, branch), the rates by which it can go on, and name, their units.
  integer, parameter :: failure_start_on_branches = 502
  integer, parameter :: failure_start_unclear = 503
  integer, parameter :: failure_start_locked = 504
  !> No position beside a singular start was found for certain.
  integer, parameter :: failure_start_not_left = 505
  !> A motion ends because a coordinate grows without bound: chains and coordinates of the block, number (of closures), t,
  !> others and values (the independent coordinates there), growing. The same for the following two.
  integer, parameter :: failure_escape = 506
  integer, parameter :: failure_dead_point = 507
  integer, parameter :: failure_lost_branch = 508
  integer, parameter :: last_tracking_failure = failure_lost_branch
end module mech9_tracking_failures
