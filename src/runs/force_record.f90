!> The forces that a run records: of drives and in pairs, from the present state of its simulation.
module mech9_force_record
  use mech9_error, only: error_type
  use mech9_masks, only: numbers_of
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_simulation, only: simulation_type
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan, is_made_for
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  use mech9_uniqueness, only: uniqueness_type, find_unique
  use mech9_columns, only: columns_type
  implicit none
  private
  public :: force_record_type, reacting_pairs

  type :: force_record_type
    logical :: wanted = .false.              !< forces are recorded
    type(uniqueness_type), allocatable :: unique   !< of forces; not allocated: no reactions are recorded
    class(reactions_type), allocatable :: reactions        !< of the present state
    type(reaction_plan_type), private :: plan
    integer, private :: plans = -1           !< plans of the simulation before the one for which the plan was made; -1: there is none
  contains
    procedure :: begin
    procedure :: judge
    procedure :: find
  end type force_record_type

contains

  !> The pairs whose wrenches are recorded. The first coordinate of a joint with several freedoms stands for it.
  pure function reacting_pairs(model) result(reacting)
    type(model_type), intent(in) :: model     !< the model
    logical :: reacting(size(model%mechanism%pairs))

    reacting = model%request%output%reacting(size(reacting)) .and. model%mechanism%structure%stands_alone()
  end function reacting_pairs

  !> Add the columns of the forces that the request names.
  subroutine begin(self, model, columns)
    class(force_record_type), intent(out) :: self    !< the record
    type(model_type), intent(in) :: model            !< the model
    type(columns_type), intent(inout) :: columns     !< those of coordinates and points; gets those of forces
    logical :: driven(size(model%mechanism%pairs))

    allocate (self%reactions)
    associate (output => model%request%output)
      self%wanted = output%with_forces()
      if (.not. self%wanted) return
      driven = output%drive_forces .and. model%problem%has_drive()
      call columns%append_forces(model%mechanism, numbers_of(driven), numbers_of(reacting_pairs(model)))
    end associate
  end subroutine begin

  !> Find which components of the wrenches are unique, if any are recorded.
  subroutine judge(self, model, plan, start)
    class(force_record_type), intent(inout) :: self   !< the record; gets `unique`
    type(model_type), intent(in) :: model             !< the model
    type(plan_type), intent(in) :: plan               !< its plan, with all blocks
    type(state_type), intent(in) :: start             !< its assembled position
    type(reaction_plan_type) :: reactions
    integer :: j

    if (.not. model%request%output%reactions) return
    call make_reaction_plan(model%mechanism, plan, reactions)
    allocate (self%unique)
    call find_unique(plan, reactions, start, self%unique)
    associate (structure => model%mechanism%structure)
      if (.not. allocated(structure%joints)) return
      do j = 1, size(structure%joints)
        associate (numbers => structure%joints(j)%coordinates())
          self%unique%pairs(:, numbers(1)) = self%unique%pairs(:, numbers(size(numbers)))
        end associate
      end do
    end associate
  end subroutine judge

  !> The forces in the present state of a simulation. The plan of inverse dynamics is made anew after a change of coordinates.
  subroutine find(self, simulation, plan, state, err)
    class(force_record_type), intent(inout) :: self     !< the record; gets the forces
    class(simulation_type), intent(in) :: simulation    !< the motion
    type(plan_type), intent(in) :: plan                 !< its present plan
    type(state_type), intent(in) :: state               !< its present state
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (self%plans /= simulation%plans() .or. .not. is_made_for(self%plan, plan)) then
      call make_reaction_plan(simulation%model%mechanism, plan, self%plan)
      deallocate (self%reactions)
      allocate (self%reactions, source=new_reactions(plan, self%plan))
      self%plans = simulation%plans()
    end if
    call find_reactions(simulation%model%mechanism, plan, self%plan, state, self%reactions, err)
  end subroutine find
end module mech9_force_record
