!> The choice of the next step where the law of the error is known.
module test_step_choice
  use mech9_kinds, only: wp
  use mech9_step_choice, only: next_step_length
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  real(wp), parameter :: steps(3) = [0.3_wp, 1.0_wp, 2.5_wp]

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('known_law')) call known_law(test)
  end subroutine run

  !> The error is a power of the step times a constant.
  subroutine known_law(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: h, h_before, constant, chosen
    integer :: i, j, order

    do order = 1, 8
      constant = 0.2_wp**order
      do i = 1, 3
        h = steps(i)
        ! error = constant h**order: the error is one at h = 5, whatever the steps were
        call test%near(next_step_length(h, 0.0_wp, law(constant, h, order), 1.0_wp, order), 5.0_wp, 1.0e-13_wp, &
                       'the first step meets the error that is allowed')
        do j = 1, 3
          h_before = steps(j)
          chosen = next_step_length(h, h_before, law(constant, h, order), law(constant, h_before, order), order)
          call test%near(chosen, 5.0_wp, 1.0e-13_wp, 'a step of another length before it does not mislead the choice')
          ! the constant has doubled: half of that trend is to come, 2**(1/2) in the error
          chosen = next_step_length(h, h_before, law(2.0_wp*constant, h, order), law(constant, h_before, order), order)
          call test%near(law(2.0_wp*sqrt(2.0_wp)*constant, chosen, order), 1.0_wp, 1.0e-12_wp, &
                         'half of the trend of the error goes on')
        end do
        chosen = next_step_length(-h, -h, law(constant, h, order), law(constant, h, order), order)
        call test%near(chosen, -5.0_wp, 1.0e-13_wp, 'a step backward in time is chosen as one forward')
      end do
      chosen = next_step_length(1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, order)
      call test%is_true(chosen > 1.0_wp .and. chosen <= 1.0e11_wp, 'a step without any error grows and stays finite')
    end do
  end subroutine known_law

  pure real(wp) function law(constant, h, order)
    real(wp), intent(in) :: constant   !< factor of the law
    real(wp), intent(in) :: h          !< length of the step [s]
    integer, intent(in) :: order       !< of the method

    law = constant*abs(h)**order
  end function law
end module test_step_choice
