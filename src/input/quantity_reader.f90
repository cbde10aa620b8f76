!> Quantities of a run, its section, its exponents, periodic motions and branches, as groups of a checked document request them.
module mech9_quantity_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, group_or_empty, has_group, has_name, get_integer, get_logical, get_real, get_text, span_of
  use mech9_name_check, only: check_name
  use mech9_diagnostics, only: diagnostics_type
  use mech9_request, only: time_grid_type
  use mech9_quantity, only: quantity_type
  use mech9_long_term, only: section_type, exponents_type, periodic_type, branch_request_type
  implicit none
  private
  public :: read_quantities, read_section, read_exponents, read_periodic, read_branches

contains

  !> Read all groups &quantity. Their columns are looked for when these are known.
  pure subroutine read_quantities(document, time, quantities, diagnostics)
    type(document_type), intent(in) :: document                     !< the data file as groups and items
    type(time_grid_type), intent(in) :: time                        !< the times of the results
    type(quantity_type), allocatable, intent(out) :: quantities(:)  !< one for each sound group, in their order
    type(diagnostics_type), intent(inout) :: diagnostics            !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'quantity')
    allocate (quantities(size(numbers)))
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), quantity => quantities(i))
        quantity%name = get_text(group, 'name')
        quantity%column = get_text(group, 'of')
        quantity%take = get_text(group, 'take')
        quantity%place = diagnostics%place(span_of(group, 'of', 1))
        call check_name(group, quantity%name, diagnostics)
        if (quantity%take == 'at' .and. .not. has_name(group, 'at')) then
          call diagnostics%add(span_of(group, 'take', 1), 'take=''at'' needs ''at'': the time of the value')
        else if (quantity%take /= 'at' .and. has_name(group, 'at')) then
          call diagnostics%add(span_of(group, 'take', 1), '''at'' gives the time for take=''at'', and belongs to no other one')
        else if (has_name(group, 'at')) then
          quantity%at = get_real(group, 'at')
          if (quantity%at < min(time%start, time%end) .or. quantity%at > max(time%start, time%end)) &
            call diagnostics%add(span_of(group, 'at', 1), 'this time is not among those of the results, '// &
                                 to_text(time%start)//' to '//to_text(time%end)//' s')
        end if
      end associate
    end do
  end subroutine read_quantities

  !> Read the group &section. A column is looked for when the columns are known.
  pure subroutine read_section(document, mechanism, section, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs
    type(section_type), intent(out) :: section            !< the section; not wanted where there is no group
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(group_type) :: group

    group = group_or_empty(document, 'section')
    section%is_wanted = has_group(document, 'section')
    section%column = get_text(group, 'column')
    section%table = get_text(group, 'table')
    if (.not. section%is_wanted) return
    if (has_name(group, 'coordinate')) section%coordinate = get_integer(group, 'coordinate')
    if (has_name(group, 'period')) section%period = get_real(group, 'period')
    section%value = get_real(group, 'value')
    section%direction = get_integer(group, 'direction')
    section%every_turn = get_logical(group, 'every_turn')
    section%transient = get_real(group, 'transient')
    section%reduce_angles = get_logical(group, 'reduce_angles')
    section%place = diagnostics%place(group%span)
    if (has_name(group, 'column')) section%place = diagnostics%place(span_of(group, 'column', 1))
    if (count([has_name(group, 'coordinate'), has_name(group, 'column'), has_name(group, 'period')]) /= 1) &
      call diagnostics%add(group%span, 'a section needs one of coordinate=, column= and period=, to say where its points are')
    if (abs(section%direction) > 1) &
      call diagnostics%add(span_of(group, 'direction', 1), 'direction is 1 (the value grows), -1 (it falls) or 0 (both)')
    call check_names_of_section(group, section, mechanism, diagnostics)
  end subroutine read_section

  !> Report a coordinate that does not exist, and names that belong to another kind of section.
  pure subroutine check_names_of_section(group, section, mechanism, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(section_type), intent(in) :: section             !< the section
    type(mechanism_type), intent(in) :: mechanism         !< with its pairs
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=10), parameter :: of_value(3) = [character(len=10) :: 'value', 'direction', 'every_turn']
    logical :: turns
    integer :: i

    turns = .false.
    if (section%coordinate > size(mechanism%pairs) .and. size(mechanism%pairs) > 0) then
      call diagnostics%add(span_of(group, 'coordinate', 1), 'there is no coordinate '//to_text(section%coordinate)// &
                           '; the coordinates are 1 to '//to_text(size(mechanism%pairs)))
    else if (section%coordinate > 0 .and. size(mechanism%pairs) > 0) then
      if (allocated(mechanism%pairs(section%coordinate)%pair)) &
        turns = mechanism%pairs(section%coordinate)%pair%angular
    end if
    if (section%every_turn .and. .not. turns) &
      call diagnostics%add(span_of(group, 'every_turn', 1), 'every_turn belongs to a coordinate that turns; leave it out')
    if (.not. section%period > 0.0_wp) return
    do i = 1, size(of_value)
      if (has_name(group, trim(of_value(i)))) &
        call diagnostics%add(span_of(group, trim(of_value(i)), 1), 'the points of a period have no '//trim(of_value(i))// &
                             '; leave it out, or give coordinate= in place of period=')
    end do
  end subroutine check_names_of_section

  !> Read the group &exponents.
  pure subroutine read_exponents(document, exponents, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(exponents_type), intent(out) :: exponents        !< how they are found
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(group_type) :: group

    group = group_or_empty(document, 'exponents')
    if (.not. has_group(document, 'exponents')) return
    exponents%transient = get_real(group, 'transient')
    if (has_name(group, 'time')) exponents%time = get_real(group, 'time')
    exponents%place = diagnostics%place(group%span)
  end subroutine read_exponents

  !> Read the group &periodic.
  pure subroutine read_periodic(document, periodic, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(periodic_type), intent(out) :: periodic          !< how periodic motions are found
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(group_type) :: group

    group = group_or_empty(document, 'periodic')
    if (.not. has_group(document, 'periodic')) return
    if (has_name(group, 'period')) periodic%period = get_real(group, 'period')
    periodic%starts = get_integer(group, 'starts')
    periodic%place = diagnostics%place(group%span)
  end subroutine read_periodic

  !> Read all groups &branch. Their parameters are looked for when these are known.
  pure subroutine read_branches(document, branches, diagnostics)
    type(document_type), intent(in) :: document                         !< the data file as groups and items
    type(branch_request_type), allocatable, intent(out) :: branches(:)  !< one for each group, in their order
    type(diagnostics_type), intent(inout) :: diagnostics                !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'branch')
    allocate (branches(size(numbers)))
    do i = 1, size(numbers)
      associate (group => document%groups(numbers(i)), branch => branches(i))
        branch%parameter = get_text(group, 'parameter')
        branch%of = get_text(group, 'of')
        branch%has_low = has_name(group, 'low')
        branch%has_high = has_name(group, 'high')
        if (branch%has_low) branch%low = get_real(group, 'low')
        if (branch%has_high) branch%high = get_real(group, 'high')
        branch%step = get_real(group, 'step')
        branch%points = get_integer(group, 'points')
        branch%switch = get_logical(group, 'switch')
        branch%place = diagnostics%place(group%span)
        if (branch%has_low .and. branch%has_high .and. .not. branch%low < branch%high) &
          call diagnostics%add(span_of(group, 'high', 1), 'a branch needs high larger than low')
      end associate
    end do
  end subroutine read_branches
end module mech9_quantity_reader
