!> A position of equilibrium with its stability, its linearised equations of motion and its modes.
module mech9_linearised_equilibrium
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_data, exit_singular
  use mech9_dynamics_failures, only: failure_no_inertia
  use mech9_simulation_failures, only: failure_gimbal_lock
  use mech9_lapack, only: dsyev
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_tolerances, only: negligible_inertia
  use mech9_eigenmodes, only: eigenmodes_type, find_eigenmodes
  use mech9_mechanism, only: mechanism_type
  use mech9_partition, only: partition_type
  use mech9_linearisation, only: find_matrix, by_rate, by_acceleration
  use mech9_resting_motors, only: motor_coupling_type, release_setpoints, couple_motors
  use mech9_motor_modes, only: find_motor_modes
  use mech9_stopped_motion, only: find_lock
  use mech9_resting_mechanism, only: resting_type, find_stiffness, try_step, return_to_coordinates, refuse_singular
  implicit none
  private
  public :: equilibrium_type, linearise, linearise_in_place, let_follow, copy_equilibrium

  !> A position of equilibrium. Matrices are in SI units, of the coordinates `resting%free`.
  type :: equilibrium_type
    type(resting_type) :: resting               !< the mechanism in this position
    real(wp), allocatable :: inertia(:, :)      !< M [kg m^2, kg m, kg]
    real(wp), allocatable :: damping(:, :)      !< C [N m s/rad, N s/m]
    real(wp), allocatable :: stiffness(:, :)    !< K [N m/rad, N/m]
    real(wp) :: damping_magnitude = 0.0_wp      !< sum of the magnitudes of the terms of the damping, in units of the plan [J s]
    type(eigenmodes_type) :: modes              !< of M x'' + C x' + K x = 0; shapes in SI units
    !> No root grows beyond round-off; where a coordinate has no inertia, no stiffness is negative beyond round-off.
    logical :: is_stable = .false.
    !> A free coordinate that moves no mass in any position; 0: none. There are no modes then, and the growth has no value.
    integer :: without_inertia = 0
    type(motor_coupling_type) :: motors         !< with the states of motors, where there are motors
    integer :: found = 1                        !< number of starts that led to it
  end type equilibrium_type

  !> Conditioning at which the coordinates of the data file are taken again for the matrices.
  real(wp), parameter :: fair_conditioning = 1.0e-4_wp
  !> Stiffness and damping below this part of the sum of their terms are round-off.
  real(wp), parameter :: round_off = 1.0e-11_wp

contains

  !> Linearise the equations of motion in an equilibrium and find their modes. Fails with exit_singular where branches meet in this
  !> position, or where coordinates have no inertia in this position alone.
  subroutine linearise(mechanism, partition, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< with the coordinates of the data file
    type(equilibrium_type), intent(inout) :: found      !< with its position; gets all else
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call release_setpoints(mechanism, partition, found%resting, err)
    if (.not. allocated(err)) &
      call return_to_coordinates(mechanism, partition, fair_conditioning, found%resting, err)
    if (.not. allocated(err)) call linearise_in_place(mechanism, found, err)
  end subroutine linearise

  !> Linearise in the present coordinates, with the motors in the states that they have. Fails as `linearise` does.
  subroutine linearise_in_place(mechanism, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(equilibrium_type), intent(inout) :: found      !< with its position; gets all else
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), allocatable, dimension(:, :) :: m, c
    integer :: n, massless

    call refuse_singular(found%resting, err)
    if (.not. allocated(err)) call find_stiffness(mechanism, found%resting, err)
    if (allocated(err)) return
    associate (resting => found%resting)
      n = size(resting%free)
      allocate (m(n, n), c(n, n))
      call find_matrix(mechanism, resting%plan, resting%state, by_rate, resting%free, resting%linearisation, c, &
                       found%damping_magnitude, err)
      if (allocated(err)) return
      call find_inertia(mechanism, resting, m, massless, err)
      if (allocated(err)) return
      if (massless == 0) then
        call find_eigenmodes(m, c, resting%stiffness, round_off*found%damping_magnitude, round_off*resting%stiffness_magnitude, &
                             found%modes)
        massless = found%modes%without_inertia
      end if
      if (massless > 0) then
        call judge_statics(mechanism, massless, m, found, err)
        return
      end if
      found%without_inertia = 0
      if (size(mechanism%motors) > 0) call couple_motors(mechanism, resting, found%motors, err)
    end associate
    if (.not. allocated(err)) call take_matrices(m, c, found)
  end subroutine linearise_in_place

  !> Take inertia and damping, and find what motors and units change of the modes.
  subroutine take_matrices(m, c, found)
    real(wp), intent(in) :: m(:, :)                     !< (n,n) inertia [J s^2]
    real(wp), intent(in) :: c(:, :)                     !< (n,n) damping [J s]
    type(equilibrium_type), intent(inout) :: found      !< with its stiffness, modes and motors; gets the matrices and the stability
    real(wp) :: per_unit(size(m, 1), size(m, 1))
    integer :: i

    if (allocated(found%motors%states)) then
      if (size(found%motors%states) > 0) call add_motors(m, c, found)
    end if
    found%is_stable = .not. found%modes%growth > 0.0_wp
    associate (resting => found%resting)
      do i = 1, size(m, 1)
        per_unit(:, i) = 1.0_wp/(resting%plan%unit_of(resting%free)*resting%plan%unit_of(resting%free(i)))
        found%modes%shapes(i, :found%modes%count) = found%modes%shapes(i, :found%modes%count)*resting%plan%unit_of(resting%free(i))
      end do
      found%inertia = per_unit*0.5_wp*(m + transpose(m))
      found%damping = per_unit*c
      found%stiffness = per_unit*resting%stiffness
    end associate
  end subroutine take_matrices

  !> Couple the states of motors with the motion, and find the modes again.
  subroutine add_motors(m, c, found)
    real(wp), intent(in) :: m(:, :)                     !< (n,n) inertia [J s^2]
    real(wp), intent(in) :: c(:, :)                     !< (n,n) damping [J s]
    type(equilibrium_type), intent(inout) :: found      !< with its stiffness and the coupling of motors; gets the modes
    real(wp), dimension(size(m, 1), size(m, 1)) :: factors, k, damping
    real(wp), allocatable :: force(:, :), by_position(:, :), by_rate(:, :)
    integer :: failed_at, i

    associate (unit => found%resting%plan%unit_of(found%resting%free), motors => found%motors)
      force = motors%force_by_state
      by_position = motors%rate_by_q
      by_rate = motors%rate_by_dq
      do i = 1, size(m, 1)
        force(i, :) = force(i, :)*unit(i)
        by_position(:, i) = by_position(:, i)*unit(i)
        by_rate(:, i) = by_rate(:, i)*unit(i)
      end do
    end associate
    factors = 0.5_wp*(m + transpose(m))
    k = found%resting%stiffness
    where (abs(k) <= round_off*found%resting%stiffness_magnitude) k = 0.0_wp
    damping = c
    call cholesky_factorize(size(m, 1), factors, failed_at)
    do i = 1, size(m, 1)
      call cholesky_solve(size(m, 1), factors, k(:, i))
      call cholesky_solve(size(m, 1), factors, damping(:, i))
    end do
    do i = 1, size(force, 2)
      call cholesky_solve(size(m, 1), factors, force(:, i))
    end do
    call find_motor_modes(k, damping, force, by_position, by_rate, found%motors%rate_by_state, found%modes)
  end subroutine add_motors

  !> Let some free coordinates follow the others, as closed contacts make them do, and find the modes of these motions.
  subroutine let_follow(kept, followers, follow, found)
    integer, intent(in) :: kept(:)                      !< (k) places of the coordinates that stay free, among the free ones
    integer, intent(in) :: followers(:)                 !< (h) places of the others
    real(wp), intent(in) :: follow(:, :)                !< (h,k) their rates by the rates of those that stay free [rad, m]
    type(equilibrium_type), intent(inout) :: found      !< linearised; changes
    real(wp) :: along(size(found%resting%free), size(kept)), scaled(size(found%resting%free), size(kept))
    real(wp), dimension(size(kept), size(kept)) :: m, c
    integer :: i

    associate (resting => found%resting)
      along = 0.0_wp
      do i = 1, size(kept)
        along(kept(i), i) = 1.0_wp
        along(followers, i) = follow(:, i)
        scaled(:, i) = along(:, i)*resting%plan%unit_of(resting%free(kept(i)))/resting%plan%unit_of(resting%free)
      end do
      resting%stiffness = matmul(transpose(scaled), matmul(resting%stiffness, scaled))
      resting%forces = matmul(resting%forces, scaled)
      do i = 1, size(kept)
        scaled(:, i) = along(:, i)*resting%plan%unit_of(resting%free(kept(i)))
      end do
      if (found%without_inertia == 0) then
        m = matmul(transpose(scaled), matmul(found%inertia, scaled))
        c = matmul(transpose(scaled), matmul(found%damping, scaled))
      end if
      resting%following = resting%free(followers)
      resting%follow = follow
      resting%free = resting%free(kept)
      if (allocated(found%motors%states)) then
        associate (motors => found%motors)
          motors%force_by_state = matmul(transpose(along), motors%force_by_state)
          motors%force_by_input = matmul(transpose(along), motors%force_by_input)
          motors%rate_by_q = matmul(motors%rate_by_q, along)
          motors%rate_by_dq = matmul(motors%rate_by_dq, along)
        end associate
      end if
      if (found%without_inertia > 0) then
        call judge_stiffness(found)
      else
        call find_eigenmodes(m, c, resting%stiffness, round_off*found%damping_magnitude, round_off*resting%stiffness_magnitude, &
                             found%modes)
        call take_matrices(m, c, found)
      end if
    end associate
  end subroutine let_follow

  !> The inertia of the free coordinates, and one that moves no mass.
  subroutine find_inertia(mechanism, resting, m, massless, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< the mechanism at rest; its last variation changes
    real(wp), intent(out) :: m(:, :)                    !< (n,n) [J s^2]
    integer, intent(out) :: massless                    !< its place among the free coordinates; 0: none is found by its own inertia
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    real(wp) :: magnitude
    integer :: i

    massless = 0
    call find_matrix(mechanism, resting%plan, resting%state, by_acceleration, resting%free, resting%linearisation, m, magnitude, &
                     err)
    if (allocated(err)) return
    do i = size(m, 1), 1, -1
      if (.not. m(i, i) > negligible_inertia*magnitude) massless = i
    end do
  end subroutine find_inertia

  !> Judge an equilibrium in which a coordinate moves no mass by its stiffness alone. Fails with exit_singular where it does so in
  !> this position only (gimbal lock): the forces then say nothing about it.
  subroutine judge_statics(mechanism, massless, m, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    integer, intent(in) :: massless                     !< place of the coordinate among the free ones
    real(wp), intent(in) :: m(:, :)                     !< (n,n) inertia of the free coordinates [J s^2]
    type(equilibrium_type), intent(inout) :: found      !< with its position and stiffness; gets its stability
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: elsewhere(size(m, 1), size(m, 1))
    logical :: has_inertia

    call look_elsewhere(mechanism, found%resting, elsewhere, has_inertia, err)
    if (allocated(err)) return
    if (has_inertia) then
      call refuse_lock(mechanism, found%resting, massless, find_lock(m, elsewhere), err)
      return
    end if
    call judge_stiffness(found)
    found%without_inertia = found%resting%free(massless)
    found%modes%count = 0
    found%modes%growth = ieee_value(found%modes%growth, ieee_quiet_nan)
  end subroutine judge_statics

  !> Judge the stability by the stiffness alone.
  subroutine judge_stiffness(found)
    type(equilibrium_type), intent(inout) :: found      !< with its stiffness; gets its stability
    real(wp), dimension(size(found%resting%free), size(found%resting%free)) :: vectors
    real(wp) :: values(size(vectors, 1)), work(34*size(vectors, 1))
    integer :: info

    vectors = 0.5_wp*(found%resting%stiffness + transpose(found%resting%stiffness))
    if (size(values) > 0) call dsyev('N', 'L', size(values), vectors, size(values), values, work, size(work), info)
    found%is_stable = all(values >= -round_off*found%resting%stiffness_magnitude)
  end subroutine judge_stiffness

  !> Fail because coordinates have no inertia in this position alone.
  subroutine refuse_lock(mechanism, resting, massless, is_locked, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(in) :: resting           !< the mechanism at rest
    integer, intent(in) :: massless                     !< place of a coordinate without inertia among the free ones
    logical, intent(in) :: is_locked(:)                 !< (n) the free coordinate can move with others without moving any mass
    type(error_type), allocatable, intent(out) :: err   !< the failure

    if (any(is_locked)) then
      call raise(err, exit_singular, failure_gimbal_lock)
      err%failure%coordinates = pack(resting%free, is_locked)
      err%failure%t = resting%state%t
    else
      call raise(err, exit_data, failure_no_inertia)
      err%failure%coordinates = [resting%free(massless)]
      call add_place(err, place=mechanism%pairs(resting%free(massless))%pair%place)
    end if
  end subroutine refuse_lock

  !> Inertia in another position near by. Where the mechanism cannot move, there is none.
  subroutine look_elsewhere(mechanism, resting, m, has_inertia, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(in) :: resting           !< the mechanism at rest
    real(wp), intent(out) :: m(:, :)                    !< (n,n) inertia of the free coordinates there [J s^2]
    logical, intent(out) :: has_inertia                 !< no motion of them moves no mass
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    real(wp), parameter :: steps(3) = [0.3_wp, 0.1_wp, 0.01_wp]   ! [rad, lengths of the mechanism]
    type(resting_type) :: other
    real(wp) :: factors(size(m, 1), size(m, 1)), step(size(m, 1))
    integer :: i, k, massless, failed_at
    logical :: moved

    has_inertia = .false.
    m = 0.0_wp
    do i = 1, size(steps)
      step = [(steps(i)*(0.7_wp + 0.3_wp*sin(real(k, wp))), k=1, size(step))]
      call try_step(mechanism, resting, step, other, moved, err)
      if (allocated(err)) return
      if (moved) exit
    end do
    if (.not. moved) return
    call find_inertia(mechanism, other, m, massless, err)
    if (allocated(err) .or. massless > 0) return
    factors = m
    call cholesky_factorize(size(step), factors, failed_at)
    has_inertia = failed_at == 0
  end subroutine look_elsewhere

  !> Copy an equilibrium.
  subroutine copy_equilibrium(from, to)
    type(equilibrium_type), intent(in) :: from      !< the equilibrium
    type(equilibrium_type), intent(inout) :: to     !< the same afterwards

    to = from
  end subroutine copy_equilibrium
end module mech9_linearised_equilibrium
