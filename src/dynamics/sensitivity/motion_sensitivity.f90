!> Derivatives of a free motion by parameters: the accelerations that they have in the variational equations.
!>
!> With the forces f that a motion requires beyond its loads, f(q, dq, ddq, p) = 0 in the independent coordinates. The derivatives s
!> of the free coordinates by a parameter satisfy a s'' = -(df at s'' = 0), where a holds the coefficients of motion, and df is the
!> derivative of f along s, s' and the parameter itself.
module mech9_motion_sensitivity
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_integrator
  use mech9_force_gradient_failures, only: failure_lost_inertia
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_known_derivatives, only: check_known
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_varied_motion, only: varied_motion_type, new_varied_motion, find_varied_motion, find_varied_points
  use mech9_motor, only: motor_change_type
  use mech9_varied_motors, only: find_varied_motors
  use mech9_force_gradient, only: force_gradient_type, new_force_gradient, needs_motions, find_force_gradient
  implicit none
  private
  public :: motion_sensitivity_type, new_motion_sensitivity

  !> The derivatives of the free coordinates by all parameters, and what finds those of the whole motion.
  type :: motion_sensitivity_type
    type(varied_motion_type) :: motion             !< of all coordinates and frames
    type(force_gradient_type) :: gradient          !< derivatives of the forces that the motion requires
    real(wp), allocatable :: values(:, :, :)       !< (P,free,0:2) of free coordinates and their derivatives in time [rad, m]
    real(wp), allocatable :: motors(:, :, :)       !< (P,motors,0:1) of the motors' states and their derivatives in time
    real(wp), allocatable :: size_of(:)            !< (P) size that the derivatives by a parameter have at least, for tolerances
  contains
    procedure :: start
    procedure :: pack
    procedure :: pack_rates
    procedure :: unpack
    procedure :: find_accelerations
    procedure :: complete
  end type motion_sensitivity_type

contains

  !> Prepare the derivatives of a motion. Fails where the model does not exist beside the present values, and where a parameter sets
  !> numbers whose derivatives are not known.
  subroutine new_motion_sensitivity(variable, model, plan, dynamics, self, err)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    type(plan_type), intent(in) :: plan                     !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics        !< its plan of dynamics
    type(motion_sensitivity_type), intent(out) :: self      !< prepared; the derivatives are zero
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    integer :: p

    call new_varied_motion(variable, model, plan, self%motion, err)
    if (.not. allocated(err)) call check_known(model, self%motion%tangents, err)
    if (allocated(err)) return
    call new_force_gradient(model, plan, dynamics, self%motion%tangents, self%gradient)
    associate (n => self%motion%n_parameters)
      allocate (self%values(n, size(plan%free), 0:2), self%motors(n, size(model%mechanism%motors), 0:1), source=0.0_wp)
      allocate (self%size_of(n))
      do p = 1, n
        self%size_of(p) = self%motion%tangents(p)%size
        if (.not. self%size_of(p) > 0.0_wp) self%size_of(p) = 1.0_wp
      end do
    end associate
  end subroutine new_motion_sensitivity

  !> Begin with the derivatives that the start of the motion has.
  pure subroutine start(self)
    class(motion_sensitivity_type), intent(inout) :: self   !< gets the derivatives of the free coordinates and of their rates
    integer :: p

    do p = 1, self%motion%n_parameters
      self%values(p, :, 0:1) = self%motion%tangents(p)%start(self%motion%plan%free, :)
    end do
  end subroutine start

  !> Write the derivatives of free coordinates, those of their rates, and those of the motors' states into a vector.
  pure subroutine pack(self, y)
    class(motion_sensitivity_type), intent(in) :: self   !< the derivatives
    real(wp), intent(inout), contiguous :: y(:)          !< the vector
    integer :: n, m

    n = size(self%values(:, :, 0))
    m = size(self%motors(:, :, 0))
    call copy(n, self%values(:, :, 0), y)
    call copy(n, self%values(:, :, 1), y(n + 1:))
    if (m > 0) call copy(m, self%motors(:, :, 0), y(2*n + 1:))
  end subroutine pack

  !> Write the rate of change of this vector.
  pure subroutine pack_rates(self, ydot)
    class(motion_sensitivity_type), intent(in) :: self      !< the derivatives
    real(wp), intent(inout), contiguous :: ydot(:)          !< the rate of change
    integer :: n, m

    n = size(self%values(:, :, 0))
    m = size(self%motors(:, :, 0))
    call copy(n, self%values(:, :, 1), ydot)
    call copy(n, self%values(:, :, 2), ydot(n + 1:))
    if (m > 0) call copy(m, self%motors(:, :, 1), ydot(2*n + 1:))
  end subroutine pack_rates

  !> Take the derivatives from such a vector.
  pure subroutine unpack(self, y)
    class(motion_sensitivity_type), intent(inout) :: self   !< gets the derivatives
    real(wp), intent(in), contiguous :: y(:)                !< the vector
    integer :: n, m

    n = size(self%values(:, :, 0))
    m = size(self%motors(:, :, 0))
    call copy(n, y, self%values(:, :, 0))
    call copy(n, y(n + 1:), self%values(:, :, 1))
    if (m > 0) call copy(m, y(2*n + 1:), self%motors(:, :, 0))
  end subroutine unpack

  !> Copy numbers. The shapes are explicit, so that the loop needs no strides.
  pure subroutine copy(n, from, to)
    integer, intent(in) :: n            !< how many
    real(wp), intent(in) :: from(n)     !< the numbers
    real(wp), intent(inout) :: to(n)    !< gets them
    integer :: i

    do i = 1, n
      to(i) = from(i)
    end do
  end subroutine copy

  !> Find the derivatives of the free accelerations in the present motion, from those of free coordinates and rates. Fails where
  !> a free coordinate has no inertia, or a load fails.
  subroutine find_accelerations(self, model, state, work, err)
    class(motion_sensitivity_type), intent(inout) :: self   !< the derivatives
    type(model_type), intent(in) :: model                   !< the model
    type(state_type), intent(in) :: state                   !< the motion, with all accelerations
    type(lagrange_work_type), intent(inout) :: work         !< its evaluation, with the factors of the closed chains
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    integer :: failed_at

    if (needs_motions(self%gradient)) then
      self%values(:, :, 2) = 0.0_wp
      call give(self)
      call find_varied_motion(model, state, self%motion, err)
    else
      call give_to_motors(state, self)
    end if
    if (.not. allocated(err)) call find_motor_rates(model, self, err)
    if (allocated(err)) return
    call find_force_gradient(model, state, self%motion, work, self%gradient, err)
    if (allocated(err)) return
    associate (gradient => self%gradient, n => size(self%motion%plan%free), m => self%motion%n_parameters)
      call find_right_sides(m, n, gradient%by_parameters, gradient%by_position, gradient%by_rate, self%values)
      call divide(m, n, gradient%by_acceleration, self%values(:, :, 2), failed_at)
    end associate
    if (failed_at == 0) return
    call raise(err, exit_integrator, failure_lost_inertia)
    err%failure%coordinates = [self%motion%plan%free(failed_at)]
  end subroutine find_accelerations

  !> Find the derivatives of the rates of the motors' states, from those of coordinates, rates and states.
  subroutine find_motor_rates(model, self, err)
    type(model_type), intent(in) :: model                   !< the model
    class(motion_sensitivity_type), intent(inout) :: self   !< with the derivatives of the motion; gets those of the rates
    type(error_type), allocatable, intent(out) :: err       !< allocated if the law of a motor has no value
    type(motor_change_type) :: changes(size(self%motors, 1), size(self%motors, 2))

    if (size(changes) == 0) return
    call find_varied_motors(model, self%motion, changes, err)
    self%motors(:, :, 1) = changes%rate
  end subroutine find_motor_rates

  !> The right-hand sides of the variational equations: what the derivatives require without their accelerations, with a minus sign.
  pure subroutine find_right_sides(m, n, by_parameters, by_position, by_rate, values)
    integer, intent(in) :: m                           !< number of parameters
    integer, intent(in) :: n                           !< number of free coordinates
    real(wp), intent(in) :: by_parameters(m, n)        !< of each force, by each parameter
    real(wp), intent(in) :: by_position(n, n)          !< of each force, by each coordinate
    real(wp), intent(in) :: by_rate(n, n)              !< of each force, by each rate
    real(wp), intent(inout) :: values(m, n, 0:2)       !< derivatives; those of order 2 become the right-hand sides
    integer :: i, j, p

    do i = 1, n
      do p = 1, m
        values(p, i, 2) = -by_parameters(p, i)
      end do
      do j = 1, n
        do p = 1, m
          values(p, i, 2) = values(p, i, 2) - by_position(i, j)*values(p, j, 0) - by_rate(i, j)*values(p, j, 1)
        end do
      end do
    end do
  end subroutine find_right_sides

  !> Divide by the coefficients of motion.
  pure subroutine divide(m, n, coefficients, values, failed_at)
    integer, intent(in) :: m                       !< number of parameters
    integer, intent(in) :: n                       !< number of free coordinates
    real(wp), intent(in) :: coefficients(n, n)     !< the coefficients
    real(wp), intent(inout) :: values(m, n)        !< right-hand sides by rows; then the solutions
    integer, intent(out) :: failed_at              !< place of a coordinate without inertia; 0: none
    real(wp) :: factors(n, n), right(n)
    integer :: p

    failed_at = 0
    if (n == 0) return
    if (n == 1 .and. all(coefficients > 0.0_wp)) then
      do p = 1, m
        values(p, 1) = values(p, 1)/coefficients(1, 1)
      end do
      return
    end if
    factors = coefficients
    call cholesky_factorize(n, factors, failed_at)
    if (failed_at > 0) return
    do p = 1, m
      right = values(p, :)
      call cholesky_solve(n, factors, right)
      values(p, :) = right
    end do
  end subroutine divide

  !> Find the derivatives of all coordinates, frames and points, after find_accelerations.
  subroutine complete(self, model, state, err)
    class(motion_sensitivity_type), intent(inout) :: self   !< the derivatives
    type(model_type), intent(in) :: model                   !< the model
    type(state_type), intent(in) :: state                   !< the motion, with all accelerations
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed

    call give(self)
    call find_varied_motion(model, state, self%motion, err)
    if (.not. allocated(err)) call find_varied_points(model, self%motion)
  end subroutine complete

  !> Give the present motion, and the derivatives of the free coordinates and of their rates, to motors, which all act on such coordinates.
  pure subroutine give_to_motors(state, self)
    type(state_type), intent(in) :: state                   !< the motion
    class(motion_sensitivity_type), intent(inout) :: self   !< the derivatives
    integer :: i

    if (size(self%motors, 2) == 0) return
    self%motion%state%t = state%t
    self%motion%state%q = state%q
    self%motion%state%dq = state%dq
    self%motion%state%ddq = state%ddq
    self%motion%state%motor = state%motor
    self%motion%state%limited = state%limited
    do i = 1, size(self%motion%plan%free)
      self%motion%q(:, 0:1, self%motion%plan%free(i)) = self%values(:, i, 0:1)
    end do
    self%motion%motor = self%motors(:, :, 0)
  end subroutine give_to_motors

  !> Give the derivatives of the free coordinates to those of the whole motion.
  pure subroutine give(self)
    class(motion_sensitivity_type), intent(inout) :: self   !< the derivatives
    integer :: order

    do order = 0, 2
      self%motion%given(:, order, :) = self%values(:, :, order)
    end do
    self%motion%motor = self%motors(:, :, 0)
  end subroutine give
end module mech9_motion_sensitivity
