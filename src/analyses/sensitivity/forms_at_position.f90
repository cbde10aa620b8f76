!> Parts of the forms in space that are found at each position by itself: twists that are not constant in a frame, equations of chains
!> with fewer than six of them, and couplings.
module mech9_forms_at_position
  use mech9_kinds, only: wp
  use mech9_plan, only: plan_type, closure_type
  use mech9_state, only: state_type
  use mech9_coupling, only: coupling_type
  use mech9_spatial_closure, only: reduced_screw
  use mech9_coupling_constraint, only: coupling_factors
  use mech9_twists, only: frame_twists_type, carried
  use mech9_tangent, only: tangent_type
  use mech9_pair_changes, only: find_pair_change, carry_pair_change
  use mech9_parameter_support, only: varied_constant_type
  use mech9_linear_form, only: linear_form_type, put_share
  implicit none
  private
  public :: find_twist, fill_reduced_columns, put_reduced_shares, fill_coupling_columns, put_coupling_shares

contains

  !> The twist of a constant, seen from frame 0, and its derivatives in time.
  subroutine find_twist(plan, constant, tangent, state, twists, highest, series)
    type(plan_type), intent(in) :: plan                  !< the plan, in space
    type(varied_constant_type), intent(in) :: constant   !< the constant
    type(tangent_type), intent(in) :: tangent            !< derivatives of the constants by its parameter
    type(state_type), intent(in) :: state                !< the motion
    type(frame_twists_type), intent(in) :: twists        !< of its frames
    integer, intent(in) :: highest                       !< order of the highest derivative
    real(wp), intent(out) :: series(6, 0:2)              !< the twist up to this derivative
    real(wp) :: length(0:2), change(6, 0:2)

    if (constant%by_pair) then
      series = 0.0_wp
      call find_pair_change(plan, state, tangent, constant%step, change)
      call carry_pair_change(plan, state, twists, constant%step, change, highest, series)
      return
    end if
    call carried(state, twists, constant%frame, constant%twist, highest, series)
    if (constant%stretched_by == 0) return
    length(0) = state%q(constant%stretched_by) + plan%steps(constant%step)%offset
    length(1) = state%dq(constant%stretched_by)
    length(2) = state%ddq(constant%stretched_by)
    series(:, 2) = length(2)*series(:, 0) + 2.0_wp*length(1)*series(:, 1) + length(0)*series(:, 2)
    series(:, 1) = length(1)*series(:, 0) + length(0)*series(:, 1)
    series(:, 0) = length(0)*series(:, 0)
  end subroutine find_twist

  !> Fill the columns of a closed chain with fewer than six equations: the independent components of its opening.
  pure subroutine fill_reduced_columns(plan, c, state, twists, position, highest, form)
    type(plan_type), intent(in) :: plan                  !< the plan, in space
    integer, intent(in) :: c                             !< number of the closure
    type(state_type), intent(in) :: state                !< the motion
    type(frame_twists_type), intent(in) :: twists        !< of its steps
    integer, intent(in) :: position                      !< number of the position in the batch
    integer, intent(in) :: highest                       !< order of the highest derivative
    type(linear_form_type), intent(inout) :: form        !< gets its columns at this position
    integer :: i, order

    do i = 1, size(form%steps)
      do order = 0, highest
        call reduce(plan, plan%closures(c), state, form%signs(i), twists%step(:, order, form%steps(i)), &
                    form%columns(position, :, order, i))
      end do
      form%columns(position, :, 3, i) = 2.0_wp*form%columns(position, :, 1, i)
    end do
  end subroutine fill_reduced_columns

  !> Put the shares of constants in the opening of such a chain.
  pure subroutine put_reduced_shares(plan, c, state, series, position, highest, form)
    type(plan_type), intent(in) :: plan                  !< the plan, in space
    integer, intent(in) :: c                             !< number of the closure
    type(state_type), intent(in) :: state                !< the motion
    real(wp), intent(in) :: series(:, 0:, :)             !< (6,0:2,constants) twists of constants
    integer, intent(in) :: position                      !< number of the position in the batch
    integer, intent(in) :: highest                       !< order of the highest derivative
    type(linear_form_type), intent(inout) :: form        !< gets its shares at this position
    real(wp) :: few(form%rows, 0:2)
    integer :: i, order

    do i = 1, size(form%constants)
      do order = 0, highest
        call reduce(plan, plan%closures(c), state, form%constant_signs(i), series(:, order, form%constants(i)), few(:, order))
      end do
      call put_share(form, i, position, highest, few)
    end do
  end subroutine put_reduced_shares

  !> The components of a twist in the equations of a closure.
  pure subroutine reduce(plan, closure, state, factor, twist, rows)
    type(plan_type), intent(in) :: plan            !< the plan, in space
    type(closure_type), intent(in) :: closure      !< the closure
    type(state_type), intent(in) :: state          !< with the poses of the frames
    real(wp), intent(in) :: factor                 !< of the twist
    real(wp), intent(in) :: twist(6)               !< rotation, and shift at the origin of frame 0
    real(wp), intent(inout) :: rows(:)             !< the components
    real(wp) :: components(size(rows))

    call reduced_screw(plan, closure, state, twist(1:3), twist(4:6), [0.0_wp, 0.0_wp, 0.0_wp], components)
    rows = factor*components
  end subroutine reduce

  !> Fill the columns of a coupling.
  pure subroutine fill_coupling_columns(plan, c, state, third, position, form)
    type(plan_type), intent(in) :: plan                  !< the plan
    integer, intent(in) :: c                             !< number of the closure that is the coupling
    type(state_type), intent(in) :: state                !< the motion
    real(wp), intent(in) :: third                        !< third derivative of the coupling's function
    integer, intent(in) :: position                      !< number of the position in the batch
    type(linear_form_type), intent(inout) :: form        !< one row; gets its columns at this position
    integer :: i

    associate (coupling => plan%couplings(plan%closures(c)%coupling)%coupling)
      do i = 1, size(form%steps)
        form%columns(position, 1, 0:2, i) = coupling_factors(plan, c, state, third, &
                                                             findloc(coupling%coordinates, form%coordinates(i), dim=1))
        form%columns(position, 1, 3, i) = 2.0_wp*form%columns(position, 1, 1, i)
      end do
    end associate
  end subroutine fill_coupling_columns

  !> Put the shares of the numbers of a coupling.
  subroutine put_coupling_shares(coupling, closure, state, tangents, position, highest, form)
    class(coupling_type), intent(in) :: coupling         !< the coupling of the present model
    type(closure_type), intent(in) :: closure            !< its closure
    type(state_type), intent(in) :: state                !< the motion
    type(tangent_type), intent(in) :: tangents(:)        !< (P) derivatives of constants
    integer, intent(in) :: position                      !< number of the position in the batch
    integer, intent(in) :: highest                       !< order of the highest derivative
    type(linear_form_type), intent(inout) :: form        !< one row; gets its shares at this position
    integer :: p, order

    do p = 1, size(tangents)
      if (form%slots(p) == 0) cycle
      do order = 0, highest
        form%shares(position, 1, order, form%slots(p)) = &
          closure%weight*share_of_numbers(coupling, state, tangents(p)%couplings(closure%coupling)%change, order)
      end do
    end do
  end subroutine put_coupling_shares

  !> The share of the numbers of a coupling in the variation of its function.
  real(wp) function share_of_numbers(coupling, state, change, order) result(share)
    class(coupling_type), intent(in) :: coupling    !< the coupling of the present model
    type(state_type), intent(in) :: state           !< the motion
    real(wp), intent(in) :: change(:)               !< derivatives of these numbers
    integer, intent(in) :: order                    !< of the derivative in time
    integer :: i, k

    share = 0.0_wp
    do i = 1, size(coupling%coordinates)
      k = coupling%coordinates(i)
      select case (order)
      case (0)
        share = share + coupling%varied_term(change, i, state%q(k), 0)
      case (1)
        share = share + coupling%varied_term(change, i, state%q(k), 1)*state%dq(k)
      case default
        share = share + coupling%varied_term(change, i, state%q(k), 1)*state%ddq(k) &
              + coupling%varied_term(change, i, state%q(k), 2)*state%dq(k)**2
      end select
    end do
  end function share_of_numbers
end module mech9_forms_at_position
