!> The look-ahead near a singular position of a block: does the motion end there, or does it go through?
!>
!> A copy of the branch stepper, the probe, goes on until the singular position is very near. At a dead point the rates of the
!> block grow without bound, as 1/sqrt(T - t), and the rates and accelerations of the probe give T far better than Newton's
!> method could find it. Where branches cross, the rates stay finite while the least pivot decreases linearly to zero. Where two
!> branches only come close and part again, the probe passes in regular steps. A sliding coordinate may also escape: where
!> axes become parallel it grows as a power of 1/(T - t), and there is no position at T.
module mech9_special_position
  use mech9_kinds, only: wp
  use mech9_tracking_tolerances, only: clear_pivot, crossing_growth, crossing_pivot, dead_growth, escape_law, &
    escaped_slide, escaping_speed, far_slide, last_pivot, longest_growth, probe_move, stuck_pivot
  use mech9_error, only: error_type
  use mech9_law, only: drive_slot_type
  use mech9_plan, only: plan_type, block_type
  use mech9_predictor, only: acceleration_of
  use mech9_branch_stepping, only: branch_stepper_type, step_towards
  use mech9_branch_crossing, only: copy_stepper
  implicit none
  private
  public :: finding_type, look_ahead, find_escape, has_slides
  public :: nothing_special, dead_point, branch_point, uncertain, escape

  integer, parameter :: nothing_special = 0   !< there is no singular position near
  integer, parameter :: dead_point = 1        !< the motion ends there
  integer, parameter :: branch_point = 2      !< branches cross: the motion can go through
  integer, parameter :: uncertain = 3         !< neither a dead point nor a crossing, but no step is accepted
  integer, parameter :: escape = 4            !< a sliding coordinate grows beyond all bounds

  !> The result of a look-ahead.
  type :: finding_type
    integer :: kind = nothing_special       !< one of the kinds above
    integer :: block = 0                    !< number of the block
    real(wp) :: t = 0.0_wp                  !< time of the special position; if there is none, time up to which none was found [s]
    integer :: coordinate = 0               !< number of the coordinate that escapes
  end type finding_type

  !> Largest number of steps of the probe.
  integer, parameter :: most_steps = 2000
  !> Largest number of shortenings of one step of the probe where drives end.
  integer, parameter :: most_trials = 20

contains

  !> Look ahead from a position that is near a singular one of block b.
  subroutine look_ahead(drives, plan, stepper, b, direction, finding)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the independent coordinates
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
    if (.not. speed > 0.0_wp) return            ! at rest the motion has no direction
    call copy_stepper(stepper, probe)
    probe%derivatives = 2
    probe%last_block = b
    do i = 1, most_steps
      if (.not. speed > 0.0_wp) return
      pivot_before = probe%monitors(b)%pivot
      t_before = probe%predictor%t
      step = min(probe%reach, probe_move/speed, longest_growth*probe%predictor%before)
      do trial = 1, most_trials
        t = t_before + direction*step
        call step_towards(drives, plan, probe, t, stuck, refused_by, err)
        if (.not. allocated(err)) exit
        step = step/longest_growth                      ! a drive may end before the special position, or just at it
      end do
      if (allocated(err)) return
      if (stuck .and. refused_by /= b) return   ! the look-ahead of the other block decides
      finding%t = probe%predictor%t
      call find_speeds(plan, probe, b, speed, usual)
      growth = speed/max(usual, tiny(usual))
      part = probe%monitors(b)%pivot/probe%monitors(b)%largest_pivot
      if (part > clear_pivot) return
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

  !> Whether the fastest coordinate of a block escapes, and the time at which it exceeds all bounds.
  pure subroutine find_escape(plan, stepper, b, stuck, finding)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    logical, intent(in) :: stuck   !< no step is accepted any more, however far the coordinate is
    type(finding_type), intent(inout) :: finding   !< changed where one escapes
    real(wp) :: speed, usual
    integer :: k

    ! this runs at every step for every block that has slides: the cheapest test comes first
    if (.not. slides_far(plan, stepper, b)) return
    usual = 0.0_wp
    call find_speeds(plan, stepper, b, speed, usual)
    k = fastest_of(plan, stepper, b)
    if (.not. stuck .and. (speed <= escaping_speed*usual .or. abs(stepper%predictor%q(k)) < escaped_slide*plan%unit_of(k))) return
    if (.not. follows_power_law(plan, stepper, b)) return
    associate (q => stepper%predictor%q(k), dq => stepper%predictor%dq(k), ddq => acceleration_of(stepper%predictor, k))
      ! x'/x'' is (T - t)/(p + 1), and x/x' is (T - t)/p
      finding = finding_type(escape, b, stepper%predictor%t + 1.0_wp/(ddq/dq - dq/q), k)
    end associate
  end subroutine find_escape

  !> Whether a dependent coordinate of a block slides, so that it could escape.
  pure elemental logical function has_slides(block, plan)
    type(block_type), intent(in) :: block   !< the block
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism

    associate (steps => plan%steps(block%unknowns))
      has_slides = any(steps%is_screw .and. .not. abs(steps%turn) > 0.0_wp)
    end associate
  end function has_slides

  !> Whether a dependent coordinate of a block slides and is far.
  pure logical function slides_far(plan, stepper, b)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    integer :: i, k

    slides_far = .false.
    do i = 1, size(plan%blocks(b)%unknowns)
      k = plan%blocks(b)%coordinates(i)
      if (abs(stepper%predictor%q(k)) < far_slide*plan%unit_of(k)) cycle
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
      if (abs(q) < far_slide*plan%unit_of(k) .or. .not. q*dq > 0.0_wp .or. .not. dq*ddq > 0.0_wp) return
      quotient = (q/dq)*(ddq/dq)
      follows = quotient > escape_law(1) .and. quotient < escape_law(2)
    end associate
  end function follows_power_law

  !> Largest rate of a block's dependent coordinates, and that of the coordinates that drive it.
  pure subroutine find_speeds(plan, stepper, b, speed, usual)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(branch_stepper_type), intent(in) :: stepper   !< the branch stepper
    integer, intent(in) :: b   !< number of the block
    real(wp), intent(out) :: speed              !< largest rate [rad/s, lengths of the mechanism/s]
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

  !> The time T at which the square-root law x = x* + c sqrt(T - t) ends: it has x'/x'' = 2 (T - t).
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
