!> Lagrange's equations in a plane: the same sums as in space, over columns of three numbers.
module mech9_planar_dynamics
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_least_squares, only: least_squares_type
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type, planar_motion_type
  use mech9_planar_motion, only: to_plane, planar_accelerations
  use mech9_planar_closure, only: planar_bias_rates, planar_difference
  use mech9_planar_chain, only: chain_jacobian, chain_accelerations
  use mech9_planar_lagrange, only: spread_columns, add_bodies => add_inertia, planar_wrench
  use mech9_planar_block, only: planar_block_type, list_loops, fill_columns, add_earlier, take_rates, move_frames, &
    move_with_drives, find_chain_rates, move_chain_frames
  use mech9_planar_articulated, only: planar_body_type, planar_body, new_planar_work, set_bodies, go_inward, go_outward, &
    pass_inward, pass_outward
  use mech9_cluster_bodies, only: find_rest, find_accelerations
  use mech9_planar_cluster, only: eliminate_cluster, move_cluster
  use mech9_tree_coefficients, only: find_reach, accelerate_in_plane, collect_in_plane
  use mech9_frame_columns, only: jacobian_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type, dynamics_arithmetic_type
  implicit none
  private
  public :: planar_dynamics_type, begin_planar_dynamics, take_blocks

  !> The arithmetic of a plane.
  type, extends(dynamics_arithmetic_type) :: planar_dynamics_type
    type(planar_body_type), allocatable :: bodies(:)      !< those of the plan of dynamics
    type(planar_block_type), allocatable :: blocks(:)     !< loops of each block
    real(wp) :: gravity(2) = 0.0_wp                       !< in the plane's axes [m/s^2]
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
  end type planar_dynamics_type

contains

  !> Begin the planar arithmetic of a plan of dynamics, whose bodies and columns are known.
  subroutine begin_planar_dynamics(mechanism, plan, dynamics, unchanged, self, known)
    type(mechanism_type), intent(in) :: mechanism             !< the mechanism
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism, planar
    type(dynamics_plan_type), intent(in) :: dynamics          !< the plan of dynamics
    logical, intent(in) :: unchanged(:)                       !< (blocks) the block is as in the plan of dynamics `known`
    type(planar_dynamics_type), intent(out) :: self           !< the planar arithmetic
    type(dynamics_plan_type), intent(in), optional :: known   !< the plan of dynamics in other coordinates
    real(wp) :: gravity(3)
    integer :: i, n

    if (present(known)) then
      call take_blocks(known%arithmetics(1)%kind, unchanged, self)
      self%bodies%frame = plan%frame_of(dynamics%bodies%link)
    else
      gravity = to_plane(plan%planar, dynamics%gravity)
      self%gravity = gravity(1:2)
      allocate (self%bodies(size(dynamics%bodies)), self%blocks(size(plan%blocks)))
      ! bodies have the order of those in the plan of dynamics
      n = 0
      do i = 1, size(mechanism%bodies)
        if (mechanism%bodies(i)%link == 1 .or. .not. mechanism%bodies(i)%has_inertia()) cycle
        n = n + 1
        self%bodies(n) = planar_body(plan, mechanism%bodies(i))
      end do
    end if
    do i = 1, size(plan%blocks)
      if (.not. unchanged(i)) call list_loops(plan, i, dynamics%frame_entries_type, dynamics%place_of, self%blocks(i))
    end do
  end subroutine begin_planar_dynamics

  !> Take gravity, bodies and the lists of unchanged blocks from the arithmetic in other coordinates.
  subroutine take_blocks(known, unchanged, self)
    class(dynamics_arithmetic_type), intent(in) :: known   !< the planar arithmetic in other coordinates
    logical, intent(in) :: unchanged(:)                    !< (blocks) the block is the same there
    class(planar_dynamics_type), intent(inout) :: self     !< gets these parts
    integer :: b

    allocate (self%blocks(size(unchanged)))
    select type (known)
    class is (planar_dynamics_type)
      self%gravity = known%gravity
      self%bodies = known%bodies
      do b = 1, size(unchanged)
        if (unchanged(b)) self%blocks(b) = known%blocks(b)
      end do
    end select
  end subroutine take_blocks

  !> Room for the columns of frames and for the passes of articulated bodies.
  pure subroutine make_work(self, plan, dynamics, work)
    class(planar_dynamics_type), intent(in) :: self    !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(lagrange_work_type), intent(inout) :: work    !< gets the room

    allocate (work%jacobian%flat(3, size(dynamics%column)), source=0.0_wp)
    if (dynamics%articulated) work%planar = new_planar_work(plan%n_coordinates)
  end subroutine make_work

  !> Factorize the Jacobian of a block.
  subroutine factorize_block(self, plan, b, state, work)
    class(planar_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    integer, intent(in) :: b                          !< number of the block
    type(state_type), intent(in) :: state             !< with the poses of the frames
    type(lagrange_work_type), intent(inout) :: work   !< gets the factors

    call factorize_in_plane(plan, self%blocks(b), state%planar, work%blocks(b)%equations)
    work%blocks(b)%count%factorizations = work%blocks(b)%count%factorizations + 1
  end subroutine factorize_block

  !> Rates, entries and accelerations from rates in two passes.
  subroutine move_regular_block(self, plan, dynamics, b, state, work, moved)
    class(planar_dynamics_type), intent(in) :: self    !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    integer, intent(in) :: b                           !< number of the block
    type(state_type), intent(inout) :: state           !< gets the motion of the block
    type(lagrange_work_type), intent(inout) :: work    !< with the block factorized; gets the entries
    logical, intent(out) :: moved                      !< true

    moved = .true.
    if (self%blocks(b)%chain%used .and. work%blocks(b)%equations%by_cofactors) then
      call move_chain(self%blocks(b), work%blocks(b)%equations%inverse, plan, dynamics, state, work%jacobian)
    else
      call move_in_plane(self%blocks(b), plan, dynamics, b, state, work)
    end if
  end subroutine move_regular_block

  !> Move a well conditioned chain that determines three coordinates by itself.
  pure subroutine move_chain(flat, inverse, plan, dynamics, state, jacobian)
    type(planar_block_type), intent(in) :: flat        !< the chain
    real(wp), intent(in) :: inverse(3, 3)              !< inverse of its Jacobian
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(inout) :: state           !< with poses and independent rates; gets the motion of the chain
    type(jacobian_type), intent(inout) :: jacobian     !< with the entries of earlier blocks; gets those of this one
    real(wp) :: bias(2)

    call find_chain_rates(flat, inverse, plan%planar%steps, state%planar, jacobian, state%dq)
    call move_chain_frames(flat%chain, plan%planar%steps, dynamics, state%dq, state%planar, jacobian, bias)
    call chain_accelerations(plan%planar, flat%chain, inverse, bias, state%dq, state%ddq, state%planar)
  end subroutine move_chain

  !> Form the Jacobian of a block in planar arithmetic and factorize it.
  subroutine factorize_in_plane(plan, flat, motion, equations)
    type(plan_type), intent(in) :: plan                    !< the plan of the mechanism
    type(planar_block_type), intent(in) :: flat            !< the loops of the block
    type(planar_motion_type), intent(in) :: motion         !< with the poses of the frames
    type(least_squares_type), intent(inout) :: equations   !< gets the Jacobian and its factors

    if (flat%chain%used) then
      call chain_jacobian(plan%planar, flat%chain, motion, equations%a)
    else
      call fill_columns(flat%unknowns, plan%planar%steps, motion, plan%length, equations%a)
    end if
    call equations%factorize()
  end subroutine factorize_in_plane

  !> Move a well conditioned block in planar arithmetic: each frame is moved once, then those of its closed cluster and beyond once
  !> more with the accelerations of the dependent coordinates.
  subroutine move_in_plane(flat, plan, dynamics, b, state, work)
    type(planar_block_type), intent(in) :: flat          !< the loops of the block
    type(plan_type), intent(in) :: plan                  !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics     !< the plan of dynamics
    integer, intent(in) :: b                             !< number of the block
    type(state_type), intent(inout) :: state             !< with poses and independent rates; gets the motion of the block
    type(lagrange_work_type), intent(inout) :: work      !< with the block's Jacobian factorized; gets the entries of the block
    integer :: i, j

    associate (block => plan%blocks(b), steps => plan%planar%steps, motion => state%planar, solver => work%blocks(b))
      call fill_columns(flat%independent, steps, motion, plan%length, work%sides(:, :flat%columns))
      if (size(flat%earlier) > 0) &
        call add_earlier(flat%earlier, motion%pose, work%jacobian%flat, plan%length, work%sides(:, :flat%columns))
      if (flat%columns == 0) state%dq(block%coordinates) = 0.0_wp
      do j = 1, flat%columns
        call solver%equations%solve(work%sides(:solver%equations%m, j), solver%change)
        call take_rates(flat, j, block%coordinates, solver%change, work%jacobian%b, state%dq)
      end do
      call move_frames(block, steps, state%dq, motion)
      call spread_columns(steps, block, dynamics%first, dynamics%parent_entry, dynamics%carries_columns, motion, work%jacobian)
      if (flat%driven) call move_with_drives(plan, block, state)
      call planar_bias_rates(plan%planar, block%first_closure, block%last_closure, motion, solver%right)
      call solver%equations%solve(solver%right, solver%change)
      do i = 1, size(block%unknowns)
        state%ddq(block%coordinates(i)) = -solver%change(i)*flat%units(i)
      end do
      call planar_accelerations(plan%planar, dynamics%first_closed(b), block%last_step, state%dq, state%ddq, motion)
    end associate
  end subroutine move_in_plane

  !> Outward recursion of the Jacobian's entries over the frames of a block that belong to its closed cluster.
  pure subroutine spread_jacobian(self, plan, dynamics, block, state, all_frames, jacobian)
    class(planar_dynamics_type), intent(in) :: self    !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(block_type), intent(in) :: block              !< the block
    type(state_type), intent(in) :: state              !< with the poses of the frames
    logical, intent(in) :: all_frames                  !< also frames of closed clusters that carry nothing
    type(jacobian_type), intent(inout) :: jacobian     !< with `b` of the block's steps

    if (all_frames) then
      call spread_columns(plan%planar%steps, block, dynamics%first, dynamics%parent_entry, dynamics%closed, state%planar, jacobian)
    else
      call spread_columns(plan%planar%steps, block, dynamics%first, dynamics%parent_entry, dynamics%carries_columns, &
                          state%planar, jacobian)
    end if
  end subroutine spread_jacobian

  !> Velocity of the closing frame relative to the target, as rows of the closure's equations, per unit rate of one
  !> independent coordinate.
  pure subroutine closing_column(self, plan, c, state, jacobian, entries, column)
    class(planar_dynamics_type), intent(in) :: self   !< the arithmetic
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    integer, intent(in) :: c                          !< number of the closure
    type(state_type), intent(in) :: state             !< with the poses of the frames
    type(jacobian_type), intent(in) :: jacobian       !< entries of all frames
    integer, intent(in) :: entries(2)                 !< of the closing frame, and of the target frame or 0: it does not move
    real(wp), intent(out), contiguous :: column(:)    !< (3) in the equations of the closure
    real(wp) :: of_target(3)

    of_target = 0.0_wp
    if (entries(2) > 0) of_target = jacobian%flat(:, entries(2))
    call planar_difference(plan%planar, c, state%planar, jacobian%flat(:, entries(1)), of_target, column)
  end subroutine closing_column

  !> Add the coefficients a_pr (21), the velocity terms of (19) and the weights of all bodies of one cluster on link 1.
  pure subroutine add_inertia(self, dynamics, state, work)
    class(planar_dynamics_type), intent(in) :: self    !< the arithmetic
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work    !< with the entries of the Jacobian; gets the sums

    call add_bodies(self%bodies, self%gravity, state%planar%pose, state%planar%velocity, state%planar%acceleration, dynamics, &
                    work)
  end subroutine add_inertia

  !> Add the generalized forces (25) of the loads on one link.
  pure subroutine add_link_force(self, plan, dynamics, state, link, work)
    class(planar_dynamics_type), intent(in) :: self    !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the poses of the frames
    integer, intent(in) :: link                        !< number of the link
    type(lagrange_work_type), intent(inout) :: work    !< with the loads' forces; gets the generalized ones
    real(wp) :: wrench(3)
    integer :: f, e, p

    f = plan%frame_of(link)
    wrench = planar_wrench(plan%planar, link, state%planar%pose(:, f), work%sum%force(:, link), work%sum%torque(:, link))
    do e = dynamics%first(f), dynamics%first(f + 1) - 1
      p = dynamics%column(e)
      work%forces(p) = work%forces(p) + dot_product(work%jacobian%flat(:, e), wrench)
    end do
  end subroutine add_link_force

  !> Accelerations by articulated bodies: a sweep inward over the stages, and one outward.
  pure subroutine solve_tree(self, plan, dynamics, state, work, found)
    class(planar_dynamics_type), intent(in) :: self    !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work    !< with the loads' forces; gets the accelerations
    logical, intent(out) :: found                      !< whether all coordinates have inertia
    integer :: i

    found = .true.
    call set_applied(plan, dynamics, state, work)
    associate (steps => plan%planar%steps, motion => state%planar, frames => work%planar, columns => work%jacobian%flat, &
               entries => dynamics%frame_entries_type)
      call set_bodies(self%bodies, self%gravity, motion, frames)
      do i = size(dynamics%stages), 1, -1
        associate (stage => dynamics%stages(i), cluster => work%clusters(i))
          if (stage%closed) then
            cluster%rest = 0.0_wp
            if (work%sum%any_generalized) call find_rest(stage, entries, work%jacobian%b, work%sum%generalized, cluster%rest)
            call eliminate_cluster(stage, entries, columns, motion%pose, frames%bodies, cluster, found)
          else if (stage%driven) then
            call pass_inward(stage%first_step, stage%last_step, steps, motion%pose, frames%bodies)
          else
            call go_inward(stage%first_step, stage%last_step, steps, motion, work%sum%generalized, frames, found)
          end if
        end associate
        if (.not. found) return
      end do
      do i = 1, size(dynamics%stages)
        associate (stage => dynamics%stages(i), cluster => work%clusters(i))
          if (stage%closed) then
            call find_accelerations(stage%places, frames%motion(:, stage%base), cluster, work%accelerations)
            call move_cluster(stage, entries, columns, motion%pose, cluster%ddq, frames%motion)
          else if (stage%driven) then
            call pass_outward(stage%first_step, stage%last_step, steps, motion%pose, frames%motion)
          else
            call go_outward(stage%first_step, stage%last_step, steps, dynamics%place_of, motion, frames, work%accelerations)
          end if
        end associate
      end do
    end associate
  end subroutine solve_tree

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
      work%planar%applied(:, f) = planar_wrench(plan%planar, k, state%planar%pose(:, f), work%sum%force(:, k), &
                                                work%sum%torque(:, k))
    end do
  end subroutine set_applied

  !> Coefficients of motion, velocity terms, and generalized forces of weights and of loads on links, of any tree of clusters.
  pure subroutine weigh_tree(self, plan, dynamics, state, work)
    class(planar_dynamics_type), intent(in) :: self    !< the arithmetic
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(state_type), intent(in) :: state              !< with the accelerations that rates alone give
    type(lagrange_work_type), intent(inout) :: work    !< with the columns of closed clusters; gets the results
    real(wp) :: whole(size(work%forces))
    integer :: reach(2, size(work%forces))
    integer :: i, m

    m = plan%n_coordinates
    do i = 1, m
      if (dynamics%closed(i) .or. dynamics%first(i) == dynamics%first(i + 1)) cycle
      work%jacobian%flat(1, dynamics%first(i)) = plan%planar%steps(i)%turn
      work%jacobian%flat(2:3, dynamics%first(i)) = merge(0.0_wp, state%planar%slide(:, i), plan%planar%steps(i)%turns)
    end do
    associate (motion => state%planar, frames => work%planar, columns => work%jacobian%flat, &
               entries => dynamics%frame_entries_type)
      call set_applied(plan, dynamics, state, work)
      call set_bodies(self%bodies, self%gravity, motion, frames)
      call collect_in_plane([1, m], entries, columns, motion%pose, frames%bodies, whole)
      frames%applied = 0.0_wp
      call set_bodies(self%bodies, 0.0_wp*self%gravity, motion, frames)
      call collect_in_plane([1, m], entries, columns, motion%pose, frames%bodies, work%velocity_terms)
      work%forces = work%velocity_terms - whole
      call find_reach(entries, reach)
      frames%motion = 0.0_wp
      do i = 1, size(whole)
        call accelerate_in_plane(i, reach(:, i), entries, columns, motion%pose, frames)
        call collect_in_plane(reach(:, i), entries, columns, motion%pose, frames%bodies, whole)
        frames%motion(:, reach(1, i):reach(2, i)) = 0.0_wp
        work%coefficients(i:, i) = whole(i:)
      end do
    end associate
  end subroutine weigh_tree
end module mech9_planar_dynamics
