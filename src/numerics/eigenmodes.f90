!> Eigenvalues and shapes of M x'' + C x' + K x = 0.
!>
!> A vibration without damping, M and K symmetric, is a symmetric problem: its eigenvalues are purely imaginary, real, or zero, and
!> come out so exactly. All others are eigenvalues of a general matrix. Roots that are zero follow from the structure: each
!> null vector of K is a root, and one more where C makes no force along it; they are taken out before the others are found, which
!> a double root near by would disturb by the root of round-off (Tisseur and Meerbergen in docs/reference/bibliography.md).
module mech9_eigenmodes
  use mech9_kinds, only: wp
  use mech9_lapack, only: dsyev, dgeev
  use mech9_cholesky, only: cholesky_factorize
  use mech9_singular_values, only: decompose, null_vector
  implicit none
  private
  public :: eigenmodes_type, find_eigenmodes, add_mode, sort_modes

  !> One mode for each conjugate pair of roots, for each other real root, and for each null vector of K.
  type :: eigenmodes_type
    integer :: count = 0                     !< their number
    complex(wp), allocatable :: roots(:)     !< (modes) the root with positive imaginary part [1/s]
    complex(wp), allocatable :: shapes(:, :) !< (n,modes) their vectors x
    logical, allocatable :: twofold(:)       !< (modes) the root, zero, is a double root with one vector
    real(wp) :: growth = 0.0_wp              !< largest real part of a root [1/s]
    integer :: without_inertia = 0           !< a coordinate that moves no mass; then there are no modes
  end type eigenmodes_type

  !> Roots within this part of each other have shapes of their own only if the matrix has as many small singular values.
  real(wp), parameter :: equal_roots = 1.0e-7_wp
  !> Part of the largest singular value that counts as small for a shape.
  real(wp), parameter :: shape_round_off = 1.0e-9_wp
  !> Damping along a null vector of K below this part of the largest damping is none.
  real(wp), parameter :: no_damping = 1.0e-10_wp

contains

  !> Find all modes. Stiffnesses and dampings below the given round-off are zero, and K is symmetric where it differs from its
  !> transpose by less.
  subroutine find_eigenmodes(m, c, k, damping_round_off, stiffness_round_off, modes)
    real(wp), intent(in) :: m(:, :)               !< (n,n) inertia, symmetric
    real(wp), intent(in) :: c(:, :)               !< (n,n) damping
    real(wp), intent(in) :: k(:, :)               !< (n,n) stiffness
    real(wp), intent(in) :: damping_round_off     !< in the unit of `c`
    real(wp), intent(in) :: stiffness_round_off   !< in the unit of `k`
    type(eigenmodes_type), intent(out) :: modes   !< the modes, sorted
    real(wp), dimension(size(m, 1), size(m, 1)) :: lower, damping, stiffness
    integer :: n, failed_at, nullity
    logical :: is_symmetric

    n = size(m, 1)
    allocate (modes%roots(2*n), modes%shapes(n, 2*n), modes%twofold(2*n))
    lower = 0.5_wp*(m + transpose(m))
    call cholesky_factorize(n, lower, failed_at)
    modes%without_inertia = failed_at
    if (failed_at > 0 .or. n == 0) return
    stiffness = k
    is_symmetric = all(abs(k - transpose(k)) <= 2.0_wp*stiffness_round_off)
    if (is_symmetric) stiffness = 0.5_wp*(k + transpose(k))
    call clean(stiffness, stiffness_round_off, is_symmetric, nullity)
    call divide_by(lower, stiffness)
    if (is_symmetric .and. all(abs(c) <= damping_round_off)) then
      call undamped_modes(stiffness, nullity, modes)
    else
      damping = c
      call divide_by(lower, damping)
      call damped_modes(damping, stiffness, nullity, modes)
    end if
    call restore_shapes(lower, modes)
    call sort_modes(modes)
    modes%growth = maxval(real(modes%roots(:modes%count), wp))
  end subroutine find_eigenmodes

  !> Make singular values that are round-off zero, and count them. A symmetric matrix stays so.
  subroutine clean(a, round_off, is_symmetric, nullity)
    real(wp), intent(inout) :: a(:, :)      !< (n,n) the matrix
    real(wp), intent(in) :: round_off       !< singular values up to this are zero
    logical, intent(in) :: is_symmetric     !< the matrix is symmetric
    integer, intent(out) :: nullity         !< number of singular values that are zero
    real(wp) :: u(size(a, 1), size(a, 1)), v(size(a, 1), size(a, 1)), s(size(a, 1))
    integer :: i

    call decompose(a, u, s, v)
    nullity = count(s <= round_off)
    if (nullity == 0) return
    a = 0.0_wp
    do i = 1, size(s) - nullity
      a = a + s(i)*matmul(u(:, i:i), transpose(v(:, i:i)))
    end do
    if (is_symmetric) a = 0.5_wp*(a + transpose(a))
  end subroutine clean

  !> L^-1 a L^-T.
  pure subroutine divide_by(lower, a)
    real(wp), intent(in) :: lower(:, :)    !< (n,n) L in the lower triangle
    real(wp), intent(inout) :: a(:, :)     !< (n,n)
    integer :: i

    do i = 1, size(a, 1)
      a(i, :) = (a(i, :) - matmul(lower(i, :i - 1), a(:i - 1, :)))/lower(i, i)
    end do
    do i = 1, size(a, 1)
      a(:, i) = (a(:, i) - matmul(a(:, :i - 1), lower(i, :i - 1)))/lower(i, i)
    end do
  end subroutine divide_by

  !> The modes of y'' + K y = 0 with symmetric K.
  subroutine undamped_modes(stiffness, nullity, modes)
    real(wp), intent(in) :: stiffness(:, :)         !< (n,n) K
    integer, intent(in) :: nullity                  !< dimension of its null space
    type(eigenmodes_type), intent(inout) :: modes   !< gets the modes
    real(wp) :: vectors(size(stiffness, 1), size(stiffness, 1)), squares(size(stiffness, 1)), work(34*size(stiffness, 1))
    integer :: n, i, info
    logical :: is_zero(size(stiffness, 1))

    n = size(stiffness, 1)
    vectors = stiffness
    call dsyev('V', 'L', n, vectors, n, squares, work, size(work), info)
    is_zero = .false.
    do i = 1, nullity
      is_zero(minloc(abs(squares), dim=1, mask=.not. is_zero)) = .true.
    end do
    do i = 1, n
      if (is_zero(i)) then
        call add_mode(modes, (0.0_wp, 0.0_wp), cmplx(vectors(:, i), kind=wp), .true.)
      else if (squares(i) > 0.0_wp) then
        call add_mode(modes, cmplx(0.0_wp, sqrt(squares(i)), wp), cmplx(vectors(:, i), kind=wp), .false.)
      else
        call add_mode(modes, cmplx(sqrt(-squares(i)), 0.0_wp, wp), cmplx(vectors(:, i), kind=wp), .false.)
        call add_mode(modes, cmplx(-sqrt(-squares(i)), 0.0_wp, wp), cmplx(vectors(:, i), kind=wp), .false.)
      end if
    end do
  end subroutine undamped_modes

  !> The modes of y'' + C y' + K y = 0.
  subroutine damped_modes(damping, stiffness, nullity, modes)
    real(wp), intent(in) :: damping(:, :)           !< (n,n) C
    real(wp), intent(in) :: stiffness(:, :)         !< (n,n) K
    integer, intent(in) :: nullity                  !< dimension of the null space of K
    type(eigenmodes_type), intent(inout) :: modes   !< gets the modes
    real(wp), dimension(size(damping, 1), size(damping, 1)) :: u, v
    real(wp) :: s(size(damping, 1)), frequency
    real(wp), allocatable :: system(:, :)
    integer :: n, r, i

    n = size(damping, 1)
    r = n - nullity
    call decompose(stiffness, u, s, v)
    ! time is counted in units in which no root is much larger than 1
    frequency = max(maxval(abs(damping)), sqrt(maxval([s, 0.0_wp])))
    if (.not. frequency > 0.0_wp) frequency = 1.0_wp
    allocate (system(n + r, n + r), source=0.0_wp)
    system(:r, r + 1:) = transpose(v(:, :r))
    do i = 1, r
      system(r + 1:, i) = -u(:, i)*s(i)/frequency**2
    end do
    system(r + 1:, r + 1:) = -damping/frequency
    i = undamped_null_vectors(damping, u(:, r + 1:), v(:, r + 1:))
    call take_out_zeros(i, system)
    call add_zero_modes(v(:, r + 1:), i, modes)
    call add_other_modes(system, frequency, damping, stiffness, modes)
  end subroutine damped_modes

  !> The number of null vectors of K along which C makes no force that K does not balance.
  integer function undamped_null_vectors(damping, left, right) result(number)
    real(wp), intent(in) :: damping(:, :)   !< (n,n) C
    real(wp), intent(in) :: left(:, :)      !< (n,nullity) left null vectors of K
    real(wp), intent(in) :: right(:, :)     !< (n,nullity) right null vectors of K
    real(wp) :: along(size(left, 2), size(left, 2)), u(size(left, 2), size(left, 2)), v(size(left, 2), size(left, 2))
    real(wp) :: s(size(left, 2))

    number = 0
    if (size(left, 2) == 0) return
    along = matmul(transpose(left), matmul(damping, right))
    call decompose(along, u, s, v)
    number = count(s <= no_damping*maxval(abs(damping)))
  end function undamped_null_vectors

  !> Take null vectors out of a matrix: the other eigenvalues are those of the matrix on the complement of its null space.
  subroutine take_out_zeros(number, system)
    integer, intent(in) :: number                          !< dimension of the null space
    real(wp), allocatable, intent(inout) :: system(:, :)   !< the matrix; becomes smaller by `number`
    real(wp), dimension(size(system, 1), size(system, 1)) :: u, v
    real(wp) :: s(size(system, 1))
    integer :: n

    if (number == 0) return
    n = size(system, 1) - number
    call decompose(system, u, s, v)
    system = matmul(transpose(v(:, :n)), matmul(system, v(:, :n)))
  end subroutine take_out_zeros

  !> A mode of root zero for each null vector of K. The double roots among their combinations are not identified.
  subroutine add_zero_modes(vectors, number, modes)
    real(wp), intent(in) :: vectors(:, :)           !< (n,nullity) right null vectors of K
    integer, intent(in) :: number                   !< number of double roots
    type(eigenmodes_type), intent(inout) :: modes   !< gets the modes
    integer :: i

    do i = 1, size(vectors, 2)
      call add_mode(modes, (0.0_wp, 0.0_wp), cmplx(vectors(:, i), kind=wp), i <= number)
    end do
  end subroutine add_zero_modes

  !> The modes whose roots are not zero by structure.
  subroutine add_other_modes(system, frequency, damping, stiffness, modes)
    real(wp), intent(in) :: system(:, :)            !< matrix whose eigenvalues are the roots, in the unit of time
    real(wp), intent(in) :: frequency               !< one over the unit of time [1/s]
    real(wp), intent(in) :: damping(:, :)           !< (n,n) C
    real(wp), intent(in) :: stiffness(:, :)         !< (n,n) K
    type(eigenmodes_type), intent(inout) :: modes   !< gets the modes
    real(wp) :: copy(size(system, 1), size(system, 1)), re(size(system, 1)), im(size(system, 1)), no_left(1, 1), no_right(1, 1)
    real(wp) :: work(8*size(system, 1)), round_off
    complex(wp) :: shape(size(damping, 1)), root
    integer :: i, n, info

    n = size(system, 1)
    if (n == 0) return
    copy = system
    call dgeev('N', 'N', n, copy, n, re, im, no_left, 1, no_right, 1, work, size(work), info)
    round_off = 8.0_wp*n*epsilon(1.0_wp)*maxval(abs(system))
    where (abs(re) <= round_off) re = 0.0_wp
    do i = 1, n
      if (im(i) < 0.0_wp) cycle
      root = frequency*cmplx(re(i), im(i), wp)
      call find_shape(root, damping, stiffness, modes, shape)
      call add_mode(modes, root, shape, .false.)
    end do
  end subroutine add_other_modes

  !> The shape of a root: a null vector of root^2 + root C + K.
  subroutine find_shape(root, damping, stiffness, modes, shape)
    complex(wp), intent(in) :: root              !< the root [1/s]
    real(wp), intent(in) :: damping(:, :)        !< (n,n) C
    real(wp), intent(in) :: stiffness(:, :)      !< (n,n) K
    type(eigenmodes_type), intent(in) :: modes   !< modes found before
    complex(wp), intent(out) :: shape(:)         !< (n) the shape
    complex(wp) :: matrix(size(damping, 1), size(damping, 1))
    integer :: i, equal

    matrix = root*damping + stiffness
    do i = 1, size(damping, 1)
      matrix(i, i) = matrix(i, i) + root**2
    end do
    equal = count(abs(modes%roots(:modes%count) - root) <= equal_roots*abs(root))
    call null_vector(matrix, 1 + equal, shape_round_off, shape)
  end subroutine find_shape

  !> Append a mode.
  pure subroutine add_mode(modes, root, shape, twofold)
    type(eigenmodes_type), intent(inout) :: modes   !< gets one mode more
    complex(wp), intent(in) :: root                 !< its root [1/s]
    complex(wp), intent(in) :: shape(:)             !< (n) its shape
    logical, intent(in) :: twofold                  !< the root is a double one with one vector

    modes%count = modes%count + 1
    modes%roots(modes%count) = root
    modes%shapes(:, modes%count) = shape
    modes%twofold(modes%count) = twofold
  end subroutine add_mode

  !> x = L^-T y for all shapes.
  pure subroutine restore_shapes(lower, modes)
    real(wp), intent(in) :: lower(:, :)             !< (n,n) L in the lower triangle
    type(eigenmodes_type), intent(inout) :: modes   !< with shapes y; gets x
    integer :: i, j

    do j = 1, modes%count
      associate (x => modes%shapes(:, j))
        do i = size(lower, 1), 1, -1
          x(i) = (x(i) - sum(lower(i + 1:, i)*x(i + 1:)))/lower(i, i)
        end do
      end associate
    end do
  end subroutine restore_shapes

  !> Sort the modes: frequencies ascending, and real roots, whose frequency is zero, from the largest to the least.
  pure subroutine sort_modes(modes)
    type(eigenmodes_type), intent(inout) :: modes   !< to be sorted
    complex(wp) :: root, shape(size(modes%shapes, 1))
    logical :: twofold
    integer :: i, j

    do i = 2, modes%count
      root = modes%roots(i)
      shape = modes%shapes(:, i)
      twofold = modes%twofold(i)
      j = i - 1
      do while (j > 0)
        if (.not. comes_before(root, modes%roots(j))) exit
        modes%roots(j + 1) = modes%roots(j)
        modes%shapes(:, j + 1) = modes%shapes(:, j)
        modes%twofold(j + 1) = modes%twofold(j)
        j = j - 1
      end do
      modes%roots(j + 1) = root
      modes%shapes(:, j + 1) = shape
      modes%twofold(j + 1) = twofold
    end do
  end subroutine sort_modes

  !> Whether a root comes before another.
  pure logical function comes_before(a, b)
    complex(wp), intent(in) :: a   !< a root
    complex(wp), intent(in) :: b   !< another root

    comes_before = aimag(a) < aimag(b)
    if (.not. abs(aimag(a) - aimag(b)) > 0.0_wp) comes_before = real(a, wp) > real(b, wp)
  end function comes_before
end module mech9_eigenmodes
