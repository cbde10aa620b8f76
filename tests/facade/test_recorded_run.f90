!> Runs of the library: rows, quantities and their derivatives against the closed forms of a centric slider-crank; numbers that are
!> set and read by their names; the text of a mechanism; failures and interruptions.
module test_recorded_run
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9, only: wp, mechanism_type, run_type, interruption_type, error_type, read_text, exit_usage, exit_data, exit_singular, &
    exit_interrupted
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> Crank 0.3 m, rod 1.1 m; the crank turns once in two seconds.
  character(len=*), parameter :: slider_crank = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''prismatic'', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 / '// &
    '&initial coordinate=4, position=1.3 / '// &
    '&drive coordinate=1, kind=''polynomial'', coefficients=0, 3.141592653589793 / '// &
    '&point name=''B'', link=4 / &time end=2, intervals=40 / &quantity name=''stroke'', of=''B.x'', take=''range'' / '
  character(len=*), parameter :: with_parameter = slider_crank// &
    '&parameter name=''crank'', sets=''pair(2).point(1)'', value=0.25 / &output gradients=.true. /'
  real(wp), parameter :: pi = 3.141592653589793_wp

  !> Stops a motion at the twentieth question.
  type, extends(interruption_type) :: impatient_type
    integer, pointer :: calls => null()
  contains
    procedure :: is_wanted
  end type impatient_type

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_nothing_begun')) call check_nothing_begun(test)
    if (test%runs('check_rows')) call check_rows(test)
    if (test%runs('check_gradient')) call check_gradient(test)
    if (test%runs('check_numbers')) call check_numbers(test)
    if (test%runs('check_refused_numbers')) call check_refused_numbers(test)
    if (test%runs('check_text')) call check_text(test)
    if (test%runs('check_failure')) call check_failure(test)
    if (test%runs('check_interruption')) call check_interruption(test)
  end subroutine run

  !> Questions to a run that was never begun have no answers, and do no harm.
  subroutine check_nothing_begun(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(run_type) :: run
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:), text
    real(wp), allocatable :: values(:), gradients(:, :)
    real(wp) :: rows(2, 2), value
    integer :: count

    call run%begin_kinematics(mechanism, err)
    call test%has_error(err, exit_usage, 'no run begins while no mechanism was read')
    call run%take_rows(rows, count, err)
    call test%has_error(err, exit_usage, 'no rows are taken while no run was begun')
    call run%columns(names)
    call test%is_true(run%outputs() == 0 .and. size(names) == 0 .and. count == 0, 'a run that was not begun has no columns')
    call run%quantities(names, values)
    call run%gradients(gradients)
    call test%is_true(size(values) == 0 .and. size(gradients) == 0, 'a run that was not begun has no quantities')
    call mechanism%number('time.end', value, err)
    call test%has_error(err, exit_usage, 'no number is read while no mechanism was read')
    call mechanism%set('time.end', 1.0_wp, err)
    call test%has_error(err, exit_usage, 'no number is set while no mechanism was read')
    call mechanism%text(text)
    call test%is_true(text == '' .and. ieee_is_nan(value), 'a mechanism that was not read has no text')
    call run%close()
  end subroutine check_nothing_begun

  !> Rows in three pieces: x = 0.3 cos q + sqrt(1.1^2 - (0.3 sin q)^2), and the stroke is twice the crank.
  subroutine check_rows(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(run_type) :: run
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:), units(:)
    real(wp), allocatable :: rows(:, :), piece(:, :), values(:)
    real(wp) :: worst
    integer :: count, taken, i, x

    call read_text(slider_crank, mechanism, err)
    call run%begin_kinematics(mechanism, err)
    call test%no_error(err, 'a run of a slider-crank begins')
    if (allocated(err)) return
    call run%columns(names, units)
    x = findloc(names == 'B.x', .true., dim=1)
    call test%is_true(names(1) == 't' .and. units(1) == 's' .and. x > 0, 'time and the point have columns')
    allocate (rows(size(names), run%outputs()), piece(size(names), 15))
    taken = 0
    do
      call run%take_rows(piece, count, err)
      call test%no_error(err, 'rows are taken')
      if (allocated(err) .or. count == 0) exit
      rows(:, taken + 1:taken + count) = piece(:, :count)
      taken = taken + count
    end do
    call test%is_true(taken == 41, 'all outputs have rows')
    worst = 0.0_wp
    do i = 1, taken
      associate (q => pi*rows(1, i))
        worst = max(worst, abs(rows(x, i) - 0.3_wp*cos(q) - sqrt(1.21_wp - (0.3_wp*sin(q))**2)))
      end associate
    end do
    call test%near(worst, 0.0_wp, 1e-14_wp, 'the slider is where the closed form says')
    call run%quantities(names, values, units)
    call test%is_true(size(values) == 1 .and. names(1) == 'stroke' .and. units(1) == 'm', 'the quantity has its name and unit')
    call test%near(values(1), 0.6_wp, 1e-13_wp, 'the stroke is twice the crank')
    call run%close()
    call test%is_true(run%outputs() == 0, 'a run that is closed has no outputs')
  end subroutine check_rows

  !> The stroke changes by 2 m for each metre of the crank. Before the last row the quantity is no number.
  subroutine check_gradient(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(run_type) :: run
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:)
    real(wp), allocatable :: rows(:, :), values(:), gradients(:, :)
    integer :: count

    call read_text(with_parameter, mechanism, err)
    call run%begin_kinematics(mechanism, err)
    call test%no_error(err, 'a run with derivatives begins')
    if (allocated(err)) return
    call run%columns(names)
    allocate (rows(size(names), 40))
    call run%take_rows(rows, count, err)
    call run%quantities(names, values)
    call test%is_true(count == 40 .and. ieee_is_nan(values(1)), 'before its last row a run has no quantities')
    call run%take_rows(rows, count, err)
    call run%quantities(names, values)
    call run%gradients(gradients)
    call test%is_true(count == 1, 'one row is left')
    call test%near(values(1), 0.5_wp, 1e-13_wp, 'the stroke follows the parameter')
    call test%near(gradients(1, 1), 2.0_wp, 1e-12_wp, 'the derivative of the stroke by the crank is 2')
    call run%close()
  end subroutine check_gradient

  !> Numbers are set and read by their names, whole ones and defaults too; the next run has them.
  subroutine check_numbers(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(run_type) :: run
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:)
    real(wp), allocatable :: rows(:, :), values(:)
    integer :: count

    call read_text(slider_crank, mechanism, err)
    call expect('pair(2).point(1)', 0.3_wp, 'a number of the file')
    call expect('time.start', 0.0_wp, 'a default')
    call mechanism%set('pair(2).point(1)', 0.45_wp, err)
    call test%no_error(err, 'a number is set')
    call mechanism%set('time.intervals', 10.0_wp, err)
    call test%no_error(err, 'a whole number is set')
    call expect('pair(2).point(1)', 0.45_wp, 'a number that was set')
    call expect('time.intervals', 10.0_wp, 'a whole number that was set')
    call run%begin_kinematics(mechanism, err)
    call test%no_error(err, 'a run with changed numbers begins')
    if (allocated(err)) return
    call run%columns(names)
    allocate (rows(size(names), run%outputs()))
    call run%take_rows(rows, count, err)
    call run%quantities(names, values)
    call test%is_true(count == 11, 'the run has the number of outputs that was set')
    call test%near(values(1), 0.9_wp, 1e-13_wp, 'the stroke is twice the crank that was set')
    call run%close()
    call read_text(with_parameter, mechanism, err)
    call expect('pair(2).point(1)', 0.25_wp, 'a number that a parameter sets')
    call mechanism%set('parameter(1).value', 0.35_wp, err)
    call expect('pair(2).point(1)', 0.35_wp, 'a number that follows a parameter')
  contains
    subroutine expect(name, right, what)
      character(len=*), intent(in) :: name   !< of the number
      real(wp), intent(in) :: right          !< the number
      character(len=*), intent(in) :: what   !< of which kind it is
      real(wp) :: value

      call mechanism%number(name, value, err)
      call test%no_error(err, what//' is read')
      call test%near(value, right, 0.0_wp, what//' is right')
    end subroutine expect
  end subroutine check_numbers

  !> Names that do not exist, values out of range, and numbers of parameters are refused; the mechanism stays as it was.
  subroutine check_refused_numbers(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(error_type), allocatable :: err
    character(len=:), allocatable :: before, after
    real(wp) :: value

    call read_text(with_parameter, mechanism, err)
    call mechanism%text(before)
    call refuse('pair(2).pint(1)', 1.0_wp, exit_data, 'did you mean ''point''?')
    call refuse('pair(9).point(1)', 1.0_wp, exit_data, 'groups')
    call refuse('pair(2).kind', 1.0_wp, exit_data, 'is a word, not a number')
    call refuse('pair(2).point(1)', 1.0_wp, exit_usage, 'parameter ''crank'' sets pair(2).point(1); set parameter(1).value')
    call refuse('time.intervals', 1.5_wp, exit_data, 'whole number')
    call refuse('time.intervals', -1.0_wp, exit_data, 'must be')
    call refuse('no name', 1.0_wp, exit_data, 'write the name of a number as')
    call refuse('', 1.0_wp, exit_data, 'write the name of a number as')
    call mechanism%number('pair(2).kind', value, err)
    call test%has_error(err, exit_data, 'a word is not read as a number')
    call mechanism%text(after)
    call test%is_true(before == after, 'a refused number changes nothing')
  contains
    subroutine refuse(name, number, code, words)
      character(len=*), intent(in) :: name    !< of the number
      real(wp), intent(in) :: number          !< its value
      integer, intent(in) :: code             !< right code of the failure
      character(len=*), intent(in) :: words   !< of the right message

      call mechanism%set(name, number, err)
      call test%has_error(err, code, 'setting '''//name//''' is refused')
      if (allocated(err)) call test%is_true(index(err%message, words) > 0, 'the message about '''//name//''': '//err%message)
    end subroutine refuse
  end subroutine check_refused_numbers

  !> The text of a mechanism gives the same mechanism: the same text, and the same bits of its rows.
  subroutine check_text(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism, again
    type(error_type), allocatable :: err
    character(len=:), allocatable :: text, second
    real(wp), allocatable :: rows(:, :), same(:, :)

    call read_text(slider_crank, mechanism, err)
    call mechanism%set('pair(2).point(1)', 1.0_wp/3.0_wp, err)
    call test%no_error(err, 'a number is set before the text is written')
    call mechanism%text(text)
    call read_text(text, again, err)
    call test%no_error(err, 'the text of a mechanism is read')
    call again%text(second)
    call test%is_true(text == second, 'the text of the text is the same')
    call all_rows(mechanism, rows)
    call all_rows(again, same)
    call test%is_true(size(rows) > 0, 'the mechanism of the text moves')
    call test%near(maxval(abs(rows - same)), 0.0_wp, 0.0_wp, 'both mechanisms move alike')
  end subroutine check_text

  !> All rows of a driven run; none after a failure.
  subroutine all_rows(mechanism, rows)
    type(mechanism_type), intent(in) :: mechanism            !< the mechanism
    real(wp), allocatable, intent(out) :: rows(:, :)         !< (columns,outputs)
    type(run_type) :: run
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:)
    integer :: count

    call run%begin_kinematics(mechanism, err)
    if (.not. allocated(err)) then
      call run%columns(names)
      allocate (rows(size(names), run%outputs()))
      call run%take_rows(rows, count, err)
    end if
    if (allocated(err)) rows = reshape([real(wp) ::], [0, 0])
    call run%close()
  end subroutine all_rows

  !> A crank that is longer than the rod comes to a dead point: rows before it are there, and the run has ended.
  subroutine check_failure(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(run_type) :: run
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:)
    real(wp), allocatable :: rows(:, :)
    integer :: count

    call read_text(slider_crank, mechanism, err)
    call mechanism%set('pair(3).point(1)', 0.2_wp, err)
    call mechanism%set('initial(1).position', 0.5_wp, err)
    call run%begin_kinematics(mechanism, err)
    call test%no_error(err, 'a run towards a dead point begins')
    if (allocated(err)) return
    call run%columns(names)
    allocate (rows(size(names), run%outputs()))
    call run%take_rows(rows, count, err)
    call test%has_error(err, exit_singular, 'the run ends at the dead point')
    ! sin q = 2/3 at t = 0.232 s, outputs are 0.05 s apart
    call test%is_true(count == 5, 'the rows before the dead point are there')
    call run%take_rows(rows, count, err)
    call test%has_error(err, exit_usage, 'a run that failed has no more rows')
    call run%close()
  end subroutine check_failure

  !> A run that is stopped on its way goes on with the next call, and has the same rows.
  subroutine check_interruption(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(run_type) :: run
    type(impatient_type) :: impatient
    type(error_type), allocatable :: err
    character(len=:), allocatable :: names(:)
    real(wp), allocatable :: rows(:, :), whole(:, :)
    integer, target :: calls
    integer :: count, taken

    call read_text(slider_crank, mechanism, err)
    call all_rows(mechanism, whole)
    calls = 0
    impatient%calls => calls
    call run%begin_kinematics(mechanism, err, impatient)
    call test%no_error(err, 'a run that may be stopped begins')
    if (allocated(err)) return
    call run%columns(names)
    allocate (rows(size(names), run%outputs()))
    call run%take_rows(rows, count, err)
    call test%has_error(err, exit_interrupted, 'the run is stopped')
    call test%is_true(count > 0 .and. count < 41, 'the rows before the stop are there')
    taken = count
    call run%take_rows(rows(:, taken + 1:), count, err)
    call test%no_error(err, 'the run goes on')
    call test%is_true(taken + count == 41, 'the run has all its rows')
    call test%near(maxval(abs(rows - whole)), 0.0_wp, 0.0_wp, 'the rows are those of a run that is not stopped')
    call run%close()
  end subroutine check_interruption

  !> Whether the motion shall stop: at the twentieth question only.
  logical function is_wanted(self)
    class(impatient_type), intent(in) :: self   !< counts the questions

    self%calls = self%calls + 1
    is_wanted = self%calls == 20
  end function is_wanted
end module test_recorded_run
