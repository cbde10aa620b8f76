!> Sentences about the forces in pairs: which components equilibrium determines.
module mech9_force_text
  use mech9_text, only: to_text, some_of
  use mech9_masks, only: numbers_of
  use mech9_uniqueness, only: uniqueness_type
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: print_uniqueness, print_undetermined, print_forceless

  !> Most numbers that a list shows.
  integer, parameter :: longest_list = 24

contains

  !> Print the components that equilibrium does not determine.
  subroutine print_uniqueness(unit, recorded, unique)
    integer, intent(in) :: unit              !< the output unit
    logical, intent(in) :: recorded(:)       !< (M) pairs whose forces are recorded
    type(uniqueness_type), intent(in) :: unique   !< components and forces that it determines
    integer :: k

    call print_couplings(unit, unique)
    if (all(unique%pairs .or. spread(.not. recorded, 1, 6))) then
      write (unit, '(a)') 'forces and moments in the pairs: equilibrium determines all components'
      return
    end if
    write (unit, '(a)') 'forces and moments in the pairs: equilibrium does not determine these components, for which those of '// &
      'least norm are given'
    write (unit, '(a)') '(x, y, z of the pair''s frame in its moving link, z along its axis; columns are along the axes of link 1):'
    do k = 1, size(recorded)
      if (all(unique%pairs(:, k)) .or. .not. recorded(k)) cycle
      write (unit, '(a)') '  pair '//to_text(k)//':'//components_in_words(unique%pairs(:, k))
    end do
  end subroutine print_uniqueness

  !> Components that are not determined, as " force along z, moment about x y".
  pure function components_in_words(unique) result(words)
    logical, intent(in) :: unique(6)    !< of the force and the moment
    character(len=:), allocatable :: words
    character(len=*), parameter :: axes(3) = ['x', 'y', 'z']
    integer :: i

    words = ''
    if (.not. all(unique(:3))) words = ' force along'
    do i = 1, 3
      if (.not. unique(i)) words = words//' '//axes(i)
    end do
    if (.not. (all(unique(:3)) .or. all(unique(4:)))) words = words//','
    if (.not. all(unique(4:))) words = words//' moment about'
    do i = 1, 3
      if (.not. unique(3 + i)) words = words//' '//axes(i)
    end do
  end function components_in_words

  !> Print how many components equilibrium does not determine, if there are any.
  subroutine print_undetermined(unit, recorded, unique)
    integer, intent(in) :: unit              !< the output unit
    logical, intent(in) :: recorded(:)       !< (M) pairs whose forces are recorded
    type(uniqueness_type), intent(in) :: unique   !< components and forces that it determines
    integer :: n

    call print_couplings(unit, unique)
    n = count(spread(recorded, 1, 6) .and. .not. unique%pairs)
    if (n > 0) write (unit, '(a)') 'equilibrium does not determine '//to_text(n)//' of the '//to_text(6*count(recorded))// &
      ' components of forces and moments in the pairs; --check names them, and those of least norm are given'
  end subroutine print_undetermined

  !> Print the couplings whose forces equilibrium does not determine, if there are any.
  subroutine print_couplings(unit, unique)
    integer, intent(in) :: unit                   !< the output unit
    type(uniqueness_type), intent(in) :: unique   !< components and forces that it determines

    if (all(unique%couplings)) return
    write (unit, '(a)') 'forces of couplings: equilibrium does not determine those of couplings '// &
      some_of(numbers_of(.not. unique%couplings), longest_list)//', which repeat each other or closed chains; those of least '// &
      'norm are given'
  end subroutine print_couplings

  !> Say that all forces are zero, where no link has mass and no load acts.
  subroutine print_forceless(unit, mechanism)
    integer, intent(in) :: unit                     !< the output unit
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer :: i

    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%link /= 1 .and. mechanism%bodies(i)%has_inertia()) return
    end do
    if (mechanism%has_forces()) return
    write (unit, '(a)') 'note: no link has mass and no load acts, so that all forces of drives and in pairs are zero; '// &
      'give &body or &load'
  end subroutine print_forceless
end module mech9_force_text
