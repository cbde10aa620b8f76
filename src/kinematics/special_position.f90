!> Looking ahead where a block comes near a singular position: does the motion end there, or go through?
!> Uses kinds, error, mechanism, plan, following.
!>
!> A scout follows the branch down to a small distance. At a dead point the rates of the block grow
!> without bound, as 1/sqrt(T - t); two positions of the scout then give T far better than Newton's method
!> could find it. Where branches cross, the rates stay finite while the least pivot falls to zero
!> at an even rate. Everything between, two branches that come close and part again, the scout
!> simply passes.
module mech9_special_position
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  use mech9_following, only: follower_type, step_towards
  implicit none
  private
  public :: finding_type, look_ahead, is_near, nothing_special, dead_point, crossing, lost

  integer, parameter :: nothing_special = 0
  integer, parameter :: dead_point = 1      !< the motion ends there
  integer, parameter :: crossing = 2        !< branches cross: it can go through
  integer, parameter :: lost = 3            !< neither; but no step goes on

  !> What lies ahead.
  type :: finding_type
    integer :: kind = nothing_special
    integer :: block = 0
    real(wp) :: t = 0.0_wp                  !< when it is reached; nothing special: until when [s]
  end type finding_type

  !> Near: the least pivot is below this part of the largest it was.
  real(wp), parameter :: near = 0.03_wp
  !> Rates that have grown so much come from a dead point ...
  real(wp), parameter :: dead_growth = 1.0e3_wp
  !> ... and at this part of the largest pivot those that have not grown so much come from a crossing.
  real(wp), parameter :: crossing_pivot = 1.0e-6_wp
  real(wp), parameter :: crossing_growth = 3.0_wp
  !> Round-off may let no step pass already somewhat before.
  real(wp), parameter :: stuck_pivot = 1.0e-4_wp
  !> Below this part round-off rules, and it must be decided.
  real(wp), parameter :: last_pivot = 3.0e-8_wp
  !> Steps of a scout: the movement of a driven or dependent coordinate [rad, lengths of the mechanism].
  real(wp), parameter :: scout_move = 0.1_wp
  integer, parameter :: most_steps = 2000
  !> A step of a scout against the one before it, and how often it is shortened for drives that end.
  real(wp), parameter :: longer = 4.0_wp
  integer, parameter :: most_trials = 20

contains

  !> Whether a block of a follower is near a singular position.
  pure logical function is_near(follower, b)
    type(follower_type), intent(in) :: follower
    integer, intent(in) :: b

    is_near = follower%watches(b)%pivot < near*follower%watches(b)%largest_pivot
  end function is_near

  !> Look ahead from a follower that is near a singular position of its block b.
  subroutine look_ahead(mechanism, plan, follower, b, direction, finding)
    type(mechanism_type), intent(in) :: mechanism
    type(plan_type), intent(in) :: plan
    type(follower_type), intent(in) :: follower
    integer, intent(in) :: b
    real(wp), intent(in) :: direction          !< +1, or -1 backwards in time
    type(finding_type), intent(out) :: finding
    type(follower_type) :: scout
    type(error_type), allocatable :: err
    real(wp) :: usual, speed, growth, part, pivot_before, t_before, t, step
    integer :: i, trial, refused_by
    logical :: stuck

    finding%block = b
    finding%t = follower%departure%t
    usual = 0.0_wp
    call find_speeds(plan, follower, b, speed, usual)
    usual = max(usual, speed)
    if (.not. speed > 0.0_wp) return            ! at rest: no telling where it goes
    scout = follower
    do i = 1, most_steps
      if (.not. speed > 0.0_wp) return
      pivot_before = scout%watches(b)%pivot
      t_before = scout%departure%t
      step = min(scout%reach, scout_move/speed, longer*scout%departure%before)
      do trial = 1, most_trials
        t = t_before + direction*step
        call step_towards(mechanism, plan, scout, t, stuck, refused_by, err)
        if (.not. allocated(err)) exit
        step = step/longer                      ! a drive may end before a special position, or just at it
      end do
      if (allocated(err)) return
      if (stuck .and. refused_by /= b) return   ! another block has its own turn
      finding%t = scout%departure%t
      call find_speeds(plan, scout, b, speed, usual)
      growth = speed/max(usual, tiny(usual))
      part = scout%watches(b)%pivot/scout%watches(b)%largest_pivot
      if (part > 2.0_wp*near) return
      if (growth > dead_growth .or. ((stuck .or. part < last_pivot) .and. growth > crossing_growth)) then
        finding%kind = dead_point
        finding%t = time_of_dead_point(plan, scout, b)
        return
      else if (part < last_pivot .or. (growth < crossing_growth .and. &
                                       (part < crossing_pivot .or. (stuck .and. part < stuck_pivot)))) then
        finding%kind = crossing
        if (scout%watches(b)%pivot < pivot_before) finding%t = scout%departure%t &
          + (scout%departure%t - t_before)*scout%watches(b)%pivot/(pivot_before - scout%watches(b)%pivot)
        return
      else if (stuck) then
        finding%kind = lost
        return
      end if
    end do
  end subroutine look_ahead

  !> Largest rate of a block's dependent coordinates, and of all that drives it if that is more than `usual`.
  pure subroutine find_speeds(plan, follower, b, speed, usual)
    type(plan_type), intent(in) :: plan
    type(follower_type), intent(in) :: follower
    integer, intent(in) :: b
    real(wp), intent(out) :: speed              !< [rad/s, lengths of the mechanism/s]
    real(wp), intent(inout) :: usual
    integer :: s, k

    speed = 0.0_wp
    do s = 1, plan%blocks(b)%last_step
      k = plan%steps(s)%coordinate
      if (s >= plan%blocks(b)%first_step .and. plan%steps(s)%dependent) then
        speed = max(speed, abs(follower%departure%dq(k))/plan%unit_of(k))
      else
        usual = max(usual, abs(follower%departure%dq(k))/plan%unit_of(k))
      end if
    end do
  end subroutine find_speeds

  !> When the square-root law ends: x = x* + c sqrt(T - t) has x'/x'' = 2 (T - t).
  pure real(wp) function time_of_dead_point(plan, follower, b) result(t)
    type(plan_type), intent(in) :: plan
    type(follower_type), intent(in) :: follower
    integer, intent(in) :: b
    integer :: i, k, fastest

    fastest = plan%blocks(b)%coordinates(1)
    do i = 2, size(plan%blocks(b)%unknowns)
      k = plan%blocks(b)%coordinates(i)
      if (abs(follower%departure%dq(k))/plan%unit_of(k) > abs(follower%departure%dq(fastest))/plan%unit_of(fastest)) &
        fastest = k
    end do
    t = follower%departure%t
    associate (dq => follower%departure%dq(fastest), ddq => follower%departure%ddq(fastest))
      if (abs(ddq) > 0.0_wp) t = t + 0.5_wp*dq/ddq
    end associate
  end function time_of_dead_point
end module mech9_special_position
