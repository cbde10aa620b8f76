!> A block of closed chains in planar arithmetic: the lists of the steps in its closures, made once, and the loops over these
!> lists in each evaluation of the motion.
!>
!> The rate of a closure's residual is the sum of the contributions of the steps in its loop, each taken at the origin of the
!> loop's base. The steps of the block's unknowns make up the Jacobian. The steps of independent coordinates, and the frames of
!> earlier blocks from which the loop starts, give the right-hand sides for B = dq/dq_i, for which no frame of the block is moved.
module mech9_planar_block
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_planar_plan, only: planar_step_type
  use mech9_planar_motion, only: planar_accelerations
  use mech9_planar_chain, only: planar_chain_type, new_planar_chain
  use mech9_planar_formulas, only: step_column, step_velocity, step_acceleration
  use mech9_planar_lagrange, only: carry_columns
  implicit none
  private
  public :: planar_block_type, loop_part_type, list_loops, fill_columns, add_earlier, add_part, take_rates, move_frames, &
    move_with_drives

  !> A step in a loop, or a frame of an earlier block from which the loop starts.
  type :: loop_part_type
    integer :: frame = 0           !< number of the frame, which is that of the step
    integer :: row = 0             !< number of equations of the block before those of the closure
    integer :: base = 0            !< frame at whose origin the closure's equations are taken
    integer :: column = 0          !< number of the unknown among those of the block, or of the right-hand side
    integer :: entry = 0           !< for a frame of an earlier block, the entry of one of its columns
    !> +1 towards the closing frame, -1 towards the target; for a frame of an earlier block, times the coordinate's unit.
    real(wp) :: weight = 1.0_wp
  end type loop_part_type

  !> The loops of a block.
  type :: planar_block_type
    type(planar_chain_type) :: chain                     !< the block as a planar chain, if it is one
    logical :: driven = .false.                          !< a coordinate of the block is driven
    integer :: columns = 0                               !< number of independent coordinates on which the block depends
    type(loop_part_type), allocatable :: unknowns(:)     !< steps with the unknowns of the block
    type(loop_part_type), allocatable :: independent(:)  !< steps with independent coordinates
    type(loop_part_type), allocatable :: earlier(:)      !< columns of frames of earlier blocks
    integer, allocatable :: first_entries(:)             !< first entry of the frame of each unknown
    real(wp), allocatable :: units(:)                    !< unit of each unknown [rad, m]
    integer, allocatable :: given(:)                     !< numbers of the independent coordinates
    real(wp), allocatable :: given_units(:)              !< their units [rad, m]
  end type planar_block_type

contains

  !> List the parts of the loops of block b. The columns of its frames and of those of earlier blocks must be known.
  pure subroutine list_loops(plan, b, first, column, place_of, flat)
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    integer, intent(in) :: b                       !< number of the block
    integer, intent(in) :: first(0:)               !< (0:M+1) first entry of each frame
    integer, intent(in) :: column(:)               !< (entries) place of the coordinate among the independent ones
    integer, intent(in) :: place_of(:)             !< (M) place of a coordinate among the independent ones, or 0
    type(planar_block_type), intent(out) :: flat   !< the loops of the block
    type(loop_part_type) :: part
    integer :: c, i

    allocate (flat%unknowns(0), flat%independent(0), flat%earlier(0))
    associate (block => plan%blocks(b))
      flat%first_entries = first(block%unknowns)
      flat%units = plan%unit_of(block%coordinates)
      if (size(block%unknowns) == 0) return
      flat%chain = new_planar_chain(plan, block)
      flat%chain%last_moved = block%last_step
      flat%driven = any(plan%driven(plan%steps(block%first_step:block%last_step)%coordinate))
      flat%columns = first(block%unknowns(1) + 1) - first(block%unknowns(1))
      associate (columns => column(first(block%unknowns(1)):first(block%unknowns(1) + 1) - 1))
        flat%given = plan%independent(columns)
        flat%given_units = plan%unit_of(flat%given)
        do c = block%first_closure, block%last_closure
          part%row = 3*(c - block%first_closure)
          part%base = plan%planar%closures(c)%base
          do i = 1, size(plan%closures(c)%part%steps)
            part%frame = plan%closures(c)%part%steps(i)
            part%weight = plan%closures(c)%part%signs(i)
            if (plan%steps(part%frame)%dependent) then
              part%column = place_among(block%unknowns, part%frame)
              call append(flat%unknowns, part)
            else
              part%column = place_among(columns, place_of(plan%steps(part%frame)%coordinate))
              call append(flat%independent, part)
            end if
          end do
          associate (stems => plan%closures(c)%part%stems)
            ! a motion that both ends share has no part in the relative motion of the ends
            if (stems(1) == stems(2)) cycle
            call list_columns(plan, stems(1), 1.0_wp, first, column, columns, part, flat%earlier)
            call list_columns(plan, stems(2), -1.0_wp, first, column, columns, part, flat%earlier)
          end associate
        end do
      end associate
    end associate
  end subroutine list_loops

  !> Append a part for each column of a frame of an earlier block. The base of the cluster has none of its own.
  pure subroutine list_columns(plan, frame, sign, first, column, columns, part, parts)
    type(plan_type), intent(in) :: plan                            !< the plan of the mechanism
    integer, intent(in) :: frame                                   !< number of the frame
    real(wp), intent(in) :: sign                                   !< +1 towards the closing frame, -1 towards the target
    integer, intent(in) :: first(0:)                               !< (0:M+1) first entry of each frame
    integer, intent(in) :: column(:)                               !< (entries) place of the coordinate among the independent ones
    integer, intent(in) :: columns(:)   !< places of the independent coordinates on which the block depends
    type(loop_part_type), intent(inout) :: part                    !< with row and base of the closure; its other components change
    type(loop_part_type), allocatable, intent(inout) :: parts(:)   !< the list that grows
    integer :: e

    part%frame = frame
    do e = first(frame), first(frame + 1) - 1
      part%entry = e
      part%weight = sign*plan%unit_of(plan%independent(column(e)))
      part%column = place_among(columns, column(e))
      if (part%column > 0) call append(parts, part)
    end do
  end subroutine list_columns

  !> The place of a number in a list, 0 when it is not there.
  pure integer function place_among(list, number) result(place)
    integer, intent(in) :: list(:)   !< numbers, each once
    integer, intent(in) :: number    !< one of them, or another

    do place = size(list), 1, -1
      if (list(place) == number) return
    end do
  end function place_among

  !> Append one part to a list.
  pure subroutine append(parts, part)
    type(loop_part_type), allocatable, intent(inout) :: parts(:)   !< the list that grows
    type(loop_part_type), intent(in) :: part                       !< its new last part

    parts = [parts, part]
  end subroutine append

  ! Arrays are passed with explicit shapes, apart from their types: the compiler then keeps their addresses in registers.

  !> Derivatives of the closures' equations with respect to the coordinates of steps, where translations are divided by the
  !> mechanism's length: they fill the columns of a matrix, which is zero elsewhere.
  pure subroutine fill_columns(n, parts, m, steps, f, slide, length, rows, columns, matrix)
    integer, intent(in) :: n                         !< number of parts
    type(loop_part_type), intent(in) :: parts(n)     !< steps of the loops
    integer, intent(in) :: m                         !< number of steps
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame, in the plane's axes [m]
    real(wp), intent(in) :: slide(2, m)              !< velocity of each new origin per unit rate, in the plane's axes
    real(wp), intent(in) :: length                   !< the mechanism's size [m]
    integer, intent(in) :: rows                      !< number of rows of the matrix
    integer, intent(in) :: columns                   !< number of its columns
    real(wp), intent(out) :: matrix(rows, columns)   !< rows in rad or parts of length, columns per rad or per length
    real(wp) :: per_length
    integer :: i, s, row

    per_length = 1.0_wp/length
    ! the parts of one closure, as many as columns, leave nothing else
    if (rows > 3 .or. n < columns) matrix = 0.0_wp
    do i = 1, n
      s = parts(i)%frame
      row = parts(i)%row
      call step_column(steps(s), parts(i)%weight, f(:, s), slide(:, s), f(3:4, parts(i)%base), per_length, &
                       matrix(row + 1:row + 3, parts(i)%column))
    end do
  end subroutine fill_columns

  !> Add the contributions of frames of earlier blocks to the closures, from their columns.
  pure subroutine add_earlier(n, parts, m, f, n_entries, entries, length, rows, columns, matrix)
    integer, intent(in) :: n                           !< number of parts
    type(loop_part_type), intent(in) :: parts(n)       !< columns of frames of earlier blocks
    integer, intent(in) :: m                           !< number of steps
    real(wp), intent(in) :: f(4, 0:m)                  !< pose of each frame, in the plane's axes [m]
    integer, intent(in) :: n_entries                   !< number of entries of all frames
    real(wp), intent(in) :: entries(3, n_entries)      !< angular velocity and velocity of the origin per unit rate, plane's axes
    real(wp), intent(in) :: length                     !< the mechanism's size [m]
    integer, intent(in) :: rows                        !< number of rows of the matrix
    integer, intent(in) :: columns                     !< number of its columns
    real(wp), intent(inout) :: matrix(rows, columns)   !< rows in rad or parts of length, columns per rad or per length
    real(wp) :: per_length
    integer :: i, row

    per_length = 1.0_wp/length
    do i = 1, n
      row = parts(i)%row
      call add_part(parts(i), per_length, f(3:4, parts(i)%base) - f(3:4, parts(i)%frame), entries(:, parts(i)%entry), &
                    matrix(row + 1:row + 3, parts(i)%column))
    end do
  end subroutine add_earlier

  !> Add the contribution of a frame of an earlier block, from one of its columns.
  pure subroutine add_part(part, per_length, arm, column, rows)
    type(loop_part_type), intent(in) :: part   !< the frame in the loop
    real(wp), intent(in) :: per_length         !< one over the mechanism's size [1/m]
    real(wp), intent(in) :: arm(2)             !< from the frame's origin to that of the closure's base [m]
    real(wp), intent(in) :: column(3)          !< angular velocity and velocity of the origin per unit rate, plane's axes
    real(wp), intent(inout) :: rows(3)         !< of the closure, in rad or parts of length, per rad or per length

    rows(1) = rows(1) + part%weight*column(1)
    rows(2) = rows(2) + part%weight*per_length*(column(2) - column(1)*arm(2))
    rows(3) = rows(3) + part%weight*per_length*(column(3) + column(1)*arm(1))
  end subroutine add_part

  !> Take the entries of the unknowns' steps for one independent coordinate, and add its share to the rates of the unknowns.
  pure subroutine take_rates(n, change, units, coordinates, first_entries, j, given, unit, n_b, m, b, dq)
    integer, intent(in) :: n                  !< number of unknowns
    real(wp), intent(in) :: change(n)         !< change of the closures' equations per unit of each, solved for the unknowns
    real(wp), intent(in) :: units(n)          !< units of the unknowns [rad, m]
    integer, intent(in) :: coordinates(n)     !< numbers of the unknowns
    integer, intent(in) :: first_entries(n)   !< first entry of the frame of each unknown
    integer, intent(in) :: j                  !< place of the independent coordinate among those of the block
    integer, intent(in) :: given              !< its number
    real(wp), intent(in) :: unit              !< its unit [rad, m]
    integer, intent(in) :: n_b                !< number of entries of all frames
    integer, intent(in) :: m                  !< number of coordinates
    real(wp), intent(inout) :: b(n_b)         !< gets B, rate of the step's coordinate per unit rate of an independent one
    real(wp), intent(inout) :: dq(m)          !< rates of all coordinates [rad/s, m/s]
    real(wp) :: rate
    integer :: i, e

    rate = dq(given)
    do i = 1, n
      e = first_entries(i) + j - 1
      b(e) = -change(i)*units(i)/unit
      if (j == 1) dq(coordinates(i)) = 0.0_wp
      dq(coordinates(i)) = dq(coordinates(i)) + b(e)*rate
    end do
  end subroutine take_rates

  !> Columns and velocities of frames first .. last, and their accelerations with no accelerations of any coordinate.
  pure subroutine move_frames(m, n_b, steps, first, last, entries, parent_entry, carries, b, dq, f, slide, columns, v, a)
    integer, intent(in) :: m                         !< number of steps
    integer, intent(in) :: n_b                       !< number of entries of all frames
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    integer, intent(in) :: first                     !< frames from this one
    integer, intent(in) :: last                      !< to this one
    integer, intent(in) :: entries(0:m + 1)          !< first entry of each frame
    integer, intent(in) :: parent_entry(n_b)         !< the same column in the parent frame, 0 for none
    logical, intent(in) :: carries(0:m)              !< frames whose columns are requested
    real(wp), intent(in) :: b(n_b)                   !< B, rate of the step's coordinate per unit rate of an independent one
    real(wp), intent(in) :: dq(m)                    !< rates of all coordinates [rad/s, m/s]
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame, in the plane's axes [m]
    real(wp), intent(in) :: slide(2, m)              !< velocity of each new origin per unit rate, in the plane's axes
    real(wp), intent(inout) :: columns(3, n_b)       !< angular velocity and velocity of the origin per unit rate, plane's axes
    real(wp), intent(inout) :: v(3, 0:m)             !< velocities of the frames, in the plane's axes [rad/s, m/s]
    real(wp), intent(inout) :: a(3, 0:m)             !< accelerations of the frames, in the plane's axes [rad/s^2, m/s^2]
    real(wp) :: x, y, rate
    integer :: s, p

    do s = first, last
      p = steps(s)%parent
      x = f(3, s) - f(3, p)
      y = f(4, s) - f(4, p)
      rate = dq(steps(s)%coordinate)
      call step_velocity(steps(s), rate, [x, y], slide(:, s), v(:, p), v(:, s))
      call step_acceleration(steps(s), [rate, 0.0_wp], [x, y], slide(:, s), v(1, p), a(:, p), a(:, s))
      if (carries(s)) &
        call carry_columns(n_b, entries(s), entries(s + 1) - 1, parent_entry, steps(s), slide(:, s), x, y, b, columns)
    end do
  end subroutine move_frames

  !> Accelerations of the frames of a block with driven coordinates, with no accelerations of its unknowns.
  pure subroutine move_with_drives(plan, block, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    type(block_type), intent(in) :: block      !< the block
    type(state_type), intent(inout) :: state   !< with poses, rates and driven accelerations; gets accelerations of the frames
    integer :: i

    do i = 1, size(block%unknowns)
      state%ddq(block%coordinates(i)) = 0.0_wp
    end do
    call planar_accelerations(plan%planar, block%first_step, block%last_step, state%dq, state%ddq, state%planar)
  end subroutine move_with_drives
end module mech9_planar_block
