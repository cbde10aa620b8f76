!> Processes that make the runs of a study together. All read the same data file; the first one hands out the runs and writes the
!> results.
module mech9_study_team
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_study_runs, only: study_runs_type
  implicit none
  private
  public :: study_team_type

  type, abstract :: study_team_type
    logical :: is_first = .true.   !< this process hands out the runs
    integer :: processes = 1       !< how many there are
  contains
    procedure(agree), deferred :: agree
    procedure(lead), deferred :: lead
    procedure(follow), deferred :: follow
  end type study_team_type

  abstract interface
    !> Learn whether all processes can go on. Every process calls it at the same two points: when it has read the data file, and
    !> before the first run.
    subroutine agree(self, code, err)
      import :: study_team_type, error_type
      class(study_team_type), intent(in) :: self           !< the processes
      integer, intent(in) :: code                          !< exit code that this process has to end with; 0: it can go on
      type(error_type), allocatable, intent(out) :: err    !< allocated if this process could go on, and another one cannot
    end subroutine agree

    !> Hand out runs to the other processes and make some, until all are made. The first process calls it.
    subroutine lead(self, model, varied, quiet, runs)
      import :: study_team_type, model_type, variable_model_type, study_runs_type
      class(study_team_type), intent(in) :: self            !< the processes
      type(model_type), intent(in) :: model                 !< the model with the values of the data file
      class(variable_model_type), intent(in) :: varied      !< the model as a function of its parameters
      logical, intent(in) :: quiet                          !< nothing is said of a run that takes long
      type(study_runs_type), intent(inout) :: runs          !< about to begin
    end subroutine lead

    !> Make the runs that the first process hands out. All other processes call it.
    subroutine follow(self, model, varied, quiet)
      import :: study_team_type, model_type, variable_model_type
      class(study_team_type), intent(in) :: self            !< the processes
      type(model_type), intent(in) :: model                 !< the model with the values of the data file
      class(variable_model_type), intent(in) :: varied      !< the model as a function of its parameters
      logical, intent(in) :: quiet                          !< nothing is said of a run that takes long
    end subroutine follow
  end interface
end module mech9_study_team
