!> The targets of all objectives of a synthesis, one behind the other.
module mech9_targets
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross, about_axis, rotation_between
  use mech9_frame_motion, only: point_motion, link_motion
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_law, only: drive_slot_type
  use mech9_model, only: model_type
  use mech9_objective, only: objective_type, path_objective, function_objective, pose_objective, timing_free, &
    timing_over
  use mech9_open_position, only: open_position_type, point_derivatives, turn_derivatives
  use mech9_design_space, only: design_type
  implicit none
  private
  public :: target_type, gather_targets, components_of, difference, difference_derivatives, time_at, outer_times

  !> One target.
  type :: target_type
    integer :: objective = 0            !< number of its objective
    integer :: timing = timing_free
    integer :: point = 0                !< number of the point that should meet it; 0: a coordinate should
    integer :: link = 0                 !< link of this point, or the link that should meet a pose
    integer :: coordinate = 0           !< the coordinate
    integer :: over = 0                 !< driven coordinate whose value gives the time
    integer :: turned = 0               !< driven angle that is turned on by the first component of `place`; 0: none
    integer :: components = 3           !< components that count
    real(wp) :: place(3) = 0.0_wp       !< of the target [m], or the value [rad, m] first
    real(wp) :: turn(3, 3) = 0.0_wp     !< rotation of a pose
    real(wp) :: length = 0.0_wp         !< by which the angle between two rotations is multiplied [m]; 0: the target is no pose
    real(wp) :: at = 0.0_wp             !< time [s], or value of the driven coordinate [rad, m]
    real(wp) :: factor = 1.0_wp         !< root of the weight
  end type target_type

contains

  !> The targets of all objectives of a model.
  pure subroutine gather_targets(model, targets)
    type(model_type), intent(in) :: model                        !< with its objectives
    type(target_type), allocatable, intent(out) :: targets(:)    !< in the order of objectives and files
    integer :: i, j, n

    n = 0
    do i = 1, size(model%request%objectives)
      n = n + size(model%request%objectives(i)%targets, 2)
    end do
    allocate (targets(n))
    n = 0
    do i = 1, size(model%request%objectives)
      do j = 1, size(model%request%objectives(i)%targets, 2)
        n = n + 1
        call set_target(model, model%request%objectives(i), j, targets(n))
        targets(n)%objective = i
      end do
    end do
  end subroutine gather_targets

  !> One target of an objective.
  pure subroutine set_target(model, objective, number, target)
    type(model_type), intent(in) :: model               !< the model
    type(objective_type), intent(in) :: objective       !< the objective
    integer, intent(in) :: number                       !< of the target in the objective
    type(target_type), intent(inout) :: target          !< the target
    real(wp) :: angle

    target%timing = objective%timing
    target%over = objective%over
    target%components = objective%components
    target%place = objective%targets(:, number)
    target%at = objective%at(number)
    target%factor = sqrt(objective%weight)
    select case (objective%kind)
    case (path_objective)
      target%point = objective%point
      target%link = model%mechanism%points(objective%point)%link
    case (function_objective)
      target%coordinate = objective%coordinate
    case (pose_objective)
      target%link = objective%link
      target%length = objective%length
      angle = norm2(objective%turns(:, number))
      target%turn = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      if (angle > 0.0_wp) target%turn = about_axis(objective%turns(:, number)/angle, angle)
    end select
  end subroutine set_target

  !> Number of components that the difference from each target has: three, or six where there are poses.
  pure integer function components_of(targets)
    type(target_type), intent(in) :: targets(:)   !< all targets

    components_of = merge(6, 3, any(targets%length > 0.0_wp))
  end function components_of

  !> The weighted difference of the mechanism from a target: of places, or of the value of a coordinate first, then the angle between
  !> rotations, as a rotation vector times a length.
  subroutine difference(target, plan, design, state, r)
    type(target_type), intent(in) :: target       !< the target
    type(plan_type), intent(in) :: plan           !< of the design, in the arithmetic of the state
    type(design_type), intent(in) :: design       !< placed
    type(state_type), intent(in) :: state         !< with the poses of its frames
    real(wp), intent(out) :: r(:)                 !< (3 or 6) the difference [m, rad]
    real(wp) :: place(3), turned(3, 3), omega(3), v(3)

    r = 0.0_wp
    if (target%coordinate > 0) then
      r(1) = target%factor*(state%q(target%coordinate) - target%place(1))
    else if (target%link > 0) then
      if (target%point > 0) then
        call point_motion(plan, state, target%link, design%places(:, target%point), place)
      else
        call link_motion(plan, state, target%link, turned, place, omega, v)
        r(4:6) = target%factor*target%length*rotation_between(target%turn, turned)
      end if
      r(:target%components) = target%factor*(place(:target%components) - target%place(:target%components))
    end if
  end subroutine difference

  !> The derivatives of the weighted difference from a target by coordinates and parameters.
  subroutine difference_derivatives(target, design, position, by_q, by_x)
    type(target_type), intent(in) :: target                !< the target
    type(design_type), intent(in) :: design                !< placed, with its tangents
    type(open_position_type), intent(in) :: position       !< with the twists of its frames
    real(wp), intent(out) :: by_q(:, :)                    !< (3 or 6,M) by the coordinates, each in its unit
    real(wp), intent(out) :: by_x(:, :)                    !< (3 or 6,P) by the parameters
    real(wp) :: place(3), r(3, 3), phi(3)
    integer :: i

    by_q = 0.0_wp
    by_x = 0.0_wp
    if (target%coordinate > 0) then
      by_q(1, target%coordinate) = target%factor*design%in_space%unit_of(target%coordinate)
    else if (target%link > 0) then
      call point_derivatives(design, position, target%point, target%link, place, by_q(:3, :), by_x(:3, :))
      by_q(target%components + 1:3, :) = 0.0_wp
      by_x(target%components + 1:3, :) = 0.0_wp
      if (target%length > 0.0_wp) then
        call turn_derivatives(design, position, target%link, r, by_q(4:6, :), by_x(4:6, :))
        phi = rotation_between(target%turn, r)
        do i = 1, size(by_q, 2)
          by_q(4:6, i) = target%length*change_of_vector(phi, by_q(4:6, i))
        end do
        do i = 1, size(by_x, 2)
          by_x(4:6, i) = target%length*change_of_vector(phi, by_x(4:6, i))
        end do
      end if
      by_q = target%factor*by_q
      by_x = target%factor*by_x
    end if
  end subroutine difference_derivatives

  !> The change of a rotation vector by a small rotation that follows the rotation (Bullo and Murray 1995).
  pure function change_of_vector(phi, small) result(change)
    real(wp), intent(in) :: phi(3)     !< rotation vector [rad]
    real(wp), intent(in) :: small(3)   !< small rotation, in the axes in which the rotation vector is given [rad]
    real(wp) :: change(3)
    real(wp) :: angle, part, across(3)

    angle = norm2(phi)
    ! (1 - (angle/2)/tan(angle/2))/angle^2, by its series for small angles
    if (angle < 1.0e-2_wp) then
      part = 1.0_wp/12.0_wp + angle**2*(1.0_wp/720.0_wp + angle**2/30240.0_wp)
    else
      part = (1.0_wp - 0.5_wp*angle/tan(0.5_wp*angle))/angle**2
    end if
    across = cross(phi, small)
    change = small - 0.5_wp*across + part*cross(phi, across)
  end function change_of_vector

  !> The time at which a driven coordinate has a value, by Newton's method; `found` is false where it has not within the run.
  subroutine time_at(drives, coordinate, value, low, high, t, found)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives
    integer, intent(in) :: coordinate                !< the driven coordinate
    real(wp), intent(in) :: value                    !< its value [rad, m]
    real(wp), intent(in) :: low                      !< earliest time [s]
    real(wp), intent(in) :: high                     !< latest time [s]
    real(wp), intent(out) :: t                       !< the time [s]
    logical, intent(out) :: found                    !< whether there is one
    type(error_type), allocatable :: err
    real(wp) :: q, dq, ddq, move
    integer :: i, k

    found = .false.
    t = 0.5_wp*(low + high)
    do i = 1, size(drives)
      if (drives(i)%drive%coordinate == coordinate) exit
    end do
    if (i > size(drives)) return
    do k = 1, 100
      call drives(i)%drive%evaluate(t, q, dq, ddq, err)
      if (allocated(err)) return
      found = abs(q - value) <= 8.0_wp*epsilon(q)*max(abs(q), abs(value))
      if (found .or. .not. abs(dq) > 0.0_wp) exit
      move = (value - q)/dq
      if (abs(move) <= 4.0_wp*epsilon(t)*abs(t)) found = .true.
      t = min(max(t + move, low), high)
    end do
  end subroutine time_at

  !> The times of all targets as far as these are not free, and whether each lies within the run.
  subroutine outer_times(targets, design, low, high, times, found)
    type(target_type), intent(in) :: targets(:)   !< all targets
    type(design_type), intent(in) :: design       !< with its drives
    real(wp), intent(in) :: low                   !< earliest time of the run [s]
    real(wp), intent(in) :: high                  !< latest time of the run [s]
    real(wp), intent(inout) :: times(:)           !< (targets) gets times that are not free [s]
    logical, intent(out) :: found                 !< all lie within the run
    integer :: i
    logical :: one

    found = .true.
    do i = 1, size(targets)
      if (targets(i)%timing == timing_free) cycle
      times(i) = targets(i)%at
      if (targets(i)%timing /= timing_over) cycle
      call time_at(design%drives, targets(i)%over, targets(i)%at, low, high, times(i), one)
      found = found .and. one
    end do
  end subroutine outer_times
end module mech9_targets
