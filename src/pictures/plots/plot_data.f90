!> The rows of a run that a plot needs: the columns of its curves, thinned out if a picture cannot show all rows.
module mech9_plot_data
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_plot_request, only: curve_type
  implicit none
  private
  public :: plot_data_type, new_plot_data

  !> The largest number of rows in a picture: ten for each of its pixels from left to right.
  integer, parameter :: most_rows = 10000

  type :: plot_data_type
    type(string_type), allocatable :: names(:), units(:)   !< names and units of all columns of the results
    type(string_type), allocatable :: labels(:)            !< names of these columns in the picture
    integer, allocatable :: columns(:)                     !< numbers of the columns that are kept, ascending
    real(wp), allocatable :: values(:, :)                  !< (columns kept,rows kept) values
    integer :: count = 0                                   !< number of rows kept
    integer :: stride = 1                                  !< one of so many rows is kept
    integer :: seen = 0                                    !< number of rows taken
    logical :: are_points = .false.                        !< rows are points that no line joins
  contains
    procedure :: take
    procedure :: place_of
    procedure :: extent
  end type plot_data_type

contains

  !> Empty data for curves.
  pure function new_plot_data(names, units, curves, expected) result(data)
    type(string_type), intent(in) :: names(:)  !< names of all columns of the results
    type(string_type), intent(in) :: units(:)  !< units of all columns of the results
    type(curve_type), intent(in) :: curves(:)  !< the curves, each with its two columns
    integer, intent(in) :: expected            !< largest number of rows that will come
    type(plot_data_type) :: data
    integer :: i

    data%names = names
    data%labels = names
    data%units = units
    data%columns = pack([(i, i=1, size(names))], [(any(curves%x == i .or. curves%y == i), i=1, size(names))])
    data%stride = 1 + (max(expected, 1) - 1)/most_rows
    allocate (data%values(size(data%columns), 1 + (max(expected, 1) - 1)/data%stride))
  end function new_plot_data

  !> Keep the needed columns of the next row, if it is the turn of this row.
  pure subroutine take(self, row)
    class(plot_data_type), intent(inout) :: self  !< rows and columns that are plotted
    real(wp), intent(in) :: row(:)                !< all columns of the results

    if (modulo(self%seen, self%stride) == 0 .and. self%count < size(self%values, 2)) then
      self%count = self%count + 1
      self%values(:, self%count) = row(self%columns)
    end if
    self%seen = self%seen + 1
  end subroutine take

  !> The place of a column of the results among the columns that are kept.
  pure integer function place_of(self, column)
    class(plot_data_type), intent(in) :: self  !< rows and columns that are plotted
    integer, intent(in) :: column              !< number of the column in the results, one that is kept

    place_of = count(self%columns <= column)
  end function place_of

  !> The least and greatest finite value of some columns; [0, 0] if there is none.
  pure function extent(self, columns) result(ends)
    class(plot_data_type), intent(in) :: self  !< rows and columns that are plotted
    integer, intent(in) :: columns(:)          !< numbers of the columns in the results, all of them kept
    real(wp) :: ends(2), value
    integer :: i, j

    ends = [huge(value), -huge(value)]
    do j = 1, self%count
      do i = 1, size(columns)
        value = self%values(self%place_of(columns(i)), j)
        if (.not. abs(value) <= huge(value)) cycle   ! NaN and infinities do not count
        ends = [min(ends(1), value), max(ends(2), value)]
      end do
    end do
    if (ends(1) > ends(2)) ends = 0.0_wp
  end function extent
end module mech9_plot_data
