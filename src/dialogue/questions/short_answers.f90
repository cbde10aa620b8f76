!> Short forms of answers, and the full forms in which a data file holds them.
!>
!> The reader of data files takes full forms only. Short forms are understood where the user can be asked again.
module mech9_short_answers
  use mech9_text, only: lower
  use mech9_grammar, only: item_row_type, words_of
  implicit none
  private
  public :: full_form, word_meant

  !> Names that take a direction, with blanks around each.
  character(len=*), parameter :: directions = ' axis zero moving_axis moving_zero '
  character(len=*), parameter :: digits = '0123456789', blanks = ' '//achar(9)
  !> Longer answers are no short forms.
  integer, parameter :: longest = 40

contains

  !> The full form of an answer: "rev" and "hinge" are revolute, "-z" is the axis 0, 0, -1, and "1-2" means the links 1,
  !> 2. For gravity "-y" is 0, -9.81, 0 and "none" is 0, 0, 0. Other answers stay as they are.
  pure function full_form(row, line) result(text)
    type(item_row_type), intent(in) :: row  !< row of the table of names for the question
    character(len=*), intent(in) :: line    !< the answer, without blanks around it
    character(len=:), allocatable :: text
    character(len=:), allocatable :: word

    text = line
    if (len(line) > longest .or. line == '') return
    if (row%words /= '') then
      word = word_in_table(line, words_of(trim(row%words)))
      if (row%group == 'pair' .and. word == '') word = kind_of_pair(line)
      if (word /= '') text = word
    else if (row%type == 'real' .and. index(directions, ' '//trim(row%name)//' ') > 0) then
      if (is_signed_axis(line)) text = along(line, '1')
    else if (row%group == 'gravity' .and. row%name == 'acceleration') then
      if (lower(line) == 'none' .or. lower(line) == 'no') text = '0, 0, 0'
      if (is_signed_axis(line)) text = along(line, '9.81')
    else if (row%name == 'links' .and. row%high == 2) then
      text = two_numbers(line)
    end if
  end function full_form

  !> The word of the table of names that an answer means, as it stands there; empty if there is none or more than one.
  pure function word_in_table(line, words) result(word)
    character(len=*), intent(in) :: line      !< the answer, without blanks around it
    character(len=*), intent(in) :: words(:)  !< the words allowed
    character(len=:), allocatable :: word
    character(len=len(words)) :: lowered(size(words))
    integer :: i

    do i = 1, size(words)
      lowered(i) = lower(words(i))
    end do
    word = word_meant(line, lowered)
    if (word == '') return
    i = findloc(lowered == word, .true., dim=1)
    word = trim(words(i))
  end function word_in_table

  !> The kind of pair that a mechanic's word means; empty for other words.
  pure function kind_of_pair(line) result(kind)
    character(len=*), intent(in) :: line  !< the answer, without blanks around it
    character(len=:), allocatable :: kind

    select case (lower(line))
    case ('hinge', 'pin')
      kind = 'revolute'
    case ('slide', 'slider', 'p')
      ! the letter with which textbooks name it, though a path begins with it, too
      kind = 'prismatic'
    case ('screw')
      kind = 'helical'
    case ('ball')
      kind = 'spherical'
    case ('cardan', 'hooke')
      kind = 'universal'
    case ('curve', 'wire', 'rail')
      kind = 'path'
    case default
      kind = ''
    end select
  end function kind_of_pair

  !> The word of a list that an answer means: the answer itself, or the only word that begins with it. It is empty if
  !> there is no such word or more than one.
  pure function word_meant(line, words) result(word)
    character(len=*), intent(in) :: line      !< the answer, without blanks around it
    character(len=*), intent(in) :: words(:)  !< the words allowed, in lower case
    character(len=:), allocatable :: word
    character(len=:), allocatable :: typed
    integer :: i, n

    typed = trim(lower(line))
    word = ''
    n = 0
    do i = 1, size(words)
      if (words(i) == typed) then
        word = typed
        return
      end if
      if (index(words(i), typed) /= 1) cycle
      n = n + 1
      word = trim(words(i))
    end do
    if (n /= 1) word = ''
  end function word_meant

  !> Whether a line is x, y or z, perhaps behind a sign.
  pure logical function is_signed_axis(line)
    character(len=*), intent(in) :: line  !< the answer, without blanks around it

    is_signed_axis = .false.
    if (len(line) > 2) return
    if (len(line) == 2) then
      if (scan(line(1:1), '+-') == 0) return
    end if
    is_signed_axis = scan(lower(line(len(line):)), 'xyz') == 1
  end function is_signed_axis

  !> Components of a vector along the axis that a line such as "-y" names.
  pure function along(line, length) result(text)
    character(len=*), intent(in) :: line    !< the answer, without blanks around it
    character(len=*), intent(in) :: length  !< length of the vector, as a number is typed
    character(len=:), allocatable :: text, component
    integer :: i

    text = ''
    do i = 1, 3
      component = '0'
      if (index('xyz', lower(line(len(line):))) == i) component = length
      if (component /= '0' .and. line(1:1) == '-') component = '-'//component
      text = text//component
      if (i < 3) text = text//', '
    end do
  end function along

  !> Two numbers with a comma between them, "1, 2" for "1-2" and "1 - 2". Other texts stay as they are.
  pure function two_numbers(line) result(text)
    character(len=*), intent(in) :: line  !< the answer, without blanks around it
    character(len=:), allocatable :: text, first, second
    integer :: dash

    text = line
    dash = index(line, '-')
    if (dash < 2 .or. dash == len(line)) return
    first = line(:verify(line(:dash - 1), blanks, back=.true.))
    second = line(dash + verify(line(dash + 1:)//'-', blanks):)
    if (first == '' .or. second == '') return
    if (verify(first, digits) > 0 .or. verify(second, digits) > 0) return
    text = first//', '//second
  end function two_numbers
end module mech9_short_answers
