!> Closed positions near another one, at other values of the free coordinates and of the drives.
module mech9_nearby_position
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_assembly
  use mech9_law, only: drive_slot_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_branch_stepping, only: set_inputs
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance_driven => advance
  use mech9_straight_drives, only: straight_drives
  implicit none
  private
  public :: find_nearby_position

contains

  !> Find the coordinates of the position to which a closed one moves, on its branch, while the independent coordinates go on a straight
  !> line. Fails with exit_assembly where the chains do not close on the way, and as the laws of drives do.
  subroutine find_nearby_position(drives, plan, state, free, values, t, complaint, q, err)
    type(drive_slot_type), intent(in) :: drives(:)      !< those of the model
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    type(state_type), intent(in) :: state               !< the closed position
    integer, intent(in) :: free(:)                      !< (n) numbers of the free coordinates
    real(wp), intent(in) :: values(:)                   !< (n) which they shall have [rad, m]
    real(wp), intent(in) :: t                           !< time of the drives [s]
    character(len=*), intent(in) :: complaint           !< sentence of a failure where the chains do not close
    real(wp), intent(out) :: q(:)                       !< (M) coordinates of the position [rad, m]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(drive_slot_type), allocatable :: lines(:)
    class(driven_motion_type), allocatable :: driven
    real(wp), dimension(size(q)) :: dq, ddq

    allocate (driven)
    dq = 0.0_wp
    ddq = 0.0_wp
    q = state%q
    q(free) = values
    call set_inputs(drives, t, q, dq, ddq, err)
    if (allocated(err) .or. size(plan%closures) == 0) return
    associate (k => plan%independent)
      if (.not. any(abs(q(k) - state%q(k)) > 0.0_wp)) return
      call straight_drives(k, state%q(k), q(k) - state%q(k), lines)
      call start_driven_motion(lines, plan, state, 0.0_wp, driven, err, derivatives=1)
      if (.not. allocated(err)) call advance_driven(lines, plan, driven, 1.0_wp, err)
      if (allocated(err)) then
        call raise(err, exit_assembly, complaint)
        return
      end if
      driven%state%q(k) = q(k)
      q = driven%state%q
    end associate
  end subroutine find_nearby_position
end module mech9_nearby_position
