!> A coupling: one equation between coordinates, as of gears, racks, belts and screws.
!>
!> Its equation is a sum of terms, each a function of one coordinate, that must be zero. Only the term of the first coordinate
!> may be a curve; this is evaluated once for each position.
module mech9_coupling
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type
  implicit none
  private
  public :: coupling_type, coupling_slot_type, coupling_name_length, curve_order

  integer, parameter :: coupling_name_length = 6   !< length of the names of kinds
  integer, parameter :: curve_order = 2            !< derivatives of a curve that a position keeps

  !> An equation between coordinates.
  type, abstract :: coupling_type
    integer, allocatable :: coordinates(:)   !< (n) numbers of the coordinates, in the order of the data file
    type(place_type) :: place                !< place of its group in the data file
  contains
    procedure(term_interface), deferred :: term
    procedure(curve_interface), deferred :: find_curve
    procedure(third_interface), deferred :: find_third
    procedure(weight_interface), deferred :: weight
    procedure(is_linear_interface), deferred :: is_linear
    procedure :: ends => without_ends
    procedure(kind_name_interface), deferred :: kind_name
    procedure :: constants => unknown_constants
    procedure :: varied_term => unvaried_term
  end type coupling_type

  !> One of several couplings of different kinds.
  type :: coupling_slot_type
    class(coupling_type), allocatable :: coupling
  end type coupling_slot_type

  abstract interface
    !> One term of the equation, or its derivative by its coordinate.
    pure real(wp) function term_interface(self, i, q, curve, order)
      import :: coupling_type, curve_order, wp
      class(coupling_type), intent(in) :: self           !< the coupling
      integer, intent(in) :: i                           !< number of the term, from 1 to n
      real(wp), intent(in) :: q                          !< its coordinate [rad, m]
      real(wp), intent(in) :: curve(0:curve_order)       !< from find_curve
      integer, intent(in) :: order                       !< 0: the term; 1, 2: a derivative
    end function term_interface

    !> The curve of the first coordinate and its derivatives. Fails where the curve does not exist.
    subroutine curve_interface(self, q, curve, err)
      import :: coupling_type, curve_order, error_type, wp
      class(coupling_type), intent(in) :: self             !< the coupling
      real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
      real(wp), intent(out) :: curve(0:curve_order)        !< value and derivatives; zero where the equation is linear
      type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    end subroutine curve_interface

    !> The third derivative of the curve. Fails where the curve does not exist.
    subroutine third_interface(self, q, third, err)
      import :: coupling_type, error_type, wp
      class(coupling_type), intent(in) :: self             !< the coupling
      real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
      real(wp), intent(out) :: third                       !< third derivative; zero where the equation is linear
      type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    end subroutine third_interface

    !> The factor by which the equation counts beside those of closed chains.
    pure real(wp) function weight_interface(self, units)
      import :: coupling_type, wp
      class(coupling_type), intent(in) :: self   !< the coupling
      real(wp), intent(in) :: units(:)           !< (n) units of its coordinates: 1 rad, or the mechanism's size [m]
    end function weight_interface

    !> Whether the derivatives of all terms are constant.
    pure logical function is_linear_interface(self)
      import :: coupling_type
      class(coupling_type), intent(in) :: self   !< the coupling
    end function is_linear_interface

    !> The name of the kind in the data file.
    pure function kind_name_interface(self) result(name)
      import :: coupling_type, coupling_name_length
      class(coupling_type), intent(in) :: self   !< the coupling
      character(len=coupling_name_length) :: name
    end function kind_name_interface
  end interface
contains

  !> Least and greatest values that the first coordinate can have: beyond all that occur.
  pure function without_ends(self) result(ends)
    class(coupling_type), intent(in) :: self   !< the coupling
    real(wp) :: ends(2)

    ends = [-huge(ends), huge(ends)]
  end function without_ends

  !> The numbers on which the equation depends smoothly, in a fixed order. This procedure, for couplings whose numbers are
  !> not known, gives none.
  pure subroutine unknown_constants(self, values)
    class(coupling_type), intent(in) :: self         !< the coupling
    real(wp), allocatable, intent(out) :: values(:)  !< its numbers; not allocated where they are not known

  end subroutine unknown_constants

  !> The derivative of a term, or of a derivative of it by its coordinate, by one parameter while the coordinate is held. This
  !> procedure is for couplings without numbers.
  real(wp) function unvaried_term(self, change, i, q, order)
    class(coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: change(:)          !< derivatives of its numbers
    integer, intent(in) :: i                   !< number of the term, from 1 to n
    real(wp), intent(in) :: q                  !< its coordinate [rad, m]
    integer, intent(in) :: order               !< 0: of the term; 1, 2: of a derivative

    unvaried_term = 0.0_wp
  end function unvaried_term
end module mech9_coupling
