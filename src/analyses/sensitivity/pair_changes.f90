!> The twists by which pairs without a fixed axis move when a parameter changes numbers beside those of their frames, such as the
!> size of a curve or the numbers that a user's procedure receives. The derivatives in time follow from those in the coordinate, which
!> the pair gives.
module mech9_pair_changes
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn, cross, combine
  use mech9_pair, only: pair_type, pair_motion_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_twists, only: frame_twists_type, bracket
  use mech9_tangent, only: tangent_type
  implicit none
  private
  public :: find_pair_change, carry_pair_change

contains

  !> The twist of the step of a pair by a parameter in frame 0, and its derivatives in the coordinate while the frame before is at
  !> rest.
  subroutine find_pair_change(plan, state, tangent, s, change)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state            !< with the poses of the frames
    type(tangent_type), intent(in) :: tangent        !< derivatives of the constants by the parameter
    integer, intent(in) :: s                         !< the step
    real(wp), intent(out) :: change(6, 0:2)          !< the twist and two derivatives
    real(wp) :: twist(6, 0:2)
    integer :: j, k

    k = plan%steps(s)%coordinate
    call find_twist(plan%pairs(k)%pair, tangent%pairs(k)%change, state%q(k), plan%steps(s)%reversed, twist)
    do j = 0, 2
      change(:, j) = in_frame_0(plan, state, s, twist(:, j))
    end do
  end subroutine find_pair_change

  !> The twist of a pair by a parameter in its frame in the link that the step departs from, and its derivatives in the coordinate.
  subroutine find_twist(pair, change, q, reversed, twist)
    class(pair_type), intent(in) :: pair            !< the pair
    real(wp), intent(in) :: change(:)               !< derivatives of its numbers
    real(wp), intent(in) :: q                       !< its coordinate
    logical, intent(in) :: reversed                 !< the step leads from the moving link to the reference link
    real(wp), intent(out) :: twist(6, 0:2)          !< the twist [rad, m] and two derivatives in q
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err

    call pair%vary(change, q, twist)
    if (.not. reversed) return
    ! the pair had this pose when the position was found
    call pair%evaluate(q, motion, err)
    twist = reversed_twist(motion, twist)
  end subroutine find_twist

  !> The twist of the reference link by a change of the pair, seen from the moving link.
  pure function reversed_twist(motion, twist) result(back)
    type(pair_motion_type), intent(in) :: motion   !< motion of the moving link in the reference link
    real(wp), intent(in) :: twist(6, 0:2)          !< twist of the moving link in the reference link, and two derivatives in q
    real(wp) :: back(6, 0:2), rate(6), second(6), seen(6, 0:2)
    integer :: j

    rate(1:3) = motion%w
    rate(4:6) = motion%v - cross(motion%w, motion%pose%p)
    second(1:3) = motion%w_rate
    second(4:6) = motion%v_rate - cross(motion%w_rate, motion%pose%p) - cross(motion%w, motion%v)
    ! derivatives seen by an observer in the moving link
    seen(:, 0) = twist(:, 0)
    seen(:, 1) = twist(:, 1) - bracket(rate, twist(:, 0))
    seen(:, 2) = twist(:, 2) - bracket(rate, twist(:, 1)) - bracket(second, twist(:, 0)) - bracket(rate, seen(:, 1))
    do j = 0, 2
      back(1:3, j) = -matmul(transpose(motion%pose%r), seen(1:3, j))
      back(4:6, j) = -matmul(transpose(motion%pose%r), seen(4:6, j) + cross(seen(1:3, j), motion%pose%p))
    end do
  end function reversed_twist

  !> The derivatives in time of the twist of a step by a parameter.
  pure subroutine carry_pair_change(plan, state, motion, s, change, highest, series)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state            !< the motion
    type(frame_twists_type), intent(in) :: motion    !< its twists
    integer, intent(in) :: s                         !< step of the pair
    real(wp), intent(in) :: change(6, 0:2)           !< the twist in frame 0 and two derivatives in the coordinate
    integer, intent(in) :: highest                   !< order of the highest derivative in time
    real(wp), intent(inout) :: series(6, 0:2)        !< gets the twist up to this derivative
    integer :: i

    i = plan%steps(s)%parent
    associate (dq => state%dq(plan%steps(s)%coordinate), ddq => state%ddq(plan%steps(s)%coordinate))
      series(:, 0) = change(:, 0)
      if (highest < 1) return
      series(:, 1) = bracket(motion%velocity(:, i), series(:, 0)) + dq*change(:, 1)
      if (highest < 2) return
      series(:, 2) = bracket(motion%acceleration(:, i), series(:, 0)) + bracket(motion%velocity(:, i), series(:, 1)) &
                     + dq*bracket(motion%velocity(:, i), change(:, 1)) + ddq*change(:, 1) + dq**2*change(:, 2)
    end associate
  end subroutine carry_pair_change

  !> A twist in the frame from which a step departs as a twist in frame 0.
  pure function in_frame_0(plan, state, s, twist) result(seen)
    type(plan_type), intent(in) :: plan              !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state            !< with the poses of the frames
    integer, intent(in) :: s                         !< the step
    real(wp), intent(in) :: twist(6)                 !< the twist in the frame of the pair
    real(wp) :: seen(6), departing(3, 3), place(3)

    associate (i => plan%steps(s)%parent, before => plan%steps(s)%before)
      departing = combine(state%r(:, :, i), before%r)
      place = state%p(:, i) + turn(state%r(:, :, i), before%p)
      seen(1:3) = turn(departing, twist(1:3))
      seen(4:6) = turn(departing, twist(4:6)) + cross(place, seen(1:3))
    end associate
  end function in_frame_0
end module mech9_pair_changes
