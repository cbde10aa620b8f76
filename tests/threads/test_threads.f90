!> Different mechanisms run side by side: the same numbers, bit by bit, from 1, 2 and 8 OpenMP threads.
!>
!> Compares the program with itself: runs alone and runs side by side.
module test_threads
  use mech9_text, only: to_text
  use mech9_testing, only: tester_type
  use many_runs, only: run_type, list_runs, carry_out, same
  implicit none
  private
  public :: run

  integer, parameter :: threads(*) = [1, 2, 8]

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('one_two_eight')) call one_two_eight(tester)
  end subroutine run

  !> The runs of one, two and eight threads.
  subroutine one_two_eight(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(run_type), allocatable :: alone(:)
    integer :: i

    call list_runs(tester%tree//'/tests', 48, alone)
    do i = 1, size(alone)
      call carry_out(alone(i))
      call tester%is_true(alone(i)%done, alone(i)%file//' runs')
    end do
    do i = 1, size(threads)
      call test_side_by_side(tester, tester%tree//'/tests', alone, threads(i))
    end do
  end subroutine one_two_eight

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
end module test_threads
