!> Second part of the plan: a test whether the mechanism is planar, and its plan in the plane.
module mech9_planar_layout
  use mech9_kinds, only: wp
  use mech9_tolerances, only: planar_round_off
  use mech9_failure, only: failure_chain_dimensions, failure_nothing_turns, failure_pair_off_plane, failure_chain_off_plane
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type, pose_from_axis, default_zero
  use mech9_plan, only: plan_type
  use mech9_planar_plan, only: planar_plan_type
  implicit none
  private
  public :: lay_out_in_plane


contains

  !> Lay out the plan in its plane, if it has one: the axes of all revolute pairs are parallel to one normal, those of all
  !> prismatic pairs are perpendicular to it, and the space of motions of every closed chain has three dimensions. The ranks
  !> of the closures must be known. `planar%used` tells the result, and `planar%why_not` the reason if it is false.
  pure subroutine lay_out_in_plane(plan)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(planar_plan_type) :: planar
    real(wp) :: to_frame(3, 3, 0:plan%n_coordinates)
    logical :: fits
    integer :: s, c

    do c = 1, size(plan%closures)
      if (plan%closures(c)%rank == 3) cycle
      call refuse(failure_chain_dimensions, plan%planar)
      plan%planar%why_not%chains = [plan%closures(c)%chain]
      plan%planar%why_not%number = plan%closures(c)%rank
      return
    end do
    call find_axes(plan, planar, fits)
    if (.not. fits) call refuse(failure_nothing_turns, plan%planar)
    if (.not. fits) return
    planar%length = plan%length
    allocate (planar%steps(plan%n_coordinates), planar%closures(size(plan%closures)))
    allocate (planar%height(0:plan%n_coordinates), source=0.0_wp)
    to_frame(:, :, 0) = transpose(planar%axes)
    do s = 1, plan%n_coordinates
      fits = plan%steps(s)%is_screw
      if (fits) call lay_out_step(plan, s, planar, to_frame, fits)
      if (fits) cycle
      call refuse(failure_pair_off_plane, plan%planar)
      plan%planar%why_not%coordinates = [plan%steps(s)%coordinate]
      return
    end do
    do c = 1, size(plan%closures)
      call lay_out_closure(plan, c, to_frame, planar, fits)
      if (fits) cycle
      call refuse(failure_chain_off_plane, plan%planar)
      plan%planar%why_not%chains = [plan%closures(c)%chain]
      return
    end do
    allocate (planar%link_in_frame(plan%n_links))
    do s = 1, plan%n_links
      planar%link_in_frame(s) = seen_from_plane(planar, to_frame, plan%frame_of(s), plan%link_in_frame(s))
    end do
    planar%used = .true.
    plan%planar = planar
  end subroutine lay_out_in_plane

  !> Keep why there is no plane; the caller adds the numbers that the kind names.
  pure subroutine refuse(kind, planar)
    integer, intent(in) :: kind                           !< of failure
    type(planar_plan_type), intent(inout) :: planar       !< gets `why_not`

    allocate (planar%why_not)
    planar%why_not%kind = kind
  end subroutine refuse

  !> The axes of the plane, from the first revolute pair. `fits` is false where there is none.
  pure subroutine find_axes(plan, planar, fits)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(planar_plan_type), intent(inout) :: planar   !< the planar part of the plan
    logical, intent(out) :: fits   !< there is a revolute pair and its axis gives a normal
    real(wp) :: normal(3), r(3, 3)
    type(pose_type) :: frame
    integer :: s, f

    fits = .false.
    do s = 1, plan%n_coordinates
      if (abs(plan%steps(s)%turn) > 0.0_wp) exit
    end do
    if (s > plan%n_coordinates) return
    ! from the pair back to link 1, over pairs that do not turn
    normal = plan%steps(s)%before%r(:, 3)
    f = plan%steps(s)%parent
    do while (f > 0)
      r = plan%steps(f)%before%r
      normal = matmul(r, normal)
      f = plan%steps(f)%parent
    end do
    planar%in_xy_plane = norm2(normal(1:2)) <= planar_round_off
    fits = .true.
    if (planar%in_xy_plane) return
    call pose_from_axis([0.0_wp, 0.0_wp, 0.0_wp], normal, default_zero(normal), frame, fits)
    planar%axes = frame%r
  end subroutine find_axes

  !> Lay out one step.
  pure subroutine lay_out_step(plan, s, planar, to_frame, fits)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: s   !< number of the step
    type(planar_plan_type), intent(inout) :: planar   !< the planar part of the plan
    real(wp), intent(inout) :: to_frame(:, :, 0:)   !< (3,3,0:M) turns components from a frame of the plan to that of the plane
    logical, intent(out) :: fits   !< the step stays in the plane
    real(wp) :: r(3, 3), p(3), side

    associate (step => plan%steps(s), flat => planar%steps(s))
      r = matmul(to_frame(:, :, step%parent), step%before%r)
      p = matmul(to_frame(:, :, step%parent), step%before%p)
      flat%parent = step%parent
      flat%coordinate = step%coordinate
      flat%place = p(1:2)
      planar%height(s) = planar%height(step%parent) + p(3)
      flat%turns = abs(step%turn) > 0.0_wp
      if (flat%turns) then
        ! the axis may point in either direction along the normal
        side = sign(1.0_wp, r(3, 3))
        fits = norm2(r(1:2, 3)) <= planar_round_off .and. .not. abs(step%slide) > 0.0_wp
        flat%turn = side*step%turn
        flat%angle = flat%turn*step%offset + atan2(r(2, 1), r(1, 1))
        to_frame(:, :, s) = identity
        to_frame(2, 2, s) = side
        to_frame(3, 3, s) = side
      else
        fits = abs(r(3, 3)) <= planar_round_off
        flat%slide = step%slide*r(1:2, 3)
        flat%place = flat%place + step%offset*flat%slide
        to_frame(:, :, s) = r
      end if
    end associate
  end subroutine lay_out_step

  !> Lay out one closure: the pose of the closing frame in the target frame, if it lies in the plane.
  pure subroutine lay_out_closure(plan, c, to_frame, planar, fits)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    integer, intent(in) :: c   !< number of the closure
    real(wp), intent(in) :: to_frame(:, :, 0:)   !< (3,3,0:M) turns components from a frame of the plan to that of the plane
    type(planar_plan_type), intent(inout) :: planar   !< the planar part of the plan
    logical, intent(out) :: fits   !< the chain closes in the plane
    real(wp) :: r_closing(3, 3), r(3, 3), p(3)

    associate (closure => plan%closures(c), flat => planar%closures(c))
      flat%closing = closure%closing
      flat%target = closure%target
      flat%base = closure%base
      r_closing = transpose(to_frame(:, :, closure%closing))
      r = matmul(to_frame(:, :, closure%target), matmul(closure%in_target%r, r_closing))
      p = matmul(to_frame(:, :, closure%target), closure%in_target%p)
      flat%place = p(1:2)
      flat%cosine = r(1, 1)
      flat%sine = r(2, 1)
      fits = norm2(r(1:2, 3)) <= planar_round_off .and. r(3, 3) > 0.0_wp .and. &
             abs(planar%height(closure%target) + p(3) - planar%height(closure%closing)) <= planar_round_off*plan%length
    end associate
  end subroutine lay_out_closure

  !> A pose that is given in a frame of the plan, in the same frame of the plane and at the height of frame 0.
  pure function seen_from_plane(planar, to_frame, frame, pose) result(seen)
    type(planar_plan_type), intent(in) :: planar   !< the planar part of the plan
    real(wp), intent(in) :: to_frame(:, :, 0:)   !< (3,3,0:M) turns components from a frame of the plan to that of the plane
    integer, intent(in) :: frame   !< number of the frame
    type(pose_type), intent(in) :: pose   !< pose in this frame of the plan
    type(pose_type) :: seen

    seen%r = matmul(to_frame(:, :, frame), pose%r)
    seen%p = matmul(to_frame(:, :, frame), pose%p)
    seen%p(3) = seen%p(3) + planar%height(frame)
  end function seen_from_plane
end module mech9_planar_layout
