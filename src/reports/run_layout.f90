!> A whole run as data sets: the content of its HDF5 file (docs/reference/results.md).
module mech9_run_layout
  use mech9_kinds, only: wp
  use mech9_facts, only: facts_type
  use mech9_model, only: model_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_run, only: run_type
  use mech9_column_sets, only: column_set_list_type, chunk_rows_for
  use mech9_row_layout, only: list_row_sets, put_row_scales, list_change_sets, put_change_scales, take_changes, write_events, &
    write_coefficients, most_changes
  use mech9_structure_layout, only: write_structure
  use mech9_force_layout, only: write_uniqueness
  use mech9_quantity_layout, only: write_quantities
  use mech9_section_layout, only: write_section
  use mech9_fact_layout, only: put_diagnostics
  use mech9_provenance_layout, only: origin_type, write_origin
  use mech9_data_set_table, only: data_set_table_type
  implicit none
  private
  public :: lay_out_run

contains

  !> Lay out a run that is over, in the order in which a program writes its file.
  subroutine lay_out_run(model, run, facts, exit_code, origin, table)
    type(model_type), intent(in) :: model                 !< the model
    type(run_type), intent(inout) :: run                  !< the run, as far as it went
    type(facts_type), intent(in) :: facts                 !< about the run
    integer, intent(in) :: exit_code                      !< of the run
    type(origin_type), intent(in) :: origin               !< of the results
    type(data_set_table_type), intent(out) :: table       !< the data sets
    type(column_set_list_type) :: list
    type(free_simulation_type), pointer :: free
    real(wp), allocatable :: rows(:, :)

    associate (source => run%source, output => model%request%output)
      call list_row_sets(model%mechanism, source%columns, list)
      call table%add_columns(list, chunk_rows_for(source%columns%width(), model%request%time%intervals + 1, output%compression), &
                             output%compression)
      call put_row_scales(table, model%mechanism, source%columns, list)
      call write_origin(table, model%mechanism%title, origin)
      call write_structure(table, model)
      call write_uniqueness(table, source%columns, source%forces)
      if (.not. source%quantities%is_empty()) call write_quantities(source%quantities, table, again=.false.)
    end associate
    call put_diagnostics(facts, table)
    call put_diagnostics(facts, table, exit_code)
    if (allocated(run%source%section)) call write_section(run%source%section, table)
    free => run%motion%free()
    if (.not. associated(free)) return
    call write_coefficients(table, run%motion%plan, free)
    associate (n => size(run%motion%plan%independent))
      call list_change_sets(n, list)
      call take_changes(free, rows)
      call table%add_rows(list, rows, most_changes)
      call put_change_scales(table, n, list)
    end associate
    call write_events(table, free)
  end subroutine lay_out_run
end module mech9_run_layout
