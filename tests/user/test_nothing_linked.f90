!> No procedure of a user is linked: whoever asks for one is told so.
module test_nothing_linked
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type, new_force_sum
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_procedure_pair, only: procedure_pair_type, make_procedure_pair
  use mech9_procedure_drive, only: procedure_drive_type, make_procedure_drive
  use mech9_procedure_load, only: procedure_load_type
  use mech9_procedure_coupling, only: procedure_coupling_type, make_procedure_coupling
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('ask_for_procedures')) call ask_for_procedures(test)
  end subroutine run

  subroutine ask_for_procedures(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(procedure_pair_type) :: pair
    type(procedure_drive_type) :: drive
    type(procedure_load_type) :: load
    type(procedure_coupling_type) :: coupling
    type(motion_view_type) :: state
    type(force_sum_type) :: forces
    type(error_type), allocatable :: err

    call make_procedure_pair(3, [1.0_wp, 2.0_wp], registered_procedure_type(), pair, err)
    call test%has_error(err, exit_data, 'a pair without its procedure is refused')
    call test%is_true(index(err%message, 'pair 3') > 0 .and. index(err%message, 'none is linked') > 0 .and. &
                      index(err%message, 'user_pair') > 0, 'the message names the pair, its procedure and that none is linked')

    call make_procedure_drive(5, 0.0_wp, [real(wp) ::], registered_procedure_type(), drive, err)
    call test%has_error(err, exit_data, 'a drive without its procedure is refused')
    call test%is_true(index(err%message, 'coordinate 5') > 0 .and. index(err%message, 'none is linked') > 0 .and. &
                      index(err%message, 'user_drive') > 0, &
                      'the message names the coordinate, its procedure and that none is linked')

    call make_procedure_coupling(2, 0.0_wp, [real(wp) ::], registered_procedure_type(), coupling, err)
    call test%has_error(err, exit_data, 'a coupling without its procedure is refused')
    call test%is_true(index(err%message, 'coupling 2') > 0 .and. index(err%message, 'none is linked') > 0 .and. &
                      index(err%message, 'user_coupling') > 0, &
                      'the message names the coupling, its procedure and that none is linked')

    load%parameters = [real(wp) ::]
    forces = new_force_sum(2, 1)
    allocate (state%links(2), state%q(1), state%dq(1))
    state%q = 0.0_wp
    state%dq = 0.0_wp
    call load%apply(state, forces, err)
    call test%has_error(err, exit_data, 'a load without its procedure is refused')
    call test%is_true(index(err%message, 'none is linked') > 0 .and. index(err%message, 'user_force') > 0, &
                      'the message names the procedure of the load and that none is linked')
  end subroutine ask_for_procedures
end module test_nothing_linked
