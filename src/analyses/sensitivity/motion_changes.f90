!> The derivatives of coordinates and points by all parameters at several positions at once.
module mech9_motion_changes
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size
  implicit none
  private
  public :: motion_changes_type, new_motion_changes, place_of_coordinate, place_of_point

  !> Each parameter counts in its unit in the data file.
  type :: motion_changes_type
    integer :: n_parameters = 0
    integer :: n_coordinates = 0
    real(wp), allocatable :: values(:, :, :)   !< (batch,numbers,P) of coordinates [rad, m], then of points [m]
  contains
    procedure :: put
  end type motion_changes_type

contains

  !> Derivatives that are all zero.
  pure function new_motion_changes(n_parameters, n_coordinates, n_points) result(changes)
    integer, intent(in) :: n_parameters    !< number of parameters
    integer, intent(in) :: n_coordinates   !< number of coordinates
    integer, intent(in) :: n_points        !< number of points
    type(motion_changes_type) :: changes

    changes%n_parameters = n_parameters
    changes%n_coordinates = n_coordinates
    allocate (changes%values(batch_size, 3*n_coordinates + 9*n_points, n_parameters), source=0.0_wp)
  end function new_motion_changes

  !> Place of a coordinate among the numbers, or of its derivatives in time.
  pure integer function place_of_coordinate(k, order) result(place)
    integer, intent(in) :: k       !< number of the coordinate
    integer, intent(in) :: order   !< of the derivative in time

    place = 3*(k - 1) + order + 1
  end function place_of_coordinate

  !> Place of a component of a point among the numbers, or of its derivatives in time.
  pure integer function place_of_point(n_coordinates, number, order, axis) result(place)
    integer, intent(in) :: n_coordinates   !< number of coordinates
    integer, intent(in) :: number          !< of the point
    integer, intent(in) :: order           !< of the derivative in time
    integer, intent(in) :: axis            !< of frame 0: 1 to 3

    place = 3*n_coordinates + 9*(number - 1) + 3*order + axis
  end function place_of_point

  !> Put the derivatives at one position that were found elsewhere.
  pure subroutine put(self, position, q, points)
    class(motion_changes_type), intent(inout) :: self   !< gets the derivatives
    integer, intent(in) :: position                     !< number of the position in the batch
    real(wp), intent(in) :: q(:, 0:, :)                 !< (P,0:2,M) of coordinates
    real(wp), intent(in) :: points(:, :, 0:, :)         !< (P,3,0:2,points)
    integer :: i, order, axis

    do order = 0, 2
      do i = 1, size(q, 3)
        self%values(position, place_of_coordinate(i, order), :) = q(:, order, i)
      end do
      do i = 1, size(points, 4)
        do axis = 1, 3
          self%values(position, place_of_point(self%n_coordinates, i, order, axis), :) = points(:, axis, order, i)
        end do
      end do
    end do
  end subroutine put
end module mech9_motion_changes
