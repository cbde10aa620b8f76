!> Quantities of a run that the groups &quantity of a checked document request.
module mech9_quantity_reader
  use mech9_text, only: to_text
  use mech9_document, only: document_type
  use mech9_lookup, only: groups_named, has_name, get_real, get_text, span_of
  use mech9_name_check, only: check_name
  use mech9_diagnostics, only: diagnostics_type
  use mech9_request, only: time_grid_type
  use mech9_quantity, only: quantity_type
  implicit none
  private
  public :: read_quantities

contains

  !> Read all groups &quantity. Their columns are looked for when these are known.
  pure subroutine read_quantities(document, time, quantities, diagnostics)
    type(document_type), intent(in) :: document                     !< the data file as groups and items
    type(time_grid_type), intent(in) :: time                        !< the times of the results
    type(quantity_type), allocatable, intent(out) :: quantities(:)  !< one for each sound group, in their order
    type(diagnostics_type), intent(inout) :: diagnostics            !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'quantity')
    allocate (quantities(size(numbers)))
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), quantity => quantities(i))
        quantity%name = get_text(group, 'name')
        quantity%column = get_text(group, 'of')
        quantity%take = get_text(group, 'take')
        quantity%place = diagnostics%place(span_of(group, 'of', 1))
        call check_name(group, quantity%name, diagnostics)
        if (quantity%take == 'at' .and. .not. has_name(group, 'at')) then
          call diagnostics%add(span_of(group, 'take', 1), 'take=''at'' needs ''at'': the time of the value')
        else if (quantity%take /= 'at' .and. has_name(group, 'at')) then
          call diagnostics%add(span_of(group, 'take', 1), '''at'' gives the time for take=''at'', and belongs to no other one')
        else if (has_name(group, 'at')) then
          quantity%at = get_real(group, 'at')
          if (quantity%at < min(time%start, time%end) .or. quantity%at > max(time%start, time%end)) &
            call diagnostics%add(span_of(group, 'at', 1), 'this time is not among those of the results, '// &
                                 to_text(time%start)//' to '//to_text(time%end)//' s')
        end if
      end associate
    end do
  end subroutine read_quantities
end module mech9_quantity_reader
