!> The interface of what looks at each impact of a motion, to keep the impulses of pairs.
module mech9_impact_watcher
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: impact_watcher_type

  !> Looks at each impact of a motion, and keeps the impulses of pairs.
  type, abstract :: impact_watcher_type
  contains
    procedure(take_interface), deferred :: take
    procedure(show_interface), deferred :: show
  end type impact_watcher_type

  abstract interface
    !> Take the impacts of one time. Fails where the impulses of pairs are infinite.
    subroutine take_interface(self, plan, state, impulses, changes, err)
      import :: impact_watcher_type, plan_type, state_type, error_type, wp
      class(impact_watcher_type), intent(inout) :: self   !< the watcher
      type(plan_type), intent(in) :: plan                 !< the plan in the present coordinates
      type(state_type), intent(in) :: state               !< the position, with its frames
      real(wp), intent(in) :: impulses(:)                 !< (M) of stops on the coordinates, positive while they grow [N m s, N s]
      real(wp), intent(in) :: changes(:)                  !< (M) of the rates of all coordinates [rad/s, m/s]
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine take_interface

    !> Show the impulses of pairs by the impacts of a time.
    pure subroutine show_interface(self, t, pairs, wrenches)
      import :: impact_watcher_type, wp
      class(impact_watcher_type), intent(in) :: self      !< the watcher
      real(wp), intent(in) :: t                           !< the time [s]
      integer, allocatable, intent(out) :: pairs(:)       !< numbers of the pairs, by their coordinates; none: nothing is known of the time
      real(wp), allocatable, intent(out) :: wrenches(:, :)   !< (6,pairs) of force and moment as in the results [N s, N m s]
    end subroutine show_interface
  end interface
end module mech9_impact_watcher
