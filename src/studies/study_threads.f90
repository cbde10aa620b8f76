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
  use mech9_run_maker, only: run_maker_type, made_run_type
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
      call make_until_done(makers(i), interruption, runs)
    end do
    !$omp end parallel do
  end subroutine make_in_threads

  !> Make one run after the other until all are handed out. One thread at a time asks for a number and gives its run back.
  subroutine make_until_done(maker, interruption, runs)
    type(run_maker_type), intent(inout) :: maker   !< of this thread
    class(interruption_type), intent(in) :: interruption   !< is copied
    type(study_runs_type), intent(inout) :: runs   !< of all threads
    type(made_run_type) :: run
    class(interruption_type), allocatable :: of_run
    integer :: number

    allocate (of_run, source=interruption)
    do
      !$omp critical (runs_of_study)
      if (run%number > 0) call runs%take(run)
      number = runs%hand_out()
      !$omp end critical (runs_of_study)
      run%number = 0
      if (number == all_handed_out) exit
      if (number == wait_for_others) then
        call pause_for(short_wait)
      else
        call maker%make(number, run, of_run)
      end if
    end do
  end subroutine make_until_done
end module mech9_study_threads
