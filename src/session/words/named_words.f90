!> Sentences with the names of links and pairs behind their numbers.
module mech9_named_words
  use mech9_part_names, only: part_names_type, add_names
  implicit none
  private
  public :: with_names

contains

  !> A sentence in which names stand behind the numbers of links, pairs and coordinates: link 2 (crank).
  pure function with_names(names, sentence) result(text)
    type(part_names_type), intent(in) :: names    !< of links and pairs
    character(len=*), intent(in) :: sentence      !< with numbers
    character(len=:), allocatable :: text

    text = sentence
    call add_names(names, text)
  end function with_names
end module mech9_named_words
