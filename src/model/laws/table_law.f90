!> A law through the points of a table by a cubic spline with continuous second derivative.
module mech9_table_law
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_spline, only: spline_type
  use mech9_law, only: law_type, refuse_time, repetition_type, stands_still, repeats_after, never_repeats
  implicit none
  private
  public :: table_law_type

  !> The ends of a table over time may be missed by round-off, those of one over a coordinate by the errors of its motion, as
  !> parts of the table.
  real(wp), parameter :: time_slack = 1.0e-12_wp, motion_slack = 1.0e-9_wp

  !> A law by a table, as a spline.
  type, extends(law_type) :: table_law_type
    type(spline_type) :: spline   !< the coordinate [rad, m] over time [s]
    logical :: repeats = .false.  !< after the last time it begins again; a setpoint advances then as one in segments does
  contains
    procedure :: evaluate
    procedure :: greatest_rate
    procedure :: check_time
    procedure :: repetition
    procedure :: constants
    procedure :: antiderivatives
    procedure :: has_value_at
    procedure, private :: period
    procedure, private :: rounds_before
  end type table_law_type

contains

  !> The spline and its derivatives. Fails outside the times of the table unless it repeats.
  subroutine evaluate(self, t, q, dq, ddq, err)
    class(table_law_type), intent(in) :: self         !< the table law
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(out) :: q                          !< the coordinate [rad, m]
    real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: rounds

    call self%check_time(t, 'a value is asked for at', err)
    if (allocated(err)) return
    rounds = self%rounds_before(t)
    call self%spline%evaluate(t - rounds*self%period(), q, dq, ddq)
    if (self%coordinate > 0) q = q + rounds*(self%spline%y(size(self%spline%y)) - self%spline%y(1))
  end subroutine evaluate

  !> Fail outside the times of the table. Output times are sums and may miss its ends by round-off.
  subroutine check_time(self, t, demand, err)
    class(table_law_type), intent(in) :: self           !< the table law
    real(wp), intent(in) :: t                           !< the time [s]
    character(len=*), intent(in) :: demand              !< the words before this time
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is no value

    if (self%has_value_at(t)) return
    associate (x => self%spline%x)
      call refuse_time(self, 'table', x(1), x(size(x)), t, demand, 'lengthen the table', err)
    end associate
  end subroutine check_time

  !> Whether the table holds a value, or repeats.
  pure logical function has_value_at(self, x)
    class(table_law_type), intent(in) :: self   !< the table law
    real(wp), intent(in) :: x                   !< its variable [s, or its unit]

    has_value_at = self%repeats
    if (has_value_at) return
    associate (first => self%spline%x(1), last => self%spline%x(size(self%spline%x)), slack => slack_of(self)*self%period())
      has_value_at = x >= first - slack .and. x <= last + slack
    end associate
  end function has_value_at

  !> The part of the table by which its ends may be missed.
  pure real(wp) function slack_of(self)
    class(table_law_type), intent(in) :: self   !< the table law

    slack_of = merge(time_slack, motion_slack, self%variable == 't')
  end function slack_of

  !> Length of the table [s, or the unit of its variable].
  pure real(wp) function period(self)
    class(table_law_type), intent(in) :: self   !< the table law

    period = self%spline%x(size(self%spline%x)) - self%spline%x(1)
  end function period

  !> Number of whole periods before a value of the variable; 0 where nothing repeats.
  pure real(wp) function rounds_before(self, x)
    class(table_law_type), intent(in) :: self   !< the table law
    real(wp), intent(in) :: x                   !< its variable [s, or its unit]

    rounds_before = 0.0_wp
    if (self%repeats) rounds_before = real(floor((x - self%spline%x(1))/self%period(), selected_int_kind(15)), wp)
  end function rounds_before

  !> The law, its integral from the first point, and the integral of this one.
  pure subroutine antiderivatives(self, x, value, first, second)
    class(table_law_type), intent(in) :: self   !< the table law
    real(wp), intent(in) :: x                   !< its variable [s, or its unit]
    real(wp), intent(out) :: value              !< the law
    real(wp), intent(out) :: first              !< its integral
    real(wp), intent(out) :: second             !< the integral of the integral
    real(wp) :: rounds, whole_first, whole_second, slope, bending, into, inside

    rounds = self%rounds_before(x)
    inside = x - rounds*self%period()
    call self%spline%evaluate(inside, value, slope, bending)
    call self%spline%integrate(inside, first, second)
    if (.not. abs(rounds) > 0.0_wp) return
    call self%spline%integrate(self%spline%x(size(self%spline%x)), whole_first, whole_second)
    into = inside - self%spline%x(1)
    second = second + rounds*(whole_first*(0.5_wp*(rounds - 1.0_wp)*self%period() + into) + whole_second)
    first = first + rounds*whole_first
  end subroutine antiderivatives

  !> How the law repeats: after its last point, where it begins again.
  pure type(repetition_type) function repetition(self) result(found)
    class(table_law_type), intent(in) :: self   !< the law

    found%kind = never_repeats
    if (.not. any(abs(self%spline%y - self%spline%y(1)) > 0.0_wp)) then
      found%kind = stands_still
    else if (self%repeats) then
      found%kind = repeats_after
      found%period = self%period()
      if (self%coordinate > 0) found%advance = self%spline%y(size(self%spline%y)) - self%spline%y(1)
    end if
  end function repetition

  !> A table has no numbers that a parameter could set.
  pure subroutine constants(self, values)
    class(table_law_type), intent(in) :: self        !< the table law
    real(wp), allocatable, intent(out) :: values(:)  !< none

    allocate (values(0))
  end subroutine constants

  !> The bound is that of the spline between the two times; where it repeats, of the whole spline.
  function greatest_rate(self, t, h) result(rate)
    class(table_law_type), intent(in) :: self   !< the table law
    real(wp), intent(in) :: t                     !< beginning of the interval [s]
    real(wp), intent(in) :: h                     !< length of the interval [s]; may be negative
    real(wp) :: rate

    if (self%repeats) then
      rate = self%spline%steepest(self%spline%x(1), self%spline%x(size(self%spline%x)))
    else
      rate = self%spline%steepest(min(t, t + h), max(t, t + h))
    end if
  end function greatest_rate
end module mech9_table_law
