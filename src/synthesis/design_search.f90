!> The search for the best design from one start: in each assembly that is found there, first with chains that may open, then with
!> closed chains along the branch.
module mech9_design_search
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_bounded_least_squares, only: bounds_type, least_squares_settings_type, least_squares_outcome_type, minimise_squares, &
    ended_without_value
  use mech9_plan, only: new_state, within_range
  use mech9_state, only: state_type
  use mech9_counted_random, only: uniform_at
  use mech9_sobol, only: sobol_at, most_sobol_dimensions
  use mech9_design_space, only: design_space_type, design_type, new_design, place_design
  use mech9_open_position, only: open_position_type, new_open_position
  use mech9_targets, only: target_type, outer_times
  use mech9_waypoints, only: gather_waypoints
  use mech9_relaxed_fit, only: relaxed_fit_type, new_relaxed_fit
  use mech9_exact_fit, only: exact_fit_type, search_place_type, new_exact_fit
  use mech9_design_limits, only: design_limits_type, new_design_limits
  use mech9_closed_search, only: found_design_type, search_closed
  use mech9_sampled_run, only: sample_run, reach
  use mech9_moving_design, only: find_moving
  implicit none
  private
  public :: search_type, found_design_type, new_search, search_from, most_assemblies

  !> The tools of a search, which every start uses anew.
  type :: search_type
    type(target_type), allocatable :: targets(:)   !< all targets, then the positions at which chains must be closed
    type(design_limits_type) :: limits
    real(wp), allocatable :: times(:)              !< (targets) their times [s]
    class(relaxed_fit_type), allocatable :: relaxed
    class(exact_fit_type), allocatable :: exact
    class(design_type), allocatable :: design
    type(open_position_type) :: position
    real(wp) :: scale = 1.0_wp              !< size of the targets [m, rad]
  end type search_type

  integer, parameter :: most_assemblies = 8   !< assemblies that are tried from one start
  integer, parameter :: closings = 8          !< random positions from which assemblies are looked for
  !> Weights of the openings of chains, one after the other, and steps with each.
  real(wp), parameter :: weights(3) = [1.0_wp, 10.0_wp, 100.0_wp]
  integer, parameter :: steps_with(3) = [40, 25, 15]

contains

  !> Prepare the tools of a search.
  subroutine new_search(space, targets, seen)
    type(design_space_type), intent(in), target :: space     !< the designs
    type(target_type), intent(in) :: targets(:)              !< the targets
    type(search_type), intent(out) :: seen                   !< the tools
    type(target_type), allocatable :: waypoints(:)
    integer :: i, j

    allocate (seen%design, seen%relaxed, seen%exact)
    call new_design(space, seen%design)
    call new_open_position(seen%design, seen%position)
    call gather_waypoints(space%model, size(targets) > 0, waypoints)
    seen%targets = [targets, waypoints]
    allocate (seen%times(size(seen%targets)), source=space%model%request%time%start)
    call new_relaxed_fit(space, seen%design, seen%position, seen%targets, seen%relaxed)
    call new_exact_fit(space, seen%design, seen%position, targets, seen%exact)
    call new_design_limits(space%plan, space%model%request%limits, seen%limits)
    seen%scale = 0.0_wp
    do i = 1, size(targets)
      do j = 1, i - 1
        if (targets(i)%objective == targets(j)%objective) &
          seen%scale = max(seen%scale, norm2(targets(i)%place - targets(j)%place)*targets(i)%factor)
      end do
    end do
    if (.not. seen%scale > 0.0_wp) seen%scale = 1.0_wp
    seen%relaxed%scale = seen%scale
  end subroutine new_search

  !> Search from one start. The first one has the values of the data file, the others are spread over the ranges.
  subroutine search_from(space, seen, seed, start, found)
    type(design_space_type), intent(inout), target :: space      !< the designs
    type(search_type), intent(inout) :: seen                     !< the tools
    integer, intent(in) :: seed                                  !< another seed gives other starts
    integer, intent(in) :: start                                 !< number of the start, from 1
    type(found_design_type), allocatable, intent(out) :: found(:)!< one for each assembly from which the search was
                                                                 !< made; not allocated where the user interrupted
    real(wp) :: x(size(space%varied)), low, high
    real(wp), allocatable :: closed(:, :)
    type(error_type), allocatable :: err
    logical :: within
    integer :: i

    do i = 1, size(x)
      if (start == 1) then
        x(i) = (space%values(space%varied(i)) - space%low(i))/(space%high(i) - space%low(i))
      else if (size(x) <= most_sobol_dimensions) then
        x(i) = sobol_at(seed, start, i)
      else
        x(i) = uniform_at(seed, start, i)
      end if
    end do
    x = min(max(x, 0.0_wp), 1.0_wp)
    allocate (found(0))
    call place_design(space, space%low + x*(space%high - space%low), seen%design, err)
    if (allocated(err)) return
    low = min(seen%exact%start, seen%exact%end)
    high = max(seen%exact%start, seen%exact%end)
    seen%times = seen%exact%start
    call outer_times(seen%targets, seen%design, low, high, seen%times, within)
    call find_closings(space, seen, start, closed)
    deallocate (found)
    allocate (found(size(closed, 2)))
    do i = 1, size(closed, 2)
      call search_assembly(space, seen, x, closed(:, i), found(i))
    end do
    ! a search that the user ends has not come to its designs
    if (seen%exact%was_cut) deallocate (found)
  end subroutine search_from

  !> Find assemblies at the start of the run from random positions; the nearest position where no chain closes.
  subroutine find_closings(space, seen, start, closed)
    type(design_space_type), intent(in) :: space              !< the designs
    type(search_type), intent(inout) :: seen                  !< the tools, with the design
    integer, intent(in) :: start                              !< number of the start
    real(wp), allocatable, intent(out) :: closed(:, :)        !< (M,assemblies) coordinates [rad, m]
    type(state_type) :: state
    type(target_type) :: nowhere
    real(wp) :: all(space%plan%n_coordinates, most_assemblies), guess(space%plan%n_coordinates)
    logical :: is_closed
    integer :: i, k, n, s

    state = new_state(seen%design%plan)
    n = 0
    do i = 1, closings
      guess = space%model%problem%initial%position
      do k = 1, merge(0, size(guess), i == 1)
        s = space%plan%step_of(k)
        if (space%plan%steps(s)%dependent) guess(k) = within_range(space%plan%steps(s), guess(k) + pi*space%plan%unit_of(k) &
                                                                   *(2.0_wp*uniform_at(1000 + i, start, k) - 1.0_wp))
      end do
      state%q = guess
      call reach(seen%design, seen%exact%start, nowhere, state, is_closed)
      if (i == 1) all(:, 1) = state%q
      if (.not. is_closed) cycle
      if (is_known(space, state%q, all(:, :n))) cycle
      n = n + 1
      all(:, n) = state%q
      if (n == most_assemblies) exit
    end do
    closed = all(:, :max(n, 1))
  end subroutine find_closings

  !> Whether a position is among others, but for whole turns.
  pure logical function is_known(space, q, others)
    type(design_space_type), intent(in) :: space    !< the designs
    real(wp), intent(in) :: q(:)                    !< (M) the position [rad, m]
    real(wp), intent(in) :: others(:, :)            !< (M,n) other positions
    real(wp) :: apart, period
    integer :: i, k
    logical :: same

    is_known = .false.
    do i = 1, size(others, 2)
      same = .true.
      do k = 1, size(q)
        apart = q(k) - others(k, i)
        period = space%plan%steps(space%plan%step_of(k))%period
        if (period > 0.0_wp) apart = apart - period*anint(apart/period)
        same = same .and. abs(apart) <= 1.0e-6_wp*space%plan%unit_of(k)
      end do
      is_known = is_known .or. same
    end do
  end function is_known

  !> Search from one position at the start of the run.
  subroutine search_assembly(space, seen, x_start, q_start, found)
    type(design_space_type), intent(inout), target :: space  !< the designs
    type(search_type), intent(inout) :: seen                 !< the tools, with the design
    real(wp), intent(in) :: x_start(:)                       !< parameters as parts of their ranges
    real(wp), intent(in) :: q_start(:)                       !< (M) coordinates at the start [rad, m]
    type(found_design_type), intent(out) :: found            !< the design to which the search led
    type(least_squares_settings_type) :: settings
    type(least_squares_outcome_type) :: outcome
    type(error_type), allocatable :: err
    real(wp) :: x(size(x_start)), y(seen%relaxed%n_y, seen%relaxed%groups)
    type(bounds_type) :: bounds
    type(search_place_type) :: place
    integer :: i, first
    logical :: came

    x = x_start
    call place_design(space, space%low + x*(space%high - space%low), seen%design, err)
    if (allocated(err)) return
    call sample_run(seen%relaxed, seen%design, seen%position, seen%times, q_start, y)
    bounds%low = [(0.0_wp, i=1, size(x))]
    bounds%high = [(1.0_wp, i=1, size(x))]
    allocate (bounds%y_high(size(y, 1), size(y, 2)), source=1.0e10_wp)
    bounds%y_low = -bounds%y_high
    bounds%y_low(size(y, 1), :) = 0.0_wp
    bounds%y_high(size(y, 1), :) = 1.0_wp
    settings%short = 1.0e-4_wp
    settings%flat = 1.0e-4_wp
    do i = 1, size(weights)
      seen%relaxed%closing = weights(i)
      settings%most_steps = steps_with(i)
      call minimise_squares(seen%relaxed, x, y, bounds, settings, outcome)
      if (outcome%kind == ended_without_value) return
    end do
    call place_design(space, space%low + x*(space%high - space%low), seen%design, err)
    if (allocated(err)) return
    seen%times = seen%exact%start + y(size(y, 1), :)*(seen%exact%end - seen%exact%start)
    call outer_times(seen%targets, seen%design, min(seen%exact%start, seen%exact%end), max(seen%exact%start, seen%exact%end), &
                     seen%times, came)
    first = minloc((seen%times - seen%exact%start)*sign(1.0_wp, seen%exact%end - seen%exact%start), dim=1, &
                   mask=seen%targets%turned == 0)
    place%x = x
    associate (targets => seen%exact%free%target)
      place%parts = [(y(size(y, 1), targets(i)), i=1, size(targets))]
    end associate
    place%q = space%model%problem%initial%position
    associate (dependent => seen%relaxed%dependent)
      do i = 1, size(dependent)
        place%q(dependent(i)) = y(i, first)*space%plan%unit_of(dependent(i))
      end do
    end associate
    associate (file => (space%values(space%varied) - space%low)/(space%high - space%low))
      call find_moving(seen%exact, seen%design, seen%times(first), &
                       reshape([x_start, min(max(file, 0.0_wp), 1.0_wp)], [size(x), 2]), place, came)
    end associate
    if (came) call search_closed(seen%exact, seen%limits, seen%scale, place, found)
  end subroutine search_assembly
end module mech9_design_search
