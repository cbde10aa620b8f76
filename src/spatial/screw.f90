!> Screws as six numbers (w, v): angular velocity, and velocity of the point at the origin of the frame in which they are written.
module mech9_screw
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_pose, only: pose_type
  use mech9_lapack, only: dgesvd
  implicit none
  private
  public :: bracket, moved_screw, generated_algebra, orthonormal_basis, split_space

contains

  !> Lie bracket of two screws: the rate of change of the second screw when the first moves it.
  pure function bracket(a, b) result(c)
    real(wp), intent(in) :: a(6)   !< the screw that moves, in any frame
    real(wp), intent(in) :: b(6)   !< the screw that is moved, in the same frame
    real(wp) :: c(6)

    c(1:3) = cross(a(1:3), b(1:3))
    c(4:6) = cross(a(1:3), b(4:6)) - cross(b(1:3), a(4:6))
  end function bracket

  !> The screw given in frame B, written in frame A.
  pure function moved_screw(x_ab, screw_b) result(screw_a)
    type(pose_type), intent(in) :: x_ab   !< pose of B in A, translations in the unit of length of the screw
    real(wp), intent(in) :: screw_b(6)    !< the screw in B
    real(wp) :: screw_a(6)

    screw_a(1:3) = matmul(x_ab%r, screw_b(1:3))
    screw_a(4:6) = matmul(x_ab%r, screw_b(4:6)) + cross(x_ab%p, screw_a(1:3))
  end function moved_screw

  !> Orthonormal basis of the columns of `screws`; singular values below `tolerance` times the
  !> largest do not count. Lengths must be scaled to order one by the caller.
  subroutine orthonormal_basis(screws, tolerance, basis, rank)
    real(wp), intent(in) :: screws(:, :)   !< (6, n)
    real(wp), intent(in) :: tolerance      !< part of the largest singular value below which one does not count
    real(wp), intent(out) :: basis(6, 6)   !< the first `rank` columns count
    integer, intent(out) :: rank           !< dimension of the space
    real(wp) :: a(6, size(screws, 2)), s(6), vt(1, 1), work(64 + 8*size(screws, 2))
    integer :: info, n

    n = size(screws, 2)
    rank = 0
    basis = 0.0_wp
    if (n == 0) return
    a = screws
    s = 0.0_wp
    call dgesvd('A', 'N', 6, n, a, 6, s, basis, 6, vt, 1, work, size(work), info)
    rank = count(s > tolerance*max(s(1), tiny(s)))
  end subroutine orthonormal_basis

  !> Orthonormal basis of the smallest space of screws that holds the given ones and is closed under
  !> the bracket. The motion stays in it at all positions of the joints. Its dimension is 3 for planar and spherical chains,
  !> 1 to 3 for translations, 2 for cylindrical chains, 4 for planar chains with a translation across the plane, else 6.
  subroutine generated_algebra(screws, tolerance, basis, rank, most)
    real(wp), intent(in) :: screws(:, :)   !< (6, n), lengths scaled to order one
    real(wp), intent(in) :: tolerance      !< part of the largest singular value below which one does not count
    real(wp), intent(out) :: basis(6, 6)   !< the first `rank` columns count
    integer, intent(out) :: rank           !< dimension of the space
    integer, intent(in), optional :: most  !< the dimension at most; 6 unless given
    real(wp) :: extended(6, 21)
    integer :: i, j, n, before, enough

    enough = 6
    if (present(most)) enough = most
    call orthonormal_basis(screws, tolerance, basis, rank)
    do
      before = rank
      if (rank >= enough) return
      n = rank
      extended(:, 1:n) = basis(:, 1:n)
      do j = 2, before
        do i = 1, j - 1
          n = n + 1
          extended(:, n) = bracket(basis(:, i), basis(:, j))
        end do
      end do
      call orthonormal_basis(extended(:, 1:n), tolerance, basis, rank)
      if (rank == before) return
    end do
  end subroutine generated_algebra

  !> Directions about which a space of screws turns, and those along which it slides without turning. Elimination makes
  !> them as simple as possible: none has a component along the leading axis of another one.
  pure subroutine split_space(basis, turns, n_turns, slides, n_slides, screws)
    real(wp), intent(in) :: basis(:, :)     !< (6, rank), orthonormal
    real(wp), intent(out) :: turns(3, 3)    !< unit vectors of the axes of turning; the first n_turns count
    real(wp), intent(out) :: slides(3, 3)   !< unit vectors of the directions of sliding; the first n_slides count
    integer, intent(out) :: n_turns         !< number of axes of turning
    integer, intent(out) :: n_slides        !< number of directions of sliding
    logical, intent(out) :: screws          !< its only turning goes with sliding along the same direction
    real(wp), parameter :: tolerance = 1.0e-9_wp
    real(wp) :: a(6, size(basis, 2)), pivot(6)
    integer :: i, j, row, best

    a = basis
    row = 0
    n_turns = 0
    turns = 0.0_wp
    slides = 0.0_wp
    do i = 1, 6
      if (row == size(a, 2)) exit
      best = row + maxloc(abs(a(i, row + 1:)), dim=1)
      if (abs(a(i, best)) <= tolerance) cycle
      row = row + 1
      pivot = a(:, best)/a(i, best)
      a(:, best) = a(:, row)
      a(:, row) = pivot
      do j = 1, size(a, 2)
        if (j /= row) a(:, j) = a(:, j) - a(i, j)*pivot
      end do
      if (i <= 3) n_turns = row
    end do
    n_slides = row - n_turns
    do j = 1, n_turns
      turns(:, j) = a(1:3, j)/norm2(a(1:3, j))
    end do
    do j = 1, n_slides
      slides(:, j) = a(4:6, n_turns + j)/norm2(a(4:6, n_turns + j))
    end do
    ! a single slide goes along the axis, so that the turning needs none of it; two slides go across the axis
    screws = .false.
    if (n_turns == 1 .and. mod(n_slides, 2) == 0) screws = abs(dot_product(a(1:3, 1), a(4:6, 1))) > tolerance
  end subroutine split_space
end module mech9_screw
