!> A model is all that a data file describes, checked: a mechanism, the problem posed on it, the request for results, and the
!> parameters by which its numbers can be varied. It does not change once it is read.
module mech9_model
  use mech9_mechanism, only: mechanism_type
  use mech9_problem, only: problem_type
  use mech9_request, only: request_type
  use mech9_parameter, only: parameter_type
  implicit none
  private
  public :: model_type

  type :: model_type
    type(mechanism_type) :: mechanism
    type(problem_type) :: problem
    type(request_type) :: request
    type(parameter_type), allocatable :: parameters(:)   !< in the order of the data file
  end type model_type
end module mech9_model
