!> A model as a function of one of its parameters, while the others keep their values.
module mech9_single_parameter
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  implicit none
  private
  public :: single_parameter_type, new_single_parameter

  type, extends(variable_model_type) :: single_parameter_type
    class(variable_model_type), pointer, private :: all => null()   !< as a function of all parameters; not owned
    real(wp), allocatable, private :: values(:)                     !< of all parameters, in the units of the data file
    integer, private :: number = 0                                  !< of the one that varies
  contains
    procedure :: at
    procedure :: along
  end type single_parameter_type

contains

  !> Prepare a model as a function of one parameter.
  subroutine new_single_parameter(all, model, number, single)
    class(variable_model_type), intent(in), target :: all   !< the model as a function of all parameters; outlives the result
    type(model_type), intent(in) :: model                   !< the model with its present values
    integer, intent(in) :: number                           !< of the parameter that varies
    type(single_parameter_type), intent(out) :: single      !< the function
    integer :: i

    single%all => all
    single%number = number
    single%values = [(model%parameters(i)%value, i=1, size(model%parameters))]
  end subroutine new_single_parameter

  !> The model at a value of the parameter, which is then its only one.
  subroutine at(self, values, model, err)
    class(single_parameter_type), intent(inout) :: self   !< the function
    real(wp), intent(in) :: values(:)                     !< (1) of the parameter, in the units of the data file
    type(model_type), intent(out) :: model                !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err     !< allocated if there is no such model

    self%values(self%number) = values(1)
    call self%all%at(self%values, model, err)
    if (.not. allocated(err)) call keep_one(self%number, model)
  end subroutine at

  !> The model where the parameter has a larger value, and formulas follow it along their tangents.
  subroutine along(self, values, number, distance, model, err)
    class(single_parameter_type), intent(inout) :: self   !< the function
    real(wp), intent(in) :: values(:)                     !< (1) of the parameter, in the units of the data file
    integer, intent(in) :: number                         !< of the parameter: 1
    real(wp), intent(in) :: distance                      !< by which its value is larger
    type(model_type), intent(out) :: model                !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err     !< allocated if there is no such model

    self%values(self%number) = values(number)
    call self%all%along(self%values, self%number, distance, model, err)
    if (.not. allocated(err)) call keep_one(self%number, model)
  end subroutine along

  !> Leave a model one parameter alone.
  subroutine keep_one(number, model)
    integer, intent(in) :: number               !< of the parameter
    type(model_type), intent(inout) :: model    !< the model

    model%parameters = model%parameters(number:number)
  end subroutine keep_one
end module mech9_single_parameter
