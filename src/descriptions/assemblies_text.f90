!> The assemblies of a mechanism in words, for --branches.
module mech9_assemblies_text
  use mech9_named_words, only: named_list
  use mech9_part_names, only: part_names_type, name_in
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_mechanism, only: mechanism_type
  use mech9_joint_words, only: shown_of
  use mech9_result_units, only: unit_of
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_assemblies, only: assembly_list_type, find_assemblies
  implicit none
  private
  public :: print_assemblies

  !> So many links are listed at most.
  integer, parameter :: most_links = 24

contains

  !> Find the assemblies for the independent coordinates of the start and print each as groups &initial. An assembly becomes
  !> the start when its groups are put into the data file.
  subroutine print_assemblies(unit, mechanism, plan, start, n_starts)
    integer, intent(in) :: unit                    !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    type(state_type), intent(in) :: start          !< the closed position at the start
    integer, intent(in) :: n_starts                !< number of random starts
    type(assembly_list_type) :: list
    character(len=24) :: number
    character(len=:), allocatable :: words, reference
    integer :: i, k

    call find_assemblies(mechanism, plan, start, n_starts, list)
    write (unit, '(a)') '! '//counted(size(list%found), 'assembly')//' found from '//counted(list%starts, 'start')// &
      ', of which '//to_text(list%closed)//' could be closed'
    if (size(list%posture%unseen) > 0) call print_unseen(unit, mechanism%names, shown_of(mechanism%structure, list%posture%unseen))
    do i = 1, size(list%found)
      words = ''
      if (i == 1) words = '; that of the data file'
      if (i > 1 .and. list%found(i) == 0) words = '; found on the way from others'
      write (unit, '(a)') '! assembly '//to_text(i)//', from '//counted(list%found(i), 'start')//words
      do k = 1, plan%n_coordinates
        if (.not. plan%steps(plan%step_of(k))%dependent) cycle
        write (number, '(es24.16)') list%q(k, i)/unit_of(mechanism, k)
        reference = to_text(k)
        if (name_in(mechanism%names%coordinates, k) /= '') reference = ''''//trim(name_in(mechanism%names%coordinates, k))//''''
        write (unit, '(a)') '&initial coordinate='//reference//', position='//trim(adjustl(number))//' /'
      end do
    end do
  end subroutine print_assemblies

  !> Say which settings make no assembly of their own.
  subroutine print_unseen(unit, names, links)
    integer, intent(in) :: unit       !< Fortran unit to write to
    type(part_names_type), intent(in) :: names   !< of links and pairs
    integer, intent(in) :: links(:)   !< links of joints and rods, but for those that the user does not know

    if (size(links) > 0) then
      write (unit, '(a)') '! these links only form joints, or rods between joints, and their settings are not counted: '// &
        named_list(names%links, links, most_links)
    else
      write (unit, '(a)') '! settings of the angles of one joint are not counted'
    end if
  end subroutine print_unseen
end module mech9_assemblies_text
