!> Variations of frames along the steps of a plan, from those of the coordinates: the derivatives of the recursions by which
!> poses, velocities and accelerations spread in space.
module mech9_frame_variation
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, step_count, trial_step, derivatives_from_stencil
  use mech9_rotation, only: turn, cross, combine
  use mech9_pair, only: pair_motion_type, pair_thirds_type, reversed_motion, reversed_thirds
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_variation, only: variation_type
  implicit none
  private
  public :: third_derivatives_type, new_third_derivatives, find_third_derivatives
  public :: vary_positions, vary_velocities, vary_accelerations

  !> Derivatives in q of axis_w_rate and axis_v_rate of pairs without a fixed axis, with the parent frame fixed. Where such a pair
  !> gives two derivatives of its pose only, the third is found from differences of the second, to near round-off.
  type :: third_derivatives_type
    real(wp), allocatable :: w(:, :)   !< (3,M) third derivative of the rotation, zero for steps along fixed axes
    real(wp), allocatable :: v(:, :)   !< (3,M) of the origin
    real(wp), allocatable :: couplings(:)   !< (couplings) of their functions
  end type third_derivatives_type

contains

  !> Third derivatives that are zero.
  pure function new_third_derivatives(plan) result(third)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(third_derivatives_type) :: third

    allocate (third%w(3, plan%n_coordinates), third%v(3, plan%n_coordinates), third%couplings(size(plan%couplings)), source=0.0_wp)
  end function new_third_derivatives

  !> Find the third derivatives of the pairs without a fixed axis that move, those at rest need none, and of couplings.
  subroutine find_third_derivatives(plan, state, third, err)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                 !< with poses and rates
    type(third_derivatives_type), intent(inout) :: third  !< gets the derivatives
    type(error_type), allocatable, intent(out) :: err     !< allocated if a pair has no pose near its present one
    integer :: s
    logical :: known

    do s = 1, plan%n_coordinates
      if (plan%steps(s)%is_screw) cycle
      third%w(:, s) = 0.0_wp
      third%v(:, s) = 0.0_wp
      if (.not. abs(state%dq(plan%steps(s)%coordinate)) > 0.0_wp) cycle
      call take_known(plan, state, s, third, known, err)
      if (.not. (known .or. allocated(err))) call differentiate_pair(plan, state, s, third, err)
      if (allocated(err)) return
    end do
    do s = 1, size(plan%couplings)
      associate (coupling => plan%couplings(s)%coupling)
        call coupling%find_third(state%q(coupling%coordinates(1)), third%couplings(s), err)
      end associate
      if (allocated(err)) return
    end do
  end subroutine find_third_derivatives

  !> Take the third derivatives of one pair, where it knows them.
  subroutine take_known(plan, state, s, third, known, err)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                 !< with poses
    integer, intent(in) :: s                              !< step of the pair
    type(third_derivatives_type), intent(inout) :: third  !< gets the derivatives of this step, where they are known
    logical, intent(out) :: known                         !< the pair knows them
    type(error_type), allocatable, intent(out) :: err     !< allocated if the pair has no pose
    type(pair_thirds_type) :: thirds
    type(pair_motion_type) :: motion
    real(wp) :: departing(3, 3)

    associate (step => plan%steps(s), pair => plan%pairs(plan%steps(s)%coordinate)%pair)
      call pair%thirds(state%q(step%coordinate), thirds)
      known = thirds%known
      if (.not. known) return
      if (step%reversed) then
        call pair%evaluate(state%q(step%coordinate), motion, err)
        if (allocated(err)) return
        thirds = reversed_thirds(motion, thirds)
      end if
      departing = combine(state%r(:, :, step%parent), step%before%r)
    end associate
    third%w(:, s) = turn(departing, thirds%w)
    third%v(:, s) = turn(departing, thirds%v)
  end subroutine take_known

  !> The third derivatives of one pair, by the stencil whose two highest orders agree best.
  subroutine differentiate_pair(plan, state, s, third, err)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                 !< with poses
    integer, intent(in) :: s                              !< step of the pair
    type(third_derivatives_type), intent(inout) :: third  !< gets the derivatives of this step
    type(error_type), allocatable, intent(out) :: err     !< allocated if the pair has no pose near its present one
    real(wp) :: values(6, -half_width:half_width), trial(6), derivative(6), h, worst, best, error, second, departing(3, 3)
    integer :: number, i

    best = huge(best)
    derivative = 0.0_wp
    do number = 1, step_count
      h = trial_step(number, 1.0_wp)
      call sample(plan, s, state%q(plan%steps(s)%coordinate), h, values, err)
      if (allocated(err) .or. .not. all(ieee_is_finite(values))) cycle
      worst = 0.0_wp
      do i = 1, 6
        call derivatives_from_stencil(values(i, :), h, trial(i), second, error)
        worst = max(worst, h*error)
      end do
      if (worst < best) then
        best = worst
        derivative = trial
      end if
      if (worst <= 64.0_wp*epsilon(h)*maxval(abs(values))/h) exit
    end do
    if (.not. best < huge(best)) return
    if (allocated(err)) deallocate (err)
    departing = combine(state%r(:, :, plan%steps(s)%parent), plan%steps(s)%before%r)
    third%w(:, s) = turn(departing, derivative(:3))
    third%v(:, s) = turn(departing, derivative(4:))
  end subroutine differentiate_pair

  !> Second derivatives of a pair on both sides of its present position.
  subroutine sample(plan, s, q, h, values, err)
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism, in space
    integer, intent(in) :: s                                !< step of the pair
    real(wp), intent(in) :: q                               !< its coordinate
    real(wp), intent(in) :: h                               !< distance of neighbouring positions, in the unit of q
    real(wp), intent(out) :: values(6, -half_width:half_width)   !< w_rate and v_rate in the departing frame
    type(error_type), allocatable, intent(out) :: err       !< allocated if the pair has no pose there
    type(pair_motion_type) :: motion
    integer :: i

    do i = -half_width, half_width
      call plan%pairs(plan%steps(s)%coordinate)%pair%evaluate(q + i*h, motion, err)
      if (allocated(err)) return
      if (plan%steps(s)%reversed) motion = reversed_motion(motion)
      values(:3, i) = motion%w_rate
      values(4:, i) = motion%v_rate
    end do
  end subroutine sample

  !> Rotations and shifts of frames, and variations of the screws of their steps, from variations of the coordinates.
  pure subroutine vary_positions(plan, state, first, last, variation)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state              !< with poses and screws
    integer, intent(in) :: first                       !< frames from this one
    integer, intent(in) :: last                        !< to this one
    type(variation_type), intent(inout) :: variation   !< with `q`; gets the frames
    real(wp) :: arm(3), dq
    integer :: s, i

    do s = first, last
      i = plan%steps(s)%parent
      dq = variation%q(plan%steps(s)%coordinate)
      arm = state%p(:, s) - state%p(:, i)
      associate (turn => variation%turn, axis_w => state%axis_w(:, s), axis_v => state%axis_v(:, s))
        turn(:, s) = turn(:, i) + dq*axis_w
        variation%shift(:, s) = variation%shift(:, i) + cross(turn(:, i), arm) + dq*axis_v
        variation%axis_w(:, s) = cross(turn(:, i), axis_w) + dq*state%axis_w_rate(:, s)
        variation%axis_v(:, s) = cross(turn(:, i), axis_v) + dq*state%axis_v_rate(:, s)
      end associate
    end do
  end subroutine vary_positions

  !> Variations of the velocities of frames, after those of their positions.
  pure subroutine vary_velocities(plan, state, first, last, variation)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state              !< with velocities
    integer, intent(in) :: first                       !< frames from this one
    integer, intent(in) :: last                        !< to this one
    type(variation_type), intent(inout) :: variation   !< with positions and `dq`; gets the velocities
    real(wp) :: arm(3), arm_change(3), rate, rate_change
    integer :: s, i

    do s = first, last
      i = plan%steps(s)%parent
      rate = state%dq(plan%steps(s)%coordinate)
      rate_change = variation%dq(plan%steps(s)%coordinate)
      arm = state%p(:, s) - state%p(:, i)
      arm_change = variation%shift(:, s) - variation%shift(:, i)
      variation%omega(:, s) = variation%omega(:, i) + rate_change*state%axis_w(:, s) + rate*variation%axis_w(:, s)
      variation%v(:, s) = variation%v(:, i) + cross(variation%omega(:, i), arm) + cross(state%omega(:, i), arm_change) &
                          + rate_change*state%axis_v(:, s) + rate*variation%axis_v(:, s)
    end do
  end subroutine vary_velocities

  !> Variations of the accelerations of frames, after those of their velocities.
  pure subroutine vary_accelerations(plan, state, third, first, last, variation)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state               !< with velocities and accelerations
    type(third_derivatives_type), intent(in) :: third   !< of the pairs without a fixed axis
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    type(variation_type), intent(inout) :: variation    !< with velocities and `ddq`; gets the accelerations
    integer :: s

    do s = first, last
      call vary_acceleration(plan%steps(s)%parent, plan%steps(s)%coordinate, s, state, variation)
      if (plan%steps(s)%is_screw) cycle
      call add_uneven_pair(plan%steps(s)%parent, plan%steps(s)%coordinate, s, state, third, variation)
    end do
  end subroutine vary_accelerations

  !> The variation of the acceleration of one frame, whose step has a fixed axis.
  pure subroutine vary_acceleration(i, k, s, state, variation)
    integer, intent(in) :: i                           !< the parent frame
    integer, intent(in) :: k                           !< the coordinate of the step
    integer, intent(in) :: s                           !< the step, and its frame
    type(state_type), intent(in) :: state              !< with velocities and accelerations
    type(variation_type), intent(inout) :: variation   !< with velocities and `ddq`; gets the acceleration
    real(wp) :: arm(3), arm_change(3), slip(3), slip_change(3), turning(3), turning_change(3), rate, rate_change

    rate = state%dq(k)
    rate_change = variation%dq(k)
    arm = state%p(:, s) - state%p(:, i)
    arm_change = variation%shift(:, s) - variation%shift(:, i)
    turning = rate*state%axis_w(:, s)
    turning_change = rate_change*state%axis_w(:, s) + rate*variation%axis_w(:, s)
    slip = cross(state%omega(:, i), arm) + 2.0_wp*rate*state%axis_v(:, s)
    slip_change = cross(variation%omega(:, i), arm) + cross(state%omega(:, i), arm_change) &
                  + 2.0_wp*(rate_change*state%axis_v(:, s) + rate*variation%axis_v(:, s))
    variation%alpha(:, s) = variation%alpha(:, i) + variation%ddq(k)*state%axis_w(:, s) + state%ddq(k)*variation%axis_w(:, s) &
                            + cross(variation%omega(:, i), turning) + cross(state%omega(:, i), turning_change)
    variation%a(:, s) = variation%a(:, i) + cross(variation%alpha(:, i), arm) + cross(state%alpha(:, i), arm_change) &
                        + variation%ddq(k)*state%axis_v(:, s) + state%ddq(k)*variation%axis_v(:, s) &
                        + cross(variation%omega(:, i), slip) + cross(state%omega(:, i), slip_change)
  end subroutine vary_acceleration

  !> Add the terms of a pair without a fixed axis: rate^2 times the second derivatives of its pose.
  pure subroutine add_uneven_pair(i, k, s, state, third, variation)
    integer, intent(in) :: i                            !< the parent frame
    integer, intent(in) :: k                            !< the coordinate of the step
    integer, intent(in) :: s                            !< the step, and its frame
    type(state_type), intent(in) :: state               !< with rates and the second derivatives of the pair
    type(third_derivatives_type), intent(in) :: third   !< of the pair
    type(variation_type), intent(inout) :: variation    !< gets the terms
    real(wp) :: rate, double

    rate = state%dq(k)
    double = 2.0_wp*rate*variation%dq(k)
    associate (w => state%axis_w_rate(:, s), v => state%axis_v_rate(:, s), turn => variation%turn(:, i))
      variation%alpha(:, s) = variation%alpha(:, s) + double*w + rate**2*(cross(turn, w) + variation%q(k)*third%w(:, s))
      variation%a(:, s) = variation%a(:, s) + double*v + rate**2*(cross(turn, v) + variation%q(k)*third%v(:, s))
    end associate
  end subroutine add_uneven_pair
end module mech9_frame_variation
