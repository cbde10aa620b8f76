!> Sums of products at several positions of a motion at once: the position is the fastest index, and runs innermost.
!>
!> Three products are added to three sums together, so that numbers are read and written seldom. Factors of several sums follow each
!> other. All arrays have known shapes, so that the compiler keeps their addresses in registers.
module mech9_batch_products
  use mech9_kinds, only: wp
  implicit none
  private
  public :: batch_size, sum_three, add_three_to, add_to

  !> Most positions that are treated at once.
  integer, parameter :: batch_size = 32

contains

  !> Three sums of three products each, or three more products in each of them.
  pure subroutine sum_three(n, anew, f, g, h, a, b, c, x, y, z)
    integer, intent(in) :: n                       !< number of positions
    logical, intent(in) :: anew                    !< the sums begin with these products
    real(wp), intent(in) :: f(batch_size, 3)       !< factors of `a` in the sums
    real(wp), intent(in) :: g(batch_size, 3)       !< factors of `b`
    real(wp), intent(in) :: h(batch_size, 3)       !< factors of `c`
    real(wp), intent(in) :: a(batch_size)          !< first numbers
    real(wp), intent(in) :: b(batch_size)          !< second numbers
    real(wp), intent(in) :: c(batch_size)          !< third numbers
    real(wp), intent(inout) :: x(batch_size)       !< first sum
    real(wp), intent(inout) :: y(batch_size)       !< second sum
    real(wp), intent(inout) :: z(batch_size)       !< third sum
    integer :: i

    if (anew) then
      do i = 1, n
        x(i) = f(i, 1)*a(i) + g(i, 1)*b(i) + h(i, 1)*c(i)
        y(i) = f(i, 2)*a(i) + g(i, 2)*b(i) + h(i, 2)*c(i)
        z(i) = f(i, 3)*a(i) + g(i, 3)*b(i) + h(i, 3)*c(i)
      end do
    else
      do i = 1, n
        x(i) = x(i) + f(i, 1)*a(i) + g(i, 1)*b(i) + h(i, 1)*c(i)
        y(i) = y(i) + f(i, 2)*a(i) + g(i, 2)*b(i) + h(i, 2)*c(i)
        z(i) = z(i) + f(i, 3)*a(i) + g(i, 3)*b(i) + h(i, 3)*c(i)
      end do
    end if
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
