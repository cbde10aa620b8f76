!> Driven motion: closed to round-off, rates and accelerations exact, four-bar against its closed form.
module test_driven_motion
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_singular
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_driven_motion, only: driven_motion_type, advance
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_sample_mechanisms, only: drive, fig1, four_bar, general_loop
  use mech9_followed_motions, only: begin_motion
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('fig1')) call fig1_driven(test, 5, [0.5_wp, 6.0_wp], 'Fig. 1')
    if (test%runs('fig1_at_q1')) call fig1_driven(test, 1, [-1.0_wp, 0.4_wp, -0.2_wp], 'Fig. 1 driven at q1')
    if (test%runs('spatial_loop')) call spatial_loop(test)
    if (test%runs('check_four_bar')) call check_four_bar(test)
    if (test%runs('check_dead_point')) call check_dead_point(test)
  end subroutine run

  subroutine fig1_driven(test, driven, coefficients, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, intent(in) :: driven              !< the driven coordinate
    real(wp), intent(in) :: coefficients(:)    !< of its polynomial of time
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    type(model_type) :: model

    call fig1(driven, model)
    call drive(model, driven, coefficients)
    call check_derivatives(test, model, name)
  end subroutine fig1_driven

  subroutine spatial_loop(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call general_loop(model)
    call drive(model, 1, [0.1_wp, 0.4_wp, 0.3_wp])
    call check_derivatives(test, model, 'general loop')
  end subroutine spatial_loop

  !> Rates and accelerations against high-order differences of the positions around t = 0.
  subroutine check_derivatives(test, model, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    real(wp), parameter :: h = 2.0_wp**(-8)
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp), allocatable :: q(:, :), dq(:), ddq(:)
    real(wp) :: first, second, error
    integer :: i, k

    call begin_motion(test, model, -half_width*h, plan, driven)
    allocate (q(-half_width:half_width, plan%n_coordinates))
    q(-half_width, :) = driven%state%q
    do i = 1 - half_width, half_width
      call advance(model%problem%drives, plan, driven, i*h, err)
      call test%no_error(err, name//' goes on')
      q(i, :) = driven%state%q
      if (i == 0) dq = driven%state%dq
      if (i == 0) ddq = driven%state%ddq
    end do
    do k = 1, plan%n_coordinates
      call derivatives_from_stencil(q(:, k), h, first, second, error)
      ! positions are known to 1e-15 over a conditioning of 0.1; differences multiply it by 2/h = 5e2 and 8/h^2 = 5e5
      call test%near(dq(k), first, 1.0e-11_wp, name//': rates are derivatives of positions')
      call test%near(ddq(k), second, 1.0e-8_wp, name//': accelerations are second derivatives')
    end do
    call test%is_true(driven%worst_closure <= 1.0e-13_wp*plan%length, name//' stays closed to round-off')
  end subroutine check_derivatives

  !> A crank-rocker over many turns, with few and with many outputs a turn, against its closed form.
  subroutine check_four_bar(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: ground = 0.40_wp, crank = 0.15_wp, coupler = 0.35_wp, rocker = 0.30_wp
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    integer :: per_turn, i
    real(wp) :: t, expected

    do per_turn = 3, 300, 33
      call four_bar(ground, crank, coupler, rocker, [0.0_wp, 1.0_wp, 1.0_wp, 1.7_wp], model)
      call drive(model, 1, [0.0_wp, 2.0_wp*pi])
      call begin_motion(test, model, 0.0_wp, plan, driven)
      do i = 1, 3*per_turn
        t = real(i, wp)/per_turn
        call advance(model%problem%drives, plan, driven, t, err)
        call test%no_error(err, 'a four-bar goes on')
        expected = rocker_angle(2.0_wp*pi*t)
        ! the closed form loses a few digits in its square root and arc functions
        call test%near(driven%state%q(4), expected, 1.0e-13_wp, 'the rocker has the angle of its closed form')
      end do
      call test%near(driven%state%q(2) + 6.0_wp*pi, coupler_angle(), 1.0e-13_wp, 'the coupler has its angle after three turns')
    end do
  end subroutine check_four_bar

  !> Angle of the rocker of the open branch.
  real(wp) function rocker_angle(angle)
    real(wp), intent(in) :: angle   !< of the crank [rad]
    real(wp), parameter :: ground = 0.40_wp, crank = 0.15_wp, coupler = 0.35_wp, rocker = 0.30_wp
    real(wp) :: x, y, diagonal

    x = crank*cos(angle) - ground
    y = crank*sin(angle)
    diagonal = hypot(x, y)
    rocker_angle = atan2(y, x) - acos((rocker**2 + diagonal**2 - coupler**2)/(2.0_wp*rocker*diagonal))
    rocker_angle = modulo(rocker_angle, 2.0_wp*pi)
  end function rocker_angle

  !> Angle of the coupler against the crank, crank at zero: from the same triangle.
  real(wp) function coupler_angle()
    real(wp), parameter :: ground = 0.40_wp, crank = 0.15_wp, coupler = 0.35_wp, rocker = 0.30_wp
    real(wp) :: diagonal

    diagonal = ground - crank
    coupler_angle = acos((coupler**2 + diagonal**2 - rocker**2)/(2.0_wp*coupler*diagonal))
  end function coupler_angle

  !> A crank that cannot turn fully stops just short of its dead point, on its branch.
  subroutine check_dead_point(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    real(wp) :: limit
    integer :: i

    ! coupler and rocker stretch out when the diagonal is 0.3 + 0.3
    limit = acos((0.4_wp**2 + 0.35_wp**2 - 0.6_wp**2)/(2.0_wp*0.4_wp*0.35_wp))
    call four_bar(0.4_wp, 0.35_wp, 0.3_wp, 0.3_wp, [0.5_wp, 0.5_wp, 1.0_wp, 2.0_wp], model)
    call drive(model, 1, [0.5_wp, 1.0_wp])
    call begin_motion(test, model, 0.0_wp, plan, driven)
    do i = 1, 40
      call advance(model%problem%drives, plan, driven, 0.1_wp*i, err)
      if (allocated(err)) exit
    end do
    call test%has_error(err, exit_singular, 'a motion to a dead point ends with exit code 6')
    ! the motion goes on to 1e-9 of the time that was left when the limit was found
    call test%near(driven%state%q(1), limit, 1.0e-9_wp, 'the motion stops at the dead point of the closed form')
    call test%is_true(driven%state%q(1) <= limit, 'the motion does not go beyond the dead point')
  end subroutine check_dead_point
end module test_driven_motion
