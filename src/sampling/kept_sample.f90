!> A sample of the rows of a study: all rows of a short study, and of a longer one a bounded number that is drawn at random.
!>
!> Algorithm R of J. S. Vitter, "Random sampling with a reservoir", ACM Transactions on Mathematical Software 11, 37-57, 1985. Its
!> random numbers are functions of the seed and the place of a row, so that the same rows in the same order leave the same sample.
module mech9_kept_sample
  use mech9_kinds, only: wp, long
  use mech9_counted_random, only: philox
  implicit none
  private
  public :: kept_sample_type, most_kept

  !> Rows that are kept: the error of a median of so many numbers is a two-hundredth of their deviation.
  integer, parameter :: most_kept = 65536
  !> The counter of the draws, apart from those of values, of permutations and of shifts.
  integer(long), parameter :: apart = 3758096384_long

  type :: kept_sample_type
    integer :: kept = 0                      !< rows in the sample
    integer :: seen = 0                      !< rows that were taken
    real(wp), allocatable :: rows(:, :)      !< (columns,kept) in the order of the rows as long as all are kept
    integer, private :: seed = 0
  contains
    procedure :: begin
    procedure :: take
  end type kept_sample_type

contains

  !> Begin without rows.
  pure subroutine begin(self, columns, expected, seed)
    class(kept_sample_type), intent(inout) :: self   !< the sample
    integer, intent(in) :: columns                   !< numbers of a row
    integer, intent(in) :: expected                  !< the most rows that will come
    integer, intent(in) :: seed                      !< of the study, not negative

    self%kept = 0
    self%seen = 0
    self%seed = seed
    if (allocated(self%rows)) deallocate (self%rows)
    allocate (self%rows(columns, min(expected, most_kept)))
  end subroutine begin

  !> Take the next row. Each row that came is in the sample with the same probability.
  pure subroutine take(self, row)
    class(kept_sample_type), intent(inout) :: self   !< the sample
    real(wp), intent(in) :: row(:)                   !< (columns) its numbers
    integer(long) :: words(2), place

    self%seen = self%seen + 1
    if (self%kept < size(self%rows, 2)) then
      self%kept = self%kept + 1
      self%rows(:, self%kept) = row
      return
    end if
    call philox([apart, int(self%seen, long)], int(self%seed, long), words)
    ! 31 bits times a number of runs fit in a long integer
    place = 1 + shiftr(shiftr(words(1), 1)*self%seen, 31)
    if (place <= self%kept) self%rows(:, place) = row
  end subroutine take
end module mech9_kept_sample
