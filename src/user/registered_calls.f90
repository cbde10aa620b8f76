!> Calls of the user's procedures that are registered (include/mech9.h).
module mech9_registered_calls
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_loc, c_f_procpointer
  use mech9_kinds, only: wp
  use mech9_taylor, only: taylor
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_registered_procedures, only: registered_procedure_type
  implicit none
  private
  public :: call_function, call_pair, call_force

  abstract interface
    !> A drive or a coupling: value, first and second derivative. Those that it does not set are not numbers. It returns 0 where
    !> there is a value.
    integer(c_int) function c_function(number, x, n, parameters, values, data) bind(c)
      import :: c_int, c_double, c_ptr
      integer(c_int), value, intent(in) :: number      !< of the coordinate, or of the coupling
      real(c_double), value, intent(in) :: x           !< the time, or the first coordinate [s, rad, m]
      integer(c_int), value, intent(in) :: n           !< number of parameters
      real(c_double), intent(in) :: parameters(*)      !< (n) of the group &user
      real(c_double), intent(inout) :: values(0:2)     !< coordinate and derivatives by x
      type(c_ptr), value, intent(in) :: data           !< of the user
    end function c_function

    !> The three points of a pair, with two derivatives by its coordinate.
    integer(c_int) function c_pair(coordinate, q, n, parameters, points, data) bind(c)
      import :: c_int, c_double, c_ptr
      integer(c_int), value, intent(in) :: coordinate      !< number of the coordinate
      real(c_double), value, intent(in) :: q               !< the coordinate
      integer(c_int), value, intent(in) :: n               !< number of parameters
      real(c_double), intent(in) :: parameters(*)          !< (n) of the group &user
      real(c_double), intent(inout) :: points(3, 3, 0:2)   !< (components, points, derivatives) in the reference link [m]
      type(c_ptr), value, intent(in) :: data               !< of the user
    end function c_pair

    !> Forces on links and coordinates.
    integer(c_int) function c_force(t, motion, n, parameters, loads, data) bind(c)
      import :: c_int, c_double, c_ptr
      real(c_double), value, intent(in) :: t          !< time [s]
      type(c_ptr), value, intent(in) :: motion        !< of links and coordinates, a motion_view_type
      integer(c_int), value, intent(in) :: n          !< number of parameters
      real(c_double), intent(in) :: parameters(*)     !< (n) of the group &user
      type(c_ptr), value, intent(in) :: loads         !< gets the forces, a force_sum_type
      type(c_ptr), value, intent(in) :: data          !< of the user
    end function c_force
  end interface

contains

  !> Call a drive or a coupling. What it does not give is not a number.
  subroutine call_function(procedure, number, x, parameters, y)
    type(registered_procedure_type), intent(in) :: procedure   !< the procedure, which exists
    integer, intent(in) :: number                              !< of the coordinate, or of the coupling
    real(wp), intent(in) :: x                                  !< the time, or the first coordinate [s, rad, m]
    real(wp), intent(in) :: parameters(:)                      !< of the group &user
    type(taylor), intent(out) :: y                             !< the coordinate with its derivatives by x [rad, m]
    procedure(c_function), pointer :: function
    real(wp) :: values(0:2)

    values = ieee_value(x, ieee_quiet_nan)
    call c_f_procpointer(procedure%address, function)
    if (function(number, x, size(parameters), parameters, values, procedure%data) /= 0) values = ieee_value(x, ieee_quiet_nan)
    y = taylor(values(0), values(1), values(2))
  end subroutine call_function

  !> Call a pair. What it does not give is not a number.
  subroutine call_pair(procedure, coordinate, q, parameters, r)
    type(registered_procedure_type), intent(in) :: procedure   !< the procedure, which exists
    integer, intent(in) :: coordinate                          !< number of the coordinate
    real(wp), intent(in) :: q                                  !< the coordinate
    real(wp), intent(in) :: parameters(:)                      !< of the group &user
    type(taylor), intent(out) :: r(3, 3)                       !< the three points by columns, with derivatives in q [m]
    procedure(c_pair), pointer :: function
    real(wp) :: points(3, 3, 0:2)

    points = ieee_value(q, ieee_quiet_nan)
    call c_f_procpointer(procedure%address, function)
    if (function(coordinate, q, size(parameters), parameters, points, procedure%data) /= 0) points = ieee_value(q, ieee_quiet_nan)
    r%value = points(:, :, 0)
    r%first = points(:, :, 1)
    r%second = points(:, :, 2)
  end subroutine call_pair

  !> Call a procedure for forces, which adds its forces.
  subroutine call_force(procedure, state, parameters, sum, has_failed)
    type(registered_procedure_type), intent(in) :: procedure   !< the procedure, which exists
    type(motion_view_type), intent(in), target :: state        !< motion of links and coordinates
    real(wp), intent(in) :: parameters(:)                      !< of the group &user
    type(force_sum_type), intent(inout), target :: sum         !< forces so far; those of the procedure are added
    logical, intent(out) :: has_failed                         !< the procedure says that it has no forces here
    procedure(c_force), pointer :: function

    call c_f_procpointer(procedure%address, function)
    has_failed = function(state%t, c_loc(state), size(parameters), parameters, c_loc(sum), procedure%data) /= 0
  end subroutine call_force
end module mech9_registered_calls
