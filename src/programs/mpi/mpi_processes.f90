!> The procedures of processes that make the runs of a study together, by MPI.
!>
!> Runs are handed out in batches, each as long as some milliseconds of work. Every process has two batches, so that it works on the
!> second one while the results of the first one are on their way. The first process makes runs, too, one at a time, and looks for
!> messages between them.
submodule (mech9_processes) mech9_mpi_processes
  use mpi_f08, only: MPI_COMM_WORLD, MPI_ANY_SOURCE, MPI_INTEGER, MPI_DOUBLE_PRECISION, MPI_CHARACTER, MPI_Status, MPI_Allgather, &
                     MPI_Iprobe, MPI_Get_count, MPI_Recv, MPI_Send
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_error, only: place_type, raise
  use mech9_clock, only: seconds
  use mech9_pause, only: pause_for
  use mech9_explanation, only: explain
  use mech9_study_values, only: values_of_run
  use mech9_run_maker, only: run_maker_type, made_run_type
  use mech9_study_runs, only: all_handed_out, wait_for_others
  implicit none

  !> Tags of the messages: numbers of runs from the first process; codes, quantities and texts of runs to it, and the columns of
  !> each run, if they are kept.
  integer, parameter :: of_numbers = 1, of_codes = 2, of_quantities = 3, of_texts = 4, of_rows = 5
  !> Numbers that are sent of each run beside its quantities: its number, exit code, line, column and text of its place, and letters
  !> of its message.
  integer, parameter :: codes_per_run = 6
  integer, parameter :: batches = 2                     !< for each process at a time
  integer, parameter :: longest_batch = 24              !< runs; two of them are fewer than the runs ahead for each process
  real(wp), parameter :: time_of_batch = 0.005_wp       !< work in a batch [s]
  real(wp), parameter :: short_wait = 0.0002_wp         !< until a process that has nothing to do looks for messages again [s]

contains

  module subroutine agree(self, err)
    class(processes_type), intent(inout) :: self    !< the processes
    type(error_type), allocatable, intent(inout) :: err   !< allocated if this process cannot go on; afterwards if any cannot
    integer :: codes(self%count), code, other

    self%agreements = self%agreements + 1
    code = 0
    if (allocated(err)) code = err%code
    call MPI_Allgather([code], 1, MPI_INTEGER, codes, 1, MPI_INTEGER, MPI_COMM_WORLD)
    if (code /= 0) return
    do other = 1, self%count
      if (codes(other) == 0) cycle
      call raise(err, codes(other), 'process '//to_text(other)//' of '//to_text(self%count)//' cannot begin and ends with '// &
                 to_text(codes(other))//'; can it read the data file, and the files that this one names?')
      return
    end do
  end subroutine agree

  !> The first process makes some of the runs, too.
  module subroutine lead(self, model, varied, threads, interruption, runs)
    class(processes_type), intent(in) :: self       !< the processes
    type(model_type), intent(in) :: model                 !< the model with the values of the data file
    class(variable_model_type), intent(in) :: varied      !< the model as a function of its parameters
    integer, intent(in) :: threads                        !< unused: each process has one
    class(interruption_type), intent(in) :: interruption  !< is asked whether a run shall stop
    type(study_runs_type), intent(inout) :: runs          !< about to begin
    class(interruption_type), allocatable :: of_run
    type(run_maker_type) :: maker
    type(made_run_type) :: run
    integer :: waiting(self%count - 1)
    integer :: number, batch, other
    real(wp) :: begun

    allocate (of_run, source=interruption)
    call maker%begin(model, varied)
    waiting = 0
    batch = 1
    do
      call take_results(model, maker%shape_of_rows(), waiting, runs)
      call feed_all(batch, waiting, runs)
      number = runs%hand_out()
      if (number == all_handed_out .and. all(waiting == 0)) exit
      if (number == all_handed_out .or. number == wait_for_others) then
        call pause_for(short_wait)
        cycle
      end if
      begun = seconds()
      call maker%make(number, run, of_run)
      batch = int(min(real(longest_batch, wp), max(1.0_wp, time_of_batch/max(seconds() - begun, tiny(begun)))))
      call runs%take(run)
    end do
    do other = 1, size(waiting)
      call MPI_Send([0], 0, MPI_INTEGER, other, of_numbers, MPI_COMM_WORLD)
    end do
  end subroutine lead

  !> Hand out runs until every process has two batches, or there are none to hand out now.
  subroutine feed_all(batch, waiting, runs)
    integer, intent(in) :: batch                      !< runs in a batch
    integer, intent(inout) :: waiting(:)              !< (other processes) batches that each has
    type(study_runs_type), intent(inout) :: runs      !< of the study
    integer :: numbers(longest_batch), number, other, n, round

    do round = 1, batches
      do other = 1, size(waiting)
        if (waiting(other) >= round) cycle
        do n = 0, batch - 1
          number = runs%hand_out()
          if (number == all_handed_out .or. number == wait_for_others) exit
          numbers(n + 1) = number
        end do
        if (n == 0) return
        call MPI_Send(numbers, n, MPI_INTEGER, other, of_numbers, MPI_COMM_WORLD)
        waiting(other) = waiting(other) + 1
      end do
    end do
  end subroutine feed_all

  !> Take the results of all batches that have arrived.
  subroutine take_results(model, shape_of_rows, waiting, runs)
    type(model_type), intent(in) :: model             !< the model with the values of the data file
    integer, intent(in) :: shape_of_rows(2)           !< columns and outputs of a run; 0 where they are not kept
    integer, intent(inout) :: waiting(:)              !< (other processes) batches that each has
    type(study_runs_type), intent(inout) :: runs      !< of the study
    type(MPI_Status) :: status
    integer, allocatable :: codes(:, :)
    real(wp), allocatable :: quantities(:, :)
    character(len=:), allocatable :: texts
    integer :: length, n
    logical :: arrived

    do
      call MPI_Iprobe(MPI_ANY_SOURCE, of_codes, MPI_COMM_WORLD, arrived, status)
      if (.not. arrived) return
      call MPI_Get_count(status, MPI_INTEGER, length)
      n = length/codes_per_run
      allocate (codes(codes_per_run, n), quantities(size(model%request%quantities), n))
      associate (other => status%MPI_SOURCE)
        call MPI_Recv(codes, length, MPI_INTEGER, other, of_codes, MPI_COMM_WORLD, status)
        call MPI_Recv(quantities, size(quantities), MPI_DOUBLE_PRECISION, other, of_quantities, MPI_COMM_WORLD, status)
        allocate (character(len=sum(codes(codes_per_run, :))) :: texts)
        call MPI_Recv(texts, len(texts), MPI_CHARACTER, other, of_texts, MPI_COMM_WORLD, status)
        waiting(other) = waiting(other) - 1
        call take_batch(model, codes, quantities, texts, other, shape_of_rows, runs)
      end associate
      deallocate (codes, quantities, texts)
    end do
  end subroutine take_results

  !> Give the runs of a batch back. Their values of the parameters follow from their numbers.
  subroutine take_batch(model, codes, quantities, texts, sender, shape_of_rows, runs)
    type(model_type), intent(in) :: model             !< the model with the values of the data file
    integer, intent(in) :: codes(:, :)                !< (codes_per_run,runs)
    real(wp), intent(in) :: quantities(:, :)          !< (quantities,runs)
    character(len=*), intent(in) :: texts             !< messages of failed runs, one behind the other
    integer, intent(in) :: sender                     !< rank of the process that made them
    integer, intent(in) :: shape_of_rows(2)           !< columns and outputs of a run; 0 where they are not kept
    type(study_runs_type), intent(inout) :: runs      !< of the study
    type(made_run_type) :: run
    type(MPI_Status) :: status
    integer :: i, at

    at = 0
    allocate (run%values(size(model%parameters)))
    if (all(shape_of_rows > 0)) allocate (run%rows(shape_of_rows(1), shape_of_rows(2)))
    do i = 1, size(codes, 2)
      run%number = codes(1, i)
      run%exit_code = codes(2, i)
      call values_of_run(model%request%study, model%parameters, run%number, run%values)
      run%quantities = quantities(:, i)
      if (allocated(run%failure)) deallocate (run%failure)
      if (codes(2, i) /= 0) then
        call raise(run%failure, codes(2, i), texts(at + 1:at + codes(6, i)))
        run%failure%place = place_type(codes(3, i), codes(4, i), codes(5, i))
      end if
      at = at + codes(6, i)
      if (allocated(run%rows)) &
        call MPI_Recv(run%rows, size(run%rows), MPI_DOUBLE_PRECISION, sender, of_rows, MPI_COMM_WORLD, status)
      call runs%take(run)
    end do
  end subroutine take_batch

  module subroutine follow(self, model, varied, interruption)
    class(processes_type), intent(in) :: self       !< the processes
    type(model_type), intent(in) :: model                 !< the model with the values of the data file
    class(variable_model_type), intent(in) :: varied      !< the model as a function of its parameters
    class(interruption_type), intent(in) :: interruption  !< is asked whether a run shall stop
    class(interruption_type), allocatable :: of_run
    type(run_maker_type) :: maker
    type(MPI_Status) :: status
    integer :: numbers(longest_batch), n
    logical :: arrived

    allocate (of_run, source=interruption)
    call maker%begin(model, varied)
    do
      do
        call MPI_Iprobe(0, of_numbers, MPI_COMM_WORLD, arrived, status)
        if (arrived) exit
        call pause_for(short_wait)
      end do
      call MPI_Get_count(status, MPI_INTEGER, n)
      call MPI_Recv(numbers, n, MPI_INTEGER, 0, of_numbers, MPI_COMM_WORLD, status)
      if (n == 0) exit
      call make_batch(maker, numbers(:n), size(model%request%quantities), of_run)
    end do
  end subroutine follow

  !> Make the runs of a batch, and send their results to the first process.
  subroutine make_batch(maker, numbers, n_quantities, interruption)
    type(run_maker_type), intent(inout) :: maker   !< of this process
    integer, intent(in) :: numbers(:)              !< of the runs
    integer, intent(in) :: n_quantities            !< how many quantities a run has
    class(interruption_type), intent(inout) :: interruption   !< is asked whether a run shall stop
    type(made_run_type) :: made(size(numbers))
    integer :: codes(codes_per_run, size(numbers)), i
    real(wp) :: quantities(n_quantities, size(numbers))
    character(len=:), allocatable :: texts

    texts = ''
    codes = 0
    do i = 1, size(numbers)
      associate (run => made(i))
        call maker%make(numbers(i), run, interruption)
        codes(:2, i) = [run%number, run%exit_code]
        quantities(:, i) = run%quantities
        if (.not. allocated(run%failure)) cycle
        call explain(run%failure)
        associate (place => run%failure%place)
          codes(3:, i) = [place%line, place%column, place%source, len(run%failure%message)]
        end associate
        texts = texts//run%failure%message
      end associate
    end do
    call MPI_Send(codes, size(codes), MPI_INTEGER, 0, of_codes, MPI_COMM_WORLD)
    call MPI_Send(quantities, size(quantities), MPI_DOUBLE_PRECISION, 0, of_quantities, MPI_COMM_WORLD)
    call MPI_Send(texts, len(texts), MPI_CHARACTER, 0, of_texts, MPI_COMM_WORLD)
    do i = 1, size(numbers)
      if (allocated(made(i)%rows)) &
        call MPI_Send(made(i)%rows, size(made(i)%rows), MPI_DOUBLE_PRECISION, 0, of_rows, MPI_COMM_WORLD)
    end do
  end subroutine make_batch
end submodule mech9_mpi_processes
