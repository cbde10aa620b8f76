!> A coupling by a table: the second coordinate is a function of the first one. Cams by their law of motion and gears that are not
!> round are of this kind.
!>
!> A quintic spline goes through the points, so that the first four derivatives are continuous. A table over one turn repeats after
!> each turn; any other ends with its points.
module mech9_table_coupling
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_singular
  use mech9_failure, only: failure_off_table
  use mech9_quintic_spline, only: quintic_spline_type, build_quintic
  use mech9_coupling, only: coupling_name_length, curve_order
  use mech9_function_coupling, only: function_coupling_type
  implicit none
  private
  public :: table_coupling_type, new_table_coupling, new_turning_table

  !> The second coordinate is a function of the first one: that of a spline, and in a table that repeats a gain, which is the same
  !> for each turn.
  type, extends(function_coupling_type) :: table_coupling_type
    real(wp) :: unit = 1.0_wp               !< of the first coordinate in the data file [rad, m]
    character(len=3) :: unit_name = ''      !< its name
    logical, private :: repeats = .false.   !< after each turn of the first coordinate
    type(quintic_spline_type), private :: spline   !< its first component [rad, m] over the first coordinate [rad, m]
    real(wp), private :: gain = 0.0_wp      !< change of the second coordinate per rad of the first one, over a whole turn
  contains
    procedure :: find_curve
    procedure :: find_third
    procedure :: ends
    procedure :: kind_name
    procedure :: constants
  end type table_coupling_type

  !> A coordinate may be beyond the end of a table by this part of its length, by round-off.
  real(wp), parameter :: at_end = 1.0e-9_wp

contains

  !> The coupling through points, which ends with them. Fails where no spline goes through them.
  subroutine new_table_coupling(x, y, coupling, err)
    real(wp), intent(in) :: x(:)                           !< (n) first coordinate, increasing [rad, m]
    real(wp), intent(in) :: y(:)                           !< (n) values of the second coordinate [rad, m]
    type(table_coupling_type), intent(out) :: coupling     !< the coupling, without its coordinates
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: points(3, size(x))

    points = 0.0_wp
    points(1, :) = y
    call build_quintic(x, points, .false., coupling%spline, err)
    if (.not. allocated(err)) call find_steepest(coupling)
  end subroutine new_table_coupling

  !> The coupling through points over one turn, which repeats. Fails where no spline goes through them.
  subroutine new_turning_table(x, y, gain, coupling, err)
    real(wp), intent(in) :: x(:)                           !< (n) first coordinate, increasing; the last is a turn on [rad]
    real(wp), intent(in) :: y(:)                           !< (n) values of the second coordinate [rad, m]
    real(wp), intent(in) :: gain                           !< change of the second coordinate per rad of the first one
    type(table_coupling_type), intent(out) :: coupling     !< the coupling, without its coordinates
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: points(3, size(x))
    integer :: n

    n = size(x)
    points = 0.0_wp
    points(1, :) = y - gain*(x - x(1))
    points(1, n) = points(1, 1)
    call build_quintic(x, points, .true., coupling%spline, err)
    if (allocated(err)) return
    coupling%repeats = .true.
    coupling%gain = gain
    call find_steepest(coupling)
  end subroutine new_turning_table

  !> Find the greatest slope at the points.
  pure subroutine find_steepest(coupling)
    type(table_coupling_type), intent(inout) :: coupling   !< with its spline; gets the slope
    real(wp) :: slope(3)
    integer :: i

    do i = 1, size(coupling%spline%x) - 1
      slope = coupling%spline%velocity(i, coupling%spline%x(i))
      coupling%steepest = max(coupling%steepest, abs(coupling%gain + slope(1)))
    end do
  end subroutine find_steepest

  !> The function and its derivatives. Fails beyond the ends of a table that does not repeat.
  subroutine find_curve(self, q, curve, err)
    class(table_coupling_type), intent(in) :: self       !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    real(wp), intent(out) :: curve(0:curve_order)        !< value and derivatives
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    real(wp) :: x, y(3), first(3), second(3), third(3)

    curve = 0.0_wp
    if (.not. self%repeats) call check_ends(self, q, err)
    if (allocated(err)) return
    x = place_in(self, q)
    call self%spline%evaluate(piece_of(self%spline%x, x), x, y, first, second, third)
    curve = [y(1) + self%gain*(q - self%spline%x(1)), first(1) + self%gain, second(1)]
  end subroutine find_curve

  !> Fail for a coordinate beyond an end of the table, by more than round-off. The caller adds the time.
  pure subroutine check_ends(self, q, err)
    class(table_coupling_type), intent(in) :: self       !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    type(error_type), allocatable, intent(out) :: err    !< allocated if it is beyond an end
    real(wp) :: limits(2)

    limits = self%ends()
    if (q >= limits(1) - at_end*(limits(2) - limits(1)) .and. q <= limits(2) + at_end*(limits(2) - limits(1))) return
    call raise(err, exit_singular, failure_off_table)
    err%failure%coordinates = self%coordinates(1:1)
    err%failure%values = reshape([q, limits]/self%unit, [3, 1])
    err%failure%name = trim(self%unit_name)
    err%place = self%place
  end subroutine check_ends

  !> The third derivative of the function; beyond the ends of a table that of its last piece.
  subroutine find_third(self, q, third, err)
    class(table_coupling_type), intent(in) :: self       !< the coupling
    real(wp), intent(in) :: q                            !< the first coordinate [rad, m]
    real(wp), intent(out) :: third                       !< third derivative
    type(error_type), allocatable, intent(out) :: err    !< never allocated
    real(wp) :: x, y(3), first(3), second(3), thirds(3)

    x = place_in(self, q)
    call self%spline%evaluate(piece_of(self%spline%x, x), x, y, first, second, thirds)
    third = thirds(1)
  end subroutine find_third

  !> Least and greatest values that the first coordinate can have; without bounds where the table repeats.
  pure function ends(self)
    class(table_coupling_type), intent(in) :: self   !< the coupling
    real(wp) :: ends(2)

    ends = [-huge(ends), huge(ends)]
    if (.not. self%repeats) ends = [self%spline%x(1), self%spline%x(size(self%spline%x))]
  end function ends

  !> The place in a table at which its spline is evaluated.
  pure real(wp) function place_in(self, q) result(x)
    class(table_coupling_type), intent(in) :: self   !< the coupling
    real(wp), intent(in) :: q                        !< the first coordinate [rad, m]

    associate (start => self%spline%x(1), finish => self%spline%x(size(self%spline%x)))
      x = q
      if (self%repeats) x = min(finish, start + modulo(q - start, finish - start))
    end associate
  end function place_in

  !> The piece of a spline in which a parameter lies, by bisection.
  pure integer function piece_of(points, x) result(piece)
    real(wp), intent(in) :: points(:)   !< (n) parameter at the points, increasing [rad, m]
    real(wp), intent(in) :: x           !< the parameter, from the first to the last [rad, m]
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

  !> A table has no numbers that a parameter could set.
  pure subroutine constants(self, values)
    class(table_coupling_type), intent(in) :: self   !< the coupling
    real(wp), allocatable, intent(out) :: values(:)  !< none

    allocate (values(0))
  end subroutine constants

  !> The name of the kind in the data file.
  pure function kind_name(self) result(name)
    class(table_coupling_type), intent(in) :: self   !< the coupling
    character(len=coupling_name_length) :: name

    name = 'table'
  end function kind_name
end module mech9_table_coupling
