!> Extremes and integrals in time of one column, collected piece by piece along a motion.
module mech9_quantity_sums
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type
  implicit none
  private
  public :: quantity_sums_type

  type :: quantity_sums_type
    real(wp) :: first = 0.0_wp       !< value at the start
    real(wp) :: last = 0.0_wp        !< value at the latest time
    real(wp) :: low = 0.0_wp         !< least value
    real(wp) :: high = 0.0_wp        !< largest value
    real(wp) :: time_low = 0.0_wp    !< time of the least value [s]
    real(wp) :: time_high = 0.0_wp   !< time of the largest value [s]
    real(wp) :: duration = 0.0_wp    !< from the start to the latest time; negative where time runs backwards [s]
    real(wp) :: integral = 0.0_wp    !< of the value over time
    real(wp) :: square = 0.0_wp      !< integral of its square over time
  contains
    procedure :: begin
    procedure :: begin_extremes
    procedure :: add_value
    procedure :: add_piece
    procedure :: add_chords
    procedure :: add_extremes
    procedure :: result_of
  end type quantity_sums_type

contains

  !> Begin with the value at the start.
  pure subroutine begin(self, t, value)
    class(quantity_sums_type), intent(inout) :: self   !< the sums, without anything so far
    real(wp), intent(in) :: t                          !< time of the start [s]
    real(wp), intent(in) :: value                      !< of the column

    self%first = value
    self%last = value
    call self%begin_extremes(t, value)
  end subroutine begin

  !> Begin the extremes with a value.
  pure subroutine begin_extremes(self, t, value)
    class(quantity_sums_type), intent(inout) :: self   !< the sums
    real(wp), intent(in) :: t                          !< its time [s]
    real(wp), intent(in) :: value                      !< of the column

    self%low = value
    self%high = value
    self%time_low = t
    self%time_high = t
  end subroutine begin_extremes

  !> Take a value into account for the extremes.
  pure subroutine add_value(self, t, value)
    class(quantity_sums_type), intent(inout) :: self   !< the sums
    real(wp), intent(in) :: t                          !< its time [s]
    real(wp), intent(in) :: value                      !< of the column

    if (value < self%low) then
      self%low = value
      self%time_low = t
    end if
    if (value > self%high) then
      self%high = value
      self%time_high = t
    end if
  end subroutine add_value

  !> Go on by an interval of time in which the column is a polynomial.
  pure subroutine add_piece(self, rule, from, to, values)
    class(quantity_sums_type), intent(inout) :: self   !< the sums
    type(chebyshev_type), intent(in) :: rule           !< points in an interval
    real(wp), intent(in) :: from                       !< beginning of the interval [s]
    real(wp), intent(in) :: to                         !< end of the interval [s]
    real(wp), intent(in) :: values(:)                  !< (rule%n) of the column at the points
    real(wp) :: half

    half = 0.5_wp*(to - from)
    self%duration = self%duration + (to - from)
    self%integral = self%integral + half*dot_product(rule%weights, values)
    self%square = self%square + half*dot_product(rule%weights, values**2)
    self%last = values(rule%n)
    call self%add_extremes(rule, from, to, values)
  end subroutine add_piece

  !> Go on over values between which nothing is known, as where the column jumps: extremes are those of the values, integrals those of
  !> chords.
  pure subroutine add_chords(self, times, values)
    class(quantity_sums_type), intent(inout) :: self   !< the sums
    real(wp), intent(in) :: times(:)                   !< (values) in their order [s]
    real(wp), intent(in) :: values(:)                  !< of the column
    real(wp) :: h
    integer :: i

    call self%add_value(times(1), values(1))
    do i = 2, size(values)
      call self%add_value(times(i), values(i))
      h = times(i) - times(i - 1)
      self%duration = self%duration + h
      self%integral = self%integral + 0.5_wp*h*(values(i - 1) + values(i))
      self%square = self%square + 0.5_wp*h*(values(i - 1)**2 + values(i)**2)
    end do
    self%last = values(size(values))
  end subroutine add_chords

  !> Find the extremes of a polynomial. An extreme between two points counts where the polynomial is resolved: it then exceeds
  !> the points by less than their difference from their neighbours.
  pure subroutine add_extremes(self, rule, from, to, values)
    class(quantity_sums_type), intent(inout) :: self   !< the sums
    type(chebyshev_type), intent(in) :: rule           !< points in an interval
    real(wp), intent(in) :: from                       !< beginning of the interval [s]
    real(wp), intent(in) :: to                         !< end of the interval [s]
    real(wp), intent(in) :: values(:)                  !< (rule%n) of the column at the points
    real(wp) :: slopes(rule%n), x, value, spread, excess
    integer :: i

    do i = 1, rule%n
      call self%add_value(from + 0.5_wp*(to - from)*(1.0_wp + rule%points(i)), values(i))
    end do
    slopes = matmul(rule%derivative, values)
    spread = maxval(values) - minval(values)
    do i = 1, rule%n - 1
      if (slopes(i)*slopes(i + 1) >= 0.0_wp) cycle
      x = rule%zero_between(slopes, i)
      value = rule%value_at(values, x)
      excess = max(value - max(values(i), values(i + 1)), min(values(i), values(i + 1)) - value)
      if (excess <= spread) call self%add_value(from + 0.5_wp*(to - from)*(1.0_wp + x), value)
    end do
  end subroutine add_extremes

  !> The number that is asked for: start, end, min, max, peak, range, mean, rms or integral. Means over no time are the value at
  !> the start.
  pure real(wp) function result_of(self, take) result(number)
    class(quantity_sums_type), intent(in) :: self   !< the sums of the whole motion
    character(len=*), intent(in) :: take            !< name of the number

    number = 0.0_wp
    select case (take)
    case ('start')
      number = self%first
    case ('end')
      number = self%last
    case ('min')
      number = self%low
    case ('max')
      number = self%high
    case ('peak')
      number = max(abs(self%low), abs(self%high))
    case ('range')
      number = self%high - self%low
    case ('mean')
      number = self%first
      if (abs(self%duration) > 0.0_wp) number = self%integral/self%duration
    case ('rms')
      number = abs(self%first)
      if (abs(self%duration) > 0.0_wp) number = sqrt(max(0.0_wp, self%square/self%duration))
    case ('integral')
      number = self%integral
    end select
  end function result_of
end module mech9_quantity_sums
