!> The nearest design that moves through the whole run, on the way from one that may not to others that may.
module mech9_moving_design
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_plan, only: new_state
  use mech9_state, only: state_type
  use mech9_design_space, only: design_type, place_design
  use mech9_targets, only: target_type
  use mech9_sampled_run, only: reach
  use mech9_branch, only: follow
  use mech9_free_times, only: choose_pivots, gaps_of
  use mech9_exact_fit, only: exact_fit_type, search_place_type, begin_at
  use mech9_design_limits, only: design_limits_type
  use mech9_limited_fit, only: limited_fit_type, new_limited_fit, find_value
  implicit none
  private
  public :: find_moving

  !> Parts of the way to another design.
  real(wp), parameter :: parts_of_way(8) = [0.0_wp, 0.01_wp, 0.03_wp, 0.08_wp, 0.2_wp, 0.4_wp, 0.7_wp, 1.0_wp]

contains

  !> Find a design that moves. The one at the place is tried first, then others towards each of some designs.
  subroutine find_moving(fit, design, t, others, place, found)
    type(exact_fit_type), intent(inout), target :: fit       !< the fit
    type(design_type), intent(inout) :: design               !< scratch
    real(wp), intent(in) :: t                                !< a time in the run [s]
    real(wp), intent(in) :: others(:, :)                     !< (P,designs) other designs, parameters as parts of their ranges
    type(search_place_type), intent(inout) :: place          !< with coordinates at this time, nearly closed; then at the start
    logical, intent(out) :: found                            !< a design was found
    type(limited_fit_type) :: limited
    type(design_limits_type) :: none
    real(wp) :: trial(size(place%x)), q_trial(size(place%q))
    integer :: i, k

    call new_limited_fit(fit, none, limited)
    call choose_pivots(place%parts, fit%free)
    do k = 1, size(others, 2)
      do i = merge(1, 2, k == 1), size(parts_of_way)
        trial = place%x + parts_of_way(i)*(others(:, k) - place%x)
        q_trial = place%q
        call try_design(trial, q_trial)
        if (found) exit
      end do
      if (found) exit
    end do
    if (.not. found) return
    place%x = trial
    place%q = q_trial
  contains
    !> Try whether a design moves.
    subroutine try_design(x, q)
      real(wp), intent(in) :: x(:)       !< its parameters as parts of their ranges
      real(wp), intent(inout) :: q(:)    !< coordinates at the time, then at the start [rad, m]
      type(state_type) :: state
      type(target_type) :: nowhere
      type(error_type), allocatable :: err
      real(wp) :: value

      found = .false.
      call place_design(fit%space, fit%space%low + x*(fit%space%high - fit%space%low), design, err)
      if (allocated(err)) return
      if (i > 1) then
        state = new_state(design%plan)
        state%q = q
        call reach(design, t, nowhere, state, found)
        if (.not. found) return
        q = state%q
      end if
      call follow(design, t, fit%start, q, found)
      if (.not. found) return
      call begin_at(q, fit)
      call find_value(limited, [x, gaps_of(place%parts, fit%free)], value, found)
      q = fit%q_trial
    end subroutine try_design
  end subroutine find_moving
end module mech9_moving_design
