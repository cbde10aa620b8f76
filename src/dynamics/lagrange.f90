!> Lagrange's equations in the independent coordinates, (19): coefficients of motion, velocity terms and generalized forces from
!> the Jacobians of the frames.
!>
!> (21) and the terms of (19) that are squares of rates are not differentiated: with the Jacobians J_c of
!> mass centres and J_w of angular velocities,
!>   a_pr = sum m J_c,p . J_c,r + J_w,p . I J_w,r,
!>   h_p  = sum m J_c,p . a_c + J_w,p . (I alpha + omega x I omega)
!> with the accelerations a_c, alpha that rates alone give (no accelerations of independent coordinates);
!> then a ddq_i = Q - h. The result is the same, at O(links I^2). Open chains need no coefficients for their
!> accelerations: the plan says where articulated bodies give them.
module mech9_lagrange
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_dynamics_plan, only: dynamics_plan_type, frame_body_type
  use mech9_lagrange_work, only: lagrange_work_type
  use mech9_block_motion, only: move_block
  use mech9_generalized_forces, only: collect_loads, collect_forces, torque_on_frame
  use mech9_planar_lagrange, only: add_inertia, planar_wrench
  use mech9_articulated_bodies, only: solve_open_chains
  use mech9_planar_articulated, only: solve_in_plane
  use mech9_frame_motion, only: spread_all_accelerations, spread_all_velocities
  implicit none
  private
  public :: find_motion, find_equations, complete_accelerations

contains

  !> Rates of the dependent coordinates and accelerations of the independent ones, for closed positions
  !> (frames in place) and the rates of the independent coordinates in `state`. Dependent accelerations
  !> in `state` are then those that rates alone give. Fails with exit_singular in a singular position of
  !> a block, with exit_data where a coordinate has no inertia, and where a load fails.
  subroutine find_motion(mechanism, plan, dynamics, state, work, err)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(lagrange_work_type), intent(inout) :: work
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: n, failed_at
    logical :: found

    if (dynamics%open_chains) then
      call move_open_chains(mechanism, plan, dynamics, state, work, found, err)
      ! where a coordinate has no inertia, the coefficients tell which
      if (allocated(err) .or. found) return
    end if
    call find_equations(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    n = size(plan%independent)
    if (n == 1 .and. work%coefficients(1, 1) > 0.0_wp) then
      work%accelerations(1) = (work%forces(1) - work%velocity_terms(1))/work%coefficients(1, 1)
      return
    end if
    work%factors = work%coefficients
    call cholesky_factorize(n, work%factors, failed_at)
    if (failed_at > 0) then
      call raise(err, exit_data, 'independent coordinate '//to_text(plan%independent(failed_at))// &
                 ' has no inertia: no link with mass moves with it (apart from those that the independent '// &
                 'coordinates before it move already); give a &body')
      return
    end if
    work%accelerations = work%forces - work%velocity_terms
    call cholesky_solve(n, work%factors, work%accelerations)
  end subroutine find_motion

  !> Coefficients of motion, velocity terms and generalized forces, and the rates of the dependent coordinates;
  !> see find_motion.
  subroutine find_equations(mechanism, plan, dynamics, state, work, err)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(lagrange_work_type), intent(inout) :: work
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: b

    do b = 1, size(plan%independent)
      state%ddq(plan%independent(b)) = 0.0_wp
    end do
    work%expects = .false.
    do b = 1, size(plan%blocks)
      call move_block(plan, dynamics, b, state, work, err)
      if (allocated(err)) return
    end do
    call collect_inertia(dynamics, state, work)
    call collect_loads(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    if (size(dynamics%acting) > 0) call collect_forces(plan, dynamics, state, work)
  end subroutine find_equations

  !> The motion of open chains by articulated bodies. `found` is false where a coordinate has no inertia.
  subroutine move_open_chains(mechanism, plan, dynamics, state, work, found, err)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    type(lagrange_work_type), intent(inout) :: work
    logical, intent(out) :: found
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i, k, f

    found = .false.
    state%ddq = 0.0_wp
    call spread_all_velocities(plan, state)
    call spread_all_accelerations(plan, state)
    call collect_loads(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    do i = 1, size(dynamics%loaded)
      k = dynamics%loaded(i)
      f = plan%frame_of(k)
      if (plan%planar%used) then
        work%planar%applied(:, f) = planar_wrench(plan%planar, k, state%planar%pose(:, f), work%sum%force(:, k), &
                                                  work%sum%torque(:, k))
      else
        work%articulated%applied(1:3, f) = torque_on_frame(plan, state, k, work)
        work%articulated%applied(4:6, f) = work%sum%force(:, k)
      end if
    end do
    if (plan%planar%used) then
      call solve_in_plane(plan%n_coordinates, plan%planar%steps, dynamics%planar_bodies, dynamics%gravity(1:2), &
                          state%planar%pose, state%planar%slide, state%planar%velocity, state%planar%acceleration, &
                          work%sum%generalized, work%planar, work%accelerations, found)
      return
    end if
    call solve_open_chains(dynamics%articulated, plan%n_coordinates, dynamics%gravity, state%r, state%p, state%axis_w, &
                           state%axis_v, state%omega, state%alpha, state%a, work%sum%generalized, work%articulated, &
                           work%accelerations, found)
  end subroutine move_open_chains

  !> a_pr (21) and the velocity terms of (19).
  subroutine collect_inertia(dynamics, state, work)
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(lagrange_work_type), intent(inout) :: work
    integer :: i

    work%coefficients = 0.0_wp
    work%velocity_terms = 0.0_wp
    work%forces = 0.0_wp
    if (allocated(dynamics%planar_bodies)) then
      call add_inertia(size(dynamics%planar_bodies), dynamics%planar_bodies, size(state%q), size(dynamics%column), &
                       dynamics%first, dynamics%column, work%jacobian%flat, state%planar%pose, state%planar%velocity, &
                       state%planar%acceleration, dynamics%gravity(1:2), size(work%forces), work%coefficients, &
                       work%velocity_terms, work%forces)
      return
    end if
    do i = 1, size(dynamics%bodies)
      call add_body(dynamics, dynamics%bodies(i), state, work)
    end do
  end subroutine collect_inertia

  pure subroutine add_body(dynamics, body, state, work)
    type(dynamics_plan_type), intent(in) :: dynamics
    type(frame_body_type), intent(in) :: body
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    type(lagrange_work_type), intent(inout) :: work
    real(wp) :: arm(3), force(3), torque(3), j_c(3), momentum(3), spin(3)
    integer :: f, e, d, p, r

    f = body%frame
    arm = turn(state%r(:, :, f), body%centre)
    force = body%mass*(state%a(:, f) + cross(state%alpha(:, f), arm) &
                       + cross(state%omega(:, f), cross(state%omega(:, f), arm)))
    torque = 0.0_wp
    if (.not. body%is_point) then
      spin = inertia_times(body, state%r(:, :, f), state%omega(:, f))
      torque = inertia_times(body, state%r(:, :, f), state%alpha(:, f)) + cross(state%omega(:, f), spin)
    end if
    do e = dynamics%first(f), dynamics%first(f + 1) - 1
      p = dynamics%column(e)
      j_c = work%jacobian%v(:, e) + cross(work%jacobian%w(:, e), arm)
      work%velocity_terms(p) = work%velocity_terms(p) + dot_product(j_c, force) &
                               + dot_product(work%jacobian%w(:, e), torque)
      work%forces(p) = work%forces(p) + body%mass*dot_product(j_c, dynamics%gravity)
      momentum = body%mass*j_c
      spin = cross(arm, momentum)
      if (.not. body%is_point) spin = spin + inertia_times(body, state%r(:, :, f), work%jacobian%w(:, e))
      ! J_c,r = J_v,r + J_w,r x arm, so that J_c,r . m J_c,p splits into J_v,r and J_w,r
      do d = e, dynamics%first(f + 1) - 1
        r = dynamics%column(d)
        work%coefficients(r, p) = work%coefficients(r, p) + dot_product(work%jacobian%v(:, d), momentum) &
                                  + dot_product(work%jacobian%w(:, d), spin)
      end do
    end do
  end subroutine add_body

  !> The body's inertia tensor, in fixed axes, times a vector.
  pure function inertia_times(body, r, vector) result(product)
    type(frame_body_type), intent(in) :: body
    real(wp), intent(in) :: r(3, 3)          !< of its frame
    real(wp), intent(in) :: vector(3)
    real(wp) :: product(3)

    product = turn(r, turn(body%inertia, turn_back(r, vector)))
  end function inertia_times

  !> After find_motion: the accelerations of all coordinates and frames, for results.
  pure subroutine complete_accelerations(plan, dynamics, work, state)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics
    type(lagrange_work_type), intent(in) :: work
    type(state_type), intent(inout) :: state   !< position and motion of the mechanism
    integer :: s, e

    if (dynamics%open_chains) then
      state%ddq = work%accelerations
      call spread_all_accelerations(plan, state)
      return
    end if
    do s = 1, plan%n_coordinates
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        state%ddq(plan%steps(s)%coordinate) = state%ddq(plan%steps(s)%coordinate) &
                                              + work%jacobian%b(e)*work%accelerations(dynamics%column(e))
      end do
    end do
    call spread_all_accelerations(plan, state)
  end subroutine complete_accelerations
end module mech9_lagrange
