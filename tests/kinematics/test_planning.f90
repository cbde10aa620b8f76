!> Blocks, ranks and mobility errors.
module test_planning
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_structure, exit_assembly
  use mech9_partition, only: new_partition
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame, fig1, four_bar, general_loop
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

  real(wp), parameter :: origin(3) = 0.0_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('chains_of_fig1')) call chains_of_fig1(test)
    if (test%runs('general')) call general(test)
    if (test%runs('spherical')) call spherical(test)
    if (test%runs('too_few_inputs')) call too_few_inputs(test)
    if (test%runs('too_many_inputs')) call too_many_inputs(test)
    if (test%runs('impossible_lengths')) call impossible_lengths(test)
    if (test%runs('size_by_slides')) call size_by_slides(test)
  end subroutine run

  !> A block that slides 3 m away from its guide makes a mechanism of 3 m, to whichever side it slides.
  subroutine size_by_slides(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: x(3) = [1.0_wp, 0.0_wp, 0.0_wp], starts(2) = [3.0_wp, -3.0_wp]
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: i

    do i = 1, 2
      call new_mechanism(2, reshape([1, 2], [2, 1]), [1], model)
      call add_prismatic(model, 1, 1, 2, frame(origin, x), frame(origin, x))
      model%problem%initial%position = starts(i:i)
      call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
      call test%no_error(err, 'a block that slides has a plan')
      call test%near(plan%length, 3.0_wp, 0.0_wp, 'the size of the mechanism is the way of the block')
      call test%near(plan%unit_of(1), 3.0_wp, 0.0_wp, 'and so is the unit of its coordinate')
    end do
  end subroutine size_by_slides

  !> Driven in its first chain, the two chains are solved one after the other.
  subroutine chains_of_fig1(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: assembled(:)
    integer :: k

    call fig1(5, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'Fig. 1 driven at q5 has a plan')
    call test%is_true(size(plan%blocks) == 2, 'the two chains of Fig. 1 are solved one after the other')
    call test%is_true(all(plan%closures%rank == 3), 'planar chains have three independent equations')
    assembled = state%q
    do k = 1, 7
      call fig1(k, model)
      model%problem%initial%position = assembled
      call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
      call test%no_error(err, 'Fig. 1 driven at any coordinate has a plan')
      if (any(k == [4, 5, 6, 7])) cycle
      call test%is_true(size(plan%blocks) == 1, 'the chains of Fig. 1 driven in the second one are solved together')
    end do
  end subroutine chains_of_fig1

  subroutine general(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err

    call general_loop(model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a general loop has a plan')
    call test%is_true(all(plan%closures%rank == 6), 'a general loop has six independent equations')
  end subroutine general

  !> A four-bar with all axes through one point.
  subroutine spherical(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err

    call new_mechanism(4, reshape([1, 2, 2, 3, 3, 4, 4, 1], [2, 4]), [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, [0.0_wp, 0.0_wp, 1.0_wp]), frame(origin, [0.0_wp, 0.0_wp, 1.0_wp]))
    call add_revolute(model, 2, 2, 3, frame(origin, [0.4_wp, 0.0_wp, 1.0_wp]), frame(origin, [0.4_wp, 0.0_wp, 1.0_wp]))
    call add_revolute(model, 3, 3, 4, frame(origin, [1.0_wp, 0.6_wp, 0.2_wp]), frame(origin, [1.0_wp, 0.6_wp, 0.2_wp]))
    call add_revolute(model, 4, 4, 1, frame(origin, [1.0_wp, 0.0_wp, 0.0_wp]), frame(origin, [1.0_wp, 0.0_wp, 0.0_wp]))
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a spherical four-bar has a plan')
    call test%is_true(all(plan%closures%rank == 3), 'a spherical chain has three independent equations')
  end subroutine spherical

  subroutine too_few_inputs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: k

    call new_mechanism(5, reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 1], [2, 5]), [1], model)
    do k = 1, 5
      call add_revolute(model, k, k, mod(k, 5) + 1, &
                        frame([cos(1.3_wp*k), sin(1.3_wp*k), 0.0_wp], [0.0_wp, 0.0_wp, 1.0_wp]), &
                        frame([cos(1.3_wp*k), sin(1.3_wp*k), 0.0_wp], [0.0_wp, 0.0_wp, 1.0_wp]))
    end do
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%has_error(err, exit_structure, 'a five-bar with one independent coordinate is refused')
    call test%is_true(index(message_of(err), '1 more of the coordinates 2, 3, 4, 5') > 0, &
                      'the message about the five-bar names the coordinates 2 to 5')
  end subroutine too_few_inputs

  subroutine too_many_inputs(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err

    call four_bar(1.0_wp, 1.0_wp, 1.3_wp, 0.9_wp, [0.0_wp, 1.0_wp, 1.0_wp, 1.7_wp], model)
    call new_partition(model%mechanism%structure, [.true., .true., .false., .false.], model%problem%partition)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%is_true(allocated(err), 'a four-bar with two independent coordinates is refused')
  end subroutine too_many_inputs

  subroutine impossible_lengths(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err

    call four_bar(5.0_wp, 1.0_wp, 1.3_wp, 0.9_wp, [0.0_wp, 1.0_wp, 1.0_wp, 1.7_wp], model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%has_error(err, exit_assembly, 'links that are too short to meet are refused')
  end subroutine impossible_lengths
end module test_planning
