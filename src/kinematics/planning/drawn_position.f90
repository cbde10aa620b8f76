!> Whether the chains of a mechanism close at given coordinates, without a search.
module mech9_drawn_position
  use mech9_kinds, only: wp
  use mech9_planning_tolerances, only: drawn_gap
  use mech9_error, only: error_type
  use mech9_partition, only: partition_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, new_state
  use mech9_state, only: state_type
  use mech9_spanning_tree, only: lay_out_frames
  use mech9_arithmetics, only: set_in_space
  use mech9_frame_motion, only: place_frames
  use mech9_generic_position, only: free_block
  implicit none
  private
  public :: is_drawn_closed

contains

  !> Whether all chains and couplings close at given values of all coordinates, but for errors of points with few digits. False
  !> where there are no chains, or where a user's pair has no pose.
  logical function is_drawn_closed(mechanism, partition, q, known) result(closed)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(partition_type), intent(in) :: partition   !< driven, free and dependent coordinates
    real(wp), intent(in) :: q(:)                    !< (M) values of all coordinates [rad, m]
    type(plan_type), intent(in), optional :: known  !< the plan of the mechanism, where it is known
    type(plan_type) :: plan

    if (present(known)) then
      closed = is_closed_at(known, q)
    else
      call lay_out_frames(mechanism, partition, q, plan)
      call set_in_space(plan)
      closed = is_closed_at(plan, q)
    end if
  end function is_drawn_closed

  !> Whether all constraints of a plan hold at given values of all coordinates.
  logical function is_closed_at(plan, q) result(closed)
    type(plan_type), intent(in) :: plan             !< the plan
    real(wp), intent(in) :: q(:)                    !< (M) the values [rad, m]
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: c

    state = new_state(plan)
    state%q = q
    call place_frames(plan, free_block(plan, plan%n_coordinates, size(plan%closures)), state, err)
    closed = size(plan%closures) > 0 .and. .not. allocated(err)
    do c = 1, size(plan%closures)
      if (.not. closed) return
      closed = plan%constraints(c)%item%gap(plan, state) <= drawn_gap*plan%length
    end do
  end function is_closed_at
end module mech9_drawn_position
