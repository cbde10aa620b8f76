!> Lagrange's equations in the independent coordinates, (19): coefficients of motion, velocity terms and
!> generalized forces from the Jacobians of the frames. Uses the kinematics floor, mechanism, loads,
!> cholesky, dynamics_plan, jacobian, planar_lagrange, articulated_bodies, planar_articulated.
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
  use mech9_error, only: error_type, raise, exit_data, exit_singular
  use mech9_text, only: to_text
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_mechanism, only: mechanism_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type, acceleration_known
  use mech9_motion, only: spread_velocities, spread_accelerations, link_motion
  use mech9_closure, only: closure_rates
  use mech9_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_dynamics_plan, only: dynamics_plan_type, frame_body_type
  use mech9_planar_lagrange, only: add_inertia, planar_wrench, add_link_force
  use mech9_articulated_bodies, only: articulated_work_type, new_articulated_work, solve_open_chains
  use mech9_planar_articulated, only: planar_work_type, new_planar_work, solve_in_plane
  use mech9_jacobian, only: jacobian_type, new_jacobian, find_jacobian, noise_of_rates
  implicit none
  private
  public :: lagrange_work_type, new_lagrange_work, find_motion, find_equations, complete_accelerations, show_state

  !> Blocks whose least pivot is below this are at a singular position.
  real(wp), parameter :: singular = 1.0e-9_wp

  !> Scratch and results of one evaluation, sized once.
  type :: lagrange_work_type
    type(block_work_type), allocatable :: blocks(:)
    type(jacobian_type) :: jacobian
    !> What rates and accelerations are expected to be, by continuation from before: B, entry by entry, and
    !> the accelerations that rates alone give. They only count beside noise; zero will do.
    real(wp), allocatable :: expected_b(:)
    real(wp), allocatable :: expected_ddq(:)
    !> Of find_equations, and of find_motion where the plan does without articulated bodies.
    real(wp), allocatable :: coefficients(:, :)      !< a_pr, lower triangle
    real(wp), allocatable :: factors(:, :)
    real(wp), allocatable :: velocity_terms(:)       !< h_p
    real(wp), allocatable :: forces(:)               !< Q_p
    real(wp), allocatable :: accelerations(:)        !< of the independent coordinates
    type(motion_view_type) :: view
    type(force_sum_type) :: sum
    type(articulated_work_type) :: articulated       !< of open chains, or in the plane:
    type(planar_work_type) :: planar
  end type lagrange_work_type

contains

  !> Scratch for a mechanism with this plan.
  function new_lagrange_work(plan, dynamics) result(work)
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(lagrange_work_type) :: work
    integer :: b, n

    n = size(plan%independent)
    allocate (work%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      work%blocks(b) = new_block_work(plan%blocks(b))
    end do
    work%jacobian = new_jacobian(plan, dynamics)
    allocate (work%expected_b(size(dynamics%column)), work%expected_ddq(plan%n_coordinates), source=0.0_wp)
    allocate (work%coefficients(n, n), work%factors(n, n), source=0.0_wp)
    allocate (work%velocity_terms(n), work%forces(n), work%accelerations(n), source=0.0_wp)
    allocate (work%view%links(plan%n_links))
    allocate (work%view%q(plan%n_coordinates), work%view%dq(plan%n_coordinates), source=0.0_wp)
    work%sum = new_force_sum(plan%n_links, plan%n_coordinates)
    if (.not. dynamics%open_chains) return
    if (plan%planar%used) then
      work%planar = new_planar_work(plan%n_coordinates)
    else
      work%articulated = new_articulated_work(plan%n_coordinates)
    end if
  end function new_lagrange_work

  !> Rates of the dependent coordinates and accelerations of the independent ones, for closed positions
  !> (frames in place) and the rates of the independent coordinates in `state`. Dependent accelerations
  !> in `state` are then those that rates alone give. Fails with exit_singular in a singular position of
  !> a block, with exit_data where a coordinate has no inertia, and where a load fails.
  subroutine find_motion(mechanism, plan, dynamics, state, work, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(inout) :: state
    type(lagrange_work_type), intent(inout) :: work
    type(error_type), allocatable, intent(out) :: err
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
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(inout) :: state
    type(lagrange_work_type), intent(inout) :: work
    type(error_type), allocatable, intent(out) :: err
    integer :: b

    state%ddq(plan%independent) = 0.0_wp
    do b = 1, size(plan%blocks)
      call move_block(plan, dynamics, b, state, work, err)
      if (allocated(err)) return
    end do
    call collect_inertia(dynamics, state, work)
    call collect_loads(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    if (size(mechanism%loads) > 0) call collect_forces(plan, dynamics, state, work)
  end subroutine find_equations

  !> The motion of open chains by articulated bodies. `found` is false where a coordinate has no inertia.
  subroutine move_open_chains(mechanism, plan, dynamics, state, work, found, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(inout) :: state
    type(lagrange_work_type), intent(inout) :: work
    logical, intent(out) :: found
    type(error_type), allocatable, intent(out) :: err
    integer :: i, f

    found = .false.
    state%ddq = 0.0_wp
    call spread_velocities(plan, 1, plan%n_coordinates, state)
    call spread_accelerations(plan, 1, plan%n_coordinates, state)
    call collect_loads(mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    do i = 2, plan%n_links
      if (.not. dynamics%load_links(i)) cycle
      f = plan%frame_of(i)
      if (plan%planar%used) then
        work%planar%applied(:, f) = planar_wrench(plan%planar, i, state%planar%pose(:, f), work%sum%force(:, i), &
                                                  work%sum%torque(:, i))
      else
        work%articulated%applied(1:3, f) = torque_on_frame(plan, state, i, work)
        work%articulated%applied(4:6, f) = work%sum%force(:, i)
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

  !> Rates and Jacobians of one block, and its accelerations from rates alone.
  subroutine move_block(plan, dynamics, b, state, work, err)
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    integer, intent(in) :: b
    type(state_type), intent(inout) :: state
    type(lagrange_work_type), intent(inout) :: work
    type(error_type), allocatable, intent(out) :: err
    integer :: i, s, e
    real(wp) :: rate

    associate (block => plan%blocks(b))
      if (size(block%unknowns) > 0) then
        call factorize_block(plan, block, state, work%blocks(b))
        if (work%blocks(b)%equations%conditioning() < singular) then
          call raise(err, exit_singular, 'a closed chain is in a singular position for these independent coordinates')
          return
        end if
      end if
      call find_jacobian(plan, dynamics, block, state, work%expected_b, work%blocks(b), work%jacobian)
      do i = 1, size(block%unknowns)
        s = block%unknowns(i)
        rate = 0.0_wp
        do e = dynamics%first(s), dynamics%first(s + 1) - 1
          rate = rate + work%jacobian%b(e)*state%dq(plan%independent(dynamics%column(e)))
        end do
        state%dq(plan%steps(s)%coordinate) = rate
      end do
      call spread_velocities(plan, block%first_step, block%last_step, state)
      call find_bias(plan, block, work%expected_ddq, state, work%blocks(b))
    end associate
  end subroutine move_block

  !> Accelerations that rates alone give a block, from what is expected; see find_jacobian.
  subroutine find_bias(plan, block, expected, state, work)
    type(plan_type), intent(in) :: plan
    type(block_type), intent(in) :: block
    real(wp), intent(in) :: expected(:)       !< (M)
    type(state_type), intent(inout) :: state
    type(block_work_type), intent(inout) :: work
    real(wp) :: scale
    integer :: i, k

    if (size(block%unknowns) == 0) then
      call spread_accelerations(plan, block%first_step, block%last_step, state)
      return
    end if
    scale = 0.0_wp
    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      state%ddq(k) = expected(k)
      scale = max(scale, (state%dq(k)/plan%unit_of(k))**2)
    end do
    call spread_accelerations(plan, block%first_step, block%last_step, state)
    call closure_rates(plan, block, state, acceleration_known, work%right)
    work%right = -work%right
    call work%equations%solve(work%right, work%change, noise=noise_of_rates*scale)
    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      state%ddq(k) = state%ddq(k) + work%change(i)*plan%unit_of(k)
    end do
    call spread_accelerations(plan, block%first_step, block%last_step, state)
  end subroutine find_bias

  !> a_pr (21) and the velocity terms of (19).
  subroutine collect_inertia(dynamics, state, work)
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(in) :: state
    type(lagrange_work_type), intent(inout) :: work
    integer :: i

    work%coefficients = 0.0_wp
    work%velocity_terms = 0.0_wp
    work%forces = 0.0_wp
    do i = 1, size(dynamics%bodies)
      if (allocated(dynamics%planar_bodies)) then
        call add_planar_body(dynamics, i, state, work)
      else
        call add_body(dynamics, dynamics%bodies(i), state, work)
      end if
    end do
  end subroutine collect_inertia

  pure subroutine add_body(dynamics, body, state, work)
    type(dynamics_plan_type), intent(in) :: dynamics
    type(frame_body_type), intent(in) :: body
    type(state_type), intent(in) :: state
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

  pure subroutine add_planar_body(dynamics, i, state, work)
    type(dynamics_plan_type), intent(in) :: dynamics
    integer, intent(in) :: i
    type(state_type), intent(in) :: state
    type(lagrange_work_type), intent(inout) :: work
    integer :: f, first, last

    f = dynamics%planar_bodies(i)%frame
    first = dynamics%first(f)
    last = dynamics%first(f + 1) - 1
    call add_inertia(dynamics%planar_bodies(i), last - first + 1, size(work%forces), dynamics%column(first:last), &
                     work%jacobian%flat(:, first:last), state%planar%pose(:, f), state%planar%velocity(:, f), &
                     state%planar%acceleration(:, f), dynamics%gravity(1:2), work%coefficients, &
                     work%velocity_terms, work%forces)
  end subroutine add_planar_body

  !> The body's inertia tensor, in fixed axes, times a vector.
  pure function inertia_times(body, r, vector) result(product)
    type(frame_body_type), intent(in) :: body
    real(wp), intent(in) :: r(3, 3)          !< of its frame
    real(wp), intent(in) :: vector(3)
    real(wp) :: product(3)

    product = turn(r, turn(body%inertia, turn_back(r, vector)))
  end function inertia_times

  !> What the loads exert, on links and on coordinates.
  subroutine collect_loads(mechanism, plan, dynamics, state, work, err)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(in) :: state
    type(lagrange_work_type), intent(inout) :: work
    type(error_type), allocatable, intent(out) :: err
    integer :: i

    if (size(mechanism%loads) == 0) return
    call show_state(plan, dynamics, state, work%view)
    call work%sum%clear()
    do i = 1, size(mechanism%loads)
      call mechanism%loads(i)%load%apply(work%view, work%sum, err)
      if (allocated(err)) return
    end do
  end subroutine collect_loads

  !> Q_p (25) of what the loads exert.
  pure subroutine collect_forces(plan, dynamics, state, work)
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(in) :: state
    type(lagrange_work_type), intent(inout) :: work
    integer :: i, e, p, s

    do i = 2, plan%n_links
      if (.not. dynamics%load_links(i)) cycle
      call add_forces_on_link(plan, dynamics, state, i, work)
    end do
    do i = 1, plan%n_coordinates
      if (.not. abs(work%sum%generalized(i)) > 0.0_wp) cycle
      s = plan%step_of(i)
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        p = dynamics%column(e)
        work%forces(p) = work%forces(p) + work%jacobian%b(e)*work%sum%generalized(i)
      end do
    end do
  end subroutine collect_forces

  pure subroutine add_forces_on_link(plan, dynamics, state, link, work)
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(in) :: state
    integer, intent(in) :: link
    type(lagrange_work_type), intent(inout) :: work
    real(wp) :: torque(3)
    integer :: f, first, last, e, p

    f = plan%frame_of(link)
    first = dynamics%first(f)
    last = dynamics%first(f + 1) - 1
    if (plan%planar%used) then
      call add_link_force(plan%planar, link, last - first + 1, dynamics%column(first:last), &
                          work%jacobian%flat(:, first:last), state%planar%pose(:, f), work%sum%force(:, link), &
                          work%sum%torque(:, link), work%forces)
      return
    end if
    torque = torque_on_frame(plan, state, link, work)
    do e = first, last
      p = dynamics%column(e)
      work%forces(p) = work%forces(p) + dot_product(work%jacobian%v(:, e), work%sum%force(:, link)) &
                       + dot_product(work%jacobian%w(:, e), torque)
    end do
  end subroutine add_forces_on_link

  !> Torque of the loads on a link about the origin of its frame.
  pure function torque_on_frame(plan, state, link, work) result(torque)
    type(plan_type), intent(in) :: plan
    type(state_type), intent(in) :: state
    integer, intent(in) :: link
    type(lagrange_work_type), intent(in) :: work
    real(wp) :: torque(3), arm(3)

    arm = work%view%links(link)%p - plan%origin - state%p(:, plan%frame_of(link))
    torque = work%sum%torque(:, link) + cross(arm, work%sum%force(:, link))
  end function torque_on_frame

  !> The state as loads see it: the links' own systems in that of link 1.
  pure subroutine show_state(plan, dynamics, state, view)
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(state_type), intent(in) :: state
    type(motion_view_type), intent(inout) :: view
    integer :: i

    view%t = state%t
    view%q = state%q
    view%dq = state%dq
    ! link 1 stays where it is
    do i = 2, plan%n_links
      if (.not. dynamics%load_links(i)) cycle
      call link_motion(plan, state, i, view%links(i)%r, view%links(i)%p, view%links(i)%omega, view%links(i)%v)
    end do
  end subroutine show_state

  !> After find_motion: the accelerations of all coordinates and frames, for results.
  pure subroutine complete_accelerations(plan, dynamics, work, state)
    type(plan_type), intent(in) :: plan
    type(dynamics_plan_type), intent(in) :: dynamics
    type(lagrange_work_type), intent(in) :: work
    type(state_type), intent(inout) :: state
    integer :: s, e

    if (dynamics%open_chains) then
      state%ddq = work%accelerations
      call spread_accelerations(plan, 1, plan%n_coordinates, state)
      return
    end if
    do s = 1, plan%n_coordinates
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        state%ddq(plan%steps(s)%coordinate) = state%ddq(plan%steps(s)%coordinate) &
                                              + work%jacobian%b(e)*work%accelerations(dynamics%column(e))
      end do
    end do
    call spread_accelerations(plan, 1, plan%n_coordinates, state)
  end subroutine complete_accelerations
end module mech9_lagrange
