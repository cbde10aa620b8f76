!> All branches of a curve that hang together with a start: the one through it, those that cross at branch points, and those of the doubled
!> period that begin where periods double.
module mech9_curve_branches
  use mech9_kinds, only: wp
  use mech9_curve_tolerances, only: same_point, same_direction
  use mech9_curve, only: curve_type, curve_point_type
  use mech9_curve_step, only: first_direction
  use mech9_special_points, only: regular, branching, period_doubling
  use mech9_branch_point, only: branch_point_type, find_crossing
  use mech9_curve_branch, only: curve_branch_type, curve_settings_type, join_halves, ends_closed, ends_stopped, &
    ends_special
  use mech9_curve_tracing, only: trace, shortest_way
  implicit none
  private
  public :: find_branches

contains

  !> Find all branches. `left_out` counts branch points from which none was followed: those that are not simple; `not_doubled` period
  !> doublings from which none was followed.
  subroutine find_branches(curve, start, switch, settings, branches, left_out, not_doubled)
    class(curve_type), intent(inout) :: curve                            !< the problem
    type(curve_point_type), intent(in) :: start                          !< the start, with its direction
    logical, intent(in) :: switch                                        !< branches are followed from branch points and doublings
    type(curve_settings_type), intent(in) :: settings                    !< bounds
    type(curve_branch_type), allocatable, intent(out) :: branches(:)     !< the branches
    integer, intent(out) :: left_out                                     !< number of branch points that are not simple
    integer, intent(out) :: not_doubled                                  !< number of period doublings that were not followed
    type(branch_point_type), allocatable :: known(:)
    type(curve_branch_type) :: branch
    integer :: i

    allocate (branches(0), known(0))
    left_out = 0
    not_doubled = 0
    curve%scale = max(maxval(abs(start%jacobian)), tiny(1.0_wp))
    call trace_both(curve, start, regular, 0, settings, branch, known)
    branches = [branches, branch]
    if (.not. switch) return
    i = 1
    do while (i <= size(known))
      if (size(branches) >= settings%branches .or. any(branches(size(branches))%ends%reason == ends_stopped)) exit
      if (known(i)%doubles) then
        call follow_doubled(curve, i, settings, branches, known, not_doubled)
        call follow_single(curve, i, settings, branches, known)
      else
        call follow_crossing(curve, i, settings, branches, known, left_out)
      end if
      i = i + 1
    end do
  end subroutine find_branches

  !> Follow the branch that crosses at a branch point, if there is one which has not been followed.
  subroutine follow_crossing(curve, i, settings, branches, known, left_out)
    class(curve_type), intent(inout) :: curve                               !< the problem
    integer, intent(in) :: i                                                !< number of the branch point
    type(curve_settings_type), intent(in) :: settings                       !< bounds
    type(curve_branch_type), allocatable, intent(inout) :: branches(:)      !< gets the branch
    type(branch_point_type), allocatable, intent(inout) :: known(:)         !< the branch points; gets new ones
    integer, intent(inout) :: left_out                                      !< counts branch points that are not simple
    type(curve_branch_type) :: branch
    type(curve_point_type) :: from
    real(wp), dimension(size(known(i)%point%z)) :: along, crossing
    logical :: found

    found = known(i)%is_polished
    if (found) call find_crossing(known(i), curve%scale, known(i)%directions(:, 1), along, crossing, found)
    if (found) known(i)%directions(:, 1) = along
    if (.not. found) left_out = left_out + 1
    if (found) found = .not. is_known(known(i), crossing)
    if (.not. found) return
    from = known(i)%point
    from%direction = crossing
    from%tangent = crossing(from%place)
    call add_direction(known(i), crossing)
    call trace_both(curve, from, branching, (known(i)%doublings), settings, branch, known)
    branch%from = i
    branches = [branches, branch]
  end subroutine follow_crossing

  !> Follow the branch of the doubled period from a point at which periods double. It is traced in one direction: in the other one are the
  !> same solutions, begun a single period later.
  subroutine follow_doubled(curve, i, settings, branches, known, not_doubled)
    class(curve_type), intent(inout) :: curve                               !< the problem
    integer, intent(in) :: i                                                !< number of the point
    type(curve_settings_type), intent(in) :: settings                       !< bounds
    type(curve_branch_type), allocatable, intent(inout) :: branches(:)      !< gets the branch
    type(branch_point_type), allocatable, intent(inout) :: known(:)         !< the branch points; gets new ones
    integer, intent(inout) :: not_doubled                                   !< counts points from which none was followed
    type(curve_branch_type) :: branch
    type(branch_point_type), allocatable :: met(:)
    type(curve_point_type) :: from
    logical :: found

    if (known(i)%knows_double) return
    found = known(i)%doublings < settings%doublings
    if (found) call curve%double(known(i)%point, from, found)
    if (.not. found) not_doubled = not_doubled + 1
    if (.not. found) return
    known(i)%knows_double = .true.
    branch%doublings = known(i)%doublings + 1
    allocate (met(0))
    call trace(curve, from, period_doubling, settings, branch, met)
    branch%ends(1)%reason = ends_special
    branch%from = i
    branch%start = 1
    branches = [branches, branch]
    call remember_all(curve, met, known)
  end subroutine follow_doubled

  !> Follow the branch of the single period through a point that was met from a branch of the doubled one.
  subroutine follow_single(curve, i, settings, branches, known)
    class(curve_type), intent(inout) :: curve                               !< the problem
    integer, intent(in) :: i                                                !< number of the point
    type(curve_settings_type), intent(in) :: settings                       !< bounds
    type(curve_branch_type), allocatable, intent(inout) :: branches(:)      !< gets the branch
    type(branch_point_type), allocatable, intent(inout) :: known(:)         !< the branch points; gets new ones
    type(curve_branch_type) :: branch
    type(curve_point_type) :: from
    integer :: directions

    if (known(i)%knows_single .or. size(branches) >= settings%branches) return
    known(i)%knows_single = .true.
    from = known(i)%point
    call first_direction(from, directions)
    if (directions /= 1) return
    call trace_both(curve, from, period_doubling, (known(i)%doublings), settings, branch, known)
    branch%from = i
    branches = [branches, branch]
  end subroutine follow_single

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
  subroutine trace_both(curve, start, kind, doublings, settings, branch, known)
    class(curve_type), intent(inout) :: curve                         !< the problem
    type(curve_point_type), intent(in) :: start                       !< a point, with its direction
    integer, intent(in) :: kind                                       !< of this point
    integer, intent(in) :: doublings                                  !< times by which the period doubled on the way to it
    type(curve_settings_type), intent(in) :: settings                 !< bounds
    type(curve_branch_type), intent(out) :: branch                    !< the branch
    type(branch_point_type), allocatable, intent(inout) :: known(:)   !< branch points; gets new ones
    type(curve_branch_type) :: forward, backward
    type(branch_point_type), allocatable :: met(:)
    type(curve_point_type) :: reversed

    allocate (met(0))
    forward%doublings = doublings
    backward%doublings = doublings
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
    call remember_all(curve, met, known)
  end subroutine trace_both

  !> Add branch points to those that are known.
  subroutine remember_all(curve, met, known)
    class(curve_type), intent(in) :: curve                            !< the problem
    type(branch_point_type), intent(in) :: met(:)                     !< the branch points
    type(branch_point_type), allocatable, intent(inout) :: known(:)   !< those that are known
    integer :: i

    do i = 1, size(met)
      call remember(curve, met(i), known)
    end do
  end subroutine remember_all

  !> Add a branch point to those that are known, or the direction of a branch through it.
  subroutine remember(curve, met, known)
    class(curve_type), intent(in) :: curve                            !< the problem
    type(branch_point_type), intent(in) :: met                        !< the branch point
    type(branch_point_type), allocatable, intent(inout) :: known(:)   !< those that are known
    integer :: i

    do i = 1, size(known)
      if (known(i)%doubles .neqv. met%doubles) cycle
      if (norm2(shortest_way(curve, known(i)%point%z, met%point%z)) > same_point) cycle
      known(i)%knows_single = known(i)%knows_single .or. met%knows_single
      known(i)%knows_double = known(i)%knows_double .or. met%knows_double
      if (.not. met%doubles) call add_direction(known(i), met%directions(:, 1))
      return
    end do
    known = [known, met]
  end subroutine remember
end module mech9_curve_branches
