!> Lyapunov exponents in words.
module mech9_exponents_words
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_model, only: model_type
  use mech9_exponents, only: exponents_found_type
  implicit none
  private
  public :: print_exponents

contains

  !> Print the exponents with their standard errors.
  subroutine print_exponents(unit, model, found)
    integer, intent(in) :: unit                          !< Fortran unit to write to
    type(model_type), intent(in) :: model                !< the model
    type(exponents_found_type), intent(in) :: found      !< the exponents
    character(len=:), allocatable :: words
    integer :: k

    if (model%mechanism%title /= '') write (unit, '(a)') model%mechanism%title
    do k = 1, size(found%exponents) - found%lost
      write (unit, '(a)') 'exponent '//to_text(k)//': '//to_text(found%exponents(k), 6)//' 1/s, standard error '// &
        to_text(found%errors(k), 2)//', change in the second half of the time '//to_text(found%changes(k), 2)
    end do
    do k = size(found%exponents) - found%lost + 1, size(found%exponents)
      write (unit, '(a)') 'exponent '//to_text(k)//': minus infinity, since events make neighbouring motions the same'
    end do
    if (size(found%exponents) == found%states .and. found%lost == 0) then
      words = 'their sum: '//to_text(sum(found%exponents), 8)//' 1/s'
      if (found%knows_divergence) words = words//'; mean divergence '//to_text(found%divergence, 8)//' 1/s'
      write (unit, '(a)') words
    end if
    write (unit, '(a)') 'means from t = '//to_text(found%from, 6)//' s to '//to_text(found%to, 6)//' s; '// &
      counted(found%orthonormalised, 'orthonormal set')//' of directions'
    if (found%coordinate_changes > 0) &
      write (unit, '(a)') counted(found%coordinate_changes, 'change')//' of the independent coordinates'
  end subroutine print_exponents
end module mech9_exponents_words
