!> The quantities of a run in words.
module mech9_quantity_words
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9_text, only: to_text
  use mech9_quantity_record, only: quantity_record_type
  implicit none
  private
  public :: print_quantities

contains

  !> Print a line for each quantity, and for each of its derivatives, after a run that went to its end.
  subroutine print_quantities(unit, quantities)
    integer, intent(in) :: unit                            !< Fortran unit to write to
    type(quantity_record_type), intent(in) :: quantities   !< of a run
    character(len=:), allocatable :: per_parameter
    integer :: i, p

    if (quantities%is_empty() .or. .not. quantities%is_finished) return
    do i = 1, size(quantities%tracked)
      associate (name => quantities%quantities(i)%name, columns => quantities%columns)
        write (unit, '(a)') name//' = '//to_text(quantities%numbers(i), 12)//' '//quantities%unit_of(i)
        do p = 1, size(quantities%gradient, 1)
          if (ieee_is_nan(quantities%gradient(p, i))) then
            write (unit, '(a)') '  d('//name//')/d('//columns%parameters(p)%text//') is not known'
          else
            call columns%find_unit_per(quantities%unit_of(i), p, per_parameter)
            write (unit, '(a)') '  d('//name//')/d('//columns%parameters(p)%text//') = '// &
              to_text(quantities%gradient(p, i), 12)//' '//per_parameter
          end if
        end do
      end associate
    end do
  end subroutine print_quantities
end module mech9_quantity_words
