!> A law with the function q = mean + amplitude sin(angular_frequency t + phase).
module mech9_harmonic_law
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_law, only: law_type
  implicit none
  private
  public :: harmonic_law_type

  !> A harmonic law by its four numbers.
  type, extends(law_type) :: harmonic_law_type
    real(wp) :: mean = 0.0_wp                !< [rad or m]
    real(wp) :: amplitude = 0.0_wp           !< [rad or m]
    real(wp) :: angular_frequency = 0.0_wp   !< [rad/s]
    real(wp) :: phase = 0.0_wp               !< [rad]
  contains
    procedure :: evaluate
    procedure :: greatest_rate
    procedure :: constants
    procedure :: vary
  end type harmonic_law_type

contains

  !> The harmonic and its derivatives; it has values at all times.
  subroutine evaluate(self, t, q, dq, ddq, err)
    class(harmonic_law_type), intent(in) :: self      !< the harmonic law
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(out) :: q                          !< the coordinate [rad, m]
    real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: angle, swing

    angle = self%angular_frequency*t + self%phase
    swing = self%amplitude*sin(angle)
    q = self%mean + swing
    dq = self%amplitude*self%angular_frequency*cos(angle)
    ddq = -self%angular_frequency**2*swing
  end subroutine evaluate

  !> The greatest rate of the whole period.
  function greatest_rate(self, t, h) result(rate)
    class(harmonic_law_type), intent(in) :: self   !< the harmonic law
    real(wp), intent(in) :: t                        !< beginning of the interval [s]; unused
    real(wp), intent(in) :: h                        !< length of the interval [s]; unused
    real(wp) :: rate

    rate = abs(self%amplitude*self%angular_frequency)
  end function greatest_rate

  !> The four numbers of the law.
  pure subroutine constants(self, values)
    class(harmonic_law_type), intent(in) :: self     !< the harmonic law
    real(wp), allocatable, intent(out) :: values(:)  !< mean, amplitude, angular frequency and phase

    values = [self%mean, self%amplitude, self%angular_frequency, self%phase]
  end subroutine constants

  !> The derivatives by one parameter, from those of the four numbers.
  subroutine vary(self, change, t, q, dq, ddq)
    class(harmonic_law_type), intent(in) :: self   !< the harmonic law
    real(wp), intent(in) :: change(:)              !< derivatives of the four numbers
    real(wp), intent(in) :: t                      !< time [s]
    real(wp), intent(out) :: q                     !< derivative of the coordinate [rad, m]
    real(wp), intent(out) :: dq                    !< derivative of its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                   !< derivative of its acceleration [rad/s^2, m/s^2]
    real(wp) :: c, s, turned

    associate (amplitude => self%amplitude, frequency => self%angular_frequency)
      s = sin(frequency*t + self%phase)
      c = cos(frequency*t + self%phase)
      turned = change(3)*t + change(4)
      q = change(1) + change(2)*s + amplitude*turned*c
      dq = (change(2)*frequency + amplitude*change(3))*c - amplitude*frequency*turned*s
      ddq = -(change(2)*frequency + 2.0_wp*amplitude*change(3))*frequency*s - amplitude*frequency**2*turned*c
    end associate
  end subroutine vary
end module mech9_harmonic_law
