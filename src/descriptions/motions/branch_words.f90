!> Branches over a parameter in words: their special points, and why they end.
module mech9_branch_words
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_part_names, only: part_names_type, add_names
  use mech9_counted, only: counted
  use mech9_explanation, only: explain
  use mech9_curve_branch, only: branch_end_type, ends_low, ends_high, ends_points, ends_closed, ends_range, ends_failed, &
    ends_special
  use mech9_branches, only: branches_found_type
  use mech9_branches_report, only: name_of_kind
  implicit none
  private
  public :: print_branches

contains

  !> Print a few lines for each branch.
  subroutine print_branches(unit, found, names)
    integer, intent(in) :: unit                          !< Fortran unit to write to
    type(branches_found_type), intent(in) :: found       !< the branches
    type(part_names_type), intent(in) :: names           !< of links and pairs
    character(len=:), allocatable :: words
    integer :: b, i, at

    at = 0
    do b = 1, size(found%branches)
      associate (branch => found%branches(b), first => found%rows(:, at + 1))
        write (unit, '(a)') 'branch '//to_text(b)//': '//counted(branch%count, 'point')//', '//found%parameter//' = '// &
          to_text(first(3), 8)//' to '//to_text(found%rows(3, at + branch%count), 8)//'; '//&
          period_of_branch(branch%doublings)//words_of_ends(found, b)
        do i = 1, branch%count
          if (branch%kind(i) == 0) cycle
          words = coordinates(found, at + i)
          call add_names(names, words)
          write (unit, '(a)') '  '//name_of_kind(branch%kind(i))//' at '//found%parameter//' = '// &
            to_text(found%rows(3, at + i), 12)//', point '//to_text(i)//words//period(found, at + i)
        end do
        at = at + branch%count
      end associate
    end do
    if (found%left_out > 0) &
      write (unit, '(a)') 'no branch was followed from '//counted(found%left_out, 'branch point')//', where more than two '// &
        'branches meet, or none crosses'
    if (found%not_doubled > 0) &
      write (unit, '(a)') 'no branch was followed from '//counted(found%not_doubled, 'period doubling')//', where the period '// &
        'has doubled often before, or several multipliers are -1'
  end subroutine print_branches

  !> The period of the motions of a branch beside that of the start, where it differs.
  function period_of_branch(doublings) result(text)
    integer, intent(in) :: doublings                     !< times by which the period doubled; below 0 where it was halved
    character(len=:), allocatable :: text

    text = ''
    if (doublings == 1) text = 'twice the period; '
    if (doublings > 1) text = to_text(2**doublings)//' times the period; '
    if (doublings < 0) text = 'the period divided by '//to_text(2**(-doublings))//'; '
  end function period_of_branch

  !> The coordinates of a row, if they are few.
  function coordinates(found, row) result(text)
    type(branches_found_type), intent(in) :: found       !< the branches
    integer, intent(in) :: row                           !< number of the row
    character(len=:), allocatable :: text
    integer, parameter :: few = 6
    integer :: k

    text = ''
    do k = 4, min(found%columns%motion, 3 + few)
      text = text//', '//found%columns%names(k)%text//' = '//to_text(found%rows(k, row), 8)
    end do
    if (found%columns%motion > 3 + few) text = text//' and others'
  end function coordinates

  !> The period of a row, where motions have periods of their own.
  function period(found, row) result(text)
    type(branches_found_type), intent(in) :: found       !< the branches
    integer, intent(in) :: row                           !< number of the row
    character(len=:), allocatable :: text

    text = ''
    if (found%period == 0) return
    if (ieee_is_finite(found%rows(found%period, row))) text = ', period '//to_text(found%rows(found%period, row), 10)//' s'
  end function period

  !> Why a branch ends at both ends.
  function words_of_ends(found, b) result(text)
    type(branches_found_type), intent(in) :: found       !< the branches
    integer, intent(in) :: b                             !< number of the branch
    character(len=:), allocatable :: text

    associate (branch => found%branches(b), group => found%groups(b))
      if (branch%ends(2)%reason == ends_closed) then
        text = 'it is closed'
        if (allocated(branch%ends(2)%turns)) text = text//turns(branch%ends(2)%turns)
      else
        text = 'it begins '//words_of_end(found, group, branch%ends(1), branch%kind(1))//' and ends '// &
               words_of_end(found, group, branch%ends(2), branch%kind(branch%count))
      end if
    end associate
  end function words_of_ends

  !> The coordinates that have turned where a branch comes back.
  pure function turns(numbers) result(text)
    real(wp), intent(in) :: numbers(:)   !< (M+1) whole turns
    character(len=:), allocatable :: text
    integer :: k

    text = ''
    do k = 1, size(numbers)
      if (abs(numbers(k)) > 0.5_wp) text = text//', q'//to_text(k)//' has turned '//counted(nint(abs(numbers(k))), 'time')
    end do
  end function turns

  !> Why a branch ends.
  function words_of_end(found, group, last, kind) result(text)
    type(branches_found_type), intent(in) :: found       !< the branches
    integer, intent(in) :: group                         !< number of the group
    type(branch_end_type), intent(in) :: last            !< the end
    integer, intent(in) :: kind                          !< of its point
    character(len=:), allocatable :: text
    type(error_type), allocatable :: err

    select case (last%reason)
    case (ends_low)
      text = 'at low='//to_text(found%low(group), 8)
    case (ends_high)
      text = 'at high='//to_text(found%high(group), 8)
    case (ends_points)
      text = 'after so many points as points= allows'
    case (ends_range)
      text = 'at a rigid stop'
    case (ends_special)
      text = 'at a '//name_of_kind(kind)
    case (ends_failed)
      text = 'where no further point was found, with steps down to '//to_text(last%last_step, 2)
      if (allocated(last%err)) then
        err = last%err
        call explain(err)
        if (allocated(err%message)) text = text//': '//err%message
      end if
    case default
      text = 'where the work was interrupted'
    end select
  end function words_of_end
end module mech9_branch_words
