!> Sums of products at several positions of a motion at once: the position is the fastest index, and runs innermost.
!>
!> Three products are added to three sums together, so that numbers are read and written seldom. Factors of several sums follow each
!> other. All arrays have known shapes, so that the compiler keeps their addresses in registers.
module mech9_batch_products
  use mech9_kinds, only: wp
  implicit none
  private
  public :: batch_size, set_three, sum_three, add_three_to, add_to

  !> Most positions that are treated at once.
  integer, parameter :: batch_size = 32

contains

  !> Three sums of three products each.
  pure subroutine set_three(n, width, factors, numbers, x, y, z)
    integer, intent(in) :: n                                  !< number of positions
    integer, intent(in) :: width                              !< number of all sums to which the factors belong
    real(wp), intent(in) :: factors(batch_size, width, 3)     !< of each number, in these three sums and those that follow
    real(wp), intent(in) :: numbers(batch_size, 3)            !< the numbers
    real(wp), intent(inout) :: x(batch_size)                  !< first sum
    real(wp), intent(inout) :: y(batch_size)                  !< second sum
    real(wp), intent(inout) :: z(batch_size)                  !< third sum
    integer :: i

    do i = 1, n
      x(i) = factors(i, 1, 1)*numbers(i, 1) + factors(i, 1, 2)*numbers(i, 2) + factors(i, 1, 3)*numbers(i, 3)
      y(i) = factors(i, 2, 1)*numbers(i, 1) + factors(i, 2, 2)*numbers(i, 2) + factors(i, 2, 3)*numbers(i, 3)
      z(i) = factors(i, 3, 1)*numbers(i, 1) + factors(i, 3, 2)*numbers(i, 2) + factors(i, 3, 3)*numbers(i, 3)
    end do
  end subroutine set_three

  !> Three more products in each of three sums.
  pure subroutine sum_three(n, width, factors, numbers, x, y, z)
    integer, intent(in) :: n                                  !< number of positions
    integer, intent(in) :: width                              !< number of all sums to which the factors belong
    real(wp), intent(in) :: factors(batch_size, width, 3)     !< of each number, in these three sums and those that follow
    real(wp), intent(in) :: numbers(batch_size, 3)            !< the numbers
    real(wp), intent(inout) :: x(batch_size)                  !< first sum
    real(wp), intent(inout) :: y(batch_size)                  !< second sum
    real(wp), intent(inout) :: z(batch_size)                  !< third sum
    integer :: i

    do i = 1, n
      x(i) = x(i) + factors(i, 1, 1)*numbers(i, 1) + factors(i, 1, 2)*numbers(i, 2) + factors(i, 1, 3)*numbers(i, 3)
      y(i) = y(i) + factors(i, 2, 1)*numbers(i, 1) + factors(i, 2, 2)*numbers(i, 2) + factors(i, 2, 3)*numbers(i, 3)
      z(i) = z(i) + factors(i, 3, 1)*numbers(i, 1) + factors(i, 3, 2)*numbers(i, 2) + factors(i, 3, 3)*numbers(i, 3)
    end do
  end subroutine sum_three

  !> Add three products to each of some sums that follow each other.
  pure subroutine add_three_to(n, count, f, g, h, a, b, c, x)
    integer, intent(in) :: n                          !< number of positions
    integer, intent(in) :: count                      !< number of sums
    real(wp), intent(in) :: f(batch_size, count)      !< factors of `a` in the sums
    real(wp), intent(in) :: g(batch_size, count)      !< factors of `b`
    real(wp), intent(in) :: h(batch_size, count)      !< factors of `c`
    real(wp), intent(in) :: a(batch_size)             !< first numbers
    real(wp), intent(in) :: b(batch_size)             !< second numbers
    real(wp), intent(in) :: c(batch_size)             !< third numbers
    real(wp), intent(inout) :: x(batch_size, count)   !< the sums
    integer :: i, r

    do r = 1, count - 2, 3
      do i = 1, n
        x(i, r) = x(i, r) + f(i, r)*a(i) + g(i, r)*b(i) + h(i, r)*c(i)
        x(i, r + 1) = x(i, r + 1) + f(i, r + 1)*a(i) + g(i, r + 1)*b(i) + h(i, r + 1)*c(i)
        x(i, r + 2) = x(i, r + 2) + f(i, r + 2)*a(i) + g(i, r + 2)*b(i) + h(i, r + 2)*c(i)
      end do
    end do
    r = count - mod(count, 3)
    select case (count - r)
    case (1)
      do i = 1, n
        x(i, r + 1) = x(i, r + 1) + f(i, r + 1)*a(i) + g(i, r + 1)*b(i) + h(i, r + 1)*c(i)
      end do
    case (2)
      do i = 1, n
        x(i, r + 1) = x(i, r + 1) + f(i, r + 1)*a(i) + g(i, r + 1)*b(i) + h(i, r + 1)*c(i)
        x(i, r + 2) = x(i, r + 2) + f(i, r + 2)*a(i) + g(i, r + 2)*b(i) + h(i, r + 2)*c(i)
      end do
    end select
  end subroutine add_three_to

  !> Add one product to each of some sums that follow each other.
  pure subroutine add_to(n, count, f, a, x)
    integer, intent(in) :: n                          !< number of positions
    integer, intent(in) :: count                      !< number of sums
    real(wp), intent(in) :: f(batch_size, count)      !< factors in the sums
    real(wp), intent(in) :: a(batch_size)             !< the numbers
    real(wp), intent(inout) :: x(batch_size, count)   !< the sums
    integer :: i, r

    do r = 1, count - 2, 3
      do i = 1, n
        x(i, r) = x(i, r) + f(i, r)*a(i)
        x(i, r + 1) = x(i, r + 1) + f(i, r + 1)*a(i)
        x(i, r + 2) = x(i, r + 2) + f(i, r + 2)*a(i)
      end do
    end do
    r = count - mod(count, 3)
    select case (count - r)
    case (1)
      do i = 1, n
        x(i, r + 1) = x(i, r + 1) + f(i, r + 1)*a(i)
      end do
    case (2)
      do i = 1, n
        x(i, r + 1) = x(i, r + 1) + f(i, r + 1)*a(i)
        x(i, r + 2) = x(i, r + 2) + f(i, r + 2)*a(i)
      end do
    end select
  end subroutine add_to
end module mech9_batch_products
