!> The vector that is integrated: all coordinates, after them the rates of the free ones, then the states of the motors; perhaps
!> followed by the derivatives of free coordinates by parameters and those of their rates (mech9_motion_system).
!>
!> Driven coordinates are in the vector, too, but they are not taken from it: their drives give them.
module mech9_integrated_vector
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: length_of_vector, coordinate_of, pack_state, pack_rates, unpack_state

contains

  !> The length of the vector.
  pure integer function length_of_vector(plan, n_motors)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: n_motors       !< how many motors there are

    length_of_vector = plan%n_coordinates + size(plan%free) + n_motors
  end function length_of_vector

  !> The coordinate that a number of the vector belongs to, by itself or by its rate; minus the number of the motor to which it
  !> belongs otherwise.
  pure integer function coordinate_of(plan, place)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: place          !< of the number in the vector

    coordinate_of = place
    if (place <= plan%n_coordinates) return
    if (place <= plan%n_coordinates + size(plan%free)) then
      coordinate_of = plan%free(place - plan%n_coordinates)
    else
      coordinate_of = plan%n_coordinates + size(plan%free) - place
    end if
  end function coordinate_of

  !> The vector of a state.
  pure subroutine pack_state(plan, state, y)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< coordinates, rates of the free ones, and states of the motors
    real(wp), intent(inout) :: y(:)         !< the vector
    integer :: i, m

    m = plan%n_coordinates
    do i = 1, m
      y(i) = state%q(i)
    end do
    do i = 1, size(plan%free)
      y(m + i) = state%dq(plan%free(i))
    end do
    if (allocated(state%motor)) y(m + size(plan%free) + 1:m + size(plan%free) + size(state%motor)) = state%motor
  end subroutine pack_state

  !> The derivative of the vector in time.
  pure subroutine pack_rates(plan, state, accelerations, ydot)
    type(plan_type), intent(in) :: plan          !< the plan of the mechanism
    type(state_type), intent(in) :: state        !< with the rates of all coordinates, and of the motors' states
    real(wp), intent(in) :: accelerations(:)     !< of the independent coordinates [rad/s^2, m/s^2]
    real(wp), intent(inout) :: ydot(:)           !< the derivative
    integer :: i, m

    m = plan%n_coordinates
    do i = 1, m
      ydot(i) = state%dq(i)
    end do
    do i = 1, size(plan%free)
      ydot(m + i) = accelerations(plan%free_places(i))
    end do
    if (allocated(state%motor)) ydot(m + size(plan%free) + 1:m + size(plan%free) + size(state%motor)) = state%motor_rate
  end subroutine pack_rates

  !> Put time, coordinates, free rates and motors of a vector into a state. The drives give the motion of driven coordinates
  !> afterwards.
  pure subroutine unpack_state(plan, t, y, state)
    type(plan_type), intent(in) :: plan        !< the plan of the mechanism
    real(wp), intent(in) :: t                  !< time [s]
    real(wp), intent(in) :: y(:)               !< the vector
    type(state_type), intent(inout) :: state   !< gets them
    integer :: i, m

    state%t = t
    m = plan%n_coordinates
    do i = 1, m
      state%q(i) = y(i)
    end do
    do i = 1, size(plan%free)
      state%dq(plan%free(i)) = y(m + i)
    end do
    if (allocated(state%motor)) state%motor = y(m + size(plan%free) + 1:m + size(plan%free) + size(state%motor))
  end subroutine unpack_state
end module mech9_integrated_vector
