!> A model as a function of its parameters.
module mech9_variable_model
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  implicit none
  private
  public :: variable_model_type

  type, abstract :: variable_model_type
  contains
    procedure(model_at), deferred :: at
    procedure :: along => model_along
  end type variable_model_type

  abstract interface
    !> The model with other values of its parameters. Fails with the code of a data file with these numbers where it would be wrong.
    subroutine model_at(self, values, model, err)
      import :: variable_model_type, wp, model_type, error_type
      class(variable_model_type), intent(inout) :: self   !< the model as a function; it keeps these values
      real(wp), intent(in) :: values(:)                   !< of all parameters, in their order, in the units of the data file
      type(model_type), intent(out) :: model              !< of use only where nothing failed
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine model_at
  end interface

contains

  !> The model where one parameter has a larger value, and formulas follow it along their tangents at the values. Its derivative by the
  !> distance, at 0, is the total one. Without formulas it is the model at this value.
  subroutine model_along(self, values, number, distance, model, err)
    class(variable_model_type), intent(inout) :: self   !< the model as a function; it keeps these values
    real(wp), intent(in) :: values(:)                   !< of all parameters, in their order, in the units of the data file
    integer, intent(in) :: number                       !< of the parameter
    real(wp), intent(in) :: distance                    !< by which its value is larger
    type(model_type), intent(out) :: model              !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: shifted(size(values))

    shifted = values
    shifted(number) = values(number) + distance
    call self%at(shifted, model, err)
  end subroutine model_along
end module mech9_variable_model
