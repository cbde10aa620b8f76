!> The branch of a position of a design: chains closed nearby, and motions along the branch through the run or through a full turn.
module mech9_branch
  use mech9_kinds, only: wp, long, pi
  use mech9_error, only: error_type
  use mech9_plan, only: new_state
  use mech9_state, only: state_type
  use mech9_law, only: drive_slot_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_block_solver, only: new_block_work, block_work_type, newton_outcome_type, close_block
  use mech9_frame_motion, only: place_all
  use mech9_branch_stepping, only: set_inputs
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_design_space, only: design_type
  implicit none
  private
  public :: close_near, follow, follow_turn, turning_drives

contains

  !> Follow the branch of a position from one time to another; `came` is whether the motion comes there.
  subroutine follow(design, from, to, q, came)
    type(design_type), intent(in) :: design   !< placed
    real(wp), intent(in) :: from              !< time of the position [s]
    real(wp), intent(in) :: to                !< time to go to [s]
    real(wp), intent(inout) :: q(:)           !< (M) coordinates near the position, then those at the end [rad, m]
    logical, intent(out) :: came              !< the motion comes there
    type(driven_motion_type) :: driven
    type(state_type) :: state
    type(error_type), allocatable :: err

    state = new_state(design%plan)
    state%q = q
    call close_near(design, from, state, came)
    if (.not. came) return
    q = state%q
    if (.not. abs(to - from) > 0.0_wp) return
    call start_driven_motion(design%drives, design%plan, state, from, driven, err, derivatives=0)
    driven%stops_short = .true.
    if (.not. allocated(err)) call advance(design%drives, design%plan, driven, to, err)
    came = .not. allocated(err)
    if (came) q = driven%state%q
  end subroutine follow

  !> Follow the branch of a position while one driven angle turns fully and all other drives stand still; `came` is whether the
  !> motion comes to the end of the turn.
  subroutine follow_turn(design, q, coordinate, came, work)
    type(design_type), intent(in) :: design       !< placed
    real(wp), intent(in) :: q(:)                  !< (M) coordinates of the position, closed [rad, m]
    integer, intent(in) :: coordinate             !< the driven angle
    logical, intent(out) :: came                  !< it can turn fully
    integer(long), intent(inout) :: work          !< grows by the number of steps
    type(drive_slot_type), allocatable :: drives(:)
    type(driven_motion_type) :: driven
    type(state_type) :: state
    type(error_type), allocatable :: err

    call turning_drives(design, q, coordinate, drives)
    state = new_state(design%plan)
    state%q = q
    call set_inputs(drives, 0.0_wp, state%q, state%dq, state%ddq, err)
    if (.not. allocated(err)) call place_all(design%plan, state, err)
    if (.not. allocated(err)) call start_driven_motion(drives, design%plan, state, 0.0_wp, driven, err, derivatives=0)
    driven%stops_short = .true.
    if (.not. allocated(err)) call advance(drives, design%plan, driven, 2.0_wp*pi, err)
    came = .not. allocated(err)
    work = work + driven%steps + driven%halvings
  end subroutine follow_turn

  !> Drives that turn one driven angle at a rate of 1 rad/s from a position on, while all others stand still.
  subroutine turning_drives(design, q, coordinate, drives)
    type(design_type), intent(in) :: design                        !< any of the designs
    real(wp), intent(in) :: q(:)                                   !< (M) coordinates of the position [rad, m]
    integer, intent(in) :: coordinate                              !< the driven angle
    type(drive_slot_type), allocatable, intent(out) :: drives(:)   !< in the order of those of the design
    type(polynomial_law_type) :: turning
    integer :: i

    allocate (drives(size(design%drives)))
    do i = 1, size(drives)
      turning%coordinate = design%drives(i)%drive%coordinate
      turning%coefficients = [q(turning%coordinate), 0.0_wp]
      if (turning%coordinate == coordinate) turning%coefficients(2) = 1.0_wp
      allocate (drives(i)%drive, source=turning)
    end do
  end subroutine turning_drives

  !> Close all chains near the coordinates in the state by Newton's method.
  subroutine close_near(design, t, state, closed)
    type(design_type), intent(in) :: design       !< placed
    real(wp), intent(in) :: t                     !< time [s]
    type(state_type), intent(inout) :: state      !< with coordinates nearby; closed
    logical, intent(out) :: closed                !< whether it converged
    type(block_work_type) :: work
    type(newton_outcome_type) :: newton
    type(error_type), allocatable :: err
    integer :: b

    state%t = t
    closed = .false.
    call set_inputs(design%drives, t, state%q, state%dq, state%ddq, err)
    if (.not. allocated(err)) call place_all(design%plan, state, err)
    if (allocated(err)) return
    do b = 1, size(design%plan%blocks)
      work = new_block_work(design%plan%blocks(b), design%plan)
      call close_block(design%plan, design%plan%blocks(b), state, work, newton, err)
      if (allocated(err) .or. .not. newton%converged) return
    end do
    closed = .true.
  end subroutine close_near
end module mech9_branch
