!> Assembly from rough guesses, near and beyond the reach of the links, and the list of all assemblies,
!> against closed forms and counts known otherwise.
module test_assemblies
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type, exit_assembly
  use mech9_random, only: random_type
  use mech9_pose, only: pose_type, compose, inverse
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_assemblies, only: assembly_list_type, find_assemblies
  use mech9_sample_mechanisms, only: new_mechanism, add_revolute, add_prismatic, frame, four_bar
  use mech9_plan_checks, only: check_closed
  use mech9_testing, only: tester_type, message_of
  implicit none
  private
  public :: run

  real(wp), parameter :: z(3) = [0.0_wp, 0.0_wp, 1.0_wp], origin(3) = 0.0_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('four_bars_from_anywhere')) call four_bars_from_anywhere(test)
    if (test%runs('four_bar_near_its_reach')) call four_bar_near_its_reach(test)
    if (test%runs('slider_crank')) call slider_crank(test)
    if (test%runs('platforms')) call platforms(test)
    if (test%runs('six_revolutes')) call six_revolutes(test)
  end subroutine run

  !> Any guess leads to one of the two positions of the rocker, where there are any; the list holds both.
  subroutine four_bars_from_anywhere(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(assembly_list_type) :: list
    type(error_type), allocatable :: err
    real(wp) :: length(4), diagonal, rockers(2), guess(4)
    integer :: i, k, closed, open
    type(random_type) :: random

    closed = 0
    open = 0
    do i = 1, 300
      do k = 1, 4
        length(k) = 1.0_wp + 0.8_wp*random%symmetric()
        guess(k) = pi*random%symmetric()
      end do
      call four_bar(length(1), length(2), length(3), length(4), guess, model)
      call make_plan(model%mechanism, model%problem%partition, guess, plan, state, err)
      diagonal = norm2([length(2)*cos(guess(1)) - length(1), length(2)*sin(guess(1))])
      ! coupler, rocker and diagonal must make a triangle; leave out the narrowest ones
      if (min(length(3) + length(4) - diagonal, diagonal - abs(length(3) - length(4))) > 1.0e-6_wp) then
        closed = closed + 1
        call test%no_error(err, 'a four-bar within its reach is assembled')
        if (allocated(err)) cycle
        call check_closed(test, plan, state, 'four-bar')
        rockers = rocker_angles(length, guess(1))
        call test%near(minval(abs(cos(state%q(4) - rockers) - 1.0_wp)), 0.0_wp, 1.0e-14_wp, &
                       'an assembled four-bar has one of its two rocker angles')
        call find_assemblies(model%mechanism, plan, state, 50, list)
        call test%is_true(size(list%found) == 2, 'a four-bar has two assemblies')
        if (size(list%found) == 2) call test%near(abs(cos(list%q(4, 1) - list%q(4, 2)) - cos(rockers(1) - rockers(2))), &
          0.0_wp, 1.0e-13_wp, 'the two assemblies of a four-bar are its two rocker angles')
      else if (min(length(3) + length(4) - diagonal, diagonal - abs(length(3) - length(4))) < -1.0e-3_wp) then
        open = open + 1
        call test%has_error(err, exit_assembly, 'a four-bar beyond its reach is refused')
        if (allocated(err)) call test%is_true(index(message_of(err), 'closed chain 1') > 0, &
                                              'the message about a four-bar beyond its reach names the chain')
      end if
    end do
    call test%is_true(closed > 100 .and. open > 30, 'four-bars within and beyond their reach both happened often')
  end subroutine four_bars_from_anywhere

  !> The two angles of the rocker for an angle of the crank, by the law of cosines.
  pure function rocker_angles(length, crank) result(angles)
    real(wp), intent(in) :: length(4)   !< of ground, crank, coupler and rocker [m]
    real(wp), intent(in) :: crank       !< its angle [rad]
    real(wp) :: angles(2), to_tip(2), diagonal, opening

    to_tip = [length(2)*cos(crank) - length(1), length(2)*sin(crank)]
    diagonal = norm2(to_tip)
    opening = acos((length(4)**2 + diagonal**2 - length(3)**2)/(2.0_wp*length(4)*diagonal))
    angles = atan2(to_tip(2), to_tip(1)) + [opening, -opening]
  end function rocker_angles

  !> Coupler and rocker stretched: the two assemblies are one, and coordinates are known to the root of
  !> round-off only; but the chain closes. A millionth farther it does not, and stays open by at most that.
  subroutine four_bar_near_its_reach(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp) :: gap
    integer :: i

    do i = 0, 20
      call four_bar(3.0_wp, 1.0_wp, 1.2_wp, 0.8_wp, [0.0_wp, 0.3_wp*i/20, 0.2_wp, 2.8_wp], model)
      call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
      call test%no_error(err, 'a four-bar that just reaches is assembled')
      if (.not. allocated(err)) call check_closed(test, plan, state, 'a four-bar that just reaches')
    end do
    call four_bar(3.0_wp + 1.0e-3_wp, 1.0_wp, 1.2_wp, 0.8_wp, [0.0_wp, 0.3_wp, 0.2_wp, 2.8_wp], model)
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%has_error(err, exit_assembly, 'a four-bar that just does not reach is refused')
    if (.not. allocated(err)) return
    call test%is_true(index(message_of(err), 'stays open by ') > 0, &
                      'the message about an open chain says by how much it stays open')
    gap = err%failure%gap
    ! the least of rotation and translation together, in units of the mechanism's length of 3
    call test%is_true(gap > 1.0e-4_wp .and. gap <= 1.01e-3_wp, 'the gap is the length that is missing')
  end subroutine four_bar_near_its_reach

  !> Crank and rod: the slide is at r cos a -+ sqrt(l^2 - r^2 sin^2 a).
  subroutine slider_crank(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(assembly_list_type) :: list
    type(error_type), allocatable :: err
    integer, parameter :: links(2, 4) = reshape([1, 2, 2, 3, 3, 4, 1, 4], [2, 4])
    real(wp), parameter :: crank = 0.4_wp, rod = 1.1_wp, angle = 0.7_wp
    real(wp) :: slides(2)

    call new_mechanism(4, links, [1], model)
    call add_revolute(model, 1, 1, 2, frame(origin, z), frame(origin, z))
    call add_revolute(model, 2, 2, 3, frame([crank, 0.0_wp, 0.0_wp], z), frame(origin, z))
    call add_revolute(model, 3, 3, 4, frame([rod, 0.0_wp, 0.0_wp], z), frame(origin, z))
    call add_prismatic(model, 4, 1, 4, frame(origin, [1.0_wp, 0.0_wp, 0.0_wp]), frame(origin, [1.0_wp, 0.0_wp, 0.0_wp]))
    model%problem%initial%position(1) = angle
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'a slider-crank is assembled')
    if (allocated(err)) return
    call find_assemblies(model%mechanism, plan, state, 60, list)
    call test%is_true(size(list%found) == 2, 'a slider-crank has two assemblies')
    if (size(list%found) /= 2) return
    slides = crank*cos(angle) + [-1.0_wp, 1.0_wp]*sqrt(rod**2 - (crank*sin(angle))**2)
    call test%near(minval(list%q(4, :)), slides(1), 1.0e-13_wp, 'the slide has its closed form on one side')
    call test%near(maxval(list%q(4, :)), slides(2), 1.0e-13_wp, 'the slide has its closed form on the other side')
  end subroutine slider_crank

  !> A triangle on three legs that are turned by nothing: the number of its positions against a count
  !> along all its orientations.
  subroutine platforms(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp) :: base(2, 3), plate(2, 3), legs(3)
    integer :: i, k, most
    type(random_type) :: random

    most = 0
    do i = 1, 12
      do k = 1, 3
        base(:, k) = [cos(2.1_wp*k), sin(2.1_wp*k)] + 0.2_wp*[random%symmetric(), random%symmetric()]
        plate(:, k) = 0.7_wp*[cos(2.1_wp*k), sin(2.1_wp*k)] + 0.2_wp*[random%symmetric(), random%symmetric()]
        legs(k) = 0.9_wp + 0.25_wp*random%symmetric()
      end do
      call platform(test, base, plate, legs, most)
    end do
    call test%is_true(most >= 4, 'some platforms have four positions or more')
  end subroutine platforms

  subroutine platform(test, base, plate, legs, most)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: base(2, 3)         !< (2,3) pivots in the frame [m]
    real(wp), intent(in) :: plate(2, 3)        !< (2,3) joints in the platform [m]
    real(wp), intent(in) :: legs(3)            !< their lengths [m]
    integer, intent(inout) :: most             !< the greatest number of positions so far
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(assembly_list_type) :: list
    type(error_type), allocatable :: err
    integer, parameter :: links(2, 6) = reshape([1, 3, 3, 2, 1, 4, 4, 2, 1, 5, 5, 2], [2, 6])
    integer :: k, expected

    call new_mechanism(5, links, [integer ::], model)
    do k = 1, 3
      call add_revolute(model, 2*k - 1, 1, 2 + k, frame([base(:, k), 0.0_wp], z), frame(origin, z))
      call add_revolute(model, 2*k, 2 + k, 2, frame([legs(k), 0.0_wp, 0.0_wp], z), frame([plate(:, k), 0.0_wp], z))
    end do
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    expected = positions_of(base, plate, legs)
    if (expected == 0) then
      call test%has_error(err, exit_assembly, 'a platform without positions is refused')
      return
    end if
    call test%no_error(err, 'a platform is assembled')
    if (allocated(err)) return
    call find_assemblies(model%mechanism, plan, state, 400, list)
    call test%is_true(size(list%found) == expected, 'the platform has as many assemblies as counted')
    most = max(most, expected)
  end subroutine platform

  !> Number of positions of a platform: for each orientation two legs leave two places, and the third leg
  !> fits where its lack changes sign.
  integer function positions_of(base, plate, legs) result(found)
    real(wp), intent(in) :: base(2, 3)    !< (2,3) pivots in the frame [m]
    real(wp), intent(in) :: plate(2, 3)   !< (2,3) joints in the platform [m]
    real(wp), intent(in) :: legs(3)       !< their lengths [m]
    integer, parameter :: n = 200000
    real(wp) :: turn(2, 2), centre(2), apart(2), along, across, place(2), residual_norm, before(2), angle
    logical :: had(2)
    integer :: i, side

    found = 0
    had = .false.
    do i = 0, n
      angle = 2.0_wp*pi*i/n
      turn = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      ! the plate's origin is on circles about two places
      centre = base(:, 1) - matmul(turn, plate(:, 1))
      apart = base(:, 2) - matmul(turn, plate(:, 2)) - centre
      along = (legs(1)**2 - legs(2)**2 + dot_product(apart, apart))/(2.0_wp*norm2(apart))
      if (legs(1)**2 < along**2) then
        had = .false.
        cycle
      end if
      across = sqrt(legs(1)**2 - along**2)
      apart = apart/norm2(apart)
      do side = 1, 2
        place = centre + along*apart + (3 - 2*side)*across*[-apart(2), apart(1)]
        residual_norm = norm2(place + matmul(turn, plate(:, 3)) - base(:, 3)) - legs(3)
        if (had(side)) then
          if (residual_norm*before(side) < 0.0_wp) found = found + 1
        end if
        before(side) = residual_norm
        had(side) = .true.
      end do
    end do
  end function positions_of

  !> Six revolutes in a loop, the arm of Manseur and Doty in the position that is reached in 16 ways, the most
  !> that any such arm has.
  subroutine six_revolutes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(model_type) :: model
    type(plan_type) :: plan
    type(state_type) :: state
    type(assembly_list_type) :: list
    type(error_type), allocatable :: err
    integer, parameter :: links(2, 6) = reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 1], [2, 6])
    real(wp), parameter :: a(6) = [0.3_wp, 1.0_wp, 0.0_wp, 1.5_wp, 0.0_wp, 0.0_wp]
    real(wp), parameter :: twist(6) = [pi/2, 1.0_wp*pi/180, pi/2, 1.0_wp*pi/180, pi/2, 0.0_wp]
    real(wp), parameter :: d(6) = [0.0_wp, 0.0_wp, 0.2_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    type(pose_type) :: hand, after, in_moving
    integer :: k

    hand%r = reshape([-0.760117_wp, 0.133333_wp, -0.635959_wp, -0.641689_wp, 0.0_wp, 0.766965_wp, &
                      0.102262_wp, 0.991071_wp, 0.085558_wp], [3, 3])
    hand%p = [-1.14017_wp, 0.0_wp, 0.0_wp]
    call orthonormalize(hand%r)
    call new_mechanism(6, links, [integer ::], model)
    do k = 1, 6
      after%r = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, cos(twist(k)), sin(twist(k)), &
                         0.0_wp, -sin(twist(k)), cos(twist(k))], [3, 3])
      after%p = [a(k), 0.0_wp, d(k)]
      in_moving = inverse(after)
      if (k == 6) in_moving = compose(hand, in_moving)
      call add_revolute(model, k, links(1, k), links(2, k), frame(origin, z), in_moving)
    end do
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, state, err)
    call test%no_error(err, 'six revolutes are assembled')
    if (allocated(err)) return
    call find_assemblies(model%mechanism, plan, state, 1500, list)
    call test%is_true(size(list%found) == 16, 'six revolutes have sixteen assemblies')
  end subroutine six_revolutes

  !> The rotation nearest to one printed with six digits, by Newton's iteration for the polar factor.
  subroutine orthonormalize(r)
    real(wp), intent(inout) :: r(3, 3)   !< nearly a rotation, then a rotation
    integer :: i

    do i = 1, 6
      r = 0.5_wp*matmul(r, 3.0_wp*reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3]) - matmul(transpose(r), r))
    end do
  end subroutine orthonormalize
end module test_assemblies
