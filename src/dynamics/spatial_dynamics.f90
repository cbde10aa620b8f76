!> Lagrange's equations in space: Jacobians of frames, inertia of links, forces on them, articulated bodies.
module mech9_spatial_dynamics
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: solver_factorize => factorize_block
  use mech9_articulated_bodies, only: articulated_type, chain_step_type, new_articulated, new_articulated_work, &
    add_to_rigid_body, set_bodies, go_inward, go_outward, pass_inward, pass_outward
  use mech9_cluster_bodies, only: find_rest, add_frames, eliminate_cluster, find_accelerations, move_cluster
  use mech9_planar_view, only: plane_in_space
  use mech9_moving_plane, only: plane_motion_type, seen_motion, gather_bodies
  use mech9_tree_stages, only: stage_type
  use mech9_tree_coefficients, only: find_reach, accelerate_in_space, collect_in_space
  use mech9_spatial_lagrange, only: spread_columns, add_body
  use mech9_frame_columns, only: jacobian_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type, dynamics_arithmetic_type
  implicit none
  private
  public :: spatial_dynamics_type, new_spatial_dynamics

  !> The arithmetic of space.
  type, extends(dynamics_arithmetic_type) :: spatial_dynamics_type
    type(articulated_type) :: articulated        !< steps and bodies, where articulated bodies serve
  contains
    procedure :: make_work
    procedure :: factorize_block
    procedure :: move_regular_block
    procedure :: spread_jacobian
    procedure :: closing_column
    procedure :: add_inertia
    procedure :: add_link_force
    procedure :: solve_tree
    procedure :: weigh_tree
  end type spatial_dynamics_type

contains

  !> The spatial arithmetic for a plan of dynamics, whose bodies are known.
  pure function new_spatial_dynamics(plan, dynamics) result(self)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(spatial_dynamics_type) :: self
    type(chain_step_type) :: steps(plan%n_coordinates)
    integer :: i

    if (.not. dynamics%articulated) return
    steps%parent = plan%steps%parent
    steps%coordinate = plan%steps%coordinate
    steps%place = dynamics%place_of(plan%steps%coordinate)
    steps%slides = abs(plan%steps%slide) > 0.0_wp .or. .not. plan%steps%is_screw
    self%articulated = new_articulated(steps)
    do i = 1, size(dynamics%bodies)
      associate (body => dynamics%bodies(i))
        call add_to_rigid_body(self%articulated%bodies(body%frame), body%mass, body%centre, body%inertia)
      end associate
    end do
  end function new_spatial_dynamics

  !> Room for the columns of frames and for the passes of articulated bodies.
  pure subroutine make_work(self, plan, dynamics, work)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(lagrange_work_type), intent(inout) :: work    !< gets the room

    allocate (work%jacobian%w(3, size(dynamics%column)), work%jacobian%v(3, size(dynamics%column)), source=0.0_wp)
    if (dynamics%articulated) work%articulated = new_articulated_work(plan%n_coordinates)
  end subroutine make_work

  !> Factorize the Jacobian of a block.
  subroutine factorize_block(self, plan, b, state, work)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    integer, intent(in) :: b                           !< number of the block
    type(state_type), intent(in) :: state              !< with the poses of the frames
    type(lagrange_work_type), intent(inout) :: work    !< gets the factors

    call solver_factorize(plan, plan%blocks(b), state, work%blocks(b))
  end subroutine factorize_block

  !> Space has no shorter way than the general one.
  subroutine move_regular_block(self, plan, dynamics, b, state, work, moved)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    integer, intent(in) :: b                           !< number of the block
    type(state_type), intent(inout) :: state           !< not changed
    type(lagrange_work_type), intent(inout) :: work    !< not changed
    logical, intent(out) :: moved                      !< false

    moved = .false.
  end subroutine move_regular_block

  !> Outward recursion of the Jacobian's entries over the frames of a block that belong to its closed cluster.
  pure subroutine spread_jacobian(self, plan, dynamics, block, state, all_frames, jacobian)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(block_type), intent(in) :: block              !< the block
    type(state_type), intent(in) :: state              !< with the poses of the frames
    logical, intent(in) :: all_frames                  !< also frames of closed clusters that carry nothing
    type(jacobian_type), intent(inout) :: jacobian     !< with `b` of the block's steps

    if (all_frames) then
      call spread_columns(plan, block, dynamics%first, dynamics%parent_entry, dynamics%closed, state, jacobian)
    else
      call spread_columns(plan, block, dynamics%first, dynamics%parent_entry, dynamics%carries_columns, state, jacobian)
    end if
  end subroutine spread_jacobian

  !> Velocity of the closing frame relative to the target, as rows of the closure's equations, per unit rate of one
  !> independent coordinate.
  pure subroutine closing_column(self, plan, c, state, jacobian, entries, column)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    integer, intent(in) :: c                           !< number of the closure
    type(state_type), intent(in) :: state              !< with the poses of the frames
    type(jacobian_type), intent(in) :: jacobian        !< entries of all frames
    integer, intent(in) :: entries(2)                  !< of the closing frame, and of the target frame or 0: it does not move
    real(wp), intent(out), contiguous :: column(:)     !< (rank) in the equations of the closure
    real(wp) :: w(3), v(3), arm(3)

    associate (closure => plan%closures(c), e => entries(1), t => entries(2))
      w = jacobian%w(:, e)
      v = jacobian%v(:, e)
      if (t > 0) then
        arm = state%p(:, closure%closing) - state%p(:, closure%target)
        w = w - jacobian%w(:, t)
        v = v - jacobian%v(:, t) - cross(jacobian%w(:, t), arm)
      end if
      call plan%constraints(c)%item%opening(plan, state, w, v, column)
    end associate
  end subroutine closing_column

  !> Add the coefficients a_pr (21), the velocity terms of (19) and the weights of all bodies of one cluster on link 1.
  pure subroutine add_inertia(self, dynamics, state, work)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work    !< with the entries of the Jacobian; gets the sums
    integer :: i

    do i = 1, size(dynamics%bodies)
      call add_body(dynamics, dynamics%bodies(i), state, work)
    end do
  end subroutine add_inertia

  !> Add the generalized forces (25) of the loads on one link.
  pure subroutine add_link_force(self, plan, dynamics, state, link, work)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the poses of the frames
    integer, intent(in) :: link                        !< number of the link
    type(lagrange_work_type), intent(inout) :: work    !< with the loads' forces; gets the generalized ones
    real(wp) :: torque(3)
    integer :: f, e, p

    f = plan%frame_of(link)
    torque = torque_on_frame(plan, state, link, work)
    do e = dynamics%first(f), dynamics%first(f + 1) - 1
      p = dynamics%column(e)
      work%forces(p) = work%forces(p) + dot_product(work%jacobian%v(:, e), work%sum%force(:, link)) &
                       + dot_product(work%jacobian%w(:, e), torque)
    end do
  end subroutine add_link_force

  !> Torque of the loads on a link about the origin of its frame.
  pure function torque_on_frame(plan, state, link, work) result(torque)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: state          !< with the poses of the frames
    integer, intent(in) :: link                    !< number of the link
    type(lagrange_work_type), intent(in) :: work   !< with the loads' forces and the motion that they read
    real(wp) :: torque(3)   !< in fixed axes [N m]
    real(wp) :: arm(3)

    arm = work%view%links(link)%p - plan%origin - state%p(:, plan%frame_of(link))
    torque = work%sum%torque(:, link) + cross(arm, work%sum%force(:, link))
  end function torque_on_frame

  !> Accelerations by articulated bodies: a sweep inward over the stages, and one outward.
  pure subroutine solve_tree(self, plan, dynamics, state, work, found)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work    !< with the loads' forces; gets the accelerations
    logical, intent(out) :: found                      !< whether all coordinates have inertia
    integer :: i

    found = .true.
    call set_applied(plan, dynamics, state, work)
    associate (steps => self%articulated%steps, frames => work%articulated, jacobian => work%jacobian, &
               entries => dynamics%frame_entries_type)
      call set_bodies(self%articulated%bodies, dynamics%in_space, dynamics%gravity, state, frames)
      do i = size(dynamics%stages), 1, -1
        associate (stage => dynamics%stages(i), cluster => work%clusters(i))
          if (stage%closed) then
            cluster%factors = 0.0_wp
            cluster%column = 0.0_wp
            cluster%rest = 0.0_wp
            cluster%rigid = 0.0_wp
            if (work%sum%any_generalized) call find_rest(stage, entries, jacobian%b, work%sum%generalized, cluster%rest)
            if (stage%plane > 0) call gather_bodies(stage, entries, jacobian%flat, base_motion(plan, dynamics, stage, state), &
                                                    state%planar, frames%bodies(stage%base), cluster)
            call add_frames(stage, entries, jacobian%w, jacobian%v, state%p, frames%bodies, cluster)
            call eliminate_cluster(plan%n_coordinates, stage, frames%bodies(stage%base), cluster, found)
          else if (stage%driven) then
            call pass_inward(stage%first_step, stage%last_step, steps, state%p, frames%bodies)
          else
            call go_inward(stage%first_step, stage%last_step, steps, state, work%sum%generalized, frames, found)
          end if
        end associate
        if (.not. found) return
      end do
      do i = 1, size(dynamics%stages)
        associate (stage => dynamics%stages(i), cluster => work%clusters(i))
          if (stage%closed) then
            call find_accelerations(stage%places, frames%motion(:, stage%base), cluster, work%accelerations)
            call move_cluster(stage, entries, jacobian%w, jacobian%v, state%p, cluster%ddq, frames%motion)
          else if (stage%driven) then
            call pass_outward(stage%first_step, stage%last_step, steps, state%p, frames%motion)
          else
            call go_outward(stage%first_step, stage%last_step, steps, state, frames, work%accelerations)
          end if
        end associate
      end do
    end associate
  end subroutine solve_tree

  !> The motion of the plane of a cluster.
  pure function base_motion(plan, dynamics, stage, state) result(motion)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(stage_type), intent(in) :: stage              !< the cluster
    type(state_type), intent(in) :: state              !< with the accelerations that rates alone give
    type(plane_motion_type) :: motion

    associate (base => plan%planar%planes(stage%plane)%base)
      motion = seen_motion(plane_in_space(plan, state, stage%first_step), state%omega(:, base), state%alpha(:, base), &
                           state%a(:, base), dynamics%gravity)
    end associate
  end function base_motion

  !> The wrenches of the loads on the frames of their links.
  pure subroutine set_applied(plan, dynamics, state, work)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the poses of the frames
    type(lagrange_work_type), intent(inout) :: work    !< with the loads' forces; gets the wrenches
    integer :: i, k, f

    do i = 1, size(dynamics%loaded)
      k = dynamics%loaded(i)
      f = plan%frame_of(k)
      work%articulated%applied(1:3, f) = torque_on_frame(plan, state, k, work)
      work%articulated%applied(4:6, f) = work%sum%force(:, k)
    end do
  end subroutine set_applied

  !> Coefficients of motion, velocity terms, and generalized forces of weights and of loads on links, of any tree of clusters.
  pure subroutine weigh_tree(self, plan, dynamics, state, work)
    class(spatial_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work    !< with the columns of closed clusters; gets the results
    real(wp) :: whole(size(work%forces))
    integer :: reach(2, size(work%forces))
    logical :: all_frames(0:plan%n_coordinates)
    integer :: i, m

    all_frames = .true.
    m = plan%n_coordinates
    do i = 1, m
      if (dynamics%closed(i) .or. dynamics%first(i) == dynamics%first(i + 1)) cycle
      work%jacobian%w(:, dynamics%first(i)) = state%axis_w(:, i)
      work%jacobian%v(:, dynamics%first(i)) = state%axis_v(:, i)
    end do
    associate (own => self%articulated%bodies, frames => work%articulated, w => work%jacobian%w, v => work%jacobian%v, &
               entries => dynamics%frame_entries_type)
      call set_applied(plan, dynamics, state, work)
      call set_bodies(own, all_frames, dynamics%gravity, state, frames)
      call collect_in_space([1, m], entries, w, v, state%p, frames%bodies, whole)
      frames%applied = 0.0_wp
      call set_bodies(own, all_frames, 0.0_wp*dynamics%gravity, state, frames)
      call collect_in_space([1, m], entries, w, v, state%p, frames%bodies, work%velocity_terms)
      work%forces = work%velocity_terms - whole
      call find_reach(entries, reach)
      frames%motion = 0.0_wp
      do i = 1, size(whole)
        call accelerate_in_space(i, reach(:, i), entries, w, v, state%p, frames)
        call collect_in_space(reach(:, i), entries, w, v, state%p, frames%bodies, whole)
        frames%motion(:, reach(1, i):reach(2, i)) = 0.0_wp
        work%coefficients(i:, i) = whole(i:)
      end do
    end associate
  end subroutine weigh_tree
end module mech9_spatial_dynamics
