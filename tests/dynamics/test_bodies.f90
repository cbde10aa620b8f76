!> Bodies: the same matter described in other ways moves the same way, what has no mass does not
!> count, and a coordinate that moves no mass is named. Closed forms of pendulums.
!>
!> Compares the program with itself in part: the same matter described in several ways; pendulums have closed forms.
module test_bodies
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data, exit_integrator
  use mech9_rotation, only: identity
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_equations, find_motion
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame
  use mech9_loaded_mechanisms, only: open_chain, loaded_fig1, loaded_loop, two_loops, without_loads, add_body, &
    add_load, add_point_masses
  use mech9_random_geometry, only: random_vector
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

  real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], origin(3) = 0.0_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('test_point_masses')) call test_point_masses(test)
    if (test%runs('test_halves')) call test_halves(test)
    if (test%runs('test_massless')) call test_massless(test)
    if (test%runs('test_no_inertia')) call test_no_inertia(test)
    if (test%runs('test_flywheel')) call test_flywheel(test)
    if (test%runs('test_double_pendulum')) call test_double_pendulum(test)
    if (test%runs('test_spring_without_length')) call test_spring_without_length(test)
  end subroutine run

  !> Assemble and work out the motion for some rates of the independent coordinates.
  subroutine find(model, plan, dynamics, work, err)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(out) :: plan                !< its plan
    type(dynamics_plan_type), intent(out) :: dynamics   !< plan of its dynamics
    type(lagrange_work_type), intent(out) :: work       !< the equations at the start
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(state_type) :: state
    integer :: i

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    if (allocated(err)) return
    call make_dynamics_plan(model%mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    ! frames that nothing depends on must not be read
    do i = 1, plan%n_coordinates
      if (dynamics%carries(i)) cycle
      associate (first => dynamics%first(i), last => dynamics%first(i + 1) - 1)
        if (plan%planar%used) then
          work%jacobian%flat(:, first:last) = huge(1.0_wp)
        else
          work%jacobian%w(:, first:last) = huge(1.0_wp)
          work%jacobian%v(:, first:last) = huge(1.0_wp)
        end if
      end associate
    end do
    state%dq(plan%independent) = [(1.3_wp - 0.7_wp*i, i=1, size(plan%independent))]
    ! open chains have their accelerations without the equations
    call find_equations(model%mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    call find_motion(model%mechanism, plan, dynamics, state, work, err)
  end subroutine find

  !> Two mechanisms have the same equations. They are sums over the same matter in another order: some
  !> dozens of units of round-off of the largest number.
  subroutine check_same(test, first, second, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: first      !< first mechanism
    type(model_type), intent(in) :: second     !< second mechanism
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: a, b
    type(error_type), allocatable :: err
    real(wp), parameter :: tolerance = 1.0e-13_wp

    call find(first, plan, dynamics, a, err)
    call test%no_error(err, why//': the first equations are found')
    call find(second, plan, dynamics, b, err)
    call test%no_error(err, why//': the second equations are found')
    call test%near(largest(a%coefficients - b%coefficients)/largest(a%coefficients), 0.0_wp, tolerance, &
                   why//': the coefficients are equal')
    call test%near(maxval(abs(a%velocity_terms - b%velocity_terms))/maxval(abs(a%velocity_terms)), 0.0_wp, tolerance, &
                   why//': the velocity terms are equal')
    call test%near(maxval(abs(a%forces - b%forces))/maxval(abs(a%forces)), 0.0_wp, tolerance, why//': the forces are equal')
  end subroutine check_same

  !> The largest entry of the lower triangle, which alone is kept.
  pure real(wp) function largest(a)
    real(wp), intent(in) :: a(:, :)   !< symmetric
    integer :: i

    largest = maxval([(maxval(abs(a(i:, i))), i=1, size(a, 2))])
  end function largest

  !> A rigid body is its point masses: parallel axes, tensors and mass centres, on two spatial loops.
  subroutine test_point_masses(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: bodies, points
    type(random_type) :: random
    real(wp) :: masses(4, 6)
    integer :: i, j

    call two_loops([1, 5], bodies)
    deallocate (bodies%mechanism%bodies)
    allocate (bodies%mechanism%bodies(0))
    points = bodies
    do i = 2, 15
      do j = 1, 6
        masses(1:3, j) = random_vector(random)
        masses(4, j) = 0.1_wp*j
      end do
      call add_point_masses(bodies, i, masses, together=.true.)
      call add_point_masses(points, i, masses, together=.false.)
    end do
    call check_same(test, bodies, points, 'bodies as point masses')
  end subroutine test_point_masses

  !> Two bodies of half the mass in the same place are the whole one.
  subroutine test_halves(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: whole, halves
    integer :: i

    call loaded_fig1(5, whole)
    halves = whole
    deallocate (halves%mechanism%bodies)
    allocate (halves%mechanism%bodies(0))
    do i = 1, size(whole%mechanism%bodies)
      associate (body => whole%mechanism%bodies(i))
        call add_body(halves, body%link, 0.5_wp*body%mass, body%centre, 0.5_wp*body%inertia)
        call add_body(halves, body%link, 0.5_wp*body%mass, body%centre, 0.5_wp*body%inertia)
      end associate
    end do
    call check_same(test, whole, halves, 'bodies in halves')
  end subroutine test_halves

  !> Links without mass are not in the plan, nor is the frame; what they are left out of is the same.
  subroutine test_massless(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model, padded
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(error_type), allocatable :: err
    integer :: i

    call loaded_loop(model)
    call without_loads(model)
    model%mechanism%gravity = [0.0_wp, -9.81_wp, 0.0_wp]
    call add_body(model, 2, 2.0_wp, [0.3_wp, 0.1_wp, 0.2_wp], 0.1_wp*identity)
    padded = model
    do i = 3, 7
      call add_body(padded, i, 0.0_wp, [0.3_wp, 0.1_wp, 0.2_wp], 0.0_wp*identity)
    end do
    call add_body(padded, 1, 5.0_wp, [0.3_wp, 0.1_wp, 0.2_wp], identity)
    call check_same(test, model, padded, 'bodies without mass, and one of the frame')
    call find(padded, plan, dynamics, work, err)
    call test%is_true(size(dynamics%bodies) == 1, 'one link with mass is one body in the plan')
    call test%is_true(dynamics%carries(plan%frame_of(2)), 'the frame of the link with mass is kept')
    call test%is_true(.not. dynamics%carries(plan%closures(1)%closing), &
                      'the frame by which the loop closes has no mass of its own')
  end subroutine test_massless

  !> The coordinate that moves no mass is named, whichever it is.
  subroutine test_no_inertia(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(error_type), allocatable :: err

    call open_chain(model)
    call without_loads(model)
    call find(model, plan, dynamics, work, err)
    call test%has_error(err, exit_data, 'a mechanism without bodies is refused')
    call test%is_true(index(message_of(err), 'coordinate 1 ') > 0, &
                      'the first coordinate without inertia is named: '//message_of(err))
    call add_body(model, 2, 1.0_wp, [0.2_wp, 0.3_wp, 0.4_wp], identity)
    call add_body(model, 3, 1.0_wp, [0.2_wp, 0.3_wp, 0.4_wp], identity)
    call find(model, plan, dynamics, work, err)
    call test%has_error(err, exit_data, 'a mechanism without mass on its last link is refused')
    call test%is_true(index(message_of(err), 'coordinate 3 ') > 0, &
                      'the last coordinate without inertia is named: '//message_of(err))
    call add_body(model, 4, 1.0_wp, [0.2_wp, 0.3_wp, 0.4_wp], identity)
    call find(model, plan, dynamics, work, err)
    call test%no_error(err, 'a mechanism with a body on every link is accepted')
  end subroutine test_no_inertia

  !> Inertia without mass, turned by a torque on its coordinate: J ddq = M.
  subroutine test_flywheel(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(error_type), allocatable :: err

    call new_mechanism(2, reshape([1, 2], [2, 1]), [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call without_loads(model)
    call add_body(model, 2, 0.0_wp, origin, 0.25_wp*identity)
    call add_load(model, coordinate_load_type(coordinate=1, force=3.0_wp))
    call find(model, plan, dynamics, work, err)
    call test%no_error(err, 'the accelerations of a flywheel are found')
    call test%near(work%accelerations(1), 12.0_wp, 1.0e-15_wp, 'the acceleration of a flywheel is 3/0.25')
  end subroutine test_flywheel

  !> A double pendulum of two point masses, angles q1 and q1 + q2 from the x axis, gravity along x:
  !> the textbook's equations with c = cos q2, s = sin q2.
  subroutine test_double_pendulum(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(error_type), allocatable :: err
    real(wp), parameter :: m1 = 0.7_wp, m2 = 1.1_wp, l1 = 0.9_wp, l2 = 0.6_wp, g = 9.81_wp, q1 = 0.4_wp, q2 = -1.1_wp
    real(wp), parameter :: rate1 = 0.6_wp, rate2 = -0.1_wp, c = cos(q2), s = sin(q2)

    call new_mechanism(3, reshape([1, 2, 2, 3], [2, 2]), [1, 2], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(model, 2, 2, 3, frame([l1, 0.0_wp, 0.0_wp], z), frame(origin, z))
    model%problem%initial%position = [q1, q2]
    call without_loads(model)
    model%mechanism%gravity = [g, 0.0_wp, 0.0_wp]
    call add_body(model, 2, m1, [l1, 0.0_wp, 0.0_wp], 0.0_wp*identity)
    call add_body(model, 3, m2, [l2, 0.0_wp, 0.0_wp], 0.0_wp*identity)
    call find(model, plan, dynamics, work, err)
    call test%no_error(err, 'the accelerations of a double pendulum are found')
    call test%near(work%coefficients(1, 1), (m1 + m2)*l1**2 + m2*l2**2 + 2.0_wp*m2*l1*l2*c, 1.0e-15_wp, &
                   'the coefficient a11 of a double pendulum is that of its closed form')
    call test%near(work%coefficients(2, 1), m2*l2**2 + m2*l1*l2*c, 1.0e-15_wp, &
                   'the coefficient a12 of a double pendulum is that of its closed form')
    call test%near(work%coefficients(2, 2), m2*l2**2, 1.0e-15_wp, &
                   'the coefficient a22 of a double pendulum is that of its closed form')
    call test%near(work%velocity_terms(1), -m2*l1*l2*s*(2.0_wp*rate1*rate2 + rate2**2), 1.0e-15_wp, &
                   'the velocity term h1 of a double pendulum is that of its closed form')
    call test%near(work%velocity_terms(2), m2*l1*l2*s*rate1**2, 1.0e-15_wp, &
                   'the velocity term h2 of a double pendulum is that of its closed form')
    call test%near(work%forces(1), -(m1 + m2)*g*l1*sin(q1) - m2*g*l2*sin(q1 + q2), 1.0e-15_wp, &
                   'the force Q1 of a double pendulum is that of its closed form')
    call test%near(work%forces(2), -m2*g*l2*sin(q1 + q2), 1.0e-15_wp, &
                   'the force Q2 of a double pendulum is that of its closed form')
  end subroutine test_double_pendulum

  !> A spring of free length zero may shrink to nothing, where its damper alone is left; any other may not.
  subroutine test_spring_without_length(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(error_type), allocatable :: err

    call new_mechanism(2, reshape([1, 2], [2, 1]), [1], model)
    call add_prismatic(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call without_loads(model)
    call add_body(model, 2, 2.0_wp, origin, 0.0_wp*identity)
    call add_load(model, spring_load_type(links=[1, 2], stiffness=5.0_wp, damping=3.0_wp))
    call find(model, plan, dynamics, work, err)
    call test%no_error(err, 'a spring of free length zero may shrink to nothing')
    ! the rate that `find` gives to a first coordinate is 0.6
    call test%near(work%accelerations(1), -3.0_wp*0.6_wp/2.0_wp, 1.0e-15_wp, &
                   'a spring of length zero acts by its damper alone, -3 v/2')
    call add_load(model, spring_load_type(links=[1, 2], stiffness=5.0_wp, free_length=0.1_wp))
    call find(model, plan, dynamics, work, err)
    call test%has_error(err, exit_integrator, 'a spring of free length 0.1 m that shrinks to nothing is refused')
  end subroutine test_spring_without_length
end module test_bodies
