!> Derivatives by parameters of the number that a quantity is: beside its sums, the same sums of the derivatives of its column.
!>
!> The sums are linear in the values of the column, and the time of an extreme changes its value in second order only, or is an end
!> of the motion. So the derivative of the number is that of the column at the time of the extreme, or summed as the column is.
!> A column may jump at a time that depends on a parameter. Its integral then changes by the jump as well, and an extreme at this time
!> moves with the time.
module mech9_quantity_gradient
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_chebyshev, only: chebyshev_type
  use mech9_quantity_sums, only: quantity_sums_type
  implicit none
  private
  public :: quantity_gradient_type

  !> Each array has one number for each parameter.
  type :: quantity_gradient_type
    real(wp), allocatable :: first(:)      !< derivatives of the column at the start
    real(wp), allocatable :: last(:)       !< at the latest output
    real(wp), allocatable :: low(:)        !< at the time of the least value
    real(wp), allocatable :: high(:)       !< at the time of the largest value
    real(wp), allocatable :: at(:)         !< at the time that is asked for
    real(wp), allocatable :: integral(:)   !< integrals of the derivatives over time
    real(wp), allocatable :: product(:)    !< integrals of value times derivative over time
    real(wp), allocatable :: largest(:)    !< largest magnitudes so far
    logical :: is_lost = .false.           !< the column was not known around an event
  contains
    procedure :: begin
    procedure :: add_piece
    procedure :: add_jump
    procedure :: result_of
  end type quantity_gradient_type

  !> Differences of the values on both sides of a joint below this part of them are round-off of some solutions of chains.
  real(wp), parameter :: round_off = 1.0e-10_wp

contains

  !> Begin with the derivatives at the start.
  pure subroutine begin(self, changes)
    class(quantity_gradient_type), intent(inout) :: self   !< the derivatives, without anything so far
    real(wp), intent(in) :: changes(:)                     !< of the column by each parameter

    self%first = changes
    self%last = changes
    self%low = changes
    self%high = changes
    self%at = changes
    self%integral = 0.0_wp*changes
    self%product = self%integral
    self%largest = abs(changes)
  end subroutine begin

  !> Go on by an interval of time in which column and derivatives are polynomials.
  pure subroutine add_piece(self, rule, from, to, values, changes)
    class(quantity_gradient_type), intent(inout) :: self   !< the derivatives
    type(chebyshev_type), intent(in) :: rule               !< points in an interval
    real(wp), intent(in) :: from                           !< beginning of the interval [s]
    real(wp), intent(in) :: to                             !< end of the interval [s]
    real(wp), intent(in) :: values(:)                      !< (rule%n) of the column at the points
    real(wp), intent(in) :: changes(:, :)                  !< (parameters,rule%n) its derivatives there
    real(wp) :: weights(rule%n)

    weights = 0.5_wp*(to - from)*rule%weights
    self%integral = self%integral + matmul(changes, weights)
    self%product = self%product + matmul(changes, weights*values)
    self%largest = max(self%largest, maxval(abs(changes), 2))
  end subroutine add_piece

  !> Pass a time at which the column jumps. A jump of round-off changes nothing.
  pure subroutine add_jump(self, before, behind, rate)
    class(quantity_gradient_type), intent(inout) :: self   !< the derivatives
    real(wp), intent(in) :: before                         !< value of the column before the jump
    real(wp), intent(in) :: behind                         !< its value behind it
    real(wp), intent(in) :: rate(:)                        !< derivatives of the time of the jump by each parameter

    if (abs(behind - before) <= round_off*max(abs(behind), abs(before))) return
    self%integral = self%integral + (before - behind)*rate
    self%product = self%product + 0.5_wp*(before**2 - behind**2)*rate
  end subroutine add_jump

  !> Derivatives of the number that is asked for: start, end, min, max, peak, range, mean, rms, integral or at. The root of a mean
  !> square that is zero has none, unless the column does not change at all.
  pure subroutine result_of(self, take, sums, gradient)
    class(quantity_gradient_type), intent(in) :: self   !< the derivatives over the whole motion
    character(len=*), intent(in) :: take                !< name of the number
    type(quantity_sums_type), intent(in) :: sums        !< the sums of the column itself
    real(wp), intent(out) :: gradient(:)                !< (parameters); NaN where the number has no derivative
    real(wp) :: rms

    gradient = 0.0_wp
    if (self%is_lost .and. all(take /= [character(len=5) :: 'start', 'end', 'at'])) then
      gradient = ieee_value(rms, ieee_quiet_nan)
      return
    end if
    select case (take)
    case ('start')
      gradient = self%first
    case ('end')
      gradient = self%last
    case ('min')
      gradient = self%low
    case ('max')
      gradient = self%high
    case ('peak')
      if (abs(sums%low) > abs(sums%high)) gradient = sign(1.0_wp, sums%low)*self%low
      if (abs(sums%low) <= abs(sums%high)) gradient = sign(1.0_wp, sums%high)*self%high
    case ('range')
      gradient = self%high - self%low
    case ('mean')
      gradient = self%first
      if (abs(sums%duration) > 0.0_wp) gradient = self%integral/sums%duration
    case ('rms')
      rms = sums%result_of('rms')
      if (.not. rms > 0.0_wp) then
        where (self%largest > 0.0_wp) gradient = ieee_value(rms, ieee_quiet_nan)
      else if (abs(sums%duration) > 0.0_wp) then
        gradient = self%product/(sums%duration*rms)
      else
        gradient = sign(1.0_wp, sums%first)*self%first
      end if
    case ('integral')
      gradient = self%integral
    case ('at')
      gradient = self%at
    end select
  end subroutine result_of
end module mech9_quantity_gradient
