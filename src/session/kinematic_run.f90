!> The run of mech9k: following the drives from output to output.
module mech9_kinematic_run
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_requested, only: requested_by_results, leave_out
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance, set_inputs
  use mech9_columns, only: kinematic_columns
  use mech9_closure_guard, only: check_closure
  use mech9_recording, only: motion_source_type
  use mech9_geometry_text, only: explain_geometry
  implicit none
  private
  public :: kinematic_run_type, new_kinematic_run, assemble_start

  type, extends(motion_source_type) :: kinematic_run_type
    type(mechanism_type) :: mechanism
    type(plan_type) :: plan              !< of what serves them
    type(state_type) :: start            !< assembled
    type(driven_motion_type) :: driven
    logical :: started = .false.
  contains
    procedure :: row_at
  end type kinematic_run_type

contains

  !> Plan and assembled position at the start of the motion.
  subroutine assemble_start(mechanism, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(out) :: plan   !< the plan of the mechanism
    type(state_type), intent(out) :: state   !< position and motion of the mechanism
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), dimension(size(mechanism%pairs)) :: q, dq, ddq

    q = mechanism%initial_position
    call set_inputs(mechanism, mechanism%time%start, q, dq, ddq, err)
    if (allocated(err)) return
    call make_plan(mechanism, q, plan, state, err)
    call explain_geometry(mechanism, err)
    state%t = mechanism%time%start
  end subroutine assemble_start

  !> A run from an assembled start.
  subroutine new_kinematic_run(mechanism, plan, start, run, pictures)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: start
    type(kinematic_run_type), intent(out) :: run
    logical, intent(in), optional :: pictures      !< of the mechanism are wanted; not unless given

    run%program_name = 'mech9k'
    run%mechanism = mechanism
    run%plan = plan
    run%requested = requested_by_results(mechanism, pictures)
    call leave_out(run%plan, run%requested)
    run%start = start
    run%columns = kinematic_columns(mechanism)
    call run%columns%append('closure', 'm', 'largest error of a closed chain')
    if (mechanism%output%conditioning) &
      call run%columns%append('conditioning', '1', 'least singular value of the worst chains')
  end subroutine new_kinematic_run

  !> Position, velocity and acceleration at time t.
  subroutine row_at(self, t, row, err)
    class(kinematic_run_type), intent(inout) :: self   !< the kinematic run
    real(wp), intent(in) :: t
    real(wp), intent(inout) :: row(:)
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: next

    if (self%started) then
      call advance(self%mechanism, self%plan, self%driven, t, err)
    else
      call start_driven_motion(self%mechanism, self%plan, self%start, t, self%driven, err, self%requested%derivatives > 1)
      self%started = .true.
    end if
    if (.not. allocated(err)) call check_closure(self%plan, t, self%driven%closure, err)
    if (allocated(err)) return
    call self%columns%fill(self%mechanism, self%plan, self%driven%state, row)
    next = self%columns%motion + 1
    call self%columns%fill_poses(self%plan, self%driven%state, row)
    row(next) = self%driven%closure
    if (self%mechanism%output%conditioning) &
      call self%driven%conditioning%look(t, self%driven%work, row(next + 1))
    if (allocated(self%film)) call self%film%take(self%mechanism, self%plan, self%driven%state, row)
  end subroutine row_at
end module mech9_kinematic_run
