!> Numbers and words in attributes and texts of XML elements.
!>
!> These procedures do nothing after a failure, so that a reader may call several of them and look at the failure once.
module mech9_xml_values
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_numeral, only: numeral_type, read_numeral
  use mech9_xml_tree, only: xml_tree_type
  implicit none
  private
  public :: get_numbers, get_number, get_list, needed_attribute, numbers_in, get_content, get_content_number
  public :: is_true, place_in, one_of

  !> Numbers that data files can hold.
  real(wp), parameter :: largest = 1.0e100_wp, smallest = 1.0e-100_wp
  integer, parameter :: longest_quote = 40, most_numbers = 1000
  character(len=*), parameter :: blanks = ' '//achar(9)//achar(10)//achar(13)

contains

  !> The numbers in an attribute, exactly as many as the array holds. They stay as they are where the element does not have it.
  subroutine get_numbers(tree, element, name, numbers, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element; 0: none
    character(len=*), intent(in) :: name                 !< name of the attribute
    real(wp), intent(inout) :: numbers(:)                !< defaults before, values afterwards
    type(error_type), allocatable, intent(inout) :: err  !< the failure

    if (allocated(err) .or. .not. tree%has(element, name)) return
    call numbers_in(tree, element, tree%attribute(element, name), "'"//name//"'", numbers, err)
  end subroutine get_numbers

  !> The number in an attribute. It stays as it is where the element does not have it.
  subroutine get_number(tree, element, name, number, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element; 0: none
    character(len=*), intent(in) :: name                 !< name of the attribute
    real(wp), intent(inout) :: number                    !< default before, value afterwards
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: numbers(1)

    numbers = number
    call get_numbers(tree, element, name, numbers, err)
    number = numbers(1)
  end subroutine get_number

  !> As many numbers as an attribute holds; none where the element does not have it.
  subroutine get_list(tree, element, name, numbers, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element; 0: none
    character(len=*), intent(in) :: name                 !< name of the attribute
    real(wp), allocatable, intent(out) :: numbers(:)     !< the values
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: found(most_numbers)
    integer :: n

    n = 0
    if (.not. allocated(err)) call split(tree, element, tree%attribute(element, name), "'"//name//"'", found, n, err)
    numbers = found(:min(n, most_numbers))
    if (n > most_numbers) call tree%fail(element, "'"//name//"' holds more than "//to_text(most_numbers)//' numbers', err)
  end subroutine get_list

  !> The numbers in a text, exactly as many as the array holds.
  subroutine numbers_in(tree, element, text, what, numbers, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element that holds the text
    character(len=*), intent(in) :: text                 !< the numbers with blanks between them
    character(len=*), intent(in) :: what                 !< the text in words, for messages
    real(wp), intent(inout) :: numbers(:)                !< the values
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: found(most_numbers)
    integer :: n

    if (allocated(err)) return
    call split(tree, element, text, what, found, n, err)
    if (allocated(err)) return
    if (n /= size(numbers)) then
      call tree%fail(element, what//' must hold '//to_text(size(numbers))//' numbers, not '//to_text(n), err)
    else
      numbers = found(:n)
    end if
  end subroutine numbers_in

  !> Split a text into numbers.
  subroutine split(tree, element, text, what, numbers, n, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element that holds the text
    character(len=*), intent(in) :: text                 !< numbers with blanks between them
    character(len=*), intent(in) :: what                 !< the text in words, for messages
    real(wp), intent(out) :: numbers(most_numbers)       !< the first values
    integer, intent(out) :: n                            !< how many there are
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    type(numeral_type) :: numeral
    integer :: at, first, last

    n = 0
    numbers = 0.0_wp
    at = 1
    do
      first = verify(text(at:), blanks)
      if (first == 0) return
      first = at + first - 1
      last = scan(text(first:), blanks)
      last = merge(len(text), first + last - 2, last == 0)
      call read_numeral(text(first:last), numeral)
      if (.not. allocated(numeral%problem) .and. abs(numeral%number) > largest) numeral%problem = 'is too large'
      if (allocated(numeral%problem)) then
        call tree%fail(element, what//": '"//text(first:min(last, first + longest_quote))//"' "//numeral%problem, err)
        return
      end if
      n = n + 1
      if (n <= most_numbers) numbers(n) = merge(numeral%number, 0.0_wp, abs(numeral%number) >= smallest)
      at = last + 1
      if (at > len(text)) return
    end do
  end subroutine split

  !> The numbers in the text of an element of this name in an element. They stay as they are where there is none.
  subroutine get_content(tree, element, name, numbers, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element around it; 0: none
    character(len=*), intent(in) :: name                 !< its name
    real(wp), intent(inout) :: numbers(:)                !< defaults before, values afterwards
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    integer :: e

    e = tree%child(element, name)
    if (e > 0) call numbers_in(tree, e, tree%content(e), '<'//name//'>', numbers, err)
  end subroutine get_content

  !> The number in the text of an element of this name in an element. It stays as it is where there is none.
  subroutine get_content_number(tree, element, name, number, err)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element around it; 0: none
    character(len=*), intent(in) :: name                 !< its name
    real(wp), intent(inout) :: number                    !< default before, value afterwards
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    real(wp) :: numbers(1)

    numbers = number
    call get_content(tree, element, name, numbers, err)
    number = numbers(1)
  end subroutine get_content_number

  !> The value of an attribute that an element must have.
  function needed_attribute(tree, element, name, err) result(value)
    type(xml_tree_type), intent(in) :: tree              !< the document
    integer, intent(in) :: element                       !< number of the element
    character(len=*), intent(in) :: name                 !< name of the attribute
    type(error_type), allocatable, intent(inout) :: err  !< the failure
    character(len=:), allocatable :: value

    value = tree%attribute(element, name)
    if (.not. tree%has(element, name)) call tree%fail(element, '<'//tree%name(element)//"> needs '"//name//"'", err)
  end function needed_attribute

  !> The place of a word in a list; 0 where it is not there.
  pure integer function place_in(list, word) result(place)
    character(len=*), intent(in) :: list(:)  !< words
    character(len=*), intent(in) :: word     !< the word that is looked for

    do place = size(list), 1, -1
      if (list(place) == word) return
    end do
  end function place_in

  !> The words of a list, as the remedy of a message about another word.
  pure function one_of(list) result(text)
    character(len=*), intent(in) :: list(:)  !< words, at least two
    character(len=:), allocatable :: text
    integer :: i

    text = 'the types are '//trim(list(1))
    do i = 2, size(list) - 1
      text = text//', '//trim(list(i))
    end do
    text = text//' and '//trim(list(size(list)))
  end function one_of

  !> Whether a text says yes.
  pure logical function is_true(text)
    character(len=*), intent(in) :: text  !< value of an attribute or text of an element

    is_true = any(text == [character(len=4) :: 'true', 'True', 'TRUE', '1'])
  end function is_true
end module mech9_xml_values
