!> A planar closed chain that determines three coordinates by itself, the commonest block: its Jacobian and its motion, with all
!> indices found beforehand.
!>
!> The results are those of the general procedures for any block; only the search for indices and the calls are saved. The rates,
!> the velocities of the frames, and the accelerations of the coordinates and of the frames take one loop each.
module mech9_planar_chain
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, block_type
  use mech9_planar_plan, only: planar_plan_type, planar_closure_type, planar_step_type
  use mech9_planar_motion, only: planar_velocities, planar_accelerations
  use mech9_planar_formulas, only: step_column, step_velocity, add_rate, add_bias, stem_difference, rows_at_base, closing_error
  use mech9_state, only: planar_motion_type
  implicit none
  private
  public :: planar_chain_type, new_planar_chain, chain_residual, chain_jacobian, chain_change, chain_rates, chain_motion, &
    chain_accelerations

  !> A block of one planar closed chain with three unknowns.
  type :: planar_chain_type
    logical :: used = .false.             !< the block is such a chain
    integer :: first_step = 0             !< first step of the block
    integer :: last_step = 0              !< last step of the block
    integer :: last_moved = 0             !< last step of the block whose acceleration is used
    type(planar_closure_type) :: closure  !< its closure
    real(wp) :: per_length = 1.0_wp       !< one over the mechanism's size [1/m]
    integer :: unknowns(3) = 0            !< steps of the three unknown coordinates
    integer :: coordinates(3) = 0         !< numbers of these coordinates
    real(wp) :: units(3) = 1.0_wp         !< their units: 1 rad, or the length of the mechanism [m]
    integer :: stems(2) = 0               !< frames of other blocks at which the two branches of the loop begin
    real(wp), allocatable :: signs(:)     !< (first_step:last_step) of each step in the loop: 1 or -1; 0: not in it
    integer, allocatable :: given(:)      !< steps of the loop whose coordinates are given
  end type planar_chain_type

contains

  !> A block as a planar chain; `used` is false where the block is not one.
  pure function new_planar_chain(plan, block) result(chain)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(planar_chain_type) :: chain
    integer :: i, s

    if (.not. (plan%planar%used .or. block%arithmetic > 1)) return
    if (block%first_closure /= block%last_closure .or. size(block%unknowns) /= 3) return
    chain%first_step = block%first_step
    chain%last_step = block%last_step
    chain%last_moved = min(block%last_step, block%last_moved)
    chain%closure = plan%planar%closures(block%first_closure)
    chain%per_length = 1.0_wp/plan%planar%length
    chain%unknowns = block%unknowns
    chain%coordinates = block%coordinates
    chain%units = plan%unit_of(block%coordinates)
    allocate (chain%signs(block%first_step:block%last_step), source=0.0_wp)
    associate (part => plan%closures(block%first_closure)%part)
      chain%stems = part%stems
      do i = 1, size(part%steps)
        s = part%steps(i)
        if (s < block%first_step) return
        chain%signs(s) = part%signs(i)
      end do
      chain%given = pack(part%steps, .not. plan%steps(part%steps)%dependent)
    end associate
    chain%used = .true.
  end function new_planar_chain

  !> The residual of the three equations.
  pure subroutine chain_residual(chain, motion, residual)
    type(planar_chain_type), intent(in) :: chain     !< the chain
    type(planar_motion_type), intent(in) :: motion   !< with the poses of the frames
    real(wp), intent(out) :: residual(3)             !< [rad, lengths of the mechanism]
    real(wp) :: error(3)

    call closing_error(chain%closure, motion%pose, error)
    call rows_at_base(chain%closure, chain%per_length, motion%pose, error, residual)
  end subroutine chain_residual

  !> Add to the three coordinates the change that cancels a residual.
  pure subroutine chain_change(chain, inverse, residual, q, change)
    type(planar_chain_type), intent(in) :: chain       !< the chain
    real(wp), intent(in) :: inverse(3, 3)              !< inverse of the Jacobian
    real(wp), intent(in) :: residual(3)                !< [rad, lengths of the mechanism]
    real(wp), intent(inout), contiguous :: q(:)        !< (M) coordinates [rad, m]
    real(wp), intent(out) :: change(3)                 !< of the three coordinates, in their units
    integer :: j

    do j = 1, 3
      change(j) = -(inverse(j, 1)*residual(1) + inverse(j, 2)*residual(2) + inverse(j, 3)*residual(3))
      q(chain%coordinates(j)) = q(chain%coordinates(j)) + chain%units(j)*change(j)
    end do
  end subroutine chain_change

  !> Derivatives of the three equations with respect to the three coordinates, each in its unit.
  pure subroutine chain_jacobian(planar, chain, motion, jacobian)
    type(planar_plan_type), intent(in) :: planar     !< the plan in planar arithmetic
    type(planar_chain_type), intent(in) :: chain     !< the chain
    type(planar_motion_type), intent(in) :: motion   !< with the poses of the frames
    real(wp), intent(out) :: jacobian(3, 3)          !< (equations, coordinates)

    call fill(chain, planar%steps, motion%pose, motion%slide, jacobian)
  end subroutine chain_jacobian

  !> Rates of the three coordinates and velocities of the frames up to frame `last`, from the rates of the given coordinates
  !> and the velocities of the frames of earlier blocks.
  pure subroutine chain_rates(planar, chain, inverse, last, dq, motion)
    type(planar_plan_type), intent(in) :: planar        !< the plan in planar arithmetic
    type(planar_chain_type), intent(in) :: chain        !< the chain
    real(wp), intent(in) :: inverse(3, 3)               !< inverse of the Jacobian
    integer, intent(in) :: last                         !< last frame whose velocity is found
    real(wp), intent(inout), contiguous :: dq(:)        !< (M) given rates in; rates of the three coordinates out [rad/s, m/s]
    type(planar_motion_type), intent(inout) :: motion   !< poses in; velocities of these frames out

    call find_rates(chain, inverse, planar%steps, motion%pose, motion%slide, motion%velocity, dq)
    call planar_velocities(planar, chain%first_step, last, dq, motion)
  end subroutine chain_rates

  !> Rates and accelerations of the three coordinates, velocities and accelerations of the frames, from the motion of the
  !> given coordinates and of the frames of earlier blocks.
  pure subroutine chain_motion(planar, chain, inverse, dq, ddq, motion)
    type(planar_plan_type), intent(in) :: planar        !< the plan in planar arithmetic
    type(planar_chain_type), intent(in) :: chain        !< the chain
    real(wp), intent(in) :: inverse(3, 3)               !< inverse of the Jacobian
    real(wp), intent(inout), contiguous :: dq(:)        !< (M) given rates in; rates of the three coordinates out [rad/s, m/s]
    real(wp), intent(inout), contiguous :: ddq(:)       !< (M) given accelerations in; all of the chain out [rad/s^2, m/s^2]
    type(planar_motion_type), intent(inout) :: motion   !< poses in; velocities and accelerations out
    real(wp) :: bias(2)

    call find_rates(chain, inverse, planar%steps, motion%pose, motion%slide, motion%velocity, dq)
    call find_velocities(chain, planar%steps, motion%pose, motion%slide, dq, motion%velocity, bias)
    call chain_accelerations(planar, chain, inverse, bias, dq, ddq, motion)
  end subroutine chain_motion

  !> Accelerations of the three coordinates and of the frames, from the velocities, the accelerations of the given coordinates
  !> and those of the frames of earlier blocks.
  pure subroutine chain_accelerations(planar, chain, inverse, bias, dq, ddq, motion)
    type(planar_plan_type), intent(in) :: planar        !< the plan in planar arithmetic
    type(planar_chain_type), intent(in) :: chain        !< the chain
    real(wp), intent(in) :: inverse(3, 3)               !< inverse of the Jacobian
    real(wp), intent(in) :: bias(2)                     !< bias acceleration of the loop [m/s^2]
    real(wp), intent(in), contiguous :: dq(:)           !< (M) rates of all coordinates [rad/s, m/s]
    real(wp), intent(inout), contiguous :: ddq(:)       !< (M) given accelerations in; all of the chain out [rad/s^2, m/s^2]
    type(planar_motion_type), intent(inout) :: motion   !< poses and velocities in; accelerations out
    real(wp) :: opening(3), square
    integer :: i, t

    i = chain%closure%closing
    t = chain%closure%target
    call find_opening(chain, planar%steps, motion%pose, motion%slide, motion%acceleration, ddq, opening)
    ! the target's point at the closing frame's origin has a centripetal acceleration about the target's origin
    square = motion%velocity(1, t)**2
    opening(2) = opening(2) + bias(1) + square*(motion%pose(3, i) - motion%pose(3, t))
    opening(3) = opening(3) + bias(2) + square*(motion%pose(4, i) - motion%pose(4, t))
    call close_rates(chain, inverse, motion%pose, opening, ddq)
    call planar_accelerations(planar, chain%first_step, chain%last_moved, dq, ddq, motion)
  end subroutine chain_accelerations

  ! The following procedures take arrays of which all but the last extent is known, so that the compiler keeps their addresses in
  ! registers.

  !> Derivatives of the three equations with respect to the three coordinates, each in its unit.
  pure subroutine fill(chain, steps, f, slide, jacobian)
    type(planar_chain_type), intent(in) :: chain     !< the chain
    type(planar_step_type), intent(in) :: steps(*)   !< steps of the plan
    real(wp), intent(in) :: f(4, 0:*)                !< (cosine, sine, x, y) pose of each frame [m]
    real(wp), intent(in) :: slide(2, *)              !< velocity of each frame's origin per unit rate
    real(wp), intent(out) :: jacobian(3, 3)          !< (equations, coordinates)
    integer :: j, s

    do j = 1, 3
      s = chain%unknowns(j)
      call step_column(steps(s), chain%signs(s), f(:, s), slide(:, s), f(3:4, chain%closure%base), chain%per_length, &
                       jacobian(:, j))
    end do
  end subroutine fill

  !> Rates of the three coordinates, by which the loop stays closed.
  pure subroutine find_rates(chain, inverse, steps, f, slide, v, dq)
    type(planar_chain_type), intent(in) :: chain       !< the chain
    real(wp), intent(in) :: inverse(3, 3)              !< inverse of the chain's Jacobian
    type(planar_step_type), intent(in) :: steps(*)     !< steps of the plan
    real(wp), intent(in) :: f(4, 0:*)                  !< (cosine, sine, x, y) pose of each frame [m]
    real(wp), intent(in) :: slide(2, *)                !< velocity of each frame's origin per unit rate
    real(wp), intent(in) :: v(3, 0:*)                  !< velocity of each frame of earlier blocks [rad/s, m/s]
    real(wp), intent(inout) :: dq(*)                   !< rates of all coordinates [rad/s, m/s]
    real(wp) :: opening(3)

    call find_opening(chain, steps, f, slide, v, dq, opening)
    call close_rates(chain, inverse, f, opening, dq)
  end subroutine find_rates

  !> Relative motion of the ends of the loop by the given coordinates and by the frames at which it begins, at the closing frame.
  pure subroutine find_opening(chain, steps, f, slide, v, rates, opening)
    type(planar_chain_type), intent(in) :: chain       !< the chain
    type(planar_step_type), intent(in) :: steps(*)     !< steps of the plan
    real(wp), intent(in) :: f(4, 0:*)                  !< (cosine, sine, x, y) pose of each frame [m]
    real(wp), intent(in) :: slide(2, *)                !< velocity of each frame's origin per unit rate
    real(wp), intent(in) :: v(3, 0:*)                  !< velocity, or acceleration, of each frame of earlier blocks
    real(wp), intent(in) :: rates(*)                   !< rates, or accelerations, of all coordinates
    real(wp), intent(out) :: opening(3)                !< motion of the closing frame relative to the target
    integer :: i, s

    call stem_difference(chain%stems, f(3:4, chain%closure%closing), f, v, opening)
    do i = 1, size(chain%given)
      s = chain%given(i)
      call add_rate(steps(s), chain%signs(s)*rates(steps(s)%coordinate), f(:, s), slide(:, s), f(3:4, chain%closure%closing), &
                    opening)
    end do
  end subroutine find_opening

  !> The rates of the three coordinates that cancel a relative motion of the ends of the loop.
  pure subroutine close_rates(chain, inverse, f, opening, rates)
    type(planar_chain_type), intent(in) :: chain       !< the chain
    real(wp), intent(in) :: inverse(3, 3)              !< inverse of the chain's Jacobian
    real(wp), intent(in) :: f(4, 0:*)                  !< (cosine, sine, x, y) pose of each frame [m]
    real(wp), intent(in) :: opening(3)                 !< motion of the closing frame relative to the target, at the closing frame
    real(wp), intent(inout) :: rates(*)                !< rates, or accelerations, of all coordinates; gets those of the three
    real(wp) :: rows(3)
    integer :: j

    call rows_at_base(chain%closure, chain%per_length, f, opening, rows)
    do j = 1, 3
      rates(chain%coordinates(j)) = -chain%units(j)*(inverse(j, 1)*rows(1) + inverse(j, 2)*rows(2) + inverse(j, 3)*rows(3))
    end do
  end subroutine close_rates

  !> Velocities of the frames, and the bias acceleration of the loop: its centripetal and Coriolis terms.
  pure subroutine find_velocities(chain, steps, f, slide, dq, v, bias)
    type(planar_chain_type), intent(in) :: chain     !< the chain
    type(planar_step_type), intent(in) :: steps(*)   !< steps of the plan
    real(wp), intent(in) :: f(4, 0:*)                !< (cosine, sine, x, y) pose of each frame [m]
    real(wp), intent(in) :: slide(2, *)              !< velocity of each frame's origin per unit rate
    real(wp), intent(in) :: dq(*)                    !< rates of all coordinates [rad/s, m/s]
    real(wp), intent(inout) :: v(3, 0:*)             !< velocity of each frame [rad/s, m/s]
    real(wp), intent(out) :: bias(2)                 !< bias acceleration of the loop, by its steps [m/s^2]
    real(wp) :: arm(2), rate
    integer :: i, p

    bias = 0.0_wp
    do i = chain%first_step, chain%last_step
      p = steps(i)%parent
      rate = dq(steps(i)%coordinate)
      arm = f(3:4, i) - f(3:4, p)
      call step_velocity(steps(i), rate, arm, slide(:, i), v(:, p), v(:, i))
      call add_bias(steps(i), chain%signs(i), rate, arm, slide(:, i), v(1, p), bias)
    end do
  end subroutine find_velocities
end module mech9_planar_chain
