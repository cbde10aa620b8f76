!> The motion of designs side by side, by the widest instructions that the processor has. All of them give the same bits.
module mech9_lane_motion
  use mech9_kinds, only: wp
  use mech9_lane_group, only: lane_group_type, lanes
  use mech9_lane_motion_sse2, only: begin_sse2 => begin_in_lanes, go_on_sse2 => go_on_in_lanes, &
    renew_sse2 => renew_rates_in_lanes, point_sse2 => point_in_lanes, keep_sse2 => keep_in_lanes
  use mech9_lane_motion_avx2, only: begin_avx2 => begin_in_lanes, go_on_avx2 => go_on_in_lanes, &
    renew_avx2 => renew_rates_in_lanes, point_avx2 => point_in_lanes, keep_avx2 => keep_in_lanes
  use mech9_lane_motion_avx512, only: begin_avx512 => begin_in_lanes, go_on_avx512 => go_on_in_lanes, &
    renew_avx512 => renew_rates_in_lanes, point_avx512 => point_in_lanes, keep_avx512 => keep_in_lanes
  implicit none
  private
  public :: begin_group, go_on_with_group, renew_rates_of_group, find_point, keep_column

contains

  !> Begin at the closed positions of the designs: find their rates and accelerations.
  pure subroutine begin_group(bits, group)
    integer, intent(in) :: bits                     !< of the vector registers that are used: 512, 256, or any others
    type(lane_group_type), intent(inout) :: group   !< with coordinates, and the motion of the given ones

    select case (bits)
    case (512)
      call begin_avx512(group)
    case (256)
      call begin_avx2(group)
    case default
      call begin_sse2(group)
    end select
  end subroutine begin_group

  !> Go on by a step on the same branch. `refused` is raised in lanes where the branch stepper would not accept the step at once.
  pure subroutine go_on_with_group(bits, h, group)
    integer, intent(in) :: bits                     !< of the vector registers that are used: 512, 256, or any others
    real(wp), intent(in) :: h(lanes)                !< lengths of the step [s]; 0: beside the last position
    type(lane_group_type), intent(inout) :: group   !< with the motion of the given coordinates at its end

    select case (bits)
    case (512)
      call go_on_avx512(h, group)
    case (256)
      call go_on_avx2(h, group)
    case default
      call go_on_sse2(h, group)
    end select
  end subroutine go_on_with_group

  !> Find rates and accelerations anew at the positions that were found last, for others of the given coordinates.
  pure subroutine renew_rates_of_group(bits, group)
    integer, intent(in) :: bits                     !< of the vector registers that are used: 512, 256, or any others
    type(lane_group_type), intent(inout) :: group   !< with rates and accelerations of the given coordinates

    select case (bits)
    case (512)
      call renew_avx512(group)
    case (256)
      call renew_avx2(group)
    case default
      call renew_sse2(group)
    end select
  end subroutine renew_rates_of_group

  !> A component of the motion of a point of a link.
  pure subroutine find_point(bits, group, frame, place, axis, origin, motion)
    integer, intent(in) :: bits                      !< of the vector registers that are used: 512, 256, or any others
    type(lane_group_type), intent(in) :: group       !< with the motion of its frames
    integer, intent(in) :: frame                     !< the link's first frame
    real(wp), intent(in) :: place(lanes, 3)          !< the point in the frame [m]
    real(wp), intent(in) :: axis(lanes, 3)           !< components of the direction in the plane's axes
    real(wp), intent(in) :: origin(lanes)            !< component of the origin of frame 0 [m]
    real(wp), intent(inout) :: motion(lanes, 0:2)    !< gets the component of position, velocity and acceleration [m, m/s, m/s^2]

    associate (pose => group%frames(frame)%pose, v => group%frames(frame)%v, a => group%frames(frame)%a)
      select case (bits)
      case (512)
        call point_avx512(pose, v, a, place, axis, origin, motion)
      case (256)
        call point_avx2(pose, v, a, place, axis, origin, motion)
      case default
        call point_sse2(pose, v, a, place, axis, origin, motion)
      end select
    end associate
  end subroutine find_point

  !> Keep a column with its derivatives, and find out where it may have a turning point since the output before.
  pure subroutine keep_column(bits, h, factors, motion, kept, range, turning)
    integer, intent(in) :: bits                      !< of the vector registers that are used: 512, 256, or any others
    real(wp), intent(in) :: h                        !< time from the output before [s]
    real(wp), intent(in) :: factors(0:2)             !< from the units of the motion to numbers whose derivatives are the next ones
    real(wp), intent(in) :: motion(lanes, 0:2)       !< the column, its rate and its acceleration
    real(wp), intent(inout) :: kept(lanes, 0:2, 2)   !< the numbers of the output before; second, gets those of this one
    real(wp), intent(inout) :: range(lanes, 2)       !< least and largest number so far
    real(wp), intent(inout) :: turning(lanes)        !< 1 where the rate may change its sign, else 0

    select case (bits)
    case (512)
      call keep_avx512(h, factors, motion, kept, range, turning)
    case (256)
      call keep_avx2(h, factors, motion, kept, range, turning)
    case default
      call keep_sse2(h, factors, motion, kept, range, turning)
    end select
  end subroutine keep_column
end module mech9_lane_motion
