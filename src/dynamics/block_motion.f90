!> Rates and Jacobians of one block, and the accelerations that its rates alone give.
module mech9_block_motion
  use mech9_kinds, only: wp
  use mech9_tolerances, only: round_off_of_rates, singular_conditioning
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_dynamics_failures, only: failure_singular_block
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_least_squares, only: nearly_dependent
  use mech9_block_solver, only: block_work_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_jacobian, only: find_jacobian
  use mech9_frame_motion, only: spread_velocities, spread_accelerations
  use mech9_block_equations, only: block_rates
  implicit none
  private
  public :: move_block

contains

  !> Find the rates, Jacobian entries and accelerations from rates of block b. Its frames must have their poses, the rates
  !> of the independent coordinates must be known, and earlier blocks must be done. Fails with exit_singular in a singular
  !> position.
  subroutine move_block(plan, dynamics, b, state, work, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    integer, intent(in) :: b                            !< number of the block
    type(state_type), intent(inout) :: state            !< with poses and independent rates; gets the motion of the block
    type(lagrange_work_type), intent(inout) :: work     !< scratch; gets the Jacobian entries of the block
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: conditioning
    logical :: moved

    associate (block => plan%blocks(b))
      if (size(block%unknowns) == 0) then
        call spread_velocities(plan, block, state)
        call spread_accelerations(plan, block, block%last_step, state)
        return
      end if
      call dynamics%arithmetics(dynamics%arithmetic_of(b))%kind%factorize_block(plan, b, state, work)
      conditioning = work%blocks(b)%equations%conditioning()
      work%conditioning = min(work%conditioning, conditioning)
      if (conditioning < singular_conditioning) then
        call raise(err, exit_singular, failure_singular_block)
        err%failure%chains = block%chains
        err%failure%coordinates = block%coordinates
        return
      end if
      if (conditioning >= nearly_dependent) then
        call dynamics%arithmetics(dynamics%arithmetic_of(b))%kind%move_regular_block(plan, dynamics, b, state, work, moved)
        if (moved) return
      end if
      call expect(state%t, work)
      call move_as_expected(plan, dynamics, b, state, work)
    end associate
  end subroutine move_block

  !> Extrapolate B and the accelerations from rates to this evaluation's time, once in an evaluation.
  pure subroutine expect(t, work)
    real(wp), intent(in) :: t                         !< time [s]
    type(lagrange_work_type), intent(inout) :: work   !< with the expectation; gets `expected_b` and `expected_ddq`

    if (.not. work%expects) call work%expectation%continue_to(t, work%expected_b, work%expected_ddq)
    work%expects = .true.
  end subroutine expect

  !> The general way: corrections are added to the expected values, which remain where round-off hides the correction.
  subroutine move_as_expected(plan, dynamics, b, state, work)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    integer, intent(in) :: b                           !< number of the block
    type(state_type), intent(inout) :: state           !< with poses and independent rates; gets the motion of the block
    type(lagrange_work_type), intent(inout) :: work    !< with the expected values; gets the Jacobian entries of the block

    associate (block => plan%blocks(b))
      call find_jacobian(plan, dynamics, b, state, work%expected_b, work%blocks(b), work%jacobian)
      call find_rates(plan, dynamics, block, work%jacobian%b, state%dq)
      call spread_velocities(plan, block, state)
      call find_bias(plan, block, work%expected_ddq, state, work%blocks(b))
    end associate
  end subroutine move_as_expected

  !> Rates of the dependent coordinates of a block, B times those of the independent ones.
  pure subroutine find_rates(plan, dynamics, block, b, dq)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(block_type), intent(in) :: block              !< the block
    real(wp), intent(in) :: b(:)   !< (entries) B, rates of dependent coordinates per unit rate of independent ones
    real(wp), intent(inout) :: dq(:)                   !< (M) independent rates in, dependent rates of the block out [rad/s, m/s]
    real(wp) :: rate
    integer :: i, s, e

    do i = 1, size(block%unknowns)
      s = block%unknowns(i)
      rate = 0.0_wp
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        rate = rate + b(e)*dq(plan%independent(dynamics%column(e)))
      end do
      dq(block%coordinates(i)) = rate
    end do
  end subroutine find_rates

  !> Accelerations that rates alone give a block, as corrections of the expected ones; see find_jacobian.
  subroutine find_bias(plan, block, expected, state, work)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(block_type), intent(in) :: block          !< the block
    real(wp), intent(in) :: expected(:)            !< (M) accelerations from rates, extrapolated [rad/s^2, m/s^2]
    type(state_type), intent(inout) :: state       !< with velocities; gets accelerations of the block's coordinates and frames
    type(block_work_type), intent(inout) :: work   !< with the block's Jacobian factorized; scratch
    real(wp) :: scale
    integer :: i, k

    scale = 0.0_wp
    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      state%ddq(k) = expected(k)
      scale = max(scale, (state%dq(k)/plan%unit_of(k))**2)
    end do
    call spread_accelerations(plan, block, block%last_step, state)
    call block_rates(plan, block, 2, state, work%right)
    work%right = -work%right
    call work%equations%solve(work%right, work%change, round_off=round_off_of_rates*scale)
    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      state%ddq(k) = state%ddq(k) + work%change(i)*plan%unit_of(k)
    end do
    call spread_accelerations(plan, block, block%last_step, state)
  end subroutine find_bias
end module mech9_block_motion
