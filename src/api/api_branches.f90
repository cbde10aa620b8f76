!> Branches over a parameter for C (include/mech9.h).
module mech9_api_branches
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_null_ptr
  use mech9, only: wp, error_type, mechanism_type, find_position_branches, kinematics, dynamics
  use mech9_api_text, only: read_c_text
  use mech9_api_error, only: begin_call
  use mech9_api_interruption, only: flag_interruption_type, new_interruption
  use mech9_api_mechanism, only: find_mechanism
  use mech9_api_results, only: results_type, show_results, put_texts
  use mech9_api_analyses, only: end_analysis, has_rows
  implicit none
  private
  public :: find_branches

contains

  !> Find the branches of positions over a parameter.
  integer(c_int) function find_branches(mechanism, parameter, with_forces, stop, results, error) bind(c, name='mech9_branch') &
    result(code)
    type(c_ptr), value, intent(in) :: mechanism    !< the mechanism
    type(c_ptr), value, intent(in) :: parameter    !< name of the parameter
    integer(c_int), value, intent(in) :: with_forces   !< 0: positions of driven mechanisms; else positions of rest
    type(c_ptr), value, intent(in) :: stop         !< address of a number that stops the work once it is not 0, or null
    type(c_ptr), intent(out) :: results            !< a row for each point, and their report; null after a failure
    type(c_ptr), value, intent(in) :: error        !< handle of errors, or null
    type(mechanism_type), pointer :: moved
    type(results_type), pointer :: found
    type(flag_interruption_type) :: interruption
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:), units(:), report, name
    real(wp), allocatable :: rows(:, :)
    integer :: program

    call begin_call(error)
    results = c_null_ptr
    program = merge(kinematics, dynamics, with_forces == 0)
    call new_interruption(stop, interruption)
    call read_c_text(parameter, name)
    call find_mechanism(mechanism, moved, err)
    if (.not. allocated(err)) call find_position_branches(moved, program, name, names, units, rows, report, err, interruption)
    if (has_rows(err)) then
      allocate (found)
      call put_texts(names, found%names)
      call put_texts(units, found%units)
      found%count = size(rows, 2)
      allocate (found%rows, source=rows)
      call found%text%put(report)
      results = show_results(found)
    end if
    code = end_analysis(error, err, moved, program)
  end function find_branches
end module mech9_api_branches
