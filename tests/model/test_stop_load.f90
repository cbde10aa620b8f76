!> The energy of compliant stops: its slopes against differences of the energy itself.
module test_stop_load
  use mech9_kinds, only: wp
  use mech9_motion_change, only: motion_change_type, new_motion_change
  use mech9_motion_view, only: motion_view_type
  use mech9_stop_load, only: stop_load_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('energy_slopes')) call energy_slopes(test)
  end subroutine run

  !> Pressed in at either end, by the coordinate, both ends, stiffness, damping, which stores no energy, and exponent.
  subroutine energy_slopes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: numbers(6) = [0.0_wp, -0.4_wp, 0.3_wp, 50.0_wp, 2.0_wp, 1.5_wp]   ! coordinate, then the stop's own
    real(wp), parameter :: h = 1.0e-3_wp
    type(motion_change_type) :: change
    type(motion_view_type) :: view
    type(stop_load_type) :: load
    real(wp) :: at(6), own(5), slope
    integer :: end, i

    allocate (view%dq(1), source=0.0_wp)
    do end = 1, 2
      at = numbers
      at(1) = merge(-0.9_wp, 0.8_wp, end == 1)
      do i = 1, size(at)
        ! central differences of two widths: the error is of the order h^4, and round-off is 1e-13
        slope = (8.0_wp*(energy(at, i, h) - energy(at, i, -h)) - energy(at, i, 2.0_wp*h) + energy(at, i, -2.0_wp*h))/(12.0_wp*h)
        change = new_motion_change(0, 1)
        own = 0.0_wp
        if (i == 1) change%q = 1.0_wp
        if (i > 1) own(i - 1) = 1.0_wp
        call set(at)
        call test%near(load%varied_potential(view, change, own), slope, 1.0e-9_wp, 'the slope of the energy by a number')
      end do
    end do
  contains

    !> The energy where one number is another one.
    real(wp) function energy(at, i, distance)
      real(wp), intent(in) :: at(6)      !< coordinate, both ends [m], stiffness [N/m], damping, exponent [1]
      integer, intent(in) :: i           !< the number that is another one
      real(wp), intent(in) :: distance   !< by so much [m]
      real(wp) :: beside(6)

      beside = at
      beside(i) = beside(i) + distance
      call set(beside)
      energy = load%potential(view)
    end function energy

    !> Set the coordinate and the stop.
    subroutine set(at)
      real(wp), intent(in) :: at(6)      !< coordinate, both ends [m], stiffness [N/m], damping, exponent [1]

      view%q = at(1:1)
      load%stop%coordinate = 1
      load%stop%is_rigid = .false.
      load%stop%ends = at(2:3)
      load%stop%stiffness = at(4)
      load%stop%damping = at(5)
      load%stop%exponent = at(6)
    end subroutine set
  end subroutine energy_slopes
end module test_stop_load
