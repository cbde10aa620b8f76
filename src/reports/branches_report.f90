!> The part of a report that has branches over a parameter, as JSON (docs/reference/results.md), and names of their points and ends.
module mech9_branches_report
  use mech9_json, only: json_type
  use mech9_special_points, only: fold, branching, hopf, period_doubling, torus
  use mech9_curve_branch, only: ends_low, ends_high, ends_points, ends_closed, ends_range, ends_failed, ends_special
  use mech9_branches, only: branches_found_type
  implicit none
  private
  public :: add_branches, name_of_kind, name_of_end

contains

  !> Add the branches with their special points.
  subroutine add_branches(json, found)
    type(json_type), intent(inout) :: json              !< the report, inside its object
    type(branches_found_type), intent(in) :: found      !< the branches; without any after a failure
    integer :: b, i, at, n

    if (found%count() == 0) return
    n = found%columns%motion
    call json%add('parameter', found%parameter)
    call json%begin_array('branches')
    at = 0
    do b = 1, size(found%branches)
      associate (branch => found%branches(b))
        call json%begin_object()
        call json%add('branch', b)
        call json%add('of', trim(found%of(found%groups(b))))
        call json%add('points', branch%count)
        if (found%of(found%groups(b)) == 'periodic') call json%add('period_doublings', branch%doublings)
        call json%add('closed', branch%ends(2)%reason == ends_closed)
        call json%begin_array('ends')
        do i = 1, 2
          if (branch%ends(i)%reason == ends_special) then
            call json%add(name_of_kind(branch%kind(merge(1, branch%count, i == 1))))
          else
            call json%add(name_of_end(branch%ends(i)%reason))
          end if
        end do
        call json%end_array()
        call json%begin_array('special_points')
        do i = 1, branch%count
          if (branch%kind(i) == 0) cycle
          call json%begin_object()
          call json%add('point', i)
          call json%add('type', branch%kind(i))
          call json%add('kind', name_of_kind(branch%kind(i)))
          call json%add('value', found%rows(3, at + i))
          call json%add('q', found%rows(4:n, at + i))
          if (found%period > 0) call json%add('period', found%rows(found%period, at + i))
          if (found%growth > 0) call json%add('growth', found%rows(found%growth, at + i))
          call json%end_object()
        end do
        call json%end_array()
        call json%end_object()
        at = at + branch%count
      end associate
    end do
    call json%end_array()
    call json%add('branch_points_left_out', found%left_out)
    if (any(found%of == 'periodic')) call json%add('period_doublings_left_out', found%not_doubled)
  end subroutine add_branches

  !> The name of a kind of point.
  pure function name_of_kind(kind) result(name)
    integer, intent(in) :: kind   !< of point
    character(len=:), allocatable :: name

    select case (kind)
    case (fold)
      name = 'fold'
    case (branching)
      name = 'branch point'
    case (hopf)
      name = 'Hopf point'
    case (period_doubling)
      name = 'period doubling'
    case (torus)
      name = 'torus'
    case default
      name = 'regular'
    end select
  end function name_of_kind

  !> The name of the reason why a branch ends.
  pure function name_of_end(reason) result(name)
    integer, intent(in) :: reason   !< the reason
    character(len=:), allocatable :: name

    select case (reason)
    case (ends_low)
      name = 'low'
    case (ends_high)
      name = 'high'
    case (ends_points)
      name = 'points'
    case (ends_closed)
      name = 'closed'
    case (ends_range)
      name = 'stop'
    case (ends_failed)
      name = 'no convergence'
    case default
      name = 'interrupted'
    end select
  end function name_of_end
end module mech9_branches_report
