!> Figures of a study: the counts of a histogram, the mean of a quantity over a parameter, and its means over two parameters.
module mech9_study_figures
  use mech9_kinds, only: wp
  use mech9_sample_quantiles, only: sort_numbers
  implicit none
  private
  public :: histogram_type, effect_type, map_type, find_histogram, find_effect, find_map

  integer, parameter :: most_bars = 80     !< of a histogram
  integer, parameter :: most_alone = 20    !< values that have a bar each
  integer, parameter :: most_values = 60   !< of a parameter that are shown one by one
  integer, parameter :: most_groups = 20   !< of equally many runs, where a parameter has more values
  integer, parameter :: in_group = 10      !< runs in a group, at least
  integer, parameter :: most_cells = 24    !< along each side of a map, where a parameter has more values
  integer, parameter :: in_cell = 4        !< runs in a cell, on average

  !> The numbers of runs in intervals.
  type :: histogram_type
    real(wp), allocatable :: edges(:)      !< (bars+1) of the bars, ascending
    integer, allocatable :: counts(:)      !< (bars) runs in each
  end type histogram_type

  !> The mean of one number over another one.
  type :: effect_type
    real(wp), allocatable :: x(:)          !< (groups) mean of the first number in each group of runs, ascending
    real(wp), allocatable :: mean(:)       !< (groups) mean of the second number
    real(wp), allocatable :: deviation(:)  !< (groups) its standard deviation within the group
  end type effect_type

  !> The means of one number over two others, in rectangles.
  type :: map_type
    real(wp), allocatable :: x_edges(:)    !< (columns+1) ascending
    real(wp), allocatable :: y_edges(:)    !< (rows+1) ascending
    real(wp), allocatable :: sums(:, :)    !< (columns,rows) sum of the number over the runs in a rectangle
    integer, allocatable :: counts(:, :)   !< (columns,rows) runs in a rectangle
  end type map_type

contains

  !> Form the histogram of numbers. The width of its bars follows from the distance of the quartiles (D. Freedman and P.
  !> Diaconis, "On the histogram as a density estimator", Zeitschrift für Wahrscheinlichkeitstheorie 57, 453-476, 1981).
  !> A few values at equal distances have a bar each.
  pure subroutine find_histogram(numbers, histogram)
    real(wp), intent(in) :: numbers(:)                 !< at least one
    type(histogram_type), intent(out) :: histogram     !< of them
    real(wp), allocatable :: values(:)
    real(wp) :: sorted(size(numbers)), span, width
    integer :: n, bars, i

    call find_values(numbers, values)
    if (size(values) <= most_alone .and. are_even(values)) then
      call find_edges(numbers, histogram%edges)
    else
      sorted = numbers
      call sort_numbers(sorted)
      n = size(sorted)
      span = sorted(n) - sorted(1)
      width = 2.0_wp*(sorted(1 + (3*(n - 1))/4) - sorted(1 + (n - 1)/4))/real(n, wp)**(1.0_wp/3.0_wp)
      ! at least as many as Sturges' rule gives; where the quartiles are nearly equal, as many as there can be
      bars = ceiling(1.0_wp + log(real(n, wp))/log(2.0_wp))
      bars = max(bars, min(most_bars, n/5, ceiling(span/max(width, span/most_bars))))
      histogram%edges = [(sorted(1) + span*i/bars, i=0, bars)]
      histogram%edges(bars + 1) = sorted(n)
    end if
    allocate (histogram%counts(size(histogram%edges) - 1), source=0)
    do i = 1, size(numbers)
      associate (bar => first_not_below(histogram%edges(2:), numbers(i)))
        histogram%counts(bar) = histogram%counts(bar) + 1
      end associate
    end do
  end subroutine find_histogram

  !> Whether numbers have about equal distances.
  pure logical function are_even(values)
    real(wp), intent(in) :: values(:)   !< ascending, at least one
    real(wp) :: distances(size(values) - 1)

    distances = values(2:) - values(:size(values) - 1)
    are_even = size(distances) == 0
    if (.not. are_even) are_even = maxval(distances) < 1.5_wp*minval(distances)
  end function are_even

  !> Whether two numbers differ by more than round-off.
  pure logical function is_resolved(low, high)
    real(wp), intent(in) :: low    !< the smaller one
    real(wp), intent(in) :: high   !< the larger one

    is_resolved = high - low > 1e3_wp*epsilon(low)*max(abs(low), abs(high))
  end function is_resolved

  !> Compute the mean and the deviation of numbers over others: for each value of these if they are few, else in groups
  !> of equal size.
  pure subroutine find_effect(x, y, effect)
    real(wp), intent(in) :: x(:)               !< (runs) at least one
    real(wp), intent(in) :: y(:)               !< (runs)
    type(effect_type), intent(out) :: effect   !< y over x
    real(wp), allocatable :: last(:)
    integer, allocatable :: counts(:)
    real(wp) :: step
    integer :: i, k, n

    call find_last_of_groups(x, last)
    n = size(last)
    allocate (effect%x(n), effect%mean(n), effect%deviation(n), source=0.0_wp)
    allocate (counts(n), source=0)
    do i = 1, size(x)
      k = first_not_below(last, x(i))
      counts(k) = counts(k) + 1
      effect%x(k) = effect%x(k) + (x(i) - effect%x(k))/counts(k)
      step = y(i) - effect%mean(k)
      effect%mean(k) = effect%mean(k) + step/counts(k)
      effect%deviation(k) = effect%deviation(k) + step*(y(i) - effect%mean(k))
    end do
    effect%deviation = sqrt(effect%deviation/max(1, counts - 1))
  end subroutine find_effect

  !> Find the greatest number of each group.
  pure subroutine find_last_of_groups(x, last)
    real(wp), intent(in) :: x(:)                       !< (runs) at least one
    real(wp), allocatable, intent(out) :: last(:)      !< (groups) ascending
    real(wp), allocatable :: values(:)
    real(wp) :: sorted(size(x))
    integer :: i, n

    call find_values(x, values)
    if (size(values) <= most_values) then
      last = values
      return
    end if
    sorted = x
    call sort_numbers(sorted)
    n = max(1, min(most_groups, size(x)/in_group))
    call find_values([(sorted(ceiling(real(i, wp)*size(x)/n)), i=1, n)], last)
  end subroutine find_last_of_groups

  !> List the different ones of some numbers, ascending. Numbers that differ by round-off are one, its greatest.
  pure subroutine find_values(x, values)
    real(wp), intent(in) :: x(:)                       !< at least one
    real(wp), allocatable, intent(out) :: values(:)    !< of them
    real(wp) :: sorted(size(x)), least
    integer :: i, n

    sorted = x
    call sort_numbers(sorted)
    n = 1
    least = sorted(1)
    do i = 2, size(sorted)
      if (is_resolved(least, sorted(i))) then
        n = n + 1
        least = sorted(i)
      end if
      sorted(n) = sorted(i)
    end do
    values = sorted(:n)
  end subroutine find_values

  !> The place of the first number that is not less than another one.
  pure integer function first_not_below(ascending, number) result(place)
    real(wp), intent(in) :: ascending(:)   !< numbers, of which the last is not less
    real(wp), intent(in) :: number         !< the number
    integer :: low, middle

    low = 1
    place = size(ascending)
    do while (low < place)
      middle = (low + place)/2
      if (ascending(middle) < number) then
        low = middle + 1
      else
        place = middle
      end if
    end do
  end function first_not_below

  !> Compute the means of numbers over two others: for each pair of values where these have few, else in equal
  !> rectangles.
  pure subroutine find_map(x, y, z, map)
    real(wp), intent(in) :: x(:)         !< (runs) at least one
    real(wp), intent(in) :: y(:)         !< (runs)
    real(wp), intent(in) :: z(:)         !< (runs)
    type(map_type), intent(out) :: map   !< z over x and y
    integer :: i, column, row

    call find_edges(x, map%x_edges)
    call find_edges(y, map%y_edges)
    allocate (map%sums(size(map%x_edges) - 1, size(map%y_edges) - 1), source=0.0_wp)
    allocate (map%counts(size(map%x_edges) - 1, size(map%y_edges) - 1), source=0)
    do i = 1, size(x)
      column = first_not_below(map%x_edges(2:), x(i))
      row = first_not_below(map%y_edges(2:), y(i))
      map%sums(column, row) = map%sums(column, row) + z(i)
      map%counts(column, row) = map%counts(column, row) + 1
    end do
  end subroutine find_map

  !> Choose the edges of intervals that hold numbers: one interval about each value where there are few, else equal
  !> ones.
  pure subroutine find_edges(x, edges)
    real(wp), intent(in) :: x(:)                       !< at least one
    real(wp), allocatable, intent(out) :: edges(:)     !< (intervals+1) ascending
    real(wp), allocatable :: values(:)
    real(wp) :: half
    integer :: i, n, cells

    call find_values(x, values)
    n = size(values)
    if (n > most_values) then
      cells = max(1, min(most_cells, int(sqrt(real(size(x), wp)/in_cell))))
      edges = [(values(1) + (values(n) - values(1))*i/cells, i=0, cells)]
      edges(cells + 1) = values(n)
      return
    end if
    allocate (edges(n + 1))
    edges(2:n) = 0.5_wp*(values(:n - 1) + values(2:))
    half = 0.5_wp*max(abs(values(1)), tiny(half)/epsilon(half))
    if (n > 1) half = 0.5_wp*(values(2) - values(1))
    edges(1) = values(1) - half
    if (n > 1) half = 0.5_wp*(values(n) - values(n - 1))
    edges(n + 1) = values(n) + half
  end subroutine find_edges
end module mech9_study_figures
