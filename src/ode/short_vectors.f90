!> Linear combinations of short vectors for SUNDIALS, whose own take several times as many instructions; a Runge-Kutta method
!> forms one in every stage.
module mech9_short_vectors
  use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_int64_t, c_double, c_f_pointer
  implicit none
  private
  public :: linear_combination, length_of, numbers_of

  !> Elements, and terms, that are summed at a time.
  integer, parameter :: chunk = 64, group = 4

  ! Functions of SUNDIALS by their C names: the Fortran wrappers take as much time again.
  interface
    !> The number of elements of a vector.
    function length_of(vector) bind(c, name='N_VGetLength_Serial')
      import :: c_ptr, c_int64_t
      type(c_ptr), value :: vector   !< a serial vector of SUNDIALS
      integer(c_int64_t) :: length_of
    end function length_of

    !> The address of the elements of a vector.
    function numbers_of(vector) bind(c, name='N_VGetArrayPointer_Serial')
      import :: c_ptr
      type(c_ptr), value :: vector   !< a serial vector of SUNDIALS
      type(c_ptr) :: numbers_of
    end function numbers_of
  end interface

contains

  !> SUNDIALS calls this function for z = sum of c(i) x(i); z may be one of the x. Terms whose factor is zero are left out, of which
  !> Runge-Kutta methods of high order have many. It answers 0.
  integer(c_int) function linear_combination(n, c, x, z) bind(c) result(answer)
    integer(c_int), value :: n           !< number of terms
    real(c_double), intent(in) :: c(n)   !< factors
    type(c_ptr), intent(in) :: x(n)      !< serial vectors
    type(c_ptr), value :: z              !< serial vector that gets the sum
    real(c_double) :: total(chunk), factors(group)
    real(c_double), pointer, contiguous :: numbers(:)
    type(c_ptr) :: terms(group)
    integer :: length, first, part, i, k

    length = int(length_of(z))
    do first = 1, length, chunk
      part = min(chunk, length - first + 1)
      total(:part) = 0.0_c_double
      k = 0
      do i = 1, n
        if (.not. abs(c(i)) > 0.0_c_double) cycle
        k = k + 1
        factors(k) = c(i)
        terms(k) = numbers_of(x(i))
        if (k < group) cycle
        call add_group(factors, terms, length, first, part, total)
        k = 0
      end do
      do i = 1, k
        call c_f_pointer(terms(i), numbers, [length])
        call add(part, factors(i), numbers(first:first + part - 1), total)
      end do
      call c_f_pointer(numbers_of(z), numbers, [length])
      numbers(first:first + part - 1) = total(:part)
    end do
    answer = 0
  end function linear_combination

  !> Add a group of terms to a part of a sum.
  subroutine add_group(factors, terms, length, first, part, total)
    real(c_double), intent(in) :: factors(group)   !< factors of the terms
    type(c_ptr), intent(in) :: terms(group)        !< their numbers
    integer, intent(in) :: length                  !< number of elements of each
    integer, intent(in) :: first                   !< first element of the part
    integer, intent(in) :: part                    !< number of elements of the part
    real(c_double), intent(inout) :: total(part)   !< the sum so far
    real(c_double), pointer, contiguous :: w(:), x(:), y(:), z(:)

    call c_f_pointer(terms(1), w, [length])
    call c_f_pointer(terms(2), x, [length])
    call c_f_pointer(terms(3), y, [length])
    call c_f_pointer(terms(4), z, [length])
    call add_four(part, factors, w(first:first + part - 1), x(first:first + part - 1), y(first:first + part - 1), &
                  z(first:first + part - 1), total)
  end subroutine add_group

  !> Four further terms of a sum.
  pure subroutine add_four(n, factors, w, x, y, z, total)
    integer, intent(in) :: n                    !< number of elements
    real(c_double), intent(in) :: factors(4)    !< factors of the four
    real(c_double), intent(in) :: w(n)          !< elements of the first vector
    real(c_double), intent(in) :: x(n)          !< elements of the second vector
    real(c_double), intent(in) :: y(n)          !< elements of the third vector
    real(c_double), intent(in) :: z(n)          !< elements of the fourth vector
    real(c_double), intent(inout) :: total(n)   !< the sum so far, to which the four terms are added, one after the other

    total = total + factors(1)*w + factors(2)*x + factors(3)*y + factors(4)*z
  end subroutine add_four

  !> A further term of a sum.
  pure subroutine add(n, factor, x, total)
    integer, intent(in) :: n                    !< number of elements
    real(c_double), intent(in) :: factor        !< factor of x
    real(c_double), intent(in) :: x(n)          !< elements of a vector
    real(c_double), intent(inout) :: total(n)   !< the sum so far, to which factor x is added

    total = total + factor*x
  end subroutine add
end module mech9_short_vectors
