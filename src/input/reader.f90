!> The mechanism of a document, with all data checked.
module mech9_reader
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type
  use mech9_partition, only: partition_type
  use mech9_mechanism, only: mechanism_type
  use mech9_problem, only: problem_type
  use mech9_request, only: request_type, time_grid_type
  use mech9_model, only: model_type
  use mech9_document, only: document_type, group_type
  use mech9_checker, only: check_document
  use mech9_item_units, only: units_of_document
  use mech9_lookup, only: groups_named, group_or_empty, has_group, has_name, get_integer, get_integers, get_real, get_reals, &
    get_text, span_of
  use mech9_parameter_reader, only: read_parameters
  use mech9_formula_parameters, only: formula_parameters_type
  use mech9_structure_reader, only: read_structure
  use mech9_pair_reader, only: read_pairs
  use mech9_drive_reader, only: read_drives
  use mech9_drive_check, only: check_drives, check_motors
  use mech9_motion_reader, only: read_initial, read_points
  use mech9_coupling_reader, only: read_couplings
  use mech9_body_reader, only: read_bodies, read_gravity
  use mech9_load_reader, only: read_loads
  use mech9_stop_reader, only: read_stops
  use mech9_contact_reader, only: read_contacts
  use mech9_friction_reader, only: read_frictions
  use mech9_motor, only: motor_slot_type
  use mech9_motor_reader, only: read_motors
  use mech9_rod_holding, only: hold_idle_rods
  use mech9_output_reader, only: read_output, check_sensitivities, check_links
  use mech9_study_reader, only: read_study
  use mech9_quantity_reader, only: read_quantities, read_section, read_exponents, read_periodic, read_branches
  use mech9_objective_reader, only: read_objectives
  use mech9_limit_reader, only: read_limits
  use mech9_cam_reader, only: read_cams
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_structure_only, read_model, read_checked

  !> Largest data_tolerance [rad, parts of the mechanism's size]; a chain that stays open by more is not closed.
  real(wp), parameter :: largest_data_tolerance = 1.0e-3_wp

  !> More outputs than this would take years, and their numbers would not fit.
  integer, parameter :: most_intervals = 1000000000

contains

  !> The structure alone. The mechanism's geometry need not be given; whatever is given is checked
  !> against the grammar. Of use only where the diagnostics are without errors afterwards.
  pure subroutine read_structure_only(document, structure, partition, diagnostics)
    type(document_type), intent(in) :: document            !< the data file as groups and items
    type(structure_type), intent(out) :: structure         !< links and coordinates; of use only without errors
    type(partition_type), intent(out) :: partition         !< kinds of coordinates and their order; of use only without errors
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    type(document_type) :: checked
    logical :: known

    if (size(document%groups) == 0) return          ! the reason was reported when the file was read
    checked = document
    call check_document(checked, diagnostics)
    call read_structure(checked, structure, partition, known, diagnostics)
  end subroutine read_structure_only

  !> The model, in m, rad, kg, s. All errors are collected in the diagnostics, which may hold some from
  !> reading the document already; the model is of use only where there are none.
  subroutine read_model(document, program, model, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    integer, intent(in) :: program                        !< kinematics, where every independent coordinate must be driven, or dynamics
    type(model_type), intent(out) :: model                !< the mechanism, its problem, and the request for results
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(document_type) :: checked
    type(formula_parameters_type) :: formulas

    model%program = program
    if (size(document%groups) == 0) return          ! the reason was reported when the file was read
    checked = document
    call check_document(checked, diagnostics)
    call read_parameters(checked, model%parameters, diagnostics, formulas)
    model%formulas = formulas%results
    call read_checked(checked, model, diagnostics)
    if (.not. diagnostics%failed()) call hold_idle_rods(model)
    call read_study(checked, model%parameters, model%request%study, diagnostics)
    call read_objectives(checked, model, diagnostics)
    call read_limits(checked, model, diagnostics)
  end subroutine read_model

  !> The model of a document that is checked and in which the parameters have set their numbers; see read_model. Idle rods are not
  !> held yet. Motors are left out where all independent coordinates are driven.
  subroutine read_checked(document, model, diagnostics)
    type(document_type), intent(in) :: document           !< checked
    type(model_type), intent(inout) :: model              !< with its program and its parameters; gets all else
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(motor_slot_type), allocatable :: motors(:)
    logical :: known

    call read_settings(document, model%mechanism, diagnostics)
    call read_request(document, model%request, diagnostics)
    call read_structure(document, model%mechanism%structure, model%problem%partition, known, diagnostics)
    if (.not. known) call forget(model%mechanism%structure, model%problem%partition)
    if (has_name(group_or_empty(document, 'structure'), 'cq')) &
      model%problem%given = get_integers(group_or_empty(document, 'structure'), 'cq')
    model%mechanism%names = document%names
    if (known) call check_link_numbers(document, model%mechanism%structure%shown_links(), diagnostics)
    call read_parts(document, model%mechanism, model%problem, model%request, diagnostics)
    if (model%program == dynamics) then
      call read_motors(document, model%mechanism, motors, diagnostics)
      call move_alloc(motors, model%mechanism%motors)
    else if (.not. allocated(model%mechanism%motors)) then
      allocate (model%mechanism%motors(0))
    end if
    call check_drives(document, model, diagnostics)
    if (model%program == dynamics) call check_motors(document, model, diagnostics)
    call check_sensitivities(document, size(model%parameters), diagnostics)
  end subroutine read_checked

  !> Report names of links that do not exist.
  pure subroutine check_link_numbers(document, n_links, diagnostics)
    type(document_type), intent(in) :: document           !< checked
    integer, intent(in) :: n_links                        !< number of links that the user knows
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'link')
    do i = 1, size(numbers)
      if (get_integer(document%groups(numbers(i)), 'number') <= n_links) cycle
      call diagnostics%add(span_of(document%groups(numbers(i)), 'number', 1), 'there are '//to_text(n_links)//' links only')
    end do
  end subroutine check_link_numbers

  !> Set a structure and its partition to the form that means unknown: no links and no coordinates.
  pure subroutine forget(structure, partition)
    type(structure_type), intent(out) :: structure  !< gets no links and no coordinates
    type(partition_type), intent(out) :: partition  !< gets no coordinates

    allocate (structure%links(2, 0), partition%kind(0))
  end subroutine forget

  !> Read the groups whose numbers refer to the structure.
  subroutine read_parts(document, mechanism, problem, request, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(mechanism_type), intent(inout) :: mechanism      !< the mechanism, with its structure
    type(problem_type), intent(inout) :: problem          !< the problem, with its partition
    type(request_type), intent(inout) :: request          !< the request for results, with its times
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    associate (m => mechanism)
      call read_pairs(document, m, diagnostics)
      call read_initial(document, problem%partition, m%pairs, m%units, problem%initial, diagnostics)
      call read_couplings(document, problem%initial%position, m, diagnostics)
      call read_points(document, m%structure%shown_links(), m%points, diagnostics)
      call read_drives(document, m, request%time%start, problem%partition, problem%drives, diagnostics)
      call read_bodies(document, m%structure, m%pairs, m%bodies, diagnostics)
      m%gravity = read_gravity(document)
      call read_loads(document, m, diagnostics)
      call read_frictions(document, request%time, m, diagnostics)
      call read_stops(document, request%time, m, diagnostics)
      call read_contacts(document, request%time, m, diagnostics)
      call read_output(document, m%structure, request%output, diagnostics)
      call check_links(document, m, request%output, diagnostics)
      call read_quantities(document, request%time, request%quantities, diagnostics)
      call read_section(document, m, request%section, diagnostics)
      call read_exponents(document, request%exponents, diagnostics)
      call read_periodic(document, request%periodic, diagnostics)
      call read_branches(document, request%branches, diagnostics)
      call read_cams(document, m%structure, m%pairs, request%cams, diagnostics)
      call check_pairs_given(document, m, diagnostics)
    end associate
  end subroutine read_parts

  !> Report a mechanism without pairs: its structure may be known, but its geometry is not.
  pure subroutine check_pairs_given(document, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(mechanism_type), intent(in) :: mechanism         !< the mechanism
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)

    if (mechanism%structure%n_coordinates == 0 .or. has_group(document, 'pair')) return
    numbers = groups_named(document, 'structure')
    call diagnostics%add(document%groups(numbers(1))%span, 'there are no pairs; give a &pair for each coordinate '// &
                         '(--structure shows the structure alone)')
  end subroutine check_pairs_given

  !> Read the settings of the mechanism that do not refer to its structure: title, units, tolerance, and numbers of
  !> the user.
  pure subroutine read_settings(document, mechanism, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(mechanism_type), intent(inout) :: mechanism      !< the mechanism
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(group_type) :: group

    group = group_or_empty(document, 'mechanism')
    mechanism%title = get_text(group, 'title')
    mechanism%units = units_of_document(document)
    mechanism%data_tolerance = get_real(group, 'data_tolerance')
    if (mechanism%data_tolerance > largest_data_tolerance) &
      call diagnostics%add(span_of(group, 'data_tolerance', 1), 'data_tolerance is at most 1e-3: chains that are less exact '// &
                           'are not closed')
    group = group_or_empty(document, 'user')
    mechanism%parameters = get_reals(group, 'parameters')
    mechanism%procedures = document%procedures
  end subroutine read_settings

  !> Read the times of the results, and the settings of the solver.
  pure subroutine read_request(document, request, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(request_type), intent(inout) :: request          !< the request for results
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(group_type) :: group

    group = group_or_empty(document, 'solver')
    request%solver%method = get_text(group, 'method')
    request%solver%accuracy = get_real(group, 'accuracy')
    request%solver%relative_tolerance = get_real(group, 'relative_tolerance')
    request%solver%absolute_tolerance = get_real(group, 'absolute_tolerance')
    request%solver%maximum_steps = get_integer(group, 'maximum_steps')
    call read_time(group_or_empty(document, 'time'), request%time, diagnostics)
  end subroutine read_request

  !> Read the times of the results.
  pure subroutine read_time(group, time, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(time_grid_type), intent(out) :: time             !< the times of the results [s]
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (has_name(group, 'at')) then
      time%start = get_real(group, 'at')
      time%end = time%start
      time%intervals = 0
      return
    end if
    time%start = get_real(group, 'start')
    time%end = get_real(group, 'end')
    time%intervals = get_integer(group, 'intervals')
    if (time%intervals > most_intervals) &
      call diagnostics%add(span_of(group, 'intervals', 1), 'there are at most '//to_text(most_intervals)//' intervals')
    if (time%intervals == 0) then
      if (has_name(group, 'end') .and. abs(time%end - time%start) > 0.0_wp) &
        call diagnostics%add(span_of(group, 'intervals', 1), 'intervals=0 gives the start alone; leave ''end'' out, or give '// &
                             'at least one interval')
      time%end = time%start
    else if (.not. abs(time%end - time%start) > 0.0_wp) then
      call diagnostics%add(span_of(group, 'end', 1), 'the end is the same time as the start; for a single position give '// &
                           'intervals=0')
    end if
  end subroutine read_time
end module mech9_reader
