!> Lengths of failures in words, in the unit of the data file.
module mech9_length_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_units, only: units_type, units_of_words
  use mech9_failure, only: failure_type
  implicit none
  private
  public :: length_in_words

contains

  !> A length with its unit: "0.35 mm". The unit is that which the failure names, or m.
  pure character(len=36) function length_in_words(failure, length, digits) result(words)
    type(failure_type), intent(in) :: failure   !< of a kind with lengths, and perhaps with the name of their unit
    real(wp), intent(in) :: length              !< the length [m]
    integer, intent(in) :: digits               !< significant digits
    type(units_type) :: units

    units = units_type()
    if (allocated(failure%name)) units = units_of_words(failure%name, '', '', '', '')
    words = to_text(length/units%length, digits)//' '//units%length_name
  end function length_in_words
end module mech9_length_words
