!> Failures of derivatives by parameters: parameters and positions for which there are none.
module mech9_sensitivity_failures
  implicit none
  private
  public :: failure_no_neighbours, failure_unknown_derivative, failure_singular_sensitivity, &
    failure_opening_parameter, last_sensitivity_failure

  !> A parameter cannot be changed in both directions: name.
  integer, parameter :: failure_no_neighbours = 801
  !> A parameter sets numbers whose derivatives are not known: name.
  integer, parameter :: failure_unknown_derivative = 802
  !> Derivatives by parameters do not exist in a singular position: chains, coordinates, t.
  integer, parameter :: failure_singular_sensitivity = 803
  !> A change of a parameter opens a closed chain: chains, coordinates, name, t.
  integer, parameter :: failure_opening_parameter = 804
  integer, parameter :: last_sensitivity_failure = failure_opening_parameter
end module mech9_sensitivity_failures
