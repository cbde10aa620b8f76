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
  public :: equilibrium_type, linearise, copy_equilibrium

  !> A position of equilibrium. Matrices are in SI units, of the coordinates `resting%free`.
  type :: equilibrium_type
    type(resting_type) :: resting               !< the mechanism in this position
    real(wp), allocatable :: inertia(:, :)      !< M [kg m^2, kg m, kg]
    real(wp), allocatable :: damping(:, :)      !< C [N m s/rad, N s/m]
    real(wp), allocatable :: stiffness(:, :)    !< K [N m/rad, N/m]
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
    real(wp), allocatable, dimension(:, :) :: m, c, per_unit
    real(wp) :: c_magnitude
    integer :: i, n, massless

    call release_setpoints(mechanism, partition, found%resting, err)
    if (.not. allocated(err)) &
      call return_to_coordinates(mechanism, partition, fair_conditioning, found%resting, err)
    if (allocated(err)) return
    call refuse_singular(found%resting, err)
    if (.not. allocated(err)) call find_stiffness(mechanism, found%resting, err)
    if (allocated(err)) return
    associate (resting => found%resting)
      n = size(resting%free)
      allocate (m(n, n), c(n, n))
      call find_matrix(mechanism, resting%plan, resting%state, by_rate, resting%free, resting%linearisation, c, c_magnitude, err)
      if (allocated(err)) return
      call find_inertia(mechanism, resting, m, massless, err)
      if (allocated(err)) return
      if (massless == 0) then
        call find_eigenmodes(m, c, resting%stiffness, round_off*c_magnitude, round_off*resting%stiffness_magnitude, found%modes)
        massless = found%modes%without_inertia
      end if
      if (massless > 0) then
        call judge_statics(mechanism, massless, m, found, err)
        return
      end if
      if (size(mechanism%motors) > 0) call add_motors(mechanism, m, c, found, err)
      if (allocated(err)) return
      found%without_inertia = 0
      found%is_stable = .not. found%modes%growth > 0.0_wp
      allocate (per_unit(n, n))
      do i = 1, n
        per_unit(:, i) = 1.0_wp/(resting%plan%unit_of(resting%free)*resting%plan%unit_of(resting%free(i)))
        found%modes%shapes(i, :found%modes%count) = found%modes%shapes(i, :found%modes%count)*resting%plan%unit_of(resting%free(i))
      end do
      found%inertia = per_unit*0.5_wp*(m + transpose(m))
      found%damping = per_unit*c
      found%stiffness = per_unit*resting%stiffness
    end associate
  end subroutine linearise

  !> Couple the motors with the motion, and find the modes again where these have states.
  subroutine add_motors(mechanism, m, c, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    real(wp), intent(in) :: m(:, :)                     !< (n,n) inertia [J s^2]
    real(wp), intent(in) :: c(:, :)                     !< (n,n) damping [J s]
    type(equilibrium_type), intent(inout) :: found      !< with its stiffness; gets coupling and modes
    type(error_type), allocatable, intent(out) :: err   !< allocated if the law of a motor has no value
    real(wp), dimension(size(m, 1), size(m, 1)) :: factors, k, damping
    real(wp), allocatable :: force(:, :), by_position(:, :), by_rate(:, :)
    integer :: failed_at, i

    call couple_motors(mechanism, found%resting, found%motors, err)
    if (allocated(err) .or. size(found%motors%states) == 0) return
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
    real(wp), dimension(size(m, 1), size(m, 1)) :: elsewhere, vectors
    real(wp) :: values(size(m, 1)), work(34*size(m, 1))
    integer :: info
    logical :: has_inertia

    call look_elsewhere(mechanism, found%resting, elsewhere, has_inertia, err)
    if (allocated(err)) return
    if (has_inertia) then
      call refuse_lock(mechanism, found%resting, massless, find_lock(m, elsewhere), err)
      return
    end if
    vectors = 0.5_wp*(found%resting%stiffness + transpose(found%resting%stiffness))
    call dsyev('N', 'L', size(values), vectors, size(values), values, work, size(work), info)
    found%is_stable = all(values >= -round_off*found%resting%stiffness_magnitude)
    found%without_inertia = found%resting%free(massless)
    found%modes%count = 0
    found%modes%growth = ieee_value(found%modes%growth, ieee_quiet_nan)
  end subroutine judge_statics

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
