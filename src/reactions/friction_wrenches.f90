!> The wrenches on which frictions depend, in the axes of their pairs.
module mech9_friction_wrenches
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_data
  use mech9_reaction_failures, only: failure_shared_bearing
  use mech9_reaction_tolerances, only: counts_as_zero
  use mech9_rotation, only: turn_back, combine
  use mech9_friction, only: friction_type
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: link_motion
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  use mech9_uniqueness, only: uniqueness_type, find_unique, component_names
  implicit none
  private
  public :: friction_wrenches_type, prepare_friction_wrenches

  !> Inverse dynamics of the frictions. Parts are polymorphic where these are copied by calls, which keeps the code of copies
  !> small.
  type :: friction_wrenches_type
    class(reaction_plan_type), allocatable :: plan
    class(reactions_type), allocatable :: reactions
    logical, allocatable :: unique(:, :)              !< (6,frictions) components that equilibrium determines
  contains
    procedure :: find
    procedure :: probe
  end type friction_wrenches_type

contains

  !> Prepare inverse dynamics in a plan. What is unique does not depend on the plan and is found once, unless it is known.
  subroutine prepare_friction_wrenches(mechanism, plan, start, self)
    type(mechanism_type), intent(in) :: mechanism            !< the mechanism, with frictions
    type(plan_type), intent(in) :: plan                      !< its plan, with all blocks
    type(state_type), intent(in) :: start                    !< an assembled position
    type(friction_wrenches_type), intent(inout) :: self      !< made anew but for what is unique
    type(uniqueness_type) :: unique

    if (allocated(self%plan)) deallocate (self%plan, self%reactions)
    allocate (self%plan)
    call make_reaction_plan(mechanism, plan, self%plan)
    allocate (self%reactions, source=new_reactions(plan, self%plan))
    if (allocated(self%unique)) return
    call find_unique(plan, self%plan, start, unique)
    self%unique = unique%pairs(:, mechanism%frictions%coordinate)
  end subroutine prepare_friction_wrenches

  !> Find the wrenches of the pairs with friction, in a state whose frames have their accelerations, under the frictions that stand in
  !> it. Fails where friction depends on a component that equilibrium does not determine, unless that is zero.
  subroutine find(self, mechanism, plan, state, wrenches, err)
    class(friction_wrenches_type), intent(inout) :: self     !< inverse dynamics
    type(mechanism_type), intent(in) :: mechanism            !< the mechanism
    type(plan_type), intent(in) :: plan                      !< its plan
    type(state_type), intent(in) :: state                    !< positions, rates and accelerations
    real(wp), intent(out) :: wrenches(:, :)                  !< (6,frictions) force [N], moment about the pair's point [N m]
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    real(wp) :: r(3, 3), p(3), omega(3), v(3), largest
    integer :: i, c
    logical :: reads(6)

    call find_reactions(mechanism, plan, self%plan, state, self%reactions, err)
    if (allocated(err)) return
    do i = 1, size(mechanism%frictions)
      associate (friction => mechanism%frictions(i), k => mechanism%frictions(i)%coordinate)
        call link_motion(plan, state, self%plan%pairs(k)%links(1), r, p, omega, v)
        r = combine(r, self%plan%pairs(k)%frame%r)
        wrenches(1:3, i) = turn_back(r, self%reactions%force(:, k))
        wrenches(4:6, i) = turn_back(r, self%reactions%moment(:, k))
        largest = max(norm2(wrenches(1:3, i)), norm2(wrenches(4:6, i))/self%plan%length)
        reads = friction%reads()
        do c = 1, 6
          if (self%unique(c, i) .or. .not. reads(c)) cycle
          if (abs(wrenches(c, i))/merge(1.0_wp, self%plan%length, c < 4) <= counts_as_zero*largest) then
            wrenches(c, i) = 0.0_wp
            cycle
          end if
          call raise(err, exit_data, failure_shared_bearing)
          err%failure%coordinates = [k]
          err%failure%name = component_names(c)
          err%failure%t = state%t
          call add_place(err, place=friction%place)
          return
        end do
      end associate
    end do
  end subroutine find
  !> A force of a friction whose wrenches are clearly above the round-off of those that were found last: its bearing load, or a part of
  !> that which the largest wrench of the mechanism would give [N m, N].
  pure real(wp) function probe(self, friction, wrench)
    class(friction_wrenches_type), intent(in) :: self     !< inverse dynamics, with the last wrenches
    type(friction_type), intent(in) :: friction           !< the friction
    real(wp), intent(in) :: wrench(6)                     !< of its pair [N, N m]
    real(wp), parameter :: part = 1.0e-3_wp
    real(wp) :: largest

    largest = max(maxval(abs(self%reactions%force)), maxval(abs(self%reactions%moment))/self%plan%length)
    probe = max(friction%bearing_load(friction%terms(wrench)), part*largest*sum(friction%weights()))
    if (.not. probe > 0.0_wp) probe = 1.0_wp
  end function probe
end module mech9_friction_wrenches
