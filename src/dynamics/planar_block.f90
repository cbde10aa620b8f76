!> A block of closed chains in planar arithmetic: which steps its closures hold, listed once, and the loops over these lists
!> that an evaluation of the motion runs through.
!>
!> What a closure lacks is the sum of what the steps of its loop give to it, each seen from the loop's base. Those
!> of the block's unknowns make up the Jacobian. The independent ones and the frames of earlier blocks, from
!> which the loop sets out, give the right-hand sides for B = dq/dq_i: no frame of the block is moved for that.
module mech9_planar_block
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_planar_plan, only: planar_step_type
  use mech9_planar_formulas, only: step_column, step_velocity, step_acceleration
  use mech9_planar_lagrange, only: carry_columns
  implicit none
  private
  public :: planar_block_type, loop_part_type, list_loops, fill_columns, add_earlier, move_frames

  !> A step in a loop, or a frame of an earlier block from which it sets out.
  type :: loop_part_type
    integer :: frame = 0           !< also the number of the step
    integer :: row = 0             !< equations of the block before those of the closure
    integer :: base = 0            !< frame at whose origin the closure is written
    integer :: column = 0          !< unknown among those of the block, or right-hand side
    integer :: entry = 0           !< of a frame of an earlier block: that of its column
    real(wp) :: weight = 1.0_wp    !< +1 towards the closing frame, -1 towards the target; of a column times its unit
  end type loop_part_type

  !> The loops of a block.
  type :: planar_block_type
    integer :: columns = 0                               !< independent coordinates that the block depends on
    type(loop_part_type), allocatable :: unknowns(:)
    type(loop_part_type), allocatable :: independent(:)
    type(loop_part_type), allocatable :: earlier(:)
  end type planar_block_type

contains

  !> What the loops of block b hold. The columns of its frames and of those before must be known.
  pure subroutine list_loops(plan, b, first, column, place_of, flat)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: b
    integer, intent(in) :: first(0:)                      !< as in the dynamics plan, likewise the next
    integer, intent(in) :: column(:), place_of(:)
    type(planar_block_type), intent(out) :: flat
    type(loop_part_type) :: part
    integer :: c, i

    allocate (flat%unknowns(0), flat%independent(0), flat%earlier(0))
    associate (block => plan%blocks(b))
      flat%columns = first(block%first_step + 1) - first(block%first_step)
      associate (columns => column(first(block%first_step):first(block%first_step + 1) - 1))
        do c = block%first_closure, block%last_closure
          part%row = 3*(c - block%first_closure)
          part%base = plan%closures(c)%base
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
            ! a motion that both ends share opens nothing
            if (stems(1) == stems(2)) cycle
            call list_columns(plan, stems(1), 1.0_wp, first, column, columns, part, flat%earlier)
            call list_columns(plan, stems(2), -1.0_wp, first, column, columns, part, flat%earlier)
          end associate
        end do
      end associate
    end associate
  end subroutine list_loops

  !> A part for each column of a frame of an earlier block.
  pure subroutine list_columns(plan, frame, sign, first, column, columns, part, parts)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: frame
    real(wp), intent(in) :: sign
    integer, intent(in) :: first(0:), column(:)
    integer, intent(in) :: columns(:)                     !< of the block
    type(loop_part_type), intent(inout) :: part
    type(loop_part_type), allocatable, intent(inout) :: parts(:)
    integer :: e

    part%frame = frame
    do e = first(frame), first(frame + 1) - 1
      part%entry = e
      part%weight = sign*plan%unit_of(plan%independent(column(e)))
      part%column = place_among(columns, column(e))
      call append(parts, part)
    end do
  end subroutine list_columns

  !> Where a number stands in a list; 0 when it is not there.
  pure integer function place_among(list, number) result(place)
    integer, intent(in) :: list(:)
    integer, intent(in) :: number

    do place = size(list), 1, -1
      if (list(place) == number) return
    end do
  end function place_among

  !> One more part.
  pure subroutine append(parts, part)
    type(loop_part_type), allocatable, intent(inout) :: parts(:)
    type(loop_part_type), intent(in) :: part

    parts = [parts, part]
  end subroutine append

  ! Arrays of known shape, apart from their types: the compiler then keeps their addresses in registers.

  !> Derivatives of the closures with respect to the coordinates of steps, those of lengths in the mechanism's: into
  !> the columns of a matrix, which is zero elsewhere.
  pure subroutine fill_columns(n, parts, m, steps, f, slide, length, rows, columns, matrix)
    integer, intent(in) :: n, m                   !< parts, steps
    type(loop_part_type), intent(in) :: parts(n)
    type(planar_step_type), intent(in) :: steps(m)
    real(wp), intent(in) :: f(4, 0:m), slide(2, m)
    real(wp), intent(in) :: length                !< of the mechanism [m]
    integer, intent(in) :: rows, columns
    real(wp), intent(out) :: matrix(rows, columns)
    real(wp) :: per_length
    integer :: i, s, row

    per_length = 1.0_wp/length
    matrix = 0.0_wp
    do i = 1, n
      s = parts(i)%frame
      row = parts(i)%row
      call step_column(steps(s), parts(i)%weight, f(:, s), slide(:, s), f(3:4, parts(i)%base), per_length, &
                       matrix(row + 1:row + 3, parts(i)%column))
    end do
  end subroutine fill_columns

  !> Add what frames of earlier blocks give to the closures, from their columns.
  pure subroutine add_earlier(n, parts, m, f, n_entries, entries, length, rows, columns, matrix)
    integer, intent(in) :: n, m, n_entries        !< parts, steps, entries
    type(loop_part_type), intent(in) :: parts(n)
    real(wp), intent(in) :: f(4, 0:m)
    real(wp), intent(in) :: entries(3, n_entries) !< the columns of all frames
    real(wp), intent(in) :: length                !< of the mechanism [m]
    integer, intent(in) :: rows, columns
    real(wp), intent(inout) :: matrix(rows, columns)
    real(wp) :: per_length, w, x, y
    integer :: i, row, j

    per_length = 1.0_wp/length
    do i = 1, n
      row = parts(i)%row
      j = parts(i)%column
      w = entries(1, parts(i)%entry)
      x = entries(2, parts(i)%entry) - w*(f(4, parts(i)%base) - f(4, parts(i)%frame))
      y = entries(3, parts(i)%entry) + w*(f(3, parts(i)%base) - f(3, parts(i)%frame))
      matrix(row + 1, j) = matrix(row + 1, j) + parts(i)%weight*w
      matrix(row + 2, j) = matrix(row + 2, j) + parts(i)%weight*per_length*x
      matrix(row + 3, j) = matrix(row + 3, j) + parts(i)%weight*per_length*y
    end do
  end subroutine add_earlier

  !> Columns, velocities, and accelerations without accelerations of any coordinate, of frames first .. last.
  pure subroutine move_frames(m, n_b, steps, first, last, entries, parent_entry, carries, b, dq, f, slide, columns, v, a)
    integer, intent(in) :: m, n_b                 !< steps, entries of B
    type(planar_step_type), intent(in) :: steps(m)
    integer, intent(in) :: first, last
    integer, intent(in) :: entries(0:m + 1), parent_entry(n_b)   !< as in the dynamics plan
    logical, intent(in) :: carries(0:m)           !< frames whose columns are asked for
    real(wp), intent(in) :: b(n_b), dq(m)
    real(wp), intent(in) :: f(4, 0:m), slide(2, m)
    real(wp), intent(inout) :: columns(3, n_b), v(3, 0:m), a(3, 0:m)
    real(wp) :: x, y, rate
    integer :: s, p

    do s = first, last
      p = steps(s)%parent
      x = f(3, s) - f(3, p)
      y = f(4, s) - f(4, p)
      rate = dq(steps(s)%coordinate)
      call step_velocity(steps(s), rate, x, y, slide(:, s), v(:, p), v(:, s))
      call step_acceleration(steps(s), rate, 0.0_wp, x, y, slide(:, s), v(1, p), a(:, p), a(:, s))
      if (carries(s)) &
        call carry_columns(n_b, entries(s), entries(s + 1) - 1, parent_entry, steps(s), slide(:, s), x, y, b, columns)
    end do
  end subroutine move_frames
end module mech9_planar_block
