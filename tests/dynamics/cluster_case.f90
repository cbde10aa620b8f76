!> A mechanism with all that its motion needs, and the checks of its accelerations, for tests of articulated bodies over open links
!> and clusters. Programs that use it are linked for the counts of mech9_counted_memory.
module mech9_cluster_case
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_motion, find_equations, complete_accelerations
  use mech9_block_equations, only: block_rates
  use mech9_literal_lagrange, only: literal_type, literal_equations
  use mech9_testing, only: tester_type
  use mech9_counted_memory, only: calls
  implicit none
  private
  public :: cluster_case_type, prepare, check_motion, check_literally, check_memory

  !> A mechanism and all that its motion needs.
  type :: cluster_case_type
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    real(wp) :: conditioning = 0.0_wp   !< the worst of all blocks
  end type cluster_case_type

contains

  !> Plan, and some rates.
  subroutine prepare(this, in_space, found)
    type(cluster_case_type), intent(inout) :: this   !< with the model; gets plans, state and equations
    logical, intent(in) :: in_space                  !< spatial arithmetic, also where the mechanism is planar
    logical, intent(out) :: found                    !< the mechanism moves
    type(error_type), allocatable :: err
    integer :: i

    call make_plan(this%model%mechanism, this%model%problem%partition, this%model%problem%initial%position, this%plan, &
                   this%state, err, planning_settings_type(in_space=in_space))
    found = .not. allocated(err)
    if (.not. found) return
    call make_dynamics_plan(this%model%mechanism, this%plan, this%dynamics)
    this%work = new_lagrange_work(this%plan, this%dynamics)
    this%state%dq(this%plan%independent) = [(1.3_wp*cos(2.0_wp*i), i=1, size(this%plan%independent))]
    call find_equations(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    found = .not. allocated(err)
    this%conditioning = 1.0_wp
    do i = 1, size(this%work%blocks)
      this%conditioning = min(this%conditioning, this%work%blocks(i)%equations%conditioning())
    end do
  end subroutine prepare

  !> The accelerations satisfy a ddq = Q - h, and those of the dependent coordinates the closures. Sums over all links along a chain
  !> lose some hundreds of units of round-off.
  subroutine check_motion(test, this, why)
    type(tester_type), intent(inout) :: test         !< gets the outcome
    type(cluster_case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    character(len=*), intent(in) :: why              !< the mechanism, printed where its accelerations are wrong
    type(error_type), allocatable :: err
    real(wp), allocatable :: a(:, :), left(:), right(:)
    real(wp) :: terms
    integer :: i, n

    this%work%coefficients = 0.0_wp
    call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    call test%no_error(err, why//': the motion is found')
    if (allocated(err)) return
    n = size(this%plan%independent)
    if (this%dynamics%articulated) call test%near(maxval(abs(this%work%coefficients)), 0.0_wp, 0.0_wp, &
                                                  why//': the coefficients are not computed')
    associate (ddq => this%work%accelerations)
      call find_equations(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
      call test%no_error(err, why//': the equations are found')
      a = this%work%coefficients
      do i = 1, n
        a(i, i + 1:) = a(i + 1:, i)
      end do
      left = matmul(a, ddq) - this%work%forces + this%work%velocity_terms
      terms = maxval(matmul(abs(a), abs(ddq)) + abs(this%work%forces) + abs(this%work%velocity_terms))
    end associate
    call test%is_true(terms > 1.0_wp, why//': there is something to compare')
    call test%near(maxval(abs(left))/terms, 0.0_wp, 1.0e-13_wp/this%conditioning, why//': Lagrange''s equations hold')
    call complete_accelerations(this%plan, this%dynamics, this%work, this%state)
    call test%near(maxval(abs(this%state%ddq(this%plan%independent) - this%work%accelerations)), 0.0_wp, 0.0_wp, &
                   why//': each acceleration belongs to its coordinate')
    do i = 1, size(this%plan%blocks)
      if (this%plan%blocks(i)%equations == 0) cycle
      if (allocated(right)) deallocate (right)
      allocate (right(this%plan%blocks(i)%equations))
      call block_rates(this%plan, this%plan%blocks(i), 2, this%state, right)
      call test%near(maxval(abs(right))/(1.0_wp + maxval(abs(this%state%ddq))), 0.0_wp, 1.0e-12_wp/this%conditioning, &
                     why//': the closed chains stay closed')
    end do
  end subroutine check_motion

  !> Accelerations against (19), (21) and (25) by differences of closed positions, which lose 1e-9 of the largest number.
  subroutine check_literally(test, this, model, why, compared)
    type(tester_type), intent(inout) :: test         !< gets the outcome
    type(cluster_case_type), intent(inout) :: this   !< mechanism, plans, state and equations with the accelerations
    type(model_type), intent(in) :: model            !< the same mechanism with loads that the literal equations know
    character(len=*), intent(in) :: why              !< the mechanism, printed where its accelerations are wrong
    logical, intent(out) :: compared                 !< the neighbouring positions that the differences need are within reach
    type(literal_type) :: literal
    type(error_type), allocatable :: err
    real(wp), allocatable :: left(:)
    real(wp) :: terms

    call literal_equations(model, this%plan, this%state, literal, err)
    compared = .not. allocated(err)
    if (.not. compared) return
    associate (ddq => this%work%accelerations)
      left = matmul(literal%coefficients, ddq) - literal%forces + literal%velocity_terms
      terms = maxval(matmul(abs(literal%coefficients), abs(ddq)) + abs(literal%forces) + abs(literal%velocity_terms))
    end associate
    call test%near(maxval(abs(left))/terms, 0.0_wp, 1.0e-8_wp, why//': equation (19) taken literally holds')
  end subroutine check_literally

  !> Evaluations allocate nothing.
  subroutine check_memory(test, this)
    type(tester_type), intent(inout) :: test         !< gets the outcome
    type(cluster_case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    type(error_type), allocatable :: err
    integer :: i, before

    before = calls
    call test%is_true(before > 0, 'the counter of allocations counts')
    do i = 1, 10
      call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
      if (allocated(err)) exit
    end do
    call test%is_true(calls == before, 'ten evaluations allocate nothing')
    call test%no_error(err, 'ten evaluations succeed')
  end subroutine check_memory
end module mech9_cluster_case
