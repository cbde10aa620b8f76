!> The linear propagation of errors in a study whose values are drawn: by how much each parameter lets a quantity
!> scatter. It uses the exact derivatives of the quantities where all parameters have their means. It costs one run with
!> derivatives.
module mech9_study_propagation
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_explanation, only: explain
  use mech9_model, only: model_type
  use mech9_parameter, only: parameter_type
  use mech9_variable_model, only: variable_model_type
  use mech9_simulation, only: interruption_type
  use mech9_design_run, only: find_design_gradient
  implicit none
  private
  public :: propagation_type, propagate

  !> How one quantity scatters to first order.
  type :: propagation_type
    logical :: known = .false.               !< it has derivatives by all parameters that vary
    logical :: varies = .false.              !< it changes with one of these
    real(wp) :: deviation = 0.0_wp           !< standard deviation, in the unit of the quantity
    real(wp), allocatable :: derivative(:)   !< (parameters) unit of the quantity per unit of the parameter in the data file
    real(wp), allocatable :: share(:)        !< (parameters) in the variance
  end type propagation_type

contains

  !> Find how all quantities scatter to first order. Fail where the run with derivatives fails.
  subroutine propagate(model, varied, interruption, found, err)
    type(model_type), intent(in) :: model                              !< the model with the values of the data file
    class(variable_model_type), intent(inout) :: varied                !< the model as a function of its parameters
    class(interruption_type), intent(inout), target :: interruption    !< is asked whether the run shall stop
    type(propagation_type), allocatable, intent(out) :: found(:)       !< (quantities) none where it fails
    type(error_type), allocatable, intent(out) :: err                  !< allocated if it failed, with a sentence
    class(model_type), allocatable, target :: mean
    real(wp) :: numbers(size(model%request%quantities)), values(size(model%parameters))
    real(wp) :: gradient(size(model%parameters), size(model%request%quantities))
    integer :: i

    allocate (mean)
    allocate (found(0))
    if (size(numbers) == 0) return
    values = [(mean_of(model%parameters(i)), i=1, size(values))]
    call varied%at(values, mean, err)
    if (.not. allocated(err)) call find_design_gradient(mean, varied, numbers, gradient, err, interruption)
    if (allocated(err)) then
      call explain(err)
      return
    end if
    deallocate (found)
    allocate (found(size(numbers)))
    do i = 1, size(found)
      call share_out(model%parameters, numbers(i), gradient(:, i), found(i))
    end do
  end subroutine propagate

  !> Compute the shares of the parameters in the variance of a quantity.
  subroutine share_out(parameters, number, gradient, found)
    type(parameter_type), intent(in) :: parameters(:)   !< with their distributions
    real(wp), intent(in) :: number                      !< the quantity
    real(wp), intent(in) :: gradient(:)                 !< (parameters) its derivatives
    type(propagation_type), intent(out) :: found        !< its scatter
    real(wp) :: parts(size(gradient)), greatest
    integer :: i

    parts = 0.0_wp
    do i = 1, size(parts)
      if (.not. deviation_of(parameters(i)) > 0.0_wp) cycle
      if (.not. ieee_is_finite(gradient(i))) return
      parts(i) = abs(gradient(i))*deviation_of(parameters(i))
    end do
    found%known = .true.
    found%derivative = gradient
    greatest = maxval(parts)
    ! a derivative that is round-off is none
    found%varies = greatest > 1e3_wp*epsilon(number)*abs(number)
    allocate (found%share(size(parts)), source=0.0_wp)
    if (.not. found%varies) return
    parts = parts/greatest
    found%deviation = greatest*norm2(parts)
    found%share = (parts/norm2(parts))**2
  end subroutine share_out

  !> The mean of a parameter's distribution.
  pure real(wp) function mean_of(parameter)
    type(parameter_type), intent(in) :: parameter   !< with a spread or a range

    mean_of = parameter%value
    if (.not. parameter%spread > 0.0_wp) mean_of = 0.5_wp*parameter%low + 0.5_wp*parameter%high
  end function mean_of

  !> The standard deviation of a parameter's distribution.
  pure real(wp) function deviation_of(parameter)
    type(parameter_type), intent(in) :: parameter   !< with a spread or a range

    if (.not. parameter%spread > 0.0_wp) then
      deviation_of = (parameter%high - parameter%low)/sqrt(12.0_wp)
    else if (parameter%uniform) then
      deviation_of = parameter%spread/sqrt(3.0_wp)
    else
      deviation_of = parameter%spread
    end if
  end function deviation_of
end module mech9_study_propagation
