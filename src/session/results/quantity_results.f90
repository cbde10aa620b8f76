!> The quantities of a run in its HDF5 file, and in lines.
module mech9_quantity_results
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9_text, only: to_text, string_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_facts, only: facts_type
  use mech9_hdf5_facts, only: put_facts
  use mech9_hdf5_file, only: hdf5_file_type
  implicit none
  private
  public :: write_quantities, print_quantities

contains

  !> List the quantities as facts, for the HDF5 file.
  subroutine find_facts(quantities, facts)
    type(quantity_record_type), intent(in) :: quantities   !< of a run
    type(facts_type), intent(out) :: facts                 !< the quantities; NaN before the end of the run
    integer :: i

    if (quantities%is_empty()) return
    do i = 1, size(quantities%tracked)
      associate (quantity => quantities%quantities(i))
        call facts%add(quantity%name, quantities%numbers(i), trim(quantity%take)//' of '//quantity%column, quantities%unit_of(i))
      end associate
    end do
  end subroutine find_facts

  !> Write the quantities to the HDF5 file, with their derivatives by the parameters: before the run, when they are NaN, and again
  !> after it.
  subroutine write_quantities(quantities, file, again)
    type(quantity_record_type), intent(in) :: quantities   !< of a run
    type(hdf5_file_type), intent(inout) :: file            !< the open file
    logical, intent(in) :: again                           !< the file has them already, and they are written over
    type(facts_type) :: facts
    type(string_type) :: names(size(quantities%quantities))
    integer :: i

    call find_facts(quantities, facts)
    call put_facts(facts, file, 'quantities', again)
    if (.not. quantities%has_gradient()) return
    if (.not. again) then
      do i = 1, size(names)
        names(i)%text = quantities%quantities(i)%name
      end do
      call file%put('quantity', names, 'name of the quantity')
      call file%make_scale('quantity')
      if (quantities%columns%sensitivities == 0) then
        call file%put('parameter', quantities%columns%parameters, 'name of the parameter')
        call file%make_scale('parameter')
      end if
    end if
    call file%put('quantities/gradient', quantities%gradient, 'derivatives of the quantities by the parameters', &
                  'unit of the quantity per unit of the parameter in the data file')
    if (.not. again) call file%attach_scales('quantities/gradient', ['/quantity ', '/parameter'])
  end subroutine write_quantities

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

end module mech9_quantity_results
