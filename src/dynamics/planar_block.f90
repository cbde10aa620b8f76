!> A block of closed chains in planar arithmetic: the lists of the steps in its closures, made once, and the loops over these
!> lists in each evaluation of the motion.
!>
!> The rate of a closure's residual is the sum of the contributions of the steps in its loop, each taken at the origin of the
!> loop's base. The steps of the block's unknowns make up the Jacobian. The steps of independent coordinates, and the frames of
!> earlier blocks from which the loop starts, give the right-hand sides for B = dq/dq_i, for which no frame of the block is moved.
module mech9_planar_block
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type, planar_motion_type
  use mech9_planar_plan, only: planar_step_type
  use mech9_planar_motion, only: planar_accelerations
  use mech9_planar_chain, only: planar_chain_type, new_planar_chain
  use mech9_planar_formulas, only: step_column, step_velocity, step_acceleration, add_bias
  use mech9_frame_columns, only: frame_entries_type, jacobian_type
  use mech9_lagrange_types, only: dynamics_plan_type
  implicit none
  private
  public :: planar_block_type, list_loops, fill_columns, add_earlier, take_rates, move_frames, move_with_drives, &
    find_chain_rates, move_chain_frames

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
  pure subroutine list_loops(plan, b, entries, place_of, flat)
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism
    integer, intent(in) :: b                          !< number of the block
    type(frame_entries_type), intent(in) :: entries   !< of all frames
    integer, intent(in) :: place_of(:)                !< (M) place of a coordinate among the independent ones, or 0
    type(planar_block_type), intent(out) :: flat      !< the loops of the block
    type(loop_part_type) :: part
    integer :: c, i

    allocate (flat%unknowns(0), flat%independent(0), flat%earlier(0))
    associate (block => plan%blocks(b))
      flat%first_entries = entries%first(block%unknowns)
      flat%units = plan%unit_of(block%coordinates)
      if (size(block%unknowns) == 0) return
      flat%chain = new_planar_chain(plan, block)
      flat%chain%last_moved = block%last_step
      flat%driven = any(plan%driven(plan%steps(block%first_step:block%last_step)%coordinate))
      flat%columns = entries%first(block%unknowns(1) + 1) - entries%first(block%unknowns(1))
      associate (columns => entries%column(entries%first(block%unknowns(1)):entries%first(block%unknowns(1) + 1) - 1))
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
            call list_columns(plan, stems(1), 1.0_wp, entries, columns, part, flat%earlier)
            call list_columns(plan, stems(2), -1.0_wp, entries, columns, part, flat%earlier)
          end associate
        end do
      end associate
    end associate
  end subroutine list_loops

  !> Append a part for each column of a frame of an earlier block. The base of the cluster has none of its own.
  pure subroutine list_columns(plan, frame, sign, entries, columns, part, parts)
    type(plan_type), intent(in) :: plan                            !< the plan of the mechanism
    integer, intent(in) :: frame                                   !< number of the frame
    real(wp), intent(in) :: sign                                   !< +1 towards the closing frame, -1 towards the target
    type(frame_entries_type), intent(in) :: entries                !< of all frames
    integer, intent(in) :: columns(:)   !< places of the independent coordinates on which the block depends
    type(loop_part_type), intent(inout) :: part                    !< with row and base of the closure; its other components change
    type(loop_part_type), allocatable, intent(inout) :: parts(:)   !< the list that grows
    integer :: e

    part%frame = frame
    do e = entries%first(frame), entries%first(frame + 1) - 1
      part%entry = e
      part%weight = sign*plan%unit_of(plan%independent(entries%column(e)))
      part%column = place_among(columns, entries%column(e))
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

  ! Inner procedures take arrays of which all but the last extent is known, so that the compiler keeps their addresses in registers.

  !> Derivatives of the closures' equations with respect to the coordinates of steps, where translations are divided by the
  !> mechanism's length: they fill the columns of a matrix, which is zero elsewhere.
  pure subroutine fill_columns(parts, steps, motion, length, matrix)
    type(loop_part_type), intent(in), contiguous :: parts(:)    !< steps of the loops
    type(planar_step_type), intent(in) :: steps(*)              !< the steps of the plan
    type(planar_motion_type), intent(in) :: motion              !< with the poses of the frames
    real(wp), intent(in) :: length                              !< the mechanism's size [m]
    real(wp), intent(inout), contiguous :: matrix(:, :)         !< (rows,columns) gets rows in rad or parts of length, per rad or per length [1]
    integer :: rows, columns

    rows = size(matrix, 1)
    columns = size(matrix, 2)
    call fill(motion%pose, motion%slide, matrix)

  contains

    !> The same from plain arrays.
    pure subroutine fill(f, slide, matrix)
      real(wp), intent(in) :: f(4, 0:*)                !< pose of each frame, in the plane's axes [m]
      real(wp), intent(in) :: slide(2, *)              !< (2,M) velocity of each new origin per unit rate, in the plane's axes [m/rad, 1]
      real(wp), intent(inout) :: matrix(rows, columns) !< (rows,columns) the columns, in rad or parts of length, per rad or per length [1]
      real(wp) :: per_length
      integer :: i, s, row

      per_length = 1.0_wp/length
      ! the parts of one closure, as many as columns, leave nothing else
      if (rows > 3 .or. size(parts) < columns) matrix = 0.0_wp
      do i = 1, size(parts)
        s = parts(i)%frame
        row = parts(i)%row
        call step_column(steps(s), parts(i)%weight, f(:, s), slide(:, s), f(3:4, parts(i)%base), per_length, &
                         matrix(row + 1:row + 3, parts(i)%column))
      end do
    end subroutine fill
  end subroutine fill_columns

  !> Add the contributions of frames of earlier blocks to the closures, from their columns.
  pure subroutine add_earlier(parts, f, columns, length, matrix)
    type(loop_part_type), intent(in), contiguous :: parts(:)   !< columns of frames of earlier blocks
    real(wp), intent(in) :: f(4, 0:*)                     !< (4,0:M) pose of each frame, in the plane's axes [m]
    real(wp), intent(in) :: columns(3, *)                 !< (entries) angular velocity and velocity of the origin per unit rate
    real(wp), intent(in) :: length                        !< the mechanism's size [m]
    real(wp), intent(inout), contiguous :: matrix(:, :)   !< (rows,columns) rows in rad or parts of length, columns per rad or per length [1]
    real(wp) :: per_length
    integer :: i, row

    per_length = 1.0_wp/length
    do i = 1, size(parts)
      row = parts(i)%row
      call add_part(parts(i), per_length, f(3:4, parts(i)%base) - f(3:4, parts(i)%frame), columns(:, parts(i)%entry), &
                    matrix(row + 1:row + 3, parts(i)%column))
    end do
  end subroutine add_earlier

  !> Add the contribution of a frame of an earlier block, from one of its columns.
  pure subroutine add_part(part, per_length, arm, column, rows)
    type(loop_part_type), intent(in) :: part   !< the frame in the loop
    real(wp), intent(in) :: per_length         !< one over the mechanism's size [1/m]
    real(wp), intent(in) :: arm(2)             !< from the frame's origin to that of the closure's base [m]
    real(wp), intent(in) :: column(3)          !< (3,entries) angular velocity and velocity of the origin per unit rate, plane's axes [1, m/rad]
    real(wp), intent(inout) :: rows(3)         !< of the closure, in rad or parts of length, per rad or per length

    rows(1) = rows(1) + part%weight*column(1)
    rows(2) = rows(2) + part%weight*per_length*(column(2) - column(1)*arm(2))
    rows(3) = rows(3) + part%weight*per_length*(column(3) + column(1)*arm(1))
  end subroutine add_part

  !> Take the entries of the unknowns' steps for one independent coordinate, and add its share to the rates of the unknowns.
  pure subroutine take_rates(flat, j, coordinates, change, b, dq)
    type(planar_block_type), intent(in) :: flat     !< the loops of the block
    integer, intent(in) :: j                        !< place of the independent coordinate among those of the block
    integer, intent(in), contiguous :: coordinates(:)   !< numbers of the unknowns
    real(wp), intent(in), contiguous :: change(:)   !< (unknowns) change of the closures' equations per unit of it, solved for the unknowns [1]
    real(wp), intent(inout) :: b(*)                 !< (entries) gets B, rates of steps per unit rate of independent coordinates
    real(wp), intent(inout) :: dq(*)                !< (M) rates of all coordinates [rad/s, m/s]
    real(wp) :: rate, unit
    integer :: i, e

    rate = dq(flat%given(j))
    unit = flat%given_units(j)
    do i = 1, size(coordinates)
      e = flat%first_entries(i) + j - 1
      b(e) = -change(i)*flat%units(i)/unit
      if (j == 1) dq(coordinates(i)) = 0.0_wp
      dq(coordinates(i)) = dq(coordinates(i)) + b(e)*rate
    end do
  end subroutine take_rates

  !> Velocities of the frames of a block, and their accelerations with no accelerations of any coordinate.
  pure subroutine move_frames(block, steps, dq, motion)
    type(block_type), intent(in) :: block               !< the block
    type(planar_step_type), intent(in) :: steps(*)      !< the steps of the plan
    real(wp), intent(in) :: dq(*)                       !< (M) rates of all coordinates [rad/s, m/s]
    type(planar_motion_type), intent(inout) :: motion   !< with poses; gets velocities and accelerations of these frames

    call move(motion%pose, motion%slide, motion%velocity, motion%acceleration)

  contains

    !> The same from plain arrays.
    pure subroutine move(f, slide, v, a)
      real(wp), intent(in) :: f(4, 0:*)      !< pose of each frame, in the plane's axes [m]
      real(wp), intent(in) :: slide(2, *)    !< (2,M) velocity of each new origin per unit rate, in the plane's axes [m/rad, 1]
      real(wp), intent(inout) :: v(3, 0:*)   !< velocities of the frames, in the plane's axes [rad/s, m/s]
      real(wp), intent(inout) :: a(3, 0:*)   !< accelerations of the frames, in the plane's axes [rad/s^2, m/s^2]
      real(wp) :: arm(2), rate
      integer :: s, p

      do s = block%first_step, block%last_step
        p = steps(s)%parent
        arm = f(3:4, s) - f(3:4, p)
        rate = dq(steps(s)%coordinate)
        call step_velocity(steps(s), rate, arm, slide(:, s), v(:, p), v(:, s))
        call step_acceleration(steps(s), [rate, 0.0_wp], arm, slide(:, s), v(1, p), a(:, p), a(:, s))
      end do
    end subroutine move
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

  !> B of the three coordinates of a planar chain that determines them by itself (mech9_planar_chain), and their rates from those
  !> of the independent coordinates. The right-hand sides stay in registers.
  pure subroutine find_chain_rates(flat, inverse, steps, motion, jacobian, dq)
    type(planar_block_type), intent(in) :: flat      !< the loop
    real(wp), intent(in) :: inverse(3, 3)            !< (3,3) inverse of the Jacobian, of unknowns per rad and per length [1]
    type(planar_step_type), intent(in) :: steps(*)   !< the steps of the plan
    type(planar_motion_type), intent(in) :: motion   !< with the poses of the frames
    type(jacobian_type), intent(inout) :: jacobian   !< with the columns of earlier blocks; gets B
    real(wp), intent(inout) :: dq(*)                 !< (M) rates of all coordinates; gets those of the three [rad/s, m/s]

    call find(motion%pose, motion%slide, jacobian%flat, jacobian%b, dq)

  contains

    !> The same from plain arrays.
    pure subroutine find(f, slide, columns, b, dq)
      real(wp), intent(in) :: f(4, 0:*)        !< pose of each frame, in the plane's axes [m]
      real(wp), intent(in) :: slide(2, *)      !< (2,M) velocity of each new origin per unit rate, in the plane's axes [m/rad, 1]
      real(wp), intent(in) :: columns(3, *)    !< (3,entries) of the frames of earlier blocks, in the plane's axes [1, m/rad]
      real(wp), intent(inout) :: b(*)          !< (entries) gets B, rate of the coordinate per unit rate of an independent one [1, rad/m, m/rad]
      real(wp), intent(inout) :: dq(*)         !< rates of all coordinates; gets those of the three [rad/s, m/s]
      real(wp) :: side(3), rate
      integer :: i, j, e

      do i = 1, 3
        dq(flat%chain%coordinates(i)) = 0.0_wp
      end do
      do j = 1, flat%columns
        call find_side(j, flat, steps, f, slide, columns, side)
        rate = dq(flat%given(j))
        side = side*(-1.0_wp/flat%given_units(j))
        do i = 1, 3
          e = flat%first_entries(i) + j - 1
          b(e) = (inverse(i, 1)*side(1) + inverse(i, 2)*side(2) + inverse(i, 3)*side(3))*flat%units(i)
          dq(flat%chain%coordinates(i)) = dq(flat%chain%coordinates(i)) + b(e)*rate
        end do
      end do
    end subroutine find
  end subroutine find_chain_rates

  !> The motion of the ends of a chain's loop relative to each other for one independent coordinate, in the closure's equations.
  pure subroutine find_side(j, flat, steps, f, slide, columns, side)
    integer, intent(in) :: j                         !< place of the coordinate among those of the block
    type(planar_block_type), intent(in) :: flat      !< the loop
    type(planar_step_type), intent(in) :: steps(*)   !< the steps of the plan
    real(wp), intent(in) :: f(4, 0:*)                !< (4,0:M) pose of each frame, in the plane's axes [m]
    real(wp), intent(in) :: slide(2, *)              !< (2,M) velocity of each new origin per unit rate, in the plane's axes
    real(wp), intent(in) :: columns(3, *)            !< (entries) of the frames of earlier blocks, in the plane's axes
    real(wp), intent(out) :: side(3)                 !< (3) rows in rad or parts of length, per rad or per length [1]
    real(wp) :: column(3)
    integer :: i, s

    side = 0.0_wp
    do i = 1, size(flat%independent)
      associate (part => flat%independent(i))
        if (part%column /= j) cycle
        s = part%frame
        call step_column(steps(s), part%weight, f(:, s), slide(:, s), f(3:4, part%base), flat%chain%per_length, column)
        side = side + column
      end associate
    end do
    do i = 1, size(flat%earlier)
      associate (part => flat%earlier(i))
        if (part%column /= j) cycle
        call add_part(part, flat%chain%per_length, f(3:4, part%base) - f(3:4, part%frame), columns(:, part%entry), side)
      end associate
    end do
  end subroutine find_side

  !> Velocities and columns of the frames of a planar chain, and the bias acceleration of its loop. One loop moves the frames.
  pure subroutine move_chain_frames(chain, steps, dynamics, dq, motion, jacobian, bias)
    type(planar_chain_type), intent(in) :: chain        !< the chain
    type(planar_step_type), intent(in) :: steps(*)      !< the steps of the plan
    type(dynamics_plan_type), intent(in) :: dynamics    !< the plan of dynamics
    real(wp), intent(in) :: dq(*)                       !< (M) rates of all coordinates [rad/s, m/s]
    type(planar_motion_type), intent(inout) :: motion   !< with poses; gets the velocities of these frames
    type(jacobian_type), intent(inout) :: jacobian      !< with `b`; gets the columns of these frames
    real(wp), intent(out) :: bias(2)                    !< bias acceleration of the loop [m/s^2]

    call move(dynamics%parent_entry, motion%pose, motion%slide, jacobian%b, jacobian%flat, motion%velocity, bias)

  contains

    !> The same from plain arrays.
    pure subroutine move(parent_entry, f, slide, b, columns, v, bias)
      integer, intent(in) :: parent_entry(*)      !< (entries) the same column in the parent frame, 0 for none
      real(wp), intent(in) :: f(4, 0:*)           !< pose of each frame, in the plane's axes [m]
      real(wp), intent(in) :: slide(2, *)         !< (2,M) velocity of each new origin per unit rate, in the plane's axes [m/rad, 1]
      real(wp), intent(in) :: b(*)                !< (entries) B, rate of the step's coordinate per unit rate of an independent one [1, rad/m, m/rad]
      real(wp), intent(inout) :: columns(3, *)    !< (3,entries) angular velocity and velocity of the origin per unit rate, plane's axes [1, m/rad]
      real(wp), intent(inout) :: v(3, 0:*)        !< velocities of the frames, in the plane's axes [rad/s, m/s]
      real(wp), intent(out) :: bias(2)            !< bias acceleration of the loop [m/s^2]
      real(wp) :: arm(2), carried(3), rate
      integer :: s, p, e

      bias = 0.0_wp
      do s = chain%first_step, chain%last_step
        p = steps(s)%parent
        rate = dq(steps(s)%coordinate)
        arm = f(3:4, s) - f(3:4, p)
        call step_velocity(steps(s), rate, arm, slide(:, s), v(:, p), v(:, s))
        call add_bias(steps(s), chain%signs(s), rate, arm, slide(:, s), v(1, p), bias)
        if (.not. dynamics%carries_columns(s)) cycle
        do e = dynamics%first(s), dynamics%first(s + 1) - 1
          carried = 0.0_wp
          if (parent_entry(e) > 0) carried = columns(:, parent_entry(e))
          call step_velocity(steps(s), b(e), arm, slide(:, s), carried, columns(:, e))
        end do
      end do
    end subroutine move
  end subroutine move_chain_frames
end module mech9_planar_block
