!> Eight threads run different mechanisms; built with the thread sanitizer this finds whatever they share.
!>
!> Compares the program with itself: runs alone and runs side by side.
program test_races
  use mech9_testing, only: tester_type
  use many_runs, only: list_runs, carry_out, same, run_type
  use posix_threads, only: share_type, run_in_threads
  implicit none
  call run_tests()
contains

  subroutine run_tests()
    type(tester_type) :: tester
    type(share_type), allocatable :: shares(:)
    type(run_type), allocatable :: alone(:)
    character(len=1000) :: folder
    integer :: i, k
    logical :: failed

    call get_command_argument(1, folder)
    call list_runs(trim(folder), 14, alone)
    do k = 1, size(alone)
      call carry_out(alone(k))
    end do
    allocate (shares(8))
    do i = 1, size(shares)
      call list_runs(trim(folder), size(alone), shares(i)%runs)
    end do
    call run_in_threads(shares, failed)
    call tester%is_true(.not. failed, 'the threads ran')
    do i = 1, size(shares)
      do k = 1, size(alone)
        call tester%is_true(same(shares(i)%runs(k), alone(k)), 'a run beside others has the numbers of one alone: '//alone(k)%file)
      end do
    end do
    deallocate (shares, alone)
    call tester%finish()
  end subroutine run_tests
end program test_races
