!> Latin hypercubes: in each dimension, each of as many equal intervals as there are runs holds one run. A run's interval is a keyed
!> permutation of its number, so that no table of the others is needed.
module mech9_latin_hypercube
  use mech9_kinds, only: wp, long
  use mech9_counted_random, only: philox, uniform_at
  implicit none
  private
  public :: latin_at, permuted

  integer, parameter :: rounds = 6             !< of the permutation
  !> Counters from here on belong to permutations, not to numbers that are drawn.
  integer(long), parameter :: apart = 2147483648_long

contains

  !> A number between 0 and 1 of a run.
  pure real(wp) function latin_at(seed, run, dimension, runs) result(u)
    integer, intent(in) :: seed        !< of the study, not negative
    integer, intent(in) :: run         !< number of the run, 1 to runs
    integer, intent(in) :: dimension   !< number of the dimension, from 1
    integer, intent(in) :: runs        !< of the whole study

    u = (permuted(seed, dimension, run - 1, runs) + uniform_at(seed, run, dimension))/runs
  end function latin_at

  !> The place of a number in a permutation of 0 ... count - 1. Numbers are exchanged by a Feistel network of a power of four
  !> elements, again until they are below count.
  pure integer function permuted(seed, dimension, number, count) result(place)
    integer, intent(in) :: seed        !< chooses the permutation, with the dimension
    integer, intent(in) :: dimension   !< from 1
    integer, intent(in) :: number      !< 0 to count - 1
    integer, intent(in) :: count       !< of elements
    integer(long) :: left, right, words(2), mask
    integer :: half, round

    half = 1
    do while (4_long**half < count)
      half = half + 1
    end do
    mask = 2_long**half - 1
    place = number
    do
      left = shiftr(int(place, long), half)
      right = iand(int(place, long), mask)
      do round = 1, rounds
        call philox([right, apart + int(rounds, long)*dimension + round], int(seed, long), words)
        words(1) = iand(ieor(left, words(1)), mask)
        left = right
        right = words(1)
      end do
      if (shiftl(left, half) + right < count) exit
      place = int(shiftl(left, half) + right)
    end do
    place = int(shiftl(left, half) + right)
  end function permuted
end module mech9_latin_hypercube
