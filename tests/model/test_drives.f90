!> Drives: values by their formulas, derivatives against differences, tables and where they end.
module test_drives
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, place_type, exit_data
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_spline, only: build_spline
  use mech9_law, only: law_type
  use mech9_polynomial_law, only: polynomial_law_type
  use mech9_harmonic_law, only: harmonic_law_type
  use mech9_table_law, only: table_law_type
  use mech9_segments_law, only: segments_law_type
  use mech9_cam_curves, only: curve_number
  use mech9_request, only: time_grid_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A few roundings of numbers of order one.
  real(wp), parameter :: round_off = 1.0e-14_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('polynomials')) call polynomials(test)
    if (test%runs('harmonics')) call harmonics(test)
    if (test%runs('table_of_cubic')) call table_of_cubic(test)
    if (test%runs('table_of_sine')) call table_of_sine(test)
    if (test%runs('ends_of_table')) call ends_of_table(test)
    if (test%runs('time_grid')) call time_grid(test)
    if (test%runs('joints_of_segments')) call joints_of_segments(test)
  end subroutine run

  real(wp) function value_at(test, drive, t)
    type(tester_type), intent(inout) :: test   !< counts the checks
    class(law_type), intent(in) :: drive       !< the drive
    real(wp), intent(in) :: t                  !< time [s]
    type(error_type), allocatable :: err
    real(wp) :: dq, ddq

    call drive%evaluate(t, value_at, dq, ddq, err)
    if (allocated(err)) call test%no_error(err, 'a drive has a value where it is defined')
  end function value_at

  !> Derivatives as stated against differences of sixteenth order at h = 1/32: they leave the round-off
  !> of the values, of order one, times 2/h and 8/h^2.
  subroutine check_derivatives(test, drive, t, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    class(law_type), intent(in) :: drive       !< the drive
    real(wp), intent(in) :: t                  !< time [s]
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    real(wp), parameter :: h = 1.0_wp/32.0_wp
    type(error_type), allocatable :: err
    real(wp) :: values(-half_width:half_width), q, dq, ddq, first, second, error
    integer :: i

    do i = -half_width, half_width
      values(i) = value_at(test, drive, t + i*h)
    end do
    call derivatives_from_stencil(values, h, first, second, error)
    call drive%evaluate(t, q, dq, ddq, err)
    call test%no_error(err, why//': the drive has a value')
    call test%near(q, values(0), 0.0_wp, why//': the value is the same in each call')
    call test%near(dq, first, 1.0e-12_wp, why//': the first derivative is the slope of the values')
    call test%near(ddq, second, 5.0e-11_wp, why//': the second derivative is the curvature of the values')
  end subroutine check_derivatives

  subroutine polynomials(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(polynomial_law_type) :: drive
    type(error_type), allocatable :: err
    real(wp) :: t, q, dq, ddq
    integer :: n, i

    do n = 0, 7
      drive%coefficients = [(random%symmetric(), i=0, n)]
      t = 1.2_wp*random%symmetric()
      call test%near(value_at(test, drive, t), sum([(drive%coefficients(i + 1)*t**i, i=0, n)]), round_off, &
                     'a polynomial is the sum of its powers')
      call check_derivatives(test, drive, t, 'a polynomial')
      call drive%evaluate(0.0_wp, q, dq, ddq, err)
      call test%near(q, drive%coefficients(1), 0.0_wp, 'a polynomial has its first coefficient as value at zero')
      if (n >= 1) call test%near(dq, drive%coefficients(2), 0.0_wp, 'a polynomial has its second coefficient as rate at zero')
      if (n >= 2) call test%near(ddq, 2.0_wp*drive%coefficients(3), 0.0_wp, &
                                 'a polynomial has twice its third coefficient as second derivative at zero')
    end do
    drive%coefficients = [real(wp) ::]
    call drive%evaluate(0.7_wp, q, dq, ddq, err)
    call test%near(maxval(abs([q, dq, ddq])), 0.0_wp, 0.0_wp, 'a polynomial without coefficients rests at zero')
  end subroutine polynomials

  subroutine harmonics(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(harmonic_law_type) :: drive
    type(error_type), allocatable :: err
    real(wp) :: t, q, dq, ddq
    integer :: i

    do i = 1, 20
      drive%mean = random%symmetric()
      drive%amplitude = random%symmetric()
      drive%angular_frequency = 3.0_wp*random%symmetric()
      drive%phase = 4.0_wp*random%symmetric()
      t = 2.0_wp*random%symmetric()
      call check_derivatives(test, drive, t, 'a harmonic')
      call drive%evaluate(t, q, dq, ddq, err)
      call test%near(q, drive%mean + drive%amplitude*sin(drive%angular_frequency*t + drive%phase), round_off, &
                     'a harmonic is its formula')
      call test%near(ddq, -drive%angular_frequency**2*(q - drive%mean), round_off, &
                     'a harmonic satisfies the equation of oscillation')
      call test%near((drive%angular_frequency*(q - drive%mean))**2 + dq**2, &
                     (drive%angular_frequency*drive%amplitude)**2, round_off, 'the energy of a harmonic is constant')
      call test%near(value_at(test, drive, t + 2.0_wp*pi/drive%angular_frequency), q, &
                     round_off/min(1.0_wp, abs(drive%angular_frequency)), 'a harmonic repeats itself after its period')
    end do
  end subroutine harmonics

  !> Points of a cubic, unevenly spaced, give the cubic.
  subroutine table_of_cubic(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(table_law_type) :: table
    type(polynomial_law_type) :: cubic
    type(error_type), allocatable :: err
    real(wp) :: t(12), q(12), from_table(3), from_cubic(3), x
    integer :: i

    cubic%coefficients = [0.3_wp, -1.0_wp, 0.4_wp, 0.7_wp]
    t = [(0.2_wp*i + 0.08_wp*random%symmetric(), i=1, 12)]
    q = [(value_at(test, cubic, t(i)), i=1, 12)]
    call build_spline(t, q, table%spline, err)
    call test%no_error(err, 'a table of a cubic is accepted')
    do i = 0, 40
      x = t(1) + (t(12) - t(1))*i/40.0_wp
      call table%evaluate(x, from_table(1), from_table(2), from_table(3), err)
      call test%no_error(err, 'a table has a value within its range')
      call cubic%evaluate(x, from_cubic(1), from_cubic(2), from_cubic(3), err)
      ! values up to fourteen, distances down to 0.04: roundings by 2/h and 8/h^2 at worst
      call test%near(from_table(1), from_cubic(1), 1.0e-14_wp, 'a table of a cubic has the values of the cubic')
      call test%near(from_table(2), from_cubic(2), 1.0e-13_wp, 'a table of a cubic has the rates of the cubic')
      call test%near(from_table(3), from_cubic(3), 1.0e-11_wp, 'a table of a cubic has the second derivatives of the cubic')
    end do
  end subroutine table_of_cubic

  !> Within one piece a table is a cubic, whose derivatives differences find exactly.
  subroutine table_of_sine(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(table_law_type) :: table
    type(error_type), allocatable :: err
    real(wp) :: t(11)
    integer :: i

    t = [(0.75_wp*i, i=0, 10)]
    call build_spline(t, sin(t), table%spline, err)
    call test%no_error(err, 'a table of a sine is accepted')
    do i = 1, 10
      call test%near(value_at(test, table, t(i)), sin(t(i)), round_off, 'a table runs through its points')
      call check_derivatives(test, table, 0.5_wp*(t(i) + t(i + 1)), 'a piece of a table')
    end do
  end subroutine table_of_sine

  subroutine ends_of_table(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(table_law_type) :: table
    type(error_type), allocatable :: err
    real(wp) :: t(5), q, dq, ddq

    t = [1.0_wp, 1.5_wp, 2.0_wp, 2.5_wp, 3.0_wp]
    table%coordinate = 7
    table%place = place_type(12, 3)
    call build_spline(t, t**2, table%spline, err)
    call test%near(value_at(test, table, 1.0_wp), 1.0_wp, round_off, 'the first point belongs to the table')
    call test%near(value_at(test, table, 3.0_wp), 9.0_wp, round_off, 'the last point belongs to the table')
    call test%near(value_at(test, table, nearest(3.0_wp, 1.0_wp)), 9.0_wp, round_off, &
                   'a time one unit in the last place beyond the end is taken as the end')
    call test%near(value_at(test, table, nearest(1.0_wp, -1.0_wp)), 1.0_wp, round_off, &
                   'a time one unit in the last place before the beginning is taken as the beginning')
    call table%evaluate(3.001_wp, q, dq, ddq, err)
    call test%has_error(err, exit_data, 'a time after the end of a table is refused')
    call test%is_true(err%place%line == 12, 'the error of a time outside a table tells where the drive is written')
    call test%is_true(index(err%message, 'coordinate 7') > 0 .and. index(err%message, 'after t = 3 s') > 0 .and. &
                      index(err%message, 't = 3.001 s') > 0, &
                      'the message about a time outside a table names the coordinate, the last time and the time')
    call table%evaluate(0.999_wp, q, dq, ddq, err)
    call test%has_error(err, exit_data, 'a time before the beginning of a table is refused')
  end subroutine ends_of_table

  !> Times of results: evenly spaced, the ends exact.
  subroutine time_grid(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(time_grid_type) :: grid
    integer :: i

    grid%start = 0.1_wp
    grid%end = 0.7_wp
    grid%intervals = 7
    call test%near(grid%time(0), 0.1_wp, 0.0_wp, 'the first time is the start')
    call test%near(grid%time(7), 0.7_wp, 0.0_wp, 'the last time is the end')
    do i = 1, 7
      call test%near(grid%time(i) - grid%time(i - 1), 0.6_wp/7.0_wp, 2.0e-16_wp, 'times are evenly spaced')
    end do
  end subroutine time_grid

  !> Joints of a law that repeats: ends of segments, and eighths of those with modified laws. Their times change with those of the ends.
  subroutine joints_of_segments(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(segments_law_type) :: law, moved
    real(wp), parameter :: change(6) = [0.1_wp, -0.2_wp, 0.3_wp, 0.0_wp, 0.0_wp, 0.0_wp], step = 1.0e-6_wp
    real(wp) :: t, later
    integer :: i

    law%times = [0.0_wp, 0.5_wp, 4.5_wp]
    law%values = [0.0_wp, 0.0_wp, 1.0_wp]
    law%curves = [curve_number('dwell'), curve_number('modified-trapezoidal')]
    law%repeats = .true.
    moved = law
    moved%times = law%times + step*change(:3)
    t = 0.25_wp
    do i = 1, 12
      later = law%next_joint(t, 1.0_wp)
      call test%near(later, joint_number(i), 1.0e-14_wp, 'the next joint')
      call test%near(law%next_joint(later + 0.1_wp, -1.0_wp), later, 1.0e-14_wp, 'the joint before')
      ! times are linear in the ends: round-off of 10/step
      call test%near(law%joint_rate(change, later), (moved%next_joint(t, 1.0_wp) - later)/step, 1.0e-8_wp, 'its derivative')
      t = 0.5_wp*(later + joint_number(i + 1))
    end do
  contains
    !> The joints in their order: in each period of 4.5 s the end of the dwell, four eighths, and the end.
    pure real(wp) function joint_number(i) result(time)
      integer, intent(in) :: i   !< 1 for the first one
      real(wp), parameter :: in_period(6) = [0.5_wp, 1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 4.5_wp]

      time = in_period(modulo(i - 1, 6) + 1) + 4.5_wp*((i - 1)/6)
    end function joint_number
  end subroutine joints_of_segments
end module test_drives
