!> A coupling by a table: the second coordinate is a function of the first one, which turns, and repeats after each full turn.
!> Cams by their law of motion and gears that are not round are of this kind.
!>
!> A periodic quintic spline goes through the points, so that the first four derivatives are continuous.
module mech9_table_coupling
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_quintic_spline, only: quintic_spline_type, build_quintic
  use mech9_coupling, only: coupling_type, coupling_name_length
  implicit none
  private
  public :: table_coupling_type, new_table_coupling

  !> The second coordinate is a function of the first one: a periodic part, and a gain that is the same for each turn.
  type, extends(coupling_type) :: table_coupling_type
    private
    type(quintic_spline_type) :: spline     !< the periodic part is its first component [rad, m] over the first coordinate [rad]
    real(wp) :: gain = 0.0_wp               !< change of the second coordinate per rad of the first one, over a whole turn
    real(wp) :: steepest = 0.0_wp           !< greatest slope of the function at the points [1, m/rad]
  contains
    procedure :: term
    procedure :: weight
    procedure :: is_linear
    procedure :: kind_name
  end type table_coupling_type

contains

  !> The coupling through points over one turn. Fails where no spline goes through them.
  subroutine new_table_coupling(x, y, gain, coupling, err)
    real(wp), intent(in) :: x(:)                           !< (n) first coordinate, increasing; the last is a turn on [rad]
    real(wp), intent(in) :: y(:)                           !< (n) values of the second coordinate [rad, m]
    real(wp), intent(in) :: gain                           !< change of the second coordinate per rad of the first one
    type(table_coupling_type), intent(out) :: coupling     !< the coupling, without its coordinates
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: points(3, size(x)), slope(3)
    integer :: i, n

    n = size(x)
    points = 0.0_wp
    points(1, :) = y - gain*(x - x(1))
    points(1, n) = points(1, 1)
    call build_quintic(x, points, .true., coupling%spline, err)
    if (allocated(err)) return
    coupling%gain = gain
    do i = 1, n - 1
      slope = coupling%spline%velocity(i, x(i))
      coupling%steepest = max(coupling%steepest, abs(gain + slope(1)))
    end do
  end subroutine new_table_coupling

  !> One term of the equation, or its derivative by its coordinate: minus the function of the first coordinate, or the second one.
  pure real(wp) function term(self, i, q, order)
    class(table_coupling_type), intent(in) :: self   !< the coupling
    integer, intent(in) :: i                         !< number of the term, 1 or 2
    real(wp), intent(in) :: q                        !< its coordinate [rad, m]
    integer, intent(in) :: order                     !< 0: the term; 1, 2, 3: a derivative
    real(wp) :: x, y(3), first(3), second(3), third(3)

    if (i == 2) then
      term = 0.0_wp
      if (order == 0) term = q
      if (order == 1) term = 1.0_wp
      return
    end if
    associate (start => self%spline%x(1), finish => self%spline%x(size(self%spline%x)))
      x = min(finish, start + modulo(q - start, finish - start))
      call self%spline%evaluate(piece_of(self%spline%x, x), x, y, first, second, third)
      select case (order)
      case (0)
        term = -(y(1) + self%gain*(q - start))
      case (1)
        term = -(first(1) + self%gain)
      case (2)
        term = -second(1)
      case default
        term = -third(1)
      end select
    end associate
  end function term

  !> The piece of a spline in which a parameter lies, by bisection.
  pure integer function piece_of(points, x) result(piece)
    real(wp), intent(in) :: points(:)   !< (n) parameter at the points, increasing [rad]
    real(wp), intent(in) :: x           !< the parameter, from the first to the last [rad]
    integer :: beyond, middle

    piece = 1
    beyond = size(points)
    do while (beyond - piece > 1)
      middle = (piece + beyond)/2
      if (x < points(middle)) then
        beyond = middle
      else
        piece = middle
      end if
    end do
  end function piece_of

  !> The factor that makes the largest derivative of the equation about one.
  pure real(wp) function weight(self, units)
    class(table_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: units(:)                 !< (2) units of its coordinates: 1 rad, or the mechanism's size [m]

    weight = 1.0_wp/max(self%steepest*units(1), units(2))
  end function weight

  !> The slope of the function is not constant.
  pure logical function is_linear(self)
    class(table_coupling_type), intent(in) :: self   !< the coupling

    is_linear = .false.
  end function is_linear

  !> The name of the kind in the data file.
  pure function kind_name(self) result(name)
    class(table_coupling_type), intent(in) :: self   !< the coupling
    character(len=coupling_name_length) :: name

    name = 'table'
  end function kind_name
end module mech9_table_coupling
