!> Many positions of one mechanism: against closed forms of the four-bar linkage, the slider-crank and the five-bar linkage; side by side
!> against one after the other.
!>
!> Compares the program with itself in part: positions side by side and alone, with vectors of other lengths.
module test_positions
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use mech9, only: wp, mechanism_type, positions_type, error_type, read_text
  use mech9_random, only: random_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  character, parameter :: nl = new_line('a')
  !> Fewer positions in one call than can be found side by side.
  integer, parameter :: few = 63
  real(wp), parameter :: ground = 0.40_wp, crank = 0.15_wp, coupler = 0.35_wp, rocker = 0.30_wp
  !> Two chains: a slider-crank is moved by the coupler of a four-bar linkage.
  character(len=*), parameter :: two_loops = &
    '&mechanism links=6, coordinates=7 /'//nl//'&structure cq=1 /'//nl// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=3, links=1,4, kind=''revolute'', axis=0,0,1, point=0.40,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=4, links=4,3, kind=''revolute'', axis=0,0,1, point=0.30,0,0, moving_point=0.35,0,0 /'//nl// &
    '&pair coordinate=5, links=3,5, kind=''revolute'', axis=0,0,1, point=0.2,0.1,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=6, links=5,6, kind=''revolute'', axis=0,0,1, point=0.5,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=7, links=1,6, kind=''prismatic'', axis=1,0,0 /'//nl// &
    '&initial coordinate=2, position=1.0 /'//nl//'&initial coordinate=3, position=1.8 /'//nl// &
    '&initial coordinate=4, position=-0.8 /'//nl//'&initial coordinate=7, position=0.8 /'//nl
  !> A crank drives a slide on an arm that turns.
  character(len=*), parameter :: slotted = &
    '&mechanism links=4, coordinates=4 /'//nl//'&structure cq=1 /'//nl// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.15,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=3, links=1,4, kind=''revolute'', axis=0,0,1, point=-0.4,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=4, links=4,3, kind=''prismatic'', axis=1,0,0 /'//nl//'&initial coordinate=4, position=0.5 /'//nl
  !> A slider-crank whose slide is moved, in millimetres and degrees.
  character(len=*), parameter :: pushed = &
    '&mechanism links=4, coordinates=4, length_unit=''mm'', angle_unit=''deg'' /'//nl//'&structure cq=4 /'//nl// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=300,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=3, links=3,4, kind=''revolute'', axis=0,0,1, point=1100,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=4, links=1,4, kind=''prismatic'', axis=1,0,0 /'//nl// &
    '&initial coordinate=1, position=70 /'//nl//'&initial coordinate=2, position=-86 /'//nl// &
    '&initial coordinate=3, position=16 /'//nl//'&initial coordinate=4, position=1160 /'//nl
  !> Five bars of two coordinates.
  character(len=*), parameter :: five_bars = &
    '&mechanism links=5, coordinates=5 /'//nl//'&structure cq=1,3 /'//nl// &
    '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /'//nl// &
    '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=0.2,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=3, links=1,5, kind=''revolute'', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=4, links=5,4, kind=''revolute'', axis=0,0,1, point=0.2,0,0, moving_point=0,0,0 /'//nl// &
    '&pair coordinate=5, links=4,3, kind=''revolute'', axis=0,0,1, point=0.4,0,0, moving_point=0.4,0,0 /'//nl// &
    '&initial coordinate=1, position=2.0 /'//nl//'&initial coordinate=2, position=-1.2 /'//nl// &
    '&initial coordinate=3, position=1.1 /'//nl//'&initial coordinate=4, position=1.2 /'//nl// &
    '&initial coordinate=5, position=-1.5 /'//nl

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('closed_form')) call closed_form(tester)
    if (tester%runs('slides')) call slides(tester)
    if (tester%runs('two_coordinates')) call two_coordinates(tester)
    if (tester%runs('random_four_bars')) call random_four_bars(tester)
    if (tester%runs('special_positions')) call special_positions(tester)
    if (tester%runs('rates_in_crossings')) call rates_in_crossings(tester)
    if (tester%runs('crossings_of_two')) call crossings_of_two(tester)
    if (tester%runs('other_structures')) call other_structures(tester)
    if (tester%runs('spacings')) call spacings(tester)
    if (tester%runs('next_to_the_start')) call next_to_the_start(tester)
    if (tester%runs('all_vectors')) call all_vectors(tester)
  end subroutine run

  !> A four-bar linkage by its lengths; `side` is 1 where it is open, -1 where it is crossed.
  function four_bar(lengths, side) result(text)
    real(wp), intent(in) :: lengths(4)   !< ground, crank, coupler, rocker [m]
    integer, intent(in) :: side          !< of the assembly
    character(len=1200) :: text
    real(wp) :: q(4)

    q = exact_four_bar(lengths, side, 0.6_wp)
    write (text, '(3a,2(a,es23.16,a),2(a,es23.16),a,4(a,i0,a,es23.16,a))') &
      '&mechanism links=4, coordinates=4 /', nl, '&structure cq=1 /'// &
      '&pair coordinate=1, links=1,2, kind=''revolute'', axis=0,0,1 /', &
      '&pair coordinate=2, links=2,3, kind=''revolute'', axis=0,0,1, point=', lengths(2), ',0,0, moving_point=0,0,0 /', &
      '&pair coordinate=3, links=1,4, kind=''revolute'', axis=0,0,1, point=', lengths(1), ',0,0, moving_point=0,0,0 /', &
      '&pair coordinate=4, links=4,3, kind=''revolute'', axis=0,0,1, point=', lengths(4), ',0,0, moving_point=', lengths(3), &
      ',0,0 /', '&initial coordinate=', 1, ', position=', q(1), ' /', '&initial coordinate=', 2, ', position=', q(2), ' /', &
      '&initial coordinate=', 3, ', position=', q(3), ' /', '&initial coordinate=', 4, ', position=', q(4), ' /'
  end function four_bar

  !> Coordinates of a four-bar linkage, but for whole turns, by two circles that meet.
  pure function exact_four_bar(lengths, side, turn) result(q)
    real(wp), intent(in) :: lengths(4)   !< ground, crank, coupler, rocker [m]
    integer, intent(in) :: side          !< 1: open; -1: crossed
    real(wp), intent(in) :: turn         !< angle of the crank [rad]
    real(wp) :: q(4), x, y, far, along, across

    ! from the end of the crank to the rocker's pivot
    x = lengths(1) - lengths(2)*cos(turn)
    y = -lengths(2)*sin(turn)
    far = hypot(x, y)
    along = (lengths(3)**2 - lengths(4)**2 + far**2)/(2.0_wp*far)
    across = side*sqrt(lengths(3)**2 - along**2)
    q(1) = turn
    q(2) = atan2(y, x) + atan2(across, along)
    q(3) = atan2(y, x) + atan2(across, along - far)
    ! link 3 in link 4
    q(4) = q(2) - q(3)
    q(2) = q(2) - turn
  end function exact_four_bar

  !> The four-bar linkage in thousands of positions, in no order, over many turns, in both assemblies: coordinates, rates, accelerations.
  !> Positions are closed to round-off; at the least pivot, which is above 0.2, rates lose a digit, accelerations two.
  subroutine closed_form(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: lengths(4) = [ground, crank, coupler, rocker]
    integer, parameter :: n = 3000
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    real(wp), dimension(1, n) :: given, rates, accelerations
    real(wp), allocatable, dimension(:, :) :: q, dq, ddq
    integer :: codes(n)
    real(wp) :: exact(4), a(4), w(4), e(4)
    integer :: i, side

    allocate (q(4, n), dq(4, n), ddq(4, n))
    do i = 1, n
      given(1, i) = 40.0_wp*modulo(i*0.6180339887498949_wp, 1.0_wp) - 20.0_wp
      rates(1, i) = 1.0_wp + modulo(0.37_wp*i, 2.0_wp)
      accelerations(1, i) = modulo(0.73_wp*i, 3.0_wp) - 1.0_wp
    end do
    do side = 1, -1, -2
      call read_text(four_bar(lengths, side), mechanism, err)
      call tester%no_error(err, 'a four-bar linkage is read')
      call positions%begin(mechanism, err)
      call tester%no_error(err, 'it is put together')
      if (allocated(err)) return
      call positions%find(given, q, codes, err, rates=rates, dq=dq, accelerations=accelerations, ddq=ddq)
      call tester%no_error(err, 'positions are found')
      call tester%is_true(positions%found_beside == n, 'all of them are found side by side')
      call tester%is_true(all(codes == 0), 'all positions are reached')
      do i = 1, n
        exact = exact_four_bar(lengths, side, given(1, i))
        e = q(:, i) - exact
        call tester%is_true(maxval(abs(sin(0.5_wp*e))) < 2.0e-14_wp, 'coordinates')
        ! angles of the links that move
        a = [exact(1), exact(1) + exact(2), exact(3), 0.0_wp]
        w(1) = rates(1, i)
        w(2) = crank*w(1)*sin(a(1) - a(3))/(coupler*sin(a(3) - a(2)))
        w(3) = crank*w(1)*sin(a(1) - a(2))/(rocker*sin(a(3) - a(2)))
        call tester%near(dq(2, i), w(2) - w(1), 1.0e-12_wp, 'a rate of the coupler')
        call tester%near(dq(3, i), w(3), 1.0e-12_wp, 'a rate of the rocker')
        w(4) = (crank*(accelerations(1, i)*sin(a(1) - a(2)) + w(1)**2*cos(a(1) - a(2))) + coupler*w(2)**2 &
                - rocker*w(3)**2*cos(a(3) - a(2)))/(rocker*sin(a(3) - a(2)))
        call tester%near(ddq(3, i), w(4), 1.0e-11_wp, 'an acceleration of the rocker')
      end do
      call positions%close()
    end do
  end subroutine closed_form

  !> A slide that is moved, in millimetres and degrees, up to the dead points at both ends of its way.
  subroutine slides(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 1001
    real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    real(wp) :: given(1, n), q(4, n), angle
    integer :: codes(n), i

    call read_text(pushed, mechanism, err)
    call tester%no_error(err, 'a slider-crank is read')
    call positions%begin(mechanism, err)
    call tester%no_error(err, 'it is put together')
    if (allocated(err)) return
    given(1, :) = [(750.0_wp + 700.0_wp*i/n, i=1, n)]
    call positions%find(given, q, codes, err)
    call tester%no_error(err, 'positions are found')
    call tester%is_true(positions%found_beside > 400, 'many are found side by side')
    do i = 1, n
      associate (s => given(1, i))
        call tester%is_true((codes(i) == 0) .eqv. (s > 800.0_wp .and. s < 1400.0_wp), 'positions between the dead points')
        if (codes(i) /= 0) then
          call tester%is_true(all(ieee_is_nan(q(:, i))), 'no number where there is no position')
          cycle
        end if
        angle = acos((300.0_wp**2 + s**2 - 1100.0_wp**2)/(600.0_wp*s))
        ! the angle has round-off over its sine, which is 0.03 at the positions next to the ends
        call tester%near(q(1, i)*degree, angle, 1.0e-13_wp/sin(angle), 'the crank')
        call tester%near(q(4, i), s, 1.0e-12_wp*s, 'the slide')
      end associate
    end do
    call positions%close()
  end subroutine slides

  !> A five-bar linkage: each position is the end of a line of its own. Some have no position.
  subroutine two_coordinates(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 300
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    type(random_type) :: random
    real(wp) :: given(2, n), q(5, n), one(5, 1), tip(2), other(2), pin(2), from_other(2)
    integer :: codes(n), code(1), i

    call read_text(five_bars, mechanism, err)
    call tester%no_error(err, 'a five-bar linkage is read')
    call positions%begin(mechanism, err)
    call tester%no_error(err, 'it is put together')
    if (allocated(err)) return
    do i = 1, n
      given(:, i) = [2.0_wp + 1.5_wp*random%symmetric(), 1.1_wp + 1.5_wp*random%symmetric()]
    end do
    call positions%find(given, q, codes, err)
    call tester%no_error(err, 'positions are found')
    call tester%is_true(positions%found_beside > n/2, 'most of them are found side by side')
    do i = 1, n
      call positions%find(given(:, i:i), one, code, err)
      call tester%is_true(code(1) == codes(i), 'alone: the same code')
      if (code(1) /= 0) cycle
      call tester%is_true(all(abs(one(:, 1) - q(:, i)) < 1.0e-12_wp), 'alone: the same position')
      tip = 0.2_wp*[cos(q(1, i)), sin(q(1, i))]
      other = [0.3_wp, 0.0_wp] + 0.2_wp*[cos(q(3, i)), sin(q(3, i))]
      pin = tip + 0.4_wp*[cos(q(1, i) + q(2, i)), sin(q(1, i) + q(2, i))]
      from_other = other + 0.4_wp*[cos(q(3, i) + q(4, i)), sin(q(3, i) + q(4, i))]
      call tester%is_true(all(abs(pin - from_other) < 1.0e-14_wp), 'the pin of both links')
      pin = pin - tip
      other = other - tip
      call tester%is_true(other(1)*pin(2) - other(2)*pin(1) > 0.0_wp, 'the side on which it was put together')
    end do
    call positions%close()
  end subroutine two_coordinates

  !> Compare positions side by side with the same ones found alone, codes of failures included.
  subroutine compare(tester, text, low, high, n, why, at_least, at_most)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< of the data file
    real(wp), intent(in) :: low                  !< least value of the independent coordinate [unit of the file]
    real(wp), intent(in) :: high                 !< largest one [unit of the file]
    integer, intent(in) :: n                     !< number of positions
    character(len=*), intent(in) :: why          !< name of the mechanism
    integer, intent(in) :: at_least              !< so many of the positions are found side by side
    integer, intent(in), optional :: at_most     !< no more of them are; any number unless given
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    real(wp) :: given(1, n), rates(1, n)
    real(wp), allocatable, dimension(:, :) :: q, dq, one_q, one_dq
    integer :: codes(n), one_codes(n), first, i, last

    call read_text(text, mechanism, err)
    call tester%no_error(err, why//' is read')
    call positions%begin(mechanism, err)
    call tester%no_error(err, why//' is put together')
    if (allocated(err)) return
    allocate (q(positions%coordinates(), n), dq(positions%coordinates(), n))
    allocate (one_q, one_dq, mold=q)
    given(1, :) = [(low + (high - low)*i/n, i=1, n)]
    rates = 1.0_wp
    call positions%find(given, q, codes, err, rates=rates, dq=dq)
    call tester%no_error(err, why//': positions are found')
    call tester%is_true(positions%found_beside >= at_least, why//': positions are found side by side')
    if (present(at_most)) call tester%is_true(positions%found_beside <= at_most, why//': others are found alone')
    do first = 1, n, few
      last = min(first + few - 1, n)
      call positions%find(given(:, first:last), one_q(:, first:last), one_codes(first:last), err, rates=rates(:, first:last), &
                          dq=one_dq(:, first:last))
      call tester%is_true(positions%found_beside == 0, why//': few positions are found alone')
    end do
    call tester%is_true(all(codes == one_codes), why//': the same codes')
    do i = 1, n
      if (codes(i) /= 0 .or. one_codes(i) /= 0) cycle
      ! round-off over the least pivot, which is above 0.03 of the largest where positions are found side by side
      call tester%is_true(all(abs(q(:, i) - one_q(:, i)) < 1.0e-11_wp*max(1.0_wp, abs(one_q(:, i)))), why//': the same position')
      call tester%is_true(all(abs(dq(:, i) - one_dq(:, i)) < 1.0e-9_wp*max(1.0_wp, abs(one_dq(:, i)))), why//': the same rates')
    end do
    call positions%close()
  end subroutine compare

  !> Four-bar linkages of random lengths, over more than a turn: cranks, rockers with dead points, and all between.
  subroutine random_four_bars(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(random_type) :: random
    real(wp) :: lengths(4), q(4)
    integer :: i, made

    made = 0
    do while (made < 12)
      lengths = [(0.3_wp + 0.2_wp*random%symmetric(), i=1, 4)]
      q(1) = sqrt((lengths(1) - lengths(2)*cos(0.6_wp))**2 + (lengths(2)*sin(0.6_wp))**2)
      ! it can be put together
      if (q(1) > 0.9_wp*(lengths(3) + lengths(4)) .or. q(1) < 1.1_wp*abs(lengths(3) - lengths(4))) cycle
      made = made + 1
      call compare(tester, four_bar(lengths, merge(1, -1, modulo(made, 2) == 0)), -5.0_wp, 7.0_wp, 600, 'a random four-bar', 0)
    end do
  end subroutine random_four_bars

  !> Positions beyond dead points, through crossings of branches, and beside near ones.
  subroutine special_positions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    ! dead points at both ends
    call compare(tester, four_bar([0.4_wp, 0.35_wp, 0.2_wp, 0.3_wp], 1), -3.0_wp, 4.0_wp, 900, 'a rocker', 100)
    ! a parallelogram goes through its crossings
    call compare(tester, four_bar([0.4_wp, 0.15_wp, 0.4_wp, 0.15_wp], 1), -8.0_wp, 8.0_wp, 900, 'a parallelogram', 300)
    ! branches come so near that a lane cannot tell them there
    call compare(tester, four_bar([0.4_wp, 0.15_wp, 0.4_wp, 0.1502_wp], 1), -8.0_wp, 8.0_wp, 900, 'nearly a parallelogram', 300, &
                 at_most=880)
    call compare(tester, four_bar([0.4_wp, 0.15_wp, 0.4_wp, 0.1502_wp], 1), -8.0_wp, 8.0_wp, 160, 'the same by long steps', 10)
    ! lanes that begin near a crossing are left, though their short steps away from it could be trusted
    call compare(tester, four_bar([0.4_wp, 0.15_wp, 0.4_wp, 0.15_wp], 1), acos(-1.0_wp) - 0.08_wp, acos(-1.0_wp) + 0.08_wp, 320, &
                 'lanes near a crossing', 100, at_most=200)
    ! many turns
    call compare(tester, four_bar([0.4_wp, 0.15_wp, 0.35_wp, 0.30_wp], -1), 0.61_wp, 60.0_wp, 1000, 'long ways', 1000)
  end subroutine special_positions

  !> A parallelogram keeps its rates in the very positions in which its branches cross: those of the crank.
  subroutine rates_in_crossings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    real(wp), parameter :: pi = acos(-1.0_wp)
    real(wp), dimension(1, 4) :: given
    real(wp), dimension(4, 4) :: q, dq, ddq
    integer :: codes(4), i

    call read_text(four_bar([0.4_wp, 0.15_wp, 0.4_wp, 0.15_wp], 1), mechanism, err)
    call positions%begin(mechanism, err)
    call tester%no_error(err, 'a parallelogram is put together')
    if (allocated(err)) return
    given(1, :) = [0.0_wp, pi, -pi, 1.0_wp]
    call positions%find(given, q, codes, err, rates=spread([2.0_wp], 2, 4), dq=dq, accelerations=spread([3.0_wp], 2, 4), ddq=ddq)
    call tester%is_true(all(codes == 0), 'all positions are reached')
    do i = 1, 4
      ! the motion through a crossing is a polynomial; its least pivot there limits accelerations
      call tester%is_true(all(abs(dq(:, i) - [2.0_wp, -2.0_wp, 2.0_wp, -2.0_wp]) < 1.0e-9_wp), 'rates')
      call tester%is_true(all(abs(ddq(:, i) - [3.0_wp, -3.0_wp, 3.0_wp, -3.0_wp]) < 1.0e-6_wp), 'accelerations')
    end do
    call positions%close()
  end subroutine rates_in_crossings

  !> A parallelogram with an arm that moves by itself: a position in which branches cross has no rates for two given ones, and says so.
  subroutine crossings_of_two(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    real(wp), parameter :: pi = acos(-1.0_wp)
    real(wp), dimension(2, 3) :: given
    real(wp), dimension(5, 3) :: q, dq
    integer :: codes(3), i
    character(len=:), allocatable :: text

    text = four_bar([0.4_wp, 0.15_wp, 0.4_wp, 0.15_wp], 1)
    i = index(text, '&structure')
    text = '&mechanism links=5, coordinates=5 /'//nl//'&structure cq=1,5 /'//text(i + 17:)//nl// &
           '&pair coordinate=5, links=4,5, kind=''revolute'', axis=0,0,1, point=0.1,0,0, moving_point=0,0,0 /'
    call read_text(text, mechanism, err)
    call positions%begin(mechanism, err)
    call tester%no_error(err, 'a parallelogram with an arm is put together')
    if (allocated(err)) return
    given(:, 1) = [1.0_wp, 0.5_wp]
    given(:, 2) = [pi, 0.5_wp]
    given(:, 3) = [4.0_wp, 0.5_wp]
    call positions%find(given, q, codes, err, rates=spread([2.0_wp, 1.0_wp], 2, 3), dq=dq)
    call tester%is_true(all(codes == [0, 6, 0]), 'a singular position is told')
    call tester%is_true(all(abs(q(3, :) - given(1, :)) < 1.0e-9_wp), 'all positions are those of a parallelogram')
    call tester%is_true(all(ieee_is_nan(dq(:, 2))), 'it has no rates')
    do i = 1, 3, 2
      call tester%is_true(all(abs(dq(:, i) - [2.0_wp, -2.0_wp, 2.0_wp, -2.0_wp, 1.0_wp]) < 1.0e-9_wp), 'rates of the others')
    end do
    call positions%close()
  end subroutine crossings_of_two

  !> Two chains, a slide on an arm, few positions far from each other.
  subroutine other_structures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call compare(tester, two_loops, -4.0_wp, 6.0_wp, 500, 'two chains', 500)
    call compare(tester, slotted, -7.0_wp, 8.0_wp, 500, 'a slide on an arm', 500)
    ! between positions lanes make several steps
    call compare(tester, two_loops, 0.0_wp, 100.0_wp, 200, 'far positions', 200)
  end subroutine other_structures

  !> Values so near to the start that powers of their differences are no numbers, and others beside them.
  subroutine next_to_the_start(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 200
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    real(wp) :: given(1, n), q(7, n), one(7, 1)
    integer :: codes(n), code(1), i

    call read_text(two_loops, mechanism, err)
    call positions%begin(mechanism, err)
    call tester%no_error(err, 'a mechanism is put together')
    if (allocated(err)) return
    given(1, :) = [(merge(0.01_wp, 1.0e-200_wp, modulo(i, 3) == 0)*i, i=1, n)]
    call positions%find(given, q, codes, err)
    call tester%is_true(positions%found_beside == n, 'all are found side by side')
    do i = 1, n, 7
      call positions%find(given(:, i:i), one, code, err)
      call tester%is_true(codes(i) == 0 .and. code(1) == 0, 'a position is reached')
      call tester%is_true(all(abs(q(:, i) - one(:, 1)) < 1.0e-12_wp), 'the same position')
    end do
    call positions%close()
  end subroutine next_to_the_start

  !> Positions twice, with other rates; positions whose values differ in their last bits; positions in bunches.
  subroutine spacings(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    real(wp), parameter :: lengths(4) = [ground, crank, coupler, rocker]
    integer, parameter :: n = 1600
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    real(wp), dimension(1, n) :: given, rates
    real(wp) :: q(4, n), dq(4, n), exact(4), w
    integer :: codes(n), i

    call read_text(four_bar(lengths, 1), mechanism, err)
    call positions%begin(mechanism, err)
    call tester%no_error(err, 'a four-bar linkage is put together')
    if (allocated(err)) return
    do i = 1, n
      rates(1, i) = 1.0_wp + modulo(i, 3)
      given(1, i) = 0.01_wp*((i - 1)/2)
      if (modulo(i, 4) == 0) given(1, i) = given(1, i)*(1.0_wp + 3.0_wp*epsilon(1.0_wp))
      if (modulo(i, 5) == 0) given(1, i) = given(1, i) + 1.0e-13_wp
      if (modulo(i, 7) == 0) given(1, i) = given(1, i) + 2.0e-9_wp
      if (modulo(i, 11) == 0) given(1, i) = 3.0_wp + 1.0e-7_wp*i
    end do
    call positions%find(given, q, codes, err, rates=rates, dq=dq)
    call tester%no_error(err, 'positions are found')
    call tester%is_true(positions%found_beside > n - 10, 'nearly all are found side by side')
    call tester%is_true(all(codes == 0), 'all positions are reached')
    do i = 1, n
      exact = exact_four_bar(lengths, 1, given(1, i))
      call tester%is_true(maxval(abs(sin(0.5_wp*(q(:, i) - exact)))) < 2.0e-14_wp, 'coordinates')
      w = crank*rates(1, i)*sin(-exact(2))/(rocker*sin(exact(3) - exact(1) - exact(2)))
      call tester%near(dq(3, i), w, 1.0e-12_wp, 'a rate of the rocker')
    end do
    call positions%close()
  end subroutine spacings

  !> The same bits by all vectors that the processor has.
  subroutine all_vectors(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 500
    type(mechanism_type) :: mechanism
    type(positions_type) :: positions
    type(error_type), allocatable :: err
    real(wp), dimension(1, n) :: given, rates
    real(wp), dimension(7, n) :: q, dq, ddq, first_q, first_dq, first_ddq
    integer :: bits, codes(n), i

    call read_text(two_loops, mechanism, err)
    call tester%no_error(err, 'a mechanism is read')
    given(1, :) = [(20.0_wp*modulo(i*0.6180339887498949_wp, 1.0_wp) - 10.0_wp, i=1, n)]
    rates = 2.0_wp
    bits = 128
    do while (bits <= 512)
      positions%most_bits = bits
      call positions%begin(mechanism, err)
      call tester%no_error(err, 'it is put together')
      if (allocated(err)) return
      call positions%find(given, q, codes, err, rates=rates, dq=dq, accelerations=rates, ddq=ddq)
      call tester%is_true(positions%found_beside == n, 'all are found side by side')
      if (bits == 128) then
        first_q = q
        first_dq = dq
        first_ddq = ddq
      end if
      call tester%is_true(.not. any(abs(q - first_q) > 0.0_wp), 'the same coordinates')
      call tester%is_true(.not. any(abs(dq - first_dq) > 0.0_wp), 'the same rates')
      call tester%is_true(.not. any(abs(ddq - first_ddq) > 0.0_wp), 'the same accelerations')
      call positions%close()
      bits = 2*bits
    end do
  end subroutine all_vectors
end module test_positions
