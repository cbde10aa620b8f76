!> Motions for C that a caller advances from time to time (include/mech9.h).
module mech9_api_simulation
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_null_ptr, c_associated, c_f_pointer, c_loc
  use mech9, only: wp, error_type, mechanism_type, motion_type, kinematics, dynamics
  use mech9_api_handle, only: is_live, simulation_mark, no_mark
  use mech9_api_text, only: read_c_text
  use mech9_api_error, only: begin_call, end_call, refuse
  use mech9_api_interruption, only: flag_interruption_type, new_interruption
  use mech9_api_mechanism, only: find_mechanism
  use mech9_api_analyses, only: end_analysis
  implicit none
  private
  public :: simulation_handle_type, find_simulation, claim, release
  public :: create, destroy, advance, time, coordinates, take, point, energies, closure
  public :: set, free_coordinates, take_equations, size_of_state, take_state, set_state

  !> A motion that is advanced, and the units of its coordinates.
  type :: simulation_handle_type
    integer(c_int) :: mark = simulation_mark
    type(motion_type) :: motion
    real(wp), allocatable :: units(:)             !< (M) of the coordinates in the data file [rad, m]
    real(wp), allocatable :: rate_units(:)        !< (M) of their rates [rad/s, m/s]
    logical :: is_busy = .false.                  !< a call changes it; a user procedure in it, or another thread, must not
  end type simulation_handle_type

contains

  !> Start a motion.
  integer(c_int) function create(mechanism, with_forces, stop, simulation, error) bind(c, name='mech9_simulation_create') &
    result(code)
    type(c_ptr), value, intent(in) :: mechanism        !< the mechanism; it may be destroyed afterwards
    integer(c_int), value, intent(in) :: with_forces   !< 0: a driven motion; else a motion under forces
    type(c_ptr), value, intent(in) :: stop             !< address of a number that stops the motion while it is not 0, or null
    type(c_ptr), intent(out) :: simulation             !< the handle; null after a failure
    type(c_ptr), value, intent(in) :: error            !< handle of errors, or null
    type(mechanism_type), pointer :: moved
    type(simulation_handle_type), pointer :: handle
    type(flag_interruption_type) :: interruption
    type(error_type), allocatable :: err
    integer :: k

    call begin_call(error)
    simulation = c_null_ptr
    call new_interruption(stop, interruption)
    call find_mechanism(mechanism, moved, err)
    if (.not. allocated(err)) then
      allocate (handle)
      if (with_forces == 0) then
        call handle%motion%start_kinematics(moved, err, interruption)
      else
        call handle%motion%start_dynamics(moved, err, interruption)
      end if
      if (allocated(err)) deallocate (handle)
    end if
    if (.not. allocated(err)) then
      handle%units = [(handle%motion%unit(k), k=1, handle%motion%coordinates())]
      handle%rate_units = [(handle%motion%unit(k, of_rate=.true.), k=1, handle%motion%coordinates())]
      simulation = c_loc(handle)
    end if
    code = end_analysis(error, err, moved, merge(kinematics, dynamics, with_forces == 0))
  end function create

  !> End a motion and free its handle. Nothing happens while a call changes it.
  subroutine destroy(simulation) bind(c, name='mech9_simulation_destroy')
    type(c_ptr), value, intent(in) :: simulation   !< the handle, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call claim(simulation, handle, err)
    if (allocated(err)) return
    call handle%motion%close()
    handle%mark = no_mark
    deallocate (handle)
  end subroutine destroy

  !> Go on to a time. After a failure the motion stays at the last time that it reached.
  recursive integer(c_int) function advance(simulation, t, error) bind(c, name='mech9_simulation_advance') result(code)
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    real(c_double), value, intent(in) :: t         !< the time, in the direction of &time [s]
    type(c_ptr), value, intent(in) :: error        !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call begin_call(error)
    call claim(simulation, handle, err)
    if (.not. allocated(err)) call handle%motion%advance(t, err)
    call release(handle)
    code = end_call(error, err)
  end function advance

  !> The present time [s]; not a number where there is no motion.
  real(c_double) function time(simulation) bind(c, name='mech9_simulation_time')
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    time = ieee_value(time, ieee_quiet_nan)
    call find_simulation(simulation, handle, err)
    if (associated(handle)) time = handle%motion%t()
  end function time

  !> Number of coordinates.
  integer(c_int) function coordinates(simulation) bind(c, name='mech9_simulation_coordinates')
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    coordinates = 0
    call find_simulation(simulation, handle, err)
    if (associated(handle)) coordinates = handle%motion%coordinates()
  end function coordinates

  !> Take all coordinates, their rates and second derivatives.
  integer(c_int) function take(simulation, q, dq, ddq, error) bind(c, name='mech9_simulation_take') result(code)
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    type(c_ptr), value, intent(in) :: q            !< (M) gets the coordinates [unit of the data file], or null
    type(c_ptr), value, intent(in) :: dq           !< (M) gets their rates [unit of the data file], or null
    type(c_ptr), value, intent(in) :: ddq          !< (M) gets their second derivatives [unit/s^2], or null
    type(c_ptr), value, intent(in) :: error        !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    real(wp), allocatable :: found(:, :)

    call begin_call(error)
    call find_simulation(simulation, handle, err)
    if (.not. allocated(err)) then
      allocate (found(size(handle%units), 3))
      call handle%motion%take_coordinates(found(:, 1), found(:, 2), found(:, 3))
      call put(found(:, 1)/handle%units, q)
      call put(found(:, 2)/handle%rate_units, dq)
      call put(found(:, 3)/handle%units, ddq)
    end if
    code = end_call(error, err)
  end function take

  !> Motion of a named point, in the system of link 1.
  integer(c_int) function point(simulation, name, position, velocity, acceleration, error) &
    bind(c, name='mech9_simulation_point') result(code)
    type(c_ptr), value, intent(in) :: simulation     !< the handle
    type(c_ptr), value, intent(in) :: name           !< of the point
    type(c_ptr), value, intent(in) :: position       !< (3) gets the position [m], or null
    type(c_ptr), value, intent(in) :: velocity       !< (3) gets the velocity [m/s], or null
    type(c_ptr), value, intent(in) :: acceleration   !< (3) gets the acceleration [m/s^2], or null
    type(c_ptr), value, intent(in) :: error          !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    real(wp) :: found(3, 3)

    call begin_call(error)
    call read_c_text(name, text)
    call find_simulation(simulation, handle, err)
    if (.not. allocated(err)) call handle%motion%point(text, err, found(:, 1), found(:, 2), found(:, 3))
    if (.not. allocated(err)) then
      call put(found(:, 1), position)
      call put(found(:, 2), velocity)
      call put(found(:, 3), acceleration)
    end if
    code = end_call(error, err)
  end function point

  !> Energies of the present position.
  recursive integer(c_int) function energies(simulation, kinetic, potential, error) &
    bind(c, name='mech9_simulation_energies') result(code)
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    real(c_double), intent(out) :: kinetic         !< of all bodies [J]
    real(c_double), intent(out) :: potential       !< of gravity and springs [J]
    type(c_ptr), value, intent(in) :: error        !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call begin_call(error)
    kinetic = ieee_value(kinetic, ieee_quiet_nan)
    potential = kinetic
    call claim(simulation, handle, err)
    if (.not. allocated(err)) call handle%motion%energies(kinetic, potential)
    call release(handle)
    code = end_call(error, err)
  end function energies

  !> Largest gap of a closed chain [m]; not a number where there is no motion.
  real(c_double) function closure(simulation) bind(c, name='mech9_simulation_closure')
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    closure = ieee_value(closure, ieee_quiet_nan)
    call find_simulation(simulation, handle, err)
    if (associated(handle)) closure = handle%motion%closure()
  end function closure

  !> Give a number of a load or a motor another value, from the present time on.
  recursive integer(c_int) function set(simulation, name, value, error) bind(c, name='mech9_simulation_set') result(code)
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    type(c_ptr), value, intent(in) :: name         !< of the number, as load(1).force(2)
    real(c_double), value, intent(in) :: value     !< in the unit of the data file
    type(c_ptr), value, intent(in) :: error        !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text

    call begin_call(error)
    call read_c_text(name, text)
    call claim(simulation, handle, err)
    if (.not. allocated(err)) call handle%motion%set(text, value, err)
    call release(handle)
    code = end_call(error, err)
  end function set

  !> Number of free coordinates, whose motion follows from forces.
  integer(c_int) function free_coordinates(simulation) bind(c, name='mech9_simulation_free')
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    free_coordinates = 0
    call find_simulation(simulation, handle, err)
    if (associated(handle)) free_coordinates = handle%motion%free_coordinates()
  end function free_coordinates

  !> Take the equations of motion of the free coordinates, mass matrix times accelerations + bias = 0, in SI units.
  recursive integer(c_int) function take_equations(simulation, numbers, mass_matrix, bias, error) &
    bind(c, name='mech9_simulation_equations') result(code)
    type(c_ptr), value, intent(in) :: simulation    !< the handle
    type(c_ptr), value, intent(in) :: numbers       !< (n) gets the numbers of the free coordinates, from 1, or null
    type(c_ptr), value, intent(in) :: mass_matrix   !< (n,n) gets the mass matrix, or null
    type(c_ptr), value, intent(in) :: bias          !< (n) gets the bias, or null
    type(c_ptr), value, intent(in) :: error         !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    integer, allocatable :: coordinates(:)
    integer(c_int), pointer :: array(:)
    real(wp), allocatable :: inertia(:, :), forces(:)

    call begin_call(error)
    call claim(simulation, handle, err)
    if (.not. allocated(err)) call handle%motion%take_equations(coordinates, inertia, forces, err)
    if (.not. allocated(err)) then
      if (c_associated(numbers)) then
        call c_f_pointer(numbers, array, [size(coordinates)])
        array = coordinates
      end if
      call put(reshape(inertia, [size(inertia)]), mass_matrix)
      call put(forces, bias)
    end if
    call release(handle)
    code = end_call(error, err)
  end function take_equations

  !> How many numbers a state has.
  integer(c_int) function size_of_state(simulation) bind(c, name='mech9_simulation_state_size')
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    real(wp), allocatable :: numbers(:)

    size_of_state = 0
    call find_simulation(simulation, handle, err)
    if (allocated(err)) return
    call handle%motion%take_state(numbers)
    size_of_state = size(numbers)
  end function size_of_state

  !> Take the present state.
  integer(c_int) function take_state(simulation, state, error) bind(c, name='mech9_simulation_state') result(code)
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    type(c_ptr), value, intent(in) :: state        !< gets the numbers of the state
    type(c_ptr), value, intent(in) :: error        !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    real(wp), allocatable :: numbers(:)

    call begin_call(error)
    call find_simulation(simulation, handle, err)
    if (.not. allocated(err)) then
      call handle%motion%take_state(numbers)
      call put(numbers, state)
    end if
    code = end_call(error, err)
  end function take_state

  !> Go to a state, perhaps of another simulation of the same mechanism: the motion starts there anew.
  recursive integer(c_int) function set_state(simulation, n, state, error) bind(c, name='mech9_simulation_set_state') result(code)
    type(c_ptr), value, intent(in) :: simulation   !< the handle
    integer(c_int), value, intent(in) :: n         !< how many numbers the state has
    type(c_ptr), value, intent(in) :: state        !< the numbers of the state
    type(c_ptr), value, intent(in) :: error        !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    real(c_double), pointer :: numbers(:)

    call begin_call(error)
    call claim(simulation, handle, err)
    if (.not. allocated(err) .and. (n < 0 .or. .not. c_associated(state))) call refuse('this is no state of this mechanism', err)
    if (.not. allocated(err)) then
      call c_f_pointer(state, numbers, [n])
      call handle%motion%go_to_state(numbers, err)
    end if
    call release(handle)
    code = end_call(error, err)
  end function set_state

  !> Put numbers into an array of C, where it is given.
  subroutine put(numbers, address)
    real(wp), intent(in) :: numbers(:)      !< the numbers
    type(c_ptr), intent(in) :: address      !< of the array, or null
    real(c_double), pointer :: array(:)

    if (.not. c_associated(address)) return
    call c_f_pointer(address, array, [size(numbers)])
    array = numbers
  end subroutine put

  !> The handle at an address, for a call that changes it. Fails with exit_usage where there is none, and while another call does.
  subroutine claim(address, handle, err)
    type(c_ptr), intent(in) :: address                               !< its address
    type(simulation_handle_type), pointer, intent(out) :: handle     !< the handle; null after a failure
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed

    call find_simulation(address, handle, err)
    if (allocated(err)) return
    if (handle%is_busy) then
      handle => null()
      call refuse('a call changes this simulation; a user procedure in it, or another thread, must use another simulation', err)
    else
      handle%is_busy = .true.
    end if
  end subroutine claim

  !> End a call that changed a motion.
  subroutine release(handle)
    type(simulation_handle_type), pointer, intent(in) :: handle   !< the handle, or null

    if (associated(handle)) handle%is_busy = .false.
  end subroutine release

  !> The handle at an address. Fails with exit_usage where there is none.
  subroutine find_simulation(address, handle, err)
    type(c_ptr), intent(in) :: address                               !< its address
    type(simulation_handle_type), pointer, intent(out) :: handle     !< the handle
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed

    handle => null()
    if (is_live(address, simulation_mark)) then
      call c_f_pointer(address, handle)
    else
      call refuse('this is no simulation, or it was destroyed; create one first', err)
    end if
  end subroutine find_simulation
end module mech9_api_simulation
