!> From text to model: poses, units, defaults, structure from each of its sources, all against closed forms.
module test_reader
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_rotation, only: about_axis, identity
  use mech9_pair, only: pair_motion_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_testing, only: tester_type
  use mech9_input_support, only: mechanism_from_text, printed, slider_crank, eol
  implicit none
  private
  public :: run

  !> Numbers that are sums of a few products of numbers near one.
  real(wp), parameter :: round_off = 1.0e-15_wp

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('a_whole_mechanism')) call a_whole_mechanism(tester)
    if (tester%runs('sources_of_structure')) call sources_of_structure(tester)
    if (tester%runs('zero_directions')) call zero_directions(tester)
    if (tester%runs('denavit_hartenberg')) call denavit_hartenberg(tester)
    if (tester%runs('helix')) call helix(tester)
    if (tester%runs('degrees')) call degrees(tester)
    if (tester%runs('bodies_and_settings')) call bodies_and_settings(tester)
    if (tester%runs('tables')) call tables(tester)
    if (tester%runs('single_position')) call single_position(tester)
    if (tester%runs('all_errors_at_once')) call all_errors_at_once(tester)
  end subroutine run

  subroutine read_well(tester, text, model, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of a good data file
    character(len=*), intent(in) :: why          !< the statement that is checked, printed where it is wrong
    type(model_type), intent(out) :: model       !< the mechanism that it describes
    type(diagnostics_type) :: diagnostics

    call mechanism_from_text(text, model, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), why//' is read')
    if (diagnostics%failed()) print '(a)', printed(diagnostics)
  end subroutine read_well

  !> Pose of a pair at q, held against a rotation and a translation.
  subroutine pose_is(tester, model, k, q, r, p, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type), intent(in) :: model        !< the model
    integer, intent(in) :: k                     !< coordinate of the pair
    real(wp), intent(in) :: q                    !< its value [rad or m]
    real(wp), intent(in) :: r(3, 3)              !< the right rotation
    real(wp), intent(in) :: p(3)                 !< the right translation [m]
    character(len=*), intent(in) :: why          !< the statement that is checked, printed where it is wrong
    type(pair_motion_type) :: motion
    type(error_type), allocatable :: err

    call model%mechanism%pairs(k)%pair%evaluate(q, motion, err)
    call tester%no_error(err, why//': the pair has a motion')
    call tester%near(maxval(abs(motion%pose%r - r)), 0.0_wp, 4.0_wp*round_off, why//': the rotation of the pair is right')
    call tester%near(maxval(abs(motion%pose%p - p)), 0.0_wp, 4.0_wp*round_off, why//': the translation of the pair is right')
  end subroutine pose_is

  subroutine a_whole_mechanism(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m
    real(wp), parameter :: x(3) = [1.0_wp, 0.0_wp, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 1.0_wp]

    call read_well(tester, slider_crank, m, 'the slider-crank')
    call tester%is_true(m%mechanism%title == 'Slider-crank', 'the title is read')
    call tester%is_true(m%mechanism%structure%n_links == 4 .and. m%mechanism%structure%n_coordinates == 4, &
                        'the links and coordinates are counted')
    call tester%is_true(all(m%problem%partition%independent() .eqv. [.true., .false., .false., .false.]), &
                        'the independent coordinate is read')
    call tester%is_true(size(m%problem%partition%vectors%nrg) == 5, 'the structural vectors have the length of (9), 4 + 2 - 1')
    call tester%is_true(m%mechanism%pairs(1)%pair%coordinate == 1 .and. m%mechanism%pairs(4)%pair%coordinate == 4, &
                        'pairs stand in the order of their coordinates')
    call tester%is_true(m%mechanism%pairs(3)%pair%reference == 3 .and. m%mechanism%pairs(3)%pair%moving == 4, &
                        'the links of a pair are read')
    call tester%is_true(m%mechanism%pairs(1)%pair%angular .and. .not. m%mechanism%pairs(4)%pair%angular, &
                        'angles are told from lengths')
    call tester%is_true(m%mechanism%pairs(4)%pair%place%line == 6 .and. m%mechanism%points(1)%place%line == 8 &
                        .and. m%problem%drives(1)%drive%place%line == 9, 'pairs, points and drives know their lines in the file')
    call pose_is(tester, m, 1, 0.3_wp, about_axis(z, 0.3_wp), [0.0_wp, 0.0_wp, 0.0_wp], 'a turn about z')
    call pose_is(tester, m, 2, 0.3_wp, about_axis(z, 0.3_wp), 0.3_wp*x, 'a turn about an axis beside the origin')
    call pose_is(tester, m, 4, 1.2_wp, identity, [1.2_wp, 0.1_wp, 0.0_wp], 'a slide along x')
    call tester%near(m%problem%initial%position(4), 1.2_wp, 0.0_wp, 'an initial position is read')
    call tester%is_true(all(m%problem%initial%position_given .eqv. [.false., .false., .false., .true.]), &
                        'initial positions that are given are told from others')
    call tester%is_true(m%mechanism%points(1)%name == 'B' .and. m%mechanism%points(1)%link == 4, 'a point is read')
    call tester%is_true(all(abs(m%mechanism%points(1)%position) <= 0.0_wp), 'a point stands in the origin by default')
    call tester%is_true(m%request%time%intervals == 10 .and. size(m%mechanism%parameters) == 0, 'times and parameters are read')
  end subroutine a_whole_mechanism

  !> c, the second set, and the links of the pairs describe the same structure.
  subroutine sources_of_structure(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m, other
    character(len=:), allocatable :: rest
    integer :: at

    call read_well(tester, slider_crank, m, 'the structure from c')
    at = index(slider_crank, '&pair')
    rest = slider_crank(at:)
    call read_well(tester, "&structure cq=1 /"//eol//rest, other, 'the structure from the pairs alone')
    call same_structure(tester, m, other, 'from the pairs')
    call read_well(tester, "&structure nrg=1,2,3,4,1 nws=0,1,2,3,4 rdw=2*1,3*0 /"//rest, other, 'the second set')
    call same_structure(tester, m, other, 'from the second set')
    call tester%is_true(all(other%problem%partition%vectors%nrw == [0, 0, 0, 0, 1]), 'nrw is computed where it is not given')
    call read_well(tester, "&structure nrg=1,4,3,2,1 nws=0,4,3,2,1 rdw=1,0,0,0,1 nrw=4*0,1, cq=1" &
                   //" c(1,4)=4 c(4,1)=4 c(1,2)=1 c(2,1)=1 c(2,3)=2 c(3,2)=2 c(4,3)=3 c(3,4)=3 /"//rest, other, 'both sets')
    call same_structure(tester, m, other, 'from both sets')
    call tester%is_true(all(other%problem%partition%vectors%nrg == [1, 4, 3, 2, 1]), 'the order of computation is the one given')
    call read_well(tester, "&structure c=0,1,0,4, 1,0,2,0, 0,2,0,3, 4,0,3,0 cq=1 /"//rest, other, 'c in one piece')
    call same_structure(tester, m, other, 'from c in one piece')
  end subroutine sources_of_structure

  subroutine same_structure(tester, a, b, why)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type), intent(in) :: a            !< first mechanism
    type(model_type), intent(in) :: b            !< second mechanism
    character(len=*), intent(in) :: why          !< the statement that is checked, printed where it is wrong
    integer :: k

    call tester%is_true(a%mechanism%structure%n_links == b%mechanism%structure%n_links, why//': both have as many links')
    call tester%is_true(all(a%problem%partition%kind == b%problem%partition%kind), &
                        why//': both have the same independent coordinates')
    do k = 1, size(a%mechanism%structure%links, 2)
      call tester%is_true(minval(a%mechanism%structure%links(:, k)) == minval(b%mechanism%structure%links(:, k)) .and. &
                          maxval(a%mechanism%structure%links(:, k)) == maxval(b%mechanism%structure%links(:, k)), &
                                              why//': the pairs join the same links')
    end do
  end subroutine same_structure

  !> An open chain of one pair.
  function one_pair(rest) result(text)
    character(len=*), intent(in) :: rest   !< of the group &pair, and further groups
    character(len=:), allocatable :: text

    text = "&structure cq=1 / &drive coordinate=1, kind='polynomial', coefficients=0 / &pair coordinate=1, links=1,2, "// &
           rest//' /'
  end function one_pair

  subroutine zero_directions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m
    real(wp) :: r(3, 3)
    real(wp), parameter :: half = sqrt(0.5_wp), none(3) = 0.0_wp

    ! F has z along z and x along x; G has z along x and, by its own rule, x along y
    call read_well(tester, one_pair("kind='revolute', axis=0,0,1, moving_axis=2,0,0"), m, 'a moving axis')
    r = reshape([0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [3, 3])
    call pose_is(tester, m, 1, 0.0_wp, r, none, 'a new axis comes with its own zero')
    ! an axis at 45 degrees to x leaves x as zero, made perpendicular: (1,-1,0)
    call read_well(tester, one_pair("kind='revolute', axis=1,1,0, moving_zero=1,-1,0"), m, 'an axis at 45 degrees')
    call pose_is(tester, m, 1, 0.0_wp, identity, none, 'x serves as zero at 45 degrees')
    ! nearer to x than 45 degrees: y serves, so that (-1,1,0)-like directions are x of the frame
    call read_well(tester, one_pair("kind='revolute', axis=1,0.9,0, moving_zero=-0.9,1,0"), m, 'an axis near x')
    call pose_is(tester, m, 1, 0.0_wp, identity, none, 'y serves as zero below 45 degrees')
    ! a zero given once turns with nothing: both links in the home position coincide
    call read_well(tester, one_pair("kind='revolute', axis=0,0,1, zero=0,3,0"), m, 'a zero')
    call pose_is(tester, m, 1, 0.0_wp, identity, none, 'given once, the home position')
    call read_well(tester, one_pair("kind='revolute', axis=0,0,1, zero=1,1,0, moving_zero=1,0,0"), m, 'two zeros')
    r = reshape([half, half, 0.0_wp, -half, half, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
    call pose_is(tester, m, 1, 0.0_wp, r, none, 'the zero of the moving link stands at that of the reference link')
  end subroutine zero_directions

  !> T = Rz(theta) Tz(d) Tx(a) Rx(alpha) by elementary rotations.
  subroutine denavit_hartenberg(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m
    real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], x(3) = [1.0_wp, 0.0_wp, 0.0_wp]
    real(wp) :: r(3, 3), p(3), q

    q = 0.7_wp
    call read_well(tester, one_pair("kind='revolute', dh=0.4, 0.5, 0.6, 0.3"), m, 'a revolute pair with dh')
    r = about_axis(z, 0.3_wp + q)
    p = 0.6_wp*z + matmul(r, 0.4_wp*x)
    call pose_is(tester, m, 1, q, matmul(r, about_axis(x, 0.5_wp)), p, 'dh, q added to theta')
    call read_well(tester, one_pair("kind='prismatic', dh=0.4, 0.5, 0.6, 0.3"), m, 'a prismatic pair with dh')
    r = about_axis(z, 0.3_wp)
    p = (0.6_wp + q)*z + matmul(r, 0.4_wp*x)
    call pose_is(tester, m, 1, q, matmul(r, about_axis(x, 0.5_wp)), p, 'dh, q added to d')
    call read_well(tester, "&mechanism angle_unit='deg' /"//one_pair("kind='helical', pitch=0.1, dh=0.4, 30, 0.6, 60"), m, &
                   'a helical pair with dh in degrees')
    r = about_axis(z, pi/3.0_wp + q)
    p = (0.6_wp + 0.1_wp*q/(2.0_wp*pi))*z + matmul(r, 0.4_wp*x)
    call pose_is(tester, m, 1, q, matmul(r, about_axis(x, pi/6.0_wp)), p, 'dh in degrees, helical')
  end subroutine denavit_hartenberg

  subroutine helix(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m

    call read_well(tester, one_pair("kind='helical', axis=0,0,5, pitch=0.25"), m, 'a helical pair')
    call pose_is(tester, m, 1, 2.0_wp*pi, identity, [0.0_wp, 0.0_wp, 0.25_wp], 'one turn advances by the pitch')
  end subroutine helix

  !> In degrees only angles change: those of revolute coordinates, not of prismatic ones.
  subroutine degrees(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m
    character(len=*), parameter :: head = "&mechanism angle_unit='DEG' / &structure cq=1,2 /"// &
                                   "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"// &
                                   "&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /"
    real(wp) :: q, dq, ddq
    type(error_type), allocatable :: err

    call read_well(tester, head//"&drive coordinate=1, kind='polynomial', coefficients=60, -30, 45 /"// &
                   "&drive coordinate=2, kind='harmonic', mean=2, amplitude=3, angular_frequency=90, phase=30 /"// &
                   "&initial coordinate=1, position=60, velocity=-30 / &initial coordinate=2, position=3.5 /", &
                   m, 'a mechanism in degrees')
    call tester%near(m%mechanism%units%angle, pi/180.0_wp, round_off, 'the unit of angles is read')
    call tester%near(m%problem%initial%position(1), pi/3.0_wp, round_off, 'an initial angle in degrees is read')
    call tester%near(m%problem%initial%velocity(1), -pi/6.0_wp, round_off, 'an initial angular velocity in degrees is read')
    call tester%near(m%problem%initial%position(2), 3.5_wp, 0.0_wp, 'an initial length is not taken for an angle')
    call m%problem%drives(1)%drive%evaluate(2.0_wp, q, dq, ddq, err)
    call tester%near(q, pi, 4.0_wp*round_off, 'a polynomial of an angle in degrees has its value')
    call tester%near(ddq, pi/2.0_wp, round_off, 'a polynomial of an angle in degrees has its second derivative')
    call m%problem%drives(2)%drive%evaluate(2.0_wp, q, dq, ddq, err)
    ! 2 + 3 sin(180 + 30 degrees) = 2 - 3/2
    call tester%near(q, 0.5_wp, 4.0_wp*round_off, 'a harmonic length with its phase in degrees has its value')
    call tester%near(dq, -3.0_wp*(pi/2.0_wp)*sqrt(0.75_wp), 8.0_wp*round_off, &
                     'a harmonic length with its phase in degrees has its rate')
  end subroutine degrees

  subroutine bodies_and_settings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m

    call read_well(tester, slider_crank//"&body link=3, mass=2, centre=1,2,3, inertia=4,5,6,0.1,0.2,0.3 /"// &
                   "&gravity acceleration=0,-9.81,0 / &solver method='Adams', relative_tolerance=1e-9, maximum_steps=77 /"// &
                   "&output table='a b.dat' hdf5='x.h5'/ &user parameters=3*0.5, 7 /"// &
                   "&load kind='coordinate', coordinate=2, stiffness=-2 / &load kind='user' /", m, 'everything else')
    call tester%is_true(m%mechanism%bodies(1)%link == 3 .and. m%mechanism%bodies(1)%place%line == 11, 'the link of a body is read')
    call tester%near(maxval(abs(m%mechanism%bodies(1)%inertia - transpose(m%mechanism%bodies(1)%inertia))), 0.0_wp, 0.0_wp, &
                        'a tensor of inertia is symmetric')
    call tester%is_true(all(abs([m%mechanism%bodies(1)%inertia(1, 2), m%mechanism%bodies(1)%inertia(3, 1), &
                        m%mechanism%bodies(1)%inertia(2, 3)] &
                                - [0.1_wp, 0.2_wp, 0.3_wp]) <= 0.0_wp), 'the products of inertia stand in the order xy, xz, yz')
    call tester%is_true(abs(m%mechanism%bodies(1)%inertia(3, 3) - 6.0_wp) <= 0.0_wp, 'the moment of inertia zz is read')
    call tester%near(m%mechanism%gravity(2), -9.81_wp, 0.0_wp, 'gravity is read')
    call tester%is_true(m%request%solver%method == 'adams' .and. m%request%solver%maximum_steps == 77, &
                        'the method and the number of steps are read')
    call tester%near(m%request%solver%relative_tolerance, 1.0e-9_wp, 0.0_wp, 'a tolerance is read')
    call tester%near(m%request%solver%absolute_tolerance, 1.0e-10_wp, 0.0_wp, 'a tolerance that is not given has its default')
    call tester%is_true(m%request%output%table == 'a b.dat' .and. m%request%output%hdf5 == 'x.h5', 'names of files are read')
    call tester%is_true(size(m%mechanism%parameters) == 4 .and. abs(m%mechanism%parameters(4) - 7.0_wp) <= 0.0_wp, &
                        'parameters are read')
  end subroutine bodies_and_settings

  !> A smooth curve through points of a cubic is that cubic.
  subroutine tables(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m
    type(diagnostics_type) :: g
    character(len=*), parameter :: drive = "&structure cq=1 / &pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /"// &
                                   "&drive coordinate=1, kind='table', file='test_reader_table.dat' /"
    real(wp) :: t, q, dq, ddq
    type(error_type), allocatable :: err
    integer :: unit, i

    open (newunit=unit, file='test_reader_table.dat', status='replace', action='write')
    write (unit, '(a)') '# t, q', ''
    do i = 0, 6
      t = 0.25_wp*i
      write (unit, '(es24.16,a,es24.16,a)') t, merge(' , ', '   ', i > 3), 1.0_wp - 2.0_wp*t + 3.0_wp*t**3, '  # comment'
    end do
    close (unit)
    call read_well(tester, drive, m, 'a table')
    t = 0.9_wp
    call m%problem%drives(1)%drive%evaluate(t, q, dq, ddq, err)
    call tester%no_error(err, 'a table has a value within its range')
    ! second derivatives come from second differences over 0.25: 16 times round-off of the values, and more
    call tester%near(q, 1.0_wp - 2.0_wp*t + 3.0_wp*t**3, 1.0e-14_wp, 'the table of a cubic has the value of the cubic')
    call tester%near(dq, -2.0_wp + 9.0_wp*t**2, 1.0e-13_wp, 'the table of a cubic has its first derivative')
    call tester%near(ddq, 18.0_wp*t, 1.0e-12_wp, 'the table of a cubic has its second derivative')
    call read_well(tester, "&mechanism angle_unit='deg' /"//drive, m, 'a table in degrees')
    call m%problem%drives(1)%drive%evaluate(t, q, dq, ddq, err)
    call tester%near(q, (1.0_wp - 2.0_wp*t + 3.0_wp*t**3)*pi/180.0_wp, 1.0e-14_wp, &
                     'the table of a cubic in degrees has the value of the cubic')
    open (newunit=unit, file='test_reader_table.dat', status='old')
    close (unit, status='delete')
    call mechanism_from_text(drive, m, g)
    call tester%is_true(g%code() == 8, 'a table that is not there has the exit code of files')
  end subroutine tables

  subroutine single_position(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m
    integer :: at

    at = index(slider_crank, '&time')
    call read_well(tester, slider_crank(:at - 1)//'&time start=0.2, intervals=0 /', m, 'a single position')
    call tester%near(m%request%time%time(0), 0.2_wp, 0.0_wp, 'the first time is that of the start')
    call read_well(tester, slider_crank(:at - 1)//'&time start=1, end=0, intervals=4 /', m, 'time running backwards')
    call tester%near(m%request%time%time(1), 0.75_wp, 0.0_wp, 'the second time is the start and one interval')
    call read_well(tester, slider_crank(:at - 1), m, 'no &time')
    call tester%near(m%request%time%time(1), 0.01_wp, round_off, 'times have their default')
  end subroutine single_position

  !> The errors that the scanner, the grammar, the structure and the model find are told in one go, in the order of the lines.
  subroutine all_errors_at_once(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(model_type) :: m
    type(diagnostics_type) :: g
    character(len=:), allocatable :: text, answer
    integer :: places(5), i

    text = "&structure cq=1, 7 /"//eol//slider_crank(index(slider_crank, '&pair'):)// &
           "&point name='A B', link=2 /"//eol//"&point naem='C', link=2 /"//eol//"&gravity acceleration=0,-9..81,0 /"//eol// &
           "&body link=2, mass=-1 /"
    call mechanism_from_text(text, m, g)
    answer = printed(g)
    places = [index(answer, 'test.nml:1:'), index(answer, 'test.nml:10:'), index(answer, 'test.nml:11:'), &
              index(answer, 'test.nml:12:'), index(answer, 'test.nml:13:')]
    call tester%is_true(all(places > 0), 'all five mistakes are told')
    call tester%is_true(all([(places(i) < places(i + 1), i=1, 4)]), 'mistakes are told in the order of the lines')
    call tester%is_true(g%code() == 3, 'wrong data come before a wrong structure')
  end subroutine all_errors_at_once
end module test_reader
