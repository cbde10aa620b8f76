!> Sentences about the events of a motion that is not smooth.
module mech9_event_words
  use mech9_text, only: to_text
  use mech9_motion_event, only: motion_event_type, event_impact, event_close, event_stick, event_slip, event_lift
  implicit none
  private
  public :: event_sentence

contains

  !> The sentence about an event, such as "stop 1 is hit, impulse -1.579".
  pure function event_sentence(event) result(text)
    type(motion_event_type), intent(in) :: event   !< the event
    character(len=:), allocatable :: text

    text = trim(event%group)//' '//to_text(event%number)
    select case (event%kind)
    case (event_stick)
      text = text//' sticks'
    case (event_slip)
      text = text//' slips'
    case (event_impact)
      text = text//' is hit, impulse '//to_text(event%impulse, 4)
    case (event_close)
      text = text//' closes'
    case (event_lift)
      text = text//' lifts off'
    case default
      text = text//' opens'
    end select
  end function event_sentence
end module mech9_event_words
