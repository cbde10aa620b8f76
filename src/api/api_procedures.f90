!> User procedures of C: how they are registered, and what those for forces may read and add (include/mech9.h).
module mech9_api_procedures
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_funptr, c_f_pointer
  use mech9, only: error_type, mechanism_type, motion_view_type, force_sum_type
  use mech9_api_error, only: begin_call, end_call
  use mech9_api_mechanism, only: find_mechanism
  implicit none
  private
  public :: use_pair, use_drive, use_coupling, use_force
  public :: position, velocity, turned, angular_velocity, coordinate, rate, add_force, add_torque, add_generalized

contains

  !> Register a function for pairs.
  integer(c_int) function use_pair(mechanism, function, data, error) bind(c, name='mech9_mechanism_use_pair') result(code)
    type(c_ptr), value, intent(in) :: mechanism      !< the handle
    type(c_funptr), value, intent(in) :: function    !< the function, or null
    type(c_ptr), value, intent(in) :: data           !< is given to each call
    type(c_ptr), value, intent(in) :: error          !< handle of errors, or null

    code = register(mechanism, 'pair', function, data, error)
  end function use_pair

  !> Register a function for drives.
  integer(c_int) function use_drive(mechanism, function, data, error) bind(c, name='mech9_mechanism_use_drive') result(code)
    type(c_ptr), value, intent(in) :: mechanism      !< the handle
    type(c_funptr), value, intent(in) :: function    !< the function, or null
    type(c_ptr), value, intent(in) :: data           !< is given to each call
    type(c_ptr), value, intent(in) :: error          !< handle of errors, or null

    code = register(mechanism, 'drive', function, data, error)
  end function use_drive

  !> Register a function for couplings.
  integer(c_int) function use_coupling(mechanism, function, data, error) bind(c, name='mech9_mechanism_use_coupling') &
    result(code)
    type(c_ptr), value, intent(in) :: mechanism      !< the handle
    type(c_funptr), value, intent(in) :: function    !< the function, or null
    type(c_ptr), value, intent(in) :: data           !< is given to each call
    type(c_ptr), value, intent(in) :: error          !< handle of errors, or null

    code = register(mechanism, 'coupling', function, data, error)
  end function use_coupling

  !> Register a function for forces.
  integer(c_int) function use_force(mechanism, function, data, error) bind(c, name='mech9_mechanism_use_force') result(code)
    type(c_ptr), value, intent(in) :: mechanism      !< the handle
    type(c_funptr), value, intent(in) :: function    !< the function, or null
    type(c_ptr), value, intent(in) :: data           !< is given to each call
    type(c_ptr), value, intent(in) :: error          !< handle of errors, or null

    code = register(mechanism, 'load', function, data, error)
  end function use_force

  !> Register a function for the groups of a name.
  integer(c_int) function register(mechanism, name, function, data, error) result(code)
    type(c_ptr), intent(in) :: mechanism      !< the handle
    character(len=*), intent(in) :: name      !< of the groups
    type(c_funptr), intent(in) :: function    !< the function, or null
    type(c_ptr), intent(in) :: data           !< is given to each call
    type(c_ptr), intent(in) :: error          !< handle of errors, or null
    type(mechanism_type), pointer :: found
    type(error_type), allocatable :: err

    call begin_call(error)
    call find_mechanism(mechanism, found, err)
    if (.not. allocated(err)) call found%register(name, function, data, err)
    code = end_call(error, err)
  end function register

  !> Position of a point of a link.
  subroutine position(motion, link, point, found) bind(c, name='mech9_motion_position')
    type(c_ptr), value, intent(in) :: motion      !< of links and coordinates
    integer(c_int), value, intent(in) :: link     !< its number
    real(c_double), intent(in) :: point(3)        !< in the link's system [m]
    real(c_double), intent(out) :: found(3)       !< in the system of link 1 [m]
    type(motion_view_type), pointer :: state

    call c_f_pointer(motion, state)
    found = state%position(link, point)
  end subroutine position

  !> Velocity of a point of a link.
  subroutine velocity(motion, link, point, found) bind(c, name='mech9_motion_velocity')
    type(c_ptr), value, intent(in) :: motion      !< of links and coordinates
    integer(c_int), value, intent(in) :: link     !< its number
    real(c_double), intent(in) :: point(3)        !< in the link's system [m]
    real(c_double), intent(out) :: found(3)       !< along the axes of link 1 [m/s]
    type(motion_view_type), pointer :: state

    call c_f_pointer(motion, state)
    found = state%velocity(link, point)
  end subroutine velocity

  !> A direction that is fixed in a link.
  subroutine turned(motion, link, direction, found) bind(c, name='mech9_motion_turned')
    type(c_ptr), value, intent(in) :: motion      !< of links and coordinates
    integer(c_int), value, intent(in) :: link     !< its number
    real(c_double), intent(in) :: direction(3)    !< in the link's axes, of any unit
    real(c_double), intent(out) :: found(3)       !< along the axes of link 1
    type(motion_view_type), pointer :: state

    call c_f_pointer(motion, state)
    found = state%turned(link, direction)
  end subroutine turned

  !> Angular velocity of a link.
  subroutine angular_velocity(motion, link, found) bind(c, name='mech9_motion_angular_velocity')
    type(c_ptr), value, intent(in) :: motion      !< of links and coordinates
    integer(c_int), value, intent(in) :: link     !< its number
    real(c_double), intent(out) :: found(3)       !< along the axes of link 1 [rad/s]
    type(motion_view_type), pointer :: state

    call c_f_pointer(motion, state)
    found = state%angular_velocity(link)
  end subroutine angular_velocity

  !> A coordinate [rad, m].
  real(c_double) function coordinate(motion, number) bind(c, name='mech9_motion_q')
    type(c_ptr), value, intent(in) :: motion      !< of links and coordinates
    integer(c_int), value, intent(in) :: number   !< of the coordinate
    type(motion_view_type), pointer :: state

    call c_f_pointer(motion, state)
    coordinate = state%coordinate(number)
  end function coordinate

  !> The rate of a coordinate [rad/s, m/s].
  real(c_double) function rate(motion, number) bind(c, name='mech9_motion_dq')
    type(c_ptr), value, intent(in) :: motion      !< of links and coordinates
    integer(c_int), value, intent(in) :: number   !< of the coordinate
    type(motion_view_type), pointer :: state

    call c_f_pointer(motion, state)
    rate = state%rate(number)
  end function rate

  !> Add a force at a point of a link.
  subroutine add_force(loads, motion, link, point, force) bind(c, name='mech9_loads_add_force')
    type(c_ptr), value, intent(in) :: loads       !< gets the force
    type(c_ptr), value, intent(in) :: motion      !< of links and coordinates
    integer(c_int), value, intent(in) :: link     !< its number
    real(c_double), intent(in) :: point(3)        !< in the link's system [m]
    real(c_double), intent(in) :: force(3)        !< along the axes of link 1 [N]
    type(force_sum_type), pointer :: sum
    type(motion_view_type), pointer :: state

    call c_f_pointer(loads, sum)
    call c_f_pointer(motion, state)
    call sum%add_force(state, link, point, force)
  end subroutine add_force

  !> Add a torque on a link.
  subroutine add_torque(loads, link, torque) bind(c, name='mech9_loads_add_torque')
    type(c_ptr), value, intent(in) :: loads       !< gets the torque
    integer(c_int), value, intent(in) :: link     !< its number
    real(c_double), intent(in) :: torque(3)       !< along the axes of link 1 [N m]
    type(force_sum_type), pointer :: sum

    call c_f_pointer(loads, sum)
    call sum%add_torque(link, torque)
  end subroutine add_torque

  !> Add a generalized force on a coordinate.
  subroutine add_generalized(loads, number, value) bind(c, name='mech9_loads_add_generalized')
    type(c_ptr), value, intent(in) :: loads       !< gets the force
    integer(c_int), value, intent(in) :: number   !< of the coordinate
    real(c_double), value, intent(in) :: value    !< [N m, N]
    type(force_sum_type), pointer :: sum

    call c_f_pointer(loads, sum)
    call sum%add_generalized(number, value)
  end subroutine add_generalized
end module mech9_api_procedures
