!> Frictions from the groups &friction of a checked document.
module mech9_friction_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_pair, only: screw_factors_type
  use mech9_units, only: coordinate_units_type
  use mech9_mechanism, only: mechanism_type
  use mech9_request, only: time_grid_type
  use mech9_friction, only: friction_type
  use mech9_friction_load, only: friction_load_type
  use mech9_load, only: load_slot_type, append_loads
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_real, get_text, span_of
  use mech9_drive_reader, only: units_of_coordinate
  use mech9_diagnostics, only: diagnostics_type
  use mech9_load_reader, only: check_coordinate
  implicit none
  private
  public :: read_frictions

contains

  !> All frictions, in the order of the file, and a load for each.
  subroutine read_frictions(document, time, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(time_grid_type), intent(in) :: time              !< the times of the results
    type(mechanism_type), intent(inout) :: mechanism      !< with its pairs and loads; gets the frictions
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i, k
    logical :: allowed

    numbers = groups_named(document, 'friction')
    allocate (mechanism%frictions(size(numbers)))
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), friction => mechanism%frictions(i))
        call check_coordinate(group, size(mechanism%pairs), diagnostics)
        call read_friction(group, units_of_coordinate(group, mechanism%pairs, mechanism%units), friction)
        friction%place = diagnostics%place(group%span)
        k = friction%coordinate
        if (k > size(mechanism%pairs)) cycle
        if (.not. allocated(mechanism%pairs(k)%pair)) cycle
        call take_pair(group, mechanism, friction, allowed, diagnostics)
        if (.not. allowed) cycle
        if (any(mechanism%frictions(:i - 1)%coordinate == k)) &
          call diagnostics%add(span_of(group, 'coordinate', 1), 'coordinate '//to_text(k)//' has friction already; leave one '// &
                               'of both groups out')
        call check_lengths(group, friction, diagnostics)
        call check_numbers(group, friction, diagnostics)
        if (time%end < time%start .and. .not. friction%is_smooth) &
          call diagnostics%add(group%span, 'friction does not allow a motion back in time, since a pair that sticks does not '// &
                               'show how it came to rest; give an end after the start, or law=''smooth''')
      end associate
    end do
    call add_loads(mechanism%frictions, mechanism%loads)
  end subroutine read_frictions

  !> The friction of one group.
  pure subroutine read_friction(group, unit, friction)
    type(group_type), intent(in) :: group           !< the group of the data file
    type(coordinate_units_type), intent(in) :: unit   !< units of the coordinate in the file
    type(friction_type), intent(inout) :: friction  !< gets its numbers

    friction%coordinate = get_integer(group, 'coordinate')
    friction%dynamic = get_real(group, 'dynamic')
    friction%static = friction%dynamic
    if (has_name(group, 'static')) friction%static = get_real(group, 'static')
    friction%radius = get_real(group, 'radius')
    friction%face_radius = get_real(group, 'face_radius')
    if (has_name(group, 'arm')) friction%arm = get_real(group, 'arm')
    friction%preload = unit%force*get_real(group, 'preload')
    friction%is_smooth = get_text(group, 'law') == 'smooth'
    if (has_name(group, 'transition')) friction%transition = unit%rate*get_real(group, 'transition')
  end subroutine read_friction

  !> Take the kind of motion of the pair. Friction is not allowed in pairs of other kinds, and in some joints.
  subroutine take_pair(group, mechanism, friction, allowed, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs
    type(friction_type), intent(inout) :: friction        !< gets whether the pair turns, and its lead
    logical, intent(out) :: allowed                       !< the pair may have friction
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(screw_factors_type) :: factors
    character(len=:), allocatable :: kind
    integer :: joint

    associate (k => friction%coordinate)
      call mechanism%pairs(k)%pair%as_screw(factors, allowed)
      if (.not. allowed) then
        call diagnostics%add(span_of(group, 'coordinate', 1), 'friction needs a pair that turns, slides or does both about a '// &
                             'fixed axis; the pair of coordinate '//to_text(k)//' has none')
        return
      end if
      friction%turns = abs(factors%turn) > 0.0_wp
      friction%lead = factors%slide
      joint = mechanism%structure%joint_of(k)
      if (joint == 0) return
      kind = trim(mechanism%structure%joints(joint)%kind)
      allowed = kind == 'universal' .or. kind == 'cylindrical'
      if (.not. allowed) &
        call diagnostics%add(span_of(group, 'coordinate', 1), 'friction is not available in a '//kind//' joint; the pairs of '// &
                             'universal and cylindrical joints may have it, and pairs with one freedom')
    end associate
  end subroutine take_pair

  !> Report lengths that do not belong to the kind of pair, or lack.
  pure subroutine check_lengths(group, friction, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(friction_type), intent(in) :: friction           !< the friction, with its kind of pair
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (friction%turns .and. has_name(group, 'arm')) &
      call diagnostics%add(span_of(group, 'arm', 1), 'arm= belongs to a sliding pair; leave it out')
    if (.not. friction%turns .and. has_name(group, 'radius')) &
      call diagnostics%add(span_of(group, 'radius', 1), 'radius= belongs to a turning or helical pair; leave it out')
    if ((friction%is_helical() .or. .not. friction%turns) .and. has_name(group, 'face_radius')) &
      call diagnostics%add(span_of(group, 'face_radius', 1), 'face_radius= belongs to a turning pair; leave it out')
    if (friction%is_helical() .and. .not. friction%radius > 0.0_wp) &
      call diagnostics%add(group%span, 'friction in a helical pair needs the mean radius of the thread; give radius=')
    if (friction%turns .and. .not. (friction%is_helical() .or. friction%radius > 0.0_wp .or. friction%face_radius > 0.0_wp .or. &
                                    friction%preload > 0.0_wp)) &
      call diagnostics%add(group%span, 'nothing presses in this turning pair; give radius=, face_radius= or preload=')
  end subroutine check_lengths

  !> Report coefficients and a law that contradict each other.
  pure subroutine check_numbers(group, friction, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(friction_type), intent(in) :: friction           !< the friction
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (friction%static < friction%dynamic) &
      call diagnostics%add(span_of(group, 'static', 1), 'static= is less than dynamic=; friction at rest holds at least '// &
                           'as much as in motion')
    if (friction%is_smooth .and. .not. has_name(group, 'transition')) &
      call diagnostics%add(span_of(group, 'law', 1), 'the smooth law needs the rate up to which friction grows; '// &
                           'give transition=')
    if (.not. friction%is_smooth .and. has_name(group, 'transition')) &
      call diagnostics%add(span_of(group, 'transition', 1), 'transition= belongs to law=''smooth''; give that law, or leave '// &
                           'transition= out')
    if (friction%is_smooth .and. has_name(group, 'static')) &
      call diagnostics%add(span_of(group, 'static', 1), 'by the smooth law a pair never sticks; leave static= out')
  end subroutine check_numbers

  !> Append a load for each friction.
  subroutine add_loads(frictions, loads)
    type(friction_type), intent(in) :: frictions(:)                !< all frictions
    type(load_slot_type), allocatable, intent(inout) :: loads(:)   !< the loads of the data file; gets those of frictions
    type(load_slot_type) :: more(size(frictions))
    integer :: i

    do i = 1, size(frictions)
      allocate (more(i)%load, source=friction_load_type(coordinate=frictions(i)%coordinate, number=i, place=frictions(i)%place))
    end do
    call append_loads(more, loads)
  end subroutine add_loads
end module mech9_friction_reader
