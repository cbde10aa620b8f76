!> The names that the user gives to links and pairs, beside their numbers.
module mech9_part_names
  use mech9_text, only: to_text
  implicit none
  private
  public :: part_names_type, longest_part_name, longest_called, name_in, coordinate_named, link_named, number_columns, &
    name_column, add_names, has_names, label_of, lengthen

  integer, parameter :: longest_part_name = 40                    !< letters of a name
  integer, parameter :: longest_called = longest_part_name + 3    !< with the place of a coordinate in its joint: B(2)

  !> Names of links and of coordinates. Those of links and coordinates without a name are blank; there may be fewer than links and
  !> coordinates.
  type :: part_names_type
    character(len=longest_part_name), allocatable :: links(:)       !< not allocated where no link has a name
    character(len=longest_called), allocatable :: coordinates(:)    !< the same for coordinates; B(2) for the second one of joint B
  end type part_names_type

  character(len=*), parameter :: digits = '0123456789'
  !> Ends of columns by names, and the beginnings of the same columns by numbers: B.dq is dq4.
  character(len=5), parameter :: ends(4) = [character(len=5) :: 'q', 'dq', 'ddq', 'drive']
  character(len=5), parameter :: starts(4) = [character(len=5) :: 'q', 'dq', 'ddq', 'F']
  !> Ends of columns of pairs, R4.fx, which are the same by names and by numbers.
  character(len=8), parameter :: of_pairs(11) = [character(len=8) :: 'fx', 'fy', 'fz', 'mx', 'my', 'mz', 'f', 'm', 'friction', &
                                                 'loss', 'heat']
  !> Ends of columns of links, L3.phi, which are the same by names and by numbers.
  character(len=6), parameter :: of_links(16) = [character(len=6) :: 'phi', 'omega', 'alpha', 'e0', 'e1', 'e2', 'e3', &
                                                 'wx', 'wy', 'wz', 'alphax', 'alphay', 'alphaz', 'pole.x', 'pole.y', 'pole.z']

contains

  !> Make a list of names longer.
  pure subroutine lengthen(list, length)
    character(len=*), allocatable, intent(inout) :: list(:)    !< the list
    integer, intent(in) :: length                              !< least length afterwards
    character(len=len(list)), allocatable :: longer(:)

    if (size(list) >= length) return
    allocate (longer(max(length, 2*size(list))))
    longer = ''
    longer(:size(list)) = list
    call move_alloc(longer, list)
  end subroutine lengthen

  !> Whether any link or pair has a name.
  pure logical function has_names(names)
    type(part_names_type), intent(in) :: names    !< the names

    has_names = allocated(names%links) .or. allocated(names%coordinates)
  end function has_names

  !> The name with a number in a list; blank where there is none.
  pure character(len=longest_called) function name_in(list, number) result(name)
    character(len=*), allocatable, intent(in) :: list(:)    !< names of links or of coordinates
    integer, intent(in) :: number                           !< of the link or the coordinate

    name = ''
    if (.not. allocated(list)) return
    if (number >= 1 .and. number <= size(list)) name = list(number)
  end function name_in

  !> The name of a link or a coordinate, or its number where it has none.
  pure character(len=longest_called) function label_of(list, number) result(label)
    character(len=*), allocatable, intent(in) :: list(:)    !< names of links or of coordinates
    integer, intent(in) :: number                           !< of the link or the coordinate

    label = name_in(list, number)
    if (label == '') label = to_text(number)
  end function label_of

  !> Number of the link with a name; 0 where there is none.
  pure integer function link_named(names, name) result(number)
    type(part_names_type), intent(in) :: names    !< the names
    character(len=*), intent(in) :: name          !< any text

    number = 0
    if (name == '' .or. .not. allocated(names%links)) return
    do number = size(names%links), 1, -1
      if (names%links(number) == name) return
    end do
  end function link_named

  !> Number of the coordinate with a name: B of a pair, B(2) of the second coordinate of a joint. 0 where there is none, and for B
  !> where B is a joint with several.
  pure integer function coordinate_named(names, name) result(number)
    type(part_names_type), intent(in) :: names    !< the names
    character(len=*), intent(in) :: name          !< any text

    number = 0
    if (name == '' .or. .not. allocated(names%coordinates)) return
    do number = size(names%coordinates), 1, -1
      if (names%coordinates(number) == name) return
    end do
  end function coordinate_named

  !> Replace the name of a column that is formed with names of pairs and links by the one with their numbers: B.dq by dq4, B.fx by
  !> R4.fx, coupler.phi by L3.phi. Others stay.
  pure subroutine number_columns(names, text)
    type(part_names_type), intent(in) :: names                !< the names
    character(len=:), allocatable, intent(inout) :: text      !< names of columns
    integer :: first, last
    character(len=:), allocatable :: column

    if (.not. has_names(names)) return
    first = 1
    do while (first <= len(text))
      last = first + scan(text(first:)//',', ',: ') - 2
      if (last >= first) then
        column = text(first:last)
        call number_column(names, column)
        text = text(:first - 1)//column//text(last + 1:)
        last = first + len(column) - 1
      end if
      first = last + 2
    end do
  end subroutine number_columns

  !> Replace the names in one column by numbers. A derivative d(B.q)/d(a) is taken apart.
  pure recursive subroutine number_column(names, text)
    type(part_names_type), intent(in) :: names                !< the names
    character(len=:), allocatable, intent(inout) :: text      !< name of a column
    character(len=:), allocatable :: part, rest
    integer :: point, i, number

    if (starts_derivative(text)) then
      point = index(text, ')/d(')
      part = text(3:point - 1)
      rest = text(point:)
      call number_column(names, part)
      text = 'd('//part//rest
      return
    end if
    point = index(text, '.')
    if (point < 2 .or. point == len(text)) return
    part = text(:point - 1)
    rest = text(point + 1:)
    if (any(rest == ['q.re', 'q.im'])) then
      ! a column of modes
      number = coordinate_named(names, part)
      if (number > 0) text = 'q'//to_text(number)//rest(2:)
      return
    end if
    do i = 1, size(ends)
      if (ends(i) /= rest) cycle
      number = coordinate_named(names, part)
      if (number > 0) text = trim(starts(i))//to_text(number)
      return
    end do
    if (any(of_links == rest)) then
      number = link_named(names, part)
      if (number > 0) text = 'L'//to_text(number)//'.'//rest
    else if (any(of_pairs == rest)) then
      number = coordinate_named(names, part)
      ! the first coordinate of a joint stands for it
      if (number == 0) number = coordinate_named(names, part//'(1)')
      if (number > 0) text = 'R'//to_text(number)//'.'//rest
    end if
  end subroutine number_column

  !> Whether the name of a column is that of a derivative.
  pure logical function starts_derivative(text)
    character(len=*), intent(in) :: text     !< name of a column

    starts_derivative = .false.
    if (len(text) > 7) starts_derivative = text(:2) == 'd(' .and. index(text, ')/d(') > 3
  end function starts_derivative

  !> Replace the name of a column that is formed with numbers of pairs and links by the one with their names, where they have any.
  pure recursive subroutine name_column(names, text)
    type(part_names_type), intent(in) :: names                !< the names
    character(len=:), allocatable, intent(inout) :: text      !< name of a column
    character(len=:), allocatable :: part
    character(len=longest_called) :: name
    integer :: i, point, number

    if (.not. has_names(names)) return
    if (starts_derivative(text)) then
      point = index(text, ')/d(')
      part = text(3:point - 1)
      call name_column(names, part)
      text = 'd('//part//text(point:)
      return
    end if
    do i = 1, size(starts)
      ! columns of modes end with parts of complex numbers: q4.re
      point = index(text//'.', '.')
      if (starts(i) /= 'q' .or. all(text(point:) /= ['   ', '.re', '.im'])) point = len(text) + 1
      number = number_after(trim(starts(i)), text(:point - 1))
      name = name_in(names%coordinates, number)
      if (name == '') cycle
      text = trim(name)//'.'//trim(ends(i))//text(point:)
      return
    end do
    point = index(text, '.')
    if (point < 3) return
    part = text(point + 1:)
    name = ''
    if (any(of_links == part)) name = name_in(names%links, number_after('L', text(:point - 1)))
    if (any(of_pairs == part)) then
      name = name_in(names%coordinates, number_after('R', text(:point - 1)))
      i = index(name, '(1)')
      if (i > 0) name = name(:i - 1)
    end if
    if (name /= '') text = trim(name)//'.'//part
  end subroutine name_column

  !> Number that follows letters at the beginning of a name; 0 where the name has another form.
  pure integer function number_after(letters, name) result(number)
    character(len=*), intent(in) :: letters   !< the beginning of the name
    character(len=*), intent(in) :: name      !< name of a column
    integer :: i

    number = 0
    if (len(name) <= len(letters) .or. len(name) > len(letters) + 8) return
    if (name(:len(letters)) /= letters .or. verify(name(len(letters) + 1:), digits) > 0) return
    do i = len(letters) + 1, len(name)
      number = 10*number + index(digits, name(i:i)) - 1
    end do
  end function number_after

  !> Add names behind numbers in a sentence: link 2 becomes link 2 (crank), coordinates 1, 4 become coordinates 1 (A), 4 (B), and
  !> q4 = 0.5 becomes q4 (B) = 0.5.
  pure subroutine add_names(names, text)
    type(part_names_type), intent(in) :: names                !< the names
    character(len=:), allocatable, intent(inout) :: text      !< any sentence
    integer :: i

    if (.not. has_names(names)) return
    call add_behind('link', names%links, text)
    call add_behind('coordinate', names%coordinates, text)
    call add_behind('pair', names%coordinates, text)
    if (.not. allocated(names%coordinates)) return
    do i = 1, 3
      call add_to_values(trim(starts(i)), names%coordinates, text)
    end do
  end subroutine add_names

  !> Add names behind the numbers that follow a word.
  pure subroutine add_behind(word, list, text)
    character(len=*), intent(in) :: word                      !< the word, without an s
    character(len=*), allocatable, intent(in) :: list(:)      !< names
    character(len=:), allocatable, intent(inout) :: text      !< any sentence
    integer :: at, found, number, last
    character(len=longest_called) :: name

    if (.not. allocated(list)) return
    at = 1
    do
      found = index(text(at:), word)
      if (found == 0) return
      found = at + found - 1
      at = found + len(word)
      if (found > 1) then
        if (scan(text(found - 1:found - 1), '&_=''abcdefghijklmnopqrstuvwxyz') > 0) cycle
      end if
      if (at > len(text)) return
      if (text(at:at) == 's') at = at + 1
      do
        call next_number(text, at, number, last)
        if (number == 0) exit
        name = name_in(list, number)
        at = last + 1
        if (name == '') cycle
        if (index(text(at:), ' ('//trim(name)//')') /= 1) text = text(:last)//' ('//trim(name)//')'//text(at:)
        at = at + len_trim(name) + 3
      end do
      if (at > len(text)) return
    end do
  end subroutine add_behind

  !> Add names behind coordinates that have a value in a sentence: q4 = 0.5 becomes q4 (B) = 0.5.
  pure subroutine add_to_values(letters, list, text)
    character(len=*), intent(in) :: letters                   !< q, dq or ddq
    character(len=*), allocatable, intent(in) :: list(:)      !< names of coordinates
    character(len=:), allocatable, intent(inout) :: text      !< any sentence
    integer :: at, found, last
    character(len=longest_called) :: name

    at = 1
    do
      found = index(text(at:), ' '//letters)
      if (found == 0) return
      found = at + found
      at = found + len(letters)
      last = at + verify(text(at:)//'.', digits) - 2
      if (last < at .or. index(text(last + 1:), ' = ') /= 1) cycle
      name = name_in(list, number_after(letters, text(found:last)))
      at = last + 1
      if (name /= '') text = text(:last)//' ('//trim(name)//')'//text(at:)
    end do
  end subroutine add_to_values

  !> The next number of a list behind a word: after a blank, a comma or `and`. 0 where another word follows, or a broken number.
  pure subroutine next_number(text, at, number, last)
    character(len=*), intent(in) :: text     !< a sentence
    integer, intent(in) :: at                !< the next byte
    integer, intent(out) :: number           !< 0 where there is none
    integer, intent(out) :: last             !< its last byte
    integer :: first

    number = 0
    last = at
    first = at
    if (at > len(text)) return
    if (index(text(at:), ', ') == 1) then
      first = at + 2
    else if (index(text(at:), ' and ') == 1) then
      first = at + 5
    else if (text(at:at) == ' ') then
      first = at + 1
    else
      return
    end if
    if (first > len(text)) return
    last = first + verify(text(first:)//'.', digits) - 2
    if (last < first .or. last > first + 7) return
    if (last < len(text)) then
      if (scan(text(last + 1:last + 1), '.eE') == 1 .and. last + 1 < len(text)) then
        if (index(digits, text(last + 2:last + 2)) > 0) return
      end if
    end if
    number = number_after('', text(first:last))
  end subroutine next_number
end module mech9_part_names
