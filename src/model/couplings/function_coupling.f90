!> A coupling that makes the second coordinate a function of the first one: by a table or a user's procedure.
module mech9_function_coupling
  use mech9_kinds, only: wp
  use mech9_coupling, only: coupling_type, curve_order
  implicit none
  private
  public :: function_coupling_type

  !> The second coordinate, less a function of the first one, is zero. The function is the curve.
  type, abstract, extends(coupling_type) :: function_coupling_type
    real(wp) :: steepest = 0.0_wp   !< greatest slope of the function that is known [1, m/rad, rad/m]
  contains
    procedure :: term
    procedure :: weight
    procedure :: is_linear
  end type function_coupling_type

contains

  !> One term of the equation, or its derivative by its coordinate: minus the function of the first coordinate, or the second one.
  pure real(wp) function term(self, i, q, curve, order)
    class(function_coupling_type), intent(in) :: self   !< the coupling
    integer, intent(in) :: i                            !< number of the term, 1 or 2
    real(wp), intent(in) :: q                           !< its coordinate [rad, m]
    real(wp), intent(in) :: curve(0:curve_order)        !< value and derivatives of the function
    integer, intent(in) :: order                        !< 0: the term; 1, 2: a derivative

    if (i == 1) then
      term = -curve(order)
    else
      term = 0.0_wp
      if (order == 0) term = q
      if (order == 1) term = 1.0_wp
    end if
  end function term

  !> The factor that makes the largest derivative of the equation about one.
  pure real(wp) function weight(self, units)
    class(function_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: units(:)                    !< (2) units of its coordinates: 1 rad, or the mechanism's size [m]

    weight = 1.0_wp/max(self%steepest*units(1), units(2))
  end function weight

  !> The slope of the function is not constant.
  pure logical function is_linear(self)
    class(function_coupling_type), intent(in) :: self   !< the coupling

    is_linear = .false.
  end function is_linear
end module mech9_function_coupling
