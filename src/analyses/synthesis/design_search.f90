!> The search for the best design from one start: in each assembly that is found there, first with chains that may open, then with
!> closed chains along the branch.
module mech9_design_search
  use mech9_kinds, only: wp, pi
  use mech9_error, only: error_type
  use mech9_bounded_least_squares, only: least_squares_settings_type, least_squares_outcome_type, minimise_squares, &
    ended_without_value
  use mech9_plan, only: new_state, within_range
  use mech9_state, only: state_type
  use mech9_block_solver, only: new_block_work, block_work_type
  use mech9_assembly, only: assemble_block, assembly_outcome_type
  use mech9_frame_motion, only: place_all
  use mech9_branch_stepping, only: set_inputs
  use mech9_counted_random, only: uniform_at
  use mech9_sobol, only: sobol_at, most_sobol_dimensions
  use mech9_objective, only: timing_free
  use mech9_design_space, only: design_space_type, design_type, new_design, place_design
  use mech9_open_position, only: open_position_type, new_open_position, find_openings
  use mech9_targets, only: target_type, difference, outer_times
  use mech9_relaxed_fit, only: relaxed_fit_type, new_relaxed_fit
  use mech9_exact_fit, only: exact_fit_type, new_exact_fit, follow
  implicit none
  private
  public :: search_type, found_design_type, new_search, search_from, most_assemblies

  !> A design to which a search led.
  type :: found_design_type
    logical :: found = .false.              !< the search came to a design that can move through the whole run
    real(wp) :: value = huge(1.0_wp)        !< weighted sum of squares
    real(wp), allocatable :: x(:)           !< values of the varied parameters, in the units of the file
    real(wp), allocatable :: q(:)           !< (M) coordinates at the start of the run [rad, m]
    real(wp), allocatable :: times(:)       !< (targets) times of the targets [s]
  end type found_design_type

  !> The tools of a search, which every start uses anew.
  type :: search_type
    type(target_type), allocatable :: targets(:)
    type(relaxed_fit_type) :: relaxed
    type(exact_fit_type) :: exact
    type(design_type) :: design
    type(open_position_type) :: position
    real(wp) :: scale = 1.0_wp              !< size of the targets [m, rad]
  end type search_type

  integer, parameter :: most_assemblies = 8   !< assemblies that are tried from one start
  integer, parameter :: closings = 8          !< random positions from which assemblies are looked for
  integer, parameter :: fewest_samples = 48   !< positions at which free times are looked for
  !> Weights of the openings of chains, one after the other, and steps with each.
  real(wp), parameter :: weights(3) = [1.0_wp, 10.0_wp, 100.0_wp]
  integer, parameter :: steps_with(3) = [40, 25, 15]

contains

  !> Prepare the tools of a search.
  subroutine new_search(space, targets, seen)
    type(design_space_type), intent(in), target :: space     !< the designs
    type(target_type), intent(in) :: targets(:)              !< the targets
    type(search_type), intent(out) :: seen                   !< the tools
    integer :: i, j

    seen%targets = targets
    call new_design(space, seen%design)
    call new_open_position(seen%design, seen%position)
    call new_relaxed_fit(space, seen%design, seen%position, targets, seen%relaxed)
    call new_exact_fit(space, seen%design, seen%position, targets, seen%exact)
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
    type(found_design_type), allocatable, intent(out) :: found(:)!< one for each assembly from which the search was made
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
    seen%exact%times = seen%exact%start
    call outer_times(seen%targets, seen%design, low, high, seen%exact%times, within)
    call find_closings(space, seen, start, closed)
    deallocate (found)
    allocate (found(size(closed, 2)))
    do i = 1, size(closed, 2)
      call search_assembly(space, seen, x, closed(:, i), found(i))
    end do
  end subroutine search_from

  !> Find assemblies at the start of the run from random positions; the nearest position where no chain closes.
  subroutine find_closings(space, seen, start, closed)
    type(design_space_type), intent(in) :: space              !< the designs
    type(search_type), intent(inout) :: seen                  !< the tools, with the design
    integer, intent(in) :: start                              !< number of the start
    real(wp), allocatable, intent(out) :: closed(:, :)        !< (M,assemblies) coordinates [rad, m]
    type(state_type) :: state
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
      call reach(seen%design, seen%exact%start, state, is_closed)
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

  !> Close all chains from the coordinates in the state, or come as near as damped least squares lead.
  subroutine reach(design, t, state, closed)
    type(design_type), intent(in) :: design       !< placed
    real(wp), intent(in) :: t                     !< time [s]
    type(state_type), intent(inout) :: state      !< coordinates in and out
    logical, intent(out) :: closed                !< all chains are closed
    type(block_work_type) :: work
    type(assembly_outcome_type) :: outcome
    type(error_type), allocatable :: err
    integer :: b

    closed = .false.
    state%t = t
    call set_inputs(design%drives, t, state%q, state%dq, state%ddq, err)
    if (.not. allocated(err)) call place_all(design%plan, state, err)
    if (allocated(err)) return
    closed = .true.
    do b = 1, size(design%plan%blocks)
      if (size(design%plan%blocks(b)%unknowns) == 0) cycle
      work = new_block_work(design%plan%blocks(b))
      call assemble_block(design%plan, design%plan%blocks(b), state, work, .false., outcome, err)
      closed = closed .and. outcome%closed .and. .not. allocated(err)
    end do
  end subroutine reach

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
    real(wp) :: x(size(x_start)), y(seen%relaxed%own, seen%relaxed%groups), free(size(y, 1), size(y, 2)), q(size(q_start))
    real(wp) :: low(size(x_start)), high(size(x_start))
    integer :: i, first
    logical :: came

    low = 0.0_wp
    high = 1.0_wp
    x = x_start
    call place_design(space, space%low + x*(space%high - space%low), seen%design, err)
    if (allocated(err)) return
    call sample_run(seen, q_start, y)
    free = 1.0e10_wp
    free(size(y, 1), :) = 1.0_wp
    settings%short = 1.0e-4_wp
    settings%flat = 1.0e-4_wp
    do i = 1, size(weights)
      seen%relaxed%closing = weights(i)
      settings%most_steps = steps_with(i)
      call minimise_squares(seen%relaxed, x, y, low, high, &
                            merge(0.0_wp, -free, spread([(first == size(y, 1), first=1, size(y, 1))], 2, size(y, 2))), free, &
                            settings, outcome)
      if (outcome%kind == ended_without_value) return
    end do
    call place_design(space, space%low + x*(space%high - space%low), seen%design, err)
    if (allocated(err)) return
    seen%exact%times = seen%exact%start + y(size(y, 1), :)*(seen%exact%end - seen%exact%start)
    call outer_times(seen%targets, seen%design, min(seen%exact%start, seen%exact%end), max(seen%exact%start, seen%exact%end), &
                     seen%exact%times, came)
    first = minloc((seen%exact%times - seen%exact%start)*sign(1.0_wp, seen%exact%end - seen%exact%start), dim=1)
    q = space%model%problem%initial%position
    q(seen%exact%dependent) = y(:size(y, 1) - 1, first)*space%plan%unit_of(seen%exact%dependent)
    call follow(seen%design, seen%exact%times(first), seen%exact%start, q, came)
    if (came) call fit_exactly(space, seen, x, y(size(y, 1):, :), q, found)
  end subroutine search_assembly

  !> Improve a design whose chains are closed at the start of the run.
  subroutine fit_exactly(space, seen, x, times, q, found)
    type(design_space_type), intent(in) :: space             !< the designs
    type(search_type), intent(inout) :: seen                 !< the tools
    real(wp), intent(in) :: x(:)                             !< parameters as parts of their ranges
    real(wp), intent(in) :: times(:, :)                      !< (1,targets) times as parts of the run
    real(wp), intent(in) :: q(:)                             !< (M) coordinates at the start of the run [rad, m]
    type(found_design_type), intent(out) :: found            !< the design to which the search led
    type(least_squares_settings_type) :: settings
    type(least_squares_outcome_type) :: outcome
    real(wp) :: at(size(x)), y(seen%exact%own, seen%exact%groups), low(size(x)), high(size(x)), last(size(y, 1), size(y, 2))

    low = 0.0_wp
    high = 1.0_wp
    at = x
    y = times(:seen%exact%own, :)
    last = 1.0_wp
    seen%exact%q_start = q
    seen%exact%work = 0
    settings%small = (1.0e-14_wp*seen%scale)**2*size(seen%targets)
    settings%short = 1.0e-9_wp
    call minimise_squares(seen%exact, at, y, low, high, 0.0_wp*last, last, settings, outcome)
    found%found = outcome%kind /= ended_without_value
    if (.not. found%found) return
    found%value = outcome%value
    found%x = space%low + at*(space%high - space%low)
    found%q = seen%exact%q_start
    found%times = seen%exact%times
    if (seen%exact%own > 0) found%times = seen%exact%start + y(1, :)*(seen%exact%end - seen%exact%start)
  end subroutine fit_exactly

  !> Sample the run from a position at its start, with chains closed or nearly so, and choose the coordinates and times of the
  !> targets: those with free times are assigned in their order to the samples that are nearest to them.
  subroutine sample_run(seen, q_start, y)
    type(search_type), intent(inout) :: seen             !< the tools, with the design
    real(wp), intent(in) :: q_start(:)                   !< (M) coordinates at the start [rad, m]
    real(wp), intent(out) :: y(:, :)                     !< (own,targets) dependent coordinates in their units, and times
    type(state_type) :: state
    type(error_type), allocatable :: err
    real(wp), allocatable :: q(:, :), times(:), squares(:, :)
    real(wp) :: r(3), by_q(3, size(q_start)), by_x(3, size(seen%design%x)), time
    integer, allocatable :: at(:)
    integer :: i, g, n
    logical :: closed

    n = max(fewest_samples, 3*size(seen%targets))
    allocate (q(size(q_start), 0:n), times(0:n), squares(size(seen%targets), 0:n))
    state = new_state(seen%design%plan)
    state%q = q_start
    do i = 0, n
      times(i) = seen%exact%start + (seen%exact%end - seen%exact%start)*i/n
      call reach(seen%design, times(i), state, closed)
      q(:, i) = state%q
      seen%position%state%t = times(i)
      seen%position%state%q = state%q
      call set_inputs(seen%design%drives, times(i), seen%position%state%q, seen%position%state%dq, seen%position%state%ddq, err)
      if (.not. allocated(err)) call find_openings(seen%design, seen%position, err)
      do g = 1, size(seen%targets)
        call difference(seen%targets(g), seen%design, seen%position, r, by_q, by_x)
        squares(g, i) = sum(r**2)
      end do
    end do
    allocate (at(size(seen%targets)))
    call assign_in_order(seen%targets, squares, at)
    do g = 1, size(seen%targets)
      time = times(at(g))
      if (seen%targets(g)%timing /= timing_free) then
        time = seen%exact%times(g)
        at(g) = minloc(abs(times - time), dim=1) - 1
        state%q = q(:, at(g))
        call reach(seen%design, time, state, closed)
        y(:size(y, 1) - 1, g) = state%q(seen%exact%dependent)/seen%design%in_space%unit_of(seen%exact%dependent)
      else
        y(:size(y, 1) - 1, g) = q(seen%exact%dependent, at(g))/seen%design%in_space%unit_of(seen%exact%dependent)
      end if
      y(size(y, 1), g) = (time - seen%exact%start)/(seen%exact%end - seen%exact%start)
    end do
  end subroutine sample_run

  !> Assign the targets of each objective to samples in increasing order, so that the sum of squares is least (dynamic programming).
  pure subroutine assign_in_order(targets, squares, at)
    type(target_type), intent(in) :: targets(:)   !< the targets
    real(wp), intent(in) :: squares(:, 0:)        !< (targets,0:n) squared difference at each sample
    integer, intent(out) :: at(:)                 !< (targets) sample of each target, from 0
    real(wp) :: least(size(targets), 0:ubound(squares, 2))
    integer :: from(size(targets), 0:ubound(squares, 2)), g, i, best, before, after
    logical :: is_first, is_last

    do g = 1, size(targets)
      before = max(1, g - 1)
      is_first = g == 1 .or. targets(g)%objective /= targets(before)%objective
      best = -1
      do i = 0, ubound(squares, 2)
        least(g, i) = squares(g, i)
        from(g, i) = 0
        if (is_first) cycle
        if (best < 0) then
          least(g, i) = huge(1.0_wp)
        else
          least(g, i) = min(huge(1.0_wp), least(g, i) + least(before, best))
          from(g, i) = best
        end if
        if (best < 0) then
          best = i
        else if (least(before, i) < least(before, best)) then
          best = i
        end if
      end do
    end do
    do g = size(targets), 1, -1
      after = min(g + 1, size(targets))
      is_last = g == after .or. targets(g)%objective /= targets(after)%objective
      if (is_last) then
        at(g) = minloc(least(g, :), dim=1) - 1
      else
        at(g) = from(after, at(after))
      end if
    end do
  end subroutine assign_in_order
end module mech9_design_search
