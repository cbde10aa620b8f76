!> Articulated bodies give what Lagrange's equations (19) ask for, on random trees with all kinds of pairs and loads, in
!> space and in the plane; a coordinate without inertia is named as there; an evaluation allocates nothing.
!>
!> Compares the program with itself: articulated bodies and Lagrange's equations, which `test_lagrange` holds against the formulas
!> of the paper.
module test_open_chains
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type
  use mech9_random, only: random_type
  use mech9_cholesky, only: cholesky_factorize
  use mech9_screw_pair, only: screw_pair_type, helical_pair
  use mech9_model, only: model_type
  use mech9_lagrange, only: find_motion, find_equations
  use mech9_cluster_case, only: cluster_case_type, prepare, check_motion, check_memory
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame, general_loop
  use mech9_curved_pair, only: curved_pair_type
  use mech9_loaded_mechanisms, only: five_bar, load_everything, without_loads, add_body
  use mech9_random_geometry, only: random_vector, random_unit
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_trees')) call random_trees(test)
    if (test%runs('long_chain')) call long_chain(test)
    if (test%runs('without_inertia')) call without_inertia(test)
    if (test%runs('closed_chains')) call closed_chains(test)
  end subroutine run

  !> Trees of 2 to 13 steps; on every second one some links have no mass, but never the last of a branch.
  subroutine random_trees(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: tree
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
      call check_articulated(test, tree, 'a tree')
      call test%is_true(tree%plan%planar%used .or. .not. planar, 'a tree in the plane takes planar arithmetic')
    end do
  end subroutine random_trees

  !> Steps of all kinds, from any earlier link to the next, either way round, coordinates in any order.
  subroutine random_tree(random, m, planar, links, model)
    type(random_type), intent(inout) :: random         !< source of the random numbers
    integer, intent(in) :: m                           !< coordinates
    logical, intent(in) :: planar                      !< only pairs about and across z
    integer, allocatable, intent(out) :: links(:, :)   !< (2,m) reference and moving link of each coordinate
    type(model_type), intent(out) :: model             !< the model
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
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: k                     !< its coordinate
    integer, intent(in) :: links(2)              !< reference and moving link
    type(model_type), intent(inout) :: model     !< the model
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
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: k                     !< its coordinate
    integer, intent(in) :: links(2)              !< reference and moving link
    type(model_type), intent(inout) :: model     !< the model
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
    type(random_type), intent(inout) :: random   !< source of the random numbers
    integer, intent(in) :: links(:, :)           !< (2,M) reference and moving link of each pair
    integer, intent(in) :: most                  !< links
    type(model_type), intent(inout) :: model     !< the model
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

  !> The mechanism moves by articulated bodies, whose accelerations satisfy Lagrange's equations.
  subroutine check_articulated(test, this, why)
    type(tester_type), intent(inout) :: test         !< counts the checks
    type(cluster_case_type), intent(inout) :: this   !< with the model
    character(len=*), intent(in) :: why              !< the mechanism, printed where something is wrong
    logical :: found

    call prepare(this, .false., found)
    call test%is_true(found, why//': there is a plan')
    if (.not. found) return
    call test%is_true(this%dynamics%articulated, why//': articulated bodies are taken')
    call check_motion(test, this, why)
    call check_memory(test, this)
  end subroutine check_articulated

  !> Sixty links of 1 m in a row, turning about x and y by turns.
  subroutine long_chain(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: m = 60
    real(wp), parameter :: top(3) = [0.0_wp, 0.0_wp, 1.0_wp], foot(3) = 0.0_wp
    real(wp) :: axis(3)
    type(cluster_case_type) :: chain
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
    call check_articulated(test, chain, 'sixty links')
  end subroutine long_chain

  !> The error is that of the coefficients: mass that is missing at the end, and mass that turns about
  !> two axes in one line, of which the second is left no inertia but round-off.
  subroutine without_inertia(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: chain
    type(random_type) :: random
    real(wp) :: point(3), axis(3)
    integer :: trial, massive
    logical :: found

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
      call prepare(chain, .false., found)
      call test%is_true(found, 'a chain without inertia has a plan')
      call check_refusal(test, chain)
    end do
  end subroutine without_inertia

  subroutine check_refusal(test, this)
    type(tester_type), intent(inout) :: test         !< counts the checks
    type(cluster_case_type), intent(inout) :: this   !< mechanism, plans, state and equations
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
  subroutine closed_chains(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(cluster_case_type) :: closed
    logical :: found

    call five_bar(closed%model)
    call prepare(closed, .false., found)
    call test%is_true(found .and. .not. closed%dynamics%articulated, 'articulated bodies are not taken for a five-bar')
    call general_loop(closed%model)
    call without_loads(closed%model)
    call prepare(closed, .false., found)
    call test%is_true(found .and. .not. closed%dynamics%articulated, 'articulated bodies are not taken for a spatial loop')
  end subroutine closed_chains
end module test_open_chains
