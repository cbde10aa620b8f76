!> The results of a run kept in memory, to be examined after the run.
module mech9_kept_rows
  use mech9_kinds, only: wp, long
  use mech9_text, only: string_type, nearest_name
  use mech9_part_names, only: part_names_type, number_columns
  use mech9_mechanism, only: mechanism_type
  use mech9_motion_event, only: motion_events_type
  use mech9_event_words, only: told_events_type, tell_events
  implicit none
  private
  public :: kept_rows_type

  !> Most numbers kept (128 MiB); of a longer run only each row number 1, 1 + stride, 1 + 2 stride, ... is kept.
  integer(long), parameter :: most_numbers = 2_long**24

  type :: kept_rows_type
    character(len=:), allocatable :: title
    type(string_type), allocatable :: names(:), units(:)  !< headings and units of the columns, time first
    real(wp), allocatable :: rows(:, :)                   !< rows(:, i): row i; `count` of them are filled
    type(part_names_type) :: parts                        !< names of links and pairs, which may stand in those of columns
    type(told_events_type) :: events                      !< those of the run
    integer :: count = 0                                  !< how many rows are kept
    integer :: stride = 1                                 !< one row of so many is kept
    integer :: seen = 0                                   !< how many rows were taken, with those not kept
  contains
    procedure :: begin
    procedure :: take
    procedure :: take_events
    procedure :: column
  end type kept_rows_type

contains

  !> Begin without rows; earlier ones are removed.
  pure subroutine begin(self, title, names, units, expected)
    class(kept_rows_type), intent(inout) :: self  !< the kept rows
    character(len=*), intent(in) :: title         !< title of the mechanism
    type(string_type), intent(in) :: names(:)     !< headings of the columns, time first
    type(string_type), intent(in) :: units(:)     !< units of the columns
    integer, intent(in) :: expected               !< most rows to come

    self%title = title
    self%names = names
    self%units = units
    self%stride = 1 + int((size(names)*int(expected, long))/most_numbers)
    self%count = 0
    self%seen = 0
    if (allocated(self%rows)) deallocate (self%rows)
    allocate (self%rows(size(names), 1 + (max(expected, 1) - 1)/self%stride))
  end subroutine begin

  !> Keep rows, which follow the earlier ones.
  pure subroutine take(self, rows)
    class(kept_rows_type), intent(inout) :: self  !< the kept rows
    real(wp), intent(in) :: rows(:, :)            !< (columns, rows) numbers of the rows
    integer :: i

    do i = 1, size(rows, 2)
      if (modulo(self%seen, self%stride) == 0 .and. self%count < size(self%rows, 2)) then
        self%count = self%count + 1
        self%rows(:, self%count) = rows(:, i)
      end if
      self%seen = self%seen + 1
    end do
  end subroutine take

  !> Keep the events of the run.
  pure subroutine take_events(self, events, mechanism)
    class(kept_rows_type), intent(inout) :: self     !< the kept rows
    type(motion_events_type), intent(in) :: events   !< in the order of time
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism

    call tell_events(events, mechanism, self%events)
  end subroutine take_events

  !> Number of the column with a name; if there is none, 0 and the nearest name.
  pure subroutine column(self, name, number, meant)
    class(kept_rows_type), intent(in) :: self            !< the kept rows
    character(len=*), intent(in) :: name                 !< heading of the column
    integer, intent(out) :: number                       !< number of the column; 0: there is none
    character(len=:), allocatable, intent(out) :: meant  !< the nearest heading; empty where none is near
    character(len=len(name) + 8) :: known(size(self%names))
    character(len=:), allocatable :: numbered

    meant = ''
    numbered = name
    call number_columns(self%parts, numbered)
    do number = 1, size(self%names)
      if (self%names(number)%text == numbered) return
      known(number) = self%names(number)%text
    end do
    number = 0
    meant = nearest_name(name, known)
  end subroutine column
end module mech9_kept_rows
