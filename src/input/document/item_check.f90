!> Check of the values under one name against its row of the grammar: type, count, range, words.
module mech9_item_check
  use mech9_kinds, only: wp, long
  use mech9_text, only: to_text, lower, nearest_name
  use mech9_source, only: span_type
  use mech9_grammar, only: item_row_type, unlimited, words_of
  use mech9_item_rows, only: find_item_rows
  use mech9_document, only: item_type, value_type, value_null, value_integer, value_real, value_logical, value_text, &
                            value_word, value_bad
  use mech9_diagnostics, only: diagnostics_type, printable
  implicit none
  private
  public :: check_item, known_word, is_sensible, is_in_range

contains

  !> Report every error in the values of an item whose repeats are written out.
  pure subroutine check_item(item, row, diagnostics)
    type(item_type), intent(in) :: item                   !< the item whose values are checked
    type(item_row_type), intent(in) :: row                !< the name, as a row of item_table
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i, found

    found = diagnostics%count
    do i = 1, size(item%values)
      if (equals_is_missing(item%values(i), row)) then
        call diagnostics%add(item%values(i)%span, 'an = is missing after '''//lower(item%values(i)%text)//'''')
        return
      end if
      call check_type(item%values(i), i, item%name, row, diagnostics)
    end do
    if (diagnostics%count > found .or. any(item%values%kind == value_bad)) return
    call check_count(item, row, diagnostics)
    do i = 1, min(size(item%values), row%high)
      call check_range(item%values(i), item%name, row, diagnostics)
      if (row%words /= '') call check_word(item%values(i), item%name, row, diagnostics)
    end do
  end subroutine check_item

  !> Whether a value is a name of the group, so that an = is missing after it: "point = 0,0,0 axis 0,0,1".
  pure logical function equals_is_missing(value, row)
    type(value_type), intent(in) :: value   !< the value that is checked
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table

    equals_is_missing = .false.
    if (value%kind == value_word) equals_is_missing = size(find_item_rows(row%group, value%text)) > 0
  end function equals_is_missing

  !> Report a value of the wrong type.
  pure subroutine check_type(value, number, name, row, diagnostics)
    type(value_type), intent(in) :: value                 !< the value that is checked
    integer, intent(in) :: number                         !< position of the value in its list
    character(len=*), intent(in) :: name                  !< name of the item, for the message
    type(item_row_type), intent(in) :: row                !< the name, as a row of item_table
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: written

    if (value%kind == value_bad) return
    written = diagnostics%text_of(value%span)
    if (value%kind == value_null) then
      call diagnostics%add(value%span, 'value '//to_text(number)//' of '''//name//''' is left empty; write every value')
      return
    end if
    select case (row%type)
    case ('integer')
      if (value%kind == value_integer) then
        if (abs(value%whole) > int(huge(1), long)) call diagnostics%add(value%span, written//' is too large for '''//name//'''')
      else
        call diagnostics%add(value%span, ''''//name//''' takes whole numbers, and '//written//' is none')
      end if
    case ('real')
      if (value%kind /= value_integer .and. value%kind /= value_real) then
        call diagnostics%add(value%span, ''''//name//''' takes numbers, and '//written//' is none')
      else if (.not. is_sensible(value%number)) then
        call diagnostics%add(value%span, written//' is too large or too small; numbers are 0 or between 1e-100 and 1e100')
      end if
    case ('text')
      if (value%kind == value_word .or. value%kind == value_logical) then
        call diagnostics%add(value%span, ''''//name//''' takes a text in quotes: '//name//' = '''//written//'''')
      else if (value%kind /= value_text) then
        call diagnostics%add(value%span, ''''//name//''' takes a text in quotes, and '//written//' is none')
      end if
    case ('logical')
      if (value%kind /= value_logical) &
        call diagnostics%add(value%span, ''''//name//''' is .true. or .false., and '//written//' is neither')
    end select
  end subroutine check_type

  !> Whether squares of a number, and its products with other sensible ones, stay within the range of floating point.
  pure logical function is_sensible(number)
    real(wp), intent(in) :: number  !< any number, in any unit

    is_sensible = abs(number) <= 1.0e100_wp .and. (abs(number) >= 1.0e-100_wp .or. .not. abs(number) > 0.0_wp)
  end function is_sensible

  !> Report too few or too many values.
  pure subroutine check_count(item, row, diagnostics)
    type(item_type), intent(in) :: item                   !< the item whose values are checked
    type(item_row_type), intent(in) :: row                !< the name, as a row of item_table
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: message
    integer :: n

    n = size(item%values)
    if (n >= row%low .and. n <= row%high) return
    message = to_text(n)//merge(' value ', ' values', n == 1)
    message = trim(message)//' for '''//item%name//''' where '//trim(expected_count(row))
    if (n > row%high) then
      if (n == 2*row%high .and. decimal_commas(item, diagnostics)) then
        message = message//'; a decimal comma? write '//diagnostics%text_of(item%values(1)%span)//'.'// &
                  diagnostics%text_of(item%values(2)%span)
      end if
      call diagnostics%add(cover(item%values(row%high + 1), item%values(n)), message)
    else
      call diagnostics%add(item%span, message)
    end if
  end subroutine check_count

  !> The allowed number of values, in words.
  pure function expected_count(row) result(text)
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table
    character(len=60) :: text

    if (row%high > row%low .and. row%high < unlimited) then
      text = to_text(row%low)//' to '//to_text(row%high)//' are expected'
    else
      text = to_text(row%low)//trim(merge(' are expected', ' is expected ', row%low > 1))
      if (row%high > row%low) text = 'at least '//trim(text)
    end if
  end function expected_count

  !> Whether all values are whole numbers in pairs joined by a comma without a blank: 1,5.
  pure logical function decimal_commas(item, diagnostics)
    type(item_type), intent(in) :: item                !< the item whose values are checked
    type(diagnostics_type), intent(in) :: diagnostics  !< gets the errors
    integer :: i

    decimal_commas = .false.
    do i = 1, size(item%values) - 1, 2
      associate (whole => item%values(i), part => item%values(i + 1))
        if (whole%kind /= value_integer .or. part%kind /= value_integer) return
        if (whole%span%source /= part%span%source .or. part%span%first /= whole%span%last + 2) return
        if (verify(diagnostics%text_of(part%span), '0123456789') > 0) return
      end associate
    end do
    decimal_commas = .true.
  end function decimal_commas

  !> The span from one value to another; that of the first alone where they do not stand in one text and in order.
  pure type(span_type) function cover(first, last)
    type(value_type), intent(in) :: first  !< the value that the result begins with
    type(value_type), intent(in) :: last   !< the value that the result ends with

    cover = first%span
    if (last%span%source == cover%source .and. last%span%last > cover%last) cover%last = last%span%last
  end function cover

  !> Report a number outside its range.
  pure subroutine check_range(value, name, row, diagnostics)
    type(value_type), intent(in) :: value                 !< the value that is checked
    character(len=*), intent(in) :: name                  !< name of the item, for the message
    type(item_row_type), intent(in) :: row                !< the name, as a row of item_table
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

    if (.not. is_in_range(value%number, row)) &
      call diagnostics%add(value%span, ''''//name//''' must be '//trim(row%range)//', not '//diagnostics%text_of(value%span))
  end subroutine check_range

  !> Whether a number lies in the range of its name.
  pure logical function is_in_range(number, row)
    real(wp), intent(in) :: number          !< in the units of the file
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table

    select case (row%range)
    case ('>0')
      is_in_range = number > 0.0_wp
    case ('>=0')
      is_in_range = number >= 0.0_wp
    case ('>=1')
      is_in_range = number >= 1.0_wp
    case ('>0 and <1')
      is_in_range = number > 0.0_wp .and. number < 1.0_wp
    case default
      is_in_range = .true.
    end select
  end function is_in_range

  !> Report a text that is not one of the allowed words.
  pure subroutine check_word(value, name, row, diagnostics)
    type(value_type), intent(in) :: value                 !< the value that is checked
    character(len=*), intent(in) :: name                  !< name of the item, for the message
    type(item_row_type), intent(in) :: row                !< the name, as a row of item_table
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=:), allocatable :: hint, word

    if (known_word(value%text, row)) return
    word = printable(value%text, 40)
    hint = trim(own_name(lower(word), row%words))
    ! letters in common do not make cm a misspelt m
    if (hint == '' .and. len(word) > 2) hint = nearest_name(word, words_of(row%words))
    if (hint == '') then
      hint = '; it is one of: '//trim(row%words)
    else
      hint = '; did you mean '''//hint//'''?'
    end if
    if (name == 'kind') then
      call diagnostics%add(value%span, 'unknown '//trim(row%group)//' kind '''//word//''''//hint)
    else
      call diagnostics%add(value%span, 'unknown '//name//' '''//word//''''//hint)
    end if
  end subroutine check_word

  !> The name that a kind of pair has here, where textbooks or other programs call it by another one; empty for other words.
  pure character(len=12) function own_name(word, words) result(name)
    character(len=*), intent(in) :: word    !< a word that is not known, in lower case
    character(len=*), intent(in) :: words   !< the words that are known
    character(len=12), parameter :: names(2, 22) = reshape([character(len=12) :: &
      'ball', 'spherical', 'ball_joint', 'spherical', 'socket', 'spherical', 'gimbal', 'spherical', 'hinge', 'revolute', &
      'pin', 'revolute', 'pivot', 'revolute', 'rotary', 'revolute', 'continuous', 'revolute', 'slide', 'prismatic', &
      'slider', 'prismatic', 'sliding', 'prismatic', 'translation', 'prismatic', 'screw', 'helical', 'hooke', 'universal', &
      'cardan', 'universal', 'u-joint', 'universal', 'plane', 'planar', 'floating', 'free', '6dof', 'free', 'curve', 'path', &
      'cam', 'path'], [2, 22])
    integer :: i

    name = ''
    do i = 1, size(names, 2)
      if (names(1, i) == word .and. index(' '//words//' ', ' '//trim(names(2, i))//' ') > 0) name = names(2, i)
    end do
  end function own_name

  !> Whether a text is one of the words of its row, in any case of letters.
  pure logical function known_word(text, row)
    character(len=*), intent(in) :: text    !< a text as the user wrote it
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table

    known_word = text /= '' .and. index(trim(text), ' ') == 0 .and. &
                 index(' '//lower(row%words)//' ', ' '//lower(trim(text))//' ') > 0
  end function known_word
end module mech9_item_check
