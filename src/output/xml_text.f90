!> Texts and numbers as pictures in XML need them.
module mech9_xml_text
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_printable, only: printable, with_escapes
  implicit none
  private
  public :: xml_text, decimal

contains

  !> Any text as text of an XML document, in which no part of it is taken for markup.
  pure function xml_text(text) result(xml)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=:), allocatable :: xml

    xml = with_escapes(printable(text), '&<>"''', [character(len=6) :: '&amp;', '&lt;', '&gt;', '&quot;', '&#39;'])
  end function xml_text

  !> A number with at most two decimals and without trailing zeros, such as 12.5, -0.25 or 7.
  pure function decimal(number) result(text)
    real(wp), intent(in) :: number  !< the number, of a size that a picture has
    character(len=:), allocatable :: text
    integer :: hundredths, whole, rest

    hundredths = nint(100.0_wp*max(-2.0e7_wp, min(2.0e7_wp, number)))
    whole = abs(hundredths)/100
    rest = mod(abs(hundredths), 100)
    text = to_text(whole)
    if (hundredths < 0) text = '-'//text
    if (rest == 0) return
    text = text//'.'//achar(48 + rest/10)
    if (mod(rest, 10) > 0) text = text//achar(48 + mod(rest, 10))
  end function decimal
end module mech9_xml_text
