!> A study as a program carries it out: its files, its runs, and the scatter of its quantities by derivatives.
!>
!> It hands on the processes and the numbers of threads by which studies and searches are made.
module mech9_kept_study
  use mech9_error, only: error_type
  use mech9_simulation, only: interruption_type
  use mech9_processes, only: processes_type
  use mech9_study_runs, only: study_runs_type
  use mech9_study_propagation, only: propagation_type, propagate
  use mech9_study_threads, only: threads_of_machine, threads_for, has_threads
  use mech9_json, only: json_type
  use mech9_report_parts, only: begin_report
  use mech9_study_report, only: add_study
  use mech9_data_file, only: data_file_type
  use mech9_study_results, only: study_results_type
  implicit none
  private
  public :: kept_study_type, processes_type, threads_of_machine, threads_for, has_threads

  !> How many runs for each thread may be made before one that takes long is written.
  integer, parameter :: runs_ahead = 64

  !> It must not be copied.
  type :: kept_study_type
    type(study_results_type) :: results                      !< its files, and its section where it has one
    type(study_runs_type) :: runs                            !< sums and statistics of the runs
    type(propagation_type), allocatable :: propagation(:)    !< (quantities) scatter to first order; none where it was not found
    type(error_type), allocatable :: without_shares          !< the failure by which it was not found
  contains
    procedure :: make
    procedure :: has_scatter
    procedure :: find_scatter
    procedure :: save_report
  end type kept_study_type

contains

  !> Make the runs that are missing, and close the files. Fails with exit_interrupted where the study is stopped, and with
  !> exit_file where runs cannot be kept.
  subroutine make(self, given, processes, threads, with_sample, interruption, err)
    class(kept_study_type), intent(inout), target :: self    !< with its open files
    type(data_file_type), intent(inout) :: given             !< the data file, with its variable model
    type(processes_type), intent(in) :: processes            !< those that make the runs together; this one is the first of them
    integer, intent(in) :: threads                           !< how many make the runs where there is one process
    logical, intent(in) :: with_sample                       !< a sample of the runs is kept for plots
    class(interruption_type), intent(in) :: interruption     !< is asked whether the study shall stop
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed

    allocate (self%propagation(0))
    call self%runs%begin(given%model, self%results, runs_ahead*max(threads, processes%count), with_sample, interruption)
    call processes%lead(given%model, given%variable, threads, interruption, self%runs)
    call self%runs%finish(err)
  end subroutine make

  !> Whether quantities scatter since values were drawn, so that shares by derivatives can be found.
  pure logical function has_scatter(self, given)
    class(kept_study_type), intent(in) :: self     !< made
    type(data_file_type), intent(in) :: given      !< the data file

    associate (study => given%model%request%study)
      has_scatter = .not. (study%classes .or. study%exponents > 0) .and. self%runs%statistics%drawn .and. self%runs%sums%done > 0
    end associate
  end function has_scatter

  !> Find the scatter of the quantities by derivatives at the means of the parameters; the failure is kept where there are none.
  subroutine find_scatter(self, given, interruption)
    class(kept_study_type), intent(inout) :: self                     !< made
    type(data_file_type), intent(inout) :: given                      !< the data file, with its variable model
    class(interruption_type), intent(inout), target :: interruption   !< is asked whether the run at the means shall stop

    call propagate(given%model, given%variable, interruption, self%propagation, self%without_shares)
  end subroutine find_scatter

  !> Save the report.
  subroutine save_report(self, path, given, err)
    class(kept_study_type), intent(in) :: self            !< made
    character(len=*), intent(in) :: path                  !< of the report
    type(data_file_type), intent(in) :: given             !< the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if it cannot be written
    type(json_type) :: json

    call begin_report(json, given%model, given%diagnostics, self%results%wanted%table)
    call add_study(json, given%model, given%quantities, self%runs, self%propagation)
    call json%end_object()
    call json%save(path, err)
  end subroutine save_report
end module mech9_kept_study
