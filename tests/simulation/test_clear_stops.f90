!> Coordinates far from their stops: which steps are clear by positions and rates.
module test_clear_stops
  use mech9_kinds, only: wp
  use mech9_state, only: state_type
  use mech9_clear_stops, only: clear_stops_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('steps')) call steps(test)
  end subroutine run

  !> A coordinate that may go 0.25 to both sides: steps of 0.1 s, by their ends and by the rates at both ends.
  subroutine steps(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(clear_stops_type) :: clear

    call start(clear)
    call check(test, clear, 0.24_wp, 2.4_wp, .true., 'a step within the range')
    call check(test, clear, 0.26_wp, 0.0_wp, .false., 'an end beyond the range')
    call check(test, clear, -0.26_wp, 0.0_wp, .false., 'an end beyond the range on the other side')
    call check(test, clear, 0.0_wp, -2.6_wp, .false., 'a rate at the end by which the motion may leave the range')
    call test%near(clear%ranges(3, 1), 0.24_wp, 0.0_wp, 'a step that is not clear leaves the last position')
    call test%near(clear%ranges(4, 1), 2.4_wp, 0.0_wp, 'and its rate')
    call start(clear)
    clear%ranges(4, 1) = 2.6_wp
    call check(test, clear, 0.0_wp, 0.0_wp, .false., 'a rate at the start by which the motion may leave the range')
  end subroutine steps

  !> One coordinate at rest in the middle of its range.
  subroutine start(clear)
    type(clear_stops_type), intent(out) :: clear   !< the coordinate

    clear%n = 1
    clear%coordinates = [1]
    clear%ranges = reshape([0.0_wp, 0.25_wp, 0.0_wp, 0.0_wp], [4, 1])
  end subroutine start

  !> Check whether a step of -0.1 s is clear.
  subroutine check(test, clear, q, dq, wanted, what)
    type(tester_type), intent(inout) :: test           !< counts the check
    type(clear_stops_type), intent(inout) :: clear     !< the coordinate; goes on
    real(wp), intent(in) :: q                          !< its value at the end of the step [rad]
    real(wp), intent(in) :: dq                         !< its rate there [rad/s]
    logical, intent(in) :: wanted                      !< the step is clear
    character(len=*), intent(in) :: what               !< the step
    type(state_type) :: state
    logical :: is_clear

    state%q = [q]
    state%dq = [dq]
    call clear%go_on(state, -0.1_wp, is_clear)
    call test%is_true(is_clear .eqv. wanted, what)
  end subroutine check
end module test_clear_stops
