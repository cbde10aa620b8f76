!> Three turns: one motion in the angles of two triples of axes, and angles through gimbal lock.
module test_three_turns
  use mech9_kinds, only: wp, pi
  use mech9_random, only: random_type
  use mech9_rotation, only: combine, cross, about_z
  use mech9_three_turns, only: three_turns_type, swing_type, heading_type, set_three_turns, substitute_turns, cyclic
  use mech9_varied_turns, only: carry_changes
  use mech9_random_geometry, only: random_vector, random_unit
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A few roundings of numbers of order one.
  real(wp), parameter :: round_off = 1.0e-13_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('common_form')) call common_form(test)
    if (test%runs('axes_not_at_right_angles')) call axes_not_at_right_angles(test)
    if (test%runs('one_motion_in_two_triples')) call one_motion_in_two_triples(test)
    if (test%runs('changes_in_two_triples')) call changes_in_two_triples(test)
    if (test%runs('limits_in_lock')) call limits_in_lock(test)
    if (test%runs('way_past_the_lock')) call way_past_the_lock(test)
    if (test%runs('way_through_the_lock')) call way_through_the_lock(test)
  end subroutine run

  !> Three rotations before turns about z whose neighbouring axes are at right angles.
  subroutine make_before(random, before)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp), intent(out) :: before(3, 3, 3)     !< the rotations
    real(wp) :: angles(3)
    integer :: i

    before(:, :, 1) = frame_of(random_unit(random), random_unit(random))
    do i = 2, 3
      angles = random_vector(random)*pi
      before(:, :, i) = combine(about_z(angles(1)), combine(cyclic, about_z(angles(2))))
    end do
  end subroutine make_before

  !> A rotation with a given z axis.
  pure function frame_of(z, other) result(r)
    real(wp), intent(in) :: z(3)       !< direction, of length one
    real(wp), intent(in) :: other(3)   !< another direction, of length one
    real(wp) :: r(3, 3)

    r(:, 3) = z
    r(:, 1) = cross(z, other)/norm2(cross(z, other))
    r(:, 2) = cross(z, r(:, 1))
  end function frame_of

  !> The rotation by three turns, without the common form.
  pure function turned(before, sign, offset, q) result(r)
    real(wp), intent(in) :: before(3, 3, 3)   !< rotation before each turn
    real(wp), intent(in) :: sign(3)           !< of each turn
    real(wp), intent(in) :: offset(3)         !< of each coordinate [rad]
    real(wp), intent(in) :: q(3)              !< coordinates [rad]
    real(wp) :: r(3, 3)
    integer :: i

    r = before(:, :, 1)
    do i = 1, 3
      if (i > 1) r = combine(r, before(:, :, i))
      r = combine(r, about_z(sign(i)*(q(i) + offset(i))))
    end do
  end function turned

  !> The rotation that a motion of a joint describes: its third axis is z.
  pure function rotation_of(motion) result(r)
    type(swing_type), intent(in) :: motion   !< of the joint
    real(wp) :: r(3, 3), side(3)

    side = cross(motion%e, motion%d)
    r(:, 3) = motion%d
    r(:, 1) = cos(motion%spin(1))*side + sin(motion%spin(1))*motion%e
    r(:, 2) = cross(r(:, 3), r(:, 1))
  end function rotation_of

  !> The common form gives the rotation of the turns themselves, up to one constant turn about the third axis.
  subroutine common_form(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(three_turns_type) :: turns
    real(wp) :: before(3, 3, 3), sign(3), offset(3), q(3), constant(3, 3), first(3, 3)
    logical :: fits
    integer :: i, k

    sign = [1.0_wp, -1.0_wp, 1.0_wp]
    do i = 1, 20
      call make_before(random, before)
      sign = cshift(-sign, 1)
      offset = random_vector(random)*pi
      call set_three_turns(before, sign, offset, 1.0e-11_wp, turns, fits)
      call test%is_true(fits, 'axes at right angles make a ball joint')
      do k = 1, 3
        q = random_vector(random)*2.0_wp*pi
        constant = combine(transpose(rotation_of(turns%swing(q, 0.0_wp*q, 0.0_wp*q))), turned(before, sign, offset, q))
        if (k == 1) first = constant
        call test%near(maxval(abs(constant - first)), 0.0_wp, round_off, 'the turns differ from the swing by a constant rotation')
        call test%near(constant(3, 3), 1.0_wp, round_off, 'the constant rotation is one about the third axis')
      end do
    end do
  end subroutine common_form

  !> Neighbouring axes at other angles cannot be replaced: their turns do not reach all rotations.
  subroutine axes_not_at_right_angles(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(three_turns_type) :: turns
    real(wp) :: before(3, 3, 3)
    logical :: fits

    call make_before(random, before)
    before(:, :, 2) = frame_of([sin(1.5_wp), 0.0_wp, cos(1.5_wp)], [0.0_wp, 1.0_wp, 0.0_wp])
    call set_three_turns(before, [1.0_wp, 1.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], 1.0e-11_wp, turns, fits)
    call test%is_true(.not. fits, 'an angle of 1.5 rad is no right angle')
  end subroutine axes_not_at_right_angles

  !> Compare two motions of a joint: rotation, angular velocity and acceleration.
  subroutine same_motion(test, a, b, tolerance, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(swing_type), intent(in) :: a          !< a motion
    type(swing_type), intent(in) :: b          !< another one
    real(wp), intent(in) :: tolerance          !< largest difference of components
    character(len=*), intent(in) :: why        !< the statement that is checked

    call test%near(maxval(abs(rotation_of(a) - rotation_of(b))), 0.0_wp, tolerance, why//': the rotations are equal')
    call test%near(maxval(abs(a%omega + a%spin(2)*a%d - b%omega - b%spin(2)*b%d)), 0.0_wp, tolerance, &
                   why//': the angular velocities are equal')
    call test%near(maxval(abs(a%omega_rate + a%spin(3)*a%d + a%spin(2)*cross(a%omega, a%d) &
                              - b%omega_rate - b%spin(3)*b%d - b%spin(2)*cross(b%omega, b%d))), 0.0_wp, tolerance, &
                   why//': the angular accelerations are equal')
  end subroutine same_motion

  !> One motion has the same rotation, angular velocity and angular acceleration in both triples, and comes back to the same
  !> coordinates.
  subroutine one_motion_in_two_triples(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(three_turns_type) :: given, other
    type(swing_type) :: motion, substituted
    type(heading_type) :: heading
    real(wp) :: q(3), dq(3), ddq(3), a(3), da(3), dda(3), before(3, 3, 3), limit
    logical :: fits
    integer :: i

    do i = 1, 50
      call make_before(random, before)
      call set_three_turns(before, [1.0_wp, -1.0_wp, -1.0_wp], random_vector(random), 1.0e-11_wp, given, fits)
      other = substitute_turns(given)
      q = random_vector(random)*3.0_wp
      dq = random_vector(random)
      ddq = random_vector(random)
      motion = given%swing(q, dq, ddq)
      call test%near(given%distance(motion), given%margin(q(2)), round_off, &
                     'the distance from the lock is that of the second angle')
      heading = heading_type()
      call other%continue_heading(motion, 0.0_wp, heading)
      call other%coordinates(motion, heading, 0.0_wp, a, da, dda)
      substituted = other%swing(a, da, dda)
      ! accelerations are divided twice by the distances from both locks
      limit = round_off/(given%distance(motion)*other%distance(motion))**3
      call same_motion(test, substituted, motion, limit, 'in the substitute angles')
      heading = heading_type(given%sign(1)*q(1) + given%shift(1) + 0.1_wp, given%sign(2)*q(2) + given%shift(2), &
                             given%sign(3)*q(3) + given%shift(3) - substituted%spin(1) - 0.1_wp)
      call given%continue_heading(substituted, 0.0_wp, heading)
      call given%coordinates(substituted, heading, 0.0_wp, a, da, dda)
      call test%near(maxval(abs(a - q)), 0.0_wp, limit, 'coordinates that are carried there and back are the same')
      call test%near(maxval(abs(da - dq)), 0.0_wp, limit, 'rates that are carried there and back are the same')
      call test%near(maxval(abs(dda - ddq)), 0.0_wp, limit, 'accelerations that are carried there and back are the same')
    end do
  end subroutine one_motion_in_two_triples

  !> Changes of a motion in two triples: those of time are rates and accelerations; others are differences of neighbouring motions.
  subroutine changes_in_two_triples(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: step = 1.0e-5_wp
    type(random_type) :: random
    type(three_turns_type) :: given, other
    real(wp) :: q(3), dq(3), ddq(3), before(3, 3, 3), there(3, 0:2), beside(3, 0:2, -1:1), changes(2, 0:1, 3), wanted(3, 0:1), limit
    logical :: fits
    integer :: i, k

    do i = 1, 50
      call make_before(random, before)
      call set_three_turns(before, [1.0_wp, -1.0_wp, -1.0_wp], random_vector(random), 1.0e-11_wp, given, fits)
      other = substitute_turns(given)
      q = random_vector(random)*3.0_wp
      dq = random_vector(random)
      ddq = random_vector(random)
      call substitute(given, other, q, dq, ddq, there)
      changes(1, 0, :) = dq
      changes(1, 1, :) = ddq
      changes(2, 0, :) = random_vector(random)
      changes(2, 1, :) = random_vector(random)
      do k = -1, 1, 2
        call substitute(given, other, q + k*step*changes(2, 0, :), dq + k*step*changes(2, 1, :), ddq, beside(:, :, k))
      end do
      wanted = (beside(:, 0:1, 1) - beside(:, 0:1, -1))/(2.0_wp*step)
      call carry_changes(given, reshape([q, dq], [3, 2]), other, there(:, 0:1), changes)
      limit = (given%margin(q(2))*other%margin(there(2, 0)))**3
      call test%near(maxval(abs(changes(1, 0, :) - there(:, 1))), 0.0_wp, round_off/limit, 'changes in time are rates')
      call test%near(maxval(abs(changes(1, 1, :) - there(:, 2))), 0.0_wp, round_off/limit, 'their rates are accelerations')
      ! the difference has errors of step**2 times third derivatives, and of round-off over the step
      limit = 1.0e-9_wp/limit**2
      call test%near(maxval(abs(changes(2, 0, :) - wanted(:, 0))), 0.0_wp, limit, 'changes of angles are differences')
      call test%near(maxval(abs(changes(2, 1, :) - wanted(:, 1))), 0.0_wp, limit, 'changes of rates are differences')
      call carry_changes(other, there(:, 0:1), given, reshape([q, dq], [3, 2]), changes)
      call test%near(maxval(abs(changes(1, 0, :) - dq)), 0.0_wp, round_off/sqrt(1.0e-9_wp/limit), 'there and back')
    end do
  end subroutine changes_in_two_triples

  !> A motion in the angles of another triple: its coordinates, rates and accelerations.
  subroutine substitute(given, other, q, dq, ddq, there)
    type(three_turns_type), intent(in) :: given   !< the triple
    type(three_turns_type), intent(in) :: other   !< the other triple
    real(wp), intent(in) :: q(3)                  !< coordinates [rad]
    real(wp), intent(in) :: dq(3)                 !< rates [rad/s]
    real(wp), intent(in) :: ddq(3)                !< accelerations [rad/s^2]
    real(wp), intent(out) :: there(3, 0:2)        !< the same of the other triple
    type(swing_type) :: motion
    type(heading_type) :: heading

    motion = given%swing(q, dq, ddq)
    call other%continue_heading(motion, 0.0_wp, heading)
    call other%coordinates(motion, heading, 0.0_wp, there(:, 0), there(:, 1), there(:, 2))
  end subroutine substitute

  !> In gimbal lock itself, rates and accelerations are those of a motion that goes through with smooth coordinates.
  subroutine limits_in_lock(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(three_turns_type) :: given, other
    type(swing_type) :: motion
    type(heading_type) :: heading
    real(wp) :: q(3), dq(3), ddq(3), dddq(3), a(3), da(3), dda(3), beside(3, -1:1), ignored(3), before(3, 3, 3), step
    logical :: fits
    integer :: i, k

    step = 1.0e-5_wp
    do i = 1, 20
      call make_before(random, before)
      call set_three_turns(before, [-1.0_wp, 1.0_wp, 1.0_wp], random_vector(random), 1.0e-11_wp, given, fits)
      other = substitute_turns(given)
      q = random_vector(random)
      q(2) = given%sign(2)*(0.5_wp*pi*merge(1.0_wp, -1.0_wp, mod(i, 2) == 0) - given%shift(2))
      dq = random_vector(random)
      dq(2) = dq(2) + sign(1.0_wp, dq(2))
      ddq = random_vector(random)
      dddq = random_vector(random)
      do k = -1, 1
        heading = heading_type()
        motion = given%swing(q + k*step*dq + 0.5_wp*(k*step)**2*ddq + (k*step)**3/6.0_wp*dddq, &
                             dq + k*step*ddq + 0.5_wp*(k*step)**2*dddq, ddq + k*step*dddq)
        call other%continue_heading(motion, 0.0_wp, heading)
        call other%coordinates(motion, heading, 0.0_wp, a, da, beside(:, k))
      end do
      motion = given%swing(q, dq, ddq)
      heading = heading_type()
      call other%continue_heading(motion, 0.0_wp, heading)
      call other%coordinates(motion, heading, 0.0_wp, a, da, dda)
      motion = other%swing(a, da, dda)
      call other%add_jerk(a, da, dda, (beside(:, 1) - beside(:, -1))/(2.0_wp*step), motion)
      call test%is_true(given%in_lock(motion, 1.0e-9_wp), 'the motion is in gimbal lock')
      heading = heading_type(given%sign(1)*q(1) + given%shift(1), given%sign(2)*q(2) + given%shift(2), &
                             given%sign(3)*q(3) + given%shift(3) - motion%spin(1))
      call given%continue_heading(motion, 1.0e-9_wp, heading)
      call given%coordinates(motion, heading, 1.0e-9_wp, a, da, dda)
      ignored = a - q
      call test%near(maxval(abs(ignored)), 0.0_wp, 1.0e-12_wp, 'the coordinates in gimbal lock are found')
      call test%near(maxval(abs(da - dq)), 0.0_wp, 1.0e-11_wp, 'the rates in gimbal lock are found')
      ! the difference has an error of step**2 times fifth derivatives, some tens, and of round-off over the step
      call test%near(maxval(abs(dda - ddq)), 0.0_wp, 1.0e-7_wp, 'the accelerations in gimbal lock are found')
    end do
  end subroutine limits_in_lock

  !> Follow the angles while the third axis goes past the lock on a straight line, in steps as long as they may be.
  subroutine follow(aside, lock, heading)
    real(wp), intent(in) :: aside                !< least distance from the lock [rad]
    real(wp), intent(in) :: lock                 !< distance below which directions are not known [rad]
    type(heading_type), intent(out) :: heading   !< at the end
    type(three_turns_type) :: given, other
    type(swing_type) :: motion
    type(heading_type) :: inside
    real(wp) :: x, d(3), q(3), dq(3), ddq(3)

    given%base = about_z(0.0_wp)
    other = substitute_turns(given)
    x = -0.5_wp
    do while (x < 0.5_wp)
      d = [x, aside, sqrt(1.0_wp - x**2 - aside**2)]
      motion%d = d
      motion%omega = cross(d, [1.0_wp, 0.0_wp, -x/d(3)])
      motion%e = cross(d, [0.0_wp, 1.0_wp, 0.0_wp])/norm2(cross(d, [0.0_wp, 1.0_wp, 0.0_wp]))
      inside = heading_type()
      call other%continue_heading(motion, 0.0_wp, inside)
      call other%coordinates(motion, inside, 0.0_wp, q, dq, ddq)
      motion = other%swing(q, dq, ddq)
      if (x <= -0.5_wp) heading = heading_type(atan2(-d(1), d(2)), atan2(d(3), norm2(d(1:2))), 0.0_wp)
      call given%continue_heading(motion, lock, heading)
      x = x + max(0.4_wp*norm2(d(1:2)), 0.5_wp*lock)
    end do
  end subroutine follow

  !> Past the lock, the first angle turns by nearly half a turn on the side on which the axis passes.
  subroutine way_past_the_lock(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(heading_type) :: heading
    real(wp) :: aside
    integer :: i

    do i = 1, 7
      aside = 0.1_wp**i
      call follow(aside, 1.0e-9_wp, heading)
      ! from atan2(0.5, aside) to below zero as far, on the way over 0
      call test%is_true(heading%first < -1.0_wp .and. heading%first > -0.5_wp*pi, 'the first angle went over 0')
      call test%is_true(heading%second < 0.5_wp*pi, 'the second angle stayed below 90 degrees')
      call follow(-aside, 1.0e-9_wp, heading)
      call test%is_true(heading%first > 4.0_wp .and. heading%first < 1.5_wp*pi, 'the first angle went over pi on the other side')
    end do
  end subroutine way_past_the_lock

  !> Through the lock, or nearer to it than is known, the first angle stays and the second goes beyond 90 degrees.
  subroutine way_through_the_lock(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(heading_type) :: heading
    real(wp), parameter :: asides(4) = [0.0_wp, 1.0e-16_wp, -1.0e-13_wp, 1.0e-11_wp]
    integer :: i

    do i = 1, size(asides)
      call follow(asides(i), 1.0e-9_wp, heading)
      call test%near(heading%first, 0.5_wp*pi, 1.0e-10_wp, 'the first angle stays through the lock')
      call test%is_true(heading%second > 1.9_wp, 'the second angle goes beyond 90 degrees')
    end do
  end subroutine way_through_the_lock
end module test_three_turns
