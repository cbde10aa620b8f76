!> The report of a run, as JSON: how it ended and the work that it took (docs/reference/results.md).
module mech9_whole_report
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_json, only: json_type
  use mech9_facts, only: facts_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_driven_simulation, only: driven_simulation_type
  use mech9_impact_watcher, only: impact_watcher_type
  use mech9_units, only: units_type
  use mech9_result_units, only: impulse_unit_of
  use mech9_free_simulation, only: free_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_force_record, only: reacting_pairs
  use mech9_run, only: run_type
  use mech9_instant_report, only: add_instant, add_coefficients
  use mech9_periodic, only: periodic_found_type
  use mech9_periodic_report, only: add_periodic
  use mech9_report_parts, only: begin_report, add_structure, add_uniqueness
  implicit none
  private
  public :: compose_report

contains

  !> Compose the whole report of a run, with the structure.
  subroutine compose_report(json, model, diagnostics, table_path, facts, run, periodic)
    type(json_type), intent(inout) :: json                !< gets the report
    type(model_type), intent(in) :: model                 !< the model
    type(diagnostics_type), intent(in) :: diagnostics     !< messages and exit code of the run
    character(len=*), intent(in) :: table_path            !< path of the table; '-': standard output; empty: none
    type(facts_type), intent(in) :: facts                 !< about the run
    type(run_type), intent(inout) :: run                  !< the run, as far as it went
    type(periodic_found_type), intent(in), optional :: periodic   !< the periodic motions, of which the run records one
    type(driven_simulation_type), pointer :: driven
    type(free_simulation_type), pointer :: free

    call begin_report(json, model, diagnostics, table_path)
    call facts%to_json(json)
    driven => run%motion%driven()
    free => run%motion%free()
    if (associated(free)) call add_free(json, run%motion, free)
    if (.not. diagnostics%failed()) call add_instant(json, model, run)
    if (present(periodic)) call add_periodic(json, model%mechanism, periodic)
    call report_quantities(run%source%quantities, json)
    if (allocated(run%source%section)) then
      call json%begin_object('section')
      call json%add('points', run%source%section%count)
      call json%end_object()
    end if
    associate (forces => run%source%forces)
      if (allocated(forces%unique)) &
        call add_uniqueness(json, reacting_pairs(model), forces%unique, model%request%output%reactions_in_links)
    end associate
    if (associated(driven)) then
      ! only the blocks that are requested are executed
      call add_structure(json, model, driven%plan)
    else
      call add_structure(json, model, run%motion%plan)
    end if
    call json%end_object()
  end subroutine compose_report

  !> Add coefficients of motion and events to the report.
  subroutine add_free(json, motion, simulation)
    type(json_type), intent(inout) :: json                 !< the report, inside its object
    type(model_motion_type), intent(in) :: motion          !< the motion, as far as it went
    type(free_simulation_type), intent(in) :: simulation   !< its simulation

    call add_coefficients(json, simulation%model%mechanism, motion%plan%independent, simulation%coefficients)
    call add_coordinate_changes(json, simulation)
    call add_events(json, simulation)
  end subroutine add_free

  !> Add the changes of the independent coordinates, and of the angles that are integrated.
  subroutine add_coordinate_changes(json, simulation)
    type(json_type), intent(inout) :: json                 !< the report, inside its object
    type(free_simulation_type), intent(in) :: simulation   !< the motion, as far as it went
    integer :: i, k

    call json%begin_array('coordinate_changes')
    do i = 1, size(simulation%coordinate_changes)
      call json%begin_object()
      call json%add('t', simulation%coordinate_changes(i)%t)
      call json%begin_array('independent')
      do k = 1, size(simulation%coordinate_changes(i)%independent)
        call json%add(simulation%coordinate_changes(i)%independent(k))
      end do
      call json%end_array()
      call json%begin_array('replaced')
      do k = 1, size(simulation%coordinate_changes(i)%replaced)
        call json%add(simulation%coordinate_changes(i)%replaced(k))
      end do
      call json%end_array()
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_coordinate_changes

  !> Add the events: [{"time": 0.45, "kind": "impact", "group": "stop", "number": 1, "impulse": 0.9}, ...]. An event without an impulse
  !> has null there. With reactions, impacts have the impulses of pairs, too: "pairs": [{"pair": 1, "force": [..], "moment": [..]}, ...].
  subroutine add_events(json, simulation)
    type(json_type), intent(inout) :: json                   !< the report, inside its object
    class(free_simulation_type), intent(in) :: simulation    !< the motion, as far as it went
    integer :: i

    call json%begin_array('events')
    do i = 1, simulation%events%count
      associate (event => simulation%events%items(i))
        call json%begin_object()
        call json%add('time', event%t)
        call json%add('kind', trim(event%kind))
        call json%add('group', trim(event%group))
        call json%add('number', event%number)
        call json%add('impulse', merge(event%impulse/impulse_unit_of(simulation%model%mechanism, trim(event%group), event%number), &
                                       ieee_value(event%impulse, ieee_quiet_nan), event%has_impulse))
        if (event%has_impulse .and. allocated(simulation%impacts)) &
          call add_pairs(json, simulation%model%mechanism%units, simulation%impacts, event%t)
        call json%end_object()
      end associate
    end do
    call json%end_array()
  end subroutine add_events

  !> Add the impulses of pairs by the impacts of one time.
  subroutine add_pairs(json, units, impacts, t)
    type(json_type), intent(inout) :: json               !< the report, inside the object of an event
    type(units_type), intent(in) :: units                !< of the results
    class(impact_watcher_type), intent(in) :: impacts    !< the impulses of all impacts
    real(wp), intent(in) :: t                            !< the time [s]
    integer, allocatable :: pairs(:)
    real(wp), allocatable :: wrenches(:, :)
    integer :: i

    call impacts%show(t, pairs, wrenches)
    call json%begin_array('pairs')
    do i = 1, size(pairs)
      call json%begin_object()
      call json%add('pair', pairs(i))
      call json%add('force', wrenches(1:3, i)/units%force)
      call json%add('moment', wrenches(4:6, i)/(units%force*units%length))
      call json%end_object()
    end do
    call json%end_array()
  end subroutine add_pairs

  !> Write the quantities as a list in a report:
  !> [{"name": "stroke", "value": 0.6, "unit": "m", "gradient": [{"parameter": "crank", "value": 2.0}]}, ...]
  subroutine report_quantities(quantities, json)
    type(quantity_record_type), intent(in) :: quantities   !< of a run
    type(json_type), intent(inout) :: json                 !< the report, inside its object
    integer :: i, p

    if (quantities%is_empty()) return
    call json%begin_array('quantities')
    do i = 1, size(quantities%tracked)
      call json%begin_object()
      call json%add('name', quantities%quantities(i)%name)
      call json%add('value', quantities%numbers(i))
      call json%add('unit', quantities%unit_of(i))
      if (quantities%has_gradient()) call json%begin_array('gradient')
      do p = 1, size(quantities%gradient, 1)
        call json%begin_object()
        call json%add('parameter', quantities%columns%parameters(p)%text)
        call json%add('value', quantities%gradient(p, i))
        call json%end_object()
      end do
      if (quantities%has_gradient()) call json%end_array()
      call json%end_object()
    end do
    call json%end_array()
  end subroutine report_quantities
end module mech9_whole_report
