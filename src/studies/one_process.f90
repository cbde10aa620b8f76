!> A process that is alone makes the runs of a study in threads.
submodule (mech9_processes) mech9_one_process
  use mech9_study_threads, only: make_in_threads
  implicit none

contains

  module subroutine agree(self, err)
    class(processes_type), intent(inout) :: self    !< the process
    type(error_type), allocatable, intent(inout) :: err   !< unchanged

    self%agreements = self%agreements + 1
  end subroutine agree

  module subroutine lead(self, model, varied, threads, interruption, runs)
    class(processes_type), intent(in) :: self       !< the process
    type(model_type), intent(in) :: model                 !< the model with the values of the data file
    class(variable_model_type), intent(in) :: varied      !< the model as a function of its parameters
    integer, intent(in) :: threads                        !< how many make the runs
    class(interruption_type), intent(in) :: interruption  !< is asked whether a run shall stop
    type(study_runs_type), intent(inout) :: runs          !< about to begin

    call make_in_threads(model, varied, threads, interruption, runs)
  end subroutine lead

  !> There is no other process to call it.
  module subroutine follow(self, model, varied, interruption)
    class(processes_type), intent(in) :: self       !< the process
    type(model_type), intent(in) :: model                 !< unused
    class(variable_model_type), intent(in) :: varied      !< unused
    class(interruption_type), intent(in) :: interruption  !< unused
  end subroutine follow
end submodule mech9_one_process
