!> The choice of other independent coordinates near a singular position (Wehage and Haug in docs/bibliography.md).
module mech9_coordinate_choice
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_structure, exit_assembly, exit_singular
  use mech9_failure, only: failure_other_branch
  use mech9_lapack, only: dgeqp3
  use mech9_partition, only: partition_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_requested, only: requested_type
  use mech9_planning, only: make_plan
  implicit none
  private
  public :: best_independent, carry_over

contains

  !> The independent coordinates with the best conditioned dependent ones at a closed position, by QR with column pivoting of the
  !> closures' Jacobian over all coordinates. Chains that are left out stay dependent.
  subroutine best_independent(plan, state, independent)
    type(plan_type), intent(in) :: plan      !< the plan of the mechanism
    type(state_type), intent(in) :: state    !< frames in place
    logical, intent(out) :: independent(:)   !< (M)
    real(wp), allocatable :: a(:, :), tau(:), work(:)
    integer, allocatable :: pivot(:)
    logical :: followed(plan%n_coordinates)
    integer :: m, n, row, b, c, dependent, info

    n = plan%n_coordinates
    m = sum(plan%closures%rank)
    allocate (a(m, n), source=0.0_wp)
    allocate (tau(min(m, n)), work(2*n + (n + 1)*32), source=0.0_wp)
    allocate (pivot(n), source=0)
    row = 0
    followed = .false.
    followed(plan%independent) = .true.
    do b = 1, size(plan%blocks)
      followed(plan%blocks(b)%coordinates) = .true.
      do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
        call add_closure(plan, state, c, row, a)
        row = row + plan%closures(c)%rank
      end do
    end do
    if (m > 0) call dgeqp3(m, n, a, m, pivot, tau, work, size(work), info)
    dependent = count(followed) - size(plan%independent)
    independent = followed
    independent(pivot(:dependent)) = .false.
  end subroutine best_independent

  !> The rows of one closure: the derivatives by all coordinates of its loop.
  pure subroutine add_closure(plan, state, c, row, a)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: c                !< number of the closure
    integer, intent(in) :: row              !< rows of `a` before those of the closure
    real(wp), intent(inout) :: a(:, :)      !< (rows,M) derivatives of all closures by all coordinates
    integer :: i, s

    associate (loop => plan%closures(c)%loop)
      do i = 1, size(loop%steps)
        s = loop%steps(i)
        call plan%constraints(c)%item%column(plan, s, loop%signs(i), state, &
                                             a(row + 1:row + plan%closures(c)%rank, plan%steps(s)%coordinate))
      end do
    end associate
  end subroutine add_closure

  !> The plan and the state in other independent coordinates. Fails with exit_singular where these cannot serve or the
  !> state cannot be carried over, and with the code of the failure where a pair or the program itself fails.
  subroutine carry_over(mechanism, partition, plan, state, requested, new_plan, new_state, err)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(partition_type), intent(in) :: partition        !< with the other independent coordinates
    type(plan_type), intent(in) :: plan                  !< the present plan
    type(state_type), intent(in) :: state                !< closed, with rates of all coordinates
    type(requested_type), intent(in) :: requested        !< requested quantities; blocks that do not serve them are left out
    type(plan_type), intent(out) :: new_plan             !< the plan in the other coordinates
    type(state_type), intent(out) :: new_state           !< the same position and motion, for the new plan
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    integer :: k

    call make_plan(mechanism, partition, state%q, new_plan, new_state, err, requested=requested, length=plan%length)
    if (allocated(err)) then
      if (err%code == exit_structure .or. err%code == exit_assembly) err%code = exit_singular
      return
    end if
    ! chains that were left out so far close anywhere
    k = maxloc(abs(new_state%q - state%q)/new_plan%unit_of, dim=1, mask=requested%coordinates)
    if (abs(new_state%q(k) - state%q(k)) > 1.0e-6_wp*new_plan%unit_of(k)) then
      call raise(err, exit_singular, failure_other_branch)
      err%failure%coordinates = [k]
      return
    end if
    new_state%t = state%t
    new_state%dq = state%dq
  end subroutine carry_over
end module mech9_coordinate_choice
