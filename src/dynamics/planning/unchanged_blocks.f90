!> The blocks that a change of independent coordinates leaves as they are.
module mech9_unchanged_blocks
  use mech9_plan, only: plan_type
  use mech9_lagrange_types, only: dynamics_plan_type
  implicit none
  private
  public :: unchanged_blocks

contains

  !> The blocks with the same steps, closures and entries as in the plans in other coordinates, under the same numbers.
  pure function unchanged_blocks(known_plan, known, plan, dynamics) result(unchanged)
    type(plan_type), intent(in) :: known_plan          !< the plan in other coordinates, with the same frames
    type(dynamics_plan_type), intent(in) :: known      !< its plan of dynamics
    type(plan_type), intent(in) :: plan                !< the plan of the mechanism
    type(dynamics_plan_type), intent(in) :: dynamics   !< the plan of dynamics, with all entries
    logical :: unchanged(size(plan%blocks))
    logical :: frame_stays(0:plan%n_coordinates)
    integer :: b, c, s

    frame_stays(0) = .true.
    do s = 1, plan%n_coordinates
      frame_stays(s) = has_same_entries(s)
    end do
    unchanged = .false.
    do b = 1, min(size(plan%blocks), size(known_plan%blocks))
      associate (block => plan%blocks(b), before => known_plan%blocks(b))
        unchanged(b) = all([block%first_step, block%last_step, block%first_closure, block%last_closure, block%arithmetic] == &
                           [before%first_step, before%last_step, before%first_closure, before%last_closure, before%arithmetic])
        if (unchanged(b)) unchanged(b) = all(frame_stays(block%first_step:block%last_step))
        do c = block%first_closure, block%last_closure
          if (.not. unchanged(b)) exit
          unchanged(b) = plan%closures(c)%chain == known_plan%closures(c)%chain .and. all(frame_stays(plan%closures(c)%part%stems))
        end do
      end associate
    end do

  contains

    !> Whether a frame is made by the same step, from the same frame, and moves with the same independent coordinates.
    pure logical function has_same_entries(s) result(same)
      integer, intent(in) :: s   !< number of the frame
      integer :: e

      associate (step => plan%steps(s), before => known_plan%steps(s))
        same = step%coordinate == before%coordinate .and. step%parent == before%parent .and. &
               (step%dependent .eqv. before%dependent) .and. all(dynamics%first(s:s + 1) == known%first(s:s + 1))
      end associate
      if (.not. same) return
      do e = dynamics%first(s), dynamics%first(s + 1) - 1
        same = same .and. plan%independent(dynamics%column(e)) == known_plan%independent(known%column(e))
      end do
    end function has_same_entries
  end function unchanged_blocks
end module mech9_unchanged_blocks
