!> Figures of studies: counts, means and deviations against those of numbers that are added up directly.
module test_study_figures
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_study_figures, only: histogram_type, effect_type, map_type, find_histogram, find_effect, find_map
  use mech9_checks, only: near_vector
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: tol = 1.0e-13_wp   ! sums of some hundred numbers of order one

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('few_values')) call few_values(tester)
    if (tester%runs('many_values')) call many_values(tester)
    if (tester%runs('effects')) call effects(tester)
    if (tester%runs('groups')) call groups(tester)
    if (tester%runs('maps')) call maps(tester)
  end subroutine run

  !> A few values at equal distances have a bar each, and so have those that differ by round-off.
  subroutine few_values(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(histogram_type) :: h

    call find_histogram([2.0_wp, 1.0_wp, 3.0_wp, 2.0_wp, 2.0_wp + 4.0_wp*epsilon(1.0_wp)], h)
    call tester%is_true(size(h%counts) == 3, 'three bars')
    if (size(h%counts) == 3) call tester%is_true(all(h%counts == [1, 3, 1]), 'runs in each')
    call near_vector(tester, h%edges, [0.5_wp, 1.5_wp, 2.5_wp, 3.5_wp], tol, 'bars stand about their values')
    call find_histogram([5.0_wp, 5.0_wp], h)
    call tester%is_true(size(h%counts) == 1 .and. h%counts(1) == 2, 'equal numbers have one bar')
    call tester%is_true(h%edges(1) < 5.0_wp .and. h%edges(2) > 5.0_wp, 'which has a width')
    call find_histogram([0.0_wp], h)
    call tester%is_true(h%edges(1) < 0.0_wp .and. h%edges(2) > 0.0_wp, 'so has that of zero')
  end subroutine few_values

  !> Each number is in the bar whose edges are around it.
  subroutine many_values(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(random_type) :: random
    type(histogram_type) :: h
    real(wp) :: x(1000)
    logical :: right
    integer :: i, n

    do i = 1, size(x)
      x(i) = random%symmetric()**3
    end do
    call find_histogram(x, h)
    n = size(h%counts)
    call tester%is_true(sum(h%counts) == size(x) .and. n <= 80 .and. n >= 11, 'all numbers are in bars')
    call tester%is_true(all(h%edges(2:) > h%edges(:n)), 'edges ascend')
    call near_vector(tester, h%edges([1, n + 1]), [minval(x), maxval(x)], 0.0_wp, 'from the least to the greatest')
    right = h%counts(1) == count(x <= h%edges(2))
    do i = 2, n
      right = right .and. h%counts(i) == count(x > h%edges(i) .and. x <= h%edges(i + 1))
    end do
    call tester%is_true(right, 'counts are those of the edges')
  end subroutine many_values

  !> Means and deviations at each value.
  subroutine effects(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(effect_type) :: effect

    call find_effect([2.0_wp, 1.0_wp, 2.0_wp, 1.0_wp, 2.0_wp], [1.0_wp, 5.0_wp, 2.0_wp, 7.0_wp, 3.0_wp], effect)
    call near_vector(tester, effect%x, [1.0_wp, 2.0_wp], tol, 'values')
    call near_vector(tester, effect%mean, [6.0_wp, 2.0_wp], tol, 'means')
    call near_vector(tester, effect%deviation, [sqrt(2.0_wp), 1.0_wp], tol, 'deviations')
  end subroutine effects

  !> Many values are taken in groups of equally many runs; the means of a line lie on the line.
  subroutine groups(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(effect_type) :: effect
    real(wp) :: x(400)
    integer :: i

    x = [(modulo(7*i, 400)/400.0_wp, i=1, 400)]
    call find_effect(x, 3.0_wp*x - 1.0_wp, effect)
    call tester%is_true(size(effect%x) == 20, 'twenty groups')
    call near_vector(tester, effect%mean, 3.0_wp*effect%x - 1.0_wp, tol, 'means lie on the line')
    call near_vector(tester, effect%x, [((i - 0.5_wp)/20.0_wp - 0.5_wp/400.0_wp, i=1, 20)], tol, 'groups have equally many runs')
  end subroutine groups

  !> The sums of a map are those of its rectangles.
  subroutine maps(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(map_type) :: map

    call find_map([1.0_wp, 2.0_wp, 1.0_wp, 2.0_wp, 2.0_wp], [10.0_wp, 10.0_wp, 30.0_wp, 30.0_wp, 30.0_wp], &
                  [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp], map)
    call tester%is_true(all(shape(map%counts) == [2, 2]), 'two by two rectangles')
    call tester%is_true(all(map%counts == reshape([1, 1, 1, 2], [2, 2])), 'runs in each')
    call near_vector(tester, [map%sums], [1.0_wp, 2.0_wp, 3.0_wp, 9.0_wp], tol, 'sums')
    call near_vector(tester, map%x_edges, [0.5_wp, 1.5_wp, 2.5_wp], tol, 'edges along x')
    call near_vector(tester, map%y_edges, [0.0_wp, 20.0_wp, 40.0_wp], tol, 'edges along y')
  end subroutine maps
end module test_study_figures
