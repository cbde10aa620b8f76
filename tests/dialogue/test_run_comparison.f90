!> Tests of rows kept after a run, of their list, and of two runs held against each other.
module test_run_comparison
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_kept_rows, only: kept_rows_type
  use mech9_rows_text, only: rows_text
  use mech9_run_comparison, only: comparison_type, compare_runs, comparison_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character, parameter :: eol = achar(10)

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('test_kept')) call test_kept(tester)
    if (tester%runs('test_thinned')) call test_thinned(tester)
    if (tester%runs('test_text')) call test_text(tester)
    if (tester%runs('test_comparison')) call test_comparison(tester)
    if (tester%runs('test_large_mechanism')) call test_large_mechanism(tester)
    if (tester%runs('test_common_times')) call test_common_times(tester)
  end subroutine run

  !> A run of n + 1 rows from 0 to 1 s: t, q1 = a t, P.x = 1 + a t^2, P.z = round-off that has the sign of a.
  function new_run(n, a) result(kept)
    integer, intent(in) :: n    !< intervals
    real(wp), intent(in) :: a   !< factor of the motion
    type(kept_rows_type) :: kept
    type(string_type) :: names(4), units(4)
    real(wp) :: t
    integer :: i

    names(1)%text = 't'
    names(2)%text = 'q1'
    names(3)%text = 'P.x'
    names(4)%text = 'P.z'
    units(1)%text = 's'
    units(2)%text = 'rad'
    units(3)%text = 'm'
    units(4)%text = 'm'
    call kept%begin('A run', names, units, n + 1)
    do i = 0, n
      t = real(i, wp)/n
      call kept%take(reshape([t, a*t, 1.0_wp + a*t**2, 1.0e-17_wp*a], [4, 1]))
    end do
  end function new_run

  subroutine test_kept(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(kept_rows_type) :: kept
    character(len=:), allocatable :: meant
    integer :: number

    kept = new_run(10, 2.0_wp)
    call tester%is_true(kept%count == 11 .and. kept%stride == 1, 'all rows are kept')
    call tester%near(kept%rows(2, 11), 2.0_wp, 0.0_wp, 'the last row that is kept is the last one of the run')
    call kept%column('P.x', number, meant)
    call tester%is_true(number == 3, 'a column is found by its name')
    call kept%column('P.y', number, meant)
    call tester%is_true(number == 0 .and. meant == 'P.x', 'a name that is nearly that of a column tells which was meant')
    call kept%column('velocity', number, meant)
    call tester%is_true(number == 0 .and. meant == '', 'a name that is like no column tells nothing')
  end subroutine test_kept

  !> A run that is too long for the memory is kept in part: the first row, and then every n-th one.
  subroutine test_thinned(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(kept_rows_type) :: kept
    type(string_type) :: names(1), units(1)
    integer, parameter :: n = 40000000
    real(wp) :: rows(1, 1000)
    integer :: i, k

    names(1)%text = 't'
    units(1)%text = 's'
    call kept%begin('A long run', names, units, n)
    do i = 0, 99
      rows(1, :) = [(real(1000*i + k, wp), k=0, 999)]
      call kept%take(rows)
    end do
    call tester%is_true(kept%stride > 1, 'not all of forty million numbers are kept')
    call tester%is_true(size(kept%rows, kind=8) <= 2_8**24 + 1, 'as many numbers are kept as there is memory for')
    call tester%is_true(kept%count == (100000 - 1)/kept%stride + 1, 'as many rows are kept as the stride leaves')
    call tester%near(kept%rows(1, kept%count), real((kept%count - 1)*kept%stride, wp), 0.0_wp, &
                     'each row that is kept has its number')
  end subroutine test_thinned

  subroutine test_text(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text

    text = rows_text(new_run(4, 2.0_wp), [1, 3], 2)
    call tester%is_true(text == '            t          P.x'//eol//'            s            m'//eol// &
                        '         0.75        2.125'//eol//'            1            3'//eol// &
                        '(the last 2 of 5 rows; 2 of 4 columns)'//eol, 'the last two rows of two columns are printed: '//eol//text)
  end subroutine test_text

  !> Lengths a million times larger: the round-off of P.z is no number near zero any more, but nothing beside P.x of the same unit.
  subroutine test_large_mechanism(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(kept_rows_type) :: earlier, later
    type(comparison_type) :: comparison

    earlier = new_run(10, 2.0_wp)
    later = new_run(10, 2.5_wp)
    earlier%rows(3, :) = 1.0e6_wp*earlier%rows(3, :)
    earlier%rows(4, :) = 2.0e-9_wp
    later%rows(3, :) = 1.0e6_wp*later%rows(3, :)
    later%rows(4, :) = 2.5e-9_wp
    call compare_runs(earlier, later, comparison)
    call tester%is_true(size(comparison%columns) == 2 .and. comparison%alike == 1, 'round-off of large lengths does not differ')
  end subroutine test_large_mechanism

  !> q1 differs by |a - b| at t = 1 s; P.x as well, a smaller share; P.z by no more than round-off.
  subroutine test_comparison(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(comparison_type) :: comparison
    character(len=:), allocatable :: text

    call compare_runs(new_run(10, 2.0_wp), new_run(10, 2.5_wp), comparison)
    call tester%is_true(comparison%times == 11, 'runs are compared at all their times')
    call tester%is_true(size(comparison%columns) == 2 .and. comparison%alike == 1 .and. comparison%same == 0, &
                        'two columns differ, and one of the others by round-off')
    associate (first => comparison%columns(1), second => comparison%columns(2))
      call tester%is_true(first%column == 2 .and. second%column == 3, 'the column that differs by the greatest share comes first')
      call tester%near(first%difference, 0.5_wp, 1.0e-15_wp, 'the difference of q1 is right')
      call tester%near(first%share, 0.5_wp/2.5_wp, 1.0e-15_wp, 'the difference of q1 is a part of the largest value of its unit')
      call tester%near(second%difference, 0.5_wp, 1.0e-15_wp, 'the difference of P.x is right')
      call tester%near(second%share, 0.5_wp/3.5_wp, 1.0e-15_wp, &
                       'the difference of P.x is a part of the largest value of P.x and P.z')
      call tester%near(second%time, 1.0_wp, 0.0_wp, 'the greatest difference of P.x is found at the end')
      call tester%near(second%before, 3.0_wp, 1.0e-15_wp, 'the value of P.x in the first run is told')
      call tester%near(second%after, 3.5_wp, 1.0e-15_wp, 'the value of P.x in the second run is told')
    end associate
    call compare_runs(new_run(10, 2.5_wp), new_run(10, 2.0_wp), comparison)
    call tester%near(comparison%columns(1)%share, 0.5_wp/2.5_wp, 1.0e-15_wp, &
                     'the share does not depend on which run has the larger values')
    call compare_runs(new_run(10, 2.0_wp), new_run(10, 2.5_wp), comparison)
    text = comparison_text(comparison, new_run(10, 2.5_wp))
    call tester%is_true(index(text, '2 columns differ, 1 does not') > 0 .and. index(text, 'q1') < index(text, 'P.x'), &
                        'the comparison is told in words: '//text)
    call compare_runs(new_run(10, 2.0_wp), new_run(10, 2.0_wp), comparison)
    text = comparison_text(comparison, new_run(10, 2.0_wp))
    call tester%is_true(comparison%same == 3 .and. index(text, 'to the last bit') > 0, &
                        'a run is the same as itself to the last bit')
  end subroutine test_comparison

  subroutine test_common_times(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(comparison_type) :: comparison
    type(kept_rows_type) :: later

    call compare_runs(new_run(10, 2.0_wp), new_run(15, 2.0_wp), comparison)
    call tester%is_true(comparison%times == 6, 'tenths and fifteenths of a second have fifths in common')
    call tester%is_true(size(comparison%columns) == 0, 'runs that are the same have no columns that differ')
    later = new_run(10, 2.0_wp)
    later%rows(1, :) = later%rows(1, :) + 5.0_wp
    call compare_runs(new_run(10, 2.0_wp), later, comparison)
    call tester%is_true(comparison%times == 0 .and. &
                        index(comparison_text(comparison, later), 'no time in common') > 0, &
                        'runs without a time in common are told as such')
  end subroutine test_common_times
end module test_run_comparison
