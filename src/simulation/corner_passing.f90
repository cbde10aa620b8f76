!> The time within a step at which the ball of a contact that acts comes to the end of a stretch of its profile, where curvatures jump.
!>
!> On its stretch a contact is smooth, also a little beyond the end. The event lies a little beyond it, so that the ball goes back to the
!> stretch before by another event, and not by round-off.
module mech9_corner_passing
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_integrated_motion, only: integrated_motion_type
  use mech9_stop_contacts, only: look_at_gap
  use mech9_smooth_parts, only: gap_look_type
  use mech9_event_search, only: locate, value_at, of_corner, way_beyond
  implicit none
  private
  public :: find_corner, correct_corner

  !> Points within a step at which ways past the end of a stretch are looked at; the last one is the end of the step.
  integer, parameter :: looks = 8
  !> Corrections of the time by Newton's method, and the largest one in parts of the step.
  integer, parameter :: most_corrections = 8
  real(wp), parameter :: largest_correction = 0.5_wp

contains

  !> Find the contact whose ball comes first to the end of a stretch, and the time.
  subroutine find_corner(motion, from, corner, t, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step; its system may stand elsewhere
    real(wp), intent(in) :: from                            !< start of the step [s]
    integer, intent(out) :: corner                          !< number of the end of this contact; 0: none comes there
    real(wp), intent(out) :: t                              !< the time [s]
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: found_at
    integer :: i
    logical :: passed

    corner = 0
    t = motion%t
    do i = 1, size(motion%contacts%ends)
      if (motion%contacts%ends(i)%stretch == 0) cycle
      call find_passing(motion, i, from, found_at, passed, err)
      if (allocated(err)) return
      if (.not. passed) cycle
      if (corner > 0 .and. abs(found_at - from) >= abs(t - from)) cycle
      corner = i
      t = found_at
    end do
  end subroutine find_corner

  !> Find the first time in a step at which the ball of a contact is past the end of its stretch.
  subroutine find_passing(motion, i, from, t, passed, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step
    integer, intent(in) :: i                                !< number of the end of this contact
    real(wp), intent(in) :: from                            !< start of the step [s]
    real(wp), intent(out) :: t                              !< the time [s]
    logical, intent(out) :: passed                          !< it lies within the step
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: before, value
    integer :: look

    before = from
    passed = .false.
    do look = 1, looks
      t = from + real(look, wp)/looks*(motion%t - from)
      if (look == looks) t = motion%t
      call value_at(motion, of_corner, i, t, value, err)
      passed = value > 0.0_wp
      if (passed .or. allocated(err)) exit
      before = t
    end do
    if (passed .and. .not. allocated(err)) call locate(motion, of_corner, i, before, t, passed, err)
  end subroutine find_passing

  !> Correct the time of a step that was made onto the end of a stretch, by Newton's method. Where the ball does not come there, because
  !> dense output was wrong, there is no event.
  subroutine correct_corner(motion, from, corner, err)
    type(integrated_motion_type), intent(inout) :: motion   !< the motion at the end of a step, where the system stands
    real(wp), intent(in) :: from                            !< start of the step [s]
    integer, intent(in) :: corner                           !< number of the end of this contact
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(gap_look_type) :: now
    real(wp) :: value, margin, rate, change

    associate (system => motion%system, end => motion%contacts%ends(corner), corrections => motion%contacts%corrections)
      now = look_at_gap(system%model%mechanism, system%plan, system%state, end)
      call way_beyond(motion, corner, value, margin)
      if (abs(value) <= 0.5_wp*margin) return
      rate = now%place%past_rate*sign(1.0_wp, motion%t - from)
      change = huge(change)
      if (rate > 0.0_wp) change = -value/rate
      if (corrections < most_corrections .and. abs(change) < largest_correction*abs(motion%t - from)) then
        change = sign(change, (motion%t - from)*change)
        if (abs(change) <= spacing(motion%t)) return
        corrections = corrections + 1
        change = motion%t + change
        call motion%step_back(change, err)
        call system%interval%end_at_event(change, 0, 0, 0, 0, corner)
      else if (value < 0.0_wp) then
        call system%interval%forget_event()
        call motion%note_start(err)
      end if
    end associate
  end subroutine correct_corner
end module mech9_corner_passing
