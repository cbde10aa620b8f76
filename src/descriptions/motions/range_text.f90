!> The ranges of the independent coordinates in words, for --range.
module mech9_range_text
  use mech9_named_words, only: with_names
  use mech9_part_names, only: part_names_type, name_in
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_motion_range, only: motion_range_type, end_type, find_range, ends_at_limit, ends_round, ends_otherwise
  use mech9_error, only: error_type
  use mech9_block_names, only: words_of_block
  use mech9_explanation, only: explain
  implicit none
  private
  public :: print_ranges, put_limits_in_words

  !> Significant digits of a limit, whose relative error is about 1e-12.
  integer, parameter :: digits = 13
  integer, parameter :: width = 22

contains

  !> Write a line for each independent coordinate: start, lower and upper end, unit, and the cause of its limits.
  subroutine print_ranges(unit, model, plan, start)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(model_type), intent(in) :: model          !< the model
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: start          !< the closed position at the start
    type(motion_range_type) :: range
    character(len=:), allocatable :: name, limits
    real(wp) :: factor
    integer :: i, k, named

    write (unit, '(a)') '# how far each independent coordinate can go from the start, the others held there'
    named = name_width(model%mechanism%names, plan%independent)
    write (unit, '(a)') column('#', 6)//column('start', width)//column('lower', width)//column('upper', width)// &
      'unit  '//named_column('name', named)//'limited by'
    do i = 1, size(plan%independent)
      k = plan%independent(i)
      call find_range(plan, start, k, range)
      factor = 1.0_wp/unit_of(model%mechanism, k)
      name = trim(unit_name(model%mechanism, k))
      call put_limits_in_words(model, plan, k, range, limits)
      write (unit, '(a)') column('q'//to_text(k), 6)//column(to_text(factor*range%start, digits), width)// &
        column(value_of(range%lower, factor), width)//column(value_of(range%upper, factor), width)// &
        column(name, 6)//named_column(trim(name_in(model%mechanism%names%coordinates, k)), named)// &
        limits
    end do
  end subroutine print_ranges

  !> The causes of the limits of a coordinate on both sides, with the names of coordinates.
  pure subroutine put_limits_in_words(model, plan, coordinate, range, text)
    type(model_type), intent(in) :: model                   !< the model
    type(plan_type), intent(in) :: plan                     !< the plan of the mechanism
    integer, intent(in) :: coordinate                       !< number of the coordinate
    type(motion_range_type), intent(in) :: range            !< its range
    character(len=:), allocatable, intent(out) :: text      !< the causes

    text = with_names(model%mechanism%names, reasons(plan, range, 1.0_wp/unit_of(model%mechanism, coordinate), &
                                                     trim(unit_name(model%mechanism, coordinate))))
  end subroutine put_limits_in_words

  !> Width of the column of names; 0 where no independent coordinate has a name.
  pure integer function name_width(names, independent) result(letters)
    type(part_names_type), intent(in) :: names    !< of links and pairs
    integer, intent(in) :: independent(:)         !< numbers of the coordinates
    integer :: i, longest

    longest = 0
    do i = 1, size(independent)
      longest = max(longest, len_trim(name_in(names%coordinates, independent(i))))
    end do
    letters = 0
    if (longest > 0) letters = max(longest, len('name')) + 2
  end function name_width

  !> A name in the column of names; empty where there is no such column.
  pure function named_column(name, width) result(padded)
    character(len=*), intent(in) :: name  !< the name; empty: none
    integer, intent(in) :: width          !< letters of the column
    character(len=width) :: padded

    padded = name
    if (name == '' .and. width > 0) padded = '-'
  end function named_column

  !> A text in a column of the given width.
  pure function column(text, width) result(padded)
    character(len=*), intent(in) :: text  !< the text of the column
    integer, intent(in) :: width          !< letters of the column
    character(len=max(width, len(text) + 1)) :: padded

    padded = text
  end function column

  !> The value of an end; a dash where there is none.
  pure function value_of(found, factor) result(text)
    type(end_type), intent(in) :: found  !< one end of the range
    real(wp), intent(in) :: factor       !< factor from rad or m to the unit of the file
    character(len=:), allocatable :: text

    text = '-'
    if (found%kind == ends_at_limit .or. found%kind == ends_otherwise) text = to_text(factor*found%value, digits)
  end function value_of

  !> The causes of the limits of a coordinate on both sides.
  pure function reasons(plan, range, factor, unit) result(text)
    type(plan_type), intent(in) :: plan           !< the plan of the mechanism
    type(motion_range_type), intent(in) :: range  !< the range of the coordinate
    real(wp), intent(in) :: factor                !< factor from rad or m to the unit of the file
    character(len=*), intent(in) :: unit          !< unit of the coordinate in the file
    character(len=:), allocatable :: text, lower, upper

    lower = reason(plan, range%lower, factor, unit)
    upper = reason(plan, range%upper, factor, unit)
    text = upper
    if (lower /= upper) text = 'below: '//lower//'; above: '//upper
  end function reasons

  !> The cause of one end of a range.
  pure function reason(plan, found, factor, unit) result(text)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(end_type), intent(in) :: found   !< one end of the range
    real(wp), intent(in) :: factor        !< factor from rad or m to the unit of the file
    character(len=*), intent(in) :: unit  !< unit of the coordinate in the file
    character(len=:), allocatable :: text
    type(error_type) :: err

    select case (found%kind)
    case (ends_at_limit)
      text = words_of_block(plan%blocks(found%block)%chains, plan%blocks(found%block)%coordinates)
    case (ends_round)
      text = 'full turn'
      if (found%turns > 1) text = 'full turns: it repeats after '//to_text(found%turns)
    case (ends_otherwise)
      err = found%failure
      call explain(err)
      text = err%message
    case default
      text = 'no limit up to '//to_text(factor*found%value)//' '//unit
    end select
  end function reason
end module mech9_range_text
