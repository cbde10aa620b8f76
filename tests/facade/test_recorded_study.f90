!> Studies of the library: the stroke of a centric slider-crank is twice its crank, and a crank that is longer than its rod does not
!> turn. Any number of threads gives the same bits; a study that is stopped keeps the runs before.
module test_recorded_study
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9, only: wp, mechanism_type, study_type, interruption_type, error_type, read_text, exit_usage, exit_data, exit_interrupted
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: slider_crank = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''prismatic'', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 / '// &
    '&initial coordinate=4, position=0.8 / '// &
    '&drive coordinate=1, kind=''polynomial'', coefficients=0, 3.141592653589793 / '// &
    '&point name=''B'', link=4 / &time end=2, intervals=40 / &quantity name=''stroke'', of=''B.x'', take=''range'' / '// &
    '&parameter name=''crank'', sets=''pair(2).point(1)'', low=0.1, high=0.6, count=6 / '
  character(len=*), parameter :: grid = slider_crank//'&study kind=''grid'' /'

  !> Stops a study after some questions.
  type, extends(interruption_type) :: impatient_type
    integer, pointer :: questions => null()   !< so many are answered no
  contains
    procedure :: is_wanted
  end type impatient_type

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_grid')) call check_grid(test)
    if (test%runs('check_threads')) call check_threads(test)
    if (test%runs('check_refusals')) call check_refusals(test)
    if (test%runs('check_stop')) call check_stop(test)
  end subroutine run

  !> Cranks of 0.1 m to 0.6 m beside a rod of 0.5 m. A crank as long as the rod passes special positions, with x = cos q; a longer
  !> one comes to a dead point.
  subroutine check_grid(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(study_type) :: study
    type(error_type), allocatable :: err
    integer :: i

    call read_text(grid, mechanism, err)
    call study%make_kinematics(mechanism, 1, err)
    call test%no_error(err, 'the study is made')
    call test%is_true(size(study%exit_codes) == 6, 'it has six runs')
    if (size(study%exit_codes) /= 6) return
    call test%is_true(study%parameter_names(1) == 'crank' .and. study%quantity_names(1) == 'stroke', 'names are those of the file')
    do i = 1, 4
      call test%near(study%parameters(1, i), 0.1_wp*i, 1e-15_wp, 'a value of the grid')
      call test%is_true(study%exit_codes(i) == 0, 'a crank that is shorter than the rod turns')
      call test%near(study%quantities(1, i), 0.2_wp*i, 1e-13_wp, 'its stroke is twice the crank')
    end do
    call test%is_true(study%exit_codes(5) == 0, 'a crank that is as long as the rod turns')
    call test%near(study%quantities(1, 5), 2.0_wp, 1e-9_wp, 'its stroke is four times the crank')
    call test%is_true(study%exit_codes(6) == 6 .and. ieee_is_nan(study%quantities(1, 6)), 'a longer crank comes to a dead point')
  end subroutine check_grid

  !> Three threads give the bits of one.
  subroutine check_threads(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(study_type) :: one, three
    type(error_type), allocatable :: err

    call read_text(slider_crank//'&study kind=''sobol'', runs=50 /', mechanism, err)
    call mechanism%set('parameter(1).high', 0.4_wp, err)
    call test%no_error(err, 'a range of a parameter is set')
    call one%make_kinematics(mechanism, 1, err)
    call test%no_error(err, 'one thread makes the study')
    call three%make_kinematics(mechanism, 3, err)
    call test%no_error(err, 'three threads make the study')
    call test%is_true(size(one%exit_codes) == 50 .and. all(one%exit_codes == 0), 'all runs go to their ends')
    call test%near(maxval(abs(one%quantities - three%quantities)), 0.0_wp, 0.0_wp, 'threads change nothing')
    call test%near(maxval(abs(one%quantities - 2.0_wp*one%parameters)), 0.0_wp, 1e-13_wp, 'strokes are twice the cranks')
  end subroutine check_threads

  !> A mechanism without a study, and one that asks for derivatives, are refused.
  subroutine check_refusals(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(study_type) :: study
    type(error_type), allocatable :: err

    call study%make_kinematics(mechanism, 1, err)
    call test%has_error(err, exit_usage, 'no study is made while no mechanism was read')
    call read_text(slider_crank, mechanism, err)
    call study%make_kinematics(mechanism, 1, err)
    call test%has_error(err, exit_usage, 'no study is made where none is described')
    call test%is_true(size(study%exit_codes) == 0, 'a study that is refused has no runs')
    call read_text(grid//' &output gradients=.true. /', mechanism, err)
    call study%make_kinematics(mechanism, 1, err)
    call test%has_error(err, exit_data, 'a study with gradients is refused')
  end subroutine check_refusals

  !> A study that is stopped keeps the runs that were made.
  subroutine check_stop(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(study_type) :: study
    type(impatient_type) :: impatient
    type(error_type), allocatable :: err
    integer, target :: questions

    call read_text(slider_crank//'&study kind=''sobol'', runs=50 /', mechanism, err)
    call mechanism%set('parameter(1).high', 0.4_wp, err)
    ! one for each run, whether runs are made one by one or side by side
    questions = 20
    impatient%questions => questions
    call study%make_kinematics(mechanism, 1, err, impatient)
    call test%has_error(err, exit_interrupted, 'the study is stopped')
    call test%is_true(size(study%exit_codes) > 0 .and. size(study%exit_codes) < 50, 'the runs before the stop are there')
    if (size(study%exit_codes) == 0) return
    call test%near(study%quantities(1, 1), 2.0_wp*study%parameters(1, 1), 1e-13_wp, 'they have their quantities')
  end subroutine check_stop

  !> Whether the study shall stop.
  logical function is_wanted(self)
    class(impatient_type), intent(in) :: self   !< counts the questions

    self%questions = self%questions - 1
    is_wanted = self%questions < 0
  end function is_wanted
end module test_recorded_study
