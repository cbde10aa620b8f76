!> Articulated bodies give what Lagrange's equations (19) ask for, on random trees with all kinds of pairs and loads, in
!> space and in the plane; a coordinate without inertia is named as there; an evaluation allocates nothing.
!>
!> Compares the program with itself: articulated bodies and Lagrange's equations, which `test_lagrange` holds against the formulas
!> of the paper.
program test_open_chains
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type
  use mech9_random, only: random_type
  use mech9_cholesky, only: cholesky_factorize
  use mech9_screw_pair, only: screw_pair_type, helical_pair
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_motion, find_equations, complete_accelerations
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame, general_loop
  use mech9_curved_pair, only: curved_pair_type
  use mech9_loaded_mechanisms, only: five_bar, load_everything, without_loads, add_body
  use mech9_random_geometry, only: random_vector, random_unit
  use mech9_testing, only: tester_type, message_of
  use mech9_counted_memory, only: calls
  implicit none

  !> A mechanism and all that its motion needs.
  type :: case_type
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
  end type case_type

  type(tester_type) :: test

  call random_trees()
  call long_chain()
  call without_inertia()
  call closed_chains()
  call test%finish()

contains

  !> Trees of 2 to 13 steps; on every second one some links have no mass, but never the last of a branch.
  subroutine random_trees()
    type(case_type) :: tree
    type(random_type) :: random
    integer, allocatable :: links(:, :)
    integer :: trial, m
    logical :: planar

    do trial = 1, 96
      m = 2 + mod(trial, 12)
      planar = trial > 48
      call random_tree(random, m, planar, links, tree%model)
      call load_everything(random, tree%model)
      if (mod(trial, 2) == 0) call lighten(random, links, merge(1, 4, planar), tree%model)
      call prepare(tree, 'a tree')
      call test%is_true(tree%plan%planar%used .or. .not. planar, 'a tree in the plane takes planar arithmetic')
      call check_motion(tree, 'a tree')
      call check_memory(tree)
    end do
  end subroutine random_trees

  !> Steps of all kinds, from any earlier link to the next, either way round, coordinates in any order.
  subroutine random_tree(random, m, planar, links, model)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: m                           !< coordinates
    logical, intent(in) :: planar                      !< only pairs about and across z
    integer, allocatable, intent(out) :: links(:, :)   !< (2,m) reference and moving link of each coordinate
    type(model_type), intent(out) :: model         !< the model
    integer :: order(m), i, k, other

    order = [(i, i=1, m)]
    do i = m, 2, -1
      other = below(random, i) + 1
      k = order(i)
      order(i) = order(other)
      order(other) = k
    end do
    allocate (links(2, m))
    do i = 1, m
      links(:, order(i)) = [1 + below(random, i), i + 1]
      if (below(random, 2) == 0) links(:, order(i)) = links([2, 1], order(i))
    end do
    call new_mechanism(m + 1, links, [(i, i=1, m)], model)
    do k = 1, m
      if (planar) then
        call add_planar_pair(random, k, links(:, k), model)
      else
        call add_random_pair(random, k, links(:, k), model)
      end if
      model%problem%initial%position(k) = random%symmetric()
    end do
  end subroutine random_tree

  subroutine add_random_pair(random, k, links, model)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: k                           !< its coordinate
    integer, intent(in) :: links(2)                    !< reference and moving link
    type(model_type), intent(inout) :: model       !< the model
    type(screw_pair_type) :: helix
    type(curved_pair_type) :: curved
    type(pose_type) :: here, there

    here = frame(random_vector(random), random_unit(random))
    there = frame(random_vector(random), random_unit(random))
    select case (below(random, 5))
    case (0)
      call add_prismatic(model, k, links(1), links(2), here, there)
    case (1)
      helix = helical_pair(here, there, 0.4_wp)
      allocate (model%mechanism%pairs(k)%pair, source=helix)
    case (2)
      curved%angular = .false.
      allocate (model%mechanism%pairs(k)%pair, source=curved)
    case default
      call add_revolute(model, k, links(1), links(2), here, there)
    end select
    model%mechanism%pairs(k)%pair%coordinate = k
    model%mechanism%pairs(k)%pair%reference = links(1)
    model%mechanism%pairs(k)%pair%moving = links(2)
  end subroutine add_random_pair

  subroutine add_planar_pair(random, k, links, model)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: k                           !< its coordinate
    integer, intent(in) :: links(2)                    !< reference and moving link
    type(model_type), intent(inout) :: model       !< the model
    type(pose_type) :: here, there
    real(wp) :: along(3)
    logical :: slides

    along = [0.0_wp, 0.0_wp, sign(1.0_wp, random%symmetric())]
    ! without a pair that turns there is no plane
    slides = below(random, 3) == 0 .and. k > 1
    if (slides) along = [random%symmetric(), 1.0_wp, 0.0_wp]
    here = frame(random_vector(random), along)
    there = frame(random_vector(random), along)
    if (slides) then
      call add_prismatic(model, k, links(1), links(2), here, there)
    else
      call add_revolute(model, k, links(1), links(2), here, there)
    end if
  end subroutine add_planar_pair

  !> A whole number from 0 to n - 1.
  integer function below(random, n)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: n                     !< greater than the greatest number

    below = min(n - 1, int(0.5_wp*n*(1.0_wp + random%symmetric())))
  end function below

  !> Some links that carry another one lose their mass; a body at the end of them all resists six steps in
  !> general, in the plane three, but only two of them slides.
  subroutine lighten(random, links, most, model)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: links(:, :)                 !< (2,M) reference and moving link of each pair
    integer, intent(in) :: most                        !< links
    type(model_type), intent(inout) :: model       !< the model
    integer :: i, light, toss

    light = 0
    do i = 1, size(model%mechanism%bodies)
      toss = below(random, 2)
      associate (body => model%mechanism%bodies(i))
        if (count(links == body%link) < 2 .or. light == most .or. toss == 0) cycle
        light = light + 1
        body%mass = 0.0_wp
        body%inertia = 0.0_wp
      end associate
    end do
  end subroutine lighten

  !> Plan, and some rates.
  subroutine prepare(this, why)
    type(case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    character(len=*), intent(in) :: why      !< the statement that is checked, printed where it is wrong
    type(error_type), allocatable :: err
    integer :: i

    call make_plan(this%model%mechanism, this%model%problem%partition, this%model%problem%initial%position, this%plan, &
                   this%state, err)
    call test%no_error(err, why//': there is a plan')
    call make_dynamics_plan(this%model%mechanism, this%plan, this%dynamics)
    this%work = new_lagrange_work(this%plan, this%dynamics)
    this%state%dq(this%plan%independent) = [(1.3_wp*cos(2.0_wp*i), i=1, size(this%plan%independent))]
  end subroutine prepare

  !> The accelerations satisfy a ddq = Q - h. The rest is round-off of the terms: of sums over all links
  !> along a chain, some hundreds of units.
  subroutine check_motion(this, why)
    type(case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    character(len=*), intent(in) :: why      !< the statement that is checked, printed where it is wrong
    type(error_type), allocatable :: err
    real(wp), allocatable :: ddq(:), a(:, :), left(:)
    real(wp) :: terms
    integer :: i, n

    call test%is_true(this%dynamics%articulated, why//': articulated bodies are taken')
    call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    call test%no_error(err, why//': the motion is found')
    if (allocated(err)) return
    n = size(this%plan%independent)
    call test%near(maxval(abs(this%work%coefficients)), 0.0_wp, 0.0_wp, why//': the coefficients are not computed')
    ddq = this%work%accelerations
    call complete_accelerations(this%plan, this%dynamics, this%work, this%state)
    call test%near(maxval(abs(this%state%ddq(this%plan%independent) - ddq)), 0.0_wp, 0.0_wp, &
                   why//': each acceleration belongs to its coordinate')
    call find_equations(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    call test%no_error(err, why//': the equations are found')
    a = this%work%coefficients
    do i = 1, n
      a(i, i + 1:) = a(i + 1:, i)
    end do
    left = matmul(a, ddq) - this%work%forces + this%work%velocity_terms
    terms = maxval(matmul(abs(a), abs(ddq)) + abs(this%work%forces) + abs(this%work%velocity_terms))
    call test%is_true(terms > 1.0_wp, why//': there is something to compare')
    call test%near(maxval(abs(left))/terms, 0.0_wp, 1.0e-13_wp, why//': Lagrange''s equations hold')
  end subroutine check_motion

  subroutine check_memory(this)
    type(case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    type(error_type), allocatable :: err
    integer :: i, before

    before = calls
    call test%is_true(before > 0, 'the counter of allocations counts')
    do i = 1, 10
      call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
      if (allocated(err)) exit
    end do
    call test%is_true(calls == before, 'ten evaluations allocate nothing')
    call test%no_error(err, 'ten evaluations succeed')
  end subroutine check_memory

  !> Sixty links of 1 m in a row, turning about x and y by turns.
  subroutine long_chain()
    integer, parameter :: m = 60
    real(wp), parameter :: top(3) = [0.0_wp, 0.0_wp, 1.0_wp], foot(3) = 0.0_wp
    real(wp) :: axis(3)
    type(case_type) :: chain
    integer :: k

    call new_mechanism(m + 1, reshape([(k, k + 1, k=1, m)], [2, m]), [(k, k=1, m)], chain%model)
    call without_loads(chain%model)
    chain%model%mechanism%gravity = [0.0_wp, 0.0_wp, -9.81_wp]
    do k = 1, m
      axis = [modulo(k, 2), modulo(k + 1, 2), 0]
      call add_revolute(chain%model, k, k, k + 1, frame(top, axis), frame(foot, axis))
      call add_body(chain%model, k + 1, 1.0_wp, 0.5_wp*top, 0.08_wp*identity)
      chain%model%problem%initial%position(k) = 0.3_wp*sin(real(k, wp))
    end do
    call prepare(chain, 'sixty links')
    call check_motion(chain, 'sixty links')
    call check_memory(chain)
  end subroutine long_chain

  !> The error is that of the coefficients: mass that is missing at the end, and mass that turns about
  !> two axes in one line, of which the second is left no inertia but round-off.
  subroutine without_inertia()
    type(case_type) :: chain
    type(random_type) :: random
    real(wp) :: point(3), axis(3)
    integer :: trial, massive

    do trial = 1, 20
      call new_mechanism(4, reshape([1, 2, 2, 3, 3, 4], [2, 3]), [1, 2, 3], chain%model)
      call without_loads(chain%model)
      point = random_vector(random)
      axis = random_unit(random)
      call add_prismatic(chain%model, 1, 1, 2, frame(random_vector(random), random_unit(random)), frame(point, axis))
      call add_revolute(chain%model, 2, 2, 3, frame(point, axis), frame(point, axis))
      call add_revolute(chain%model, 3, 3, 4, frame(point + 0.7_wp*axis, axis), frame(random_vector(random), axis))
      chain%model%problem%initial%position = [0.4_wp, random%symmetric(), random%symmetric()]
      massive = merge(3, 4, mod(trial, 2) == 0)
      call add_body(chain%model, massive, 1.0_wp + 0.5_wp*random%symmetric(), random_vector(random), 0.3_wp*identity)
      call prepare(chain, 'without inertia')
      call check_refusal(chain)
    end do
  end subroutine without_inertia

  subroutine check_refusal(this)
    type(case_type), intent(inout) :: this   !< mechanism, plans, state and equations
    type(error_type), allocatable :: err, none
    integer :: failed_at

    call find_motion(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, err)
    call test%has_error(err, exit_data, 'a coordinate without inertia is refused')
    if (.not. allocated(err)) return
    call test%is_true(index(message_of(err), 'coordinate 3 ') > 0, &
                      'the last coordinate without inertia is named: '//message_of(err))
    call find_equations(this%model%mechanism, this%plan, this%dynamics, this%state, this%work, none)
    call test%no_error(none, 'the coefficients of a coordinate without inertia are found')
    call cholesky_factorize(size(this%plan%independent), this%work%coefficients, failed_at)
    call test%is_true(failed_at > 0, 'the coefficients of a coordinate without inertia are singular')
    if (failed_at > 0) call test%is_true(all(err%failure%coordinates == this%plan%independent(failed_at)), &
                                         'the error names the coordinate of the singular coefficients')
  end subroutine check_refusal

  !> One closed cluster on link 1, in the plane or in space, needs its coefficients in any case.
  subroutine closed_chains()
    type(case_type) :: closed

    call five_bar(closed%model)
    call prepare(closed, 'five-bar')
    call test%is_true(.not. closed%dynamics%articulated, 'articulated bodies are not taken for a five-bar')
    call general_loop(closed%model)
    call without_loads(closed%model)
    call prepare(closed, 'spatial loop')
    call test%is_true(.not. closed%dynamics%articulated, 'articulated bodies are not taken for a spatial loop')
  end subroutine closed_chains
end program test_open_chains
