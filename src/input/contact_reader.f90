!> Contacts from the groups &contact of a checked document.
module mech9_contact_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_units, only: units_type
  use mech9_mechanism, only: mechanism_type
  use mech9_request, only: time_grid_type
  use mech9_contact, only: contact_type
  use mech9_contact_load, only: contact_load_type
  use mech9_load, only: load_slot_type, append_loads
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_real, get_reals, get_text, span_of
  use mech9_diagnostics, only: diagnostics_type
  use mech9_motion_reader, only: check_link
  implicit none
  private
  public :: read_contacts

contains

  !> All contacts, in the order of the file, and a load for each.
  subroutine read_contacts(document, time, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(time_grid_type), intent(in) :: time              !< the times of the results
    type(mechanism_type), intent(inout) :: mechanism      !< with its points, loads and frictions; gets the contacts
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'contact')
    allocate (mechanism%contacts(size(numbers)))
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), contact => mechanism%contacts(i))
        call check_link(group, 'link', 1, mechanism%structure%shown_links(), diagnostics)
        call read_contact(group, mechanism%units, contact)
        contact%place = diagnostics%place(group%span)
        call take_point(group, mechanism, contact, diagnostics)
        call check_surface(group, contact, diagnostics)
        call check_numbers(group, contact, diagnostics)
        if (contact%is_rigid .and. time%end < time%start) &
          call diagnostics%add(group%span, 'a rigid contact does not allow a motion back in time; give an end after the '// &
                               'start, or make the contact compliant by stiffness=')
        if (contact%has_friction() .and. time%end < time%start) &
          call diagnostics%add(span_of(group, 'friction', 1), 'friction does not allow a motion back in time; give an end '// &
                               'after the start, or leave friction= out')
        if (mechanism%has_frictions()) &
          call diagnostics%add(group%span, 'contacts and frictions of pairs are not available together; leave out the groups '// &
                               '&contact or the groups &friction')
      end associate
    end do
    call add_loads(mechanism%contacts, mechanism%loads)
  end subroutine read_contacts

  !> The contact of one group, without its point.
  pure subroutine read_contact(group, units, contact)
    type(group_type), intent(in) :: group         !< the group of the data file
    type(units_type), intent(in) :: units         !< units of the file
    type(contact_type), intent(inout) :: contact  !< gets its numbers

    contact%links(2) = get_integer(group, 'link')
    contact%is_plane = get_text(group, 'kind') == 'plane'
    contact%origin = get_reals(group, 'origin')
    contact%normal = get_reals(group, 'normal')
    if (norm2(contact%normal) > 0.0_wp) contact%normal = contact%normal/norm2(contact%normal)
    contact%radius = get_real(group, 'radius')
    contact%other_radius = get_real(group, 'other_radius')
    contact%restitution = get_real(group, 'restitution')
    contact%sliding_friction = get_real(group, 'friction')
    contact%static_friction = contact%sliding_friction
    if (has_name(group, 'static_friction')) contact%static_friction = get_real(group, 'static_friction')
    contact%is_rigid = .not. has_name(group, 'stiffness')
    contact%exponent = get_real(group, 'exponent')
    associate (unit => units%force/units%length**contact%exponent)
      if (.not. contact%is_rigid) contact%stiffness = unit*get_real(group, 'stiffness')
      contact%damping = unit*get_real(group, 'damping')/units%length
    end associate
  end subroutine read_contact

  !> Take link and position of the point by its name.
  pure subroutine take_point(group, mechanism, contact, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(mechanism_type), intent(in) :: mechanism         !< with its points
    type(contact_type), intent(inout) :: contact          !< gets the link and the centre of its ball
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: name
    integer :: i

    name = get_text(group, 'point')
    do i = 1, size(mechanism%points)
      if (mechanism%points(i)%name /= name) cycle
      contact%links(1) = mechanism%points(i)%link
      contact%center = mechanism%points(i)%position
      if (contact%links(1) == contact%links(2)) &
        call diagnostics%add(span_of(group, 'link', 1), 'point '//name//' and the surface are on the same link '// &
                             to_text(contact%links(2))//', which does not touch itself; give another link')
      return
    end do
    call diagnostics%add(span_of(group, 'point', 1), 'there is no point '//name//'; give a group &point with this name')
  end subroutine take_point

  !> Report a surface that has no direction or no size, and items that belong to the other kind.
  pure subroutine check_surface(group, contact, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(contact_type), intent(in) :: contact             !< the contact
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (.not. norm2(contact%normal) > 0.0_wp) &
      call diagnostics%add(span_of(group, 'normal', 1), 'the normal of the plane has no length; give a direction')
    if (contact%is_plane .and. has_name(group, 'other_radius')) &
      call diagnostics%add(span_of(group, 'other_radius', 1), 'other_radius= belongs to kind=''sphere''; give that kind, or '// &
                           'leave other_radius= out')
    if (contact%is_plane) return
    if (has_name(group, 'normal')) &
      call diagnostics%add(span_of(group, 'normal', 1), 'normal= belongs to kind=''plane''; leave it out')
    if (.not. contact%radius + contact%other_radius > 0.0_wp) &
      call diagnostics%add(group%span, 'neither the ball nor the sphere has a radius; give radius=, other_radius= or both')
  end subroutine check_surface

  !> Report numbers that contradict each other.
  pure subroutine check_numbers(group, contact, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(contact_type), intent(in) :: contact             !< the contact
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (contact%static_friction < contact%sliding_friction) &
      call diagnostics%add(span_of(group, 'static_friction', 1), 'static_friction= is less than friction=; friction at rest '// &
                           'holds at least as much as in motion')
    if (contact%static_friction > 0.0_wp .and. .not. has_name(group, 'friction')) &
      call diagnostics%add(span_of(group, 'static_friction', 1), 'static_friction= needs the coefficient in motion, too; give '// &
                           'friction=')
    if (contact%restitution > 1.0_wp) &
      call diagnostics%add(span_of(group, 'restitution', 1), 'a restitution above 1 would add energy; give 0 to 1')
    if (has_name(group, 'restitution') .and. .not. contact%is_rigid) &
      call diagnostics%add(span_of(group, 'restitution', 1), 'a contact with stiffness= is compliant and has no restitution; '// &
                           'give damping= for its losses, or leave stiffness= out')
    if (contact%is_rigid .and. has_name(group, 'damping')) &
      call diagnostics%add(span_of(group, 'damping', 1), 'damping= belongs to a compliant contact; give stiffness= too, or '// &
                           'leave damping= out')
    if (contact%is_rigid .and. has_name(group, 'exponent')) &
      call diagnostics%add(span_of(group, 'exponent', 1), 'exponent= belongs to a compliant contact; give stiffness= too, or '// &
                           'leave exponent= out')
  end subroutine check_numbers

  !> Append a load for each contact.
  subroutine add_loads(contacts, loads)
    type(contact_type), intent(in) :: contacts(:)                  !< all contacts
    type(load_slot_type), allocatable, intent(inout) :: loads(:)   !< the loads of the data file; gets those of contacts
    type(load_slot_type) :: more(size(contacts))
    integer :: i

    do i = 1, size(contacts)
      allocate (more(i)%load, source=contact_load_type(contact=contacts(i), number=i, place=contacts(i)%place))
    end do
    call append_loads(more, loads)
  end subroutine add_loads
end module mech9_contact_reader
