!> Settings of the group &output, checked.
module mech9_output_reader
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type
  use mech9_mechanism, only: mechanism_type
  use mech9_turning_plane, only: turning_plane_type, find_turning_plane
  use mech9_request, only: output_settings_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: group_or_empty, groups_named, has_group, has_unsound, get_integer, get_integers, get_logical, get_text, &
    has_name, span_of
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_output, check_sensitivities, check_links

contains

  !> Read which quantities are recorded and in which files; names not given have their defaults.
  pure subroutine read_output(document, structure, output, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(structure_type), intent(in) :: structure         !< links and joints; without coordinates where it is not known
    type(output_settings_type), intent(out) :: output     !< the settings, with defaults for those not given
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(group_type) :: group
    integer :: i, n_coordinates

    n_coordinates = structure%n_coordinates
    group = group_or_empty(document, 'output')
    output%table = get_text(group, 'table')
    output%hdf5 = get_text(group, 'hdf5')
    output%sketch = get_text(group, 'sketch')
    output%animation = get_text(group, 'animation')
    output%view = get_text(group, 'view')
    output%sketch_place = diagnostics%place(span_of(group, 'sketch', 1))
    output%animation_place = diagnostics%place(span_of(group, 'animation', 1))
    output%view_place = diagnostics%place(span_of(group, 'view', 1))
    output%poses = get_logical(group, 'poses')
    output%hdf5_runs = get_logical(group, 'hdf5_runs')
    output%compression = get_integer(group, 'compression')
    output%conditioning = get_logical(group, 'conditioning')
    output%coordinates = get_integers(group, 'coordinates')
    output%derivatives = get_integer(group, 'derivatives')
    output%energies = get_logical(group, 'energies')
    output%reaction_pairs = get_integers(group, 'reaction_pairs')
    output%reactions = get_logical(group, 'reactions') .or. size(output%reaction_pairs) > 0
    if (has_name(group, 'reactions') .and. .not. get_logical(group, 'reactions') .and. size(output%reaction_pairs) > 0) &
      call diagnostics%add(span_of(group, 'reaction_pairs'), 'reactions=.false. contradicts reaction_pairs; leave one of them out')
    output%drive_forces = get_logical(group, 'drive_forces')
    output%force_arrows = get_logical(group, 'force_arrows')
    output%velocity_arrows = get_logical(group, 'velocity_arrows')
    output%acceleration_arrows = get_logical(group, 'acceleration_arrows')
    output%links = get_integers(group, 'links')
    output%poles = get_integers(group, 'poles')
    output%reaction_magnitudes = get_logical(group, 'reaction_magnitudes')
    output%reactions_in_links = get_text(group, 'reaction_axes') == 'link'
    call check_wrenches(group, output, diagnostics)
    output%sensitivities = get_logical(group, 'sensitivities')
    output%gradients = get_logical(group, 'gradients')
    if (output%gradients) output%sensitivities_place = diagnostics%place(span_of(group, 'gradients', 1))
    if (output%sensitivities) output%sensitivities_place = diagnostics%place(span_of(group, 'sensitivities', 1))
    if (output%compression > 9) &
      call diagnostics%add(span_of(group, 'compression', 1), 'compression goes from 0 (none) to 9 (the smallest file)')
    if (output%derivatives > 2) call diagnostics%add(span_of(group, 'derivatives', 1), 'derivatives is 0 (positions), '// &
                                                     '1 (velocities too) or 2 (accelerations too)')
    if (n_coordinates == 0) return
    call check_coordinates(group, 'coordinates', 'coordinate', n_coordinates, output%coordinates, diagnostics)
    call check_coordinates(group, 'reaction_pairs', 'pair', n_coordinates, output%reaction_pairs, diagnostics)
    do i = 1, size(output%reaction_pairs)
      associate (k => output%reaction_pairs(i))
        if (k > n_coordinates) cycle
        if (structure%first_of_joint(k) == k) cycle
        call diagnostics%add(span_of(group, 'reaction_pairs', i), 'coordinate '//to_text(k)//' is no pair of its own; name the '// &
                             'first coordinate of its joint, '//to_text(structure%first_of_joint(k)))
      end associate
    end do
  end subroutine read_output

  !> Report a form of wrenches that are not recorded.
  pure subroutine check_wrenches(group, output, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(output_settings_type), intent(in) :: output      !< the settings
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=19), parameter :: forms(2) = [character(len=19) :: 'reaction_magnitudes', 'reaction_axes']
    logical :: asked(2)
    integer :: i

    if (output%reactions) return
    asked = [output%reaction_magnitudes, output%reactions_in_links]
    do i = 1, size(forms)
      if (.not. asked(i)) cycle
      call diagnostics%add(span_of(group, trim(forms(i)), 1), trim(forms(i))//' is a form of the forces in pairs, which are '// &
                           'not recorded; set reactions=.true., too')
    end do
  end subroutine check_wrenches

  !> Report links whose turning motion is recorded that do not exist or do not move, and poles that do not exist.
  pure subroutine check_links(document, mechanism, output, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism, with its pairs
    type(output_settings_type), intent(inout) :: output   !< the settings; links in error are left out
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(group_type) :: group
    type(turning_plane_type) :: plane
    integer :: n

    group = group_or_empty(document, 'output')
    n = mechanism%structure%shown_links()
    call keep_moving(group, 'links', n, output%links, diagnostics)
    call keep_moving(group, 'poles', n, output%poles, diagnostics)
    if (size(output%poles) == 0 .or. diagnostics%failed()) return
    if (output%derivatives == 0) call diagnostics%add(span_of(group, 'poles', 1), 'poles follow from velocities; set '// &
                                                      'derivatives=1 or 2')
    call find_turning_plane(mechanism%structure, mechanism%pairs, plane)
    if (plane%found) return
    if (plane%pair == 0) then
      call diagnostics%add(span_of(group, 'poles', 1), 'a link has a velocity pole where it turns in a plane; '// &
                           'no pair of this mechanism is revolute')
    else
      call diagnostics%add(span_of(group, 'poles', 1), 'links have velocity poles where all move in one plane; pair '// &
                           to_text(plane%barrier)//' leaves the plane across the axis of pair '//to_text(plane%pair)// &
                           '; leave poles out')
    end if
  end subroutine check_links

  !> Report links that do not exist, do not move or are named twice, and leave them out.
  pure subroutine keep_moving(group, name, n_links, links, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: name                  !< of the item with their numbers
    integer, intent(in) :: n_links                        !< how many links there are; 0: that is not known
    integer, allocatable, intent(inout) :: links(:)       !< their numbers
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i

    do i = 1, size(links)
      if (n_links == 0) exit
      if (links(i) > n_links) then
        call diagnostics%add(span_of(group, name, i), 'there is no link '//to_text(links(i))//'; they are 1 to '//to_text(n_links))
      else if (links(i) == 1) then
        call diagnostics%add(span_of(group, name, i), 'link 1 is the frame, which does not move; name other links')
      else if (any(links(:i - 1) == links(i))) then
        call diagnostics%add(span_of(group, name, i), 'link '//to_text(links(i))//' is there already')
      end if
    end do
    links = pack(links, links > 1 .and. links <= n_links)
  end subroutine keep_moving

  !> Report sensitivities and gradients without a parameter or without a quantity.
  pure subroutine check_sensitivities(document, n_parameters, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: n_parameters                   !< how many parameters the data file has
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=13), parameter :: requests(2) = ['sensitivities', 'gradients    ']
    type(group_type) :: group
    integer, allocatable :: quantities(:)
    integer :: i

    group = group_or_empty(document, 'output')
    quantities = groups_named(document, 'quantity')
    do i = 1, size(requests)
      if (.not. get_logical(group, trim(requests(i)))) cycle
      if (n_parameters == 0 .and. has_unsound(document, 'parameter')) then
        cycle
      else if (n_parameters == 0) then
        call diagnostics%add(span_of(group, trim(requests(i)), 1), trim(requests(i))//' are derivatives by the parameters, '// &
                             trim(merge('and all of them have formulas; give one a value     ', &
                                        'and there are none; give a group &parameter for each', has_group(document, 'parameter'))))
      else if (i == 2 .and. size(quantities) == 0) then
        call diagnostics%add(span_of(group, trim(requests(i)), 1), 'gradients are derivatives of the quantities, '// &
                             'and there are none; give a group &quantity for each')
      end if
    end do
    if (.not. (get_logical(group, 'sensitivities') .or. get_logical(group, 'gradients'))) return
    do i = 1, size(quantities)
      if (get_text(document%groups(quantities(i)), 'name') == 'gradient') &
        call diagnostics%add(span_of(document%groups(quantities(i)), 'name', 1), 'the derivatives of quantities have the '// &
                             'name ''gradient'' in the HDF5 file; choose another name')
    end do
  end subroutine check_sensitivities

  !> Report recorded coordinates, or pairs, that do not exist or are named twice.
  pure subroutine check_coordinates(group, name, counted, n_coordinates, coordinates, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: name                  !< of the item with their numbers
    character(len=*), intent(in) :: counted               !< 'coordinate' or 'pair'
    integer, intent(in) :: n_coordinates                  !< how many coordinates there are
    integer, intent(in) :: coordinates(:)                 !< numbers of the recorded coordinates
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i

    do i = 1, size(coordinates)
      if (coordinates(i) > n_coordinates) then
        call diagnostics%add(span_of(group, name, i), 'there is no '//counted//' '//to_text(coordinates(i))// &
                             '; they are 1 to '//to_text(n_coordinates))
      else if (any(coordinates(:i - 1) == coordinates(i))) then
        call diagnostics%add(span_of(group, name, i), counted//' '//to_text(coordinates(i))//' is there already')
      end if
    end do
  end subroutine check_coordinates
end module mech9_output_reader
