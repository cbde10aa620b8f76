!> Contacts of links that never move against each other, which are mistakes in the data.
!>
!> Such links are those whose pairs between them stand still: in chains without mobility, or by drives that do not move. A pair may stand
!> still at the start alone, as a follower does at its dead point, so that another position is judged, too.
module mech9_still_contacts
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_simulation_failures, only: failure_contact_still
  use mech9_tolerances, only: rank_tolerance
  use mech9_law, only: drive_slot_type, repetition_type, stands_still
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_tree_paths, only: mark_path
  use mech9_unit_rates, only: find_unit_rates
  use mech9_generic_position, only: generic_position_type, find_generic_position
  implicit none
  private
  public :: refuse_still_contacts

contains

  !> Fail where the links of a contact never move against each other.
  subroutine refuse_still_contacts(model, plan, start, err)
    type(model_type), intent(in) :: model               !< the model
    type(plan_type), intent(in) :: plan                 !< its plan
    type(state_type), intent(in) :: start               !< its closed position at the start
    type(error_type), allocatable, intent(out) :: err   !< allocated if there are such links
    type(generic_position_type) :: generic
    logical :: moves(plan%n_coordinates), found
    integer :: i

    if (.not. model%mechanism%has_contacts()) return
    call mark_moving(model%problem%drives, plan, start, moves)
    ! gaps of a mechanism that stands still altogether are those of one position
    if (.not. any(moves)) return
    i = first_still()
    if (i == 0 .or. size(plan%blocks) == 0) return
    call find_generic_position(plan, plan%blocks, start, generic, found)
    if (.not. found) return
    call mark_moving(model%problem%drives, plan, generic%state, moves)
    i = first_still()
    if (i == 0) return
    call raise(err, exit_data, failure_contact_still)
    err%failure%number = model%mechanism%contacts(i)%number
    err%place = model%mechanism%contacts(i)%place
  contains
    !> The place of the first contact between whose links no coordinate moves; 0: there is none.
    integer function first_still() result(first)
      logical :: paths(plan%n_coordinates, 2)
      integer :: end

      do first = 1, size(model%mechanism%contacts)
        paths = .false.
        do end = 1, 2
          call mark_path(plan%steps, plan%frame_of(model%mechanism%contacts(first)%links(end)), paths(:, end))
        end do
        ! steps on both paths lead to both links
        if (.not. any(moves(plan%steps%coordinate) .and. (paths(:, 1) .neqv. paths(:, 2)))) return
      end do
      first = 0
    end function first_still
  end subroutine refuse_still_contacts

  !> Mark the coordinates that move in a position, by free coordinates or by drives that do not stand still.
  subroutine mark_moving(drives, plan, state, moves)
    type(drive_slot_type), intent(in) :: drives(:)   !< the drives of the data file
    type(plan_type), intent(in) :: plan              !< the plan
    type(state_type), intent(in) :: state            !< a closed position
    logical, intent(out) :: moves(:)                 !< (M) the coordinate moves
    real(wp), allocatable :: rates(:, :)
    integer :: i

    call find_unit_rates(plan, state, rates)
    moves = .false.
    do i = 1, size(plan%independent)
      if (.not. stands(plan%independent(i))) moves = moves .or. abs(rates(:, i)) > rank_tolerance
    end do
  contains
    !> Whether a drive holds a coordinate at one value.
    logical function stands(coordinate)
      integer, intent(in) :: coordinate   !< its number
      type(repetition_type) :: repetition
      integer :: d

      stands = .false.
      do d = 1, size(drives)
        if (drives(d)%drive%coordinate /= coordinate) cycle
        repetition = drives(d)%drive%repetition()
        stands = repetition%kind == stands_still
      end do
    end function stands
  end subroutine mark_moving
end module mech9_still_contacts
