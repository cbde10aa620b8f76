!> Equilibria and modes of the library against the closed forms of a pendulum: it hangs at -90 degrees and stands at 90; its small
!> vibrations have the frequency sqrt(m g s/J)/(2 pi).
module test_recorded_rest
  use mech9, only: wp, mechanism_type, rest_type, error_type, read_text, exit_usage, exit_data
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: turning = '&structure cq=1 / &pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&body link=2, mass=3, centre=0.5,0,0, inertia=0,0,0.1,0,0,0 / &gravity acceleration=0,-9.81,0 / '
  character(len=*), parameter :: pendulum = turning//'&initial coordinate=1, position=-0.3 /'
  real(wp), parameter :: pi = 3.141592653589793_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_equilibrium')) call check_equilibrium(test)
    if (test%runs('check_starts')) call check_starts(test)
    if (test%runs('check_modes')) call check_modes(test)
    if (test%runs('check_refusals')) call check_refusals(test)
  end subroutine run

  !> The pendulum hangs, and hanging is stable.
  subroutine check_equilibrium(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(rest_type) :: rest
    type(error_type), allocatable :: err

    call read_text(pendulum, mechanism, err)
    call rest%find_equilibria(mechanism, 0, err)
    call test%no_error(err, 'the pendulum comes to rest')
    if (allocated(err)) return
    call test%is_true(size(rest%rows, 2) == 1, 'there is one equilibrium')
    call test%near(number(rest, 'q1', 1), -pi/2, 1e-12_wp, 'the pendulum hangs')
    call test%near(number(rest, 'stable', 1), 1.0_wp, 0.0_wp, 'hanging is stable')
  end subroutine check_equilibrium

  !> Random starts find the upper position, too, and it is not stable.
  subroutine check_starts(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(rest_type) :: rest
    type(error_type), allocatable :: err
    integer :: i

    call read_text(pendulum, mechanism, err)
    call rest%find_equilibria(mechanism, 40, err)
    call test%no_error(err, 'random starts are made')
    if (allocated(err)) return
    call test%is_true(size(rest%rows, 2) >= 1 .and. size(rest%rows, 2) <= 2, 'a pendulum has two equilibria')
    do i = 1, size(rest%rows, 2)
      call test%near(abs(number(rest, 'q1', i)), pi/2, 1e-10_wp, 'an equilibrium is upright')
      call test%is_true((number(rest, 'stable', i) > 0.5_wp) .eqv. (number(rest, 'q1', i) < 0.0_wp), 'hanging alone is stable')
    end do
  end subroutine check_starts

  !> m = 3 kg, s = 0.5 m, J = 0.1 + 3*0.5**2 kg m^2.
  subroutine check_modes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(rest_type) :: rest
    type(error_type), allocatable :: err

    call read_text(pendulum, mechanism, err)
    call rest%find_modes(mechanism, err)
    call test%no_error(err, 'the pendulum has modes')
    if (allocated(err)) return
    call test%is_true(size(rest%rows, 2) == 1, 'there is one mode')
    call test%near(number(rest, 'frequency', 1), sqrt(3.0_wp*9.81_wp*0.5_wp/0.85_wp)/(2.0_wp*pi), 1e-12_wp, &
                   'its frequency is that of the closed form')
    call test%near(number(rest, 'damping', 1), 0.0_wp, 1e-12_wp, 'nothing damps it')
  end subroutine check_modes

  !> Nothing can rest where all is driven; a failure leaves no rows.
  subroutine check_refusals(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(rest_type) :: rest
    type(error_type), allocatable :: err

    call rest%find_equilibria(mechanism, 0, err)
    call test%has_error(err, exit_usage, 'nothing rests while no mechanism was read')
    call read_text(turning//'&drive coordinate=1, kind=''polynomial'', coefficients=0, 1 /', mechanism, err)
    call rest%find_equilibria(mechanism, 0, err)
    call test%has_error(err, exit_data, 'a driven pendulum cannot come to rest')
    call test%is_true(size(rest%rows) == 0 .and. size(rest%names) == 0, 'a failure leaves no rows')
    call rest%find_modes(mechanism, err)
    call test%has_error(err, exit_data, 'a driven pendulum has no modes')
  end subroutine check_refusals

  !> A number of a table by the name of its column.
  real(wp) function number(rest, name, row)
    type(rest_type), intent(in) :: rest      !< with rows
    character(len=*), intent(in) :: name     !< of the column
    integer, intent(in) :: row               !< number of the row

    number = rest%rows(findloc(rest%names == name, .true., dim=1), row)
  end function number
end module test_recorded_rest
