!> Words that the reports of all runs share.
module mech9_run_words
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  implicit none
  private
  public :: duration, each

contains

  !> The mean time in words: ", 1.2 us each".
  pure function each(total, count) result(text)
    real(wp), intent(in) :: total  !< time of all of them [s]
    integer, intent(in) :: count   !< how many there are
    character(len=:), allocatable :: text

    text = ''
    if (count > 1) text = ', '//duration(total/count)//' each'
  end function each

  !> A time span in a readable unit.
  pure function duration(seconds) result(text)
    real(wp), intent(in) :: seconds  !< a time span [s]
    character(len=:), allocatable :: text

    if (seconds < 1.0e-3_wp) then
      text = to_text(1.0e6_wp*seconds, 3)//' us'
    else if (seconds < 1.0_wp) then
      text = to_text(1.0e3_wp*seconds, 3)//' ms'
    else
      text = to_text(seconds, 4)//' s'
    end if
  end function duration

end module mech9_run_words
