!> The space of motions of each loop: planar, spherical, translational, another subalgebra, or all six dimensions.
!>
!> It is the smallest Lie algebra that contains the screws of the loop's pairs, and its dimension is the number of equations
!> of the closure (Herve's groups of displacements, docs/reference/bibliography.md).
module mech9_loop_space
  use mech9_kinds, only: wp
  use mech9_tolerances, only: inexact_dimensions, screw_tolerance
  use mech9_error, only: error_type
  use mech9_random, only: random_type
  use mech9_rotation, only: cross, combine, turn
  use mech9_screw, only: generated_algebra
  use mech9_pair, only: pair_motion_type, reversed_motion
  use mech9_plan, only: plan_type, closure_type, new_state, within_range
  use mech9_state, only: state_type
  use mech9_spatial_closure, only: loop_screw
  implicit none
  private
  public :: find_loop_spaces

  !> Number of places at which a pair along a curve shows its screws, and the part of the curve between two of them.
  integer, parameter :: places_on_curve = 8
  real(wp), parameter :: golden = 0.618033988749895_wp

contains

  !> Find rank and rows of the closures. The screws are taken at random coordinates near the guesses: the space that they
  !> generate does not depend on the position, and the loops need not be closed.
  subroutine find_loop_spaces(plan, guess, ranked, complete, err)
    type(plan_type), intent(inout) :: plan   !< the plan of the mechanism
    real(wp), intent(in) :: guess(:)   !< (M) guesses of the coordinates [rad, m]
    logical, intent(in) :: ranked(:)   !< (closures) the rank is known already
    logical, intent(in) :: complete(:)   !< (closures) the rows are known, too
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(state_type) :: state
    type(random_type) :: random
    integer :: c, k

    do c = 1, size(plan%closures)
      plan%constraints(c)%item%equations = plan%closures(c)%rank
    end do
    if (all(complete)) return
    state = new_state(plan)
    do k = 1, plan%n_coordinates
      state%q(k) = guess(k)
      ! a user's pair may have no pose at other coordinates
      if (plan%steps(plan%step_of(k))%searchable) &
        state%q(k) = within_range(plan%steps(plan%step_of(k)), guess(k) + plan%unit_of(k)*random%symmetric())
    end do
    call plan%arithmetics(1)%kind%place(plan, 1, plan%n_coordinates, state, err)
    if (allocated(err)) return
    do c = 1, size(plan%closures)
      if (complete(c) .or. plan%closures(c)%coupling > 0) cycle
      call find_space(plan, state, merge(plan%closures(c)%rank, 6, ranked(c)), plan%closures(c), err)
      if (allocated(err)) return
      plan%constraints(c)%item%equations = plan%closures(c)%rank
    end do
  end subroutine find_loop_spaces

  !> Find rank and rows of one closure from the screws of its loop.
  subroutine find_space(plan, state, most, closure, err)
    type(plan_type), intent(in) :: plan   !< the plan of the mechanism
    type(state_type), intent(in) :: state   !< position and motion of the mechanism
    integer, intent(in) :: most   !< the rank where it is known, else 6
    type(closure_type), intent(inout) :: closure   !< the closure; gets its rank and rows
    type(error_type), allocatable, intent(out) :: err   !< allocated if a pair has no pose where it should have one
    real(wp) :: screws(6, (1 + places_on_curve)*size(closure%loop%steps))
    integer :: i, n, s
    real(wp) :: within

    within = max(screw_tolerance, inexact_dimensions*plan%data_tolerance)
    n = 0
    do i = 1, size(closure%loop%steps)
      s = closure%loop%steps(i)
      n = n + 1
      screws(:, n) = loop_screw(plan, closure, state, state%axis_w(:, s), state%axis_v(:, s), state%p(:, s))
      screws(:, n) = screws(:, n)/norm2(screws(:, n))
      if (plan%steps(s)%is_screw) cycle
      if (plan%steps(s)%searchable) then
        call add_curve(plan, closure, state, s, screws, n, err)
        if (allocated(err)) return
        cycle
      end if
      ! the axis of a user's pair moves: the derivative of its screw belongs to the space too
      n = n + 1
      screws(:, n) = loop_screw(plan, closure, state, state%axis_w_rate(:, s), &
                                state%axis_v_rate(:, s) - cross(state%axis_w(:, s), state%axis_v(:, s)), &
                                state%p(:, s))
      if (norm2(screws(:, n)) > within) then
        screws(:, n) = screws(:, n)/norm2(screws(:, n))
      else
        n = n - 1
      end if
    end do
    call generated_algebra(screws(:, :n), within, closure%rows, closure%rank, most)
    if (closure%rank == 6) closure%rows = 0.0_wp
  end subroutine find_space

  !> Add the screws of a pair along a curve at several places of it, as the departing frame sees them. They all belong to the space:
  !> one place and a derivative there would not show a curve that bends elsewhere.
  subroutine add_curve(plan, closure, state, s, screws, n, err)
    type(plan_type), intent(in) :: plan         !< the plan of the mechanism
    type(closure_type), intent(in) :: closure   !< the closure
    type(state_type), intent(in) :: state       !< with the pose of the frame from which the step leads
    integer, intent(in) :: s                    !< number of the step
    real(wp), intent(inout) :: screws(:, :)     !< (6,:) screws of the loop, of length one
    integer, intent(inout) :: n                 !< how many there are
    type(error_type), allocatable, intent(out) :: err   !< allocated if the pair has no pose
    type(pair_motion_type) :: motion
    real(wp) :: r(3, 3), p(3), along
    integer :: i

    associate (step => plan%steps(s))
      r = combine(state%r(:, :, step%parent), step%before%r)
      p = state%p(:, step%parent) + turn(state%r(:, :, step%parent), step%before%p)
      along = step%period
      if (.not. along > 0.0_wp) along = step%range(2) - step%range(1)
      do i = 1, places_on_curve
        ! at uneven distances, so that symmetric curves do not repeat themselves
        call plan%pairs(step%coordinate)%pair%evaluate(along*modulo(golden*i, 1.0_wp), motion, err)
        if (allocated(err)) return
        if (step%reversed) motion = reversed_motion(motion)
        n = n + 1
        screws(:, n) = loop_screw(plan, closure, state, turn(r, motion%w), turn(r, motion%v), p + turn(r, motion%pose%p))
        screws(:, n) = screws(:, n)/norm2(screws(:, n))
      end do
    end associate
  end subroutine add_curve
end module mech9_loop_space
