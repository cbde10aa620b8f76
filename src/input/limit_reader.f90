!> The groups &limit of a checked document: conditions that the designs of an optimisation must meet.
module mech9_limit_reader
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  use mech9_error, only: place_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, get_integer, get_real, get_text, span_of
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_objective, only: limit_type, quantity_limit, assembles_limit, crank_limit, transmission_limit
  use mech9_objective_reader, only: find_quantity
  implicit none
  private
  public :: read_limits

  real(wp), parameter :: right_angle = 0.5_wp*pi   !< [rad]

contains

  !> Read all groups &limit.
  subroutine read_limits(document, model, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(model_type), intent(inout) :: model              !< with mechanism, problem and quantities; gets the limits
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i, j

    numbers = groups_named(document, 'limit')
    allocate (model%request%limits(size(numbers)))
    if (diagnostics%failed()) return             ! quantities and coordinates may not be known
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), limit => model%request%limits(i))
        limit%place = diagnostics%place(group%span)
        select case (get_text(group, 'kind'))
        case ('quantity')
          call read_range(group, model, limit, diagnostics)
        case ('assembles')
          limit%kind = assembles_limit
        case ('crank')
          call read_crank(group, model, limit, diagnostics)
        case ('transmission')
          call read_transmission(group, model, limit, diagnostics)
        end select
        if (limit%kind /= quantity_limit) cycle
        do j = 1, i - 1
          call compare_ranges(group, model, model%request%limits(j), limit, diagnostics)
        end do
      end associate
    end do
  end subroutine read_limits

  !> Read the range of a quantity.
  pure subroutine read_range(group, model, limit, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the limit
    type(model_type), intent(in) :: model                 !< with the quantities
    type(limit_type), intent(inout) :: limit              !< gets the range
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    limit%kind = quantity_limit
    call find_quantity(group, model, limit%quantity, diagnostics)
    if (has_name(group, 'low')) limit%low = get_real(group, 'low')
    if (has_name(group, 'high')) limit%high = get_real(group, 'high')
    if (.not. (has_name(group, 'low') .or. has_name(group, 'high'))) then
      call diagnostics%add(span_of(group, 'kind', 1), 'a limit of a quantity needs ''low'', ''high'' or both')
    else if (limit%low > limit%high) then
      call diagnostics%add(span_of(group, 'high', 1), 'no value is at least '//to_text(limit%low)//' and at most '// &
                           to_text(limit%high)//'; exchange ''low'' and ''high''')
    else if (.not. limit%low < limit%high) then
      call diagnostics%add(span_of(group, 'high', 1), 'round-off would break a limit to one value; give a range, or an '// &
                           '&objective with this value as its ''goal''')
    end if
  end subroutine read_range

  !> Report two limits of one quantity that exclude each other.
  pure subroutine compare_ranges(group, model, other, limit, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the later limit
    type(model_type), intent(in) :: model                 !< with the quantities
    type(limit_type), intent(in) :: other                 !< the earlier limit
    type(limit_type), intent(in) :: limit                 !< the later limit
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the error
    type(place_type) :: there

    if (other%kind /= quantity_limit .or. other%quantity /= limit%quantity .or. limit%quantity == 0) return
    if (other%low > other%high .or. limit%low > limit%high) return     ! reported already
    if (max(other%low, limit%low) <= min(other%high, limit%high)) return
    there = other%place
    call diagnostics%add(span_of(group, 'of', 1), 'this limit and the one in line '//to_text(there%line)// &
                         ' exclude each other: no value of '''//model%request%quantities(limit%quantity)%name// &
                         ''' is in both ranges')
  end subroutine compare_ranges

  !> Read the coordinate that must turn fully: an angle that one drive moves.
  pure subroutine read_crank(group, model, limit, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the limit
    type(model_type), intent(in) :: model                 !< with the coordinates and drives
    type(limit_type), intent(inout) :: limit              !< gets the coordinate
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical :: exists
    integer :: i

    limit%kind = crank_limit
    call read_coordinate(group, model, limit, exists, diagnostics)
    if (.not. exists) return
    if (.not. model%mechanism%pairs(limit%coordinate)%pair%angular) then
      call diagnostics%add(span_of(group, 'coordinate', 1), 'coordinate '//to_text(limit%coordinate)// &
                           ' is a length, and only angles turn fully')
    else if (.not. any([(model%problem%drives(i)%drive%coordinate == limit%coordinate, i=1, size(model%problem%drives))])) then
      call diagnostics%add(span_of(group, 'coordinate', 1), 'the coordinate that turns fully must have a drive, and coordinate '// &
                           to_text(limit%coordinate)//' has none')
    end if
  end subroutine read_crank

  !> Read the least transmission angle.
  pure subroutine read_transmission(group, model, limit, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the limit
    type(model_type), intent(in) :: model                 !< with the coordinates
    type(limit_type), intent(inout) :: limit              !< gets coordinate and angle
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical :: exists

    limit%kind = transmission_limit
    call read_coordinate(group, model, limit, exists, diagnostics)
    limit%at_least = get_real(group, 'at_least')
    if (limit%at_least > right_angle*(1.0_wp + epsilon(1.0_wp))) &
      call diagnostics%add(span_of(group, 'at_least', 1), 'a transmission angle is at most a right angle, '// &
                           to_text(right_angle/model%mechanism%units%angle)//' in the unit of this file')
  end subroutine read_transmission

  !> Read the coordinate of a limit.
  pure subroutine read_coordinate(group, model, limit, exists, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the limit
    type(model_type), intent(in) :: model                 !< with the coordinates
    type(limit_type), intent(inout) :: limit              !< gets the coordinate
    logical, intent(out) :: exists                        !< the mechanism has it
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the error

    limit%coordinate = get_integer(group, 'coordinate')
    exists = limit%coordinate <= size(model%mechanism%pairs)
    if (.not. exists) call diagnostics%add(span_of(group, 'coordinate', 1), 'there is no coordinate '//to_text(limit%coordinate)// &
                                           '; there are q1 to q'//to_text(size(model%mechanism%pairs)))
  end subroutine read_coordinate
end module mech9_limit_reader
