!> The motion of blocks by code that was made for one plan (mech9_made_blocks, `mech9-link --specialise`).
!>
!> The code serves a block only where the plan has the structure for which it was made, and where each number that is a constant of the code
!> has the same bits. Where the code finds no motion, the general procedures are to begin anew, so that their judgement stands.
module mech9_made_motion
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_planar_chain, only: planar_chain_type, new_planar_chain
  use mech9_planar_view, only: show_poses, show_velocities, show_accelerations
  use mech9_block_solver, only: block_work_type, newton_outcome_type
  use mech9_made_blocks, only: made_course_type, describe_made_plan, move_made_block
  implicit none
  private
  public :: take_made_blocks, move_as_made, structure_of_plan, key_of_block, numbers_of_plan, can_be_made, per_step, per_closure, &
    key_length

  !> Numbers of a step: its angle, place (2) and slide (2); and of a closure: cosine, sine, and place (2). That of all closures follows
  !> that of all steps, and the mechanism's size is the last one.
  integer, parameter :: per_step = 5, per_closure = 4
  !> First and last step of a block, its closure (0: none), and the steps of its unknowns.
  integer, parameter :: key_length = 6

contains

  !> Whether code can be made for a block: one planar chain of three unknowns, or steps in a plane that close none.
  pure logical function can_be_made(plan, block) result(can)
    type(plan_type), intent(in) :: plan     !< the plan
    type(block_type), intent(in) :: block   !< its block
    type(planar_chain_type) :: chain

    can = (plan%planar%used .or. block%arithmetic > 1) .and. .not. block%is_constant
    if (.not. can) return
    if (block%first_closure > block%last_closure) then
      can = size(block%unknowns) == 0 .and. block%last_step >= block%first_step
    else
      chain = new_planar_chain(plan, block)
      can = chain%used
    end if
  end function can_be_made

  !> The structure of a plan in planar arithmetic, in integers.
  pure subroutine structure_of_plan(plan, structure)
    type(plan_type), intent(in) :: plan                   !< the plan
    integer, allocatable, intent(out) :: structure(:)     !< empty where nothing is planar
    integer :: c, m, n, s

    n = 0
    m = 0
    if (allocated(plan%planar%steps)) m = size(plan%planar%steps)
    if (m > 0) n = size(plan%planar%closures)
    allocate (structure(merge(2 + 5*m + 3*n, 0, m > 0)))
    if (m == 0) return
    structure(:2) = [m, n]
    do s = 1, m
      associate (step => plan%planar%steps(s))
        structure(5*s - 2:5*s + 2) = [step%parent, step%coordinate, merge(1, 0, step%turns), nint(step%turn), &
                                      merge(1, 0, plan%steps(s)%dependent)]
      end associate
    end do
    do c = 1, n
      associate (closure => plan%planar%closures(c))
        structure(5*m + 3*c:5*m + 3*c + 2) = [closure%closing, closure%target, closure%base]
      end associate
    end do
  end subroutine structure_of_plan

  !> The key of a block.
  pure function key_of_block(block) result(key)
    type(block_type), intent(in) :: block   !< the block
    integer :: key(key_length)

    key = 0
    key(:2) = [block%first_step, block%last_step]
    if (block%first_closure > block%last_closure) return
    key(3) = block%first_closure
    key(4:6) = block%unknowns(:3)
  end function key_of_block

  !> The numbers of a plan in planar arithmetic.
  pure subroutine numbers_of_plan(plan, numbers)
    type(plan_type), intent(in) :: plan                   !< the plan, with a planar part
    real(wp), allocatable, intent(out) :: numbers(:)      !< see per_step [rad, m]
    integer :: c, m, n, s

    m = size(plan%planar%steps)
    n = size(plan%planar%closures)
    allocate (numbers(per_step*m + per_closure*n + 1))
    do s = 1, m
      associate (step => plan%planar%steps(s))
        numbers(per_step*(s - 1) + 1:per_step*s) = [step%angle, step%place, step%slide]
      end associate
    end do
    do c = 1, n
      associate (closure => plan%planar%closures(c), before => per_step*m + per_closure*(c - 1))
        numbers(before + 1:before + per_closure) = [closure%cosine, closure%sine, closure%place]
      end associate
    end do
    numbers(size(numbers)) = plan%planar%length
  end subroutine numbers_of_plan

  !> Let made code serve the blocks of a plan for which it was made.
  pure subroutine take_made_blocks(plan, work)
    type(plan_type), intent(in) :: plan                 !< the plan
    type(block_work_type), intent(inout) :: work(:)     !< scratch of its blocks
    integer, allocatable :: made(:), structure(:), places(:)
    real(wp), allocatable :: values(:), numbers(:)
    integer :: b, i, n

    call describe_made_plan(made, places, values)
    if (size(made) == 0) return
    call structure_of_plan(plan, structure)
    n = size(structure)
    if (n == 0 .or. n > size(made)) return
    if (any(made(:n) /= structure)) return
    call numbers_of_plan(plan, numbers)
    ! equal bits: a constant that differs at all belongs to another plan
    if (any(abs(numbers(places) - values) > 0.0_wp)) return
    do b = 1, size(plan%blocks)
      if (.not. can_be_made(plan, plan%blocks(b))) cycle
      do i = 1, (size(made) - n)/key_length
        if (all(made(n + key_length*(i - 1) + 1:n + key_length*i) == key_of_block(plan%blocks(b)))) work(b)%made = i
      end do
      if (work(b)%made > 0) work(b)%numbers = numbers
    end do
  end subroutine take_made_blocks

  !> Close a block from the coordinates in `state` and find its rates and accelerations, by made code.
  subroutine move_as_made(plan, block, full, state, work, outcome, is_solved)
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism
    type(block_type), intent(in) :: block                !< the block
    logical, intent(in) :: full                          !< find accelerations too
    type(state_type), intent(inout) :: state             !< first guess in; the motion of the block out
    type(block_work_type), intent(inout) :: work         !< scratch of the block; gets the factors of its Jacobian
    type(newton_outcome_type), intent(out) :: outcome    !< the course of Newton's method
    logical, intent(out) :: is_solved                    !< else the general procedures are to begin anew, from a guess
    type(made_course_type) :: course
    integer :: steps

    associate (motion => state%planar)
      call move_made_block(work%made, work%numbers, full, state%q, state%dq, state%ddq, motion%pose, motion%slide, motion%turn, &
                           motion%velocity, motion%acceleration, work%jacobian, work%equations%inverse, course, is_solved)
    end associate
    if (.not. is_solved) return
    outcome%converged = .true.
    outcome%iterations = course%iterations
    outcome%correction = course%correction
    outcome%contraction = course%contraction
    outcome%last = 0.0_wp      ! the factors are those of the closed position
    steps = block%last_step - block%first_step + 1
    if (size(block%unknowns) > 0) call work%equations%take_inverse(work%jacobian, course%pivots, course%sign_of_det)
    associate (count => work%count)
      count%frames_placed = count%frames_placed + (course%iterations + 1)*steps
      count%factorizations = count%factorizations + course%iterations + 1
      count%rates = count%rates + 1
      count%frames_moved = count%frames_moved + merge(2*steps, steps, full)
      if (full) count%accelerations = count%accelerations + 1
    end associate
    if (.not. block%is_shown) return
    call show_poses(plan, plan%planar%shown, block%first_step, block%last_step, state)
    call show_velocities(plan, plan%planar%shown, block%first_step, block%last_step, state)
    if (full) call show_accelerations(plan, plan%planar%shown, block%first_step, block%last_step, state)
  end subroutine move_as_made
end module mech9_made_motion
