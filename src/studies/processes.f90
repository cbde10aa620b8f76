!> Processes that make the runs of a study, or the starts of a search, together. All read the same data file; the first one hands out
!> the work and writes the results. Which procedures stand behind these interfaces is decided by the linker: those of the library
!> serve a program that is alone, and those of src/programs/mpi replace them in programs with MPI.
module mech9_processes
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_simulation, only: interruption_type
  use mech9_study_runs, only: study_runs_type
  implicit none
  private
  public :: processes_type

  type :: processes_type
    logical :: is_first = .true.   !< this process hands out the work
    integer :: count = 1           !< how many there are
    integer :: agreements = 0      !< at how many points this process has agreed with the others
  contains
    procedure :: agree
    procedure :: lead
    procedure :: follow
  end type processes_type

  interface
    !> Learn whether all processes can go on. Every process calls it at the same two points: when it has read the data file, and
    !> before the first run or start.
    module subroutine agree(self, err)
      class(processes_type), intent(inout) :: self    !< the processes
      type(error_type), allocatable, intent(inout) :: err   !< allocated if this process cannot go on; afterwards if any cannot
    end subroutine agree

    !> Make all runs. The first process calls it; it hands out runs to the other processes.
    module subroutine lead(self, model, varied, threads, interruption, runs)
      class(processes_type), intent(in) :: self       !< the processes
      type(model_type), intent(in) :: model                 !< the model with the values of the data file
      class(variable_model_type), intent(in) :: varied      !< the model as a function of its parameters
      integer, intent(in) :: threads                        !< how many make the runs where there is one process
      class(interruption_type), intent(in) :: interruption  !< is asked whether a run shall stop
      type(study_runs_type), intent(inout) :: runs          !< about to begin
    end subroutine lead

    !> Make the runs that the first process hands out. All other processes call it.
    module subroutine follow(self, model, varied, interruption)
      class(processes_type), intent(in) :: self       !< the processes
      type(model_type), intent(in) :: model                 !< the model with the values of the data file
      class(variable_model_type), intent(in) :: varied      !< the model as a function of its parameters
      class(interruption_type), intent(in) :: interruption  !< is asked whether a run shall stop
    end subroutine follow
  end interface
end module mech9_processes
