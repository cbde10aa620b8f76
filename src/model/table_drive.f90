!> Drive through the points of a table, smooth: a cubic spline with continuous second derivative.
module mech9_table_drive
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_spline, only: spline_type
  use mech9_drive, only: drive_type
  implicit none
  private
  public :: table_drive_type

  type, extends(drive_type) :: table_drive_type
    type(spline_type) :: spline   !< q over t
  contains
    procedure :: evaluate
    procedure :: greatest_rate
  end type table_drive_type

contains

  subroutine evaluate(self, t, q, dq, ddq, err)
    class(table_drive_type), intent(in) :: self   !< the table drive
    real(wp), intent(in) :: t
    real(wp), intent(out) :: q, dq, ddq
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: slack

    associate (first => self%spline%x(1), last => self%spline%x(size(self%spline%x)))
      slack = 1.0e-12_wp*(last - first)   ! output times are sums and may miss the end by round-off
      if (t < first - slack .or. t > last + slack) then
        call raise(err, exit_data, 'the table of the drive of coordinate '//to_text(self%coordinate)// &
                   ' covers t = '//to_text(first)//' to '//to_text(last)//', and t = '//to_text(t)// &
                   ' is asked for; lengthen the table or shorten &time', self%place)
        return
      end if
    end associate
    call self%spline%evaluate(t, q, dq, ddq)
  end subroutine evaluate

  !> That of the pieces of the curve between the two times.
  function greatest_rate(self, t, h) result(rate)
    class(table_drive_type), intent(in) :: self   !< the table drive
    real(wp), intent(in) :: t, h
    real(wp) :: rate

    rate = self%spline%steepest(min(t, t + h), max(t, t + h))
  end function greatest_rate
end module mech9_table_drive
