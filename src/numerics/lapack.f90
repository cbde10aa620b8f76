!> Interfaces of the LAPACK routines in use, double precision.
module mech9_lapack
  use mech9_kinds, only: wp
  implicit none
  private
  public :: ilaver, dgtsv, dgbsv, dgetrf, dgetrs, dgesvd, zgesvd, dormqr, dgeqp3, dsyev, dgeev

  interface
    !> The version of the library.
    subroutine ilaver(major, minor, patch)
      integer, intent(out) :: major   !< first number of the version
      integer, intent(out) :: minor   !< second number of the version
      integer, intent(out) :: patch   !< third number of the version
    end subroutine ilaver

    !> Tridiagonal linear equations.
    subroutine dgtsv(n, nrhs, dl, d, du, b, ldb, info)
      import :: wp
      integer, intent(in) :: n               !< order of the matrix
      integer, intent(in) :: nrhs            !< number of right-hand sides
      integer, intent(in) :: ldb             !< rows of `b` in memory
      real(wp), intent(inout) :: dl(*)       !< (n-1) below the diagonal; overwritten
      real(wp), intent(inout) :: d(*)        !< (n) the diagonal; overwritten
      real(wp), intent(inout) :: du(*)       !< (n-1) above the diagonal; overwritten
      real(wp), intent(inout) :: b(ldb, *)   !< (n,nrhs) right-hand sides; the solutions afterwards
      integer, intent(out) :: info           !< 0: all is well
    end subroutine dgtsv

    !> Linear equations with a band matrix.
    subroutine dgbsv(n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
      import :: wp
      integer, intent(in) :: n                !< order of the matrix
      integer, intent(in) :: kl               !< diagonals below the main one
      integer, intent(in) :: ku               !< diagonals above it
      integer, intent(in) :: nrhs             !< number of right-hand sides
      integer, intent(in) :: ldab             !< rows of `ab` in memory, at least 2 kl + ku + 1
      integer, intent(in) :: ldb              !< rows of `b` in memory
      real(wp), intent(inout) :: ab(ldab, *)  !< the matrix: element i,j in row kl + ku + 1 + i - j of column j; overwritten
      integer, intent(out) :: ipiv(*)         !< (n) exchanges of rows
      real(wp), intent(inout) :: b(ldb, *)    !< (n,nrhs) right-hand sides; the solutions afterwards
      integer, intent(out) :: info            !< 0: all is well
    end subroutine dgbsv

    !> Singular values and vectors of a matrix.
    subroutine dgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
      import :: wp
      character, intent(in) :: jobu          !< 'A', 'S', 'O' or 'N': which left singular vectors are wanted
      character, intent(in) :: jobvt         !< 'A', 'S', 'O' or 'N': which right singular vectors are wanted
      integer, intent(in) :: m               !< number of rows
      integer, intent(in) :: n               !< number of columns
      integer, intent(in) :: lda             !< rows of `a` in memory
      integer, intent(in) :: ldu             !< rows of `u` in memory
      integer, intent(in) :: ldvt            !< rows of `vt` in memory
      integer, intent(in) :: lwork           !< size of `work`
      real(wp), intent(inout) :: a(lda, *)   !< (m,n) the matrix; overwritten
      real(wp), intent(out) :: s(*)          !< singular values, not increasing
      real(wp), intent(out) :: u(ldu, *)     !< left singular vectors in columns
      real(wp), intent(out) :: vt(ldvt, *)   !< right singular vectors in rows
      real(wp), intent(out) :: work(*)       !< scratch
      integer, intent(out) :: info           !< 0: all is well
    end subroutine dgesvd

    !> Product with the orthogonal factor of a QR factorization.
    subroutine dormqr(side, trans, m, n, k, a, lda, tau, c, ldc, work, lwork, info)
      import :: wp
      character, intent(in) :: side          !< 'L': Q stands on the left; 'R': on the right
      character, intent(in) :: trans         !< 'N': Q; 'T': its transpose
      integer, intent(in) :: m               !< rows of `c`
      integer, intent(in) :: n               !< columns of `c`
      integer, intent(in) :: k               !< number of reflections
      integer, intent(in) :: lda             !< rows of `a` in memory
      integer, intent(in) :: ldc             !< rows of `c` in memory
      integer, intent(in) :: lwork           !< size of `work`
      real(wp), intent(in) :: a(lda, *)      !< reflections, as dgeqp3 leaves them
      real(wp), intent(in) :: tau(*)         !< scales of the reflections
      real(wp), intent(inout) :: c(ldc, *)   !< (m,n) the other factor; the product afterwards
      real(wp), intent(out) :: work(*)       !< scratch
      integer, intent(out) :: info           !< 0: all is well
    end subroutine dormqr

    !> QR factorization with column pivoting.
    subroutine dgeqp3(m, n, a, lda, jpvt, tau, work, lwork, info)
      import :: wp
      integer, intent(in) :: m               !< number of rows
      integer, intent(in) :: n               !< number of columns
      integer, intent(in) :: lda             !< rows of `a` in memory
      integer, intent(in) :: lwork           !< size of `work`
      real(wp), intent(inout) :: a(lda, *)   !< (m,n) the matrix; its factors afterwards
      integer, intent(inout) :: jpvt(*)      !< (n) zeros on entry; column of the matrix at each place afterwards
      real(wp), intent(out) :: tau(*)        !< scales of the reflections
      real(wp), intent(out) :: work(*)       !< scratch
      integer, intent(out) :: info           !< 0: all is well
    end subroutine dgeqp3

    !> Triangular factors of a matrix, with row pivoting.
    subroutine dgetrf(m, n, a, lda, ipiv, info)
      import :: wp
      integer, intent(in) :: m               !< number of rows
      integer, intent(in) :: n               !< number of columns
      integer, intent(in) :: lda             !< rows of `a` in memory
      real(wp), intent(inout) :: a(lda, *)   !< (m,n) the matrix; its factors afterwards
      integer, intent(out) :: ipiv(*)        !< (m) rows that were exchanged with each one
      integer, intent(out) :: info           !< 0: all is well; above: number of a pivot that is zero
    end subroutine dgetrf

    !> Solution of linear equations by the factors of dgetrf.
    subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
      import :: wp
      character, intent(in) :: trans         !< 'N': the matrix as it is; 'T': transposed
      integer, intent(in) :: n               !< order of the matrix
      integer, intent(in) :: nrhs            !< number of right sides
      integer, intent(in) :: lda             !< rows of `a` in memory
      integer, intent(in) :: ldb             !< rows of `b` in memory
      real(wp), intent(in) :: a(lda, *)      !< (n,n) the factors
      integer, intent(in) :: ipiv(*)         !< (n) rows that were exchanged with each one
      real(wp), intent(inout) :: b(ldb, *)   !< (n,nrhs) right sides; solutions afterwards
      integer, intent(out) :: info           !< 0: all is well
    end subroutine dgetrs

    !> Eigenvalues and eigenvectors of a symmetric matrix.
    subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
      import :: wp
      character, intent(in) :: jobz          !< 'V': eigenvectors are wanted; 'N': not
      character, intent(in) :: uplo          !< 'L': the lower triangle is given; 'U': the upper one
      integer, intent(in) :: n               !< order of the matrix
      integer, intent(in) :: lda             !< rows of `a` in memory
      integer, intent(in) :: lwork           !< size of `work`
      real(wp), intent(inout) :: a(lda, *)   !< (n,n) the matrix; its eigenvectors in columns afterwards
      real(wp), intent(out) :: w(*)          !< (n) eigenvalues, not decreasing
      real(wp), intent(out) :: work(*)       !< scratch
      integer, intent(out) :: info           !< 0: all is well
    end subroutine dsyev

    !> Eigenvalues and eigenvectors of any real matrix, which is balanced first.
    subroutine dgeev(jobvl, jobvr, n, a, lda, wr, wi, vl, ldvl, vr, ldvr, work, lwork, info)
      import :: wp
      character, intent(in) :: jobvl         !< 'V': left eigenvectors are wanted; 'N': not
      character, intent(in) :: jobvr         !< 'V': right eigenvectors are wanted; 'N': not
      integer, intent(in) :: n               !< order of the matrix
      integer, intent(in) :: lda             !< rows of `a` in memory
      integer, intent(in) :: ldvl            !< rows of `vl` in memory
      integer, intent(in) :: ldvr            !< rows of `vr` in memory
      integer, intent(in) :: lwork           !< size of `work`
      real(wp), intent(inout) :: a(lda, *)   !< (n,n) the matrix; overwritten
      real(wp), intent(out) :: wr(*)         !< (n) real parts of the eigenvalues
      real(wp), intent(out) :: wi(*)         !< (n) imaginary parts, the positive one of a pair first
      real(wp), intent(out) :: vl(ldvl, *)   !< left eigenvectors in columns
      real(wp), intent(out) :: vr(ldvr, *)   !< right eigenvectors in columns
      real(wp), intent(out) :: work(*)       !< scratch
      integer, intent(out) :: info           !< 0: all is well
    end subroutine dgeev

    !> Singular values and vectors of a complex matrix.
    subroutine zgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, rwork, info)
      import :: wp
      character, intent(in) :: jobu             !< 'A', 'S', 'O' or 'N': which left singular vectors are wanted
      character, intent(in) :: jobvt            !< 'A', 'S', 'O' or 'N': which right singular vectors are wanted
      integer, intent(in) :: m                  !< number of rows
      integer, intent(in) :: n                  !< number of columns
      integer, intent(in) :: lda                !< rows of `a` in memory
      integer, intent(in) :: ldu                !< rows of `u` in memory
      integer, intent(in) :: ldvt               !< rows of `vt` in memory
      integer, intent(in) :: lwork              !< size of `work`
      complex(wp), intent(inout) :: a(lda, *)   !< (m,n) the matrix; overwritten
      real(wp), intent(out) :: s(*)             !< singular values, not increasing
      complex(wp), intent(out) :: u(ldu, *)     !< left singular vectors in columns
      complex(wp), intent(out) :: vt(ldvt, *)   !< conjugates of the right singular vectors in rows
      complex(wp), intent(out) :: work(*)       !< scratch
      real(wp), intent(out) :: rwork(*)         !< (5 min(m,n)) scratch
      integer, intent(out) :: info              !< 0: all is well
    end subroutine zgesvd
  end interface
end module mech9_lapack
