!> Inverse dynamics on random mechanisms of open links, closed chains, ladders and planar chains that stand on moving links, with
!> all kinds of loads: at any accelerations, the forces that the independent coordinates need are those of Lagrange's equations,
!> a ddq + h - Q, which come about without the forces in the pairs; and the pairs of each link balance it.
module test_reactions
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_rotation, only: cross
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_equations, complete_accelerations
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  use mech9_required_wrenches, only: required_wrenches_type, find_required
  use mech9_joint_geometry, only: find_geometry
  use mech9_uniqueness, only: uniqueness_type, find_unique
  use mech9_mixed_structures, only: structure_type, random_structure, finished, below
  use mech9_loaded_mechanisms, only: loaded_loop, five_bar, loaded_fig1, open_chain
  use mech9_testing, only: tester_type
  use mech9_counted_memory, only: calls
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('known_mechanisms')) call known_mechanisms(test)
    if (test%runs('random_mechanisms')) call random_mechanisms(test)
  end subroutine run

  subroutine known_mechanisms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(model_type) :: model
    integer :: determined   ! clusters that equilibrium determines

    determined = 0
    call open_chain(model)
    call check(test, determined, random, model, 'an open chain')
    call five_bar(model)
    call check(test, determined, random, model, 'a five-bar')
    call loaded_fig1(5, model)
    call check(test, determined, random, model, 'Fig. 1')
    call loaded_loop(model)
    call check(test, determined, random, model, 'a spatial loop with all kinds of pairs')
  end subroutine known_mechanisms

  subroutine random_mechanisms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(structure_type) :: structure
    type(model_type) :: model
    integer :: trial
    integer :: determined   ! clusters that equilibrium determines

    determined = 0
    do trial = 1, 60
      call random_structure(random, mod(trial, 2) == 0, 2 + below(random, 5), structure)
      call finished(random, structure, model)
      call check(test, determined, random, model, 'a random mechanism')
      if (.not. structure%planar) cycle
      call lay_flat(model)
      call check(test, determined, random, model, 'a flat mechanism')
    end do
    call test%is_true(determined > 30, 'equilibrium determines many clusters')
  end subroutine random_mechanisms

  !> Leave nothing that acts across the x-y plane: bodies in the plane, gravity along it, and loads on coordinates only.
  subroutine lay_flat(model)
    type(model_type), intent(inout) :: model   !< a planar mechanism; its bodies, gravity and loads are changed
    logical :: marked(model%mechanism%structure%n_links)
    integer, allocatable :: kept(:)
    integer :: i

    model%mechanism%gravity(3) = 0.0_wp
    do i = 1, size(model%mechanism%bodies)
      model%mechanism%bodies(i)%centre(3) = 0.0_wp
      model%mechanism%bodies(i)%inertia(1:2, 3) = 0.0_wp
      model%mechanism%bodies(i)%inertia(3, 1:2) = 0.0_wp
    end do
    allocate (kept(0))
    do i = 1, size(model%mechanism%loads)
      marked = .false.
      call model%mechanism%loads(i)%load%mark_links(marked)
      if (.not. any(marked)) kept = [kept, i]
    end do
    model%mechanism%loads = model%mechanism%loads(kept)
  end subroutine lay_flat

  !> Compare at random rates and accelerations.
  subroutine check(test, determined, random, model, why)
    type(tester_type), intent(inout) :: test     !< counts the checks
    integer, intent(inout) :: determined         !< clusters that equilibrium determines
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(model_type), intent(in) :: model        !< the mechanism
    character(len=*), intent(in) :: why          !< its name
    type(plan_type) :: plan
    type(state_type) :: state
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(reaction_plan_type) :: reaction_plan
    type(reactions_type) :: reactions
    type(error_type), allocatable :: err
    real(wp), allocatable :: needed(:), a(:, :)
    type(uniqueness_type) :: unique
    real(wp) :: scale, conditioning
    integer :: i, n, before

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    call make_dynamics_plan(model%mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    n = size(plan%independent)
    state%dq(plan%independent) = [(1.3_wp*random%symmetric(), i=1, n)]
    call find_equations(model%mechanism, plan, dynamics, state, work, err)
    call test%no_error(err, why//': the equations are found')
    work%accelerations = [(3.0_wp*random%symmetric(), i=1, n)]
    a = work%coefficients
    do i = 1, n
      a(i, i + 1:) = a(i + 1:, i)
    end do
    needed = matmul(a, work%accelerations) + work%velocity_terms - work%forces
    if (dynamics%articulated) then
      do i = 1, size(plan%blocks)
        call dynamics%arithmetics(dynamics%arithmetic_of(i))%kind%spread_jacobian(plan, dynamics, plan%blocks(i), state, .true., &
                                                                                  work%jacobian)
      end do
    end if
    call complete_accelerations(plan, dynamics, work, state)
    call make_reaction_plan(model%mechanism, plan, reaction_plan)
    reactions = new_reactions(plan, reaction_plan)
    call find_reactions(model%mechanism, plan, reaction_plan, state, reactions, err)
    call test%no_error(err, why//': the forces are found')
    if (allocated(err)) return
    ! dependent accelerations grow with the inverse square of the conditioning, and their errors with them
    conditioning = 1.0_wp
    do i = 1, size(plan%blocks)
      conditioning = min(conditioning, work%blocks(i)%equations%conditioning())
    end do
    scale = max(maxval(abs(needed)), maxval(abs(reactions%force)), maxval(abs(reactions%moment)))
    call test%near(maxval(abs(reactions%needed(plan%independent) - needed))/scale, 0.0_wp, 1.0e-13_wp/conditioning**2, &
                   why//': independent coordinates need a ddq + h - Q')
    call check_balance(test, model, plan, reaction_plan, state, reactions, scale, why)
    if (conditioning > 1.0e-3_wp) call check_cost(test, determined, plan, reaction_plan, reactions, why)
    call find_unique(plan, reaction_plan, state, unique)
    call test%is_true(all(unique%pairs(:, pack([(i, i=1, plan%n_coordinates)], reaction_plan%alone(plan%step_of)))), &
                      why//': all components of open chains are unique')
    before = calls
    call find_reactions(model%mechanism, plan, reaction_plan, state, reactions, err)
    call find_reactions(model%mechanism, plan, reaction_plan, state, reactions, err)
    call test%is_true(calls == before .and. before > 0, why//': nothing is allocated')
  end subroutine check

  !> The balance of all links of a cluster at once, whose cost is a multiple of that of the motion, is not solved where the
  !> transposed equations of the motion serve: its matrices are still zero.
  subroutine check_cost(test, determined, plan, reaction_plan, reactions, why)
    type(tester_type), intent(inout) :: test                !< counts the checks
    integer, intent(inout) :: determined                    !< clusters that equilibrium determines
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism
    type(reaction_plan_type), intent(in) :: reaction_plan   !< its plan of inverse dynamics
    type(reactions_type), intent(in) :: reactions           !< the forces
    character(len=*), intent(in) :: why                     !< name of the mechanism
    integer :: c

    do c = 1, size(reaction_plan%clusters)
      if (.not. reaction_plan%clusters(c)%determined) cycle
      if (plan%planar%used .and. .not. reaction_plan%flat) cycle
      determined = determined + 1
      call test%is_true(.not. any(abs(reactions%balances(c)%factors%diagonal) > 0.0_wp), &
                        why//': a cluster that equilibrium determines is not solved as a whole')
      if (plan%planar%used) call test%is_true(.not. any(abs(reactions%in_plane(c)%factors%diagonal) > 0.0_wp), &
                                              why//': nor in the plane')
    end do
  end subroutine check_cost

  !> Each link but link 1 receives from its pairs what it requires.
  subroutine check_balance(test, model, plan, reaction_plan, state, reactions, scale, why)
    type(tester_type), intent(inout) :: test                !< counts the checks
    type(model_type), intent(in) :: model                   !< the mechanism
    type(plan_type), intent(in) :: plan                     !< its plan
    type(reaction_plan_type), intent(in) :: reaction_plan   !< its plan of inverse dynamics
    type(state_type), intent(in) :: state                   !< the motion
    type(reactions_type), intent(in) :: reactions           !< the forces
    real(wp), intent(in) :: scale                           !< the largest force [N, N m]
    character(len=*), intent(in) :: why                     !< name of the mechanism
    type(required_wrenches_type) :: links
    real(wp) :: force(3, plan%n_links), moment(3, plan%n_links), arm(3)
    integer :: k, side, link

    links = reactions%links
    call find_geometry(plan, reaction_plan, state, links%geometry)
    call find_required(model%mechanism, plan, reaction_plan, state, links)
    force = links%force
    moment = links%moment
    do k = 1, plan%n_coordinates
      do side = 1, 2
        link = reaction_plan%pairs(k)%links(side)
        arm = links%geometry%point(:, k) - links%geometry%place(:, link)
        force(:, link) = force(:, link) - (3 - 2*side)*reactions%force(:, k)
        moment(:, link) = moment(:, link) - (3 - 2*side)*(reactions%moment(:, k) + cross(arm, reactions%force(:, k)))
      end do
    end do
    call test%near(max(maxval(abs(force(:, 2:))), maxval(abs(moment(:, 2:))))/scale, 0.0_wp, 1.0e-12_wp, &
                   why//': the links are in balance')
    call test%is_true(size(model%mechanism%bodies) > 0, why//': there are masses')
  end subroutine check_balance
end module test_reactions
