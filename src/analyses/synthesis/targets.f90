!> The targets of all objectives of a synthesis, one behind the other.
module mech9_targets
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_law, only: drive_slot_type
  use mech9_model, only: model_type
  use mech9_objective, only: path_objective, timing_free, timing_over
  use mech9_open_position, only: open_position_type, point_derivatives
  use mech9_design_space, only: design_type
  implicit none
  private
  public :: target_type, gather_targets, difference, time_at, are_in_order, meet_in_time, outer_times

  !> One target.
  type :: target_type
    integer :: objective = 0            !< number of its objective
    integer :: timing = timing_free
    integer :: point = 0                !< number of the point that should meet it; 0: a coordinate should
    integer :: link = 0                 !< link of this point
    integer :: coordinate = 0           !< the coordinate
    integer :: over = 0                 !< driven coordinate whose value gives the time
    integer :: components = 3           !< components that count
    real(wp) :: place(3) = 0.0_wp       !< of the target [m], or the value [rad, m] first
    real(wp) :: at = 0.0_wp             !< time [s], or value of the driven coordinate [rad, m]
    real(wp) :: factor = 1.0_wp         !< root of the weight
  end type target_type

  !> Times that differ by less than this part of the run are nearly the same.
  real(wp), parameter :: same_time = 1.0e-3_wp

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
      associate (objective => model%request%objectives(i))
        do j = 1, size(objective%targets, 2)
          n = n + 1
          targets(n) = target_type(i, objective%timing, objective%point, 0, objective%coordinate, objective%over, &
                                   objective%components, objective%targets(:, j), objective%at(j), sqrt(objective%weight))
          if (objective%kind == path_objective) targets(n)%link = model%mechanism%points(objective%point)%link
        end do
      end associate
    end do
  end subroutine gather_targets

  !> The weighted difference of the mechanism from a target, and its derivatives by coordinates and parameters.
  subroutine difference(target, design, position, r, by_q, by_x)
    type(target_type), intent(in) :: target                !< the target
    type(design_type), intent(in) :: design                !< placed, with its tangents
    type(open_position_type), intent(in) :: position       !< with the twists of its frames
    real(wp), intent(out) :: r(3)                          !< the difference [m, rad]
    real(wp), intent(out) :: by_q(:, :)                    !< (3,M) by the coordinates, each in its unit
    real(wp), intent(out) :: by_x(:, :)                    !< (3,P) by the parameters
    real(wp) :: place(3)

    if (target%point > 0) then
      call point_derivatives(design, position, target%point, target%link, place, by_q, by_x)
    else
      place = 0.0_wp
      by_q = 0.0_wp
      by_x = 0.0_wp
      place(1) = position%state%q(target%coordinate)
      by_q(1, target%coordinate) = design%in_space%unit_of(target%coordinate)
    end if
    r = target%factor*(place - target%place)
    r(target%components + 1:) = 0.0_wp
    by_q(target%components + 1:, :) = 0.0_wp
    by_x(target%components + 1:, :) = 0.0_wp
    by_q = target%factor*by_q
    by_x = target%factor*by_x
  end subroutine difference

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

  !> Whether free times of each objective increase from target to target in the direction of the run.
  pure logical function are_in_order(targets, times, direction)
    type(target_type), intent(in) :: targets(:)   !< all targets
    real(wp), intent(in) :: times(:)              !< their times [s]
    real(wp), intent(in) :: direction             !< +1, or -1 for a run backwards in time
    integer :: i

    are_in_order = .true.
    do i = 2, size(targets)
      if (targets(i)%timing /= timing_free .or. targets(i)%objective /= targets(i - 1)%objective) cycle
      are_in_order = are_in_order .and. (times(i) - times(i - 1))*direction > 0.0_wp
    end do
  end function are_in_order

  !> Whether two neighbouring targets with free times are met at nearly the same time: the search does not change their order, and may
  !> have stopped there.
  pure logical function meet_in_time(targets, times, duration)
    type(target_type), intent(in) :: targets(:)   !< all targets
    real(wp), intent(in) :: times(:)              !< their times [s]
    real(wp), intent(in) :: duration              !< of the run [s]
    integer :: i

    meet_in_time = .false.
    do i = 2, size(targets)
      if (targets(i)%timing /= timing_free .or. targets(i)%objective /= targets(i - 1)%objective) cycle
      meet_in_time = meet_in_time .or. abs(times(i) - times(i - 1)) < same_time*abs(duration)
    end do
  end function meet_in_time

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
