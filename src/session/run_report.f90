!> The report of a run: a few lines for a person, and data sets for programs. Each kind of motion has its own.
module mech9_run_report
  use mech9_hdf5_sink, only: hdf5_sink_type
  use mech9_model_motion, only: model_motion_type
  use mech9_run_outcome, only: run_outcome_type
  implicit none
  private
  public :: run_report_type

  type, abstract :: run_report_type
  contains
    procedure(print_interface), deferred, nopass :: print
    procedure, nopass :: write_start => write_nothing
    procedure, nopass :: write_end => write_nothing
  end type run_report_type

  abstract interface
    !> Print the short report of a run.
    subroutine print_interface(unit, motion, table_path, outcome)
      import :: model_motion_type, run_outcome_type
      integer, intent(in) :: unit                             !< Fortran unit to write to
      type(model_motion_type), intent(inout) :: motion        !< the motion, as far as it went
      character(len=*), intent(in) :: table_path              !< path of the table; '-': standard output; empty: none
      type(run_outcome_type), intent(in) :: outcome     !< number of rows, and the times for solving and writing
    end subroutine print_interface
  end interface

contains

  !> Write data sets at the start of a run, or at its end.
  subroutine write_nothing(hdf5, motion)
    type(hdf5_sink_type), intent(inout) :: hdf5         !< the open file of results
    type(model_motion_type), intent(inout) :: motion    !< the motion, as far as it went
  end subroutine write_nothing
end module mech9_run_report
