!> Different mechanisms run side by side: the same numbers, bit by bit, from 1, 2 and 8 OpenMP threads.
!>
!> Compares the program with itself: runs alone and runs side by side.
program test_threads
  use mech9_text, only: to_text
  use mech9_testing, only: tester_type
  use many_runs, only: run_type, list_runs, carry_out, same
  implicit none
  call run_tests()
contains

  subroutine run_tests()
    type(tester_type) :: tester
    type(run_type), allocatable :: alone(:)
    integer, parameter :: threads(*) = [1, 2, 8]
    character(len=1000) :: folder
    integer :: i

    call get_command_argument(1, folder)
    call list_runs(trim(folder), 48, alone)
    do i = 1, size(alone)
      call carry_out(alone(i))
      call tester%is_true(alone(i)%done, alone(i)%file//' runs')
    end do
    do i = 1, size(threads)
      call test_side_by_side(tester, trim(folder), alone, threads(i))
    end do
    call tester%finish()
  end subroutine run_tests

  subroutine test_side_by_side(tester, folder, alone, threads)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: folder       !< of the data files
    type(run_type), intent(in) :: alone(:)       !< the same runs, carried out one after the other
    integer, intent(in) :: threads               !< at once
    type(run_type), allocatable :: runs(:)
    integer :: i

    call list_runs(folder, size(alone), runs)
    !$omp parallel do num_threads(threads) schedule(dynamic, 1)
    do i = 1, size(runs)
      call carry_out(runs(i))
    end do
    !$omp end parallel do
    do i = 1, size(runs)
      call tester%is_true(same(runs(i), alone(i)), &
                          to_text(threads)//' threads give the numbers of one: '//runs(i)%file)
    end do
  end subroutine test_side_by_side
end program test_threads
