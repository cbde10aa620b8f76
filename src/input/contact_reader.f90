!> Contacts from the groups &contact of a checked document.
module mech9_contact_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_units, only: units_type
  use mech9_pose, only: pose_type, default_zero
  use mech9_quintic_spline, only: fewest_points
  use mech9_space_curve, only: space_curve_type, curve_place_type, build_curve
  use mech9_profile, only: profile_type
  use mech9_mechanism, only: mechanism_type
  use mech9_request, only: time_grid_type
  use mech9_contact, only: contact_type, plane_surface, ball_surface, profile_surface, surface_words
  use mech9_contact_load, only: contact_load_type
  use mech9_load, only: load_slot_type, append_loads
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_integers, get_real, get_reals, get_text, get_logical, span_of
  use mech9_diagnostics, only: diagnostics_type
  use mech9_source, only: span_type
  use mech9_table_file, only: read_curve_file, beside
  use mech9_axis_reader, only: make_frame, real_or
  use mech9_explanation, only: explain
  use mech9_motion_reader, only: check_link
  implicit none
  private
  public :: read_contacts

  !> The ends of a curve meet where their distance is this part of its size.
  real(wp), parameter :: ends_meet = 1.0e-9_wp

contains

  !> All contacts, in the order of the file, and a load for each.
  subroutine read_contacts(document, time, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(time_grid_type), intent(in) :: time              !< the times of the results
    type(mechanism_type), intent(inout) :: mechanism      !< with its points, loads and frictions; gets the contacts
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(contact_type) :: contact
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'contact')
    allocate (mechanism%contacts(0))
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)))
        call check_link(group, 'link', 1, mechanism%structure%shown_links(), diagnostics)
        call read_contact(group, mechanism%units, contact)
        contact%number = i
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
        if (contact%surface == profile_surface) then
          call append_sides(group, mechanism%units, contact, mechanism%contacts, diagnostics)
        else
          mechanism%contacts = [mechanism%contacts, contact]
        end if
      end associate
    end do
    mechanism%contacts%slot = [(i, i=1, size(mechanism%contacts))]
    call add_loads(mechanism%contacts, mechanism%loads)
  end subroutine read_contacts

  !> The contact of one group, without its point.
  pure subroutine read_contact(group, units, contact)
    type(group_type), intent(in) :: group         !< the group of the data file
    type(units_type), intent(in) :: units         !< units of the file
    type(contact_type), intent(out) :: contact    !< gets its numbers

    contact%links(2) = get_integer(group, 'link')
    contact%surface = findloc(surface_words == get_text(group, 'kind'), .true., dim=1)
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

    character(len=12), parameter :: of_kinds(9) = [character(len=12) :: 'normal', 'other_radius', 'file', 'columns', 'scale', &
                                                   'axis', 'zero', 'closed', 'side']
    integer, parameter :: kinds(9) = [plane_surface, ball_surface, spread(profile_surface, 1, 7)]
    integer :: i

    if (.not. norm2(contact%normal) > 0.0_wp) &
      call diagnostics%add(span_of(group, 'normal', 1), 'the normal of the plane has no length; give a direction')
    do i = 1, size(of_kinds)
      if (contact%surface == kinds(i) .or. .not. has_name(group, trim(of_kinds(i)))) cycle
      call diagnostics%add(span_of(group, trim(of_kinds(i)), 1), trim(of_kinds(i))//'= belongs to kind='''// &
                           trim(surface_words(kinds(i)))//'''; give that kind, or leave '//trim(of_kinds(i))//'= out')
    end do
    if (contact%surface /= ball_surface) return
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

  !> Append the contacts of a ball with the sides of a path: one for each part between corners that stand in, where a ball touches both
  !> sides at once.
  subroutine append_sides(group, units, contact, contacts, diagnostics)
    type(group_type), intent(in) :: group                         !< the group of the data file
    type(units_type), intent(in) :: units                         !< units of the file
    type(contact_type), intent(in) :: contact                     !< the contact without its profile
    type(contact_type), allocatable, intent(inout) :: contacts(:) !< gets the contacts
    type(diagnostics_type), intent(inout) :: diagnostics          !< gets the errors
    type(contact_type) :: one
    type(pose_type) :: frame
    type(profile_type) :: whole
    type(profile_type), allocatable :: sides(:)
    real(wp) :: axis(3)
    integer :: found, i

    found = diagnostics%count
    axis = get_reals(group, 'axis')
    if (.not. has_name(group, 'file')) then
      call diagnostics%add(group%span, 'a path needs the file of its points; give file=')
      return
    end if
    call make_frame(group, '', contact%origin, axis, real_or(group, 'zero', default_zero(axis)), frame, diagnostics)
    call read_profile(group, units, contact%radius, whole, diagnostics)
    if (diagnostics%count > found) return
    call part_at_corners(whole, sides)
    call whole%prepare()
    do i = 1, size(sides)
      one = contact
      one%axes = frame%r
      call sides(i)%prepare()
      one%profile = sides(i)
      if (size(sides) > 1) one%whole = whole
      contacts = [contacts, one]
    end do
  end subroutine append_sides

  !> Read the curve of a path as smooth pieces.
  subroutine read_profile(group, units, radius, profile, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(units_type), intent(in) :: units                 !< units of the file
    real(wp), intent(in) :: radius                        !< of the ball [m]
    type(profile_type), intent(out) :: profile            !< the whole curve
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(span_type), allocatable :: spans(:)
    real(wp), allocatable :: points(:, :)
    logical, allocatable :: corners(:)
    integer, allocatable :: ends(:)
    type(error_type), allocatable :: err
    integer :: i, n
    logical :: ok

    call read_curve_file(beside(diagnostics%sources(1)%name, get_text(group, 'file')), span_of(group, 'file', 1), &
                         get_integers(group, 'columns'), 2, points, spans, corners, ok, diagnostics)
    if (.not. ok) return
    points = units%length*get_real(group, 'scale')*points
    n = size(spans)
    call check_points(group, units, points, spans, profile%closed, ok, diagnostics)
    if (ok) call find_side(group, points, profile, ok, diagnostics)
    if (.not. ok) return
    if (profile%closed) points(:, n) = points(:, 1)
    ! the first point of an open curve is its end in any case
    corners(1) = corners(1) .and. profile%closed
    ends = [1, pack([(i, i=2, n)], corners(2:n)), n]
    allocate (profile%pieces(size(ends) - 1))
    do i = 1, size(profile%pieces)
      associate (piece => profile%pieces(i), first => ends(i), last => ends(i + 1))
        if (last - first == 2) then
          call diagnostics%add(spans(first + 1), 'the side between two corners has 3 points here; give 2 for a straight side, '// &
                               'or 4 and more for a smooth curve')
          return
        end if
        call build_curve(points_of_piece(points(:, first:last)), profile%closed .and. .not. any(corners), piece, err)
        if (allocated(err)) then
          call explain(err)
          call diagnostics%add(spans(first), err%message, err%code)
          return
        end if
        call check_curvature(piece, profile%side, radius, spans(first:last), diagnostics)
      end associate
    end do
    if (.not. radius > 0.0_wp .and. any(corners)) &
      call diagnostics%add(group%span, 'a path with corners needs a ball, whose centre moves smoothly about them; give '// &
                           'radius=, however small')
  end subroutine read_profile

  !> The points of one piece; on a straight side of two points there are as many as a smooth curve needs.
  pure function points_of_piece(given) result(points)
    real(wp), intent(in) :: given(:, :)   !< (3,n) [m]
    real(wp), allocatable :: points(:, :)
    integer :: i

    if (size(given, 2) > 2) then
      points = given
    else
      allocate (points(3, fewest_points))
      do i = 1, fewest_points
        points(:, i) = given(:, 1) + (i - 1)*((given(:, 2) - given(:, 1))/(fewest_points - 1))
      end do
      points(:, fewest_points) = given(:, 2)
    end if
  end function points_of_piece

  !> Report points that repeat their neighbour, lie beside the plane, or do not meet though they should.
  subroutine check_points(group, units, points, spans, closed, ok, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(units_type), intent(in) :: units                 !< units of the file
    real(wp), intent(in) :: points(:, :)                  !< (3,n) the points [m]
    type(span_type), intent(in) :: spans(:)               !< (n) their places in the file
    logical, intent(out) :: closed                        !< the curve has no ends
    logical, intent(out) :: ok                            !< no error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp) :: extent, distance
    integer :: i, n, found

    found = diagnostics%count
    n = size(spans)
    extent = norm2(maxval(points, dim=2) - minval(points, dim=2))
    do i = 1, n
      if (abs(points(3, i)) > 0.0_wp) &
        call diagnostics%add(spans(i), 'the path of a contact lies in a plane; give x and y in each line')
      if (diagnostics%count > found) exit
      if (i == 1) cycle
      if (norm2(points(:, i) - points(:, i - 1)) <= ends_meet*extent) &
        call diagnostics%add(spans(i), 'this point repeats the one before it; a curve needs different points, leave one of '// &
                             'them out')
    end do
    distance = norm2(points(:, n) - points(:, 1))
    closed = n > 2 .and. distance <= ends_meet*extent
    if (has_name(group, 'closed')) then
      if (get_logical(group, 'closed') .and. .not. closed) &
        call diagnostics%add(span_of(group, 'closed', 1), 'the ends of the curve are '//to_text(distance/units%length, 4)//' '// &
                             trim(units%length_name)//' apart; repeat the first point at the end of its file, or leave '// &
                             '''closed'' out')
      closed = get_logical(group, 'closed')
    end if
    ok = diagnostics%count == found
  end subroutine check_points

  !> Find the free side of a curve.
  subroutine find_side(group, points, profile, ok, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: points(:, :)                  !< (3,n) the points of the curve [m]
    type(profile_type), intent(inout) :: profile          !< known to be closed or not; gets its side
    logical, intent(out) :: ok                            !< no error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp) :: area
    character(len=:), allocatable :: side
    integer :: n

    side = 'outside'
    if (has_name(group, 'side')) side = get_text(group, 'side')
    n = size(points, 2)
    area = sum(points(1, :n - 1)*points(2, 2:) - points(1, 2:)*points(2, :n - 1))
    ok = .true.
    select case (side)
    case ('left')
      profile%side = 1.0_wp
    case ('right')
      profile%side = -1.0_wp
    case default
      ! the inside of a curve that goes round counterclockwise is to its left
      profile%side = sign(1.0_wp, area)
      if (side == 'outside') profile%side = -profile%side
      ok = profile%closed
      if (.not. ok) call diagnostics%add(span_of(group, trim(merge('side', 'file', has_name(group, 'side'))), 1), &
                                         'a path with ends has no outside; give side=''left'' or side=''right''')
    end select
  end subroutine find_side

  !> Report a curve that bends towards the ball more than the ball, which would touch it in two points.
  subroutine check_curvature(piece, side, radius, spans, diagnostics)
    type(space_curve_type), intent(in) :: piece           !< a smooth piece of the profile
    real(wp), intent(in) :: side                          !< 1 where the ball is to its left, -1 to the right
    real(wp), intent(in) :: radius                        !< of the ball [m]
    type(span_type), intent(in) :: spans(:)               !< places of the points of the piece in the file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the error
    integer, parameter :: places = 8   !< of each part at which the curvature is judged
    type(curve_place_type) :: at
    integer :: part, i

    do part = 1, size(piece%piece)
      do i = 0, places
        call piece%locate(piece%s(part - 1) + i*(piece%s(part) - piece%s(part - 1))/places, at)
        if (side*(at%tangent(1)*at%curvature(2) - at%tangent(2)*at%curvature(1))*radius < 1.0_wp) cycle
        call diagnostics%add(spans(min(piece%piece(part), size(spans))), 'near this point the path bends more than the ball, '// &
                             'which would touch it twice; make it a corner by an empty line, or give a smaller radius')
        return
      end do
    end do
  end subroutine check_curvature

  !> Part a profile at the corners that stand in.
  subroutine part_at_corners(whole, sides)
    type(profile_type), intent(in) :: whole                   !< all pieces
    type(profile_type), allocatable, intent(out) :: sides(:)  !< the parts between such corners
    logical :: parted(size(whole%pieces))
    integer, allocatable :: last(:)
    integer :: i, k, n, before

    n = size(whole%pieces)
    ! whether the corner at the end of each piece stands in
    do i = 1, n
      parted(i) = .false.
      if (i < n .or. whole%closed) parted(i) = .not. whole%stands_out(i, mod(i, n) + 1)
    end do
    if (n == 1 .and. whole%pieces(1)%closed) parted = .false.
    if (.not. whole%closed) parted(n) = .true.
    last = pack([(i, i=1, n)], parted)
    if (size(last) == 0) then
      sides = [whole]
      return
    end if
    allocate (sides(size(last)))
    do i = 1, size(last)
      before = last(size(last)) - n
      if (i > 1) before = last(i - 1)
      sides(i)%side = whole%side
      sides(i)%ends_freely = .not. whole%closed .and. [i == 1, i == size(last)]
      sides(i)%pieces = whole%pieces([(modulo(k - 1, n) + 1, k=before + 1, last(i))])
    end do
  end subroutine part_at_corners

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
