!> The motion of a mechanism at one instant, on a plan in space in the coordinates of the data file, as exact derivatives need it.
module mech9_motion_in_space
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_tolerances, only: singular_conditioning
  use mech9_simulation_failures, only: failure_singular_start_block
  use mech9_mechanism, only: mechanism_type
  use mech9_partition, only: partition_type, dependent_coordinate, driven_coordinate
  use mech9_problem, only: problem_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_held_angles, only: held_angles_type
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_linearisation, only: linearisation_type
  implicit none
  private
  public :: partition_with_angles, place_in_space, refuse_singular_chains

contains

  !> The partition of the data file with the angles of idle rods that a motion holds at present, which need not be those of its start.
  pure subroutine partition_with_angles(problem, angles, partition)
    type(problem_type), intent(in) :: problem            !< with the partition at the start
    type(held_angles_type), intent(in) :: angles         !< of the motion
    type(partition_type), intent(out) :: partition       !< the partition
    logical :: has_drive(size(problem%partition%kind))
    integer :: i

    partition = problem%partition
    if (.not. allocated(angles%rods)) return
    has_drive = problem%has_drive()
    do i = 1, size(angles%rods)
      associate (rod => angles%rods(i))
        if (rod%is_free .or. rod%held == 0) cycle
        associate (numbers => [rod%coordinates])
          where (partition%kind(numbers) == driven_coordinate .and. .not. has_drive(numbers)) &
            partition%kind(numbers) = dependent_coordinate
        end associate
        partition%kind(rod%held) = driven_coordinate
      end associate
    end do
  end subroutine partition_with_angles

  !> Make a plan in space and place a motion on it: its time, the motion of the independent coordinates, and the states of motors, stops,
  !> frictions and contacts. The rates and accelerations of dependent coordinates are left to who finds the forces. Fails as make_plan.
  subroutine place_in_space(mechanism, partition, q, motion, plan, state, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< driven, free and dependent coordinates
    real(wp), intent(in) :: q(:)                        !< (M) closed position [rad, m]
    type(state_type), intent(in) :: motion              !< the motion in this position, on any plan
    type(plan_type), intent(out) :: plan                !< in space
    type(state_type), intent(out) :: state              !< the motion on it
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(planning_settings_type) :: settings

    settings%in_space = .true.
    call make_plan(mechanism, partition, q, plan, state, err, settings)
    if (allocated(err)) return
    state%t = motion%t
    state%dq(plan%independent) = motion%dq(plan%independent)
    state%ddq(plan%independent) = motion%ddq(plan%independent)
    if (allocated(motion%motor)) state%motor = motion%motor
    if (allocated(motion%motor_rate)) state%motor_rate = motion%motor_rate
    if (allocated(motion%limited)) state%limited = motion%limited
    if (allocated(motion%stop_force)) state%stop_force = motion%stop_force
    if (allocated(motion%pressed)) state%pressed = motion%pressed
    if (allocated(motion%friction)) state%friction = motion%friction
    if (allocated(motion%contact_force)) state%contact_force = motion%contact_force
  end subroutine place_in_space

  !> Fail where closed chains stand in a singular position: dependent coordinates have no derivatives there.
  subroutine refuse_singular_chains(plan, state, linearisation, err)
    type(plan_type), intent(in) :: plan                          !< the plan, in space
    type(state_type), intent(in) :: state                        !< the motion
    type(linearisation_type), intent(inout) :: linearisation     !< with the factors of the chains
    type(error_type), allocatable, intent(out) :: err            !< allocated if one does
    integer :: b

    do b = 1, size(plan%blocks)
      if (plan%blocks(b)%equations == 0) cycle
      if (linearisation%motion%blocks(b)%equations%conditioning() >= singular_conditioning) cycle
      call raise(err, exit_singular, failure_singular_start_block)
      err%failure%t = state%t
      err%failure%chains = plan%blocks(b)%chains
      err%failure%coordinates = plan%blocks(b)%coordinates
      return
    end do
  end subroutine refuse_singular_chains
end module mech9_motion_in_space
