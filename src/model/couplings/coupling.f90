!> A coupling: one equation between coordinates, as of gears, racks, belts and screws.
!>
!> Its equation is a sum of terms, each a function of one coordinate, that must be zero.
module mech9_coupling
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: coupling_type, coupling_slot_type, coupling_name_length

  integer, parameter :: coupling_name_length = 6   !< length of the names of kinds

  !> An equation between coordinates.
  type, abstract :: coupling_type
    integer, allocatable :: coordinates(:)   !< (n) numbers of the coordinates, in the order of the data file
    type(place_type) :: place                !< place of its group in the data file
  contains
    procedure(term_interface), deferred :: term
    procedure(weight_interface), deferred :: weight
    procedure(is_linear_interface), deferred :: is_linear
    procedure(kind_name_interface), deferred :: kind_name
  end type coupling_type

  !> One of several couplings of different kinds.
  type :: coupling_slot_type
    class(coupling_type), allocatable :: coupling
  end type coupling_slot_type

  abstract interface
    !> One term of the equation, or its derivative by its coordinate.
    pure real(wp) function term_interface(self, i, q, order)
      import :: coupling_type, wp
      class(coupling_type), intent(in) :: self   !< the coupling
      integer, intent(in) :: i                   !< number of the term, from 1 to n
      real(wp), intent(in) :: q                  !< its coordinate [rad, m]
      integer, intent(in) :: order               !< 0: the term; 1, 2, 3: a derivative
    end function term_interface

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
end module mech9_coupling
