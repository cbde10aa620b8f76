!> Lagrange's equations taken literally: (19), (21), (25) with every derivative by differences of closed positions.
!>
!> Sixteenth-order differences over 17 positions, each closed to round-off. Nothing of the dynamics floor
!> is used, and of the kinematics floor positions only: no Jacobian, no rate, no acceleration.
module mech9_literal_lagrange
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_assembly
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_rotation, only: cross
  use mech9_pose, only: pose_type, transformed
  use mech9_inertia, only: second_moments
  use mech9_model, only: model_type
  use mech9_load, only: load_type
  use mech9_force_load, only: force_load_type
  use mech9_spring_load, only: spring_load_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, newton_outcome_type, close_block, factorize_block, apply_change
  use mech9_frame_motion, only: link_motion
  use mech9_block_equations, only: block_residual
  implicit none
  private
  public :: literal_type, literal_equations, close_chains

  !> Distance of neighbouring positions [rad, m]. For mechanisms that change over lengths of order one
  !> truncation is (8!)^2 h^16 = 2e-20, round-off of first derivatives some 2/h units.
  real(wp), parameter :: h = 1.0_wp/64.0_wp

  !> Numbers kept of each body and each load at one position.
  integer, parameter :: body_size = 12      !< mass centre, rotation by columns
  integer, parameter :: load_size = 14      !< point of attack, rotation of its link, length of a spring, coordinate

  !> The equations at one position and for one set of rates.
  type :: literal_type
    real(wp), allocatable :: coefficients(:, :)   !< a_pr of (21)
    real(wp), allocatable :: velocity_terms(:)    !< sum of (d a_pr/dq_l - 1/2 d a_lr/dq_p) dq_l dq_r of (19)
    real(wp), allocatable :: forces(:)            !< Q_p of (25)
  end type literal_type

contains

  !> The equations at the closed position in `state`, for its rates of the independent coordinates.
  subroutine literal_equations(model, plan, state, literal, err)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< its plan
    type(state_type), intent(in) :: state               !< a closed position
    type(literal_type), intent(out) :: literal          !< coefficients, velocity terms and forces
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(state_type) :: around(-half_width:half_width)
    real(wp), allocatable :: derivatives(:, :), a(:, :, :), da(:, :, :), rates(:)
    real(wp) :: unused, error
    integer :: n, l, p, r, i

    n = size(plan%independent)
    rates = state%dq(plan%independent)
    call differentiate(model, plan, state, derivatives, err)
    if (allocated(err)) return
    literal%coefficients = coefficients_of(model, derivatives)
    literal%forces = forces_of(model, snapshot(model, plan, state), derivatives, rates)

    allocate (a(n, n, -half_width:half_width), da(n, n, n), literal%velocity_terms(n))
    do l = 1, n
      call neighbours(plan, state, plan%independent(l), around, err)
      do i = -half_width, half_width
        if (.not. allocated(err)) call differentiate(model, plan, around(i), derivatives, err)
        if (allocated(err)) return
        a(:, :, i) = coefficients_of(model, derivatives)
      end do
      do r = 1, n
        do p = 1, n
          call derivatives_from_stencil(a(p, r, :), h, da(p, r, l), unused, error)
        end do
      end do
    end do
    do p = 1, n
      literal%velocity_terms(p) = 0.0_wp
      do l = 1, n
        do r = 1, n
          literal%velocity_terms(p) = literal%velocity_terms(p) + (da(p, r, l) - 0.5_wp*da(l, r, p))*rates(l)*rates(r)
        end do
      end do
    end do
  end subroutine literal_equations

  !> The closed positions at distances i h of one independent coordinate, each reached from the one before.
  subroutine neighbours(plan, centre, coordinate, around, err)
    type(plan_type), intent(in) :: plan                               !< its plan
    type(state_type), intent(in) :: centre                            !< a closed position
    integer, intent(in) :: coordinate                                 !< coordinate that is changed
    type(state_type), intent(out) :: around(-half_width:half_width)   !< closed positions at i h
    type(error_type), allocatable, intent(out) :: err                 !< allocated if it failed
    integer :: i, side

    around(0) = centre
    do side = -1, 1, 2
      do i = side, side*half_width, side
        around(i) = around(i - side)
        around(i)%q(coordinate) = centre%q(coordinate) + i*h
        call close_chains(plan, around(i), err)
        if (allocated(err)) return
      end do
    end do
  end subroutine neighbours

  !> Close all chains from the coordinates in `state`, with one step of Newton's method more than it needs.
  subroutine close_chains(plan, state, err)
    type(plan_type), intent(in) :: plan                 !< its plan
    type(state_type), intent(inout) :: state            !< its coordinates, from guesses to closed ones
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(block_work_type) :: work
    type(newton_outcome_type) :: outcome
    integer :: b

    do b = 1, size(plan%blocks)
      work = new_block_work(plan%blocks(b))
      call close_block(plan, plan%blocks(b), state, work, outcome, err)
      if (allocated(err)) return
      if (.not. outcome%converged .or. outcome%correction > 0.5_wp) then
        call raise(err, exit_assembly, 'a neighbouring position does not close')
        return
      end if
      if (size(plan%blocks(b)%unknowns) == 0) cycle
      call factorize_block(plan, plan%blocks(b), state, work)
      call block_residual(plan, plan%blocks(b), state, work%right)
      work%right = -work%right
      call work%equations%solve(work%right, work%change)
      call apply_change(plan, plan%blocks(b), work%change, state)
      call close_block(plan, plan%blocks(b), state, work, outcome, err)
      if (allocated(err)) return
    end do
  end subroutine close_chains

  !> Derivatives of a snapshot with respect to each independent coordinate: (snapshot, I).
  subroutine differentiate(model, plan, state, derivatives, err)
    type(model_type), intent(in) :: model                     !< the model
    type(plan_type), intent(in) :: plan                       !< its plan
    type(state_type), intent(in) :: state                     !< its state
    real(wp), allocatable, intent(out) :: derivatives(:, :)   !< (snapshot,I) by the independent coordinates
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(state_type) :: around(-half_width:half_width)
    real(wp), allocatable :: values(:, :)
    real(wp) :: unused, error
    integer :: n, p, i

    n = body_size*size(model%mechanism%bodies) + load_size*size(model%mechanism%loads)
    allocate (derivatives(n, size(plan%independent)), values(n, -half_width:half_width))
    do p = 1, size(plan%independent)
      call neighbours(plan, state, plan%independent(p), around, err)
      if (allocated(err)) return
      do i = -half_width, half_width
        values(:, i) = snapshot(model, plan, around(i))
      end do
      do i = 1, n
        call derivatives_from_stencil(values(i, :), h, derivatives(i, p), unused, error)
      end do
    end do
  end subroutine differentiate

  !> All numbers that are differentiated: of each body, then of each load.
  function snapshot(model, plan, state) result(numbers)
    type(model_type), intent(in) :: model           !< the model
    type(plan_type), intent(in) :: plan             !< its plan
    type(state_type), intent(in) :: state           !< its state
    real(wp) :: numbers(body_size*size(model%mechanism%bodies) + load_size*size(model%mechanism%loads))
    type(pose_type) :: pose
    integer :: i, first

    do i = 1, size(model%mechanism%bodies)
      pose = link_pose(plan, state, model%mechanism%bodies(i)%link)
      first = body_size*(i - 1)
      numbers(first + 1:first + 3) = transformed(pose, model%mechanism%bodies(i)%centre)
      numbers(first + 4:first + 12) = reshape(pose%r, [9])
    end do
    do i = 1, size(model%mechanism%loads)
      first = body_size*size(model%mechanism%bodies) + load_size*(i - 1)
      numbers(first + 1:first + load_size) = load_snapshot(model%mechanism%loads(i)%load, plan, state)
    end do
  end function snapshot

  function load_snapshot(load, plan, state) result(numbers)
    class(load_type), intent(in) :: load    !< the load
    type(plan_type), intent(in) :: plan     !< its plan
    type(state_type), intent(in) :: state   !< its state
    real(wp) :: numbers(load_size)
    type(pose_type) :: pose

    numbers = 0.0_wp
    select type (load)
    type is (force_load_type)
      pose = link_pose(plan, state, load%link)
      numbers(1:3) = transformed(pose, load%position)
      numbers(4:12) = reshape(pose%r, [9])
    type is (spring_load_type)
      numbers(13) = norm2(transformed(link_pose(plan, state, load%links(2)), load%positions(:, 2)) &
                          - transformed(link_pose(plan, state, load%links(1)), load%positions(:, 1)))
    type is (coordinate_load_type)
      numbers(14) = state%q(load%coordinate)
    class default
      error stop 'a kind of load that the literal equations do not know'
    end select
  end function load_snapshot

  !> A link's own system in that of link 1.
  pure function link_pose(plan, state, link) result(pose)
    type(plan_type), intent(in) :: plan     !< its plan
    type(state_type), intent(in) :: state   !< its state
    integer, intent(in) :: link             !< its number
    type(pose_type) :: pose
    real(wp) :: omega(3), v(3)

    call link_motion(plan, state, link, pose%r, pose%p, omega, v)
  end function link_pose

  !> (21): sum of m du/dq_p . du/dq_r + sum_jkl dA_jk/dq_p dA_jl/dq_r J'_kl.
  pure function coefficients_of(model, derivatives) result(a)
    type(model_type), intent(in) :: model           !< the model
    real(wp), intent(in) :: derivatives(:, :)       !< (snapshot,I) by the independent coordinates
    real(wp) :: a(size(derivatives, 2), size(derivatives, 2))
    real(wp) :: moments(3, 3), rotation_p(3, 3), rotation_r(3, 3)
    integer :: i, first, p, r, j, k, l

    a = 0.0_wp
    do i = 1, size(model%mechanism%bodies)
      moments = second_moments(model%mechanism%bodies(i)%inertia)
      first = body_size*(i - 1)
      do r = 1, size(a, 2)
        rotation_r = reshape(derivatives(first + 4:first + 12, r), [3, 3])
        do p = 1, size(a, 1)
          rotation_p = reshape(derivatives(first + 4:first + 12, p), [3, 3])
          a(p, r) = a(p, r) + model%mechanism%bodies(i)%mass*dot_product(derivatives(first + 1:first + 3, p), &
                                                                   derivatives(first + 1:first + 3, r))
          do l = 1, 3
            do k = 1, 3
              do j = 1, 3
                a(p, r) = a(p, r) + rotation_p(j, k)*rotation_r(j, l)*moments(k, l)
              end do
            end do
          end do
        end do
      end do
    end do
  end function coefficients_of

  !> (25): forces and couples on links; springs as -dV/dq, dampers by the rates of their lengths.
  function forces_of(model, here, derivatives, rates) result(forces)
    type(model_type), intent(in) :: model           !< the model
    real(wp), intent(in) :: here(:)                 !< snapshot
    real(wp), intent(in) :: derivatives(:, :)       !< (snapshot,I) by the independent coordinates
    real(wp), intent(in) :: rates(:)                !< of the independent coordinates
    real(wp) :: forces(size(rates))
    integer :: i, p, first

    forces = 0.0_wp
    do p = 1, size(rates)
      do i = 1, size(model%mechanism%bodies)
        first = body_size*(i - 1)
        forces(p) = forces(p) + model%mechanism%bodies(i)%mass &
                    *dot_product(model%mechanism%gravity, derivatives(first + 1:first + 3, p))
      end do
    end do
    do i = 1, size(model%mechanism%loads)
      first = body_size*size(model%mechanism%bodies) + load_size*(i - 1)
      forces = forces + load_forces(model%mechanism%loads(i)%load, here(first + 1:first + load_size), &
                                    derivatives(first + 1:first + load_size, :), rates)
    end do
  end function forces_of

  !> Generalized forces of one load.
  function load_forces(load, here, derivatives, rates) result(forces)
    class(load_type), intent(in) :: load        !< the load
    real(wp), intent(in) :: here(load_size)     !< its part of the snapshot
    real(wp), intent(in) :: derivatives(:, :)   !< (snapshot,I) by the independent coordinates
    real(wp), intent(in) :: rates(:)            !< of the independent coordinates
    real(wp) :: forces(size(rates)), rotation(3, 3), force(3), torque(3)
    integer :: p, l

    select type (load)
    type is (force_load_type)
      rotation = reshape(here(4:12), [3, 3])
      force = load%force
      torque = load%torque
      if (load%turns_with_link) then
        force = matmul(rotation, load%force)
        torque = matmul(rotation, load%torque)
      end if
      do p = 1, size(rates)
        forces(p) = dot_product(force, derivatives(1:3, p))
        ! a couple as forces S_l = (torque x e_l)/2 at the tips of the link's unit vectors e_l: their moment is
        ! (3 torque - torque)/2, their sum does no work in a translation of the link
        do l = 1, 3
          forces(p) = forces(p) + 0.5_wp*dot_product(cross(torque, rotation(:, l)), derivatives(3*l + 1:3*l + 3, p))
        end do
      end do
    type is (spring_load_type)
      forces = -(load%stiffness*(here(13) - load%free_length) + load%damping*dot_product(derivatives(13, :), rates)) &
               *derivatives(13, :)
    type is (coordinate_load_type)
      forces = (load%force - load%stiffness*(here(14) - load%rest) &
                - load%damping*dot_product(derivatives(14, :), rates))*derivatives(14, :)
    class default
      error stop 'a kind of load that the literal equations do not know'
    end select
  end function load_forces
end module mech9_literal_lagrange
