!> Equations with known solutions, and some that go wrong, for tests of the integrator.
module mech9_integration_problems
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_ode_system, only: ode_system_type
  use mech9_integrator, only: integrator_type, integration_statistics_type, step_tolerance_type
  implicit none
  private
  public :: orbit_type, orbit_start, orbit_at, pendulum_type, pendulum_quarter_period, swing_type, push_type
  public :: stiff_type, fading_type, explosion_type, obstacle_type, power_type, rotation_type, integrate

  !> Kepler's orbit, of semi-major axis and gravitational parameter one: (x, y, x', y').
  type, extends(ode_system_type) :: orbit_type
  contains
    procedure :: rate => orbit_rate
  end type orbit_type

  !> The pendulum of unit length and gravity: (angle, rate).
  type, extends(ode_system_type) :: pendulum_type
  contains
    procedure :: rate => pendulum_rate
  end type pendulum_type

  !> A driven, damped pendulum, without a closed form: (angle, rate).
  type, extends(ode_system_type) :: swing_type
  contains
    procedure :: rate => swing_rate
  end type swing_type

  !> A mass pushed by cos(20 t): (place, rate), from rest (1 - cos(20 t))/400 and sin(20 t)/20.
  type, extends(ode_system_type) :: push_type
  contains
    procedure :: rate => push_rate
  end type push_type

  !> y' = -stiffness (y - cos t) - sin t in both parts; y = cos t where it starts there.
  type, extends(ode_system_type) :: stiff_type
    real(wp) :: stiffness = 1.0e4_wp
  contains
    procedure :: rate => stiff_rate
    procedure :: jacobian => stiff_jacobian
  end type stiff_type

  !> The same with a stiffness that goes from 1e4 to 1 and back once per 20 pi.
  type, extends(ode_system_type) :: fading_type
  contains
    procedure :: rate => fading_rate
  end type fading_type

  !> y' = y**2, y(0) = 1: y = 1/(1 - t).
  type, extends(ode_system_type) :: explosion_type
  contains
    procedure :: rate => explosion_rate
  end type explosion_type

  !> y' = cos t in both parts, refused where it passes `edge` (in time, or in y), in a way to be chosen.
  type, extends(ode_system_type) :: obstacle_type
    logical :: in_time = .true.
    real(wp) :: edge = 1.0_wp
    integer :: code = exit_singular   !< of the failure; 0: gives NaN instead
  contains
    procedure :: rate => obstacle_rate
  end type obstacle_type

  !> y' = t**power.
  type, extends(ode_system_type) :: power_type
    integer :: power = 0
  contains
    procedure :: rate => power_rate
  end type power_type

  !> A point that turns once per 2 pi: (x, y). Settling puts it back on the unit circle, and counts.
  type, extends(ode_system_type) :: rotation_type
    integer :: settled = 0
    real(wp) :: refuse_longer_than = huge(1.0_wp)   !< settling refuses steps longer than this [s]
    real(wp) :: t_settled = 0.0_wp
    real(wp) :: largest_correction = 0.0_wp
  contains
    procedure :: rate => rotation_rate
    procedure :: settle => rotation_settle
  end type rotation_type

contains

  subroutine orbit_rate(self, t, y, ydot, err)
    class(orbit_type), intent(inout) :: self            !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot(1:2) = y(3:4)
    ydot(3:4) = -y(1:2)/norm2(y(1:2))**3
  end subroutine orbit_rate

  !> The values at the point next to the centre, t = 0.
  pure function orbit_start(eccentricity) result(y)
    real(wp), intent(in) :: eccentricity   !< of the orbit, 0 to 1
    real(wp) :: y(4)

    y = [1.0_wp - eccentricity, 0.0_wp, 0.0_wp, sqrt((1.0_wp + eccentricity)/(1.0_wp - eccentricity))]
  end function orbit_start

  !> The values at time t, by Kepler's equation, E - e sin E = t.
  pure function orbit_at(eccentricity, t) result(y)
    real(wp), intent(in) :: eccentricity   !< of the orbit, 0 to 1
    real(wp), intent(in) :: t              !< time [s]
    real(wp) :: y(4), anomaly, rate, width
    integer :: i

    anomaly = t
    do i = 1, 50
      anomaly = anomaly - (anomaly - eccentricity*sin(anomaly) - t)/(1.0_wp - eccentricity*cos(anomaly))
    end do
    width = sqrt(1.0_wp - eccentricity**2)
    rate = 1.0_wp/(1.0_wp - eccentricity*cos(anomaly))
    y = [cos(anomaly) - eccentricity, width*sin(anomaly), -rate*sin(anomaly), rate*width*cos(anomaly)]
  end function orbit_at

  subroutine pendulum_rate(self, t, y, ydot, err)
    class(pendulum_type), intent(inout) :: self         !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot(1) = y(2)
    ydot(2) = -sin(y(1))
  end subroutine pendulum_rate

  subroutine power_rate(self, t, y, ydot, err)
    class(power_type), intent(inout) :: self            !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot = t**self%power
  end subroutine power_rate

  !> The time from rest at an angle to the lowest point: K(sin(angle/2)), by the arithmetic-geometric mean.
  pure real(wp) function pendulum_quarter_period(angle) result(quarter)
    real(wp), intent(in) :: angle   !< from the lowest point [rad]
    real(wp) :: a, g, mean
    integer :: i

    a = 1.0_wp
    g = cos(0.5_wp*angle)
    do i = 1, 10
      mean = 0.5_wp*(a + g)
      g = sqrt(a*g)
      a = mean
    end do
    quarter = 0.5_wp*pi/a
  end function pendulum_quarter_period

  subroutine swing_rate(self, t, y, ydot, err)
    class(swing_type), intent(inout) :: self            !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot(1) = y(2)
    ydot(2) = -sin(y(1)) - 0.2_wp*y(2) + 0.5_wp*cos(0.7_wp*t)
  end subroutine swing_rate

  subroutine push_rate(self, t, y, ydot, err)
    class(push_type), intent(inout) :: self             !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot(1) = y(2)
    ydot(2) = cos(20.0_wp*t)
  end subroutine push_rate

  subroutine stiff_rate(self, t, y, ydot, err)
    class(stiff_type), intent(inout) :: self            !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot = -self%stiffness*(y - cos(t)) - sin(t)
  end subroutine stiff_rate

  subroutine fading_rate(self, t, y, ydot, err)
    class(fading_type), intent(inout) :: self           !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot = -(1.0_wp + 1.0e4_wp*cos(0.05_wp*t)**100)*(y - cos(t)) - sin(t)
  end subroutine fading_rate

  subroutine stiff_jacobian(self, t, y, ydot, jac, err)
    class(stiff_type), intent(inout) :: self            !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(in) :: ydot(:)                     !< its rate of change
    real(wp), intent(out) :: jac(:, :)                  !< derivatives of the rate by the vector
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: i

    jac = 0.0_wp
    do i = 1, size(y)
      jac(i, i) = -self%stiffness
    end do
  end subroutine stiff_jacobian

  subroutine explosion_rate(self, t, y, ydot, err)
    class(explosion_type), intent(inout) :: self        !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot = y**2
  end subroutine explosion_rate

  subroutine obstacle_rate(self, t, y, ydot, err)
    class(obstacle_type), intent(inout) :: self         !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    logical :: passed

    if (self%in_time) then
      passed = t > self%edge
    else
      passed = y(1) > self%edge
    end if
    ydot = cos(t)
    if (.not. passed) return
    if (self%code == 0) then
      ydot(2) = ieee_value(1.0_wp, ieee_quiet_nan)
    else
      call raise(err, self%code, 'the wall is in the way')
    end if
  end subroutine obstacle_rate

  subroutine rotation_rate(self, t, y, ydot, err)
    class(rotation_type), intent(inout) :: self         !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(in) :: y(:)                        !< the integrated vector
    real(wp), intent(out) :: ydot(:)                    !< its rate of change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    ydot = [-y(2), y(1)]
  end subroutine rotation_rate

  subroutine rotation_settle(self, t, y, err)
    class(rotation_type), intent(inout) :: self         !< the system
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(inout) :: y(:)                     !< the integrated vector
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (t - self%t_settled > self%refuse_longer_than) then
      call raise(err, exit_singular, 'too far to settle')
      return
    end if
    self%settled = self%settled + 1
    self%t_settled = t
    self%largest_correction = max(self%largest_correction, abs(norm2(y) - 1.0_wp))
    y = y/norm2(y)
  end subroutine rotation_settle

  !> Integrate from (0, y) to t_end, with one tolerance for everything, or with equal steps that pass every error test.
  subroutine integrate(system, method, tolerance, t_end, y, statistics, err, equal_step, outputs)
    class(ode_system_type), intent(inout), target :: system        !< system that is integrated
    character(len=*), intent(in) :: method                         !< name of the method
    real(wp), intent(in) :: tolerance                              !< relative and absolute
    real(wp), intent(in) :: t_end                                  !< end of the integration [s]
    real(wp), intent(inout) :: y(:)                                !< at the start, then at the end
    type(integration_statistics_type), intent(out) :: statistics   !< work of the integrator
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed
    real(wp), intent(in), optional :: equal_step                   !< length of all steps [s]; the integrator chooses unless given
    integer, intent(in), optional :: outputs                       !< equal parts of the way, each met exactly
    type(integrator_type) :: integrator
    real(wp) :: absolute(size(y)), t, t_stop
    integer :: i, n

    n = 1
    if (present(outputs)) n = outputs
    absolute = tolerance
    t = 0.0_wp
    call integrator%create(system, method, step_tolerance_type(min(tolerance, 0.1_wp), absolute), t, y, err)
    if (.not. allocated(err) .and. present(equal_step)) &
      call integrator%limit(err, largest_step=equal_step, first_step=equal_step)
    do i = 1, n
      t_stop = t_end*i/n
      do while (abs(t_stop - t) > 0.0_wp .and. .not. allocated(err))
        call integrator%step(t_stop, t, y, err)
      end do
    end do
    statistics = integrator%statistics()
    call integrator%destroy()
  end subroutine integrate
end module mech9_integration_problems
