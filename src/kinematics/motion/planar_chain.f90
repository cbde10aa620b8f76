!> A planar closed chain that determines three coordinates by itself, the commonest block: its Jacobian and its motion, with all
!> places looked up beforehand.
!>
!> The numbers are those of closures and frames of any block; what is saved is the way to them. Rates, velocities of
!> the frames, accelerations of the coordinates and of the frames take one loop each.
module mech9_planar_chain
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, block_type
  use mech9_planar_plan, only: planar_plan_type, planar_closure_type, planar_step_type
  use mech9_planar_motion, only: find_accelerations
  use mech9_planar_formulas, only: step_column, step_velocity, add_rate, add_bias, stem_difference, rows_at_base
  use mech9_state, only: planar_motion_type
  implicit none
  private
  public :: planar_chain_type, new_planar_chain, chain_jacobian, chain_rates, chain_motion

  type :: planar_chain_type
    logical :: used = .false.
    integer :: first_step = 0, last_step = 0
    integer :: last_moved = 0                  !< the last step of which accelerations are asked for
    integer :: closure = 0
    integer :: unknowns(3) = 0                 !< steps
    integer :: coordinates(3) = 0              !< of these
    real(wp) :: units(3) = 1.0_wp              !< of the coordinates
    integer :: stems(2) = 0                    !< frames of other blocks from which it departs
    real(wp), allocatable :: signs(:)          !< (first_step:last_step) of each step in the loop; 0: not in it
    integer, allocatable :: given(:)           !< steps of the loop whose coordinates are given
  end type planar_chain_type

contains

  !> A block as such a chain; not used where it is none.
  pure function new_planar_chain(plan, block) result(chain)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(block_type), intent(in) :: block   !< the block
    type(planar_chain_type) :: chain
    integer :: i, s

    if (.not. plan%planar%used .or. block%first_closure /= block%last_closure .or. size(block%unknowns) /= 3) return
    chain%first_step = block%first_step
    chain%last_step = block%last_step
    chain%last_moved = min(block%last_step, block%last_moved)
    chain%closure = block%first_closure
    chain%unknowns = block%unknowns
    chain%coordinates = block%coordinates
    chain%units = plan%unit_of(block%coordinates)
    allocate (chain%signs(block%first_step:block%last_step), source=0.0_wp)
    associate (part => plan%closures(chain%closure)%part)
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

  !> Derivatives of the three equations with respect to the three coordinates, each in its unit.
  pure subroutine chain_jacobian(planar, chain, motion, jacobian)
    type(planar_plan_type), intent(in) :: planar
    type(planar_chain_type), intent(in) :: chain
    type(planar_motion_type), intent(in) :: motion
    real(wp), intent(out) :: jacobian(3, 3)

    call fill(chain%unknowns, chain%first_step, chain%last_step, chain%signs, planar%closures(chain%closure)%base, &
              1.0_wp/planar%length, size(planar%steps), planar%steps, motion%pose, motion%slide, jacobian)
  end subroutine chain_jacobian

  !> Rates of the three coordinates and velocities of the frames up to that of step `last`, from those of the given
  !> coordinates and of the blocks before.
  pure subroutine chain_rates(planar, chain, inverse, last, dq, motion)
    type(planar_plan_type), intent(in) :: planar
    type(planar_chain_type), intent(in) :: chain
    real(wp), intent(in) :: inverse(3, 3)                  !< of the Jacobian
    integer, intent(in) :: last
    real(wp), intent(inout), contiguous :: dq(:)           !< (M)
    type(planar_motion_type), intent(inout) :: motion
    real(wp) :: swing(2)

    call move(chain, planar%closures(chain%closure), chain%first_step, chain%last_step, chain%signs, size(chain%given), &
              chain%given, 1.0_wp/planar%length, inverse, size(planar%steps), planar%steps, motion%pose, motion%slide, &
              last, dq, motion%velocity, swing)
  end subroutine chain_rates

  !> Rates and accelerations of the three coordinates, velocities and accelerations of the frames, from those of the
  !> given coordinates and of the blocks before.
  pure subroutine chain_motion(planar, chain, inverse, dq, ddq, motion)
    type(planar_plan_type), intent(in) :: planar
    type(planar_chain_type), intent(in) :: chain
    real(wp), intent(in) :: inverse(3, 3)                  !< of the Jacobian
    real(wp), intent(inout), contiguous :: dq(:), ddq(:)   !< (M)
    type(planar_motion_type), intent(inout) :: motion

    real(wp) :: swing(2)

    call move(chain, planar%closures(chain%closure), chain%first_step, chain%last_step, chain%signs, size(chain%given), &
              chain%given, 1.0_wp/planar%length, inverse, size(planar%steps), planar%steps, motion%pose, motion%slide, &
              chain%last_step, dq, motion%velocity, swing)
    call accelerate(chain, planar%closures(chain%closure), chain%first_step, chain%last_step, chain%signs, size(chain%given), &
                    chain%given, 1.0_wp/planar%length, inverse, size(planar%steps), planar%steps, motion%pose, motion%slide, &
                    dq, swing, motion%velocity, ddq, motion%acceleration)
  end subroutine chain_motion

  ! Arrays of known shape, apart from their types: the compiler then keeps their addresses in registers.

  pure subroutine fill(unknowns, first, last, signs, base, per_length, m, steps, f, slide, jacobian)
    integer, intent(in) :: unknowns(3), first, last, base, m
    real(wp), intent(in) :: signs(first:last), per_length, f(4, 0:m), slide(2, m)
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(out) :: jacobian(3, 3)
    integer :: j, s

    do j = 1, 3
      s = unknowns(j)
      call step_column(steps(s), signs(s), f(:, s), slide(:, s), f(3:4, base), per_length, jacobian(:, j))
    end do
  end subroutine fill

  pure subroutine move(chain, closure, first, last, signs, n_given, given, per_length, inverse, m, steps, f, slide, &
                       last_moved, dq, v, swing)
    type(planar_chain_type), intent(in) :: chain
    type(planar_closure_type), intent(in) :: closure
    integer, intent(in) :: first, last, n_given, given(n_given), m, last_moved
    real(wp), intent(in) :: signs(first:last), per_length, inverse(3, 3), f(4, 0:m), slide(2, m)
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(inout) :: dq(m), v(3, 0:m)
    real(wp), intent(out) :: swing(2)               !< as the loop would open if it only kept the velocities
    real(wp) :: opening(3)

    call stem_difference(m, chain%stems, f(3:4, closure%closing), f, v, opening)
    call add_given(n_given, given, first, last, signs, f(3:4, closure%closing), m, steps, f, slide, dq, opening)
    call close_rates(chain, closure, per_length, inverse, m, f, opening, dq)
    call find_velocities(first, last_moved, signs, m, steps, f, slide, dq, v, swing)
  end subroutine move

  pure subroutine accelerate(chain, closure, first, last, signs, n_given, given, per_length, inverse, m, steps, f, slide, &
                             dq, swing, v, ddq, a)
    type(planar_chain_type), intent(in) :: chain
    type(planar_closure_type), intent(in) :: closure
    integer, intent(in) :: first, last, n_given, given(n_given), m
    real(wp), intent(in) :: signs(first:last), per_length, inverse(3, 3), f(4, 0:m), slide(2, m)
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(in) :: dq(m), swing(2), v(3, 0:m)
    real(wp), intent(inout) :: ddq(m), a(3, 0:m)
    real(wp) :: opening(3)

    call stem_difference(m, chain%stems, f(3:4, closure%closing), f, a, opening)
    call add_given(n_given, given, first, last, signs, f(3:4, closure%closing), m, steps, f, slide, ddq, opening)
    ! what the target carries along swings about it
    opening(2) = opening(2) + swing(1) + v(1, closure%target)**2*(f(3, closure%closing) - f(3, closure%target))
    opening(3) = opening(3) + swing(2) + v(1, closure%target)**2*(f(4, closure%closing) - f(4, closure%target))
    call close_rates(chain, closure, per_length, inverse, m, f, opening, ddq)
    call find_accelerations(m, steps, first, chain%last_moved, dq, ddq, f, slide, v, a)
  end subroutine accelerate

  !> Add by how much the given coordinates' rates open the chain at a place: an angle and a way.
  pure subroutine add_given(n, given, first, last, signs, place, m, steps, f, slide, rates, opening)
    integer, intent(in) :: n, given(n), first, last, m
    real(wp), intent(in) :: signs(first:last), place(2), f(4, 0:m), slide(2, m), rates(m)
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(inout) :: opening(3)
    integer :: i, s

    do i = 1, n
      s = given(i)
      call add_rate(steps(s), signs(s)*rates(steps(s)%coordinate), f(:, s), slide(:, s), place, opening)
    end do
  end subroutine add_given

  !> The rates of the three coordinates that make up for an opening.
  pure subroutine close_rates(chain, closure, per_length, inverse, m, f, opening, rates)
    type(planar_chain_type), intent(in) :: chain
    type(planar_closure_type), intent(in) :: closure
    integer, intent(in) :: m
    real(wp), intent(in) :: per_length, inverse(3, 3), f(4, 0:m), opening(3)
    real(wp), intent(inout) :: rates(m)
    real(wp) :: rows(3)
    integer :: j

    call rows_at_base(closure, per_length, m, f, opening, rows)
    do j = 1, 3
      rates(chain%coordinates(j)) = -chain%units(j)*(inverse(j, 1)*rows(1) + inverse(j, 2)*rows(2) + inverse(j, 3)*rows(3))
    end do
  end subroutine close_rates

  !> Velocities of the frames, and the way in which the loop would open if it only kept them.
  pure subroutine find_velocities(first, last, signs, m, steps, f, slide, dq, v, swing)
    integer, intent(in) :: first, last, m
    real(wp), intent(in) :: signs(first:last), f(4, 0:m), slide(2, m), dq(m)
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(inout) :: v(3, 0:m)
    real(wp), intent(out) :: swing(2)
    real(wp) :: x, y, rate
    integer :: i, p

    swing = 0.0_wp
    do i = first, last
      p = steps(i)%parent
      rate = dq(steps(i)%coordinate)
      x = f(3, i) - f(3, p)
      y = f(4, i) - f(4, p)
      call step_velocity(steps(i), rate, x, y, slide(:, i), v(:, p), v(:, i))
      call add_bias(steps(i), signs(i), rate, x, y, slide(:, i), v(1, p), swing)
    end do
  end subroutine find_velocities
end module mech9_planar_chain
