!> Points of links whose motion is recorded.
module mech9_point
  use mech9_kinds, only: wp
  use mech9_error, only: place_type
  implicit none
  private
  public :: point_type

  !> A point that moves with a link.
  type :: point_type
    character(len=:), allocatable :: name   !< of its columns in the results
    integer :: link = 0                     !< number of the link
    real(wp) :: position(3) = 0.0_wp        !< in the link's system [m]
    type(place_type) :: place               !< place of its group in the data file
  end type point_type
end module mech9_point
