!> Forms of the arguments of options.
module mech9_argument_forms
  implicit none
  private
  public :: is_whole_number, is_assignment, is_part

contains

  !> Whether a text is a whole number from 1 on that an integer can hold.
  pure logical function is_whole_number(text)
    character(len=*), intent(in) :: text  !< the argument of an option
    integer :: value, status

    is_whole_number = .false.
    if (verify(text, '0123456789') > 0) return
    read (text, *, iostat=status) value
    if (status == 0) is_whole_number = value > 0
  end function is_whole_number

  !> Whether a text is the number of a part and the number of all parts, K/N with K from 1 to N.
  pure logical function is_part(text)
    character(len=*), intent(in) :: text  !< the argument of an option
    integer :: slash, part, parts

    slash = index(text, '/')
    is_part = slash > 1
    if (is_part) is_part = is_whole_number(text(:slash - 1)) .and. is_whole_number(text(slash + 1:))
    if (.not. is_part) return
    read (text(:slash - 1), *) part
    read (text(slash + 1:), *) parts
    is_part = part <= parts
  end function is_part

  !> Whether a text has the form GROUP.NAME=VALUE. The reader of the data file checks the names.
  pure logical function is_assignment(text)
    character(len=*), intent(in) :: text  !< the argument of an option
    integer :: equals, dot

    equals = index(text, '=')
    dot = index(text(:max(equals - 1, 0)), '.')
    is_assignment = dot > 1 .and. dot < equals - 1
  end function is_assignment
end module mech9_argument_forms
