!> The numbers of derivatives by parameters, from those at several positions to the columns of rows.
module mech9_derivative_columns
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size
  use mech9_motion_changes, only: motion_changes_type, place_of_coordinate, place_of_point
  implicit none
  private
  public :: derivative_columns_type, new_derivative_columns

  !> The columns of a motion that have derivatives: coordinates by orders, then points.
  type :: derivative_columns_type
    private
    integer, allocatable :: places(:)      !< (columns) of their derivatives among those of the motion
    real(wp), allocatable :: factors(:)    !< (columns) from the program's units to those of the results
  contains
    procedure :: fill
  end type derivative_columns_type

contains

  !> The columns of recorded coordinates and of all points.
  pure function new_derivative_columns(coordinates, factors, highest, n_coordinates, n_points) result(columns)
    integer, intent(in) :: coordinates(:)   !< numbers of the recorded coordinates
    real(wp), intent(in) :: factors(:)      !< (columns) from the program's units to those of the results
    integer, intent(in) :: highest          !< order of the highest derivative in time
    integer, intent(in) :: n_coordinates    !< number of all coordinates
    integer, intent(in) :: n_points         !< number of points
    type(derivative_columns_type) :: columns
    integer :: i, order, axis

    columns%places = [((place_of_coordinate(coordinates(i), order), i=1, size(coordinates)), order=0, highest), &
                      (((place_of_point(n_coordinates, i, order, axis), axis=1, 3), order=0, highest), i=1, n_points)]
    columns%factors = factors
  end function new_derivative_columns

  !> Fill the columns of derivatives in rows that follow each other.
  pure subroutine fill(self, changes, first, n, list, before, width, rows)
    class(derivative_columns_type), intent(in) :: self      !< the columns
    type(motion_changes_type), intent(in) :: changes        !< the derivatives at several positions
    integer, intent(in) :: first                            !< number of the position of the first row
    integer, intent(in) :: n                                !< number of rows
    integer, intent(in) :: list(:)                          !< columns whose derivatives are wanted, from 1 for the first one after time
    integer, intent(in) :: before                           !< columns of a row before those of derivatives
    integer, intent(in) :: width                            !< number of all columns of a row
    real(wp), intent(inout) :: rows(width, n)               !< gets the derivatives
    integer :: i

    do i = 1, size(list)
      associate (c => list(i), p => changes%n_parameters)
        call put_numbers(n, p, self%factors(c), size(changes%values, 2), changes%values(first, self%places(c), 1), &
                         width, rows(before + (c - 1)*p + 1, 1))
      end associate
    end do
  end subroutine fill

  !> Put the derivatives of a number into their columns, by four parameters at a time. The arrays have known shapes, so that the compiler
  !> keeps their addresses in registers.
  pure subroutine put_numbers(n, n_parameters, factor, numbers, values, width, rows)
    integer, intent(in) :: n                              !< number of rows
    integer, intent(in) :: n_parameters                   !< number of parameters
    real(wp), intent(in) :: factor                        !< of the numbers
    integer, intent(in) :: numbers                        !< number of derivatives by each parameter
    real(wp), intent(in) :: values(batch_size*numbers, *) !< (positions,P) the derivatives; those by one parameter begin with this number
    integer, intent(in) :: width                          !< number of all columns
    real(wp), intent(inout) :: rows(width, *)             !< (P,n) gets them
    integer :: i, p

    do p = 1, n_parameters - 3, 4
      do i = 1, n
        rows(p, i) = factor*values(i, p)
        rows(p + 1, i) = factor*values(i, p + 1)
        rows(p + 2, i) = factor*values(i, p + 2)
        rows(p + 3, i) = factor*values(i, p + 3)
      end do
    end do
    p = n_parameters - mod(n_parameters, 4) + 1
    if (mod(n_parameters, 4) >= 2) then
      do i = 1, n
        rows(p, i) = factor*values(i, p)
        rows(p + 1, i) = factor*values(i, p + 1)
      end do
      p = p + 2
    end if
    if (mod(n_parameters, 2) == 1) then
      do i = 1, n
        rows(p, i) = factor*values(i, p)
      end do
    end if
  end subroutine put_numbers
end module mech9_derivative_columns
