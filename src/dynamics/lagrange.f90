!> Lagrange's equations in the independent coordinates, (19): coefficients of motion, velocity terms and generalized forces from
!> the Jacobians of the frames.
!>
!> The coefficients (21) and the terms of (19) that are quadratic in the rates are found without differentiation: with the
!> Jacobians J_c of mass centres and J_w of angular velocities,
!>   a_pr = sum m J_c,p . J_c,r + J_w,p . I J_w,r,
!>   h_p  = sum m J_c,p . a_c + J_w,p . (I alpha + omega x I omega)
!> with the accelerations a_c, alpha that rates alone give (no accelerations of independent coordinates);
!> then a ddq_i = Q - h. The result is the same, at the cost O(links I^2) for I independent coordinates of one closed cluster.
!>
!> Driven coordinates have the accelerations of their drives, which count among those that rates alone give: then h_p contains
!> a_pd ddq_d, and the unknowns of the equations are what the free accelerations add to these (the terms of (19) for driven
!> coordinates are moved to the right side). The accelerations that are found are zero for driven coordinates.
!>
!> The accelerations of other mechanisms do not require the coefficients: articulated bodies give them, in O(links).
module mech9_lagrange
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_dynamics_failures, only: failure_no_inertia
  use mech9_tolerances, only: negligible_inertia
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_driven_equations, only: hold
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_block_motion, only: move_block
  use mech9_generalized_forces, only: collect_loads, collect_forces, add_generalized
  use mech9_frame_motion, only: spread_all_velocities, spread_all_accelerations, show_all_frames
  implicit none
  private
  public :: find_motion, find_equations, check_inertia, complete_accelerations

contains

  !> Rates of the dependent coordinates and accelerations of the independent ones, for the poses of the frames, which must
  !> satisfy all closures, and the rates of the independent coordinates in `state`. Dependent accelerations in `state` are
  !> then those that rates alone give. Fails in a singular position of a block, where a coordinate has no inertia, and where
  !> a load fails.
  subroutine find_motion(mechanism, plan, dynamics, state, work, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    type(state_type), intent(inout) :: state            !< with poses and independent rates; gets rates and accelerations from rates
    type(lagrange_work_type), intent(inout) :: work     !< scratch; gets `accelerations`
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: n, failed_at
    logical :: found

    if (dynamics%articulated) then
      call move_tree(mechanism, plan, dynamics, state, work, found, err)
      ! the coefficients show the number of a coordinate without inertia
      if (allocated(err) .or. found) return
    end if
    call find_equations(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    n = size(plan%independent)
    if (n == 1 .and. size(plan%free) == 1 .and. work%coefficients(1, 1) > 0.0_wp) then
      work%accelerations(1) = (work%forces(1) - work%velocity_terms(1))/work%coefficients(1, 1)
      return
    end if
    work%factors = work%coefficients
    work%accelerations = work%forces - work%velocity_terms
    if (size(dynamics%held) > 0) call hold(n, dynamics%held, work%factors, work%accelerations)
    call cholesky_factorize(n, work%factors, failed_at)
    if (failed_at > 0) then
      call raise(err, exit_data, failure_no_inertia)
      err%failure%coordinates = [plan%independent(failed_at)]
      return
    end if
    call cholesky_solve(n, work%factors, work%accelerations)
  end subroutine find_motion

  !> Fail with exit_data where a coefficient of motion is no inertia but round-off: the rate of its coordinate moves no mass, by
  !> rates that should be zero.
  subroutine check_inertia(plan, dynamics, work, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    type(lagrange_work_type), intent(in) :: work        !< with the coefficients of motion
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: largest
    integer :: i, k

    largest = 0.0_wp
    do i = 1, size(dynamics%bodies)
      associate (body => dynamics%bodies(i))
        largest = largest + body%mass*plan%length**2 + body%inertia(1, 1) + body%inertia(2, 2) + body%inertia(3, 3)
      end associate
    end do
    do i = 1, size(plan%independent)
      k = plan%independent(i)
      if (plan%driven(k) .or. work%coefficients(i, i)*plan%unit_of(k)**2 > negligible_inertia*largest) cycle
      call raise(err, exit_data, failure_no_inertia)
      err%failure%coordinates = [k]
      return
    end do
  end subroutine check_inertia

  !> Coefficients of motion, velocity terms and generalized forces, and the rates of the dependent coordinates;
  !> see find_motion.
  subroutine find_equations(mechanism, plan, dynamics, state, work, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    type(state_type), intent(inout) :: state            !< poses and independent rates in; velocities, accelerations from rates out
    type(lagrange_work_type), intent(inout) :: work     !< scratch; gets `coefficients`, `velocity_terms`, `forces`
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: b

    call move_blocks(plan, dynamics, state, work, err)
    if (allocated(err)) return
    call collect_loads(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    if (dynamics%articulated) then
      do b = 1, size(plan%blocks)
        call dynamics%arithmetics(dynamics%arithmetic_of(b))%kind%spread_jacobian(plan, dynamics, plan%blocks(b), state, .true., &
                                                                                  work%jacobian)
      end do
      call show_all_frames(plan, state)
      call dynamics%arithmetics(1)%kind%weigh_tree(plan, dynamics, state, work)
    else
      call collect_inertia(dynamics, state, work)
      if (size(dynamics%acting) > 0) call collect_forces(plan, dynamics, state, work)
    end if
    call add_generalized(plan, dynamics, work)
  end subroutine find_equations

  !> The motion of all blocks by rates alone.
  subroutine move_blocks(plan, dynamics, state, work, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    type(state_type), intent(inout) :: state            !< poses and independent rates in; velocities, accelerations from rates out
    type(lagrange_work_type), intent(inout) :: work     !< scratch; gets the Jacobian entries of all blocks
    type(error_type), allocatable, intent(out) :: err   !< allocated if a block is in a singular position
    integer :: i, b

    do i = 1, size(plan%free)
      state%ddq(plan%free(i)) = 0.0_wp
    end do
    work%conditioning = 1.0_wp
    if (size(plan%closures) == 0) then
      call spread_all_velocities(plan, state)
      call spread_all_accelerations(plan, state)
      return
    end if
    work%expects = .false.
    do b = 1, size(plan%blocks)
      call move_block(plan, dynamics, b, state, work, err)
      if (allocated(err)) return
    end do
  end subroutine move_blocks

  !> The motion by articulated bodies. `found` is false where a coordinate has no inertia.
  subroutine move_tree(mechanism, plan, dynamics, state, work, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    type(state_type), intent(inout) :: state            !< poses and independent rates in; velocities, accelerations from rates out
    type(lagrange_work_type), intent(inout) :: work     !< scratch; gets `accelerations`
    logical, intent(out) :: found                       !< whether all coordinates have inertia
    type(error_type), allocatable, intent(out) :: err   !< allocated in a singular position, or if a load failed

    found = .false.
    call move_blocks(plan, dynamics, state, work, err)
    if (allocated(err)) return
    call collect_loads(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    call dynamics%arithmetics(1)%kind%solve_tree(plan, dynamics, state, work, found)
  end subroutine move_tree

  !> The coefficients a_pr (21), the velocity terms of (19), and the generalized forces of the weights.
  subroutine collect_inertia(dynamics, state, work)
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with velocities and the accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work    !< with the Jacobian; gets `coefficients`, `velocity_terms`, `forces`

    work%coefficients = 0.0_wp
    work%velocity_terms = 0.0_wp
    work%forces = 0.0_wp
    call dynamics%arithmetics(1)%kind%add_inertia(dynamics, state, work)
  end subroutine collect_inertia

  !> The accelerations of all coordinates and frames, for results, after find_motion.
  pure subroutine complete_accelerations(plan, dynamics, work, state)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(lagrange_work_type), intent(in) :: work       !< with the results of find_motion
    type(state_type), intent(inout) :: state           !< as find_motion left it; gets the accelerations
    integer :: s, e

    do s = 1, plan%n_coordinates
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        state%ddq(plan%steps(s)%coordinate) = state%ddq(plan%steps(s)%coordinate) &
                                              + work%jacobian%b(e)*work%accelerations(dynamics%column(e))
      end do
    end do
    call spread_all_accelerations(plan, state)
  end subroutine complete_accelerations
end module mech9_lagrange
