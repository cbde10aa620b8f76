!> The equation of a coupling as a constraint: a sum of functions of single coordinates, whatever the arithmetic of the frames.
module mech9_coupling_constraint
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_coupling, only: curve_order
  use mech9_plan, only: plan_type, loop_type, constraint_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: coupling_constraint_type, find_curves, curve_of, varied_coupling, coupling_factors, bent_force

  !> The constraint of one coupling.
  type, extends(constraint_type) :: coupling_constraint_type
    integer :: closure = 0   !< its number among the closures of the plan
  contains
    procedure :: residual
    procedure :: jacobian
    procedure :: column
    procedure :: rates
    procedure :: opening
    procedure :: gap
  end type coupling_constraint_type

contains

  !> The residual of the equation, weighed.
  pure subroutine residual(self, plan, state, values)
    class(coupling_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< with the coordinates
    real(wp), intent(out), contiguous :: values(:)        !< (1) [rad, lengths of the mechanism]
    real(wp) :: curve(0:curve_order)
    integer :: i

    values(1) = 0.0_wp
    curve = curve_of(plan, self%closure, state)
    associate (coupling => plan%couplings(plan%closures(self%closure)%coupling)%coupling)
      do i = 1, size(coupling%coordinates)
        values(1) = values(1) + coupling%term(i, state%q(coupling%coordinates(i)), curve, 0)
      end do
    end associate
    values(1) = plan%closures(self%closure)%weight*values(1)
  end subroutine residual

  !> Derivatives with respect to the coordinates of steps of a loop, each in its unit.
  pure subroutine jacobian(self, plan, loop, column_of, state, row, matrix)
    class(coupling_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(loop_type), intent(in) :: loop                   !< steps of coupled coordinates
    integer, allocatable, intent(in) :: column_of(:)      !< (steps of the block) column of each step; 0: none
    type(state_type), intent(in) :: state                 !< with the coordinates
    integer, intent(in) :: row                            !< number of rows of `matrix` before that of this constraint
    real(wp), intent(inout), contiguous :: matrix(:, :)   !< Jacobian of the block; gets the row of this constraint
    integer :: i, s

    do i = 1, size(loop%steps)
      s = loop%steps(i)
      if (s < lbound(column_of, 1)) cycle
      if (column_of(s) == 0) cycle
      call self%column(plan, s, loop%signs(i), state, matrix(row + 1:row + 1, column_of(s)))
    end do
  end subroutine jacobian

  !> The derivative with respect to the coordinate of one step, in its unit.
  pure subroutine column(self, plan, s, sign, state, values)
    class(coupling_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    integer, intent(in) :: s                              !< number of the step
    real(wp), intent(in) :: sign                          !< without meaning
    type(state_type), intent(in) :: state                 !< with the coordinates
    real(wp), intent(out), contiguous :: values(:)        !< (1) [rad, lengths of the mechanism] per unit of the coordinate
    real(wp) :: curve(0:curve_order)
    integer :: i, k

    curve = curve_of(plan, self%closure, state)
    k = plan%steps(s)%coordinate
    associate (coupling => plan%couplings(plan%closures(self%closure)%coupling)%coupling)
      do i = 1, size(coupling%coordinates) - 1
        if (coupling%coordinates(i) == k) exit
      end do
      values(1) = plan%closures(self%closure)%weight*plan%unit_of(k)*coupling%term(i, state%q(k), curve, 1)
    end associate
  end subroutine column

  !> First or second time derivative at the rates, or rates and accelerations, in `state`.
  pure subroutine rates(self, plan, order, state, values)
    class(coupling_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    integer, intent(in) :: order                          !< 1: first derivative, 2: second derivative
    type(state_type), intent(in) :: state                 !< with coordinates, rates and accelerations
    real(wp), intent(out), contiguous :: values(:)        !< (1) [rad, lengths of the mechanism; per s or s^2]
    real(wp) :: curve(0:curve_order)
    integer :: i, k

    values(1) = 0.0_wp
    curve = curve_of(plan, self%closure, state)
    associate (coupling => plan%couplings(plan%closures(self%closure)%coupling)%coupling)
      do i = 1, size(coupling%coordinates)
        k = coupling%coordinates(i)
        if (order == 1) then
          values(1) = values(1) + coupling%term(i, state%q(k), curve, 1)*state%dq(k)
        else
          values(1) = values(1) + coupling%term(i, state%q(k), curve, 1)*state%ddq(k) &
                      + coupling%term(i, state%q(k), curve, 2)*state%dq(k)**2
        end if
      end do
    end associate
    values(1) = plan%closures(self%closure)%weight*values(1)
  end subroutine rates

  !> The motion of frames does not enter a coupling.
  pure subroutine opening(self, plan, state, w, v, values)
    class(coupling_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< without meaning
    real(wp), intent(in) :: w(3)                          !< without meaning
    real(wp), intent(in) :: v(3)                          !< without meaning
    real(wp), intent(out), contiguous :: values(:)        !< (1) zero

    values = 0.0_wp
  end subroutine opening

  !> The residual as a length [m]: an angle times the mechanism's size.
  pure real(wp) function gap(self, plan, state)
    class(coupling_constraint_type), intent(in) :: self   !< the constraint
    type(plan_type), intent(in) :: plan                   !< the plan of the mechanism
    type(state_type), intent(in) :: state                 !< with the coordinates
    real(wp) :: values(1)

    call self%residual(plan, state, values)
    gap = plan%length*abs(values(1))
  end function gap

  !> Find the functions of the couplings among some closures, and their derivatives, at the coordinates in `state`. Fails where one
  !> does not exist.
  subroutine find_curves(plan, first, last, state, err)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    integer, intent(in) :: first                        !< closures from this one
    integer, intent(in) :: last                         !< last one of these
    type(state_type), intent(inout) :: state            !< coordinates in; functions out
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer :: c, number

    do c = first, last
      number = plan%closures(c)%coupling
      if (number == 0) cycle
      associate (coupling => plan%couplings(number)%coupling)
        if (coupling%is_linear()) cycle
        call coupling%find_curve(state%q(coupling%coordinates(1)), state%curve(:, number), err)
      end associate
      if (.not. allocated(err)) cycle
      if (.not. allocated(err%failure)) return
      err%failure%chains = [-number]
      err%failure%t = state%t
      return
    end do
  end subroutine find_curves

  !> The function of a coupling and its derivatives; zero where it is linear.
  pure function curve_of(plan, c, state) result(curve)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    integer, intent(in) :: c                !< number of the closure that is the coupling
    type(state_type), intent(in) :: state   !< with the functions of couplings
    real(wp) :: curve(0:curve_order)

    curve = 0.0_wp
    if (plan%has_curves) curve = state%curve(:, plan%closures(c)%coupling)
  end function curve_of

  !> The variation of the equation, or of its first or second time derivative, from variations of the motion. The motion
  !> itself is in `state`.
  pure real(wp) function varied_coupling(plan, c, state, third, order, changes) result(change)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    integer, intent(in) :: c                !< number of the closure that is the coupling
    type(state_type), intent(in) :: state   !< coordinates, rates and accelerations
    real(wp), intent(in) :: third           !< third derivative of the coupling's function
    integer, intent(in) :: order            !< 0: of the equation; 1, 2: of its time derivatives
    real(wp), intent(in) :: changes(0:, :)  !< (0:2,coordinates of the coupling) variations of their values, rates and accelerations
    real(wp) :: factors(0:2)
    integer :: i

    change = 0.0_wp
    do i = 1, size(changes, 2)
      factors = coupling_factors(plan, c, state, third, i)
      select case (order)
      case (0)
        change = change + factors(0)*changes(0, i)
      case (1)
        change = change + factors(0)*changes(1, i) + factors(1)*changes(0, i)
      case default
        change = change + factors(0)*changes(2, i) + 2.0_wp*factors(1)*changes(1, i) + factors(2)*changes(0, i)
      end select
    end do
  end function varied_coupling

  !> The derivative of the equation by one of its coordinates, and the first two derivatives of this number in time.
  pure function coupling_factors(plan, c, state, third, i) result(factors)
    type(plan_type), intent(in) :: plan     !< the plan of the mechanism
    integer, intent(in) :: c                !< number of the closure that is the coupling
    type(state_type), intent(in) :: state   !< coordinates, rates and accelerations
    real(wp), intent(in) :: third           !< third derivative of the coupling's function
    integer, intent(in) :: i                !< place of the coordinate in the coupling
    real(wp) :: factors(0:2)
    real(wp) :: curve(0:curve_order), bend
    integer :: k

    curve = curve_of(plan, c, state)
    associate (coupling => plan%couplings(plan%closures(c)%coupling)%coupling)
      k = coupling%coordinates(i)
      bend = coupling%term(i, state%q(k), curve, 2)
      factors = [coupling%term(i, state%q(k), curve, 1), bend*state%dq(k), bend*state%ddq(k)]
      ! the function is subtracted
      if (i == 1) factors(2) = factors(2) - third*state%dq(k)**2
    end associate
    factors = plan%closures(c)%weight*factors
  end function coupling_factors

  !> Add to forces on coordinates the change of those of a coupling whose multiplier is held while coordinates vary.
  pure subroutine bent_force(plan, c, state, multiplier, q, forces)
    type(plan_type), intent(in) :: plan      !< the plan of the mechanism
    integer, intent(in) :: c                 !< number of the closure that is the coupling
    type(state_type), intent(in) :: state    !< with the coordinates
    real(wp), intent(in) :: multiplier       !< of the weighed equation
    real(wp), intent(in) :: q(:)             !< (M) variations of the coordinates
    real(wp), intent(inout) :: forces(:)     !< (M) the sum [N m, N]
    real(wp) :: curve(0:curve_order)
    integer :: i, k

    curve = curve_of(plan, c, state)
    associate (coupling => plan%couplings(plan%closures(c)%coupling)%coupling)
      do i = 1, size(coupling%coordinates)
        k = coupling%coordinates(i)
        forces(k) = forces(k) + plan%closures(c)%weight*multiplier*coupling%term(i, state%q(k), curve, 2)*q(k)
      end do
    end associate
  end subroutine bent_force
end module mech9_coupling_constraint
