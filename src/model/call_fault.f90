!> A number of a link or coordinate that the mechanism does not have, as a user's procedure gave it.
module mech9_call_fault
  implicit none
  private
  public :: call_fault_type

  !> The first fault of the calls that share it.
  type :: call_fault_type
    logical :: found = .false.
    character(len=21) :: procedure = ' '   !< what was called, such as loads%add_force
    character(len=10) :: counted = ' '     !< 'link' or 'coordinate'
    integer :: number = 0                  !< the one that was given
    integer :: greatest = 0                !< the numbers that there are: 1 to this one
  contains
    procedure :: note
  end type call_fault_type

contains

  !> Keep this fault, unless another one came before it.
  pure subroutine note(self, procedure, counted, number, greatest)
    class(call_fault_type), intent(inout) :: self   !< the call fault
    character(len=*), intent(in) :: procedure   !< what was called
    character(len=*), intent(in) :: counted     !< 'link' or 'coordinate'
    integer, intent(in) :: number               !< that does not exist
    integer, intent(in) :: greatest             !< number that exists

    if (self%found) return
    self%found = .true.
    self%procedure = procedure
    self%counted = counted
    self%number = number
    self%greatest = greatest
  end subroutine note
end module mech9_call_fault
