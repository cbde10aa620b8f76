!> Numbers that are linear in the derivatives of coordinates by all parameters, such as the openings of a chain or the shift of a
!> point, with their derivatives in time, at several positions of a motion at once.
!>
!> The position is the fastest index. All that the parameters decide, such as which of them changes which coordinate, is decided once
!> for all positions: a product of zero is never formed.
module mech9_linear_form
  use mech9_kinds, only: wp
  use mech9_batch_products, only: batch_size, set_three, sum_three, add_three_to, add_to
  implicit none
  private
  public :: linear_form_type, form_steps_type, form_constants_type, new_linear_form, put_share, keep_double, find_values, &
    find_sizes, solve_for

  !> For each parameter p, value(r) = share(r,p) + the sum over the steps of columns(r,s)*q(p,s), and the derivatives of this sum in time.
  type :: linear_form_type
    integer :: rows = 0                                !< how many numbers
    integer :: n_given = 0                             !< steps, the first ones, whose coordinates other blocks or drives determine
    integer :: first_moving = 1                        !< rows before this one have constant columns
    integer, allocatable :: steps(:)                   !< steps whose coordinates change with some parameter
    integer, allocatable :: coordinates(:)             !< of these steps
    logical, allocatable :: touched(:, :)              !< (steps,P) the coordinate changes with the parameter
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

  !> Products of columns and coordinates that wait to be added, three at a time.
  type :: terms_type
    integer :: count = 0       !< how many wait
    integer :: steps(3)        !< number of the step of each in the form
    integer :: kinds(3)        !< kind of its column
    integer :: orders(3)       !< of the derivative of its coordinate
  end type terms_type

  !> Steps of a form.
  type :: form_steps_type
    integer, allocatable :: numbers(:)         !< of the steps
    integer, allocatable :: coordinates(:)     !< of the steps
    real(wp), allocatable :: signs(:)          !< of the steps: 1 or -1
  end type form_steps_type

  !> Twists by which constants of a form change with parameters.
  type :: form_constants_type
    integer, allocatable :: numbers(:)         !< of the twists
    real(wp), allocatable :: signs(:)          !< of the twists: 1 or -1
    integer, allocatable :: parameters(:)      !< of the twists
  end type form_constants_type

contains

  !> A form of some steps and constants, with room for its columns.
  pure function new_linear_form(rows, steps, constants, touched, varies) result(form)
    integer, intent(in) :: rows                     !< how many numbers the form gives
    type(form_steps_type), intent(in) :: steps      !< its steps
    type(form_constants_type), intent(in) :: constants   !< its twists of constants
    logical, intent(in) :: touched(:, :)            !< (M,P) coordinates that change with each parameter
    logical, intent(in) :: varies(:)                !< (P) parameters that have a share besides these twists
    type(linear_form_type) :: form
    integer :: i, p

    form%rows = rows
    form%steps = steps%numbers
    form%coordinates = steps%coordinates
    form%signs = steps%signs
    form%touched = touched(steps%coordinates, :)
    form%constants = constants%numbers
    form%constant_signs = constants%signs
    form%parameters = constants%parameters
    associate (parameters => constants%parameters)
      form%is_first = [(all(parameters(:i - 1) /= parameters(i)), i=1, size(parameters))]
      allocate (form%unknowns(size(steps%numbers)), form%slots(size(varies)), source=0)
      allocate (form%keeps(size(parameters)), form%is_still(size(varies)), source=.false.)
      form%is_changed = varies
      do p = 1, size(varies)
        if (varies(p) .or. any(parameters == p)) form%slots(p) = maxval(form%slots) + 1
        form%is_changed(p) = form%slots(p) > 0 .or. any(form%touched(:, p))
      end do
    end associate
    allocate (form%columns(batch_size, rows, 0:3, size(steps%numbers)), form%shares(batch_size, rows, 0:2, maxval(form%slots)), &
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
  pure subroutine find_values(form, n, p, order, whole, q, values)
    type(linear_form_type), intent(in) :: form                    !< with its columns and shares
    integer, intent(in) :: n                                      !< number of positions
    integer, intent(in) :: p                                      !< number of the parameter
    integer, intent(in) :: order                                  !< of the derivative in time
    logical, intent(in) :: whole                                  !< with the unknowns in this order, not only with those that are given
    real(wp), intent(in) :: q(batch_size, 0:2, *)                 !< (batch,0:2,M) of the coordinates, with derivatives in time
    real(wp), intent(inout) :: values(batch_size, form%rows)      !< the values

    if (form%slots(p) > 0) then
      call copy(n, form%rows, form%shares(1, 1, order, form%slots(p)), values)
    else
      call set_zero(n, form%rows, values)
    end if
    call add_steps(form, n, p, order, merge(size(form%steps), form%n_given, whole), q, values)
  end subroutine find_values

  !> Add the products of all steps, three at a time.
  pure subroutine add_steps(form, n, p, order, n_counted, q, values)
    type(linear_form_type), intent(in) :: form                    !< with its columns
    integer, intent(in) :: n                                      !< number of positions
    integer, intent(in) :: p                                      !< number of the parameter
    integer, intent(in) :: order                                  !< of the derivative in time
    integer, intent(in) :: n_counted                                    !< number of steps whose coordinates count in this order itself
    real(wp), intent(in) :: q(batch_size, 0:2, *)                 !< (batch,0:2,M) derivatives of the coordinates
    real(wp), intent(inout) :: values(batch_size, form%rows)      !< the sums
    type(terms_type) :: terms
    integer :: j, i, kind_of, first

    first = form%first_moving
    do j = 0, order
      kind_of = order - j
      if (order == 2 .and. j == 1) kind_of = 3
      if (kind_of == 0 .and. first > 1) then
        call add_terms(form, n, first, terms, q, values)
        first = 1
      end if
      do i = 1, merge(n_counted, size(form%steps), j == order)
        if (.not. form%touched(i, p)) cycle
        terms%count = terms%count + 1
        terms%steps(terms%count) = i
        terms%kinds(terms%count) = kind_of
        terms%orders(terms%count) = j
        if (terms%count == 3) call add_terms(form, n, first, terms, q, values)
      end do
    end do
    call add_terms(form, n, first, terms, q, values)
  end subroutine add_steps

  !> Add the products that wait.
  pure subroutine add_terms(form, n, first, terms, q, values)
    type(linear_form_type), intent(in) :: form                    !< with its columns
    integer, intent(in) :: n                                      !< number of positions
    integer, intent(in) :: first                                  !< first of the rows that change
    type(terms_type), intent(inout) :: terms                      !< the products; none wait afterwards
    real(wp), intent(in) :: q(batch_size, 0:2, *)                 !< (batch,0:2,M) derivatives of the coordinates
    real(wp), intent(inout) :: values(batch_size, form%rows)      !< the sums
    integer :: k

    associate (steps => terms%steps, kinds => terms%kinds, orders => terms%orders)
      if (terms%count == 3) then
        call add_three_to(n, form%rows - first + 1, form%columns(1, first, kinds(1), steps(1)), &
                          form%columns(1, first, kinds(2), steps(2)), form%columns(1, first, kinds(3), steps(3)), &
                          q(1, orders(1), form%coordinates(steps(1))), q(1, orders(2), form%coordinates(steps(2))), &
                          q(1, orders(3), form%coordinates(steps(3))), values(1, first))
      else
        do k = 1, terms%count
          call add_to(n, form%rows - first + 1, form%columns(1, first, kinds(k), steps(k)), &
                      q(1, orders(k), form%coordinates(steps(k))), values(1, first))
        end do
      end if
    end associate
    terms%count = 0
  end subroutine add_terms

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
  pure subroutine solve_for(n, rows, solver, openings, order, coordinates, q)
    integer, intent(in) :: n                                               !< number of positions
    integer, intent(in) :: rows                                            !< number of openings, a multiple of three
    integer, intent(in) :: order                                           !< of the derivative in time
    integer, intent(in) :: coordinates(:)                                  !< the unknowns
    real(wp), intent(in) :: solver(batch_size, size(coordinates), rows)    !< factors of the openings
    real(wp), intent(in) :: openings(batch_size, rows)                     !< of the block, by the parameter
    real(wp), intent(inout) :: q(batch_size, 0:2, *)                       !< (batch,0:2,M) of the coordinates; gets the unknowns
    integer :: unknowns, u, r

    unknowns = size(coordinates)
    do u = 1, unknowns - 2, 3
      associate (i => coordinates(u), j => coordinates(u + 1), k => coordinates(u + 2))
        call set_three(n, unknowns, solver(1, u, 1), openings, q(1, order, i), q(1, order, j), q(1, order, k))
        do r = 4, rows, 3
          call sum_three(n, unknowns, solver(1, u, r), openings(1, r), q(1, order, i), q(1, order, j), q(1, order, k))
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
  pure subroutine find_sizes(form, n, p, q, sizes)
    type(linear_form_type), intent(in) :: form      !< with its columns
    integer, intent(in) :: n                        !< number of positions
    integer, intent(in) :: p                        !< number of the parameter
    real(wp), intent(in) :: q(batch_size, 0:2, *)   !< (batch,0:2,M) derivatives of the coordinates
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
