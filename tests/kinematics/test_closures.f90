!> The equations of closed chains and couplings: columns of their Jacobians and derivatives in time against differences, in the plane
!> and in space, and gaps of known sizes.
module test_closures
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion
  use mech9_frame_motion, only: place_all, spread_all_velocities, spread_all_accelerations
  use mech9_spatial_closure, only: spatial_closure_type
  use mech9_planar_closure, only: planar_closure_constraint_type
  use mech9_coupling_constraint, only: coupling_constraint_type, find_curves
  use mech9_sample_mechanisms, only: fig1, general_loop, drive
  use mech9_planar_mechanisms, only: slider_crank
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('fig1_in_plane')) call check_fig1(test, .false.)
    if (test%runs('fig1_in_space')) call check_fig1(test, .true.)
    if (test%runs('slide_in_plane')) call check_slide(test, .false.)
    if (test%runs('slide_in_space')) call check_slide(test, .true.)
    if (test%runs('general')) call check_general(test)
    if (test%runs('couplings')) call couplings(test)
    if (test%runs('gaps_in_plane')) call gaps(test, .false.)
    if (test%runs('gaps_in_space')) call gaps(test, .true.)
  end subroutine run

  subroutine check_fig1(test, in_space)
    type(tester_type), intent(inout) :: test   !< counts the checks
    logical, intent(in) :: in_space            !< in spatial arithmetic
    type(model_type) :: model

    call fig1(5, model)
    call drive(model, 5, [model%problem%initial%position(5), 1.0_wp])
    call check_all(test, model, in_space, 'Fig. 1')
  end subroutine check_fig1

  subroutine check_slide(test, in_space)
    type(tester_type), intent(inout) :: test   !< counts the checks
    logical, intent(in) :: in_space            !< in spatial arithmetic
    type(model_type) :: model

    call slider_crank(0.3_wp, 1.1_wp, 0.1_wp, 0.8_wp, 1, model)
    call drive(model, 1, [0.8_wp, 1.0_wp])
    call check_all(test, model, in_space, 'slider-crank')
  end subroutine check_slide

  subroutine check_general(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call general_loop(model)
    call drive(model, 1, [0.0_wp, 1.0_wp])
    call check_all(test, model, .true., 'general loop')
  end subroutine check_general

  !> Gears, and a rack on the second wheel.
  subroutine couplings(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call model_from_text(test, '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
                         '&pair coordinate=2, links=1,3, kind=''revolute'', axis=0,0,1, point=1,0,0 / '// &
                         '&pair coordinate=3, links=3,4, kind=''prismatic'', axis=1,0,0, zero=0,1,0 / '// &
                         '&coupling kind=''gear'', coordinates=1,2, ratio=-2.5 / '// &
                         '&coupling kind=''rack'', coordinates=2,3, radius=0.2 / '// &
                         '&drive coordinate=1, kind=''polynomial'', coefficients=0,1 /', kinematics, model)
    call check_all(test, model, .false., 'gears and a rack')
  end subroutine couplings

  !> Check all closures of a mechanism at its closed start.
  subroutine check_all(test, model, in_space, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the mechanism
    logical, intent(in) :: in_space            !< in spatial arithmetic
    character(len=*), intent(in) :: why        !< its name, for the report of a failure
    type(plan_type) :: plan
    type(state_type) :: state
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err
    integer :: c

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=in_space))
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    call start_driven_motion(model%problem%drives, plan, state, 0.0_wp, driven, err)
    call test%no_error(err, why//': the motion starts')
    state = driven%state
    do c = 1, size(plan%closures)
      select type (item => plan%constraints(c)%item)
      type is (spatial_closure_type)
        call test%is_true(in_space .and. item%closure == c, why//': the closure is in space')
      type is (planar_closure_constraint_type)
        call test%is_true(.not. in_space .and. item%closure == c, why//': the closure is in the plane')
      type is (coupling_constraint_type)
        call test%is_true(plan%closures(c)%coupling > 0, why//': it is a coupling')
      end select
      call check_columns(test, plan, state, c, why)
      call check_rates(test, plan, state, c, why)
    end do
  end subroutine check_all

  !> Columns against differences of the residual.
  subroutine check_columns(test, plan, state, c, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type), intent(in) :: plan        !< the plan
    type(state_type), intent(in) :: state      !< closed
    integer, intent(in) :: c                   !< number of the closure
    character(len=*), intent(in) :: why        !< name of the mechanism
    real(wp), parameter :: h = 1.0_wp/64.0_wp
    type(state_type) :: moved
    real(wp) :: values(6, -half_width:half_width), column(6), slope, second, error
    integer :: i, j, k, s

    associate (item => plan%constraints(c)%item, loop => plan%closures(c)%loop)
      do j = 1, size(loop%steps)
        s = loop%steps(j)
        k = plan%steps(s)%coordinate
        do i = -half_width, half_width
          moved = state
          moved%q(k) = moved%q(k) + i*h*plan%unit_of(k)
          call place(test, plan, moved)
          call item%residual(plan, moved, values(:item%equations, i))
          if (i == 0) call item%column(plan, s, loop%signs(j), moved, column(:item%equations))
        end do
        do i = 1, item%equations
          call test%near(values(i, 0), 0.0_wp, 1.0e-14_wp, why//': it is closed')
          call derivatives_from_stencil(values(i, :), h, slope, second, error)
          ! round-off 2/h times that of the equations
          call test%near(column(i), slope, 1.0e-12_wp, why//': a column is the derivative of the equations')
        end do
      end do
    end associate
  end subroutine check_columns

  !> Place all frames, and find the functions of couplings.
  subroutine place(test, plan, state)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(plan_type), intent(in) :: plan          !< the plan
    type(state_type), intent(inout) :: state     !< with coordinates; gets the frames
    type(error_type), allocatable :: err

    call place_all(plan, state, err)
    if (.not. allocated(err)) call find_curves(plan, 1, size(plan%closures), state, err)
    call test%no_error(err, 'frames are placed')
  end subroutine place

  !> Derivatives in time against differences of the residual along q + dq t + ddq t^2/2: first ones for any rates, second ones for
  !> rates that keep the chains closed, and any accelerations.
  subroutine check_rates(test, plan, state, c, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type), intent(in) :: plan        !< the plan
    type(state_type), intent(in) :: state      !< closed, with rates that keep it so
    integer, intent(in) :: c                   !< number of the closure
    character(len=*), intent(in) :: why        !< name of the mechanism
    real(wp), parameter :: h = 1.0_wp/64.0_wp
    type(state_type) :: start, moved
    type(random_type) :: random
    real(wp) :: values(6, -half_width:half_width), rates(6), derivatives(2), error
    integer :: i, k, order

    associate (item => plan%constraints(c)%item)
      do order = 1, 2
        start = state
        do k = 1, size(start%q)
          if (order == 1) start%dq(k) = random%symmetric()*plan%unit_of(k)
          start%ddq(k) = random%symmetric()*plan%unit_of(k)
        end do
        do i = -half_width, half_width
          moved = start
          moved%q = start%q + i*h*(start%dq + 0.5_wp*i*h*start%ddq)
          call place(test, plan, moved)
          call item%residual(plan, moved, values(:item%equations, i))
          if (i /= 0) cycle
          call spread_all_velocities(plan, moved)
          call spread_all_accelerations(plan, moved)
          call item%rates(plan, order, moved, rates(:item%equations))
        end do
        do i = 1, item%equations
          call derivatives_from_stencil(values(i, :), h, derivatives(1), derivatives(2), error)
          ! round-off 2/h and 8/h^2 times that of the equations
          call test%near(rates(i), derivatives(order), merge(1.0e-12_wp, 1.0e-10_wp, order == 1), why//': derivatives in time')
        end do
      end do
    end associate
  end subroutine check_rates

  !> A slide that is pushed aside opens its chain by as much; an angle that is turned aside, by this angle times the mechanism's size at
  !> least.
  subroutine gaps(test, in_space)
    type(tester_type), intent(inout) :: test   !< counts the checks
    logical, intent(in) :: in_space            !< in spatial arithmetic
    real(wp), parameter :: aside = 0.01_wp
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state, moved
    type(error_type), allocatable :: err
    real(wp) :: gap
    integer :: k

    call slider_crank(0.3_wp, 1.1_wp, 0.1_wp, 0.8_wp, 1, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=in_space))
    call test%no_error(err, 'there is a plan')
    do k = 1, 4
      moved = state
      moved%q(k) = moved%q(k) + aside
      call place(test, plan, moved)
      gap = plan%constraints(1)%item%gap(plan, moved)
      ! round-off of places of order one
      if (k == 4) call test%near(gap, aside, 1.0e-14_wp, 'the gap is the way of the slide')
      if (k < 4) call test%is_true(gap >= aside*plan%length*(1.0_wp - 1.0e-12_wp), 'the gap is no less than the angle')
    end do
  end subroutine gaps
end module test_closures
