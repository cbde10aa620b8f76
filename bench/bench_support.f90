!> Procedures that the benchmarks share: reading a mechanism, medians, and an end that tells why.
module mech9_bench_support
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document
  use mech9_reader, only: read_model
  implicit none
  private
  public :: read_data_file, stop_at, median, argument, peak_memory, data_memory

contains

  !> A mechanism from its data file; ends the program where something is wrong with it.
  subroutine read_data_file(path, needs_drives, model)
    character(len=*), intent(in) :: path                !< of the data file
    logical, intent(in) :: needs_drives                 !< each independent coordinate must have a drive
    type(model_type), intent(out) :: model      !< all that the file says, checked
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call read_document(path, document, diagnostics)
    call read_model(document, needs_drives, model, diagnostics)
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

  !> The middle one of some numbers.
  pure real(wp) function median(numbers)
    real(wp), intent(in) :: numbers(:)   !< in any order; 0 is returned where there are none
    integer :: i, below

    do i = 1, size(numbers)
      median = numbers(i)
      below = count(numbers < median)
      if (below <= (size(numbers) - 1)/2 .and. count(numbers <= median) > (size(numbers) - 1)/2) return
    end do
    median = 0.0_wp
  end function median

  !> Word i of the command line.
  function argument(i) result(word)
    integer, intent(in) :: i   !< from 1 on
    character(len=:), allocatable :: word
    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(len=length) :: word)
    if (length > 0) call get_command_argument(i, word)
  end function argument

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
