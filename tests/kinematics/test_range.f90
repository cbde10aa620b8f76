!> Ranges of independent coordinates against closed forms: dead points on both sides, full turns, none.
module test_range
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_partition, only: new_partition
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_motion_range, only: motion_range_type, find_range, ends_at_limit, ends_never, ends_round
  use mech9_sample_mechanisms, only: four_bar, new_mechanism, add_revolute, add_prismatic, frame
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess, four_bar_limit, random_crank, slider_crank
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> The limits are found to the square of the last distance from them; a thousand times better than promised.
  real(wp), parameter :: tolerance = 1.0e-12_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_ranges')) call random_ranges(test)
    if (test%runs('two_turns')) call two_turns(test)
    if (test%runs('open_chain')) call open_chain(test)
  end subroutine run

  subroutine random_ranges(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer :: i, branch
    type(random_type) :: random

    do i = 1, 20
      do branch = -1, 1, 2
        call both_sides(test, branch, 10.0_wp**(-0.3_wp*i))
        call folded(test, random, branch)
        call full_turn(test, random, branch)
        call slider_as_input(test, random, branch)
      end do
    end do
  end subroutine random_ranges

  subroutine range_of(test, model, coordinate, range)
    type(tester_type), intent(inout) :: test        !< counts the checks
    type(model_type), intent(in) :: model           !< the model
    integer, intent(in) :: coordinate               !< coordinate that is moved
    type(motion_range_type), intent(out) :: range   !< range that it has
    type(plan_type) :: plan
    type(state_type) :: start
    type(error_type), allocatable :: err

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, start, err)
    call test%no_error(err, 'the mechanism has a plan and is assembled')
    if (allocated(err)) call test%finish()
    call find_range(plan, start, coordinate, range)
  end subroutine range_of

  subroutine check_limits(test, range, lower, upper, name)
    type(tester_type), intent(inout) :: test       !< counts the checks
    type(motion_range_type), intent(in) :: range   !< range that was found
    real(wp), intent(in) :: lower                  !< the right lower end [rad, m]
    real(wp), intent(in) :: upper                  !< the right upper end [rad, m]
    character(len=*), intent(in) :: name           !< of the mechanism, for the report of a failure

    call test%is_true(range%lower%kind == ends_at_limit .and. range%upper%kind == ends_at_limit, name//': the range has two limits')
    call test%near(range%lower%value, lower, tolerance, name//': the lower limit is that of the closed form')
    call test%near(range%upper%value, upper, tolerance, name//': the upper limit is that of the closed form')
    call test%is_true(range%lower%block == 1 .and. range%upper%block == 1, name//': the only chain limits the range')
  end subroutine check_limits

  !> A crank between two positions in which coupler and rocker are stretched out: it swings through zero.
  !> The smaller `excess`, the nearer it passes to another dead point at zero, or at half a turn to none.
  subroutine both_sides(test, branch, excess)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: branch              !< +1 or -1: side of the diagonal on which the chain closes
    real(wp), intent(in) :: excess             !< length of the ground beyond coupler and rocker less the crank [m]
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(motion_range_type) :: range
    real(wp) :: limit

    bar = four_bar_type(ground=0.0_wp, crank=0.7_wp, coupler=0.8_wp, rocker=0.75_wp)
    bar%ground = bar%coupler + bar%rocker - bar%crank + excess
    limit = four_bar_limit(bar, stretched=.true.)
    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.3_wp*limit, branch), model)
    call range_of(test, model, 1, range)
    call check_limits(test, range, -limit, limit, 'a crank that swings')
  end subroutine both_sides

  !> A crank between the positions in which coupler and rocker are folded and stretched out.
  subroutine folded(test, random, branch)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: branch                !< +1 or -1: side of the diagonal on which the chain closes
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(motion_range_type) :: range
    real(wp) :: from, to

    bar = four_bar_type(ground=1.0_wp, crank=0.7_wp + 0.1_wp*random%symmetric(), coupler=1.0_wp, &
                        rocker=0.4_wp + 0.1_wp*random%symmetric())
    if (bar%ground + bar%crank < bar%coupler + bar%rocker) return
    from = four_bar_limit(bar, stretched=.false.)
    to = four_bar_limit(bar, stretched=.true.)
    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, &
                  four_bar_guess(bar, 0.5_wp*(from + to), branch), model)
    call range_of(test, model, 1, range)
    call check_limits(test, range, from, to, 'a crank between folded and stretched')
  end subroutine folded

  subroutine full_turn(test, random, branch)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: branch                !< +1 or -1: side of the diagonal on which the chain closes
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(motion_range_type) :: range

    bar = random_crank(random, 0.1_wp*abs(random%symmetric()))
    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.4_wp, branch), model)
    call range_of(test, model, 1, range)
    call test%is_true(range%upper%kind == ends_round .and. range%lower%kind == ends_round, &
                      'a crank that turns fully comes round both ways')
    call test%is_true(range%upper%turns == 1, 'a crank that turns fully comes round after one turn')
  end subroutine full_turn

  !> A slider-crank driven at its slider: between crank and coupler stretched out and folded.
  subroutine slider_as_input(test, random, branch)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    integer, intent(in) :: branch                !< +1 or -1: side of the diagonal on which the chain closes
    type(model_type) :: model
    type(motion_range_type) :: range
    real(wp) :: crank, coupler, offset, lower, upper

    crank = 0.5_wp + 0.1_wp*random%symmetric()
    coupler = 1.5_wp + 0.1_wp*random%symmetric()
    offset = 0.2_wp*random%symmetric()
    call slider_crank(crank, coupler, offset, 1.0_wp*branch, 1, model)
    call new_partition(model%mechanism%structure, [.false., .false., .false., .true.], model%problem%partition)
    lower = sqrt((coupler - crank)**2 - offset**2)
    upper = sqrt((coupler + crank)**2 - offset**2)
    call range_of(test, model, 4, range)
    call check_limits(test, range, lower, upper, 'a slider')
  end subroutine slider_as_input

  !> A kite is its own mirror image after one turn of the crank: it is round after two.
  subroutine two_turns(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(motion_range_type) :: range

    call four_bar(0.7_wp, 0.7_wp, 1.0_wp, 1.0_wp, &
                  four_bar_guess(four_bar_type(0.7_wp, 0.7_wp, 1.0_wp, 1.0_wp), 0.8_wp, 1), model)
    call range_of(test, model, 1, range)
    call test%is_true(range%upper%kind == ends_round .and. range%upper%turns == 2, 'a kite comes round after two turns')
  end subroutine two_turns

  !> An arm and a slide: one turns round, the other has no end.
  subroutine open_chain(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(motion_range_type) :: range
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], x(3) = [1.0_wp, 0.0_wp, 0.0_wp]

    call new_mechanism(3, reshape([1, 2, 2, 3], [2, 2]), [1, 2], model)
    call add_revolute(model, 1, 1, 2, frame(0.0_wp*z, z), frame(0.0_wp*z, z))
    call add_prismatic(model, 2, 2, 3, frame(x, x), frame(0.0_wp*x, x))
    call range_of(test, model, 1, range)
    call test%is_true(range%upper%kind == ends_round, 'an arm that carries nothing turns round')
    call range_of(test, model, 2, range)
    call test%is_true(range%upper%kind == ends_never .and. range%lower%kind == ends_never, &
                      'a slide that carries nothing has no end')
    call test%is_true(range%upper%value > 10.0_wp .and. range%lower%value < -10.0_wp, 'the range of a slide is followed far')
  end subroutine open_chain
end module test_range
