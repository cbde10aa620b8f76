!> The starts of a search, made by several processes together. All read the same data file; the first one hands out the starts and
!> writes the results. The linker decides which procedures stand behind these interfaces, as for the runs of a study
!> (src/studies/processes.f90).
module mech9_search_processes
  use mech9_variable_model, only: variable_model_type
  use mech9_synthesis, only: synthesis_type
  use mech9_search_starts, only: search_starts_type
  use mech9_processes, only: processes_type
  implicit none
  private
  public :: lead_search, follow_search

  interface
    !> Make all starts that are missing, unless the user interrupts. The first process calls it; it hands out starts to the others.
    module subroutine lead_search(processes, variable, synthesis, seed, threads, starts)
      type(processes_type), intent(in) :: processes          !< those that make the starts together
      class(variable_model_type), intent(in) :: variable     !< the model as a function of its parameters
      type(synthesis_type), intent(in) :: synthesis          !< prepared
      integer, intent(in) :: seed                            !< of the starts
      integer, intent(in) :: threads                         !< how many make the starts where there is one process
      class(search_starts_type), intent(inout) :: starts     !< about to be made
    end subroutine lead_search

    !> Make the starts that the first process hands out. All other processes call it.
    module subroutine follow_search(variable, synthesis, seed)
      class(variable_model_type), intent(in) :: variable     !< the model as a function of its parameters
      type(synthesis_type), intent(in) :: synthesis          !< prepared
      integer, intent(in) :: seed                            !< of the starts
    end subroutine follow_search
  end interface
end module mech9_search_processes
