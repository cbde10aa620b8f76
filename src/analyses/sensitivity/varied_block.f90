!> The chains that are solved together, with the derivatives of their unknowns by all parameters.
module mech9_varied_block
  use mech9_kinds, only: wp
  use mech9_tolerances, only: opened_by_parameter, inexact_dimensions
  use mech9_least_squares, only: least_squares_type
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_tangent, only: tangent_type
  use mech9_parameter_support, only: support_type, closure_form, keep_static
  use mech9_linear_form, only: linear_form_type, find_values, add_sizes, solve_for
  implicit none
  private
  public :: varied_block_type, new_varied_block, factorize, solve_block

  !> A block that some parameter changes.
  type :: varied_block_type
    integer :: number = 0                              !< of the block in the plan
    integer :: first_closure = 1                       !< its first closure
    type(linear_form_type), allocatable :: forms(:)    !< openings of its closures, in its equations
    type(linear_form_type), allocatable :: whole(:)    !< the same with all components, where the equations leave some out
    logical :: has_whole = .false.                     !< the equations leave some out
    logical :: is_checked = .false.                    !< chains may stay open although the equations are solved
    integer, allocatable :: coordinates(:)             !< unknowns
    integer, allocatable, private :: columns(:, :)     !< (unknowns,0:2) of their derivatives among those of all coordinates
    real(wp), allocatable :: units(:)                  !< of the unknowns: 1 rad, or the length of the mechanism [m]
    type(least_squares_type) :: equations              !< factors of the Jacobian
    logical :: by_solver = .false.                     !< `solver` serves for all right-hand sides
    real(wp), allocatable :: jacobian(:, :)            !< (equations,unknowns) in units of the unknowns
    real(wp), allocatable :: solver(:, :)              !< (equations,unknowns) share of each opening in each unknown; rows to a multiple of three
    real(wp), allocatable, private :: openings(:, :)   !< (P,equations) and up to two columns of zeros
    real(wp), allocatable, private :: parts(:, :)      !< (P,6) the whole opening of a closure
    real(wp), allocatable, private :: sizes(:)         !< (P) of what adds up to it
    real(wp), allocatable, private :: right(:), change(:)   !< (equations), (unknowns) scratch
  end type varied_block_type

contains

  !> A block with room for all that a position needs.
  function new_varied_block(plan, support, number, n, in_plane, highest) result(block)
    type(plan_type), intent(in) :: plan            !< the plan
    type(support_type), intent(in) :: support      !< all that the parameters change
    integer, intent(in) :: number                  !< of the block
    integer, intent(in) :: n                       !< number of parameters
    logical, intent(in) :: in_plane                !< the arithmetic is planar
    integer, intent(in) :: highest                 !< order of the highest derivative
    type(varied_block_type) :: block
    integer :: c, i, rows, unknowns, padded

    block%number = number
    associate (planned => plan%blocks(number))
      block%first_closure = planned%first_closure
      block%coordinates = planned%coordinates
      block%units = plan%unit_of(planned%coordinates)
      allocate (block%forms(planned%last_closure - planned%first_closure + 1))
      rows = 0
      do i = 1, size(block%forms)
        c = planned%first_closure + i - 1
        block%forms(i) = closure_form(plan, support, planned, c, n, plan%constraints(c)%item%equations)
        if (in_plane) then
          block%forms(i)%first_moving = 2
          call keep_static(support, plan%closures(c)%base == 0, block%forms(i))
        end if
        rows = rows + block%forms(i)%rows
        if (plan%closures(c)%coupling == 0 .and. .not. in_plane) &
          block%has_whole = block%has_whole .or. plan%constraints(c)%item%equations < 6
      end do
      unknowns = size(planned%coordinates)
      block%is_checked = block%has_whole .or. rows > unknowns
      allocate (block%whole(merge(size(block%forms), 0, block%has_whole)))
      do i = 1, size(block%whole)
        block%whole(i) = block%forms(i)
        if (plan%closures(planned%first_closure + i - 1)%coupling == 0) &
          block%whole(i) = closure_form(plan, support, planned, planned%first_closure + i - 1, n, 6)
      end do
      allocate (block%columns(unknowns, 0:2))
      do i = 0, 2
        block%columns(:, i) = 3*planned%coordinates - 2 + i
      end do
      call block%equations%create(rows, unknowns)
      block%equations%regular_pivot = planned%regular_pivot
    end associate
    block%by_solver = rows == 3 .and. unknowns == 3 .or. rows <= (highest + 1)*n
    ! openings are combined three at a time
    padded = 3*((rows + 2)/3)
    allocate (block%jacobian(rows, unknowns), block%solver(padded, unknowns), block%openings(n, padded), block%parts(n, 6), &
              block%sizes(n), block%right(rows), block%change(unknowns), source=0.0_wp)
  end function new_varied_block

  !> Factorize the equations of a block from the columns of its forms.
  subroutine factorize(block)
    type(varied_block_type), intent(inout) :: block   !< with its columns; gets the factors
    integer :: i, j, u, r, row

    row = 0
    do i = 1, size(block%forms)
      associate (form => block%forms(i))
        do j = form%n_given + 1, size(form%steps)
          u = form%unknowns(j)
          do r = 1, form%rows
            block%jacobian(row + r, u) = form%columns(r, 0, j)*block%units(u)
          end do
        end do
        row = row + form%rows
      end associate
    end do
    call block%equations%factorize(block%jacobian)
    if (block%by_solver) call find_solver(block)
  end subroutine factorize

  !> Find the share of each opening in each unknown.
  subroutine find_solver(block)
    type(varied_block_type), intent(inout) :: block   !< with its factors
    integer :: r, u

    if (block%equations%by_cofactors) then
      do u = 1, 3
        do r = 1, 3
          block%solver(r, u) = -block%units(u)*block%equations%inverse(u, r)
        end do
      end do
      return
    end if
    do r = 1, size(block%right)
      block%right = 0.0_wp
      block%right(r) = -1.0_wp
      call block%equations%solve(block%right, block%change)
      do u = 1, size(block%units)
        block%solver(r, u) = block%units(u)*block%change(u)
      end do
    end do
  end subroutine find_solver

  !> Find the derivatives of the unknowns of a block, in all orders.
  subroutine solve_block(model, plan, state, tangents, highest, n, m, block, q, opened_by)
    type(model_type), intent(in) :: model               !< the present model
    type(plan_type), intent(in) :: plan                 !< the plan
    type(state_type), intent(in) :: state               !< the motion
    type(tangent_type), intent(in) :: tangents(:)       !< (P) derivatives of constants
    integer, intent(in) :: highest                      !< order of the highest derivative
    integer, intent(in) :: n                            !< number of parameters
    integer, intent(in) :: m                            !< number of coordinates
    type(varied_block_type), intent(inout) :: block     !< with its factors
    real(wp), intent(inout) :: q(n, 0:2, m)             !< derivatives of the coordinates; gets the unknowns
    integer, intent(out) :: opened_by                   !< parameter that opens a chain; 0: none
    integer :: order, i, row

    opened_by = 0
    do order = 0, highest
      row = 1
      do i = 1, size(block%forms)
        call find_values(block%forms(i), n, m, order, .false., q, block%openings(1, row))
        if (plan%closures(block%first_closure + i - 1)%coupling > 0) &
          call add_coupling(model, plan, state, tangents, block%first_closure + i - 1, order, block%openings(:, row))
        row = row + block%forms(i)%rows
      end do
      if (block%by_solver) then
        call solve_for(n, m, size(block%units), size(block%solver, 1), block%solver, block%openings, &
                       block%columns(:, order), q)
      else
        call solve_one_by_one(block, order, n, m, q)
      end if
      if (order == 0 .and. block%is_checked) call find_opened(model, plan, state, tangents, n, m, block, q, opened_by)
      if (opened_by > 0) return
    end do
  end subroutine solve_block

  !> Solve for each parameter on its own, where there are fewer of them than equations.
  subroutine solve_one_by_one(block, order, n, m, q)
    type(varied_block_type), intent(inout) :: block     !< with its factors and openings
    integer, intent(in) :: order                        !< of the derivative in time
    integer, intent(in) :: n                            !< number of parameters
    integer, intent(in) :: m                            !< number of coordinates
    real(wp), intent(inout) :: q(n, 0:2, m)             !< derivatives of the coordinates; gets the unknowns
    integer :: p, u

    do p = 1, n
      block%right = -block%openings(p, :size(block%right))
      call block%equations%solve(block%right, block%change)
      do u = 1, size(block%units)
        q(p, order, block%coordinates(u)) = block%units(u)*block%change(u)
      end do
    end do
  end subroutine solve_one_by_one

  !> Add the share of the numbers of a coupling in the variation of its equation.
  subroutine add_coupling(model, plan, state, tangents, c, order, openings)
    type(model_type), intent(in) :: model           !< the present model
    type(plan_type), intent(in) :: plan             !< the plan
    type(state_type), intent(in) :: state           !< the motion
    type(tangent_type), intent(in) :: tangents(:)   !< (P) derivatives of constants
    integer, intent(in) :: c                        !< number of the closure that is the coupling
    integer, intent(in) :: order                    !< of the derivative in time
    real(wp), intent(inout) :: openings(:)          !< (P) the variation of the equation
    real(wp) :: own
    integer :: i, k, p

    do p = 1, size(tangents)
      associate (part => tangents(p)%couplings(plan%closures(c)%coupling), &
                 coupling => model%mechanism%couplings(plan%closures(c)%coupling)%coupling)
        if (.not. part%varies) cycle
        own = 0.0_wp
        do i = 1, size(coupling%coordinates)
          k = coupling%coordinates(i)
          select case (order)
          case (0)
            own = own + coupling%varied_term(part%change, i, state%q(k), 0)
          case (1)
            own = own + coupling%varied_term(part%change, i, state%q(k), 1)*state%dq(k)
          case default
            own = own + coupling%varied_term(part%change, i, state%q(k), 1)*state%ddq(k) &
                  + coupling%varied_term(part%change, i, state%q(k), 2)*state%dq(k)**2
          end select
        end do
        openings(p) = openings(p) + plan%closures(c)%weight*own
      end associate
    end do
  end subroutine add_coupling

  !> Find a parameter for which no change of the unknowns keeps a chain closed: the equations of the block left it out because they
  !> do not change in any motion of the mechanism, but they change with the parameter.
  subroutine find_opened(model, plan, state, tangents, n, m, block, q, opened_by)
    type(model_type), intent(in) :: model               !< the present model
    type(plan_type), intent(in) :: plan                 !< the plan
    type(state_type), intent(in) :: state               !< the motion
    type(tangent_type), intent(in) :: tangents(:)       !< (P) derivatives of constants
    integer, intent(in) :: n                            !< number of parameters
    integer, intent(in) :: m                            !< number of coordinates
    type(varied_block_type), intent(inout) :: block     !< with its forms
    real(wp), intent(in) :: q(n, 0:2, m)                !< derivatives of the coordinates
    integer, intent(out) :: opened_by                   !< the parameter; 0: none
    integer :: i

    opened_by = 0
    do i = 1, size(block%forms)
      if (block%has_whole) then
        call judge(block%whole(i))
      else
        call judge(block%forms(i))
      end if
      if (opened_by > 0) return
    end do
  contains

    !> Judge the opening of one closure.
    subroutine judge(form)
      type(linear_form_type), intent(in) :: form   !< its opening
      integer :: p, c

      c = block%first_closure + i - 1
      call find_values(form, n, m, 0, .true., q, block%parts)
      block%sizes = 0.0_wp
      call add_sizes(form, n, m, q, block%sizes)
      if (plan%closures(c)%coupling > 0) then
        call add_coupling(model, plan, state, tangents, c, 0, block%parts(:, 1))
        block%sizes = max(block%sizes, abs(block%parts(:, 1)))
      end if
      do p = 1, n
        if (maxval(abs(block%parts(p, :form%rows))) <= &
            max(opened_by_parameter, inexact_dimensions*plan%data_tolerance)*block%sizes(p)) cycle
        opened_by = p
        return
      end do
    end subroutine judge
  end subroutine find_opened
end module mech9_varied_block
