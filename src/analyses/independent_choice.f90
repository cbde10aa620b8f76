!> Other choices of the independent coordinates in which a dependent one becomes independent, and driven ones stay so.
module mech9_independent_choice
  use mech9_kinds, only: wp
  use mech9_tolerances, only: least_rate
  use mech9_error, only: error_type
  use mech9_masks, only: numbers_of
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_planning, only: make_plan
  use mech9_branch_stepping, only: set_inputs
  use mech9_mobility_report, only: mobility_report_type, report_mobility
  implicit none
  private
  public :: find_choice

contains

  !> The independent coordinates with a dependent one among them, in place of that free one whose rate moves it most; empty where
  !> driven coordinates determine it. Not known where the mechanism cannot be assembled.
  subroutine find_choice(model, coordinate, known, choice)
    type(model_type), intent(in) :: model             !< the model, which is sound but for what is asked of this coordinate
    integer, intent(in) :: coordinate                 !< a dependent coordinate
    logical, intent(out) :: known                     !< a choice was found, or it is certain that there is none
    integer, allocatable, intent(out) :: choice(:)    !< coordinates, ascending
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: state
    type(mobility_report_type) :: report
    type(error_type), allocatable :: err
    real(wp) :: share(size(model%mechanism%pairs)), q(size(share)), dq(size(share)), ddq(size(share))
    logical :: chosen(size(share))
    integer :: best

    allocate (plan, state)
    known = .false.
    allocate (choice(0))
    q = model%problem%initial%position
    call set_inputs(model%problem%drives, model%request%time%start, q, dq, ddq, err)
    if (.not. allocated(err)) call make_plan(model%mechanism, model%problem%partition, q, plan, state, err)
    if (allocated(err)) return
    known = .true.
    call report_mobility(model%mechanism, plan, state, report)
    share = 0.0_wp
    share(plan%independent) = abs(report%shares(coordinate, :))
    where (plan%driven) share = 0.0_wp
    best = maxloc(share, dim=1)
    if (share(best) <= least_rate) return
    chosen = model%problem%partition%independent()
    chosen(best) = .false.
    chosen(coordinate) = .true.
    choice = numbers_of(chosen)
  end subroutine find_choice
end module mech9_independent_choice
