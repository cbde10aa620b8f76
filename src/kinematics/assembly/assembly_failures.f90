!> Failures of the assembled position and of the choice of the independent coordinates.
module mech9_assembly_failures
  implicit none
  private
  public :: failure_wrong_choice, failure_undetermined_coordinates, failure_open_chain, failure_nearly_closed_chain, &
    failure_locked_chain, failure_nearly_moving_chain, failure_open_coupling, last_assembly_failure

  !> The independent coordinates do not fit the mobility: number, coordinates (the independent ones), others (a choice that
  !> serves), idle (those that cannot move), replaces; chains and lines (couplings, and closed chains, that hold coordinates
  !> between them).
  integer, parameter :: failure_wrong_choice = 301
  !> The independent coordinates do not determine the others: coordinates (which would have to be independent as well).
  integer, parameter :: failure_undetermined_coordinates = 302
  !> A closed chain stays open: chains, link and coordinates of its closing, gap, size.
  integer, parameter :: failure_open_chain = 303
  !> The same as failure_open_chain, by so little that the digits of the data may be the cause.
  integer, parameter :: failure_nearly_closed_chain = 304
  !> A chain has redundant equations at the start only: chains, number (of them), displacement, gap, size.
  integer, parameter :: failure_locked_chain = 305
  !> The same as failure_locked_chain, of dimensions that are near those of a chain that moves: distance as well.
  integer, parameter :: failure_nearly_moving_chain = 306
  !> Couplings, or a coupling and closed chains, contradict each other in the values of their coordinates: chains, lines,
  !> coordinates, gap.
  integer, parameter :: failure_open_coupling = 307
  integer, parameter :: last_assembly_failure = failure_open_coupling
end module mech9_assembly_failures
