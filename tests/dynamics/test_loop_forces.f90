!> Forces of closed chains: those that balance each other where equations are redundant, those of gears, and the sum of all forces on
!> the frame, which is the change of momentum less all weights.
module test_loop_forces
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_rotation, only: cross, turn
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_frame_motion, only: point_motion
  use mech9_linearisation, only: linearisation_type, new_linearisation, find_forces
  use mech9_loop_forces, only: loop_forces_type, new_loop_forces, draw_idle_forces, loop_wrenches, eliminate_dependent
  use mech9_tree_forces, only: loop_wrench_type
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, frame, four_bar
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess
  use mech9_loaded_mechanisms, only: check_each_mechanism
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('virtual_work')) call virtual_work(test)
    if (test%runs('idle_forces')) call idle_forces(test)
    if (test%runs('no_idle_forces')) call no_idle_forces(test)
    call check_each_mechanism(test, momentum)
  end subroutine run

  !> Forces on the coordinates of a four-bar leave a torque at the crank that does the same work: dependent forces times the rates per
  !> rate of the crank.
  subroutine virtual_work(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.4_wp, coupler=0.9_wp, rocker=0.7_wp)
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(linearisation_type) :: linearisation
    type(loop_forces_type) :: loops
    type(random_type) :: random
    type(error_type), allocatable :: err
    real(wp) :: forces(4), work
    integer :: trial, k

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.8_wp, 1), model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=.true.))
    call test%no_error(err, 'there is a plan')
    state%dq(1) = 1.0_wp
    call new_linearisation(model%mechanism, plan, linearisation)
    call find_forces(model%mechanism, plan, state, linearisation, err)
    call test%no_error(err, 'the rates are found')
    loops = new_loop_forces(plan)
    do trial = 1, 20
      do k = 1, 4
        forces(k) = random%symmetric()
      end do
      work = dot_product(forces, state%dq)
      call eliminate_dependent(plan, state, linearisation%motion%blocks, loops, forces)
      ! sums of a few products over a conditioning of some tenths
      call test%near(forces(1), work, 1.0e-13_wp, 'the torque at the crank does the work of all')
      call test%near(maxval(abs(forces(2:))), 0.0_wp, 0.0_wp, 'nothing is left for the others')
    end do
  end subroutine virtual_work

  !> A coupler on three parallel cranks has a redundant equation: there are forces of its chains that balance each other on all
  !> coordinates.
  subroutine idle_forces(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: links(2, 6) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 3, 5, 5, 1], [2, 6])
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp), parameter :: at(2, 6) = reshape([0.0_wp, 0.0_wp, 0.3_wp, 0.5_wp, 1.3_wp, 0.5_wp, 1.0_wp, 0.0_wp, &
                                               2.3_wp, 0.5_wp, 2.0_wp, 0.0_wp], [2, 6])
    type(model_type) :: model
    type(loop_wrench_type), allocatable :: wrenches(:)
    type(plan_type) :: plan
    type(state_type) :: state
    integer :: k

    call new_mechanism(5, links, [1], model)
    do k = 1, 6
      call add_revolute(model, k, links(1, k), links(2, k), frame([at(:, k), 0.0_wp], z), frame([at(:, k), 0.0_wp], z))
    end do
    call draw(test, model, plan, state, wrenches)
    call test%is_true(maxval([(norm2(wrenches(k)%force), k=1, size(wrenches))]) > 1.0e-3_wp, 'there are idle forces')
    do k = 1, 6
      ! sums of wrenches of order one, each known to round-off over the conditioning of the chains
      call test%near(power_on(plan, state, wrenches, plan%step_of(k)), 0.0_wp, 1.0e-12_wp, 'they do no work on any coordinate')
    end do
  end subroutine idle_forces

  !> A four-bar whose equations are independent has none.
  subroutine no_idle_forces(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.4_wp, coupler=0.9_wp, rocker=0.7_wp)
    type(model_type) :: model
    type(loop_wrench_type), allocatable :: wrenches(:)
    type(plan_type) :: plan
    type(state_type) :: state

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.8_wp, 1), model)
    call draw(test, model, plan, state, wrenches)
    call test%near(maxval(abs([wrenches(1)%force, wrenches(1)%moment])), 0.0_wp, 1.0e-14_wp, &
                   'the forces that are drawn are taken back, but for their round-off')
  end subroutine no_idle_forces

  !> Idle forces of a mechanism, as forces on the frames of its closed chains.
  subroutine draw(test, model, plan, state, wrenches)
    type(tester_type), intent(inout) :: test                        !< counts the checks
    type(model_type), intent(in) :: model                           !< the mechanism
    type(plan_type), intent(out) :: plan                            !< its plan, in space
    type(state_type), intent(out) :: state                          !< its position
    type(loop_wrench_type), allocatable, intent(out) :: wrenches(:) !< (closures)
    type(linearisation_type) :: linearisation
    type(loop_forces_type) :: loops
    type(random_type) :: random
    type(error_type), allocatable :: err

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=.true.))
    call test%no_error(err, 'there is a plan')
    call new_linearisation(model%mechanism, plan, linearisation)
    call find_forces(model%mechanism, plan, state, linearisation, err)
    call test%no_error(err, 'frames are placed')
    loops = new_loop_forces(plan)
    call draw_idle_forces(plan, state, linearisation%motion%blocks, loops, random)
    allocate (wrenches(size(plan%closures)))
    call loop_wrenches(plan, state, loops, wrenches)
  end subroutine draw

  !> The power of the forces of all chains per unit rate of one step: they act on the closing frame, and
  !> opposite on its target, and are given at the base of each loop in its axes.
  real(wp) function power_on(plan, state, wrenches, s) result(power)
    type(plan_type), intent(in) :: plan                 !< the plan, in space
    type(state_type), intent(in) :: state               !< with the frames
    type(loop_wrench_type), intent(in) :: wrenches(:)   !< (closures)
    integer, intent(in) :: s                            !< the step
    real(wp) :: velocity(3)
    integer :: c, i

    power = 0.0_wp
    do c = 1, size(plan%closures)
      associate (closure => plan%closures(c), r => state%r(:, :, plan%closures(c)%base))
        i = findloc(closure%loop%steps, s, dim=1)
        if (i == 0) cycle
        velocity = state%axis_v(:, s) + cross(state%axis_w(:, s), state%p(:, closure%base) - state%p(:, s))
        power = power + closure%loop%signs(i)*(dot_product(turn(r, wrenches(c)%moment), state%axis_w(:, s)) &
                                               + dot_product(turn(r, wrenches(c)%force), velocity))
      end associate
    end do
  end function power_on

  !> Without loads, the frame carries the rates of momentum of all bodies less their weights.
  subroutine momentum(test, model, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the mechanism; its loads are taken away
    character(len=*), intent(in) :: why        !< its name, for the report of a failure
    type(plan_type) :: plan
    type(state_type) :: state
    type(linearisation_type) :: linearisation
    type(random_type) :: random
    type(error_type), allocatable :: err
    real(wp) :: expected(3), p(3), v(3), a(3), largest
    integer :: i

    deallocate (model%mechanism%loads)
    allocate (model%mechanism%loads(0))
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=.true.))
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    do i = 1, size(plan%independent)
      state%dq(plan%independent(i)) = random%symmetric()
      state%ddq(plan%independent(i)) = random%symmetric()
    end do
    call new_linearisation(model%mechanism, plan, linearisation)
    call find_forces(model%mechanism, plan, state, linearisation, err)
    call test%no_error(err, why//': the forces are found')
    expected = 0.0_wp
    largest = 0.0_wp
    do i = 1, size(model%mechanism%bodies)
      associate (body => model%mechanism%bodies(i))
        call point_motion(plan, state, body%link, body%centre, p, v, a)
        expected = expected + body%mass*(a - model%mechanism%gravity)
        largest = largest + body%mass*norm2(a - model%mechanism%gravity)
      end associate
    end do
    ! forces of closed chains act on two frames of one link, so that they cancel in the sum
    call test%near(norm2(linearisation%tree%force(:, 0) - expected)/largest, 0.0_wp, 1.0e-13_wp, why//': the force on the frame')
  end subroutine momentum
end module test_loop_forces
