!> Stops from the groups &stop of a checked document.
module mech9_stop_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_units, only: coordinate_units_type
  use mech9_mechanism, only: mechanism_type
  use mech9_request, only: time_grid_type
  use mech9_stop, only: stop_type
  use mech9_stop_load, only: stop_load_type
  use mech9_load, only: load_slot_type, append_loads
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_real, span_of
  use mech9_drive_reader, only: units_of_coordinate
  use mech9_diagnostics, only: diagnostics_type
  use mech9_load_reader, only: check_coordinate
  implicit none
  private
  public :: read_stops

contains

  !> All stops, in the order of the file, and a load for each compliant one.
  subroutine read_stops(document, time, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(time_grid_type), intent(in) :: time              !< the times of the results
    type(mechanism_type), intent(inout) :: mechanism      !< with its pairs and loads; gets the stops
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'stop')
    allocate (mechanism%stops(size(numbers)))
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), stop => mechanism%stops(i))
        call check_coordinate(group, size(mechanism%pairs), diagnostics)
        call read_stop(group, units_of_coordinate(group, mechanism%pairs, mechanism%units), stop)
        stop%place = diagnostics%place(group%span)
        call check_stop(group, stop, diagnostics)
        call check_others(group, i, mechanism%stops, diagnostics)
        if (stop%is_rigid .and. time%end < time%start) &
          call diagnostics%add(group%span, 'a rigid stop does not allow a motion back in time; give an end after the '// &
                               'start, or make the stop compliant by stiffness=')
      end associate
    end do
    call add_loads(mechanism%stops, mechanism%loads)
  end subroutine read_stops

  !> The stop of one group.
  pure subroutine read_stop(group, unit, stop)
    type(group_type), intent(in) :: group             !< the group of the data file
    type(coordinate_units_type), intent(in) :: unit   !< units of the coordinate in the file
    type(stop_type), intent(inout) :: stop            !< gets its numbers

    stop%coordinate = get_integer(group, 'coordinate')
    if (has_name(group, 'low')) stop%ends(1) = unit%position*get_real(group, 'low')
    if (has_name(group, 'high')) stop%ends(2) = unit%position*get_real(group, 'high')
    stop%restitution = get_real(group, 'restitution')
    stop%is_rigid = .not. has_name(group, 'stiffness')
    stop%exponent = get_real(group, 'exponent')
    ! penetrations of angles are in rad, whatever the unit of angles
    associate (depth => unit%force/unit%slope)
      if (.not. stop%is_rigid) stop%stiffness = unit%force/depth**stop%exponent*get_real(group, 'stiffness')
      stop%damping = unit%slope/depth**stop%exponent*get_real(group, 'damping')
    end associate
  end subroutine read_stop

  !> Report a stop without ends, with ends in the wrong order, or with numbers of both kinds.
  pure subroutine check_stop(group, stop, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(stop_type), intent(in) :: stop                   !< the stop
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (.not. (stop%has_end(1) .or. stop%has_end(2))) &
      call diagnostics%add(group%span, 'the stop has no end; give low=, high= or both')
    if (.not. stop%ends(1) < stop%ends(2)) &
      call diagnostics%add(span_of(group, 'high', 1), 'the high end is not above the low one; exchange them, or move one')
    if (stop%restitution > 1.0_wp) &
      call diagnostics%add(span_of(group, 'restitution', 1), 'a restitution above 1 would add energy; give 0 to 1')
    if (has_name(group, 'restitution') .and. .not. stop%is_rigid) &
      call diagnostics%add(span_of(group, 'restitution', 1), 'a stop with stiffness= is compliant and has no restitution; '// &
                           'give damping= for its losses, or leave stiffness= out')
    if (stop%is_rigid .and. has_name(group, 'damping')) &
      call diagnostics%add(span_of(group, 'damping', 1), 'damping= belongs to a compliant stop; give stiffness= too, or leave '// &
                           'damping= out')
    if (stop%is_rigid .and. has_name(group, 'exponent')) &
      call diagnostics%add(span_of(group, 'exponent', 1), 'exponent= belongs to a compliant stop; give stiffness= too, or '// &
                           'leave exponent= out')
  end subroutine check_stop

  !> Report a stop that shares no range with an earlier rigid one of the same coordinate, and one whose rigid end an earlier one has.
  pure subroutine check_others(group, number, stops, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: number                         !< of the stop
    type(stop_type), intent(in) :: stops(:)               !< all stops, up to this one
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i, end

    if (.not. stops(number)%is_rigid) return
    do i = 1, number - 1
      if (stops(i)%coordinate /= stops(number)%coordinate .or. .not. stops(i)%is_rigid) cycle
      if (max(stops(i)%ends(1), stops(number)%ends(1)) >= min(stops(i)%ends(2), stops(number)%ends(2))) &
        call diagnostics%add(group%span, 'stops '//to_text(i)//' and '//to_text(number)//' leave coordinate '// &
                             to_text(stops(i)%coordinate)//' no common range; move an end of one of them')
      do end = 1, 2
        if (stops(i)%has_end(end) .and. stops(number)%has_end(end)) &
          call diagnostics%add(span_of(group, merge('low ', 'high', end == 1), 1), 'stop '//to_text(i)// &
                               ' bounds coordinate '//to_text(stops(i)%coordinate)//' on this side already; leave one out')
      end do
    end do
  end subroutine check_others

  !> Append a load for each compliant stop.
  subroutine add_loads(stops, loads)
    type(stop_type), intent(in) :: stops(:)                     !< all stops
    type(load_slot_type), allocatable, intent(inout) :: loads(:)   !< the loads of the data file; gets those of stops
    type(load_slot_type) :: more(count(.not. stops%is_rigid))
    integer :: i, n

    n = 0
    do i = 1, size(stops)
      if (stops(i)%is_rigid) cycle
      n = n + 1
      allocate (more(n)%load, source=stop_load_type(stop=stops(i), number=i, place=stops(i)%place))
    end do
    call append_loads(more, loads)
  end subroutine add_loads
end module mech9_stop_reader
