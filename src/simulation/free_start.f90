!> The start of a free motion: the closed position, and the rates of the independent coordinates.
module mech9_free_start
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_data, exit_singular
  use mech9_simulation_failures, only: failure_no_initial_position
  use mech9_partition, only: free_coordinate
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_start_path, only: start_way_type, assemble_start
  use mech9_branch_stepping, only: set_inputs
  use mech9_motion_coefficients, only: find_coefficients
  implicit none
  private
  public :: assemble_free, keep_coefficients

contains

  !> The plan, and the closed position at the start: positions and rates of the free coordinates as given, those of driven ones by
  !> their drives. Free coordinates at rest need no velocity.
  subroutine assemble_free(model, plan, state, err, way)
    type(model_type), intent(in) :: model           !< the model
    type(plan_type), intent(out) :: plan                !< the plan of the mechanism
    type(state_type), intent(out) :: state              !< the closed position, with the rates of independent coordinates
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(start_way_type), intent(out), optional :: way  !< how the start was reached from the drawn position
    real(wp), dimension(size(model%mechanism%pairs)) :: q, dq, ddq
    integer :: k

    do k = 1, size(model%mechanism%pairs)
      if (model%problem%initial%position_given(k) .or. model%problem%partition%kind(k) /= free_coordinate) cycle
      call raise(err, exit_data, failure_no_initial_position)
      err%failure%coordinates = [k]
      call add_place(err, place=model%mechanism%pairs(k)%pair%place)
      return
    end do
    q = model%problem%initial%position
    call set_inputs(model%problem%drives, model%request%time%start, q, dq, ddq, err)
    if (.not. allocated(err)) call assemble_start(model, q, plan, state, err, way)
    if (allocated(err)) return
    state%t = model%request%time%start
    state%dq(plan%free) = model%problem%initial%velocity(plan%free)
    call set_inputs(model%problem%drives, state%t, state%q, state%dq, state%ddq, err)
  end subroutine assemble_free
  !> Keep the coefficients of motion in the angles of the data file. In closed chains those may be singular at the start: then the ones
  !> of the integrated motion remain.
  subroutine keep_coefficients(model, plan, assembled, coefficients, err)
    type(model_type), intent(in) :: model                       !< the model
    type(plan_type), intent(in) :: plan                         !< with the angles of the data file
    type(state_type), intent(in) :: assembled                   !< its closed position
    real(wp), allocatable, intent(inout) :: coefficients(:, :)  !< of the integrated motion; lower triangle
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    real(wp), allocatable :: found(:, :)

    call find_coefficients(model%mechanism, plan, assembled, found, err)
    if (.not. allocated(err)) then
      call move_alloc(found, coefficients)
    else if (size(plan%closures) > 0 .and. err%code == exit_singular) then
      deallocate (err)
    end if
  end subroutine keep_coefficients
end module mech9_free_start
