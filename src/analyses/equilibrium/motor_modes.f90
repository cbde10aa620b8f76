!> Modes of a mechanism with motors: roots of M x'' + C x' + K x = G s, s' = Q x + R x' + S s, with the states s of the motors.
module mech9_motor_modes
  use mech9_kinds, only: wp
  use mech9_lapack, only: dgeev
  use mech9_singular_values, only: decompose, null_vector
  use mech9_eigenmodes, only: eigenmodes_type, add_mode, sort_modes
  implicit none
  private
  public :: find_motor_modes

  !> Singular values below this part of the largest one are zero, as are roots.
  real(wp), parameter :: round_off = 1.0e-11_wp
  !> Part of the largest singular value that counts as small for a shape.
  real(wp), parameter :: shape_round_off = 1.0e-9_wp
  !> A root that differs by less from the root of a motor belongs to this motor alone.
  real(wp), parameter :: same_root = 1.0e-12_wp
  !> Roots within this part of each other are the same.
  real(wp), parameter :: equal_roots = 1.0e-7_wp

contains

  !> Find all modes, with shapes by coordinates; a root of a motor that moves nothing has the shape zero.
  subroutine find_motor_modes(stiffness, damping, force, by_position, by_rate, by_state, modes)
    real(wp), intent(in) :: stiffness(:, :)       !< (n,n) M^-1 K
    real(wp), intent(in) :: damping(:, :)         !< (n,n) M^-1 C
    real(wp), intent(in) :: force(:, :)           !< (n,s) M^-1 G
    real(wp), intent(in) :: by_position(:, :)     !< (s,n) Q
    real(wp), intent(in) :: by_rate(:, :)         !< (s,n) R
    real(wp), intent(in) :: by_state(:)           !< (s) diagonal of S
    type(eigenmodes_type), intent(out) :: modes   !< the modes, sorted
    real(wp), allocatable :: system(:, :)
    real(wp), allocatable :: re(:), im(:), work(:)
    real(wp) :: no_left(1, 1), no_right(1, 1), largest
    complex(wp) :: shape(size(damping, 1))
    integer :: n, i, info

    n = size(damping, 1)
    allocate (modes%roots(2*n + size(by_state)), modes%shapes(n, 2*n + size(by_state)), modes%twofold(2*n + size(by_state)))
    call set_system(stiffness, damping, force, by_position, by_rate, by_state, system)
    call take_out_zeros(n, system, modes)
    allocate (re(size(system, 1)), im(size(system, 1)), work(8*size(system, 1)))
    if (size(re) > 0) call dgeev('N', 'N', size(re), system, size(re), re, im, no_left, 1, no_right, 1, work, size(work), info)
    largest = maxval([hypot(re, im), 0.0_wp])
    where (abs(re) <= round_off*largest) re = 0.0_wp
    do i = 1, size(re)
      if (im(i) < 0.0_wp) cycle
      call find_shape(cmplx(re(i), im(i), wp), shape)
      call add_mode(modes, cmplx(re(i), im(i), wp), shape, .false.)
    end do
    call sort_modes(modes)
    modes%growth = maxval(real(modes%roots(:modes%count), wp))
  contains
    !> The shape of a root: a null vector of root^2 + root C + K - G (root - S)^-1 (Q + root R).
    subroutine find_shape(root, shape)
      complex(wp), intent(in) :: root       !< the root [1/s]
      complex(wp), intent(out) :: shape(:)  !< (n) the shape
      complex(wp) :: matrix(n, n)
      integer :: j, equal

      shape = (0.0_wp, 0.0_wp)
      if (any(abs(root - by_state) <= same_root*abs(root))) return
      matrix = root*damping + stiffness
      do j = 1, n
        matrix(j, j) = matrix(j, j) + root**2
      end do
      do j = 1, size(by_state)
        matrix = matrix - matmul(force(:, j:j), by_position(j:j, :) + root*by_rate(j:j, :))/(root - by_state(j))
      end do
      equal = count(abs(modes%roots(:modes%count) - root) <= equal_roots*abs(root))
      call null_vector(matrix, 1 + equal, shape_round_off, shape)
    end subroutine find_shape
  end subroutine find_motor_modes

  !> The matrix of the first-order system for (x, x', s).
  subroutine set_system(stiffness, damping, force, by_position, by_rate, by_state, system)
    real(wp), intent(in) :: stiffness(:, :)               !< (n,n) M^-1 K
    real(wp), intent(in) :: damping(:, :)                 !< (n,n) M^-1 C
    real(wp), intent(in) :: force(:, :)                   !< (n,s) M^-1 G
    real(wp), intent(in) :: by_position(:, :)             !< (s,n) Q
    real(wp), intent(in) :: by_rate(:, :)                 !< (s,n) R
    real(wp), intent(in) :: by_state(:)                   !< (s) diagonal of S
    real(wp), allocatable, intent(out) :: system(:, :)    !< the matrix [1/s, in the units of the states]
    integer :: n, i

    n = size(damping, 1)
    allocate (system(2*n + size(by_state), 2*n + size(by_state)), source=0.0_wp)
    do i = 1, n
      system(i, n + i) = 1.0_wp
    end do
    system(n + 1:2*n, :n) = -stiffness
    system(n + 1:2*n, n + 1:2*n) = -damping
    system(n + 1:2*n, 2*n + 1:) = force
    system(2*n + 1:, :n) = by_position
    system(2*n + 1:, n + 1:2*n) = by_rate
    do i = 1, size(by_state)
      system(2*n + i, 2*n + i) = by_state(i)
    end do
  end subroutine set_system

  !> Take the roots that are zero out of a matrix: the others are those of the matrix on the complement of its null space. Double
  !> roots need a second time.
  subroutine take_out_zeros(n, system, modes)
    integer, intent(in) :: n                               !< number of free coordinates
    real(wp), allocatable, intent(inout) :: system(:, :)   !< the matrix; becomes smaller
    type(eigenmodes_type), intent(inout) :: modes          !< gets a mode for each null vector
    real(wp), allocatable :: u(:, :), v(:, :), s(:)
    integer :: round, number, m, i

    do round = 1, 2
      m = size(system, 1)
      allocate (u(m, m), v(m, m), s(m))
      call decompose(system, u, s, v)
      number = count(s <= round_off*s(1))
      do i = 1, number
        if (round == 1) call add_mode(modes, (0.0_wp, 0.0_wp), cmplx(v(:n, m - number + i), kind=wp), .false.)
        if (round == 2) modes%twofold(i) = .true.
      end do
      m = m - number
      system = matmul(transpose(v(:, :m)), matmul(system, v(:, :m)))
      deallocate (u, v, s)
      if (number == 0 .or. m == 0) exit
    end do
  end subroutine take_out_zeros
end module mech9_motor_modes
