!> Extrapolation of rates and of the accelerations that rates alone give, from the last two evaluations.
module mech9_expectation
  use mech9_kinds, only: wp
  implicit none
  private
  public :: expectation_type

  !> The results of one evaluation.
  type :: past_type
    logical :: known = .false.         !< there are results
    real(wp) :: t = 0.0_wp             !< their time [s]
    real(wp), allocatable :: b(:)      !< (entries) dependent rates per unit rate of independent coordinates, as in the Jacobian
    real(wp), allocatable :: ddq(:)    !< (M) accelerations that rates alone give [rad/s^2, m/s^2]
  end type past_type

  !> The results at the last two times, the later one first.
  type :: expectation_type
    private
    type(past_type) :: past(2)   !< the later results, the earlier ones
  contains
    procedure :: remember
    procedure :: continue_to
  end type expectation_type

contains

  !> Keep the results of an evaluation at time t.
  pure subroutine remember(self, t, b, ddq)
    class(expectation_type), intent(inout) :: self   !< the expectation
    real(wp), intent(in) :: t                        !< time [s]
    real(wp), intent(in) :: b(:)                     !< (entries) dependent rates per unit rate of independent coordinates
    real(wp), intent(in) :: ddq(:)                   !< (M) accelerations that rates alone give [rad/s^2, m/s^2]

    if (self%past(1)%known) then
      ! two results at one time determine no straight line
      if (.not. abs(t - self%past(1)%t) > 0.0_wp) return
      self%past(2)%known = .true.
      self%past(2)%t = self%past(1)%t
      self%past(2)%b = self%past(1)%b
      self%past(2)%ddq = self%past(1)%ddq
    end if
    self%past(1)%known = .true.
    self%past(1)%t = t
    self%past(1)%b = b
    self%past(1)%ddq = ddq
  end subroutine remember

  !> Expected values at time t, on a straight line through the kept results; with nothing kept, they do not change.
  pure subroutine continue_to(self, t, b, ddq)
    class(expectation_type), intent(in) :: self   !< the expectation
    real(wp), intent(in) :: t                     !< time [s]
    real(wp), intent(inout) :: b(:)               !< (entries) dependent rates per unit rate of independent coordinates
    real(wp), intent(inout) :: ddq(:)             !< (M) accelerations that rates alone give [rad/s^2, m/s^2]
    real(wp) :: part

    if (.not. self%past(1)%known) return
    if (self%past(2)%known) then
      part = (t - self%past(1)%t)/(self%past(1)%t - self%past(2)%t)
      b = self%past(1)%b + part*(self%past(1)%b - self%past(2)%b)
      ddq = self%past(1)%ddq + part*(self%past(1)%ddq - self%past(2)%ddq)
    else
      b = self%past(1)%b
      ddq = self%past(1)%ddq
    end if
  end subroutine continue_to
end module mech9_expectation
