!> Derivatives of a force by small motions of a mechanism, as rows that are handed inward from frame to frame, like forces.
!>
!> A twist u of all frames from a step on, with its derivatives u' and u'' in time, changes the force by the sum of row 0 times u,
!> row 1 times u' and row 2 times u''. A change of the step's coordinate is such a twist, and a change of a constant of the
!> mechanism, too. Closed chains hold dependent coordinates: their rows are made zero by wrenches with which the chains act on the
!> rows of their loops, in the same way as forces of constraint make the forces of dependent coordinates zero.
module mech9_gradient_rows
  use mech9_kinds, only: wp
  use mech9_zero, only: make_zero
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type
  use mech9_coupling_constraint, only: coupling_factors
  implicit none
  private
  public :: gradient_rows_type, new_gradient_rows, clear_rows, sum_inward, sum_order_inward, row_of_coordinate, &
    eliminate_rows, subtract_crossed, pairing

  !> The rows of one force. Twists have D numbers, three in a plane and six in space.
  type :: gradient_rows_type
    real(wp), allocatable :: frames(:, :, :)      !< (D,0:2,0:M) by a twist of the frame and all that follows it
    real(wp), allocatable :: coordinates(:, :)    !< (0:2,M) by coordinates and rates beside their twists, and by accelerations
    real(wp), allocatable :: chains(:, :, :)      !< (D,0:2,closures) by a twist of the pose at which a chain closes
    real(wp), allocatable :: couplings(:, :)      !< (0:2,closures) multipliers of the equations of couplings
    real(wp), allocatable, private :: right(:)    !< right-hand side for one block
    real(wp), allocatable, private :: values(:)   !< multipliers of its equations
  end type gradient_rows_type

contains

  !> Room for the rows of one force.
  pure function new_gradient_rows(plan, d) result(rows)
    type(plan_type), intent(in) :: plan   !< the plan, in the arithmetic of the rows
    integer, intent(in) :: d              !< numbers of a twist
    type(gradient_rows_type) :: rows
    integer :: b, unknowns, equations

    unknowns = 0
    equations = 0
    do b = 1, size(plan%blocks)
      unknowns = max(unknowns, size(plan%blocks(b)%unknowns))
      equations = max(equations, plan%blocks(b)%equations)
    end do
    associate (m => plan%n_coordinates, n => size(plan%closures))
      allocate (rows%frames(d, 0:2, 0:m), rows%coordinates(0:2, m), rows%chains(d, 0:2, n), rows%couplings(0:2, n), &
                rows%right(unknowns), rows%values(equations), source=0.0_wp)
    end associate
  end function new_gradient_rows

  !> Make all rows of frames and coordinates zero.
  pure subroutine clear_rows(rows)
    type(gradient_rows_type), intent(inout) :: rows   !< the rows

    call make_zero(size(rows%frames), rows%frames)
    call make_zero(size(rows%coordinates), rows%coordinates)
  end subroutine clear_rows

  !> Add the rows of each frame to those of its parent.
  pure subroutine sum_inward(plan, n, sums)
    type(plan_type), intent(in) :: plan                             !< the plan of the mechanism
    integer, intent(in) :: n                                        !< numbers of each frame
    real(wp), intent(inout) :: sums(n, 0:plan%n_coordinates)        !< (d,0:2,0:M) rows of each frame; then of all that follows it, too, per unit of the motion
    integer :: s, c

    do s = plan%n_coordinates, 1, -1
      associate (i => plan%steps(s)%parent)
        if (n == 9) then
          ! the three orders of a plane: a loop whose length is known takes a third of the work
          do c = 1, 9
            sums(c, i) = sums(c, i) + sums(c, s)
          end do
        else
          do c = 1, n
            sums(c, i) = sums(c, i) + sums(c, s)
          end do
        end if
      end associate
    end do
  end subroutine sum_inward

  !> Add the rows of one order of each frame to those of its parent.
  pure subroutine sum_order_inward(plan, d, order, rows)
    type(plan_type), intent(in) :: plan                                 !< the plan of the mechanism
    integer, intent(in) :: d                                            !< numbers of a twist
    integer, intent(in) :: order                                        !< of the rows
    real(wp), intent(inout) :: rows(d, 0:2, 0:plan%n_coordinates)       !< (d,0:2,0:M) rows of each frame; then of all that follows it, too, per unit of the motion
    integer :: s, c

    do s = plan%n_coordinates, 1, -1
      associate (i => plan%steps(s)%parent)
        do c = 1, d
          rows(c, order, i) = rows(c, order, i) + rows(c, order, s)
        end do
      end associate
    end do
  end subroutine sum_order_inward

  !> The derivative of a force by the coordinate of a step, by its rate or by its acceleration: order 0, 1 or 2.
  pure real(wp) function row_of_coordinate(d, order, twist, rows, direct) result(row)
    integer, intent(in) :: d                 !< numbers of a twist
    integer, intent(in) :: order             !< of the derivative of the coordinate in time
    real(wp), intent(in) :: twist(d, 0:2)    !< (3,0:2) twist of the step per unit rate, with its derivatives in time [1, m/rad, per s]
    real(wp), intent(in) :: rows(d, 0:2)     !< (3,0:2) rows by twists from the step on, per rad and per m
    real(wp), intent(in) :: direct(0:2)      !< (0:2) rows of the coordinate beside its twist, per unit of the coordinate
    integer :: c

    row = direct(order)
    select case (order)
    case (0)
      do c = 1, d
        row = row + twist(c, 0)*rows(c, 0) + twist(c, 1)*rows(c, 1) + twist(c, 2)*rows(c, 2)
      end do
    case (1)
      do c = 1, d
        row = row + twist(c, 0)*rows(c, 1) + 2.0_wp*twist(c, 1)*rows(c, 2)
      end do
    case default
      do c = 1, d
        row = row + twist(c, 0)*rows(c, 2)
      end do
    end select
  end function row_of_coordinate

  !> The same in a plane, without loops.
  pure real(wp) function row_in_plane(order, twist, rows, direct) result(row)
    integer, intent(in) :: order             !< of the derivative of the coordinate in time
    real(wp), intent(in) :: twist(3, 0:2)    !< (3,0:2) twist of the step per unit rate, with its derivatives in time [1, m/rad, per s]
    real(wp), intent(in) :: rows(3, 0:2)     !< (3,0:2) rows by twists from the step on, per rad and per m
    real(wp), intent(in) :: direct(0:2)      !< (0:2) rows of the coordinate beside its twist, per unit of the coordinate

    select case (order)
    case (0)
      row = direct(0) + product_in_plane(twist(:, 0), rows(:, 0)) + product_in_plane(twist(:, 1), rows(:, 1)) &
            + product_in_plane(twist(:, 2), rows(:, 2))
    case (1)
      row = direct(1) + product_in_plane(twist(:, 0), rows(:, 1)) + 2.0_wp*product_in_plane(twist(:, 1), rows(:, 2))
    case default
      row = direct(2) + product_in_plane(twist(:, 0), rows(:, 2))
    end select
  end function row_in_plane

  !> The product of three numbers with three others.
  pure real(wp) function product_in_plane(a, b) result(product)
    real(wp), intent(in) :: a(3)             !< (3) three numbers
    real(wp), intent(in) :: b(3)             !< (3) the other numbers

    product = a(1)*b(1) + a(2)*b(2) + a(3)*b(3)
  end function product_in_plane

  !> Let closed chains and couplings make the rows of dependent coordinates zero, block by block inward, in each block from the rows
  !> by accelerations on.
  subroutine eliminate_rows(plan, d, lowest, state, steps, thirds, maps, blocks, rows)
    type(plan_type), intent(in) :: plan                   !< the plan, in the arithmetic of the rows
    integer, intent(in) :: d                              !< numbers of a twist
    integer, intent(in) :: lowest                         !< lowest order of the rows that are found
    type(state_type), intent(in) :: state                 !< the motion
    real(wp), intent(in) :: steps(d, 0:2, plan%n_coordinates)   !< twists of all steps per unit rate, with derivatives in time
    real(wp), intent(in) :: thirds(:)                     !< third derivatives of the functions of couplings
    real(wp), intent(in) :: maps(d, d, size(plan%closures))     !< wrench of each multiplier of each closed chain
    type(block_work_type), intent(inout) :: blocks(:)     !< factors of the closed chains
    type(gradient_rows_type), intent(inout) :: rows       !< summed over all that follows each frame; gets the action of the chains
    integer :: b, order, u, n

    do b = size(plan%blocks), 1, -1
      n = size(plan%blocks(b)%unknowns)
      if (n == 0) cycle
      do order = 2, lowest, -1
        call find_right_side(plan%n_coordinates, d, order, n, plan%blocks(b)%unknowns, plan%blocks(b)%coordinates, steps, &
                             rows%frames, rows%coordinates, rows%right)
        do u = 1, n
          rows%right(u) = plan%unit_of(plan%blocks(b)%coordinates(u))*rows%right(u)
        end do
        call blocks(b)%equations%solve_transposed(rows%right(:n), rows%values(:plan%blocks(b)%equations))
        call hand_on(plan, d, b, order, state, thirds, maps, rows)
      end do
    end do
  end subroutine eliminate_rows

  !> The rows of the unknowns of a block, from plain arrays.
  pure subroutine find_right_side(m, d, order, n, unknowns, coordinates, steps, frames, direct, right)
    integer, intent(in) :: m                        !< number of all steps
    integer, intent(in) :: d                        !< numbers of a twist
    integer, intent(in) :: order                    !< of the rows
    integer, intent(in) :: n                        !< number of unknowns
    integer, intent(in) :: unknowns(n)              !< their steps
    integer, intent(in) :: coordinates(n)           !< their coordinates
    real(wp), intent(in) :: steps(d, 0:2, m)        !< twists of all steps per unit rate, with derivatives in time
    real(wp), intent(in) :: frames(d, 0:2, 0:m)     !< (3,0:2,0:M) rows of the frames, per rad and per m
    real(wp), intent(in) :: direct(0:2, m)          !< rows of coordinates beside their twists
    real(wp), intent(inout) :: right(n)             !< the rows
    integer :: u

    if (d == 3) then
      do u = 1, n
        right(u) = row_in_plane(order, steps(1, 0, unknowns(u)), frames(1, 0, unknowns(u)), direct(0, coordinates(u)))
      end do
    else
      do u = 1, n
        right(u) = row_of_coordinate(d, order, steps(1, 0, unknowns(u)), frames(1, 0, unknowns(u)), direct(0, coordinates(u)))
      end do
    end if
  end subroutine find_right_side

  !> Subtract the action of the chains of a block, with its multipliers, from the rows of their loops.
  subroutine hand_on(plan, d, b, order, state, thirds, maps, rows)
    type(plan_type), intent(in) :: plan                   !< the plan, in the arithmetic of the rows
    integer, intent(in) :: d                              !< numbers of a twist
    integer, intent(in) :: b                              !< number of the block
    integer, intent(in) :: order                          !< of the rows
    type(state_type), intent(in) :: state                 !< the motion
    real(wp), intent(in) :: thirds(:)                     !< third derivatives of the functions of couplings
    real(wp), intent(in) :: maps(d, d, size(plan%closures))   !< wrench of each multiplier of each closed chain
    type(gradient_rows_type), intent(inout) :: rows       !< with the multipliers; its frames and coordinates change
    integer :: c, row, n

    row = 0
    do c = plan%blocks(b)%first_closure, plan%blocks(b)%last_closure
      n = plan%constraints(c)%item%equations
      if (plan%closures(c)%coupling > 0) then
        rows%couplings(order, c) = rows%values(row + 1)
        call hand_on_coupling(plan, c, order, state, thirds(plan%closures(c)%coupling), rows)
      else
        associate (loop => plan%closures(c)%loop)
          if (d == 3 .and. n == 3) then
            call hand_on_in_plane(order, rows%values(row + 1), maps(1, 1, c), size(loop%steps), loop%steps, loop%signs, &
                                  plan%n_coordinates, rows%chains(1, 0, c), rows%frames)
          else
            call hand_on_chain(d, order, n, rows%values(row + 1), maps(1, 1, c), size(loop%steps), loop%steps, loop%signs, &
                               plan%n_coordinates, rows%chains(1, 0, c), rows%frames)
          end if
        end associate
      end if
      row = row + n
    end do
  end subroutine hand_on

  !> Subtract the action of a closed chain from the rows of its loop, from plain arrays.
  pure subroutine hand_on_chain(d, order, n, multipliers, map, n_steps, steps, signs, m, chain, frames)
    integer, intent(in) :: d                        !< numbers of a twist
    integer, intent(in) :: order                    !< of the rows
    integer, intent(in) :: n                        !< number of equations of the chain
    real(wp), intent(in) :: multipliers(n)          !< of these equations
    real(wp), intent(in) :: map(d, n)               !< (3,3) wrenches of the multipliers
    integer, intent(in) :: n_steps                  !< number of steps of the loop
    integer, intent(in) :: steps(n_steps)           !< steps of the loop
    real(wp), intent(in) :: signs(n_steps)          !< (n_steps) 1, or -1 where the chain goes against the step
    integer, intent(in) :: m                        !< number of all steps
    real(wp), intent(inout) :: chain(d, 0:2)        !< (3,0:2) gets the wrench of the chain, per rad and per m
    real(wp), intent(inout) :: frames(d, 0:2, 0:m)  !< (3,0:2,0:M) rows of the frames, per rad and per m
    real(wp) :: sum
    integer :: i, j, k

    do k = 1, d
      sum = 0.0_wp
      do j = 1, n
        sum = sum + map(k, j)*multipliers(j)
      end do
      chain(k, order) = sum
      do i = 1, n_steps
        frames(k, order, steps(i)) = frames(k, order, steps(i)) - signs(i)*sum
      end do
    end do
  end subroutine hand_on_chain

  !> The same for a chain with three equations in a plane.
  pure subroutine hand_on_in_plane(order, multipliers, map, n_steps, steps, signs, m, chain, frames)
    integer, intent(in) :: order                    !< of the rows
    real(wp), intent(in) :: multipliers(3)          !< (3) multipliers of the equations
    real(wp), intent(in) :: map(3, 3)               !< (3,3) wrenches of the multipliers
    integer, intent(in) :: n_steps                  !< number of steps of the loop
    integer, intent(in) :: steps(n_steps)           !< steps of the loop
    real(wp), intent(in) :: signs(n_steps)          !< (n_steps) 1, or -1 where the chain goes against the step
    integer, intent(in) :: m                        !< number of all steps
    real(wp), intent(inout) :: chain(3, 0:2)        !< (3,0:2) gets the wrench of the chain, per rad and per m
    real(wp), intent(inout) :: frames(3, 0:2, 0:m)  !< (3,0:2,0:M) rows of the frames, per rad and per m
    real(wp) :: x, y, z
    integer :: i

    x = map(1, 1)*multipliers(1) + map(1, 2)*multipliers(2) + map(1, 3)*multipliers(3)
    y = map(2, 1)*multipliers(1) + map(2, 2)*multipliers(2) + map(2, 3)*multipliers(3)
    z = map(3, 1)*multipliers(1) + map(3, 2)*multipliers(2) + map(3, 3)*multipliers(3)
    chain(1, order) = x
    chain(2, order) = y
    chain(3, order) = z
    do i = 1, n_steps
      associate (s => steps(i))
        frames(1, order, s) = frames(1, order, s) - signs(i)*x
        frames(2, order, s) = frames(2, order, s) - signs(i)*y
        frames(3, order, s) = frames(3, order, s) - signs(i)*z
      end associate
    end do
  end subroutine hand_on_in_plane

  !> Subtract the action of a coupling from the rows of its coordinates.
  pure subroutine hand_on_coupling(plan, c, order, state, third, rows)
    type(plan_type), intent(in) :: plan                   !< the plan
    integer, intent(in) :: c                              !< number of the closure that is the coupling
    integer, intent(in) :: order                          !< of the rows
    type(state_type), intent(in) :: state                 !< the motion
    real(wp), intent(in) :: third                         !< third derivative of the coupling's function
    type(gradient_rows_type), intent(inout) :: rows       !< with the multiplier; its coordinates change
    real(wp) :: factors(0:2)
    integer :: i, k

    associate (coupling => plan%couplings(plan%closures(c)%coupling)%coupling, multiplier => rows%couplings(order, c))
      do i = 1, size(coupling%coordinates)
        k = coupling%coordinates(i)
        factors = coupling_factors(plan, c, state, third, i)
        rows%coordinates(order, k) = rows%coordinates(order, k) - multiplier*factors(0)
        if (order > 0) rows%coordinates(order - 1, k) = rows%coordinates(order - 1, k) - order*multiplier*factors(1)
        if (order > 1) rows%coordinates(0, k) = rows%coordinates(0, k) - multiplier*factors(2)
      end do
    end associate
  end subroutine hand_on_coupling

  !> Subtract the rate of change of a wrench that is fixed in a body with a twist.
  pure subroutine subtract_crossed(d, twist, wrench, rest)
    integer, intent(in) :: d              !< 3 in a plane, 6 in space
    real(wp), intent(in) :: twist(d)      !< of the body: rotation, then shift at the origin
    real(wp), intent(in) :: wrench(d)     !< moment about the origin, then force
    real(wp), intent(inout) :: rest(d)    !< from which it is subtracted

    if (d == 3) then
      rest(1) = rest(1) - (twist(2)*wrench(3) - twist(3)*wrench(2))
      rest(2) = rest(2) + twist(1)*wrench(3)
      rest(3) = rest(3) - twist(1)*wrench(2)
    else
      rest(1) = rest(1) - (twist(2)*wrench(3) - twist(3)*wrench(2) + twist(5)*wrench(6) - twist(6)*wrench(5))
      rest(2) = rest(2) - (twist(3)*wrench(1) - twist(1)*wrench(3) + twist(6)*wrench(4) - twist(4)*wrench(6))
      rest(3) = rest(3) - (twist(1)*wrench(2) - twist(2)*wrench(1) + twist(4)*wrench(5) - twist(5)*wrench(4))
      rest(4) = rest(4) - (twist(2)*wrench(6) - twist(3)*wrench(5))
      rest(5) = rest(5) - (twist(3)*wrench(4) - twist(1)*wrench(6))
      rest(6) = rest(6) - (twist(1)*wrench(5) - twist(2)*wrench(4))
    end if
  end subroutine subtract_crossed

  !> The product of a row with a twist, of all orders of which there are n numbers together.
  pure real(wp) function pairing(n, row, twist) result(product)
    integer, intent(in) :: n              !< how many numbers
    real(wp), intent(in) :: row(n)        !< of the row
    real(wp), intent(in) :: twist(n)      !< of the twist
    integer :: c

    product = 0.0_wp
    do c = 1, n
      product = product + row(c)*twist(c)
    end do
  end function pairing
end module mech9_gradient_rows
