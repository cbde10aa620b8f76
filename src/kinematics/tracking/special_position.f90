!> Looking ahead where a block comes near a singular position: does the motion end there, or go through?
!>
!> A scout follows the branch down to a small distance. At a dead point the rates of the block grow
!> without bound, as 1/sqrt(T - t); two positions of the scout then give T far better than Newton's method
!> could find it. Where branches cross, the rates stay finite while the least pivot falls to zero
!> at an even rate. Everything between, two branches that come close and part again, the scout
!> simply passes. A sliding coordinate may also escape: where axes come to be parallel it grows as a
!> power of 1/(T - t), and no position is there at T.
module mech9_special_position
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_predictor, only: acceleration_of
  use mech9_branch_stepping, only: branch_stepper_type, step_towards
  implicit none
  private
  public :: finding_type, look_ahead, find_escape
  public :: nothing_special, dead_point, branch_point, uncertain, escape

  integer, parameter :: nothing_special = 0
  integer, parameter :: dead_point = 1      !< the motion ends there
  integer, parameter :: branch_point = 2        !< branches cross: it can go through
  integer, parameter :: uncertain = 3            !< neither; but no step goes on
  integer, parameter :: escape = 4          !< a sliding coordinate grows beyond all bounds

  !> What lies ahead.
  type :: finding_type
    integer :: kind = nothing_special
    integer :: block = 0
    real(wp) :: t = 0.0_wp                  !< when it is reached; nothing special: until when [s]
    integer :: coordinate = 0               !< that escapes
  end type finding_type

  !> Far from the special position again: the least pivot is above this part of the largest it was.
  real(wp), parameter :: clear = 0.06_wp
  !> Rates that have grown so much come from a dead point ...
  real(wp), parameter :: dead_growth = 1.0e4_wp
  !> ... and at this part of the largest pivot those that have not grown so much come from a crossing.
  real(wp), parameter :: crossing_pivot = 1.0e-6_wp
  real(wp), parameter :: crossing_growth = 3.0_wp
  !> Round-off may let no step pass already somewhat before.
  real(wp), parameter :: stuck_pivot = 1.0e-4_wp
  !> Below this part round-off rules, and it must be decided.
  real(wp), parameter :: last_pivot = 3.0e-8_wp
  !> Steps of a scout: the movement of a driven or dependent coordinate [rad, lengths of the mechanism].
  real(wp), parameter :: probe_move = 0.1_wp
  integer, parameter :: most_steps = 2000
  !> A step of a scout against the one before it, and how often it is shortened for drives that end.
  real(wp), parameter :: longer = 4.0_wp
  integer, parameter :: most_trials = 20
  !> A slide may escape from so many lengths of the mechanism on ...
  real(wp), parameter :: far = 3.0_wp
  !> ... and does, where it is so far and so many times faster than what drives it: two axes that come as close
  !> to parallel as that and part again are hardly meant.
  real(wp), parameter :: far_away = 100.0_wp
  real(wp), parameter :: fast_away = 5.0e3_wp
  !> For x = c/(T - t)^p the quotient x x''/x'^2 is 1 + 1/p, between these; at a dead point it is large.
  real(wp), parameter :: power_law(2) = [1.2_wp, 6.0_wp]

contains

  !> Look ahead from a follower that is near a singular position of its block b.
  subroutine look_ahead(mechanism, plan, stepper, b, direction, finding)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper, near a singular position of block b
    integer, intent(in) :: b   !< number of the block
    real(wp), intent(in) :: direction          !< +1, or -1 backwards in time
    type(finding_type), intent(out) :: finding   !< kind and time of the special position ahead
    type(branch_stepper_type) :: probe
    type(error_type), allocatable :: err
    real(wp) :: usual, speed, growth, part, pivot_before, t_before, t, step
    integer :: i, trial, refused_by
    logical :: stuck

    finding%block = b
    finding%t = stepper%predictor%t
    usual = 0.0_wp
    call find_speeds(plan, stepper, b, speed, usual)
    usual = max(usual, speed)
    if (.not. speed > 0.0_wp) return            ! at rest: no telling where it goes
    probe = stepper
    probe%with_accelerations = .true.
    probe%last_block = b
    do i = 1, most_steps
      if (.not. speed > 0.0_wp) return
      pivot_before = probe%monitors(b)%pivot
      t_before = probe%predictor%t
      step = min(probe%reach, probe_move/speed, longer*probe%predictor%before)
      do trial = 1, most_trials
        t = t_before + direction*step
        call step_towards(mechanism, plan, probe, t, stuck, refused_by, err)
        if (.not. allocated(err)) exit
        step = step/longer                      ! a drive may end before a special position, or just at it
      end do
      if (allocated(err)) return
      if (stuck .and. refused_by /= b) return   ! another block has its own turn
      finding%t = probe%predictor%t
      call find_speeds(plan, probe, b, speed, usual)
      growth = speed/max(usual, tiny(usual))
      part = probe%monitors(b)%pivot/probe%monitors(b)%largest_pivot
      if (part > clear) return
      call find_escape(plan, probe, b, stuck, finding)
      if (finding%kind == escape) return
      if (follows_power_law(plan, probe, b)) cycle
      if (growth > dead_growth .or. ((stuck .or. part < last_pivot) .and. growth > crossing_growth)) then
        finding%kind = dead_point
        finding%t = time_of_dead_point(plan, probe, b)
        return
      else if (part < last_pivot .or. (growth < crossing_growth .and. &
                                       (part < crossing_pivot .or. (stuck .and. part < stuck_pivot)))) then
        finding%kind = branch_point
        if (probe%monitors(b)%pivot < pivot_before) finding%t = probe%predictor%t &
          + (probe%predictor%t - t_before)*probe%monitors(b)%pivot/(pivot_before - probe%monitors(b)%pivot)
        return
      else if (stuck) then
        finding%kind = uncertain
        return
      end if
    end do
  end subroutine look_ahead

  !> Whether the fastest coordinate of a block escapes, and when it is beyond all bounds.
  pure subroutine find_escape(plan, stepper, b, stuck, finding)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    logical, intent(in) :: stuck   !< no step is accepted any more, however far the coordinate is
    type(finding_type), intent(inout) :: finding   !< changed where one escapes
    real(wp) :: speed, usual
    integer :: k

    ! asked at every step of every block: the question first that costs least
    if (.not. slides_far(plan, stepper, b)) return
    usual = 0.0_wp
    call find_speeds(plan, stepper, b, speed, usual)
    k = fastest_of(plan, stepper, b)
    if (.not. stuck .and. (speed <= fast_away*usual .or. abs(stepper%predictor%q(k)) < far_away*plan%unit_of(k))) return
    if (.not. follows_power_law(plan, stepper, b)) return
    associate (q => stepper%predictor%q(k), dq => stepper%predictor%dq(k), ddq => acceleration_of(stepper%predictor, k))
      ! x'/x'' is (T - t)/(p + 1), and x/x' is (T - t)/p
      finding = finding_type(escape, b, stepper%predictor%t + 1.0_wp/(ddq/dq - dq/q), k)
    end associate
  end subroutine find_escape

  !> Whether a dependent coordinate of a block slides and is far.
  pure logical function slides_far(plan, stepper, b)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    integer :: i, k

    slides_far = .false.
    do i = 1, size(plan%blocks(b)%unknowns)
      k = plan%blocks(b)%coordinates(i)
      if (abs(stepper%predictor%q(k)) < far*plan%unit_of(k)) cycle
      associate (step => plan%steps(plan%blocks(b)%unknowns(i)))
        slides_far = step%is_screw .and. .not. abs(step%turn) > 0.0_wp
      end associate
      if (slides_far) return
    end do
  end function slides_far

  !> Whether the fastest coordinate of a block slides, is far, and moves as a power of 1/(T - t).
  pure logical function follows_power_law(plan, stepper, b) result(follows)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    real(wp) :: quotient
    integer :: i, k

    follows = .false.
    k = fastest_of(plan, stepper, b)
    do i = 1, size(plan%blocks(b)%unknowns)
      associate (step => plan%steps(plan%blocks(b)%unknowns(i)))
        if (step%coordinate == k .and. (.not. step%is_screw .or. abs(step%turn) > 0.0_wp)) return
      end associate
    end do
    associate (q => stepper%predictor%q(k), dq => stepper%predictor%dq(k), ddq => acceleration_of(stepper%predictor, k))
      if (abs(q) < far*plan%unit_of(k) .or. .not. q*dq > 0.0_wp .or. .not. dq*ddq > 0.0_wp) return
      quotient = (q/dq)*(ddq/dq)
      follows = quotient > power_law(1) .and. quotient < power_law(2)
    end associate
  end function follows_power_law

  !> Largest rate of a block's dependent coordinates, and of all that drives it if that is more than `usual`.
  pure subroutine find_speeds(plan, stepper, b, speed, usual)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    real(wp), intent(out) :: speed              !< [rad/s, lengths of the mechanism/s]
    real(wp), intent(inout) :: usual   !< raised to the largest rate of the coordinates that drive the block, in the same units
    integer :: s, k

    speed = 0.0_wp
    do s = 1, plan%blocks(b)%last_step
      k = plan%steps(s)%coordinate
      if (s >= plan%blocks(b)%first_step .and. plan%steps(s)%dependent) then
        speed = max(speed, abs(stepper%predictor%dq(k))/plan%unit_of(k))
      else
        usual = max(usual, abs(stepper%predictor%dq(k))/plan%unit_of(k))
      end if
    end do
  end subroutine find_speeds

  !> When the square-root law ends: x = x* + c sqrt(T - t) has x'/x'' = 2 (T - t).
  pure real(wp) function time_of_dead_point(plan, stepper, b) result(t)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    integer :: k

    k = fastest_of(plan, stepper, b)
    t = stepper%predictor%t
    associate (dq => stepper%predictor%dq(k), ddq => acceleration_of(stepper%predictor, k))
      if (abs(ddq) > 0.0_wp) t = t + 0.5_wp*dq/ddq
    end associate
  end function time_of_dead_point

  !> The dependent coordinate of a block that moves fastest.
  pure integer function fastest_of(plan, stepper, b) result(fastest)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    integer :: i, k

    fastest = plan%blocks(b)%coordinates(1)
    do i = 2, size(plan%blocks(b)%unknowns)
      k = plan%blocks(b)%coordinates(i)
      if (abs(stepper%predictor%dq(k))/plan%unit_of(k) > abs(stepper%predictor%dq(fastest))/plan%unit_of(fastest)) &
        fastest = k
    end do
  end function fastest_of
end module mech9_special_position
