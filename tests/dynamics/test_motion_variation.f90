!> Variations of motions: of all coordinates and frames, with two derivatives in time, by position, rate and acceleration of each
!> independent coordinate, against differences of closed motions.
module test_motion_variation
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_rotation, only: cross
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_linearisation, only: linearisation_type, new_linearisation, find_forces
  use mech9_variation, only: variation_type, new_variation
  use mech9_motion_variation, only: vary_motion, vary_position
  use mech9_literal_lagrange, only: close_chains
  use mech9_loaded_mechanisms, only: check_each_mechanism
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    call check_each_mechanism(test, compare)
  end subroutine run

  !> Compare the variations of a motion with random rates and accelerations.
  subroutine compare(test, model, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the mechanism
    character(len=*), intent(in) :: why        !< its name, for the report of a failure
    type(plan_type) :: plan
    type(state_type) :: state, moved
    type(linearisation_type) :: linearisation
    type(variation_type) :: variation
    type(random_type) :: random
    type(error_type), allocatable :: err
    real(wp), allocatable :: numbers(:, :)
    integer :: i, order, k

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=.true.))
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    do i = 1, size(plan%independent)
      state%dq(plan%independent(i)) = random%symmetric()
      state%ddq(plan%independent(i)) = random%symmetric()
    end do
    call new_linearisation(model%mechanism, plan, linearisation)
    variation = new_variation(plan)
    allocate (numbers(3*plan%n_coordinates + 24*plan%n_coordinates, -half_width:half_width))
    do i = 1, size(plan%independent)
      k = plan%independent(i)
      do order = 0, 2
        call find_numbers(test, model, plan, linearisation, state, k, order, numbers)
        moved = state
        call find_forces(model%mechanism, plan, moved, linearisation, err)
        call variation%clear()
        if (order == 0) variation%q(k) = 1.0_wp
        if (order == 1) variation%dq(k) = 1.0_wp
        if (order == 2) variation%ddq(k) = 1.0_wp
        call vary_motion(plan, moved, linearisation%motion, variation)
        call compare_numbers(test, moved, variation, numbers, why)
      end do
      call check_position(test, plan, moved, linearisation, k, why)
    end do
  end subroutine compare

  !> The numbers of motions with one number of an independent coordinate changed by steps of 1/256.
  subroutine find_numbers(test, model, plan, linearisation, state, k, order, numbers)
    type(tester_type), intent(inout) :: test                     !< counts the checks
    type(model_type), intent(in) :: model                        !< the mechanism
    type(plan_type), intent(in) :: plan                          !< its plan, in space
    type(linearisation_type), intent(inout) :: linearisation     !< room
    type(state_type), intent(in) :: state                        !< closed, with independent rates and accelerations
    integer, intent(in) :: k                                     !< the coordinate
    integer, intent(in) :: order                                 !< of the derivative in time that changes
    real(wp), intent(out) :: numbers(:, -half_width:)            !< of each motion
    real(wp), parameter :: h = 1.0_wp/256.0_wp
    type(state_type) :: moved
    type(error_type), allocatable :: err
    integer :: i, m

    m = plan%n_coordinates
    do i = -half_width, half_width
      moved = state
      if (order == 0) moved%q(k) = moved%q(k) + i*h
      if (order == 1) moved%dq(k) = moved%dq(k) + i*h
      if (order == 2) moved%ddq(k) = moved%ddq(k) + i*h
      call close_chains(plan, moved, err)
      if (.not. allocated(err)) call find_forces(model%mechanism, plan, moved, linearisation, err)
      call test%no_error(err, 'there is a motion nearby')
      numbers(:, i) = [moved%q, moved%dq, moved%ddq, reshape(moved%p(:, 1:m), [3*m]), reshape(moved%v(:, 1:m), [3*m]), &
                       reshape(moved%a(:, 1:m), [3*m]), reshape(moved%omega(:, 1:m), [3*m]), reshape(moved%alpha(:, 1:m), [3*m]), &
                       reshape(moved%r(:, :, 1:m), [9*m])]
    end do
  end subroutine find_numbers

  !> Compare the numbers of a variation with differences.
  subroutine compare_numbers(test, state, variation, numbers, why)
    type(tester_type), intent(inout) :: test                !< counts the checks
    type(state_type), intent(in) :: state                   !< the motion
    type(variation_type), intent(in) :: variation           !< its variation
    real(wp), intent(in) :: numbers(:, -half_width:)        !< of motions nearby
    character(len=*), intent(in) :: why                     !< name of the mechanism
    real(wp), parameter :: h = 1.0_wp/256.0_wp
    real(wp) :: found(size(numbers, 1)), slopes(size(numbers, 1)), turned(3, 3, size(state%q)), second, error
    integer :: i, m, axis

    m = size(state%q)
    do i = 1, m
      do axis = 1, 3
        turned(:, axis, i) = cross(variation%turn(:, i), state%r(:, axis, i))
      end do
    end do
    found = [variation%q, variation%dq, variation%ddq, reshape(variation%shift(:, 1:m), [3*m]), &
             reshape(variation%v(:, 1:m), [3*m]), reshape(variation%a(:, 1:m), [3*m]), reshape(variation%omega(:, 1:m), [3*m]), &
             reshape(variation%alpha(:, 1:m), [3*m]), reshape(turned, [9*m])]
    do i = 1, size(found)
      call derivatives_from_stencil(numbers(i, :), h, slopes(i), second, error)
    end do
    ! differences lose 2/h = 512 units of round-off times the conditioning of the chains, some hundreds, and accelerations this twice
    call test%near(maxval(abs(found - slopes))/max(1.0_wp, maxval(abs(slopes))), 0.0_wp, 1.0e-9_wp, &
                   why//': variations are the derivatives of the motion')
  end subroutine compare_numbers

  !> The variation of the position alone is that of the motion.
  subroutine check_position(test, plan, state, linearisation, k, why)
    type(tester_type), intent(inout) :: test                     !< counts the checks
    type(plan_type), intent(in) :: plan                          !< the plan, in space
    type(state_type), intent(in) :: state                        !< the motion
    type(linearisation_type), intent(inout) :: linearisation     !< prepared for it
    integer, intent(in) :: k                                     !< an independent coordinate
    character(len=*), intent(in) :: why                          !< name of the mechanism
    type(variation_type) :: position, motion

    position = new_variation(plan)
    motion = position
    position%q(k) = 1.0_wp
    motion%q(k) = 1.0_wp
    call vary_position(plan, state, linearisation%motion, position)
    call vary_motion(plan, state, linearisation%motion, motion)
    call test%near(maxval(abs(position%q - motion%q)), 0.0_wp, 0.0_wp, why//': coordinates vary alike')
    call test%near(maxval(abs(position%shift - motion%shift)), 0.0_wp, 0.0_wp, why//': frames vary alike')
  end subroutine check_position
end module test_motion_variation
