!> The forces that a run records: of drives and in pairs, from the present state of its simulation.
module mech9_force_record
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_rotation, only: turn_back
  use mech9_masks, only: numbers_of
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_mechanism, only: mechanism_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion
  use mech9_simulation, only: simulation_type
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan, is_made_for
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  use mech9_uniqueness, only: uniqueness_type, find_unique
  use mech9_columns, only: columns_type
  implicit none
  private
  public :: force_record_type, reacting_pairs, moving_link, fill_wrenches

  type :: force_record_type
    logical :: wanted = .false.              !< forces are recorded
    type(uniqueness_type), allocatable :: unique   !< of forces; not allocated: no reactions are recorded
    class(reactions_type), allocatable :: reactions        !< of the present state
    type(reaction_plan_type), private :: plan
    integer, private :: plans = -1           !< plans of the simulation before the one for which the plan was made; -1: there is none
  contains
    procedure :: begin
    procedure :: append_magnitudes
    procedure :: judge
    procedure :: find
    procedure :: fill
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
      columns%in_links = output%reactions_in_links
      driven = output%drive_forces .and. model%problem%has_drive()
      call columns%append_forces(model%mechanism, numbers_of(driven), numbers_of(reacting_pairs(model)))
    end associate
  end subroutine begin

  !> Add the columns of the magnitudes of the wrenches, if the request names them.
  subroutine append_magnitudes(self, model, columns)
    class(force_record_type), intent(in) :: self     !< the record, begun
    type(model_type), intent(in) :: model            !< the model
    type(columns_type), intent(inout) :: columns     !< those of forces, motors and energies; gets those of magnitudes
    integer :: i

    if (.not. (self%wanted .and. model%request%output%reaction_magnitudes)) return
    columns%magnitudes = 2*size(columns%reacting)
    do i = 1, size(columns%reacting)
      associate (k => columns%reacting(i))
        call columns%append_in('R'//to_text(k)//'.f', 'N', 'magnitude of the force in pair '//to_text(k))
        call columns%append_in('R'//to_text(k)//'.m', 'N m', 'magnitude of the moment in pair '//to_text(k)// &
                            ' about the origin of its frame in the moving link')
      end associate
    end do
  end subroutine append_magnitudes

  !> The link that a pair, or the joint for which its coordinate stands, moves.
  pure integer function moving_link(mechanism, k) result(link)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: k                        !< number of the pair
    integer :: joint

    link = mechanism%pairs(k)%pair%moving
    joint = mechanism%structure%joint_of(k)
    if (joint > 0) link = mechanism%structure%joints(joint)%ends(2)
  end function moving_link

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
        associate (numbers => structure%joints(j)%coordinates(), unique => self%unique)
          unique%pairs(:, numbers(1)) = unique%pairs(:, numbers(size(numbers)))
          unique%fixed(:, numbers(1)) = unique%fixed(:, numbers(size(numbers)))
          unique%moving(:, numbers(1)) = unique%moving(:, numbers(size(numbers)))
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

  !> Fill the columns of forces and of magnitudes in a row, after find.
  subroutine fill(self, columns, mechanism, plan, state, row)
    class(force_record_type), intent(in) :: self     !< the record, with the forces
    type(columns_type), intent(in) :: columns        !< the columns
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(plan_type), intent(in) :: plan              !< the plan with which the forces were found
    type(state_type), intent(in) :: state            !< the state for which they were found
    real(wp), intent(inout) :: row(:)                !< numbers of one row, one for each column

    call fill_wrenches(self%reactions, columns, mechanism, plan, state, row)
  end subroutine fill

  !> Fill the columns of forces and of magnitudes in a row.
  subroutine fill_wrenches(reactions, columns, mechanism, plan, state, row)
    class(reactions_type), intent(in) :: reactions   !< the forces
    type(columns_type), intent(in) :: columns        !< the columns
    type(mechanism_type), intent(in) :: mechanism    !< the mechanism
    type(plan_type), intent(in) :: plan              !< the plan with which the forces were found
    type(state_type), intent(in) :: state            !< the state for which they were found
    real(wp), intent(inout) :: row(:)                !< numbers of one row, one for each column
    real(wp) :: force(3, size(reactions%force, 2)), moment(3, size(reactions%force, 2)), r(3, 3), p(3), omega(3), v(3)
    integer :: i

    force = reactions%force
    moment = reactions%moment
    do i = 1, size(columns%reacting)
      associate (k => columns%reacting(i))
        if (columns%magnitudes > 0) then
          associate (at => columns%before_stops() - columns%links - columns%magnitudes + 2*i)
            row(at - 1) = norm2(force(:, k))
            row(at) = norm2(moment(:, k))
          end associate
        end if
        if (.not. columns%in_links) cycle
        call link_motion(plan, state, moving_link(mechanism, k), r, p, omega, v)
        force(:, k) = turn_back(r, force(:, k))
        moment(:, k) = turn_back(r, moment(:, k))
      end associate
    end do
    call columns%fill_forces(reactions%needed, force, moment, reactions%couplings%values, row)
  end subroutine fill_wrenches
end module mech9_force_record
