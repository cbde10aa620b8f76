!> Drives from the groups &drive of a checked document, and laws of time for other groups.
module mech9_drive_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_counted, only: counted
  use mech9_spline, only: build_spline
  use mech9_explanation, only: explain
  use mech9_partition, only: partition_type, driven_coordinate
  use mech9_pair, only: pair_slot_type
  use mech9_mechanism, only: mechanism_type
  use mech9_units, only: units_type, coordinate_units_type
  use mech9_result_units, only: si_unit
  use mech9_law, only: law_type, drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_harmonic_law, only: harmonic_law_type
  use mech9_table_law, only: table_law_type
  use mech9_cam_curves, only: curve_number
  use mech9_segments_law, only: segments_law_type
  use mech9_procedure_drive, only: procedure_drive_type, make_procedure_drive
  use mech9_source, only: span_type
  use mech9_document, only: document_type, group_type, item_type
  use mech9_lookup, only: groups_named, get_integer, get_real, get_reals, get_text, count_values, get_word, has_name, span_of
  use mech9_table_file, only: read_table_file, beside
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_drives, read_drive_group, read_law, files_of_groups, units_of_coordinate

  !> A period is that of the segments where it differs by no more than this part.
  real(wp), parameter :: same_period = 1.0e-9_wp

contains

  !> Make the drives of all sound groups.
  subroutine read_drives(document, mechanism, start, partition, drives, diagnostics)
    type(document_type), intent(in) :: document                   !< the data file as groups and items
    type(mechanism_type), intent(in) :: mechanism                 !< with its pairs
    real(wp), intent(in) :: start                                 !< time of the first result [s]
    type(partition_type), intent(inout) :: partition              !< kinds of the coordinates, none where the structure is unknown;
                                                                  !< those with drives become driven ones
    type(drive_slot_type), allocatable, intent(out) :: drives(:)  !< the drives of sound groups, in their order
    type(diagnostics_type), intent(inout) :: diagnostics          !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i, n, k

    numbers = groups_named(document, 'drive')
    allocate (drives(size(numbers)))
    n = 0
    do i = 1, size(numbers)
      call read_drive_group(document, numbers(i), mechanism, start, drives(n + 1), diagnostics)
      call check_coordinate(document%groups(numbers(i)), partition, diagnostics)
      if (allocated(drives(n + 1)%drive)) n = n + 1
    end do
    do i = 1, n
      k = drives(i)%drive%coordinate
      if (k < 1 .or. k > size(partition%kind)) cycle
      if (partition%is_independent(k)) partition%kind(k) = driven_coordinate
    end do
  end subroutine read_drives

  !> The drive of one group, in rad, m and s; the slot stays empty where something was reported.
  subroutine read_drive_group(document, number, mechanism, start, slot, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: number                         !< of the group in the document
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs
    real(wp), intent(in) :: start                         !< time of the first result [s]
    type(drive_slot_type), intent(out) :: slot            !< gets the drive
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(procedure_drive_type) :: user_drive
    type(error_type), allocatable :: err

    associate (group => document%groups(number))
      if (get_text(group, 'kind') == 'user') then
        call make_procedure_drive(get_integer(group, 'coordinate'), start, mechanism%parameters, mechanism%procedures%drive, &
                                  user_drive, err)
        if (.not. allocated(err)) allocate (slot%drive, source=user_drive)
        if (allocated(err)) call diagnostics%add(span_of(group, 'kind', 1), err%message, err%code)
      else
        call read_law(document, group, get_text(group, 'kind'), units_of_coordinate(group, mechanism%pairs, mechanism%units), &
                      slot%drive, diagnostics)
      end if
      if (.not. allocated(slot%drive)) return
      slot%drive%coordinate = get_integer(group, 'coordinate')
      slot%drive%place = diagnostics%place(group%span)
    end associate
  end subroutine read_drive_group

  !> The factors that turn numbers of a group about a coordinate into SI.
  pure type(coordinate_units_type) function units_of_coordinate(group, pairs, units) result(unit)
    type(group_type), intent(in) :: group         !< a group with a name `coordinate`
    type(pair_slot_type), intent(in) :: pairs(:)  !< (M) pairs by coordinate; a slot is empty where its group has an error
    type(units_type), intent(in) :: units         !< units of the file
    integer :: k

    k = get_integer(group, 'coordinate')
    if (k > size(pairs)) return
    if (.not. allocated(pairs(k)%pair)) return
    unit = units%of_coordinate(trim(si_unit(pairs(k)%pair)))
  end function units_of_coordinate

  !> Report a drive of a coordinate that does not exist.
  pure subroutine check_coordinate(group, partition, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(partition_type), intent(in) :: partition         !< kinds of the coordinates; none where the structure is unknown
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: k

    if (size(partition%kind) == 0) return
    k = get_integer(group, 'coordinate')
    if (k > size(partition%kind)) &
      call diagnostics%add(span_of(group, 'coordinate', 1), 'there is no coordinate '//to_text(k)//'; they are 1 to '// &
                           to_text(size(partition%kind)))
  end subroutine check_coordinate

  !> A law of time by the names of a group, in SI; it stays unallocated where an error was reported, and for a constant.
  subroutine read_law(document, group, name, unit, law, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: name                  !< of the law
    type(coordinate_units_type), intent(in) :: unit       !< units of the law's values and rates in the file
    class(law_type), allocatable, intent(out) :: law      !< the law
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(polynomial_law_type) :: polynomial
    type(harmonic_law_type) :: harmonic
    real(wp), allocatable :: given(:)

    select case (name)
    case ('polynomial')
      given = get_reals(group, 'coefficients')
      polynomial%coefficients = unit%position*given
      if (size(given) > 1) polynomial%coefficients(2) = unit%rate*given(2)
      allocate (law, source=polynomial)
    case ('harmonic')
      harmonic%mean = unit%position*get_real(group, 'mean')
      harmonic%amplitude = unit%position*get_real(group, 'amplitude')
      harmonic%angular_frequency = get_real(group, 'angular_frequency')
      harmonic%phase = get_real(group, 'phase')
      allocate (law, source=harmonic)
    case ('table')
      call read_table(document, group, unit%position, law, diagnostics)
    case ('segments')
      call read_segments(group, unit%position, law, diagnostics)
    end select
  end subroutine read_law

  !> A law through the points of a file.
  subroutine read_table(document, group, unit, law, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: unit                          !< unit of the law's values in the file [rad, m or 1]
    class(law_type), allocatable, intent(inout) :: law    !< gets the law; stays unallocated where an error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(table_law_type) :: table
    type(error_type), allocatable :: err
    real(wp), allocatable :: points(:, :)
    type(span_type) :: span
    logical :: ok

    span = span_of(group, 'file', 1)
    call read_table_file(beside(document%source%name, get_text(group, 'file')), span, 't', 'q', points, ok, diagnostics)
    if (.not. ok) return
    call build_spline(points(1, :), unit*points(2, :), table%spline, err)
    if (allocated(err)) then
      call explain(err)
      call diagnostics%add(span, err%message, err%code)
    else
      allocate (law, source=table)
    end if
  end subroutine read_table

  !> A law in segments.
  subroutine read_segments(group, unit, law, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: unit                          !< unit of the law's values in the file [rad, m or 1]
    class(law_type), allocatable, intent(inout) :: law    !< gets the law; stays unallocated where an error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(segments_law_type) :: segments
    integer :: i, known, n

    known = diagnostics%known()
    segments%times = get_reals(group, 'times')
    segments%values = unit*get_reals(group, 'values')
    n = size(segments%times) - 1
    do i = 1, n
      if (.not. segments%times(i + 1) > segments%times(i)) call diagnostics%add(span_of(group, 'times', i + 1), &
        'times must increase, and '//to_text(segments%times(i + 1))//' does not come after '//to_text(segments%times(i)))
    end do
    if (size(segments%values) /= n + 1) &
      call diagnostics%add(span_of(group, 'values'), 'there are '//to_text(size(segments%values))//' values for '// &
                           to_text(n + 1)//' times; give one for each time')
    if (count_values(group, 'laws') /= n .and. count_values(group, 'laws') /= 1) &
      call diagnostics%add(span_of(group, 'laws'), 'there are '//to_text(count_values(group, 'laws'))//' laws for '// &
                           counted(n, 'segment')//'; give one for each segment, or one for all')
    if (has_name(group, 'period')) call check_period(group, segments%times, diagnostics)
    if (diagnostics%known() > known) return
    segments%repeats = has_name(group, 'period')
    allocate (segments%curves(n))
    do i = 1, n
      segments%curves(i) = curve_number(get_word(group, 'laws', min(i, count_values(group, 'laws'))))
      if (segments%curves(i) == curve_number('dwell') .and. abs(segments%values(i + 1) - segments%values(i)) > 0.0_wp) &
        call diagnostics%add(span_of(group, 'values', i + 1), 'segment '//to_text(i)//' dwells, but its values differ: '// &
                             to_text(segments%values(i)/unit)//' and '//to_text(segments%values(i + 1)/unit))
    end do
    if (diagnostics%known() == known) allocate (law, source=segments)
  end subroutine read_segments

  !> Report a period that leaves a gap between the last segment and the first one, or cuts segments off.
  subroutine check_period(group, times, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: times(:)                      !< ends of the segments [s]
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp) :: period, span

    period = get_real(group, 'period')
    span = times(size(times)) - times(1)
    if (abs(period - span) <= same_period*span) return
    if (period > span) then
      call diagnostics%add(span_of(group, 'period', 1), 'the segments last '//to_text(span)//' s, which leaves a gap in a '// &
                           'period of '//to_text(period)//' s; add a segment, for instance a dwell')
    else
      call diagnostics%add(span_of(group, 'period', 1), 'the segments last '//to_text(span)//' s, longer than a period of '// &
                           to_text(period)//' s; give the period that they last, or leave out segments')
    end if
  end subroutine check_period

  !> The files that drives, laws of loads and motors, curves of pairs and couplings are read from, in a document that may be
  !> unchecked yet.
  pure subroutine files_of_groups(document, paths)
    type(document_type), intent(in) :: document              !< the data file as groups and items
    type(string_type), allocatable, intent(out) :: paths(:)  !< path of each file, from the working directory
    integer :: i, n

    n = 0
    if (allocated(document%groups)) n = size(document%groups)
    allocate (paths(n))
    n = 0
    do i = 1, size(paths)
      associate (group => document%groups(i))
        if (all(group%name /= [character(len=9) :: 'drive', 'load', 'motor', 'pair', 'coupling', 'study', 'objective']) .or. &
            .not. allocated(group%items)) cycle
        call take_file(document%source%name, group%items, paths, n)
      end associate
    end do
    paths = paths(:n)
  end subroutine files_of_groups

  !> Append the file that a group names; if it names several, the last one counts.
  pure subroutine take_file(data_file, items, paths, n)
    character(len=*), intent(in) :: data_file     !< path of the data file
    type(item_type), intent(in) :: items(:)       !< items of the group
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
end module mech9_drive_reader
