!> Positions for C: many positions of one mechanism in one call (include/mech9.h).
module mech9_api_positions
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_null_ptr, c_associated, c_f_pointer, c_loc
  use mech9, only: error_type, mechanism_type, positions_type, dynamics
  use mech9_api_handle, only: is_live, positions_mark, no_mark
  use mech9_api_error, only: begin_call, end_call, refuse
  use mech9_api_interruption, only: flag_interruption_type, new_interruption
  use mech9_api_mechanism, only: find_mechanism
  use mech9_api_analyses, only: end_analysis
  implicit none
  private
  public :: create, destroy, coordinates, count_independent, independent_at, find

  type :: positions_handle_type
    integer(c_int) :: mark = positions_mark
    type(positions_type) :: positions
  end type positions_handle_type

contains

  !> Assemble a mechanism whose positions will be asked for.
  integer(c_int) function create(mechanism, positions, error) bind(c, name='mech9_positions_create') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism; it may be destroyed afterwards
    type(c_ptr), intent(out) :: positions         !< the handle; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: assembled
    type(positions_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call begin_call(error)
    positions = c_null_ptr
    call find_mechanism(mechanism, assembled, err)
    if (.not. allocated(err)) then
      allocate (handle)
      call handle%positions%begin(assembled, err)
      if (allocated(err)) deallocate (handle)
    end if
    if (.not. allocated(err)) positions = c_loc(handle)
    code = end_analysis(error, err, assembled, dynamics)
  end function create

  !> Free a handle.
  subroutine destroy(positions) bind(c, name='mech9_positions_destroy')
    type(c_ptr), value, intent(in) :: positions   !< the handle, or null
    type(positions_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    call find_handle(positions, handle, err)
    if (allocated(err)) return
    call handle%positions%close()
    handle%mark = no_mark
    deallocate (handle)
  end subroutine destroy

  !> Number of coordinates of a position.
  integer(c_int) function coordinates(positions) bind(c, name='mech9_positions_coordinates')
    type(c_ptr), value, intent(in) :: positions   !< the handle
    type(positions_handle_type), pointer :: handle
    type(error_type), allocatable :: err

    coordinates = 0
    call find_handle(positions, handle, err)
    if (associated(handle)) coordinates = handle%positions%coordinates()
  end function coordinates

  !> Number of independent coordinates.
  integer(c_int) function count_independent(positions) bind(c, name='mech9_positions_independent') result(n)
    type(c_ptr), value, intent(in) :: positions   !< the handle
    type(positions_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    integer, allocatable :: numbers(:)

    n = 0
    call find_handle(positions, handle, err)
    if (allocated(err)) return
    call handle%positions%independent(numbers)
    n = size(numbers)
  end function count_independent

  !> Number of an independent coordinate, from 1, in the order in which values are given; 0 where there is none.
  integer(c_int) function independent_at(positions, i) bind(c, name='mech9_positions_independent_at') result(number)
    type(c_ptr), value, intent(in) :: positions   !< the handle
    integer(c_int), value, intent(in) :: i        !< its position, from 0
    type(positions_handle_type), pointer :: handle
    type(error_type), allocatable :: err
    integer, allocatable :: numbers(:)

    number = 0
    call find_handle(positions, handle, err)
    if (allocated(err)) return
    call handle%positions%independent(numbers)
    if (i >= 0 .and. i < size(numbers)) number = numbers(i + 1)
  end function independent_at

  !> Find positions, and, where their arrays are given, rates and accelerations in them. A position that is not reached is not a
  !> number; its code tells why.
  integer(c_int) function find(positions, n, values, rates, accelerations, stop, q, dq, ddq, codes, error) &
    bind(c, name='mech9_positions_find') result(code)
    type(c_ptr), value, intent(in) :: positions       !< the handle
    integer(c_int), value, intent(in) :: n            !< number of positions
    type(c_ptr), value, intent(in) :: values          !< (n,I) of the independent coordinates [unit of the data file]
    type(c_ptr), value, intent(in) :: rates           !< (n,I) of the independent coordinates [unit/s], or null
    type(c_ptr), value, intent(in) :: accelerations   !< (n,I) of the independent coordinates [unit/s^2], or null
    type(c_ptr), value, intent(in) :: stop            !< address of a number that stops the call once it is not 0, or null
    type(c_ptr), value, intent(in) :: q               !< (n,M) gets all coordinates [unit of the data file]
    type(c_ptr), value, intent(in) :: dq              !< (n,M) gets their rates [unit/s], or null; needs rates
    type(c_ptr), value, intent(in) :: ddq             !< (n,M) gets second derivatives [unit/s^2], or null; needs accelerations
    type(c_ptr), value, intent(in) :: codes           !< (n) gets 0, or the exit code of the failure of a position
    type(c_ptr), value, intent(in) :: error           !< handle of errors, or null
    type(positions_handle_type), pointer :: handle
    type(flag_interruption_type) :: interruption
    type(error_type), allocatable :: err
    integer, allocatable :: independent(:)
    real(c_double), pointer, dimension(:, :) :: given_q, given_dq, given_ddq, found_q, found_dq, found_ddq
    integer(c_int), pointer :: found_codes(:)
    integer :: m

    call begin_call(error)
    call new_interruption(stop, interruption)
    call find_handle(positions, handle, err)
    if (.not. allocated(err) .and. (n < 0 .or. .not. (c_associated(values) .and. c_associated(q) .and. c_associated(codes)))) &
      call refuse('positions need arrays for values, coordinates and codes', err)
    if (.not. allocated(err)) then
      call handle%positions%independent(independent)
      m = handle%positions%coordinates()
      call c_f_pointer(codes, found_codes, [n])
      call take_array(values, size(independent), n, given_q)
      call take_array(rates, size(independent), n, given_dq)
      call take_array(accelerations, size(independent), n, given_ddq)
      call take_array(q, m, n, found_q)
      call take_array(dq, m, n, found_dq)
      call take_array(ddq, m, n, found_ddq)
      ! a null pointer is an absent argument
      call handle%positions%find(given_q, found_q, found_codes, err, interruption, given_dq, found_dq, given_ddq, found_ddq)
    end if
    code = end_call(error, err)
  end function find

  !> An array of C with a row for each position; null where C gives none.
  subroutine take_array(address, columns, n, array)
    type(c_ptr), intent(in) :: address                              !< of its first number, or null
    integer, intent(in) :: columns                                  !< numbers in a row
    integer(c_int), intent(in) :: n                                 !< number of rows
    real(c_double), pointer, intent(out) :: array(:, :)             !< (columns,n)

    array => null()
    if (c_associated(address)) call c_f_pointer(address, array, [columns, int(n)])
  end subroutine take_array

  !> The handle at an address. Fails with exit_usage where there is none.
  subroutine find_handle(address, handle, err)
    type(c_ptr), intent(in) :: address                              !< its address
    type(positions_handle_type), pointer, intent(out) :: handle     !< the handle
    type(error_type), allocatable, intent(out) :: err               !< allocated if it failed

    handle => null()
    if (is_live(address, positions_mark)) then
      call c_f_pointer(address, handle)
    else
      call refuse('these are no positions, or they were destroyed; create them first', err)
    end if
  end subroutine find_handle
end module mech9_api_positions
