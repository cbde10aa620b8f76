!> Plans in other independent coordinates: those that take the properties of unchanged loops from the plan before are the plans that
!> are made whole, on random trees of open links and loops, in the plane and in space.
module test_known_loops
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_partition, only: partition_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type, closure_type
  use mech9_state, only: state_type
  use mech9_requested, only: requested_by_results
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_known_loops, only: take_known_loops
  use mech9_mixed_structures, only: structure_type, random_structure, exchange_some, finished
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_changes')) call random_changes(test)
  end subroutine run

  !> Structures of 2 to 7 pieces. In each, some blocks exchange an independent coordinate for one of their unknowns.
  subroutine random_changes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(structure_type) :: structure
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: trial, changes, compared, taken, alike

    compared = 0
    taken = 0
    alike = 0
    do trial = 1, 60
      call random_structure(random, mod(trial, 2) == 0, 2 + mod(trial, 6), structure)
      call finished(random, structure, model)
      call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
      if (allocated(err)) cycle
      do changes = 1, 3
        call compare_change(test, random, model, plan, state, compared, taken, alike)
      end do
    end do
    call test%is_true(compared > 60, 'most of the random changes of coordinates lead to a plan')
    call test%is_true(taken > 20, 'many loops pass the same pairs after a change of coordinates')
    call test%is_true(alike > 20 .and. alike < taken, &
                      'some loops, but not all, are passed from the same base in the same direction')
  end subroutine random_changes

  !> Exchange coordinates at random, and compare the plan that takes known loops with one that takes only the size.
  subroutine compare_change(test, random, model, plan, state, compared, taken, alike)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    type(model_type), intent(in) :: model        !< the mechanism
    type(plan_type), intent(in), target :: plan  !< its plan
    type(state_type), intent(in) :: state        !< its closed position
    integer, intent(inout) :: compared           !< number of changes that were compared
    integer, intent(inout) :: taken              !< number of loops that pass the same pairs as before
    integer, intent(inout) :: alike              !< number of those that begin at the same base in the same direction
    type(plan_type), target :: bare
    type(plan_type) :: whole, shared
    type(state_type) :: whole_state, shared_state
    type(partition_type) :: partition
    type(planning_settings_type) :: settings
    type(error_type), allocatable :: err, shared_err
    logical :: independent(plan%n_coordinates)
    logical, allocatable :: ranked(:), complete(:)

    call exchange_some(random, plan, independent)
    settings%requested = requested_by_results(model%mechanism, model%request%output, pictures=.true.)
    call model%problem%partition%with_independent(model%mechanism%structure, independent, partition)
    bare = plan
    bare%closures = plan%closures(:0)
    settings%known => bare
    call make_plan(model%mechanism, partition, state%q, whole, whole_state, err, settings)
    settings%known => plan
    call make_plan(model%mechanism, partition, state%q, shared, shared_state, shared_err, settings)
    call test%is_true(allocated(err) .eqv. allocated(shared_err), 'known loops do not decide whether coordinates can serve')
    if (allocated(err) .or. allocated(shared_err)) return
    compared = compared + 1
    call compare_plans(test, whole, shared)
    ! both are closed to round-off from the same position
    call test%near(maxval(abs(shared_state%q - whole_state%q)/plan%unit_of), 0.0_wp, 1.0e-11_wp, &
                   'both plans are assembled in the same position')
    allocate (ranked(size(whole%closures)), complete(size(whole%closures)))
    call take_known_loops(plan, whole, ranked, complete)
    taken = taken + count(ranked)
    alike = alike + count(complete)
  end subroutine compare_change

  !> Two plans have the same steps, blocks and closures, and their equations span the same spaces.
  subroutine compare_plans(test, a, b)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type), intent(in) :: a           !< the plan made whole
    type(plan_type), intent(in) :: b           !< the plan with known loops
    integer :: c

    call test%is_true(all(a%steps%coordinate == b%steps%coordinate) .and. all(a%steps%parent == b%steps%parent) .and. &
                      all(a%steps%reversed .eqv. b%steps%reversed), 'both plans have the same steps')
    call test%is_true(size(a%blocks) == size(b%blocks) .and. (a%planar%used .eqv. b%planar%used), &
                      'both plans have as many blocks in the same arithmetic')
    if (size(a%blocks) /= size(b%blocks)) return
    call test%is_true(all(a%blocks%first_step == b%blocks%first_step) .and. all(a%blocks%equations == b%blocks%equations) .and. &
                      all(a%blocks%last_closure == b%blocks%last_closure) .and. all(a%blocks%arithmetic == b%blocks%arithmetic), &
                      'both plans have the same blocks')
    do c = 1, size(a%closures)
      call test%is_true(a%closures(c)%closing == b%closures(c)%closing .and. a%closures(c)%target == b%closures(c)%target .and. &
                        a%closures(c)%rank == b%closures(c)%rank .and. &
                        a%closures(c)%independent_equations == b%closures(c)%independent_equations, &
                        'both plans have the same closures with as many equations')
      call test%near(maxval(abs(projector(a%closures(c)) - projector(b%closures(c)))), 0.0_wp, 1.0e-9_wp, &
                     'the equations of both plans select the same screws')
    end do
  end subroutine compare_plans

  !> The projection of screws on those that the equations of a closure select. Spaces are found to 1e-11 (screw_tolerance).
  pure function projector(closure) result(p)
    type(closure_type), intent(in) :: closure   !< the closure
    real(wp) :: p(6, 6)

    p = matmul(closure%rows(:, :closure%rank), transpose(closure%rows(:, :closure%rank)))
  end function projector
end module test_known_loops
