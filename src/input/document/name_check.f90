!> Check of the names by which points, parameters and quantities stand in results.
module mech9_name_check
  use mech9_text, only: to_text
  use mech9_document, only: group_type
  use mech9_lookup, only: span_of
  use mech9_diagnostics, only: diagnostics_type, printable
  implicit none
  private
  public :: check_name

  character(len=*), parameter :: name_letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_'
  integer, parameter :: longest_name = 40

contains

  !> Check the name of a group, which becomes part of names of columns, such as P.x.
  pure subroutine check_name(group, name, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: name                  !< the name that it gives
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (len(name) > 0 .and. len(name) <= longest_name .and. verify(name, name_letters) == 0) return
    call diagnostics%add(span_of(group, 'name', 1), '''name'' must be of letters (a to z), digits and _, at most '// &
                         to_text(longest_name)//' of them, not '''//printable(name, longest_name)//'''')
  end subroutine check_name
end module mech9_name_check
