!> Numbers that are linear in the derivatives of coordinates by all parameters, such as the openings of a chain or the shift of a
!> point, with their derivatives in time.
!>
!> The parameter is the fastest index, so that the innermost loops run over all parameters. A coordinate that no parameter changes
!> has no column.
module mech9_linear_form
  use mech9_kinds, only: wp
  implicit none
  private
  public :: linear_form_type, new_linear_form, find_values, add_sizes, solve_for, add_motion

  !> value(p,r) = fixed(p,r) + shares(r,i) of the constants of parameter p + the sum over the steps of columns(r,s)*q(p,s), and the
  !> derivatives of this sum in time.
  type :: linear_form_type
    integer :: rows = 0                                !< how many numbers
    integer :: n_given = 0                             !< steps, the first ones, whose coordinates other blocks or drives determine
    integer :: first_moving = 1                        !< rows before this one have constant columns
    integer, allocatable :: steps(:)                   !< steps whose coordinates change with some parameter
    integer, allocatable :: coordinates(:)             !< of these steps
    real(wp), allocatable :: signs(:)                  !< of these steps: 1 or -1
    integer, allocatable :: unknowns(:)                !< number of each coordinate among the unknowns of the block; 0: it is given
    real(wp), allocatable :: columns(:, :, :)          !< (rows,0:2,steps) with derivatives in time, per unit of the coordinate
    integer, allocatable :: constants(:)               !< twists by which constants change with a parameter
    real(wp), allocatable :: constant_signs(:)         !< of these twists
    integer, allocatable :: parameters(:)              !< of these twists
    real(wp), allocatable :: shares(:, :, :)           !< (rows,0:2,constants) of these twists, with their signs
    real(wp), allocatable :: fixed(:, :)               !< (P,rows) the part that does not change in time
  end type linear_form_type

  !> Binomial coefficients of derivatives of a product: (part, order).
  real(wp), parameter :: binomial(0:2, 0:2) = &
    reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 1.0_wp], [3, 3])

contains

  !> A form of some steps and constants, with room for its columns.
  pure function new_linear_form(n, rows, steps, coordinates, signs, constants, constant_signs, parameters) result(form)
    integer, intent(in) :: n                        !< number of all parameters
    integer, intent(in) :: rows                     !< how many numbers the form gives
    integer, intent(in) :: steps(:)                 !< steps
    integer, intent(in) :: coordinates(:)           !< their coordinates
    real(wp), intent(in) :: signs(:)                !< their signs
    integer, intent(in) :: constants(:)             !< numbers of twists of constants
    real(wp), intent(in) :: constant_signs(:)       !< their signs
    integer, intent(in) :: parameters(:)            !< their parameters
    type(linear_form_type) :: form

    form%rows = rows
    form%steps = steps
    form%coordinates = coordinates
    form%signs = signs
    form%constants = constants
    form%constant_signs = constant_signs
    form%parameters = parameters
    allocate (form%unknowns(size(steps)), source=0)
    allocate (form%columns(rows, 0:2, size(steps)), form%shares(rows, 0:2, size(constants)), form%fixed(n, rows), source=0.0_wp)
  end function new_linear_form

  !> The values of a form, or of its derivatives in time.
  pure subroutine find_values(form, n, m, order, whole, q, values)
    type(linear_form_type), intent(in) :: form        !< with its columns and shares
    integer, intent(in) :: n                          !< number of parameters
    integer, intent(in) :: m                          !< number of coordinates
    integer, intent(in) :: order                      !< of the derivative in time
    logical, intent(in) :: whole                      !< with the unknowns in this order, not only with those that are given
    real(wp), intent(in) :: q(n, 0:2, m)              !< derivatives of the coordinates by all parameters
    real(wp), intent(inout) :: values(n, form%rows)   !< the values
    integer :: i, j, r, p, count

    if (order == 0) then
      do r = 1, form%rows
        do p = 1, n
          values(p, r) = form%fixed(p, r)
        end do
      end do
    else
      do r = 1, form%rows
        do p = 1, n
          values(p, r) = 0.0_wp
        end do
      end do
    end if
    do i = 1, size(form%constants)
      p = form%parameters(i)
      do r = 1, form%rows
        values(p, r) = values(p, r) + form%shares(r, order, i)
      end do
    end do
    do j = 0, order
      count = size(form%steps)
      if (j == order .and. .not. whole) count = form%n_given
      if (count == 0) cycle
      call add_products(n, m, j, order - j, count, form%coordinates, form%rows, merge(form%first_moving, 1, j < order), &
                        binomial(j, order), form%columns, q, values)
    end do
  end subroutine find_values

  !> Add the products of columns in one order and derivatives of coordinates in another. Terms are added three at a time, so that the sums are
  !> read and written seldom.
  pure subroutine add_products(n, m, order, other, count, coordinates, rows, first, weight, columns, q, values)
    integer, intent(in) :: n                        !< number of parameters
    integer, intent(in) :: m                        !< number of coordinates
    integer, intent(in) :: order                    !< of the derivatives of coordinates
    integer, intent(in) :: other                    !< of the columns
    integer, intent(in) :: count                    !< number of terms
    integer, intent(in) :: coordinates(count)       !< of the terms
    integer, intent(in) :: rows                     !< how many numbers
    integer, intent(in) :: first                    !< the first of them that is not left out
    real(wp), intent(in) :: weight                  !< of all products
    real(wp), intent(in) :: columns(rows, 0:2, count)   !< factors of the coordinates
    real(wp), intent(in) :: q(n, 0:2, m)            !< derivatives of the coordinates
    real(wp), intent(inout) :: values(n, rows)      !< the sums
    real(wp) :: a, b, c
    integer :: r, t, p, i, j, k

    do r = first, rows
      do t = 1, count - 2, 3
        a = weight*columns(r, other, t)
        b = weight*columns(r, other, t + 1)
        c = weight*columns(r, other, t + 2)
        i = coordinates(t)
        j = coordinates(t + 1)
        k = coordinates(t + 2)
        do p = 1, n
          values(p, r) = values(p, r) + a*q(p, order, i) + b*q(p, order, j) + c*q(p, order, k)
        end do
      end do
      do t = count - mod(count, 3) + 1, count
        a = weight*columns(r, other, t)
        i = coordinates(t)
        do p = 1, n
          values(p, r) = values(p, r) + a*q(p, order, i)
        end do
      end do
    end do
  end subroutine add_products

  !> Add the sizes of all parts of a form's values, each counted by its largest row.
  pure subroutine add_sizes(form, n, m, q, sizes)
    type(linear_form_type), intent(in) :: form      !< with its columns and shares
    integer, intent(in) :: n                        !< number of parameters
    integer, intent(in) :: m                        !< number of coordinates
    real(wp), intent(in) :: q(n, 0:2, m)            !< derivatives of the coordinates by all parameters
    real(wp), intent(inout) :: sizes(n)             !< the sums
    real(wp) :: largest
    integer :: i, p

    do i = 1, size(form%steps)
      largest = maxval(abs(form%columns(:, 0, i)))
      do p = 1, n
        sizes(p) = sizes(p) + largest*abs(q(p, 0, form%coordinates(i)))
      end do
    end do
    do i = 1, size(form%constants)
      p = form%parameters(i)
      sizes(p) = sizes(p) + maxval(abs(form%shares(:, 0, i)))
    end do
    do p = 1, n
      sizes(p) = sizes(p) + maxval(abs(form%fixed(p, :)))
    end do
  end subroutine add_sizes

  !> The derivatives of one coordinate in one order, a combination of openings.
  pure subroutine solve_for(n, rows, solver, openings, q)
    integer, intent(in) :: n                        !< number of parameters
    integer, intent(in) :: rows                     !< number of openings
    real(wp), intent(in) :: solver(rows)            !< factors of the openings
    real(wp), intent(in) :: openings(n, rows)       !< of the block, by all parameters
    real(wp), intent(out) :: q(n)                   !< the derivatives
    real(wp) :: a, b, c
    integer :: r, p, start

    start = mod(rows, 3)
    if (start == 0) then
      a = solver(1)
      b = solver(2)
      c = solver(3)
      do p = 1, n
        q(p) = a*openings(p, 1) + b*openings(p, 2) + c*openings(p, 3)
      end do
      start = 3
    else if (start == 1) then
      a = solver(1)
      do p = 1, n
        q(p) = a*openings(p, 1)
      end do
    else
      a = solver(1)
      b = solver(2)
      do p = 1, n
        q(p) = a*openings(p, 1) + b*openings(p, 2)
      end do
    end if
    do r = start + 1, rows, 3
      a = solver(r)
      b = solver(r + 1)
      c = solver(r + 2)
      do p = 1, n
        q(p) = q(p) + a*openings(p, r) + b*openings(p, r + 1) + c*openings(p, r + 2)
      end do
    end do
  end subroutine solve_for

  !> Add the motion that one coordinate gives to a twist.
  pure subroutine add_motion(n, highest, series, q, twists)
    integer, intent(in) :: n                          !< number of parameters
    integer, intent(in) :: highest                    !< order of the highest derivative
    real(wp), intent(in) :: series(6, 0:2)            !< twist per unit of the coordinate, and its derivatives in time
    real(wp), intent(in) :: q(n, 0:2)                 !< derivatives of the coordinate by all parameters
    real(wp), intent(inout) :: twists(n, 6, 0:2)      !< the sum
    integer :: order, j, i, p

    do order = 0, highest
      do j = 0, order
        do i = 1, 6
          do p = 1, n
            twists(p, i, order) = twists(p, i, order) + binomial(j, order)*series(i, order - j)*q(p, j)
          end do
        end do
      end do
    end do
  end subroutine add_motion
end module mech9_linear_form
