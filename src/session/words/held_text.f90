!> Lines about rods between ball joints that turn about themselves.
module mech9_held_text
  use mech9_text, only: to_text
  use mech9_idle_rods, only: idle_rod_type, find_idle_rods
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of
  use mech9_joint_words, only: joint_name
  implicit none
  private
  public :: print_held

contains

  !> Write a line for each rod one of whose angles the program has made independent.
  subroutine print_held(unit, model)
    integer, intent(in) :: unit               !< Fortran unit to write to
    type(model_type), intent(in) :: model     !< the model
    type(idle_rod_type), allocatable :: rods(:)
    character(len=:), allocatable :: words
    integer :: i, k

    call find_idle_rods(model%mechanism%structure, rods)
    do i = 1, size(rods)
      associate (joints => model%mechanism%structure%joints)
        k = held_angle(model, [joints(rods(i)%joints(1))%coordinates(), joints(rods(i)%joints(2))%coordinates()])
        if (k == 0) cycle
        words = 'note: link '//to_text(rods(i)%link)//' can turn by itself between the '// &
                trim(joint_name(joints(rods(i)%joints(1))))//' and the '//trim(joint_name(joints(rods(i)%joints(2))))
      end associate
      write (unit, '(a)') words//'; coordinate '//to_text(k)//' is held at '// &
        to_text(model%problem%initial%position(k)/unit_of(model%mechanism, k), 6)
    end do
  end subroutine print_held

  !> The one of some coordinates that the program holds: its drive has no place in the data file. 0: there is none.
  pure integer function held_angle(model, coordinates) result(k)
    type(model_type), intent(in) :: model        !< the model
    integer, intent(in) :: coordinates(:)        !< numbers of coordinates
    integer :: i

    k = 0
    do i = 1, size(model%problem%drives)
      associate (drive => model%problem%drives(i)%drive)
        if (drive%place%line == 0 .and. any(coordinates == drive%coordinate)) k = drive%coordinate
      end associate
    end do
  end function held_angle
end module mech9_held_text
