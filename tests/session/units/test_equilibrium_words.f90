!> Sentences about positions of equilibrium: stable, unstable, indifferent, damped, and several of them.
module test_equilibrium_words
  use mech9_kinds, only: wp
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_mechanism, only: mechanism_type
  use mech9_equilibrium_words, only: print_findings
  use mech9_test_files, only: text_of_unit
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_equilibrium_words.txt'
  real(wp), parameter :: pi = acos(-1.0_wp)

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('one_equilibrium')) call one_equilibrium(tester)
    if (tester%runs('several')) call several(tester)
  end subroutine run

  !> An equilibrium of which the roots are known.
  subroutine with_roots(roots, is_stable, found)
    complex(wp), intent(in) :: roots(:)              !< [1/s]
    logical, intent(in) :: is_stable                 !< no root grows
    type(equilibrium_type), intent(out) :: found     !< the equilibrium

    found%is_stable = is_stable
    found%modes%count = size(roots)
    found%modes%roots = roots
    found%modes%growth = maxval(real(roots))
  end subroutine with_roots

  subroutine one_equilibrium(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(equilibrium_type) :: found

    ! a period of a half and of a fifth of a second
    call with_roots([(-0.1_wp, 0.0_wp) + (0.0_wp, 1.0_wp)*10.0_wp*pi, (0.0_wp, 1.0_wp)*4.0_wp*pi], .true., found)
    call says(found, 'a stable equilibrium; its lowest frequency is 2 Hz')
    call with_roots([(-4.0_wp, 0.0_wp), (-0.5_wp, 0.0_wp)], .true., found)
    call says(found, 'a stable equilibrium; it does not oscillate: deviations shrink by the factor e within 2 s')
    call with_roots([(0.0_wp, 0.0_wp), (0.0_wp, 3.0_wp)], .true., found)
    call says(found, 'a stable equilibrium; neighbouring positions are as good in 1 direction')
    call with_roots([(4.0_wp, 0.0_wp), (-4.0_wp, 0.0_wp)], .false., found)
    call says(found, 'an unstable equilibrium: a deviation grows by the factor e in 0.25 s')
    found%without_inertia = 3
    call says(found, 'an unstable equilibrium by its stiffness; coordinate 3 has no inertia, so that no growth can be told')
  contains
    subroutine says(found, expected)
      type(equilibrium_type), intent(in) :: found   !< the equilibrium
      character(len=*), intent(in) :: expected      !< the right sentence
      type(mechanism_type) :: plain
      character(len=:), allocatable :: text
      integer :: unit

      open (newunit=unit, file=path)
      call print_findings(unit, plain, 0, [found], .false.)
      call text_of_unit(tester, unit, text)
      call tester%is_true(text == expected//achar(10), 'the sentence: '//text)
    end subroutine says
  end subroutine one_equilibrium

  subroutine several(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(equilibrium_type) :: list(2)
    type(mechanism_type) :: plain
    character(len=:), allocatable :: text
    integer :: unit

    call with_roots([(0.0_wp, 3.0_wp)], .true., list(1))
    call with_roots([(3.0_wp, 0.0_wp)], .false., list(2))
    open (newunit=unit, file=path)
    call print_findings(unit, plain, 20, list, .false.)
    call print_findings(unit, plain, 20, list, .true.)
    call text_of_unit(tester, unit, text)
    call tester%is_true(index(text, '2 positions of equilibrium from the initial position and 20 random ones, '// &
                              '1 of them stable') == 1, &
                        'two of them: '//text)
    call tester%is_true(index(text, '2 positions of equilibrium found so far, 1 of them stable') > 0, 'an interruption')
  end subroutine several
end module test_equilibrium_words
