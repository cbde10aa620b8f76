!> Drives from the groups &drive of a checked document, and laws of time, or over another variable, for other groups.
module mech9_drive_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_counted, only: counted
  use mech9_spline, only: build_spline, build_periodic_spline
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
  use mech9_law_over, only: law_over_type
  use mech9_result_units, only: unit_of, unit_name, rate_unit_of, rate_unit_name
  use mech9_procedure_drive, only: procedure_drive_type, make_procedure_drive
  use mech9_source, only: span_type
  use mech9_document, only: document_type, group_type, item_type
  use mech9_lookup, only: groups_named, get_integer, get_real, get_reals, get_text, count_values, get_word, has_name, span_of
  use mech9_table_file, only: read_table_file, beside
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_drives, read_drive_group, read_law, read_law_over, is_over, files_of_groups, units_of_coordinate

  !> A period is that of the segments where it differs by no more than this part.
  real(wp), parameter :: same_period = 1.0e-9_wp
  !> The last value of a law is its first where it differs by no more than this part of the largest one: files round.
  real(wp), parameter :: same_value = 1.0e-9_wp

  !> A variable of laws by its name and its unit. A law that repeats may advance by the difference of its ends, as setpoints do.
  type :: law_variable_type
    character(len=80) :: name = 't'
    character(len=8) :: unit = 's'
    logical :: advances = .false.
  end type law_variable_type

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

  !> A law of time by the names of a group, in SI, or over another variable, which counts in units of the file; it stays
  !> unallocated where an error was reported, and for a constant.
  subroutine read_law(document, group, name, unit, law, diagnostics, over)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: name                  !< of the law
    type(coordinate_units_type), intent(in) :: unit       !< units of the law's values and rates in the file
    class(law_type), allocatable, intent(out) :: law      !< the law
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(law_variable_type), intent(in), optional :: over !< its variable; the time unless given
    type(polynomial_law_type) :: polynomial
    type(harmonic_law_type) :: harmonic
    real(wp), allocatable :: given(:)
    type(law_variable_type) :: variable

    if (present(over)) variable = over
    select case (name)
    case ('polynomial')
      given = get_reals(group, 'coefficients')
      polynomial%coefficients = unit%position*given
      if (size(given) > 1 .and. .not. present(over)) polynomial%coefficients(2) = unit%rate*given(2)
      allocate (law, source=polynomial)
    case ('harmonic')
      harmonic%mean = unit%position*get_real(group, 'mean')
      harmonic%amplitude = unit%position*get_real(group, 'amplitude')
      harmonic%angular_frequency = get_real(group, 'angular_frequency')
      harmonic%phase = get_real(group, 'phase')
      allocate (law, source=harmonic)
    case ('table')
      call read_table(document, group, unit%position, variable, law, diagnostics)
    case ('segments')
      call read_segments(group, unit%position, variable, law, diagnostics)
    end select
    if (.not. (allocated(law) .and. present(over))) return
    law%variable = variable%name
    law%variable_unit = variable%unit
  end subroutine read_law

  !> Whether a group has a law over another variable than the time.
  pure logical function is_over(group)
    type(group_type), intent(in) :: group  !< a group with a name `over`

    is_over = has_name(group, 'over')
    if (is_over) is_over = get_text(group, 'over') /= 't'
  end function is_over

  !> The law of a load or of a motor over a coordinate, a rate or a component of a point. It stays unallocated where an error was
  !> reported, and for a constant.
  subroutine read_law_over(document, group, mechanism, unit, over, diagnostics, advances)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs and points; none where they are not known
    type(coordinate_units_type), intent(in) :: unit       !< units of the law's values in the file
    type(law_over_type), allocatable, intent(out) :: over !< the law with its variable
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical, intent(in) :: advances                       !< a law that repeats may end elsewhere than it begins
    type(law_over_type) :: found
    type(law_variable_type) :: variable
    integer :: known

    if (.not. (has_name(group, 'law') .and. size(mechanism%pairs) > 0)) return
    if (get_text(group, 'law') == 'constant') return
    known = diagnostics%known()
    variable%advances = advances
    variable%name = get_text(group, 'over')
    call find_variable(group, mechanism, found, variable%unit, diagnostics)
    if (diagnostics%known() > known) return
    call read_law(document, group, get_text(group, 'law'), unit, found%law, diagnostics, variable)
    if (.not. allocated(found%law)) return
    select type (law => found%law)
    type is (harmonic_law_type)
      ! an angle for each unit of the variable, and not for each second
      law%angular_frequency = law%angular_frequency*mechanism%units%angle/mechanism%units%rate
    end select
    over = found
  end subroutine read_law_over

  !> Find the variable of a law by its name, which is that of a column of the results. Accelerations follow from forces and cannot
  !> decide them.
  subroutine find_variable(group, mechanism, over, unit, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs and points
    type(law_over_type), intent(inout) :: over            !< gets its variable
    character(len=*), intent(out) :: unit                 !< name of its unit in the file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: name
    integer :: derivative, dot, i

    unit = ''
    name = get_text(group, 'over')
    derivative = verify(name//'q', 'd') - 1
    dot = index(name, '.', back=.true.)
    if (dot > 0) then
      call find_component(name, mechanism, over, unit, derivative)
    else if (index(name, repeat('d', derivative)//'q') == 1) then
      do i = 1, size(mechanism%pairs)
        if (name(derivative + 2:) /= to_text(i)) cycle
        over%coordinate = i
        over%is_rate = derivative == 1
        if (.not. allocated(mechanism%pairs(i)%pair)) return
        over%unit = unit_of(mechanism, i)
        unit = unit_name(mechanism, i)
        if (over%is_rate) over%unit = rate_unit_of(mechanism, i)
        if (over%is_rate) unit = rate_unit_name(mechanism, i)
        if (unit(1:1) == '1') unit = ''
      end do
    end if
    if (over%coordinate == 0 .and. over%link == 0) then
      call diagnostics%add(span_of(group, 'over', 1), 'there is no variable '''//name//'''; a law is over t, a coordinate '// &
                           '(q1 to q'//to_text(size(mechanism%pairs))//'), a rate (as dq1), or the position or velocity of a '// &
                           '&point (as P.x, P.vx)')
    else if (derivative > 1) then
      call diagnostics%add(span_of(group, 'over', 1), 'accelerations follow from the forces, so that no force can be over '// &
                           name//'; give a coordinate, a rate, or the position or velocity of a point')
    end if
  end subroutine find_variable

  !> Find a component of a point by the name of its column.
  pure subroutine find_component(name, mechanism, over, unit, derivative)
    character(len=*), intent(in) :: name               !< as P.vx
    type(mechanism_type), intent(in) :: mechanism      !< with its points
    type(law_over_type), intent(inout) :: over         !< gets the point and the direction; stays as it is where there is none
    character(len=*), intent(inout) :: unit            !< gets the name of its unit
    integer, intent(out) :: derivative                 !< 0 for a position, 1 for a velocity, 2 for an acceleration
    character(len=2), parameter :: orders(0:2) = ['  ', 'v ', 'a ']
    integer :: dot, i, k, order

    dot = index(name, '.', back=.true.)
    derivative = 0
    do i = 1, size(mechanism%points)
      if (mechanism%points(i)%name /= name(:dot - 1)) cycle
      do order = 0, 2
        k = index('xyz', name(len(name):))
        if (k == 0 .or. name(dot + 1:len(name) - 1) /= trim(orders(order))) cycle
        over%link = mechanism%points(i)%link
        over%position = mechanism%points(i)%position
        over%direction = 0.0_wp
        over%direction(k) = 1.0_wp
        over%is_rate = order == 1
        derivative = order
        over%unit = mechanism%units%length
        unit = mechanism%units%name_of(trim(merge('m/s', 'm  ', order == 1)))
      end do
    end do
  end subroutine find_component

  !> A law through the points of a file.
  subroutine read_table(document, group, unit, variable, law, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: unit                          !< unit of the law's values in the file [rad, m or 1]
    type(law_variable_type), intent(in) :: variable       !< the variable of the law
    class(law_type), allocatable, intent(inout) :: law    !< gets the law; stays unallocated where an error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(table_law_type) :: table
    type(error_type), allocatable :: err
    real(wp), allocatable :: points(:, :)
    type(span_type) :: span
    integer :: known
    logical :: ok

    known = diagnostics%known()
    span = span_of(group, 'file', 1)
    call read_table_file(beside(document%source%name, get_text(group, 'file')), span, trim(variable%name), &
                         trim(merge('q     ', 'factor', variable%name == 't')), points, ok, diagnostics)
    if (.not. ok) return
    table%repeats = has_name(group, 'period')
    if (table%repeats) then
      call check_period(group, points(1, :), 'the table lasts', 'lengthen the table, with its first value at the end', variable, &
                        diagnostics)
      if (.not. variable%advances) call check_return(span, points(2, :), 'the table', variable, diagnostics)
      if (diagnostics%known() > known) return
      call build_periodic_spline(points(1, :), unit*points(2, :), table%spline, err)
    else
      call build_spline(points(1, :), unit*points(2, :), table%spline, err)
    end if
    if (allocated(err)) then
      call explain(err)
      call diagnostics%add(span, err%message, err%code)
    else
      allocate (law, source=table)
    end if
  end subroutine read_table

  !> Report a law that repeats and jumps back to its first value.
  pure subroutine check_return(span, values, name, variable, diagnostics)
    type(span_type), intent(in) :: span                   !< place of the values in the data file
    real(wp), intent(in) :: values(:)                     !< of the law, in its order
    character(len=*), intent(in) :: name                  !< of that which gives the values
    type(law_variable_type), intent(in) :: variable       !< the variable of the law
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    associate (first => values(1), last => values(size(values)))
      if (abs(last - first) <= same_value*maxval(abs(values))) return
      call diagnostics%add(span, name//' repeats, and would jump from '//to_text(last)//' back to '//to_text(first)//' over '// &
                           trim(variable%name)//'; give the first value at the end again')
    end associate
  end subroutine check_return

  !> A law in segments.
  subroutine read_segments(group, unit, variable, law, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: unit                          !< unit of the law's values in the file [rad, m or 1]
    type(law_variable_type), intent(in) :: variable       !< the variable of the law
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
    if (has_name(group, 'period')) then
      call check_period(group, segments%times, 'the segments last', 'add a segment, for instance a dwell', variable, diagnostics)
      ! the times of jumps are known before, the places are not
      if (variable%name /= 't' .and. .not. variable%advances) &
        call check_return(span_of(group, 'values'), segments%values/unit, 'the law in segments', variable, diagnostics)
    end if
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

  !> Report a period that leaves a gap between the end of a law and its next beginning, or cuts its end off.
  pure subroutine check_period(group, times, what, remedy, variable, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: times(:)                      !< ends of the segments, or the abscissae of a table [s, or another unit]
    character(len=*), intent(in) :: what                  !< words for the law and its verb, as in `the table lasts`
    character(len=*), intent(in) :: remedy                !< for a gap
    type(law_variable_type), intent(in) :: variable       !< the variable of the law
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp) :: period, span

    period = get_real(group, 'period')
    span = times(size(times)) - times(1)
    if (abs(period - span) <= same_period*span) return
    associate (unit => ' '//trim(variable%unit))
      if (period > span) then
        call diagnostics%add(span_of(group, 'period', 1), what//' '//to_text(span)//trim(unit)//', which leaves a gap in a '// &
                             'period of '//to_text(period)//trim(unit)//'; '//remedy)
      else
        call diagnostics%add(span_of(group, 'period', 1), what//' '//to_text(span)//trim(unit)//', longer than a period of '// &
                             to_text(period)//trim(unit)//'; give the period of the whole law, or leave its end out')
      end if
    end associate
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
        if (all(group%name /= [character(len=9) :: 'drive', 'load', 'motor', 'contact', 'pair', 'coupling', 'study', &
                               'objective']) .or. .not. allocated(group%items)) cycle
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
