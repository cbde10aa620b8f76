!> A mechanism whose free coordinates are at rest while its driven ones have the motion of the start: the forces that keep it in
!> its position, their stiffness, and motions to other positions on the same branch.
module mech9_resting_mechanism
  use mech9_kinds, only: wp
  use mech9_integration_tolerances, only: worthwhile_improvement
  use mech9_simulation_tolerances, only: doubtful_conditioning
  use mech9_error, only: error_type, exit_integrator
  use mech9_mechanism, only: mechanism_type
  use mech9_partition, only: partition_type, free_coordinate, driven_coordinate
  use mech9_law, only: drive_slot_type
  use mech9_straight_drives, only: straight_drives
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type, copy_state
  use mech9_resting_plan, only: plan_by_geometry
  use mech9_motion_in_space, only: refuse_singular_chains
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_linearisation, only: linearisation_type, new_linearisation, find_forces, find_matrix, by_position
  use mech9_clusters, only: clusters_type, find_clusters
  use mech9_coordinate_choice, only: best_independent
  implicit none
  private
  public :: resting_type, put_to_rest, find_stiffness, try_step, choose_coordinates, return_to_coordinates, refuse_singular, &
    is_balanced, is_zero_force, stand_at, copy_resting, move_along

  !> A mechanism at rest. Forces and stiffnesses of the free coordinates count in units of the plan (rad, or lengths of the
  !> mechanism), so that all are energies.
  type :: resting_type
    type(partition_type) :: partition             !< driven, free and dependent coordinates
    class(plan_type), allocatable :: plan         !< in space
    class(state_type), allocatable :: state       !< its position; the free coordinates are at rest
    class(linearisation_type), allocatable :: linearisation   !< at this position
    integer, allocatable :: free(:)               !< (n) numbers of the free coordinates, ascending
    real(wp), allocatable :: forces(:)            !< (n) that keep the mechanism in its position; zero in equilibrium [J]
    real(wp), allocatable :: stiffness(:, :)      !< (n,n) their derivatives by the free coordinates [J]
    integer, allocatable :: following(:)          !< (h) coordinates that closed contacts let follow; not allocated: none
    real(wp), allocatable :: follow(:, :)         !< (h,n) their rates by those of the free coordinates [rad, m]
    real(wp) :: stiffness_magnitude = 0.0_wp      !< sum of the magnitudes of the terms of the stiffness [J]
  end type resting_type

  !> Forces below this part of the sum of all magnitudes are zero: round-off of some hundred terms times the conditioning of
  !> closed chains.
  real(wp), parameter :: zero_force = 1.0e-11_wp
  !> Forces below this part of the stiffness are zero: the round-off of a coordinate, about 32 units in the last place, changes
  !> the force of a spring by as much, also where the parts of this force cancel each other.
  real(wp), parameter :: round_off_of_position = 32.0_wp*epsilon(1.0_wp)
  !> Other independent coordinates keep the position to this, in units of the coordinates.
  real(wp), parameter :: same_position = 1.0e-6_wp

contains

  !> Put a mechanism to rest in an assembled position: the free coordinates and all that depends on them only. Fails where a load
  !> does.
  subroutine put_to_rest(mechanism, partition, plan, assembled, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< driven, free and dependent coordinates
    type(plan_type), intent(in) :: plan                 !< its plan, in space
    type(state_type), intent(in) :: assembled           !< closed, with rates and accelerations of the driven coordinates
    type(resting_type), intent(out) :: resting          !< the mechanism at rest
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    resting%partition = partition
    allocate (resting%state, resting%linearisation)
    allocate (resting%plan, source=plan)
    resting%free = pack(plan%independent, partition%kind(plan%independent) == free_coordinate)
    allocate (resting%forces(size(resting%free)), resting%stiffness(size(resting%free), size(resting%free)), source=0.0_wp)
    call new_linearisation(mechanism, plan, resting%linearisation)
    call stand_at(mechanism, assembled, resting, err)
  end subroutine put_to_rest

  !> Copy a mechanism at rest. The assignment stands here alone, because compilers write it out for all components.
  subroutine copy_resting(from, to)
    type(resting_type), intent(in) :: from      !< the mechanism at rest
    type(resting_type), intent(inout) :: to     !< the same afterwards

    to = from
  end subroutine copy_resting

  !> Put the mechanism to rest in another closed position of the same plan.
  subroutine stand_at(mechanism, position, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(state_type), intent(in) :: position            !< closed, with rates and accelerations of the driven coordinates
    type(resting_type), intent(inout) :: resting        !< stands there afterwards
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed

    call copy_state(position, resting%state)
    resting%state%dq(resting%free) = 0.0_wp
    resting%state%ddq(resting%free) = 0.0_wp
    call find_forces(mechanism, resting%plan, resting%state, resting%linearisation, err)
    if (allocated(err)) return
    resting%forces = resting%linearisation%forces(resting%free)*resting%plan%unit_of(resting%free)
  end subroutine stand_at

  !> Whether the forces are zero beyond round-off.
  pure logical function is_balanced(resting)
    type(resting_type), intent(in) :: resting   !< the mechanism at rest

    is_balanced = all(is_zero_force(resting, resting%forces))
  end function is_balanced

  !> Whether a force is zero beyond round-off, with the stiffness that was found last.
  elemental logical function is_zero_force(resting, force)
    type(resting_type), intent(in) :: resting   !< the mechanism at rest
    real(wp), intent(in) :: force               !< in units of the plan [J]

    is_zero_force = abs(force) <= max(zero_force*resting%linearisation%tree%magnitude, &
                                      round_off_of_position*resting%stiffness_magnitude)
  end function is_zero_force

  !> Find the stiffness. Fails where a load does.
  subroutine find_stiffness(mechanism, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< gets its stiffness
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed

    call find_matrix(mechanism, resting%plan, resting%state, by_position, resting%free, resting%linearisation, &
                     resting%stiffness, resting%stiffness_magnitude, err)
  end subroutine find_stiffness

  !> The mechanism after a step of its free coordinates, on the same branch: it is moved there as by drives. `moved` is false
  !> where it cannot go so far, or where a load has no value.
  subroutine try_step(mechanism, resting, step, other, moved, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(in) :: resting           !< the mechanism at rest
    real(wp), intent(in) :: step(:)                     !< (n) of the free coordinates, in their units
    type(resting_type), intent(inout) :: other          !< the mechanism at rest in the other position
    logical, intent(out) :: moved                       !< it can go there
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    type(drive_slot_type), allocatable :: drives(:)
    class(driven_motion_type), allocatable :: driven
    class(state_type), allocatable :: position
    type(error_type), allocatable :: failure

    allocate (driven, position)
    call drive_step(resting, step, drives)
    call start_driven_motion(drives, resting%plan, resting%state, 0.0_wp, driven, failure, derivatives=1)
    if (.not. allocated(failure)) call advance(drives, resting%plan, driven, 1.0_wp, failure)
    moved = .not. allocated(failure)
    if (.not. moved) return
    call copy_state(driven%state, position)
    position%t = resting%state%t
    position%dq(resting%plan%independent) = resting%state%dq(resting%plan%independent)
    position%ddq(resting%plan%independent) = resting%state%ddq(resting%plan%independent)
    call copy_resting(resting, other)
    call stand_at(mechanism, position, other, err)
    if (.not. allocated(err)) return
    ! beyond the end of a table over a coordinate a load has no value; a shorter step may not reach it
    moved = err%code /= exit_integrator
    if (.not. moved) deallocate (err)
  end subroutine try_step

  !> The changes of independent coordinates with one free coordinate: closed contacts let others follow.
  pure subroutine move_along(resting, i, changes)
    type(resting_type), intent(in) :: resting       !< the mechanism at rest
    integer, intent(in) :: i                        !< place of the free coordinate
    real(wp), intent(inout) :: changes(:)           !< (M) gets them per unit of it [rad, m]; others stay

    changes(resting%free(i)) = 1.0_wp
    if (allocated(resting%follow)) changes(resting%following) = resting%follow(:, i)
  end subroutine move_along

  !> Drives that move the free coordinates by a step within 1 s and hold the others, but for those that follow.
  subroutine drive_step(resting, step, drives)
    type(resting_type), intent(in) :: resting                      !< the mechanism at rest
    real(wp), intent(in) :: step(:)                                !< (n) of the free coordinates, in their units
    type(drive_slot_type), allocatable, intent(out) :: drives(:)   !< of all independent coordinates
    real(wp) :: distances(resting%plan%n_coordinates)

    distances = 0.0_wp
    distances(resting%free) = step*resting%plan%unit_of(resting%free)
    if (allocated(resting%follow)) distances(resting%following) = matmul(resting%follow, distances(resting%free))
    associate (independent => resting%plan%independent)
      call straight_drives(independent, resting%state%q(independent), distances(independent), drives)
    end associate
  end subroutine drive_step

  !> The least conditioning of any block.
  real(wp) function conditioning_of(resting) result(conditioning)
    type(resting_type), intent(inout) :: resting   !< the mechanism at rest
    integer :: b

    conditioning = 1.0_wp
    do b = 1, size(resting%plan%blocks)
      if (resting%plan%blocks(b)%equations == 0) cycle
      conditioning = min(conditioning, resting%linearisation%motion%blocks(b)%equations%conditioning())
    end do
  end function conditioning_of

  !> Fail with exit_singular where a block is in a singular position: branches meet there, and motions differ between them.
  subroutine refuse_singular(resting, err)
    type(resting_type), intent(inout) :: resting        !< the mechanism at rest, in the best coordinates
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is one

    call refuse_singular_chains(resting%plan, resting%state, resting%linearisation, err)
  end subroutine refuse_singular

  !> Take other free coordinates near a singular position of the present ones. Driven coordinates stay driven, and the free ones
  !> beside a moving drive stay free: other ones at rest would be another motion. Nothing is changed where others do not serve
  !> clearly better.
  subroutine choose_coordinates(mechanism, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(resting_type), intent(inout) :: resting        !< the mechanism at rest
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    logical :: independent(resting%plan%n_coordinates)
    real(wp) :: present_conditioning

    present_conditioning = conditioning_of(resting)
    if (present_conditioning > doubtful_conditioning) return
    call best_independent(resting%plan, resting%state, independent)
    call keep_beside_moving_drives(resting, independent)
    if (all(independent .eqv. resting%partition%independent())) return
    if (.not. all(independent .or. resting%partition%kind /= driven_coordinate)) return
    call take_coordinates(mechanism, independent, worthwhile_improvement*present_conditioning, resting, err)
  end subroutine choose_coordinates

  !> Keep the independent coordinates of the chains that a drive moves. In other chains all coordinates rest where the free ones do,
  !> whichever these are.
  pure subroutine keep_beside_moving_drives(resting, independent)
    type(resting_type), intent(in) :: resting       !< the mechanism at rest
    logical, intent(inout) :: independent(:)        !< (M) the coordinate is to be independent
    type(clusters_type) :: clusters
    logical :: present(size(independent)), kept(size(independent))
    integer :: k

    clusters = find_clusters(resting%plan)
    kept = .false.
    do k = 1, size(independent)
      if (resting%partition%kind(k) /= driven_coordinate) cycle
      if (.not. max(abs(resting%state%dq(k)), abs(resting%state%ddq(k))) > 0.0_wp) cycle
      kept = kept .or. clusters%of_step(resting%plan%step_of) == clusters%of_step(resting%plan%step_of(k))
    end do
    present = resting%partition%independent()
    where (kept) independent = present
  end subroutine keep_beside_moving_drives

  !> Take the free coordinates of a partition again, where these are not singular in the present position.
  subroutine return_to_coordinates(mechanism, partition, least, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(partition_type), intent(in) :: partition       !< with the coordinates to return to
    real(wp), intent(in) :: least                       !< least conditioning at which they are taken
    type(resting_type), intent(inout) :: resting        !< the mechanism at rest
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed

    if (all(partition%kind == resting%partition%kind)) return
    call take_coordinates(mechanism, partition%independent(), least, resting, err)
  end subroutine return_to_coordinates

  !> Take other independent coordinates in the same position, unless their conditioning is too small.
  subroutine take_coordinates(mechanism, independent, least, resting, err)
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    logical, intent(in) :: independent(:)               !< (M) the coordinate is to be independent
    real(wp), intent(in) :: least                       !< least conditioning at which they are taken
    type(resting_type), intent(inout) :: resting        !< the mechanism at rest
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    type(resting_type) :: other
    type(partition_type) :: partition
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: position
    type(error_type), allocatable :: failure

    allocate (plan, position)
    call resting%partition%with_independent(mechanism%structure, independent, partition)
    call plan_by_geometry(mechanism, partition, resting%plan, resting%state%q, plan, position, failure)
    if (allocated(failure)) return
    if (any(abs(position%q - resting%state%q) > same_position*plan%unit_of)) return
    position%t = resting%state%t
    where (partition%kind == driven_coordinate)
      position%dq = resting%state%dq
      position%ddq = resting%state%ddq
    end where
    call put_to_rest(mechanism, partition, plan, position, other, err)
    if (allocated(err)) return
    if (conditioning_of(other) > least) call copy_resting(other, resting)
  end subroutine take_coordinates
end module mech9_resting_mechanism
