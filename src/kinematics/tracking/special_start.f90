!> A start in a singular position of a block: the rates of the branches through it, and the first steps if there is only one.
!>
!> At such a position J x' = -F_t does not determine the rates: x' = p + z n with n from the null space of J. The second
!> derivatives of the equations, projected on the vector w with J^T w = 0, give a quadratic equation for z,
!> w . (J' x' + ...) = 0. Each of its real roots is a branch through the position (Allgower and Georg in
!> docs/reference/bibliography.md).
module mech9_special_start
  use mech9_kinds, only: wp
  use mech9_tolerances, only: singular_conditioning
  use mech9_tracking_tolerances, only: first_move, zero_rate
  use mech9_error, only: error_type
  use mech9_lapack, only: dgesvd
  use mech9_hermite, only: build_hermite
  use mech9_law, only: drive_slot_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type
  use mech9_branch_stepping, only: branch_stepper_type
  use mech9_branch_crossing, only: branch_crossing_type, close_from_rates, step_until, copy_stepper
  use mech9_frame_motion, only: spread_velocities, spread_accelerations
  use mech9_block_equations, only: block_jacobian, block_rates
  implicit none
  private
  public :: starting_rates_type, find_starting_rates, start_crossing

  !> The rates with which a block can leave a singular position.
  type :: starting_rates_type
    integer :: count = 0                     !< number of branches: 0, 1 or 2
    logical :: dead = .false.                !< a dead point: no rates fit those of the inputs
    logical :: undetermined = .false.        !< more than one direction is free, or all terms vanish
    real(wp), allocatable :: rates(:, :)     !< (unknowns, 2) rates of the coordinates, one branch in each column [rad/s, m/s]
  end type starting_rates_type

  !> Number of distances that are tried, each a third of the one before.
  integer, parameter :: most_trials = 5

contains

  !> The starting rates of a block whose position, and whose inputs with their rates and accelerations, are in `state`.
  subroutine find_starting_rates(plan, block, state, work, starting)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(inout) :: work   !< scratch of the block
    type(starting_rates_type), intent(out) :: starting   !< the rates with which the block can start
    real(wp), dimension(block%equations, block%equations) :: u
    real(wp), dimension(size(block%unknowns), size(block%unknowns)) :: vt
    real(wp) :: s(size(block%unknowns)), particular(size(block%unknowns)), right(block%equations)
    real(wp) :: terms(block%equations, 3)
    real(wp), dimension(2) :: roots
    integer :: rank, i, n

    n = size(block%unknowns)
    allocate (starting%rates(n, 2), source=0.0_wp)
    call decompose(plan, block, state, work, u, s, vt)
    rank = count(s > singular_conditioning*s(1))
    starting%undetermined = n - rank /= 1
    if (starting%undetermined) return
    call set_rates(plan, block, 0.0_wp*s, state)
    call block_rates(plan, block, 1, state, right)
    starting%dead = norm2(matmul(right, u(:, n:))) > singular_conditioning*max(norm2(right), tiny(s))
    if (starting%dead) return
    particular = -matmul(matmul(right, u(:, :rank))/s(:rank), vt(:rank, :))
    ! the quadratic from three of its values: at -1, 0 and 1
    do i = 1, 3
      call set_rates(plan, block, particular + (i - 2)*vt(n, :), state)
      call block_rates(plan, block, 2, state, terms(:, i))
    end do
    call find_roots(matmul(transpose(u(:, n:)), terms), starting%count, roots, starting%undetermined)
    do i = 1, starting%count
      starting%rates(:, i) = particular + roots(i)*vt(n, :)
      where (abs(starting%rates(:, i)) <= zero_rate*maxval(abs(starting%rates(:, i)))) starting%rates(:, i) = 0.0_wp
      starting%rates(:, i) = starting%rates(:, i)*plan%unit_of(block%coordinates)
    end do
  end subroutine find_starting_rates

  !> Singular values and vectors of the block's Jacobian.
  subroutine decompose(plan, block, state, work, u, s, vt)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(block_work_type), intent(in) :: work   !< scratch of the block
    real(wp), intent(out) :: u(:, :)   !< (equations,equations) left singular vectors
    real(wp), intent(out) :: s(:)   !< (unknowns) singular values, the largest first
    real(wp), intent(out) :: vt(:, :)   !< (unknowns,unknowns) right singular vectors, one in each row
    real(wp) :: a(size(u, 1), size(s)), scratch(20*(size(u, 1) + size(s)))
    integer :: info

    call block_jacobian(plan, block, state, work%column_of, a)
    call dgesvd('A', 'A', size(a, 1), size(s), a, size(a, 1), s, u, size(a, 1), vt, size(s), scratch, size(scratch), info)
  end subroutine decompose

  !> Set the rates of the dependent coordinates, and zero accelerations, and find the motion of the frames.
  pure subroutine set_rates(plan, block, rates, state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    real(wp), intent(in) :: rates(:)   !< (unknowns) rates in the units of the coordinates [1/s]
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    integer :: i, k

    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      state%dq(k) = rates(i)*plan%unit_of(k)
      state%ddq(k) = 0.0_wp
    end do
    call spread_velocities(plan, block, state)
    call spread_accelerations(plan, block, block%last_step, state)
  end subroutine set_rates

  !> Real roots of a quadratic that is given by its values at -1, 0 and 1. The values are vectors; the quadratic is taken along
  !> the direction in which its leading term is largest. Redundant equations contribute only zeros.
  pure subroutine find_roots(values, n_roots, roots, undetermined)
    real(wp), intent(in) :: values(:, :)   !< (equations,3) terms of the equations at -1, 0 and 1
    integer, intent(out) :: n_roots   !< number of real roots, 0 to 2
    real(wp), intent(out) :: roots(2)   !< the roots
    logical, intent(out) :: undetermined   !< there is a double root, or no term decides
    real(wp) :: square(size(values, 1)), linear(size(values, 1)), constant(size(values, 1)), a, b, c, root

    constant = values(:, 2)
    linear = 0.5_wp*(values(:, 3) - values(:, 1))
    square = 0.5_wp*(values(:, 3) + values(:, 1)) - constant
    n_roots = 0
    roots = 0.0_wp
    undetermined = .not. max(norm2(square), norm2(linear)) > tiny(a)
    if (undetermined) return
    if (norm2(square) >= max(norm2(linear), singular_conditioning*norm2(constant))) then
      a = norm2(square)
      b = dot_product(linear, square)/a
      c = dot_product(constant, square)/a
    else
      b = norm2(linear)
      a = dot_product(square, linear)/b
      c = dot_product(constant, linear)/b
    end if
    undetermined = max(abs(a), abs(b)) <= singular_conditioning*max(abs(c), singular_conditioning)
    if (undetermined) return
    if (abs(a) <= singular_conditioning*abs(b)) then
      n_roots = 1
      roots(1) = -c/b
      return
    end if
    root = b**2 - 4.0_wp*a*c
    ! a double root: two branches that touch
    undetermined = abs(root) <= singular_conditioning*max(b**2, abs(a*c))
    if (undetermined .or. root < 0.0_wp) return
    n_roots = 2
    root = -0.5_wp*(b + sign(sqrt(root), b))
    roots = [root/a, c/root]
  end subroutine find_roots

  !> The motion off a singular start whose rates are in `stepper`, by three regular positions beside it. It does not exist
  !> where they cannot be reached with certainty.
  subroutine start_crossing(drives, plan, stepper, crossing, err)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper at the singular start, with its rates
    type(branch_crossing_type), intent(inout) :: crossing   !< gets the motion off the start
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(branch_stepper_type) :: probe
    real(wp), dimension(plan%n_coordinates, 3) :: q, dq, ddq
    real(wp) :: times(3), step, speed
    integer :: trial, i
    logical :: ok

    crossing%exists = .false.
    speed = maxval(abs(stepper%state%dq)/plan%unit_of)
    if (.not. speed > 0.0_wp) return
    step = first_move/speed
    do trial = 1, most_trials
      call copy_stepper(stepper, probe)
      times = stepper%state%t + step*[1.0_wp, 2.0_wp, 3.0_wp]
      do i = 1, 3
        if (i == 1) then
          call close_from_rates(drives, plan, times(1), probe, ok, err)
        else
          call step_until(drives, plan, probe, times(i), ok, err)
        end if
        if (allocated(err)) return
        if (.not. ok) exit
        q(:, i) = probe%predictor%q
        dq(:, i) = probe%predictor%dq
        ddq(:, i) = probe%predictor%ddq
      end do
      if (ok) then
        call build_hermite(times, q, dq, ddq, crossing%polynomial)
        crossing%exists = .true.
        crossing%from = stepper%state%t
        crossing%to = times(3)
        if (.not. allocated(crossing%stepper_beyond)) allocate (crossing%stepper_beyond)
        call copy_stepper(probe, crossing%stepper_beyond)
        return
      end if
      step = step/3.0_wp
    end do
  end subroutine start_crossing
end module mech9_special_start
