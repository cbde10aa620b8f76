!> The processor: how wide its vector registers are.
module mech9_processor
  implicit none
  private
  public :: vector_bits

contains

  !> Bits of the vector registers that programs can use: 512, 256 or 128. The operating system tells; where it does not, 128.
  integer function vector_bits() result(bits)
    character(len=8192) :: line, preloaded
    integer :: unit, status

    bits = 128
    open (newunit=unit, file='/proc/cpuinfo', action='read', status='old', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, 'flags') /= 1) cycle
      line = trim(line)//' '
      if (index(line, ' avx2 ') > 0) bits = 256
      if (bits == 256 .and. index(line, ' avx512f ') > 0 .and. index(line, ' avx512dq ') > 0 .and. &
          index(line, ' avx512vl ') > 0) bits = 512
      exit
    end do
    close (unit)
    ! valgrind shows the processor's flags, but does not know its widest instructions
    call get_environment_variable('LD_PRELOAD', preloaded, status=status)
    if (status <= 0 .and. index(preloaded, 'vgpreload') > 0) bits = min(bits, 256)
  end function vector_bits
end module mech9_processor
