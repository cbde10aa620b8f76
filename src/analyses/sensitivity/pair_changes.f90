!> The twists by which users' pairs move when a parameter changes the numbers that their procedures receive.
!>
!> The procedures know nothing of derivatives by these numbers: they come from differences over wide stencils, to near round-off. The
!> derivatives in time follow exactly, since the procedures, or differences of them, give those in the coordinate.
module mech9_pair_changes
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, step_count, trial_step, best_slopes_type, length_along
  use mech9_rotation, only: turn, cross, combine, axial_vector
  use mech9_pair, only: pair_motion_type, reversed_motion
  use mech9_procedure_pair, only: procedure_pair_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_twists, only: frame_twists_type, bracket
  use mech9_tangent, only: tangent_type
  implicit none
  private
  public :: find_pair_change

  !> Numbers of a motion: rotation by columns, origin, angular rate, rate, and their derivatives in the coordinate.
  integer, parameter :: numbers_of_motion = 24

contains

  !> The twist of the step of a user's pair by a parameter, with its derivatives in time.
  subroutine find_pair_change(plan, state, motion, tangent, s, highest, series, slope)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state            !< the motion
    type(frame_twists_type), intent(in) :: motion    !< its twists
    type(tangent_type), intent(in) :: tangent        !< derivatives of the constants by the parameter
    integer, intent(in) :: s                         !< the step
    integer, intent(in) :: highest                   !< order of the highest derivative in time
    real(wp), intent(inout) :: series(6, 0:2)        !< gets the twist in frame 0, up to this derivative
    real(wp), intent(out), optional :: slope(6)      !< its derivative in the coordinate, with the frame before at rest
    real(wp) :: own(6, 0:2)
    integer :: k

    k = plan%steps(s)%coordinate
    select type (pair => plan%pairs(k)%pair)
    type is (procedure_pair_type)
      call find_own(pair, tangent%pairs(k)%change, state%q(k), plan%steps(s)%reversed, own)
      call find_series(plan, state, motion, s, own, highest, series)
      if (present(slope)) slope = in_frame_0(plan, state, s, own(:, 1))
    end select
  end subroutine find_pair_change

  !> The twist of a pair by a parameter in its frame in the link that it departs from, and its derivatives in the coordinate. It is NaN
  !> where the procedure has no pose beside the present numbers.
  subroutine find_own(pair, change, q, reversed, own)
    type(procedure_pair_type), intent(in) :: pair   !< the pair
    real(wp), intent(in) :: change(:)               !< derivatives of its numbers
    real(wp), intent(in) :: q                       !< its coordinate
    logical, intent(in) :: reversed                 !< the step leads from the moving link to the reference link
    real(wp), intent(out) :: own(6, 0:2)            !< the twist [rad, m] and two derivatives in q
    type(procedure_pair_type) :: beside
    type(pair_motion_type) :: motion
    type(best_slopes_type) :: best
    real(wp) :: values(numbers_of_motion, -half_width:half_width), h, r(3, 3), varied(3, 3)
    integer :: number, i
    logical :: good

    own = ieee_value(q, ieee_quiet_nan)
    beside = pair
    do number = 1, step_count
      h = trial_step(number, length_along(pair%parameters, change))
      do i = -half_width, half_width
        beside%parameters = pair%parameters + i*h*change
        call sample(beside, q, reversed, motion, values(:, i))
      end do
      call best%offer(values, h, good)
      if (good) exit
    end do
    if (.not. allocated(best%slopes)) return
    call sample(pair, q, reversed, motion, values(:, 0))
    associate (slopes => best%slopes, p => motion%pose%p, w => motion%w, v => motion%v, w_rate => motion%w_rate)
      r = transpose(motion%pose%r)
      varied = reshape(slopes(1:9), [3, 3])
      own(1:3, 0) = axial_vector(matmul(varied, r))
      own(1:3, 1) = slopes(13:15) + cross(w, own(1:3, 0))
      own(1:3, 2) = slopes(19:21) + cross(w_rate, own(1:3, 0)) + cross(w, own(1:3, 1))
      own(4:6, 0) = slopes(10:12) - cross(own(1:3, 0), p)
      own(4:6, 1) = slopes(16:18) - cross(own(1:3, 1), p) - cross(own(1:3, 0), v)
      own(4:6, 2) = slopes(22:24) - cross(own(1:3, 2), p) - 2.0_wp*cross(own(1:3, 1), v) - cross(own(1:3, 0), motion%v_rate)
    end associate
  end subroutine find_own

  !> The motion of a pair, and its numbers in a row; NaN where there is none.
  subroutine sample(pair, q, reversed, motion, values)
    type(procedure_pair_type), intent(in) :: pair     !< the pair
    real(wp), intent(in) :: q                         !< its coordinate
    logical, intent(in) :: reversed                   !< the motion of the reference link in the moving link is meant
    type(pair_motion_type), intent(out) :: motion     !< the motion
    real(wp), intent(out) :: values(:)                !< its numbers
    type(error_type), allocatable :: err

    call pair%evaluate(q, motion, err)
    if (reversed .and. .not. allocated(err)) motion = reversed_motion(motion)
    values = [reshape(motion%pose%r, [9]), motion%pose%p, motion%w, motion%v, motion%w_rate, motion%v_rate]
    if (allocated(err)) values = ieee_value(q, ieee_quiet_nan)
  end subroutine sample

  !> A twist in the frame of a pair, seen in frame 0, with its first two derivatives in time.
  pure subroutine find_series(plan, state, motion, s, own, highest, series)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state            !< the motion
    type(frame_twists_type), intent(in) :: motion    !< its twists
    integer, intent(in) :: s                         !< step of the pair
    real(wp), intent(in) :: own(6, 0:2)              !< the twist and two derivatives in the coordinate, in the frame of the pair
    integer, intent(in) :: highest                   !< order of the highest derivative in time
    real(wp), intent(inout) :: series(6, 0:2)        !< the twist and its derivatives in time
    real(wp) :: seen(6, 0:2)
    integer :: i, j

    associate (step => plan%steps(s), dq => state%dq(plan%steps(s)%coordinate), ddq => state%ddq(plan%steps(s)%coordinate))
      i = step%parent
      do j = 0, 2
        seen(:, j) = in_frame_0(plan, state, s, own(:, j))
      end do
      series(:, 0) = seen(:, 0)
      if (highest < 1) return
      series(:, 1) = bracket(motion%velocity(:, i), series(:, 0)) + dq*seen(:, 1)
      if (highest < 2) return
      series(:, 2) = bracket(motion%acceleration(:, i), series(:, 0)) + bracket(motion%velocity(:, i), series(:, 1)) &
                     + dq*bracket(motion%velocity(:, i), seen(:, 1)) + ddq*seen(:, 1) + dq**2*seen(:, 2)
    end associate
  end subroutine find_series

  !> A twist in the frame from which a step departs as a twist in frame 0.
  pure function in_frame_0(plan, state, s, own) result(seen)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state            !< with the poses of the frames
    integer, intent(in) :: s                         !< the step
    real(wp), intent(in) :: own(6)                   !< the twist in the frame of the pair
    real(wp) :: seen(6), departing(3, 3), place(3)

    associate (i => plan%steps(s)%parent, before => plan%steps(s)%before)
      departing = combine(state%r(:, :, i), before%r)
      place = state%p(:, i) + turn(state%r(:, :, i), before%p)
      seen(1:3) = turn(departing, own(1:3))
      seen(4:6) = turn(departing, own(4:6)) + cross(place, seen(1:3))
    end associate
  end function in_frame_0
end module mech9_pair_changes
