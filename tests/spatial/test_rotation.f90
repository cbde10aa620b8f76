!> Rotations: matrices against quaternions, rotation vectors at all angles, vectors.
module test_rotation
  use mech9_kinds, only: wp, pi
  use mech9_random, only: random_type
  use mech9_rotation, only: identity, cross, unit, about_axis, about_z, rotation_vector, rotation_between, axial_vector, &
    quaternion
  use mech9_random_geometry, only: random_vector, random_unit, random_rotation, rotation_from_quaternion
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A few roundings of numbers up to one.
  real(wp), parameter :: round_off = 2.0e-15_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('vectors')) call vectors(test)
    if (test%runs('unit_vectors')) call unit_vectors(test)
    if (test%runs('axis_and_angle')) call axis_and_angle(test)
    if (test%runs('vector_of_rotation')) call vector_of_rotation(test)
    if (test%runs('vector_of_small_rotation')) call vector_of_small_rotation(test)
    if (test%runs('half_turns')) call half_turns(test)
    if (test%runs('vector_of_any_rotation')) call vector_of_any_rotation(test)
    if (test%runs('vector_between_frames')) call vector_between_frames(test)
    if (test%runs('quaternion_of_any_rotation')) call quaternion_of_any_rotation(test)
  end subroutine run

  subroutine vectors(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(3), b(3), c(3), matrix(3, 3)
    integer :: i

    do i = 1, 50
      a = random_vector(random)
      b = random_vector(random)
      c = random_vector(random)
      call test%near(dot_product(cross(a, b), a), 0.0_wp, round_off, 'a vector product stands across its first factor')
      call test%near(dot_product(cross(a, b), b), 0.0_wp, round_off, 'a vector product stands across its second factor')
      call test%near(norm2(cross(a, b))**2, dot_product(a, a)*dot_product(b, b) - dot_product(a, b)**2, 2.0_wp*round_off, &
                     'a vector product satisfies Lagrange''s identity')
      call test%near(maxval(abs(cross(a, cross(b, c)) - (b*dot_product(a, c) - c*dot_product(a, b)))), 0.0_wp, &
                     2.0_wp*round_off, 'a vector product of three factors satisfies its expansion')
      matrix(:, 1) = cross(a, identity(:, 1))
      matrix(:, 2) = cross(a, identity(:, 2))
      matrix(:, 3) = cross(a, identity(:, 3))
      call test%near(maxval(abs(axial_vector(matrix) - a)), 0.0_wp, 0.0_wp, 'the vector of a skew matrix is the one that made it')
      call test%near(maxval(abs(axial_vector(matrix + outer(b, b)) - a)), 0.0_wp, round_off, &
                     'a symmetric part does not change the vector of a matrix')
    end do
    call test%near(maxval(abs(cross(identity(:, 1), identity(:, 2)) - identity(:, 3))), 0.0_wp, 0.0_wp, &
                   'the vector product of x and y is z')
  end subroutine vectors

  pure function outer(a, b) result(c)
    real(wp), intent(in) :: a(3)   !< left factor
    real(wp), intent(in) :: b(3)   !< right factor
    real(wp) :: c(3, 3)

    c = spread(a, 2, 3)*spread(b, 1, 3)
  end function outer

  !> Vectors of any size but zero, without overflow or underflow.
  subroutine unit_vectors(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(3), e(3)
    integer :: k

    do k = -290, 300, 10
      a = random_unit(random)
      e = unit(a*10.0_wp**k)
      call test%near(maxval(abs(e - a)), 0.0_wp, round_off, 'a direction of any length gives its unit vector')
      call test%near(norm2(e), 1.0_wp, round_off, 'a unit vector has length one')
    end do
    call test%near(maxval(abs(unit([0.0_wp, 0.0_wp, 0.0_wp]))), 0.0_wp, 0.0_wp, 'the unit vector of zero is zero')
    e = unit([huge(1.0_wp), huge(1.0_wp), 0.0_wp])
    call test%near(maxval(abs(e - [sqrt(0.5_wp), sqrt(0.5_wp), 0.0_wp])), 0.0_wp, round_off, &
                   'the unit vector of the longest vector is found without overflow')
  end subroutine unit_vectors

  subroutine axis_and_angle(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: e(3), angle, other, r(3, 3), a(3)
    integer :: i

    do i = 1, 100
      e = random_unit(random)
      angle = 10.0_wp*random%symmetric()
      other = 10.0_wp*random%symmetric()
      r = about_axis(e, angle)
      call test%near(maxval(abs(matmul(r, transpose(r)) - identity)), 0.0_wp, round_off, &
                     'a rotation about an axis satisfies R R^T = 1')
      call test%near(maxval(abs(cross(r(:, 1), r(:, 2)) - r(:, 3))), 0.0_wp, round_off, 'a rotation about an axis is right-handed')
      call test%near(maxval(abs(matmul(r, e) - e)), 0.0_wp, round_off, 'a rotation keeps its axis')
      call test%near(maxval(abs(r - rotation_from_quaternion([cos(0.5_wp*angle), sin(0.5_wp*angle)*e]))), 0.0_wp, &
                     round_off, 'a rotation about an axis is that of its quaternion')
      ! angles up to twenty: roundings of the sum
      call test%near(maxval(abs(matmul(r, about_axis(e, other)) - about_axis(e, angle + other))), 0.0_wp, &
                     5.0_wp*round_off, 'the angles of rotations about one axis add')
      a = random_vector(random)
      call test%near(maxval(abs(matmul(r, a) - (cos(angle)*a + sin(angle)*cross(e, a) &
                                                + (1.0_wp - cos(angle))*dot_product(e, a)*e))), 0.0_wp, round_off, &
                     'a rotation of a vector satisfies Rodrigues'' formula')
      call test%near(maxval(abs(about_z(angle) - about_axis([0.0_wp, 0.0_wp, 1.0_wp], angle))), 0.0_wp, round_off, &
                     'a rotation about z is one about the axis z')
    end do
    call test%near(maxval(abs(matmul(about_z(0.5_wp*pi), identity(:, 1)) - identity(:, 2))), 0.0_wp, round_off, &
                   'a quarter turn about z brings x to y')
  end subroutine axis_and_angle

  !> Rotation vectors of rotations from 0 to 180 degrees, close to both, and close to all angles at which formulas change.
  subroutine vector_of_rotation(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: e(3), angle, offset, phi(3)
    integer :: i, k, place

    do i = 1, 40
      e = random_unit(random)
      do place = 0, 2
        do k = -14, 0
          offset = 1.5_wp*10.0_wp**k
          angle = 0.5_wp*pi*place
          angle = merge(angle - offset, angle + offset, place == 2)
          phi = rotation_vector(about_axis(e, angle))
          call test%near(maxval(abs(phi - angle*e)), 0.0_wp, 4.0_wp*round_off, 'the rotation vector is axis times angle')
          if (place /= 1) cycle
          phi = rotation_vector(about_axis(e, angle - 2.0_wp*offset))
          if (angle < 2.0_wp*offset) phi = -phi   ! past zero the axis points the other way
          if (angle >= 2.0_wp*offset) &
            call test%near(maxval(abs(phi - (angle - 2.0_wp*offset)*e)), 0.0_wp, 4.0_wp*round_off, &
                           'the rotation vector below a right angle is axis times angle')
        end do
      end do
      phi = rotation_vector(about_axis(e, pi + 0.3_wp))
      call test%near(maxval(abs(phi + (pi - 0.3_wp)*e)), 0.0_wp, 4.0_wp*round_off, &
                     'the rotation vector beyond a half turn takes the shorter way back')
    end do
  end subroutine vector_of_rotation

  !> Small angles keep all their digits: closures are measured by them.
  subroutine vector_of_small_rotation(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: e(3), angle, phi(3)
    integer :: i, k

    do i = 1, 20
      e = random_unit(random)
      do k = -150, -3
        angle = 1.7_wp*10.0_wp**k
        phi = rotation_vector(about_axis(e, angle))
        ! the skew part is a difference of two entries that hold 1 - cos beside sin: angle/2 roundings more
        call test%is_true(maxval(abs(phi - angle*e)) <= round_off*angle, &
                          'the vector of a small rotation is right to its last digits')
      end do
    end do
    call test%near(maxval(abs(rotation_vector(identity))), 0.0_wp, 0.0_wp, 'the vector of no rotation is zero')
  end subroutine vector_of_small_rotation

  !> At 180 degrees the axis is known but for its sense.
  subroutine half_turns(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: e(3), phi(3), r(3, 3)
    integer :: i, j, k

    do i = 1, 60
      e = random_unit(random)
      if (i <= 27) then
        ! along the axes and the diagonals
        e = real([mod(i - 1, 3) - 1, mod((i - 1)/3, 3) - 1, (i - 1)/9 - 1], wp)
        if (norm2(e) < 0.5_wp) cycle
        e = e/norm2(e)
      end if
      do k = 1, 3
        do j = 1, 3
          r(j, k) = 2.0_wp*e(j)*e(k) - identity(j, k)
        end do
      end do
      phi = rotation_vector(r)
      call test%near(norm2(phi), pi, round_off, 'the vector of a half turn has the length pi')
      call test%near(min(norm2(phi - pi*e), norm2(phi + pi*e)), 0.0_wp, 4.0_wp*round_off, &
                     'the vector of a half turn lies along its axis')
    end do
  end subroutine half_turns

  !> Rotations turned into quaternions and back stay the same: random ones, and half turns about axes and diagonals, where w
  !> vanishes.
  subroutine quaternion_of_any_rotation(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: given(4), found(4)
    integer :: i

    do i = 1, 500
      given = [random%symmetric(), random_vector(random)]
      if (i <= 81) given = real([0, mod(i - 1, 3) - 1, mod((i - 1)/3, 3) - 1, mod((i - 1)/9, 3) - 1], wp)
      if (i > 27 .and. i <= 81) given(1) = real(merge(1, -1, i > 54), wp)
      if (norm2(given) < 0.1_wp) cycle
      given = given/norm2(given)
      found = quaternion(rotation_from_quaternion(given))
      call test%is_true(found(1) >= 0.0_wp, 'of two opposite quaternions the one with w >= 0 is found')
      call test%near(min(norm2(found - given), norm2(found + given)), 0.0_wp, 2.0_wp*round_off, &
                     'the quaternion of a rotation is the one that made it')
    end do
  end subroutine quaternion_of_any_rotation

  subroutine vector_of_any_rotation(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: r(3, 3), phi(3), angle
    integer :: i

    do i = 1, 1000
      r = random_rotation(random)
      phi = rotation_vector(r)
      angle = norm2(phi)
      call test%is_true(angle <= pi*(1.0_wp + epsilon(pi)), 'no rotation vector is longer than a half turn')
      call test%near(maxval(abs(about_axis(unit(phi), angle) - r)), 0.0_wp, 2.0_wp*round_off, &
                     'a rotation vector leads back to its rotation')
      call test%near(maxval(abs(rotation_vector(transpose(r)) + phi)), 0.0_wp, 4.0_wp*round_off, &
                     'the opposite rotation has the opposite vector')
    end do
  end subroutine vector_of_any_rotation

  !> The vector that turns one frame onto another is that of the turn between them, given in the axes in which both are known: for
  !> small, common and half turns, among these half turns about diagonals, which leave two axes across themselves.
  subroutine vector_between_frames(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: r_ab(3, 3), turned(3, 3), e(3), phi(3), angle
    integer :: i

    do i = 1, 600
      r_ab = random_rotation(random)
      e = random_unit(random)
      if (mod(i, 5) == 0) e = unit(real([mod(i/5, 2), 1, mod(i/10, 2)], wp))
      angle = pi*abs(random%symmetric())
      if (mod(i, 3) == 1) angle = 10.0_wp**(-8.0_wp*angle)
      if (mod(i, 3) == 2) angle = pi - 1.0e-9_wp*angle*mod(i, 2)
      turned = about_axis(e, angle)
      phi = rotation_between(r_ab, matmul(r_ab, turned))
      call test%near(norm2(phi), angle, 4.0_wp*round_off, 'the vector between two frames is as long as the angle between them')
      call test%near(maxval(abs(cross(phi, matmul(r_ab, e)))), 0.0_wp, 8.0_wp*round_off, &
                     'the vector between two frames lies along the axis of the turn between them')
      if (angle < 3.0_wp) call test%near(maxval(abs(phi - angle*matmul(r_ab, e))), 0.0_wp, 8.0_wp*round_off, &
                                         'the vector between two frames leads from the first to the second')
    end do
    call test%near(maxval(abs(rotation_between(r_ab, r_ab))), 0.0_wp, 0.0_wp, 'no turn leads from a frame to itself')
  end subroutine vector_between_frames
end module test_rotation
