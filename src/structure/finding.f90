!> A finding describes an error in structural data, and gives the number that is wrong.
!>
!> Checks of data collect findings, so that a user sees all errors at once, and the reader of
!> the data file can point at the very number.
module mech9_finding
  implicit none
  private
  public :: finding_type, finding_list_type, longest_list

  integer, parameter :: longest_list = 8    !< numbers that a message lists

  !> One error in structural data.
  type :: finding_type
    character(len=:), allocatable :: message   !< error and remedy in words
    !> Name of the data: 'c', 'cq', 'nrg', 'nws', 'rdw', 'nrw' or 'links'.
    character(len=8) :: name = ''
    !> Place in these data: row and column of C; position in a vector and 0; for 'links' the coordinate of the
    !> pair and 1 or 2, the place of the link (0: both); 0, 0 for the data as a whole.
    integer :: index(2) = 0
  end type finding_type

  !> Findings being collected.
  type :: finding_list_type
    private
    integer :: count = 0
    type(finding_type), allocatable :: items(:)
  contains
    procedure :: add
    procedure :: hand_over
  end type finding_list_type

contains

  !> Note one more finding.
  pure subroutine add(self, name, index, message)
    class(finding_list_type), intent(inout) :: self   !< the findings so far
    character(len=*), intent(in) :: name              !< see finding_type
    integer, intent(in) :: index(2)                   !< see finding_type
    character(len=*), intent(in) :: message           !< error and remedy in words
    type(finding_type), allocatable :: grown(:)

    if (.not. allocated(self%items)) allocate (self%items(4))
    if (self%count == size(self%items)) then
      allocate (grown(2*self%count))
      grown(:self%count) = self%items
      call move_alloc(grown, self%items)
    end if
    self%count = self%count + 1
    self%items(self%count)%message = message
    self%items(self%count)%name = name
    self%items(self%count)%index = index
  end subroutine add

  !> Move the findings into an array of the right size; the list is empty afterwards.
  pure subroutine hand_over(self, findings)
    class(finding_list_type), intent(inout) :: self               !< the findings; none are left afterwards
    type(finding_type), allocatable, intent(out) :: findings(:)   !< the findings in the order in which they were noted

    allocate (findings(self%count))
    if (self%count > 0) findings = self%items(:self%count)
    self%count = 0
    if (allocated(self%items)) deallocate (self%items)
  end subroutine hand_over

end module mech9_finding
