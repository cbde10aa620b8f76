!> The procedures of processes that make the starts of a search together, by MPI.
!>
!> Every process has the numbers of two starts, so that it works on the second one while the designs of the first one are on their
!> way. The first process makes starts, too, one at a time, and looks for messages between them.
submodule (mech9_search_processes) mech9_mpi_search
  use mpi_f08, only: MPI_COMM_WORLD, MPI_ANY_SOURCE, MPI_INTEGER, MPI_DOUBLE_PRECISION, MPI_Status, MPI_Iprobe, MPI_Recv, MPI_Send
  use mech9_kinds, only: wp
  use mech9_pause, only: pause_for
  use mech9_design_search, only: found_design_type
  use mech9_design_space, only: design_space_type
  use mech9_start_rows, only: start_row_type, row_of_synthesis, not_made
  use mech9_search_starts, only: all_handed_out
  implicit none

  !> Tags of the messages: the number of a start from the first process; its number and designs to it.
  integer, parameter :: of_number = 11, of_designs = 12
  integer, parameter :: starts_ahead = 2                !< for each process at a time
  real(wp), parameter :: short_wait = 0.0002_wp         !< until a process that has nothing to do looks for messages again [s]

contains

  module subroutine lead_search(processes, variable, synthesis, seed, threads, starts)
    type(processes_type), intent(in) :: processes          !< those that make the starts together
    class(variable_model_type), intent(in) :: variable     !< the model as a function of its parameters
    type(synthesis_type), intent(in) :: synthesis          !< prepared
    integer, intent(in) :: seed                            !< of the starts
    integer, intent(in) :: threads                         !< unused: each process has one
    class(search_starts_type), intent(inout) :: starts     !< about to be made
    class(variable_model_type), allocatable, target :: own
    type(design_space_type), target :: space
    type(found_design_type), allocatable :: found(:)
    type(start_row_type) :: row
    integer :: waiting(processes%count - 1), number, other

    allocate (own, source=variable)
    space = synthesis%space
    space%variable => own
    row = row_of_synthesis(synthesis)
    waiting = 0
    do
      call take_designs(row, waiting, starts)
      call feed_all(waiting, starts)
      number = starts%hand_out()
      if (number == all_handed_out) then
        if (all(waiting == 0)) exit
        call pause_for(short_wait)
        cycle
      end if
      call synthesis%make_start(space, seed, number, found)
      if (allocated(found)) call starts%take(number, found)
    end do
    do other = 1, size(waiting)
      call MPI_Send([all_handed_out], 1, MPI_INTEGER, other, of_number, MPI_COMM_WORLD)
    end do
  end subroutine lead_search

  !> Hand out starts until every process has enough of them, or there are none.
  subroutine feed_all(waiting, starts)
    integer, intent(inout) :: waiting(:)                   !< (other processes) starts that each has
    class(search_starts_type), intent(inout) :: starts     !< of the search
    integer :: number, other, round

    do round = 1, starts_ahead
      do other = 1, size(waiting)
        if (waiting(other) >= round) cycle
        number = starts%hand_out()
        if (number == all_handed_out) return
        call MPI_Send([number], 1, MPI_INTEGER, other, of_number, MPI_COMM_WORLD)
        waiting(other) = waiting(other) + 1
      end do
    end do
  end subroutine feed_all

  !> Take the designs of all starts that have arrived.
  subroutine take_designs(row, waiting, starts)
    type(start_row_type), intent(in) :: row                !< extents of the designs
    integer, intent(inout) :: waiting(:)                   !< (other processes) starts that each has
    class(search_starts_type), intent(inout) :: starts     !< of the search
    type(found_design_type), allocatable :: found(:)
    type(MPI_Status) :: status
    real(wp) :: numbers(1 + row%length())
    logical :: arrived, sound

    do
      call MPI_Iprobe(MPI_ANY_SOURCE, of_designs, MPI_COMM_WORLD, arrived, status)
      if (.not. arrived) return
      associate (other => status%MPI_SOURCE)
        call MPI_Recv(numbers, size(numbers), MPI_DOUBLE_PRECISION, other, of_designs, MPI_COMM_WORLD, status)
        waiting(other) = waiting(other) - 1
      end associate
      call row%unpack(numbers(2:), found, sound)
      ! a start that its process was told to leave has none
      if (allocated(found)) call starts%take(nint(numbers(1)), found)
    end do
  end subroutine take_designs

  module subroutine follow_search(variable, synthesis, seed)
    class(variable_model_type), intent(in) :: variable     !< the model as a function of its parameters
    type(synthesis_type), intent(in) :: synthesis          !< prepared
    integer, intent(in) :: seed                            !< of the starts
    class(variable_model_type), allocatable, target :: own
    type(design_space_type), target :: space
    type(found_design_type), allocatable :: found(:)
    type(start_row_type) :: row
    type(MPI_Status) :: status
    real(wp), allocatable :: numbers(:)
    integer :: number(1)
    logical :: arrived

    allocate (own, source=variable)
    space = synthesis%space
    space%variable => own
    row = row_of_synthesis(synthesis)
    allocate (numbers(1 + row%length()))
    do
      do
        call MPI_Iprobe(0, of_number, MPI_COMM_WORLD, arrived, status)
        if (arrived) exit
        call pause_for(short_wait)
      end do
      call MPI_Recv(number, 1, MPI_INTEGER, 0, of_number, MPI_COMM_WORLD, status)
      if (number(1) == all_handed_out) exit
      call synthesis%make_start(space, seed, number(1), found)
      numbers(1) = number(1)
      if (allocated(found)) then
        call row%pack(found, numbers(2:))
      else
        numbers(2:) = not_made
      end if
      call MPI_Send(numbers, size(numbers), MPI_DOUBLE_PRECISION, 0, of_designs, MPI_COMM_WORLD)
    end do
  end subroutine follow_search
end submodule mech9_mpi_search
