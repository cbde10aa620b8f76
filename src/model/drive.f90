!> A drive: an independent coordinate as a given function of time.
module mech9_drive
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type
  implicit none
  private
  public :: drive_type, drive_slot_type

  !> A given function of time for one coordinate.
  type, abstract :: drive_type
    integer :: coordinate = 0   !< number of the coordinate it drives
    type(place_type) :: place   !< place of its group in the data file
  contains
    procedure(evaluate_interface), deferred :: evaluate
    procedure :: greatest_rate
  end type drive_type

  !> One of several drives of different kinds.
  type :: drive_slot_type
    class(drive_type), allocatable :: drive
  end type drive_slot_type

  abstract interface
    !> q(t) and its first two derivatives in time; fails where the drive has no value.
    subroutine evaluate_interface(self, t, q, dq, ddq, err)
      import :: drive_type, error_type, wp
      class(drive_type), intent(in) :: self               !< the drive
      real(wp), intent(in) :: t                           !< time [s]
      real(wp), intent(out) :: q                          !< the coordinate [rad, m]
      real(wp), intent(out) :: dq                         !< its rate [rad/s, m/s]
      real(wp), intent(out) :: ddq                        !< its acceleration [rad/s^2, m/s^2]
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine evaluate_interface
  end interface

contains

  !> A bound of |dq/dt| between t and t + h, so that no movement between two times is overlooked. Drives
  !> whose formula is known give a proven bound. This procedure, for all others, evaluates the drive at unevenly spaced
  !> times of the interval and adds a margin by the acceleration. Times at which the drive has no value do not count.
  function greatest_rate(self, t, h) result(rate)
    class(drive_type), intent(in) :: self   !< the drive
    real(wp), intent(in) :: t               !< beginning of the interval [s]
    real(wp), intent(in) :: h               !< length of the interval [s]; may be negative
    real(wp) :: rate
    real(wp), parameter :: between(4) = [0.0_wp, 0.29_wp, 0.62_wp, 1.0_wp]
    type(error_type), allocatable :: err
    real(wp) :: q, dq, ddq
    integer :: i

    rate = 0.0_wp
    do i = 1, size(between)
      call self%evaluate(t + between(i)*h, q, dq, ddq, err)
      if (.not. allocated(err)) rate = max(rate, abs(dq) + 0.25_wp*abs(h*ddq))
    end do
  end function greatest_rate
end module mech9_drive
