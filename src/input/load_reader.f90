!> Loads from a checked document.
module mech9_load_reader
  use mech9_text, only: to_text
  use mech9_units, only: coordinate_units_type
  use mech9_mechanism, only: mechanism_type
  use mech9_load, only: load_slot_type
  use mech9_force_load, only: force_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_procedure_load, only: procedure_load_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_integers, get_real, get_reals, get_text, span_of
  use mech9_drive_reader, only: read_law, read_law_over, is_over, units_of_coordinate
  use mech9_motion_reader, only: check_link
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_loads, read_load, check_coordinate

contains

  !> All loads, in the order of the file. A link or coordinate that does not exist is reported.
  subroutine read_loads(document, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(mechanism_type), intent(inout) :: mechanism      !< with its structure and its pairs; gets a load for each sound group
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(load_slot_type), allocatable :: loads(:)
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'load')
    allocate (loads(size(numbers)))
    do i = 1, size(numbers)
      call read_load(document, numbers(i), mechanism, loads(i), diagnostics)
    end do
    call move_alloc(loads, mechanism%loads)
  end subroutine read_loads

  !> The load of one group.
  subroutine read_load(document, number, mechanism, slot, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: number                         !< of the group in the document
    type(mechanism_type), intent(in) :: mechanism         !< its structure and pairs; none where they are not known
    type(load_slot_type), intent(out) :: slot             !< gets the load
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    associate (group => document%groups(number), pairs => mechanism%pairs, n_links => mechanism%structure%shown_links())
      select case (get_text(group, 'kind'))
      case ('force', 'torque')
        call check_link(group, 'link', 1, n_links, diagnostics)
        allocate (slot%load, source=force_load(group))
      case ('spring')
        call check_spring(group, n_links, diagnostics)
        allocate (slot%load, source=spring_load(group))
      case ('coordinate')
        call check_coordinate(group, size(pairs), diagnostics)
        allocate (slot%load, source=coordinate_load(group, units_of_coordinate(group, pairs, mechanism%units)))
      case ('user')
        allocate (slot%load, source=procedure_load_type(parameters=mechanism%parameters, n_links=n_links, &
                                                       registered=mechanism%procedures%force))
      end select
      slot%load%place = diagnostics%place(group%span)
      if (get_text(group, 'kind') == 'user' .or. .not. has_name(group, 'law')) return
      if (is_over(group)) then
        call read_law_over(document, group, mechanism, coordinate_units_type(), slot%load%over, diagnostics, advances=.false.)
        if (.not. allocated(slot%load%over)) return
        slot%load%over%law%load = count(groups_named(document, 'load') <= number)
        slot%load%over%law%place = slot%load%place
      else
        call read_law(document, group, get_text(group, 'law'), coordinate_units_type(), slot%load%law, diagnostics)
        if (allocated(slot%load%law)) slot%load%law%place = slot%load%place
      end if
    end associate
  end subroutine read_load

  !> A force or torque on a link.
  function force_load(group) result(load)
    type(group_type), intent(in) :: group  !< the group of the data file
    type(force_load_type) :: load

    load%link = get_integer(group, 'link')
    load%turns_with_link = get_text(group, 'frame') == 'link'
    if (get_text(group, 'kind') == 'force') then
      load%position = get_reals(group, 'position')
      load%force = get_reals(group, 'force')
    else
      load%torque = get_reals(group, 'torque')
    end if
  end function force_load

  !> A spring and damper between two points.
  function spring_load(group) result(load)
    type(group_type), intent(in) :: group  !< the group of the data file
    type(spring_load_type) :: load

    load%links = get_integers(group, 'links')
    load%positions(:, 1) = get_reals(group, 'position')
    load%positions(:, 2) = get_reals(group, 'second_position')
    load%stiffness = get_real(group, 'stiffness')
    load%free_length = get_real(group, 'free_length')
    load%damping = get_real(group, 'damping')
  end function spring_load

  !> A load on a coordinate. Only the position of rest is an angle in the unit of the file; stiffness and damping are per rad.
  function coordinate_load(group, unit) result(load)
    type(group_type), intent(in) :: group               !< the group of the data file
    type(coordinate_units_type), intent(in) :: unit     !< units of the coordinate in the file
    type(coordinate_load_type) :: load

    load%coordinate = get_integer(group, 'coordinate')
    load%stiffness = unit%slope*get_real(group, 'stiffness')
    load%damping = unit%slope*get_real(group, 'damping')
    load%force = unit%force*get_real(group, 'force')
    load%rest = unit%position*get_real(group, 'rest')
  end function coordinate_load

  !> Report a load, or a motor, on a coordinate that does not exist.
  pure subroutine check_coordinate(group, n_coordinates, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: n_coordinates                  !< how many coordinates there are; 0: unknown
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (n_coordinates > 0 .and. get_integer(group, 'coordinate') > n_coordinates) &
      call diagnostics%add(span_of(group, 'coordinate', 1), 'there is no coordinate '// &
                           to_text(get_integer(group, 'coordinate'))//'; they are 1 to '//to_text(n_coordinates))
  end subroutine check_coordinate

  !> Report a spring whose links do not exist or are the same.
  pure subroutine check_spring(group, n_links, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: n_links                        !< how many links there are; 0: unknown
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: links(2)

    links = get_integers(group, 'links')
    call check_link(group, 'links', 1, n_links, diagnostics)
    call check_link(group, 'links', 2, n_links, diagnostics)
    if (links(1) == links(2)) &
      call diagnostics%add(span_of(group, 'links', 2), 'a spring joins two different links, not link '// &
                           to_text(links(1))//' to itself')
  end subroutine check_spring
end module mech9_load_reader
