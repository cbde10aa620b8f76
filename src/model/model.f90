!> A model is all that a data file describes, checked: a mechanism, the problem posed on it, the request for results, and the
!> parameters by which its numbers can be varied. It does not change once it is read.
module mech9_model
  use mech9_program_kind, only: kinematics
  use mech9_partition, only: free_coordinate
  use mech9_mechanism, only: mechanism_type
  use mech9_problem, only: problem_type
  use mech9_request, only: request_type
  use mech9_parameter, only: parameter_type, formula_result_type
  implicit none
  private
  public :: model_type

  type :: model_type
    integer :: program = kinematics                      !< kinematics or dynamics: what determines its motion
    type(mechanism_type) :: mechanism
    type(problem_type) :: problem
    type(request_type) :: request
    type(parameter_type), allocatable :: parameters(:)   !< in the order of the data file, without those that are formulas
    type(formula_result_type), allocatable :: formulas(:)   !< values that follow from those of the parameters
  contains
    procedure :: is_driven
  end type model_type

contains

  !> Whether drives alone determine the motion.
  pure logical function is_driven(self)
    class(model_type), intent(in) :: self   !< the model

    is_driven = self%program == kinematics .or. .not. any(self%problem%partition%kind == free_coordinate)
  end function is_driven
end module mech9_model
