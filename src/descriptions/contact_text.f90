!> Contacts of links in a check: their surfaces, and the gaps at the start.
module mech9_contact_text
  use mech9_named_words, only: with_names
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type, surface_words
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: length_text
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_contact_motion, only: place_of_contact
  implicit none
  private
  public :: print_contacts

contains

  !> Print all contacts; nothing where there are none. Of the sides of a path the nearest one counts.
  subroutine print_contacts(unit, mechanism, plan, start)
    integer, intent(in) :: unit                        !< the output unit
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(plan_type), intent(in) :: plan                !< its plan
    type(state_type), intent(in) :: start              !< assembled position
    type(contact_place_type), allocatable :: places(:)
    type(link_motion_type) :: ball, surface
    character(len=:), allocatable :: words
    integer :: i

    if (.not. mechanism%has_contacts()) return
    write (unit, '(a)') 'contacts at the start:'
    allocate (places(size(mechanism%contacts)))
    do i = 1, size(places)
      call place_of_contact(mechanism%contacts(i), plan, start, places(i), ball, surface)
    end do
    do i = 1, size(places)
      associate (contact => mechanism%contacts(i), place => places(i))
        if (minloc(places%gap, dim=1, mask=mechanism%contacts%number == contact%number) /= i) cycle
        words = 'contact '//to_text(contact%number)//': '
        if (contact%radius > 0.0_wp) then
          words = words//'a ball of the radius '//trim(length_text(mechanism, contact%radius, 6))
        else
          words = words//'a point'
        end if
        words = words//' of link '//to_text(contact%links(1))//' is '//trim(length_text(mechanism, abs(place%gap), 6))//' '// &
                trim(merge('within', 'from  ', place%gap < 0.0_wp))//' a '//trim(surface_words(contact%surface))// &
                ' of link '//to_text(contact%links(2))
        if (contact%is_rigid) then
          words = words//'; restitution '//to_text(contact%restitution, 4)
        else
          words = words//'; compliant'
        end if
        if (contact%has_friction()) words = words//'; coefficients of friction '//to_text(contact%static_friction, 4)// &
                                            ' at rest, '//to_text(contact%sliding_friction, 4)//' in motion'
        write (unit, '(2x,a)') with_names(mechanism%names, words)
      end associate
    end do
  end subroutine print_contacts
end module mech9_contact_text
