!> The least value of a smooth function between bounds and within limits, by NLopt (Johnson, https://nlopt.readthedocs.io).
!>
!> A place without value has a very large one for NLopt, and the limits of the last place that had them, so that steps to it are
!> refused and made shorter. The result is the best place of all that were evaluated and are within all limits.
module mech9_nlopt_minimum
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_ptr, c_null_ptr, c_loc, c_funloc, c_associated, c_f_pointer, c_null_char
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use, intrinsic :: ieee_exceptions, only: ieee_status_type, ieee_get_status, ieee_set_status, ieee_set_halting_mode, ieee_all
  use mech9_kinds, only: wp
  use mech9_smooth_problem, only: smooth_problem_type, smooth_settings_type, smooth_outcome_type, ended_converged, &
    ended_after_count, ended_infeasible
  use mech9_libnlopt, only: algorithm_of_name, create, destroy, set_lower_bounds, set_upper_bounds, set_objective, add_limits, &
    set_change_of_place, set_change_of_value, set_most_evaluations, set_local_optimizer, force_stop, optimize
  implicit none
  private
  public :: minimise_within_limits, has_limited_minimum

  logical, parameter :: has_limited_minimum = .true.   !< this build has NLopt

  integer(c_int), parameter :: most_evaluations_made = 5   !< NLopt's result where it ended after their number

  !> A search: the problem, the place that was evaluated last, and the best place so far.
  type :: search_type
    class(smooth_problem_type), pointer :: problem => null()
    type(smooth_settings_type) :: settings
    type(c_ptr) :: nlopt = c_null_ptr          !< address of NLopt's search
    real(wp), allocatable :: x(:)              !< (n) the place that was evaluated last
    logical :: has_value = .false.             !< the function has a value there
    real(wp) :: value = huge(1.0_wp)
    real(wp), allocatable :: gradient(:)       !< (n)
    real(wp), allocatable :: limits(:)         !< (limits)
    real(wp), allocatable :: slopes(:, :)      !< (n,limits)
    real(wp), allocatable :: best(:)           !< (n) the best place; not allocated while there is none
    real(wp) :: least = huge(1.0_wp)           !< the function there
    real(wp) :: largest = 0.0_wp               !< largest magnitude of the function so far
    integer :: evaluations = 0
  end type search_type

contains

  !> Make a function least between bounds and within limits. The start need not be within the limits, but the function must have a
  !> value there. The place stays as it is where no better one is found.
  subroutine minimise_within_limits(problem, x, low, high, settings, outcome)
    class(smooth_problem_type), intent(inout), target :: problem   !< the problem
    real(wp), intent(inout) :: x(:)                                !< (n) the start, then the best place
    real(wp), intent(in) :: low(:)                                 !< (n) least unknowns
    real(wp), intent(in) :: high(:)                                !< (n) largest unknowns
    type(smooth_settings_type), intent(in) :: settings             !< method and when to end
    type(smooth_outcome_type), intent(out) :: outcome              !< how the search ended
    type(search_type), target :: search
    type(ieee_status_type) :: status
    real(c_double) :: place(size(x)), value
    integer(c_int) :: ended

    search%problem => problem
    search%settings = settings
    allocate (search%gradient(problem%n), search%limits(problem%n_limits), search%slopes(problem%n, problem%n_limits), &
              source=0.0_wp)
    place = min(max(x, low), high)
    call visit(search, place)
    outcome%evaluations = search%evaluations
    if (.not. search%has_value) return
    call prepare(search, low, high)
    if (.not. c_associated(search%nlopt)) return
    ! NLopt's own arithmetic may overflow, which does no harm
    call ieee_get_status(status)
    call ieee_set_halting_mode(ieee_all, .false.)
    ended = optimize(search%nlopt, place, value)
    call ieee_set_status(status)
    call destroy(search%nlopt)
    outcome%evaluations = search%evaluations
    outcome%kind = merge(ended_after_count, ended_converged, ended == most_evaluations_made)
    if (.not. allocated(search%best)) outcome%kind = ended_infeasible
    outcome%value = search%least
    if (allocated(search%best)) x = search%best
  end subroutine minimise_within_limits

  !> Make NLopt's search.
  subroutine prepare(search, low, high)
    type(search_type), intent(inout), target :: search   !< gets its address; null where there is no such method
    real(wp), intent(in) :: low(:)                       !< (n) least unknowns
    real(wp), intent(in) :: high(:)                      !< (n) largest unknowns
    real(c_double) :: tolerances(search%problem%n_limits)
    integer(c_int) :: done
    type(c_ptr) :: inner

    search%nlopt = new_search(search%settings%method, search%problem%n)
    if (.not. c_associated(search%nlopt)) return
    tolerances = 0.5_wp*search%settings%margin
    done = set_lower_bounds(search%nlopt, low)
    done = set_upper_bounds(search%nlopt, high)
    done = set_objective(search%nlopt, c_funloc(value_for_nlopt), c_loc(search))
    if (search%problem%n_limits > 0) &
      done = add_limits(search%nlopt, int(search%problem%n_limits, c_int), c_funloc(limits_for_nlopt), c_loc(search), tolerances)
    done = set_change_of_place(search%nlopt, search%settings%short)
    done = set_change_of_value(search%nlopt, search%settings%flat)
    done = set_most_evaluations(search%nlopt, int(search%settings%most_evaluations, c_int))
    if (search%settings%method /= 'auglag') return
    inner = new_search('lbfgs', search%problem%n)
    if (.not. c_associated(inner)) return
    done = set_change_of_place(inner, search%settings%short)
    done = set_change_of_value(inner, search%settings%flat)
    done = set_local_optimizer(search%nlopt, inner)
    call destroy(inner)
  end subroutine prepare

  !> A search of NLopt; null where there is no such method.
  type(c_ptr) function new_search(method, n)
    character(len=*), intent(in) :: method   !< slsqp, mma, ccsaq, auglag or lbfgs
    integer, intent(in) :: n                 !< number of unknowns
    character(len=16) :: name
    integer(c_int) :: algorithm

    new_search = c_null_ptr
    select case (method)
    case ('slsqp')
      name = 'LD_SLSQP'
    case ('mma')
      name = 'LD_MMA'
    case ('ccsaq')
      name = 'LD_CCSAQ'
    case ('auglag')
      name = 'AUGLAG'
    case ('lbfgs')
      name = 'LD_LBFGS'
    case default
      return
    end select
    algorithm = algorithm_of_name(trim(name)//c_null_char)
    if (algorithm >= 0) new_search = create(algorithm, int(n, c_int))
  end function new_search

  !> The function for NLopt.
  real(c_double) function value_for_nlopt(n, x, gradient, data) bind(c) result(value)
    integer(c_int), value :: n            !< number of unknowns
    real(c_double), intent(in) :: x(n)    !< the place
    type(c_ptr), value :: gradient        !< address of (n) derivatives; null: none are asked for
    type(c_ptr), value :: data            !< address of the search
    type(search_type), pointer :: search
    real(c_double), pointer :: slopes(:)

    call c_f_pointer(data, search)
    call visit(search, x)
    value = search%value
    if (.not. search%has_value) value = 1.0e6_wp*(1.0_wp + search%largest)
    if (.not. c_associated(gradient)) return
    call c_f_pointer(gradient, slopes, [n])
    slopes = search%gradient
  end function value_for_nlopt

  !> The limits for NLopt, which must not be positive.
  subroutine limits_for_nlopt(m, values, n, x, gradient, data) bind(c)
    integer(c_int), value :: m                    !< number of limits
    real(c_double), intent(out) :: values(m)      !< their numbers
    integer(c_int), value :: n                    !< number of unknowns
    real(c_double), intent(in) :: x(n)            !< the place
    type(c_ptr), value :: gradient                !< address of (n,m) derivatives; null: none are asked for
    type(c_ptr), value :: data                    !< address of the search
    type(search_type), pointer :: search
    real(c_double), pointer :: slopes(:, :)

    call c_f_pointer(data, search)
    call visit(search, x)
    values = search%settings%margin - search%limits
    if (.not. c_associated(gradient)) return
    call c_f_pointer(gradient, slopes, [n, m])
    slopes = -search%slopes
  end subroutine limits_for_nlopt

  !> Evaluate the problem at a place, unless it is the one that was evaluated last, and keep the best place.
  subroutine visit(search, x)
    type(search_type), intent(inout) :: search   !< gets value, limits and derivatives; where there are none they stay
    real(wp), intent(in) :: x(:)                 !< (n) the place
    real(wp) :: value, gradient(size(x)), limits(size(search%limits)), slopes(size(x), size(search%limits))
    integer(c_int) :: done

    if (allocated(search%x)) then
      if (all(.not. abs(x - search%x) > 0.0_wp)) return
    end if
    search%x = x
    search%evaluations = search%evaluations + 1
    if (c_associated(search%nlopt)) then
      if (search%problem%is_stopped()) done = force_stop(search%nlopt)
    end if
    call search%problem%evaluate(x, value, gradient, limits, slopes, search%has_value)
    if (search%has_value) search%has_value = ieee_is_finite(value) .and. all(ieee_is_finite(gradient)) .and. &
                                             all(ieee_is_finite(limits)) .and. all(ieee_is_finite(slopes))
    if (.not. search%has_value) return
    search%value = value
    search%gradient = gradient
    search%limits = limits
    search%slopes = slopes
    search%largest = max(search%largest, abs(value))
    if (any(limits < 0.0_wp) .or. value >= search%least) return
    search%best = x
    search%least = value
  end subroutine visit
end module mech9_nlopt_minimum
