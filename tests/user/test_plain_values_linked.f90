!> Only the forms in plain real numbers are linked: they are found, and they are enough.
module test_plain_values_linked
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_pair, only: pair_motion_type
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_procedure_pair, only: procedure_pair_type, make_procedure_pair
  use mech9_procedure_drive, only: procedure_drive_type, make_procedure_drive
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('use_procedures')) call use_procedures(test)
  end subroutine run

  subroutine use_procedures(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(procedure_pair_type) :: pair
    type(procedure_drive_type) :: drive
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err
    real(wp) :: q, dq, ddq

    call make_procedure_pair(2, [real(wp) ::], registered_procedure_type(), pair, err)
    call test%no_error(err, 'a pair in plain values is made')
    call test%is_true(pair%plain_values, 'the form of the pair is found')
    call pair%evaluate(0.5_wp, motion, err)
    call test%no_error(err, 'a pair in plain values is evaluated')
    ! the first point runs along (2 cos q, sin q, 0.3 q^2); 1e-12, 1e-11 and 1e-10 are promised of plain values
    call test%near(motion%pose%p(1), 2.0_wp*cos(0.5_wp), 1.0e-12_wp, 'the first point of the pair lies on its curve')
    call test%near(motion%v(2), cos(0.5_wp), 1.0e-11_wp, 'the point moves with the slope of its curve')
    call test%near(motion%v_rate(3), 0.6_wp, 1.0e-10_wp, 'the second derivative is that of the curve')

    call make_procedure_drive(1, 0.0_wp, [0.0_wp, 1.0_wp, 2.0_wp], registered_procedure_type(), drive, err)
    call test%no_error(err, 'a drive in plain values is made')
    call test%is_true(drive%plain_values, 'the form of the drive is found')
    call drive%evaluate(0.5_wp, q, dq, ddq, err)
    call test%no_error(err, 'a drive in plain values is evaluated')
    call test%near(q, sin(1.0_wp), 1.0e-12_wp, 'the drive has its value')
    call test%near(dq, 2.0_wp*cos(1.0_wp), 1.0e-11_wp, 'the drive has its rate')
    call test%near(ddq, -4.0_wp*sin(1.0_wp), 1.0e-10_wp, 'the drive has its second derivative')
  end subroutine use_procedures
end module test_plain_values_linked
