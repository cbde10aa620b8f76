!> Least squares with bounds, for residuals in groups that share some unknowns and have others of their own.
!>
!> Levenberg and Marquardt's method with exact Jacobians: each step makes |r + J d|^2 + lambda |D d|^2 least, where D holds the
!> largest norms that the columns of J have had (Moré 1978), and lambda follows from the reduction of the last step (Nielsen 1999).
!> Unknowns at a bound against which the gradient pushes are held (Bertsekas 1982); a step that would leave the bounds holds the
!> unknowns there and is solved again for the others. The unknowns of a group are eliminated within the group by reflections, so
!> that the work grows linearly with the number of groups.
module mech9_bounded_least_squares
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mech9_kinds, only: wp
  use mech9_reflections, only: triangulate, solve_upper
  implicit none
  private
  public :: residuals_type, residual_values_type, bounds_type, least_squares_settings_type, least_squares_outcome_type, &
    minimise_squares
  public :: ended_flat, ended_short, ended_small, ended_by_count, ended_without_value

  integer, parameter :: ended_flat = 1           !< the residual is orthogonal to all columns that may move it
  integer, parameter :: ended_short = 2          !< the steps have become too short to matter
  integer, parameter :: ended_small = 3          !< the sum of squares is as small as was asked for
  integer, parameter :: ended_by_count = 4       !< as many steps as are allowed were made
  integer, parameter :: ended_without_value = 5  !< the residuals have no value at the start

  !> Smaller reductions, as parts of the sum of squares, are hidden by its round-off.
  real(wp), parameter :: hidden = 16.0_wp*epsilon(1.0_wp)

  !> Residuals and their derivatives at one place. Each unknown counts in its own unit.
  type :: residual_values_type
    real(wp), allocatable :: r(:, :)          !< (rows,groups) residuals
    real(wp), allocatable :: by_x(:, :, :)    !< (rows,n,groups) derivatives by the shared unknowns
    real(wp), allocatable :: by_y(:, :, :)    !< (rows,n_y,groups) derivatives by the unknowns of the group
  end type residual_values_type

  !> Residuals in groups, as functions of unknowns.
  type, abstract :: residuals_type
    integer :: n = 0         !< number of shared unknowns
    integer :: groups = 0    !< number of groups
    integer :: n_y = 0       !< number of further unknowns in each group
    integer :: rows = 0      !< number of residuals of each group
  contains
    procedure(evaluate_interface), deferred :: evaluate
  end type residuals_type

  !> Bounds of the unknowns.
  type :: bounds_type
    real(wp), allocatable :: low(:)         !< (n) least shared unknowns
    real(wp), allocatable :: high(:)        !< (n) largest shared unknowns
    real(wp), allocatable :: y_low(:, :)    !< (own,groups) least unknowns of each group
    real(wp), allocatable :: y_high(:, :)   !< (own,groups) largest unknowns of each group
  end type bounds_type

  !> When to end.
  type :: least_squares_settings_type
    integer :: most_steps = 200             !< number of steps, refused ones included
    real(wp) :: flat = 1.0e-12_wp           !< largest cosine between the residual and a column at a minimum
    real(wp) :: short = 1.0e-12_wp          !< length of a step that is too short, as a part of the unknowns
    real(wp) :: small = 0.0_wp              !< sum of squares that is small enough
    real(wp) :: damping = 1.0e-2_wp         !< damping of the first step, as a part of the squares of the columns
  end type least_squares_settings_type

  !> How the search ended.
  type :: least_squares_outcome_type
    integer :: kind = ended_without_value   !< one of the kinds above
    integer :: steps = 0                    !< number of steps, refused ones included
    real(wp) :: value = huge(1.0_wp)        !< sum of the squares
  end type least_squares_outcome_type

  abstract interface
    !> The residuals, and their derivatives where these are asked for. Without `has_value` they have none there, and the
    !> search takes a shorter step.
    subroutine evaluate_interface(self, x, y, with_derivatives, values, has_value)
      import :: residuals_type, residual_values_type, wp
      class(residuals_type), intent(inout) :: self          !< the residuals
      real(wp), intent(in) :: x(:)                          !< (n) shared unknowns
      real(wp), intent(in) :: y(:, :)                       !< (n_y,groups) unknowns of each group
      logical, intent(in) :: with_derivatives               !< derivatives are asked for, at the place asked for last
      type(residual_values_type), intent(inout) :: values   !< gets the residuals, and the derivatives that are asked for
      logical, intent(out) :: has_value                     !< the residuals have a value here
    end subroutine evaluate_interface
  end interface

  !> The present place and what is known of it.
  type :: search_type
    real(wp), allocatable :: x(:), y(:, :)                     !< the unknowns
    type(bounds_type) :: bounds
    real(wp), allocatable :: scale_x(:), scale_y(:, :)         !< largest norms of the columns so far
    logical, allocatable :: held_x(:), held_y(:, :)            !< unknowns that the step does not solve for
    real(wp), allocatable :: dx(:), dy(:, :)                   !< the step
    type(residual_values_type) :: values                       !< at the present place
    type(residual_values_type) :: trial                        !< at the end of the step
    real(wp) :: value = huge(1.0_wp)                           !< sum of squares at the present place
    real(wp) :: damping = 0.0_wp
    real(wp) :: growth = 2.0_wp                                !< factor of the damping after the next refused step
  end type search_type

contains

  !> Make the sum of squares least between bounds. The unknowns are moved into their bounds first.
  subroutine minimise_squares(residuals, x, y, bounds, settings, outcome)
    class(residuals_type), intent(inout) :: residuals               !< the residuals
    real(wp), intent(inout) :: x(:)                                 !< (n) shared unknowns: start, then the place of the minimum
    real(wp), intent(inout) :: y(:, :)                              !< (n_y,groups) unknowns of each group
    type(bounds_type), intent(in) :: bounds                         !< of the unknowns
    type(least_squares_settings_type), intent(in) :: settings       !< when to end
    type(least_squares_outcome_type), intent(out) :: outcome        !< how the search ended
    type(search_type) :: search
    real(wp) :: predicted, value
    logical :: has_value, is_last

    call begin_search(residuals, x, y, bounds, settings, search, has_value)
    outcome%kind = merge(ended_by_count, ended_without_value, has_value)
    do while (has_value .and. outcome%steps < settings%most_steps)
      if (search%value <= settings%small) outcome%kind = ended_small
      if (outcome%kind == ended_by_count .and. is_flat(search, settings%flat)) outcome%kind = ended_flat
      if (outcome%kind /= ended_by_count) exit
      outcome%steps = outcome%steps + 1
      call find_step(residuals, search, predicted)
      call try_step(residuals, search, value)
      is_last = step_length(search) <= settings%short .or. .not. search%damping < 1.0e100_wp
      if (is_improvement(predicted, search%value, value)) then
        ! a reduction that round-off hides is taken on trust, and is the last one
        is_last = is_last .or. predicted <= hidden*search%value
        call accept_step(residuals, (search%value - value)/predicted, value, search, has_value)
      else
        search%damping = search%damping*search%growth
        search%growth = min(2.0_wp*search%growth, 1.0e10_wp)
      end if
      if (is_last) outcome%kind = ended_short
      if (is_last) exit
    end do
    if (search%value <= settings%small) outcome%kind = ended_small
    outcome%value = search%value
    x = search%x
    y = search%y
  end subroutine minimise_squares

  !> Whether a step is good enough: it brings some of the reduction that the linear model predicts.
  pure logical function is_improvement(predicted, before, after)
    real(wp), intent(in) :: predicted   !< reduction of the sum of squares by the linear model
    real(wp), intent(in) :: before      !< sum of squares before the step
    real(wp), intent(in) :: after       !< sum of squares after it

    is_improvement = predicted > 0.0_wp .and. before - after > 1.0e-4_wp*predicted
    if (predicted <= hidden*before) is_improvement = predicted > 0.0_wp .and. after - before <= hidden*before
  end function is_improvement

  !> Evaluate the residuals at the start.
  subroutine begin_search(residuals, x, y, bounds, settings, search, has_value)
    class(residuals_type), intent(inout) :: residuals            !< the residuals
    real(wp), intent(in) :: x(:)                                 !< (n) shared unknowns
    real(wp), intent(in) :: y(:, :)                              !< (n_y,groups) unknowns of each group
    type(bounds_type), intent(in) :: bounds                      !< of the unknowns
    type(least_squares_settings_type), intent(in) :: settings    !< with the first damping
    type(search_type), intent(out) :: search                     !< at the start
    logical, intent(out) :: has_value                            !< the residuals have a value there

    search%bounds = bounds
    search%x = min(max(x, bounds%low), bounds%high)
    search%y = min(max(y, bounds%y_low), bounds%y_high)
    search%dx = 0.0_wp*x
    search%dy = 0.0_wp*y
    search%scale_x = search%dx
    search%scale_y = search%dy
    search%held_x = x < -huge(x)
    search%held_y = y < -huge(y)
    search%damping = settings%damping
    allocate (search%values%r(residuals%rows, residuals%groups), &
              search%values%by_x(residuals%rows, residuals%n, residuals%groups), &
              search%values%by_y(residuals%rows, residuals%n_y, residuals%groups), source=0.0_wp)
    search%trial = search%values
    call residuals%evaluate(search%x, search%y, .false., search%values, has_value)
    if (has_value) search%value = sum(search%values%r**2)
    has_value = has_value .and. ieee_is_finite(search%value)
    if (.not. has_value) search%value = huge(1.0_wp)
    if (has_value) call find_derivatives(residuals, search, has_value)
  end subroutine begin_search

  !> Find the derivatives at the present place, the scales of the columns, and the unknowns that are held at bounds.
  subroutine find_derivatives(residuals, search, has_value)
    class(residuals_type), intent(inout) :: residuals   !< the residuals
    type(search_type), intent(inout) :: search          !< at the place that was evaluated last
    logical, intent(out) :: has_value                   !< the derivatives exist
    integer :: j, g

    call residuals%evaluate(search%x, search%y, .true., search%values, has_value)
    if (has_value) has_value = all(ieee_is_finite(search%values%by_x)) .and. all(ieee_is_finite(search%values%by_y))
    if (.not. has_value) return
    do j = 1, residuals%n
      search%scale_x(j) = max(search%scale_x(j), norm2(search%values%by_x(:, j, :)))
      search%held_x(j) = is_held(search%x(j), search%bounds%low(j), search%bounds%high(j), &
                                 sum(search%values%by_x(:, j, :)*search%values%r))
    end do
    do g = 1, residuals%groups
      do j = 1, residuals%n_y
        search%scale_y(j, g) = max(search%scale_y(j, g), norm2(search%values%by_y(:, j, g)))
        search%held_y(j, g) = is_held(search%y(j, g), search%bounds%y_low(j, g), search%bounds%y_high(j, g), &
                                      dot_product(search%values%by_y(:, j, g), search%values%r(:, g)))
      end do
    end do
  end subroutine find_derivatives

  !> Whether an unknown is held: its bounds are one number, or it is at a bound beyond which the sum of squares would decrease.
  pure logical function is_held(x, low, high, slope)
    real(wp), intent(in) :: x       !< the unknown
    real(wp), intent(in) :: low     !< its least value
    real(wp), intent(in) :: high    !< its largest value
    real(wp), intent(in) :: slope   !< derivative of half the sum of squares

    is_held = .not. low < high .or. (x <= low .and. slope > 0.0_wp) .or. (x >= high .and. slope < 0.0_wp)
  end function is_held

  !> Whether the residual is orthogonal to all columns of unknowns that are not held.
  pure logical function is_flat(search, flat)
    type(search_type), intent(in) :: search   !< with derivatives
    real(wp), intent(in) :: flat              !< largest cosine
    real(wp) :: size_of_residual
    integer :: j, g

    size_of_residual = sqrt(search%value)
    is_flat = .false.
    do j = 1, size(search%x)
      if (search%held_x(j)) cycle
      if (abs(sum(search%values%by_x(:, j, :)*search%values%r)) > flat*size_of_residual*search%scale_x(j)) return
    end do
    do g = 1, size(search%y, 2)
      do j = 1, size(search%y, 1)
        if (search%held_y(j, g)) cycle
        if (abs(dot_product(search%values%by_y(:, j, g), search%values%r(:, g))) > &
            flat*size_of_residual*search%scale_y(j, g)) return
      end do
    end do
    is_flat = .true.
  end function is_flat

  !> Find a step within the bounds, and the reduction of the sum of squares that the linear model gives it.
  subroutine find_step(residuals, search, predicted)
    class(residuals_type), intent(in) :: residuals   !< the residuals
    type(search_type), intent(inout) :: search       !< gets the step
    real(wp), intent(out) :: predicted               !< reduction of the sum of squares
    logical :: held_x(size(search%x)), held_y(size(search%y, 1), size(search%y, 2))
    integer :: pass, g

    held_x = search%held_x
    held_y = search%held_y
    search%dx = 0.0_wp
    search%dy = 0.0_wp
    do pass = 1, 10
      call solve_linear(residuals, held_x, held_y, search)
      if (.not. (any(leaves(search%x + search%dx, search%bounds%low, search%bounds%high) .and. .not. held_x) .or. &
                 any(leaves(search%y + search%dy, search%bounds%y_low, search%bounds%y_high) .and. .not. held_y))) exit
      where (.not. held_x) held_x = leaves(search%x + search%dx, search%bounds%low, search%bounds%high)
      where (.not. held_y) held_y = leaves(search%y + search%dy, search%bounds%y_low, search%bounds%y_high)
      search%dx = min(max(search%x + search%dx, search%bounds%low), search%bounds%high) - search%x
      search%dy = min(max(search%y + search%dy, search%bounds%y_low), search%bounds%y_high) - search%y
    end do
    search%dx = min(max(search%x + search%dx, search%bounds%low), search%bounds%high) - search%x
    search%dy = min(max(search%y + search%dy, search%bounds%y_low), search%bounds%y_high) - search%y
    predicted = 0.0_wp
    do g = 1, residuals%groups
      ! -2 r.J d - |J d|^2, without the difference of two large numbers
      associate (change => matmul(search%values%by_x(:, :, g), search%dx) + matmul(search%values%by_y(:, :, g), search%dy(:, g)))
        predicted = predicted - dot_product(change, 2.0_wp*search%values%r(:, g) + change)
      end associate
    end do
  end subroutine find_step

  !> Whether an unknown leaves its bounds.
  elemental logical function leaves(x, low, high)
    real(wp), intent(in) :: x      !< the unknown
    real(wp), intent(in) :: low    !< its least value
    real(wp), intent(in) :: high   !< its largest value

    leaves = x < low .or. x > high
  end function leaves

  !> Solve the damped linear equations for all unknowns that are not held; the steps of those that are held are given.
  subroutine solve_linear(residuals, held_x, held_y, search)
    class(residuals_type), intent(in) :: residuals   !< the residuals
    logical, intent(in) :: held_x(:)                 !< (n) shared unknowns whose steps are given
    logical, intent(in) :: held_y(:, :)              !< (n_y,groups) others
    type(search_type), intent(inout) :: search       !< gets the step
    real(wp) :: part(residuals%rows + residuals%n_y, residuals%n_y + residuals%n + 1, residuals%groups)
    real(wp) :: whole((residuals%rows + residuals%n_y)*residuals%groups + residuals%n, residuals%n + 1)
    integer :: g, j, n, n_y, rows, at

    n = residuals%n
    n_y = residuals%n_y
    rows = residuals%rows
    whole = 0.0_wp
    at = 0
    do g = 1, residuals%groups
      call fill_part(held_x, held_y(:, g), g, search, part(:, :, g))
      call triangulate(part(:, :, g), n_y)
      whole(at + 1:at + rows, :) = part(n_y + 1:, n_y + 1:, g)
      at = at + rows
    end do
    do j = 1, n
      whole(at + j, j) = damping_of(held_x(j), search%damping, search%scale_x(j))
      if (held_x(j)) whole(at + j, n + 1) = whole(at + j, j)*search%dx(j)
    end do
    call triangulate(whole(:at + n, :), n)
    call solve_upper(whole(:n, :n), whole(:n, n + 1), search%dx)
    do g = 1, residuals%groups
      part(:n_y, n_y + n + 1, g) = part(:n_y, n_y + n + 1, g) &
                                   - matmul(part(:n_y, n_y + 1:n_y + n, g), merge(0.0_wp, search%dx, held_x))
      call solve_upper(part(:n_y, :n_y, g), part(:n_y, n_y + n + 1, g), search%dy(:, g))
    end do
  end subroutine solve_linear

  !> Fill the damped equations of one group: its unknowns, the shared ones, the right-hand side. Columns of unknowns that are held
  !> are zero, and their steps stand on the right-hand side.
  subroutine fill_part(held_x, held_y, g, search, part)
    logical, intent(in) :: held_x(:)         !< (n) shared unknowns whose steps are given
    logical, intent(in) :: held_y(:)         !< (n_y) others
    integer, intent(in) :: g                 !< number of the group
    type(search_type), intent(in) :: search  !< with derivatives and given steps
    real(wp), intent(out) :: part(:, :)      !< (rows+n_y,n_y+n+1) the equations
    integer :: j, rows, n_y, n

    n_y = size(held_y)
    n = size(held_x)
    rows = size(part, 1) - n_y
    part = 0.0_wp
    part(:rows, n_y + n + 1) = -search%values%r(:, g)
    do j = 1, n_y
      if (held_y(j)) then
        part(:rows, n_y + n + 1) = part(:rows, n_y + n + 1) - search%values%by_y(:, j, g)*search%dy(j, g)
      else
        part(:rows, j) = search%values%by_y(:, j, g)
      end if
      part(rows + j, j) = damping_of(held_y(j), search%damping, search%scale_y(j, g))
      if (held_y(j)) part(rows + j, n_y + n + 1) = part(rows + j, j)*search%dy(j, g)
    end do
    do j = 1, n
      if (held_x(j)) then
        part(:rows, n_y + n + 1) = part(:rows, n_y + n + 1) - search%values%by_x(:, j, g)*search%dx(j)
      else
        part(:rows, n_y + j) = search%values%by_x(:, j, g)
      end if
    end do
  end subroutine fill_part

  !> The factor of the damped equation of an unknown.
  elemental real(wp) function damping_of(held, damping, scale)
    logical, intent(in) :: held       !< the unknown is held, so that this is its only equation
    real(wp), intent(in) :: damping   !< of the step
    real(wp), intent(in) :: scale     !< norm of the column of the unknown

    damping_of = sqrt(damping)*scale
    if (held .or. .not. damping_of > 0.0_wp) damping_of = 1.0_wp
  end function damping_of

  !> The length of the step as a part of the unknowns, each in the scale of its column.
  pure real(wp) function step_length(search)
    type(search_type), intent(in) :: search   !< with the step
    real(wp) :: step, place

    step = sum((search%scale_x*search%dx)**2) + sum((search%scale_y*search%dy)**2)
    place = sum((search%scale_x*search%x)**2) + sum((search%scale_y*search%y)**2)
    step_length = sqrt(step/max(place, tiny(place)))
  end function step_length

  !> The sum of squares at the end of the step; huge where there is none.
  subroutine try_step(residuals, search, value)
    class(residuals_type), intent(inout) :: residuals   !< the residuals
    type(search_type), intent(inout) :: search          !< gets the residuals there
    real(wp), intent(out) :: value                      !< their sum of squares
    logical :: has_value

    call residuals%evaluate(search%x + search%dx, search%y + search%dy, .false., search%trial, has_value)
    value = huge(value)
    if (.not. has_value) return
    if (all(abs(search%trial%r) < sqrt(huge(value)/(2.0_wp*max(1, size(search%trial%r)))))) value = sum(search%trial%r**2)
  end subroutine try_step

  !> Go to the end of the step. Its damping decreases the more, the better the linear model was.
  subroutine accept_step(residuals, gain, value, search, has_value)
    class(residuals_type), intent(inout) :: residuals   !< the residuals
    real(wp), intent(in) :: gain                        !< actual reduction over the predicted one
    real(wp), intent(in) :: value                       !< the new sum of squares
    type(search_type), intent(inout) :: search          !< moved
    logical, intent(out) :: has_value                   !< the derivatives exist there

    search%x = search%x + search%dx
    search%y = search%y + search%dy
    search%values%r = search%trial%r
    search%value = value
    search%damping = max(search%damping*max(1.0_wp/3.0_wp, 1.0_wp - (2.0_wp*min(gain, 1.0e3_wp) - 1.0_wp)**3), 1.0e-20_wp)
    search%growth = 2.0_wp
    call find_derivatives(residuals, search, has_value)
  end subroutine accept_step
end module mech9_bounded_least_squares
