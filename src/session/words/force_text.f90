!> Sentences about the forces in pairs: which components equilibrium determines.
module mech9_force_text
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: print_uniqueness, print_undetermined, print_forceless, component_names

  !> Components of a wrench, in the axes of the pair's frame in its moving link.
  character(len=2), parameter :: component_names(6) = ['fx', 'fy', 'fz', 'mx', 'my', 'mz']

contains

  !> Print the components that equilibrium does not determine.
  subroutine print_uniqueness(unit, recorded, unique)
    integer, intent(in) :: unit              !< the output unit
    logical, intent(in) :: recorded(:)       !< (M) pairs whose forces are recorded
    logical, intent(in) :: unique(:, :)      !< (6,M) components that it determines
    character(len=:), allocatable :: names
    integer :: i, k

    if (all(unique .or. spread(.not. recorded, 1, 6))) then
      write (unit, '(a)') 'forces and moments in the pairs: equilibrium determines all components'
      return
    end if
    write (unit, '(a)') 'forces and moments in the pairs: equilibrium does not determine these components, for which those of '// &
      'least norm are given'
    write (unit, '(a)') '(in the axes of the pair''s frame in its moving link, z along the axis):'
    do k = 1, size(recorded)
      if (all(unique(:, k)) .or. .not. recorded(k)) cycle
      names = ''
      do i = 1, 6
        if (.not. unique(i, k)) names = names//' '//component_names(i)
      end do
      write (unit, '(a)') '  R'//to_text(k)//':'//names
    end do
  end subroutine print_uniqueness

  !> Print how many components equilibrium does not determine, if there are any.
  subroutine print_undetermined(unit, recorded, unique)
    integer, intent(in) :: unit              !< the output unit
    logical, intent(in) :: recorded(:)       !< (M) pairs whose forces are recorded
    logical, intent(in) :: unique(:, :)      !< (6,M) components that it determines
    integer :: n

    n = count(spread(recorded, 1, 6) .and. .not. unique)
    if (n > 0) write (unit, '(a)') 'equilibrium does not determine '//to_text(n)//' of the '//to_text(6*count(recorded))// &
      ' components of forces and moments in the pairs; --check names them, and those of least norm are given'
  end subroutine print_undetermined

  !> Say that all forces are zero, where no link has mass and no load acts.
  subroutine print_forceless(unit, mechanism)
    integer, intent(in) :: unit                     !< the output unit
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer :: i

    do i = 1, size(mechanism%bodies)
      if (mechanism%bodies(i)%link /= 1 .and. mechanism%bodies(i)%has_inertia()) return
    end do
    do i = 1, size(mechanism%loads)
      if (.not. mechanism%loads(i)%load%is_idle()) return
    end do
    write (unit, '(a)') 'note: no link has mass and no load acts, so that all forces of drives and in pairs are zero; '// &
      'give &body or &load'
  end subroutine print_forceless
end module mech9_force_text
