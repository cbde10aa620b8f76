!> Which coordinates a block leaves free and which cannot be given: words for mobility errors.
!> Uses kinds, text, lapack, plan, state, closure.
module mech9_mobility
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_lapack, only: dgesvd
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_closure, only: closure_jacobian
  implicit none
  private
  public :: undetermined, overdetermined

  !> Singular values and components below this count as zero.
  real(wp), parameter :: tolerance = 1.0e-8_wp

contains

  !> How many more coordinates must be independent, and which of the block's could be.
  function undetermined(plan, block, state) result(text)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    character(len=:), allocatable :: text
    integer :: steps(size(block%unknowns)), free, i
    logical :: moves(size(block%unknowns))

    steps = block%unknowns
    call free_motions(plan, block, state, steps, free, moves)
    text = to_text(free)//' more of the coordinates '// &
           to_text(ascending(pack([(plan%steps(steps(i))%coordinate, i=1, size(steps))], moves)))// &
           ' must be independent (cq)'
  end function undetermined

  !> Which independent coordinates move against each other in a block.
  function overdetermined(plan, block, state) result(text)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    character(len=:), allocatable :: text
    integer, allocatable :: given(:)
    integer :: c

    allocate (given(0))
    do c = block%first_closure, block%last_closure
      associate (steps => plan%closures(c)%path%steps)
        given = [given, pack(plan%steps(steps)%coordinate, .not. plan%steps(steps)%dependent)]
      end associate
    end do
    if (size(given) > 0) then
      text = 'take one of '//to_text(ascending(given))//' off the independent coordinates (cq)'
    else
      text = 'its links are already held by other chains; take a coordinate off the independent ones (cq)'
    end if
  end function overdetermined

  !> Number of independent motions of a block that keep its chains closed, over the given steps, and
  !> which of the steps take part in one.
  subroutine free_motions(plan, block, state, steps, free, moves)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    type(state_type), intent(in) :: state
    integer, intent(in) :: steps(:)
    integer, intent(out) :: free
    logical, intent(out) :: moves(:)
    real(wp) :: a(max(block%equations, 1), size(steps)), s(size(steps) + block%equations)
    real(wp) :: vt(size(steps), size(steps)), u(1, 1)
    real(wp) :: work(8*(size(steps) + block%equations) + 64)
    integer :: column_of(block%last_step - block%first_step + 1), i, n, rank, info

    n = size(steps)
    column_of = 0
    do i = 1, n
      column_of(steps(i) - block%first_step + 1) = i
    end do
    a = 0.0_wp
    if (block%equations > 0) call closure_jacobian(plan, block, state, column_of, a)
    s = 0.0_wp
    call dgesvd('N', 'A', size(a, 1), n, a, size(a, 1), s, u, 1, vt, n, work, size(work), info)
    rank = count(s(:min(n, size(a, 1))) > tolerance*max(s(1), tiny(s)))
    free = n - rank
    do i = 1, n
      moves(i) = norm2(vt(rank + 1:n, i)) > tolerance
    end do
  end subroutine free_motions

  !> The numbers in ascending order, each once.
  pure function ascending(numbers) result(sorted)
    integer, intent(in) :: numbers(:)
    integer, allocatable :: sorted(:)
    integer :: i

    sorted = pack([(i, i=1, maxval([0, numbers]))], [(any(numbers == i), i=1, maxval([0, numbers]))])
  end function ascending
end module mech9_mobility
