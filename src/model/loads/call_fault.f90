!> A number of a link or coordinate that the mechanism does not have, as a user's procedure gave it.
module mech9_call_fault
  implicit none
  private
  public :: call_fault_type

  !> The first fault of the calls that share it.
  type :: call_fault_type
    integer :: links = huge(1)             !< links that users know; those of joints with several freedoms have higher numbers
    logical :: found = .false.
    character(len=16) :: procedure = ' '   !< name of the procedure called, such as add_force
    character(len=10) :: counted = ' '     !< 'link' or 'coordinate'
    integer :: number = 0     !< the number given
    integer :: greatest = 0   !< the greatest number that exists; the least is 1
  contains
    procedure :: note
  end type call_fault_type

contains

  !> Keep this fault, unless another one came before it.
  pure subroutine note(self, procedure, counted, number, greatest)
    class(call_fault_type), intent(inout) :: self   !< keeps the first fault
    character(len=*), intent(in) :: procedure       !< name of the procedure called
    character(len=*), intent(in) :: counted         !< 'link' or 'coordinate'
    integer, intent(in) :: number                   !< the number given, which does not exist
    integer, intent(in) :: greatest                 !< the greatest number that exists

    if (self%found) return
    self%found = .true.
    self%procedure = procedure
    self%counted = counted
    self%number = number
    self%greatest = greatest
  end subroutine note
end module mech9_call_fault
