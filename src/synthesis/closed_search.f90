!> The search for the best design near one whose chains are closed, along its branch: by least squares, and by a method for smooth
!> functions within limits where there are limits or quantities that should be least or largest.
module mech9_closed_search
  use mech9_kinds, only: wp
  use mech9_bounded_least_squares, only: bounds_type, least_squares_settings_type, least_squares_outcome_type, minimise_squares, &
    ended_without_value
  use mech9_smooth_problem, only: smooth_settings_type, smooth_outcome_type, ended_infeasible, ended_nowhere
  use mech9_limited_minimum, only: minimise_within_limits
  use mech9_objective, only: quantity_objective, assembles_limit
  use mech9_model, only: model_type
  use mech9_free_times, only: choose_pivots, has_good_pivots, gaps_of, parts_of
  use mech9_exact_fit, only: exact_fit_type, search_place_type, begin_at, has_ended
  use mech9_design_limits, only: design_limits_type
  use mech9_limited_fit, only: limited_fit_type, new_limited_fit, find_value
  implicit none
  private
  public :: found_design_type, search_closed, is_least_squares

  !> A design to which a search led.
  type :: found_design_type
    logical :: found = .false.              !< the search came to a design that moves through the whole run within all limits
    real(wp) :: value = huge(1.0_wp)        !< weighted sum of squares, and of quantities
    real(wp), allocatable :: x(:)           !< values of the varied parameters, in the units of the file
    real(wp), allocatable :: q(:)           !< (M) coordinates at the start of the run [rad, m]
    real(wp), allocatable :: times(:)       !< (targets) times of the targets [s]
  end type found_design_type

  !> A difference from a target by this part of the size of the targets is round-off of its position.
  real(wp), parameter :: same_difference = 1.0e-11_wp
  integer, parameter :: most_pivots = 10     !< changes of the gaps that follow from others
  integer, parameter :: most_restarts = 3    !< of the method for smooth functions, from its own result
  !> A restart that lowers the value by less than this part is the last one.
  real(wp), parameter :: worthwhile = 1.0e-9_wp
  !> An unknown is at a bound where it is so near, as a part of its range.
  real(wp), parameter :: at_bound = 1.0e-7_wp

contains

  !> Whether a model asks for a sum of squares without limits that have numbers.
  pure logical function is_least_squares(model)
    type(model_type), intent(in) :: model   !< the model

    associate (objectives => model%request%objectives, limits => model%request%limits)
      is_least_squares = .not. any(objectives%kind == quantity_objective .and. .not. objectives%has_goal) .and. &
                         all(limits%kind == assembles_limit)
    end associate
  end function is_least_squares

  !> Improve a design whose chains are closed at the start of the run.
  subroutine search_closed(fit, limits, scale, place, found)
    type(exact_fit_type), intent(inout), target :: fit       !< the fit
    type(design_limits_type), intent(in) :: limits           !< the limits
    real(wp), intent(in) :: scale                            !< size of the targets [m, rad]
    type(search_place_type), intent(in) :: place             !< the design
    type(found_design_type), intent(out) :: found            !< the design to which the search led
    real(wp) :: at(fit%n), value

    call search_branch(fit, limits, scale, place, at, value, found%found)
    if (.not. found%found) return
    call follow_design(fit, limits, at, found%value, found%found)
    if (fit%near%used .and. .not. has_ended(fit) .and. .not. agree(found%found, found%value, value, scale)) then
      ! runs beside others are not trusted here
      fit%must_follow = .true.
      call search_branch(fit, limits, scale, place, at, value, found%found)
      fit%must_follow = .false.
      if (found%found) call follow_design(fit, limits, at, found%value, found%found)
    end if
    found%x = fit%space%low + at(:fit%varied)*(fit%space%high - fit%space%low)
    found%q = fit%q_trial
    found%times = fit%times
  end subroutine search_closed

  !> Whether the value of a design that was followed from its start is the one that the search found.
  pure logical function agree(found, followed, searched, scale)
    logical, intent(in) :: found          !< the motion comes to the end of the run
    real(wp), intent(in) :: followed      !< value of the run that was followed
    real(wp), intent(in) :: searched      !< value that the search found
    real(wp), intent(in) :: scale         !< size of the targets [m, rad]

    agree = found .and. abs(followed - searched) <= 1.0e-8_wp*abs(searched) + (same_difference*scale)**2
  end function agree

  !> Follow the run of the design that a search found from its start.
  subroutine follow_design(fit, limits, at, value, found)
    type(exact_fit_type), intent(inout), target :: fit       !< the fit, whose start is that of the design
    type(design_limits_type), intent(in) :: limits           !< the limits
    real(wp), intent(in) :: at(:)                            !< (n) the place
    real(wp), intent(out) :: value                           !< its value
    logical, intent(out) :: found                            !< the motion comes to the end of the run
    type(limited_fit_type) :: limited
    logical :: before

    call new_limited_fit(fit, limits, limited)
    before = fit%must_follow
    fit%must_follow = .true.
    call find_value(limited, at, value, found)
    fit%must_follow = before
  end subroutine follow_design

  !> Improve a design along its branch.
  subroutine search_branch(fit, limits, scale, place, at, value, found)
    type(exact_fit_type), intent(inout), target :: fit       !< the fit
    type(design_limits_type), intent(in) :: limits           !< the limits
    real(wp), intent(in) :: scale                            !< size of the targets [m, rad]
    type(search_place_type), intent(in) :: place             !< the design
    real(wp), intent(out) :: at(:)                           !< (n) the place to which the search led
    real(wp), intent(out) :: value                           !< its value
    logical, intent(out) :: found                            !< the place has a value within all limits
    type(limited_fit_type) :: limited
    real(wp) :: present(size(place%parts))
    integer :: pass

    call begin_at(place%q, fit)
    present = place%parts
    value = huge(value)
    at(:fit%varied) = place%x
    call new_limited_fit(fit, limits, limited)
    do pass = 1, most_pivots
      call choose_pivots(present, fit%free)
      at(fit%varied + 1:) = gaps_of(present, fit%free)
      call search_from_place(limited, scale, at, found)
      present = parts_of(at(fit%varied + 1:), fit%free)
      if (.not. found) return
      if (has_good_pivots(present, fit%free)) exit
    end do
    call find_value(limited, at, value, found)
  end subroutine search_branch

  !> Search from one place, by the method that the user chose.
  subroutine search_from_place(limited, scale, at, found)
    type(limited_fit_type), intent(inout) :: limited         !< the fit with its limits
    real(wp), intent(in) :: scale                            !< size of the targets [m, rad]
    real(wp), intent(inout) :: at(:)                         !< (n) the place
    logical, intent(out) :: found                            !< the place has a value within all limits
    character(len=:), allocatable :: method
    logical :: has_squares, by_squares

    found = .true.
    associate (model => limited%fit%space%model)
      method = model%request%optimum%method
      has_squares = limited%fit%groups > 0
      by_squares = is_least_squares(model) .and. (method == 'auto' .or. method == 'levenberg-marquardt')
      ! a sum of squares alone is a good place to begin at
      if (has_squares) call make_squares_least(limited%fit, scale, at, found)
      if (found .and. .not. by_squares) call keep_limits(limited, method, at, found)
    end associate
  end subroutine search_from_place

  !> Make the sum of squares least, without limits.
  subroutine make_squares_least(fit, scale, at, found)
    class(exact_fit_type), intent(inout) :: fit     !< the fit
    real(wp), intent(in) :: scale                   !< size of the targets [m, rad]
    real(wp), intent(inout) :: at(:)                !< (n) the place
    logical, intent(out) :: found                   !< the place has a value
    type(least_squares_settings_type) :: settings
    type(least_squares_outcome_type) :: outcome
    real(wp) :: y(0, fit%groups)

    settings%small = (1.0e-14_wp*scale)**2*size(fit%targets)
    settings%short = 1.0e-9_wp
    call minimise_squares(fit, at, y, bounds_type(0.0_wp*at, 0.0_wp*at + 1.0_wp, y, y), settings, outcome)
    found = outcome%kind /= ended_without_value
  end subroutine make_squares_least

  !> Make the value least within the limits.
  subroutine keep_limits(limited, method, at, found)
    type(limited_fit_type), intent(inout) :: limited    !< the fit with its limits
    character(len=*), intent(in) :: method              !< name of the method, or auto
    real(wp), intent(inout) :: at(:)                    !< (n) the place
    logical, intent(out) :: found                       !< the place is within all limits
    type(smooth_settings_type) :: settings
    type(smooth_outcome_type) :: outcome
    real(wp) :: value, gradient(size(at)), limits(limited%n_limits), slopes(size(at), limited%n_limits), before
    integer :: i

    limited%scale = 1.0_wp
    limited%least = huge(1.0_wp)
    ! a sum of squares may have used up all steps at the edge of the designs that move
    limited%fit%work = 0
    call limited%evaluate(at, value, gradient, limits, slopes, found)
    if (.not. found) return
    ! slopes and curvatures are then about one
    if (any(abs(gradient) > 0.0_wp)) limited%scale = norm2(gradient) + sum(limited%values%by_x**2)
    if (method /= 'auto' .and. method /= 'levenberg-marquardt') settings%method = method
    before = huge(before)
    limited%least = huge(1.0_wp)
    do i = 1, most_restarts
      call minimise_within_limits(limited, at, 0.0_wp*at, 0.0_wp*at + 1.0_wp, settings, outcome)
      found = outcome%kind /= ended_infeasible .and. outcome%kind /= ended_nowhere
      if (.not. found) return
      limited%fit%q_start = limited%q_best
      if (.not. outcome%value < before - worthwhile*abs(before)) exit
      before = outcome%value
    end do
    call go_to_bounds(limited, outcome%value, at)
  end subroutine keep_limits

  !> Set unknowns that are at a bound but for round-off to the bound, where the place is then still within all limits.
  subroutine go_to_bounds(limited, least, at)
    type(limited_fit_type), intent(inout) :: limited    !< the fit with its limits
    real(wp), intent(in) :: least                       !< value of the place
    real(wp), intent(inout) :: at(:)                    !< (n) the place
    real(wp) :: place(size(at)), value, gradient(size(at)), limits(limited%n_limits), slopes(size(at), limited%n_limits)
    logical :: has_value

    place = at
    where (place < at_bound) place = 0.0_wp
    where (place > 1.0_wp - at_bound) place = 1.0_wp
    if (.not. any(abs(place - at) > 0.0_wp)) return
    call limited%evaluate(place, value, gradient, limits, slopes, has_value)
    if (.not. has_value .or. any(limits < 0.0_wp) .or. value > least + worthwhile*abs(least)) then
      limited%fit%q_start = limited%q_best
    else
      at = place
    end if
  end subroutine go_to_bounds
end module mech9_closed_search
