!> What rates and accelerations are expected to be, by continuation from the positions before.
module mech9_expectation
  use mech9_kinds, only: wp
  implicit none
  private
  public :: expectation_type

  !> What was found at one time.
  type :: past_type
    logical :: known = .false.
    real(wp) :: t = 0.0_wp
    real(wp), allocatable :: b(:)      !< dependent rates per independent ones, as in the Jacobian
    real(wp), allocatable :: ddq(:)    !< (M) accelerations that rates alone give
  end type past_type

  !> The last two times, the later one first.
  type :: expectation_type
    private
    type(past_type) :: past(2)
  contains
    procedure :: remember
    procedure :: continue_to
  end type expectation_type

contains

  !> Keep what was found at time t.
  pure subroutine remember(self, t, b, ddq)
    class(expectation_type), intent(inout) :: self   !< the expectation
    real(wp), intent(in) :: t                  !< [s]
    real(wp), intent(in) :: b(:), ddq(:)

    if (self%past(1)%known) then
      ! no straight line through two states at one time
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

  !> What is expected at time t, by a straight line through what is kept. Left as it is where nothing is.
  pure subroutine continue_to(self, t, b, ddq)
    class(expectation_type), intent(in) :: self   !< the expectation
    real(wp), intent(in) :: t                  !< [s]
    real(wp), intent(inout) :: b(:), ddq(:)
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
