!> Couplings from the groups &coupling of a checked document.
module mech9_coupling_reader
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_pair, only: pair_slot_type
  use mech9_units, only: units_type, coordinate_units_type
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: si_unit, unit_name
  use mech9_coupling, only: coupling_slot_type
  use mech9_linear_coupling, only: linear_coupling_type
  use mech9_table_coupling, only: table_coupling_type, new_table_coupling, new_turning_table
  use mech9_procedure_coupling, only: procedure_coupling_type, make_procedure_coupling
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integers, get_real, get_reals, get_logical, get_text, span_of
  use mech9_table_file, only: read_table_file, beside
  use mech9_explanation, only: explain
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_couplings, read_coupling

  real(wp), parameter :: turn = 2.0_wp*pi   !< a full turn [rad]
  !> A table is a whole turn long, and ends as it begins, within this part of a turn or of its range: numbers of six digits serve.
  real(wp), parameter :: same_end = 1.0e-5_wp

contains

  !> All couplings, in the order of the file; of use only where nothing is reported.
  subroutine read_couplings(document, positions, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    real(wp), intent(in) :: positions(:)                  !< (M) coordinates at the start, which give constants [rad, m]
    type(mechanism_type), intent(inout) :: mechanism      !< with its pairs; gets a coupling for each sound group
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(coupling_slot_type), allocatable :: couplings(:)
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'coupling')
    allocate (couplings(size(numbers)))
    if (size(positions) > 0) then
      do i = 1, size(numbers)
        call read_coupling(document, numbers(i), i, positions, mechanism, couplings(i), diagnostics)
      end do
    end if
    call move_alloc(couplings, mechanism%couplings)
  end subroutine read_couplings

  !> The coupling of one group; of use only where nothing is reported.
  subroutine read_coupling(document, number, i, positions, mechanism, slot, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: number                         !< of the group in the document
    integer, intent(in) :: i                              !< number of the coupling
    real(wp), intent(in) :: positions(:)                  !< (M) coordinates at the start, which give constants [rad, m]
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs; a slot is empty where its group has an error
    type(coupling_slot_type), intent(out) :: slot         !< gets the coupling
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical :: ok

    associate (group => document%groups(number))
      call check_coordinates(group, size(positions), ok, diagnostics)
      if (.not. ok) return
      select case (get_text(group, 'kind'))
      case ('table')
        call read_table(beside(document%source%name, get_text(group, 'file')), group, mechanism, slot, diagnostics)
      case ('user')
        call read_procedure(group, i, positions, mechanism, slot, diagnostics)
      case default
        call read_linear(group, positions, mechanism, slot, diagnostics)
      end select
      if (.not. allocated(slot%coupling)) return
      slot%coupling%coordinates = get_integers(group, 'coordinates')
      slot%coupling%place = diagnostics%place(group%span)
    end associate
  end subroutine read_coupling

  !> Report coordinates that do not exist, that are named twice, or of which there are too many.
  pure subroutine check_coordinates(group, n_coordinates, ok, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: n_coordinates                  !< how many coordinates the mechanism has
    logical, intent(out) :: ok                            !< whether nothing was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: k(:)
    integer :: i

    k = get_integers(group, 'coordinates')
    ok = get_text(group, 'kind') == 'linear' .or. size(k) == 2
    if (.not. ok) call diagnostics%add(span_of(group, 'coordinates', 3), 'a coupling of this kind joins two coordinates, and '// &
                                       to_text(size(k))//' are given')
    do i = 1, size(k)
      if (k(i) > n_coordinates) then
        call diagnostics%add(span_of(group, 'coordinates', i), 'there is no coordinate '//to_text(k(i))//'; they are 1 to '// &
                             to_text(n_coordinates))
      else if (any(k(:i - 1) == k(i))) then
        call diagnostics%add(span_of(group, 'coordinates', i), 'coordinate '//to_text(k(i))//' is named twice; a coupling '// &
                             'joins different coordinates')
      else
        cycle
      end if
      ok = .false.
    end do
  end subroutine check_coordinates

  !> A coupling with a linear equation. The slot stays empty where an error was reported.
  subroutine read_linear(group, positions, mechanism, slot, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: positions(:)                  !< (M) coordinates at the start [rad, m]
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs and its units
    type(coupling_slot_type), intent(inout) :: slot       !< gets the coupling
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(linear_coupling_type) :: linear
    integer, allocatable :: k(:)
    real(wp), allocatable :: units(:)
    integer :: known

    known = diagnostics%known()
    k = get_integers(group, 'coordinates')
    units = units_of(k, mechanism%pairs, mechanism%units)
    linear%name = get_text(group, 'kind')
    if (linear%name == 'linear') then
      linear%coefficients = get_reals(group, 'coefficients')
      call check_coefficients(group, linear%coefficients, size(k), diagnostics)
      if (diagnostics%known() > known) return
      linear%coefficients = linear%coefficients/units
      linear%constant = get_real(group, 'constant')
    else
      call check_kinds(group, k, mechanism%pairs, diagnostics)
      linear%coefficients = [-slope_of(group, diagnostics), 1.0_wp]
      if (linear%name == 'belt') linear%radii = get_reals(group, 'radii')
      linear%constant = positions(k(2)) + linear%coefficients(1)*positions(k(1))
      if (has_name(group, 'phase')) linear%constant = units(2)*get_real(group, 'phase')
    end if
    if (diagnostics%known() == known) allocate (slot%coupling, source=linear)
  end subroutine read_linear

  !> A coupling by a table. The slot stays empty where an error was reported.
  subroutine read_table(path, group, mechanism, slot, diagnostics)
    character(len=*), intent(in) :: path                  !< of the table
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs and its units
    type(coupling_slot_type), intent(inout) :: slot       !< gets the coupling
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(table_coupling_type) :: table
    type(error_type), allocatable :: err
    real(wp), allocatable :: points(:, :), units(:)
    real(wp) :: gain
    integer :: k(2), i
    logical :: ok

    k = get_integers(group, 'coordinates')
    if (.not. are_given(k, mechanism%pairs)) return
    units = units_of(k, mechanism%pairs, mechanism%units)
    call read_table_file(path, span_of(group, 'file', 1), 'q'//to_text(k(1)), 'q'//to_text(k(2)), points, ok, diagnostics)
    if (.not. ok) return
    do i = 1, 2
      points(i, :) = units(i)*points(i, :)
    end do
    if (turns(k(1), mechanism%pairs) .and. abs(points(1, size(points, 2)) - points(1, 1) - turn) <= same_end*turn) then
      call close_turn(group, k, mechanism, points, gain, ok, diagnostics)
      if (.not. ok) return
      call new_turning_table(points(1, :), points(2, :), gain, table, err)
    else
      call new_table_coupling(points(1, :), points(2, :), table, err)
    end if
    table%unit = units(1)
    table%unit_name = unit_name(mechanism, k(1))
    if (allocated(err)) then
      call explain(err)
      call diagnostics%add(span_of(group, 'file', 1), err%message, err%code)
    else
      allocate (slot%coupling, source=table)
    end if
  end subroutine read_table

  !> A coupling by a user's procedure. The slot stays empty where an error was reported.
  subroutine read_procedure(group, number, positions, mechanism, slot, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: number                         !< of the coupling
    real(wp), intent(in) :: positions(:)                  !< (M) coordinates at the start [rad, m]
    type(mechanism_type), intent(in) :: mechanism         !< with the user's procedures and their numbers
    type(coupling_slot_type), intent(inout) :: slot       !< gets the coupling
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(procedure_coupling_type) :: coupling
    type(error_type), allocatable :: err
    integer :: k(2)

    k = get_integers(group, 'coordinates')
    call make_procedure_coupling(number, positions(k(1)), mechanism%parameters, mechanism%procedures%coupling, coupling, err)
    if (allocated(err)) then
      call diagnostics%add(span_of(group, 'kind', 1), err%message, err%code)
    else
      allocate (slot%coupling, source=coupling)
    end if
  end subroutine read_procedure

  !> Make a table exactly one turn long, with a second coordinate that ends as it begins or whole turns on; report one that is not.
  subroutine close_turn(group, k, mechanism, points, gain, ok, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: k(2)                           !< numbers of the coordinates
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs and its units
    real(wp), intent(inout) :: points(:, :)               !< (2,n) values of both coordinates [rad, m]; the last ones are moved
    real(wp), intent(out) :: gain                         !< change of the second coordinate per rad of the first one, over the turn
    logical, intent(out) :: ok                            !< whether nothing was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp) :: rise, unit
    integer :: n

    n = size(points, 2)
    gain = 0.0_wp
    rise = 0.0_wp
    if (turns(k(2), mechanism%pairs)) rise = turn*anint((points(2, n) - points(2, 1))/turn)
    ok = abs(points(2, n) - points(2, 1) - rise) <= same_end*max(abs(rise), maxval(points(2, :)) - minval(points(2, :)))
    if (.not. ok) then
      unit = unit_of(k(2), mechanism%pairs, mechanism%units)
      call diagnostics%add(span_of(group, 'file', 1), 'the table repeats after a turn of coordinate '//to_text(k(1))// &
                           ' and would jump there: coordinate '//to_text(k(2))//' begins at '// &
                           to_text(points(2, 1)/unit)//' and ends at '//to_text(points(2, n)/unit)//'; let it end as it begins'// &
                           trim(merge(', or whole turns on', '                   ', turns(k(2), mechanism%pairs))))
      return
    end if
    points(:, n) = points(:, 1) + [turn, rise]
    gain = rise/turn
  end subroutine close_turn

  !> The unit of a coordinate in the file.
  pure real(wp) function unit_of(k, pairs, units) result(unit)
    integer, intent(in) :: k                       !< number of the coordinate
    type(pair_slot_type), intent(in) :: pairs(:)   !< (M) pairs by coordinate
    type(units_type), intent(in) :: units          !< units of the file

    type(coordinate_units_type) :: found

    if (k <= size(pairs)) then
      if (allocated(pairs(k)%pair)) found = units%of_coordinate(trim(si_unit(pairs(k)%pair)))
    end if
    unit = found%position
  end function unit_of

  !> The units of some coordinates in the file.
  pure function units_of(k, pairs, units) result(list)
    integer, intent(in) :: k(:)                    !< numbers of the coordinates
    type(pair_slot_type), intent(in) :: pairs(:)   !< (M) pairs by coordinate
    type(units_type), intent(in) :: units          !< units of the file
    real(wp) :: list(size(k))
    integer :: i

    list = [(unit_of(k(i), pairs, units), i=1, size(k))]
  end function units_of

  !> Whether the pairs of both coordinates are known, without errors in their groups.
  pure logical function are_given(k, pairs)
    integer, intent(in) :: k(2)                    !< numbers of the coordinates
    type(pair_slot_type), intent(in) :: pairs(:)   !< (M) pairs by coordinate; a slot is empty where its group has an error

    are_given = all(k <= size(pairs))
    if (are_given) are_given = allocated(pairs(k(1))%pair) .and. allocated(pairs(k(2))%pair)
  end function are_given

  !> Whether a coordinate is an angle.
  pure logical function turns(k, pairs)
    integer, intent(in) :: k                       !< number of the coordinate
    type(pair_slot_type), intent(in) :: pairs(:)   !< (M) pairs by coordinate; a slot is empty where its group has an error

    turns = .false.
    if (k > size(pairs)) return
    if (allocated(pairs(k)%pair)) turns = pairs(k)%pair%angular
  end function turns

  !> The change of the second coordinate per change of the first one [rad/rad, m/rad, m/m].
  real(wp) function slope_of(group, diagnostics) result(slope)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp) :: radii(2)

    select case (get_text(group, 'kind'))
    case ('gear')
      slope = get_real(group, 'ratio')
      call refuse_zero(group, 'ratio', slope, diagnostics)
    case ('rack')
      slope = get_real(group, 'radius')
      call refuse_zero(group, 'radius', slope, diagnostics)
    case ('screw')
      slope = get_real(group, 'pitch')/(2.0_wp*pi)
      call refuse_zero(group, 'pitch', slope, diagnostics)
    case default
      radii = get_reals(group, 'radii')
      slope = radii(1)/max(radii(2), tiny(slope))
      if (get_logical(group, 'crossed')) slope = -slope
    end select
  end function slope_of

  !> Report a number that must not be zero.
  pure subroutine refuse_zero(group, name, value, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: name                  !< name of the number
    real(wp), intent(in) :: value                         !< the number
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (.not. abs(value) > 0.0_wp) &
      call diagnostics%add(span_of(group, name, 1), 'with '//name//'=0 the first coordinate would not move the second one')
  end subroutine refuse_zero

  !> Report coordinates that turn where they must slide, or slide where they must turn.
  pure subroutine check_kinds(group, k, pairs, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    integer, intent(in) :: k(2)                           !< numbers of its coordinates
    type(pair_slot_type), intent(in) :: pairs(:)          !< (M) pairs by coordinate; a slot is empty where its group has an error
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (.not. are_given(k, pairs)) return
    select case (get_text(group, 'kind'))
    case ('gear')
      if (turns(k(1), pairs) .neqv. turns(k(2), pairs)) &
        call diagnostics%add(span_of(group, 'coordinates'), 'one of the coordinates '//to_text(k)//' turns and the other one '// &
                             'does not; kind=''rack'' or ''screw'' couples such coordinates')
    case ('belt')
      if (.not. (turns(k(1), pairs) .and. turns(k(2), pairs))) &
        call diagnostics%add(span_of(group, 'coordinates'), 'a belt couples two coordinates that turn')
    case default
      if (.not. turns(k(1), pairs) .or. turns(k(2), pairs)) &
        call diagnostics%add(span_of(group, 'coordinates'), 'a '//get_text(group, 'kind')//' couples a coordinate that turns, '// &
                             'given first, and one that slides')
    end select
  end subroutine check_kinds

  !> Report coefficients whose number is wrong, or that are zero.
  pure subroutine check_coefficients(group, coefficients, n, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    real(wp), intent(in) :: coefficients(:)               !< its coefficients
    integer, intent(in) :: n                              !< number of its coordinates
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i

    if (size(coefficients) /= n) then
      call diagnostics%add(span_of(group, 'coefficients'), 'there are '//counted(size(coefficients), 'coefficient')//' for '// &
                           counted(n, 'coordinate')//'; give one for each')
      return
    end if
    do i = 1, n
      if (.not. abs(coefficients(i)) > 0.0_wp) &
        call diagnostics%add(span_of(group, 'coefficients', i), 'a coefficient of 0 couples nothing; leave its coordinate out')
    end do
  end subroutine check_coefficients
end module mech9_coupling_reader
