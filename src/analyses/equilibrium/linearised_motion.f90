!> The linearised equations of motion about a motion at one of its times: how small deviations from it go on.
!>
!> With the forces f(q, dq, ddq, t) that a motion requires beyond its loads, f = 0 along the motion, and deviations x of the free
!> coordinates follow M x'' + C x' + K x = u with M, C and K the derivatives of f there. About a motion K contains those of inertial forces.
module mech9_linearised_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_simulation_failures, only: failure_gimbal_lock
  use mech9_cholesky, only: cholesky_factorize
  use mech9_mechanism, only: mechanism_type
  use mech9_partition, only: partition_type, free_coordinate
  use mech9_state, only: state_type
  use mech9_linearisation, only: new_linearisation, find_forces, find_matrix, by_rate, by_acceleration
  use mech9_motion_in_space, only: place_in_space, refuse_singular_chains
  use mech9_resting_mechanism, only: find_stiffness
  use mech9_resting_motors, only: couple_motors
  use mech9_linearised_equilibrium, only: equilibrium_type
  implicit none
  private
  public :: linearise_motion

contains

  !> Linearise the equations of motion about a motion. Fails with exit_singular where closed chains or ball joints stand in a singular
  !> position for these coordinates, and where a load does.
  subroutine linearise_motion(mechanism, partition, q, motion, found, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< driven, free and dependent coordinates
    real(wp), intent(in) :: q(:)                        !< (M) closed position [rad, m]
    type(state_type), intent(in) :: motion              !< the motion in this position, on any plan
    type(equilibrium_type), intent(out) :: found        !< gets its matrices; without modes, and no position of rest
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), allocatable, dimension(:, :) :: m, c, per_unit
    real(wp) :: magnitude
    integer :: i, n

    associate (resting => found%resting)
      resting%partition = partition
      allocate (resting%plan, resting%state, resting%linearisation)
      call place_in_space(mechanism, partition, q, motion, resting%plan, resting%state, err)
      if (allocated(err)) return
      resting%free = pack(resting%plan%independent, partition%kind(resting%plan%independent) == free_coordinate)
      n = size(resting%free)
      allocate (resting%forces(n), resting%stiffness(n, n), source=0.0_wp)
      call new_linearisation(mechanism, resting%plan, resting%linearisation)
      call find_forces(mechanism, resting%plan, resting%state, resting%linearisation, err)
      if (.not. allocated(err)) call refuse_singular_chains(resting%plan, resting%state, resting%linearisation, err)
      if (.not. allocated(err)) call find_stiffness(mechanism, resting, err)
      if (allocated(err)) return
      resting%forces = resting%linearisation%forces(resting%free)*resting%plan%unit_of(resting%free)
      allocate (m(n, n), c(n, n), per_unit(n, n))
      call find_matrix(mechanism, resting%plan, resting%state, by_rate, resting%free, resting%linearisation, c, magnitude, err)
      if (allocated(err)) return
      call find_matrix(mechanism, resting%plan, resting%state, by_acceleration, resting%free, resting%linearisation, m, magnitude, &
                       err)
      if (.not. allocated(err)) call refuse_lock(resting%free, resting%state%t, m, err)
      if (.not. allocated(err) .and. size(mechanism%motors) > 0) call couple_motors(mechanism, resting, found%motors, err)
      if (allocated(err)) return
      do i = 1, n
        per_unit(:, i) = 1.0_wp/(resting%plan%unit_of(resting%free)*resting%plan%unit_of(resting%free(i)))
      end do
      found%inertia = per_unit*0.5_wp*(m + transpose(m))
      found%damping = per_unit*c
      found%stiffness = per_unit*resting%stiffness
    end associate
  end subroutine linearise_motion

  !> Fail where a coordinate has no inertia beside the others: a ball joint is in gimbal lock.
  pure subroutine refuse_lock(free, t, m, err)
    integer, intent(in) :: free(:)                      !< (n) numbers of the free coordinates
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: m(:, :)                     !< (n,n) their inertia [J s^2]
    type(error_type), allocatable, intent(out) :: err   !< the failure
    real(wp) :: factors(size(m, 1), size(m, 1))
    integer :: failed_at

    factors = m
    call cholesky_factorize(size(m, 1), factors, failed_at)
    if (failed_at == 0) return
    call raise(err, exit_singular, failure_gimbal_lock)
    err%failure%coordinates = [free(failed_at)]
    err%failure%t = t
  end subroutine refuse_lock
end module mech9_linearised_motion
