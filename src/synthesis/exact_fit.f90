!> The fit of a design whose chains are closed: the branch of its start is followed through the whole run, and the differences from
!> the targets and from the goals of quantities follow. A design that cannot be assembled near the last one, or whose motion does
!> not come to the end of the run, has no value.
!>
!> Beside a design whose run is known, the run of a planar design is found without following it (mech9_neighbouring_run), where this
!> proves that it has one branch. Elsewhere, and where `must_follow` is set, the run is followed from its start.
module mech9_exact_fit
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type
  use mech9_system, only: interrupted
  use mech9_tolerances, only: longest_drive
  use mech9_bounded_least_squares, only: residuals_type, residual_values_type
  use mech9_plan, only: new_state
  use mech9_state, only: state_type
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance, ends_before
  use mech9_objective, only: timing_free, timing_over, quantity_objective, crank_limit
  use mech9_design_space, only: design_space_type, design_type, place_design, find_tangents, all_values
  use mech9_open_position, only: open_position_type, place_at, find_derivatives
  use mech9_closed_changes, only: closed_changes_type, find_closed_changes
  use mech9_branch, only: close_near, follow_turn
  use mech9_planar_design, only: place_planar_design
  use mech9_neighbouring_run, only: neighbouring_run_type, new_neighbouring_run, record_position, find_neighbour, keep_run, &
    find_slopes
  use mech9_free_times, only: free_times_type, new_free_times, parts_of, part_by_gap, are_in_order
  use mech9_targets, only: target_type, components_of, difference, difference_derivatives, outer_times
  implicit none
  private
  public :: exact_fit_type, search_place_type, new_exact_fit, begin_at, has_ended

  !> Steps of the motions of one search. A search along the edge of the designs that can move would take many more, and
  !> ends.
  integer(long), parameter :: most_work = 60000
  !> Positions that are recorded between two targets.
  real(wp), parameter :: most_parts = 1.0e4_wp
  !> Steps of a motion after which the fit asks whether the user has interrupted.
  integer, parameter :: steps_at_once = 1000

  !> The unknowns are the parameters, each as a part of its range, and the gaps between free times, as parts of the run. A residual
  !> group belongs to each target, and the last ones hold the differences of quantities from their goals.
  type, extends(residuals_type) :: exact_fit_type
    type(design_space_type), pointer :: space => null()
    class(design_type), allocatable :: design
    class(open_position_type), allocatable :: position      !< scratch
    type(target_type), allocatable :: targets(:)
    type(free_times_type) :: free                           !< free times of targets
    integer :: varied = 0                                   !< number of parameters that are varied
    integer, allocatable :: goals(:)                        !< numbers of the objectives that are goals of quantities
    integer, allocatable :: cranks(:)                       !< coordinates that must be able to turn fully
    logical :: with_quantities = .false.                    !< objectives or limits need quantities
    real(wp) :: start = 0.0_wp, end = 1.0_wp                !< times of the run [s]
    real(wp), allocatable :: q_start(:)                     !< (M) the start of the last design with derivatives [rad, m]
    real(wp), allocatable :: q_trial(:)                     !< (M) the start of the last design with a value [rad, m]
    real(wp), allocatable :: q(:, :)                        !< (M,targets) its coordinates at the targets [rad, m]
    real(wp), allocatable :: times(:)                       !< (targets) times of the targets [s]
    real(wp), allocatable :: quantities(:)                  !< values of the quantities of the last design with a value
    type(closed_changes_type) :: changes                    !< scratch
    real(wp), allocatable :: gradient(:, :)                 !< (parameters,quantities) their derivatives by all parameters
    class(neighbouring_run_type), allocatable :: near       !< runs beside the last one with derivatives
    logical :: must_follow = .false.                        !< runs are followed from their starts
    integer(long) :: work = 0                               !< steps of all motions that were followed, and positions of others
    integer(long) :: followed = 0                           !< number of runs that were followed
    logical :: stops_on_interruption = .true.               !< designs have no value after the user has interrupted
    logical :: was_cut = .false.                            !< a design had no value for this reason
  contains
    procedure :: evaluate
    procedure :: has_derivatives
    procedure :: quantity_slopes
    procedure :: note_interruption
  end type exact_fit_type

  !> A design from which a search goes on.
  type :: search_place_type
    real(wp), allocatable :: x(:)       !< (P) parameters as parts of their ranges
    real(wp), allocatable :: parts(:)   !< free times as parts of the run
    real(wp), allocatable :: q(:)       !< (M) coordinates at the start of the run [rad, m]
  end type search_place_type

contains

  !> Whether no design has a value any more: the motions took too many steps, or the user has interrupted.
  pure logical function has_ended(fit)
    class(exact_fit_type), intent(in) :: fit   !< the fit

    has_ended = fit%work >= most_work .or. fit%was_cut
  end function has_ended

  !> Prepare a fit.
  subroutine new_exact_fit(space, design, position, targets, fit)
    type(design_space_type), intent(in), target :: space     !< the designs
    type(design_type), intent(in) :: design                  !< any of them
    type(open_position_type), intent(in) :: position         !< any position
    type(target_type), intent(in) :: targets(:)              !< the targets
    type(exact_fit_type), intent(out) :: fit                 !< ready but for its start
    integer :: i, m

    fit%space => space
    allocate (fit%design, source=design)
    allocate (fit%position, source=position)
    fit%targets = targets
    call new_free_times(targets, fit%free)
    associate (request => space%model%request)
      fit%goals = pack([(i, i=1, size(request%objectives))], request%objectives%has_goal)
      fit%cranks = pack(request%limits%coordinate, request%limits%kind == crank_limit)
      fit%with_quantities = any(request%objectives%kind == quantity_objective) .or. any(request%limits%quantity > 0)
      fit%start = request%time%start
      fit%end = request%time%end
    end associate
    fit%varied = size(space%varied)
    fit%n = fit%varied + fit%free%n
    fit%rows = components_of(targets)
    fit%groups = size(targets) + (size(fit%goals) + fit%rows - 1)/fit%rows
    m = space%plan%n_coordinates
    allocate (fit%q_start(m), fit%q_trial(m), fit%q(m, size(targets)), fit%times(size(targets)), source=0.0_wp)
    allocate (fit%quantities(size(space%model%request%quantities)), source=0.0_wp)
    allocate (fit%gradient(size(space%values), size(fit%quantities)), source=0.0_wp)
    allocate (fit%near)
    call new_neighbouring_run(fit%space, design, targets, fit%near)
  end subroutine new_exact_fit

  !> Begin a search at a position: no run is known.
  pure subroutine begin_at(q, fit)
    real(wp), intent(in) :: q(:)                   !< (M) coordinates near the start of the run [rad, m]
    class(exact_fit_type), intent(inout) :: fit    !< the fit

    fit%q_start = q
    fit%work = 0
    fit%near%is_known = .false.
  end subroutine begin_at

  !> The differences from the targets and goals.
  subroutine evaluate(self, x, y, with_derivatives, values, has_value)
    class(exact_fit_type), intent(inout) :: self            !< the fit
    real(wp), intent(in) :: x(:)                            !< (n) parameters as parts of their ranges, gaps of free times
    real(wp), intent(in) :: y(:, :)                         !< (0,targets) no target has unknowns of its own
    logical, intent(in) :: with_derivatives                 !< derivatives are asked for, at the place asked for last
    type(residual_values_type), intent(inout) :: values     !< gets the residuals
    logical, intent(out) :: has_value                       !< the residuals have a value here
    type(error_type), allocatable :: err
    real(wp) :: q_start(size(self%q_start)), quantities(size(self%quantities))

    if (with_derivatives) then
      call self%has_derivatives(values, has_value)
      return
    end if
    has_value = .false.
    self%near%is_neighbour = .false.
    call self%note_interruption()
    if (has_ended(self)) return
    if (self%near%is_known .and. .not. self%must_follow) then
      call evaluate_near(self, x, values, has_value)
      if (has_value) return
    end if
    associate (space => self%space, v => self%varied)
      call place_design(space, space%low + x(:v)*(space%high - space%low), self%design, err)
      if (allocated(err)) return
      call find_times(self, x(v + 1:), has_value)
      if (.not. has_value) return
      q_start = self%q_start
      values%r = 0.0_wp
      call follow_targets(self, q_start, values%r, has_value)
      if (has_value .and. self%with_quantities) &
        call space%evaluator%find_numbers(all_values(space, self%design%x), q_start, quantities, has_value)
    end associate
    ! a run for quantities may have been interrupted
    if (.not. has_value) then
      if (self%with_quantities) call self%note_interruption()
      return
    end if
    self%q_trial = q_start
    if (self%with_quantities) self%quantities = quantities
    call add_goals(self, values)
  end subroutine evaluate

  !> The differences from the targets in the run beside the known one; without `has_value` the run must be followed.
  subroutine evaluate_near(self, x, values, has_value)
    class(exact_fit_type), intent(inout) :: self            !< the fit
    real(wp), intent(in) :: x(:)                            !< (n) parameters as parts of their ranges, gaps of free times
    type(residual_values_type), intent(inout) :: values     !< gets the residuals
    logical, intent(out) :: has_value                       !< the run was found

    associate (space => self%space, v => self%varied)
      call place_planar_design(space, space%low + x(:v)*(space%high - space%low), self%near%design, self%design)
      call find_times(self, x(v + 1:), has_value)
      if (has_value) call find_neighbour(space%plan, self%targets, self%times, self%design, self%near, values%r, has_value)
      if (has_value) self%q_trial = self%near%trial%q(1, :)
      self%work = self%work + self%near%trial%n
    end associate
  end subroutine evaluate_near

  !> Ask whether the user has interrupted the program, and remember it, if the fit is to heed this.
  subroutine note_interruption(self)
    class(exact_fit_type), intent(inout) :: self            !< the fit

    if (self%stops_on_interruption .and. .not. self%was_cut) self%was_cut = interrupted()
  end subroutine note_interruption

  !> The times of all targets.
  subroutine find_times(self, gaps, found)
    class(exact_fit_type), intent(inout) :: self            !< the fit, with its design placed; gets the times
    real(wp), intent(in) :: gaps(:)                         !< between free times, as parts of the run
    logical, intent(out) :: found                           !< all lie within the run, and free ones are in order
    real(wp) :: parts(size(gaps))

    parts = parts_of(gaps, self%free)
    self%times(self%free%target) = self%start + parts*(self%end - self%start)
    call outer_times(self%targets, self%design, min(self%start, self%end), max(self%start, self%end), self%times, found)
    found = found .and. are_in_order(parts, self%free)
  end subroutine find_times

  !> Add the differences of quantities from their goals.
  pure subroutine add_goals(self, values)
    class(exact_fit_type), intent(in) :: self               !< the fit, with the quantities
    type(residual_values_type), intent(inout) :: values     !< gets the residuals
    integer :: i

    do i = 1, size(self%goals)
      associate (objective => self%space%model%request%objectives(self%goals(i)))
        values%r(row_of_goal(self, i), group_of_goal(self, i)) = sqrt(objective%weight) &
                                                                 *(self%quantities(objective%quantity) - objective%goal)
      end associate
    end do
  end subroutine add_goals

  !> The row of a goal in its group.
  pure integer function row_of_goal(self, i)
    class(exact_fit_type), intent(in) :: self   !< the fit
    integer, intent(in) :: i                    !< number of the goal

    row_of_goal = 1 + modulo(i - 1, self%rows)
  end function row_of_goal

  !> The group of a goal.
  pure integer function group_of_goal(self, i)
    class(exact_fit_type), intent(in) :: self   !< the fit
    integer, intent(in) :: i                    !< number of the goal

    group_of_goal = size(self%targets) + 1 + (i - 1)/self%rows
  end function group_of_goal

  !> Follow the branch of the start through all targets and on to the end of the run.
  subroutine follow_targets(self, q_start, r, has_value)
    class(exact_fit_type), intent(inout) :: self            !< the fit; gets the coordinates at the targets
    real(wp), intent(inout) :: q_start(:)                   !< (M) coordinates near the start, then those of the start [rad, m]
    real(wp), intent(inout) :: r(:, :)                      !< (rows,groups) gets the differences from the targets
    logical, intent(out) :: has_value                       !< the motion comes to the end of the run, and cranks turn fully
    type(driven_motion_type) :: driven
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: order(size(self%targets)), i

    self%followed = self%followed + 1
    state = new_state(self%design%plan)
    state%q = q_start
    call close_near(self%design, self%start, state, has_value)
    if (.not. has_value) return
    q_start = state%q
    call start_driven_motion(self%design%drives, self%design%plan, state, self%start, driven, err, derivatives=0)
    driven%stops_short = .true.
    call sort_times(self%times, self%end - self%start, order)
    self%near%recorded = 0
    if (self%near%used) call record_position(self%start, 0, q_start, self%near)
    do i = 1, size(order)
      if (.not. allocated(err)) call go_on(self, self%times(order(i)), order(i), driven, err)
      if (allocated(err) .or. self%was_cut) exit
      ! the design has no value if its motion does not come to the end of the run
      if (ends_before(driven, self%end)) exit
      self%q(:, order(i)) = driven%state%q
      call difference(self%targets(order(i)), self%design%plan, self%design, driven%state, r(:, order(i)))
    end do
    has_value = .not. (allocated(err) .or. self%was_cut .or. ends_before(driven, self%end))
    if (has_value) call go_on(self, self%end, 0, driven, err)
    if (allocated(err) .or. self%was_cut) has_value = .false.
    self%work = self%work + driven%steps + driven%halvings
    do i = 1, size(self%cranks)
      if (has_value) call follow_turn(self%design, q_start, self%cranks(i), has_value, self%work)
    end do
  end subroutine follow_targets

  !> Follow the branch to a time, and record positions on the way, so near to each other that no drive moves far between them. After
  !> an interruption by the user the motion is not there, and the fit `was_cut`.
  subroutine go_on(self, t, target, driven, err)
    class(exact_fit_type), intent(inout) :: self            !< the fit; gets the positions
    real(wp), intent(in) :: t                               !< the time [s]
    integer, intent(in) :: target                           !< the target that is there; 0: none
    type(driven_motion_type), intent(inout) :: driven       !< the motion
    type(error_type), allocatable, intent(out) :: err       !< allocated if the motion does not come there
    real(wp) :: from, parts
    integer :: i, n

    from = driven%state%t
    n = 1
    if (self%near%used) then
      do i = 1, size(self%design%drives)
        associate (drive => self%design%drives(i)%drive)
          parts = abs(t - from)*drive%greatest_rate(from, t - from)/(longest_drive*self%design%plan%unit_of(drive%coordinate))
        end associate
        n = max(n, ceiling(min(parts, most_parts)))
      end do
    end if
    do i = 1, n
      do
        call advance(self%design%drives, self%design%plan, driven, merge(t, from + (t - from)*i/n, i == n), err, steps_at_once)
        if (allocated(err)) return
        if (.not. driven%paused) exit
        call self%note_interruption()
        if (self%was_cut) return
      end do
      if (self%near%used) call record_position(driven%state%t, merge(target, 0, i == n), driven%state%q, self%near)
    end do
  end subroutine go_on

  !> The order of times in the direction of the run.
  pure subroutine sort_times(times, direction, order)
    real(wp), intent(in) :: times(:)       !< the times [s]
    real(wp), intent(in) :: direction      !< +1, or -1 for a run backwards in time
    integer, intent(out) :: order(:)       !< their numbers, in this order
    integer :: i, j, moved

    order = [(i, i=1, size(order))]
    do i = 2, size(order)
      moved = order(i)
      j = i - 1
      do while (j > 0)
        if ((times(order(j)) - times(moved))*direction <= 0.0_wp) exit
        order(j + 1) = order(j)
        j = j - 1
      end do
      order(j + 1) = moved
    end do
  end subroutine sort_times

  !> The derivatives at the place that was evaluated last.
  subroutine has_derivatives(self, values, has_value)
    class(exact_fit_type), intent(inout) :: self            !< the fit
    type(residual_values_type), intent(inout) :: values     !< gets the derivatives
    logical, intent(out) :: has_value                       !< they exist
    type(error_type), allocatable :: err
    integer :: g

    ! derivatives are asked for where a search goes on from: other trials start from this assembly
    self%q_start = self%q_trial
    if (self%near%used) then
      call keep_run(self%space, self%design, self%near)
      has_value = self%near%is_known
      if (has_value) call differentiate_near(self, values)
      if (has_value) return
    end if
    call find_tangents(self%space, self%design, err)
    has_value = .not. allocated(err)
    if (has_value) values%by_x = 0.0_wp
    do g = 1, size(self%targets)
      if (has_value) call differentiate_target(self, g, values%by_x(:, :, g), has_value)
    end do
    if (.not. (has_value .and. self%with_quantities)) return
    call self%space%evaluator%find_gradient(all_values(self%space, self%design%x), self%q_start, self%gradient, has_value)
    do g = 1, size(self%goals)
      associate (objective => self%space%model%request%objectives(self%goals(g)))
        values%by_x(row_of_goal(self, g), :self%varied, group_of_goal(self, g)) &
          = sqrt(objective%weight)*self%quantity_slopes(objective%quantity)
      end associate
    end do
  end subroutine has_derivatives

  !> The derivatives in the known run of a planar design.
  subroutine differentiate_near(self, values)
    class(exact_fit_type), intent(inout) :: self            !< the fit
    type(residual_values_type), intent(inout) :: values     !< gets the derivatives
    real(wp) :: by_t(self%rows, size(self%targets)), rate
    integer :: g, i

    call find_slopes(self%space%plan, self%targets, self%design, self%near, values%by_x(:, :self%varied, :), by_t)
    values%by_x(:, self%varied + 1:, :) = 0.0_wp
    do g = 1, size(self%targets)
      do i = 1, self%varied
        rate = self%space%high(i) - self%space%low(i)
        values%by_x(:, i, g) = values%by_x(:, i, g)*rate
      end do
      call add_times(self, g, by_t(:, g), values%by_x(:, :, g))
    end do
  end subroutine differentiate_near

  !> The derivatives of a quantity by the varied parameters, as parts of their ranges.
  pure function quantity_slopes(self, number) result(slopes)
    class(exact_fit_type), intent(in) :: self   !< the fit, with the derivatives of the quantities
    integer, intent(in) :: number               !< of the quantity
    real(wp) :: slopes(self%varied)

    slopes = self%gradient(self%space%varied, number)*(self%space%high - self%space%low)
  end function quantity_slopes

  !> The derivatives of the difference from one target.
  subroutine differentiate_target(self, g, by_unknown, has_value)
    class(exact_fit_type), intent(inout) :: self            !< the fit
    integer, intent(in) :: g                                !< number of the target
    real(wp), intent(inout) :: by_unknown(:, :)             !< (rows,n) the derivatives
    logical, intent(out) :: has_value                       !< they exist
    type(error_type), allocatable :: err
    real(wp) :: by_q(self%rows, size(self%q_start)), by_x(self%rows, self%varied), by_t(self%rows)
    integer :: i

    call place_at(self%design, self%times(g), self%q(:, g), self%position, err)
    has_value = .not. allocated(err)
    if (.not. has_value) return
    call find_derivatives(self%design, self%position)
    call difference_derivatives(self%targets(g), self%design, self%position, by_q, by_x)
    associate (changes => self%changes)
      call find_closed_changes(self%design, self%position, changes)
      by_t = matmul(by_q, changes%by_t)
      by_x = by_x + matmul(by_q, changes%by_x)
      if (self%targets(g)%timing == timing_over) by_x = by_x + spread(by_t, 2, self%varied) &
                                                      *spread(changes%delay(self%targets(g)%over, self%position), 1, self%rows)
    end associate
    do i = 1, self%varied
      by_unknown(:, i) = by_x(:, i)*(self%space%high(i) - self%space%low(i))
    end do
    call add_times(self, g, by_t, by_unknown)
  end subroutine differentiate_target

  !> The derivatives of the difference from a target with a free time by the gaps between times.
  pure subroutine add_times(self, g, by_t, by_unknown)
    class(exact_fit_type), intent(in) :: self               !< the fit
    integer, intent(in) :: g                                !< number of the target
    real(wp), intent(in) :: by_t(:)                         !< (rows) derivatives by its time [1/s]
    real(wp), intent(inout) :: by_unknown(:, :)             !< (rows,n) gets those by the gaps
    integer :: i, j

    if (self%targets(g)%timing /= timing_free) return
    i = findloc(self%free%target, g, dim=1)
    do j = 1, self%free%n
      by_unknown(:, self%varied + j) = by_t*(self%end - self%start)*part_by_gap(self%free, i, j)
    end do
  end subroutine add_times
end module mech9_exact_fit
