!> Mobility, assemblies and ranges of the library: a four-bar in the plane has one freedom, three redundant equations, two
!> assemblies, and, where its crank is not the shortest link, the range that the triangle of the other links allows.
module test_structure_answers
  use mech9, only: wp, mechanism_type, error_type, read_text, judge_mobility, list_assemblies, list_ranges, exit_usage, &
    exit_assembly
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character(len=*), parameter :: begin = '&structure cq=1 / &mechanism angle_unit=''rad'' / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=0.8,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''revolute'', axis=0,0,1, point=0.9,0,0, moving_point=0.7,0,0 / '// &
    '&initial coordinate=1, position=0.6 / &initial coordinate=2, position=0.5 / &initial coordinate=3, position=-2.0 / '
  character(len=*), parameter :: crank = begin// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /'
  character(len=*), parameter :: rocker = begin// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.85,0,0, moving_point=0,0,0 /'

  !> A parallelogram whose coupler has a third crank in its middle.
  character(len=*), parameter :: three_cranks = '&structure cq=1 / '// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 / '// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=0.8,0,0, moving_point=0.3,0,0 / '// &
    '&pair coordinate=4, links=1,4, kind=''revolute'', axis=0,0,1, point=0.8,0,0, moving_point=0,0,0 / '// &
    '&pair coordinate=5, links=3,5, kind=''revolute'', axis=0,0,1, point=0.4,0,0, moving_point=0.3,0,0 / '// &
    '&pair coordinate=6, links=1,5, kind=''revolute'', axis=0,0,1, point=0.4,0,0, moving_point=0,0,0 / '// &
    '&initial coordinate=1, position=0.6 / &initial coordinate=2, position=-0.6 / &initial coordinate=3, position=0.6 / '// &
    '&initial coordinate=4, position=0.6 / &initial coordinate=5, position=0.6 / &initial coordinate=6, position=0.6 /'

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('check_mobility')) call check_mobility(test)
    if (test%runs('check_assemblies')) call check_assemblies(test)
    if (test%runs('check_ranges')) call check_ranges(test)
    if (test%runs('check_refusals')) call check_refusals(test)
  end subroutine run

  !> Four hinges give four coordinates, and the plane three independent equations of six. A third crank that is parallel to the
  !> others adds two coordinates, and three equations, one of which the others imply.
  subroutine check_mobility(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(error_type), allocatable :: err
    integer :: mobility, redundant

    call read_text(crank, mechanism, err)
    call judge_mobility(mechanism, mobility, redundant, err)
    call test%no_error(err, 'the mobility is found')
    call test%is_true(mobility == 1 .and. redundant == 0, 'a four-bar has one freedom, and its plane no redundant equation')
    call read_text(three_cranks, mechanism, err)
    call judge_mobility(mechanism, mobility, redundant, err)
    call test%no_error(err, 'the mobility of three cranks is found')
    call test%is_true(mobility == 1 .and. redundant == 1, 'three parallel cranks have one freedom, and one redundant equation')
  end subroutine check_mobility

  !> Both assemblies have the same crank, and are mirrored at the line from the end of the crank to the fixed hinge.
  subroutine check_assemblies(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(error_type), allocatable :: err
    real(wp), allocatable :: q(:, :)

    call read_text(crank, mechanism, err)
    call list_assemblies(mechanism, 40, q, err)
    call test%no_error(err, 'assemblies are found')
    call test%is_true(size(q, 2) == 2, 'a four-bar has two')
    if (size(q, 2) /= 2) return
    call test%near(q(1, 1) - q(1, 2), 0.0_wp, 1e-14_wp, 'with the same crank')
    ! the angle at the coupler's end has the same cosine and the other sign
    call test%near(cos(q(3, 1)) - cos(q(3, 2)), 0.0_wp, 1e-12_wp, 'and mirrored angles')
    call test%near(sin(q(3, 1)) + sin(q(3, 2)), 0.0_wp, 1e-12_wp, 'on the two sides of the line')
  end subroutine check_assemblies

  !> A crank of 0.3 m turns. One of 0.85 m beside a base of 0.9 m ends where coupler and rocker, 0.8 and 0.7 m, are stretched.
  subroutine check_ranges(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(error_type), allocatable :: err
    integer, allocatable :: coordinates(:)
    real(wp), allocatable :: lower(:), upper(:)
    real(wp) :: limit

    call read_text(crank, mechanism, err)
    call list_ranges(mechanism, coordinates, lower, upper, err)
    call test%no_error(err, 'the range of the crank is found')
    if (allocated(err)) return
    call test%is_true(all(coordinates == [1]) .and. upper(1) > huge(1.0_wp) .and. lower(1) < -huge(1.0_wp), 'a crank turns')
    call read_text(rocker, mechanism, err)
    call list_ranges(mechanism, coordinates, lower, upper, err)
    call test%no_error(err, 'the range of the rocker is found')
    if (allocated(err)) return
    limit = acos((0.85_wp**2 + 0.9_wp**2 - 1.5_wp**2)/(2.0_wp*0.85_wp*0.9_wp))
    call test%near(upper(1), limit, 1e-9_wp, 'the upper end is where the other links are stretched')
    ! dead points are located to 1e-9
    call test%is_true(lower(1) < 0.6_wp .and. lower(1) >= -limit - 1e-9_wp, 'the lower end is not beyond its mirror')
  end subroutine check_ranges

  !> No answers without a mechanism, and none where it cannot be closed.
  subroutine check_refusals(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(mechanism_type) :: mechanism
    type(error_type), allocatable :: err
    integer :: mobility, redundant
    real(wp), allocatable :: q(:, :)

    call judge_mobility(mechanism, mobility, redundant, err)
    call test%has_error(err, exit_usage, 'no mobility while no mechanism was read')
    call read_text(crank, mechanism, err)
    call mechanism%set('pair(4).point(1)', 3.0_wp, err)
    call list_assemblies(mechanism, 5, q, err)
    call test%has_error(err, exit_assembly, 'links that do not reach each other have no assemblies')
    call test%is_true(size(q) == 0, 'a failure leaves no assemblies')
  end subroutine check_refusals
end module test_structure_answers
