!> Times of a driven motion at which pairs with friction turn back, where their frictions jump.
!>
!> The rate of such a pair passes zero. Where it is zero at the end of a stride, the acceleration tells the direction behind; motions with
!> friction go forwards in time. Within a stride, the first turn is found by bisection on the motion itself.
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
  public :: driven_turns_type

  !> The end of the last stride, and the turns there.
  type :: driven_turns_type
    logical :: may_come = .false.                    !< frictions jump where pairs turn back
    real(wp) :: end = 0.0_wp                         !< of the last stride [s]
    logical :: is_at_end = .false.                   !< pairs turn back there
    logical :: is_left = .false.                     !< the motion is looked at behind these turns
    real(wp), allocatable :: sides(:, :)             !< (frictions,2) directions of those pairs before and behind it; 0: other pairs
    real(wp), allocatable, private :: onward(:)      !< (frictions) directions of all pairs behind the end; 0: they rest, or are smooth
  contains
    procedure :: begin
    procedure :: find_first
    procedure :: note_end
  end type driven_turns_type

contains

  !> Begin at the start of the motion.
  pure subroutine begin(self, mechanism, plan, state)
    class(driven_turns_type), intent(inout) :: self   !< the turns
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(plan_type), intent(in) :: plan               !< its plan
    type(state_type), intent(in) :: state             !< the position, with rates and accelerations

    self%may_come = .not. all(mechanism%frictions%is_smooth)
    self%end = state%t
    self%is_at_end = .false.
    self%onward = directions_behind(mechanism, plan, state)
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

      turns_back = any(self%onward*slip_directions(mechanism, plan, state) < 0.0_wp)
    end function turns_back
  end subroutine find_first

  !> Note the end of a stride, at which the motion stands, with the pairs that turn back there.
  pure subroutine note_end(self, mechanism, plan, state)
    class(driven_turns_type), intent(inout) :: self   !< the turns up to the start of the stride
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(plan_type), intent(in) :: plan               !< its plan
    type(state_type), intent(in) :: state             !< the position, with rates and accelerations
    real(wp), dimension(size(self%onward)) :: before, behind

    self%end = state%t
    ! a pair that rested from the start of the stride does not turn back
    before = self%onward
    behind = directions_behind(mechanism, plan, state)
    self%onward = behind
    if (allocated(self%sides)) deallocate (self%sides)
    allocate (self%sides(size(behind), 2), source=0.0_wp)
    where (before*behind < 0.0_wp)
      self%sides(:, 1) = before
      self%sides(:, 2) = behind
    end where
    self%is_at_end = any(abs(self%sides) > 0.0_wp)
    self%is_left = .false.
  end subroutine note_end

  !> Directions in which pairs slide just behind a time: those of their rates, or where these are zero, those to which accelerations lead.
  pure function directions_behind(mechanism, plan, state) result(directions)
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(plan_type), intent(in) :: plan               !< its plan
    type(state_type), intent(in) :: state             !< the position, with rates and accelerations
    real(wp) :: directions(size(mechanism%frictions))

    directions = slip_directions(mechanism, plan, state)
    associate (acceleration => state%ddq(mechanism%frictions%coordinate))
      where (.not. (abs(directions) > 0.0_wp .or. mechanism%frictions%is_smooth) .and. abs(acceleration) > 0.0_wp) &
        directions = sign(1.0_wp, acceleration)
    end associate
  end function directions_behind
end module mech9_driven_turns
