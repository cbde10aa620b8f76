!> A fit with limits, and with quantities that should be least or largest: not a sum of squares alone.
module mech9_limited_fit
  use mech9_kinds, only: wp
  use mech9_bounded_least_squares, only: residual_values_type
  use mech9_smooth_problem, only: smooth_problem_type
  use mech9_objective, only: quantity_objective
  use mech9_exact_fit, only: exact_fit_type
  use mech9_design_limits, only: design_limits_type, find_limits
  implicit none
  private
  public :: limited_fit_type, new_limited_fit, value_of, find_value

  type, extends(smooth_problem_type) :: limited_fit_type
    class(exact_fit_type), pointer :: fit => null()
    type(design_limits_type) :: limits
    type(residual_values_type) :: values
    real(wp) :: scale = 1.0_wp                 !< by which the value is divided
    real(wp) :: least = huge(1.0_wp)           !< the least value within all limits so far
    real(wp), allocatable :: q_best(:)         !< (M) the start of this design [rad, m]
  contains
    procedure :: evaluate
    procedure :: is_stopped
  end type limited_fit_type

contains

  !> A fit with limits.
  subroutine new_limited_fit(fit, limits, limited)
    class(exact_fit_type), intent(in), target :: fit     !< the fit, which must outlive it
    type(design_limits_type), intent(in) :: limits       !< the limits
    type(limited_fit_type), intent(out) :: limited       !< ready

    limited%fit => fit
    limited%limits = limits
    limited%n = fit%n
    limited%n_limits = limits%n
    allocate (limited%values%r(fit%rows, fit%groups), limited%values%by_x(fit%rows, fit%n, fit%groups), &
              limited%values%by_y(fit%rows, 0, fit%groups), source=0.0_wp)
  end subroutine new_limited_fit

  !> The value of the present design of a fit: its sum of squares, and the quantities that should be least or largest.
  pure real(wp) function value_of(fit, values) result(value)
    class(exact_fit_type), intent(in) :: fit            !< the fit
    type(residual_values_type), intent(in) :: values    !< its residuals
    integer :: i

    value = sum(values%r**2)
    do i = 1, size(fit%space%model%request%objectives)
      associate (objective => fit%space%model%request%objectives(i))
        if (objective%kind /= quantity_objective .or. objective%has_goal) cycle
        value = value + objective%direction*objective%weight*fit%quantities(objective%quantity)
      end associate
    end do
  end function value_of

  !> Value, limits and derivatives of a place.
  subroutine evaluate(self, x, value, gradient, limits, slopes, has_value)
    class(limited_fit_type), intent(inout) :: self      !< the fit
    real(wp), intent(in) :: x(:)                        !< (n) parameters as parts of their ranges, gaps of free times
    real(wp), intent(out) :: value                      !< the value
    real(wp), intent(out) :: gradient(:)                !< (n) its derivatives
    real(wp), intent(out) :: limits(:)                  !< (limits) not negative where they are kept
    real(wp), intent(out) :: slopes(:, :)               !< (n,limits) their derivatives
    logical, intent(out) :: has_value                   !< the motion comes to the end of the run
    integer :: i

    value = 0.0_wp
    gradient = 0.0_wp
    limits = 0.0_wp
    slopes = 0.0_wp
    call find_value(self, x, value, has_value)
    if (.not. has_value) return
    call self%fit%evaluate(x, no_unknowns(self), .true., self%values, has_value)
    if (has_value) call find_limits(self%limits, self%fit, limits, slopes, has_value)
    if (.not. has_value) return
    value = value/self%scale
    if (.not. any(limits < 0.0_wp) .and. value < self%least) then
      self%least = value
      self%q_best = self%fit%q_start
    end if
    do i = 1, self%n
      gradient(i) = 2.0_wp*sum(self%values%by_x(:, i, :)*self%values%r)
    end do
    do i = 1, size(self%fit%space%model%request%objectives)
      associate (objective => self%fit%space%model%request%objectives(i), v => self%fit%varied)
        if (objective%kind /= quantity_objective .or. objective%has_goal) cycle
        gradient(:v) = gradient(:v) + objective%direction*objective%weight*self%fit%quantity_slopes(objective%quantity)
      end associate
    end do
    gradient = gradient/self%scale
  end subroutine evaluate

  !> The value of a place, without limits and derivatives.
  subroutine find_value(self, x, value, has_value)
    class(limited_fit_type), intent(inout) :: self      !< the fit
    real(wp), intent(in) :: x(:)                        !< (n) parameters as parts of their ranges, gaps of free times
    real(wp), intent(out) :: value                      !< the value
    logical, intent(out) :: has_value                   !< the motion comes to the end of the run

    value = huge(value)
    call self%fit%evaluate(x, no_unknowns(self), .false., self%values, has_value)
    if (has_value) value = value_of(self%fit, self%values)
  end subroutine find_value

  !> The unknowns that each group of residuals has of its own: none.
  pure function no_unknowns(self) result(y)
    class(limited_fit_type), intent(in) :: self   !< the fit
    real(wp) :: y(0, self%fit%groups)

    y = 0.0_wp
  end function no_unknowns

  !> Whether the user has interrupted the program.
  logical function is_stopped(self)
    class(limited_fit_type), intent(in) :: self   !< its fit notes the interruption

    call self%fit%note_interruption()
    is_stopped = self%fit%was_cut
  end function is_stopped
end module mech9_limited_fit
