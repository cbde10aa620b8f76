!> Tests of mech9_film_clock: texts that tell all frames apart, and are not longer than they need be.
module test_film_clock
  use mech9_kinds, only: wp
  use mech9_film, only: film_type
  use mech9_film_clock, only: clock_decimals, clock_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('texts')) call texts(tester)
  end subroutine run

  !> Texts of whole films, and of single times.
  subroutine texts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call check_film(tester, 0.0_wp, 0.01_wp, 101, 2, 't = 0.00 s', 't = 1.00 s')
    call check_film(tester, 0.0_wp, 1.0_wp, 11, 0, 't = 0 s', 't = 10 s')
    call check_film(tester, -0.5_wp, 0.25_wp, 5, 2, 't = -0.50 s', 't = 0.50 s')
    call check_film(tester, 0.0_wp, 1.0_wp/30.0_wp, 31, 2, 't = 0.00 s', 't = 1.00 s')
    call check_film(tester, 0.0_wp, 1.0_wp/120.0_wp, 121, 3, 't = 0.000 s', 't = 1.000 s')
    call check_film(tester, 2.0_wp, -0.1_wp, 21, 1, 't = 2.0 s', 't = 0.0 s')
    ! numbers that need more than a plain one: four digits, and a power of ten
    call check_film(tester, 0.0_wp, 1.0e-9_wp, 11, -1, 't = 0 s', 't = 1e-8 s')
    call check_film(tester, 0.0_wp, 1.0e6_wp, 11, -1, 't = 0 s', 't = 1e7 s')
    call tester%is_true(clock_text(-1.0e-9_wp, 2) == 't = 0.00 s', 'a zero has no sign')
    call tester%is_true(clock_text(-0.2_wp, 1) == 't = -0.2 s', 'a number that is not zero keeps its sign')
  end subroutine texts

  !> A film of evenly spaced frames: its decimals, and its first and last time.
  subroutine check_film(tester, start, step, frames, decimals, first, last)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), intent(in) :: start                !< time of the first frame [s]
    real(wp), intent(in) :: step                 !< between frames [s]
    integer, intent(in) :: frames                !< how many
    integer, intent(in) :: decimals              !< decimals that are expected
    character(len=*), intent(in) :: first        !< time of the first frame as the clock shows it
    character(len=*), intent(in) :: last         !< time of the last frame as the clock shows it
    type(film_type) :: film
    character(len=:), allocatable :: before, now
    integer :: i, equal

    film%n_frames = frames
    film%times = [(start + step*i, i=0, frames - 1)]
    call tester%is_true(clock_decimals(film) == decimals, 'the number of decimals is right in the film that ends with '//last)
    call tester%is_true(clock_text(film%times(1), decimals) == first, 'the first frame shows '//first)
    call tester%is_true(clock_text(film%times(frames), decimals) == last, 'the last frame shows '//last)
    equal = 0
    before = ''
    do i = 1, frames
      now = clock_text(film%times(i), decimals)
      if (now == before) equal = equal + 1
      before = now
    end do
    call tester%is_true(equal == 0, 'no frame shows the time of the one before')
  end subroutine check_film
end module test_film_clock
