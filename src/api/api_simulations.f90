!> Many motions of one mechanism for C, side by side (include/mech9.h).
module mech9_api_simulations
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_associated, c_f_pointer
  use mech9, only: wp, error_type, exit_usage
  use mech9_api_text, only: read_c_text
  use mech9_api_error, only: begin_call, end_call, refuse
  use mech9_api_simulation, only: simulation_handle_type, find_simulation, claim, release
  implicit none
  private
  public :: advance, set, take

contains

  !> Go on to a time with all motions that can go on. Fails with exit_usage for a time before the present one.
  recursive integer(c_int) function advance(simulations, n, t, codes, error) bind(c, name='mech9_simulations_advance') result(code)
    integer(c_int), value, intent(in) :: n            !< number of motions
    type(c_ptr), intent(in) :: simulations(n)         !< their handles
    real(c_double), value, intent(in) :: t            !< the time [s]
    integer(c_int), intent(inout) :: codes(n)         !< exit code of each motion; those with another one than 0 are left out
    type(c_ptr), value, intent(in) :: error           !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    integer :: i

    call begin_call(error)
    do i = 1, n
      if (codes(i) /= 0) cycle
      call claim(simulations(i), handle, err)
      if (allocated(err)) exit
      call handle%motion%advance(t, err)
      call release(handle)
      if (.not. allocated(err)) cycle
      if (err%code == exit_usage) exit
      codes(i) = err%code
      deallocate (err)
    end do
    code = end_call(error, err)
  end function advance

  !> Give a number of a load or a motor a value in each motion, from the present time on.
  recursive integer(c_int) function set(simulations, n, name, values, codes, error) &
    bind(c, name='mech9_simulations_set') result(code)
    integer(c_int), value, intent(in) :: n            !< number of motions
    type(c_ptr), intent(in) :: simulations(n)         !< their handles
    type(c_ptr), value, intent(in) :: name            !< of the number, as load(1).force(2)
    real(c_double), intent(in) :: values(n)           !< in the unit of the data file
    integer(c_int), intent(in) :: codes(n)            !< exit code of each motion; those with another one than 0 are left out
    type(c_ptr), value, intent(in) :: error           !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text
    integer :: i

    call begin_call(error)
    call read_c_text(name, text)
    do i = 1, n
      if (codes(i) /= 0) cycle
      call claim(simulations(i), handle, err)
      if (.not. allocated(err)) call handle%motion%set(text, values(i), err)
      call release(handle)
      if (allocated(err)) exit
    end do
    code = end_call(error, err)
  end function set

  !> Take the coordinates of all motions, with their rates and second derivatives. They are not numbers where a motion cannot go on.
  integer(c_int) function take(simulations, n, codes, q, dq, ddq, error) bind(c, name='mech9_simulations_take') result(code)
    integer(c_int), value, intent(in) :: n            !< number of motions
    type(c_ptr), intent(in) :: simulations(n)         !< their handles
    integer(c_int), intent(in) :: codes(n)            !< exit code of each motion
    type(c_ptr), value, intent(in) :: q               !< (M,n) gets the coordinates [unit of the data file], or null
    type(c_ptr), value, intent(in) :: dq              !< (M,n) gets their rates [unit of the data file], or null
    type(c_ptr), value, intent(in) :: ddq             !< (M,n) gets their second derivatives [unit/s^2], or null
    type(c_ptr), value, intent(in) :: error           !< handle of errors, or null
    type(simulation_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    real(wp), allocatable :: found(:, :)
    integer :: i

    call begin_call(error)
    do i = 1, n
      call find_simulation(simulations(i), handle, err)
      if (allocated(err)) exit
      if (.not. allocated(found)) allocate (found(size(handle%units), 3))
      if (size(found, 1) /= size(handle%units)) then
        call refuse('the motions must be of one mechanism', err)
        exit
      end if
      call handle%motion%take_coordinates(found(:, 1), found(:, 2), found(:, 3))
      found(:, [1, 3]) = found(:, [1, 3])/spread(handle%units, 2, 2)
      found(:, 2) = found(:, 2)/handle%rate_units
      if (codes(i) /= 0) found = ieee_value(1.0_wp, ieee_quiet_nan)
      call put_row(found(:, 1), i, q)
      call put_row(found(:, 2), i, dq)
      call put_row(found(:, 3), i, ddq)
    end do
    code = end_call(error, err)
  end function take

  !> Put numbers into a row of an array of C, where it is given.
  subroutine put_row(numbers, i, address)
    real(wp), intent(in) :: numbers(:)      !< (M) the numbers
    integer, intent(in) :: i                !< number of the row, from 1
    type(c_ptr), intent(in) :: address      !< of the array, or null
    real(c_double), pointer :: array(:, :)

    if (.not. c_associated(address)) return
    call c_f_pointer(address, array, [size(numbers), i])
    array(:, i) = numbers
  end subroutine put_row
end module mech9_api_simulations
