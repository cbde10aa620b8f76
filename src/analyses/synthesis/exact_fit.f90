!> The fit of a design whose chains are closed: the branch of its start is followed through the whole run, and the differences from
!> the targets follow. A design that cannot be assembled near the last one, or whose motion does not come to the end of the run, has
!> no value.
module mech9_exact_fit
  use mech9_kinds, only: wp, long
  use mech9_error, only: error_type
  use mech9_reflections, only: triangulate, solve_upper
  use mech9_bounded_least_squares, only: residuals_type, residual_values_type
  use mech9_plan, only: new_state
  use mech9_state, only: state_type
  use mech9_block_solver, only: new_block_work, block_work_type, newton_outcome_type, close_block
  use mech9_frame_motion, only: place_all
  use mech9_branch_stepping, only: set_inputs
  use mech9_driven_motion, only: driven_motion_type, start_driven_motion, advance
  use mech9_objective, only: timing_free, timing_over
  use mech9_design_space, only: design_space_type, design_type, place_design, find_tangents, drive_changes
  use mech9_open_position, only: open_position_type, find_openings, find_derivatives
  use mech9_targets, only: target_type, difference, are_in_order, outer_times
  implicit none
  private
  public :: exact_fit_type, new_exact_fit, follow, close_near

  !> Steps of the motions of one search. A search that creeps along the edge of the designs that can move takes many more, and ends.
  integer(long), parameter :: most_work = 60000

  !> The shared unknowns are the parameters, each as a part of its range; the unknown of a target is its time, as a part of the run.
  type, extends(residuals_type) :: exact_fit_type
    type(design_space_type), pointer :: space => null()
    type(design_type) :: design
    type(open_position_type) :: position                    !< scratch
    type(target_type), allocatable :: targets(:)
    integer, allocatable :: dependent(:)                    !< numbers of the dependent coordinates
    real(wp) :: start = 0.0_wp, end = 1.0_wp                !< times of the run [s]
    real(wp), allocatable :: q_start(:)                     !< (M) the start of the last design with a value [rad, m]
    real(wp), allocatable :: q(:, :)                        !< (M,targets) its coordinates at the targets [rad, m]
    real(wp), allocatable :: times(:)                       !< (targets) times of the targets [s]
    integer(long) :: work = 0                               !< steps of all motions that were followed
  contains
    procedure :: evaluate
    procedure :: has_derivatives
  end type exact_fit_type

contains

  !> Prepare a fit.
  subroutine new_exact_fit(space, design, position, targets, fit)
    type(design_space_type), intent(in), target :: space     !< the designs
    type(design_type), intent(in) :: design                  !< any of them
    type(open_position_type), intent(in) :: position         !< any position
    type(target_type), intent(in) :: targets(:)              !< the targets
    type(exact_fit_type), intent(out) :: fit                 !< ready but for its start
    integer :: i
    logical :: independent(space%plan%n_coordinates)

    fit%space => space
    fit%design = design
    fit%position = position
    fit%targets = targets
    independent = .false.
    independent(space%plan%independent) = .true.
    fit%dependent = pack([(i, i=1, size(independent))], .not. independent)
    fit%start = space%model%request%time%start
    fit%end = space%model%request%time%end
    fit%n = size(space%varied)
    fit%groups = size(targets)
    fit%own = merge(1, 0, any(targets%timing == timing_free))
    fit%rows = 3
    allocate (fit%q_start(size(independent)), fit%q(size(independent), size(targets)), fit%times(size(targets)), source=0.0_wp)
  end subroutine new_exact_fit

  !> The differences from the targets.
  subroutine evaluate(self, x, y, with_derivatives, values, has_value)
    class(exact_fit_type), intent(inout) :: self            !< the fit
    real(wp), intent(in) :: x(:)                            !< (n) parameters as parts of their ranges
    real(wp), intent(in) :: y(:, :)                         !< (own,targets) times
    logical, intent(in) :: with_derivatives                 !< derivatives are asked for, at the place asked for last
    type(residual_values_type), intent(inout) :: values     !< gets the residuals
    logical, intent(out) :: has_value                       !< the residuals have a value here
    type(error_type), allocatable :: err
    real(wp) :: q_start(size(self%q_start)), by_q(3, size(self%q_start)), by_x(3, size(x))
    integer :: g

    if (with_derivatives) then
      call self%has_derivatives(values, has_value)
      return
    end if
    has_value = .false.
    call place_design(self%space, self%space%low + x*(self%space%high - self%space%low), self%design, err)
    if (allocated(err)) return
    if (self%own > 0) self%times = self%start + y(1, :)*(self%end - self%start)
    call outer_times(self%targets, self%design, min(self%start, self%end), max(self%start, self%end), self%times, has_value)
    has_value = has_value .and. are_in_order(self%targets, self%times, self%end - self%start)
    if (.not. has_value) return
    q_start = self%q_start
    has_value = self%work < most_work
    if (has_value) call follow_targets(self, q_start, has_value)
    if (.not. has_value) return
    do g = 1, self%groups
      call place_at(self, g, err)
      has_value = .not. allocated(err)
      if (.not. has_value) return
      call difference(self%targets(g), self%design, self%position, values%r(:, g), by_q, by_x)
    end do
    self%q_start = q_start
  end subroutine evaluate

  !> Place the frames in space at a target.
  subroutine place_at(self, g, err)
    class(exact_fit_type), intent(inout) :: self            !< the fit
    integer, intent(in) :: g                                !< number of the target
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    real(wp) :: q(size(self%q_start))

    self%position%state%t = self%times(g)
    self%position%state%q = self%q(:, g)
    q = self%q(:, g)
    call set_inputs(self%design%drives, self%times(g), q, self%position%state%dq, self%position%state%ddq, err)
    if (.not. allocated(err)) call find_openings(self%design, self%position, err)
  end subroutine place_at

  !> Follow the branch of the start through all targets and on to the end of the run.
  subroutine follow_targets(self, q_start, has_value)
    class(exact_fit_type), intent(inout) :: self            !< the fit; gets the coordinates at the targets
    real(wp), intent(inout) :: q_start(:)                   !< (M) coordinates near the start, then those of the start [rad, m]
    logical, intent(out) :: has_value                       !< the motion comes to the end of the run
    type(driven_motion_type) :: driven
    type(state_type) :: state
    type(error_type), allocatable :: err
    integer :: order(self%groups), i

    state = new_state(self%design%plan)
    state%q = q_start
    call close_near(self%design, self%start, state, has_value)
    if (.not. has_value) return
    q_start = state%q
    call start_driven_motion(self%design%drives, self%design%plan, state, self%start, driven, err, derivatives=0)
    call sort_times(self%times, self%end - self%start, order)
    do i = 1, self%groups
      if (.not. allocated(err)) call advance(self%design%drives, self%design%plan, driven, self%times(order(i)), err)
      if (.not. allocated(err)) self%q(:, order(i)) = driven%state%q
    end do
    if (.not. allocated(err)) call advance(self%design%drives, self%design%plan, driven, self%end, err)
    has_value = .not. allocated(err)
    self%work = self%work + driven%steps + driven%halvings
  end subroutine follow_targets

  !> Follow the branch of a position from one time to another; `came` tells whether the motion comes there.
  subroutine follow(design, from, to, q, came)
    type(design_type), intent(in) :: design   !< placed
    real(wp), intent(in) :: from              !< time of the position [s]
    real(wp), intent(in) :: to                !< time to go to [s]
    real(wp), intent(inout) :: q(:)           !< (M) coordinates near the position, then those at the end [rad, m]
    logical, intent(out) :: came              !< the motion comes there
    type(driven_motion_type) :: driven
    type(state_type) :: state
    type(error_type), allocatable :: err

    state = new_state(design%plan)
    state%q = q
    call close_near(design, from, state, came)
    if (.not. came) return
    q = state%q
    if (.not. abs(to - from) > 0.0_wp) return
    call start_driven_motion(design%drives, design%plan, state, from, driven, err, derivatives=0)
    if (.not. allocated(err)) call advance(design%drives, design%plan, driven, to, err)
    came = .not. allocated(err)
    if (came) q = driven%state%q
  end subroutine follow

  !> Close all chains near the coordinates in the state by Newton's method.
  subroutine close_near(design, t, state, closed)
    type(design_type), intent(in) :: design       !< placed
    real(wp), intent(in) :: t                     !< time [s]
    type(state_type), intent(inout) :: state      !< with coordinates nearby; closed
    logical, intent(out) :: closed                !< whether it converged
    type(block_work_type) :: work
    type(newton_outcome_type) :: newton
    type(error_type), allocatable :: err
    integer :: b

    state%t = t
    closed = .false.
    call set_inputs(design%drives, t, state%q, state%dq, state%ddq, err)
    if (.not. allocated(err)) call place_all(design%plan, state, err)
    if (allocated(err)) return
    do b = 1, size(design%plan%blocks)
      work = new_block_work(design%plan%blocks(b), design%plan)
      call close_block(design%plan, design%plan%blocks(b), state, work, newton, err)
      if (allocated(err) .or. .not. newton%converged) return
    end do
    closed = .true.
  end subroutine close_near

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
    real(wp), dimension(size(self%q_start), self%n + 1) :: change
    real(wp) :: by_q(3, size(self%q_start)), by_x(3, self%n), r(3), t_by_x(self%n)
    integer :: g, i

    call find_tangents(self%space, self%design, err)
    has_value = .not. allocated(err)
    if (.not. has_value) return
    do g = 1, self%groups
      call place_at(self, g, err)
      has_value = .not. allocated(err)
      if (.not. has_value) return
      call find_derivatives(self%design, self%position)
      call difference(self%targets(g), self%design, self%position, r, by_q, by_x)
      call find_changes(self, self%targets(g), change, t_by_x)
      values%by_x(:, :, g) = by_x + matmul(by_q, change(:, :self%n))
      do i = 1, 3
        values%by_x(i, :, g) = values%by_x(i, :, g) + dot_product(by_q(i, :), change(:, self%n + 1))*t_by_x
      end do
      do i = 1, self%n
        values%by_x(:, i, g) = values%by_x(:, i, g)*(self%space%high(i) - self%space%low(i))
      end do
      if (self%own == 0) cycle
      values%by_y(:, 1, g) = 0.0_wp
      if (self%targets(g)%timing == timing_free) values%by_y(:, 1, g) = matmul(by_q, change(:, self%n + 1))*(self%end - self%start)
    end do
  end subroutine has_derivatives

  !> The derivatives of all coordinates of a closed position by the parameters, and by the time, in the units of the coordinates.
  subroutine find_changes(self, target, change, t_by_x)
    class(exact_fit_type), intent(in) :: self          !< the fit, with the derivatives of the chains
    type(target_type), intent(in) :: target            !< the target
    real(wp), intent(out) :: change(:, :)              !< (M,n+1) the derivatives; the last column is that by the time
    real(wp), intent(out) :: t_by_x(:)                 !< (n) derivatives of the time of the target
    real(wp) :: a(self%position%equations, size(self%dependent) + self%n + 1), drive(self%n)
    real(wp) :: solution(size(self%dependent))
    integer :: i, j, k, n, m

    n = self%n
    m = size(self%dependent)
    change = 0.0_wp
    t_by_x = 0.0_wp
    associate (position => self%position, plan => self%design%in_space)
      do i = 1, size(self%design%drives)
        k = self%design%drives(i)%drive%coordinate
        call drive_changes(self%design, i, position%state%t, drive)
        change(k, :n) = drive/plan%unit_of(k)
        change(k, n + 1) = position%state%dq(k)/plan%unit_of(k)
        if (target%timing == timing_over .and. target%over == k .and. abs(position%state%dq(k)) > 0.0_wp) &
          t_by_x = -drive/position%state%dq(k)
      end do
      a(:, :m) = position%by_q(:, self%dependent)
      a(:, m + 1:m + n) = -position%by_x
      a(:, m + n + 1) = 0.0_wp
      a(:, m + 1:) = a(:, m + 1:) - matmul(position%by_q, change)
      call triangulate(a, m)
      do j = 1, n + 1
        call solve_upper(a(:m, :m), a(:m, m + j), solution)
        change(self%dependent, j) = solution
      end do
    end associate
  end subroutine find_changes
end module mech9_exact_fit
