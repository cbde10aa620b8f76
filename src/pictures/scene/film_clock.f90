!> The clock of a film: the time of a frame as text, with enough decimals to distinguish one frame from the next.
module mech9_film_clock
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_film, only: film_type
  implicit none
  private
  public :: clock_decimals, clock_text

  !> Times that need more decimals than these, or are larger than this, are written with powers of ten.
  integer, parameter :: most_decimals = 7
  real(wp), parameter :: largest = 1.0e6_wp
  !> A time agrees with its rounded text if the two differ by less than this part of the last decimal. If the time
  !> between frames is less than the last decimal, this part of it counts.
  real(wp), parameter :: near = 0.01_wp
  !> Frames can be distinguished if they differ by at least this number of units of the last decimal.
  real(wp), parameter :: enough = 3.0_wp

contains

  !> The number of decimals of the times of a film. It is the least with which all times agree, or else the least that
  !> distinguishes the frames. It is negative where no number of decimals serves.
  pure integer function clock_decimals(film) result(decimals)
    type(film_type), intent(in) :: film  !< poses and values at the outputs of the run
    real(wp) :: step, scaled(film%n_frames)

    associate (times => film%times(:film%n_frames))
      if (maxval(abs(times)) < largest) then
        step = largest
        if (film%n_frames > 1) step = abs(times(film%n_frames) - times(1))/(film%n_frames - 1)
        do decimals = 0, most_decimals
          scaled = times*10.0_wp**decimals
          if (all(abs(scaled - anint(scaled)) < near*min(1.0_wp, step*10.0_wp**decimals))) return
          if (step*10.0_wp**decimals >= enough) return
        end do
      end if
    end associate
    decimals = -1
  end function clock_decimals

  !> The text of the time of a frame, as it stands below a picture.
  pure function clock_text(time, decimals) result(text)
    real(wp), intent(in) :: time     !< time of the frame [s]
    integer, intent(in) :: decimals  !< negative: four digits, and a power of ten where it needs one
    character(len=:), allocatable :: text
    character(len=24) :: number
    character(len=8) :: form

    if (decimals < 0) then
      text = 't = '//to_text(time, 4)//' s'
      return
    end if
    write (form, '(a,i0,a)') '(f24.', decimals, ')'
    write (number, form) time
    number = adjustl(number)
    if (decimals == 0) number = number(:index(number, '.') - 1)
    if (verify(trim(number), '-0.') == 0 .and. number(1:1) == '-') number = number(2:)
    text = 't = '//trim(number)//' s'
  end function clock_text
end module mech9_film_clock
