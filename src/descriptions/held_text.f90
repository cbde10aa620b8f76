!> Lines about rods between ball joints that turn about themselves.
module mech9_held_text
  use mech9_named_words, only: with_names
  use mech9_text, only: to_text
  use mech9_idle_rods, only: idle_rod_type, find_idle_rods
  use mech9_held_rods, only: held_angle
  use mech9_partition, only: free_coordinate
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, unit_name
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
        if (size(rods(i)%links) == 1) then
          words = 'note: link '//to_text(rods(i)%links)//' can turn by itself'
        else
          words = 'note: links '//to_text(rods(i)%links)//' can turn by themselves'
        end if
        words = words//' between the '//trim(joint_name(joints(rods(i)%joints(1))))//' and the '// &
                trim(joint_name(joints(rods(i)%joints(2))))
      end associate
      if (has_negligible_inertia(model, rods(i)%links)) &
        words = words//', with a negligible moment of inertia about the line between them'
      words = words//'; coordinate '//to_text(k)//' is held at '// &
              to_text(model%problem%initial%position(k)/unit_of(model%mechanism, k), 6)//' '// &
              trim(unit_name(model%mechanism, k))//', or another angle of these joints where this one would stop the motion'
      write (unit, '(a)') with_names(model%mechanism%names, words)
    end do
  end subroutine print_held

  !> Whether links have inertia in a motion by forces, in which they are held because it is negligible.
  pure logical function has_negligible_inertia(model, links) result(has)
    type(model_type), intent(in) :: model   !< the model
    integer, intent(in) :: links(:)         !< numbers of links one of whose angles is held
    integer :: i

    has = .false.
    if (.not. any(model%problem%partition%kind == free_coordinate)) return
    do i = 1, size(model%mechanism%bodies)
      associate (body => model%mechanism%bodies(i))
        has = has .or. (any(links == body%link) .and. body%has_inertia())
      end associate
    end do
  end function has_negligible_inertia
end module mech9_held_text
