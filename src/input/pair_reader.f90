!> Pairs from the groups &pair of a checked document.
module mech9_pair_reader
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_curve_failures, only: failure_sharp_curve
  use mech9_text, only: to_text
  use mech9_pose, only: pose_type, default_zero
  use mech9_quintic_spline, only: fewest_points
  use mech9_space_curve, only: space_curve_type, build_curve
  use mech9_pair, only: pair_slot_type
  use mech9_screw_pair, only: screw_pair_type, revolute_pair, prismatic_pair, helical_pair, &
                              revolute_pair_dh, prismatic_pair_dh, helical_pair_dh
  use mech9_path_pair, only: path_pair_type, path_pair
  use mech9_procedure_pair, only: procedure_pair_type, make_procedure_pair
  use mech9_source, only: span_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_integers, get_real, get_reals, get_text, &
                          get_logical, span_of
  use mech9_axis_reader, only: read_axis_frames, make_frame, real_or
  use mech9_joint_reader, only: read_joint_pairs, joint_of_group
  use mech9_compound_joint, only: compound_joint_type, is_compound
  use mech9_structure, only: structure_type
  use mech9_units, only: units_type
  use mech9_mechanism, only: mechanism_type
  use mech9_table_file, only: read_curve_file, beside
  use mech9_explanation, only: explain
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_pairs, read_pair_group

  !> The ends of a curve meet where their distance is this part of the size of the curve. Where it is this part of the mean distance
  !> of neighbours, they probably should.
  real(wp), parameter :: ends_meet = 1.0e-9_wp, ends_nearly_meet = 1.0e-2_wp

contains

  !> Make the pairs of all sound groups. Coordinates without one keep an empty slot: mechanisms with
  !> such holes are refused when the structure is read.
  subroutine read_pairs(document, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(mechanism_type), intent(inout) :: mechanism      !< without coordinates where its structure is not known; gets pairs
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    if (allocated(mechanism%pairs)) deallocate (mechanism%pairs)
    allocate (mechanism%pairs(mechanism%structure%n_coordinates))
    numbers = groups_named(document, 'pair')
    do i = 1, size(numbers)
      call read_pair_group(document, numbers(i), mechanism, diagnostics)
    end do
  end subroutine read_pairs

  !> Make the pair, or the chain of pairs, of one group.
  subroutine read_pair_group(document, number, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: number                         !< of the group in the document
    type(mechanism_type), intent(inout) :: mechanism      !< its pairs get those of the group where it is right
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(pair_slot_type) :: slot
    integer :: k

    associate (group => document%groups(number))
      if (is_compound(get_text(group, 'kind'))) then
        call read_chain(group, mechanism%structure, mechanism%pairs, diagnostics)
        return
      end if
      k = get_integer(group, 'coordinate')
      call read_pair(document%source%name, group, mechanism, slot, diagnostics)
      if (k <= size(mechanism%pairs) .and. allocated(slot%pair)) call move_alloc(slot%pair, mechanism%pairs(k)%pair)
    end associate
  end subroutine read_pair_group

  !> The chain of pairs that stands for a joint with several freedoms.
  subroutine read_chain(group, structure, pairs, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(structure_type), intent(in) :: structure         !< links and joints; without coordinates where it is not known
    type(pair_slot_type), intent(inout) :: pairs(:)       !< (M) gets the pairs by coordinate
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(compound_joint_type) :: joint
    type(pair_slot_type), allocatable :: chain(:)
    integer :: i, j

    joint = joint_of_group(group)
    j = structure%joint_of(joint%numbers(1))
    if (j > 0) joint = structure%joints(j)
    call read_joint_pairs(group, joint, chain, diagnostics)
    if (j == 0) return
    do i = 1, joint%freedoms
      if (allocated(chain(i)%pair)) call move_alloc(chain(i)%pair, pairs(joint%numbers(i))%pair)
    end do
  end subroutine read_chain

  !> One pair; the slot stays empty where something was reported.
  subroutine read_pair(data_file, group, mechanism, slot, diagnostics)
    character(len=*), intent(in) :: data_file             !< path of the data file
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(mechanism_type), intent(in) :: mechanism         !< with its units and the numbers for the user's procedures
    type(pair_slot_type), intent(out) :: slot             !< gets the pair; stays empty where an error was reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(screw_pair_type) :: screw
    type(path_pair_type) :: path
    type(procedure_pair_type) :: procedure_pair
    type(error_type), allocatable :: err
    character(len=:), allocatable :: kind
    integer :: links(2), coordinate, found

    found = diagnostics%count
    kind = get_text(group, 'kind')
    coordinate = get_integer(group, 'coordinate')
    if (kind == 'user') then
      call make_procedure_pair(coordinate, mechanism%parameters, mechanism%procedures%pair, procedure_pair, err)
      if (allocated(err)) then
        call diagnostics%add(span_of(group, 'kind', 1), err%message, err%code)
        return
      end if
      allocate (slot%pair, source=procedure_pair)
    else if (kind == 'path') then
      call read_path(data_file, group, mechanism%units, path, diagnostics)
      if (diagnostics%count > found) return
      allocate (slot%pair, source=path)
    else
      if (has_name(group, 'dh')) then
        call read_dh(group, kind, mechanism%units, screw, diagnostics)
      else
        call read_frames(group, kind, screw, diagnostics)
      end if
      if (diagnostics%count > found) return
      allocate (slot%pair, source=screw)
    end if
    links = get_integers(group, 'links')
    slot%pair%coordinate = coordinate
    slot%pair%reference = links(1)
    slot%pair%moving = links(2)
    slot%pair%place = diagnostics%place(group%span)
  end subroutine read_pair

  !> A pair in Denavit-Hartenberg form.
  pure subroutine read_dh(group, kind, units, pair, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: kind                  !< of the pair
    type(units_type), intent(in) :: units                 !< units of the file
    type(screw_pair_type), intent(out) :: pair            !< the pair of screw motion
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=12), parameter :: others(6) = [character(len=12) :: 'point', 'axis', 'zero', 'moving_point', &
                                                 'moving_axis', 'moving_zero']
    real(wp) :: dh(4)
    integer :: i

    do i = 1, size(others)
      if (has_name(group, trim(others(i)))) &
        call diagnostics%add(span_of(group, trim(others(i))), ''''//trim(others(i))// &
                             ''' cannot stand beside ''dh'', which says where the pair is; leave one of them out')
    end do
    dh = get_reals(group, 'dh')
    associate (a => units%length*dh(1), alpha => units%angle*dh(2), d => units%length*dh(3), theta => units%angle*dh(4))
      select case (kind)
      case ('revolute')
        pair = revolute_pair_dh(a, alpha, d, theta)
      case ('prismatic')
        pair = prismatic_pair_dh(a, alpha, d, theta)
      case ('helical')
        pair = helical_pair_dh(a, alpha, d, theta, get_real(group, 'pitch'))
      end select
    end associate
  end subroutine read_dh

  !> A pair between a frame in its reference link and one in its moving link.
  pure subroutine read_frames(group, kind, pair, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: kind                  !< of the pair
    type(screw_pair_type), intent(out) :: pair            !< the pair of screw motion
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(pose_type) :: reference, moving
    integer :: found

    found = diagnostics%count
    if (.not. has_name(group, 'axis')) then
      call diagnostics%add(group%span, '&pair needs ''axis'': direction of the axis, in the reference link (or ''dh'')')
      return
    end if
    call read_axis_frames(group, reference, moving, diagnostics)
    if (diagnostics%count > found) return
    select case (kind)
    case ('revolute')
      pair = revolute_pair(reference, moving)
    case ('prismatic')
      pair = prismatic_pair(reference, moving)
    case ('helical')
      pair = helical_pair(reference, moving, get_real(group, 'pitch'))
    end select
  end subroutine read_frames

  !> A pair along the curve through the points of a file.
  subroutine read_path(data_file, group, units, pair, diagnostics)
    character(len=*), intent(in) :: data_file             !< path of the data file
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(units_type), intent(in) :: units                 !< units of the file
    type(path_pair_type), intent(out) :: pair             !< the pair along a curve
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(space_curve_type) :: curve
    type(pose_type) :: reference, moving
    type(span_type), allocatable :: spans(:)
    real(wp), allocatable :: points(:, :)
    real(wp) :: axis(3), zero(3), scale
    integer :: found
    logical, allocatable :: corners(:)
    logical :: ok

    found = diagnostics%count
    axis = real_or(group, 'axis', [0.0_wp, 0.0_wp, 1.0_wp])
    zero = real_or(group, 'zero', default_zero(axis))
    call make_frame(group, '', real_or(group, 'point', [0.0_wp, 0.0_wp, 0.0_wp]), axis, zero, reference, diagnostics)
    axis = real_or(group, 'moving_axis', [0.0_wp, 0.0_wp, 1.0_wp])
    zero = real_or(group, 'moving_zero', default_zero(axis))
    call make_frame(group, 'moving_', real_or(group, 'moving_point', [0.0_wp, 0.0_wp, 0.0_wp]), axis, zero, moving, diagnostics)
    call read_curve_file(beside(data_file, get_text(group, 'file')), span_of(group, 'file', 1), get_integers(group, 'columns'), &
                         fewest_points, points, spans, corners, ok, diagnostics)
    scale = units%length*get_real(group, 'scale')
    if (ok) then
      points = scale*points
      call read_curve(group, units, points, spans, curve, diagnostics)
    end if
    if (diagnostics%count == found) pair = path_pair(curve, scale, get_text(group, 'orientation') == 'tangent', reference, moving)
  end subroutine read_path

  !> The curve through points. Points that repeat their neighbour, and ends that do not meet though they should, are reported.
  subroutine read_curve(group, units, points, spans, curve, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(units_type), intent(in) :: units                 !< units of the file
    real(wp), intent(inout) :: points(:, :)               !< (3,n) the points, at least four; ends that meet are made equal [m]
    type(span_type), intent(in) :: spans(:)               !< (n) their places in the file
    type(space_curve_type), intent(out) :: curve          !< the curve
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(error_type), allocatable :: err
    real(wp) :: size_of_curve, distance
    integer :: i, n, found
    logical :: closed

    found = diagnostics%count
    n = size(spans)
    size_of_curve = norm2(maxval(points, dim=2) - minval(points, dim=2))
    do i = 2, n
      if (norm2(points(:, i) - points(:, i - 1)) > ends_meet*size_of_curve) cycle
      call diagnostics%add(spans(i), 'this point repeats the one before it; a curve needs different points, leave one of them out')
    end do
    if (diagnostics%count > found) return
    distance = norm2(points(:, n) - points(:, 1))
    closed = distance <= ends_meet*size_of_curve
    if (has_name(group, 'closed')) then
      if (get_logical(group, 'closed') .and. .not. closed) &
        call diagnostics%add(span_of(group, 'closed', 1), 'the ends of the curve are '//to_text(distance/units%length, 4)//' '// &
                             trim(units%length_name)//' apart; repeat the first point at the end of its file, or leave '// &
                             '''closed'' out')
      closed = get_logical(group, 'closed')
    else if (.not. closed .and. distance <= ends_nearly_meet*length_of(points)/(n - 1)) then
      call diagnostics%add(spans(n), 'the last point misses the first one by '//to_text(distance/units%length, 4)//' '// &
                           trim(units%length_name)//'; for a closed curve repeat the first point with all its digits, '// &
                           'or give closed=.false. in the data file')
    end if
    if (closed .and. n - 1 < fewest_points) &
      call diagnostics%add(spans(n), 'a smooth curve needs at least '//to_text(fewest_points)//' different points, and this '// &
                           'closed one has '//to_text(n - 1)//'; add points')
    if (diagnostics%count > found) return
    if (closed) points(:, n) = points(:, 1)
    call build_curve(points, closed, curve, err)
    if (allocated(err)) call report_curve(group, spans, err, diagnostics)
  end subroutine read_curve

  !> Report that no curve could be made, at the point near which it fails.
  subroutine report_curve(group, spans, err, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(span_type), intent(in) :: spans(:)               !< (n) places of the points in the file
    type(error_type), intent(inout) :: err                !< the failure
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the message
    type(span_type) :: span

    span = span_of(group, 'file', 1)
    if (allocated(err%failure)) then
      if (err%failure%kind == failure_sharp_curve) span = spans(err%failure%number)
    end if
    call explain(err)
    call diagnostics%add(span, err%message, err%code)
  end subroutine report_curve

  !> Length of the straight lines between points.
  pure real(wp) function length_of(points)
    real(wp), intent(in) :: points(:, :)   !< (3,n) [m]
    integer :: i

    length_of = 0.0_wp
    do i = 2, size(points, 2)
      length_of = length_of + norm2(points(:, i) - points(:, i - 1))
    end do
  end function length_of
end module mech9_pair_reader
