!> Sorting by keys: ascending, nothing lost, and things with equal keys in the order in which they stood.
module test_sorting
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_sorting, only: sort_by
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('equal_keys')) call equal_keys(tester)
  end subroutine run

  !> Keys of ten values only, for lists of all lengths up to 70. Things stand by their numbers before, so that in the right order the
  !> number grows wherever the key stays.
  subroutine equal_keys(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(random_type) :: random
    real(wp) :: keys(70)
    integer :: order(70), n, i
    logical :: ascends, keeps, complete

    ascends = .true.
    keeps = .true.
    complete = .true.
    do n = 0, size(keys)
      do i = 1, n
        keys(i) = anint(5.0_wp*random%symmetric())
        order(i) = i
      end do
      call sort_by(keys(:n), order(:n))
      do i = 1, n
        complete = complete .and. any(order(:n) == i)
        if (i == 1) cycle
        ascends = ascends .and. keys(order(i)) >= keys(order(i - 1))
        keeps = keeps .and. (keys(order(i)) > keys(order(i - 1)) .or. order(i) > order(i - 1))
      end do
    end do
    call tester%is_true(complete, 'no thing is lost')
    call tester%is_true(ascends, 'keys ascend')
    call tester%is_true(keeps, 'things with equal keys keep their order')
  end subroutine equal_keys
end module test_sorting
