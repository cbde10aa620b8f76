!> A law with the function q = mean + amplitude sin(angular_frequency t + phase).
module mech9_harmonic_law
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_law, only: law_type, repetition_type, stands_still, repeats_after
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
    procedure :: repetition
    procedure :: constants
    procedure :: vary
    procedure :: antiderivatives
    procedure :: vary_antiderivatives
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

  !> How the harmonic repeats: after one turn of its angle.
  pure type(repetition_type) function repetition(self) result(found)
    class(harmonic_law_type), intent(in) :: self     !< the harmonic law
    real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)

    found%kind = stands_still
    if (.not. abs(self%amplitude*self%angular_frequency) > 0.0_wp) return
    found%kind = repeats_after
    found%period = turn/abs(self%angular_frequency)
  end function repetition

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

  !> The law, its integral from 0, and the integral of this one.
  pure subroutine antiderivatives(self, x, value, first, second)
    class(harmonic_law_type), intent(in) :: self   !< the harmonic law
    real(wp), intent(in) :: x                      !< its variable [s, or its unit]
    real(wp), intent(out) :: value                 !< the law
    real(wp), intent(out) :: first                 !< its integral
    real(wp), intent(out) :: second                !< the integral of the integral
    real(wp) :: p(0:4), r(0:4)

    call find_parts(self%angular_frequency*x, p, r)
    associate (s => sin(self%phase), c => cos(self%phase))
      value = self%mean + self%amplitude*(s*p(0) + c*r(0))
      first = self%mean*x + self%amplitude*x*(s*p(1) + c*r(1))
      second = 0.5_wp*self%mean*x**2 + self%amplitude*x**2*(s*p(2) + c*r(2))
    end associate
  end subroutine antiderivatives

  !> The derivatives of both integrals by one parameter, from those of the four numbers.
  pure subroutine vary_antiderivatives(self, change, x, first, second)
    class(harmonic_law_type), intent(in) :: self   !< the harmonic law
    real(wp), intent(in) :: change(:)              !< derivatives of the four numbers
    real(wp), intent(in) :: x                      !< its variable [s, or its unit]
    real(wp), intent(out) :: first                 !< derivative of the integral
    real(wp), intent(out) :: second                !< derivative of the integral of the integral
    real(wp) :: p(0:4), r(0:4), by_angle(2), s, c

    call find_parts(self%angular_frequency*x, p, r)
    s = sin(self%phase)
    c = cos(self%phase)
    ! of s p(k) + c r(k) by the angle: the derivatives of p(k) and r(k) are k r(k+1) - r(k) and p(k) - k p(k+1)
    by_angle(1) = -s*(r(1) - r(2)) + c*(p(1) - p(2))
    by_angle(2) = -s*(r(2) - 2.0_wp*r(3)) + c*(p(2) - 2.0_wp*p(3))
    first = change(1)*x + change(2)*x*(s*p(1) + c*r(1)) &
            + self%amplitude*x*(change(4)*(c*p(1) - s*r(1)) + change(3)*x*by_angle(1))
    second = 0.5_wp*change(1)*x**2 + change(2)*x**2*(s*p(2) + c*r(2)) &
             + self%amplitude*x**2*(change(4)*(c*p(2) - s*r(2)) + change(3)*x*by_angle(2))
  end subroutine vary_antiderivatives

  !> The k-fold integrals of the cosine and of the sine from 0 to an angle z, each divided by z^k: p(k) and r(k). Their series serve
  !> for small angles.
  pure subroutine find_parts(z, p, r)
    real(wp), intent(in) :: z               !< the angle [rad]
    real(wp), intent(out) :: p(0:4)         !< of the cosine
    real(wp), intent(out) :: r(0:4)         !< of the sine
    real(wp) :: term
    integer :: i, k

    p(0) = cos(z)
    r(0) = sin(z)
    if (abs(z) > 1.0_wp) then
      ! p(k) = r(k-1)/z, r(k) = (1/(k-1)! - p(k-1))/z
      term = 1.0_wp
      do k = 1, 4
        p(k) = r(k - 1)/z
        r(k) = (term - p(k - 1))/z
        term = term/k
      end do
      return
    end if
    do k = 1, 4
      p(k) = 0.0_wp
      r(k) = 0.0_wp
      do i = 11, 0, -1
        ! terms (-1)^i z^(2i)/(2i + k)! and (-1)^i z^(2i + 1)/(2i + 1 + k)!
        p(k) = p(k) + (-1)**i*z**(2*i)/gamma(real(2*i + k + 1, wp))
        r(k) = r(k) + (-1)**i*z**(2*i + 1)/gamma(real(2*i + k + 2, wp))
      end do
    end do
  end subroutine find_parts
end module mech9_harmonic_law
