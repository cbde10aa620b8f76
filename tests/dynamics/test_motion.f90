!> The motion as a whole: accelerations of all coordinates against differences over time, potential
!> energy against the forces that come from it, power against the change of energy.
module test_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_model, only: model_type
  use mech9_load, only: load_slot_type
  use mech9_force_load, only: force_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_dynamics_plan, only: make_dynamics_plan
  use mech9_lagrange_work, only: new_lagrange_work
  use mech9_lagrange, only: find_equations, find_motion, complete_accelerations
  use mech9_energy, only: kinetic_energy, potential_energy
  use mech9_literal_lagrange, only: close_chains
  use mech9_loaded_mechanisms, only: check_each_mechanism
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    call check_each_mechanism(test, check_all)
  end subroutine run

  subroutine check_all(test, model, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(inout) :: model   !< the model
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    type(model_type) :: conservative

    call check_over_time(test, model, why)
    conservative = model
    call keep_conservative(conservative)
    call check_potential(test, conservative, why)
  end subroutine check_all

  !> Leave the loads that have a potential energy, without their dissipation.
  subroutine keep_conservative(model)
    type(model_type), intent(inout) :: model   !< the model
    type(load_slot_type), allocatable :: kept(:)
    integer :: i, n

    allocate (kept(size(model%mechanism%loads)))
    n = 0
    do i = 1, size(model%mechanism%loads)
      select type (load => model%mechanism%loads(i)%load)
      type is (force_load_type)
        cycle
      type is (spring_load_type)
        load%damping = 0.0_wp
      type is (coordinate_load_type)
        load%damping = 0.0_wp
        load%force = 0.0_wp
      end select
      n = n + 1
      call move_alloc(model%mechanism%loads(i)%load, kept(n)%load)
    end do
    deallocate (model%mechanism%loads)
    allocate (model%mechanism%loads(n))
    do i = 1, n
      call move_alloc(kept(i)%load, model%mechanism%loads(i)%load)
    end do
  end subroutine keep_conservative

  !> The assembled start with some rates, and everything that its motion needs.
  subroutine begin(model, plan, dynamics, state, work, err)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(out) :: plan                !< its plan
    type(dynamics_plan_type), intent(out) :: dynamics   !< plan of its dynamics
    type(state_type), intent(out) :: state              !< at the start, with some rates
    type(lagrange_work_type), intent(out) :: work       !< the equations at the start
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i

    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    if (allocated(err)) return
    call make_dynamics_plan(model%mechanism, plan, dynamics)
    work = new_lagrange_work(plan, dynamics)
    state%dq(plan%independent) = [(0.9_wp - 0.5_wp*i, i=1, size(plan%independent))]
    ! open chains have their accelerations without the equations
    call find_equations(model%mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    call find_motion(model%mechanism, plan, dynamics, state, work, err)
  end subroutine begin

  !> Move the independent coordinates by q + dq t + ddq t^2/2 about the start: the differences over time of all
  !> closed coordinates are their rates and accelerations, that of the kinetic energy is the power of all forces.
  subroutine check_over_time(test, model, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    !> The accelerations, some hundreds, bend the path within a tenth of a second.
    real(wp), parameter :: h = 1.0_wp/512.0_wp
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(state_type) :: start, state
    type(lagrange_work_type) :: work, generic
    type(error_type), allocatable :: err
    real(wp), allocatable :: q(:, :)
    real(wp) :: energy(-half_width:half_width), rate, acceleration, error, scale
    integer :: i, k, side

    call begin(model, plan, dynamics, start, work, err)
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    allocate (q(plan%n_coordinates, -half_width:half_width))
    generic = work
    do side = -1, 1, 2
      state = start
      do i = 0, side*half_width, side
        associate (own => plan%independent)
          state%q(own) = start%q(own) + i*h*(start%dq(own) + 0.5_wp*i*h*work%accelerations)
          state%dq(own) = start%dq(own) + i*h*work%accelerations
        end associate
        call close_chains(plan, state, err)
        if (.not. allocated(err)) call find_motion(model%mechanism, plan, dynamics, state, generic, err)
        call test%no_error(err, why//': a position nearby is found')
        if (allocated(err)) return
        q(:, i) = state%q
        energy(i) = kinetic_energy(model%mechanism, plan, state)
      end do
    end do
    call complete_accelerations(plan, dynamics, work, start)
    scale = max(1.0_wp, maxval(abs(start%ddq)))
    do k = 1, plan%n_coordinates
      call derivatives_from_stencil(q(k, :), h, rate, acceleration, error)
      ! round-off 2/h and 8/h^2 times that of positions, some 1e-15
      call test%near((start%dq(k) - rate)/scale, 0.0_wp, 1.0e-11_wp, &
                     why//': the rates of all coordinates are slopes of their positions')
      call test%near((start%ddq(k) - acceleration)/scale, 0.0_wp, 1.0e-9_wp, &
                     why//': the accelerations of all coordinates are slopes of their rates')
    end do
    call derivatives_from_stencil(energy, h, rate, acceleration, error)
    call test%near(rate/scale, dot_product(work%forces, start%dq(plan%independent))/scale, 1.0e-9_wp, &
                   why//': the kinetic energy grows by the power of the forces')
  end subroutine check_over_time

  !> Q_p = -dV/dq_p where all loads have a potential energy.
  subroutine check_potential(test, model, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type), intent(in) :: model      !< the model
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    real(wp), parameter :: h = 1.0_wp/128.0_wp
    type(plan_type) :: plan
    type(dynamics_plan_type) :: dynamics
    type(state_type) :: start, state
    type(lagrange_work_type) :: work, generic
    type(error_type), allocatable :: err
    real(wp) :: energy(-half_width:half_width), slope, unused, error
    integer :: i, p, side

    call begin(model, plan, dynamics, start, work, err)
    call test%no_error(err, why//': there is a plan')
    if (allocated(err)) return
    generic = work
    do p = 1, size(plan%independent)
      do side = -1, 1, 2
        state = start
        do i = 0, side*half_width, side
          state%q(plan%independent(p)) = start%q(plan%independent(p)) + i*h
          call close_chains(plan, state, err)
          if (.not. allocated(err)) call find_motion(model%mechanism, plan, dynamics, state, generic, err)
          call test%no_error(err, why//': a position nearby is found')
          if (allocated(err)) return
          energy(i) = potential_energy(model%mechanism, plan, state, generic%view)
        end do
      end do
      call derivatives_from_stencil(energy, h, slope, unused, error)
      ! round-off 2/h of energies of some hundreds of J
      call test%near(work%forces(p), -slope, 1.0e-9_wp, why//': the forces are slopes of the potential energy')
    end do
  end subroutine check_potential
end module test_motion
