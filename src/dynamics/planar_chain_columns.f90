!> Rates of a planar closed chain that determines three coordinates by itself (mech9_planar_chain): B = dq/dq_i of these
!> coordinates, their rates, and the columns and velocities of the frames. The results are those of mech9_planar_block for any
!> block; the right-hand sides stay in registers, and one loop moves the frames.
module mech9_planar_chain_columns
  use mech9_kinds, only: wp
  use mech9_planar_plan, only: planar_step_type
  use mech9_planar_formulas, only: step_column, step_velocity, add_bias
  use mech9_planar_block, only: planar_block_type, loop_part_type, add_part
  implicit none
  private
  public :: chain_columns

contains

  !> B of the three coordinates, their rates from those of the independent coordinates, columns and velocities of the frames,
  !> and the bias acceleration of the loop.
  pure subroutine chain_columns(flat, first, last, signs, inverse, per_length, m, steps, f, slide, n_b, entries, parent_entry, &
                                carries, columns, b, dq, v, bias)
    type(planar_block_type), intent(in) :: flat      !< the loop
    integer, intent(in) :: first                     !< first step of the chain
    integer, intent(in) :: last                      !< last step of the chain
    real(wp), intent(in) :: signs(first:last)        !< of each step in the loop: 1 or -1; 0: not in it
    real(wp), intent(in) :: inverse(3, 3)            !< inverse of the Jacobian
    real(wp), intent(in) :: per_length               !< one over the mechanism's size [1/m]
    integer, intent(in) :: m                         !< number of steps
    type(planar_step_type), intent(in) :: steps(m)   !< the steps of the plan
    real(wp), intent(in) :: f(4, 0:m)                !< pose of each frame, in the plane's axes [m]
    real(wp), intent(in) :: slide(2, m)              !< velocity of each new origin per unit rate, in the plane's axes
    integer, intent(in) :: n_b                       !< number of entries of all frames
    integer, intent(in) :: entries(0:m + 1)          !< first entry of each frame
    integer, intent(in) :: parent_entry(n_b)         !< the same column in the parent frame, 0 for none
    logical, intent(in) :: carries(0:m)              !< frames whose columns are requested
    real(wp), intent(inout) :: columns(3, n_b)       !< angular velocity and velocity of the origin per unit rate, plane's axes
    real(wp), intent(inout) :: b(n_b)                !< gets B, rate of the coordinate per unit rate of an independent one
    real(wp), intent(inout) :: dq(m)                 !< rates of all coordinates; gets those of the three [rad/s, m/s]
    real(wp), intent(inout) :: v(3, 0:m)             !< velocities of the frames, in the plane's axes [rad/s, m/s]
    real(wp), intent(out) :: bias(2)                 !< bias acceleration of the loop [m/s^2]
    real(wp) :: side(3), carried(3), x, y, rate
    integer :: i, j, e, s, p

    do i = 1, 3
      dq(flat%chain%coordinates(i)) = 0.0_wp
    end do
    do j = 1, flat%columns
      call find_side(j, size(flat%independent), flat%independent, size(flat%earlier), flat%earlier, per_length, m, steps, &
                     f, slide, n_b, columns, side)
      rate = dq(flat%given(j))
      side = side*(-1.0_wp/flat%given_units(j))
      do i = 1, 3
        e = flat%first_entries(i) + j - 1
        b(e) = (inverse(i, 1)*side(1) + inverse(i, 2)*side(2) + inverse(i, 3)*side(3))*flat%units(i)
        dq(flat%chain%coordinates(i)) = dq(flat%chain%coordinates(i)) + b(e)*rate
      end do
    end do
    bias = 0.0_wp
    do s = first, last
      p = steps(s)%parent
      rate = dq(steps(s)%coordinate)
      x = f(3, s) - f(3, p)
      y = f(4, s) - f(4, p)
      call step_velocity(steps(s), rate, [x, y], slide(:, s), v(:, p), v(:, s))
      call add_bias(steps(s), signs(s), rate, [x, y], slide(:, s), v(1, p), bias)
      if (.not. carries(s)) cycle
      do e = entries(s), entries(s + 1) - 1
        carried = 0.0_wp
        if (parent_entry(e) > 0) carried = columns(:, parent_entry(e))
        call step_velocity(steps(s), b(e), [x, y], slide(:, s), carried, columns(:, e))
      end do
    end do
  end subroutine chain_columns

  !> The motion of the ends of the loop relative to each other for one independent coordinate, in the closure's equations.
  pure subroutine find_side(j, n, independent, n_earlier, earlier, per_length, m, steps, f, slide, n_b, columns, side)
    integer, intent(in) :: j                                !< place of the coordinate among those of the block
    integer, intent(in) :: n                                !< number of steps with independent coordinates
    type(loop_part_type), intent(in) :: independent(n)      !< these
    integer, intent(in) :: n_earlier                        !< number of columns of frames of earlier blocks
    type(loop_part_type), intent(in) :: earlier(n_earlier)  !< these
    real(wp), intent(in) :: per_length                      !< one over the mechanism's size [1/m]
    integer, intent(in) :: m                                !< number of steps
    type(planar_step_type), intent(in) :: steps(m)          !< the steps of the plan
    real(wp), intent(in) :: f(4, 0:m)                       !< pose of each frame, in the plane's axes [m]
    real(wp), intent(in) :: slide(2, m)                     !< velocity of each new origin per unit rate, in the plane's axes
    integer, intent(in) :: n_b                              !< number of entries of all frames
    real(wp), intent(in) :: columns(3, n_b)                 !< of the frames of earlier blocks, in the plane's axes
    real(wp), intent(out) :: side(3)                        !< rows in rad or parts of length, per rad or per length
    real(wp) :: part(3)
    integer :: i, s

    side = 0.0_wp
    do i = 1, n
      if (independent(i)%column /= j) cycle
      s = independent(i)%frame
      call step_column(steps(s), independent(i)%weight, f(:, s), slide(:, s), f(3:4, independent(i)%base), per_length, part)
      side = side + part
    end do
    do i = 1, n_earlier
      if (earlier(i)%column /= j) cycle
      call add_part(earlier(i), per_length, f(3:4, earlier(i)%base) - f(3:4, earlier(i)%frame), columns(:, earlier(i)%entry), &
                    side)
    end do
  end subroutine find_side
end module mech9_planar_chain_columns
