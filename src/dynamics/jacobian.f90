!> Jacobians of frames with respect to the independent coordinates, with the dependent coordinates eliminated block by block.
module mech9_jacobian
  use mech9_kinds, only: wp
  use mech9_tolerances, only: round_off_of_rates
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type
  use mech9_frame_columns, only: jacobian_type
  use mech9_lagrange_types, only: dynamics_plan_type
  implicit none
  private
  public :: start_jacobian, find_jacobian, rates_by_independent

contains

  !> Set the part of B that never changes: the rate of an independent coordinate by itself is one, by any other zero.
  pure subroutine start_jacobian(plan, dynamics, jacobian)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(jacobian_type), intent(inout) :: jacobian     !< gets `b`
    integer :: s, e

    allocate (jacobian%b(size(dynamics%column)), source=0.0_wp)
    do s = 1, plan%n_coordinates
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        if (plan%steps(s)%dependent) cycle
        if (dynamics%column(e) == dynamics%place_of(plan%steps(s)%coordinate)) jacobian%b(e) = 1.0_wp
      end do
    end do
  end subroutine start_jacobian

  !> The rate of a coordinate per rate of each independent one.
  pure subroutine rates_by_independent(plan, dynamics, jacobian, coordinate, row)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    type(jacobian_type), intent(in) :: jacobian        !< of all blocks
    integer, intent(in) :: coordinate                  !< number of the coordinate
    real(wp), intent(out) :: row(:)                    !< (independent) the rates
    integer :: e, s

    ! of an independent coordinate also where nothing depends on it and the entries are left out
    row = merge(1.0_wp, 0.0_wp, plan%independent == coordinate)
    if (any(plan%independent == coordinate)) return
    s = plan%step_of(coordinate)
    do e = dynamics%first(s), dynamics%first(s + 1) - 1
      row(dynamics%column(e)) = row(dynamics%column(e)) + jacobian%b(e)
    end do
  end subroutine rates_by_independent

  !> Find the entries of a block's frames and its part of B = dq/dq_i. The frames must have their poses, the block's Jacobian
  !> must be factorized, and earlier blocks must be done. Where round-off hides the rate of a dependent coordinate, near a
  !> position where branches meet, the rate keeps its expected value, so that the motion goes on in the same direction.
  subroutine find_jacobian(plan, dynamics, b, state, expected, work, jacobian)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    integer, intent(in) :: b                           !< number of the block
    type(state_type), intent(in) :: state              !< with the poses of the frames
    real(wp), intent(in) :: expected(:)                !< (entries) B, extrapolated from earlier evaluations
    type(block_work_type), intent(inout) :: work       !< with the block's Jacobian factorized; scratch
    type(jacobian_type), intent(inout) :: jacobian     !< with the entries of earlier blocks; gets those of this one
    integer :: s, e, c

    associate (block => plan%blocks(b))
      do s = block%first_step, block%last_step
        if (.not. plan%steps(s)%dependent) cycle
        do e = dynamics%first(s), dynamics%first(s + 1) - 1
          jacobian%b(e) = expected(e)
        end do
      end do
      if (size(block%unknowns) > 0) then
        call dynamics%arithmetics(dynamics%arithmetic_of(b))%kind%spread_jacobian(plan, dynamics, block, state, .true., jacobian)
        do c = 1, dynamics%first(block%unknowns(1) + 1) - dynamics%first(block%unknowns(1))
          call eliminate(plan, dynamics, b, state, c - 1, work, jacobian)
        end do
      end if
      call dynamics%arithmetics(dynamics%arithmetic_of(b))%kind%spread_jacobian(plan, dynamics, block, state, .false., jacobian)
    end associate
  end subroutine find_jacobian

  !> Rates of the block's dependent coordinates per unit rate of one independent coordinate, as corrections of the rates b_d
  !> that `jacobian` has: J_d (correction of b_d) = -(relative velocity of the closures' frames with these rates).
  subroutine eliminate(plan, dynamics, b, state, offset, work, jacobian)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    integer, intent(in) :: b                           !< number of the block
    type(state_type), intent(in) :: state              !< with the poses of the frames
    integer, intent(in) :: offset                      !< number of the independent coordinate among those of the block, less one
    type(block_work_type), intent(inout) :: work       !< with the block's Jacobian factorized; scratch
    type(jacobian_type), intent(inout) :: jacobian     !< with expected rates in `b` and their columns; gets the corrected `b`
    integer :: c, e, row, i, s, k

    associate (block => plan%blocks(b), arithmetic => dynamics%arithmetics(dynamics%arithmetic_of(b))%kind)
      row = 0
      do c = block%first_closure, block%last_closure
        associate (rank => plan%closures(c)%rank)
          if (plan%closures(c)%coupling > 0) then
            e = dynamics%first(block%unknowns(1)) + offset
            work%right(row + 1) = coupled_rate(plan, dynamics, c, dynamics%column(e), state, jacobian)
          else
            e = dynamics%first(plan%closures(c)%closing) + offset
            call arithmetic%closing_column(plan, c, state, jacobian, [e, dynamics%target_entry(e)], &
                                           work%right(row + 1:row + rank))
          end if
          row = row + rank
        end associate
      end do
      work%right = -work%right
      k = plan%independent(dynamics%column(dynamics%first(block%unknowns(1)) + offset))
      call work%equations%solve(work%right, work%change, round_off=round_off_of_rates/plan%unit_of(k))
      do i = 1, size(block%unknowns)
        s = block%unknowns(i)
        e = dynamics%first(s) + offset
        jacobian%b(e) = jacobian%b(e) + work%change(i)*plan%unit_of(plan%steps(s)%coordinate)
      end do
    end associate
  end subroutine eliminate

  !> The rate of a coupling's equation per unit rate of one independent coordinate.
  pure real(wp) function coupled_rate(plan, dynamics, c, column, state, jacobian) result(rate)
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics
    integer, intent(in) :: c                           !< number of the closure that is the coupling
    integer, intent(in) :: column                      !< place of the coordinate among the independent ones
    type(state_type), intent(in) :: state              !< with the coordinates
    type(jacobian_type), intent(in) :: jacobian        !< with `b` of the coupling's steps
    real(wp) :: values(1)
    integer :: i, e, s

    rate = 0.0_wp
    do i = 1, size(plan%closures(c)%loop%steps)
      s = plan%closures(c)%loop%steps(i)
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        if (dynamics%column(e) /= column) cycle
        call plan%constraints(c)%item%column(plan, s, 1.0_wp, state, values)
        rate = rate + values(1)*jacobian%b(e)/plan%unit_of(plan%steps(s)%coordinate)
      end do
    end do
  end function coupled_rate
end module mech9_jacobian
