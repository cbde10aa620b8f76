!> A planar chain of three unknowns in arithmetic of its own, against that of any block.
!>
!> Compares the program with itself: the arithmetic of a planar chain and that of any block.
module test_planar_chain
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block, solve_rates, solve_accelerations, solve_motion
  use mech9_sample_mechanisms, only: fig1, new_mechanism, add_revolute, add_prismatic, frame
  use mech9_planar_mechanisms, only: four_bar_type, random_crank, slider_crank, watt_six_bar
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_chains')) call random_chains(test)
    if (test%runs('chains_of_fig1')) call chains_of_fig1(test)
  end subroutine run

  subroutine random_chains(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(model_type) :: model
    type(four_bar_type) :: bar
    integer :: trial

    do trial = 1, 20
      call slider_crank(0.3_wp + 0.1_wp*random%symmetric(), 0.9_wp, 0.1_wp*random%symmetric(), 3.0_wp*random%symmetric(), &
                        merge(1, -1, mod(trial, 2) == 0), model)
      call check_same_motion(test, random, model, 1, 'a slider-crank')
      bar = random_crank(random, 0.3_wp)
      call watt_six_bar(bar, [0.4_wp, 0.3_wp], [2.0_wp, 0.5_wp], [2.0_wp, 1.8_wp], random%symmetric(), 1, 1, model)
      call check_same_motion(test, random, model, 2, 'a six-bar')
      call swinging_guide(0.3_wp, 0.7_wp, 3.0_wp*random%symmetric(), model)
      call check_same_motion(test, random, model, 1, 'a slide on a link that turns')
    end do
  end subroutine random_chains

  subroutine chains_of_fig1(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(model_type) :: model

    call fig1(5, model)
    call check_same_motion(test, random, model, 2, 'Fig. 1')
    call fig1(1, model)
    call check_same_motion(test, random, model, 0, 'Fig. 1 driven at q1: its chains need each other')
  end subroutine chains_of_fig1

  !> A block on the crank's pin slides along a guide that swings about a fixed pin.
  subroutine swinging_guide(crank, ground, angle, model)
    real(wp), intent(in) :: crank            !< lengths [m]
    real(wp), intent(in) :: ground           !< lengths [m]
    real(wp), intent(in) :: angle            !< of the crank [rad]
    type(model_type), intent(out) :: model   !< the model
    real(wp), parameter :: x(3) = [1.0_wp, 0.0_wp, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 1.0_wp], origin(3) = 0.0_wp
    integer, parameter :: links(2, 4) = reshape([1, 2, 2, 3, 4, 3, 1, 4], [2, 4])
    real(wp) :: way(2), guide

    call new_mechanism(4, links, [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(model, 2, 2, 3, frame(crank*x, z), frame(origin, z))
    call add_prismatic(model, 3, 4, 3, frame(origin, x), frame(origin, x))
    call add_revolute(model, 4, 1, 4, frame(ground*x, z), frame(origin, z))
    way = crank*[cos(angle), sin(angle)] - [ground, 0.0_wp]
    guide = atan2(way(2), way(1))
    model%problem%initial%position = [angle, guide - angle, norm2(way), guide]
  end subroutine swinging_guide

  !> Rates and accelerations of coordinates and frames, at random ones of the independent coordinates.
  subroutine check_same_motion(test, random, model, chains, name)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    type(model_type), intent(in) :: model        !< the model
    integer, intent(in) :: chains                !< blocks that are such chains
    character(len=*), intent(in) :: name         !< of the mechanism, for the report of a failure
    type(plan_type) :: plan
    type(state_type) :: state, other
    type(error_type), allocatable :: err
    type(block_work_type) :: any_block, chain
    integer :: b, i, found
    real(wp) :: allowed

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, name//': there is a plan')
    if (allocated(err)) return
    do i = 1, size(plan%independent)
      state%dq(plan%independent(i)) = 1.0_wp + random%symmetric()
      state%ddq(plan%independent(i)) = 2.0_wp*random%symmetric()
    end do
    other = state
    found = 0
    allowed = 1.0e-14_wp
    do b = 1, size(plan%blocks)
      associate (block => plan%blocks(b))
        any_block = new_block_work(block)
        chain = new_block_work(block, plan)
        if (chain%chain%used) found = found + 1
        call factorize_block(plan, block, state, any_block)
        call solve_rates(plan, block, state, any_block)
        call solve_accelerations(plan, block, state, any_block)
        call factorize_block(plan, block, other, chain)
        call test%is_true(maxval(abs(chain%jacobian - any_block%jacobian)) <= 4.0_wp*epsilon(1.0_wp), &
                          name//': the Jacobians are equal')
        call solve_motion(plan, block, other, chain)
        ! round-off over the conditioning: once in rates, again in accelerations, and on in the next block
        allowed = allowed*4.0_wp/min(1.0_wp, any_block%equations%conditioning())**2
      end associate
    end do
    call test%is_true(found == chains, name//': the chains of three equations are found')
    call check_close(test, other%dq, state%dq, allowed, name//': the rates are equal')
    call check_close(test, other%ddq, state%ddq, allowed, name//': the accelerations are equal')
    call check_close(test, reshape(other%planar%velocity, [size(state%planar%velocity)]), &
                     reshape(state%planar%velocity, [size(state%planar%velocity)]), allowed, &
                     name//': the velocities of frames are equal')
    call check_close(test, reshape(other%planar%acceleration, [size(state%planar%acceleration)]), &
                     reshape(state%planar%acceleration, [size(state%planar%acceleration)]), allowed, &
                     name//': the accelerations of frames are equal')
  end subroutine check_same_motion

  subroutine check_close(test, values, expected, allowed, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: values(:)          !< values that are checked
    real(wp), intent(in) :: expected(:)        !< the right ones, as many
    real(wp), intent(in) :: allowed            !< largest difference
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure

    call test%near(maxval(abs(values - expected))/max(1.0_wp, maxval(abs(expected))), 0.0_wp, allowed, name)
  end subroutine check_close
end module test_planar_chain
