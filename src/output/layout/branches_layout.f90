!> Branches over a parameter as data sets: one for each column of the table over its rows.
module mech9_branches_layout
  use mech9_branches, only: branches_found_type
  use mech9_data_set_store, only: data_set_store_type
  implicit none
  private
  public :: write_branches

contains

  !> Write the points of all branches.
  subroutine write_branches(found, store)
    type(branches_found_type), intent(in) :: found             !< the branches
    class(data_set_store_type), intent(inout) :: store         !< the open storage
    character(len=:), allocatable :: name
    integer :: i

    if (size(found%rows, 2) == 0) return
    call store%put('branches/row', [(i, i=1, size(found%rows, 2))], 'number of the row')
    call store%make_scale('branches/row')
    associate (columns => found%columns)
      do i = 1, columns%count
        name = 'branches/'//columns%names(i)%text
        if (i <= 2 .or. i == columns%count) then
          call store%put(name, nint(found%rows(i, :)), columns%long_names(i)%text)
        else
          call store%put(name, found%rows(i, :), columns%long_names(i)%text, columns%units(i)%text)
        end if
        call store%attach_scales(name, ['/branches/row'])
      end do
    end associate
  end subroutine write_branches
end module mech9_branches_layout
