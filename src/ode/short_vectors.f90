!> Linear combinations of short vectors for SUNDIALS, whose own take several times as many instructions; a Runge-Kutta method
!> forms one in every stage.
module mech9_short_vectors
  use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_int64_t, c_double, c_f_pointer
  implicit none
  private
  public :: linear_combination

  !> Elements that are summed at a time.
  integer, parameter :: chunk = 64

  ! Functions of SUNDIALS by their C names: the Fortran wrappers take as much time again.
  interface
    function length_of(vector) bind(c, name='N_VGetLength')
      import :: c_ptr, c_int64_t
      type(c_ptr), value :: vector   !< a serial vector of SUNDIALS
      integer(c_int64_t) :: length_of
    end function length_of

    function numbers_of(vector) bind(c, name='N_VGetArrayPointer')
      import :: c_ptr
      type(c_ptr), value :: vector   !< a serial vector of SUNDIALS
      type(c_ptr) :: numbers_of
    end function numbers_of
  end interface

contains

  !> SUNDIALS calls this function for z = sum of c(i) x(i); z may be one of the x. It answers 0.
  integer(c_int) function linear_combination(n, c, x, z) bind(c) result(answer)
    integer(c_int), value :: n           !< number of terms
    real(c_double), intent(in) :: c(n)   !< factors
    type(c_ptr), intent(in) :: x(n)      !< serial vectors
    type(c_ptr), value :: z              !< serial vector that gets the sum
    real(c_double) :: total(chunk)
    real(c_double), pointer, contiguous :: numbers(:)
    integer :: length, first, part, i

    length = int(length_of(z))
    do first = 1, length, chunk
      part = min(chunk, length - first + 1)
      do i = 1, n
        call c_f_pointer(numbers_of(x(i)), numbers, [length])
        if (i == 1) then
          call start(part, c(i), numbers(first:first + part - 1), total)
        else
          call add(part, c(i), numbers(first:first + part - 1), total)
        end if
      end do
      call c_f_pointer(numbers_of(z), numbers, [length])
      numbers(first:first + part - 1) = total(:part)
    end do
    answer = 0
  end function linear_combination

  !> The first term of a sum.
  pure subroutine start(n, factor, x, total)
    integer, intent(in) :: n                  !< number of elements
    real(c_double), intent(in) :: factor      !< factor of x
    real(c_double), intent(in) :: x(n)        !< elements of a vector
    real(c_double), intent(out) :: total(n)   !< factor x

    total = factor*x
  end subroutine start

  !> A further term of a sum.
  pure subroutine add(n, factor, x, total)
    integer, intent(in) :: n                    !< number of elements
    real(c_double), intent(in) :: factor        !< factor of x
    real(c_double), intent(in) :: x(n)          !< elements of a vector
    real(c_double), intent(inout) :: total(n)   !< the sum so far, to which factor x is added

    total = total + factor*x
  end subroutine add
end module mech9_short_vectors
