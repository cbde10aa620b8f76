!> A coupling whose equation is linear: of gears, racks, belts and screws.
module mech9_linear_coupling
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_coupling, only: coupling_type, coupling_name_length, curve_order
  implicit none
  private
  public :: linear_coupling_type

  !> The sum of coefficients times coordinates is a constant.
  type, extends(coupling_type) :: linear_coupling_type
    character(len=coupling_name_length) :: name = 'linear'   !< of the kind in the data file
    real(wp), allocatable :: coefficients(:)   !< (n) of the coordinates [1/rad, 1/m, or others that give the unit of the constant]
    real(wp) :: constant = 0.0_wp              !< the sum
    real(wp), allocatable :: radii(:)          !< (2) radii of the pulleys of a belt, for pictures [m]; else not allocated
  contains
    procedure :: term
    procedure :: find_curve
    procedure :: find_third
    procedure :: weight
    procedure :: is_linear
    procedure :: kind_name
    procedure :: constants
    procedure :: varied_term
  end type linear_coupling_type

contains

  !> One term of the equation, or its derivative by its coordinate; the constant is part of the first term.
  pure real(wp) function term(self, i, q, curve, order)
    class(linear_coupling_type), intent(in) :: self   !< the coupling
    integer, intent(in) :: i                          !< number of the term, from 1 to n
    real(wp), intent(in) :: q                         !< its coordinate [rad, m]
    real(wp), intent(in) :: curve(0:curve_order)      !< without meaning
    integer, intent(in) :: order                      !< 0: the term; 1, 2: a derivative

    term = 0.0_wp
    if (order == 1) term = self%coefficients(i)
    if (order > 0) return
    term = self%coefficients(i)*q
    if (i == 1) term = term - self%constant
  end function term

  !> A linear equation has no curve.
  subroutine find_curve(self, q, curve, err)
    class(linear_coupling_type), intent(in) :: self       !< the coupling
    real(wp), intent(in) :: q                             !< without meaning
    real(wp), intent(out) :: curve(0:curve_order)         !< zero
    type(error_type), allocatable, intent(out) :: err     !< never allocated

    curve = 0.0_wp
  end subroutine find_curve

  !> A linear equation has no third derivative.
  subroutine find_third(self, q, third, err)
    class(linear_coupling_type), intent(in) :: self       !< the coupling
    real(wp), intent(in) :: q                             !< without meaning
    real(wp), intent(out) :: third                        !< zero
    type(error_type), allocatable, intent(out) :: err     !< never allocated

    third = 0.0_wp
  end subroutine find_third

  !> The factor that makes the largest derivative of the equation one.
  pure real(wp) function weight(self, units)
    class(linear_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: units(:)                  !< (n) units of its coordinates: 1 rad, or the mechanism's size [m]

    weight = 1.0_wp/maxval(abs(self%coefficients*units))
  end function weight

  !> The derivatives of all terms are constant.
  pure logical function is_linear(self)
    class(linear_coupling_type), intent(in) :: self   !< the coupling

    is_linear = .true.
  end function is_linear

  !> The name of the kind in the data file.
  pure function kind_name(self) result(name)
    class(linear_coupling_type), intent(in) :: self   !< the coupling
    character(len=coupling_name_length) :: name

    name = self%name
  end function kind_name

  !> The coefficients and the sum.
  pure subroutine constants(self, values)
    class(linear_coupling_type), intent(in) :: self   !< the coupling
    real(wp), allocatable, intent(out) :: values(:)   !< (n+1) the coefficients, then the constant

    values = [self%coefficients, self%constant]
  end subroutine constants

  !> The derivative of a term, or of its derivative by its coordinate, by one parameter while the coordinate is held.
  pure real(wp) function varied_term(self, change, i, q, order)
    class(linear_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: change(:)                 !< (n+1) derivatives of the coefficients and of the constant
    integer, intent(in) :: i                          !< number of the term, from 1 to n
    real(wp), intent(in) :: q                         !< its coordinate [rad, m]
    integer, intent(in) :: order                      !< 0: of the term; 1, 2: of a derivative

    varied_term = 0.0_wp
    if (order == 1) varied_term = change(i)
    if (order > 0) return
    varied_term = change(i)*q
    if (i == 1) varied_term = varied_term - change(size(change))
  end function varied_term
end module mech9_linear_coupling
