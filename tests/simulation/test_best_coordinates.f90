!> The choice of independent coordinates: near singular positions of the present ones, those that are chosen leave dependent ones
!> whose Jacobian is conditioned as well as that of any other choice, but for the factor that QR with column pivoting can lose.
!>
!> Every choice is tried, by singular values of a Jacobian that is put together here from the screws of the steps. The rates of a
!> four-bar have a closed form.
module test_best_coordinates
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_lapack, only: dgesvd
  use mech9_rotation, only: cross
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: place_all
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_coordinate_choice, only: best_independent
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, frame, four_bar, general_loop
  use mech9_planar_mechanisms, only: four_bar_type, four_bar_guess, four_bar_limit, two_circles
  use mech9_loaded_mechanisms, only: loaded_fig1, five_bar, two_loops
  use mech9_literal_lagrange, only: close_chains
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> The rows of a screw (w, v) that count in the plane z = 0, and in space.
  integer, parameter :: in_plane(3) = [3, 4, 5], in_space(6) = [1, 2, 3, 4, 5, 6]
  !> Its crank swings: coupler and rocker can be stretched out and folded.
  type(four_bar_type), parameter :: bar = four_bar_type(ground=1.0_wp, crank=0.75_wp, coupler=1.0_wp, rocker=0.4_wp)

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_four_bar')) call check_four_bar(test)
    if (test%runs('check_five_bar')) call check_five_bar(test)
    if (test%runs('check_two_four_bars')) call check_two_four_bars(test)
    if (test%runs('check_fig1')) call check_fig1(test)
    if (test%runs('check_general_loop')) call check_general_loop(test)
    if (test%runs('check_two_loops')) call check_two_loops(test)
  end subroutine run

  subroutine check_fig1(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call loaded_fig1(1, model)
    call check_towards_limit(test, model, in_plane, 'Fig. 1 at the end of the range of coordinate 1')
  end subroutine check_fig1

  subroutine check_general_loop(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call general_loop(model)
    call check_towards_limit(test, model, in_space, 'a spatial loop at the end of the range of coordinate 1')
  end subroutine check_general_loop

  subroutine check_two_loops(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call two_loops([1, 5], model)
    call check_towards_limit(test, model, in_space, 'two spatial loops with common links')
  end subroutine check_two_loops

  !> A four-bar whose crank is at a distance from a dead point, down to round-off of its angle.
  subroutine check_four_bar(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp) :: limit, rates(4)
    logical :: independent(4)
    integer :: i, branch
    type(model_type) :: model

    limit = four_bar_limit(bar, stretched=.true.)
    call four_bar(bar%ground, bar%crank, bar%coupler, bar%rocker, four_bar_guess(bar, limit - 0.3_wp, 1), model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a four-bar has a plan')
    do i = 1, 12
      do branch = -1, 1, 2
        state%q = four_bar_guess(bar, limit - 10.0_wp**(-i), branch)
        call place_all(plan, state, err)
        call check_choice(test, plan, state, in_plane, 'a four-bar near its dead point', independent)
        if (i > 4) call test%is_true(.not. independent(1), 'a crank at its dead point does not stay independent')
        ! the entries of R11^-1 R12 are at most 2^(m-1) = 4, and are the rates per unit rate of the independent coordinate
        rates = four_bar_rates(state%q)
        call test%is_true(maxval(abs(rates)) <= 4.0_wp*abs(sum(rates, independent)), &
                          'no coordinate of a four-bar is more than four times as fast as the chosen one')
      end do
    end do
  end subroutine check_four_bar

  !> Rates of the four coordinates, in ratios that come from the velocities of the triangle's corners.
  pure function four_bar_rates(q) result(rates)
    real(wp), intent(in) :: q(4)   !< coordinates of a closed position [rad]
    real(wp) :: rates(4), crank, coupler, rocker

    crank = bar%coupler*bar%rocker*sin(q(1) + q(2) - q(4))
    coupler = bar%crank*bar%rocker*sin(q(4) - q(1))
    rocker = bar%crank*bar%coupler*sin(q(2))
    rates = [crank, coupler - crank, rocker - coupler, rocker]
  end function four_bar_rates

  !> A five-bar with two degrees of freedom, whose links 3 and 4 are stretched out but for a small angle: by its cranks it is
  !> singular then.
  subroutine check_five_bar(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp) :: first(2), last(2), pin(2), angles(4)
    real(wp), parameter :: pivot(2) = [1.0_wp, 0.0_wp]
    logical :: independent(5)
    integer :: i
    type(model_type) :: model

    call five_bar(model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a five-bar has a plan')
    do i = 1, 12
      first = 0.8_wp*[cos(2.5_wp), sin(2.5_wp)]
      last = two_circles(first, 2.5_wp - 10.0_wp**(-i), pivot, 0.9_wp, 1)
      pin = two_circles(first, 1.2_wp, last, 1.3_wp, 1)
      angles = [2.5_wp, direction(pin - first), direction(pin - last), direction(last - pivot)]
      state%q = [angles(1), angles(2:4) - angles(1:3), angles(4)]
      call place_all(plan, state, err)
      call check_choice(test, plan, state, in_plane, 'a five-bar whose couplers are nearly stretched out', independent)
      if (i > 4) call test%is_true(.not. (independent(1) .and. independent(5)), 'both cranks do not stay independent')
    end do
  end subroutine check_five_bar

  !> The angle of a vector to the x axis [rad].
  pure real(wp) function direction(a)
    real(wp), intent(in) :: a(2)   !< the vector

    direction = atan2(a(2), a(1))
  end function direction

  !> Two four-bars on one frame, near dead points of both cranks: one stretched out, one folded.
  subroutine check_two_four_bars(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: near = 1.0e-8_wp
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    logical :: independent(8)
    type(model_type) :: model

    call new_two_four_bars(test, model, .true., plan, state)
    state%q(:4) = four_bar_guess(bar, four_bar_limit(bar, stretched=.true.) - near, 1)
    state%q(5:) = four_bar_guess(bar, four_bar_limit(bar, stretched=.false.) + near, 1)
    call place_all(plan, state, err)
    call check_choice(test, plan, state, in_plane, 'two four-bars near dead points', independent)
    call test%is_true(count(independent(2:4)) == 1 .and. count(independent(6:)) == 1, 'each four-bar gets another coordinate')

    call new_two_four_bars(test, model, .false., plan, state)
    call test%is_true(size(plan%blocks) == 1, 'a four-bar that is not requested is left out of the plan')
    state%q(:4) = four_bar_guess(bar, four_bar_limit(bar, stretched=.true.) - near, 1)
    call place_all(plan, state, err)
    call best_independent(plan, state, independent)
    call test%is_true(count(independent(2:4)) == 1 .and. .not. independent(1), 'the four-bar in the plan gets another coordinate')
    call test%is_true(all(independent(5:) .eqv. [.true., .false., .false., .false.]), 'the four-bar left out keeps its coordinate')
  end subroutine check_two_four_bars

  !> Two four-bars on one frame; coordinates 1 to 4 and 5 to 8.
  subroutine new_two_four_bars(test, model, both, plan, state)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the mechanism
    logical, intent(in) :: both                !< the motion of both is requested; only of the first if false
    type(plan_type), intent(out) :: plan       !< their plan
    type(state_type), intent(out) :: state     !< a position
    integer, parameter :: links(2, 8) = reshape([1, 2, 2, 3, 3, 4, 1, 4, 1, 5, 5, 6, 6, 7, 1, 7], [2, 8])
    real(wp), parameter :: at(4) = [0.0_wp, bar%crank, bar%coupler, bar%ground]
    real(wp), parameter :: moving_at(4) = [0.0_wp, 0.0_wp, bar%rocker, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    type(planning_settings_type) :: settings
    type(error_type), allocatable :: err
    integer :: i, k

    call new_mechanism(7, links, [1, 5], model)
    do k = 1, 8
      i = modulo(k - 1, 4) + 1
      call add_revolute(model, k, links(1, k), links(2, k), frame([at(i), 0.0_wp, 0.0_wp], z), &
                        frame([moving_at(i), 0.0_wp, 0.0_wp], z))
    end do
    model%problem%initial%position(:4) = four_bar_guess(bar, four_bar_limit(bar, stretched=.true.) - 0.3_wp, 1)
    model%problem%initial%position(5:) = model%problem%initial%position(:4)
    allocate (settings%requested)
    settings%requested%coordinates = [(both .or. k <= 4, k=1, 8)]
    settings%requested%links = [(.false., k=1, 7)]
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, settings)
    call test%no_error(err, 'two four-bars have a plan')
  end subroutine new_two_four_bars

  !> Move the first independent coordinate until the chains close no longer, with steps that are halved there; the others stand.
  subroutine check_towards_limit(test, model, rows, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    integer, intent(in) :: rows(:)             !< the rows of a screw that count
    character(len=*), intent(in) :: why        !< the place, printed where a check fails
    type(plan_type) :: plan
    type(state_type) :: state, trial
    type(error_type), allocatable :: err
    logical :: independent(size(model%mechanism%pairs)), own(size(model%mechanism%pairs))
    real(wp), allocatable :: a(:, :)
    real(wp) :: step

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    own = .false.
    own(plan%independent) = .true.
    step = 0.05_wp
    do while (step > 1.0e-12_wp .and. abs(state%q(plan%independent(1))) < 7.0_wp)
      trial = state
      trial%q(plan%independent(1)) = trial%q(plan%independent(1)) + step
      call close_chains(plan, trial, err)
      if (allocated(err)) then
        step = 0.5_wp*step
        cycle
      end if
      state = trial
      call check_choice(test, plan, state, rows, why, independent)
    end do
    ! by its own coordinates the last position breaks the bound, so that the check could have failed
    a = closures_jacobian(plan, state, rows)
    call test%is_true(least_singular(a, own)*pivoting_loss(size(a, 1), size(a, 2)) < least_singular(a, independent), &
                      why//': the last position is singular for the present coordinates')
  end subroutine check_towards_limit

  !> Compare what is chosen with all other choices of as many coordinates.
  subroutine check_choice(test, plan, state, rows, why, independent)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    type(state_type), intent(in) :: state      !< a closed position
    integer, intent(in) :: rows(:)             !< the rows of a screw that count
    character(len=*), intent(in) :: why        !< the place, printed where a check fails
    logical, intent(out) :: independent(:)     !< (M) what is chosen
    real(wp), allocatable :: a(:, :)
    logical :: candidate(size(independent))
    real(wp) :: best
    integer :: choice, k

    call best_independent(plan, state, independent)
    call test%is_true(count(independent) == size(plan%independent), why//': there are as many coordinates as degrees of freedom')
    a = closures_jacobian(plan, state, rows)
    best = 0.0_wp
    do choice = 0, 2**plan%n_coordinates - 1
      if (popcnt(choice) /= size(plan%independent)) cycle
      candidate = [(btest(choice, k - 1), k=1, plan%n_coordinates)]
      ! a coordinate on which no loop depends must be independent
      if (any(maxval(abs(a), 1) <= 0.0_wp .and. .not. candidate)) cycle
      best = max(best, least_singular(a, candidate))
    end do
    call test%is_true(least_singular(a, independent)*pivoting_loss(size(a, 1), size(a, 2)) >= best, &
                      why//': no choice is better conditioned by more than pivoting can lose')
  end subroutine check_choice

  !> Greatest ratio of the least singular value of m of n columns to that of the m columns that QR with column pivoting takes.
  !> With A = (A1, A2) = A1 (1, B), B = R11^-1 R12, it is at most the norm of (1, B); pivoting makes |B_ij| <= 2^(m-i).
  pure real(wp) function pivoting_loss(m, n)
    integer, intent(in) :: m   !< rows, and columns that are taken
    integer, intent(in) :: n   !< columns

    pivoting_loss = sqrt(1.0_wp + (n - m)*(4.0_wp**m - 1.0_wp)/3.0_wp)
  end function pivoting_loss

  !> Derivatives of the loops' closures by all coordinates: the screws of the steps about the origin of frame 0, each
  !> coordinate in its unit and lengths in parts of the mechanism's size.
  function closures_jacobian(plan, state, rows) result(a)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< a closed position
    integer, intent(in) :: rows(:)          !< the rows of a screw that count
    real(wp) :: a(size(rows)*size(plan%closures), plan%n_coordinates), w(3), v(3), place(3), screw(6)
    integer :: c, i, k

    a = 0.0_wp
    do c = 1, size(plan%closures)
      associate (loop => plan%closures(c)%loop)
        do i = 1, size(loop%steps)
          call plan%arithmetics(1)%kind%step_screw(plan, state, loop%steps(i), w, v, place)
          k = plan%steps(loop%steps(i))%coordinate
          screw = loop%signs(i)*plan%unit_of(k)*[w, (v - cross(w, place))/plan%length]
          a((c - 1)*size(rows) + 1:c*size(rows), k) = screw(rows)
        end do
      end associate
    end do
  end function closures_jacobian

  !> The least singular value of the columns of the dependent coordinates. Vectors are asked for because the method for values
  !> alone (dqds) computes with infinite numbers, which builds with traps forbid.
  function least_singular(a, independent) result(least)
    real(wp), intent(in) :: a(:, :)         !< derivatives by all coordinates
    logical, intent(in) :: independent(:)   !< their columns are left out
    real(wp), dimension(size(a, 1), size(a, 1)) :: columns, u, vt
    real(wp) :: least, values(size(a, 1)), work(10*size(a, 1))
    integer :: m, k, info

    m = size(a, 1)
    columns = a(:, pack([(k, k=1, size(a, 2))], .not. independent))
    call dgesvd('A', 'A', m, m, columns, m, values, u, m, vt, m, work, size(work), info)
    least = merge(values(m), -1.0_wp, info == 0)
  end function least_singular
end module test_best_coordinates
