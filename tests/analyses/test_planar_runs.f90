!> Runs of planar designs whose positions are closed together: frames against complex numbers, Jacobians against differences, positions
!> and rates of four-bars against their closed form, and the proof that positions lie on one branch.
module test_planar_runs
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_planar_plan, only: planar_step_type
  use mech9_planar_loop, only: turn_on, place_frames, find_residual, find_column, multiply
  use mech9_planar_numbers, only: planar_design_type, place_numbers
  use mech9_planar_run, only: planar_run_type, planar_positions_type, new_planar_run, take_positions, sort_positions, &
    close_positions
  use mech9_planar_branch, only: prove_branch
  use mech9_sample_mechanisms, only: four_bar, drive
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_angle, four_bar_guess, four_bar_limit, random_crank
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Positions of a run; neighbours are some 0.1 rad apart.
  integer, parameter :: n = 60

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('turns')) call turns(tester)
    if (tester%runs('frames')) call frames(tester)
    if (tester%runs('products')) call products(tester)
    if (tester%runs('columns')) call columns(tester)
    if (tester%runs('affine_numbers')) call affine_numbers(tester)
    if (tester%runs('order_of_time')) call order_of_time(tester)
    if (tester%runs('closed_form')) call closed_form(tester)
    if (tester%runs('beyond_dead_point')) call beyond_dead_point(tester)
    if (tester%runs('two_branches')) call two_branches(tester)
  end subroutine run

  !> Cosines and sines that are turned on are those of the sum.
  subroutine turns(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(random_type) :: random
    real(wp) :: start(100), by(100), c(100), s(100)
    integer :: i

    do i = 1, size(start)
      start(i) = 3.0_wp*random%symmetric()
      by(i) = 0.25_wp*random%symmetric()
    end do
    c = cos(start)
    s = sin(start)
    call turn_on(size(start), by, c, s)
    ! the series is exact to 1e-17; a few roundings of numbers below one
    call tester%near(maxval(abs(c - cos(start + by))), 0.0_wp, 4.0_wp*epsilon(1.0_wp), 'cosines of sums')
    call tester%near(maxval(abs(s - sin(start + by))), 0.0_wp, 4.0_wp*epsilon(1.0_wp), 'sines of sums')
  end subroutine turns

  !> A chain of steps that turn and slide at random: the origins of frames as complex numbers.
  subroutine frames(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: m = 6, lead = 5
    type(planar_step_type) :: steps(m)
    type(random_type) :: random
    real(wp) :: q(lead, m), turn(lead, 2, m), frame(lead, 6, 0:m)
    complex(wp) :: place(0:m), direction(0:m), velocity
    integer :: i, k

    do k = 1, m
      steps(k)%parent = k - 1 - k/5
      steps(k)%coordinate = k
      steps(k)%turns = mod(k, 3) > 0
      steps(k)%place = [random%symmetric(), random%symmetric()]
      steps(k)%slide = [cos(real(k, wp)), sin(real(k, wp))]
      do i = 1, lead
        q(i, k) = random%symmetric()
        turn(i, :, k) = [cos(q(i, k)), sin(q(i, k))]
      end do
    end do
    frame = 0.0_wp
    frame(:, 1, 0) = 1.0_wp
    call place_frames(lead, steps, 1, m, q, turn, frame)
    do i = 1, lead
      place(0) = 0.0_wp
      direction(0) = 1.0_wp
      do k = 1, m
        associate (step => steps(k), from => steps(k)%parent)
          velocity = direction(from)*cmplx(step%slide(1), step%slide(2), wp)
          place(k) = place(from) + direction(from)*cmplx(step%place(1), step%place(2), wp)
          if (.not. step%turns) place(k) = place(k) + q(i, k)*velocity
          direction(k) = direction(from)
          if (step%turns) direction(k) = direction(k)*exp(cmplx(0.0_wp, q(i, k), wp))
          ! sums and products of a few numbers of order one
          call tester%near(abs(cmplx(frame(i, 1, k), frame(i, 2, k), wp) - direction(k)), 0.0_wp, 1.0e-14_wp, &
                           'directions of frames')
          call tester%near(abs(cmplx(frame(i, 3, k), frame(i, 4, k), wp) - place(k)), 0.0_wp, 1.0e-14_wp, 'origins of frames')
          if (.not. step%turns) call tester%near(abs(cmplx(frame(i, 5, k), frame(i, 6, k), wp) - velocity), 0.0_wp, 1.0e-14_wp, &
                                                 'velocities of slides')
        end associate
      end do
    end do
  end subroutine frames

  !> Products of matrices and vectors, as matmul forms them.
  subroutine products(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(random_type) :: random
    real(wp) :: matrices(4, 3, 3), vectors(4, 3), found(4, 3)
    integer :: i, j, k

    do k = 1, 3
      do i = 1, 4
        vectors(i, k) = random%symmetric()
        do j = 1, 3
          matrices(i, j, k) = random%symmetric()
        end do
      end do
    end do
    found = 7.0_wp
    call multiply(3, 4, matrices, vectors, found)
    do i = 1, 3
      call tester%near(maxval(abs(found(i, :) - matmul(matrices(i, :, :), vectors(i, :)))), 0.0_wp, 1.0e-15_wp, 'a product')
    end do
    call tester%near(maxval(abs(found(4, :) - 7.0_wp)), 0.0_wp, 0.0_wp, 'positions beyond the number are left alone')
  end subroutine products

  !> A four-bar with its plan, as a design.
  subroutine prepare(tester, bar, angle, branch, model, plan, design, whole)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    type(four_bar_type), intent(in) :: bar               !< its lengths
    real(wp), intent(in) :: angle                        !< of the crank at the start [rad]
    integer, intent(in) :: branch                        !< +1 or -1
    type(model_type), intent(out) :: model               !< with a drive of 1 rad/s
    type(plan_type), intent(out) :: plan                 !< its plan
    type(planar_design_type), intent(out) :: design      !< its numbers in the plane
    type(planar_run_type), intent(out) :: whole            !< prepared
    type(state_type) :: state
    type(error_type), allocatable :: err

    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, angle, branch), model)
    call drive(model, 1, [angle, 1.0_wp])
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call tester%no_error(err, 'a four-bar has a plan')
    design%used = plan%planar%used
    design%steps = plan%planar%steps
    design%closures = plan%planar%closures
    call new_planar_run(plan, model%problem%drives, whole)
    call tester%is_true(whole%used, 'its chain is closed in the plane')
  end subroutine prepare

  !> Columns of the Jacobian against differences of the equations of the chain about a closed position.
  subroutine columns(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: lead = 2*half_width + 1
    real(wp), parameter :: h = 1.0_wp/64.0_wp
    type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.4_wp, coupler=0.9_wp, rocker=0.7_wp)
    type(model_type) :: model
    type(plan_type) :: plan
    type(planar_design_type) :: design
    type(planar_run_type) :: whole
    type(planar_positions_type) :: positions
    real(wp) :: r(lead, 3), column(lead, 3), q(4, lead), first, second, error
    integer :: i, k, s, row

    call prepare(tester, bar, 0.8_wp, 1, model, plan, design, whole)
    do k = 1, 4
      q = spread(four_bar_guess(bar, 0.8_wp, 1), 2, lead)
      do i = 1, lead
        q(k, i) = q(k, i) + h*(i - half_width - 1)
      end do
      call take_positions(design, [(0.0_wp, i=1, lead)], [(0, i=1, lead)], q, whole, positions)
      call place_frames(lead, design%steps, 1, whole%m, positions%q, positions%turn, whole%frames)
      s = plan%step_of(k)
      associate (closure => design%closures(1))
        call find_residual(lead, whole%room, whole%m, closure, whole%per_length, whole%frames, whole%r)
        r = whole%r(:lead, :)
        call find_column(lead, whole%room, design%steps(s), plan%closures(1)%loop%signs( &
                         findloc(plan%closures(1)%loop%steps, s, dim=1))*[1.0_wp, whole%per_length], whole%frames(:, :, s), &
                         whole%frames(:, :, closure%base), whole%column)
        column = whole%column(:lead, :)
      end associate
      do row = 1, 3
        call tester%near(r(half_width + 1, row), 0.0_wp, 1.0e-14_wp, 'the chain is closed in the middle')
        call derivatives_from_stencil(r(:, row), h, first, second, error)
        ! round-off 2/h times that of the equations
        call tester%near(column(half_width + 1, row), first, 1.0e-12_wp, 'a column is the derivative of the equations')
      end do
    end do
  end subroutine columns

  !> The numbers of a design are affine functions of its parameters, in their order.
  subroutine affine_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(planar_design_type) :: design
    type(random_type) :: random
    real(wp), parameter :: x(2) = [1.5_wp, -0.5_wp]
    real(wp) :: expected(11)
    integer :: i

    allocate (design%steps(2), design%closures(1), design%points(3, 1), design%slopes(11, 2))
    design%at = [1.0_wp, 0.25_wp]
    design%base = [(random%symmetric(), i=1, 11)]
    design%slopes = reshape([(random%symmetric(), i=1, 22)], [11, 2])
    call place_numbers(x, design)
    expected = design%base + design%slopes(:, 1)*0.5_wp - design%slopes(:, 2)*0.75_wp
    call tester%near(maxval(abs(design%numbers - expected)), 0.0_wp, 1.0e-15_wp, 'numbers are affine functions')
    call tester%near(maxval(abs([design%steps(1)%place, design%steps(1)%angle, design%steps(2)%place, design%steps(2)%angle, &
                                 design%closures(1)%place, design%points(:, 1)] - expected)), 0.0_wp, 1.0e-15_wp, &
                     'steps come first, then closures and points')
  end subroutine affine_numbers

  !> Positions are sorted by time, forwards or backwards, with all that belongs to them.
  subroutine order_of_time(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.4_wp, coupler=0.9_wp, rocker=0.7_wp)
    real(wp), parameter :: t(4) = [0.3_wp, 0.1_wp, 0.4_wp, 0.2_wp]
    type(model_type) :: model
    type(plan_type) :: plan
    type(planar_design_type) :: design
    type(planar_run_type) :: whole
    type(planar_positions_type) :: positions
    integer :: i, side

    call prepare(tester, bar, 0.0_wp, 1, model, plan, design, whole)
    do side = -1, 1, 2
      call take_positions(design, t, [3, 1, 4, 2], spread(t, 1, 4), whole, positions)
      call sort_positions(real(side, wp), positions)
      call tester%is_true(all(positions%target(:4) == [(merge(i, 5 - i, side > 0), i=1, 4)]), 'targets are in their order')
      call tester%near(maxval(abs(positions%t(:4) - 0.1_wp*positions%target(:4))), 0.0_wp, 1.0e-15_wp, 'times are')
      call tester%near(maxval(abs(positions%q(:4, 3) - positions%t(:4))), 0.0_wp, 0.0_wp, 'coordinates are')
      call tester%near(maxval(abs(positions%turn(:4, 1, 1) - cos(positions%angle(:4, 1)))), 0.0_wp, 1.0e-15_wp, 'cosines are')
    end do
  end subroutine order_of_time

  !> Cranks that turn fully, closed from coordinates that are wrong by up to 0.05 rad: angles and rates of all links, and the proof.
  subroutine closed_form(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: h = 1.0_wp/128.0_wp
    type(random_type) :: random
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(plan_type) :: plan
    type(planar_design_type) :: design
    type(planar_run_type) :: whole
    type(planar_positions_type) :: positions
    real(wp) :: t(n), q(4, n), rocker(-half_width:half_width), rate, unused, error
    integer :: trial, branch, i, j
    logical :: closed, proved

    t = [(2.0_wp*pi*i/n, i=1, n)]
    do trial = 1, 10
      bar = random_crank(random, 0.2_wp)
      do branch = -1, 1, 2
        call prepare(tester, bar, 0.0_wp, branch, model, plan, design, whole)
        call follow_guesses(bar, branch, t, q)
        do i = 1, n
          q(:, i) = q(:, i) + 0.05_wp*[(random%symmetric(), j=1, 4)]
        end do
        call take_positions(design, t, [(i, i=1, n)], q, whole, positions)
        call close_positions(design, model%problem%drives, whole, positions, closed)
        call tester%is_true(closed, 'all positions are closed')
        if (.not. closed) cycle
        do i = 1, n
          q(:, i) = modulo(positions%q(i, :) - four_bar_guess(bar, t(i), branch) + pi, 2.0_wp*pi) - pi
          rocker = [(four_bar_angle(bar, t(i) + j*h, branch), j=-half_width, half_width)]
          rocker = modulo(rocker - rocker(0) + pi, 2.0_wp*pi)
          call derivatives_from_stencil(rocker, h, rate, unused, error)
          ! rates come from a Jacobian whose position is off by 1e-5 at most; other parts of their errors are below 1e-9
          call tester%near(positions%dq(i, 4), rate, 1.0e-5_wp/whole%pivot(i, 1), 'rates of the rocker')
        end do
        ! round-off over the pivot, some tenths
        call tester%near(maxval(abs(q)), 0.0_wp, 1.0e-13_wp, 'positions are those of the closed form')
        call prove_branch(design, model%problem%drives, whole, positions, proved)
        call tester%is_true(proved, 'they lie on one branch')
        call tester%is_true(positions%n >= n .and. count(positions%target(:positions%n) > 0) == n, 'targets are kept')
      end do
    end do
  end subroutine closed_form

  !> Closed positions of one branch whose angles go on without jumps of a turn.
  subroutine follow_guesses(bar, branch, t, q)
    type(four_bar_type), intent(in) :: bar   !< lengths of the four-bar
    integer, intent(in) :: branch            !< +1 or -1
    real(wp), intent(in) :: t(:)             !< angles of the crank [rad]
    real(wp), intent(out) :: q(:, :)         !< coordinates [rad]
    integer :: i

    do i = 1, size(t)
      q(:, i) = four_bar_guess(bar, t(i), branch)
      if (i > 1) q(:, i) = q(:, i - 1) + modulo(q(:, i) - q(:, i - 1) + pi, 2.0_wp*pi) - pi
    end do
  end subroutine follow_guesses

  !> No positions are closed beyond a dead point.
  subroutine beyond_dead_point(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.75_wp, coupler=1.0_wp, rocker=0.4_wp)
    type(model_type) :: model
    type(plan_type) :: plan
    type(planar_design_type) :: design
    type(planar_run_type) :: whole
    type(planar_positions_type) :: positions
    real(wp) :: limit
    integer :: side
    logical :: closed

    limit = four_bar_limit(bar, stretched=.true.)
    do side = -1, 1, 2
      call prepare(tester, bar, limit, 1, model, plan, design, whole)
      call take_positions(design, [0.01_wp*side], [1], reshape(four_bar_guess(bar, limit + 0.01_wp*side, 1), [4, 1]), whole, &
                          positions)
      call close_positions(design, model%problem%drives, whole, positions, closed)
      call tester%is_true(closed .eqv. side < 0, 'positions before the dead point are closed, and those beyond it are not')
    end do
  end subroutine beyond_dead_point

  !> Closed positions of which the last ones lie on the other branch are no run.
  subroutine two_branches(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(random_type) :: random
    type(four_bar_type) :: bar
    type(model_type) :: model
    type(plan_type) :: plan
    type(planar_design_type) :: design
    type(planar_run_type) :: whole
    type(planar_positions_type) :: positions
    real(wp) :: t(n), q(4, n)
    integer :: trial, i
    logical :: closed, proved

    t = [(2.0_wp*pi*i/n, i=1, n)]
    do trial = 1, 20
      ! the smaller the excess, the nearer the branches come to each other
      bar = random_crank(random, 10.0_wp**(-0.2_wp*trial))
      call prepare(tester, bar, 0.0_wp, 1, model, plan, design, whole)
      call follow_guesses(bar, 1, t(:n/2), q(:, :n/2))
      call follow_guesses(bar, -1, t(n/2 + 1:), q(:, n/2 + 1:))
      q(:, n/2 + 1:) = q(:, n/2 + 1:) + 2.0_wp*pi*spread(nint((q(:, n/2) - q(:, n/2 + 1))/(2.0_wp*pi)), 2, n/2)
      call take_positions(design, t, [(i, i=1, n)], q, whole, positions)
      call close_positions(design, model%problem%drives, whole, positions, closed)
      call tester%is_true(closed, 'all positions are closed')
      call prove_branch(design, model%problem%drives, whole, positions, proved)
      call tester%is_true(.not. proved, 'positions of two branches are no run')
    end do
  end subroutine two_branches
end module test_planar_runs
