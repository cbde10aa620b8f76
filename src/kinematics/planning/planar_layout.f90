!> Second part of the plan: a test whether the mechanism is planar, its plan in the plane, and the layout of single steps and
!> closures in a plane.
module mech9_planar_layout
  use mech9_kinds, only: wp
  use mech9_tolerances, only: planar_round_off
  use mech9_planning_failures, only: failure_chain_dimensions, failure_nothing_turns, failure_pair_off_plane, &
    failure_no_fixed_axis, failure_chain_off_plane, failure_coupled
  use mech9_rotation, only: identity
  use mech9_pose, only: pose_type, pose_from_axis, default_zero
  use mech9_plan, only: plan_type, step_type
  use mech9_planar_plan, only: planar_plan_type, planar_step_type, planar_closure_type
  implicit none
  private
  public :: lay_out_in_plane, lay_out_step, lay_out_closure, seen_from_plane, find_axes, planar_frame_type

  !> The planar frame of a frame of the plan: it has the same origin, and the normal as its z axis.
  type :: planar_frame_type
    real(wp) :: to_planar(3, 3) = identity   !< turns components in the frame of the plan into those in the planar frame
    real(wp) :: height = 0.0_wp              !< of the origin above that of the plane [m]
  end type planar_frame_type

contains

  !> Lay out the plan in its plane, if it has one: the axes of all revolute pairs are parallel to one normal, those of all
  !> prismatic pairs are perpendicular to it, and the space of motions of every closed chain has three dimensions. The ranks
  !> of the closures must be known. `planar%used` is the result, and `planar%why_not` the reason if it is false.
  pure subroutine lay_out_in_plane(plan)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    type(planar_plan_type) :: planar
    type(planar_frame_type) :: frames(0:plan%n_coordinates)
    logical :: fits
    integer :: s, c

    do c = 1, size(plan%closures)
      if (plan%closures(c)%coupling > 0) call refuse(failure_coupled, plan%planar)
      if (plan%closures(c)%coupling > 0) return
      if (plan%closures(c)%rank == 3) cycle
      call refuse(failure_chain_dimensions, plan%planar)
      plan%planar%why_not%chains = [plan%closures(c)%chain]
      plan%planar%why_not%number = plan%closures(c)%rank
      return
    end do
    call find_axes(plan%steps, 0, 1, plan%n_coordinates, planar%axes, planar%in_xy_plane, fits)
    if (.not. fits) call refuse(failure_nothing_turns, plan%planar)
    if (.not. fits) return
    planar%length = plan%length
    allocate (planar%steps(plan%n_coordinates), planar%closures(size(plan%closures)))
    frames(0)%to_planar = transpose(planar%axes)
    do s = 1, plan%n_coordinates
      call lay_out_step(plan%steps(s), plan%steps(s)%parent, frames(plan%steps(s)%parent), planar%steps(s), frames(s), fits)
      if (fits) cycle
      call refuse(merge(failure_pair_off_plane, failure_no_fixed_axis, plan%steps(s)%is_screw), plan%planar)
      plan%planar%why_not%coordinates = [plan%steps(s)%coordinate]
      return
    end do
    do c = 1, size(plan%closures)
      associate (closure => plan%closures(c), flat => planar%closures(c))
        flat%closing = closure%closing
        flat%target = closure%target
        flat%base = closure%base
        call lay_out_closure(closure%in_target, frames(flat%closing), frames(flat%target), plan%length, flat, fits)
      end associate
      if (fits) cycle
      call refuse(failure_chain_off_plane, plan%planar)
      plan%planar%why_not%chains = [plan%closures(c)%chain]
      return
    end do
    allocate (planar%height(0:plan%n_coordinates), source=frames%height)
    allocate (planar%link_in_frame(plan%n_links))
    do s = 1, plan%n_links
      planar%link_in_frame(s) = seen_from_plane(frames(plan%frame_of(s)), plan%link_in_frame(s))
    end do
    planar%used = .true.
    plan%planar = planar
  end subroutine lay_out_in_plane

  !> Keep why there is no plane; the caller adds the numbers that the kind names. Nothing is left of an earlier layout.
  pure subroutine refuse(kind, planar)
    integer, intent(in) :: kind                           !< of failure
    type(planar_plan_type), intent(inout) :: planar       !< gets `why_not`

    planar = planar_plan_type()
    allocate (planar%why_not)
    planar%why_not%kind = kind
  end subroutine refuse

  !> The axes of the plane that is fixed in a base frame, from the first of some steps that turns.
  pure subroutine find_axes(steps, base, first, last, axes, in_xy_plane, found)
    type(step_type), intent(in) :: steps(:)   !< (M) the steps of the plan
    integer, intent(in) :: base               !< frame in which the plane is fixed
    integer, intent(in) :: first              !< steps from this one
    integer, intent(in) :: last               !< to this one
    real(wp), intent(out) :: axes(3, 3)       !< turns components in the plane's axes into those of the base
    logical, intent(out) :: in_xy_plane       !< these axes are those of the base
    logical, intent(out) :: found             !< one of the steps turns, and only slides lie between it and the base
    real(wp) :: normal(3)
    type(pose_type) :: frame
    integer :: s

    axes = identity
    in_xy_plane = .true.
    found = .false.
    do s = first, last
      if (abs(steps(s)%turn) > 0.0_wp) exit
    end do
    if (s > last) return
    ! from the pair back to the base, over pairs that do not turn
    normal = steps(s)%before%r(:, 3)
    s = steps(s)%parent
    do while (s > base)
      normal = matmul(steps(s)%before%r, normal)
      s = steps(s)%parent
    end do
    found = s == base
    if (.not. found) return
    in_xy_plane = norm2(normal(1:2)) <= planar_round_off
    if (in_xy_plane) return
    call pose_from_axis([0.0_wp, 0.0_wp, 0.0_wp], normal, default_zero(normal), frame, found)
    if (found) axes = frame%r
  end subroutine find_axes

  !> Lay out one step in a plane.
  pure subroutine lay_out_step(step, parent, start, flat, reached, fits)
    type(step_type), intent(in) :: step              !< the step
    integer, intent(in) :: parent                    !< planar frame from which it leads
    type(planar_frame_type), intent(in) :: start     !< the frame from which it leads
    type(planar_step_type), intent(out) :: flat      !< the step in the plane
    type(planar_frame_type), intent(out) :: reached  !< the frame to which it leads
    logical, intent(out) :: fits                     !< the step stays in the plane
    real(wp) :: r(3, 3), p(3), side

    fits = step%is_screw
    if (.not. fits) return
    r = matmul(start%to_planar, step%before%r)
    p = matmul(start%to_planar, step%before%p)
    flat%parent = parent
    flat%coordinate = step%coordinate
    flat%place = p(1:2)
    reached%height = start%height + p(3)
    flat%turns = abs(step%turn) > 0.0_wp
    if (flat%turns) then
      ! the axis may point in either direction along the normal
      side = sign(1.0_wp, r(3, 3))
      fits = norm2(r(1:2, 3)) <= planar_round_off .and. .not. abs(step%slide) > 0.0_wp
      flat%turn = side*step%turn
      flat%angle = flat%turn*step%offset + atan2(r(2, 1), r(1, 1))
      reached%to_planar = identity
      reached%to_planar(2, 2) = side
      reached%to_planar(3, 3) = side
    else
      fits = abs(r(3, 3)) <= planar_round_off
      flat%slide = step%slide*r(1:2, 3)
      flat%place = flat%place + step%offset*flat%slide
      reached%to_planar = r
    end if
  end subroutine lay_out_step

  !> Lay out one closure in a plane: the pose of the closing frame in the target frame, if it lies in the plane.
  pure subroutine lay_out_closure(in_target, closing, target, size_of_plane, flat, fits)
    type(pose_type), intent(in) :: in_target             !< pose that the closing frame must have in the target frame
    type(planar_frame_type), intent(in) :: closing       !< the closing frame
    type(planar_frame_type), intent(in) :: target        !< the target frame
    real(wp), intent(in) :: size_of_plane                !< the mechanism's size [m]
    type(planar_closure_type), intent(inout) :: flat     !< the closure in the plane, with the numbers of its frames; gets the pose
    logical, intent(out) :: fits                         !< the chain closes in the plane
    real(wp) :: r(3, 3), p(3)

    r = matmul(target%to_planar, matmul(in_target%r, transpose(closing%to_planar)))
    p = matmul(target%to_planar, in_target%p)
    flat%place = p(1:2)
    flat%cosine = r(1, 1)
    flat%sine = r(2, 1)
    fits = norm2(r(1:2, 3)) <= planar_round_off .and. r(3, 3) > 0.0_wp .and. &
           abs(target%height + p(3) - closing%height) <= planar_round_off*size_of_plane
  end subroutine lay_out_closure

  !> A pose that is given in a frame of the plan, in the planar frame and moved along the normal to the height of the plane.
  pure function seen_from_plane(frame, pose) result(seen)
    type(planar_frame_type), intent(in) :: frame   !< the frame
    type(pose_type), intent(in) :: pose            !< pose in this frame of the plan
    type(pose_type) :: seen

    seen%r = matmul(frame%to_planar, pose%r)
    seen%p = matmul(frame%to_planar, pose%p)
    seen%p(3) = seen%p(3) + frame%height
  end function seen_from_plane
end module mech9_planar_layout
