!> Drives by user procedures: both forms against closed forms and against each other.
module test_user_drives
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type, exit_data
  use mech9_random, only: random_type
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_procedure_drive, only: procedure_drive_type, make_procedure_drive
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('closed_form')) call closed_form(test)
    if (test%runs('forms_agree')) call forms_agree(test)
    if (test%runs('end_of_domain')) call end_of_domain(test)
  end subroutine run

  subroutine make_both(test, coordinate, parameters, drives)
    type(tester_type), intent(inout) :: test               !< counts the checks
    integer, intent(in) :: coordinate                      !< selects the function
    real(wp), intent(in) :: parameters(:)                  !< of the function
    type(procedure_drive_type), intent(out) :: drives(2)   !< in Taylor arithmetic, in plain values
    type(error_type), allocatable :: err

    call make_procedure_drive(coordinate, 0.0_wp, parameters, registered_procedure_type(), drives(1), err)
    call test%no_error(err, 'a drive whose procedure is linked is accepted')
    call test%is_true(.not. drives(1)%plain_values, 'where both forms are linked Taylor arithmetic is taken')
    drives(2) = drives(1)
    drives(2)%plain_values = .true.
  end subroutine make_both

  !> Value, first and second derivative to 1e-12, 1e-11, 1e-10, as is promised of plain values.
  subroutine check_drive(test, drive, t, expected, why)
    type(tester_type), intent(inout) :: test          !< counts the checks
    type(procedure_drive_type), intent(in) :: drive   !< the drive
    real(wp), intent(in) :: t                         !< time [s]
    real(wp), intent(in) :: expected(3)               !< value, first and second derivative
    character(len=*), intent(in) :: why               !< the statement that is checked, printed where it is wrong
    type(error_type), allocatable :: err
    real(wp) :: q(3), finer

    call drive%evaluate(t, q(1), q(2), q(3), err)
    call test%no_error(err, why//': the drive has a value')
    finer = merge(1.0_wp, 1.0e-3_wp, drive%plain_values)
    call test%near(q(1), expected(1), 1.0e-12_wp*finer, why//': the value is right')
    call test%near(q(2), expected(2), 1.0e-11_wp*finer, why//': the rate is right')
    call test%near(q(3), expected(3), 1.0e-10_wp*finer, why//': the second derivative is right')
  end subroutine check_drive

  subroutine closed_form(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(procedure_drive_type) :: drives(2)
    real(wp) :: p(3), t, expected(3)
    integer :: i

    do i = 1, 30
      p = [random%symmetric(), random%symmetric(), 6.0_wp*random%symmetric()]
      t = 3.0_wp*random%symmetric()
      expected = [p(1)*t + p(2)*sin(p(3)*t), p(1) + p(2)*p(3)*cos(p(3)*t), -p(2)*p(3)**2*sin(p(3)*t)]
      call make_both(test, 1, p, drives)
      call check_drive(test, drives(1), t, expected, 'a drive with parameters, Taylor arithmetic')
      call check_drive(test, drives(2), t, expected, 'a drive with parameters, plain values')
    end do
  end subroutine closed_form

  subroutine forms_agree(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(procedure_drive_type) :: drives(2)
    type(error_type), allocatable :: err
    real(wp) :: t, expected(3)
    integer :: i

    call make_both(test, 3, [real(wp) ::], drives)
    do i = 1, 30
      t = 2.0_wp*random%symmetric()
      call drives(1)%evaluate(t, expected(1), expected(2), expected(3), err)
      call test%no_error(err, 'a drive in Taylor arithmetic is accepted')
      call check_drive(test, drives(2), t, expected, 'a drive in both forms')
    end do
  end subroutine forms_agree

  subroutine end_of_domain(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(procedure_drive_type) :: drives(2)
    type(error_type), allocatable :: err
    real(wp) :: t, s, q, dq, ddq
    integer :: i

    call make_both(test, 2, [real(wp) ::], drives)
    do i = 1, 2
      t = 0.6_wp
      s = sqrt(1.0_wp - t)
      call check_drive(test, drives(i), t, [s, -0.5_wp/s, -0.25_wp/s**3], 'close to the end of the domain')
      drives(i)%place = place_type(6, 1)
      call drives(i)%evaluate(1.25_wp, q, dq, ddq, err)
      call test%has_error(err, exit_data, 'a time beyond the end of the domain is refused')
      call test%is_true(index(err%message, 'coordinate 2') > 0 .and. index(err%message, '1.25') > 0, &
                        'the message about the domain names the coordinate and the time')
      call test%is_true(index(err%message, 'not finite') > 0 .and. err%place%line == 6, &
                        'the message about the domain tells the reason and its place')
    end do
  end subroutine end_of_domain
end module test_user_drives
