!> Sentences and lists with the names of links and pairs behind their numbers.
module mech9_named_words
  use mech9_text, only: to_text
  use mech9_part_names, only: part_names_type, add_names, name_in
  implicit none
  private
  public :: with_names, named_list, named_number

contains

  !> A sentence in which names stand behind the numbers of links, pairs and coordinates: link 2 (crank).
  pure function with_names(names, sentence) result(text)
    type(part_names_type), intent(in) :: names    !< of links and pairs
    character(len=*), intent(in) :: sentence      !< with numbers
    character(len=:), allocatable :: text

    text = sentence
    call add_names(names, text)
  end function with_names

  !> Numbers with their names behind them: 1 (A), 4, 5 (B) and 3 more.
  pure function named_list(list, numbers, most) result(text)
    character(len=*), allocatable, intent(in) :: list(:)    !< names of links or of coordinates
    integer, intent(in) :: numbers(:)                       !< of links or coordinates
    integer, intent(in) :: most                             !< so many are written
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, min(size(numbers), most)
      if (i > 1) text = text//', '
      text = text//named_number(list, numbers(i))
    end do
    if (size(numbers) > most) text = text//' and '//to_text(size(numbers) - most)//' more'
  end function named_list

  !> A number with its name behind it: 4 (B); the number alone where it has none.
  pure function named_number(list, number) result(text)
    character(len=*), allocatable, intent(in) :: list(:)    !< names of links or of coordinates
    integer, intent(in) :: number                           !< of the link or the coordinate
    character(len=:), allocatable :: text

    text = to_text(number)
    if (name_in(list, number) /= '') text = text//' ('//trim(name_in(list, number))//')'
  end function named_number
end module mech9_named_words
