!> Linearised equations of motion for C, about an equilibrium and along a motion (include/mech9.h).
module mech9_api_linear
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_null_ptr
  use mech9, only: wp, error_type, mechanism_type, linear_system_type, linear_along_type, find_linear_system, find_linear_along, &
    name_coordinates, dynamics
  use mech9_api_error, only: begin_call
  use mech9_api_interruption, only: flag_interruption_type, new_interruption
  use mech9_api_mechanism, only: find_mechanism
  use mech9_api_results, only: results_type, matrix_type, show_results, put_texts, put_matrix
  use mech9_api_analyses, only: end_analysis
  implicit none
  private
  public :: find_linear, find_linear_at

contains

  !> Linearise the equations of motion about the equilibrium to which the start leads: the matrices second_order/M, C, K and
  !> state_space/A, B, C, D, and a row with the coordinates in equilibrium.
  integer(c_int) function find_linear(mechanism, results, error) bind(c, name='mech9_linear') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    type(c_ptr), intent(out) :: results           !< the matrices; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: resting
    type(linear_system_type) :: system
    type(results_type), pointer :: found
    character(len=:), allocatable :: names(:), units(:)
    real(wp), allocatable :: sizes(:)
    type(error_type), allocatable :: err

    call begin_call(error)
    results = c_null_ptr
    call find_mechanism(mechanism, resting, err)
    if (.not. allocated(err)) call find_linear_system(resting, system, err)
    if (.not. allocated(err)) call name_coordinates(resting, names, units, sizes, err)
    if (.not. allocated(err)) then
      allocate (found)
      call put_texts(names, found%names)
      call put_texts(units, found%units)
      allocate (found%rows(size(names), 1))
      found%rows(:, 1) = system%q/sizes
      found%count = 1
      allocate (found%matrices(7))
      call put_system(system, '', found%matrices)
      results = show_results(found)
    end if
    code = end_analysis(error, err, resting, dynamics)
  end function find_linear

  !> Linearise the equations of motion along the motion: a row for each time, with the motion, and the matrices of mech9_linear for each,
  !> with the number of the time from 0 before their names: 0/second_order/M.
  integer(c_int) function find_linear_at(mechanism, count, times, stop, results, error) bind(c, name='mech9_linear_at') result(code)
    type(c_ptr), value, intent(in) :: mechanism   !< the mechanism
    integer(c_int), value, intent(in) :: count    !< number of times; 0: all outputs
    real(c_double), intent(in) :: times(*)        !< the times in the order of the motion [s]
    type(c_ptr), value, intent(in) :: stop        !< address of a number that stops the motion once it is not 0, or null
    type(c_ptr), intent(out) :: results           !< the rows and matrices; null after a failure
    type(c_ptr), value, intent(in) :: error       !< handle of errors, or null
    type(mechanism_type), pointer :: moved
    type(linear_along_type) :: along
    type(results_type), pointer :: found
    type(flag_interruption_type) :: interruption
    type(error_type), allocatable :: err
    character(len=12) :: number
    integer :: i

    call begin_call(error)
    results = c_null_ptr
    call new_interruption(stop, interruption)
    call find_mechanism(mechanism, moved, err)
    if (.not. allocated(err)) call find_linear_along(moved, times(:max(0, count)), along, err, interruption)
    if (.not. allocated(err)) then
      allocate (found)
      call put_texts(along%columns, found%names)
      call put_texts(along%column_units, found%units)
      allocate (found%rows(size(along%rows, 1), size(along%rows, 2)))
      found%rows = along%rows
      found%count = size(along%systems)
      allocate (found%matrices(7*found%count))
      do i = 1, found%count
        write (number, '(i0)') i - 1
        call put_system(along%systems(i), trim(number)//'/', found%matrices(7*i - 6:7*i))
      end do
      results = show_results(found)
    end if
    code = end_analysis(error, err, moved, dynamics)
  end function find_linear_at

  !> Put the matrices of a linear system with their names.
  subroutine put_system(system, prefix, matrices)
    type(linear_system_type), intent(in) :: system       !< the system
    character(len=*), intent(in) :: prefix               !< of the names of its matrices
    type(matrix_type), intent(inout) :: matrices(7)      !< get the matrices
    integer :: n

    n = size(system%free)
    associate (m => matrices, s => system, free => system%states(:n), units_of_free => system%state_units(:n))
      call put_matrix(prefix//'second_order/M', s%inertia, free, units_of_free, free, units_of_free, m(1))
      call put_matrix(prefix//'second_order/C', s%damping, free, units_of_free, free, units_of_free, m(2))
      call put_matrix(prefix//'second_order/K', s%stiffness, free, units_of_free, free, units_of_free, m(3))
      call put_matrix(prefix//'state_space/A', s%space%a, s%states, s%state_units, s%states, s%state_units, m(4))
      call put_matrix(prefix//'state_space/B', s%space%b, s%states, s%state_units, s%inputs, s%input_units, m(5))
      call put_matrix(prefix//'state_space/C', s%space%c, s%outputs, s%output_units, s%states, s%state_units, m(6))
      call put_matrix(prefix//'state_space/D', s%space%d, s%outputs, s%output_units, s%inputs, s%input_units, m(7))
    end associate
  end subroutine put_system
end module mech9_api_linear
