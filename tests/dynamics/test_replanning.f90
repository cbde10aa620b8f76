!> Plans in other independent coordinates that are made from the plan before: they give the accelerations of plans that are made from
!> the beginning, and blocks that do not change are not planned anew. So do plans of dynamics.
!>
!> Compares the program with itself: plans made from the plan before and plans made from the beginning.
module test_replanning
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_partition, only: partition_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, copy_plan
  use mech9_state, only: state_type, copy_state
  use mech9_requested, only: requested_by_results, add_forces
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_replanning, only: replanning_type, wanted_type, replan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_unchanged_blocks, only: unchanged_blocks
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_motion, complete_accelerations
  use mech9_mixed_structures, only: structure_type, random_structure, add_ladder, exchange_some, finished
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Beside a position with a worse conditioned block, round-off would decide the comparison.
  real(wp), parameter :: regular = 0.02_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_changes')) call random_changes(test)
    if (test%runs('rows_of_windows')) call rows_of_windows(test)
  end subroutine run

  !> Structures of 2 to 7 pieces. In each, some blocks exchange an independent coordinate for one of their unknowns; then the
  !> change is taken back.
  subroutine random_changes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(structure_type) :: structure
    type(model_type) :: model
    type(plan_type) :: plan, other
    type(state_type) :: state, other_state
    type(error_type), allocatable :: err
    integer :: trial, served, unserved, same, kept
    logical :: independent(200), found

    kept = 0
    served = 0
    unserved = 0
    same = 0
    do trial = 1, 80
      call random_structure(random, mod(trial, 2) == 0, 2 + mod(trial, 6), structure)
      call finished(random, structure, model)
      call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
      if (allocated(err)) cycle
      associate (chosen => independent(:plan%n_coordinates))
        call exchange_some(random, plan, chosen)
        call compare_change(test, model, plan, state, chosen, other, other_state, found, same, kept)
        served = served + merge(1, 0, found)
        unserved = unserved + merge(0, 1, found)
        if (.not. found) cycle
        chosen = .false.
        chosen(plan%independent) = .true.
        call compare_change(test, model, other, other_state, chosen, plan, state, found, same, kept)
        call test%is_true(found, 'a change of coordinates can be taken back')
      end associate
    end do
    call test%is_true(served > 40 .and. unserved < 20, 'most of the random changes of coordinates serve')
    call test%is_true(same > 40, 'many blocks stay as they are')
    call test%is_true(kept > 40, 'the plan of dynamics keeps the lists of many blocks')
  end subroutine random_changes

  !> Compare a plan that is made from the plan before with one that is made from the beginning.
  subroutine compare_change(test, model, plan, state, independent, other, other_state, found, same, kept)
    type(tester_type), intent(inout) :: test       !< counts the checks
    type(model_type), intent(in) :: model          !< the mechanism
    type(plan_type), intent(in), target :: plan    !< its plan
    type(state_type), intent(in) :: state          !< its closed position
    logical, intent(in) :: independent(:)          !< (M) the other choice
    type(plan_type), intent(out) :: other          !< the plan in these coordinates
    type(state_type), intent(out) :: other_state   !< the same position
    logical, intent(out) :: found                  !< the other coordinates serve
    integer, intent(inout) :: same                 !< number of blocks that stay as they are
    integer, intent(inout) :: kept                 !< number of blocks of which the plan of dynamics keeps the lists
    type(plan_type) :: whole
    type(state_type) :: whole_state
    type(partition_type) :: partition
    type(replanning_type) :: replanning
    type(wanted_type) :: wanted
    type(planning_settings_type) :: settings
    type(error_type), allocatable :: err
    type(dynamics_plan_type) :: before, dynamics, continued
    real(wp), dimension(size(independent)) :: rates, a, b
    real(wp) :: worst
    integer :: k

    wanted%requested = requested_by_results(model%mechanism, model%request%output, pictures=.true.)
    call add_forces(model%mechanism, wanted%requested)
    call model%problem%partition%with_independent(model%mechanism%structure, independent, partition)
    call replan(plan, state, partition, wanted, replanning, err)
    call test%no_error(err, 'pairs with fixed axes have poses')
    found = replanning%serves
    if (.not. found) return
    call copy_plan(replanning%plan, other)
    call copy_state(replanning%state, other_state)
    same = same + count(replanning%same_as > 0)
    call test%is_true(all(other%independent == pack([(k, k=1, size(independent))], independent)), &
                      'the chosen coordinates are the independent ones')
    call test%is_true(maxval(abs(other_state%q - state%q)) <= 0.0_wp, 'the position stays')
    settings%requested = wanted%requested
    settings%known => plan
    call make_plan(model%mechanism, partition, state%q, whole, whole_state, err, settings)
    call test%no_error(err, 'coordinates that serve a plan made from the plan before serve one made from the beginning')
    if (allocated(err)) return
    rates = [(sin(3.0_wp*k), k=1, size(rates))]
    call make_dynamics_plan(model%mechanism, plan, before)
    call make_dynamics_plan(model%mechanism, other, dynamics)
    call make_dynamics_plan(model%mechanism, other, continued, plan, before)
    kept = kept + count(unchanged_blocks(plan, before, other, dynamics))
    call find_accelerations(model, other, dynamics, other_state, rates, a, worst)
    if (worst < regular) return
    call find_accelerations(model, other, continued, other_state, rates, b, worst)
    call test%is_true(maxval(abs(a - b)) <= 0.0_wp, 'a plan of dynamics made from that before is the same')
    call make_dynamics_plan(model%mechanism, whole, dynamics)
    call find_accelerations(model, whole, dynamics, whole_state, rates, b, worst)
    ! round-off of some hundred operations, over the conditioning of chains on chains
    call test%near(maxval(abs(a - b))/maxval(abs(b)), 0.0_wp, 1.0e-9_wp, 'both plans give the same accelerations')
  end subroutine compare_change

  !> The accelerations of all coordinates at a position, for given rates of the independent ones.
  subroutine find_accelerations(model, plan, dynamics, position, rates, accelerations, conditioning)
    type(model_type), intent(in) :: model              !< the mechanism
    type(plan_type), intent(in) :: plan                !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics   !< its plan of dynamics
    type(state_type), intent(in) :: position           !< closed, with frames in place
    real(wp), intent(in) :: rates(:)                   !< (M) those of the independent coordinates count [rad/s, m/s]
    real(wp), intent(out) :: accelerations(:)          !< (M) [rad/s^2, m/s^2]
    real(wp), intent(out) :: conditioning              !< of the worst block
    type(lagrange_work_type) :: work
    type(state_type) :: state
    type(error_type), allocatable :: err

    state = position
    state%dq(plan%independent) = rates(plan%independent)
    work = new_lagrange_work(plan, dynamics)
    call find_motion(model%mechanism, plan, dynamics, state, work, err)
    conditioning = 0.0_wp
    accelerations = 1.0_wp
    if (allocated(err)) return
    call complete_accelerations(plan, dynamics, work, state)
    conditioning = work%conditioning
    accelerations = state%ddq
  end subroutine find_accelerations

  !> In a row of windows, the first upright exchanges its place with a coordinate of the first window: that window is
  !> planned anew, the others stay as they are, whatever their number. The change is rejected where a block is worse
  !> conditioned than is wanted.
  subroutine rows_of_windows(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: numbers(3) = [3, 10, 40]
    type(random_type) :: random
    type(structure_type) :: structure
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(partition_type) :: partition
    type(replanning_type) :: replanning
    type(wanted_type) :: wanted
    type(error_type), allocatable :: err
    logical, allocatable :: independent(:)
    integer :: i

    do i = 1, size(numbers)
      call random_structure(random, .true., 0, structure)
      call add_ladder(random, 1, numbers(i), structure)
      call finished(random, structure, model)
      call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
      call test%no_error(err, 'a row of windows has a plan')
      if (allocated(err)) return
      call test%is_true(size(plan%blocks) == numbers(i), 'each window is a block')
      if (allocated(independent)) deallocate (independent)
      allocate (independent(plan%n_coordinates), source=.false.)
      independent(plan%blocks(1)%coordinates(1)) = .true.
      partition = model%problem%partition%in_same_order(independent)
      wanted = wanted_type(requested_by_results(model%mechanism, model%request%output, pictures=.true.))
      call replan(plan, state, partition, wanted, replanning, err)
      call test%is_true(replanning%serves .and. .not. replanning%rejected, 'a coordinate of the first window serves')
      call test%is_true(count(replanning%same_as == 0) == 1, 'one window is planned anew')
      wanted%least = 1.1_wp
      call replan(plan, state, partition, wanted, replanning, err)
      call test%is_true(replanning%rejected, 'no window is conditioned better than the best')
      wanted%least = 1.0e-6_wp
      allocate (wanted%conditioning(numbers(i)), source=1.0_wp)
      wanted%conditioning(numbers(i)) = 1.0e-9_wp
      call replan(plan, state, partition, wanted, replanning, err)
      call test%is_true(replanning%rejected, 'a window that stays as it is, worse than wanted, makes the change rejected')
    end do
  end subroutine rows_of_windows
end module test_replanning
