!> The rates that a mechanism allows in its home position, worked out from the axes alone: the oracle for ranks, choices of
!> independent coordinates and rates.
!>
!> Twists are written in the fixed frame, moments about its origin. Along a tree of links each twist is
!> the sum of the screws on the way; each pair outside the tree asks that the twists at its two links
!> differ by its own screw.
module mech9_home_motions
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_random, only: random_type
  use mech9_mechanism_families, only: axis_type
  implicit none
  private
  public :: loop_equations, choose_dependent, rates_from

  !> The rest of a column in elimination counts as nothing below this: the entries are of order one,
  !> and elimination with pivots taken as they come multiplies round-off by some thousands.
  real(wp), parameter :: nothing = 1.0e-9_wp

contains

  !> Rows that vanish for the rates that keep all loops closed: (6 loops, M).
  subroutine loop_equations(n_links, links, axes, equations)
    integer, intent(in) :: n_links                          !< links, the frame included
    integer, intent(in) :: links(:, :)                      !< (2,M) reference and moving link of each pair
    type(axis_type), intent(in) :: axes(:)                  !< of each pair in the home position
    real(wp), allocatable, intent(out) :: equations(:, :)   !< (6 loops,M) that the rates satisfy
    real(wp), allocatable :: twist(:, :, :)
    real(wp) :: screw(6)
    logical :: known(n_links), used(size(axes))
    integer :: k, m, row, from, to

    m = size(axes)
    allocate (twist(6, m, n_links), equations(6*(m - n_links + 1), m), source=0.0_wp)
    known = .false.
    known(1) = .true.
    used = .false.
    do while (.not. all(known))
      do k = 1, m
        if (known(links(1, k)) .eqv. known(links(2, k))) cycle
        from = merge(links(1, k), links(2, k), known(links(1, k)))
        to = links(1, k) + links(2, k) - from
        twist(:, :, to) = twist(:, :, from)
        twist(:, k, to) = twist(:, k, to) + merge(1.0_wp, -1.0_wp, from == links(1, k))*screw_of(axes(k))
        known(to) = .true.
        used(k) = .true.
      end do
    end do
    row = 0
    do k = 1, m
      if (used(k)) cycle
      screw = screw_of(axes(k))
      equations(row + 1:row + 6, :) = twist(:, :, links(2, k)) - twist(:, :, links(1, k))
      equations(row + 1:row + 6, k) = equations(row + 1:row + 6, k) - screw
      row = row + 6
    end do
  end subroutine loop_equations

  pure function screw_of(axis) result(screw)
    type(axis_type), intent(in) :: axis   !< of a pair
    real(wp) :: screw(6), e(3)

    e = axis%along/norm2(axis%along)
    screw = [e, cross(axis%point, e)]
    if (axis%slides) screw = [0.0_wp, 0.0_wp, 0.0_wp, e]
  end function screw_of

  !> Dependent coordinates by elimination with the largest entry as pivot: as many as the rank. Weights
  !> drawn at random make the choice a random one among good ones.
  subroutine choose_dependent(equations, random, dependent)
    real(wp), intent(in) :: equations(:, :)      !< (6 loops,M) that the rates satisfy
    type(random_type), intent(inout) :: random   !< source of the random numbers
    logical, intent(out) :: dependent(:)         !< (M) coordinates that follow from the others
    real(wp) :: a(size(equations, 1), size(equations, 2)), weight(size(equations, 2))
    logical :: row_free(size(equations, 1))
    integer :: i, k, at(2)

    a = equations
    do k = 1, size(weight)
      weight(k) = 1.0_wp + random%symmetric()**2
    end do
    dependent = .false.
    row_free = .true.
    do
      at = maxloc(abs(a)*spread(weight, 1, size(a, 1)), spread(row_free, 2, size(a, 2)) .and. &
                  spread(.not. dependent, 1, size(a, 1)))
      if (any(at == 0)) exit
      if (abs(a(at(1), at(2))) < nothing) exit
      dependent(at(2)) = .true.
      row_free(at(1)) = .false.
      do i = 1, size(a, 1)
        if (row_free(i)) a(i, :) = a(i, :) - a(i, at(2))/a(at(1), at(2))*a(at(1), :)
      end do
    end do
  end subroutine choose_dependent

  !> All rates from those of the independent coordinates, by Gauss-Jordan elimination; `residual_norm` is the
  !> largest part of an equation that stays.
  subroutine rates_from(equations, dependent, rates, residual_norm)
    real(wp), intent(in) :: equations(:, :)   !< (6 loops,M) that the rates satisfy
    logical, intent(in) :: dependent(:)       !< (M) coordinates that follow from the others
    real(wp), intent(inout) :: rates(:)       !< on entry those of the independent coordinates
    real(wp), intent(out) :: residual_norm    !< largest remainder of an equation
    real(wp) :: a(size(equations, 1), size(equations, 2)), right(size(equations, 1))
    logical :: row_free(size(equations, 1))
    integer :: pivot_row(size(dependent)), i, at(2)

    where (dependent) rates = 0.0_wp
    right = -matmul(equations, rates)
    a = equations
    row_free = .true.
    pivot_row = 0
    do
      at = maxloc(abs(a), spread(row_free, 2, size(a, 2)) .and. &
                  spread(dependent .and. pivot_row == 0, 1, size(a, 1)))
      if (any(at == 0)) exit
      pivot_row(at(2)) = at(1)
      row_free(at(1)) = .false.
      do i = 1, size(a, 1)
        if (i == at(1)) cycle
        right(i) = right(i) - a(i, at(2))/a(at(1), at(2))*right(at(1))
        a(i, :) = a(i, :) - a(i, at(2))/a(at(1), at(2))*a(at(1), :)
      end do
    end do
    do i = 1, size(dependent)
      if (pivot_row(i) > 0) rates(i) = right(pivot_row(i))/a(pivot_row(i), i)
    end do
    residual_norm = maxval(abs(matmul(equations, rates)))
  end subroutine rates_from
end module mech9_home_motions
