!> Sobol's sequence in base 2: points that fill a cube evenly, each computed from its number alone.
!>
!> The direction numbers are those of S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections",
!> SIAM Journal on Scientific Computing 30, 2635-2654, 2008 (file new-joe-kuo-6.21201; copyright 2008 Frances Y. Kuo and
!> Stephen Joe, to be used under a BSD licence), for the first 37 dimensions.
module mech9_sobol
  use mech9_kinds, only: wp, long
  use mech9_counted_random, only: philox
  implicit none
  private
  public :: sobol_at, most_sobol_dimensions, sobol_bits

  integer, parameter :: most_sobol_dimensions = 37
  integer, parameter :: bits = 32       !< of a coordinate
  integer, parameter :: longest = 7     !< highest degree of the polynomials
  integer, parameter :: n_rows = most_sobol_dimensions - 1
  !> Of the dimensions from 2 on: the degree of the primitive polynomial, its inner coefficients as binary digits, and the first
  !> direction numbers, as many as the degree.
  integer, parameter :: table(longest + 2, n_rows) = reshape([ &
    1, 0, 1, 0, 0, 0, 0, 0, 0, &
    2, 1, 1, 3, 0, 0, 0, 0, 0, &
    3, 1, 1, 3, 1, 0, 0, 0, 0, &
    3, 2, 1, 1, 1, 0, 0, 0, 0, &
    4, 1, 1, 1, 3, 3, 0, 0, 0, &
    4, 4, 1, 3, 5, 13, 0, 0, 0, &
    5, 2, 1, 1, 5, 5, 17, 0, 0, &
    5, 4, 1, 1, 5, 5, 5, 0, 0, &
    5, 7, 1, 1, 7, 11, 19, 0, 0, &
    5, 11, 1, 1, 5, 1, 1, 0, 0, &
    5, 13, 1, 1, 1, 3, 11, 0, 0, &
    5, 14, 1, 3, 5, 5, 31, 0, 0, &
    6, 1, 1, 3, 3, 9, 7, 49, 0, &
    6, 13, 1, 1, 1, 15, 21, 21, 0, &
    6, 16, 1, 3, 1, 13, 27, 49, 0, &
    6, 19, 1, 1, 1, 15, 7, 5, 0, &
    6, 22, 1, 3, 1, 15, 13, 25, 0, &
    6, 25, 1, 1, 5, 5, 19, 61, 0, &
    7, 1, 1, 3, 7, 11, 23, 15, 103, &
    7, 4, 1, 3, 7, 13, 13, 15, 69, &
    7, 7, 1, 1, 3, 13, 7, 35, 63, &
    7, 8, 1, 3, 5, 9, 1, 25, 53, &
    7, 14, 1, 3, 1, 13, 9, 35, 107, &
    7, 19, 1, 3, 1, 5, 27, 61, 31, &
    7, 21, 1, 1, 5, 11, 19, 41, 61, &
    7, 28, 1, 3, 5, 3, 3, 13, 69, &
    7, 31, 1, 1, 7, 13, 1, 19, 1, &
    7, 32, 1, 3, 7, 5, 13, 19, 59, &
    7, 37, 1, 1, 3, 9, 25, 29, 41, &
    7, 41, 1, 3, 5, 13, 23, 1, 55, &
    7, 42, 1, 3, 7, 3, 13, 59, 17, &
    7, 50, 1, 3, 1, 3, 5, 53, 69, &
    7, 55, 1, 1, 5, 5, 23, 33, 13, &
    7, 56, 1, 1, 7, 7, 1, 61, 123, &
    7, 59, 1, 1, 7, 9, 13, 61, 49, &
    7, 62, 1, 3, 3, 5, 3, 55, 33], [longest + 2, n_rows])
  !> Counters from here on belong to shifts, not to numbers that are drawn.
  integer(long), parameter :: apart = 3221225472_long

contains

  !> A coordinate of a point, greater than 0 and less than 1. All points are shifted digit by digit by numbers that follow from the
  !> seed. The shift leaves them as even as they were, and makes means over them estimates without bias.
  pure real(wp) function sobol_at(seed, run, dimension) result(u)
    integer, intent(in) :: seed        !< of the study, not negative
    integer, intent(in) :: run         !< number of the point, from 1
    integer, intent(in) :: dimension   !< 1 to most_sobol_dimensions
    integer(long) :: shift(2)

    call philox([apart, int(dimension, long)], int(seed, long), shift)
    u = (real(ieor(sobol_bits(run - 1, dimension), shift(1)), wp) + 0.5_wp)*2.0_wp**(-bits)
  end function sobol_at

  !> The digits of a coordinate behind the point, as a whole number.
  pure integer(long) function sobol_bits(number, dimension) result(digits)
    integer, intent(in) :: number      !< of the point, from 0
    integer, intent(in) :: dimension   !< 1 to most_sobol_dimensions
    integer(long) :: directions(bits)
    integer :: i

    call find_directions(dimension, directions)
    digits = 0
    do i = 1, bits - 1
      if (btest(number, i - 1)) digits = ieor(digits, directions(i))
    end do
  end function sobol_bits

  !> The direction numbers of a dimension, as digits behind the point.
  pure subroutine find_directions(dimension, directions)
    integer, intent(in) :: dimension                !< 1 to most_sobol_dimensions
    integer(long), intent(out) :: directions(bits)  !< one for each binary digit of a point's number
    integer :: i, k, degree

    do i = 1, bits
      directions(i) = shiftl(1_long, bits - i)
    end do
    if (dimension == 1) return
    degree = table(1, dimension - 1)
    do i = 1, degree
      directions(i) = shiftl(int(table(2 + i, dimension - 1), long), bits - i)
    end do
    do i = degree + 1, bits
      directions(i) = ieor(directions(i - degree), shiftr(directions(i - degree), degree))
      do k = 1, degree - 1
        if (btest(table(2, dimension - 1), degree - 1 - k)) directions(i) = ieor(directions(i), directions(i - k))
      end do
    end do
  end subroutine find_directions
end module mech9_sobol
