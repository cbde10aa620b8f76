!> Failures of the making of the plan, and reasons why a mechanism is not planar.
module mech9_planning_failures
  implicit none
  private
  public :: failure_large_block, failure_undetermined_block, failure_contradictory_inputs, failure_chain_dimensions, &
    failure_nothing_turns, failure_pair_off_plane, failure_chain_off_plane, failure_no_fixed_axis, failure_coupled, &
    last_planning_failure

  !> A block is too large: number (of its unknowns), limit.
  integer, parameter :: failure_large_block = 401
  !> The chains of a block do not determine its unknowns: chains.
  integer, parameter :: failure_undetermined_block = 402
  !> The chains of a block do not stay closed at all rates of the independent coordinates: chains.
  integer, parameter :: failure_contradictory_inputs = 403

  ! Reasons why a mechanism is not planar

  !> The motions of a chain have not three dimensions: chains, number (of dimensions).
  integer, parameter :: failure_chain_dimensions = 404
  !> No pair of a mechanism turns.
  integer, parameter :: failure_nothing_turns = 405
  !> A pair does not move in the plane: coordinates.
  integer, parameter :: failure_pair_off_plane = 406
  !> A chain does not close in the plane: chains.
  integer, parameter :: failure_chain_off_plane = 407
  !> Planar arithmetic does not know a pair without a fixed axis: coordinates.
  integer, parameter :: failure_no_fixed_axis = 408
  !> A mechanism is executed in space because coordinates are coupled.
  integer, parameter :: failure_coupled = 409
  integer, parameter :: last_planning_failure = failure_coupled
end module mech9_planning_failures
