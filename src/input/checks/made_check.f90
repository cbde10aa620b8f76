!> The check of a program that was made for one mechanism (mech9-link --specialise): it takes no other.
module mech9_made_check
  use mech9_error, only: error_type, raise, exit_data
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_fixed_groups, only: fixed_groups, first_difference
  use mech9_made_blocks, only: describe_made_mechanism
  implicit none
  private
  public :: refuse_other_mechanism

contains

  !> Refuse a data file whose mechanism is another one than that for which the program was made.
  subroutine refuse_other_mechanism(document, diagnostics)
    type(document_type), intent(in) :: document                !< the data file, with the changes by --set, without errors
    type(diagnostics_type), intent(inout) :: diagnostics       !< gets the error
    character(len=:), allocatable :: made, name, groups, group, line_made, line_given
    type(error_type), allocatable :: err

    call describe_made_mechanism(made, name)
    if (made == '') return
    call fixed_groups(document, diagnostics%sources, groups)
    call first_difference(made, groups, group, line_made, line_given)
    if (group == '') return
    ! a group that ends sooner has / in place of a name
    if (line_made == '' .or. line_made == '/') line_made = 'nothing'
    if (line_given == '' .or. line_given == '/') line_given = 'nothing'
    call raise(err, exit_data, 'this program was made for the mechanism of '//name//', and '//group//' differs: there "'// &
               line_made//'", here "'//line_given//'"; take the general program, or make one for this file by '// &
               'mech9-link --specialise')
    call diagnostics%add_error(err)
  end subroutine refuse_other_mechanism
end module mech9_made_check
