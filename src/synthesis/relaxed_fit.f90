!> The fit of a design whose chains may be open: the coordinates at each target are unknowns too, and the openings of the chains
!> count with a weight beside the differences from the targets. So designs that cannot be assembled, or cannot reach all targets,
!> lead to designs that can.
module mech9_relaxed_fit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_bounded_least_squares, only: residuals_type, residual_values_type
  use mech9_branch_stepping, only: set_inputs
  use mech9_objective, only: timing_free, timing_over
  use mech9_design_space, only: design_space_type, design_type, place_design, find_tangents, drive_changes
  use mech9_open_position, only: open_position_type, find_openings, find_derivatives
  use mech9_free_times, only: free_times_type, new_free_times, are_in_order
  use mech9_targets, only: target_type, components_of, difference, difference_derivatives, outer_times
  implicit none
  private
  public :: relaxed_fit_type, new_relaxed_fit, turn_on

  !> The shared unknowns are the parameters, each as a part of its range; those of a target are the dependent coordinates, in their
  !> units, and the time, as a part of the run.
  type, extends(residuals_type) :: relaxed_fit_type
    type(design_space_type), pointer :: space => null()
    class(design_type), allocatable :: design
    type(open_position_type), allocatable :: positions(:)   !< (targets)
    type(target_type), allocatable :: targets(:)            !< targets, and positions at which chains must be closed
    type(free_times_type) :: free                           !< free times of targets
    integer, allocatable :: dependent(:)                    !< numbers of the dependent coordinates
    real(wp) :: start = 0.0_wp, end = 1.0_wp                !< times of the run [s]
    real(wp) :: scale = 1.0_wp                              !< length by which differences are divided [m]
    real(wp) :: closing = 1.0_wp                            !< weight of the openings of chains
  contains
    procedure :: evaluate
    procedure :: has_derivatives
  end type relaxed_fit_type

contains

  !> Prepare a fit.
  subroutine new_relaxed_fit(space, design, position, targets, fit)
    type(design_space_type), intent(in), target :: space     !< the designs
    type(design_type), intent(in) :: design                  !< any of them
    type(open_position_type), intent(in) :: position         !< any position
    type(target_type), intent(in) :: targets(:)              !< the targets
    type(relaxed_fit_type), intent(out) :: fit               !< ready
    integer :: i
    logical :: independent(space%plan%n_coordinates)

    fit%space => space
    allocate (fit%design, source=design)
    fit%targets = targets
    allocate (fit%positions(size(targets)))
    do i = 1, size(targets)
      fit%positions(i) = position
    end do
    independent = .false.
    independent(space%plan%independent) = .true.
    fit%dependent = pack([(i, i=1, size(independent))], .not. independent)
    fit%start = space%model%request%time%start
    fit%end = space%model%request%time%end
    fit%n = size(space%varied)
    fit%groups = size(targets)
    fit%n_y = size(fit%dependent) + 1
    call new_free_times(targets, fit%free)
    fit%rows = position%equations + components_of(targets)
  end subroutine new_relaxed_fit

  !> The openings of all chains, and the differences from the targets.
  subroutine evaluate(self, x, y, with_derivatives, values, has_value)
    class(relaxed_fit_type), intent(inout) :: self          !< the fit
    real(wp), intent(in) :: x(:)                            !< (n) parameters as parts of their ranges
    real(wp), intent(in) :: y(:, :)                         !< (n_y,targets) dependent coordinates and times
    logical, intent(in) :: with_derivatives                 !< derivatives are asked for, at the place asked for last
    type(residual_values_type), intent(inout) :: values     !< gets the residuals
    logical, intent(out) :: has_value                       !< the residuals have a value here
    type(error_type), allocatable :: err
    real(wp) :: times(size(self%targets))
    integer :: g

    if (with_derivatives) then
      call self%has_derivatives(values, has_value)
      return
    end if
    has_value = .false.
    call place_design(self%space, self%space%low + x*(self%space%high - self%space%low), self%design, err)
    if (allocated(err)) return
    times = self%start + y(self%n_y, :)*(self%end - self%start)
    call outer_times(self%targets, self%design, min(self%start, self%end), max(self%start, self%end), times, has_value)
    has_value = has_value .and. are_in_order(y(self%n_y, self%free%target), self%free)
    if (.not. has_value) return
    do g = 1, self%groups
      associate (position => self%positions(g), plan => self%design%in_space)
        position%state%t = times(g)
        position%state%q(self%dependent) = y(:self%n_y - 1, g)*plan%unit_of(self%dependent)
        call set_inputs(self%design%drives, times(g), position%state%q, position%state%dq, position%state%ddq, err)
        call turn_on(self%targets(g), position%state%q)
        if (.not. allocated(err)) call find_openings(self%design, position, err)
        has_value = .not. allocated(err)
        if (.not. has_value) return
        values%r(:position%equations, g) = self%closing*position%opening
        call difference(self%targets(g), plan, self%design, position%state, values%r(position%equations + 1:, g))
        values%r(position%equations + 1:, g) = values%r(position%equations + 1:, g)/self%scale
      end associate
    end do
  end subroutine evaluate

  !> Turn on a driven angle where a position is in the full turn of a crank.
  pure subroutine turn_on(target, q)
    type(target_type), intent(in) :: target   !< the position
    real(wp), intent(inout) :: q(:)           !< (M) coordinates [rad, m]

    if (target%turned > 0) q(target%turned) = q(target%turned) + target%place(1)
  end subroutine turn_on

  !> The derivatives at the place that was evaluated last.
  subroutine has_derivatives(self, values, has_value)
    class(relaxed_fit_type), intent(inout) :: self          !< the fit
    type(residual_values_type), intent(inout) :: values     !< gets the derivatives
    logical, intent(out) :: has_value                       !< they exist
    type(error_type), allocatable :: err
    real(wp) :: by_q(self%rows, size(self%positions(1)%state%q)), by_t(self%rows), change(self%n), rate, t_by_x(self%n)
    integer :: g, e, i, k

    call find_tangents(self%space, self%design, err)
    has_value = .not. allocated(err)
    if (.not. has_value) return
    do g = 1, self%groups
      associate (position => self%positions(g), plan => self%design%in_space, by_x => values%by_x(:, :, g), &
                 by_y => values%by_y(:, :, g), target => self%targets(g))
        e = position%equations
        call find_derivatives(self%design, position)
        by_q(:e, :) = self%closing*position%by_q
        by_x(:e, :) = self%closing*position%by_x
        call difference_derivatives(target, self%design, position, by_q(e + 1:, :), by_x(e + 1:, :))
        by_q(e + 1:, :) = by_q(e + 1:, :)/self%scale
        by_x(e + 1:, :) = by_x(e + 1:, :)/self%scale
        by_y(:, :self%n_y - 1) = by_q(:, self%dependent)
        by_t = 0.0_wp
        t_by_x = 0.0_wp
        do i = 1, size(self%design%drives)
          k = self%design%drives(i)%drive%coordinate
          by_t = by_t + by_q(:, k)*position%state%dq(k)/plan%unit_of(k)
          call drive_changes(self%design, i, position%state%t, change)
          if (target%timing == timing_over .and. target%over == k .and. abs(position%state%dq(k)) > 0.0_wp) &
            t_by_x = -change/position%state%dq(k)
          by_x = by_x + spread(by_q(:, k)/plan%unit_of(k), 2, self%n)*spread(change, 1, self%rows)
        end do
        by_x = by_x + spread(by_t, 2, self%n)*spread(t_by_x, 1, self%rows)
        by_y(:, self%n_y) = merge(by_t*(self%end - self%start), 0.0_wp*by_t, target%timing == timing_free)
        do i = 1, self%n
          rate = self%space%high(i) - self%space%low(i)
          by_x(:, i) = by_x(:, i)*rate
        end do
      end associate
    end do
  end subroutine has_derivatives
end module mech9_relaxed_fit
