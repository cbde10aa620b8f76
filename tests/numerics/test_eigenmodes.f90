!> Eigenvalues and shapes of M x'' + C x' + K x = 0: residuals of all modes, sums of roots, zero and double roots by structure.
module test_eigenmodes
  use mech9_kinds, only: wp
  use mech9_random, only: random_type
  use mech9_eigenmodes, only: eigenmodes_type, find_eigenmodes
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(test)
    type(tester_type), intent(inout) :: test   !< selects cases and counts their checks

    if (test%runs('all_sizes')) call all_sizes(test)
    if (test%runs('zero_roots')) call zero_roots(test)
    if (test%runs('gyroscopic')) call gyroscopic(test)
    if (test%runs('finish_without_inertia')) call finish_without_inertia(test)
  end subroutine run

  subroutine all_sizes(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    type(random_type) :: random
    integer :: n

    do n = 1, 6
      call random_systems(test, random, n)
    end do
  end subroutine all_sizes

  !> Random inertia and stiffness, without and with damping. The residuals are round-off of the terms.
  subroutine random_systems(test, random, n)
    type(tester_type), intent(inout) :: test     !< counts the checks
    type(random_type), intent(inout) :: random   !< source of random numbers
    integer, intent(in) :: n                     !< order of the matrices
    real(wp), dimension(n, n) :: m, c, k, a
    type(eigenmodes_type) :: modes
    integer :: i, j

    a = reshape([(random%symmetric(), i=1, n*n)], [n, n])
    m = matmul(a, transpose(a))
    do i = 1, n
      m(i, i) = m(i, i) + 1.0_wp
    end do
    a = reshape([(random%symmetric(), i=1, n*n)], [n, n])
    k = a + transpose(a)
    c = 0.0_wp
    call find_eigenmodes(m, c, k, 1.0e-13_wp, 1.0e-13_wp, modes)
    call check_residuals(test, m, c, k, modes, 'without damping')
    do i = 1, modes%count
      call test%near(real(modes%roots(i), wp)*aimag(modes%roots(i)), 0.0_wp, 0.0_wp, 'roots are real or purely imaginary')
    end do
    c = reshape([(random%symmetric(), i=1, n*n)], [n, n])
    call find_eigenmodes(m, c, k, 1.0e-13_wp, 1.0e-13_wp, modes)
    call check_residuals(test, m, c, k, modes, 'with damping')
    j = 0
    do i = 1, modes%count
      j = j + merge(2, 1, abs(aimag(modes%roots(i))) > 0.0_wp)
    end do
    call test%is_true(j == 2*n, 'there are twice as many roots as coordinates')
  end subroutine random_systems

  !> (root^2 M + root C + K) shape is zero, and the shape is not.
  subroutine check_residuals(test, m, c, k, modes, why)
    type(tester_type), intent(inout) :: test     !< counts the checks
    real(wp), intent(in) :: m(:, :)              !< inertia
    real(wp), intent(in) :: c(:, :)              !< damping
    real(wp), intent(in) :: k(:, :)              !< stiffness
    type(eigenmodes_type), intent(in) :: modes   !< modes to be checked
    character(len=*), intent(in) :: why          !< the system
    complex(wp) :: residual(size(m, 1)), matrix(size(m, 1), size(m, 1))
    integer :: i

    do i = 1, modes%count
      matrix = modes%roots(i)**2*m + modes%roots(i)*c + k
      residual = matmul(matrix, modes%shapes(:, i))
      call test%near(maxval(abs(residual))/(maxval(abs(modes%shapes(:, i)))*(1.0_wp + abs(modes%roots(i))**2)), 0.0_wp, &
                     1.0e-11_wp, why//': each mode solves the equations')
    end do
  end subroutine check_residuals

  !> Two masses joined by spring and damper: the motion of both is a double root with one vector. With a damper on one mass it
  !> is a single root zero, beside a real one.
  subroutine zero_roots(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: joint(2, 2) = reshape([1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp], [2, 2])
    real(wp), parameter :: m(2, 2) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 3.0_wp], [2, 2])
    real(wp) :: c(2, 2)
    type(eigenmodes_type) :: modes

    c = 0.2_wp*joint
    call find_eigenmodes(m, c, 5.0_wp*joint, 1.0e-12_wp, 1.0e-12_wp, modes)
    call test%is_true(modes%count == 2 .and. modes%twofold(1), 'a double root zero, and a vibration')
    call test%near(abs(modes%roots(1)), 0.0_wp, 0.0_wp, 'zero is exact')
    call test%near(abs(modes%shapes(1, 1) - modes%shapes(2, 1))/abs(modes%shapes(1, 1)), 0.0_wp, 1.0e-13_wp, 'both move alike')
    call test%near(modes%growth, 0.0_wp, 0.0_wp, 'nothing grows')
    c(1, 1) = c(1, 1) + 0.7_wp
    call find_eigenmodes(m, c, 5.0_wp*joint, 1.0e-12_wp, 1.0e-12_wp, modes)
    call test%is_true(modes%count == 3 .and. .not. modes%twofold(1), 'a single root zero, a decay, and a vibration')
    call test%near(abs(modes%roots(1)), 0.0_wp, 0.0_wp, 'zero is exact')
  end subroutine zero_roots

  !> A spinning mass on two equal springs: whirling forwards and backwards, without growth although the matrix is not symmetric.
  subroutine gyroscopic(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: spin = 0.8_wp, unit(2, 2) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
    type(eigenmodes_type) :: modes

    call find_eigenmodes(unit, 2.0_wp*spin*reshape([0.0_wp, 1.0_wp, -1.0_wp, 0.0_wp], [2, 2]), (4.0_wp - spin**2)*unit, &
                         1.0e-12_wp, 1.0e-12_wp, modes)
    call test%is_true(modes%count == 2, 'two whirls')
    call test%near(aimag(modes%roots(1)), 2.0_wp - spin, 1.0e-13_wp, 'backwards, slower by the spin')
    call test%near(aimag(modes%roots(2)), 2.0_wp + spin, 1.0e-13_wp, 'forwards, faster by the spin')
    call test%near(modes%growth, 0.0_wp, 0.0_wp, 'nothing grows')
  end subroutine gyroscopic

  !> A coordinate that moves no mass is named.
  subroutine finish_without_inertia(test)
    type(tester_type), intent(inout) :: test   !< counts the checks
    real(wp), parameter :: m(2, 2) = reshape([1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp], [2, 2])
    type(eigenmodes_type) :: modes

    call find_eigenmodes(m, 0.0_wp*m, m, 1.0e-12_wp, 1.0e-12_wp, modes)
    call test%is_true(modes%without_inertia == 2 .and. modes%count == 0, 'the second coordinate has no inertia')
  end subroutine finish_without_inertia
end module test_eigenmodes
