!> Numbers that are linear in the derivatives of coordinates by all parameters, such as the openings of a chain or the shift of a
!> point, with their derivatives in time, at several positions of a motion at once.
!>
!> The position is the fastest index. All that the parameters decide, such as which of them changes which coordinate, is decided once
!> for all positions: a product of zero is never formed.
module mech9_linear_form
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size, sum_three, add_three_to, add_to
  implicit none
  private
  public :: linear_form_type, new_linear_form, put_share, keep_double, find_values, find_sizes, solve_for

  !> For each parameter p, value(r) = share(r,p) + the sum over the steps of columns(r,s)*q(p,s), and the derivatives of this sum in time.
  type :: linear_form_type
    integer :: rows = 0                                !< how many numbers
    integer :: n_given = 0                             !< steps, the first ones, whose coordinates other blocks or drives determine
    integer :: first_moving = 1                        !< rows before this one have constant columns
    integer, allocatable :: steps(:)                   !< steps whose coordinates change with some parameter
    integer, allocatable :: coordinates(:)             !< of these steps
    real(wp), allocatable :: signs(:)                  !< of these steps: 1 or -1
    integer, allocatable :: unknowns(:)                !< number of each coordinate among the unknowns of the block; 0: it is given
    !> (batch,rows,0:3,steps) per unit of the coordinate, their derivatives in time, and twice the first one.
    real(wp), allocatable :: columns(:, :, :, :)
    integer, allocatable :: constants(:)               !< twists by which constants change with a parameter
    real(wp), allocatable :: constant_signs(:)         !< of these twists
    integer, allocatable :: parameters(:)              !< of these twists
    real(wp), allocatable :: constant_sizes(:)         !< (P) sums of the sizes of these twists, by their parameters
    logical, allocatable :: is_first(:)                !< the twist is the first one of its parameter
    logical, allocatable :: keeps(:)                   !< the share of the twist and of its parameter's others never changes
    logical :: is_filled = .false.                     !< the shares have been found once, those that never change for a whole batch
    integer, allocatable :: slots(:)                   !< (P) number of each parameter's share of constants; 0: it has none
    real(wp), allocatable :: shares(:, :, :, :)        !< (batch,rows,0:2,slots) sums of twists with their signs
    logical, allocatable :: is_changed(:)              !< (P) the parameter changes some of the numbers
    logical, allocatable :: is_still(:)                !< (P) it changes them by what never changes itself
  end type linear_form_type

contains

  !> A form of some steps and constants, with room for its columns.
  pure function new_linear_form(rows, steps, coordinates, signs, constants, constant_signs, parameters, touched, varies) &
    result(form)
    integer, intent(in) :: rows                     !< how many numbers the form gives
    integer, intent(in) :: steps(:)                 !< numbers of its steps
    integer, intent(in) :: coordinates(:)           !< their coordinates
    real(wp), intent(in) :: signs(:)                !< their signs
    integer, intent(in) :: constants(:)             !< numbers of twists of constants
    real(wp), intent(in) :: constant_signs(:)       !< their signs
    integer, intent(in) :: parameters(:)            !< their parameters
    logical, intent(in) :: touched(:, :)            !< (M,P) coordinates that change with each parameter
    logical, intent(in) :: varies(:)                !< (P) parameters that have a share besides these twists
    type(linear_form_type) :: form
    integer :: i, p

    form%rows = rows
    form%steps = steps
    form%coordinates = coordinates
    form%signs = signs
    form%constants = constants
    form%constant_signs = constant_signs
    form%parameters = parameters
    form%is_first = [(all(parameters(:i - 1) /= parameters(i)), i=1, size(parameters))]
    allocate (form%unknowns(size(steps)), form%slots(size(varies)), source=0)
    allocate (form%keeps(size(constants)), form%is_still(size(varies)), source=.false.)
    form%is_changed = varies
    do p = 1, size(varies)
      if (varies(p) .or. any(parameters == p)) form%slots(p) = maxval(form%slots) + 1
      form%is_changed(p) = form%slots(p) > 0 .or. any(touched(coordinates, p))
    end do
    allocate (form%columns(batch_size, rows, 0:3, size(steps)), form%shares(batch_size, rows, 0:2, maxval(form%slots)), &
              form%constant_sizes(size(varies)), source=0.0_wp)
  end function new_linear_form

  !> Put the share of a constant at one position in its place, or add it to that of an earlier constant of the same parameter.
  pure subroutine put_share(form, i, position, highest, share)
    type(linear_form_type), intent(inout) :: form   !< gets the share
    integer, intent(in) :: i                        !< number of the constant in the form; in ascending order
    integer, intent(in) :: position                 !< number of the position in the batch
    integer, intent(in) :: highest                  !< order of the highest derivative in time
    real(wp), intent(in) :: share(form%rows, 0:2)   !< addition of the constant to the values
    integer :: order

    associate (sums => form%shares(position, :, :, form%slots(form%parameters(i))))
      do order = 0, highest
        if (form%is_first(i)) then
          sums(:, 1 + order) = share(:, order)
        else
          sums(:, 1 + order) = sums(:, 1 + order) + share(:, order)
        end if
      end do
    end associate
  end subroutine put_share

  !> Keep twice the first derivatives of the columns, as the second derivatives of the values take them.
  pure subroutine keep_double(form, n)
    type(linear_form_type), intent(inout) :: form   !< with its columns
    integer, intent(in) :: n                        !< number of positions
    integer :: i, r, j

    do j = 1, size(form%steps)
      do r = form%first_moving, form%rows
        do i = 1, n
          form%columns(i, r, 3, j) = 2.0_wp*form%columns(i, r, 1, j)
        end do
      end do
    end do
  end subroutine keep_double

  !> The values of a form by one parameter, or those of its derivatives in time.
  pure subroutine find_values(form, n, p, m, order, whole, touched, q, values)
    type(linear_form_type), intent(in) :: form                    !< with its columns and shares
    integer, intent(in) :: n                                      !< number of positions
    integer, intent(in) :: p                                      !< number of the parameter
    integer, intent(in) :: m                                      !< number of coordinates
    integer, intent(in) :: order                                  !< of the derivative in time
    logical, intent(in) :: whole                                  !< with the unknowns in this order, not only with those that are given
    logical, intent(in) :: touched(m)                             !< coordinates that change with the parameter
    real(wp), intent(in) :: q(batch_size, 0:2, m)                 !< derivatives of the coordinates, each with two derivatives in time
    real(wp), intent(inout) :: values(batch_size, form%rows)      !< the values
    integer :: n_counted

    if (form%slots(p) > 0) then
      call copy(n, form%rows, form%shares(1, 1, order, form%slots(p)), values)
    else
      call set_zero(n, form%rows, values)
    end if
    n_counted = form%n_given
    if (whole) n_counted = size(form%steps)
    if (size(form%steps) > 0) call add_steps(n, m, form%rows, form%first_moving, order, size(form%steps), n_counted, &
                                             form%coordinates, touched, form%columns, q, values)
  end subroutine find_values

  !> Add the products of all steps, three at a time.
  pure subroutine add_steps(n, m, rows, first_moving, order, count, n_counted, coordinates, touched, columns, q, values)
    integer, intent(in) :: n                                            !< number of positions
    integer, intent(in) :: m                                            !< number of coordinates
    integer, intent(in) :: rows                                         !< number of all rows
    integer, intent(in) :: first_moving                                 !< rows before this one have constant columns
    integer, intent(in) :: order                                        !< of the derivative in time
    integer, intent(in) :: count                                        !< number of steps
    integer, intent(in) :: n_counted                                    !< number of steps whose coordinates count in this order itself
    integer, intent(in) :: coordinates(count)                           !< of the steps
    logical, intent(in) :: touched(m)                                   !< coordinates that change with the parameter
    real(wp), intent(in) :: columns(batch_size, rows, 0:3, count)       !< of the steps
    real(wp), intent(in) :: q(batch_size, 0:2, m)                       !< derivatives of the coordinates
    real(wp), intent(inout) :: values(batch_size, rows)                 !< the sums
    integer :: steps(3), kinds(3), orders(3), j, i, terms, kind_of, first

    terms = 0
    first = first_moving
    do j = 0, order
      kind_of = order - j
      if (order == 2 .and. j == 1) kind_of = 3
      if (kind_of == 0 .and. first > 1) then
        call add_rest(n, m, rows, first, count, terms, steps, kinds, orders, coordinates, columns, q, values)
        terms = 0
        first = 1
      end if
      do i = 1, merge(n_counted, count, j == order)
        if (.not. touched(coordinates(i))) cycle
        terms = terms + 1
        steps(terms) = i
        kinds(terms) = kind_of
        orders(terms) = j
        if (terms < 3) cycle
        call add_three_to(n, rows - first + 1, columns(1, first, kinds(1), steps(1)), columns(1, first, kinds(2), steps(2)), &
                          columns(1, first, kind_of, i), q(1, orders(1), coordinates(steps(1))), &
                          q(1, orders(2), coordinates(steps(2))), q(1, j, coordinates(i)), values(1, first))
        terms = 0
      end do
    end do
    call add_rest(n, m, rows, first, count, terms, steps, kinds, orders, coordinates, columns, q, values)
  end subroutine add_steps

  !> Add the products that are left, fewer than three.
  pure subroutine add_rest(n, m, rows, first, count, terms, steps, kinds, orders, coordinates, columns, q, values)
    integer, intent(in) :: n                                            !< number of positions
    integer, intent(in) :: m                                            !< number of coordinates
    integer, intent(in) :: rows                                         !< number of all rows
    integer, intent(in) :: first                                        !< first of the rows that change
    integer, intent(in) :: count                                        !< number of all steps
    integer, intent(in) :: terms                                        !< number of products
    integer, intent(in) :: steps(3)                                     !< number of the step of each among all
    integer, intent(in) :: kinds(3)                                     !< kind of its column
    integer, intent(in) :: orders(3)                                    !< of the derivative of its coordinate
    integer, intent(in) :: coordinates(count)                           !< of all steps
    real(wp), intent(in) :: columns(batch_size, rows, 0:3, count)       !< of all steps
    real(wp), intent(in) :: q(batch_size, 0:2, m)                       !< derivatives of the coordinates
    real(wp), intent(inout) :: values(batch_size, rows)                 !< the sums
    integer :: t

    do t = 1, terms
      call add_to(n, rows - first + 1, columns(1, first, kinds(t), steps(t)), q(1, orders(t), coordinates(steps(t))), &
                  values(1, first))
    end do
  end subroutine add_rest

  !> Copy some rows of numbers.
  pure subroutine copy(n, rows, from, to)
    integer, intent(in) :: n                          !< number of positions
    integer, intent(in) :: rows                       !< number of rows
    real(wp), intent(in) :: from(batch_size, rows)    !< the numbers
    real(wp), intent(inout) :: to(batch_size, rows)   !< gets them
    integer :: i, r

    do r = 1, rows
      do i = 1, n
        to(i, r) = from(i, r)
      end do
    end do
  end subroutine copy

  !> Set some rows of numbers to zero.
  pure subroutine set_zero(n, rows, numbers)
    integer, intent(in) :: n                               !< number of positions
    integer, intent(in) :: rows                            !< number of rows
    real(wp), intent(inout) :: numbers(batch_size, rows)   !< the numbers
    integer :: i, r

    do r = 1, rows
      do i = 1, n
        numbers(i, r) = 0.0_wp
      end do
    end do
  end subroutine set_zero

  !> The derivatives of unknowns by one parameter in one order, combinations of openings.
  pure subroutine solve_for(n, unknowns, rows, solver, openings, order, m, coordinates, q)
    integer, intent(in) :: n                                           !< number of positions
    integer, intent(in) :: unknowns                                    !< number of unknowns
    integer, intent(in) :: rows                                        !< number of openings, a multiple of three
    real(wp), intent(in) :: solver(batch_size, unknowns, rows)         !< factors of the openings
    real(wp), intent(in) :: openings(batch_size, rows)                 !< of the block, by the parameter
    integer, intent(in) :: order                                       !< of the derivative in time
    integer, intent(in) :: m                                           !< number of coordinates
    integer, intent(in) :: coordinates(unknowns)                       !< the unknowns
    real(wp), intent(inout) :: q(batch_size, 0:2, m)                   !< derivatives of the coordinates; gets the unknowns
    integer :: u, r

    do u = 1, unknowns - 2, 3
      associate (i => coordinates(u), j => coordinates(u + 1), k => coordinates(u + 2))
        do r = 1, rows, 3
          call sum_three(n, r == 1, solver(1, u, r), solver(1, u, r + 1), solver(1, u, r + 2), openings(1, r), openings(1, r + 1), &
                         openings(1, r + 2), q(1, order, i), q(1, order, j), q(1, order, k))
        end do
      end associate
    end do
    do u = 3*(unknowns/3) + 1, unknowns
      call set_zero(n, 1, q(1, order, coordinates(u)))
      do r = 1, rows, 3
        call add_three_to(n, 1, solver(1, u, r), solver(1, u, r + 1), solver(1, u, r + 2), openings(1, r), openings(1, r + 1), &
                          openings(1, r + 2), q(1, order, coordinates(u)))
      end do
    end do
  end subroutine solve_for

  !> The sizes of all parts of a form's values by one parameter, each counted by its largest row.
  pure subroutine find_sizes(form, n, p, m, q, sizes)
    type(linear_form_type), intent(in) :: form      !< with its columns
    integer, intent(in) :: n                        !< number of positions
    integer, intent(in) :: p                        !< number of the parameter
    integer, intent(in) :: m                        !< number of coordinates
    real(wp), intent(in) :: q(batch_size, 0:2, m)   !< derivatives of the coordinates
    real(wp), intent(inout) :: sizes(batch_size)    !< the sums
    integer :: i, j

    sizes(:n) = form%constant_sizes(p)
    do j = 1, size(form%steps)
      do i = 1, n
        sizes(i) = sizes(i) + maxval(abs(form%columns(i, :, 0, j)))*abs(q(i, 0, form%coordinates(j)))
      end do
    end do
  end subroutine find_sizes
end module mech9_linear_form
