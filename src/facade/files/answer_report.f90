!> Reports of runs and of answers in place of a run, as JSON.
module mech9_answer_report
  use mech9_error, only: error_type
  use mech9_json, only: json_type
  use mech9_facts, only: facts_type
  use mech9_report_parts, only: begin_report, add_uniqueness, save_short_report
  use mech9_branches_report, only: add_branches
  use mech9_equilibria_report, only: add_equilibria
  use mech9_exponents_report, only: add_exponents
  use mech9_whole_report, only: compose_report
  use mech9_data_file, only: data_file_type
  use mech9_recorded_branches, only: recorded_branches_type
  use mech9_recorded_exponents, only: recorded_exponents_type
  use mech9_recorded_rest, only: rest_of_file_type
  implicit none
  private
  public :: begin_answer_report, save_branches_report, save_exponents_report, save_rest_report, save_run_report, save_failure_report

contains

  !> Begin a report: the program, the mechanism, the exit code and the errors.
  subroutine begin_answer_report(json, given, table)
    type(json_type), intent(inout) :: json                  !< gets the beginning, inside its object
    type(data_file_type), intent(in) :: given               !< the data file
    character(len=*), intent(in) :: table                   !< path of the table; '-' is standard output; empty: none

    call begin_report(json, given%model, given%diagnostics, table)
  end subroutine begin_answer_report

  !> Save the report of branches.
  subroutine save_branches_report(path, given, table, found, err)
    character(len=*), intent(in) :: path                    !< of the report
    type(data_file_type), intent(in) :: given               !< the data file
    character(len=*), intent(in) :: table                   !< path of the table; '-' is standard output; empty: none
    type(recorded_branches_type), intent(in) :: found       !< the branches; without any after a failure
    type(error_type), allocatable, intent(out) :: err       !< allocated if it cannot be written
    type(json_type) :: json

    call begin_answer_report(json, given, table)
    call add_branches(json, found%branches_found_type)
    call json%end_object()
    call json%save(path, err)
  end subroutine save_branches_report

  !> Save the report of exponents.
  subroutine save_exponents_report(path, given, table, found, err)
    character(len=*), intent(in) :: path                    !< of the report
    type(data_file_type), intent(in) :: given               !< the data file
    character(len=*), intent(in) :: table                   !< path of the table; '-' is standard output; empty: none
    type(recorded_exponents_type), intent(in) :: found      !< the exponents; without them after a failure
    type(error_type), allocatable, intent(out) :: err       !< allocated if it cannot be written
    type(json_type) :: json

    call begin_answer_report(json, given, table)
    call add_exponents(json, found%exponents_found_type)
    call json%end_object()
    call json%save(path, err)
  end subroutine save_exponents_report

  !> Save the report of equilibria.
  subroutine save_rest_report(path, given, table, rest, with_modes, err)
    character(len=*), intent(in) :: path                    !< of the report
    type(data_file_type), intent(in) :: given               !< the data file
    character(len=*), intent(in) :: table                   !< path of the table; '-' is standard output; empty: none
    type(rest_of_file_type), intent(in) :: rest             !< the equilibria; none after an error
    logical, intent(in) :: with_modes                       !< modes are wanted
    type(error_type), allocatable, intent(out) :: err       !< allocated if it cannot be written
    type(json_type) :: json

    call begin_answer_report(json, given, table)
    call add_equilibria(json, rest%rest_type, with_modes)
    if (allocated(rest%forces%unique)) &
      call add_uniqueness(json, given%reacting_pairs(), rest%forces%unique, given%model%request%output%reactions_in_links)
    call json%end_object()
    call json%save(path, err)
  end subroutine save_rest_report

  !> Save the report of a run.
  subroutine save_run_report(path, given, table, facts, err)
    character(len=*), intent(in) :: path                    !< of the report
    type(data_file_type), intent(inout) :: given            !< the data file, with its run as far as it went
    character(len=*), intent(in) :: table                   !< path of the table; '-' is standard output; empty: none
    type(facts_type), intent(in) :: facts                   !< about the run
    type(error_type), allocatable, intent(out) :: err       !< allocated if it cannot be written
    type(json_type) :: json

    call compose_report(json, given%model, given%diagnostics, table, facts, given%run, given%periodic)
    call json%save(path, err)
  end subroutine save_run_report

  !> Save the report of a program that made no run, because of an option such as --check or because of an error.
  subroutine save_failure_report(path, given, code, err)
    character(len=*), intent(in) :: path                    !< of the report
    class(data_file_type), intent(in) :: given              !< the data file, as far as it was read
    integer, intent(in) :: code                             !< exit code of the program
    type(error_type), allocatable, intent(out) :: err       !< allocated if it cannot be written

    call save_short_report(path, given%model, code, given%choice, given%diagnostics, err)
  end subroutine save_failure_report
end module mech9_answer_report
