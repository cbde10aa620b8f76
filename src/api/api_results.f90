!> Results for C: a table with named columns, named numbers with their derivatives, and a text (include/mech9.h). Every analysis
!> gives its answer in this form.
module mech9_api_results
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_null_ptr, c_f_pointer, c_loc
  use mech9, only: wp, run_type
  use mech9_data_set_table, only: data_set_table_type
  use mech9_api_handle, only: is_live, results_mark, no_mark
  use mech9_api_text, only: c_text_type
  implicit none
  private
  public :: results_type, matrix_type, show_results, find_results, put_texts, put_matrix

  !> A matrix with names for its rows and columns.
  type :: matrix_type
    type(c_text_type) :: name
    real(wp), pointer :: values(:, :) => null()          !< (columns,rows) owned
    type(c_text_type), allocatable :: row_names(:), row_units(:)
    type(c_text_type), allocatable :: column_names(:), column_units(:)
  end type matrix_type

  !> The answer of an analysis.
  type :: results_type
    integer(c_int), private :: mark = results_mark
    type(c_text_type), allocatable :: names(:)           !< (columns)
    type(c_text_type), allocatable :: units(:)           !< (columns)
    real(wp), pointer :: rows(:, :) => null()            !< (columns,rows) owned
    integer :: count = 0                                 !< rows that are there
    type(c_text_type), allocatable :: number_names(:)    !< (numbers)
    type(c_text_type), allocatable :: number_units(:)    !< (numbers)
    real(wp), allocatable :: numbers(:)                  !< (numbers)
    real(wp), allocatable :: derivatives(:, :)           !< (parameters,numbers) of the numbers by the parameters
    type(matrix_type), allocatable :: matrices(:)        !< (matrices)
    type(run_type), pointer :: run => null()             !< owned: of a run, for its report and its data sets
    type(data_set_table_type) :: layout                  !< of a run: the data sets of its HDF5 file, once they were asked for
    real(wp), pointer :: poses(:, :) => null()           !< (columns,rows) of these, behind the columns of `rows`; owned
    type(c_text_type) :: shown                           !< a text of the layout, which the caller asked for last
    type(c_text_type) :: text                            !< a report: of a run as JSON, of a check in words
    logical :: has_report = .false.                      !< the report of the run has been composed
  end type results_type

contains

  !> Show results to C, which owns them from then on.
  type(c_ptr) function show_results(results)
    type(results_type), pointer, intent(inout) :: results   !< the results

    if (.not. allocated(results%names)) allocate (results%names(0), results%units(0))
    if (.not. allocated(results%numbers)) allocate (results%number_names(0), results%number_units(0), results%numbers(0))
    if (.not. allocated(results%derivatives)) allocate (results%derivatives(0, size(results%numbers)))
    if (.not. allocated(results%matrices)) allocate (results%matrices(0))
    if (.not. associated(results%rows)) allocate (results%rows(size(results%names), 0))
    show_results = c_loc(results)
  end function show_results

  !> Take texts of one length.
  pure subroutine put_texts(from, texts)
    character(len=*), intent(in) :: from(:)                        !< (n) with blanks at their ends
    type(c_text_type), allocatable, intent(inout) :: texts(:)      !< (n) without
    integer :: i

    if (allocated(texts)) deallocate (texts)
    allocate (texts(size(from)))
    do i = 1, size(from)
      call texts(i)%put(trim(from(i)))
    end do
  end subroutine put_texts

  !> Free results.
  subroutine destroy(address) bind(c, name='mech9_results_destroy')
    type(c_ptr), value, intent(in) :: address   !< of the results, or null
    type(results_type), pointer :: results
    integer :: i

    call find_results(address, results)
    if (.not. associated(results)) return
    call clear_texts(results%names)
    call clear_texts(results%units)
    call clear_texts(results%number_names)
    call clear_texts(results%number_units)
    do i = 1, size(results%matrices)
      call clear_matrix(results%matrices(i))
    end do
    call results%text%clear()
    call results%shown%clear()
    deallocate (results%rows)
    if (associated(results%poses)) deallocate (results%poses)
    if (associated(results%run)) then
      call results%run%close()
      deallocate (results%run)
    end if
    results%mark = no_mark
    deallocate (results)
  end subroutine destroy

  !> Take a matrix with the names and units of its rows and columns.
  subroutine put_matrix(name, values, row_names, row_units, column_names, column_units, matrix)
    character(len=*), intent(in) :: name               !< of the matrix
    real(wp), intent(in) :: values(:, :)               !< (rows,columns)
    character(len=*), intent(in) :: row_names(:)       !< (rows)
    character(len=*), intent(in) :: row_units(:)       !< (rows)
    character(len=*), intent(in) :: column_names(:)    !< (columns)
    character(len=*), intent(in) :: column_units(:)    !< (columns)
    type(matrix_type), intent(out) :: matrix           !< the matrix

    call matrix%name%put(name)
    allocate (matrix%values(size(values, 2), size(values, 1)))
    matrix%values = transpose(values)
    call put_texts(row_names, matrix%row_names)
    call put_texts(row_units, matrix%row_units)
    call put_texts(column_names, matrix%column_names)
    call put_texts(column_units, matrix%column_units)
  end subroutine put_matrix

  !> Free a matrix.
  subroutine clear_matrix(matrix)
    type(matrix_type), intent(inout) :: matrix   !< the matrix

    call matrix%name%clear()
    deallocate (matrix%values)
    call clear_texts(matrix%row_names)
    call clear_texts(matrix%row_units)
    call clear_texts(matrix%column_names)
    call clear_texts(matrix%column_units)
  end subroutine clear_matrix

  !> Free texts.
  pure subroutine clear_texts(texts)
    type(c_text_type), intent(inout) :: texts(:)   !< the texts
    integer :: i

    do i = 1, size(texts)
      call texts(i)%clear()
    end do
  end subroutine clear_texts

  !> Number of columns of the table.
  integer(c_int) function columns(address) bind(c, name='mech9_results_columns')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results

    columns = 0
    call find_results(address, results)
    if (associated(results)) columns = size(results%names)
  end function columns

  !> Number of rows of the table.
  integer(c_int) function rows(address) bind(c, name='mech9_results_rows')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results

    rows = 0
    call find_results(address, results)
    if (associated(results)) rows = results%count
  end function rows

  !> Address of the table: row after row, the numbers of the columns of a row side by side.
  type(c_ptr) function data(address) bind(c, name='mech9_results_data')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results

    data = c_null_ptr
    call find_results(address, results)
    if (.not. associated(results)) return
    if (size(results%rows) > 0) data = c_loc(results%rows)
  end function data

  !> Name of a column; null where there is none.
  type(c_ptr) function name_of(address, column) bind(c, name='mech9_results_name')
    type(c_ptr), value, intent(in) :: address       !< of the results
    integer(c_int), value, intent(in) :: column     !< its number, from 0
    type(results_type), pointer :: results

    name_of = c_null_ptr
    call find_results(address, results)
    if (associated(results)) name_of = text_at(results%names, column)
  end function name_of

  !> Unit of a column; null where there is none.
  type(c_ptr) function unit_of(address, column) bind(c, name='mech9_results_unit')
    type(c_ptr), value, intent(in) :: address       !< of the results
    integer(c_int), value, intent(in) :: column     !< its number, from 0
    type(results_type), pointer :: results

    unit_of = c_null_ptr
    call find_results(address, results)
    if (associated(results)) unit_of = text_at(results%units, column)
  end function unit_of

  !> How many numbers have names of their own.
  integer(c_int) function numbers(address) bind(c, name='mech9_results_numbers')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results

    numbers = 0
    call find_results(address, results)
    if (associated(results)) numbers = size(results%numbers)
  end function numbers

  !> Name of a number; null where there is none.
  type(c_ptr) function number_name(address, i) bind(c, name='mech9_results_number_name')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results

    number_name = c_null_ptr
    call find_results(address, results)
    if (associated(results)) number_name = text_at(results%number_names, i)
  end function number_name

  !> Unit of a number; null where there is none.
  type(c_ptr) function number_unit(address, i) bind(c, name='mech9_results_number_unit')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results

    number_unit = c_null_ptr
    call find_results(address, results)
    if (associated(results)) number_unit = text_at(results%number_units, i)
  end function number_unit

  !> A number; not a number where there is none.
  real(c_double) function number(address, i) bind(c, name='mech9_results_number')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(results_type), pointer :: results

    number = ieee_value(number, ieee_quiet_nan)
    call find_results(address, results)
    if (.not. associated(results)) return
    if (i >= 0 .and. i < size(results%numbers)) number = results%numbers(i + 1)
  end function number

  !> Number of the parameters by which the numbers have derivatives.
  integer(c_int) function parameters(address) bind(c, name='mech9_results_parameters')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results

    parameters = 0
    call find_results(address, results)
    if (associated(results)) parameters = size(results%derivatives, 1)
  end function parameters

  !> Derivative of a number by a parameter; not a number where there is none.
  real(c_double) function derivative(address, i, parameter) bind(c, name='mech9_results_derivative')
    type(c_ptr), value, intent(in) :: address          !< of the results
    integer(c_int), value, intent(in) :: i             !< position of the number, from 0
    integer(c_int), value, intent(in) :: parameter     !< position of the parameter, from 0
    type(results_type), pointer :: results

    derivative = ieee_value(derivative, ieee_quiet_nan)
    call find_results(address, results)
    if (.not. associated(results)) return
    if (i >= 0 .and. i < size(results%derivatives, 2) .and. parameter >= 0 .and. parameter < size(results%derivatives, 1)) &
      derivative = results%derivatives(parameter + 1, i + 1)
  end function derivative

  !> Number of matrices.
  integer(c_int) function matrices(address) bind(c, name='mech9_results_matrices')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results

    matrices = 0
    call find_results(address, results)
    if (associated(results)) matrices = size(results%matrices)
  end function matrices

  !> Name of a matrix; null where there is none.
  type(c_ptr) function matrix_name(address, i) bind(c, name='mech9_results_matrix_name')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(matrix_type), pointer :: matrix

    matrix_name = c_null_ptr
    call find_matrix(address, i, matrix)
    if (associated(matrix)) matrix_name = matrix%name%address()
  end function matrix_name

  !> Number of rows of a matrix.
  integer(c_int) function matrix_rows(address, i) bind(c, name='mech9_results_matrix_rows')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(matrix_type), pointer :: matrix

    matrix_rows = 0
    call find_matrix(address, i, matrix)
    if (associated(matrix)) matrix_rows = size(matrix%values, 2)
  end function matrix_rows

  !> Number of columns of a matrix.
  integer(c_int) function matrix_columns(address, i) bind(c, name='mech9_results_matrix_columns')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(matrix_type), pointer :: matrix

    matrix_columns = 0
    call find_matrix(address, i, matrix)
    if (associated(matrix)) matrix_columns = size(matrix%values, 1)
  end function matrix_columns

  !> Address of the numbers of a matrix, row after row; null where there are none.
  type(c_ptr) function matrix_data(address, i) bind(c, name='mech9_results_matrix_data')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< its position, from 0
    type(matrix_type), pointer :: matrix

    matrix_data = c_null_ptr
    call find_matrix(address, i, matrix)
    if (.not. associated(matrix)) return
    if (size(matrix%values) > 0) matrix_data = c_loc(matrix%values)
  end function matrix_data

  !> Name of a row of a matrix; null where there is none.
  type(c_ptr) function row_name(address, i, row) bind(c, name='mech9_results_matrix_row_name')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< position of the matrix, from 0
    integer(c_int), value, intent(in) :: row     !< number of the row, from 0
    type(matrix_type), pointer :: matrix

    row_name = c_null_ptr
    call find_matrix(address, i, matrix)
    if (associated(matrix)) row_name = text_at(matrix%row_names, row)
  end function row_name

  !> Unit of a row of a matrix; null where there is none.
  type(c_ptr) function row_unit(address, i, row) bind(c, name='mech9_results_matrix_row_unit')
    type(c_ptr), value, intent(in) :: address    !< of the results
    integer(c_int), value, intent(in) :: i       !< position of the matrix, from 0
    integer(c_int), value, intent(in) :: row     !< number of the row, from 0
    type(matrix_type), pointer :: matrix

    row_unit = c_null_ptr
    call find_matrix(address, i, matrix)
    if (associated(matrix)) row_unit = text_at(matrix%row_units, row)
  end function row_unit

  !> Name of a column of a matrix; null where there is none.
  type(c_ptr) function column_name(address, i, column) bind(c, name='mech9_results_matrix_column_name')
    type(c_ptr), value, intent(in) :: address       !< of the results
    integer(c_int), value, intent(in) :: i          !< position of the matrix, from 0
    integer(c_int), value, intent(in) :: column     !< number of the column, from 0
    type(matrix_type), pointer :: matrix

    column_name = c_null_ptr
    call find_matrix(address, i, matrix)
    if (associated(matrix)) column_name = text_at(matrix%column_names, column)
  end function column_name

  !> Unit of a column of a matrix; null where there is none.
  type(c_ptr) function column_unit(address, i, column) bind(c, name='mech9_results_matrix_column_unit')
    type(c_ptr), value, intent(in) :: address       !< of the results
    integer(c_int), value, intent(in) :: i          !< position of the matrix, from 0
    integer(c_int), value, intent(in) :: column     !< number of the column, from 0
    type(matrix_type), pointer :: matrix

    column_unit = c_null_ptr
    call find_matrix(address, i, matrix)
    if (associated(matrix)) column_unit = text_at(matrix%column_units, column)
  end function column_unit

  !> One of the matrices of results; null where there is none.
  subroutine find_matrix(address, i, matrix)
    type(c_ptr), intent(in) :: address                      !< of the results
    integer(c_int), intent(in) :: i                         !< its position, from 0
    type(matrix_type), pointer, intent(out) :: matrix       !< the matrix
    type(results_type), pointer :: results

    matrix => null()
    call find_results(address, results)
    if (.not. associated(results)) return
    if (i >= 0 .and. i < size(results%matrices)) matrix => results%matrices(i + 1)
  end subroutine find_matrix

  !> The report of an analysis; null where there is none.
  type(c_ptr) function text_of(address) bind(c, name='mech9_results_text')
    type(c_ptr), value, intent(in) :: address   !< of the results
    type(results_type), pointer :: results
    character(len=:), allocatable :: text

    text_of = c_null_ptr
    call find_results(address, results)
    if (.not. associated(results)) return
    if (associated(results%run) .and. .not. results%has_report) then
      call results%run%report(text)
      call results%text%put(text)
      results%has_report = .true.
    end if
    text_of = results%text%address()
  end function text_of

  !> Address of one of several texts; null where there is none.
  type(c_ptr) function text_at(texts, i)
    type(c_text_type), intent(in) :: texts(:)   !< the texts
    integer(c_int), intent(in) :: i             !< position, from 0

    text_at = c_null_ptr
    if (i >= 0 .and. i < size(texts)) text_at = texts(i + 1)%address()
  end function text_at

  !> The results at an address; null where there are none.
  subroutine find_results(address, results)
    type(c_ptr), intent(in) :: address                        !< their address
    type(results_type), pointer, intent(out) :: results       !< the results

    results => null()
    if (is_live(address, results_mark)) call c_f_pointer(address, results)
  end subroutine find_results
end module mech9_api_results
