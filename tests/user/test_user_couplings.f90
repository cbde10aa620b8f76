!> Couplings by user procedures: both forms against closed forms, up to the third derivative.
module test_user_couplings
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, place_type, exit_data
  use mech9_random, only: random_type
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_procedure_coupling, only: procedure_coupling_type, make_procedure_coupling
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('closed_form')) call closed_form(test)
    if (test%runs('end_of_domain')) call end_of_domain(test)
  end subroutine run

  !> Couplings in Taylor arithmetic and in plain values.
  subroutine make_both(test, number, parameters, couplings)
    type(tester_type), intent(inout) :: test                     !< counts the checks
    integer, intent(in) :: number                                !< selects the function
    real(wp), intent(in) :: parameters(:)                        !< of the function
    type(procedure_coupling_type), intent(out) :: couplings(2)   !< in Taylor arithmetic, in plain values
    type(error_type), allocatable :: err

    call make_procedure_coupling(number, 0.0_wp, parameters, registered_procedure_type(), couplings(1), err)
    call test%no_error(err, 'a coupling whose procedure is linked is accepted')
    call test%is_true(.not. couplings(1)%plain_values, 'where both forms are linked Taylor arithmetic is taken')
    couplings(2) = couplings(1)
    couplings(2)%plain_values = .true.
  end subroutine make_both

  !> A wave and its derivatives; the weight makes its slope where it starts, or one, the greatest derivative.
  subroutine closed_form(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(procedure_coupling_type) :: couplings(2)
    type(error_type), allocatable :: err
    real(wp) :: p(3), q, expected(0:3), found(0:3), finer
    !> Differences of plain values are as accurate as those of drives; another difference loses one digit more.
    real(wp), parameter :: near(0:3) = [1.0e-12_wp, 1.0e-11_wp, 1.0e-10_wp, 1.0e-8_wp]
    integer :: i, form, order

    do i = 1, 20
      p = [random%symmetric(), random%symmetric(), 3.0_wp*random%symmetric()]
      q = 3.0_wp*random%symmetric()
      expected = [p(1)*q + p(2)*sin(p(3)*q), p(1) + p(2)*p(3)*cos(p(3)*q), -p(2)*p(3)**2*sin(p(3)*q), &
                  -p(2)*p(3)**3*cos(p(3)*q)]
      call make_both(test, 1, p, couplings)
      do form = 1, 2
        call couplings(form)%find_curve(q, found(0:2), err)
        call test%no_error(err, 'the coupling has a value')
        call couplings(form)%find_third(q, found(3), err)
        call test%no_error(err, 'the coupling has a third derivative')
        finer = merge(1.0_wp, 1.0e-3_wp, form == 2)
        do order = 0, 3
          ! the third derivative is a difference in both forms
          if (order == 3) finer = 1.0_wp
          call test%near(found(order), expected(order), near(order)*finer, 'value and derivatives')
        end do
      end do
      call test%near(couplings(1)%weight([1.0_wp, 1.0_wp]), 1.0_wp/max(1.0_wp, abs(p(1) + p(2)*p(3))), 1.0e-12_wp, 'the weight')
    end do
  end subroutine closed_form

  !> A coordinate beyond the domain of the procedure.
  subroutine end_of_domain(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(procedure_coupling_type) :: couplings(2)
    type(error_type), allocatable :: err
    real(wp) :: curve(0:2)
    integer :: form

    call make_both(test, 2, [real(wp) ::], couplings)
    do form = 1, 2
      couplings(form)%place = place_type(7, 1)
      call couplings(form)%find_curve(1.25_wp, curve, err)
      call test%has_error(err, exit_data, 'a coordinate beyond the end of the domain is refused')
      call test%is_true(index(err%message, 'coupling 2') > 0 .and. index(err%message, '1.25') > 0 .and. &
                        index(err%message, 'not finite') > 0 .and. err%place%line == 7, &
                        'the message names the coupling, the coordinate, the reason and the place')
    end do
  end subroutine end_of_domain
end module test_user_couplings
