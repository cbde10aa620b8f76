!> Equilibria of pendulums with springs and motors: positions, matrices, roots and shapes have closed forms. The stiffness of closed
!> chains is the derivative of the forces that hold them.
module test_equilibrium
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_resting_mechanism, only: resting_type, put_to_rest, find_stiffness, try_step, is_balanced
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_equilibria, only: find_equilibrium, find_equilibria
  use mech9_mode_shapes, only: shape_of_mode, energy_shares, displacement, position_in_vibration
  use mech9_state_space, only: state_space_type, find_state_space
  use mech9_loaded_mechanisms, only: check_each_mechanism
  use mech9_text_models, only: model_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Mass, length and gravity of the pendulums.
  real(wp), parameter :: m = 2.0_wp, l = 0.8_wp, g = 9.81_wp
  real(wp), parameter :: inertia = m*l**2, weight = m*g*l
  !> An equilibrium is known to the round-off of its forces, 1e-11 of their sum, over its stiffness.
  real(wp), parameter :: at_rest = 1.0e-10_wp
  character(len=*), parameter :: pendulum = '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&body link=2, mass=2, centre=0,-0.8,0 / &gravity acceleration=0,-9.81,0 / '
  character(len=*), parameter :: double_pendulum = '&structure cq=1,2 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0,-0.8,0, moving_point=0,0,0 / '// &
    '&body link=2, mass=2, centre=0,-0.8,0 / &body link=3, mass=2, centre=0,-0.8,0 / &gravity acceleration=0,-9.81,0 / '

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('all_of_double_pendulum')) call all_of_double_pendulum(tester)
    if (tester%runs('shapes')) call shapes(tester)
    if (tester%runs('upright')) call upright(tester)
    if (tester%runs('leaning')) call leaning(tester)
    if (tester%runs('state_space')) call state_space(tester)
    call check_each_mechanism(tester, compare_stiffness)
  end subroutine run

  !> A model with its plan in space, and its closed position at the start.
  subroutine assemble(tester, text, model, plan, state)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of a data file
    type(model_type), intent(out) :: model       !< the model
    type(plan_type), intent(out) :: plan         !< its plan
    type(state_type), intent(out) :: state       !< its position
    type(error_type), allocatable :: err

    call model_from_text(tester, text, dynamics, model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=.true.))
    call tester%no_error(err, 'there is a plan in space')
  end subroutine assemble

  !> Rods that hang or stand: four equilibria. With the angles of the rods from below, and c their cosines, M = m l^2 (2, c1 c2; c1 c2, 1)
  !> and K = m g l diag(2 c1, c2), so that the roots satisfy x^2 + 2 (c1 + c2) x + 2 c1 c2 = 0 for x = root^2 l/g.
  subroutine all_of_double_pendulum(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(equilibrium_type), allocatable :: list(:)
    type(error_type), allocatable :: err
    complex(wp) :: x
    real(wp) :: c(2)
    integer :: i, j

    call assemble(tester, double_pendulum//'&initial coordinate=1, position=0.3 /', model, plan, state)
    call find_equilibria(model, plan, state, 40, list, err)
    call tester%no_error(err, 'equilibria are found')
    call tester%is_true(size(list) == 4, 'two rods hang or stand in four ways')
    do i = 1, size(list)
      associate (q => list(i)%resting%state%q)
        call tester%near(maxval(abs(sin(q))), 0.0_wp, at_rest, 'both rods are vertical')
        c = [cos(q(1)), cos(q(1) + q(2))]
        call tester%is_true(list(i)%is_stable .eqv. all(c > 0.0_wp), 'it is stable where both rods hang')
      end associate
      call check_matrices(tester, list(i), c)
      do j = 1, list(i)%modes%count
        x = list(i)%modes%roots(j)**2*l/g
        ! eigenvalues of matrices of two rows of order one
        call tester%near(abs(x**2 + 2.0_wp*sum(c)*x + 2.0_wp*product(c)), 0.0_wp, 1.0e-9_wp, &
                         'its roots are those of the closed form')
      end do
    end do
  end subroutine all_of_double_pendulum

  !> Matrices of the double pendulum by the relative angles: q = J^-1 (angles) with J = (1, 0; 1, 1).
  subroutine check_matrices(tester, found, c)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(equilibrium_type), intent(in) :: found  !< an equilibrium
    real(wp), intent(in) :: c(2)                 !< cosines of the angles of the rods
    real(wp), parameter :: j(2, 2) = reshape([1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 2])
    real(wp) :: inertias(2, 2), stiffness(2, 2)

    inertias = inertia*matmul(transpose(j), matmul(reshape([2.0_wp, product(c), product(c), 1.0_wp], [2, 2]), j))
    stiffness = weight*matmul(transpose(j), matmul(reshape([2.0_wp*c(1), 0.0_wp, 0.0_wp, c(2)], [2, 2]), j))
    call tester%near(maxval(abs(found%inertia - inertias)), 0.0_wp, at_rest*inertia, 'the inertia is that of the closed form')
    call tester%near(maxval(abs(found%stiffness - stiffness)), 0.0_wp, at_rest*weight, 'the stiffness is that of the closed form')
    call tester%near(maxval(abs(found%damping)), 0.0_wp, at_rest, 'there is no damping')
  end subroutine check_matrices

  !> The double pendulum vibrates with (2 -+ sqrt(2)) g/l; its lower rod then swings sqrt(2) times as far as the upper one, or as far
  !> in the other direction. The parts of the kinetic energy are those of the closed form.
  subroutine shapes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state, displaced
    type(equilibrium_type) :: found
    type(error_type), allocatable :: err
    complex(wp) :: shape(2)
    real(wp) :: shares(2), q(2)
    integer :: mode
    logical :: exists

    call assemble(tester, double_pendulum, model, plan, state)
    call find_equilibrium(model%mechanism, model%problem%partition, plan, state, found, err)
    call tester%no_error(err, 'the rods hang')
    call tester%is_true(found%modes%count == 2, 'there are two modes')
    do mode = 1, 2
      call tester%near(aimag(found%modes%roots(mode))**2*l/g, 2.0_wp + (-1)**mode*sqrt(2.0_wp), 1.0e-9_wp, 'a frequency')
      q = [1.0_wp, -(-1)**mode*sqrt(2.0_wp) - 1.0_wp]
      call shape_of_mode(found, mode, shape)
      call tester%near(maxval(abs(shape - q/q(maxloc(abs(q), dim=1)))), 0.0_wp, 1.0e-9_wp, 'a shape')
      call energy_shares(found, mode, shares)
      q = q*[5.0_wp*q(1) + 2.0_wp*q(2), 2.0_wp*q(1) + q(2)]
      call tester%near(maxval(abs(shares - q/sum(q))), 0.0_wp, 1.0e-9_wp, 'shares of the kinetic energy')
      call position_in_vibration(model%mechanism, found, displacement(found, mode, 0.1_wp, 0.0_wp), displaced, exists, err)
      call tester%is_true(exists, 'the rods can swing by a tenth of a rad')
      call tester%near(maxval(abs(displaced%q)), 0.1_wp, 1.0e-12_wp, 'the largest coordinate swings by a tenth of a rad')
      call tester%near(maxval(abs(displaced%q*shape(1) - displaced%q(1)*shape)), 0.0_wp, 1.0e-9_wp, 'and the others in proportion')
    end do
  end subroutine shapes

  !> A pendulum that stands, with a spring that is too weak to hold it and a damper: J x'' + d x' + (k - m g l) x = 0.
  subroutine upright(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(equilibrium_type) :: found
    type(error_type), allocatable :: err
    real(wp), parameter :: k = 10.0_wp, d = 3.0_wp
    integer :: j

    call assemble(tester, pendulum//'&load kind=''coordinate'', coordinate=1, stiffness=10, '// &
                  'rest=3.141592653589793, damping=3 / &initial coordinate=1, position=3.1 /', model, plan, state)
    call find_equilibrium(model%mechanism, model%problem%partition, plan, state, found, err)
    call tester%no_error(err, 'a pendulum that stands is at rest')
    call tester%near(found%resting%state%q(1), pi, at_rest, 'it stands upright')
    call tester%is_true(.not. found%is_stable .and. found%modes%count == 2, 'it falls, by one of its two roots')
    do j = 1, found%modes%count
      associate (root => found%modes%roots(j))
        call tester%near(abs(inertia*root**2 + d*root + k - weight), 0.0_wp, 1.0e-9_wp*weight, 'a root of the equation of motion')
      end associate
    end do
    call tester%near(found%modes%growth, (-d + sqrt(d**2 - 4.0_wp*inertia*(k - weight)))/(2.0_wp*inertia), 1.0e-9_wp, &
                     'it grows by the larger root')
  end subroutine upright

  !> The same pendulum leans to a side where the spring balances its weight: k (q - pi) = -m g l sin q. It is stable there.
  subroutine leaning(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(equilibrium_type) :: found
    type(error_type), allocatable :: err
    real(wp), parameter :: k = 10.0_wp

    call assemble(tester, pendulum//'&load kind=''coordinate'', coordinate=1, stiffness=10, rest=3.141592653589793 / '// &
                  '&initial coordinate=1, position=2.3 /', model, plan, state)
    call find_equilibrium(model%mechanism, model%problem%partition, plan, state, found, err)
    call tester%no_error(err, 'a pendulum that leans is at rest')
    associate (q => found%resting%state%q(1))
      call tester%is_true(abs(q - pi) > 0.1_wp .and. found%is_stable, 'it leans, and is stable')
      call tester%is_true(is_balanced(found%resting), 'its forces are zero beyond round-off')
      call tester%near((k*(q - pi) + weight*sin(q))/weight, 0.0_wp, at_rest, 'the spring balances the weight')
      call tester%near(found%stiffness(1, 1), k + weight*cos(q), at_rest, 'its stiffness is the derivative of the torque')
    end associate
  end subroutine leaning

  !> x' = (0, 1; -m g l/J, -d/J) x + (0; 1/J) u for the pendulum, and its end moves by l along x.
  subroutine state_space(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(equilibrium_type) :: found
    type(state_space_type) :: space
    type(error_type), allocatable :: err
    real(wp), parameter :: a(2) = [-weight, -3.0_wp]/inertia
    integer :: d

    call assemble(tester, pendulum//'&load kind=''coordinate'', coordinate=1, damping=3 / &point name=''end'', link=2, '// &
                  'position=0,-0.8,0 /', model, plan, state)
    call find_equilibrium(model%mechanism, model%problem%partition, plan, state, found, err)
    call tester%no_error(err, 'a pendulum hangs')
    call find_state_space(model%mechanism, [1], 2, found, space)
    call tester%is_true(all(shape(space%a) == [2, 2]) .and. all(shape(space%b) == [2, 1]) .and. all(shape(space%c) == [12, 2]), &
                        'two states, one force, and three derivatives of an angle and of a point')
    ! sums of a few products of numbers up to twenty
    call tester%near(maxval(abs(space%a - reshape([0.0_wp, a(1), 1.0_wp, a(2)], [2, 2]))), 0.0_wp, 1.0e-12_wp, 'the matrix A')
    call tester%near(maxval(abs(space%b(:, 1) - [0.0_wp, 1.0_wp/inertia])), 0.0_wp, 1.0e-14_wp, 'the matrix B')
    ! outputs q, dq, ddq, then the point's position, velocity, acceleration
    call tester%near(maxval(abs(space%c(1:3, :) - transpose(reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, a], [2, 3])))), 0.0_wp, &
                     1.0e-12_wp, 'the angle in the matrix C')
    do d = 0, 2
      call tester%near(maxval(abs(space%c(4 + 3*d, :) - l*space%c(1 + d, :))), 0.0_wp, 1.0e-12_wp, 'the end moves along x')
      call tester%near(maxval(abs(space%c(5 + 3*d:6 + 3*d, :))), 0.0_wp, 1.0e-14_wp, 'and in no other direction')
    end do
    call tester%near(maxval(abs(space%d(:, 1) - [0.0_wp, 0.0_wp, 1.0_wp, [(0.0_wp, d=1, 6)], l, 0.0_wp, 0.0_wp]/inertia)), 0.0_wp, &
                     1.0e-14_wp, 'the matrix D')
  end subroutine state_space

  !> The stiffness against differences of the forces along each free coordinate.
  subroutine compare_stiffness(tester, model, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type), intent(inout) :: model     !< the mechanism
    character(len=*), intent(in) :: why          !< its name, for the report of a failure
    real(wp), parameter :: h = 1.0_wp/256.0_wp
    type(plan_type) :: plan
    type(state_type) :: state
    type(resting_type) :: resting, other
    type(error_type), allocatable :: err
    real(wp), allocatable :: forces(:, :), step(:)
    real(wp) :: slope, curvature, error
    integer :: i, j, n
    logical :: moved

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=.true.))
    if (.not. allocated(err)) call put_to_rest(model%mechanism, model%problem%partition, plan, state, resting, err)
    if (.not. allocated(err)) call find_stiffness(model%mechanism, resting, err)
    call tester%no_error(err, why//': the stiffness is found')
    n = size(resting%free)
    allocate (forces(-half_width:half_width, n), step(n))
    do j = 1, n
      do i = -half_width, half_width
        step = 0.0_wp
        step(j) = i*h
        call try_step(model%mechanism, resting, step, other, moved, err)
        call tester%is_true(moved .and. .not. allocated(err), why//': the mechanism moves there')
        forces(i, :) = other%forces
      end do
      do i = 1, n
        call derivatives_from_stencil(forces(:, i), h, slope, curvature, error)
        ! round-off of the forces, some 1e-14 of their sum over the conditioning of the chains, times 2/h
        call tester%near((slope - resting%stiffness(i, j))/resting%stiffness_magnitude, 0.0_wp, 1.0e-10_wp, &
                         why//': the stiffness is the derivative of the forces')
      end do
    end do
  end subroutine compare_stiffness
end module test_equilibrium
