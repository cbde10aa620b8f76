!> Sentences about the events of a motion that is not smooth.
module mech9_event_words
  use mech9_text, only: string_type, to_text
  use mech9_part_names, only: name_in
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: impulse_unit_of
  use mech9_motion_event, only: motion_event_type, motion_events_type, event_impact, event_close, event_stick, &
    event_slip, event_lift
  implicit none
  private
  public :: told_events_type, tell_events, write_event_sentence

  !> The events of a motion with impulses in the units of the data file, and the sentences about them.
  type, extends(motion_events_type) :: told_events_type
    type(string_type), allocatable :: sentences(:)   !< (count)
  end type told_events_type

contains

  !> Tell the events of a motion, with the names of coordinates.
  pure subroutine tell_events(events, mechanism, told)
    type(motion_events_type), intent(in) :: events      !< with impulses in N s or N m s
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(told_events_type), intent(out) :: told         !< the same events
    integer :: i

    told%motion_events_type = events
    allocate (told%sentences(events%count))
    do i = 1, events%count
      associate (event => told%items(i))
        event%impulse = event%impulse/impulse_unit_of(mechanism, trim(event%group), event%number)
        call write_event_sentence(event, mechanism, told%sentences(i)%text)
      end associate
    end do
  end subroutine tell_events

  !> Write the sentence about an event, such as "stop 1 (hip) is hit, impulse -1.579".
  pure subroutine write_event_sentence(event, mechanism, text)
    type(motion_event_type), intent(in) :: event                !< the event, with its impulse in the unit that the sentence shows
    type(mechanism_type), intent(in) :: mechanism               !< the names of coordinates
    character(len=:), allocatable, intent(out) :: text          !< the sentence

    text = trim(event%group)//' '//to_text(event%number)
    call add_name(event, mechanism, text)
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
  end subroutine write_event_sentence

  !> Add the name of the coordinate of a stop or a friction, in brackets behind a blank, where it has one.
  pure subroutine add_name(event, mechanism, text)
    type(motion_event_type), intent(in) :: event                !< the event
    type(mechanism_type), intent(in) :: mechanism               !< the mechanism
    character(len=:), allocatable, intent(inout) :: text        !< a sentence that begins with the stop or the friction
    integer :: coordinate

    coordinate = 0
    if (event%group == 'stop') coordinate = mechanism%stops(event%number)%coordinate
    if (event%group == 'friction') coordinate = mechanism%frictions(event%number)%coordinate
    if (name_in(mechanism%names%coordinates, coordinate) /= '') &
      text = text//' ('//trim(name_in(mechanism%names%coordinates, coordinate))//')'
  end subroutine add_name
end module mech9_event_words
