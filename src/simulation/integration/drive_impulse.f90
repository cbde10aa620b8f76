!> The changes of free rates with those of driven ones, at one moment: by the impulse of the drives.
module mech9_drive_impulse
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_driven_equations, only: hold
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_lagrange_types, only: dynamics_plan_type, lagrange_work_type
  use mech9_lagrange, only: find_equations
  use mech9_frame_motion, only: place_all
  implicit none
  private
  public :: find_impulse

contains

  !> Find the changes of the free rates, and of those released, in a position: a_ff (change of dq_f) = -a_fd (change of dq_d). They are linear in those of the
  !> driven rates, so that derivatives of rates by parameters change alike.
  subroutine find_impulse(model, plan, dynamics, state, work, changes, err, released)
    type(model_type), intent(in) :: model                   !< the model
    type(plan_type), intent(in) :: plan                     !< its plan
    type(dynamics_plan_type), intent(in) :: dynamics        !< its plan of dynamics
    type(state_type), intent(inout) :: state                !< the position; its frames are placed
    type(lagrange_work_type), intent(inout) :: work         !< gets the equations of motion there
    real(wp), intent(inout) :: changes(:, :)                !< (M,several) of the rates; those of driven ones are given
    type(error_type), allocatable, intent(out) :: err       !< allocated if a pair has no pose, or a load fails
    integer, intent(in), optional :: released(:)            !< driven coordinates that move freely at this moment
    real(wp) :: a(size(plan%independent), size(plan%independent)), held(size(plan%independent), size(plan%independent))
    real(wp) :: given(size(plan%independent)), right(size(plan%independent))
    integer, allocatable :: still_held(:), moved(:)
    integer :: failed_at, i, j, n

    n = size(plan%independent)
    call place_all(plan, state, err)
    if (.not. allocated(err)) call find_equations(model%mechanism, plan, dynamics, state, work, err)
    if (allocated(err)) return
    a = work%coefficients
    still_held = dynamics%held
    if (present(released)) &
      still_held = pack(still_held, [(all(released /= plan%independent(still_held(i))), i=1, size(still_held))])
    moved = pack([(i, i=1, n)], [(all(still_held /= i), i=1, n)])
    do j = 1, size(changes, 2)
      given = changes(plan%independent, j)
      do i = 1, n
        right(i) = -dot_product(a(i, :i), given(:i)) - dot_product(a(i + 1:, i), given(i + 1:))
      end do
      held = a
      call hold(n, still_held, held, right)
      call cholesky_factorize(n, held, failed_at)
      if (failed_at > 0) return
      call cholesky_solve(n, held, right)
      changes(plan%independent(moved), j) = right(moved)
    end do
  end subroutine find_impulse
end module mech9_drive_impulse
