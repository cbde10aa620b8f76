!> A start for imported closed chains: a closed position, and independent coordinates that determine all others.
module mech9_robot_start
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_structure
  use mech9_failure, only: failure_wrong_choice
  use mech9_explanation, only: explain
  use mech9_partition, only: partition_type, new_partition
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  implicit none
  private
  public :: find_start

contains

  !> Choose as many independent coordinates as there are freedoms, the preferred ones as far as they are independent of each other,
  !> and close all chains. The independent coordinates keep their values where the chains close for these.
  subroutine find_start(mechanism, preferred, q, independent, err)
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    logical, intent(in) :: preferred(:)                !< (M) the coordinate should be independent
    real(wp), intent(inout) :: q(:)                    !< (M) guesses, then coordinates of a closed position [rad, m]
    logical, intent(out) :: independent(:)             !< (M) the coordinate is independent
    type(error_type), allocatable, intent(out) :: err  !< allocated if the chains do not close, or cannot move
    logical :: others(size(q))

    call choose(mechanism, preferred, q, independent, err)
    if (.not. allocated(err)) return
    if (err%code == exit_structure) return
    ! other values of the independent coordinates may close the chains
    independent = .false.
    call try_choice(mechanism, q, independent, others, err)
    if (.not. allocated(err)) call choose(mechanism, preferred, q, independent, err)
  end subroutine find_start

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
    type(plan_type) :: plan
    type(state_type) :: state
    logical :: is_wrong_choice

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
