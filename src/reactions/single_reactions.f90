!> Inverse dynamics of a single state: its plan is made for it alone.
module mech9_single_reactions
  use mech9_error, only: error_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: spread_all_accelerations
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  implicit none
  private
  public :: find_single_reactions

contains

  !> The wrenches of all pairs, and the forces that independent coordinates need. Fails as find_reactions does.
  subroutine find_single_reactions(mechanism, plan, state, reactions, err)
    type(mechanism_type), intent(in) :: mechanism                  !< the mechanism
    type(plan_type), intent(in) :: plan                            !< its plan, with all blocks
    type(state_type), intent(inout) :: state                       !< positions, rates and accelerations of coordinates, positions and
                                                                   !< rates of frames; these get their accelerations
    class(reactions_type), allocatable, intent(out) :: reactions   !< the wrenches
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed
    type(reaction_plan_type) :: reaction_plan

    call spread_all_accelerations(plan, state)
    call make_reaction_plan(mechanism, plan, reaction_plan)
    allocate (reactions, source=new_reactions(plan, reaction_plan))
    call find_reactions(mechanism, plan, reaction_plan, state, reactions, err)
  end subroutine find_single_reactions
end module mech9_single_reactions
