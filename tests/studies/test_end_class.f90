!> Cycles at the ends of motions: angles count within a turn, whatever the number of turns before.
module test_end_class
  use mech9_kinds, only: wp, pi
  use mech9_end_class, only: find_cycle
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('many_turns')) call many_turns(tester)
  end subroutine run

  !> A crank that turns thrice between two points of a section, after thousands of turns. It has a cycle where the places repeat.
  !> It has none where the place goes on by a hundredth of a radian each time, as small as this is beside the whole angle.
  subroutine many_turns(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: points = 40
    real(wp), parameter :: places(2) = [0.3_wp, 0.9_wp]
    real(wp) :: states(2, points)
    real(wp), allocatable :: cycle(:, :)
    integer :: i, period

    do period = 1, 2
      do i = 1, points
        states(:, i) = [2.0_wp*pi*(5000 + 3*i) + places(1 + mod(i, period)), 1.5_wp]
      end do
      call find_cycle(states, [1.0_wp, 1.0_wp], [.true., .false.], cycle)
      call tester%is_true(size(cycle, 2) == period, 'the places repeat')
      states(1, :) = states(1, :) + [(0.01_wp*i, i=1, points)]
      call find_cycle(states, [1.0_wp, 1.0_wp], [.true., .false.], cycle)
      call tester%is_true(size(cycle, 2) == 0, 'the places go on')
    end do
  end subroutine many_turns
end module test_end_class
