!> How the start of a motion was reached from the position in which the mechanism is drawn, in words.
module mech9_start_way_text
  use mech9_named_words, only: named_number
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: unit_of
  use mech9_start_path, only: start_way_type
  implicit none
  private
  public :: print_start_way, start_way_text

  !> So many coordinates are named at most.
  integer, parameter :: most_named = 6

contains

  !> Write a line where the motion from the drawn position to the start was interrupted.
  subroutine print_start_way(unit, mechanism, way)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(start_way_type), intent(in) :: way        !< how the start was reached

    if (way%interrupted) write (unit, '(a)') 'note: '//start_way_text(mechanism, way)
  end subroutine print_start_way

  !> A sentence about an interrupted motion to the start, without a full stop.
  function start_way_text(mechanism, way) result(text)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(start_way_type), intent(in) :: way        !< how the start was reached; it was interrupted
    character(len=:), allocatable :: text
    integer :: i, k

    text = 'the mechanism is drawn closed, but its motion from there to the start meets a singular position at '
    do i = 1, min(most_named, size(way%coordinates))
      k = way%coordinates(i)
      if (i > 1) text = text//', '
      text = text//'q'//named_number(mechanism%names%coordinates, k)//' = '//to_text(way%stopped(i)/unit_of(mechanism, k), 8)
    end do
    if (way%turned_around) then
      text = text//'; the start was reached the other way round'
    else
      text = text//'; the start may belong to another assembly, which &initial can choose from those of --branches'
    end if
  end function start_way_text
end module mech9_start_way_text
