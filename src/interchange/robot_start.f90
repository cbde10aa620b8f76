!> A start for imported closed chains: a closed position, and independent coordinates that determine all others.
module mech9_robot_start
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_structure
  use mech9_assembly_failures, only: failure_wrong_choice
  use mech9_explanation, only: explain
  use mech9_partition, only: partition_type, new_partition
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_mobility_report, only: mobility_report_type, report_mobility
  implicit none
  private
  public :: find_start

contains

  !> Choose as many independent coordinates as there are freedoms, the preferred ones as far as they are independent of each other,
  !> and close all chains. The independent coordinates keep their values where the chains close for these.
  subroutine find_start(mechanism, preferred, q, independent, moved, err)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    logical, intent(in) :: preferred(:)                !< (M) the coordinate should be independent
    real(wp), intent(inout) :: q(:)                    !< (M) guesses, then coordinates of a closed position [rad, m]
    logical, intent(out) :: independent(:)             !< (M) the coordinate is independent
    logical, intent(out) :: moved                      !< the guesses led to a singular position, and the start lies beside it
    type(error_type), allocatable, intent(out) :: err  !< allocated if the chains do not close, or cannot move
    logical :: others(size(q))

    moved = .false.
    call choose(mechanism, preferred, q, independent, err)
    if (allocated(err)) then
      if (err%code == exit_structure) return
      ! other values of the independent coordinates may close the chains
      independent = .false.
      call try_choice(mechanism, q, independent, others, err)
      if (.not. allocated(err)) call choose(mechanism, preferred, q, independent, err)
    end if
    if (.not. allocated(err)) call leave_singularity(mechanism, q, independent, moved)
  end subroutine find_start

  !> Many robots are straight where their coordinates are zero, and chains that are straight may go on in several ways. The start
  !> then goes a little to the side.
  subroutine leave_singularity(mechanism, q, independent, moved)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    real(wp), intent(inout) :: q(:)                 !< (M) coordinates of a closed position [rad, m]
    logical, intent(inout) :: independent(:)        !< (M) the coordinate is independent
    logical, intent(out) :: moved                   !< the position has changed
    real(wp), parameter :: amounts(4) = [0.3_wp, -0.3_wp, 0.1_wp, -0.1_wp]
    type(error_type), allocatable :: err
    real(wp) :: trial(size(q)), units(size(q))
    logical :: chosen(size(q)), is_singular
    integer :: i

    moved = .false.
    call judge_position(mechanism, q, independent, is_singular, units)
    if (.not. is_singular) return
    do i = 1, size(amounts)
      trial = q
      where (independent) trial = q + amounts(i)*units
      call choose(mechanism, independent, trial, chosen, err)
      if (allocated(err)) cycle
      call judge_position(mechanism, trial, chosen, is_singular)
      if (is_singular) cycle
      q = trial
      independent = chosen
      moved = .true.
      return
    end do
  end subroutine leave_singularity

  !> Whether fewer equations are independent in a closed position than in general ones near it.
  subroutine judge_position(mechanism, q, independent, is_singular, units)
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    real(wp), intent(in) :: q(:)                     !< (M) coordinates of a closed position [rad, m]
    logical, intent(in) :: independent(:)            !< (M) the coordinate is independent
    logical, intent(out) :: is_singular              !< they are fewer
    real(wp), intent(out), optional :: units(:)      !< (M) unit of each coordinate on a closed chain, else 0 [rad, m]
    type(partition_type) :: partition
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: state
    type(mobility_report_type) :: report
    type(error_type), allocatable :: err

    allocate (plan, state)
    is_singular = .false.
    if (present(units)) units = 0.0_wp
    call new_partition(mechanism%structure, independent, partition)
    call make_plan(mechanism, partition, q, plan, state, err)
    if (allocated(err)) return
    call report_mobility(mechanism, plan, state, report)
    is_singular = any(report%at_start < report%ranks)
    if (present(units)) units = merge(plan%unit_of, 0.0_wp, report%dimensions > 0)
  end subroutine judge_position

  !> Choose the independent coordinates and close all chains for their values.
  subroutine choose(mechanism, preferred, q, independent, err)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    logical, intent(in) :: preferred(:)                !< (M) the coordinate should be independent
    real(wp), intent(inout) :: q(:)                    !< (M) guesses, then coordinates of a closed position [rad, m]
    logical, intent(out) :: independent(:)             !< (M) the coordinate is independent
    type(error_type), allocatable, intent(out) :: err  !< allocated if the chains do not close, or cannot move
    logical :: others(size(q))
    integer :: trial

    independent = preferred
    do trial = 1, 3
      call try_choice(mechanism, q, independent, others, err)
      if (allocated(err)) return
      if (all(others .eqv. independent)) return
      independent = others
    end do
    call raise(err, exit_structure, 'no independent coordinates were found for the closed chains')
  end subroutine choose

  !> Assemble the mechanism with these independent coordinates. Where they cannot serve, `others` can; else the two are the same.
  !> Without independent coordinates all coordinates may change.
  subroutine try_choice(mechanism, q, independent, others, err)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    real(wp), intent(inout) :: q(:)                    !< (M) guesses, then coordinates of a closed position [rad, m]
    logical, intent(in) :: independent(:)              !< (M) the coordinate is independent
    logical, intent(out) :: others(:)                  !< (M) the coordinate should be independent
    type(error_type), allocatable, intent(out) :: err  !< allocated if the chains do not close, or cannot move
    type(partition_type) :: partition
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: state
    logical :: is_wrong_choice

    allocate (plan, state)
    others = independent
    call new_partition(mechanism%structure, independent, partition)
    call make_plan(mechanism, partition, q, plan, state, err)
    is_wrong_choice = .false.
    if (allocated(err)) then
      if (allocated(err%failure)) is_wrong_choice = err%failure%kind == failure_wrong_choice
      if (is_wrong_choice) is_wrong_choice = size(err%failure%others) > 0
      if (.not. is_wrong_choice) then
        call explain(err)
        return
      end if
      others = .false.
      others(err%failure%others) = .true.
      deallocate (err)
    end if
    if (.not. (is_wrong_choice .and. any(independent))) q = state%q
  end subroutine try_choice
end module mech9_robot_start
