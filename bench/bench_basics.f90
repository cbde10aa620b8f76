!> Words of the command line and medians, for programs that need nothing else of the library.
module mech9_bench_basics
  use mech9_kinds, only: wp
  implicit none
  private
  public :: median, argument

contains

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
end module mech9_bench_basics
