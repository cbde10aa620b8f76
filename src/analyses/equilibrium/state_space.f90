!> The linearised equations of motion in the form x' = A x + B u, y = C x + D u.
!>
!> The state x holds the deviations of the free coordinates from equilibrium, then their rates, then the deviations of the motors'
!> states. Inputs u are additional generalized forces on the free coordinates, then additional voltages of motors;
!> outputs y are deviations of coordinates, points, and their derivatives in time.
module mech9_state_space
  use mech9_kinds, only: wp
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_rotation, only: turn, cross
  use mech9_pose, only: transformed
  use mech9_mechanism, only: mechanism_type
  use mech9_motion_variation, only: vary_motion
  use mech9_resting_mechanism, only: move_along
  use mech9_resting_motors, only: motor_coupling_type
  use mech9_linearised_equilibrium, only: equilibrium_type
  implicit none
  private
  public :: state_space_type, find_state_space

  !> The matrices, in SI units with the angles of the data file.
  type :: state_space_type
    real(wp), allocatable :: a(:, :)   !< (m,m) [1/s], in the units of the states; m = 2n and the states of motors
    real(wp), allocatable :: b(:, :)   !< (m,inputs) states per N m, N or V
    real(wp), allocatable :: c(:, :)   !< (outputs,m) outputs per state
    real(wp), allocatable :: d(:, :)   !< (outputs,inputs) outputs per N m, N or V
  end type state_space_type

contains

  !> Find the matrices. Outputs are q, dq and ddq of the recorded coordinates, then position, velocity and acceleration of each
  !> point, up to the highest recorded derivative.
  subroutine find_state_space(mechanism, recorded, derivatives, equilibrium, space)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    integer, intent(in) :: recorded(:)                     !< numbers of the recorded coordinates
    integer, intent(in) :: derivatives                     !< highest derivative that is recorded, 0 to 2
    type(equilibrium_type), intent(inout) :: equilibrium   !< linearised; its last variation changes
    type(state_space_type), intent(out) :: space           !< the matrices
    real(wp), allocatable, dimension(:, :) :: by_position, by_rate, by_acceleration, accelerate
    real(wp) :: unit
    integer :: n, m, states, voltages, outputs, i

    n = size(equilibrium%resting%free)
    outputs = (derivatives + 1)*(size(recorded) + 3*size(mechanism%points))
    states = 0
    voltages = 0
    if (size(mechanism%motors) > 0) then
      states = size(equilibrium%motors%states)
      voltages = size(equilibrium%motors%inputs)
    end if
    allocate (by_position(outputs, n), by_rate(outputs, n), by_acceleration(outputs, n))
    do i = 1, n
      call outputs_of(mechanism, recorded, derivatives, equilibrium, i, 0, by_position(:, i))
      call outputs_of(mechanism, recorded, derivatives, equilibrium, i, 1, by_rate(:, i))
      call outputs_of(mechanism, recorded, derivatives, equilibrium, i, 2, by_acceleration(:, i))
    end do
    m = 2*n + states
    allocate (accelerate(n, m + n + voltages))
    call find_accelerations(equilibrium, states, voltages, accelerate)
    allocate (space%a(m, m), space%b(m, n + voltages), space%c(outputs, m), space%d(outputs, n + voltages), source=0.0_wp)
    do i = 1, n
      space%a(i, n + i) = 1.0_wp
    end do
    space%a(n + 1:2*n, :) = accelerate(:, :m)
    space%b(n + 1:2*n, :) = accelerate(:, m + 1:)
    if (states > 0) call set_motors(equilibrium%motors, n, space)
    space%c(:, :n) = by_position
    space%c(:, n + 1:2*n) = by_rate
    space%c = space%c + matmul(by_acceleration, accelerate(:, :m))
    space%d = matmul(by_acceleration, accelerate(:, m + 1:))
    do i = 1, n
      unit = unit_of_state(mechanism, equilibrium%resting%free(i))
      space%c(:, i) = space%c(:, i)*unit
      space%c(:, n + i) = space%c(:, n + i)*unit
      space%a(:, i) = space%a(:, i)*unit
      space%a(:, n + i) = space%a(:, n + i)*unit
      space%a(i, :) = space%a(i, :)/unit
      space%a(n + i, :) = space%a(n + i, :)/unit
      space%b(n + i, :) = space%b(n + i, :)/unit
    end do
  end subroutine find_state_space

  !> Set the rates of the motors' states.
  pure subroutine set_motors(motors, n, space)
    type(motor_coupling_type), intent(in) :: motors   !< with states
    integer, intent(in) :: n                          !< number of free coordinates
    type(state_space_type), intent(inout) :: space    !< gets its last rows
    integer :: i

    space%a(2*n + 1:, :n) = motors%rate_by_q
    space%a(2*n + 1:, n + 1:2*n) = motors%rate_by_dq
    do i = 1, size(motors%states)
      space%a(2*n + i, 2*n + i) = motors%rate_by_state(i)
    end do
    space%b(2*n + 1:, n + 1:) = motors%rate_by_input
  end subroutine set_motors

  !> Accelerations of the free coordinates per position, rate, state of a motor, force and voltage: M^-1 (-K, -C, G, 1, F).
  subroutine find_accelerations(equilibrium, states, voltages, accelerate)
    type(equilibrium_type), intent(in) :: equilibrium   !< linearised
    integer, intent(in) :: states                       !< number of states of motors
    integer, intent(in) :: voltages                     !< number of voltages
    real(wp), intent(out) :: accelerate(:, :)           !< (n,3n+states+voltages) in SI units
    real(wp) :: factors(size(accelerate, 1), size(accelerate, 1))
    integer :: n, m, i, failed_at

    n = size(accelerate, 1)
    m = 2*n + states
    accelerate(:, :n) = -equilibrium%stiffness
    accelerate(:, n + 1:2*n) = -equilibrium%damping
    if (states > 0) accelerate(:, 2*n + 1:m) = equilibrium%motors%force_by_state
    accelerate(:, m + 1:m + n) = 0.0_wp
    do i = 1, n
      accelerate(i, m + i) = 1.0_wp
    end do
    if (voltages > 0) accelerate(:, m + n + 1:) = equilibrium%motors%force_by_input
    factors = equilibrium%inertia
    call cholesky_factorize(n, factors, failed_at)
    do i = 1, size(accelerate, 2)
      call cholesky_solve(n, factors, accelerate(:, i))
    end do
  end subroutine find_accelerations

  !> Derivatives of the outputs by one free coordinate, its rate or its acceleration, in the units of the matrices per SI unit.
  subroutine outputs_of(mechanism, recorded, derivatives, equilibrium, i, order, outputs)
    type(mechanism_type), intent(in) :: mechanism          !< the mechanism
    integer, intent(in) :: recorded(:)                     !< numbers of the recorded coordinates
    integer, intent(in) :: derivatives                     !< highest derivative that is recorded
    type(equilibrium_type), intent(inout) :: equilibrium   !< its last variation changes
    integer, intent(in) :: i                               !< number of the free coordinate among them
    integer, intent(in) :: order                           !< of the derivative in time that is the parameter
    real(wp), intent(out) :: outputs(:)                    !< in their order
    real(wp) :: changes(3, 0:2), three(size(recorded), 0:2)
    integer :: k, used, d

    associate (resting => equilibrium%resting, variation => equilibrium%resting%linearisation%variation)
      call variation%clear()
      select case (order)
      case (0)
        call move_along(resting, i, variation%q)
      case (1)
        call move_along(resting, i, variation%dq)
      case default
        call move_along(resting, i, variation%ddq)
      end select
      call vary_motion(resting%plan, resting%state, resting%linearisation%motion, variation)
      three(:, 0) = variation%q(recorded)
      three(:, 1) = variation%dq(recorded)
      three(:, 2) = variation%ddq(recorded)
    end associate
    do k = 1, size(recorded)
      three(k, :) = three(k, :)/unit_of_state(mechanism, recorded(k))
    end do
    used = (derivatives + 1)*size(recorded)
    outputs(:used) = reshape(three(:, :derivatives), [used])
    do k = 1, size(mechanism%points)
      call vary_point(equilibrium, mechanism%points(k)%link, mechanism%points(k)%position, changes)
      do d = 0, derivatives
        outputs(used + 1:used + 3) = changes(:, d)
        used = used + 3
      end do
    end do
  end subroutine outputs_of

  !> One unit of a coordinate in the matrices: that of angles, or 1 m.
  pure real(wp) function unit_of_state(mechanism, k) result(unit)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the coordinate

    unit = 1.0_wp
    if (mechanism%pairs(k)%pair%angular) unit = mechanism%units%angle
  end function unit_of_state

  !> Derivatives of position, velocity and acceleration of a point of a link.
  pure subroutine vary_point(equilibrium, link, place, changes)
    type(equilibrium_type), intent(in) :: equilibrium   !< with the variation
    integer, intent(in) :: link                         !< number of the link
    real(wp), intent(in) :: place(3)                    !< of the point, in the link's own system [m]
    real(wp), intent(out) :: changes(3, 0:2)            !< [m, m/s, m/s^2]
    real(wp) :: arm(3), arm_change(3), slip(3), slip_change(3)
    integer :: f

    associate (plan => equilibrium%resting%plan, state => equilibrium%resting%state, &
               variation => equilibrium%resting%linearisation%variation)
      f = plan%frame_of(link)
      arm = turn(state%r(:, :, f), transformed(plan%link_in_frame(link), place))
      arm_change = cross(variation%turn(:, f), arm)
      slip = cross(state%omega(:, f), arm)
      slip_change = cross(variation%omega(:, f), arm) + cross(state%omega(:, f), arm_change)
      changes(:, 0) = variation%shift(:, f) + arm_change
      changes(:, 1) = variation%v(:, f) + slip_change
      changes(:, 2) = variation%a(:, f) + cross(variation%alpha(:, f), arm) + cross(state%alpha(:, f), arm_change) &
                      + cross(variation%omega(:, f), slip) + cross(state%omega(:, f), slip_change)
    end associate
  end subroutine vary_point
end module mech9_state_space
