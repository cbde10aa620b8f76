!> A quantity while a motion goes on: its column is followed between the outputs by polynomials.
!>
!> A column that comes with its rate and acceleration, or is one of these, is a polynomial through four neighbouring outputs with
!> two derivatives each. Others are polynomials through values at further times, which the motion must visit.
module mech9_tracked_quantity
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type
  use mech9_hermite, only: hermite_type, build_hermite
  use mech9_quantity_sums, only: quantity_sums_type
  implicit none
  private
  public :: tracked_quantity_type

  integer, parameter :: most_outputs = 4   !< outputs through which a polynomial goes
  !> Largest difference of the polynomials through two and through all outputs, over the variation of the column, with which the
  !> motion counts as smooth there; else the polynomial goes through the two outputs alone.
  real(wp), parameter :: smooth_difference = 1.0e-3_wp

  type :: tracked_quantity_type
    character(len=8) :: take = ''           !< start, end, min, max, peak, range, mean, rms, integral or at
    real(wp) :: at = 0.0_wp                 !< time of the value where `take` is at [s]
    integer :: column = 0                   !< number of its column
    integer :: family(0:2) = 0              !< columns of a position, its rate and its acceleration; 0 where they are not known
    integer :: order = 0                    !< of its column: 0 position, 1 rate, 2 acceleration
    type(quantity_sums_type) :: sums
    real(wp), private :: value_at = 0.0_wp  !< value at the time `at`
    integer, private :: seen = 0            !< outputs so far
    integer, private :: count = 0           !< outputs kept
    integer, private :: done = 0            !< intervals between these that were taken into account
    real(wp), private :: t(most_outputs) = 0.0_wp
    real(wp), private :: y(0:2, most_outputs) = 0.0_wp    !< position, rate and acceleration at the kept outputs
  contains
    procedure :: needs_piece
    procedure :: is_at_start
    procedure :: take_output
    procedure :: take_at
    procedure :: take_piece
    procedure :: finish
    procedure :: number
  end type tracked_quantity_type

contains

  !> Whether values at the rule's points between outputs are needed.
  pure logical function needs_piece(self)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity

    needs_piece = self%family(0) == 0 .and. follows(self)
  end function needs_piece

  !> Whether no output was taken so far.
  pure logical function is_at_start(self)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity

    is_at_start = self%seen == 0
  end function is_at_start

  !> Whether the column is followed between outputs.
  pure logical function follows(self)
    type(tracked_quantity_type), intent(in) :: self   !< the quantity

    follows = all(self%take /= [character(len=8) :: 'start', 'end', 'at'])
  end function follows

  !> Take an output into account. The first one is the start.
  pure subroutine take_output(self, rule, row)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval
    real(wp), intent(in) :: row(:)                        !< numbers of the output, time first

    if (self%seen == 0) call self%sums%begin(row(1), row(self%column))
    self%seen = self%seen + 1
    self%sums%last = row(self%column)
    if (.not. follows(self) .or. self%family(0) == 0) return
    if (self%count == most_outputs) then
      self%t = eoshift(self%t, 1)
      self%y = eoshift(self%y, 1, dim=2)
      self%count = self%count - 1
      self%done = self%done - 1
    end if
    self%count = self%count + 1
    self%t(self%count) = row(1)
    self%y(:, self%count) = row(self%family)
    ! an interval between others is known best
    if (self%count > 2) call add_intervals(self, rule, self%count - 2)
  end subroutine take_output

  !> Take the value at the time `at`.
  pure subroutine take_at(self, value)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    real(wp), intent(in) :: value                         !< of its column

    self%value_at = value
  end subroutine take_at

  !> Take the values at the points between two outputs into account.
  pure subroutine take_piece(self, rule, from, to, values)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval
    real(wp), intent(in) :: from                          !< time of the first output [s]
    real(wp), intent(in) :: to                            !< time of the second one [s]
    real(wp), intent(in) :: values(:)                     !< (rule%n) of its column, those at the outputs included

    call self%sums%add_piece(rule, from, to, values)
  end subroutine take_piece

  !> End with the last output.
  pure subroutine finish(self, rule)
    class(tracked_quantity_type), intent(inout) :: self   !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval

    if (self%count > 1) call add_intervals(self, rule, self%count - 1)
  end subroutine finish

  !> Take the next intervals between kept outputs into account.
  pure subroutine add_intervals(self, rule, last)
    type(tracked_quantity_type), intent(inout) :: self    !< the quantity
    type(chebyshev_type), intent(in) :: rule              !< points in an interval
    integer, intent(in) :: last                           !< number of the last one
    type(hermite_type) :: local, wide
    real(wp), dimension(rule%n) :: values, wider
    integer :: j

    do j = self%done + 1, last
      if (has_extremes_at_ends(self, j)) then
        call self%sums%add_value(self%t(j), self%y(0, j))
        call self%sums%add_value(self%t(j + 1), self%y(0, j + 1))
        cycle
      end if
      associate (a => self%t(j), b => self%t(j + 1))
        call polynomial(self%t(j:j + 1), self%y(:, j:j + 1), local)
        call values_between(local, a, b, rule, self%order, values)
        if (self%count > 2) then
          call polynomial(self%t(:self%count), self%y(:, :self%count), wide)
          call values_between(wide, a, b, rule, self%order, wider)
          if (maxval(abs(wider - values)) <= smooth_difference*(maxval(values) - minval(values))) values = wider
        end if
        call self%sums%add_piece(rule, a, b, values)
      end associate
    end do
    self%done = last
  end subroutine add_intervals

  !> Whether only the ends of an interval count: an extreme of a position is sought, and its rate keeps its sign in between. It
  !> does so where the coefficients of the rate in Bernstein's form, which follow from rates and accelerations, have one sign.
  pure logical function has_extremes_at_ends(self, j) result(at_ends)
    type(tracked_quantity_type), intent(in) :: self   !< the quantity
    integer, intent(in) :: j                          !< number of the interval
    real(wp) :: coefficients(4), third

    at_ends = .false.
    if (self%order > 0 .or. all(self%take /= [character(len=8) :: 'min', 'max', 'peak', 'range'])) return
    third = (self%t(j + 1) - self%t(j))/3.0_wp
    coefficients = [self%y(1, j), self%y(1, j) + third*self%y(2, j), self%y(1, j + 1) - third*self%y(2, j + 1), self%y(1, j + 1)]
    at_ends = all(coefficients > 0.0_wp) .or. all(coefficients < 0.0_wp)
  end function has_extremes_at_ends

  !> The polynomial through outputs with two derivatives each.
  pure subroutine polynomial(t, y, hermite)
    real(wp), intent(in) :: t(:)                 !< (outputs) times [s]
    real(wp), intent(in) :: y(0:, :)             !< (0:2,outputs) position, rate and acceleration
    type(hermite_type), intent(out) :: hermite   !< the polynomial

    call build_hermite(t, y(0:0, :), y(1:1, :), y(2:2, :), hermite)
  end subroutine polynomial

  !> Values of a polynomial, or of a derivative of it, at the points of an interval.
  pure subroutine values_between(hermite, from, to, rule, order, values)
    type(hermite_type), intent(in) :: hermite   !< the polynomial
    real(wp), intent(in) :: from                !< beginning of the interval [s]
    real(wp), intent(in) :: to                  !< end of the interval [s]
    type(chebyshev_type), intent(in) :: rule    !< its points
    integer, intent(in) :: order                !< 0 to 2: order of the derivative
    real(wp), intent(out) :: values(:)          !< (rule%n) at the points
    real(wp) :: y(1), dy(1), ddy(1)
    integer :: i

    do i = 1, rule%n
      call hermite%evaluate(from + 0.5_wp*(to - from)*(1.0_wp + rule%points(i)), y, dy, ddy)
      select case (order)
      case (0)
        values(i) = y(1)
      case (1)
        values(i) = dy(1)
      case default
        values(i) = ddy(1)
      end select
    end do
  end subroutine values_between

  !> The number itself, after the last output.
  pure real(wp) function number(self)
    class(tracked_quantity_type), intent(in) :: self   !< the quantity

    number = self%sums%result_of(self%take)
    if (self%take == 'at') number = self%value_at
  end function number
end module mech9_tracked_quantity
