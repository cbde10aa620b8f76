!> Failures as values: made, and given places on the way up.
module test_error
  use mech9_error, only: error_type, place_type, raise, add_place, exit_internal, exit_data, exit_structure
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('failures')) call failures(test)
  end subroutine run

  subroutine failures(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(error_type), allocatable :: err
    type(error_type) :: fresh

    call add_place(err, 'pair 3', place_type(4, 5))
    call test%is_true(.not. allocated(err), 'a place alone makes no failure')

    call raise(err, exit_data, 'no axis')
    call test%has_error(err, exit_data, 'an error keeps its code')
    call test%is_true(err%message == 'no axis', 'an error keeps its message')
    call test%is_true(err%place%line == 0, 'a new error has no place in a data file')

    call add_place(err, 'pair 3')
    call test%is_true(err%message == 'pair 3: no axis', 'a place stands before the message')
    call add_place(err, place=place_type(4, 5))
    call test%is_true(err%place%line == 4 .and. err%place%column == 5, 'an error takes a place in the data file')
    call add_place(err, 'fig1', place_type(7, 8))
    call test%is_true(err%message == 'fig1: pair 3: no axis', 'outer places stand before inner ones')
    call test%is_true(err%place%line == 4, 'the first place in the data file is the nearest and stays')

    call raise(err, exit_structure, 'links apart', place_type(2, 1))
    call test%has_error(err, exit_structure, 'a new failure replaces an old one')
    call test%is_true(err%message == 'links apart' .and. err%place%line == 2, &
                      'a new failure replaces the message and the place of the old one')
    call test%is_true(fresh%code == exit_internal, 'a failure without a code is a defect of the program')
  end subroutine failures
end module test_error
