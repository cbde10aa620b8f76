!> The starts of a synthesis on the cores of one machine.
!>
!> Compiled without OpenMP, its directives are comments, and one thread makes all starts. The designs to which a start leads depend on
!> its number alone, and are added in the order of these numbers, so that the result does not depend on the threads.
module mech9_start_threads
  use mech9_kinds, only: wp
  use mech9_system, only: interrupted
  use mech9_variable_model, only: variable_model_type
  use mech9_progress, only: progress_type
  use mech9_design_search, only: found_design_type
  use mech9_synthesis, only: synthesis_type
  use mech9_design_space, only: design_space_type
  implicit none
  private
  public :: make_in_threads

  !> The tools of one thread.
  type :: searcher_type
    class(variable_model_type), allocatable :: variable
    type(design_space_type) :: space
  end type searcher_type

  !> The designs to which a start led; none are allocated before it is made.
  type :: start_type
    type(found_design_type), allocatable :: found(:)
  end type start_type

contains

  !> Make all starts, unless the user interrupts.
  subroutine make_in_threads(variable, synthesis, seed, n_starts, threads, progress)
    class(variable_model_type), intent(in) :: variable     !< the model as a function of its parameters
    type(synthesis_type), intent(inout) :: synthesis       !< gets the optima
    integer, intent(in) :: seed                            !< of the starts
    integer, intent(in) :: n_starts                        !< how many
    integer, intent(in) :: threads                         !< how many
    type(progress_type), intent(inout) :: progress         !< of the search
    type(searcher_type), allocatable, target :: searchers(:)
    type(start_type), allocatable :: starts(:)
    integer :: i, next

    allocate (searchers(min(threads, n_starts)), starts(n_starts))
    do i = 1, size(searchers)
      allocate (searchers(i)%variable, source=variable)
      searchers(i)%space = synthesis%space
      searchers(i)%space%variable => searchers(i)%variable
    end do
    next = 1
    !$omp parallel do num_threads(size(searchers)) schedule(static, 1) default(shared) private(i)
    do i = 1, size(searchers)
      call make_until_done(searchers(i), synthesis, seed, starts, next, progress)
    end do
    !$omp end parallel do
    do i = 1, n_starts
      if (allocated(starts(i)%found)) call synthesis%add(i, starts(i)%found)
    end do
  end subroutine make_in_threads

  !> Make one start after the other until all are taken.
  subroutine make_until_done(searcher, synthesis, seed, starts, next, progress)
    type(searcher_type), intent(inout), target :: searcher !< of this thread
    type(synthesis_type), intent(in) :: synthesis          !< of all threads
    integer, intent(in) :: seed                            !< of the starts
    type(start_type), intent(inout) :: starts(:)           !< each is written by the thread that makes it
    integer, intent(inout) :: next                         !< number of the next start that no thread has taken
    type(progress_type), intent(inout) :: progress         !< of the search
    integer :: number

    do
      !$omp critical (starts_of_synthesis)
      number = next
      if (interrupted()) number = size(starts) + 1
      next = number + 1
      call progress%update(real(min(number, size(starts)), wp)/size(starts))
      !$omp end critical (starts_of_synthesis)
      if (number > size(starts)) exit
      call synthesis%make_start(searcher%space, seed, number, starts(number)%found)
    end do
  end subroutine make_until_done
end module mech9_start_threads
