!> Random numbers by their place: each is a function of a key and two counters, so that any of them can be drawn without the others.
!>
!> Philox 2x32 with ten rounds, of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3", 2011.
module mech9_counted_random
  use mech9_kinds, only: wp, long
  implicit none
  private
  public :: philox, uniform_at

  integer(long), parameter :: word = 4294967295_long               !< 32 bits that are set
  integer(long), parameter :: multiplier = 3528905107_long
  integer(long), parameter :: weyl = 2654435769_long                !< step of the key from round to round
  integer, parameter :: rounds = 10

contains

  !> Two words of 32 bits from two counters and a key of 32 bits each.
  pure subroutine philox(counters, key, words)
    integer(long), intent(in) :: counters(2)   !< from 0 to 2**32 - 1
    integer(long), intent(in) :: key           !< from 0 to 2**32 - 1
    integer(long), intent(out) :: words(2)     !< from 0 to 2**32 - 1
    integer(long) :: round_key, upper, lower, high, low
    integer :: round

    words = counters
    round_key = key
    do round = 1, rounds
      ! the product of two words, in halves of the first one: it would not fit a signed integer
      upper = shiftr(words(1), 16)*multiplier
      lower = iand(words(1), 65535_long)*multiplier
      high = shiftr(upper + shiftr(lower, 16), 16)
      low = iand(shiftl(iand(upper, 65535_long), 16) + lower, word)
      words = [ieor(ieor(high, round_key), words(2)), low]
      round_key = iand(round_key + weyl, word)
    end do
  end subroutine philox

  !> A number greater than 0 and less than 1.
  pure real(wp) function uniform_at(seed, run, dimension) result(u)
    integer, intent(in) :: seed        !< of the study, not negative
    integer, intent(in) :: run         !< number of the run, not negative
    integer, intent(in) :: dimension   !< number of the quantity that is drawn in this run
    integer(long) :: words(2)

    call philox([int(run, long), int(dimension, long)], int(seed, long), words)
    ! 52 bits: with one more, the half could round the largest number to 1
    u = (real(shiftl(words(1), 20) + shiftr(words(2), 12), wp) + 0.5_wp)*2.0_wp**(-52)
  end function uniform_at
end module mech9_counted_random
