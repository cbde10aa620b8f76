!> The heading of results in a table or a plot.
module mech9_heading
  use mech9_text, only: string_type
  use mech9_part_names, only: part_names_type, name_column
  use mech9_columns, only: columns_type
  implicit none
  private
  public :: heading_type, new_heading, heading_of

  !> A title, and the names of columns.
  type :: heading_type
    character(len=:), allocatable :: title      !< title of the mechanism; it may have several lines
    type(string_type), allocatable :: names(:)  !< names of the columns
    type(string_type), allocatable :: units(:)  !< their units; empty for a plain number
  contains
    procedure :: call_by_names
  end type heading_type

contains

  !> A heading of its parts.
  pure function new_heading(title, names, units) result(heading)
    character(len=*), intent(in) :: title       !< title of the mechanism; it may have several lines
    type(string_type), intent(in) :: names(:)   !< names of the columns
    type(string_type), intent(in) :: units(:)   !< their units; empty for a plain number
    type(heading_type) :: heading

    heading%title = title
    heading%names = names
    heading%units = units
  end function new_heading

  !> Call the columns of pairs and links by the names of these, where they have any: B.q in place of q2.
  pure subroutine call_by_names(self, parts)
    class(heading_type), intent(inout) :: self     !< the heading
    type(part_names_type), intent(in) :: parts     !< names of links and pairs
    integer :: i

    do i = 1, size(self%names)
      call name_column(parts, self%names(i)%text)
    end do
  end subroutine call_by_names

  !> The heading of the results of a run.
  pure function heading_of(title, columns) result(heading)
    character(len=*), intent(in) :: title       !< title of the mechanism
    type(columns_type), intent(in) :: columns   !< names and units of the columns
    type(heading_type) :: heading

    heading = new_heading(title, columns%names(:columns%count), columns%units(:columns%count))
    if (columns%in_links) heading%title = title//new_line('a')//'forces and moments in pairs: along the axes of the moving links'
  end function heading_of
end module mech9_heading
