!> All branches of a curve that hang together with a start: the one through it, and those that cross at branch points.
module mech9_curve_branches
  use mech9_kinds, only: wp
  use mech9_curve_tolerances, only: same_point, same_direction
  use mech9_curve, only: curve_type, curve_point_type
  use mech9_special_points, only: regular, branching
  use mech9_branch_point, only: branch_point_type, find_crossing
  use mech9_curve_branch, only: curve_branch_type, curve_settings_type, join_halves, ends_closed, ends_stopped
  use mech9_curve_tracing, only: trace, shortest_way
  implicit none
  private
  public :: find_branches

contains

  !> Find all branches. `left_out` counts branch points from which none was followed: those that are not simple.
  subroutine find_branches(curve, start, switch, settings, branches, left_out)
    class(curve_type), intent(inout) :: curve                            !< the problem
    type(curve_point_type), intent(in) :: start                          !< the start, with its direction
    logical, intent(in) :: switch                                        !< branches are followed from branch points
    type(curve_settings_type), intent(in) :: settings                    !< bounds
    type(curve_branch_type), allocatable, intent(out) :: branches(:)     !< the branches
    integer, intent(out) :: left_out                                     !< number of branch points that are not simple
    type(branch_point_type), allocatable :: known(:)
    type(curve_branch_type) :: branch
    type(curve_point_type) :: from
    real(wp), dimension(size(start%z)) :: along, crossing
    integer :: i
    logical :: found

    allocate (branches(0), known(0))
    left_out = 0
    curve%scale = max(maxval(abs(start%jacobian)), tiny(1.0_wp))
    call trace_both(curve, start, regular, settings, branch, known)
    branches = [branches, branch]
    if (.not. switch) return
    i = 1
    do while (i <= size(known))
      if (size(branches) >= settings%branches .or. any(branch%ends%reason == ends_stopped)) exit
      found = known(i)%is_polished
      if (found) call find_crossing(known(i), curve%scale, known(i)%directions(:, 1), along, crossing, found)
      if (found) known(i)%directions(:, 1) = along
      if (.not. found) left_out = left_out + 1
      if (found) found = .not. is_known(known(i), crossing)
      if (found) then
        from = known(i)%point
        from%direction = crossing
        from%tangent = crossing(from%place)
        call add_direction(known(i), crossing)
        call trace_both(curve, from, branching, settings, branch, known)
        branch%from = i
        branches = [branches, branch]
      end if
      i = i + 1
    end do
  end subroutine find_branches

  !> Whether a branch through a branch point has been followed.
  pure logical function is_known(point, direction)
    type(branch_point_type), intent(in) :: point   !< the branch point
    real(wp), intent(in) :: direction(:)           !< (m) of the branch

    is_known = any(abs(matmul(direction, point%directions)) > same_direction)
  end function is_known

  !> Remember that a branch through a branch point has been followed.
  pure subroutine add_direction(point, direction)
    type(branch_point_type), intent(inout) :: point   !< the branch point
    real(wp), intent(in) :: direction(:)              !< (m) of the branch

    point%directions = reshape([point%directions, direction], [size(direction), size(point%directions, 2) + 1])
  end subroutine add_direction

  !> Trace a branch in both directions, or once around where it is closed.
  subroutine trace_both(curve, start, kind, settings, branch, known)
    class(curve_type), intent(inout) :: curve                         !< the problem
    type(curve_point_type), intent(in) :: start                       !< a point, with its direction
    integer, intent(in) :: kind                                       !< of this point
    type(curve_settings_type), intent(in) :: settings                 !< bounds
    type(curve_branch_type), intent(out) :: branch                    !< the branch
    type(branch_point_type), allocatable, intent(inout) :: known(:)   !< branch points; gets new ones
    type(curve_branch_type) :: forward, backward
    type(branch_point_type), allocatable :: met(:)
    type(curve_point_type) :: reversed
    integer :: i

    allocate (met(0))
    call trace(curve, start, kind, settings, forward, met)
    if (forward%ends(2)%reason == ends_closed) then
      branch = forward
      branch%ends(1) = forward%ends(2)
      branch%start = 1
    else
      reversed = start
      reversed%direction = -start%direction
      reversed%tangent = -start%tangent
      call trace(curve, reversed, kind, settings, backward, met)
      call join_halves(backward, forward, branch)
    end if
    do i = 1, size(met)
      call remember(curve, met(i), known)
    end do
  end subroutine trace_both

  !> Add a branch point to those that are known, or the direction of a branch through it.
  subroutine remember(curve, met, known)
    class(curve_type), intent(in) :: curve                            !< the problem
    type(branch_point_type), intent(in) :: met                        !< the branch point
    type(branch_point_type), allocatable, intent(inout) :: known(:)   !< those that are known
    integer :: i

    do i = 1, size(known)
      if (norm2(shortest_way(curve, known(i)%point%z, met%point%z)) > same_point) cycle
      call add_direction(known(i), met%directions(:, 1))
      return
    end do
    known = [known, met]
  end subroutine remember
end module mech9_curve_branches
