!> Derivatives of a free motion by parameters: the accelerations that they have in the variational equations.
!>
!> With the forces f that a motion requires beyond its loads, f(q, dq, ddq, p) = 0 in the independent coordinates. The derivatives s
!> of the free coordinates by a parameter satisfy a s'' = -(df at s'' = 0), where a holds the coefficients of motion, and df is the
!> derivative of f along s, s' and the parameter itself.
module mech9_motion_sensitivity
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_known_derivatives, only: check_known
  use mech9_varied_motion, only: varied_motion_type, new_varied_motion, find_varied_motion, find_varied_points
  use mech9_motor, only: motor_change_type
  use mech9_varied_motors, only: find_varied_motors
  use mech9_varied_forces, only: varied_forces_type, new_varied_forces, find_varied_forces
  implicit none
  private
  public :: motion_sensitivity_type, new_motion_sensitivity

  !> The derivatives of the free coordinates by all parameters, and what finds those of the whole motion.
  type :: motion_sensitivity_type
    type(varied_motion_type) :: motion             !< of all coordinates and frames
    type(varied_forces_type) :: forces             !< required by the motion
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
  subroutine new_motion_sensitivity(variable, model, plan, self, err)
    class(variable_model_type), intent(inout) :: variable   !< the model as a function of its parameters
    type(model_type), intent(in) :: model                   !< the present model
    type(plan_type), intent(in) :: plan                     !< its plan
    type(motion_sensitivity_type), intent(out) :: self      !< prepared; the derivatives are zero
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    integer :: p

    call new_varied_motion(variable, model, plan, self%motion, err)
    if (.not. allocated(err)) call check_known(model, self%motion%tangents, .true., err)
    if (allocated(err)) return
    call new_varied_forces(model, self%motion, self%forces)
    associate (n => self%motion%n_parameters)
      allocate (self%values(n, size(plan%free), 0:2), self%motors(n, model%mechanism%n_motors, 0:1), source=0.0_wp)
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
    real(wp), intent(inout) :: y(:)                      !< the vector
    integer :: n, m

    n = size(self%values(:, :, 0))
    m = size(self%motors(:, :, 0))
    y(:n) = reshape(self%values(:, :, 0), [n])
    y(n + 1:2*n) = reshape(self%values(:, :, 1), [n])
    y(2*n + 1:) = reshape(self%motors(:, :, 0), [m])
  end subroutine pack

  !> Write the rate of change of this vector.
  pure subroutine pack_rates(self, ydot)
    class(motion_sensitivity_type), intent(in) :: self   !< the derivatives
    real(wp), intent(inout) :: ydot(:)                   !< the rate of change
    integer :: n, m

    n = size(self%values(:, :, 0))
    m = size(self%motors(:, :, 0))
    ydot(:n) = reshape(self%values(:, :, 1), [n])
    ydot(n + 1:2*n) = reshape(self%values(:, :, 2), [n])
    ydot(2*n + 1:) = reshape(self%motors(:, :, 1), [m])
  end subroutine pack_rates

  !> Take the derivatives from such a vector.
  pure subroutine unpack(self, y)
    class(motion_sensitivity_type), intent(inout) :: self   !< gets the derivatives
    real(wp), intent(in) :: y(:)                            !< the vector
    integer :: n

    n = size(self%values(:, :, 0))
    self%values(:, :, 0) = reshape(y(:n), shape(self%values(:, :, 0)))
    self%values(:, :, 1) = reshape(y(n + 1:2*n), shape(self%values(:, :, 1)))
    self%motors(:, :, 0) = reshape(y(2*n + 1:), shape(self%motors(:, :, 0)))
  end subroutine unpack

  !> Find the derivatives of the free accelerations in the present motion, from those of free coordinates and rates. Fails where
  !> closed chains are singular, a change of a parameter opens one, or a load fails.
  subroutine find_accelerations(self, model, state, coefficients, err)
    class(motion_sensitivity_type), intent(inout) :: self   !< the derivatives
    type(model_type), intent(in) :: model                   !< the model
    type(state_type), intent(in) :: state                   !< the motion, with all accelerations
    real(wp), intent(in) :: coefficients(:, :)              !< a_pr of the free coordinates, lower triangle
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp), dimension(size(coefficients, 1), size(coefficients, 1)) :: factors
    real(wp) :: right(size(coefficients, 1))
    integer :: p, failed_at

    self%values(:, :, 2) = 0.0_wp
    call give(self)
    call find_varied_motion(model, state, self%motion, err)
    if (.not. allocated(err)) call find_varied_forces(model, self%motion, self%forces, err)
    if (.not. allocated(err)) call find_motor_rates(model, self, err)
    if (allocated(err)) return
    factors = coefficients
    ! the motion itself was found with these coefficients
    call cholesky_factorize(size(right), factors, failed_at)
    do p = 1, self%motion%n_parameters
      right = -self%forces%changes(p, self%motion%plan%free)
      call cholesky_solve(size(right), factors, right)
      self%values(p, :, 2) = right
    end do
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
