!> The starts of a synthesis on the cores of one machine.
!>
!> Compiled without OpenMP, its directives are comments, and one thread makes all starts. The designs to which a start
!> leads depend on its number alone. They are added in the order of these numbers, so that the result does not depend on
!> the threads.
module mech9_start_threads
  use mech9_variable_model, only: variable_model_type
  use mech9_design_search, only: found_design_type
  use mech9_synthesis, only: synthesis_type
  use mech9_design_space, only: design_space_type
  use mech9_search_starts, only: search_starts_type, all_handed_out
  implicit none
  private
  public :: make_in_threads

  !> The tools of one thread.
  type :: searcher_type
    class(variable_model_type), allocatable :: variable
    type(design_space_type) :: space
  end type searcher_type

contains

  !> Make all starts that are missing, unless the user interrupts.
  subroutine make_in_threads(variable, synthesis, seed, threads, starts)
    class(variable_model_type), intent(in) :: variable     !< the model as a function of its parameters
    type(synthesis_type), intent(in) :: synthesis          !< prepared
    integer, intent(in) :: seed                            !< of the starts
    integer, intent(in) :: threads                         !< how many
    class(search_starts_type), intent(inout) :: starts     !< about to be made
    type(searcher_type), allocatable, target :: searchers(:)
    integer :: i

    allocate (searchers(min(threads, size(starts%made))))
    do i = 1, size(searchers)
      allocate (searchers(i)%variable, source=variable)
      searchers(i)%space = synthesis%space
      searchers(i)%space%variable => searchers(i)%variable
    end do
    !$omp parallel do num_threads(size(searchers)) schedule(static, 1) default(shared) private(i)
    do i = 1, size(searchers)
      call make_until_done(searchers(i), synthesis, seed, starts)
    end do
    !$omp end parallel do
  end subroutine make_in_threads

  !> Make one start after the other until all are handed out. One thread at a time asks for a number and gives its start back.
  subroutine make_until_done(searcher, synthesis, seed, starts)
    type(searcher_type), intent(inout), target :: searcher !< of this thread
    type(synthesis_type), intent(in) :: synthesis          !< of all threads
    integer, intent(in) :: seed                            !< of the starts
    class(search_starts_type), intent(inout) :: starts     !< of all threads
    type(found_design_type), allocatable :: found(:)
    integer :: number

    do
      !$omp critical (starts_of_synthesis)
      if (allocated(found)) call starts%take(number, found)
      number = starts%hand_out()
      !$omp end critical (starts_of_synthesis)
      if (number == all_handed_out) exit
      call synthesis%make_start(searcher%space, seed, number, found)
    end do
  end subroutine make_until_done
end module mech9_start_threads
