!> The columns of contacts of links in rows of results.
module mech9_contact_columns
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_motion_view, only: link_motion_type
  use mech9_contact, only: contact_place_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_contact_motion, only: place_of_contact
  use mech9_columns, only: columns_type
  implicit none
  private
  public :: append_contacts, fill_contacts

contains

  !> Append the columns of contacts of links: gap, normal force and friction of each.
  subroutine append_contacts(columns, mechanism)
    type(columns_type), intent(inout) :: columns   !< the columns
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    integer :: i

    if (.not. mechanism%has_contacts()) return
    columns%contacts = 3*maxval(mechanism%contacts%number)
    do i = 1, columns%contacts/3
      call columns%append_in('K'//to_text(i)//'.gap', 'm', 'gap of contact '//to_text(i))
      call columns%append_in('K'//to_text(i)//'.fn', 'N', 'normal force of contact '//to_text(i))
      call columns%append_in('K'//to_text(i)//'.ft', 'N', 'friction of contact '//to_text(i))
    end do
  end subroutine append_contacts

  !> Fill the columns of contacts of links in a row.
  pure subroutine fill_contacts(columns, mechanism, plan, state, row)
    type(columns_type), intent(in) :: columns           !< the columns
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< its plan
    type(state_type), intent(in) :: state               !< motion of the mechanism, with the forces of contacts
    real(wp), intent(inout) :: row(:)                   !< numbers of one row, one for each column
    type(contact_place_type) :: place
    type(link_motion_type) :: ball, surface
    real(wp) :: normal_force
    integer :: first, at, i

    if (columns%contacts == 0) return
    first = columns%before_stops() + columns%stops + columns%frictions
    row(first + 1:first + columns%contacts) = 0.0_wp
    row(first + 1:first + columns%contacts:3) = huge(1.0_wp)
    do i = 1, size(mechanism%contacts)
      at = first + 3*(mechanism%contacts(i)%number - 1)
      call place_of_contact(mechanism%contacts(i), plan, state, place, ball, surface)
      ! sides of one profile have the gap to the nearest, and their forces together
      row(at + 1) = min(row(at + 1), place%gap)
      if (allocated(state%contact_force)) then
        associate (force => state%contact_force(:, i))
          normal_force = dot_product(force, place%normal)
          row(at + 3) = row(at + 3) + norm2(force - normal_force*place%normal)
        end associate
      else
        normal_force = mechanism%contacts(i)%normal_force(place)
      end if
      row(at + 2) = row(at + 2) + normal_force
    end do
  end subroutine fill_contacts
end module mech9_contact_columns
