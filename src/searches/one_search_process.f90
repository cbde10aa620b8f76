!> A process that is alone makes the starts of a search in threads.
submodule (mech9_search_processes) mech9_one_search_process
  use mech9_start_threads, only: make_in_threads
  implicit none

contains

  module subroutine lead_search(processes, variable, synthesis, seed, threads, starts)
    type(processes_type), intent(in) :: processes          !< unused: there is one
    class(variable_model_type), intent(in) :: variable     !< the model as a function of its parameters
    type(synthesis_type), intent(in) :: synthesis          !< prepared
    integer, intent(in) :: seed                            !< of the starts
    integer, intent(in) :: threads                         !< how many make the starts
    class(search_starts_type), intent(inout) :: starts     !< about to be made

    call make_in_threads(variable, synthesis, seed, threads, starts)
  end subroutine lead_search

  !> There is no other process to call it.
  module subroutine follow_search(variable, synthesis, seed)
    class(variable_model_type), intent(in) :: variable     !< unused
    type(synthesis_type), intent(in) :: synthesis          !< unused
    integer, intent(in) :: seed                            !< unused
  end subroutine follow_search
end submodule mech9_one_search_process
