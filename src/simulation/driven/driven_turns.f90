!> Times of a driven motion at which pairs with friction turn back, begin to move, or come to rest: their frictions jump there.
!>
!> The rate of such a pair is zero at these times, so that it tells no direction. Positions a little before and behind do. Within a stride,
!> the first turn is found by bisection on the motion itself.
module mech9_driven_turns
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_law, only: drive_slot_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_driven_motion, only: driven_motion_type, advance
  use mech9_driven_angles, only: copy_driven_motion
  use mech9_driven_frictions, only: slip_directions
  implicit none
  private
  public :: driven_turns_type, directions_beside, directions_at_rest

  !> The end of the last stride, and the turns there.
  type :: driven_turns_type
    logical :: may_come = .false.                    !< frictions jump where pairs turn back
    real(wp) :: end = 0.0_wp                         !< of the last stride [s]
    logical :: is_at_end = .false.                   !< directions change there
    logical :: is_left = .false.                     !< the motion is looked at behind this change
    real(wp), allocatable, private :: sides(:, :)    !< (frictions,2) directions of all pairs before and behind the end; 0: they rest, or
                                                     !< are smooth
  contains
    procedure :: begin
    procedure :: find_first
    procedure :: note_end
    procedure :: directions_on
  end type driven_turns_type

contains

  !> Begin at the start of the motion.
  pure subroutine begin(self, mechanism, t, behind)
    class(driven_turns_type), intent(inout) :: self   !< the turns
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    real(wp), intent(in) :: t                         !< time of the start [s]
    real(wp), intent(in) :: behind(:)                 !< (frictions) directions of all pairs behind it [1]; 0: they rest, or are smooth

    self%may_come = .not. all(mechanism%frictions%is_smooth)
    if (allocated(self%sides)) deallocate (self%sides)
    allocate (self%sides(size(behind), 2))
    self%sides(:, 2) = behind
    call self%note_end(t, behind)
  end subroutine begin

  !> Find the first turn between the end of the last stride and the present position, if there is one.
  subroutine find_first(self, mechanism, plan, drives, driven, time)
    class(driven_turns_type), intent(in) :: self       !< the turns up to the start of the stride
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(plan_type), intent(in) :: plan                !< its plan
    type(drive_slot_type), intent(in) :: drives(:)     !< the drives
    type(driven_motion_type), intent(in) :: driven     !< the motion, at the end of the stride
    real(wp), intent(out) :: time                      !< of the turn, or that of the present position [s]
    type(driven_motion_type) :: other
    type(error_type), allocatable :: failure
    real(wp) :: before, middle

    time = driven%state%t
    if (.not. turns_back(driven%state)) return
    before = self%end
    call copy_driven_motion(driven, other)
    do while (abs(time - before) > 2.0_wp*spacing(max(abs(time), abs(before))))
      middle = 0.5_wp*(time + before)
      call advance(drives, plan, other, middle, failure)
      ! the way to the turn is then divided no further
      if (allocated(failure)) return
      if (turns_back(other%state)) then
        time = middle
      else
        before = middle
      end if
    end do
  contains
    !> Whether any pair moves against its direction behind the start of the stride.
    pure logical function turns_back(state)
      type(state_type), intent(in) :: state   !< a state

      turns_back = any(self%sides(:, 2)*slip_directions(mechanism, plan, state) < 0.0_wp)
    end function turns_back
  end subroutine find_first

  !> Note the end of a stride, at which the motion stands.
  pure subroutine note_end(self, t, behind)
    class(driven_turns_type), intent(inout) :: self   !< the turns up to the start of the stride
    real(wp), intent(in) :: t                         !< time of its end [s]
    real(wp), intent(in), optional :: behind(:)       !< (frictions) directions of all pairs behind it [1]; 0: they rest, or are smooth. Given
                                                      !< unless the motion ends there

    self%end = t
    self%sides(:, 1) = self%sides(:, 2)
    if (present(behind)) self%sides(:, 2) = behind
    self%is_at_end = any(abs(self%sides(:, 2) - self%sides(:, 1)) > 0.0_wp)
    self%is_left = .false.
  end subroutine note_end

  !> Directions of all pairs on one side of the end of the last stride.
  pure function directions_on(self, side, slipping, at_end) result(directions)
    class(driven_turns_type), intent(in) :: self      !< the turns
    integer, intent(in) :: side                       !< 1: within the stride; 2: behind it
    real(wp), intent(in) :: slipping(:)               !< (frictions) directions of the rates [1]; 0: at rest, or smooth
    logical, intent(in) :: at_end                     !< rates there may have the sign of the other side
    real(wp) :: directions(size(slipping))

    associate (known => self%sides(:, side))
      directions = merge(known, slipping, abs(known) > 0.0_wp .and. (at_end .or. .not. abs(slipping) > 0.0_wp))
    end associate
  end function directions_on

  !> Directions of all pairs a little before or behind the present position. Pairs that rest at that time, too, have none.
  subroutine directions_beside(mechanism, plan, drives, driven, time, directions)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(plan_type), intent(in) :: plan                !< its plan
    type(drive_slot_type), intent(in) :: drives(:)     !< the drives
    type(driven_motion_type), intent(in) :: driven     !< the motion, at this position
    real(wp), intent(in) :: time                       !< the time before or behind; that of the position: there is none [s]
    real(wp), intent(out) :: directions(:)             !< (frictions) -1, 1; 0: at rest, or smooth [1]
    type(driven_motion_type) :: other
    type(error_type), allocatable :: failure

    directions = slip_directions(mechanism, plan, driven%state)
    if (.not. any_rests(mechanism, directions) .or. .not. abs(time - driven%state%t) > 0.0_wp) return
    call copy_driven_motion(driven, other)
    call advance(drives, plan, other, time, failure)
    ! a motion that ends here has no direction behind
    if (allocated(failure)) return
    directions = merge(directions, slip_directions(mechanism, plan, other%state), abs(directions) > 0.0_wp)
  end subroutine directions_beside

  !> Directions that count in a single position: of a pair at rest, that in which it begins to move; at the end of the motion, that in which
  !> it came. A pair that turns back has none.
  pure function directions_at_rest(before, behind, is_last) result(directions)
    real(wp), intent(in) :: before(:)   !< (frictions) directions of all pairs before [1]; 0: they rest, or are smooth
    real(wp), intent(in) :: behind(:)   !< (frictions) directions behind [1]
    logical, intent(in) :: is_last      !< the motion ends there
    real(wp) :: directions(size(before))

    directions = behind
    if (is_last) directions = before
    where (before*behind < 0.0_wp) directions = 0.0_wp
  end function directions_at_rest

  !> Whether any pair rests whose friction jumps.
  pure logical function any_rests(mechanism, directions)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp), intent(in) :: directions(:)           !< (frictions) directions of its pairs [1]

    any_rests = any(.not. (abs(directions) > 0.0_wp .or. mechanism%frictions%is_smooth))
  end function any_rests
end module mech9_driven_turns
