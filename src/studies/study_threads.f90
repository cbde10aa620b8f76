!> The making of the runs of a study on the cores of one machine.
!>
!> OpenMP is known here and in the starts of a synthesis alone. Compiled without, its directives are comments, and one thread makes all runs.
module mech9_study_threads
  !$ use omp_lib, only: omp_get_max_threads
  use mech9_kinds, only: wp
  use mech9_pause, only: pause_for
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_user_calls, only: calls_user_procedures
  use mech9_simulation, only: interruption_type
  use mech9_run_maker, only: run_maker_type, made_run_type, most_runs
  use mech9_study_runs, only: study_runs_type, all_handed_out, wait_for_others
  implicit none
  private
  public :: make_in_threads, threads_of_machine, threads_for, has_threads

  !> Time after which a thread asks again where it has to wait for others [s].
  real(wp), parameter :: short_wait = 0.001_wp

contains

  !> Whether this program was built with threads.
  pure logical function has_threads()
    has_threads = .false.
    !$ has_threads = .true.
  end function has_threads

  !> How many threads this machine is to make: one for each core that the program may use, or what OMP_NUM_THREADS tells.
  integer function threads_of_machine() result(threads)
    threads = 1
    !$ threads = omp_get_max_threads()
  end function threads_of_machine

  !> How many threads a model bears: those of the machine, or one, since a user's procedures may keep numbers from call to call.
  integer function threads_for(model) result(threads)
    type(model_type), intent(in) :: model   !< the model

    threads = threads_of_machine()
    if (calls_user_procedures(model)) threads = 1
  end function threads_for

  !> Make all runs. Each thread takes the next one when it has finished one, so that none waits for runs that take long.
  subroutine make_in_threads(model, varied, threads, interruption, runs)
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    class(variable_model_type), intent(in) :: varied        !< the model as a function of its parameters
    integer, intent(in) :: threads                          !< how many
    class(interruption_type), intent(in) :: interruption    !< is asked whether a run shall stop; each thread has a copy
    type(study_runs_type), intent(inout) :: runs            !< about to begin
    type(run_maker_type), allocatable :: makers(:)
    integer :: i

    allocate (makers(threads))
    do i = 1, threads
      call makers(i)%begin(model, varied)
    end do
    !$omp parallel do num_threads(threads) schedule(static, 1) default(shared) private(i)
    do i = 1, threads
      call make_until_done(makers(i), threads, interruption, runs)
    end do
    !$omp end parallel do
  end subroutine make_in_threads

  !> Make one run after the other, or as many at once as the maker can, until all are handed out. One thread at a time asks for numbers
  !> and gives its runs back.
  subroutine make_until_done(maker, threads, interruption, runs)
    type(run_maker_type), intent(inout) :: maker   !< of this thread
    integer, intent(in) :: threads                 !< how many there are
    class(interruption_type), intent(in) :: interruption   !< is copied
    type(study_runs_type), intent(inout) :: runs   !< of all threads
    type(made_run_type) :: made(most_runs)
    class(interruption_type), allocatable :: of_run
    integer :: numbers(most_runs), count, number, i

    allocate (of_run, source=interruption)
    count = 0
    do
      !$omp critical (runs_of_study)
      do i = 1, count
        call runs%take(made(i))
      end do
      ! each thread has its share of the last runs
      count = 0
      do i = 1, min(maker%at_once(), 1 + runs%left()/threads)
        number = runs%hand_out()
        if (number == all_handed_out .or. number == wait_for_others) exit
        count = count + 1
        numbers(count) = number
      end do
      !$omp end critical (runs_of_study)
      if (count > 0) then
        call maker%make_several(numbers(:count), made(:count), of_run)
      else if (number == all_handed_out) then
        exit
      else
        call pause_for(short_wait)
      end if
    end do
  end subroutine make_until_done
end module mech9_study_threads
