!> The transformation stays near-linear: valid at 10,000 links of every kind of structure, and the
!> work for ten times the links is not much more than ten times the work.
!>
!> The hardest kind is the ladder with rungs as long as it has rungs: there each label is mended as
!> often as half a rung is long, so the work grows with the power 1.5 of the links.
module test_transformation_growth
  use mech9_kinds, only: wp, long
  use mech9_text, only: to_text
  use mech9_structure, only: structure_type
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_transformation, only: transform
  use mech9_testing, only: tester_type
  use random_structures, only: random_structure, n_kinds, kind_names
  use vector_definition, only: what_is_wrong
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks
    integer :: kind

    do kind = 1, n_kinds
      if (tester%runs(trim(kind_names(kind)))) call check_growth(tester, kind)
    end do
  end subroutine run

  subroutine check_growth(tester, kind)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, intent(in) :: kind                  !< of the random structures
    real(wp) :: work_small, work_large, time_small, time_large
    real(wp) :: most
    integer(long) :: pairs_small, pairs_large

    ! n log n gives a factor 13, n**1.5 gives 32, and n**2 gives 100
    most = merge(50.0_wp, 25.0_wp, kind_names(kind) == 'long rungs')
    call measure(tester, kind, 1000, 10, work_small, time_small, pairs_small)
    call measure(tester, kind, 10000, 3, work_large, time_large, pairs_large)
    print '(a20,2(a,f8.1),2(a,f9.3))', kind_names(kind), 'operations a pair:', work_small/pairs_small, &
      ' and', work_large/pairs_large, '   ms:', 1000*time_small, ' and', 1000*time_large
    call tester%is_true(work_large < most*work_small, &
                        trim(kind_names(kind))//': the number of operations grows almost in proportion to the links')
    ! time is only a rough witness on a busy machine: twice the factor, and half a millisecond of slack
    call tester%is_true(time_large < 2*most*(time_small + 5.0e-4_wp), &
                        trim(kind_names(kind))//': the time grows almost in proportion to the links')
  end subroutine check_growth

  !> Mean operations and least time of some structures.
  subroutine measure(tester, kind, n, seeds, work, time, pairs)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, intent(in) :: kind                  !< of the random structures
    integer, intent(in) :: n                     !< links, about
    integer, intent(in) :: seeds                 !< structures
    real(wp), intent(out) :: work                !< operations
    real(wp), intent(out) :: time                !< [s]
    integer(long), intent(out) :: pairs          !< of all structures together
    type(structure_type) :: structure
    logical, allocatable :: independent(:)
    type(structural_vectors_type) :: vectors
    character(len=:), allocatable :: wrong
    integer(long) :: operations
    real(wp) :: began, ended
    integer :: seed

    work = 0.0_wp
    pairs = 0
    time = huge(time)
    do seed = 1, seeds
      call random_structure(kind, n, seed, structure, independent)
      call cpu_time(began)
      call transform(structure, independent, vectors, operations)
      call cpu_time(ended)
      work = work + real(operations, wp)/seeds
      pairs = pairs + structure%n_coordinates
      time = min(time, ended - began)
      wrong = what_is_wrong(structure, independent, vectors)
      call tester%is_true(wrong == '', 'the vectors are as defined: '//trim(kind_names(kind))//', '//to_text(n)// &
                          ' links, seed '//to_text(seed)//': '//wrong)
    end do
    pairs = pairs/seeds
  end subroutine measure
end module test_transformation_growth
