!> Twists of constants in planar arithmetic, where all of them keep the plane.
module mech9_planar_support
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: turn
  use mech9_plan, only: plan_type, new_state
  use mech9_state, only: state_type
  use mech9_arithmetics, only: set_in_space
  use mech9_frame_motion, only: place_all
  use mech9_planar_motion, only: place_in_plane
  use mech9_parameter_support, only: support_type
  implicit none
  private
  public :: put_in_plane

  !> Part of a twist that may leave the plane: the error of derivatives of constants.
  real(wp), parameter :: negligible_part = 1.0e-11_wp

contains

  !> Write the twists of a planar mechanism's constants in the axes of the planar frames, if they keep the plane: the rotation about
  !> the normal, two shifts, and the shift along the normal, which only points may have. Else the twists stay as they are.
  subroutine put_in_plane(plan, q, support, fits)
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism, planar
    real(wp), intent(in) :: q(:)                    !< (M) any values of the coordinates [rad, m]
    type(support_type), intent(inout) :: support    !< the twists
    logical, intent(out) :: fits                    !< all twists keep the plane
    type(plan_type) :: in_space
    type(state_type) :: space, plane
    type(error_type), allocatable :: err
    real(wp) :: flat(4, support%count), tilt
    integer :: i

    in_space = plan
    in_space%blocks%arithmetic = 1
    in_space%blocks%is_shown = .false.
    call set_in_space(in_space)
    space = new_state(in_space)
    plane = new_state(plan)
    space%q = q
    call place_all(in_space, space, err)
    fits = .not. allocated(err)
    if (.not. fits) return
    call place_in_plane(plan%planar, 1, plan%n_coordinates, q, plane%planar)
    do i = 1, support%count
      associate (constant => support%constants(i))
        call flatten(plan%planar%axes, space%r(:, :, constant%frame), plane%planar%pose(:, constant%frame), constant%twist, &
                     flat(:, i), tilt)
        if (constant%point > 0) cycle
        fits = max(tilt, abs(flat(4, i))/plan%length) <= negligible_part*constant%size
        if (.not. fits) return
      end associate
    end do
    do i = 1, support%count
      support%constants(i)%twist(1:4) = flat(:, i)
    end do
  end subroutine put_in_plane

  !> A twist in the axes of a planar frame.
  pure subroutine flatten(axes, r, pose, twist, flat, tilt)
    real(wp), intent(in) :: axes(3, 3)   !< axes of the plane, in those of frame 0
    real(wp), intent(in) :: r(3, 3)      !< rotation of the frame in space
    real(wp), intent(in) :: pose(4)      !< its pose in the plane
    real(wp), intent(in) :: twist(6)     !< in the frame in space: rotation, and shift of its origin [rad, m]
    real(wp), intent(out) :: flat(4)     !< rotation about the normal, two shifts in the planar frame, shift along the normal
    real(wp), intent(out) :: tilt        !< rotation that leaves the plane [rad]
    real(wp) :: w(3), v(3)

    w = matmul(turn(r, twist(1:3)), axes)
    v = matmul(turn(r, twist(4:6)), axes)
    tilt = maxval(abs(w(1:2)))
    flat(1) = w(3)
    flat(2) = pose(1)*v(1) + pose(2)*v(2)
    flat(3) = pose(1)*v(2) - pose(2)*v(1)
    flat(4) = v(3)
  end subroutine flatten
end module mech9_planar_support
