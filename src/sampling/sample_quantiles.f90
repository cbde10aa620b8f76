!> Quantiles of a sample, with their standard errors.
module mech9_sample_quantiles
  use mech9_kinds, only: wp
  implicit none
  private
  public :: sample_quantile, sort_numbers

contains

  !> The number that a share p of a sample does not exceed, linear between neighbours, and its standard error: half of the distance
  !> between the numbers that stand one deviation of the rank before and behind it, whatever the distribution is. Where the sample
  !> does not reach as far, the error is not known.
  pure subroutine sample_quantile(sorted, p, quantile, error, known)
    real(wp), intent(in) :: sorted(:)    !< the sample in ascending order, at least one number
    real(wp), intent(in) :: p            !< from 0 to 1
    real(wp), intent(out) :: quantile    !< the quantile
    real(wp), intent(out) :: error       !< its standard error for numbers that are drawn independently; 0 where it is not known
    logical, intent(out) :: known        !< the error is known
    real(wp) :: n, rank, step

    n = size(sorted)
    rank = 1.0_wp + (n - 1.0_wp)*p
    step = sqrt(n*p*(1.0_wp - p))
    quantile = between(sorted, rank)
    error = 0.0_wp
    known = rank - step >= 1.0_wp .and. rank + step <= n .and. step > 0.0_wp
    if (known) error = 0.5_wp*(between(sorted, rank + step) - between(sorted, rank - step))
  end subroutine sample_quantile

  !> The number at a rank that need not be whole.
  pure real(wp) function between(sorted, rank) result(number)
    real(wp), intent(in) :: sorted(:)   !< in ascending order
    real(wp), intent(in) :: rank        !< 1 to their number
    integer :: i

    i = max(1, min(int(rank), size(sorted)))
    number = sorted(i)
    if (i < size(sorted)) number = number + (rank - i)*(sorted(i + 1) - sorted(i))
  end function between

  !> Sort numbers by the method of the heap, in place.
  pure subroutine sort_numbers(numbers)
    real(wp), intent(inout) :: numbers(:)   !< in ascending order afterwards
    real(wp) :: greatest
    integer :: i, n

    n = size(numbers)
    do i = n/2, 1, -1
      call sink(numbers, i, n)
    end do
    do i = n, 2, -1
      greatest = numbers(1)
      numbers(1) = numbers(i)
      numbers(i) = greatest
      call sink(numbers, 1, i - 1)
    end do
  end subroutine sort_numbers

  !> Let a number sink in a heap until none below it is greater.
  pure subroutine sink(heap, place, last)
    real(wp), intent(inout) :: heap(:)   !< a heap from place + 1 on
    integer, intent(in) :: place         !< of the number
    integer, intent(in) :: last          !< place of the last number of the heap
    real(wp) :: number
    integer :: i, below

    number = heap(place)
    i = place
    do
      below = 2*i
      if (below > last) exit
      if (below < last) then
        if (heap(below + 1) > heap(below)) below = below + 1
      end if
      if (.not. heap(below) > number) exit
      heap(i) = heap(below)
      i = below
    end do
    heap(i) = number
  end subroutine sink
end module mech9_sample_quantiles
