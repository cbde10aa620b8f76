!> The processor: how wide its vector registers are.
module mech9_processor
  use mech9_error, only: error_type
  use mech9_file_bytes, only: read_bytes
  implicit none
  private
  public :: vector_bits

contains

  !> Bits of the vector registers that programs can use: 512, 256 or 128. The operating system tells; where it does not, 128. Several
  !> threads may ask at the same time.
  integer function vector_bits() result(bits)
    character(len=:), allocatable :: facts, flags
    type(error_type), allocatable :: err
    character(len=8192) :: preloaded
    integer :: first, status

    bits = 128
    call read_bytes('/proc/cpuinfo', facts, err)
    if (allocated(err)) return
    first = index(facts, new_line('a')//'flags')
    if (first == 0) return
    flags = facts(first + 1:)
    flags = flags(:index(flags//new_line('a'), new_line('a')) - 1)//' '
    if (index(flags, ' avx2 ') > 0) bits = 256
    if (bits == 256 .and. index(flags, ' avx512f ') > 0 .and. index(flags, ' avx512dq ') > 0 .and. &
        index(flags, ' avx512vl ') > 0) bits = 512
    ! valgrind shows the processor's flags, but does not know its widest instructions
    call get_environment_variable('LD_PRELOAD', preloaded, status=status)
    if (status <= 0 .and. index(preloaded, 'vgpreload') > 0) bits = min(bits, 256)
  end function vector_bits
end module mech9_processor
