!> Positions at which a design must be closed though it has no target there: in the run, and in the full turns of cranks. Their open
!> chains lead the search to designs that can be assembled everywhere.
module mech9_waypoints
  use mech9_kinds, only: wp, pi
  use mech9_model, only: model_type
  use mech9_objective, only: timing_given, assembles_limit, crank_limit, transmission_limit
  use mech9_targets, only: target_type
  implicit none
  private
  public :: gather_waypoints

  integer, parameter :: along_run = 13    !< positions in the run, both ends included
  integer, parameter :: in_turn = 12      !< positions in a full turn

contains

  !> The positions that a model needs beside its targets.
  pure subroutine gather_waypoints(model, with_targets, waypoints)
    type(model_type), intent(in) :: model                        !< with its objectives and limits
    logical, intent(in) :: with_targets                          !< some objectives have targets
    type(target_type), allocatable, intent(out) :: waypoints(:)  !< the positions, as targets that nothing must meet
    integer :: i, j

    allocate (waypoints(0))
    associate (time => model%request%time, limits => model%request%limits)
      if (.not. with_targets .or. any(limits%kind == assembles_limit .or. limits%kind == transmission_limit)) &
        waypoints = [(target_type(timing=timing_given, at=time%start + (time%end - time%start)*i/real(along_run - 1, wp)), &
                      i=0, along_run - 1)]
      do j = 1, size(limits)
        if (limits(j)%kind /= crank_limit) cycle
        waypoints = [waypoints, (target_type(timing=timing_given, at=time%start, turned=limits(j)%coordinate, &
                                             place=[2.0_wp*pi*i/in_turn, 0.0_wp, 0.0_wp]), i=1, in_turn - 1)]
      end do
    end associate
  end subroutine gather_waypoints
end module mech9_waypoints
