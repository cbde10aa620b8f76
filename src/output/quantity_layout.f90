!> The quantities of a run as data sets.
module mech9_quantity_layout
  use mech9_text, only: string_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_facts, only: facts_type
  use mech9_fact_layout, only: put_facts
  use mech9_data_set_store, only: data_set_store_type
  implicit none
  private
  public :: write_quantities

contains

  !> List the quantities as facts, for their data sets.
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

  !> Write the quantities with their derivatives by the parameters: before the run, when they are NaN, and again
  !> after it.
  subroutine write_quantities(quantities, store, again)
    type(quantity_record_type), intent(in) :: quantities   !< of a run
    class(data_set_store_type), intent(inout) :: store !< the open storage
    logical, intent(in) :: again                           !< the storage has them already, and they are written over
    type(facts_type) :: facts
    type(string_type) :: names(size(quantities%quantities))
    integer :: i

    call find_facts(quantities, facts)
    call put_facts(facts, store, 'quantities', again)
    if (.not. quantities%has_gradient()) return
    if (.not. again) then
      do i = 1, size(names)
        names(i)%text = quantities%quantities(i)%name
      end do
      call store%put('quantity', names, 'name of the quantity')
      call store%make_scale('quantity')
      if (quantities%columns%sensitivities == 0) then
        call store%put('parameter', quantities%columns%parameters, 'name of the parameter')
        call store%make_scale('parameter')
      end if
    end if
    call store%put('quantities/gradient', quantities%gradient, 'derivatives of the quantities by the parameters', &
                  'unit of the quantity per unit of the parameter in the data file')
    if (.not. again) call store%attach_scales('quantities/gradient', ['/quantity ', '/parameter'])
  end subroutine write_quantities
end module mech9_quantity_layout
