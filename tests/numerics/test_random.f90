!> The random numbers: those of the published generator, within their range, the same each time.
module test_random
  use mech9_kinds, only: wp, long
  use mech9_random, only: random_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('known_number')) call known_number(test)
    if (test%runs('seeds_and_moments')) call seeds_and_moments(test)
  end subroutine run

  !> The C++ standard gives number 10000 of minstd_rand, which starts from 1: [rand.predef]
  subroutine known_number(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: x
    integer :: i

    random%seed = 1_long
    do i = 1, 10000
      x = random%symmetric()
    end do
    call test%is_true(random%seed == 399268537_long, 'the minimal standard generator gives its known number 10000')
    call test%near(x, 2.0_wp*399268537.0_wp/2147483647.0_wp - 1.0_wp, 1.0e-15_wp, 'a number of the generator is brought to -1 .. 1')
  end subroutine known_number

  subroutine seeds_and_moments(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: n = 100000
    type(random_type) :: random, again, other
    real(wp) :: x, y, mean, square, neighbours, last
    logical :: equal, inside, differs
    integer :: i

    other%seed = 7_long
    equal = .true.
    inside = .true.
    differs = .false.
    mean = 0.0_wp
    square = 0.0_wp
    neighbours = 0.0_wp
    last = 0.0_wp
    do i = 1, n
      x = random%symmetric()
      y = again%symmetric()
      equal = equal .and. abs(x - y) <= 0.0_wp
      y = other%symmetric()
      differs = differs .or. abs(x - y) > 0.1_wp
      inside = inside .and. abs(x) < 1.0_wp
      mean = mean + x/n
      square = square + x*x/n
      neighbours = neighbours + x*last/n
      last = x
    end do
    call test%is_true(inside, 'all numbers lie between -1 and 1')
    call test%is_true(equal, 'two generators with one seed give the same numbers')
    call test%is_true(differs, 'two seeds give different numbers')
    ! five standard deviations of means of 100000 numbers: sqrt(1/3), sqrt(4/45) and 1/3 by sqrt(n)
    call test%near(mean, 0.0_wp, 5.0_wp*sqrt(1.0_wp/3.0_wp/n), 'the mean is zero')
    call test%near(square, 1.0_wp/3.0_wp, 5.0_wp*sqrt(4.0_wp/45.0_wp/n), 'the mean square is a third')
    call test%near(neighbours, 0.0_wp, 5.0_wp/3.0_wp/sqrt(real(n, wp)), 'neighbours are not correlated')
  end subroutine seeds_and_moments
end module test_random
