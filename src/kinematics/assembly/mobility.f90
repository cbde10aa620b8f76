!> The motions that the chains of a mechanism allow, and the coordinates that can describe them.
module mech9_mobility
  use mech9_kinds, only: wp
  use mech9_tolerances, only: least_rate, rank_tolerance_for
  use mech9_lapack, only: dgesvd
  use mech9_least_squares, only: least_squares_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_generic_position, only: free_block
  use mech9_block_equations, only: block_jacobian
  implicit none
  private
  public :: find_motions, choose_coordinates, shares_of


contains

  !> All rates that keep the chains closed at a closed position whose frames are placed: an orthonormal basis with a column for
  !> each freedom, in the units of the coordinates.
  subroutine find_motions(plan, state, held, motions)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    logical, intent(in) :: held(:)   !< (M) the coordinate is known not to move
    real(wp), allocatable, intent(out) :: motions(:, :)    !< (M, mobility)
    type(block_type) :: block
    real(wp), allocatable :: a(:, :), vt(:, :), s(:), work(:)
    integer, allocatable :: column_of(:)
    integer :: i, k, m, n, rank, info
    real(wp) :: u(1, 1)

    block = free_block(plan, plan%n_coordinates, size(plan%closures))
    allocate (column_of(plan%n_coordinates), source=0)
    n = 0
    do i = 1, plan%n_coordinates
      if (held(plan%steps(i)%coordinate)) cycle
      n = n + 1
      column_of(i) = n
    end do
    m = max(block%equations, 1)
    allocate (a(m, n), vt(n, n), s(min(m, n)), work(16*(m + n) + 64), source=0.0_wp)
    rank = 0
    if (n > 0) then
      if (block%equations > 0) call block_jacobian(plan, block, state, column_of, a)
      call dgesvd('N', 'A', m, n, a, m, s, u, 1, vt, n, work, size(work), info)
      rank = count(s > rank_tolerance_for(plan%data_tolerance)*max(s(1), tiny(s)))
    end if
    allocate (motions(plan%n_coordinates, n - rank), source=0.0_wp)
    do i = 1, plan%n_coordinates
      k = plan%steps(i)%coordinate
      if (column_of(i) > 0) motions(k, :) = vt(rank + 1:, column_of(i))
    end do
  end subroutine find_motions

  !> Choose as many coordinates as there are freedoms, whose rates determine all rates: the wanted ones as far as they are
  !> independent of each other, then others with large rates.
  pure subroutine choose_coordinates(motions, wanted, chosen)
    real(wp), intent(in) :: motions(:, :)   !< (M, mobility) orthonormal basis of the rates, in the units of the coordinates
    logical, intent(in) :: wanted(:)   !< (M) the coordinate should be independent
    logical, intent(out) :: chosen(:)   !< (M) the coordinate is chosen as independent
    real(wp) :: rest(size(motions, 1), size(motions, 2)), e(size(motions, 2)), lengths(size(wanted))
    logical :: may(size(wanted))
    integer :: k, best, stage

    rest = motions
    chosen = .false.
    do stage = 1, 2
      do while (count(chosen) < size(motions, 2))
        may = .not. chosen .and. (wanted .or. stage == 2)
        lengths = [(norm2(rest(k, :)), k=1, size(wanted))]
        if (maxval(lengths, may) <= least_rate) exit
        ! the first of those with nearly the largest rate
        best = findloc(may .and. lengths >= 0.3_wp*maxval(lengths, may), .true., dim=1)
        chosen(best) = .true.
        e = rest(best, :)/lengths(best)
        do k = 1, size(wanted)
          rest(k, :) = rest(k, :) - dot_product(rest(k, :), e)*e
        end do
      end do
    end do
  end subroutine choose_coordinates

  !> The rate of each coordinate per unit rate of each chosen coordinate; these must determine all others, and have the columns
  !> in ascending order.
  subroutine shares_of(motions, chosen, shares)
    real(wp), intent(in) :: motions(:, :)   !< (M, mobility) orthonormal basis of the rates, in the units of the coordinates
    logical, intent(in) :: chosen(:)   !< (M) the coordinate is independent
    real(wp), allocatable, intent(out) :: shares(:, :)   !< (M, mobility) rate of each coordinate per unit rate of each chosen one
    type(least_squares_type) :: equations
    real(wp) :: right(size(motions, 2))
    integer :: i, k, f

    f = size(motions, 2)
    allocate (shares(size(motions, 1), f))
    call equations%create(f, f)
    i = 0
    do k = 1, size(chosen)
      if (.not. chosen(k)) cycle
      i = i + 1
      equations%a(:, i) = motions(k, :)
    end do
    call equations%factorize()
    do k = 1, size(motions, 1)
      right = motions(k, :)
      call equations%solve(right, shares(k, :))
    end do
  end subroutine shares_of
end module mech9_mobility
