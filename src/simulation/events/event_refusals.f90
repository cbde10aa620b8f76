!> Refusals of derivatives by parameters at events that have none.
module mech9_event_refusals
  use mech9_kinds, only: wp
  use mech9_event_tolerances, only: touching
  use mech9_error, only: error_type, raise, add_place, exit_singular
  use mech9_event_failures, only: failure_event_sensitivity
  use mech9_motion_system, only: motion_system_type
  use mech9_stop_contacts, only: stop_contact_type
  implicit none
  private
  public :: refuse, refuse_at, hits_others

contains

  !> Fail because an event has no derivatives.
  subroutine refuse(system, cause, number, err)
    class(motion_system_type), intent(in) :: system        !< the system at the event
    integer, intent(in) :: cause                           !< one of the constants above
    integer, intent(in) :: number                          !< of the friction; 0: another cause
    type(error_type), allocatable, intent(out) :: err      !< the failure

    call raise(err, exit_singular, failure_event_sensitivity)
    err%failure%t = system%state%t
    err%failure%number = number
    err%failure%limit = cause
    if (number > 0) call add_place(err, place=system%model%mechanism%frictions(number)%place)
  end subroutine refuse

  !> Fail because an event at a stop or a contact has no derivatives.
  subroutine refuse_at(system, cause, end, err)
    class(motion_system_type), intent(in) :: system        !< the system at the event
    integer, intent(in) :: cause                           !< one of the constants above
    type(stop_contact_type), intent(in) :: end             !< the end of a stop, or the contact
    type(error_type), allocatable, intent(out) :: err      !< the failure

    call refuse(system, cause, 0, err)
    err%failure%number = end%number()
    err%failure%name = trim(end%group())
    if (end%is_stop()) then
      call add_place(err, place=system%model%mechanism%stops(end%stop)%place)
    else
      call add_place(err, place=system%model%mechanism%contacts(end%contact)%place)
    end if
  end subroutine refuse_at

  !> Whether a rigid contact that is open is hit beside those that have impulses, and needs none because these imply it.
  pure logical function hits_others(contacts, ends, gap_motion, length) result(hits)
    type(stop_contact_type), intent(in) :: contacts(:)         !< all ends of stops and contacts
    integer, intent(in) :: ends(:)                             !< numbers of those with impulses
    real(wp), allocatable, intent(in) :: gap_motion(:, :)      !< (0:2,contacts) gaps, their rates and accelerations before the impact [m]
    real(wp), intent(in) :: length                             !< of the mechanism [m]
    integer :: i

    hits = .false.
    do i = 1, size(contacts)
      if (contacts(i)%is_stop() .or. contacts(i)%closed .or. .not. contacts(i)%is_rigid .or. any(ends == i)) cycle
      associate (motion => gap_motion(:, contacts(i)%contact))
        hits = hits .or. (motion(1) <= 4.0_wp*touching*length .and. motion(2) < 0.0_wp)
      end associate
    end do
  end function hits_others
end module mech9_event_refusals
