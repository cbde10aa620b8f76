!> Comparison of two runs: the largest difference in each column.
module mech9_run_comparison
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_rows_text, only: head_of, letters_of
  use mech9_kept_rows, only: kept_rows_type
  implicit none
  private
  public :: difference_type, comparison_type, compare_runs, comparison_text

  !> The difference of two runs in one column.
  type :: difference_type
    integer :: column = 0            !< number of the column in the later run
    real(wp) :: difference = 0.0_wp  !< largest |later - earlier|, in the column's unit
    real(wp) :: time = 0.0_wp        !< time of the largest difference [s]
    real(wp) :: before = 0.0_wp, after = 0.0_wp
    real(wp) :: share = 0.0_wp  !< the difference over the largest absolute value of this unit in either run
  end type difference_type

  !> Two runs, at the times that they have in common.
  type :: comparison_type
    integer :: times = 0
    integer :: same = 0                               !< columns that do not differ at all
    integer :: alike = 0                              !< columns that differ by no more than round-off
    type(difference_type), allocatable :: columns(:)  !< columns that differ by more, the greatest share first
  end type comparison_type

  !> Output times that differ by less than this share are equal: they are computed from start, end and number, with round-off.
  real(wp), parameter :: same_time = 1.0e-12_wp
  !> Largest share that counts as round-off of computations in another order.
  real(wp), parameter :: round_off = 1.0e-12_wp
  !> Quantities below this in any unit count as zero, such as residuals; no moving quantity is so small.
  real(wp), parameter :: as_good_as_zero = 1.0e-10_wp
  !> Most lines of a comparison, so that it fits on a screen.
  integer, parameter :: most_lines = 15
  !> Width of the first column of a comparison, which most names fit.
  integer, parameter :: usual_width = 16
  character, parameter :: eol = achar(10)

contains

  !> Compare the columns that two runs have in common by name.
  pure subroutine compare_runs(earlier, later, comparison)
    type(kept_rows_type), intent(in) :: earlier       !< rows of the earlier run
    type(kept_rows_type), intent(in) :: later         !< rows of the later run
    type(comparison_type), intent(out) :: comparison  !< the differences
    integer :: pairs(2, min(earlier%count, later%count))
    type(difference_type) :: difference
    character(len=:), allocatable :: meant
    real(wp) :: greatest_before(size(earlier%names)), greatest_now(size(later%names)), greatest
    integer :: i, other

    allocate (comparison%columns(0))
    call pair_times(earlier, later, pairs, comparison%times)
    if (comparison%times == 0) return
    greatest_before = greatest_of_unit(earlier)
    greatest_now = greatest_of_unit(later)
    do i = 2, size(later%names)
      call earlier%column(later%names(i)%text, other, meant)
      if (other == 0) cycle
      difference = difference_in(earlier%rows(other, pairs(1, :comparison%times)), &
                                 later%rows(i, pairs(2, :comparison%times)), later%rows(1, pairs(2, :comparison%times)))
      difference%column = i
      greatest = max(greatest_before(other), greatest_now(i))
      if (greatest > 0.0_wp) difference%share = difference%difference/greatest
      if (difference%share > round_off .and. greatest > as_good_as_zero) then
        call insert(comparison%columns, difference)
      else if (difference%difference > 0.0_wp) then
        comparison%alike = comparison%alike + 1
      else
        comparison%same = comparison%same + 1
      end if
    end do
  end subroutine compare_runs

  !> The rows of the two runs at each common time.
  pure subroutine pair_times(earlier, later, pairs, n)
    type(kept_rows_type), intent(in) :: earlier  !< rows of the earlier run
    type(kept_rows_type), intent(in) :: later    !< rows of the later run
    integer, intent(inout) :: pairs(:, :)        !< (2,:) row of the earlier run and row of the later one
    integer, intent(out) :: n                    !< how many pairs there are
    real(wp) :: one, other
    integer :: i, j

    n = 0
    i = 1
    j = 1
    do while (i <= earlier%count .and. j <= later%count)
      one = earlier%rows(1, i)
      other = later%rows(1, j)
      if (abs(one - other) <= same_time*max(1.0_wp, abs(one))) then
        n = n + 1
        pairs(:, n) = [i, j]
        i = i + 1
        j = j + 1
      else if (one < other) then
        i = i + 1
      else
        j = j + 1
      end if
    end do
  end subroutine pair_times

  !> The largest difference of two columns, with its time and values.
  pure type(difference_type) function difference_in(before, after, times) result(difference)
    real(wp), intent(in) :: before(:)  !< the column in the earlier run, at the common times
    real(wp), intent(in) :: after(:)   !< the column in the later run, at the common times
    real(wp), intent(in) :: times(:)   !< the common times [s]
    integer :: i

    i = maxloc(abs(after - before), dim=1)
    difference%difference = abs(after(i) - before(i))
    difference%time = times(i)
    difference%before = before(i)
    difference%after = after(i)
  end function difference_in

  !> For each column the largest absolute value in all columns of its unit. A quantity that is zero except for round-off,
  !> such as the height of a planar motion, is small compared with it.
  pure function greatest_of_unit(kept) result(greatest)
    type(kept_rows_type), intent(in) :: kept  !< rows of a run
    real(wp) :: greatest(size(kept%names))
    real(wp) :: own(size(kept%names))
    integer :: i, k

    own = 0.0_wp
    do k = 1, kept%count
      own = max(own, abs(kept%rows(:, k)))
    end do
    do i = 1, size(own)
      greatest(i) = own(i)
      do k = 1, size(own)
        if (kept%units(k)%text == kept%units(i)%text) greatest(i) = max(greatest(i), own(k))
      end do
    end do
  end function greatest_of_unit

  !> Insert a difference into the sorted list.
  pure subroutine insert(list, difference)
    type(difference_type), allocatable, intent(inout) :: list(:)  !< differences, the greatest share first
    type(difference_type), intent(in) :: difference               !< the difference to insert
    integer :: place

    place = count(list%share >= difference%share)
    list = [list(:place), difference, list(place + 1:)]
  end subroutine insert

  !> A comparison in words, as whole lines of at most 79 letters unless names are long.
  pure function comparison_text(comparison, later) result(text)
    type(comparison_type), intent(in) :: comparison  !< the differences
    type(kept_rows_type), intent(in) :: later        !< rows of the later run
    character(len=:), allocatable :: text, head
    character(len=63) :: line
    integer :: i, alike, shown, width

    if (comparison%times == 0) then
      text = 'The two runs have no time in common.'//eol
      return
    end if
    text = 'Compared at '//counted(comparison%times, 'common time')//': '
    if (size(comparison%columns) == 0) then
      text = text//'all columns are the same, '
      if (comparison%alike == 0) text = text//'to the last bit.'//eol
      if (comparison%alike > 0) text = text//'but for round-off.'//eol
      return
    end if
    alike = comparison%same + comparison%alike
    text = text//counted(size(comparison%columns), 'column')//trim(merge(' differs', ' differ ', size(comparison%columns) == 1))// &
           ', '//to_text(alike)//trim(merge(' does', ' do  ', alike == 1))//' not.'//eol
    shown = min(size(comparison%columns), most_lines)
    width = usual_width
    do i = 1, shown
      width = max(width, letters_of(head_of(later, comparison%columns(i)%column)))
    end do
    write (line, '(5a12)') 'difference', 'of largest', 'at t [s]', 'before', 'now'
    text = text//repeat(' ', width - len('column'))//'column'//trim(line)//eol
    do i = 1, shown
      associate (column => comparison%columns(i))
        head = head_of(later, column%column)
        write (line, '(5a12)') to_text(column%difference, 4), to_text(100.0_wp*column%share, 3)//' %', to_text(column%time, 5), &
          to_text(column%before, 5), to_text(column%after, 5)
      end associate
      text = text//repeat(' ', width - letters_of(head))//head//trim(line)//eol
    end do
    if (size(comparison%columns) > most_lines) &
      text = text//'and '//counted(size(comparison%columns) - most_lines, 'column')//' with smaller differences.'//eol
  end function comparison_text
end module mech9_run_comparison
