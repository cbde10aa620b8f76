!> Procedures that the benchmarks share: reading a mechanism, times of evaluations, memory, and an end that tells why.
module mech9_bench_support
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_clock, only: seconds
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motion_system, only: motion_system_type, set_motion_system
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_reader, only: read_model
  use mech9_bench_basics, only: median
  implicit none
  private
  public :: read_data_file, stop_at, time_evaluations, passes, peak_memory

  !> Repetitions for a median.
  integer, parameter :: passes = 5

contains

  !> A mechanism from its data file; ends the program where something is wrong with it.
  subroutine read_data_file(path, program, model)
    character(len=*), intent(in) :: path                !< of the data file
    integer, intent(in) :: program                      !< kinematics or dynamics
    type(model_type), intent(out) :: model              !< all that the file says, checked
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call read_document(path, document, diagnostics)
    call read_model(document, program, model, diagnostics)
    if (.not. diagnostics%failed()) return
    call diagnostics%report(error_unit)
    stop 1
  end subroutine read_data_file

  !> End the program with the words of an error; does nothing when all is well.
  subroutine stop_at(err, place)
    type(error_type), allocatable, intent(in) :: err   !< allocated where something failed
    character(len=*), intent(in) :: place              !< of the failure, for the message

    if (.not. allocated(err)) return
    write (error_unit, '(3a)') place, ': ', err%message
    stop 1
  end subroutine stop_at

  !> Median time of one evaluation of the motion, and the memory of the process then.
  subroutine time_evaluations(model, plan, start, exactly, time, memory)
    type(model_type), intent(in), target :: model   !< the mechanism with its problem
    type(plan_type), intent(in) :: plan             !< its plan
    type(state_type), intent(in) :: start           !< assembled position at the start, with the independent rates
    integer, intent(in) :: exactly                  !< number of evaluations; 0: as many as the clock needs
    real(wp), intent(out) :: time                   !< of an evaluation, median of the passes [us]
    real(wp), intent(out) :: memory                 !< for data [MB]
    type(motion_system_type), allocatable :: system
    type(error_type), allocatable :: err
    real(wp), allocatable :: y(:), rates(:)
    real(wp) :: each(passes), begin
    integer :: pass, i, evaluations

    allocate (system)
    system%plan = plan
    system%state = start
    call set_motion_system(model, model%problem%partition, system, err)
    call stop_at(err, 'the motion')
    y = system%vector()
    allocate (rates(size(y)), source=0.0_wp)
    evaluations = max(10, min(3000, 200000/plan%n_links))
    if (exactly > 0) evaluations = exactly
    do pass = 1, merge(1, passes, exactly > 0)
      begin = seconds()
      do i = 1, evaluations
        call system%rate(0.0_wp, y, rates, err)
        if (allocated(err)) exit
      end do
      each(pass) = (seconds() - begin)/evaluations
      call stop_at(err, 'the motion')
    end do
    time = 1.0e6_wp*median(each(:merge(1, passes, exactly > 0)))
    memory = data_memory()
  end subroutine time_evaluations

  !> The most memory that this process has had [MB]; 0 where the system does not tell.
  real(wp) function peak_memory()
    peak_memory = status_of('VmHWM:')
  end function peak_memory

  !> The memory that this process has taken for its data and keeps [MB], freed parts that were not handed back included; 0 where the
  !> system does not tell.
  real(wp) function data_memory()
    data_memory = status_of('RssAnon:')
  end function data_memory

  !> A number from the system's table of this process [MB]; 0 where there is no such table or row.
  real(wp) function status_of(name)
    character(len=*), intent(in) :: name   !< of the row, with its colon
    character(len=80) :: line
    integer :: unit, status

    status_of = 0.0_wp
    open (newunit=unit, file='/proc/self/status', action='read', status='old', iostat=status)
    do while (status == 0)
      read (unit, '(a)', iostat=status) line
      if (status /= 0 .or. line(:len(name)) /= name) cycle
      read (line(len(name) + 1:index(line, 'kB') - 1), *) status_of
      status_of = status_of/1024.0_wp
    end do
    close (unit, iostat=status)
  end function status_of
end module mech9_bench_support
