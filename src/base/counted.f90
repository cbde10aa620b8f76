!> Numbers with their nouns, in the singular or in the plural.
module mech9_counted
  use mech9_kinds, only: long
  use mech9_text, only: to_text
  implicit none
  private
  public :: counted

  !> A number with its noun: "1 step", "2 steps", "2 assemblies".
  interface counted
    module procedure counted_integer, counted_long
  end interface counted

contains

  ! The length of the results stands first: gfortran must see it before the functions whose results have it.

  !> Letters of a number with its noun.
  pure integer function counted_length(number, noun) result(length)
    integer(long), intent(in) :: number   !< how many there are
    character(len=*), intent(in) :: noun  !< the noun in the singular

    length = len(to_text(number)) + 1 + len(noun)
    if (number /= 1) length = length + 1 + merge(1, 0, turns_y(noun))
  end function counted_length

  !> Whether the plural of a noun ends with ies.
  pure logical function turns_y(noun)
    character(len=*), intent(in) :: noun  !< the noun in the singular, of two letters or more
    integer :: last

    last = len(noun)
    turns_y = noun(last:) == 'y' .and. scan(noun(last - 1:last - 1), 'aeiou') == 0
  end function turns_y

  !> An integer with its noun.
  pure function counted_integer(number, noun) result(words)
    integer, intent(in) :: number         !< how many there are
    character(len=*), intent(in) :: noun  !< the noun in the singular
    character(len=counted_length(int(number, long), noun)) :: words

    words = counted_long(int(number, long), noun)
  end function counted_integer

  !> A long integer with its noun.
  pure function counted_long(number, noun) result(words)
    integer(long), intent(in) :: number   !< how many there are
    character(len=*), intent(in) :: noun  !< the noun in the singular
    character(len=counted_length(number, noun)) :: words

    words = to_text(number)//' '//noun//'s'
    if (number /= 1 .and. turns_y(noun)) words = to_text(number)//' '//noun(:len(noun) - 1)//'ies'
  end function counted_long
end module mech9_counted
