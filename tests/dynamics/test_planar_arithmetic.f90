!> Planar arithmetic gives what spatial arithmetic gives, to round-off, whatever the plane; and it is used where
!> all pairs of a mechanism have one plane, and only there. Planar blocks of spatial mechanisms give what these give in space.
!>
!> Compares the program with itself: planar and spatial arithmetic.
module test_planar_arithmetic
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_random_geometry, only: random_rotation
  use mech9_point, only: point_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_equations, find_motion, complete_accelerations
  use mech9_energy, only: kinetic_energy, potential_energy
  use mech9_sample_mechanisms, only: general_loop
  use mech9_mechanism_families, only: axis_type, home_mechanism, planar_axes
  use mech9_mixed_mechanisms, only: mixed_axes, mixed_mechanism
  use mech9_loaded_mechanisms, only: loaded_fig1, five_bar, open_chain, load_everything
  use mech9_testing, only: tester_type
  use mech9_frame_motion, only: point_motion
  implicit none
  private
  public :: run

  !> All that an evaluation of the motion gives.
  type :: result_type
    logical :: planar = .false.
    real(wp) :: conditioning = 1.0_wp
    real(wp), allocatable :: q(:), dq(:), ddq(:)
    real(wp), allocatable :: points(:, :)
    real(wp), allocatable :: coefficients(:, :), velocity_terms(:), forces(:)
    real(wp) :: energies(2) = 0.0_wp
  end type result_type

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('known_mechanisms')) call known_mechanisms(test)
    if (test%runs('any_plane')) call any_plane(test)
    if (test%runs('no_plane')) call no_plane(test)
    if (test%runs('planar_blocks')) call planar_blocks(test)
  end subroutine run

  subroutine known_mechanisms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model

    call loaded_fig1(5, model)
    call compare(test, model, .true., 'two chains one after the other')
    call loaded_fig1(1, model)
    call compare(test, model, .true., 'two chains together')
    call five_bar(model)
    call compare(test, model, .true., 'two freedoms')
  end subroutine known_mechanisms

  !> Two loops with sliding pairs and an open end, driven by turning and by sliding, and a loop on a turning link; in the
  !> plane z = 0 and turned into any other, the links at different heights, a pair given either way round.
  subroutine any_plane(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    integer, parameter :: links(2, 8) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 3, 5, 6, 5, 6, 1, 5, 7], [2, 8])
    integer, parameter :: on_link_2(2, 5) = reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 2], [2, 5])
    type(model_type) :: model
    type(random_type) :: random
    type(axis_type) :: axes(8)
    real(wp) :: turn(3, 3), side
    integer :: trial, k, slide_each

    do trial = 1, 12
      slide_each = mod(trial, 4)
      if (slide_each == 1) slide_each = 5
      axes = planar_axes(8, slide_each, random)
      turn = random_rotation(random)
      do k = 1, 8
        axes(k)%point(3) = random%symmetric()
        ! against the normal as well as along it
        side = random%symmetric()
        if (.not. axes(k)%slides) axes(k)%along = sign(1.0_wp, side)*axes(k)%along
        if (trial <= 4) cycle
        axes(k)%point = matmul(turn, axes(k)%point)
        axes(k)%along = matmul(turn, axes(k)%along)
      end do
      call home_mechanism(7, links, axes, [1, 8], model)
      call load_everything(random, model)
      call compare(test, model, .true., 'any plane')
      call home_mechanism(7, links, axes, [2, 8], model)
      call load_everything(random, model)
      call compare(test, model, .true., merge('any plane, driven by a slide', 'any plane, driven by a hinge', &
                                            axes(2)%slides))
      call home_mechanism(5, on_link_2, axes(:5), [1, 2], model)
      call load_everything(random, model)
      call compare(test, model, .true., 'a loop on a turning link')
    end do
  end subroutine any_plane

  !> Axes that have no plane in common, by as little as may be meant.
  subroutine no_plane(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(random_type) :: random
    type(axis_type) :: axes(3)

    call open_chain(model)
    call compare(test, model, .false., 'a spatial chain')
    axes = planar_axes(3, 3, random)
    call home_mechanism(4, reshape([1, 2, 2, 3, 3, 4], [2, 3]), axes, [1, 2, 3], model)
    call load_everything(random, model)
    call compare(test, model, .true., 'an open planar chain')
    axes(2)%along(1) = 1.0e-9_wp
    call home_mechanism(4, reshape([1, 2, 2, 3, 3, 4], [2, 3]), axes, [1, 2, 3], model)
    call load_everything(random, model)
    call compare(test, model, .false., 'an axis that is not quite along the normal')
    axes(2)%along(1) = 0.0_wp
    axes(3)%along = [1.0_wp, 0.0_wp, 1.0e-9_wp]
    call home_mechanism(4, reshape([1, 2, 2, 3, 3, 4], [2, 3]), axes, [1, 2, 3], model)
    call load_everything(random, model)
    call compare(test, model, .false., 'a way that is not quite across the normal')
    call general_loop(model)
    call load_everything(random, model)
    call compare(test, model, .false., 'a spatial loop')
  end subroutine no_plane

  !> Planar loops in several planes, joined by hinges across these planes.
  subroutine planar_blocks(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(random_type) :: random
    type(result_type) :: result
    integer :: trial, compared

    compared = 0
    do trial = 1, 60
      call mixed_mechanism(mixed_axes(modulo(trial, 3) + 3, random), model)
      call load_everything(random, model)
      call add_point(model)
      call evaluate(test, model, .true., 'planar blocks', result)
      ! near a singular position round-off decides
      if (result%conditioning < 0.03_wp) cycle
      call compare(test, model, .false., 'planar blocks')
      compared = compared + 1
    end do
    call test%is_true(compared >= 5, 'some mechanisms with planar blocks are compared')
  end subroutine planar_blocks

  !> One point, on the last link.
  subroutine add_point(model)
    type(model_type), intent(inout) :: model   !< the model

    if (allocated(model%mechanism%points)) deallocate (model%mechanism%points)
    allocate (model%mechanism%points(1))
    model%mechanism%points(1) = point_type('P', model%mechanism%structure%n_links, [0.3_wp, -0.2_wp, 0.5_wp])
  end subroutine add_point

  !> Both arithmetics on one mechanism. Each number is a sum of some dozens of terms, and what is solved for
  !> is known to round-off over the conditioning of the chains, accelerations to that once more.
  subroutine compare(test, model, is_planar, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the model
    logical, intent(in) :: is_planar           !< it must have planar arithmetic
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(result_type) :: flat, space
    real(wp) :: tolerance

    call add_point(model)
    call evaluate(test, model, .false., why, flat)
    call evaluate(test, model, .true., why, space)
    call test%is_true((flat%planar .eqv. is_planar) .and. .not. space%planar, why//': planar mechanisms alone are found planar')
    call test%near(flat%conditioning, space%conditioning, 1.0e-12_wp, why//': the conditioning is equal')
    tolerance = 1.0e-14_wp/space%conditioning
    call test%is_true(tolerance < 1.0e-12_wp, why//': the positions are well conditioned')
    call check(test, flat%q, space%q, tolerance, why//': the positions are equal')
    call check(test, flat%dq, space%dq, tolerance, why//': the rates are equal')
    tolerance = 10.0_wp*tolerance
    call check(test, flat%ddq, space%ddq, tolerance, why//': the accelerations are equal')
    call check(test, reshape(flat%points, [9]), reshape(space%points, [9]), tolerance, &
               why//': the point has equal position, velocity and acceleration')
    call check(test, reshape(flat%coefficients, [size(flat%coefficients)]), &
               reshape(space%coefficients, [size(space%coefficients)]), tolerance, why//': the coefficients of motion are equal')
    call check(test, flat%velocity_terms, space%velocity_terms, tolerance, why//': the velocity terms are equal')
    call check(test, flat%forces, space%forces, tolerance, why//': the generalized forces are equal')
    call check(test, flat%energies, space%energies, tolerance, why//': the energies are equal')
  end subroutine compare

  !> The motion of a mechanism at its start, with some rates.
  subroutine evaluate(test, model, in_space, why, result)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    logical, intent(in) :: in_space            !< in spatial arithmetic even where planar arithmetic would do
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(result_type), intent(out) :: result   !< all numbers of its motion
    type(plan_type) :: plan
    type(state_type) :: state
    type(dynamics_plan_type) :: dynamics
    type(lagrange_work_type) :: work
    type(error_type), allocatable :: err
    integer :: i

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err, &
                   planning_settings_type(in_space=in_space))
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    call make_dynamics_plan(model%mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    state%dq(plan%independent) = [(1.3_wp - 0.7_wp*i, i=1, size(plan%independent))]
    ! open chains have their accelerations without the equations
    call find_equations(model%mechanism, plan, dynamics, state, work, err)
    call test%no_error(err, why//': the equations are found')
    call find_motion(model%mechanism, plan, dynamics, state, work, err)
    call test%no_error(err, why//': the motion is found')
    if (allocated(err)) return
    call complete_accelerations(plan, dynamics, work, state)
    result%planar = plan%planar%used
    do i = 1, size(work%blocks)
      result%conditioning = min(result%conditioning, work%blocks(i)%equations%conditioning())
    end do
    result%q = state%q
    result%dq = state%dq
    result%ddq = state%ddq
    result%coefficients = work%coefficients
    result%velocity_terms = work%velocity_terms
    result%forces = work%forces
    allocate (result%points(3, 3))
    associate (point => model%mechanism%points(1))
      call point_motion(plan, state, point%link, point%position, result%points(:, 1), result%points(:, 2), &
                        result%points(:, 3))
    end associate
    result%energies = [kinetic_energy(model%mechanism, plan, state), potential_energy(model%mechanism, plan, state, work%view)]
  end subroutine evaluate

  subroutine check(test, numbers, expected, tolerance, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: numbers(:)         !< numbers that are checked
    real(wp), intent(in) :: expected(:)        !< the right numbers, as many
    real(wp), intent(in) :: tolerance          !< over the largest number
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong

    call test%near(maxval(abs(numbers - expected))/max(1.0_wp, maxval(abs(expected))), 0.0_wp, tolerance, why)
  end subroutine check
end module test_planar_arithmetic
