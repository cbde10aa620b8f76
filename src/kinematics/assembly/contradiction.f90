!> Least sets of couplings and closed chains that hold coordinates in place, that no values of the coordinates fulfil together, or
!> of which one follows from the others.
!>
!> Such a fault stays when further closures are added. A least set is therefore found by leaving out closures, many at once
!> and then one by one, as long as the fault remains.
module mech9_contradiction
  use mech9_kinds, only: wp
  use mech9_tolerances, only: least_rate, rank_tolerance_for
  use mech9_assembly_tolerances, only: part_open
  use mech9_failure, only: failure_type
  use mech9_lapack, only: dgesvd
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_generic_position, only: free_block
  use mech9_block_equations, only: block_jacobian, block_residual
  implicit none
  private
  public :: find_holding, find_unfulfilled, find_repeating, name_closures

  !> The equations of all closures at a position.
  type :: equations_type
    real(wp), allocatable :: a(:, :)          !< (equations,M) derivatives by the coordinates, in units of these
    real(wp), allocatable :: residual(:)      !< (equations) at the position
    integer, allocatable :: closure(:)        !< (equations) to which each belongs
    real(wp) :: tolerance = 0.0_wp            !< part of the largest singular value that counts as zero
    logical, allocatable :: held(:)           !< (M) the coordinate cannot move; the couplings are the cause
    real(wp) :: open = 0.0_wp                 !< residual that counts as open [rad, lengths of the mechanism]
    integer :: last = 0                       !< closure that follows from others
  end type equations_type

  abstract interface
    !> Whether some of the closures have a fault together.
    logical function fault_interface(equations, chosen)
      import :: equations_type
      type(equations_type), intent(in) :: equations   !< of all closures
      logical, intent(in) :: chosen(:)                !< (closures)
    end function fault_interface
  end interface

contains

  !> A least set of closures that hold a coordinate in place, which could move without couplings. Empty where there is none.
  subroutine find_holding(plan, state, idle, set)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(state_type), intent(in) :: state           !< a closed position whose frames are placed
    logical, intent(in) :: idle(:)                  !< (M) the coordinate cannot move
    integer, allocatable, intent(out) :: set(:)     !< numbers of the closures, ascending
    type(equations_type) :: equations
    real(wp), allocatable :: rates(:, :)
    logical :: chains(size(plan%closures))
    integer :: k

    call form_equations(plan, state, equations)
    chains = plan%closures%coupling == 0
    call find_null_space(rows_of(equations, chains), equations%tolerance, rates)
    equations%held = idle .and. [(norm2(rates(k, :)) > least_rate, k=1, size(idle))]
    call reduce(plan, equations, holds, set)
  end subroutine find_holding

  !> A least set of closures that no coordinates near a position of least residual fulfil together. Empty where there is none.
  subroutine find_unfulfilled(plan, state, set)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(state_type), intent(in) :: state           !< the position, whose frames are placed
    integer, allocatable, intent(out) :: set(:)     !< numbers of the closures, ascending
    type(equations_type) :: equations

    call form_equations(plan, state, equations)
    equations%open = part_open*norm2(equations%residual)
    call reduce(plan, equations, stays_open, set)
  end subroutine find_unfulfilled

  !> A least set of closures from which another one follows, itself included. Empty where it does not follow from those before it.
  subroutine find_repeating(plan, state, last, set)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    type(state_type), intent(in) :: state           !< a closed position whose frames are placed
    integer, intent(in) :: last                     !< number of the closure
    integer, allocatable, intent(out) :: set(:)     !< numbers of the closures, ascending
    type(equations_type) :: equations

    call form_equations(plan, state, equations)
    equations%last = last
    call reduce(plan, equations, follows, set)
  end subroutine find_repeating

  !> Put closures into a failure: closed chains and couplings, with the lines of the latter.
  pure subroutine name_closures(plan, set, failure)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    integer, intent(in) :: set(:)                   !< numbers of the closures
    type(failure_type), intent(inout) :: failure    !< gets `chains` and `lines`
    integer :: i

    failure%chains = plan%closures(set)%chain
    allocate (failure%lines(size(set)), source=0)
    do i = 1, size(set)
      associate (number => plan%closures(set(i))%coupling)
        if (number == 0) cycle
        if (plan%couplings(number)%coupling%place%source == 1) failure%lines(i) = plan%couplings(number)%coupling%place%line
      end associate
    end do
  end subroutine name_closures

  !> The equations of all closures, with all coordinates unknown.
  subroutine form_equations(plan, state, equations)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(state_type), intent(in) :: state              !< the position
    type(equations_type), intent(out) :: equations     !< its equations
    type(block_type) :: block
    integer, allocatable :: columns(:)
    integer :: c, n

    block = free_block(plan, plan%n_coordinates, size(plan%closures))
    allocate (equations%a(block%equations, plan%n_coordinates), equations%residual(block%equations), source=0.0_wp)
    columns = plan%steps%coordinate
    call block_jacobian(plan, block, state, columns, equations%a)
    call block_residual(plan, block, state, equations%residual)
    equations%tolerance = rank_tolerance_for(plan%data_tolerance)
    allocate (equations%closure(block%equations), source=0)
    n = 0
    do c = 1, size(plan%closures)
      equations%closure(n + 1:n + plan%closures(c)%rank) = c
      n = n + plan%closures(c)%rank
    end do
  end subroutine form_equations

  !> A least set of closures with a fault: closed chains are left out first, then couplings from the last one to the first.
  subroutine reduce(plan, equations, has_fault, set)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism
    type(equations_type), intent(in) :: equations        !< of all closures
    procedure(fault_interface) :: has_fault              !< judges some of the closures
    integer, allocatable, intent(out) :: set(:)          !< numbers of the closures, ascending; empty: there is no fault
    logical, dimension(size(plan%closures)) :: kept, fewer
    integer :: order(size(kept)), c, at_once, first, n

    n = size(kept)
    kept = .true.
    if (.not. has_fault(equations, kept)) kept = .false.
    order = [pack([(c, c=1, n)], plan%closures%coupling == 0), pack([(c, c=n, 1, -1)], plan%closures(n:1:-1)%coupling > 0)]
    at_once = n
    do while (at_once > 0)
      do first = 1, n, at_once
        fewer = kept
        fewer(order(first:min(n, first + at_once - 1))) = .false.
        if (count(fewer) == count(kept)) cycle
        if (has_fault(equations, fewer)) kept = fewer
      end do
      at_once = at_once/2
    end do
    set = pack([(c, c=1, n)], kept)
  end subroutine reduce

  !> Whether some closures hold a coordinate that should move.
  logical function holds(equations, chosen)
    type(equations_type), intent(in) :: equations   !< of all closures, with the coordinates
    logical, intent(in) :: chosen(:)                !< (closures)
    real(wp), allocatable :: rates(:, :)
    integer :: k

    call find_null_space(rows_of(equations, chosen), equations%tolerance, rates)
    holds = any(equations%held .and. [(norm2(rates(k, :)) <= least_rate, k=1, size(equations%held))])
  end function holds

  !> Whether no change of the coordinates fulfils the linear equations of some closures.
  logical function stays_open(equations, chosen)
    type(equations_type), intent(in) :: equations   !< of all closures, with their residual
    logical, intent(in) :: chosen(:)                !< (closures)
    real(wp), allocatable :: columns(:, :), combinations(:, :)

    columns = transpose(rows_of(equations, chosen))
    call find_null_space(columns, equations%tolerance, combinations)
    stays_open = norm2(matmul(pack(equations%residual, chosen(equations%closure)), combinations)) > equations%open
  end function stays_open

  !> Whether the equation of one closure follows from those of some others.
  logical function follows(equations, chosen)
    type(equations_type), intent(in) :: equations   !< of all closures
    logical, intent(in) :: chosen(:)                !< (closures)
    real(wp), allocatable :: with(:, :), without(:, :)
    logical :: some(size(chosen))

    some = chosen
    some(equations%last:) = .false.
    call find_null_space(rows_of(equations, some), equations%tolerance, without)
    some(equations%last) = chosen(equations%last)
    call find_null_space(rows_of(equations, some), equations%tolerance, with)
    follows = some(equations%last) .and. size(with, 2) == size(without, 2)
  end function follows

  !> The rows of some closures.
  pure function rows_of(equations, chosen) result(rows)
    type(equations_type), intent(in) :: equations   !< of all closures
    logical, intent(in) :: chosen(:)                !< (closures)
    real(wp), allocatable :: rows(:, :)
    integer :: i

    rows = equations%a(pack([(i, i=1, size(equations%closure))], chosen(equations%closure)), :)
  end function rows_of

  !> An orthonormal basis of the vectors that a matrix makes zero.
  subroutine find_null_space(a, tolerance, basis)
    real(wp), intent(in) :: a(:, :)                       !< (m,n)
    real(wp), intent(in) :: tolerance                     !< part of the largest singular value that counts as zero
    real(wp), allocatable, intent(out) :: basis(:, :)     !< (n,n - rank)
    real(wp) :: copy(max(1, size(a, 1)), size(a, 2)), vt(size(a, 2), size(a, 2)), s(max(1, minval(shape(a)))), u(1, 1)
    real(wp) :: work(16*(size(copy, 1) + size(copy, 2)) + 64)
    integer :: n, rank, info

    n = size(a, 2)
    copy = 0.0_wp
    copy(:size(a, 1), :) = a
    s = 0.0_wp
    vt = 0.0_wp
    if (n > 0) call dgesvd('N', 'A', size(copy, 1), n, copy, size(copy, 1), s, u, 1, vt, n, work, size(work), info)
    rank = count(s > max(tolerance*s(1), tiny(s)))
    basis = transpose(vt(rank + 1:, :))
  end subroutine find_null_space
end module mech9_contradiction
