!> The plane in which a periodic motion starts whose period is its own: every point of such a motion could be its start.
!>
!> As a rule it is the plane in which a coordinate has its largest value, so that its rate vanishes. A position of rest beside the
!> motion lies in it, too, and there the motion may shrink to it. Coordinates that turn on pass a value in place of an extreme. Where the
!> motion does not cross such a plane well, one across the motion serves, which is chosen anew from point to point (Poincare's condition;
!> Seydel, Practical Bifurcation and Stability Analysis, Springer 2010).
module mech9_phase_plane
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_period_map, only: period_map_type
  implicit none
  private
  public :: phase_plane_type, choose_plane, plane_across, crosses_well

  !> A plane: normal . (state - origin) = 0. States are in the units of a curve.
  type :: phase_plane_type
    real(wp), allocatable :: normal(:)       !< (states) of length 1; the motion goes in its direction
    real(wp), allocatable :: origin(:)       !< (states) one of its points
    logical :: is_of_coordinate = .false.    !< one coordinate, or its rate, decides
  end type phase_plane_type

  !> Times at which a motion is looked at.
  integer, parameter :: samples = 400
  !> A start nearer to an extreme, in parts of the period, is there.
  real(wp), parameter :: same_time = 1.0e-9_wp
  !> Coordinates that move by less, in units of the curve, stand still.
  real(wp), parameter :: least_move = 1.0e-6_wp
  !> Least sine of the angle between the motion and a plane.
  real(wp), parameter :: least_angle = 0.1_wp

contains

  !> Choose the plane of a motion, and its start in it, which is exact but for an interpolation.
  subroutine choose_plane(map, x, period, turns, unit, plane, start, err)
    type(period_map_type), intent(inout) :: map         !< the map, begun
    real(wp), intent(in) :: x(:)                        !< (states) of the motion
    real(wp), intent(in) :: period                      !< of the motion [s]
    integer, intent(in) :: turns(:)                     !< (free) whole turns in a period
    real(wp), intent(in) :: unit(:)                     !< (states) of the curve
    type(phase_plane_type), intent(out) :: plane        !< the plane
    real(wp), allocatable, intent(out) :: start(:)      !< (states) the start
    type(error_type), allocatable, intent(out) :: err   !< allocated if the motion failed
    real(wp) :: states(size(x), 0:samples), rate(size(x)), moves(size(turns)), time
    integer :: i, k, n

    n = size(turns)
    start = x
    allocate (plane%normal(size(x)), source=0.0_wp)
    plane%is_of_coordinate = .true.
    call map%sample(x, [(period*i/samples, i=1, samples)], states(:, 1:), rate, err)
    if (allocated(err)) return
    ! the motion is the same after a period; a rate there is zero but for errors
    states(:, 0) = states(:, samples)
    moves = 0.0_wp
    do k = 1, n
      if (turns(k) == 0) moves(k) = (maxval(states(k, :)) - minval(states(k, :)))/unit(k)
    end do
    if (any(moves > least_move)) then
      k = maxloc(moves, dim=1)
      call find_extreme(states(k, :), states(n + k, :), period, time)
      if (time > same_time*period .and. time < (1.0_wp - same_time)*period) then
        call map%sample(x, [time], states(:, 1:1), rate, err)
        if (allocated(err)) return
        start = states(:, 1)
      end if
      start(n + k) = 0.0_wp
      plane%normal(n + k) = -1.0_wp
    else
      k = maxloc(abs(turns), dim=1)
      plane%normal(k) = sign(1.0_wp, real(turns(k), wp))
    end if
    plane%origin = start/unit
  end subroutine choose_plane

  !> The time at which a coordinate has its largest value.
  pure subroutine find_extreme(q, dq, period, time)
    real(wp), intent(in) :: q(0:)        !< values at equal times
    real(wp), intent(in) :: dq(0:)       !< their rates
    real(wp), intent(in) :: period       !< the last time [s]
    real(wp), intent(out) :: time        !< of the largest value [s]
    real(wp) :: largest
    integer :: i

    time = 0.0_wp
    largest = -huge(largest)
    do i = 0, samples - 1
      if (.not. dq(i) > 0.0_wp .or. dq(i + 1) > 0.0_wp .or. q(i) < largest) cycle
      largest = q(i)
      time = period*(i + dq(i)/(dq(i) - dq(i + 1)))/samples
    end do
  end subroutine find_extreme

  !> The plane across a motion at one of its points.
  pure subroutine plane_across(x, flow, plane)
    real(wp), intent(in) :: x(:)                   !< (states) the point, in the units of the curve
    real(wp), intent(in) :: flow(:)                !< (states) direction of the motion there
    type(phase_plane_type), intent(out) :: plane   !< the plane

    plane%origin = x
    plane%normal = flow/norm2(flow)
  end subroutine plane_across

  !> Whether a motion crosses a plane at no small angle, in the direction of its normal.
  pure logical function crosses_well(plane, flow)
    type(phase_plane_type), intent(in) :: plane    !< the plane
    real(wp), intent(in) :: flow(:)                !< (states) direction of the motion

    crosses_well = dot_product(plane%normal, flow) > least_angle*norm2(flow)
  end function crosses_well
end module mech9_phase_plane
