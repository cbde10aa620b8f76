!> A program of several processes, from the words of its command line to its exit code. It makes studies and searches, and nothing else.
module mech9_mpi_program
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use, intrinsic :: ieee_exceptions, only: ieee_usual, ieee_get_halting_mode, ieee_set_halting_mode, ieee_set_flag
  use mpi_f08, only: MPI_COMM_WORLD, MPI_INTEGER, MPI_Init, MPI_Finalize, MPI_Comm_rank, MPI_Comm_size, MPI_Bcast
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type
  use mech9_command_line, only: command_line_type, get_command_words, parse_command_line
  use mech9_system, only: exit_program, leave_quit_alone
  use mech9_session, only: carry_out, asks_for_text
  use mech9_kept_study, only: processes_type
  implicit none
  private
  public :: run_mpi_program

contains

  !> The whole program is run. There is no return from it. All processes end with the exit code of the first one.
  subroutine run_mpi_program(program)
    integer, intent(in) :: program   !< kinematics or dynamics
    integer :: code, rank

    call leave_quit_alone()
    call begin_mpi()
    call MPI_Comm_rank(MPI_COMM_WORLD, rank)
    ! the other processes come to the same messages as the first one
    if (rank > 0) call fall_silent()
    call run_processes(program, rank == 0, code)
    call MPI_Bcast(code, 1, MPI_INTEGER, 0, MPI_COMM_WORLD)
    call MPI_Finalize()
    call exit_program(code)
  end subroutine run_mpi_program

  !> Begin to use MPI. A build that traps invalid operations must not do so within the start of MPI, where libraries make some.
  subroutine begin_mpi()
    logical :: traps(size(ieee_usual))

    call ieee_get_halting_mode(ieee_usual, traps)
    call ieee_set_halting_mode(ieee_usual, .false.)
    call MPI_Init()
    call ieee_set_flag(ieee_usual, .false.)
    call ieee_set_halting_mode(ieee_usual, traps)
  end subroutine begin_mpi

  !> Let the output of this process go nowhere.
  subroutine fall_silent()
    open (unit=error_unit, file='/dev/null', action='write')
    open (unit=output_unit, file='/dev/null', action='write')
  end subroutine fall_silent

  !> Carry out the command line, with the other processes.
  subroutine run_processes(program, is_first, code)
    integer, intent(in) :: program   !< kinematics or dynamics
    logical, intent(in) :: is_first       !< this is the first process
    integer, intent(out) :: code          !< exit code of this process
    type(processes_type) :: processes
    type(command_line_type) :: options
    type(error_type), allocatable :: err

    call read_options(program, options, err)
    if (allocated(err)) then
      write (error_unit, '(4a)') program_names(program), '-mpi: ', err%message
      code = err%code
      return
    end if
    processes%is_first = is_first
    call MPI_Comm_size(MPI_COMM_WORLD, processes%count)
    call carry_out(options, processes, code)
    ! a process that did not come to its study or search tells the others, which may have done so
    if (processes%agreements > 0) return
    if (code /= 0) call raise(err, code, 'this process did not come to its study or search')
    call processes%agree(err)
    if (allocated(err)) code = err%code
  end subroutine run_processes

  !> Read the command line. It must be that of a study or a search.
  subroutine read_options(program, options, err)
    integer, intent(in) :: program                        !< kinematics or dynamics
    type(command_line_type), intent(out) :: options       !< the command line
    type(error_type), allocatable, intent(out) :: err     !< allocated if it is wrong
    type(string_type), allocatable :: words(:)

    call get_command_words(words)
    call parse_command_line(words, program, options, err)
    if (allocated(err) .or. asks_for_text(options)) return
    if (.not. (options%has('study') .or. options%has('optimize'))) then
      call raise(err, exit_usage, 'several processes make the runs of a study or the starts of a search; add --study or '// &
                 '--optimize, or use '//program_names(program))
    else if (options%has('threads')) then
      call raise(err, exit_usage, '--threads is for one process; here mpirun -n tells how many there are')
    end if
  end subroutine read_options
end module mech9_mpi_program
