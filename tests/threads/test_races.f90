!> Eight threads run different mechanisms; built with the thread sanitizer this finds whatever they share.
!>
!> Compares the program with itself: runs alone and runs side by side.
module test_races
  use mech9_testing, only: tester_type
  use many_runs, only: list_runs, carry_out, same, run_type
  use posix_threads, only: share_type, run_in_threads
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('eight_threads')) call eight_threads(tester)
  end subroutine run

  !> The runs of eight threads against each run alone.
  subroutine eight_threads(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(share_type), allocatable :: shares(:)
    type(run_type), allocatable :: alone(:)
    integer :: i, k
    logical :: failed

    call list_runs(tester%tree//'/tests', 15, alone)
    do k = 1, size(alone)
      call carry_out(alone(k))
    end do
    allocate (shares(8))
    do i = 1, size(shares)
      call list_runs(tester%tree//'/tests', size(alone), shares(i)%runs)
    end do
    call run_in_threads(shares, failed)
    call tester%is_true(.not. failed, 'the threads ran')
    do i = 1, size(shares)
      do k = 1, size(alone)
        call tester%is_true(same(shares(i)%runs(k), alone(k)), 'a run beside others has the numbers of one alone: '//alone(k)%file)
      end do
    end do
  end subroutine eight_threads
end module test_races
