!> A test whether chains with redundant equations stay closed over a finite motion.
!>
!> The rank of a chain at its start can be lower than at every other position. Its equations then seem redundant, and rates
!> that satisfy them exist, but the chain is locked: no finite motion keeps it closed. Bennett's linkage, whose equations are
!> redundant at every closed position, moves; with one dimension changed it has rates only at special positions.
!> The least residual after a finite displacement distinguishes the two cases: it is round-off, or a gap.
!>
!> For a chain that opens, the smallest changes of its dimensions are estimated that would keep it closed, to first order:
!> changes of the constant poses of the loop's steps enter the closures like motions of six more pairs in each step.
module mech9_finite_motion
  use mech9_kinds, only: wp
  use mech9_assembly_tolerances, only: closed_after_motion, deciding_conditioning, finite_movement, &
    first_displacement, first_order_gap, ineffective_dimensions, converged_unknowns, small_gap, small_part, &
    unexplained_gap
  use mech9_error, only: error_type
  use mech9_lapack, only: dgesvd
  use mech9_random, only: random_type
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type, block_type, new_state, within_range
  use mech9_state, only: state_type
  use mech9_arithmetics, only: set_in_space
  use mech9_spatial_closure, only: reduced_screw
  use mech9_block_equations, only: block_residual, block_jacobian
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  use mech9_generic_position, only: free_block
  implicit none
  private
  public :: locked_chain_type, find_locked_chain

  !> A chain that does not stay closed.
  type :: locked_chain_type
    logical :: exists = .false.            !< there is such a chain
    integer :: block = 0                   !< number of its block
    integer :: closure = 0                 !< number of its closure
    integer :: redundant = 0               !< number of equations of the block that seem redundant at the start
    real(wp) :: gap = huge(1.0_wp)         !< gap after a displacement [m, rotations times the mechanism's size]
    real(wp) :: displacement = 0.0_wp      !< this displacement of the independent coordinates [rad, or parts of the size]
    real(wp) :: distance = huge(1.0_wp)    !< distance from dimensions with which it moves [rad, parts of the size]; huge: unknown
  end type locked_chain_type

  !> Number of displacements that are tried, and number of their sizes, each half of the one before.
  integer, parameter :: most_trials = 21, sizes = 7
  !> Blocks whose last step is at most this one are also moved with all coordinates free.
  integer, parameter :: largest_free_block = 200

contains

  !> Find a chain whose redundant equations do not stay satisfied when its block is moved from the start.
  subroutine find_locked_chain(plan, start, locked)
    type(plan_type), intent(in) :: plan   !< the plan, with its blocks
    type(state_type), intent(in) :: start   !< the assembled position
    type(locked_chain_type), intent(out) :: locked       !< the first one found, if it exists
    type(plan_type) :: spatial
    type(state_type) :: home
    type(locked_chain_type), allocatable :: nearest(:)
    logical, allocatable :: moves(:)
    integer :: b

    moves = plan%blocks%equations <= unknowns_of(plan%blocks)
    if (all(moves)) return
    spatial = plan
    call set_in_space(spatial)
    home = new_state(spatial)
    home%q = start%q
    allocate (nearest(size(plan%blocks)))
    call displace_inputs(spatial, home, moves, nearest, locked)
    do b = 1, size(moves)
      if (locked%exists .or. moves(b)) cycle
      call displace_all(spatial, home, b, moves(b))
      ! a block that no trial reached, because an earlier one did not close, is not judged
      if (.not. moves(b) .and. nearest(b)%exists) locked = nearest(b)
    end do
    if (.not. locked%exists) return
    locked%redundant = plan%blocks(locked%block)%equations - unknowns_of(plan%blocks(locked%block))
    call estimate_distance(spatial, home, locked)
  end subroutine find_locked_chain

  !> Displace the independent coordinates by less and less, close the blocks in order and judge the gaps that stay.
  subroutine displace_inputs(plan, home, moves, nearest, locked)
    type(plan_type), intent(in) :: plan                       !< in spatial arithmetic
    type(state_type), intent(in) :: home                      !< assembled coordinates
    logical, intent(inout) :: moves(:)   !< (blocks) set where a block was shown to move, or needs no proof
    type(locked_chain_type), intent(inout) :: nearest(:)   !< (blocks) smallest gap of each block that was seen
    type(locked_chain_type), intent(inout) :: locked   !< a chain that is certainly locked, if it exists
    type(random_type) :: random
    type(state_type) :: state
    real(wp) :: amount, change
    integer :: trial, i, k

    ! first from the assembled position, then from positions beside it, because branches may meet in the assembled one
    do trial = 1, most_trials
      amount = first_displacement/2.0_wp**modulo(trial - 1, sizes)
      state = home
      do i = 1, size(plan%independent)
        k = plan%independent(i)
        change = random%symmetric()
        state%q(k) = within_range(plan%steps(plan%step_of(k)), &
                                  home%q(k) + amount*plan%unit_of(k)*(0.5_wp*change + sign(0.5_wp, change)))
      end do
      do i = 1, plan%n_coordinates
        k = plan%steps(i)%coordinate
        if (trial > sizes .and. plan%steps(i)%dependent) &
          state%q(k) = within_range(plan%steps(i), home%q(k) + amount*plan%unit_of(k)*random%symmetric())
      end do
      call close_in_order(plan, amount, state, moves, nearest, locked)
      if (locked%exists .or. all(moves)) return
    end do
  end subroutine displace_inputs

  !> Close the blocks at displaced independent coordinates, up to the first that stays open.
  subroutine close_in_order(plan, amount, state, moves, nearest, locked)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    real(wp), intent(in) :: amount   !< displacement of the independent coordinates, in their units [rad, or parts of the size]
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    logical, intent(inout) :: moves(:)   !< (blocks) set where a block was shown to move
    type(locked_chain_type), intent(inout) :: nearest(:)   !< (blocks) smallest gap of each block that was seen
    type(locked_chain_type), intent(inout) :: locked   !< the chain that does not move
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    real(wp) :: gap, tolerance, conditioning
    integer :: b

    tolerance = max(closed_after_motion, plan%data_tolerance)
    conditioning = 1.0_wp
    do b = 1, size(plan%blocks)
      work = new_block_work(plan%blocks(b))
      call assemble_block(plan, plan%blocks(b), state, work, .false., outcome, err)
      if (allocated(err)) return
      if (plan%blocks(b)%equations > 0) then
        call factorize_block(plan, plan%blocks(b), state, work)
        conditioning = min(conditioning, work%equations%conditioning())
      end if
      gap = outcome%gap/plan%length
      if (gap <= tolerance) then
        moves(b) = .true.
        cycle
      end if
      if (.not. plan%blocks(b)%equations > unknowns_of(plan%blocks(b))) return
      if (outcome%gap < nearest(b)%gap) nearest(b) = &
        locked_chain_type(exists=.true., block=b, closure=outcome%worst_closure, gap=outcome%gap, displacement=amount)
      if (.not. moves(b) .and. gap <= max(min(small_gap, small_part*amount**2), 1.0e3_wp*tolerance) .and. &
          conditioning > deciding_conditioning) then
        if (is_least(plan, plan%blocks(b), state, work)) locked = nearest(b)
      end if
      return
    end do
  end subroutine close_in_order

  !> Whether the unknowns of a block, whose Jacobian is factorized, give the least residual.
  logical function is_least(plan, block, state, work)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block, with the factors of its Jacobian

    call block_residual(plan, block, state, work%right)
    call work%equations%solve(work%right, work%change)
    is_least = maxval(abs(work%change)) <= converged_unknowns
  end function is_least

  !> Displace all coordinates up to block b and close them together, for independent coordinates that cannot be displaced alone.
  subroutine displace_all(plan, home, b, moves)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: home   !< an assembled position
    integer, intent(in) :: b   !< number of the block to be judged
    logical, intent(out) :: moves   !< the block was shown to move
    type(block_type) :: block
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    type(random_type) :: random
    type(state_type) :: state
    integer :: trial, k

    moves = .false.
    if (plan%blocks(b)%last_step > largest_free_block) return
    block = free_block(plan, plan%blocks(b)%last_step, plan%blocks(b)%last_closure)
    work = new_block_work(block)
    do trial = 1, sizes
      state = home
      do k = 1, size(block%coordinates)
        associate (c => block%coordinates(k))
          state%q(c) = within_range(plan%steps(block%unknowns(k)), &
                                    home%q(c) + first_displacement/2.0_wp**(trial - 1)*plan%unit_of(c)*random%symmetric())
        end associate
      end do
      call assemble_block(plan, block, state, work, .false., outcome, err)
      if (allocated(err)) cycle
      moves = outcome%gap <= max(closed_after_motion, plan%data_tolerance)*plan%length .and. &
              has_moved(plan, plan%blocks(b), home, state)
      if (moves) return
    end do
  end subroutine displace_all

  !> Whether some coordinate on the loops of a block has moved by a finite amount.
  pure logical function has_moved(plan, block, home, state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: home   !< an assembled position
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer :: c

    has_moved = .false.
    do c = block%first_closure, block%last_closure
      associate (k => plan%steps(plan%closures(c)%loop%steps)%coordinate)
        has_moved = has_moved .or. any(abs(state%q(k) - home%q(k)) > finite_movement*plan%unit_of(k))
      end associate
    end do
  end function has_moved

  !> The distance of a locked block's dimensions from the nearest ones that let it move, to first order: changes of all
  !> constant poses of its loops, least in their sum of squares, that close it at displaced positions on both sides. It stays
  !> unknown where such changes do not explain the gaps.
  subroutine estimate_distance(plan, home, locked)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: home   !< an assembled position
    type(locked_chain_type), intent(inout) :: locked   !< the chain that does not move
    real(wp), parameter :: step = 0.2_wp
    integer, parameter :: steps = 8
    type(state_type) :: state
    real(wp), allocatable :: effects(:, :), gaps(:), block_effects(:, :), block_gaps(:)
    real(wp) :: dimensions(6*plan%n_coordinates)
    logical :: explained
    integer :: i, direction

    allocate (effects(0, 6*plan%n_coordinates), gaps(0))
    do direction = -1, 1, 2
      state = home
      do i = 1, steps
        state%q(plan%independent) = state%q(plan%independent) + direction*step*plan%unit_of(plan%independent)
        call find_effects(plan, locked%block, state, block_effects, block_gaps)
        if (size(block_gaps) == 0) exit
        gaps = [gaps, block_gaps]
        effects = stacked(effects, block_effects)
      end do
    end do
    if (size(gaps) < 2) return
    call least_changes(effects, -gaps, dimensions, explained)
    if (explained) locked%distance = maxval(abs(dimensions))
  end subroutine estimate_distance

  !> One matrix above another.
  pure function stacked(upper, lower) result(both)
    real(wp), intent(in) :: upper(:, :)   !< (:,n) the upper matrix
    real(wp), intent(in) :: lower(:, :)   !< (:,n) the lower matrix
    real(wp) :: both(size(upper, 1) + size(lower, 1), size(upper, 2))

    both(:size(upper, 1), :) = upper
    both(size(upper, 1) + 1:, :) = lower
  end function stacked

  !> Gaps of a block in the directions that its unknowns cannot close, at a displaced position, and their derivatives by the
  !> dimensions. They are empty where an earlier block stays open, or the gap is not small, or the position is singular.
  subroutine find_effects(plan, b, state, effects, gaps)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: b   !< number of the block
    type(state_type), intent(inout) :: state   !< displaced independent coordinates, and guesses of the others
    real(wp), allocatable, intent(out) :: effects(:, :)   !< (directions, six for each step)
    real(wp), allocatable, intent(out) :: gaps(:)         !< (directions) [rad, or parts of the size]
    real(wp), allocatable :: u(:, :), vt(:, :), s(:), scratch(:), a(:, :), columns(:, :)
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    integer :: i, m, n, rank, info

    allocate (effects(0, 6*plan%n_coordinates), gaps(0))
    do i = 1, b
      work = new_block_work(plan%blocks(i))
      call assemble_block(plan, plan%blocks(i), state, work, .false., outcome, err)
      if (allocated(err) .or. (i < b .and. .not. outcome%closed) .or. outcome%gap > first_order_gap*plan%length) return
    end do
    m = plan%blocks(b)%equations
    n = unknowns_of(plan%blocks(b))
    allocate (a(m, n), u(m, m), s(n), vt(n, n), scratch(20*(m + n)), columns(m, 6*plan%n_coordinates))
    call block_jacobian(plan, plan%blocks(b), state, work%column_of, a)
    call dgesvd('A', 'N', m, n, a, m, s, u, m, vt, n, scratch, size(scratch), info)
    rank = count(s > deciding_conditioning*s(1))
    if (info /= 0 .or. rank < n) return
    call block_residual(plan, plan%blocks(b), state, work%right)
    call dimension_columns(plan, plan%blocks(b), state, columns)
    gaps = matmul(work%right, u(:, n + 1:))
    effects = matmul(transpose(u(:, n + 1:)), columns)
  end subroutine find_effects

  !> Derivatives of a block's equations with respect to small turns about, and shifts along, the axes of the frame before each
  !> step of its loops.
  pure subroutine dimension_columns(plan, block, state, columns)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    real(wp), intent(out) :: columns(:, :)      !< (equations, six for each step) [1 per rad, 1 per part of the size]
    real(wp) :: w(3), v(3)
    integer :: c, i, j, s, row

    columns = 0.0_wp
    row = 0
    do c = block%first_closure, block%last_closure
      associate (closure => plan%closures(c), place => state%p(:, plan%closures(c)%closing))
        ! the numbers of couplings are exact
        do i = 1, merge(0, size(closure%loop%steps), closure%coupling > 0)
          s = closure%loop%steps(i)
          do j = 1, 3
            w = closure%loop%signs(i)*state%r(:, j, plan%steps(s)%parent)
            v = cross(w, place - state%p(:, s))
            call reduced_screw(plan, closure, state, w, v, place, columns(row + 1:row + closure%rank, 6*s - 6 + j))
            v = plan%length*w
            call reduced_screw(plan, closure, state, [0.0_wp, 0.0_wp, 0.0_wp], v, place, &
                               columns(row + 1:row + closure%rank, 6*s - 3 + j))
          end do
        end do
        row = row + closure%rank
      end associate
    end do
  end subroutine dimension_columns

  !> The x of least norm with a x = b in the effective directions of a.
  subroutine least_changes(a, b, x, explained)
    real(wp), intent(inout) :: a(:, :)           !< (m,n); overwritten
    real(wp), intent(in) :: b(:)                 !< (m)
    real(wp), intent(out) :: x(:)                !< (n)
    logical, intent(out) :: explained            !< whether a x is near b
    real(wp) :: u(size(b), size(b)), s(min(size(b), size(x))), vt(min(size(b), size(x)), size(x))
    real(wp) :: scratch(8*(size(b) + size(x))), parts(size(b))
    integer :: rank, info

    call dgesvd('A', 'S', size(b), size(x), a, size(b), s, u, size(b), vt, size(vt, 1), scratch, size(scratch), info)
    rank = count(s > ineffective_dimensions*s(1))
    parts = matmul(b, u)
    explained = info == 0 .and. rank > 0 .and. norm2(parts(rank + 1:)) <= unexplained_gap*norm2(b)
    x = 0.0_wp
    if (explained) x = matmul(parts(:rank)/s(:rank), vt(:rank, :))
  end subroutine least_changes

  !> Number of unknowns of a block.
  pure elemental integer function unknowns_of(block)
    type(block_type), intent(in) :: block   !< the block

    unknowns_of = size(block%unknowns)
  end function unknowns_of
end module mech9_finite_motion
