!> The lines at the end of a run, for each kind of motion.
module mech9_run_text
  use mech9_free_simulation, only: free_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_run_outcome, only: run_outcome_type
  use mech9_driven_run_text, only: print_driven_run
  use mech9_free_run_text, only: print_free_run
  implicit none
  private
  public :: print_run

contains

  !> Print the lines of a motion.
  subroutine print_run(unit, motion, table_path, outcome)
    integer, intent(in) :: unit                           !< Fortran unit to write to
    type(model_motion_type), intent(inout) :: motion      !< the motion, as far as it went
    character(len=*), intent(in) :: table_path            !< path of the table; '-': standard output; empty: none
    type(run_outcome_type), intent(in) :: outcome         !< number of rows, and the times for solving and writing

    type(free_simulation_type), pointer :: free

    if (motion%is_free()) then
      free => motion%free()
      call print_free_run(unit, free, table_path, outcome)
    else
      call print_driven_run(unit, motion%driven(), table_path, outcome)
    end if
  end subroutine print_run
end module mech9_run_text
