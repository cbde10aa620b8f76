!> The designs to which a start led, as one row of numbers for files and messages. The row has for each design its value, parameters,
!> coordinates and times, one design behind the other, and their number at the end.
module mech9_start_rows
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_design_search, only: found_design_type, most_assemblies
  use mech9_synthesis, only: synthesis_type
  implicit none
  private
  public :: start_row_type, row_of_synthesis, not_made

  integer, parameter :: not_made = -1   !< number of designs in the row of a start that is not made yet

  !> Extents of the designs of one start.
  type :: start_row_type
    integer :: parameters = 0    !< those that are varied
    integer :: coordinates = 0   !< of the mechanism
    integer :: targets = 0       !< with their times
  contains
    procedure :: width
    procedure :: length
    procedure :: columns
    procedure :: pack => pack_start
    procedure :: unpack => unpack_start
  end type start_row_type

contains

  !> The extents of the designs of a synthesis.
  pure type(start_row_type) function row_of_synthesis(synthesis) result(row)
    type(synthesis_type), intent(in) :: synthesis   !< prepared

    row%parameters = size(synthesis%space%varied)
    row%coordinates = synthesis%space%plan%n_coordinates
    row%targets = size(synthesis%targets)
  end function row_of_synthesis

  !> How many numbers one design has.
  pure integer function width(self)
    class(start_row_type), intent(in) :: self   !< the extents

    width = 1 + self%parameters + self%coordinates + self%targets
  end function width

  !> How many numbers a row has.
  pure integer function length(self)
    class(start_row_type), intent(in) :: self   !< the extents

    length = most_assemblies*self%width() + 1
  end function length

  !> The columns of some numbers of all designs.
  pure function columns(self, before, n) result(list)
    class(start_row_type), intent(in) :: self   !< the extents
    integer, intent(in) :: before               !< numbers of a design before these
    integer, intent(in) :: n                    !< how many they are
    integer :: list(n*most_assemblies)
    integer :: i, k

    list = [(((k - 1)*self%width() + before + i, i=1, n), k=1, most_assemblies)]
  end function columns

  !> Write the designs of a start as a row; NaN where there is none.
  pure subroutine pack_start(self, found, row)
    class(start_row_type), intent(in) :: self           !< the extents
    type(found_design_type), intent(in) :: found(:)     !< the designs
    real(wp), intent(out) :: row(:)                     !< (length) the row
    integer :: i, n, at

    n = 0
    row = ieee_value(row, ieee_quiet_nan)
    do i = 1, size(found)
      if (.not. found(i)%found) cycle
      at = n*self%width()
      row(at + 1:at + self%width()) = [found(i)%value, found(i)%x, found(i)%q, found(i)%times]
      n = n + 1
    end do
    row(size(row)) = n
  end subroutine pack_start

  !> Read the designs of a row.
  pure subroutine unpack_start(self, row, found, sound)
    class(start_row_type), intent(in) :: self                            !< the extents
    real(wp), intent(in) :: row(:)                                       !< (length) the row
    type(found_design_type), allocatable, intent(out) :: found(:)        !< the designs; not allocated where the start is not made
    logical, intent(out) :: sound                                        !< there can be so many designs
    integer :: k, n, at

    sound = row(size(row)) >= not_made .and. row(size(row)) <= most_assemblies
    if (.not. sound) return
    n = nint(row(size(row)))
    if (n == not_made) return
    allocate (found(n))
    do k = 1, n
      at = (k - 1)*self%width() + 1
      found(k)%found = .true.
      found(k)%value = row(at)
      found(k)%x = row(at + 1:at + self%parameters)
      at = at + self%parameters
      found(k)%q = row(at + 1:at + self%coordinates)
      at = at + self%coordinates
      found(k)%times = row(at + 1:at + self%targets)
    end do
  end subroutine unpack_start
end module mech9_start_rows
