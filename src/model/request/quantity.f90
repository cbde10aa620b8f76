!> Quantities, each of which is one number from a whole run: an extreme, a mean, an integral, or a value of a column.
module mech9_quantity
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: quantity_type

  type :: quantity_type
    character(len=:), allocatable :: name
    character(len=:), allocatable :: column     !< heading of the column that it is taken of
    character(len=8) :: take = ''               !< start, end, min, max, peak, range, mean, rms, integral or at
    real(wp) :: at = 0.0_wp                     !< time of the value where `take` is at [s]
    type(place_type) :: place                   !< of its group in the data file
  end type quantity_type
end module mech9_quantity
