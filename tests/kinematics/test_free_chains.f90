!> Chains whose independent coordinates are set free: their motions and shares, closing from far away, ways to given values, and the
!> curves from one assembly to the next, on four-bars in closed form.
module test_free_chains
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_frame_motion, only: place_all
  use mech9_block_solver, only: block_work_type, new_block_work
  use mech9_mobility, only: find_motions, choose_coordinates, shares_of
  use mech9_assembly, only: assembly_outcome_type, assemble_block
  use mech9_release, only: close_free, move_inputs
  use mech9_released_curve, only: curve_type, begin_curve
  use mech9_generic_position, only: generic_position_type, find_generic_position
  use mech9_finite_motion, only: locked_chain_type, find_locked_chain
  use mech9_sample_mechanisms, only: four_bar, general_loop, new_mechanism, add_revolute, frame
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess, four_bar_limit
  use mech9_plan_checks, only: check_closed
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Its crank turns fully.
  type(four_bar_type), parameter :: crank_rocker = four_bar_type(ground=1.0_wp, crank=0.4_wp, coupler=0.9_wp, rocker=0.7_wp)
  !> Its crank swings between two dead points on either side.
  type(four_bar_type), parameter :: swinging = four_bar_type(ground=1.0_wp, crank=0.75_wp, coupler=1.0_wp, rocker=0.4_wp)

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('motions_of_four_bar')) call motions_of_four_bar(test)
    if (test%runs('motions_of_five_bar')) call motions_of_five_bar(test)
    if (test%runs('held_coordinate')) call held_coordinate(test)
    if (test%runs('blocks')) call blocks(test)
    if (test%runs('free_closing')) call free_closing(test)
    if (test%runs('ways')) call ways(test)
    if (test%runs('curve_over_dead_point')) call curve_over_dead_point(test)
    if (test%runs('generic')) call generic(test)
    if (test%runs('parallel_cranks')) call parallel_cranks(test)
  end subroutine run

  !> A four-bar with its plan and its closed position.
  subroutine prepare(test, bar, angle, branch, plan, state)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(four_bar_type), intent(in) :: bar     !< its lengths
    real(wp), intent(in) :: angle              !< of the crank [rad]
    integer, intent(in) :: branch              !< +1 or -1
    type(plan_type), intent(out) :: plan       !< its plan
    type(state_type), intent(out) :: state     !< closed
    type(model_type) :: model
    type(error_type), allocatable :: err

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, angle, branch), model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a four-bar has a plan')
    call place_all(plan, state, err)
    call test%no_error(err, 'its frames are placed')
  end subroutine prepare

  !> The distance of two angles, whole turns aside [rad].
  elemental real(wp) function apart(a, b)
    real(wp), intent(in) :: a   !< first angle [rad]
    real(wp), intent(in) :: b   !< second angle [rad]

    apart = abs(modulo(a - b + pi, 2.0_wp*pi) - pi)
  end function apart

  !> The one motion has the rates of the closed form, whichever coordinate is chosen.
  subroutine motions_of_four_bar(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: h = 1.0_wp/256.0_wp, angle = 0.8_wp
    type(plan_type) :: plan
    type(state_type) :: state
    real(wp), allocatable :: motions(:, :), shares(:, :)
    real(wp) :: rates(4), q(4, -half_width:half_width), second, error
    logical :: chosen(4)
    integer :: i, k

    call prepare(test, crank_rocker, angle, 1, plan, state)
    call find_motions(plan, state, [.false., .false., .false., .false.], motions)
    call test%is_true(size(motions, 2) == 1, 'a four-bar has one freedom')
    call test%near(norm2(motions), 1.0_wp, 1.0e-14_wp, 'its motion is of norm one')
    do i = -half_width, half_width
      q(:, i) = four_bar_guess(crank_rocker, angle + i*h, 1)
    end do
    do k = 1, 4
      call derivatives_from_stencil(q(k, :), h, rates(k), second, error)
    end do
    do k = 1, 4
      call choose_coordinates(motions, [(i == k, i=1, 4)], chosen)
      call test%is_true(count(chosen) == 1 .and. chosen(k), 'the coordinate that is wanted is chosen')
      call shares_of(motions, chosen, shares)
      ! round-off 2/h of angles, over rates of some tenths
      call test%near(maxval(abs(shares(:, 1) - rates/rates(k))), 0.0_wp, 1.0e-11_wp, 'shares are the rates of the closed form')
    end do
  end subroutine motions_of_four_bar

  !> Two motions are orthonormal; chosen coordinates have the unit matrix as their shares, and give all motions.
  subroutine motions_of_five_bar(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], unit(2, 2) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
    real(wp), allocatable :: motions(:, :), shares(:, :)
    logical :: chosen(5)
    integer :: i, k, l

    call new_mechanism(5, reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 1], [2, 5]), [1, 2], model)
    do k = 1, 5
      call add_revolute(model, k, k, mod(k, 5) + 1, frame([cos(1.3_wp*k), sin(1.3_wp*k), 0.0_wp], z), &
                        frame([cos(1.3_wp*k), sin(1.3_wp*k), 0.0_wp], z))
    end do
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    if (.not. allocated(err)) call place_all(plan, state, err)
    call test%no_error(err, 'a five-bar is closed')
    call find_motions(plan, state, [(.false., i=1, 5)], motions)
    call test%is_true(size(motions, 2) == 2, 'a five-bar has two freedoms')
    call test%near(maxval(abs(matmul(transpose(motions), motions) - unit)), 0.0_wp, 1.0e-14_wp, 'its motions are orthonormal')
    do k = 1, 5
      do l = k + 1, 5
        call choose_coordinates(motions, [(i == k .or. i == l, i=1, 5)], chosen)
        call test%is_true(chosen(k) .and. chosen(l) .and. count(chosen) == 2, 'any two coordinates serve')
        call shares_of(motions, chosen, shares)
        ! solutions of two equations whose conditioning is some tenths
        call test%near(maxval(abs(shares([k, l], :) - unit)), 0.0_wp, 1.0e-13_wp, 'chosen coordinates move as they do')
        call test%near(maxval(abs(matmul(shares, motions([k, l], :)) - motions)), 0.0_wp, 1.0e-13_wp, 'they give all motions')
      end do
    end do
  end subroutine motions_of_five_bar

  !> Nothing moves while the crank is held.
  subroutine held_coordinate(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type) :: plan
    type(state_type) :: state
    real(wp), allocatable :: motions(:, :)

    call prepare(test, crank_rocker, 0.8_wp, 1, plan, state)
    call find_motions(plan, state, [.true., .false., .false., .false.], motions)
    call test%is_true(size(motions, 2) == 0 .or. all(abs(motions(1, :)) <= 0.0_wp), 'the crank has no rate')
  end subroutine held_coordinate

  !> A block is closed from any guess, on one of both branches; links that cannot meet leave the least gap.
  subroutine blocks(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type) :: plan
    type(state_type) :: state
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(random_type) :: random
    type(error_type), allocatable :: err
    real(wp) :: angle, diagonal
    integer :: trial, k, b

    call prepare(test, crank_rocker, 0.8_wp, 1, plan, state)
    b = findloc([(size(plan%blocks(k)%unknowns), k=1, size(plan%blocks))], 3, dim=1)
    work = new_block_work(plan%blocks(b))
    do trial = 1, 20
      angle = pi*random%symmetric()
      state%q = [angle, (pi*random%symmetric(), k=2, 4)]
      call place_all(plan, state, err)
      call assemble_block(plan, plan%blocks(b), state, work, .true., outcome, err)
      call test%no_error(err, 'a block is closed')
      call test%is_true(outcome%closed, 'it is closed from any guess')
      call test%near(min(maxval(apart(state%q, four_bar_guess(crank_rocker, angle, 1))), &
                         maxval(apart(state%q, four_bar_guess(crank_rocker, angle, -1)))), 0.0_wp, 1.0e-12_wp, &
                     'the position is one of both branches')
    end do
    ! beyond its limit the swinging crank leaves coupler and rocker stretched out, too short by the rest of the way
    call prepare(test, swinging, 0.9_wp*four_bar_limit(swinging, stretched=.true.), 1, plan, state)
    angle = four_bar_limit(swinging, stretched=.true.) + 0.2_wp
    state%q(1) = angle
    call place_all(plan, state, err)
    call assemble_block(plan, plan%blocks(b), state, work, .false., outcome, err)
    call test%is_true(.not. outcome%closed .and. .not. allocated(err), 'beyond its limit it does not close')
    call test%is_true(outcome%worst_closure == 1 .and. outcome%gap > 0.0_wp, 'its chain stays open')
    diagonal = sqrt(swinging%ground**2 + swinging%crank**2 - 2.0_wp*swinging%ground*swinging%crank*cos(angle))
    ! the gap is judged at the end of the chain, the residual at its base, one of its lengths away
    call test%is_true(outcome%gap <= 3.0_wp*(diagonal - swinging%coupler - swinging%rocker), &
                      'it is as much as the links are too short')
  end subroutine blocks

  !> With its crank set free, a four-bar closes from guesses at which it cannot close with its crank held.
  subroutine free_closing(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type) :: plan
    type(state_type) :: state
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err

    call prepare(test, swinging, 0.9_wp*four_bar_limit(swinging, stretched=.true.), 1, plan, state)
    state%q(1) = four_bar_limit(swinging, stretched=.true.) + 0.2_wp
    call close_free(plan, state, .true., outcome, err)
    call test%no_error(err, 'all coordinates may change')
    call test%is_true(outcome%closed, 'then the chain closes')
    call test%is_true(state%q(1) < four_bar_limit(swinging, stretched=.true.), 'the crank comes back to its range')
    call check_closed(test, plan, state, 'a four-bar with its crank set free')
  end subroutine free_closing

  !> The crank comes to any value within its range, and to none beyond it.
  subroutine ways(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type) :: plan
    type(state_type) :: state
    real(wp) :: limits(2), target(4)
    integer :: i
    logical :: arrived

    limits = [four_bar_limit(swinging, stretched=.false.), four_bar_limit(swinging, stretched=.true.)]
    do i = -1, 9, 2
      call prepare(test, swinging, 0.5_wp*sum(limits), 1, plan, state)
      target = state%q
      target(1) = limits(1) + 0.125_wp*i*(limits(2) - limits(1))
      call move_inputs(plan, target, state, arrived)
      call test%is_true(arrived .eqv. (i > 0 .and. i < 8), 'the crank arrives within its range')
      if (.not. arrived) cycle
      call test%near(maxval(apart(state%q, four_bar_guess(swinging, target(1), 1))), 0.0_wp, 1.0e-12_wp, 'on its branch')
    end do
  end subroutine ways

  !> With its crank set free, the swinging four-bar goes over its dead point to the other branch.
  subroutine curve_over_dead_point(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type) :: plan
    type(state_type) :: state, found
    type(curve_type) :: curve
    real(wp) :: limits(2), angle, farthest
    integer :: i, side
    logical :: passed

    limits = [four_bar_limit(swinging, stretched=.false.), four_bar_limit(swinging, stretched=.true.)]
    angle = 0.4_wp*limits(1) + 0.6_wp*limits(2)
    do side = -1, 1, 2
      call prepare(test, swinging, angle, 1, plan, state)
      found = state
      call begin_curve(plan, state, 1, real(side, wp), curve)
      call test%is_true(curve%goes_on, 'the curve goes on')
      farthest = angle
      do i = 1, 10000
        if (.not. curve%goes_on) exit
        call curve%advance(plan, passed, found)
        if (side > 0) farthest = max(farthest, curve%state%q(1))
        if (side < 0) farthest = min(farthest, curve%state%q(1))
        if (passed) exit
      end do
      call test%is_true(passed, 'it comes to another assembly')
      if (.not. passed) cycle
      call test%near(maxval(apart(found%q, four_bar_guess(swinging, angle, -1))), 0.0_wp, 1.0e-11_wp, 'this is the other branch')
      call test%is_true(farthest > limits(1) - 1.0e-9_wp .and. farthest < limits(2) + 1.0e-9_wp, 'the crank stays in its range')
      ! steps are no longer than some hundredths, so that the crank comes near to its limit on the way
      call test%near(farthest, merge(limits(2), limits(1), side > 0), 0.01_wp, 'it goes up to its limit')
    end do
  end subroutine curve_over_dead_point

  !> A generic position is closed, and away from the start.
  subroutine generic(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(generic_position_type) :: position
    type(error_type), allocatable :: err
    logical :: closed

    call general_loop(model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'there is a plan')
    call find_generic_position(plan, plan%blocks, state, position, closed)
    call test%is_true(closed .and. position%exists, 'there is a generic position')
    call check_closed(test, plan, position%state, 'a generic position')
    call test%is_true(maxval(abs(position%state%q - state%q)) > 1.0e-3_wp, 'it is away from the start')
  end subroutine generic

  !> Three parallel cranks carry a coupler: the redundant equation of the third one stays satisfied.
  subroutine parallel_cranks(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: links(2, 6) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 3, 5, 5, 1], [2, 6])
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp), parameter :: at(2, 6) = reshape([0.0_wp, 0.0_wp, 0.3_wp, 0.5_wp, 1.3_wp, 0.5_wp, 1.0_wp, 0.0_wp, &
                                               2.3_wp, 0.5_wp, 2.0_wp, 0.0_wp], [2, 6])
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(locked_chain_type) :: locked
    type(error_type), allocatable :: err
    integer :: k

    call new_mechanism(5, links, [1], model)
    do k = 1, 6
      call add_revolute(model, k, links(1, k), links(2, k), frame([at(:, k), 0.0_wp], z), frame([at(:, k), 0.0_wp], z))
    end do
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'parallel cranks have a plan')
    call find_locked_chain(plan, state, locked)
    call test%is_true(.not. locked%exists, 'no chain is locked')
  end subroutine parallel_cranks
end module test_free_chains
