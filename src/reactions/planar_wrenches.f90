!> The wrenches of a planar mechanism on which nothing acts across its plane, where equilibrium determines all of them in the plane.
!>
!> The method is that of mech9_loop_balance, for all clusters and open chains together, with three numbers for each step: the moment
!> about the normal at the origin of the frame that the step reaches, and the force in the plane's axes.
module mech9_planar_wrenches
  use mech9_kinds, only: wp
  use mech9_tolerances, only: planar_round_off
  use mech9_reaction_tolerances, only: balanced, regular_balance
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type
  use mech9_planar_plan, only: planar_step_type
  use mech9_state, only: state_type
  use mech9_planar_motion, only: to_space, to_plane
  use mech9_planar_formulas, only: turn_in_plane, point_acceleration
  use mech9_planar_articulated, only: planar_body_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_reaction_plan, only: reaction_plan_type
  implicit none
  private
  public :: planar_wrenches_type, new_planar_wrenches, balance_in_plane, show_wrenches, show_needed

  !> Equations and wrenches of a planar mechanism.
  type :: planar_wrenches_type
    type(block_work_type), allocatable, private :: blocks(:)   !< with the factors of their Jacobians
    real(wp), allocatable, private :: wrench(:, :)   !< (3,0:M) what the frame of a step requires from the frame before [N m, N]
  end type planar_wrenches_type

contains

  !> Room for the wrenches of a mechanism.
  pure function new_planar_wrenches(plan) result(self)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(planar_wrenches_type) :: self
    integer :: b

    allocate (self%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      self%blocks(b) = new_block_work(plan%blocks(b), plan)
    end do
    allocate (self%wrench(3, 0:plan%n_coordinates), source=0.0_wp)
  end function new_planar_wrenches

  !> Find the wrenches. `done` is false where a load acts across the plane, and beside singular positions.
  subroutine balance_in_plane(plan, reactions, state, view, loads, self, done)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(state_type), intent(in) :: state               !< with the accelerations of the frames
    type(motion_view_type), intent(in) :: view          !< the motion that the loads read
    type(force_sum_type), intent(in) :: loads           !< sums of the loads
    type(planar_wrenches_type), intent(inout) :: self   !< equations and scratch; gets the wrenches
    logical, intent(out) :: done                        !< the wrenches are found
    integer, parameter :: most_corrections = 6
    real(wp) :: error, before
    integer :: i, b

    self%wrench = 0.0_wp
    do i = 1, size(reactions%flat_bodies)
      call add_body(reactions%flat_bodies(i), reactions%gravity, plan%n_coordinates, state%planar%pose, state%planar%velocity, &
                    state%planar%acceleration, self%wrench)
    end do
    call add_loads(plan, reactions, state, view, loads, self%wrench, done)
    if (.not. done) return
    call carry_inwards(plan%n_coordinates, plan%planar%steps, state%planar%pose, self%wrench)
    do b = 1, size(plan%blocks)
      if (plan%blocks(b)%equations > 0) call factorize_block(plan, plan%blocks(b), state, self%blocks(b))
    end do
    before = huge(before)
    do i = 0, most_corrections
      error = imbalance(plan, reactions, state, loads, self%wrench)
      ! the first solution shows whether the position is singular, also where nothing is lacking
      if ((i > 0 .and. error <= 32.0_wp*epsilon(error)) .or. (i > 1 .and. .not. error < 0.5_wp*before)) exit
      before = error
      do b = size(plan%blocks), 1, -1
        if (plan%blocks(b)%equations == 0) cycle
        call close_block_loops(plan, b, state, loads, self%blocks(b), self%wrench, done)
        if (.not. done) return
      end do
    end do
    done = error <= balanced
  end subroutine balance_in_plane

  !> Add what the inertia and the weight of a body require, about the origin of its frame.
  pure subroutine add_body(body, gravity, m, f, v, a, wrench)
    type(planar_body_type), intent(in) :: body    !< the body
    real(wp), intent(in) :: gravity(2)            !< acceleration of free fall [m/s^2]
    integer, intent(in) :: m                      !< number of steps
    real(wp), intent(in) :: f(4, 0:m)             !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: v(3, 0:m)             !< velocity of each frame [rad/s, m/s]
    real(wp), intent(in) :: a(3, 0:m)             !< acceleration of each frame [rad/s^2, m/s^2]
    real(wp), intent(inout) :: wrench(3, 0:m)     !< of each frame [N m, N]
    real(wp) :: arm(2), force(2)
    integer :: s

    s = body%frame
    call turn_in_plane(f(:, s), body%centre, arm)
    call point_acceleration(v(1, s), a(:, s), arm, force)
    force = body%mass*(force - gravity)
    wrench(1, s) = wrench(1, s) + body%inertia*a(1, s) + arm(1)*force(2) - arm(2)*force(1)
    wrench(2:3, s) = wrench(2:3, s) + force
  end subroutine add_body

  !> Subtract the loads on the links. `flat` is false where they act across the plane by more than round-off.
  pure subroutine add_loads(plan, reactions, state, view, loads, wrench, flat)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(state_type), intent(in) :: state               !< position
    type(motion_view_type), intent(in) :: view          !< the motion that the loads read
    type(force_sum_type), intent(in) :: loads           !< sums of the loads
    real(wp), intent(inout) :: wrench(:, 0:)            !< (3,0:M) of each frame [N m, N]
    logical, intent(out) :: flat                        !< nothing is across the plane
    real(wp) :: arm(3), force(3), moment(3)
    integer :: i, k, s

    flat = .true.
    do i = 1, size(reactions%loaded)
      k = reactions%loaded(i)
      s = plan%frame_of(k)
      associate (planar => plan%planar, f => state%planar%pose(:, s))
        arm = view%links(k)%p - plan%origin - to_space(planar, f(3), f(4), reactions%height)
        moment = to_plane(planar, loads%torque(:, k) + cross(arm, loads%force(:, k)))
        force = to_plane(planar, loads%force(:, k))
      end associate
      flat = flat .and. max(reactions%length*abs(force(3)), abs(moment(1)), abs(moment(2))) <= &
             planar_round_off*(reactions%length*norm2(force) + abs(moment(3)))
      wrench(1, s) = wrench(1, s) - moment(3)
      wrench(2:3, s) = wrench(2:3, s) - force(1:2)
    end do
  end subroutine add_loads

  !> Add to what each frame requires what all frames beyond it do.
  pure subroutine carry_inwards(m, steps, f, wrench)
    integer, intent(in) :: m                         !< number of steps
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(inout) :: wrench(3, 0:m)        !< of each frame [N m, N]
    integer :: s

    do s = m, 1, -1
      call add_at(1.0_wp, wrench(:, s), f(3:4, s), f(3:4, steps(s)%parent), wrench(:, steps(s)%parent))
    end do
  end subroutine carry_inwards

  !> Add a wrench that is given about one place to another about its own.
  pure subroutine add_at(sign, added, from, place, wrench)
    real(wp), intent(in) :: sign            !< factor
    real(wp), intent(in) :: added(3)        !< moment and force [N m, N]
    real(wp), intent(in) :: from(2)         !< place about which its moment is given [m]
    real(wp), intent(in) :: place(2)        !< place of the sum [m]
    real(wp), intent(inout) :: wrench(3)    !< the sum [N m, N]

    wrench(1) = wrench(1) + sign*(added(1) + (from(1) - place(1))*added(3) - (from(2) - place(2))*added(2))
    wrench(2) = wrench(2) + sign*added(2)
    wrench(3) = wrench(3) + sign*added(3)
  end subroutine add_at

  !> The generalized force of a step's wrench on its coordinate.
  pure real(wp) function along(step, slide, wrench)
    type(planar_step_type), intent(in) :: step   !< the step
    real(wp), intent(in) :: slide(2)             !< velocity of its frame's origin per unit rate
    real(wp), intent(in) :: wrench(3)            !< of its frame [N m, N]

    if (step%turns) then
      along = step%turn*wrench(1)
    else
      along = slide(1)*wrench(2) + slide(2)*wrench(3)
    end if
  end function along

  !> The largest force that a dependent coordinate requires beside the loads on it, as a part of the largest wrench.
  pure real(wp) function imbalance(plan, reactions, state, loads, wrench) result(error)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(state_type), intent(in) :: state               !< position
    type(force_sum_type), intent(in) :: loads           !< with the loads on coordinates
    real(wp), intent(in) :: wrench(:, 0:)               !< (3,0:M) of each frame [N m, N]
    real(wp) :: lacking, largest, per_length
    integer :: s

    per_length = 1.0_wp/reactions%length
    error = 0.0_wp
    largest = tiny(largest)
    do s = 1, plan%n_coordinates
      associate (step => plan%planar%steps(s))
        largest = max(largest, abs(wrench(1, s))*per_length, abs(wrench(2, s)), abs(wrench(3, s)))
        if (.not. plan%steps(s)%dependent) cycle
        lacking = along(step, state%planar%slide(:, s), wrench(:, s))
        if (loads%any_generalized) lacking = lacking - loads%generalized(step%coordinate)
        if (step%turns) lacking = lacking*per_length
        error = max(error, abs(lacking))
      end associate
    end do
    error = error/largest
  end function imbalance

  !> Let the closing frames of a block require what its dependent coordinates lack. The steps of their loops pass it on.
  subroutine close_block_loops(plan, b, state, loads, work, wrench, regular)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    integer, intent(in) :: b                       !< number of the block
    type(state_type), intent(in) :: state          !< position
    type(force_sum_type), intent(in) :: loads      !< with the loads on coordinates
    type(block_work_type), intent(inout) :: work   !< with the factors of the block
    real(wp), intent(inout) :: wrench(:, 0:)       !< (3,0:M) of each frame [N m, N]
    logical, intent(out) :: regular                !< the position is not near a singular one
    real(wp) :: added(3), place(2), regularity
    integer :: i, c, k, s, row

    do i = 1, size(plan%blocks(b)%unknowns)
      s = plan%blocks(b)%unknowns(i)
      k = plan%blocks(b)%coordinates(i)
      work%change(i) = -along(plan%planar%steps(s), state%planar%slide(:, s), wrench(:, s))
      if (loads%any_generalized) work%change(i) = work%change(i) + loads%generalized(k)
      work%change(i) = work%change(i)*plan%unit_of(k)
    end do
    call work%equations%solve_transposed(work%change, work%right, regularity)
    regular = regularity > regular_balance
    if (.not. regular) return
    row = 0
    do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
      ! the equations are written at the base: angle, displacements over the size
      added = [work%right(row + 1), work%right(row + 2)/plan%length, work%right(row + 3)/plan%length]
      place = state%planar%pose(3:4, plan%planar%closures(c)%base)
      associate (loop => plan%closures(c)%loop)
        do i = 1, size(loop%steps)
          s = loop%steps(i)
          call add_at(loop%signs(i), added, place, state%planar%pose(3:4, s), wrench(:, s))
        end do
      end associate
      row = row + 3
    end do
  end subroutine close_block_loops

  !> The wrenches in space.
  pure subroutine show_wrenches(plan, reactions, state, self, force, moment)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(state_type), intent(in) :: state               !< position
    type(planar_wrenches_type), intent(in) :: self      !< with the wrenches
    real(wp), intent(out), contiguous :: force(:, :)    !< (3,M) of each pair, axes of link 1 [N]
    real(wp), intent(out), contiguous :: moment(:, :)   !< (3,M) about the origin of its frame in the moving link [N m]
    real(wp) :: m, d
    integer :: k, s

    do s = 1, plan%n_coordinates
      associate (step => plan%planar%steps(s), slide => state%planar%slide(:, s), w => self%wrench(:, s))
        k = step%coordinate
        d = reactions%pairs(k)%direction
        m = w(1)
        ! a reversed slide leads away from the moving link, in which the origin of the pair's frame is
        if (d < 0.0_wp .and. .not. step%turns) &
          m = m + (state%q(k) + plan%steps(s)%offset)*(slide(1)*w(3) - slide(2)*w(2))
        force(:, k) = to_space(plan%planar, d*w(2), d*w(3), 0.0_wp)
        moment(:, k) = to_space(plan%planar, 0.0_wp, 0.0_wp, d*m)
      end associate
    end do
  end subroutine show_wrenches

  !> The generalized forces that independent coordinates need beside the loads on them.
  pure subroutine show_needed(plan, state, loads, self, needed)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(state_type), intent(in) :: state               !< position
    type(force_sum_type), intent(in) :: loads           !< with the loads on coordinates
    type(planar_wrenches_type), intent(in) :: self      !< with the wrenches
    real(wp), intent(out) :: needed(:)                  !< (M) zero for dependent coordinates [N m, N]
    integer :: k, s

    needed = 0.0_wp
    do s = 1, plan%n_coordinates
      if (plan%steps(s)%dependent) cycle
      k = plan%planar%steps(s)%coordinate
      needed(k) = along(plan%planar%steps(s), state%planar%slide(:, s), self%wrench(:, s))
      if (loads%any_generalized) needed(k) = needed(k) - loads%generalized(k)
    end do
  end subroutine show_needed
end module mech9_planar_wrenches
