!> The chains that are solved together, with the derivatives of their unknowns by all parameters at several positions at once.
module mech9_varied_block
  use mech9_kinds, only: wp, long
  use mech9_batch_products, only: batch_size
  use mech9_tolerances, only: singular_conditioning, inexact_dimensions
  use mech9_sensitivity_tolerances, only: opened_by_parameter, round_off_of_opening
  use mech9_least_squares, only: least_squares_type, nearly_dependent
  use mech9_cofactors, only: invert_several
  use mech9_several_inverses, only: most_rows, find_pivot_order, invert_in_order, bound_conditioning
  use mech9_plan, only: plan_type
  use mech9_tangent, only: tangent_type
  use mech9_parameter_support, only: support_type, closure_form, keep_static
  use mech9_linear_form, only: linear_form_type, find_values, find_sizes, solve_for
  use mech9_motion_changes, only: motion_changes_type
  implicit none
  private
  public :: varied_block_type, new_varied_block, solve_block

  !> A block that some parameter changes.
  type :: varied_block_type
    integer :: number = 0                              !< of the block in the plan
    integer :: first_closure = 1                       !< its first closure
    type(linear_form_type), allocatable :: forms(:)    !< openings of its closures, in its equations
    type(linear_form_type), allocatable :: whole(:)    !< the same with all components, where the equations leave some out
    logical :: has_whole = .false.                     !< the equations leave some out
    integer :: at_once = batch_size                    !< most positions that are treated at once
    logical, private :: is_checked = .false.           !< chains may stay open although the equations are solved
    integer, allocatable, private :: parameters(:)     !< those that change the block
    real(wp), allocatable, private :: round_off(:)     !< (P) of an opening by each parameter [rad, m]
    integer, allocatable, private :: coordinates(:)    !< unknowns
    real(wp), allocatable, private :: units(:)         !< of the unknowns: 1 rad, or the length of the mechanism [m]
    !> Factors of the Jacobian: those of one position after the other, or of each position where `solver` does not serve.
    type(least_squares_type), allocatable, private :: equations(:)
    logical, private :: by_solver = .false.            !< `solver` serves for all right-hand sides
    logical, private :: has_cofactors = .false.        !< it consists of cofactors
    logical, private :: together = .false.             !< it is found for several positions together, where these pivots serve
    integer, allocatable, private :: pivots(:)         !< order of the equations' pivots at the first position of all
    real(wp), allocatable, private :: matrices(:, :, :)     !< (batch,equations,unknowns) Jacobians in units of the unknowns
    real(wp), allocatable, private :: eliminated(:, :, :)   !< scratch of the same shape
    real(wp), allocatable, private :: inverses(:, :, :)     !< (batch,unknowns,equations)
    real(wp), allocatable, private :: jacobian(:, :)   !< (equations,unknowns) in units of the unknowns
    !> (batch,unknowns,equations) share of each opening in each unknown; equations to a multiple of three, those after the last zero.
    real(wp), allocatable, private :: solver(:, :, :)
    real(wp), allocatable, private :: openings(:, :)   !< (batch,equations) by one parameter, and up to two columns of zeros
    real(wp), allocatable, private :: right(:), change(:)   !< (equations), (unknowns) scratch
  end type varied_block_type

  !> Memory for the factors of several positions [bytes].
  integer(long), parameter :: most_memory = 67108864_long

contains

  !> A block with room for all that a batch of positions needs.
  function new_varied_block(plan, support, tangents, number, in_plane, highest) result(block)
    type(plan_type), intent(in) :: plan            !< the plan
    type(support_type), intent(in) :: support      !< all that the parameters change
    type(tangent_type), intent(in) :: tangents(:)  !< (P) derivatives of constants
    integer, intent(in) :: number                  !< of the block
    logical, intent(in) :: in_plane                !< the arithmetic is planar
    integer, intent(in) :: highest                 !< order of the highest derivative
    type(varied_block_type) :: block
    integer :: c, i, rows, unknowns, padded

    block%number = number
    associate (planned => plan%blocks(number))
      block%first_closure = planned%first_closure
      block%coordinates = planned%coordinates
      block%units = plan%unit_of(planned%coordinates)
      block%parameters = pack([(i, i=1, size(tangents))], any(support%touched(planned%coordinates, :), dim=1))
      block%round_off = round_off_of_opening*tangents%round_off*max(1.0_wp, plan%length)
      allocate (block%forms(planned%last_closure - planned%first_closure + 1))
      rows = 0
      do i = 1, size(block%forms)
        c = planned%first_closure + i - 1
        block%forms(i) = closure_form(plan, support, tangents, planned, c, plan%constraints(c)%item%equations)
        if (in_plane) then
          block%forms(i)%first_moving = 2
          call keep_static(support, 1, plan%closures(c)%base == 0, block%forms(i))
        else if (block%forms(i)%rows == 6) then
          call keep_static(support, 3, .false., block%forms(i))
        end if
        rows = rows + block%forms(i)%rows
        if (plan%closures(c)%coupling == 0 .and. .not. in_plane) &
          block%has_whole = block%has_whole .or. plan%constraints(c)%item%equations < 6
      end do
      unknowns = size(planned%coordinates)
      block%is_checked = block%has_whole .or. rows > unknowns
      allocate (block%whole(merge(size(block%forms), 0, block%has_whole)))
      do i = 1, size(block%whole)
        c = planned%first_closure + i - 1
        if (plan%closures(c)%coupling == 0) block%whole(i) = closure_form(plan, support, tangents, planned, c, 6)
      end do
      block%by_solver = rows == 3 .and. unknowns == 3 .or. rows <= (highest + 1)*size(block%parameters)
      block%has_cofactors = rows == 3 .and. unknowns == 3 .and. size(block%forms) == 1
      block%together = block%by_solver .and. rows == unknowns .and. rows > 3 .and. rows <= most_rows
      if (.not. block%by_solver) block%at_once = most_at_once(rows, unknowns)
      allocate (block%equations(merge(1, block%at_once, block%by_solver)))
      do i = 1, size(block%equations)
        call block%equations(i)%create(rows, unknowns)
        block%equations(i)%regular_pivot = planned%regular_pivot
      end do
    end associate
    ! openings are combined three at a time
    padded = 3*((rows + 2)/3)
    allocate (block%jacobian(rows, unknowns), block%openings(batch_size, padded), block%right(rows), block%change(unknowns), &
              source=0.0_wp)
    if (block%together) allocate (block%matrices(batch_size, rows, rows), block%eliminated(batch_size, rows, rows), &
                                  block%inverses(batch_size, rows, rows), source=0.0_wp)
    allocate (block%solver(batch_size, merge(unknowns, 0, block%by_solver), padded), source=0.0_wp)
  end function new_varied_block

  !> The number of positions whose factors are kept at once.
  pure integer function most_at_once(rows, unknowns) result(most)
    integer, intent(in) :: rows       !< number of equations
    integer, intent(in) :: unknowns   !< number of unknowns

    most = int(max(1_long, min(int(batch_size, long), most_memory/(8_long*max(1, rows*unknowns)))))
  end function most_at_once

  !> Find the derivatives of the unknowns of a block, in all orders.
  subroutine solve_block(n, plan, highest, block, changes, good, opened_by)
    integer, intent(in) :: n                                   !< number of positions
    type(plan_type), intent(in) :: plan                        !< the plan
    integer, intent(in) :: highest                             !< order of the highest derivative
    type(varied_block_type), intent(inout) :: block            !< with its forms filled
    type(motion_changes_type), intent(inout) :: changes        !< derivatives of the coordinates; gets those of the unknowns
    integer, intent(out) :: good                               !< positions before the first one without derivatives, or n
    integer, intent(out) :: opened_by                          !< parameter that opens a chain there; 0: the position is singular
    integer :: i, j, order, row

    opened_by = 0
    if (block%has_cofactors) then
      call invert(n, block, good)
    else
      call factorize(n, block, good)
    end if
    do j = 1, size(block%parameters)
      associate (p => block%parameters(j), q => changes%values)
        do order = 0, highest
          row = 1
          do i = 1, size(block%forms)
            call find_values(block%forms(i), good, p, order, .false., q(1, 1, p), block%openings(1, row))
            row = row + block%forms(i)%rows
          end do
          if (block%by_solver) then
            call solve_for(good, size(block%solver, 3), block%solver, block%openings, order, block%coordinates, q(1, 1, p))
          else
            call solve_one_by_one(good, block, order, q(1, 1, p))
          end if
        end do
      end associate
    end do
    if (block%is_checked) call find_opened(plan, block, changes, good, opened_by)
  end subroutine solve_block

  !> Factorize the equations of a block at one position after the other, as far as they are regular.
  subroutine factorize(n, block, good)
    integer, intent(in) :: n                          !< number of positions
    type(varied_block_type), intent(inout) :: block   !< with the columns of its forms; gets the factors
    integer, intent(out) :: good                      !< positions before the first singular one, or n
    real(wp) :: bounds(batch_size)
    integer :: i

    bounds(:n) = 0.0_wp
    if (block%together) call invert_together(n, block, bounds)
    do i = 1, n
      good = i - 1
      if (bounds(i) >= singular_conditioning) cycle
      call fill_jacobian(block, i)
      associate (equations => block%equations(merge(1, i, block%by_solver)))
        call equations%factorize(block%jacobian)
        if (.not. equations%conditioning() >= singular_conditioning) return
      end associate
      if (block%by_solver) call find_solver(block, i)
    end do
    good = n
  end subroutine factorize

  !> Invert the Jacobians of all positions with the pivots of the first position of the motion. Which positions are found together has
  !> no effect on the results: other pivots would change them within round-off.
  subroutine invert_together(n, block, bounds)
    integer, intent(in) :: n                          !< number of positions
    type(varied_block_type), intent(inout) :: block   !< with the columns of its forms; gets the shares of openings in unknowns
    real(wp), intent(inout) :: bounds(batch_size)     !< lower bounds of the conditioning; zero where other pivots are needed
    integer :: i, j, k, r, u, row, m

    m = size(block%units)
    row = 0
    do i = 1, size(block%forms)
      associate (form => block%forms(i))
        do j = form%n_given + 1, size(form%steps)
          u = form%unknowns(j)
          do r = 1, form%rows
            do k = 1, n
              block%matrices(k, row + r, u) = form%columns(k, r, 0, j)*block%units(u)
            end do
          end do
        end do
        row = row + form%rows
      end associate
    end do
    if (.not. allocated(block%pivots)) then
      allocate (block%pivots(m))
      call find_pivot_order(m, block%matrices(1, :, :), block%pivots)
    end if
    call invert_in_order(n, batch_size, m, block%pivots, block%matrices, block%eliminated, block%inverses)
    call bound_conditioning(n, batch_size, m, block%matrices, block%inverses, block%equations(1)%regular_pivot, bounds)
    do r = 1, m
      do u = 1, m
        do k = 1, n
          block%solver(k, u, r) = -block%units(u)*block%inverses(k, u, r)
        end do
      end do
    end do
  end subroutine invert_together

  !> Invert the Jacobians of three equations in three unknowns at all positions, as far as they are regular.
  subroutine invert(n, block, good)
    integer, intent(in) :: n                          !< number of positions
    type(varied_block_type), intent(inout) :: block   !< with the columns of its forms; gets the shares of openings in unknowns
    integer, intent(out) :: good                      !< positions before the first singular one, or n
    real(wp) :: matrices(batch_size, 3, 3), inverse(batch_size, 3, 3), largest(batch_size), least(batch_size)
    integer :: i, j, r, u

    associate (form => block%forms(1))
      do j = 1, 3
        u = form%unknowns(form%n_given + j)
        do r = 1, 3
          matrices(:n, r, u) = form%columns(:n, r, 0, form%n_given + j)*block%units(u)
        end do
      end do
    end associate
    call invert_several(n, batch_size, nearly_dependent, matrices, inverse, largest, least)
    do r = 1, 3
      do u = 1, 3
        block%solver(:n, u, r) = -block%units(u)*inverse(:n, u, r)
      end do
    end do
    do i = 1, n
      good = i - 1
      if (least(i) > nearly_dependent*max(largest(i), block%equations(1)%regular_pivot)) cycle
      block%jacobian = matrices(i, :, :)
      call block%equations(1)%factorize(block%jacobian)
      if (.not. block%equations(1)%conditioning() >= singular_conditioning) return
      call find_solver(block, i)
    end do
    good = n
  end subroutine invert

  !> Take the Jacobian from the columns of the forms.
  pure subroutine fill_jacobian(block, position)
    type(varied_block_type), intent(inout) :: block   !< with the columns of its forms; gets the Jacobian
    integer, intent(in) :: position                   !< number of the position in the batch
    integer :: i, j, r, row

    row = 0
    do i = 1, size(block%forms)
      associate (form => block%forms(i))
        do j = form%n_given + 1, size(form%steps)
          associate (u => form%unknowns(j))
            do r = 1, form%rows
              block%jacobian(row + r, u) = form%columns(position, r, 0, j)*block%units(u)
            end do
          end associate
        end do
        row = row + form%rows
      end associate
    end do
  end subroutine fill_jacobian

  !> Find the share of each opening in each unknown.
  subroutine find_solver(block, position)
    type(varied_block_type), intent(inout) :: block   !< with its factors
    integer, intent(in) :: position                   !< number of the position in the batch
    integer :: r, u

    associate (equations => block%equations(1))
      if (equations%by_cofactors) then
        do r = 1, 3
          do u = 1, 3
            block%solver(position, u, r) = -block%units(u)*equations%inverse(u, r)
          end do
        end do
        return
      end if
      do r = 1, size(block%right)
        block%right = 0.0_wp
        block%right(r) = -1.0_wp
        call equations%solve(block%right, block%change)
        do u = 1, size(block%units)
          block%solver(position, u, r) = block%units(u)*block%change(u)
        end do
      end do
    end associate
  end subroutine find_solver

  !> Solve for one position after the other, where there are fewer right-hand sides than equations.
  subroutine solve_one_by_one(n, block, order, q)
    integer, intent(in) :: n                                !< number of positions
    type(varied_block_type), intent(inout) :: block         !< with its factors and openings
    integer, intent(in) :: order                            !< of the derivative in time
    real(wp), intent(inout) :: q(batch_size, 0:2, *)        !< (batch,0:2,M) of the coordinates; gets the unknowns
    integer :: i, u

    do i = 1, n
      block%right = -block%openings(i, :size(block%right))
      call block%equations(i)%solve(block%right, block%change)
      do u = 1, size(block%coordinates)
        q(i, order, block%coordinates(u)) = block%units(u)*block%change(u)
      end do
    end do
  end subroutine solve_one_by_one

  !> Find the first position at which no change of the unknowns keeps a chain closed for some parameter: the equations of the block left
  !> out what does not change in any motion of the mechanism, but changes with the parameter.
  subroutine find_opened(plan, block, changes, good, opened_by)
    type(plan_type), intent(in) :: plan                        !< the plan
    type(varied_block_type), intent(in) :: block               !< with its forms
    type(motion_changes_type), intent(in) :: changes           !< derivatives of the coordinates
    integer, intent(inout) :: good                             !< positions that are judged; gets those before the first that is open
    integer, intent(inout) :: opened_by                        !< gets the parameter that opens it
    integer :: i, j
    logical :: is_coupling

    do i = 1, size(block%forms)
      is_coupling = plan%closures(block%first_closure + i - 1)%coupling > 0
      do j = 1, size(block%parameters)
        if (block%has_whole .and. .not. is_coupling) then
          call judge(block%whole(i), block%parameters(j))
        else
          call judge(block%forms(i), block%parameters(j))
        end if
      end do
    end do
  contains

    !> Judge the opening of one closure by one parameter.
    subroutine judge(form, p)
      type(linear_form_type), intent(in) :: form   !< its opening
      integer, intent(in) :: p                     !< number of the parameter
      real(wp) :: parts(batch_size, form%rows), sizes(batch_size)
      integer :: k

      call find_values(form, good, p, 0, .true., changes%values(1, 1, p), parts)
      call find_sizes(form, good, p, changes%values(1, 1, p), sizes)
      ! the numbers of a coupling are not among the constants whose sizes are known
      if (is_coupling) sizes(:good) = max(sizes(:good), abs(parts(:good, 1)))
      do k = 1, good
        if (maxval(abs(parts(k, :))) <= max(opened_by_parameter, inexact_dimensions*plan%data_tolerance)*sizes(k)) cycle
        if (maxval(abs(parts(k, :))) <= block%round_off(p)) cycle
        good = k - 1
        opened_by = p
        return
      end do
    end subroutine judge
  end subroutine find_opened
end module mech9_varied_block
