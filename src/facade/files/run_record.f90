!> The HDF5 file of a run: the data sets beside its rows.
module mech9_run_record
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_facts, only: facts_type
  use mech9_hdf5_sink, only: hdf5_sink_type
  use mech9_force_layout, only: write_uniqueness
  use mech9_quantity_layout, only: write_quantities
  use mech9_row_layout, only: write_coefficients, take_changes, write_events
  use mech9_section_layout, only: write_section
  use mech9_structure_layout, only: write_structure
  use mech9_run_facts, only: list_run_facts
  use mech9_data_file, only: data_file_type
  use mech9_hdf5_record, only: write_provenance
  implicit none
  private
  public :: write_run_origin, begin_run_record, begin_free_record, end_free_record, end_run_record, list_facts

contains

  !> Write the origin of the numbers, and the structure.
  subroutine write_run_origin(hdf5, given, err)
    type(hdf5_sink_type), intent(inout) :: hdf5         !< the open file of results
    type(data_file_type), intent(in) :: given           !< the data file
    type(error_type), allocatable, intent(out) :: err   !< allocated if the file cannot be written

    call write_provenance(hdf5%file, given)
    call write_structure(hdf5%file, given%model)
    call hdf5%tell(err)
  end subroutine write_run_origin

  !> Write the components of forces that are unique, and make data sets for quantities.
  subroutine begin_run_record(hdf5, given)
    type(hdf5_sink_type), intent(inout) :: hdf5         !< the open file of results
    type(data_file_type), intent(in) :: given           !< the data file, with its run

    associate (source => given%run%source)
      call write_uniqueness(hdf5%file, source%columns, source%forces)
      if (.not. source%quantities%is_empty()) call write_quantities(source%quantities, hdf5%file, again=.false.)
    end associate
  end subroutine begin_run_record

  !> Write the coefficients of a free motion as data sets, and make data sets for changes of coordinates. A driven motion has none.
  subroutine begin_free_record(hdf5, given)
    type(hdf5_sink_type), intent(inout) :: hdf5               !< the open file of results
    type(data_file_type), intent(inout), target :: given      !< the data file, with a motion that is prepared

    if (.not. given%run%motion%is_free()) return
    call write_coefficients(hdf5%file, given%run%motion%plan, given%run%motion%free())
    call hdf5%begin_changes(size(given%run%motion%plan%independent))
  end subroutine begin_free_record

  !> Write the changes of the independent coordinates and the events of a free motion as data sets.
  subroutine end_free_record(hdf5, given)
    type(hdf5_sink_type), intent(inout) :: hdf5               !< the open file of results
    type(data_file_type), intent(inout), target :: given      !< the data file, with a motion as far as it went
    real(wp), allocatable :: rows(:, :)

    if (.not. given%run%motion%is_free()) return
    call take_changes(given%run%motion%free(), rows)
    call hdf5%write_changes(rows)
    call write_events(hdf5%file, given%run%motion%free())
  end subroutine end_free_record

  !> Write the quantities, and the points of the section where there is one.
  subroutine end_run_record(hdf5, given)
    type(hdf5_sink_type), intent(inout) :: hdf5         !< the open file of results
    type(data_file_type), intent(in) :: given           !< the data file, with its run as far as it went

    associate (source => given%run%source)
      if (.not. source%quantities%is_empty()) call write_quantities(source%quantities, hdf5%file, again=.true.)
      if (allocated(source%section)) call write_section(source%section, hdf5%file)
    end associate
  end subroutine end_run_record

  !> List the facts about a run.
  subroutine list_facts(given, facts)
    type(data_file_type), intent(inout) :: given        !< the data file, with its run as far as it went
    type(facts_type), intent(out) :: facts              !< named numbers and texts

    call list_run_facts(given%run%motion, given%outcome, facts)
  end subroutine list_facts
end module mech9_run_record
