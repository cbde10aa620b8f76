!> The variation of the motion of a whole mechanism from that of its independent coordinates: the dependent ones follow block by
!> block, with the factors that close the chains.
!>
!> A closed chain stays closed: the motion of its closing frame relative to the target does not vary, in position, velocity and
!> acceleration. The plan must be in space (`in_space` of the settings of planning).
module mech9_motion_variation
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_plan, only: plan_type, block_type
  use mech9_state, only: state_type
  use mech9_block_solver, only: block_work_type, new_block_work, factorize_block
  use mech9_coupling_constraint, only: varied_coupling
  use mech9_variation, only: variation_type
  use mech9_frame_variation, only: third_derivatives_type, new_third_derivatives, find_third_derivatives, vary_positions, &
    vary_velocities, vary_accelerations
  implicit none
  private
  public :: motion_variation_work_type, new_motion_variation_work, factorize_chains, prepare_variations, &
    vary_motion, vary_position

  !> The parts that all variations of one motion share: the factors of the closed chains, and third derivatives of pairs.
  type :: motion_variation_work_type
    type(block_work_type), allocatable :: blocks(:)   !< of each block
    type(third_derivatives_type) :: third             !< of the pairs without a fixed axis
  end type motion_variation_work_type

  integer, parameter :: position = 0       !< order of a derivative in time
  integer, parameter :: velocity = 1       !< order of a derivative in time
  integer, parameter :: acceleration = 2   !< order of a derivative in time

contains

  !> Scratch for the variations of motions of a plan.
  pure function new_motion_variation_work(plan) result(work)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism, in space
    type(motion_variation_work_type) :: work
    integer :: b

    allocate (work%blocks(size(plan%blocks)))
    do b = 1, size(plan%blocks)
      work%blocks(b) = new_block_work(plan%blocks(b))
    end do
    work%third = new_third_derivatives(plan)
  end function new_motion_variation_work

  !> Factorize the closed chains at a position.
  subroutine factorize_chains(plan, state, work)
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                     !< position of the mechanism
    type(motion_variation_work_type), intent(inout) :: work   !< gets the factors
    integer :: b

    do b = 1, size(plan%blocks)
      if (plan%blocks(b)%equations > 0) call factorize_block(plan, plan%blocks(b), state, work%blocks(b))
    end do
  end subroutine factorize_chains

  !> Find the third derivatives of the pairs that variations of a motion require.
  subroutine prepare_variations(plan, state, work, err)
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                     !< position and motion of the mechanism
    type(motion_variation_work_type), intent(inout) :: work   !< gets the third derivatives of pairs
    type(error_type), allocatable, intent(out) :: err         !< allocated if a pair has no pose

    call find_third_derivatives(plan, state, work%third, err)
  end subroutine prepare_variations

  !> The variation of all coordinates and frames, of their rates and of their accelerations, from those of the independent
  !> coordinates. Variations of dependent coordinates on entry do not count.
  subroutine vary_motion(plan, state, work, variation)
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                     !< position and motion of the mechanism
    type(motion_variation_work_type), intent(inout) :: work   !< prepared for this motion
    type(variation_type), intent(inout) :: variation          !< with the independent coordinates; gets all others
    integer :: b, order

    do order = position, acceleration
      do b = 1, size(plan%blocks)
        call vary_block(plan, plan%blocks(b), state, order, work%blocks(b), work%third, variation)
      end do
    end do
  end subroutine vary_motion

  !> The variation of the position alone.
  subroutine vary_position(plan, state, work, variation)
    type(plan_type), intent(in) :: plan                       !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state                     !< position of the mechanism
    type(motion_variation_work_type), intent(inout) :: work   !< prepared for this position
    type(variation_type), intent(inout) :: variation          !< with the independent coordinates; gets all others
    integer :: b

    do b = 1, size(plan%blocks)
      call vary_block(plan, plan%blocks(b), state, position, work%blocks(b), work%third, variation)
    end do
  end subroutine vary_position

  !> The variation of one block in positions, velocities or accelerations: first with its unknowns held, then with the variations
  !> of the unknowns that keep the chains closed.
  subroutine vary_block(plan, block, state, order, work, third, variation)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism, in space
    type(block_type), intent(in) :: block               !< the block
    type(state_type), intent(in) :: state               !< position and motion of the mechanism
    integer, intent(in) :: order                        !< of the derivative in time
    type(block_work_type), intent(inout) :: work        !< with the factors of the block
    type(third_derivatives_type), intent(in) :: third   !< of the pairs without a fixed axis
    type(variation_type), intent(inout) :: variation    !< with all lower orders, and earlier blocks; gets the block
    integer :: i, k

    call set_unknowns(block%coordinates, order, variation)
    call sweep(plan, state, third, block%first_step, block%last_step, order, variation)
    if (size(block%unknowns) == 0) return
    call find_openings(plan, block, state, third, order, variation, work%right)
    work%right = -work%right
    call work%equations%solve(work%right, work%change)
    do i = 1, size(block%unknowns)
      k = block%coordinates(i)
      select case (order)
      case (position)
        variation%q(k) = work%change(i)*plan%unit_of(k)
      case (velocity)
        variation%dq(k) = work%change(i)*plan%unit_of(k)
      case default
        variation%ddq(k) = work%change(i)*plan%unit_of(k)
      end select
    end do
    call sweep(plan, state, third, block%first_step, block%last_step, order, variation)
  end subroutine vary_block

  !> Make the variations of some coordinates zero.
  pure subroutine set_unknowns(coordinates, order, variation)
    integer, intent(in) :: coordinates(:)              !< numbers of the coordinates
    integer, intent(in) :: order                       !< of the derivative in time
    type(variation_type), intent(inout) :: variation   !< its coordinates, rates or accelerations become zero

    select case (order)
    case (position)
      variation%q(coordinates) = 0.0_wp
    case (velocity)
      variation%dq(coordinates) = 0.0_wp
    case default
      variation%ddq(coordinates) = 0.0_wp
    end select
  end subroutine set_unknowns

  !> Variations of frames from those of the coordinates.
  pure subroutine sweep(plan, state, third, first, last, order, variation)
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism, in space
    type(state_type), intent(in) :: state               !< position and motion of the mechanism
    type(third_derivatives_type), intent(in) :: third   !< of the pairs without a fixed axis
    integer, intent(in) :: first                        !< frames from this one
    integer, intent(in) :: last                         !< to this one
    integer, intent(in) :: order                        !< of the derivative in time
    type(variation_type), intent(inout) :: variation    !< gets the frames

    select case (order)
    case (position)
      call vary_positions(plan, state, first, last, variation)
    case (velocity)
      call vary_velocities(plan, state, first, last, variation)
    case default
      call vary_accelerations(plan, state, third, first, last, variation)
    end select
  end subroutine sweep

  !> The variations of the motions of a block's closing frames relative to their targets, as values of its equations.
  pure subroutine find_openings(plan, block, state, third, order, variation, values)
    type(plan_type), intent(in) :: plan               !< the plan of the mechanism, in space
    type(block_type), intent(in) :: block             !< the block
    type(state_type), intent(in) :: state             !< position and motion of the mechanism
    type(third_derivatives_type), intent(in) :: third   !< of the functions of couplings
    integer, intent(in) :: order                      !< of the derivative in time
    type(variation_type), intent(in) :: variation     !< with the frames
    real(wp), intent(out), contiguous :: values(:)    !< (equations) [rad, lengths of the mechanism; per s or s^2]
    real(wp) :: w(3), v(3)
    integer :: c, row

    row = 0
    do c = block%first_closure, block%last_closure
      associate (constraint => plan%constraints(c)%item)
        if (plan%closures(c)%coupling > 0) then
          associate (number => plan%closures(c)%coupling, k => plan%couplings(plan%closures(c)%coupling)%coupling%coordinates)
            values(row + 1) = varied_coupling(plan, c, state, third%couplings(number), order, &
              reshape([variation%q(k), variation%dq(k), variation%ddq(k)], [3, size(k)], order=[2, 1]))
          end associate
        else
          call find_opening(plan%closures(c)%closing, plan%closures(c)%target, state, order, variation, w, v)
          call constraint%opening(plan, state, w, v, values(row + 1:row + constraint%equations))
        end if
        row = row + constraint%equations
      end associate
    end do
  end subroutine find_openings

  !> The variation of the motion of one frame relative to another that coincides with it.
  pure subroutine find_opening(f, g, state, order, variation, w, v)
    integer, intent(in) :: f                        !< the closing frame
    integer, intent(in) :: g                        !< the target frame
    type(state_type), intent(in) :: state           !< position and motion of the mechanism
    integer, intent(in) :: order                    !< of the derivative in time
    type(variation_type), intent(in) :: variation   !< with the frames
    real(wp), intent(out) :: w(3)                   !< rotation, or its rates [rad, per s or s^2]
    real(wp), intent(out) :: v(3)                   !< of the closing frame's origin [m, per s or s^2]
    real(wp) :: arm(3), arm_change(3), slip(3), slip_change(3)

    arm = state%p(:, f) - state%p(:, g)
    arm_change = variation%shift(:, f) - variation%shift(:, g)
    select case (order)
    case (position)
      w = variation%turn(:, f) - variation%turn(:, g)
      v = arm_change - cross(variation%turn(:, g), arm)
    case (velocity)
      w = variation%omega(:, f) - variation%omega(:, g)
      v = variation%v(:, f) - variation%v(:, g) - cross(variation%omega(:, g), arm) - cross(state%omega(:, g), arm_change)
    case default
      slip = cross(state%omega(:, g), arm)
      slip_change = cross(variation%omega(:, g), arm) + cross(state%omega(:, g), arm_change)
      w = variation%alpha(:, f) - variation%alpha(:, g)
      v = variation%a(:, f) - variation%a(:, g) - cross(variation%alpha(:, g), arm) - cross(state%alpha(:, g), arm_change) &
          - cross(variation%omega(:, g), slip) - cross(state%omega(:, g), slip_change)
    end select
  end subroutine find_opening
end module mech9_motion_variation
