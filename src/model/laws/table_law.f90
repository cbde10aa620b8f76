!> A law through the points of a table by a cubic spline with continuous second derivative.
module mech9_table_law
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_spline, only: spline_type
  use mech9_law, only: law_type, refuse_time
  implicit none
  private
  public :: table_law_type

  !> A law by a table, as a spline.
  type, extends(law_type) :: table_law_type
    type(spline_type) :: spline   !< the coordinate [rad, m] over time [s]
  contains
    procedure :: evaluate
    procedure :: greatest_rate
    procedure :: check_time
    procedure :: constants
  end type table_law_type

contains

  !> The spline and its derivatives. Fails outside the times of the table.
  subroutine evaluate(self, t, q, dq, ddq, err)
    class(table_law_type), intent(in) :: self         !< the table law
    real(wp), intent(in) :: t                           !< time [s]
    real(wp), intent(out) :: q                          !< the coordinate [rad, m]
    real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
    real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%check_time(t, 'a value is asked for at', err)
    if (.not. allocated(err)) call self%spline%evaluate(t, q, dq, ddq)
  end subroutine evaluate

  !> Fail outside the times of the table. Output times are sums and may miss its ends by round-off.
  subroutine check_time(self, t, demand, err)
    class(table_law_type), intent(in) :: self           !< the table law
    real(wp), intent(in) :: t                           !< the time [s]
    character(len=*), intent(in) :: demand              !< the words before this time
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is no value
    real(wp) :: slack

    associate (first => self%spline%x(1), last => self%spline%x(size(self%spline%x)))
      slack = 1.0e-12_wp*(last - first)
      if (t < first - slack .or. t > last + slack) &
        call refuse_time(self, 'table', first, last, t, demand, 'lengthen the table or shorten &time', err)
    end associate
  end subroutine check_time

  !> A table has no numbers that a parameter could set.
  pure subroutine constants(self, values)
    class(table_law_type), intent(in) :: self        !< the table law
    real(wp), allocatable, intent(out) :: values(:)  !< none

    allocate (values(0))
  end subroutine constants

  !> The bound is that of the spline between the two times.
  function greatest_rate(self, t, h) result(rate)
    class(table_law_type), intent(in) :: self   !< the table law
    real(wp), intent(in) :: t                     !< beginning of the interval [s]
    real(wp), intent(in) :: h                     !< length of the interval [s]; may be negative
    real(wp) :: rate

    rate = self%spline%steepest(min(t, t + h), max(t, t + h))
  end function greatest_rate
end module mech9_table_law
