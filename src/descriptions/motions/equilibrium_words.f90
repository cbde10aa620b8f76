!> Sentences about positions of equilibrium.
module mech9_equilibrium_words
  use mech9_named_words, only: with_names
  use mech9_mechanism, only: mechanism_type
  use mech9_result_units, only: force_unit_name, si_force
  use mech9_kinds, only: wp, pi
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_linearised_equilibrium, only: equilibrium_type
  implicit none
  private
  public :: print_findings

contains

  !> Say what was found, in a line.
  subroutine print_findings(unit, mechanism, n_starts, list, interrupted)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    integer, intent(in) :: n_starts                 !< number of random starts
    type(equilibrium_type), intent(in) :: list(:)   !< the equilibria
    logical, intent(in) :: interrupted              !< the search was interrupted
    integer :: i

    if (interrupted) then
      write (unit, '(a)') counted(size(list), 'position')//' of equilibrium found so far, '// &
        to_text(count([(list(i)%is_stable, i=1, size(list))]))//' of them stable'
    else if (size(list) == 1) then
      write (unit, '(a)') with_names(mechanism%names, words_about(mechanism, list(1)))
    else
      write (unit, '(a)') counted(size(list), 'position')//' of equilibrium from the initial position and '// &
        counted(n_starts, 'random one')//', '// &
        to_text(count([(list(i)%is_stable, i=1, size(list))]))//' of them stable'
    end if
  end subroutine print_findings

  !> An equilibrium in words, with the stops that bear a force.
  function words_about(mechanism, found) result(words)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(equilibrium_type), intent(in) :: found   !< the equilibrium
    character(len=:), allocatable :: words
    integer :: i

    words = words_of_stability(mechanism, found)
    if (.not. allocated(found%resting%state)) return
    if (allocated(found%resting%state%contact_force)) call add_contacts(mechanism, found, words)
    if (.not. allocated(found%resting%state%stop_force)) return
    associate (force => found%resting%state%stop_force)
      do i = 1, size(force)
        associate (k => mechanism%stops(i)%coordinate)
          if (abs(force(i)) > 0.0_wp) words = words//'; stop '//to_text(i)//' bears '// &
            to_text(force(i)/mechanism%units%size_of(trim(si_force(mechanism%pairs(k)%pair))), 5)//' '// &
            trim(force_unit_name(mechanism, k))
        end associate
      end do
    end associate
  end function words_about

  !> Add the contacts that bear.
  subroutine add_contacts(mechanism, found, words)
    type(mechanism_type), intent(in) :: mechanism             !< the mechanism
    type(equilibrium_type), intent(in) :: found               !< the equilibrium
    character(len=:), allocatable, intent(inout) :: words     !< get them
    real(wp) :: force
    integer :: i, k

    do i = 1, maxval(mechanism%contacts%number)
      force = 0.0_wp
      do k = 1, size(mechanism%contacts)
        ! sides of one path have their forces together
        if (mechanism%contacts(k)%number == i) force = force + norm2(found%resting%state%contact_force(:, k))
      end do
      if (force > 0.0_wp) words = words//'; contact '//to_text(i)//' bears '// &
        to_text(force/mechanism%units%size_of('N'), 5)//' '//trim(mechanism%units%name_of('N'))
    end do
  end subroutine add_contacts

  !> The things that hold coordinates.
  function holders(mechanism, found) result(words)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(equilibrium_type), intent(in) :: found     !< the equilibrium
    character(len=:), allocatable :: words

    words = 'stops'
    if (.not. allocated(found%resting%state)) return
    if (.not. allocated(found%resting%state%contact_force)) return
    words = 'contacts'
    if (allocated(found%resting%state%stop_force)) words = 'stops and contacts'
  end function holders

  !> The stability of an equilibrium in words.
  function words_of_stability(mechanism, found) result(words)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(equilibrium_type), intent(in) :: found     !< the equilibrium
    character(len=:), allocatable :: words

    if (allocated(found%resting%free)) then
      if (size(found%resting%free) == 0) then
        words = 'an equilibrium in which '//holders(mechanism, found)//' hold all coordinates'
        return
      end if
    end if
    if (found%without_inertia > 0) then
      words = trim(merge('a stable equilibrium   ', 'an unstable equilibrium', found%is_stable))// &
              ' by its stiffness; coordinate '//to_text(found%without_inertia)//' has no inertia, so that no growth can be told'
    else if (.not. found%is_stable) then
      words = 'an unstable equilibrium: a deviation grows by the factor e in '//to_text(1.0_wp/found%modes%growth, 4)//' s'
    else if (any(abs(found%modes%roots(:found%modes%count)) <= 0.0_wp)) then
      words = 'a stable equilibrium; neighbouring positions are as good in '// &
              counted(count(abs(found%modes%roots(:found%modes%count)) <= 0.0_wp), 'direction')
    else
      words = 'a stable equilibrium; '//words_about_return(found%modes%roots(:found%modes%count))
    end if
  end function words_of_stability

  !> How a mechanism comes back to a stable equilibrium in which each direction has stiffness.
  function words_about_return(roots) result(words)
    complex(wp), intent(in) :: roots(:)   !< of the linearised equations of motion, none of them zero [1/s]
    character(len=:), allocatable :: words
    real(wp) :: frequency

    frequency = minval(abs(aimag(roots)), mask=abs(aimag(roots)) > 0.0_wp)/(2.0_wp*pi)
    if (any(abs(aimag(roots)) > 0.0_wp)) then
      words = 'its lowest frequency is '//to_text(frequency, 6)//' Hz'
    else
      words = 'it does not oscillate: deviations shrink by the factor e within '// &
              to_text(1.0_wp/minval(-real(roots)), 4)//' s'
    end if
  end function words_about_return
end module mech9_equilibrium_words
