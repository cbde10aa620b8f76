!> Numbers that are linear in the derivatives of coordinates by all parameters, such as the openings of a chain or the shift of a
!> point, with their derivatives in time.
!>
!> The parameter is the fastest index, so that the innermost loops run over all parameters. A coordinate that no parameter changes
!> has no column.
module mech9_linear_form
  use mech9_kinds, only: wp
  implicit none
  private
  public :: linear_form_type, new_linear_form, put_constant, find_values, add_sizes, solve_for, add_motion

  !> value(p,r) = of_constants(p,r) + the sum over the steps of columns(r,s)*q(p,s), and the derivatives of this sum in time.
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
    real(wp), allocatable :: constant_sizes(:)         !< (P) sums of the sizes of these twists, by their parameters
    logical, allocatable :: is_first(:)                !< the twist is the first one of its parameter
    logical, allocatable :: keeps(:)                   !< the share of the twist and of its parameter's others never changes
    logical :: is_filled = .false.                     !< the shares have been found once
    real(wp), allocatable :: of_constants(:, :, :)     !< (P,rows,0:2) sums of these twists by their parameters, with their signs
  end type linear_form_type

  !> Binomial coefficients of derivatives of a product: (part, order).
  real(wp), parameter :: binomial(0:2, 0:2) = &
    reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 1.0_wp], [3, 3])

contains

  !> A form of some steps and constants, with room for its columns.
  pure function new_linear_form(n, rows, steps, coordinates, signs, constants, constant_signs, parameters) result(form)
    integer, intent(in) :: n                        !< number of all parameters
    integer, intent(in) :: rows                     !< how many numbers the form gives
    integer, intent(in) :: steps(:)                 !< numbers of its steps
    integer, intent(in) :: coordinates(:)           !< their coordinates
    real(wp), intent(in) :: signs(:)                !< their signs
    integer, intent(in) :: constants(:)             !< numbers of twists of constants
    real(wp), intent(in) :: constant_signs(:)       !< their signs
    integer, intent(in) :: parameters(:)            !< their parameters
    type(linear_form_type) :: form
    integer :: i

    form%rows = rows
    form%steps = steps
    form%coordinates = coordinates
    form%signs = signs
    form%constants = constants
    form%constant_signs = constant_signs
    form%parameters = parameters
    form%is_first = [(all(parameters(:i - 1) /= parameters(i)), i=1, size(parameters))]
    allocate (form%unknowns(size(steps)), source=0)
    allocate (form%keeps(size(constants)), source=.false.)
    allocate (form%columns(rows, 0:2, size(steps)), form%of_constants(n, rows, 0:2), form%constant_sizes(n), &
              source=0.0_wp)
  end function new_linear_form

  !> Put the share of a constant in its place, or add it to that of an earlier constant of the same parameter.
  pure subroutine put_constant(form, i, highest, share)
    type(linear_form_type), intent(inout) :: form   !< gets the share
    integer, intent(in) :: i                        !< number of the constant in the form; in ascending order
    integer, intent(in) :: highest                  !< order of the highest derivative in time
    real(wp), intent(in) :: share(form%rows, 0:2)   !< addition of the constant to the values

    call put_share(size(form%of_constants, 1), form%rows, form%parameters(i), form%is_first(i), highest, share, form%of_constants)
  end subroutine put_constant

  !> The same with arrays of known shape, so that the compiler keeps their addresses in registers.
  pure subroutine put_share(n, rows, p, is_first, highest, share, sums)
    integer, intent(in) :: n                           !< number of parameters
    integer, intent(in) :: rows                        !< number of rows
    integer, intent(in) :: p                           !< number of the parameter
    logical, intent(in) :: is_first                    !< its other shares are overwritten
    integer, intent(in) :: highest                     !< order of the highest derivative in time
    real(wp), intent(in) :: share(rows, 0:2)           !< addition to the values
    real(wp), intent(inout) :: sums(n, rows, 0:2)      !< gets the share
    integer :: order, r

    if (is_first) then
      do order = 0, highest
        do r = 1, rows
          sums(p, r, order) = share(r, order)
        end do
      end do
    else
      do order = 0, highest
        do r = 1, rows
          sums(p, r, order) = sums(p, r, order) + share(r, order)
        end do
      end do
    end if
  end subroutine put_share

  !> The values of a form, or of its derivatives in time. Products are added three at a time to three rows at a time, so that numbers
  !> are read and written seldom.
  pure subroutine find_values(form, n, m, order, whole, q, values)
    type(linear_form_type), intent(in) :: form        !< with its columns and its part of constants
    integer, intent(in) :: n                          !< number of parameters
    integer, intent(in) :: m                          !< number of coordinates
    integer, intent(in) :: order                      !< of the derivative in time
    logical, intent(in) :: whole                      !< with the unknowns in this order, not only with those that are given
    real(wp), intent(in) :: q(n, 3*m)                 !< derivatives of the coordinates, each with two derivatives in time
    real(wp), intent(inout) :: values(n, form%rows)   !< the values
    integer :: first, own

    call copy(n*form%rows, form%of_constants(1, 1, order), values)
    own = form%n_given
    if (whole) own = size(form%steps)
    first = 1
    if (order > 0 .and. own == 0) first = form%first_moving
    if (size(form%steps) > 0) call add_steps(n, m, form%rows, first, order, size(form%steps), own, form%coordinates, &
                                             form%columns, q, values)
  end subroutine find_values

  !> Add the products of all steps. The arrays have known shapes, so that the compiler keeps their addresses in registers.
  pure subroutine add_steps(n, m, rows, first, order, count, own, coordinates, factors_of, q, values)
    integer, intent(in) :: n                               !< number of parameters
    integer, intent(in) :: m                               !< number of coordinates
    integer, intent(in) :: rows                            !< number of all rows
    integer, intent(in) :: first                           !< first of the rows that is not left out
    integer, intent(in) :: order                           !< of the derivative in time
    integer, intent(in) :: count                           !< number of steps
    integer, intent(in) :: own                             !< number of steps whose coordinates count in this order itself
    integer, intent(in) :: coordinates(count)              !< of the steps
    real(wp), intent(in) :: factors_of(rows, 0:2, count)   !< columns of the steps
    real(wp), intent(in) :: q(n, 3*m)                      !< derivatives of the coordinates
    real(wp), intent(inout) :: values(n, rows)             !< the sums
    real(wp) :: factors(3, 3), weight
    integer :: columns(3), row, terms, i, j, r, last

    do row = first, rows, 3
      last = min(3, rows - row + 1)
      terms = 0
      do j = 0, order
        weight = binomial(j, order)
        do i = 1, merge(own, count, j == order)
          terms = terms + 1
          do r = 1, last
            factors(terms, r) = weight*factors_of(row + r - 1, order - j, i)
          end do
          columns(terms) = 3*coordinates(i) - 2 + j
          if (terms < 3) cycle
          call add_terms(n, m, rows, row, factors, columns, q, values)
          terms = 0
        end do
      end do
      if (terms == 0) cycle
      do j = terms + 1, 3
        factors(j, :) = 0.0_wp
        columns(j) = columns(1)
      end do
      call add_terms(n, m, rows, row, factors, columns, q, values)
    end do
  end subroutine add_steps

  !> Add three products to each of up to three rows.
  pure subroutine add_terms(n, m, rows, row, factors, columns, q, values)
    integer, intent(in) :: n                      !< number of parameters
    integer, intent(in) :: m                      !< number of coordinates
    integer, intent(in) :: rows                   !< number of all rows
    integer, intent(in) :: row                    !< the first of the rows
    real(wp), intent(in) :: factors(3, 3)         !< (terms,rows)
    integer, intent(in) :: columns(3)             !< columns of `q` that are multiplied
    real(wp), intent(in) :: q(n, 3*m)             !< derivatives of the coordinates
    real(wp), intent(inout) :: values(n, rows)    !< the sums

    associate (a => columns(1), b => columns(2), c => columns(3))
      select case (rows - row)
      case (0)
        call add_to_one(n, factors, q(1, a), q(1, b), q(1, c), values(1, row))
      case (1)
        call add_to_two(n, factors, q(1, a), q(1, b), q(1, c), values(1, row))
      case default
        call add_to_three(n, 3, factors, q(1, a), q(1, b), q(1, c), values(1, row), values(1, row + 1), values(1, row + 2))
      end select
    end associate
  end subroutine add_terms

  !> Copy numbers.
  pure subroutine copy(n, from, to)
    integer, intent(in) :: n            !< how many
    real(wp), intent(in) :: from(n)     !< the numbers
    real(wp), intent(inout) :: to(n)    !< gets them
    integer :: i

    do i = 1, n
      to(i) = from(i)
    end do
  end subroutine copy

  !> x = x + three products.
  pure subroutine add_to_one(n, f, a, b, c, x)
    integer, intent(in) :: n               !< number of parameters
    real(wp), intent(in) :: f(3)           !< factors
    real(wp), intent(in) :: a(n)           !< first numbers
    real(wp), intent(in) :: b(n)           !< second numbers
    real(wp), intent(in) :: c(n)           !< third numbers
    real(wp), intent(inout) :: x(n)        !< the sum
    integer :: p

    do p = 1, n
      x(p) = x(p) + f(1)*a(p) + f(2)*b(p) + f(3)*c(p)
    end do
  end subroutine add_to_one

  !> The same in two rows.
  pure subroutine add_to_two(n, f, a, b, c, x)
    integer, intent(in) :: n               !< number of parameters
    real(wp), intent(in) :: f(3, 3)        !< factors, two columns of three
    real(wp), intent(in) :: a(n)           !< first numbers
    real(wp), intent(in) :: b(n)           !< second numbers
    real(wp), intent(in) :: c(n)           !< third numbers
    real(wp), intent(inout) :: x(n, 2)     !< the sums
    integer :: p

    do p = 1, n
      x(p, 1) = x(p, 1) + f(1, 1)*a(p) + f(2, 1)*b(p) + f(3, 1)*c(p)
      x(p, 2) = x(p, 2) + f(1, 2)*a(p) + f(2, 2)*b(p) + f(3, 2)*c(p)
    end do
  end subroutine add_to_two

  !> The same in three rows.
  pure subroutine add_to_three(n, lead, f, a, b, c, x, y, z)
    integer, intent(in) :: n               !< number of parameters
    integer, intent(in) :: lead            !< number of rows in which the factors stand
    real(wp), intent(in) :: f(lead, *)     !< factors, a column for each sum; the first three rows are used
    real(wp), intent(in) :: a(n)           !< first numbers
    real(wp), intent(in) :: b(n)           !< second numbers
    real(wp), intent(in) :: c(n)           !< third numbers
    real(wp), intent(inout) :: x(n)        !< first sum
    real(wp), intent(inout) :: y(n)        !< second sum
    real(wp), intent(inout) :: z(n)        !< third sum
    integer :: p

    do p = 1, n
      x(p) = x(p) + f(1, 1)*a(p) + f(2, 1)*b(p) + f(3, 1)*c(p)
      y(p) = y(p) + f(1, 2)*a(p) + f(2, 2)*b(p) + f(3, 2)*c(p)
      z(p) = z(p) + f(1, 3)*a(p) + f(2, 3)*b(p) + f(3, 3)*c(p)
    end do
  end subroutine add_to_three

  !> Three products instead of sums, in three rows.
  pure subroutine set_three(n, lead, f, a, b, c, x, y, z)
    integer, intent(in) :: n               !< number of parameters
    integer, intent(in) :: lead            !< number of rows in which the factors stand
    real(wp), intent(in) :: f(lead, *)     !< factors, a column for each sum; the first three rows are used
    real(wp), intent(in) :: a(n)           !< first numbers
    real(wp), intent(in) :: b(n)           !< second numbers
    real(wp), intent(in) :: c(n)           !< third numbers
    real(wp), intent(inout) :: x(n)        !< first sum of products
    real(wp), intent(inout) :: y(n)        !< second sum of products
    real(wp), intent(inout) :: z(n)        !< third sum of products
    integer :: p

    do p = 1, n
      x(p) = f(1, 1)*a(p) + f(2, 1)*b(p) + f(3, 1)*c(p)
      y(p) = f(1, 2)*a(p) + f(2, 2)*b(p) + f(3, 2)*c(p)
      z(p) = f(1, 3)*a(p) + f(2, 3)*b(p) + f(3, 3)*c(p)
    end do
  end subroutine set_three

  !> The derivatives of unknowns in one order, combinations of openings.
  pure subroutine solve_for(n, m, unknowns, rows, solver, openings, columns, q)
    integer, intent(in) :: n                          !< number of parameters
    integer, intent(in) :: m                          !< number of coordinates
    integer, intent(in) :: unknowns                   !< number of unknowns
    integer, intent(in) :: rows                       !< number of openings, a multiple of three
    real(wp), intent(in) :: solver(rows, unknowns)    !< factors of the openings
    real(wp), intent(in) :: openings(n, rows)         !< of the block, by all parameters
    integer, intent(in) :: columns(unknowns)          !< columns of `q` that are solved for
    real(wp), intent(inout) :: q(n, 3*m)              !< derivatives of the coordinates
    integer :: u, r, p

    if (unknowns == 3 .and. rows == 3) then
      call set_three(n, rows, solver, openings(1, 1), openings(1, 2), openings(1, 3), q(1, columns(1)), q(1, columns(2)), &
                     q(1, columns(3)))
      return
    end if
    do u = 1, unknowns - 2, 3
      call set_three(n, rows, solver(1, u), openings(1, 1), openings(1, 2), openings(1, 3), q(1, columns(u)), &
                     q(1, columns(u + 1)), q(1, columns(u + 2)))
      do r = 4, rows, 3
        call add_to_three(n, rows, solver(r, u), openings(1, r), openings(1, r + 1), openings(1, r + 2), q(1, columns(u)), &
                          q(1, columns(u + 1)), q(1, columns(u + 2)))
      end do
    end do
    do u = 3*(unknowns/3) + 1, unknowns
      do p = 1, n
        q(p, columns(u)) = 0.0_wp
      end do
      do r = 1, rows, 3
        call add_to_one(n, solver(r, u), openings(1, r), openings(1, r + 1), openings(1, r + 2), q(1, columns(u)))
      end do
    end do
  end subroutine solve_for

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
    do p = 1, n
      sizes(p) = sizes(p) + form%constant_sizes(p)
    end do
  end subroutine add_sizes

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
