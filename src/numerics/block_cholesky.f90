!> Cholesky factors of sparse symmetric matrices of equal blocks, one block row for each node of a graph.
!>
!> The order of elimination is that of least degree: the next node is the one with the fewest neighbours left. It, and the places of
!> all blocks that elimination fills, are found once for a graph; matrices are then factorized and solved without allocation.
module mech9_block_cholesky
  use mech9_kinds, only: wp
  implicit none
  private
  public :: block_cholesky_type, new_block_cholesky, clearly_positive

  !> Least `least_part` with which corrections by the residual converge: each leaves an error of round-off over it.
  real(wp), parameter :: clearly_positive = 1.0e-12_wp

  !> A matrix, then its factors. Blocks below the diagonal are stored by columns, in the order of elimination.
  type :: block_cholesky_type
    integer :: d = 0                            !< rows of a block
    integer :: n = 0                            !< nodes
    integer, allocatable :: position(:)         !< (n) place of each node in the order of elimination
    integer, allocatable :: first(:)            !< (n+1) blocks below the diagonal of column p are first(p) .. first(p+1)-1
    integer, allocatable :: row(:)              !< (blocks) place of the node in whose row the block is, ascending in a column
    integer, allocatable :: target(:)           !< block that each product of two blocks of a column changes, column by column
    real(wp), allocatable :: diagonal(:, :, :)  !< (d,d,n) lower triangles count, in the order of elimination
    real(wp), allocatable :: blocks(:, :, :)    !< (d,d,blocks)
    real(wp), allocatable :: x(:, :)            !< (d,n) scratch
    real(wp), allocatable :: whole(:, :)        !< (d,n) scratch
    real(wp) :: least_part = 1.0_wp             !< least pivot, as a part of the number on the diagonal that it was
  contains
    procedure :: clear
    procedure :: place_of
    procedure :: find_blocks
    procedure :: factorize
    procedure :: solve
  end type block_cholesky_type

  !> A list of nodes.
  type :: list_type
    integer, allocatable :: items(:)   !< their numbers, ascending
  end type list_type

contains

  !> Room for matrices whose blocks are zero except on the diagonal and where an edge joins two nodes.
  pure function new_block_cholesky(d, n, edges) result(self)
    integer, intent(in) :: d             !< rows of a block
    integer, intent(in) :: n             !< number of nodes
    integer, intent(in) :: edges(:, :)   !< (2,edges) nodes that each joins; an edge with a node 0, or twice the same, counts nothing
    type(block_cholesky_type) :: self
    type(list_type) :: neighbours(n)
    integer :: i, a, b

    self%d = d
    self%n = n
    do i = 1, n
      allocate (neighbours(i)%items(0))
    end do
    do i = 1, size(edges, 2)
      a = edges(1, i)
      b = edges(2, i)
      if (min(a, b) == 0 .or. a == b) cycle
      neighbours(a)%items = with(neighbours(a)%items, [b])
      neighbours(b)%items = with(neighbours(b)%items, [a])
    end do
    call eliminate_nodes(neighbours, self)
    call find_targets(self)
    allocate (self%diagonal(d, d, n), self%blocks(d, d, size(self%row)), self%x(d, n), self%whole(d, n), source=0.0_wp)
  end function new_block_cholesky

  !> The order of elimination, and the columns of the factor.
  pure subroutine eliminate_nodes(neighbours, self)
    type(list_type), intent(inout) :: neighbours(:)    !< (n) of each node; changed by elimination
    type(block_cholesky_type), intent(inout) :: self   !< gets the order and the columns
    type(list_type) :: columns(size(neighbours))
    logical :: left(size(neighbours))
    integer :: degree(size(neighbours)), p, i, node

    left = .true.
    do i = 1, self%n
      degree(i) = size(neighbours(i)%items)
    end do
    allocate (self%position(self%n), self%first(self%n + 1))
    self%first(1) = 1
    do p = 1, self%n
      node = minloc(degree, 1, left)
      left(node) = .false.
      self%position(node) = p
      columns(p)%items = neighbours(node)%items
      self%first(p + 1) = self%first(p) + size(columns(p)%items)
      do i = 1, size(columns(p)%items)
        associate (other => columns(p)%items(i))
          neighbours(other)%items = with(neighbours(other)%items, columns(p)%items)
          neighbours(other)%items = pack(neighbours(other)%items, &
                                         neighbours(other)%items /= other .and. neighbours(other)%items /= node)
          degree(other) = size(neighbours(other)%items)
        end associate
      end do
    end do
    allocate (self%row(self%first(self%n + 1) - 1))
    do p = 1, self%n
      call sort(self%position(columns(p)%items), self%row(self%first(p):self%first(p + 1) - 1))
    end do
  end subroutine eliminate_nodes

  !> The blocks that elimination changes.
  pure subroutine find_targets(self)
    type(block_cholesky_type), intent(inout) :: self   !< with its columns; gets `target`
    integer :: p, i, j, n

    n = 0
    do p = 1, self%n
      n = n + (self%first(p + 1) - self%first(p))*(self%first(p + 1) - self%first(p) - 1)/2
    end do
    allocate (self%target(n))
    n = 0
    do p = 1, self%n
      do j = self%first(p), self%first(p + 1) - 1
        do i = j + 1, self%first(p + 1) - 1
          n = n + 1
          self%target(n) = block_at(self, self%row(i), self%row(j))
        end do
      end do
    end do
  end subroutine find_targets

  !> The block of a row and a column below the diagonal.
  pure integer function block_at(self, row, column) result(e)
    type(block_cholesky_type), intent(in) :: self   !< with its columns
    integer, intent(in) :: row                      !< place of a node in the order of elimination
    integer, intent(in) :: column                   !< place of a node before it

    do e = self%first(column), self%first(column + 1) - 1
      if (self%row(e) == row) return
    end do
    e = 0
  end function block_at

  !> The block of two different nodes that an edge joins. It stands for the rows of the one that is eliminated later.
  pure integer function place_of(self, a, b) result(e)
    class(block_cholesky_type), intent(in) :: self   !< the matrix
    integer, intent(in) :: a                         !< number of a node
    integer, intent(in) :: b                         !< number of another node

    e = block_at(self, max(self%position(a), self%position(b)), min(self%position(a), self%position(b)))
  end function place_of

  !> The block of each edge, and whose rows it stands for.
  pure subroutine find_blocks(self, edges, block_of, turned)
    class(block_cholesky_type), intent(in) :: self        !< the matrix
    integer, intent(in) :: edges(:, :)                    !< (2,edges) nodes that each joins
    integer, allocatable, intent(out) :: block_of(:)      !< (edges) number of the block; 0 for an edge that counts nothing
    logical, allocatable, intent(out) :: turned(:)        !< (edges) the block's rows are those of the second node
    integer :: i

    allocate (block_of(size(edges, 2)), source=0)
    allocate (turned(size(edges, 2)), source=.false.)
    do i = 1, size(edges, 2)
      associate (a => edges(1, i), b => edges(2, i))
        if (min(a, b) == 0 .or. a == b) cycle
        block_of(i) = self%place_of(a, b)
        turned(i) = self%position(b) > self%position(a)
      end associate
    end do
  end subroutine find_blocks

  !> Make the matrix zero.
  pure subroutine clear(self)
    class(block_cholesky_type), intent(inout) :: self   !< the matrix

    self%diagonal = 0.0_wp
    self%blocks = 0.0_wp
  end subroutine clear

  !> Factorize the matrix in place. `least_part` is not positive where it is not positive definite.
  pure subroutine factorize(self)
    class(block_cholesky_type), intent(inout) :: self   !< the matrix; its factors afterwards

    select case (self%d)
    case (3)
      call factorize_blocks(3, self)
    case (6)
      call factorize_blocks(6, self)
    case default
      call factorize_blocks(self%d, self)
    end select
  end subroutine factorize

  !> Factorize a matrix of blocks of a size that the compiler may know.
  pure subroutine factorize_blocks(d, self)
    integer, intent(in) :: d                            !< rows of a block
    type(block_cholesky_type), intent(inout) :: self    !< the matrix; its factors afterwards
    integer :: p, i, j, k

    self%least_part = 1.0_wp
    do p = 1, self%n
      do i = 1, d
        self%whole(i, p) = self%diagonal(i, i, p)
      end do
    end do
    k = 0
    do p = 1, self%n
      call factor_block(d, self%diagonal(1, 1, p), self%whole(1, p), self%least_part)
      if (.not. self%least_part > 0.0_wp) return
      do j = self%first(p), self%first(p + 1) - 1
        call divide_block(d, self%diagonal(1, 1, p), self%blocks(1, 1, j))
      end do
      do j = self%first(p), self%first(p + 1) - 1
        call take_square(d, self%blocks(1, 1, j), self%diagonal(1, 1, self%row(j)))
        do i = j + 1, self%first(p + 1) - 1
          k = k + 1
          call take_product(d, self%blocks(1, 1, i), self%blocks(1, 1, j), self%blocks(1, 1, self%target(k)))
        end do
      end do
    end do
  end subroutine factorize_blocks

  !> The Cholesky factor of one block, with the reciprocals of its pivots on the diagonal.
  pure subroutine factor_block(d, a, whole, least_part)
    integer, intent(in) :: d                 !< rows of the block
    real(wp), intent(inout) :: a(d, d)       !< lower triangle of the block; its factor
    real(wp), intent(in) :: whole(d)         !< its diagonal before elimination
    real(wp), intent(inout) :: least_part    !< least pivot so far, as a part of that
    integer :: i, j, k

    do j = 1, d
      if (.not. a(j, j) > 0.0_wp) then
        least_part = 0.0_wp
        return
      end if
      least_part = min(least_part, a(j, j)/whole(j))
      a(j, j) = 1.0_wp/sqrt(a(j, j))
      do i = j + 1, d
        a(i, j) = a(i, j)*a(j, j)
      end do
      do k = j + 1, d
        do i = k, d
          a(i, k) = a(i, k) - a(i, j)*a(k, j)
        end do
      end do
    end do
  end subroutine factor_block

  !> A block below the diagonal, divided by the transposed factor of its column's diagonal block.
  pure subroutine divide_block(d, c, b)
    integer, intent(in) :: d             !< rows of the blocks
    real(wp), intent(in) :: c(d, d)      !< factor of the diagonal block
    real(wp), intent(inout) :: b(d, d)   !< the block
    integer :: i, j, k

    do j = 1, d
      do k = 1, j - 1
        do i = 1, d
          b(i, j) = b(i, j) - b(i, k)*c(j, k)
        end do
      end do
      do i = 1, d
        b(i, j) = b(i, j)*c(j, j)
      end do
    end do
  end subroutine divide_block

  !> Subtract the product of a block and its transpose from the lower triangle of a block of the diagonal.
  pure subroutine take_square(d, b, a)
    integer, intent(in) :: d             !< rows of the blocks
    real(wp), intent(in) :: b(d, d)      !< the block
    real(wp), intent(inout) :: a(d, d)   !< lower triangle of the block of the diagonal
    integer :: i, j, k

    do j = 1, d
      do k = 1, d
        do i = j, d
          a(i, j) = a(i, j) - b(i, k)*b(j, k)
        end do
      end do
    end do
  end subroutine take_square

  !> Subtract the product of one block and the transpose of another from a third.
  pure subroutine take_product(d, b, c, a)
    integer, intent(in) :: d             !< rows of the blocks
    real(wp), intent(in) :: b(d, d)      !< one block
    real(wp), intent(in) :: c(d, d)      !< the other block
    real(wp), intent(inout) :: a(d, d)   !< the third
    integer :: i, j, k

    do j = 1, d
      do k = 1, d
        do i = 1, d
          a(i, j) = a(i, j) - b(i, k)*c(j, k)
        end do
      end do
    end do
  end subroutine take_product

  !> Solve for one right-hand side.
  pure subroutine solve(self, b)
    class(block_cholesky_type), intent(inout) :: self   !< the factors; scratch
    real(wp), intent(inout) :: b(:, :)                  !< (d,n) right-hand side, by nodes; the solution afterwards
    integer :: i

    do i = 1, self%n
      self%x(:, self%position(i)) = b(:, i)
    end do
    select case (self%d)
    case (3)
      call substitute(3, self)
    case (6)
      call substitute(6, self)
    case default
      call substitute(self%d, self)
    end select
    do i = 1, self%n
      b(:, i) = self%x(:, self%position(i))
    end do
  end subroutine solve

  !> Solve with factors whose blocks have a size that the compiler may know.
  pure subroutine substitute(d, self)
    integer, intent(in) :: d                            !< rows of a block
    type(block_cholesky_type), intent(inout) :: self    !< the factors, and in `x` the right-hand side; there the solution
    integer :: p, e

    do p = 1, self%n
      call solve_lower(d, self%diagonal(1, 1, p), self%x(1, p))
      do e = self%first(p), self%first(p + 1) - 1
        call take_forward(d, self%blocks(1, 1, e), self%x(1, p), self%x(1, self%row(e)))
      end do
    end do
    do p = self%n, 1, -1
      do e = self%first(p), self%first(p + 1) - 1
        call take_backward(d, self%blocks(1, 1, e), self%x(1, self%row(e)), self%x(1, p))
      end do
      call solve_upper(d, self%diagonal(1, 1, p), self%x(1, p))
    end do
  end subroutine substitute

  !> Divide a part of a right-hand side by the factor of a block of the diagonal.
  pure subroutine solve_lower(d, c, x)
    integer, intent(in) :: d           !< rows of the block
    real(wp), intent(in) :: c(d, d)    !< the factor
    real(wp), intent(inout) :: x(d)    !< the part
    integer :: i, j

    do j = 1, d
      x(j) = x(j)*c(j, j)
      do i = j + 1, d
        x(i) = x(i) - c(i, j)*x(j)
      end do
    end do
  end subroutine solve_lower

  !> Divide a part of a right-hand side by the transposed factor of a block of the diagonal.
  pure subroutine solve_upper(d, c, x)
    integer, intent(in) :: d           !< rows of the block
    real(wp), intent(in) :: c(d, d)    !< the factor
    real(wp), intent(inout) :: x(d)    !< the part
    integer :: i, j

    do j = d, 1, -1
      do i = j + 1, d
        x(j) = x(j) - c(i, j)*x(i)
      end do
      x(j) = x(j)*c(j, j)
    end do
  end subroutine solve_upper

  !> Subtract the product of a block and a part of the solution from another part of the right-hand side.
  pure subroutine take_forward(d, b, x, y)
    integer, intent(in) :: d           !< rows of the block
    real(wp), intent(in) :: b(d, d)    !< the block
    real(wp), intent(in) :: x(d)       !< the part of the solution
    real(wp), intent(inout) :: y(d)    !< the part of the right-hand side
    integer :: i, j

    do j = 1, d
      do i = 1, d
        y(i) = y(i) - b(i, j)*x(j)
      end do
    end do
  end subroutine take_forward

  !> Subtract the product of a transposed block and a part of the solution from another part of the right-hand side.
  pure subroutine take_backward(d, b, x, y)
    integer, intent(in) :: d           !< rows of the block
    real(wp), intent(in) :: b(d, d)    !< the block
    real(wp), intent(in) :: x(d)       !< the part of the solution
    real(wp), intent(inout) :: y(d)    !< the part of the right-hand side
    integer :: i, j

    do j = 1, d
      do i = 1, d
        y(j) = y(j) - b(i, j)*x(i)
      end do
    end do
  end subroutine take_backward

  !> A set of numbers with more of them.
  pure function with(numbers, more) result(union)
    integer, intent(in) :: numbers(:)   !< different numbers
    integer, intent(in) :: more(:)      !< different numbers
    integer, allocatable :: union(:)    !< both, each once
    integer :: i

    union = [numbers, pack(more, [(.not. any(numbers == more(i)), i=1, size(more))])]
  end function with

  !> Numbers in ascending order, by insertion: columns are short.
  pure subroutine sort(numbers, sorted)
    integer, intent(in) :: numbers(:)    !< different numbers
    integer, intent(out) :: sorted(:)    !< the same, ascending
    integer :: i, j

    do i = 1, size(numbers)
      j = i
      do while (j > 1)
        if (sorted(j - 1) < numbers(i)) exit
        sorted(j) = sorted(j - 1)
        j = j - 1
      end do
      sorted(j) = numbers(i)
    end do
  end subroutine sort
end module mech9_block_cholesky
