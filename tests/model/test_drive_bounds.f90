!> Bounds of the rates of drives: never below the fastest rate between two times, and not far above it
!> over short ones.
module test_drive_bounds
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_spline, only: build_spline
  use mech9_law, only: law_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_harmonic_law, only: harmonic_law_type
  use mech9_table_law, only: table_law_type
  use mech9_segments_law, only: segments_law_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('random_laws')) call random_laws(test)
    if (test%runs('many_terms')) call many_terms(test)
    if (test%runs('closed_forms')) call closed_forms(test)
  end subroutine run

  subroutine random_laws(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(polynomial_law_type) :: polynomial
    type(harmonic_law_type) :: harmonic
    type(table_law_type) :: table
    type(segments_law_type) :: segments
    type(error_type), allocatable :: err
    real(wp) :: x(12), y(12)
    integer :: i, j

    do i = 1, 40
      polynomial%coefficients = [(3.0_wp*random%symmetric(), j=0, mod(i, 8))]
      call check(test, random, polynomial, 'a polynomial')
      harmonic = harmonic_law_type(amplitude=random%symmetric(), angular_frequency=20.0_wp*random%symmetric(), phase=1.0_wp)
      call check(test, random, harmonic, 'a harmonic')
      do j = 1, size(x)
        x(j) = -3.0_wp + 0.5_wp*j + 0.2_wp*random%symmetric()
        y(j) = random%symmetric()
      end do
      call build_spline(x, y, table%spline, err)
      call test%no_error(err, 'a drive by a table is defined')
      call check(test, random, table, 'a table')
      segments%times = [(-3.0_wp + 0.5_wp*j + 0.2_wp*random%symmetric(), j=1, size(x))]
      segments%values = y
      segments%curves = [(2 + mod(i + j, 7), j=2, size(x))]
      segments%repeats = mod(i, 2) == 0
      call check(test, random, segments, 'segments')
      segments%times = segments%times*0.2_wp + 0.1_wp
      segments%repeats = .true.
      call check(test, random, segments, 'segments that repeat')
    end do
  end subroutine random_laws

  !> More terms than are worked out one by one.
  subroutine many_terms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(polynomial_law_type) :: polynomial
    integer :: i, j

    do i = 1, 10
      polynomial%coefficients = [(random%symmetric()/(1.0_wp + j), j=0, 12 + 3*i)]
      call check(test, random, polynomial, 'a polynomial')
    end do
    ! work that grew with the square of their number would take an hour
    polynomial%coefficients = [(1.0_wp/(1.0_wp + j)**2, j=0, 1000000)]
    call test%is_true(polynomial%greatest_rate(0.5_wp, 0.1_wp) > 0.5_wp, &
                      'the bound of a polynomial with a million coefficients is above its rate')
  end subroutine many_terms

  subroutine closed_forms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(polynomial_law_type) :: polynomial
    integer :: j

    polynomial%coefficients = [(0.5_wp**j, j=0, 1000)]
    call test%near(polynomial%greatest_rate(1.0_wp, 1.0e-3_wp), 0.5_wp/(1.0_wp - 0.5_wp*1.001_wp)**2, 1.0e-9_wp, &
                   'the bound of a polynomial with positive terms is its rate at the end')
    ! at rest at both ends and in the middle, with a swing between: 16 x^2 (1-x)^2 (1-2x)^2
    polynomial%coefficients = 16.0_wp*[0.0_wp, 0.0_wp, 1.0_wp, -6.0_wp, 13.0_wp, -12.0_wp, 4.0_wp]
    call test%is_true(polynomial%greatest_rate(0.0_wp, 1.0_wp) > 1.0_wp, 'a swing between two rests is seen')
    polynomial%coefficients = [1.0_wp, -2.5_wp]
    call test%near(polynomial%greatest_rate(7.0_wp, -3.0_wp), 2.5_wp, 1.0e-15_wp, 'the bound of a constant rate is this rate')
  end subroutine closed_forms

  !> Against the rates at many times between.
  subroutine check(test, random, drive, name)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the numbers
    class(law_type), intent(in) :: drive         !< the drive
    character(len=*), intent(in) :: name         !< of its kind, for the report of a failure
    real(wp) :: t, h, q, dq, ddq, bound, fastest
    type(error_type), allocatable :: err
    integer :: i, j

    do i = 0, 6
      t = 0.3_wp*random%symmetric()
      h = 2.0_wp*random%symmetric()*10.0_wp**(-i)
      bound = drive%greatest_rate(t, h)
      fastest = 0.0_wp
      do j = 0, 200
        call drive%evaluate(t + h*j/200.0_wp, q, dq, ddq, err)
        call test%no_error(err, name//' has a value')
        fastest = max(fastest, abs(dq))
      end do
      ! round-off of terms of some tens aside
      call test%is_true(bound >= fastest*(1.0_wp - 1.0e-12_wp) - 1.0e-13_wp, name//': the bound is not below the fastest rate')
      ! a harmonic is bounded by its whole swing, a table by its pieces, whatever the times
      if (i == 6 .and. name == 'a polynomial') &
        call test%near(bound, fastest, 1.0e-3_wp, name//': the bound is close to the fastest rate over a short time')
    end do
  end subroutine check
end module test_drive_bounds
