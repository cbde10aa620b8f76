!> Numbers of a column along a motion, y = a sin(b t) + c: extremes, means and integrals in closed form, with their derivatives by a, b
!> and c, from outputs with two derivatives and from values between outputs.
module test_quantities
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type, new_chebyshev
  use mech9_smooth_pieces, only: smooth_piece_type
  use mech9_tracked_quantity, only: tracked_quantity_type
  use mech9_quantity_sums, only: quantity_sums_type
  use mech9_quantity_gradient, only: quantity_gradient_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: a = 1.3_wp, b = 2.1_wp, c = 0.2_wp
  !> End of the motion [s], after a largest and a least value, and its outputs.
  real(wp), parameter :: t_end = 2.6_wp
  integer, parameter :: outputs = 26
  character(len=8), parameter :: takes(*) = [character(len=8) :: 'start', 'end', 'min', 'max', 'peak', 'range', 'mean', 'rms', &
                                             'integral']

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('with_derivatives')) call follow_all(tester, .true.)
    if (tester%runs('by_values')) call follow_all(tester, .false.)
    if (tester%runs('one_polynomial')) call one_polynomial(tester)
    if (tester%runs('no_time')) call no_time(tester)
    if (tester%runs('no_gradient')) call no_gradient(tester)
  end subroutine run

  !> The column, its derivatives in time, and those of all of them by a, b and c: a row of results, time first.
  pure function row_at(t) result(row)
    real(wp), intent(in) :: t   !< time [s]
    real(wp) :: row(13)

    row(1) = t
    row(2:4) = [a*sin(b*t) + c, a*b*cos(b*t), -a*b**2*sin(b*t)]
    row(5:7) = [sin(b*t), b*cos(b*t), -b**2*sin(b*t)]
    row(8:10) = [a*t*cos(b*t), a*cos(b*t) - a*b*t*sin(b*t), -2.0_wp*a*b*sin(b*t) - a*b**2*t*cos(b*t)]
    row(11:13) = [1.0_wp, 0.0_wp, 0.0_wp]
  end function row_at

  !> A number in closed form, and its derivatives by a, b and c.
  pure subroutine closed_form(take, number, gradient)
    character(len=*), intent(in) :: take       !< name of the number
    real(wp), intent(out) :: number            !< the number
    real(wp), intent(out) :: gradient(3)       !< its derivatives
    real(wp) :: row(13), s, s_by_b, square, square_by_b

    ! integrals of sin(b t) and of its square, and their derivatives
    s = (1.0_wp - cos(b*t_end))/b
    s_by_b = t_end*sin(b*t_end)/b - s/b
    square = 0.5_wp*t_end - sin(2.0_wp*b*t_end)/(4.0_wp*b)
    square_by_b = -0.5_wp*t_end*cos(2.0_wp*b*t_end)/b + sin(2.0_wp*b*t_end)/(4.0_wp*b**2)
    row = row_at(merge(0.0_wp, t_end, take == 'start'))
    number = row(2)
    gradient = row([5, 8, 11])
    select case (take)
    case ('max', 'peak')
      number = a + c
      gradient = [1.0_wp, 0.0_wp, 1.0_wp]
    case ('min')
      number = c - a
      gradient = [-1.0_wp, 0.0_wp, 1.0_wp]
    case ('range')
      number = 2.0_wp*a
      gradient = [2.0_wp, 0.0_wp, 0.0_wp]
    case ('integral')
      number = a*s + c*t_end
      gradient = [s, a*s_by_b, t_end]
    case ('mean')
      number = (a*s + c*t_end)/t_end
      gradient = [s, a*s_by_b, t_end]/t_end
    case ('rms')
      number = sqrt((a**2*square + 2.0_wp*a*c*s + c**2*t_end)/t_end)
      gradient = [a*square + c*s, 0.5_wp*a**2*square_by_b + a*c*s_by_b, a*s + c*t_end]/(t_end*number)
    end select
  end subroutine closed_form

  !> All numbers of the column.
  subroutine follow_all(tester, with_derivatives)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    logical, intent(in) :: with_derivatives      !< outputs have two derivatives; else there are values between them
    type(tracked_quantity_type) :: quantity
    real(wp) :: number, gradient(3), found(3)
    integer :: i

    do i = 1, size(takes)
      call follow(takes(i), with_derivatives, quantity)
      call closed_form(takes(i), number, gradient)
      call quantity%find_gradient(found)
      ! polynomials of degree 11 over intervals of 0.1 s: b^12 (0.05)^12/12! and less for the values, and roots of it for times
      call tester%near(quantity%number(), number, 1.0e-12_wp, trim(takes(i))//' of a sine')
      call tester%near(maxval(abs(found - gradient)), 0.0_wp, 1.0e-9_wp, trim(takes(i))//': its derivatives')
    end do
  end subroutine follow_all

  !> Follow the column to its end.
  subroutine follow(take, with_derivatives, quantity)
    character(len=*), intent(in) :: take                   !< name of the number
    logical, intent(in) :: with_derivatives                !< outputs have two derivatives
    type(tracked_quantity_type), intent(out) :: quantity   !< the number
    type(chebyshev_type) :: rule
    type(smooth_piece_type) :: piece
    real(wp), allocatable :: values(:), changes(:, :), no_joint(:)
    real(wp) :: row(13), from, to
    integer :: i, j

    call new_chebyshev(12, rule)
    allocate (values(rule%n), changes(3, rule%n))
    quantity%take = take
    quantity%column = 2
    if (with_derivatives) quantity%family = [2, 3, 4]
    if (with_derivatives) call quantity%follow_changes(reshape([5, 8, 11, 6, 9, 12, 7, 10, 13], [3, 3]))
    if (.not. with_derivatives) call quantity%follow_changes(reshape([5, 8, 11], [3, 1]))
    do i = 0, outputs
      to = t_end*i/outputs
      row = row_at(to)
      call quantity%take_output(row)
      if (i == 0) call quantity%begin_piece(row, no_joint)
      if (i > 0) then
        do j = 1, rule%n
          row = row_at(from + 0.5_wp*(to - from)*(1.0_wp + rule%points(j)))
          values(j) = row(2)
          changes(:, j) = row([5, 8, 11])
        end do
        piece%from = from
        piece%to = to
        call quantity%end_piece(rule, piece, 3, row_at(to), values, changes)
      end if
      from = to
    end do
    call quantity%finish(rule)
  end subroutine follow

  !> A cubic over one interval: its extremes lie at the zeros of its derivative, within the interval.
  subroutine one_polynomial(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(quantity_sums_type) :: sums
    type(chebyshev_type) :: rule
    real(wp), allocatable :: t(:)

    ! y = t^3 - 3 t from -1.5 to 1.75: 2 at -1, -2 at 1
    call new_chebyshev(6, rule)
    t = -1.5_wp + 1.625_wp*(1.0_wp + rule%points)
    call sums%begin(-1.5_wp, (-1.5_wp)**3 + 4.5_wp)
    call sums%add_piece(rule, -1.5_wp, 1.75_wp, t**3 - 3.0_wp*t)
    ! values are exact; times of extremes are exact to the root of round-off of values at worst, and to that of slopes here
    call tester%near(sums%result_of('max'), 2.0_wp, 1.0e-14_wp, 'the largest value')
    call tester%near(sums%time_high, -1.0_wp, 1.0e-12_wp, 'its time')
    call tester%near(sums%result_of('min'), -2.0_wp, 1.0e-14_wp, 'the least value')
    call tester%near(sums%time_low, 1.0_wp, 1.0e-12_wp, 'its time')
    call tester%near(sums%result_of('integral'), (1.75_wp**4 - 1.5_wp**4)/4.0_wp - 1.5_wp*(1.75_wp**2 - 1.5_wp**2), 1.0e-14_wp, &
                     'the integral')
    call tester%near(sums%duration, 3.25_wp, 1.0e-15_wp, 'the duration')
    ! less by 1, from -3 to 1
    call sums%begin(-1.5_wp, (-1.5_wp)**3 + 3.5_wp)
    call sums%add_piece(rule, -1.5_wp, 1.75_wp, t**3 - 3.0_wp*t - 1.0_wp)
    call tester%near(sums%result_of('peak'), 3.0_wp, 1.0e-14_wp, 'the peak is the largest magnitude')
  end subroutine one_polynomial

  !> Over no time, means are the value at the start.
  subroutine no_time(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(quantity_sums_type) :: sums

    call sums%begin(0.5_wp, -3.0_wp)
    call tester%near(sums%result_of('mean'), -3.0_wp, 0.0_wp, 'the mean')
    call tester%near(sums%result_of('rms'), 3.0_wp, 0.0_wp, 'the root of the mean square')
    call tester%near(sums%result_of('peak'), 3.0_wp, 0.0_wp, 'the peak')
    call tester%near(sums%result_of('integral'), 0.0_wp, 0.0_wp, 'the integral')
  end subroutine no_time

  !> The root of a mean square that is zero has no derivative, unless the column does not change.
  subroutine no_gradient(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(quantity_sums_type) :: sums
    type(quantity_gradient_type) :: gradient
    type(chebyshev_type) :: rule
    real(wp), allocatable :: zeros(:), changes(:, :)
    real(wp) :: found(2)

    call new_chebyshev(4, rule)
    allocate (zeros(rule%n), changes(2, rule%n), source=0.0_wp)
    changes(1, :) = 1.0_wp
    call sums%begin(0.0_wp, 0.0_wp)
    call gradient%begin([1.0_wp, 0.0_wp])
    call sums%add_piece(rule, 0.0_wp, 1.0_wp, zeros)
    call gradient%add_piece(rule, 0.0_wp, 1.0_wp, zeros, changes)
    call gradient%result_of('rms', sums, found)
    call tester%is_true(ieee_is_nan(found(1)), 'the root of zero has no derivative')
    call tester%near(found(2), 0.0_wp, 0.0_wp, 'a column that does not change has the derivative zero')
    call gradient%result_of('mean', sums, found)
    call tester%near(maxval(abs(found - [1.0_wp, 0.0_wp])), 0.0_wp, 1.0e-15_wp, 'means have derivatives')
  end subroutine no_gradient
end module test_quantities
