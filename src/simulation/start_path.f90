!> The assembled start of a motion. A mechanism that is drawn closed is moved from there to its start, as its drives would move it,
!> so that it keeps the assembly that was drawn.
module mech9_start_path
  use mech9_kinds, only: wp
  use mech9_simulation_tolerances, only: drawn_near_by
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_law, only: drive_slot_type
  use mech9_partition, only: dependent_coordinate
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_drawn_position, only: is_drawn_closed
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_straight_drives, only: straight_drives
  implicit none
  private
  public :: start_way_type, assemble_start, find_drawn

  !> How the start was reached from the position in which the mechanism is drawn.
  type :: start_way_type
    logical :: interrupted = .false.         !< the motion from there to the start comes to a singular position
    logical :: turned_around = .false.       !< the start was reached the other way round
    integer, allocatable :: coordinates(:)   !< independent coordinates that move; not allocated: none was moved
    real(wp), allocatable :: stopped(:)      !< their values where the motion was interrupted [rad, m]
  end type start_way_type

contains

  !> The plan, and the closed position for given values of the independent coordinates. Fails as make_plan does.
  subroutine assemble_start(model, start, plan, state, err, way)
    type(model_type), intent(in) :: model                 !< the model
    real(wp), intent(in) :: start(:)                      !< (M) values of independent coordinates, guesses of the others [rad, m]
    type(plan_type), intent(out) :: plan                  !< the plan of the mechanism
    type(state_type), intent(out) :: state                !< the closed position
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(start_way_type), intent(out), optional :: way    !< how the start was reached from the drawn position
    type(start_way_type) :: found
    real(wp) :: q(size(start)), drawn(size(start))
    logical :: exists

    q = start
    call find_drawn(model, start, drawn, exists)
    if (exists) call follow(model, drawn, start, q, found)
    call make_plan(model%mechanism, model%problem%partition, q, plan, state, err)
    if (present(way)) way = found
  end subroutine assemble_start

  !> Find the position in which the mechanism is drawn: that of the values in &initial, or, where the user gives no dependent
  !> coordinate, that in which all coordinates are zero. It exists where the chains close in it, and not at the start.
  subroutine find_drawn(model, start, drawn, exists, known)
    type(model_type), intent(in) :: model     !< the model
    real(wp), intent(in) :: start(:)          !< (M) values and guesses at the start [rad, m]
    real(wp), intent(out) :: drawn(:)         !< (M) the drawn position [rad, m]
    logical, intent(out) :: exists            !< there is one away from the start
    type(plan_type), intent(in), optional :: known   !< the plan of the mechanism, where it is known

    exists = .false.
    associate (problem => model%problem)
      drawn = problem%initial%position
      if (all(problem%partition%kind == dependent_coordinate)) return
      if (is_at(drawn, start) .and. is_zero(drawn)) return
      if (is_drawn_closed(model%mechanism, problem%partition, start, known)) return
      if (.not. is_at(drawn, start)) exists = is_drawn_closed(model%mechanism, problem%partition, drawn, known)
      if (exists .or. is_zero(drawn)) return
      if (any(problem%initial%position_given .and. problem%partition%kind == dependent_coordinate)) return
      drawn = 0.0_wp
      exists = is_drawn_closed(model%mechanism, problem%partition, drawn, known)
    end associate
  end subroutine find_drawn

  !> Whether two positions are the same to the last digit.
  pure logical function is_at(a, b)
    real(wp), intent(in) :: a(:)   !< coordinates [rad, m]
    real(wp), intent(in) :: b(:)   !< coordinates [rad, m]

    is_at = .not. any(abs(a - b) > 0.0_wp)
  end function is_at

  !> Whether all coordinates are zero.
  pure logical function is_zero(q)
    real(wp), intent(in) :: q(:)   !< coordinates [rad, m]

    is_zero = .not. any(abs(q) > 0.0_wp)
  end function is_zero

  !> Move the independent coordinates from the drawn position to the start: as the drives lead, or, where a single angle cannot go
  !> there, the other way round. Whole turns are left out.
  subroutine follow(model, drawn, start, q, way)
    type(model_type), intent(in) :: model       !< the model
    real(wp), intent(in) :: drawn(:)            !< (M) the drawn position [rad, m]
    real(wp), intent(in) :: start(:)            !< (M) values of the independent coordinates at the start [rad, m]
    real(wp), intent(inout) :: q(:)             !< (M) gets the closed position at the start, if it was reached [rad, m]
    type(start_way_type), intent(out) :: way    !< how it was reached
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: distances(:), stopped(:)
    integer :: moving
    logical :: reached

    call make_plan(model%mechanism, model%problem%partition, drawn, plan, state, err)
    if (allocated(err)) return
    if (any(abs(state%q - drawn) > drawn_near_by*plan%unit_of)) return
    associate (independent => plan%independent, periods => plan%steps(plan%step_of(plan%independent))%period)
      distances = start(independent) - drawn(independent)
      where (periods > 0.0_wp) distances = distances - periods*aint(distances/merge(periods, 1.0_wp, periods > 0.0_wp))
      way%coordinates = pack(independent, abs(start(independent) - drawn(independent)) > 0.0_wp)
      call move_to(plan, state, distances, q, reached, stopped)
      way%interrupted = .not. reached
      way%stopped = pack(stopped, abs(start(independent) - drawn(independent)) > 0.0_wp)
      moving = maxloc(abs(distances), dim=1)
      if (.not. reached .and. count(abs(distances) > 0.0_wp) == 1 .and. periods(moving) > 0.0_wp) then
        distances(moving) = distances(moving) - sign(periods(moving), distances(moving))
        call move_to(plan, state, distances, q, way%turned_around, stopped)
      end if
      q(independent) = start(independent)
    end associate
  end subroutine follow

  !> Move the independent coordinates along a straight line, on the branch of a closed position.
  subroutine move_to(plan, state, distances, q, reached, stopped)
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< the closed position
    real(wp), intent(in) :: distances(:)                  !< (independent) how far they move [rad, m]
    real(wp), intent(inout) :: q(:)                       !< (M) gets the coordinates at the end, if it was reached [rad, m]
    logical, intent(out) :: reached                       !< the end was reached
    real(wp), allocatable, intent(out) :: stopped(:)      !< (independent) values where the motion stopped [rad, m]
    type(drive_slot_type), allocatable :: drives(:)
    type(driven_motion_type) :: driven
    type(error_type), allocatable :: err

    call straight_drives(plan%independent, state%q(plan%independent), distances, drives)
    call start_driven_motion(drives, plan, state, 0.0_wp, driven, err, derivatives=1)
    if (.not. allocated(err)) call advance(drives, plan, driven, 1.0_wp, err)
    reached = .not. allocated(err)
    stopped = driven%state%q(plan%independent)
    if (reached) q = driven%state%q
  end subroutine move_to
end module mech9_start_path
