!> Screws: brackets, change of frame, bases, and the algebras that joints generate.
module test_screw
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_differentiation, only: half_width, derivatives_from_stencil
  use mech9_rotation, only: cross, about_axis
  use mech9_pose, only: pose_type, compose, inverse
  use mech9_screw, only: bracket, moved_screw, generated_algebra, orthonormal_basis, split_space
  use mech9_random_geometry, only: random_vector, random_unit, random_pose, random_matrix
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

  !> A few roundings of numbers of order one.
  real(wp), parameter :: round_off = 1.0e-14_wp
  !> Components of directions below this are zero for the program.
  real(wp), parameter :: tolerance = 1.0e-9_wp

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('bracket_identities')) call bracket_identities(test)
    if (test%runs('change_of_frame')) call change_of_frame(test)
    if (test%runs('bracket_as_rate')) call bracket_as_rate(test)
    if (test%runs('bases')) call bases(test)
    if (test%runs('algebras')) call algebras(test)
    if (test%runs('split_spaces')) call split_spaces(test)
  end subroutine run

  function random_screw(random) result(s)
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp) :: s(6)

    s(1:3) = random_vector(random)
    s(4:6) = random_vector(random)
  end function random_screw

  !> The screw of a turn about an axis through a point, with an advance per radian.
  pure function joint(axis, point, advance) result(s)
    real(wp), intent(in) :: axis(3)    !< direction of any length
    real(wp), intent(in) :: point(3)   !< of the axis [m]
    real(wp), intent(in) :: advance    !< per radian [m]
    real(wp) :: s(6)

    s(1:3) = axis
    s(4:6) = cross(point, axis) + advance*axis
  end function joint

  pure function slide(direction) result(s)
    real(wp), intent(in) :: direction(3)   !< of any length
    real(wp) :: s(6)

    s(1:3) = 0.0_wp
    s(4:6) = direction
  end function slide

  subroutine bracket_identities(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp) :: a(6), b(6), c(6), x, y
    integer :: i

    do i = 1, 50
      a = random_screw(random)
      b = random_screw(random)
      c = random_screw(random)
      x = random%symmetric()
      y = random%symmetric()
      call test%near(maxval(abs(bracket(a, a))), 0.0_wp, round_off, 'the bracket of a screw with itself is zero')
      call test%near(maxval(abs(bracket(a, b) + bracket(b, a))), 0.0_wp, round_off, &
                     'the exchange of two screws turns the sign of their bracket')
      call test%near(maxval(abs(bracket(a, x*b + y*c) - x*bracket(a, b) - y*bracket(a, c))), 0.0_wp, round_off, &
                     'the bracket is linear')
      call test%near(maxval(abs(bracket(a, bracket(b, c)) + bracket(b, bracket(c, a)) + bracket(c, bracket(a, b)))), &
                     0.0_wp, round_off, 'the bracket satisfies Jacobi''s identity')
    end do
  end subroutine bracket_identities

  !> The velocity of a point is the same vector, whatever frame it is written in.
  subroutine change_of_frame(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    type(pose_type) :: x_ab, x_bc
    real(wp) :: a(6), b(6), point_b(3), point_a(3), velocity_b(3), velocity_a(3), in_a(6)
    integer :: i

    do i = 1, 50
      x_ab = random_pose(random)
      x_bc = random_pose(random)
      a = random_screw(random)
      b = random_screw(random)
      point_b = random_vector(random)
      point_a = x_ab%p + matmul(x_ab%r, point_b)
      velocity_b = a(4:6) + cross(a(1:3), point_b)
      in_a = moved_screw(x_ab, a)
      velocity_a = in_a(4:6) + cross(in_a(1:3), point_a)
      call test%near(maxval(abs(velocity_a - matmul(x_ab%r, velocity_b))), 0.0_wp, round_off, &
                     'a screw in another frame gives the same velocity of a point')
      call test%near(maxval(abs(moved_screw(inverse(x_ab), in_a) - a)), 0.0_wp, round_off, &
                     'a screw that is moved there and back is the same')
      call test%near(maxval(abs(moved_screw(compose(x_ab, x_bc), a) - moved_screw(x_ab, moved_screw(x_bc, a)))), 0.0_wp, &
                     round_off, 'two changes of frame are one change by the product of the poses')
      call test%near(maxval(abs(bracket(in_a, moved_screw(x_ab, b)) - moved_screw(x_ab, bracket(a, b)))), 0.0_wp, &
                     round_off, 'brackets change with their screws')
    end do
  end subroutine change_of_frame

  !> The bracket is the rate at which a motion along the first screw carries the second along.
  subroutine bracket_as_rate(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), parameter :: h = 1.0_wp/32.0_wp
    type(pose_type) :: pose
    real(wp) :: axis(3), point(3), advance, b(6), a(6), moved(6, -half_width:half_width), first, second, error, rate(6)
    real(wp) :: rate_rate(6)
    integer :: i, k

    do i = 1, 20
      axis = random_unit(random)
      point = random_vector(random)
      advance = random%symmetric()
      a = joint(axis, point, advance)
      b = random_screw(random)
      do k = -half_width, half_width
        pose%r = about_axis(axis, k*h)
        pose%p = point - matmul(pose%r, point) + advance*k*h*axis
        moved(:, k) = moved_screw(pose, b)
      end do
      rate = bracket(a, b)
      rate_rate = bracket(a, rate)
      do k = 1, 6
        call derivatives_from_stencil(moved(k, :), h, first, second, error)
        ! roundings of numbers up to three, by 2/h and 8/h^2
        call test%near(first, rate(k), 2.0e-13_wp, 'a bracket is the rate of a moving screw')
        call test%near(second, rate_rate(k), 2.0e-11_wp, 'a bracket of brackets is the second derivative of a moving screw')
      end do
    end do
  end subroutine bracket_as_rate

  subroutine check_basis(test, basis, rank, screws, why)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), intent(in) :: basis(6, 6)        !< its columns are orthonormal; only the first `rank` count
    real(wp), intent(in) :: screws(:, :)       !< screws that span the space
    integer, intent(in) :: rank                !< the rank that was found
    character(len=*), intent(in) :: why        !< the statement that is checked, printed where it is wrong
    real(wp) :: product(rank, rank)
    integer :: i

    product = matmul(transpose(basis(:, :rank)), basis(:, :rank))
    do i = 1, rank
      product(i, i) = product(i, i) - 1.0_wp
    end do
    call test%is_true(all(abs(product) <= round_off), why//': the basis is orthonormal')
    call test%is_true(within(basis, rank, screws), why//': the basis spans the screws')
  end subroutine check_basis

  !> Whether all columns are combinations of the first `rank` columns of an orthonormal basis.
  pure logical function within(basis, rank, screws)
    real(wp), intent(in) :: basis(6, 6)    !< orthonormal columns
    real(wp), intent(in) :: screws(:, :)   !< screws that are looked for in the space
    integer, intent(in) :: rank            !< number of its columns that count
    real(wp) :: outside(6, size(screws, 2))

    outside = screws - matmul(basis(:, :rank), matmul(transpose(basis(:, :rank)), screws))
    within = all(abs(outside) <= 10.0_wp*tolerance)
  end function within

  subroutine bases(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), allocatable :: screws(:, :)
    real(wp) :: basis(6, 6)
    integer :: n, r, rank

    do n = 1, 40, 3
      do r = 1, min(n, 6)
        screws = matmul(random_matrix(random, 6, r), random_matrix(random, r, n))
        call orthonormal_basis(screws, tolerance, basis, rank)
        call test%is_true(rank == r, 'screws made of fewer have the rank of these')
        call check_basis(test, basis, rank, screws, 'screws made of fewer')
      end do
    end do
    call orthonormal_basis(screws(:, 1:0), tolerance, basis, rank)
    call test%is_true(rank == 0, 'no screws span nothing')
    screws = 0.0_wp*screws
    call orthonormal_basis(screws, tolerance, basis, rank)
    call test%is_true(rank == 0, 'zero screws span nothing')
    screws = 0.0_wp*screws(:, 1:2)
    screws(1, 1) = 1.0_wp
    screws(1, 2) = 1.0_wp
    screws(5, 2) = 1.0e-6_wp
    call orthonormal_basis(screws, 1.0e-5_wp, basis, rank)
    call test%is_true(rank == 1, 'screws that differ by less than the tolerance are the same')
    call orthonormal_basis(screws, 1.0e-8_wp, basis, rank)
    call test%is_true(rank == 2, 'screws that differ by more than the tolerance are not the same')
  end subroutine bases

  !> Check the algebra of some screws, written in a random frame: its dimension, that it holds the screws,
  !> and that it is closed under the bracket.
  subroutine check_algebra(test, random, screws, dimension, why)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp), intent(in) :: screws(:, :)         !< screws that generate the algebra
    integer, intent(in) :: dimension             !< the right one
    character(len=*), intent(in) :: why          !< the statement that is checked, printed where it is wrong
    type(pose_type) :: frame
    real(wp) :: moved(6, size(screws, 2)), basis(6, 6)
    integer :: rank, i, j
    logical :: closed

    frame = random_pose(random)
    do i = 1, size(screws, 2)
      moved(:, i) = moved_screw(frame, screws(:, i))
    end do
    call generated_algebra(moved, tolerance, basis, rank)
    call test%is_true(rank == dimension, why//': the algebra has the right dimension')
    call check_basis(test, basis, rank, moved, why)
    closed = .true.
    do i = 1, rank
      do j = 1, rank
        closed = closed .and. within(basis, rank, reshape(bracket(basis(:, i), basis(:, j)), [6, 1]))
      end do
    end do
    call test%is_true(closed, why//': the algebra is closed under the bracket')
  end subroutine check_algebra

  !> The subgroups of rigid motions, from few of their joints and from many.
  subroutine algebras(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), parameter :: x(3) = [1.0_wp, 0.0_wp, 0.0_wp], y(3) = [0.0_wp, 1.0_wp, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp) :: p(3), q(3), s(3), u(3), v(3), w(3)
    integer :: i

    do i = 1, 20
      p = random_vector(random)
      q = p + cross(z, random_unit(random)) + 0.1_wp*z
      s = p + x + 2.0_wp*y
      u = random_unit(random)
      v = random_unit(random)
      w = random_unit(random)
      if (abs(dot_product(u, cross(v, w))) < 0.1_wp) cycle   ! too close to one plane
      if (norm2(q - p - 0.1_wp*z) < 0.3_wp) cycle            ! too close to one axis

      call check_algebra(test, random, reshape(joint(u, p, 0.0_wp), [6, 1]), 1, 'screws of one axis')
      call check_algebra(test, random, reshape(joint(u, p, 0.3_wp), [6, 1]), 1, 'screws of one helical axis')
      call check_algebra(test, random, reshape([joint(z, p, 0.0_wp), joint(z, q, 0.0_wp)], [6, 2]), 3, 'planar screws of two axes')
      call check_algebra(test, random, reshape([joint(z, p, 0.0_wp), joint(z, q, 0.0_wp), joint(z, s, 0.0_wp), &
                                                slide(x), slide(y)], [6, 5]), 3, 'planar screws of five joints')
      call check_algebra(test, random, reshape([joint(z, p, 0.0_wp), slide(x + y)], [6, 2]), 3, &
                         'planar screws of an axis and a slide')
      call check_algebra(test, random, reshape([joint(z, p, 0.4_wp), joint(z, q, 0.4_wp)], [6, 2]), 3, &
                         'parallel screws of one pitch')
      call check_algebra(test, random, reshape([joint(u, p, 0.0_wp), joint(v, p, 0.0_wp)], [6, 2]), 3, &
                         'spherical screws of two axes')
      call check_algebra(test, random, reshape([joint(u, p, 0.0_wp), joint(v, p, 0.0_wp), joint(w, p, 0.0_wp), &
                                                joint(u + v, p, 0.0_wp)], [6, 4]), 3, 'spherical screws of four axes')
      call check_algebra(test, random, reshape(slide(u), [6, 1]), 1, 'one translation')
      call check_algebra(test, random, reshape([slide(u), slide(v), slide(u - v)], [6, 3]), 2, 'translations in a plane')
      call check_algebra(test, random, reshape([slide(u), slide(v), slide(w), slide(x)], [6, 4]), 3, 'all translations')
      call check_algebra(test, random, reshape([joint(u, p, 0.0_wp), slide(u)], [6, 2]), 2, &
                         'cylindrical screws of an axis and a slide')
      call check_algebra(test, random, reshape([joint(u, p, 0.2_wp), joint(u, p + 2.0_wp*u, -0.1_wp), slide(u)], [6, 3]), 2, &
                         'cylindrical screws of helical axes')
      call check_algebra(test, random, reshape([joint(z, p, 0.0_wp), joint(z, q, 0.0_wp), slide(z)], [6, 3]), 4, &
                         'Schoenflies screws')
      call check_algebra(test, random, reshape([joint(z, p, 0.3_wp), joint(z, q, -0.2_wp)], [6, 2]), 4, &
                         'parallel screws of two pitches')
      call check_algebra(test, random, reshape([slide(u), slide(v), slide(w), joint(z, p, 0.1_wp)], [6, 4]), 4, &
                         'all translations and an axis')
      call check_algebra(test, random, reshape([joint(u, p, 0.0_wp), joint(v, p + w, 0.0_wp)], [6, 2]), 6, 'two skew axes')
      call check_algebra(test, random, reshape([joint(u, p, 0.0_wp), joint(v, p, 0.0_wp), slide(w)], [6, 3]), 6, &
                         'screws of two meeting axes and a translation')
      call check_algebra(test, random, reshape([joint(u, p, 0.1_wp), joint(v, q, 0.0_wp), joint(w, s, 0.0_wp)], [6, 3]), 6, &
                         'screws in general')
    end do
    call check_algebra(test, random, reshape([real(wp) ::], [6, 0]), 0, 'screws of no joints')
  end subroutine algebras

  !> Split the space of some screws, written in a random frame: how many directions there are, that the slides belong to
  !> the space, the axis where there is one, and whether it turns only by screwing.
  subroutine check_split(test, random, screws, n_turns, n_slides, by_screwing, axis, why)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of the random numbers
    real(wp), intent(in) :: screws(:, :)         !< screws that span the space
    integer, intent(in) :: n_turns               !< right number of directions of turning
    integer, intent(in) :: n_slides              !< right number of directions of sliding
    logical, intent(in) :: by_screwing           !< it turns only together with a slide
    real(wp), intent(in) :: axis(3)              !< of its only turning, a unit vector
    character(len=*), intent(in) :: why          !< the statement that is checked, printed where it is wrong
    type(pose_type) :: frame
    real(wp) :: moved(6, size(screws, 2)), basis(6, 6), turns(3, 3), slides(3, 3)
    integer :: rank, turning, sliding, i
    logical :: screwing

    frame = random_pose(random)
    do i = 1, size(screws, 2)
      moved(:, i) = moved_screw(frame, screws(:, i))
    end do
    call orthonormal_basis(moved, tolerance, basis, rank)
    call split_space(basis(:, :rank), turns, turning, slides, sliding, screwing)
    call test%is_true(turning == n_turns .and. sliding == n_slides, why//': the numbers of rotations and translations are right')
    call test%is_true(screwing .eqv. by_screwing, why//': a rotation that is tied to a translation is told from a free one')
    do i = 1, sliding
      call test%near(norm2(slides(:, i)), 1.0_wp, round_off, why//': the translations are unit vectors')
      call test%is_true(within(basis, rank, reshape(slide(slides(:, i)), [6, 1])), why//': each translation belongs to the space')
    end do
    if (turning == 1) call test%near(abs(dot_product(turns(:, 1), matmul(frame%r, axis))), 1.0_wp, 10.0_wp*tolerance, &
                                     why//': the axis is the given one')
  end subroutine check_split

  !> The directions about which the subgroups of rigid motions turn, and along which they slide.
  subroutine split_spaces(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    real(wp), parameter :: x(3) = [1.0_wp, 0.0_wp, 0.0_wp], y(3) = [0.0_wp, 1.0_wp, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp) :: p(3), basis(6, 6), turns(3, 3), slides(3, 3)
    integer :: i, rank, turning, sliding
    logical :: screwing

    do i = 1, 20
      p = random_vector(random)
      call check_split(test, random, reshape(joint(z, p, 0.0_wp), [6, 1]), 1, 0, .false., z, 'screws of one axis')
      call check_split(test, random, reshape(joint(z, p, 0.3_wp), [6, 1]), 1, 0, .true., z, 'screws of one helical axis')
      call check_split(test, random, reshape([joint(z, p, 0.3_wp), slide(z)], [6, 2]), 1, 1, .false., z, 'cylindrical screws')
      call check_split(test, random, reshape([joint(z, p, 0.0_wp), slide(x), slide(y)], [6, 3]), 1, 2, .false., z, 'planar screws')
      call check_split(test, random, reshape([joint(z, p, 0.4_wp), slide(x), slide(y)], [6, 3]), 1, 2, .true., z, &
                       'parallel screws of one pitch')
      call check_split(test, random, reshape([joint(z, p, 0.4_wp), slide(x), slide(y), slide(z)], [6, 4]), 1, 3, .false., z, &
                       'Schoenflies screws')
      call check_split(test, random, reshape([joint(x, p, 0.0_wp), joint(y, p, 0.0_wp), joint(z, p, 0.0_wp)], [6, 3]), 3, 0, &
                       .false., z, 'spherical screws')
      call check_split(test, random, reshape([slide(x + p), slide(y)], [6, 2]), 0, 2, .false., z, 'screws of two slides')
    end do
    ! as simple as can be: slides along the axes of the frame where these lie in their plane
    call orthonormal_basis(reshape([joint(z, x + 2.0_wp*y, 0.0_wp), slide(x + y), slide(x - 2.0_wp*y)], [6, 3]), tolerance, &
                           basis, rank)
    call split_space(basis(:, :rank), turns, turning, slides, sliding, screwing)
    call test%near(maxval(abs(abs(slides(:, 1)) - x)), 0.0_wp, round_off, 'the first translation of planar screws lies along x')
    call test%near(maxval(abs(abs(slides(:, 2)) - y)), 0.0_wp, round_off, 'the second translation of planar screws lies along y')
  end subroutine split_spaces
end module test_screw
