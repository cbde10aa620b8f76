!> The forces that the motion of a mechanism requires along the spanning tree (Newton and Euler), and their variations.
!>
!> A frame must be given the inertial forces of all bodies beyond it, less weights and loads. The force that the coordinate of
!> a step then requires is the power of the forces at its frame per unit rate. Forces of closed chains count as loads on
!> their two frames. All vectors are in the axes of frame 0.
module mech9_tree_forces
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motion_change, only: motion_change_type, new_motion_change
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type, frame_body_type
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_generalized_forces, only: collect_loads, sum_loads, show_state
  use mech9_variation, only: variation_type
  implicit none
  private
  public :: tree_forces_type, new_tree_forces, find_tree_forces, vary_tree_forces, loop_wrench_type, add_body, add_loads, &
            show_variation

  !> The force of a closed chain on its closing frame, and its moment about the origin of the frame in which the loop starts, in
  !> the axes of that frame. The target gets the opposite.
  type :: loop_wrench_type
    real(wp) :: force(3) = 0.0_wp    !< [N]
    real(wp) :: moment(3) = 0.0_wp   !< [N m]
  end type loop_wrench_type

  !> Forces at one motion, and scratch.
  type :: tree_forces_type
    real(wp), allocatable :: force(:, :)           !< (3,0:M) that each frame must be given [N]
    real(wp), allocatable :: moment(:, :)          !< (3,0:M) about the origin of the frame [N m]
    real(wp), allocatable :: required(:)           !< (M) force that each coordinate requires [N m, N]
    !> Sum of the magnitudes of all inertial forces, weights and loads, as an energy over one length or one rad [J]: forces below
    !> round-off of this are zero.
    real(wp) :: magnitude = 0.0_wp
    class(lagrange_work_type), allocatable :: loads   !< sums of the loads, and the motion that they read
    real(wp), allocatable :: force_change(:, :)    !< (3,0:M) derivative of `force`
    real(wp), allocatable :: moment_change(:, :)   !< (3,0:M) derivative of `moment`
    real(wp), allocatable :: required_change(:)    !< (M) derivative of `required`
    real(wp) :: magnitude_change = 0.0_wp          !< sum of the magnitudes of all derivatives [J per unit of the parameter]
    type(motion_change_type) :: change             !< derivative of the motion that loads read
    type(force_sum_type) :: load_change            !< derivatives of the loads
  end type tree_forces_type

contains

  !> Room for the forces of a mechanism.
  subroutine new_tree_forces(plan, dynamics, forces)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism, in space
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(tree_forces_type), intent(out) :: forces      !< gets its room
    integer :: m

    m = plan%n_coordinates
    allocate (forces%loads, source=new_lagrange_work(plan, dynamics))
    allocate (forces%force(3, 0:m), forces%moment(3, 0:m), forces%force_change(3, 0:m), forces%moment_change(3, 0:m), &
              source=0.0_wp)
    allocate (forces%required(m), forces%required_change(m), source=0.0_wp)
    forces%change = new_motion_change(plan%n_links, m)
    forces%load_change = new_force_sum(plan%n_links, m)
  end subroutine new_tree_forces

  !> The forces at a motion whose coordinates, velocities and accelerations are known. Fails where a load does.
  subroutine find_tree_forces(mechanism, plan, dynamics, state, forces, err, wrenches)
    type(mechanism_type), intent(in) :: mechanism           !< the mechanism
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism, in space
    type(dynamics_plan_type), intent(in) :: dynamics        !< the plan of dynamics
    type(state_type), intent(in) :: state                   !< position and motion of the mechanism
    type(tree_forces_type), intent(inout) :: forces         !< gets the forces
    type(error_type), allocatable, intent(out) :: err       !< allocated if a load failed
    type(loop_wrench_type), intent(in), optional :: wrenches(:)   !< (closures) of the closed chains; none unless given
    integer :: i

    forces%force = 0.0_wp
    forces%moment = 0.0_wp
    forces%magnitude = 0.0_wp
    do i = 1, size(dynamics%bodies)
      call add_body(dynamics%bodies(i), dynamics%gravity, state, plan%length, forces)
    end do
    call add_magnitudes(mechanism, plan, dynamics, state, forces, err)
    if (.not. allocated(err)) call collect_loads(mechanism, plan, dynamics, state, forces%loads, err)
    if (allocated(err)) return
    if (size(dynamics%acting) > 0) call add_loads(plan, dynamics, state, forces)
    if (present(wrenches)) call add_wrenches(plan, state, wrenches, forces)
    call sweep_inward(plan, state, forces)
  end subroutine find_tree_forces

  !> Add the inertial force of a body, less its weight, at its frame, and its magnitude.
  subroutine add_body(body, gravity, state, length, forces)
    type(frame_body_type), intent(in) :: body         !< the body
    real(wp), intent(in) :: gravity(3)                !< [m/s^2]
    type(state_type), intent(in) :: state             !< position and motion of the mechanism
    real(wp), intent(in) :: length                    !< size of the mechanism [m]
    type(tree_forces_type), intent(inout) :: forces   !< gets the force at the body's frame
    real(wp) :: arm(3), force(3), couple(3), spin(3), slip(3)

    associate (f => body%frame, r => state%r(:, :, body%frame), omega => state%omega(:, body%frame))
      arm = turn(r, body%centre)
      slip = cross(omega, arm)
      force = body%mass*(state%a(:, f) + cross(state%alpha(:, f), arm) + cross(omega, slip) - gravity)
      couple = 0.0_wp
      if (.not. body%is_point) then
        spin = turned_inertia(body, r, omega)
        couple = turned_inertia(body, r, state%alpha(:, f)) + cross(omega, spin)
      end if
      forces%force(:, f) = forces%force(:, f) + force
      forces%moment(:, f) = forces%moment(:, f) + couple + cross(arm, force)
      forces%magnitude = forces%magnitude + (body%mass*norm2(gravity) + norm2(force))*(length + norm2(arm)) + norm2(couple)
    end associate
  end subroutine add_body

  !> The inertia tensor of a body times a vector.
  pure function turned_inertia(body, r, vector) result(product)
    type(frame_body_type), intent(in) :: body   !< the body
    real(wp), intent(in) :: r(3, 3)             !< rotation of its frame
    real(wp), intent(in) :: vector(3)           !< in the axes of frame 0
    real(wp) :: product(3)

    product = turn_back(r, vector)
    product = turn(body%inertia, product)
    product = turn(r, product)
  end function turned_inertia

  !> Subtract the loads whose sums are known at the frames of their links.
  subroutine add_loads(plan, dynamics, state, forces)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism, in space
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< position and motion of the mechanism
    type(tree_forces_type), intent(inout) :: forces    !< with the sums of the loads; gets them
    real(wp) :: arm(3)
    integer :: i, f, k

    do i = 1, size(dynamics%loaded)
      k = dynamics%loaded(i)
      f = plan%frame_of(k)
      associate (force => forces%loads%sum%force(:, k), torque => forces%loads%sum%torque(:, k))
        arm = turn(state%r(:, :, f), plan%link_in_frame(k)%p)
        forces%force(:, f) = forces%force(:, f) - force
        forces%moment(:, f) = forces%moment(:, f) - torque - cross(arm, force)
      end associate
    end do
  end subroutine add_loads

  !> Add the magnitude of each load and motor by itself, since they may cancel each other in their sums.
  subroutine add_magnitudes(mechanism, plan, dynamics, state, forces, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism, in space
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    type(state_type), intent(in) :: state               !< position and motion of the mechanism
    type(tree_forces_type), intent(inout) :: forces     !< gets the magnitudes; its sums of the loads are overwritten
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    integer :: i, j

    associate (loads => forces%loads%sum, view => forces%loads%view)
      do i = 1, size(dynamics%acting)
        call sum_loads(mechanism, plan, dynamics%acting(i:i), dynamics%loaded, state, view, loads, err)
        if (allocated(err)) return
        do j = 1, size(dynamics%loaded)
          associate (k => dynamics%loaded(j))
            forces%magnitude = forces%magnitude + norm2(loads%force(:, k))*plan%length + norm2(loads%torque(:, k))
          end associate
        end do
        forces%magnitude = forces%magnitude + sum(abs(loads%generalized)*plan%unit_of)
      end do
      if (size(mechanism%motors) > 0) call show_state(plan, dynamics, state, view)
      do i = 1, size(mechanism%motors)
        call loads%clear()
        call mechanism%motors(i)%motor%apply(view, loads, err)
        if (allocated(err)) return
        forces%magnitude = forces%magnitude + sum(abs(loads%generalized)*plan%unit_of)
      end do
    end associate
  end subroutine add_magnitudes

  !> Subtract the forces of closed chains.
  pure subroutine add_wrenches(plan, state, wrenches, forces)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state              !< position of the mechanism
    type(loop_wrench_type), intent(in) :: wrenches(:)  !< (closures) of the closed chains
    type(tree_forces_type), intent(inout) :: forces    !< gets them
    real(wp) :: force(3), moment(3), arm(3)
    integer :: c, b, e, f

    do c = 1, size(plan%closures)
      b = plan%closures(c)%base
      force = turn(state%r(:, :, b), wrenches(c)%force)
      moment = turn(state%r(:, :, b), wrenches(c)%moment)
      do e = 1, 2
        f = merge(plan%closures(c)%closing, plan%closures(c)%target, e == 1)
        arm = state%p(:, b) - state%p(:, f)
        forces%force(:, f) = forces%force(:, f) - force
        forces%moment(:, f) = forces%moment(:, f) - moment - cross(arm, force)
        force = -force
        moment = -moment
      end do
    end do
  end subroutine add_wrenches

  !> Hand the forces of each frame on to its parent, and find those that the coordinates require.
  pure subroutine sweep_inward(plan, state, forces)
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state             !< position of the mechanism
    type(tree_forces_type), intent(inout) :: forces   !< with the forces at each frame; gets the sums
    real(wp) :: arm(3)
    integer :: s, i, k

    do s = plan%n_coordinates, 1, -1
      i = plan%steps(s)%parent
      k = plan%steps(s)%coordinate
      associate (force => forces%force, moment => forces%moment)
        forces%required(k) = dot_product(state%axis_w(:, s), moment(:, s)) + dot_product(state%axis_v(:, s), force(:, s)) &
                             - forces%loads%sum%generalized(k)
        arm = state%p(:, s) - state%p(:, i)
        force(:, i) = force(:, i) + force(:, s)
        moment(:, i) = moment(:, i) + moment(:, s) + cross(arm, force(:, s))
      end associate
    end do
  end subroutine sweep_inward

  !> The derivatives of the forces that the coordinates require, with the forces of closed chains held as given to
  !> find_tree_forces. Fails where a load does.
  subroutine vary_tree_forces(mechanism, plan, dynamics, state, variation, forces, err, wrenches)
    type(mechanism_type), intent(in) :: mechanism           !< the mechanism
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism, in space
    type(dynamics_plan_type), intent(in) :: dynamics        !< the plan of dynamics
    type(state_type), intent(in) :: state                   !< position and motion of the mechanism
    type(variation_type), intent(in) :: variation           !< of this motion
    type(tree_forces_type), intent(inout) :: forces         !< at this motion; gets the derivatives
    type(error_type), allocatable, intent(out) :: err       !< allocated if a load failed
    type(loop_wrench_type), intent(in), optional :: wrenches(:)   !< (closures) of the closed chains; none unless given
    integer :: i

    forces%force_change = 0.0_wp
    forces%moment_change = 0.0_wp
    forces%magnitude_change = 0.0_wp
    do i = 1, size(dynamics%bodies)
      call vary_body(dynamics%bodies(i), dynamics%gravity, state, variation, plan%length, forces)
    end do
    call forces%load_change%clear()
    if (size(dynamics%acting) > 0 .or. size(mechanism%motors) > 0) &
      call vary_loads(mechanism, plan, dynamics, state, variation, forces, err)
    if (allocated(err)) return
    if (present(wrenches)) call vary_wrenches(plan, state, variation, wrenches, forces)
    call sweep_changes(plan, state, variation, forces)
  end subroutine vary_tree_forces

  !> Add the derivative of the inertial force of a body, less its weight.
  pure subroutine vary_body(body, gravity, state, variation, length, forces)
    type(frame_body_type), intent(in) :: body         !< the body
    real(wp), intent(in) :: gravity(3)                !< [m/s^2]
    type(state_type), intent(in) :: state             !< position and motion of the mechanism
    type(variation_type), intent(in) :: variation     !< of this motion
    real(wp), intent(in) :: length                    !< size of the mechanism [m]
    type(tree_forces_type), intent(inout) :: forces   !< gets the derivative
    real(wp) :: arm(3), arm_change(3), slip(3), slip_change(3), force(3), force_change(3), couple_change(3)

    associate (f => body%frame, r => state%r(:, :, body%frame), omega => state%omega(:, body%frame), &
               alpha => state%alpha(:, body%frame), omega_change => variation%omega(:, body%frame), &
               alpha_change => variation%alpha(:, body%frame))
      arm = turn(r, body%centre)
      arm_change = cross(variation%turn(:, f), arm)
      slip = cross(omega, arm)
      slip_change = cross(omega_change, arm) + cross(omega, arm_change)
      force = body%mass*(state%a(:, f) + cross(alpha, arm) + cross(omega, slip) - gravity)
      force_change = body%mass*(variation%a(:, f) + cross(alpha_change, arm) + cross(alpha, arm_change) &
                                + cross(omega_change, slip) + cross(omega, slip_change))
      couple_change = 0.0_wp
      if (.not. body%is_point) couple_change = change_of_couple(body, r, omega, alpha, variation%turn(:, f), omega_change, &
                                                                alpha_change)
      forces%force_change(:, f) = forces%force_change(:, f) + force_change
      forces%moment_change(:, f) = forces%moment_change(:, f) + couple_change + cross(arm_change, force) &
                                   + cross(arm, force_change)
      forces%magnitude_change = forces%magnitude_change + norm2(couple_change) &
                                + norm2(force_change)*(length + norm2(arm)) + norm2(force)*norm2(arm_change)
    end associate
  end subroutine vary_body

  !> Derivative of I alpha + omega x I omega, for a body whose frame turns.
  pure function change_of_couple(body, r, omega, alpha, turned, omega_change, alpha_change) result(change)
    type(frame_body_type), intent(in) :: body   !< the body
    real(wp), intent(in) :: r(3, 3)             !< rotation of its frame
    real(wp), intent(in) :: omega(3)            !< angular velocity [rad/s]
    real(wp), intent(in) :: alpha(3)            !< angular acceleration [rad/s^2]
    real(wp), intent(in) :: turned(3)           !< rotation of the frame [rad]
    real(wp), intent(in) :: omega_change(3)     !< derivative of omega
    real(wp), intent(in) :: alpha_change(3)     !< derivative of alpha
    real(wp) :: change(3), spin(3), spin_change(3)

    spin = turned_inertia(body, r, omega)
    spin_change = change_of_spin(body, r, omega, turned, omega_change)
    change = change_of_spin(body, r, alpha, turned, alpha_change) + cross(omega_change, spin) + cross(omega, spin_change)
  end function change_of_couple

  !> Derivative of I x, for a body whose frame turns: (turned x I x) - I (turned x x) + I (derivative of x).
  pure function change_of_spin(body, r, vector, turned, vector_change) result(change)
    type(frame_body_type), intent(in) :: body      !< the body
    real(wp), intent(in) :: r(3, 3)                !< rotation of its frame
    real(wp), intent(in) :: vector(3)              !< x, in the axes of frame 0
    real(wp), intent(in) :: turned(3)              !< rotation of the frame [rad]
    real(wp), intent(in) :: vector_change(3)       !< derivative of x
    real(wp) :: change(3), spin(3), relative(3)

    spin = turned_inertia(body, r, vector)
    relative = vector_change - cross(turned, vector)
    change = cross(turned, spin) + turned_inertia(body, r, relative)
  end function change_of_spin

  !> Subtract the derivatives of the loads and motors.
  subroutine vary_loads(mechanism, plan, dynamics, state, variation, forces, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism, in space
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    type(state_type), intent(in) :: state               !< position and motion of the mechanism
    type(variation_type), intent(in) :: variation       !< of this motion
    type(tree_forces_type), intent(inout) :: forces     !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    real(wp) :: arm(3), arm_change(3)
    integer :: i, f, k

    call show_state(plan, dynamics, state, forces%loads%view)
    call show_variation(plan, dynamics, state, variation, forces%change)
    do i = 1, size(dynamics%acting)
      call mechanism%loads(dynamics%acting(i))%load%vary(forces%loads%view, forces%change, forces%load_change, err)
      if (allocated(err)) return
    end do
    do i = 1, size(mechanism%motors)
      call mechanism%motors(i)%motor%vary(forces%loads%view, forces%change, forces%load_change, err)
      if (allocated(err)) return
    end do
    do i = 1, size(dynamics%loaded)
      k = dynamics%loaded(i)
      f = plan%frame_of(k)
      associate (force => forces%loads%sum%force(:, k), force_change => forces%load_change%force(:, k), &
                 torque_change => forces%load_change%torque(:, k))
        arm = turn(state%r(:, :, f), plan%link_in_frame(k)%p)
        arm_change = cross(variation%turn(:, f), arm)
        forces%force_change(:, f) = forces%force_change(:, f) - force_change
        forces%moment_change(:, f) = forces%moment_change(:, f) - torque_change - cross(arm_change, force) &
                                     - cross(arm, force_change)
        forces%magnitude_change = forces%magnitude_change + norm2(force_change)*plan%length + norm2(torque_change) &
                                  + norm2(force)*norm2(arm_change)
      end associate
    end do
    forces%magnitude_change = forces%magnitude_change + sum(abs(forces%load_change%generalized)*plan%unit_of)
  end subroutine vary_loads

  !> The variation as loads read it.
  pure subroutine show_variation(plan, dynamics, state, variation, change)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism, in space
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< position and motion of the mechanism
    type(variation_type), intent(in) :: variation      !< of this motion
    type(motion_change_type), intent(inout) :: change  !< gets coordinates and the links on which loads depend
    real(wp) :: arm(3), arm_change(3)
    integer :: i, k, f

    change%q = variation%q
    change%dq = variation%dq
    do i = 1, size(dynamics%loaded)
      k = dynamics%loaded(i)
      f = plan%frame_of(k)
      arm = turn(state%r(:, :, f), plan%link_in_frame(k)%p)
      arm_change = cross(variation%turn(:, f), arm)
      change%links(k)%turn = variation%turn(:, f)
      change%links(k)%shift = variation%shift(:, f) + arm_change
      change%links(k)%omega = variation%omega(:, f)
      change%links(k)%v = variation%v(:, f) + cross(variation%omega(:, f), arm) + cross(state%omega(:, f), arm_change)
    end do
  end subroutine show_variation

  !> Subtract the derivatives of the forces of closed chains, which turn and move with the frames in which their loops start.
  pure subroutine vary_wrenches(plan, state, variation, wrenches, forces)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state              !< position of the mechanism
    type(variation_type), intent(in) :: variation      !< of this position
    type(loop_wrench_type), intent(in) :: wrenches(:)  !< (closures) of the closed chains
    type(tree_forces_type), intent(inout) :: forces    !< gets the derivatives
    real(wp) :: force(3), moment(3), force_change(3), moment_change(3), arm(3), arm_change(3), sign
    integer :: c, b, e, f

    do c = 1, size(plan%closures)
      b = plan%closures(c)%base
      do e = 1, 2
        f = merge(plan%closures(c)%closing, plan%closures(c)%target, e == 1)
        sign = merge(1.0_wp, -1.0_wp, e == 1)
        force = sign*turn(state%r(:, :, b), wrenches(c)%force)
        moment = sign*turn(state%r(:, :, b), wrenches(c)%moment)
        force_change = cross(variation%turn(:, b), force)
        moment_change = cross(variation%turn(:, b), moment)
        arm = state%p(:, b) - state%p(:, f)
        arm_change = variation%shift(:, b) - variation%shift(:, f)
        forces%force_change(:, f) = forces%force_change(:, f) - force_change
        forces%moment_change(:, f) = forces%moment_change(:, f) - moment_change - cross(arm_change, force) &
                                     - cross(arm, force_change)
      end do
    end do
  end subroutine vary_wrenches

  !> Hand the derivatives of each frame on to its parent, and find those of the forces that the coordinates require.
  pure subroutine sweep_changes(plan, state, variation, forces)
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state             !< position of the mechanism
    type(variation_type), intent(in) :: variation     !< of this position
    type(tree_forces_type), intent(inout) :: forces   !< with forces, and derivatives at each frame; gets their sums
    real(wp) :: arm(3), arm_change(3)
    integer :: s, i, k

    do s = plan%n_coordinates, 1, -1
      i = plan%steps(s)%parent
      k = plan%steps(s)%coordinate
      associate (force => forces%force_change, moment => forces%moment_change)
        forces%required_change(k) = dot_product(state%axis_w(:, s), moment(:, s)) &
                                    + dot_product(state%axis_v(:, s), force(:, s)) &
                                    + dot_product(variation%axis_w(:, s), forces%moment(:, s)) &
                                    + dot_product(variation%axis_v(:, s), forces%force(:, s)) - forces%load_change%generalized(k)
        arm = state%p(:, s) - state%p(:, i)
        arm_change = variation%shift(:, s) - variation%shift(:, i)
        force(:, i) = force(:, i) + force(:, s)
        moment(:, i) = moment(:, i) + moment(:, s) + cross(arm_change, forces%force(:, s)) + cross(arm, force(:, s))
      end associate
    end do
  end subroutine sweep_changes
end module mech9_tree_forces
