!> Equations of motion as a function for C: x' = f(x, p, t) with exact derivatives (include/mech9.h).
module mech9_api_equations
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_null_ptr, c_associated, c_f_pointer, c_loc
  use mech9, only: wp, error_type, mechanism_type, equations_type, name_coordinates, dynamics
  use mech9_api_handle, only: is_live, equations_mark, no_mark
  use mech9_api_text, only: c_text_type
  use mech9_api_error, only: begin_call, end_call, refuse
  use mech9_api_mechanism, only: find_mechanism
  use mech9_api_analyses, only: end_analysis
  implicit none
  private
  public :: create, destroy, states, parameters, name, unit, start, find

  type :: equations_handle_type
    integer(c_int) :: mark = equations_mark
    type(equations_type) :: equations
    type(c_text_type) :: shown             !< the text that the caller asked for last
    logical :: is_busy = .false.           !< a call moves it; a user procedure in it, or another thread, must not
  end type equations_handle_type

contains

  !> Begin the equations of motion.
  integer(c_int) function create(mechanism, q, with_clock, equations, error) bind(c, name='mech9_equations_create') result(code)
    type(c_ptr), value, intent(in) :: mechanism       !< the mechanism; it may be destroyed afterwards
    type(c_ptr), value, intent(in) :: q               !< (M) all coordinates of a closed position [rad, m]; null: the assembled start
    integer(c_int), value, intent(in) :: with_clock   !< not 0: the phase of drives and loads is a part of the state
    type(c_ptr), intent(out) :: equations             !< the handle; null after a failure
    type(c_ptr), value, intent(in) :: error           !< handle of errors, or null
    type(mechanism_type), pointer :: moved
    type(equations_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:), units(:)
    real(c_double), pointer :: given(:)
    real(wp), allocatable :: sizes(:)

    call begin_call(error)
    equations = c_null_ptr
    call find_mechanism(mechanism, moved, err)
    if (.not. allocated(err) .and. c_associated(q)) call name_coordinates(moved, names, units, sizes, err)
    if (.not. allocated(err)) then
      allocate (handle)
      if (c_associated(q)) then
        call c_f_pointer(q, given, [size(sizes)])
        call handle%equations%begin(moved, err, given, with_clock /= 0)
      else
        call handle%equations%begin(moved, err, with_clock=with_clock /= 0)
      end if
      if (allocated(err)) deallocate (handle)
    end if
    if (.not. allocated(err)) equations = c_loc(handle)
    code = end_analysis(error, err, moved, dynamics)
  end function create

  !> Free a handle. Nothing happens while a call moves it.
  subroutine destroy(equations) bind(c, name='mech9_equations_destroy')
    type(c_ptr), value, intent(in) :: equations   !< the handle, or null
    type(equations_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call find_handle(equations, handle, err)
    if (allocated(err)) return
    if (handle%is_busy) return
    call handle%equations%close()
    call handle%shown%clear()
    handle%mark = no_mark
    deallocate (handle)
  end subroutine destroy

  !> Number of states.
  integer(c_int) function states(equations) bind(c, name='mech9_equations_states') result(n)
    type(c_ptr), value, intent(in) :: equations   !< the handle
    type(equations_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    n = 0
    call find_handle(equations, handle, err)
    if (associated(handle)) n = handle%equations%count_states()
  end function states

  !> Number of parameters.
  integer(c_int) function parameters(equations) bind(c, name='mech9_equations_parameters') result(n)
    type(c_ptr), value, intent(in) :: equations   !< the handle
    type(equations_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    n = 0
    call find_handle(equations, handle, err)
    if (associated(handle)) n = handle%equations%count_parameters()
  end function parameters

  !> Name of a state, or behind all states of a parameter; null where there is none.
  type(c_ptr) function name(equations, i) bind(c, name='mech9_equations_name')
    type(c_ptr), value, intent(in) :: equations   !< the handle
    integer(c_int), value, intent(in) :: i        !< its place, from 0

    call show(equations, i, .false., name)
  end function name

  !> Unit of a state or a parameter; null where there is none.
  type(c_ptr) function unit(equations, i) bind(c, name='mech9_equations_unit')
    type(c_ptr), value, intent(in) :: equations   !< the handle
    integer(c_int), value, intent(in) :: i        !< its place, from 0

    call show(equations, i, .true., unit)
  end function unit

  !> Show the name or the unit of a number.
  subroutine show(equations, i, is_unit, text)
    type(c_ptr), intent(in) :: equations          !< the handle
    integer(c_int), intent(in) :: i               !< place of the number, from 0
    logical, intent(in) :: is_unit                !< its unit, else its name
    type(c_ptr), intent(out) :: text              !< the text, or null
    type(equations_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:), units(:)

    text = c_null_ptr
    call find_handle(equations, handle, err)
    if (allocated(err)) return
    call handle%equations%name_all(names, units)
    if (i < 0 .or. i >= size(names)) return
    if (is_unit) then
      call handle%shown%put(trim(units(i + 1)))
    else
      call handle%shown%put(trim(names(i + 1)))
    end if
    text = handle%shown%address()
  end subroutine show

  !> The state at which the equations began, and the parameters of the data file.
  integer(c_int) function start(equations, x, values, error) bind(c, name='mech9_equations_start') result(code)
    type(c_ptr), value, intent(in) :: equations   !< the handle
    type(c_ptr), value, intent(in) :: x           !< (states) gets the state in SI units, or null
    type(c_ptr), value, intent(in) :: values      !< (parameters) gets the parameters in the units of the data file, or null
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(equations_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    real(wp), allocatable :: first_x(:), first_values(:)
    real(c_double), pointer :: numbers(:)

    call begin_call(error)
    call find_handle(equations, handle, err)
    if (.not. allocated(err)) then
      call handle%equations%start(first_x, first_values)
      if (c_associated(x)) then
        call c_f_pointer(x, numbers, [size(first_x)])
        numbers = first_x
      end if
      if (c_associated(values)) then
        call c_f_pointer(values, numbers, [size(first_values)])
        numbers = first_values
      end if
    end if
    code = end_call(error, err)
  end function start

  !> Find the rates of a state, and their derivatives.
  recursive integer(c_int) function find(equations, t, x, values, f, by_state, by_parameters, error) &
    bind(c, name='mech9_equations_find') result(code)
    type(c_ptr), value, intent(in) :: equations       !< the handle
    real(c_double), value, intent(in) :: t            !< time [s]; unused with a clock
    type(c_ptr), value, intent(in) :: x               !< (states) in SI units
    type(c_ptr), value, intent(in) :: values          !< (parameters) in the units of the data file
    type(c_ptr), value, intent(in) :: f               !< (states) gets the rates in SI units
    type(c_ptr), value, intent(in) :: by_state        !< [states][states] gets derivatives, a row for each rate, or null
    type(c_ptr), value, intent(in) :: by_parameters   !< [states][parameters] gets derivatives, or null
    type(c_ptr), value, intent(in) :: error           !< handle of errors, or null
    type(equations_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call begin_call(error)
    call find_handle(equations, handle, err)
    if (.not. allocated(err)) then
      if (handle%is_busy) then
        call refuse('a call moves these equations; a user procedure in it, or another thread, must not', err)
      else if (.not. (c_associated(x) .and. c_associated(f) .and. &
                      (c_associated(values) .or. handle%equations%count_parameters() == 0))) then
        call refuse('equations of motion need arrays for states, parameters and rates', err)
      end if
    end if
    if (.not. allocated(err)) then
      handle%is_busy = .true.
      call find_with(handle, t, x, values, f, by_state, by_parameters, err)
      handle%is_busy = .false.
    end if
    code = end_call(error, err)
  end function find

  !> Find the rates and derivatives in arrays of C.
  recursive subroutine find_with(handle, t, x, values, f, by_state, by_parameters, err)
    type(equations_handle_type), intent(inout) :: handle     !< the equations
    real(c_double), intent(in) :: t                          !< time [s]
    type(c_ptr), intent(in) :: x                             !< (states)
    type(c_ptr), intent(in) :: values                        !< (parameters), or null where there are none
    type(c_ptr), intent(in) :: f                             !< (states) gets the rates
    type(c_ptr), intent(in) :: by_state                      !< [states][states] gets derivatives, or null
    type(c_ptr), intent(in) :: by_parameters                 !< [states][parameters] gets derivatives, or null
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    real(c_double), pointer :: state(:), given(:), rates(:), rows(:, :)
    real(wp), allocatable :: of_state(:, :), of_parameters(:, :)
    real(wp), target :: none(0)
    integer :: n, p

    n = handle%equations%count_states()
    p = handle%equations%count_parameters()
    call c_f_pointer(x, state, [n])
    call c_f_pointer(f, rates, [n])
    given => none
    if (p > 0) call c_f_pointer(values, given, [p])
    allocate (of_state(n, n), of_parameters(n, p))
    if (c_associated(by_parameters)) then
      call handle%equations%find(state, given, rates, err, of_state, of_parameters, t)
      call c_f_pointer(by_parameters, rows, [p, n])
      rows = transpose(of_parameters)
    else if (c_associated(by_state)) then
      call handle%equations%find(state, given, rates, err, of_state, t=t)
    else
      call handle%equations%find(state, given, rates, err, t=t)
    end if
    if (.not. c_associated(by_state)) return
    call c_f_pointer(by_state, rows, [n, n])
    rows = transpose(of_state)
  end subroutine find_with

  !> The handle at an address. Fails with exit_usage where there is none.
  subroutine find_handle(address, handle, err)
    type(c_ptr), intent(in) :: address                              !< its address
    type(equations_handle_type), pointer, intent(out) :: handle     !< the handle
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed

    handle => null()
    if (is_live(address, equations_mark)) then
      call c_f_pointer(address, handle)
    else
      call refuse('these are no equations of motion, or they were destroyed; create them first', err)
    end if
  end subroutine find_handle
end module mech9_api_equations
