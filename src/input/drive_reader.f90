!> Drives from the groups &drive of a checked document.
module mech9_drive_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text, starts_with
  use mech9_spline, only: build_spline
  use mech9_explanation, only: explain
  use mech9_partition, only: partition_type, driven_coordinate
  use mech9_pair, only: pair_slot_type
  use mech9_drive, only: drive_slot_type
  use mech9_polynomial_drive, only: polynomial_drive_type
  use mech9_harmonic_drive, only: harmonic_drive_type
  use mech9_table_drive, only: table_drive_type
  use mech9_procedure_drive, only: procedure_drive_type, make_procedure_drive
  use mech9_source, only: span_type
  use mech9_document, only: document_type, group_type, item_type
  use mech9_lookup, only: groups_named, get_integer, get_real, get_reals, get_text, span_of
  use mech9_table_file, only: read_table_file
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_drives, files_of_drives, unit_of_coordinate

contains

  !> Make the drives of all sound groups.
  subroutine read_drives(document, partition, pairs, angle_unit, start, parameters, drives, diagnostics)
    type(document_type), intent(in) :: document                   !< the data file as groups and items
    type(partition_type), intent(inout) :: partition              !< kinds of the coordinates, none where the structure is unknown;
                                                                  !< those with drives become driven ones
    type(pair_slot_type), intent(in) :: pairs(:)  !< (M) pairs by coordinate; a slot is empty where its group has an error
    real(wp), intent(in) :: angle_unit                            !< unit of angles in the file [rad]
    real(wp), intent(in) :: start                                 !< time of the first result [s]
    real(wp), intent(in) :: parameters(:)                         !< numbers of the group &user, for the user's procedures
    type(drive_slot_type), allocatable, intent(out) :: drives(:)  !< the drives of sound groups, in their order
    type(diagnostics_type), intent(inout) :: diagnostics          !< gets what is wrong
    integer, allocatable :: numbers(:)
    integer :: i, n, k

    numbers = groups_named(document, 'drive')
    allocate (drives(size(numbers)))
    n = 0
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), slot => drives(n + 1))
        call read_drive(document, group, angle_unit, unit_of_coordinate(group, pairs, angle_unit), start, parameters, &
                        slot, diagnostics)
        call check_coordinate(group, partition, diagnostics)
        if (.not. allocated(slot%drive)) cycle
        k = get_integer(group, 'coordinate')
        slot%drive%coordinate = k
        slot%drive%place = diagnostics%place(group%span)
        n = n + 1
      end associate
    end do
    do i = 1, n
      k = drives(i)%drive%coordinate
      if (k < 1 .or. k > size(partition%kind)) cycle
      if (partition%is_independent(k)) partition%kind(k) = driven_coordinate
    end do
  end subroutine read_drives

  !> The factor that turns a number of a group about a coordinate into rad or m.
  pure real(wp) function unit_of_coordinate(group, pairs, angle_unit) result(unit)
    type(group_type), intent(in) :: group         !< a group with a name `coordinate`
    type(pair_slot_type), intent(in) :: pairs(:)  !< (M) pairs by coordinate; a slot is empty where its group has an error
    real(wp), intent(in) :: angle_unit            !< unit of angles in the file [rad]
    integer :: k

    unit = 1.0_wp
    k = get_integer(group, 'coordinate')
    if (k > size(pairs)) return
    if (.not. allocated(pairs(k)%pair)) return
    if (pairs(k)%pair%angular) unit = angle_unit
  end function unit_of_coordinate

  !> Report a drive of a coordinate that does not exist.
  pure subroutine check_coordinate(group, partition, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(partition_type), intent(in) :: partition         !< kinds of the coordinates; none where the structure is unknown
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    integer :: k

    if (size(partition%kind) == 0) return
    k = get_integer(group, 'coordinate')
    if (k > size(partition%kind)) &
      call diagnostics%add(span_of(group, 'coordinate', 1), 'there is no coordinate '//to_text(k)//'; they are 1 to '// &
                           to_text(size(partition%kind)))
  end subroutine check_coordinate

  !> One drive, in rad, m and s; the slot stays empty where something was reported.
  subroutine read_drive(document, group, angle_unit, unit, start, parameters, slot, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: angle_unit                    !< unit of angles in the file [rad]
    real(wp), intent(in) :: unit                          !< unit of the coordinate in the file [rad or m]
    real(wp), intent(in) :: start                         !< time at the start [s]
    real(wp), intent(in) :: parameters(:)                 !< numbers of the group &user, for the user's procedures
    type(drive_slot_type), intent(out) :: slot            !< gets the drive; stays empty where an error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    type(polynomial_drive_type) :: polynomial
    type(procedure_drive_type) :: user_drive
    type(error_type), allocatable :: err

    select case (get_text(group, 'kind'))
    case ('polynomial')
      polynomial%coefficients = unit*get_reals(group, 'coefficients')
      allocate (slot%drive, source=polynomial)
    case ('harmonic')
      allocate (slot%drive, source=harmonic_drive_type(mean=unit*get_real(group, 'mean'), &
                                                       amplitude=unit*get_real(group, 'amplitude'), &
                                                       angular_frequency=angle_unit*get_real(group, 'angular_frequency'), &
                                                       phase=angle_unit*get_real(group, 'phase')))
    case ('table')
      call read_table_drive(document, group, unit, slot, diagnostics)
    case ('user')
      call make_procedure_drive(get_integer(group, 'coordinate'), start, parameters, user_drive, err)
      if (.not. allocated(err)) allocate (slot%drive, source=user_drive)
    end select
    if (allocated(err)) call diagnostics%add(span_of(group, 'kind', 1), err%message, err%code)
  end subroutine read_drive

  !> A drive through the points of a file.
  subroutine read_table_drive(document, group, unit, slot, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: unit                          !< unit of the coordinate in the file [rad or m]
    type(drive_slot_type), intent(inout) :: slot          !< gets the drive; stays empty where an error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets what is wrong
    type(table_drive_type) :: drive
    type(error_type), allocatable :: err
    real(wp), allocatable :: t(:), q(:)
    type(span_type) :: span
    logical :: ok

    span = span_of(group, 'file', 1)
    call read_table_file(beside(document%source%name, get_text(group, 'file')), span, t, q, ok, diagnostics)
    if (.not. ok) return
    call build_spline(t, unit*q, drive%spline, err)
    if (allocated(err)) then
      call explain(err)
      call diagnostics%add(span, err%message, err%code)
    else
      allocate (slot%drive, source=drive)
    end if
  end subroutine read_table_drive

  !> The files that drives are read from, in a document that may be unchecked yet.
  pure subroutine files_of_drives(document, paths)
    type(document_type), intent(in) :: document              !< the data file as groups and items
    type(string_type), allocatable, intent(out) :: paths(:)  !< path of each file, from the working directory
    integer :: i, n

    n = 0
    if (allocated(document%groups)) n = size(document%groups)
    allocate (paths(n))
    n = 0
    do i = 1, size(paths)
      associate (group => document%groups(i))
        if (group%name /= 'drive' .or. .not. allocated(group%items)) cycle
        call take_file(document%source%name, group%items, paths, n)
      end associate
    end do
    paths = paths(:n)
  end subroutine files_of_drives

  !> Append the file that a drive names; if it names several, the last one counts.
  pure subroutine take_file(data_file, items, paths, n)
    character(len=*), intent(in) :: data_file     !< path of the data file
    type(item_type), intent(in) :: items(:)       !< items of the group &drive
    type(string_type), intent(inout) :: paths(:)  !< the paths so far; the first n are in use
    integer, intent(inout) :: n                   !< how many paths are in use
    integer :: i

    do i = size(items), 1, -1
      if (items(i)%name /= 'file' .or. .not. allocated(items(i)%values)) cycle
      if (size(items(i)%values) /= 1) cycle
      if (.not. allocated(items(i)%values(1)%text)) cycle
      n = n + 1
      paths(n)%text = beside(data_file, items(i)%values(1)%text)
      return
    end do
  end subroutine take_file

  !> Length of the part of the data file's path that a relative name is appended to; 0 for an absolute name.
  pure integer function start_length(data_file, name)
    character(len=*), intent(in) :: data_file  !< path of the data file
    character(len=*), intent(in) :: name       !< path as the data file gives it

    start_length = index(data_file, '/', back=.true.)
    if (starts_with(name, '/')) start_length = 0
  end function start_length

  !> Path of a file named in a data file: relative names start from the data file's folder.
  pure function beside(data_file, name) result(path)
    character(len=*), intent(in) :: data_file  !< path of the data file
    character(len=*), intent(in) :: name       !< path as the data file gives it
    character(len=start_length(data_file, name) + len(name)) :: path

    path = data_file(:start_length(data_file, name))//name
  end function beside
end module mech9_drive_reader
