!> Sentences about the forces in pairs: which components equilibrium determines.
module mech9_force_text
  use mech9_named_words, only: with_names
  use mech9_part_names, only: part_names_type
  use mech9_kinds, only: wp
  use mech9_text, only: to_text, some_of
  use mech9_masks, only: numbers_of
  use mech9_uniqueness, only: uniqueness_type, component_names
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: print_uniqueness, print_undetermined, print_forceless, print_across

  !> A normal whose other parts are below this is an axis of link 1.
  real(wp), parameter :: along_axis = 1.0e-12_wp
  !> Most numbers that a list shows.
  integer, parameter :: longest_list = 24

contains

  !> Print the components that equilibrium does not determine, with their columns in the results.
  subroutine print_uniqueness(unit, names, recorded, unique, in_links)
    integer, intent(in) :: unit              !< the output unit
    type(part_names_type), intent(in) :: names    !< of links and pairs
    logical, intent(in) :: recorded(:)       !< (M) pairs whose forces are recorded
    type(uniqueness_type), intent(in) :: unique   !< components and forces that it determines
    logical, intent(in) :: in_links          !< columns are along the axes of the moving links; else of link 1
    integer :: k

    call print_couplings(unit, unique)
    if (all(unique%pairs .or. spread(.not. recorded, 1, 6))) then
      write (unit, '(a)') 'forces and moments in the pairs: equilibrium determines all components'
      return
    end if
    write (unit, '(a)') 'forces and moments in the pairs: equilibrium does not determine these components, for which those of '// &
      'least norm are given'
    write (unit, '(a)') '(x, y, z of the pair''s frame in its moving link, z along its axis; columns are along the axes of '// &
      trim(merge('the moving links):', 'link 1):          ', in_links))
    do k = 1, size(recorded)
      if (all(unique%pairs(:, k)) .or. .not. recorded(k)) cycle
      write (unit, '(a)') with_names(names, '  pair '//to_text(k)//':'//components_in_words(unique%pairs(:, k))// &
                                     '; columns'//columns_in_words(k, unique%shown(in_links)))
    end do
  end subroutine print_uniqueness

  !> Say that the components which equilibrium does not determine are across the plane of the mechanism, where they are.
  subroutine print_across(unit, normal, recorded, unique)
    integer, intent(in) :: unit              !< the output unit
    real(wp), intent(in) :: normal(3)        !< of the plane, in the axes of link 1
    logical, intent(in) :: recorded(:)       !< (M) pairs whose forces are recorded
    type(uniqueness_type), intent(in) :: unique   !< components and forces that it determines
    logical :: open(6)
    integer :: k

    open = [(any(recorded .and. .not. unique%fixed(k, :)), k=1, 6)]
    k = maxloc(abs(normal), dim=1)
    if (.not. any(open) .or. norm2(pack(normal, [1, 2, 3] /= k)) > along_axis) return
    if (any(pack(open(:3), [1, 2, 3] /= k)) .or. open(3 + k)) return
    write (unit, '(a)') 'they are forces across the plane of the mechanism and moments about axes in it; all in the plane is '// &
      'determined'
  end subroutine print_across

  !> The columns of a pair that are not determined, as " R1.fz R1.mx".
  pure function columns_in_words(k, unique) result(words)
    integer, intent(in) :: k             !< number of the pair
    logical, intent(in) :: unique(:, :)  !< (6,M) components that are determined
    character(len=:), allocatable :: words
    integer :: i

    words = ''
    do i = 1, 6
      if (.not. unique(i, k)) words = words//' R'//to_text(k)//'.'//component_names(i)
    end do
  end function columns_in_words

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

  !> Print the columns that equilibrium does not determine, if there are any.
  subroutine print_undetermined(unit, recorded, unique, in_links)
    integer, intent(in) :: unit              !< the output unit
    logical, intent(in) :: recorded(:)       !< (M) pairs whose forces are recorded
    type(uniqueness_type), intent(in) :: unique   !< components and forces that it determines
    logical, intent(in) :: in_links          !< columns are along the axes of the moving links; else of link 1
    logical :: open(6, size(recorded))
    character(len=:), allocatable :: words
    integer :: k, listed

    call print_couplings(unit, unique)
    open = spread(recorded, 1, 6) .and. .not. unique%shown(in_links)
    if (.not. any(open)) return
    words = ''
    listed = 0
    do k = 1, size(recorded)
      if (listed + count(open(:, k)) > longest_list) exit
      words = words//columns_in_words(k, .not. open)
      listed = listed + count(open(:, k))
    end do
    if (listed < count(open)) words = words//' and others, which --check names'
    write (unit, '(a)') 'equilibrium does not determine '//to_text(count(open))//' of the '//to_text(6*count(recorded))// &
      ' components of forces and moments in the pairs:'//words//'; those of least norm are given'
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
