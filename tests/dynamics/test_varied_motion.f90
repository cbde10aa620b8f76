!> Derivatives of energies, required forces and poses by all parameters, against differences of mechanisms with other parameters that
!> have the same motion of their independent coordinates; a pendulum in closed form.
module test_varied_motion
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_varied_document, only: varied_document_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_frame_motion, only: link_motion, point_motion
  use mech9_linearisation, only: linearisation_type, new_linearisation, find_forces
  use mech9_energy, only: kinetic_energy, potential_energy
  use mech9_varied_motion, only: varied_motion_type, new_varied_motion, find_varied_motion, find_varied_points
  use mech9_varied_energy, only: varied_energy_type, new_varied_energy, find_varied_energy
  use mech9_varied_forces, only: varied_forces_type, new_varied_forces, find_varied_forces
  use mech9_varied_poses, only: find_varied_poses
  use mech9_small_models, only: loaded_pendulum, loaded_four_bar, loaded_screw
  use mech9_text_models, only: varied_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('closed_form')) call closed_form(test)
    if (test%runs('pendulum')) call compare(test, loaded_pendulum, 'pendulum')
    if (test%runs('four_bar')) call compare(test, loaded_four_bar, 'four-bar')
    if (test%runs('screw')) call compare(test, loaded_screw, 'crank, rod and screw')
  end subroutine run

  !> The numbers of a mechanism whose first coordinate has a rate of 1.3 and an acceleration of -0.7: kinetic and potential energy, the
  !> force that it requires, points, and poses of the links.
  subroutine find_numbers(model, start, numbers, state, plan, err)
    type(model_type), intent(in) :: model                   !< the mechanism
    real(wp), intent(in) :: start(:)                        !< (M) coordinates, from guesses to closed ones [rad, m]
    real(wp), allocatable, intent(out) :: numbers(:)        !< the numbers
    type(state_type), intent(out) :: state                  !< the motion
    type(plan_type), intent(out) :: plan                    !< the plan, in space
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(linearisation_type) :: linearisation
    real(wp) :: r(3, 3), p(3), omega(3), v(3), motion(3, 3)
    real(wp), allocatable :: poses(:)
    integer :: i

    call make_plan(model%mechanism, model%problem%partition, start, plan, state, err, planning_settings_type(in_space=.true.))
    if (allocated(err)) return
    state%dq(1) = 1.3_wp
    state%ddq(1) = -0.7_wp
    call new_linearisation(model%mechanism, plan, linearisation)
    call find_forces(model%mechanism, plan, state, linearisation, err)
    if (allocated(err)) return
    numbers = [kinetic_energy(model%mechanism, plan, state), &
               potential_energy(model%mechanism, plan, state, linearisation%tree%loads%view), linearisation%forces(1)]
    do i = 1, size(model%mechanism%points)
      associate (point => model%mechanism%points(i))
        call point_motion(plan, state, point%link, point%position, motion(:, 1), motion(:, 2), motion(:, 3))
      end associate
      numbers = [numbers, reshape(motion, [9])]
    end do
    allocate (poses(0))
    do i = 1, plan%n_links
      call link_motion(plan, state, i, r, p, omega, v)
      numbers = [numbers, p]
      poses = [poses, reshape(transpose(r), [9])]
    end do
    numbers = [numbers, poses]
  end subroutine find_numbers

  !> The derivatives of these numbers.
  subroutine find_changes(test, varied, model, state, plan, changes)
    type(tester_type), intent(inout) :: test               !< counts the checks
    type(varied_document_type), intent(inout) :: varied    !< the model as a function of its parameters
    type(model_type), intent(in) :: model                  !< the present model
    type(state_type), intent(in) :: state                  !< the motion
    type(plan_type), intent(in) :: plan                    !< the plan
    real(wp), allocatable, intent(out) :: changes(:, :)    !< (P,numbers)
    type(varied_motion_type) :: motion
    type(varied_energy_type) :: energy
    type(varied_forces_type) :: forces
    type(error_type), allocatable :: err
    integer :: p, n

    n = size(model%parameters)
    allocate (changes(n, 3 + 9*size(model%mechanism%points) + 12*plan%n_links))
    call new_varied_motion(varied, model, plan, motion, err)
    if (.not. allocated(err)) call find_varied_motion(model, state, motion, err)
    call test%no_error(err, 'there are derivatives of the motion')
    if (allocated(err)) return
    call new_varied_energy(model, motion, energy)
    call find_varied_energy(model, motion, energy)
    call new_varied_forces(model, motion, forces)
    call find_varied_forces(model, motion, forces, err)
    call test%no_error(err, 'there are derivatives of forces')
    call find_varied_points(model, motion)
    do p = 1, n
      changes(p, :3) = [energy%kinetic(p), energy%potential(p), forces%changes(p, 1)]
      changes(p, 4:3 + 9*size(model%mechanism%points)) = reshape(motion%points(p, :, :, :), [9*size(model%mechanism%points)])
    end do
    call find_varied_poses(motion, changes(:, 4 + 9*size(model%mechanism%points):))
  end subroutine find_changes

  !> Compare all derivatives with differences.
  subroutine compare(test, text, name)
    type(tester_type), intent(inout) :: test   !< counts the checks
    character(len=*), intent(in) :: text       !< of a data file
    character(len=*), intent(in) :: name       !< of the mechanism, for the report of a failure
    real(wp), parameter :: h = 1.0_wp/1024.0_wp
    type(varied_document_type), target :: varied
    type(model_type) :: model, other
    type(state_type) :: state, beside
    type(plan_type) :: plan, other_plan
    type(error_type), allocatable :: err
    real(wp), allocatable :: changes(:, :), numbers(:), values(:, :), x(:)
    real(wp) :: slope, curvature, error
    integer :: p, k, i

    call varied_from_text(test, text, dynamics, varied, model)
    call find_numbers(model, model%problem%initial%position, numbers, state, plan, err)
    call test%no_error(err, name//': there is a motion')
    if (allocated(err)) return
    call find_changes(test, varied, model, state, plan, changes)
    allocate (values(size(numbers), -half_width:half_width))
    do p = 1, size(model%parameters)
      do k = -half_width, half_width
        x = model%parameters%value
        x(p) = x(p) + k*h
        call varied%at(x, other, err)
        if (.not. allocated(err)) call find_numbers(other, state%q, numbers, beside, other_plan, err)
        call test%no_error(err, name//': there is a motion nearby')
        if (allocated(err)) return
        values(:, k) = numbers
      end do
      do i = 1, size(numbers)
        call derivatives_from_stencil(values(i, :), h, slope, curvature, error)
        ! round-off of energies and forces up to some ten, some 1e-14 over a conditioning of a tenth, times 2/h
        call test%near(changes(p, i), slope, 1.0e-9_wp, name//': derivatives by '//trim(model%parameters(p)%name))
      end do
    end do
  end subroutine compare

  !> T = (m l^2 + J) dq^2/2, V = m g l (-cos q) + k q^2/2, f = (m l^2 + J) ddq + m g l sin q + k q + d dq.
  subroutine closed_form(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: q = 0.6_wp, dq = 1.3_wp, ddq = -0.7_wp, m = 2.0_wp, l = 0.8_wp, g = 9.81_wp
    type(varied_document_type), target :: varied
    type(model_type) :: model
    type(state_type) :: state
    type(plan_type) :: plan
    type(error_type), allocatable :: err
    real(wp), allocatable :: changes(:, :), numbers(:)
    real(wp) :: expected(6, 3)

    call varied_from_text(test, loaded_pendulum, dynamics, varied, model)
    call find_numbers(model, model%problem%initial%position, numbers, state, plan, err)
    call test%no_error(err, 'there is a motion')
    call find_changes(test, varied, model, state, plan, changes)
    ! by mass, inertia, centre (-l), stiffness, damping and gravity (-g)
    expected(:, 1) = [0.5_wp*l**2*dq**2, 0.5_wp*dq**2, -m*l*dq**2, 0.0_wp, 0.0_wp, 0.0_wp]
    expected(:, 2) = [-g*l*cos(q), 0.0_wp, m*g*cos(q), 0.5_wp*q**2, 0.0_wp, m*l*cos(q)]
    expected(:, 3) = [l**2*ddq + g*l*sin(q), ddq, -2.0_wp*m*l*ddq - m*g*sin(q), q, dq, -m*l*sin(q)]
    ! sums of a few products of numbers up to ten
    call test%near(maxval(abs(changes(:, :3) - expected)), 0.0_wp, 1.0e-12_wp, 'energies and force of a pendulum')
  end subroutine closed_form
end module test_varied_motion
