!> The impulses of pairs by impacts: the reactions of a mechanism at rest, without weight and loads, whose accelerations are the changes of
!> the rates, under the impulses of stops and contacts in place of forces.
module mech9_impact_record
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_mechanism, only: mechanism_type
  use mech9_coordinate_load, only: coordinate_load_type
  use mech9_contact_load, only: contact_load_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type, copy_state
  use mech9_frame_motion, only: spread_all_velocities
  use mech9_impact_watcher, only: impact_watcher_type
  use mech9_reactions, only: reactions_type
  use mech9_single_reactions, only: find_single_reactions
  implicit none
  private
  public :: impact_record_type, new_impact_record

  !> The impulses of pairs at all times of impacts. Parts are polymorphic, which keeps the code of copies small.
  type, extends(impact_watcher_type) :: impact_record_type
    class(mechanism_type), allocatable, private :: mechanism   !< without weight, with a load for each stop and contact
    integer, allocatable, private :: pairs(:)                  !< pairs whose impulses are kept, by their coordinates
    integer, private :: count = 0                              !< times so far
    real(wp), allocatable, private :: times(:)                 !< these times, then room for more [s]
    real(wp), allocatable, private :: wrenches(:, :, :)        !< (6,pairs,times) force and moment of each [N s, N m s]
  contains
    procedure :: take
    procedure :: show
  end type impact_record_type

contains

  !> A record of the impacts of a model.
  subroutine new_impact_record(model, pairs, record)
    type(model_type), intent(in) :: model                  !< the model, with rigid stops
    integer, intent(in) :: pairs(:)                        !< pairs whose impulses are kept, by their coordinates
    type(impact_record_type), intent(out) :: record        !< the record, without impacts
    integer :: i, n

    record%pairs = pairs
    allocate (record%times(16), record%wrenches(6, size(pairs), 16))
    allocate (record%mechanism, source=model%mechanism)
    associate (m => record%mechanism)
      m%gravity = 0.0_wp
      deallocate (m%loads, m%motors)
      n = 0
      if (m%has_contacts()) n = size(m%contacts)
      allocate (m%motors(0), m%loads(size(m%stops) + n))
      do i = 1, size(m%stops)
        allocate (m%loads(i)%load, source=coordinate_load_type(coordinate=m%stops(i)%coordinate, force=1.0_wp))
      end do
      do i = 1, n
        allocate (m%loads(size(m%stops) + i)%load, source=contact_load_type(contact=m%contacts(i), number=i))
      end do
    end associate
  end subroutine new_impact_record

  !> Take the impacts of one time.
  subroutine take(self, plan, state, impulses, changes, err)
    class(impact_record_type), intent(inout) :: self    !< the record
    type(plan_type), intent(in) :: plan                 !< the plan in the present coordinates
    type(state_type), intent(in) :: state               !< the position, with its frames
    real(wp), intent(in) :: impulses(:)                 !< (M) of stops on the coordinates, positive while they grow [N m s, N s]
    real(wp), intent(in) :: changes(:)                  !< (M) of the rates of all coordinates [rad/s, m/s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    class(reactions_type), allocatable :: reactions
    type(state_type) :: at_rest
    real(wp), allocatable :: times(:), wrenches(:, :, :)
    integer :: i, n

    call copy_state(state, at_rest)
    at_rest%dq = 0.0_wp
    at_rest%ddq = changes
    call spread_all_velocities(plan, at_rest)
    call load_with(impulses, self%mechanism)
    call find_single_reactions(self%mechanism, plan, at_rest, reactions, err)
    if (allocated(err)) return
    n = self%count
    if (n == size(self%times)) then
      allocate (times(2*n), wrenches(6, size(self%pairs), 2*n))
      times(:n) = self%times
      wrenches(:, :, :n) = self%wrenches
      call move_alloc(times, self%times)
      call move_alloc(wrenches, self%wrenches)
    end if
    self%count = n + 1
    self%times(n + 1) = state%t
    do i = 1, size(self%pairs)
      self%wrenches(1:3, i, n + 1) = reactions%force(:, self%pairs(i))
      self%wrenches(4:6, i, n + 1) = reactions%moment(:, self%pairs(i))
    end do
  end subroutine take

  !> Let the loads of the mechanism be impulses; the first stop of each coordinate has the whole.
  subroutine load_with(impulses, mechanism)
    real(wp), intent(in) :: impulses(:)                     !< (M) on the coordinates [N m s, N s]
    class(mechanism_type), intent(inout) :: mechanism       !< one load for each stop
    integer :: i

    do i = 1, size(mechanism%stops)
      select type (load => mechanism%loads(i)%load)
      type is (coordinate_load_type)
        load%force = 0.0_wp
        if (.not. any(mechanism%stops(:i - 1)%coordinate == load%coordinate)) load%force = impulses(load%coordinate)
      end select
    end do
  end subroutine load_with

  !> Show the impulses of pairs by the impacts of a time.
  pure subroutine show(self, t, pairs, wrenches)
    class(impact_record_type), intent(in) :: self          !< the record
    real(wp), intent(in) :: t                              !< the time [s]
    integer, allocatable, intent(out) :: pairs(:)          !< numbers of the pairs; none: nothing is known of the time
    real(wp), allocatable, intent(out) :: wrenches(:, :)   !< (6,pairs) of force and moment as in the results [N s, N m s]
    integer :: after, before, middle

    before = 0
    after = self%count + 1
    do while (after - before > 1)
      middle = (before + after)/2
      if (self%times(middle) <= t) then
        before = middle
      else
        after = middle
      end if
    end do
    allocate (pairs(0), wrenches(6, 0))
    if (before == 0) return
    if (self%times(before) < t) return
    pairs = self%pairs
    wrenches = self%wrenches(:, :, before)
  end subroutine show
end module mech9_impact_record
