!> Wrenches of pairs: a slider-crank and gears in closed form by each way of balance, wrenches of least norm of a cluster with redundant
!> equations, and which components equilibrium determines.
module test_wrenches
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_force_load, only: force_load_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  use mech9_joint_geometry, only: joint_geometry_type, new_joint_geometry, find_geometry
  use mech9_cluster_balance, only: cluster_balance_type, new_cluster_balance
  use mech9_singular_cluster, only: singular_cluster_type, decompose_cluster
  use mech9_coupling_forces, only: coupling_forces_type, new_coupling_forces, draw_idle_couplings
  use mech9_uniqueness, only: uniqueness_type, find_unique
  use mech9_sample_mechanisms, only: four_bar, general_loop, drive
  use mech9_planar_mechanisms, only: slider_crank, four_bar_type, four_bar_guess
  use mech9_loaded_mechanisms, only: add_load
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.4_wp, coupler=0.9_wp, rocker=0.7_wp)

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('slider_crank_flat')) call check_slider_crank(tester, .false., .false.)
    if (tester%runs('slider_crank_in_plane')) call check_slider_crank(tester, .true., .false.)
    if (tester%runs('slider_crank_in_space')) call check_slider_crank(tester, .false., .true.)
    if (tester%runs('least_norm')) call least_norm(tester)
    if (tester%runs('regular_cluster')) call regular_cluster(tester)
    if (tester%runs('unique_in_plane')) call unique_in_plane(tester)
    if (tester%runs('unique_in_space')) call unique_in_space(tester)
    if (tester%runs('gears')) call gears(tester)
    if (tester%runs('repeated_gears')) call repeated_gears(tester)
  end subroutine run

  !> The plan of inverse dynamics of a model at rest, and its position.
  subroutine prepare(tester, model, in_space, plan, reactions, state)
    type(tester_type), intent(inout) :: tester            !< counts the checks
    type(model_type), intent(in) :: model                 !< with constant drives
    logical, intent(in) :: in_space                       !< in spatial arithmetic
    type(plan_type), intent(out) :: plan                  !< its plan
    type(reaction_plan_type), intent(out) :: reactions    !< its plan of inverse dynamics
    type(state_type), intent(out) :: state                !< at rest
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=in_space))
    call tester%no_error(err, 'there is a plan')
    call start_driven_motion(model%problem%drives, plan, state, 0.0_wp, driven, err)
    call tester%no_error(err, 'the motion starts')
    state = driven%state
    call make_reaction_plan(model%mechanism, plan, reactions)
  end subroutine prepare

  !> A force F against the slide of a slider-crank. The rod has an angle with sin b = r sin a/l; it pushes with F/cos b, the guide with
  !> F tan b, and the crank needs the torque -F r sin(a + b)/cos b.
  subroutine check_slider_crank(tester, gravity_across, in_space)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    logical, intent(in) :: gravity_across        !< links without mass do not feel it, but the balance of flat mechanisms is not used
    logical, intent(in) :: in_space              !< in spatial arithmetic, in which the mechanism is overconstrained
    real(wp), parameter :: r = 0.3_wp, l = 1.1_wp, f = 7.0_wp
    type(model_type) :: model
    type(plan_type) :: plan
    type(reaction_plan_type) :: plan_of_forces
    type(reactions_type) :: reactions
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp) :: a, b, rod(3)
    integer :: i, k

    do i = 0, 11
      a = 0.1_wp + i*pi/6.0_wp
      b = asin(r*sin(a)/l)
      call slider_crank(r, l, 0.0_wp, a, 1, model)
      call drive(model, 1, [a])
      call add_load(model, force_load_type(link=4, force=[-f, 0.0_wp, 0.0_wp]))
      if (gravity_across) model%mechanism%gravity = [0.0_wp, 0.0_wp, -9.81_wp]
      call prepare(tester, model, in_space, plan, plan_of_forces, state)
      call tester%is_true(plan_of_forces%flat .eqv. .not. (gravity_across .or. in_space), 'the way of balance')
      reactions = new_reactions(plan, plan_of_forces)
      call find_reactions(model%mechanism, plan, plan_of_forces, state, reactions, err)
      call tester%no_error(err, 'wrenches are found')
      rod = f*[1.0_wp, -tan(b), 0.0_wp]
      ! sums of some terms of order ten; least norm is found by normal equations that are corrected
      do k = 1, 3
        call tester%near(maxval(abs(reactions%force(:, k) - rod)), 0.0_wp, 1.0e-12_wp, 'crank and rod pass on the force of the rod')
      end do
      call tester%near(maxval(abs(reactions%force(:, 4) - [0.0_wp, f*tan(b), 0.0_wp])), 0.0_wp, 1.0e-12_wp, 'the guide')
      call tester%near(reactions%needed(1), -f*r*sin(a + b)/cos(b), 1.0e-12_wp, 'the torque that the crank needs')
      call tester%near(maxval(abs(reactions%moment(:, 1) - [0.0_wp, 0.0_wp, reactions%needed(1)])), 0.0_wp, 1.0e-12_wp, &
                       'the pivot passes on this torque and no other')
      call tester%near(maxval(abs(reactions%moment(:, 2:))), 0.0_wp, 1.0e-12_wp, 'pins have no moment')
    end do
  end subroutine check_slider_crank

  !> The balance of the only cluster of a mechanism in space.
  subroutine balance_of(plan, reactions, state, geometry, balance, regular)
    type(plan_type), intent(in) :: plan                     !< its plan
    type(reaction_plan_type), intent(in) :: reactions       !< its plan of inverse dynamics
    type(state_type), intent(in) :: state                   !< its position
    type(joint_geometry_type), intent(out) :: geometry      !< of the position
    type(cluster_balance_type), intent(out) :: balance      !< the equations
    logical, intent(out) :: regular                         !< the factors can be used

    geometry = new_joint_geometry(plan)
    call find_geometry(plan, reactions, state, geometry)
    balance = new_cluster_balance(reactions, reactions%clusters(1))
    call balance%set_position(reactions%clusters(1), geometry, reactions, reactions%length, regular)
  end subroutine balance_of

  !> A four-bar in space has 18 equations of balance, and 21 unknown components: three at random balance nothing. Wrenches of least
  !> norm have no part along these, and singular values give the same as Cholesky's factors.
  subroutine least_norm(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(reaction_plan_type) :: reactions
    type(state_type) :: state
    type(joint_geometry_type) :: geometry
    type(cluster_balance_type) :: balance
    type(singular_cluster_type) :: singular
    type(random_type) :: random
    real(wp) :: required(6, 3), lacking(6, 3), nothing(6, 3), wrenches(6, 4), others(6, 4), idle(6, 4)
    integer :: trial
    logical :: regular, converged

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.8_wp, 1), model)
    call drive(model, 1, [0.8_wp])
    call prepare(tester, model, .true., plan, reactions, state)
    call balance_of(plan, reactions, state, geometry, balance, regular)
    call tester%is_true(regular, 'the position is regular')
    associate (cluster => reactions%clusters(1))
      call decompose_cluster(cluster, balance, 1.0e-9_wp, singular)
      call tester%is_true(singular%rank == 18, 'all 18 equations are independent')
      nothing = 0.0_wp
      do trial = 1, 10
        call fill(random, required)
        wrenches = 0.0_wp
        call balance%complete(required, wrenches, lacking, converged)
        call tester%is_true(converged, 'the links are in balance')
        call balance%find_lacking(required, wrenches, lacking)
        ! round-off of sums of a dozen wrenches of order ten
        call tester%near(maxval(abs(lacking)), 0.0_wp, 1.0e-13_wp, 'no link lacks anything')
        call tester%near(work_on_held(balance, wrenches), 0.0_wp, 1.0e-13_wp, 'dependent coordinates need no drive')
        others = 0.0_wp
        call singular%complete(balance, required, others, converged)
        call tester%is_true(converged, 'singular values balance the links')
        ! the factors have the square of the condition, some hundred; corrections remove its error
        call tester%near(maxval(abs(others - wrenches)), 0.0_wp, 1.0e-11_wp, 'both ways give the same wrenches')
        call fill(random, idle)
        call take_off_held(balance, idle)
        call singular%remove_determined(idle)
        call balance%find_lacking(nothing, idle, lacking)
        call tester%near(maxval(abs(lacking)), 0.0_wp, 1.0e-13_wp, 'idle wrenches balance each other')
        call tester%is_true(maxval(abs(idle)) > 1.0e-3_wp, 'there are such wrenches')
        call tester%near(sum(idle*wrenches), 0.0_wp, 1.0e-12_wp, 'wrenches of least norm have no part of them')
      end do
    end associate
  end subroutine least_norm

  !> The general loop of seven revolutes has as many unknowns as equations: singular values and Cholesky's factors give the same.
  subroutine regular_cluster(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(reaction_plan_type) :: reactions
    type(state_type) :: state
    type(joint_geometry_type) :: geometry
    type(cluster_balance_type) :: balance
    type(singular_cluster_type) :: singular
    type(random_type) :: random
    real(wp) :: required(6, 6), lacking(6, 6), wrenches(6, 7), others(6, 7)
    logical :: regular, converged

    call general_loop(model)
    call drive(model, 1, [-0.2_wp])
    model%problem%initial%position(1) = -0.2_wp
    call prepare(tester, model, .true., plan, reactions, state)
    call tester%is_true(reactions%clusters(1)%determined, 'equilibrium determines all wrenches')
    call balance_of(plan, reactions, state, geometry, balance, regular)
    call tester%is_true(regular, 'the position is regular')
    associate (cluster => reactions%clusters(1))
      call decompose_cluster(cluster, balance, 1.0e-9_wp, singular)
      call tester%is_true(singular%rank == 36, 'all equations are independent')
      call fill(random, required)
      wrenches = 0.0_wp
      call balance%complete(required, wrenches, lacking, converged)
      call tester%is_true(converged, 'the links are in balance')
      others = 0.0_wp
      call singular%complete(balance, required, others, converged)
      call tester%is_true(converged, 'singular values balance the links')
      call tester%near(maxval(abs(others - wrenches))/maxval(abs(wrenches)), 0.0_wp, 1.0e-10_wp, 'both ways give the same wrenches')
      call fill(random, others)
      call take_off_held(balance, others)
      call singular%remove_determined(others)
      call tester%near(maxval(abs(others)), 0.0_wp, 1.0e-10_wp, 'no wrench but zero balances nothing')
    end associate
  end subroutine regular_cluster

  !> Numbers between -1 and 1 at random.
  subroutine fill(random, numbers)
    type(random_type), intent(inout) :: random   !< source of the numbers
    real(wp), intent(out) :: numbers(:, :)       !< gets them
    integer :: i, j

    do j = 1, size(numbers, 2)
      do i = 1, size(numbers, 1)
        numbers(i, j) = random%symmetric()
      end do
    end do
  end subroutine fill

  !> Take off the parts of wrenches that do work on dependent coordinates.
  subroutine take_off_held(balance, wrenches)
    type(cluster_balance_type), intent(in) :: balance   !< the equations
    real(wp), intent(inout) :: wrenches(:, :)           !< (6,pairs) scaled
    integer :: i

    do i = 1, size(wrenches, 2)
      if (balance%held(i)) wrenches(:, i) = wrenches(:, i) - dot_product(balance%axis(:, i), wrenches(:, i))*balance%axis(:, i)
    end do
  end subroutine take_off_held

  !> The largest work of wrenches on a dependent coordinate.
  real(wp) function work_on_held(balance, wrenches) result(largest)
    type(cluster_balance_type), intent(in) :: balance   !< the equations
    real(wp), intent(in) :: wrenches(:, :)              !< (6,pairs) scaled
    integer :: i

    largest = 0.0_wp
    do i = 1, size(wrenches, 2)
      if (balance%held(i)) largest = max(largest, abs(dot_product(balance%axis(:, i), wrenches(:, i))))
    end do
  end function work_on_held

  !> Of a planar four-bar in space, equilibrium determines what is in the plane.
  subroutine unique_in_plane(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(reaction_plan_type) :: reactions
    type(state_type) :: state
    type(uniqueness_type) :: unique
    integer :: k

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, 0.8_wp, 1), model)
    call drive(model, 1, [0.8_wp])
    call prepare(tester, model, .true., plan, reactions, state)
    call find_unique(plan, reactions, state, unique)
    do k = 1, 4
      call tester%is_true(all(unique%pairs(:, k) .eqv. [.true., .true., .false., .false., .false., .true.]), &
                          'forces in the plane and the moment across it are unique')
    end do
  end subroutine unique_in_plane

  !> Of the general loop, equilibrium determines everything.
  subroutine unique_in_space(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(reaction_plan_type) :: reactions
    type(state_type) :: state
    type(uniqueness_type) :: unique

    call general_loop(model)
    call drive(model, 1, [0.0_wp])
    call prepare(tester, model, .true., plan, reactions, state)
    call find_unique(plan, reactions, state, unique)
    call tester%is_true(all(unique%pairs), 'all components are unique')
  end subroutine unique_in_space

  !> A torque on the second of two geared wheels: the teeth pass on its opposite, and the first wheel needs the ratio times as much.
  subroutine gears(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: text = '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
      '&pair coordinate=2, links=1,3, kind=''revolute'', axis=0,0,1, point=1,0,0 / '// &
      '&coupling kind=''gear'', coordinates=1,2, ratio=-2.5 / &load kind=''torque'', link=3, torque=0,0,4 / '// &
      '&drive coordinate=1, kind=''polynomial'', coefficients=0.3 /'
    type(model_type) :: model
    type(plan_type) :: plan
    type(reaction_plan_type) :: plan_of_forces
    type(reactions_type) :: reactions
    type(state_type) :: state
    type(uniqueness_type) :: unique
    type(error_type), allocatable :: err

    call model_from_text(tester, text, kinematics, model)
    model%problem%initial%position = [0.3_wp, -0.75_wp]
    call prepare(tester, model, .false., plan, plan_of_forces, state)
    call tester%near(state%q(2), -2.5_wp*state%q(1), 1.0e-14_wp, 'the second wheel turns by the ratio')
    reactions = new_reactions(plan, plan_of_forces)
    call find_reactions(model%mechanism, plan, plan_of_forces, state, reactions, err)
    call tester%no_error(err, 'wrenches are found')
    call tester%near(reactions%couplings%values(1), -4.0_wp, 1.0e-14_wp, 'the teeth hold the torque')
    call tester%near(reactions%needed(1), 2.5_wp*4.0_wp, 1.0e-13_wp, 'the first wheel needs the ratio times as much')
    call find_unique(plan, plan_of_forces, state, unique)
    call tester%is_true(all(unique%couplings) .and. all(unique%pairs), 'all forces are unique')
  end subroutine gears

  !> Two equal gears between the same wheels share their forces: none of both is unique, and idle ones cancel each other.
  subroutine repeated_gears(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: gear = '&coupling kind=''gear'', coordinates=1,2, ratio=-2.5 / '
    character(len=*), parameter :: text = '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
      '&pair coordinate=2, links=1,3, kind=''revolute'', axis=0,0,1, point=1,0,0 / '//gear//gear// &
      '&load kind=''torque'', link=3, torque=0,0,4 / &drive coordinate=1, kind=''polynomial'', coefficients=0.3 /'
    type(model_type) :: model
    type(plan_type) :: plan
    type(reaction_plan_type) :: plan_of_forces
    type(reactions_type) :: reactions
    type(coupling_forces_type) :: couplings
    type(state_type) :: state
    type(uniqueness_type) :: unique
    type(random_type) :: random
    type(error_type), allocatable :: err
    real(wp) :: multipliers(2), forces(2)

    call model_from_text(tester, text, kinematics, model)
    model%problem%initial%position = [0.3_wp, -0.75_wp]
    call prepare(tester, model, .false., plan, plan_of_forces, state)
    reactions = new_reactions(plan, plan_of_forces)
    call find_reactions(model%mechanism, plan, plan_of_forces, state, reactions, err)
    call tester%no_error(err, 'wrenches are found')
    ! the least squares of two equal parts
    call tester%near(maxval(abs(reactions%couplings%values + 2.0_wp)), 0.0_wp, 1.0e-13_wp, 'each gear holds half of the torque')
    call tester%near(reactions%needed(1), 2.5_wp*4.0_wp, 1.0e-13_wp, 'the first wheel needs the ratio times as much')
    call find_unique(plan, plan_of_forces, state, unique)
    call tester%is_true(.not. any(unique%couplings), 'no gear has a unique force')
    couplings = new_coupling_forces(plan)
    call draw_idle_couplings(plan, state, random, couplings, multipliers, forces)
    call tester%is_true(maxval(abs(multipliers)) > 1.0e-3_wp, 'there are idle forces')
    call tester%near(maxval(abs(forces)), 0.0_wp, 1.0e-14_wp, 'idle forces cancel each other on each coordinate')
  end subroutine repeated_gears
end module test_wrenches
