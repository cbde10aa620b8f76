!> Initial coordinates and recorded points: the groups &initial and &point of a checked document.
module mech9_motion_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_partition, only: partition_type
  use mech9_pair, only: pair_slot_type
  use mech9_point, only: point_type
  use mech9_problem, only: initial_type
  use mech9_document, only: document_type, group_type
  use mech9_units, only: units_type, coordinate_units_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_real, get_reals, get_text, span_of
  use mech9_drive_reader, only: units_of_coordinate
  use mech9_name_check, only: check_name
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_initial, read_points, read_point, check_link

contains

  !> All groups &initial: positions and velocities that are given, in rad and m.
  pure subroutine read_initial(document, partition, pairs, units, initial, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(partition_type), intent(in) :: partition         !< the kinds of the coordinates; none where the structure is unknown
    type(pair_slot_type), intent(in) :: pairs(:)          !< (M) pairs by coordinate; a slot is empty where its group has an error
    type(units_type), intent(in) :: units                 !< units of the file
    type(initial_type), intent(out) :: initial            !< positions and velocities at the start; zero where not given
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    type(coordinate_units_type) :: unit
    integer :: i, k, m

    m = size(partition%kind)
    allocate (initial%position(m), initial%velocity(m), source=0.0_wp)
    allocate (initial%position_given(m), initial%velocity_given(m), source=.false.)
    if (m == 0) return
    numbers = groups_named(document, 'initial')
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)))
        k = get_integer(group, 'coordinate')
        if (k > m) then
          call diagnostics%add(span_of(group, 'coordinate', 1), 'there is no coordinate '//to_text(k)// &
                               '; they are 1 to '//to_text(m))
          cycle
        end if
        if (has_name(group, 'velocity') .and. .not. partition%is_independent(k)) &
          call diagnostics%add(span_of(group, 'velocity'), 'coordinate '//to_text(k)//' is dependent: its velocity '// &
                               'follows from the others; leave it out')
        unit = units_of_coordinate(group, pairs, units)
        initial%position(k) = unit%position*get_real(group, 'position')
        initial%velocity(k) = unit%rate*get_real(group, 'velocity')
        initial%position_given(k) = has_name(group, 'position')
        initial%velocity_given(k) = has_name(group, 'velocity')
      end associate
    end do
  end subroutine read_initial

  !> All groups &point: names, links and positions of the recorded points [m, in the frame of the link].
  pure subroutine read_points(document, n_links, points, diagnostics)
    type(document_type), intent(in) :: document              !< the data file as groups and items
    integer, intent(in) :: n_links                           !< how many links there are; 0 where it is not known
    type(point_type), allocatable, intent(out) :: points(:)  !< one for each sound group, in their order
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'point')
    allocate (points(size(numbers)))
    do i = 1, size(numbers)
      call read_point(document%groups(numbers(i)), n_links, points(i), diagnostics)
    end do
  end subroutine read_points

  !> Name, link and position of one point.
  pure subroutine read_point(group, n_links, point, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: n_links                        !< how many links there are; 0 where it is not known
    type(point_type), intent(out) :: point                !< the point
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    point%name = get_text(group, 'name')
    point%link = get_integer(group, 'link')
    point%position = get_reals(group, 'position')
    point%place = diagnostics%place(group%span)
    call check_name(group, point%name, diagnostics)
    call check_link(group, 'link', 1, n_links, diagnostics)
  end subroutine read_point

  !> Report the number of a link that does not exist.
  pure subroutine check_link(group, name, position, n_links, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: name                  !< name of the item that holds the number of the link
    integer, intent(in) :: position                       !< position of the number in the list
    integer, intent(in) :: n_links                        !< how many links there are; 0 where it is not known
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp), allocatable :: numbers(:)

    if (n_links == 0) return
    numbers = get_reals(group, name)
    if (nint(numbers(position)) <= n_links) return
    call diagnostics%add(span_of(group, name, position), 'there is no link '//to_text(nint(numbers(position)))// &
                         '; they are 1 to '//to_text(n_links))
  end subroutine check_link
end module mech9_motion_reader
