!> Periodic motions under forces, stable or not, by shooting.
!>
!> The period of a driven motion is a multiple of the common period of its laws, that of a free motion is unknown. From the start of the
!> data file, and from random starts, Newton's method looks for a state to which the motion comes back. Where it finds none, the
!> motion goes on for some periods, which leads to stable motions.
module mech9_periodic
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_assembly, exit_interrupted
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_random, only: random_type
  use mech9_result_units, only: unit_of, unit_name, rate_unit_of, rate_unit_name
  use mech9_model, only: model_type
  use mech9_directed_motion, only: explain_refusal
  use mech9_state, only: state_type, copy_state
  use mech9_simulation, only: interruption_type
  use mech9_law_periods, only: law_period_type, find_law_period, fit_period
  use mech9_period_map, only: period_map_type
  use mech9_periodic_motion, only: periodic_motion_type, find_multipliers, judge_stability, same_motion, unstable, &
    belongs_to_family
  use mech9_periodic_newton, only: newton_type
  implicit none
  private
  public :: periodic_found_type, find_periodic

  !> Periods that the motion goes on for, where Newton's method finds nothing: one after the other.
  integer, parameter :: transients(*) = [0, 10, 40, 150]
  !> Parts of the period at whose ends a motion may repeat already.
  integer, parameter :: parts(*) = [2, 3, 5, 7]
  !> Coordinates that move by less, in their units, stand still.
  real(wp), parameter :: at_rest = 1.0e-6_wp
  !> Deviations up to so many times the tolerance, and what motions grow by, are errors of steps.
  real(wp), parameter :: of_check = 4.0_wp
  !> Largest difference of both ends, in units of the state.
  real(wp), parameter :: largest_residual = 1.0e-5_wp
  !> A motion that moves farther in a period goes away without bounds, in units of the state.
  real(wp), parameter :: farthest = 1.0e6_wp
  !> Random starts lie within the range of the motion from the start of the file, times this, and at least so far from it in units; angles
  !> of open chains anywhere.
  real(wp), parameter :: wider = 1.5_wp, least_range = 0.1_wp
  !> A free motion comes back between these parts of the guess of its period, if at all; so many positions are looked at.
  real(wp), parameter :: nearest_return = 0.6_wp, farthest_return = 1.6_wp
  integer, parameter :: samples = 400
  real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)

  !> The motions, that from the start of the data file first where it leads to one.
  type :: periodic_found_type
    type(periodic_motion_type), allocatable :: motions(:)   !< distinct ones
    type(law_period_type) :: laws                           !< the laws of time
    integer :: starts = 0                                   !< starts from which was searched
    integer :: failed = 0                                   !< of these, those from which none was found
  end type periodic_found_type

contains

  !> Find periodic motions of a model. Fails with exit_data where there can be none, or where they are not known, with exit_assembly where
  !> none was found, and as a motion does.
  subroutine find_periodic(given, found, err, interruption)
    type(model_type), intent(in) :: given                            !< the model
    type(periodic_found_type), intent(out) :: found                  !< the motions
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the search shall stop
    type(period_map_type) :: map
    real(wp) :: period

    call refuse(given, err)
    if (.not. allocated(err)) call find_law_period(given, found%laws, err)
    if (.not. allocated(err)) call choose_period(given, found%laws, period, err)
    if (.not. allocated(err)) call map%begin(given, err, interruption)
    if (.not. allocated(err)) call search_all(given, map, period, found, err)
    call explain_refusal(err, 'the derivatives by which periodic motions are found', 'periodic motions')
    call map%close()
  end subroutine find_periodic

  !> Fail where periodic motions do not exist or are not known.
  subroutine refuse(model, err)
    type(model_type), intent(in) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated where they are refused

    if (model%is_driven()) then
      call raise(err, exit_data, 'every independent coordinate is driven, so that the motion is periodic as its drives are; '// &
                 'leave out --periodic, or a &drive')
      if (size(model%problem%drives) > 0) err%place = model%problem%drives(1)%drive%place
    else if (model%request%output%with_derivatives()) then
      call raise(err, exit_data, 'derivatives by parameters are not known for periodic motions; leave out sensitivities= and '// &
                 'gradients=', model%request%output%sensitivities_place)
    end if
  end subroutine refuse

  !> Choose the period: a multiple of that of the laws, or a guess.
  subroutine choose_period(model, laws, period, err)
    type(model_type), intent(in) :: model               !< the model
    type(law_period_type), intent(in) :: laws           !< the laws of time
    real(wp), intent(out) :: period                     !< the period, or its guess [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated where there is none

    period = model%request%periodic%period
    if (laws%follows_time) then
      call fit_period(laws, model%request%periodic%period, model%request%periodic%place, period, err)
    else if (.not. period > 0.0_wp) then
      call raise(err, exit_data, 'no drive, load or motor follows time, so that the motion has a period of its own; give a '// &
                 'guess for it by period= in &periodic', model%request%periodic%place)
    end if
  end subroutine choose_period

  !> Search from the start of the data file, and from random starts.
  subroutine search_all(given, map, period, found, err)
    type(model_type), intent(in) :: given                  !< the model
    type(period_map_type), intent(inout) :: map            !< the map, begun
    real(wp), intent(in) :: period                         !< or its guess [s]
    type(periodic_found_type), intent(inout) :: found      !< gets the motions
    type(error_type), allocatable, intent(out) :: err      !< allocated if none was found
    type(error_type), allocatable :: failure
    type(periodic_motion_type) :: motion
    type(random_type) :: random
    type(state_type) :: start
    real(wp), allocatable :: first(:), x(:), range(:)
    integer :: i

    allocate (found%motions(0))
    first = map%state_at_start()
    call copy_state(map%start, start)
    call find_range(map, first, period, given%request%periodic%starts, range)
    do i = 0, given%request%periodic%starts
      x = first
      call copy_state(start, map%start)
      if (i > 0) call draw(random, range, x)
      call search(map, found%laws, x, period, motion, failure)
      found%starts = found%starts + 1
      if (allocated(failure)) then
        if (failure%code == exit_interrupted .or. .not. allocated(err)) call move_alloc(failure, err)
        found%failed = found%failed + 1
        if (err%code == exit_interrupted) then
          if (size(found%motions) > 0) call raise(err, exit_interrupted, 'interrupted; '// &
            counted(size(found%motions), 'periodic motion')//' of '//counted(found%starts - 1, 'start')//' found until then')
          return
        end if
      else if (.not. is_known(motion, found%motions)) then
        call append(motion, found%motions)
      end if
    end do
    if (size(found%motions) > 0 .and. allocated(err)) deallocate (err)
  end subroutine search_all

  !> The range in which random starts lie, on both sides of the start of the data file.
  subroutine find_range(map, x, period, starts, range)
    type(period_map_type), intent(inout) :: map       !< the map
    real(wp), intent(in) :: x(:)                      !< (states) the start of the data file
    real(wp), intent(in) :: period                    !< or its guess [s]
    integer, intent(in) :: starts                     !< random starts; 0: no range is needed
    real(wp), allocatable, intent(out) :: range(:)    !< (states)
    type(error_type), allocatable :: err
    integer :: n

    n = size(map%free)
    range = map%unit_of
    if (starts == 0) return
    call map%evaluate(x, period, err, with_volume=.true.)
    if (allocated(err)) return
    range(:n) = max(least_range*map%unit_of(:n), wider*map%largest_move(map%free))
    range(n + 1:2*n) = range(:n)*turn/period
    ! angles that no chain limits may begin anywhere
    where (map%period_of(map%free) > 0.0_wp .and. (range(:n) > 0.5_wp*map%period_of(map%free) .or. .not. map%has_chains)) &
      range(:n) = 0.5_wp*map%period_of(map%free)
    range(2*n + 1:) = max(1.0_wp, abs(map%at_end(2*n + 1:)))
  end subroutine find_range

  !> Draw a start.
  subroutine draw(random, range, x)
    type(random_type), intent(inout) :: random   !< goes on
    real(wp), intent(in) :: range(:)             !< (states) on both sides
    real(wp), intent(inout) :: x(:)              !< (states) the middle; then the start
    integer :: i

    do i = 1, size(x)
      x(i) = x(i) + random%symmetric()*range(i)
    end do
  end subroutine draw

  !> Whether a motion was found before.
  pure logical function is_known(motion, motions)
    type(periodic_motion_type), intent(in) :: motion       !< the motion
    type(periodic_motion_type), intent(in) :: motions(:)   !< those before
    integer :: i

    is_known = .false.
    do i = 1, size(motions)
      is_known = is_known .or. same_motion(motion, motions(i))
    end do
  end function is_known

  !> Append a motion. By hand: an array constructor would leak (gfortran 12).
  subroutine append(motion, motions)
    type(periodic_motion_type), intent(in) :: motion                        !< the motion
    type(periodic_motion_type), allocatable, intent(inout) :: motions(:)    !< gets it
    type(periodic_motion_type), allocatable :: grown(:)
    integer :: i

    allocate (grown(size(motions) + 1))
    do i = 1, size(motions)
      grown(i) = motions(i)
    end do
    grown(size(grown)) = motion
    call move_alloc(grown, motions)
  end subroutine append

  !> Search from one start, and from where the motion leads meanwhile. An equilibrium that the motion leaves counts where nothing else is
  !> found.
  subroutine search(map, laws, first, period, motion, err)
    type(period_map_type), intent(inout) :: map          !< the map
    type(law_period_type), intent(in) :: laws            !< the laws of time
    real(wp), intent(in) :: first(:)                     !< (states) the start
    real(wp), intent(in) :: period                       !< or its guess [s]
    type(periodic_motion_type), intent(out) :: motion    !< the motion that was found
    type(error_type), allocatable, intent(out) :: err    !< allocated if nothing was found
    type(error_type), allocatable :: failure, of_start
    type(periodic_motion_type) :: found
    type(state_type) :: here
    real(wp) :: x(size(first))
    integer :: i, evaluations
    logical :: has_rest

    x = first
    has_rest = .false.
    evaluations = 0
    call copy_state(map%start, here)
    do i = 1, size(transients)
      call copy_state(here, map%start)
      call go_on(map, transients(i), period, x, evaluations, failure)
      call copy_state(map%start, here)
      if (.not. allocated(failure)) call search_near(map, laws, x, period, evaluations, found, failure)
      if (allocated(failure)) then
        if (failure%code == exit_interrupted) exit
        ! the failure near the start of the data file says most
        if (.not. allocated(of_start)) call move_alloc(failure, of_start)
        if (of_start%code /= exit_assembly) exit
        if (allocated(failure)) deallocate (failure)
      else
        motion = found
        has_rest = found%is_trivial .and. found%stability == unstable
        if (.not. has_rest) return
      end if
    end do
    if (allocated(failure)) then
      call move_alloc(failure, err)
    else if (.not. has_rest) then
      call move_alloc(of_start, err)
    end if
  end subroutine search

  !> Search from a state alone: first for a motion that comes back but for cyclic coordinates, where there are some, then for one that comes
  !> back but for whole turns. One of a family, or one that is hardly apart from a steady motion, counts only where there is no other.
  subroutine search_near(map, laws, x, period, evaluations, motion, err)
    type(period_map_type), intent(inout) :: map          !< the map
    type(law_period_type), intent(in) :: laws            !< the laws of time
    real(wp), intent(in) :: x(:)                         !< (states) the state
    real(wp), intent(in) :: period                       !< or its guess [s]
    integer, intent(inout) :: evaluations                !< counts them
    type(periodic_motion_type), intent(out) :: motion    !< the motion that was found
    type(error_type), allocatable, intent(out) :: err    !< allocated if nothing was found
    type(periodic_motion_type) :: relative
    real(wp) :: start(size(x))
    logical :: found

    found = .false.
    start = x
    if (.not. laws%follows_time .and. any(map%may_go_on)) then
      call search_relative(map, laws, start, period, evaluations, relative, found, err)
      if (allocated(err)) return
      if (found) motion = relative
      if (found .and. .not. belongs_to_family(relative)) return
    end if
    call search_whole(map, laws, start, period, evaluations, motion, err)
    if (.not. found .or. .not. allocated(err)) return
    if (err%code == exit_interrupted) return
    deallocate (err)
    motion = relative
  end subroutine search_near

  !> Search for a motion that comes back but for whole turns.
  subroutine search_whole(map, laws, x, period, evaluations, motion, err)
    type(period_map_type), intent(inout) :: map          !< the map
    type(law_period_type), intent(in) :: laws            !< the laws of time
    real(wp), intent(in) :: x(:)                         !< (states) the state
    real(wp), intent(in) :: period                       !< or its guess [s]
    integer, intent(inout) :: evaluations                !< counts them
    type(periodic_motion_type), intent(out) :: motion    !< the motion that was found
    type(error_type), allocatable, intent(out) :: err    !< allocated if nothing was found
    type(newton_type) :: newton
    real(wp) :: guess

    guess = period
    if (.not. laws%follows_time) call find_return(map, x, period, guess, err)
    if (allocated(err)) return
    call newton%begin(map, x, guess, .not. laws%follows_time)
    call newton%find(map, err)
    evaluations = evaluations + newton%evaluations
    newton%evaluations = evaluations
    if (allocated(err)) return
    if (newton%converged) then
      call take_motion(map, laws, newton, motion, err)
    else
      call describe_failure(map, newton, err)
    end if
  end subroutine search_whole

  !> Search for a free motion that comes back but for cyclic coordinates. A steady motion, in which these alone change, is none: its start
  !> is a better one for a search with whole turns.
  subroutine search_relative(map, laws, x, period, evaluations, motion, found, err)
    type(period_map_type), intent(inout) :: map          !< the map
    type(law_period_type), intent(in) :: laws            !< the laws of time
    real(wp), intent(inout) :: x(:)                      !< (states) the state; that of a steady motion where the search led to one
    real(wp), intent(in) :: period                       !< guess of the period [s]
    integer, intent(inout) :: evaluations                !< counts them
    type(periodic_motion_type), intent(inout) :: motion  !< the motion, where one was found
    logical, intent(out) :: found                        !< one was found
    type(error_type), allocatable, intent(out) :: err    !< allocated if the motion was interrupted
    type(newton_type) :: newton
    real(wp) :: guess, along(size(x))
    integer :: n

    found = .false.
    map%goes_on = map%may_go_on
    guess = period
    call find_return(map, x, period, guess, err)
    if (.not. allocated(err)) then
      call newton%begin(map, x, guess, .true.)
      call newton%find(map, err)
      evaluations = evaluations + newton%evaluations
      newton%evaluations = evaluations
    end if
    if (newton%converged .and. .not. allocated(err)) then
      n = size(map%free)
      along = map%rate_at_start*newton%period/newton%scale
      where (map%goes_on) along(:n) = 0.0_wp
      found = any(abs(along) > sqrt(newton%tolerance)*turn)
      if (found) call take_motion(map, laws, newton, motion, err)
      if (.not. found) x = newton%x
    end if
    map%goes_on = .false.
    if (.not. allocated(err)) return
    found = .false.
    if (err%code /= exit_interrupted) deallocate (err)
  end subroutine search_relative

  !> Find a better guess of the period of a free motion: the time near the guess at which the motion passes its start most closely.
  subroutine find_return(map, x, guess, period, err)
    type(period_map_type), intent(inout) :: map         !< the map
    real(wp), intent(in) :: x(:)                        !< (states) the state
    real(wp), intent(in) :: guess                       !< of the period [s]
    real(wp), intent(inout) :: period                   !< the better guess; stays where the motion does not come back [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if the motion failed
    real(wp) :: times(samples), states(size(x), samples), rate(size(x)), scale(size(x))
    real(wp) :: away(size(x), samples), along(samples), part, distance, least
    integer :: i, n

    n = size(map%free)
    times = [(farthest_return*guess*real(i, wp)/samples, i=1, samples)]
    call map%sample(x, times, states, rate, err)
    if (allocated(err)) return
    scale = map%unit_of
    scale(n + 1:2*n) = scale(n + 1:2*n)*turn/guess
    do i = 1, samples
      away(:, i) = map%difference(states(:, i), x)/scale
      along(i) = dot_product(rate/scale, away(:, i))
    end do
    least = huge(least)
    do i = 1, samples - 1
      if (along(i) > 0.0_wp .or. along(i + 1) <= 0.0_wp .or. times(i + 1) < nearest_return*guess) cycle
      part = -along(i)/(along(i + 1) - along(i))
      distance = norm2((1.0_wp - part)*away(:, i) + part*away(:, i + 1))
      if (distance >= least) cycle
      least = distance
      period = (1.0_wp - part)*times(i) + part*times(i + 1)
    end do
  end subroutine find_return

  !> Let the motion go on for some periods.
  subroutine go_on(map, periods, period, x, evaluations, err)
    type(period_map_type), intent(inout) :: map         !< the map
    integer, intent(in) :: periods                      !< how many
    real(wp), intent(in) :: period                      !< [s]
    real(wp), intent(inout) :: x(:)                     !< (states) the state
    integer, intent(inout) :: evaluations               !< counts them
    type(error_type), allocatable, intent(out) :: err   !< allocated if the motion failed
    integer :: i

    do i = 1, periods
      call map%evaluate(x, period, err)
      if (allocated(err)) return
      evaluations = evaluations + 1
      if (any(abs(map%residual()) > farthest*map%unit_of)) then
        call raise(err, exit_assembly, 'no periodic motion was found: the motion goes away without bounds; give another start', &
                   map%model%request%periodic%place)
        return
      end if
      call map%go_on(err)
      if (allocated(err)) return
      x = map%state_at_start()
    end do
  end subroutine go_on

  !> Say where a search ended that did not converge.
  subroutine describe_failure(map, newton, err)
    type(period_map_type), intent(in) :: map            !< the map, evaluated at its end
    type(newton_type), intent(in) :: newton             !< the search
    type(error_type), allocatable, intent(out) :: err   !< the failure
    character(len=:), allocatable :: list
    real(wp) :: r(size(newton%x))
    integer :: i, k, n

    n = size(map%free)
    list = ''
    r = map%residual()
    associate (mechanism => map%model%mechanism)
      do i = 1, n
        k = map%free(i)
        if (i > 1) list = list//', '
        list = list//'coordinate '//to_text(k)//' by '//to_text(r(i)/unit_of(mechanism, k), 3)//' '// &
               trim(unit_name(mechanism, k))//' and its rate by '//to_text(r(n + i)/rate_unit_of(mechanism, k), 3)//' '// &
               trim(rate_unit_name(mechanism, k))
      end do
    end associate
    call raise(err, exit_assembly, 'no periodic motion was found near the start: after '// &
               counted(newton%iterations, 'correction')//' both ends of '//to_text(newton%period, 6)//' s differ, '//list// &
               '; start nearer to one, or give starts= in &periodic', map%model%request%periodic%place)
  end subroutine describe_failure

  !> Take the motion to which a search converged. Fails where it is none.
  subroutine take_motion(map, laws, newton, motion, err)
    type(period_map_type), intent(inout) :: map          !< the map
    type(law_period_type), intent(in) :: laws            !< the laws of time
    type(newton_type), intent(inout) :: newton           !< the search, converged
    type(periodic_motion_type), intent(out) :: motion    !< the motion that was found
    type(error_type), allocatable, intent(out) :: err    !< allocated if it is no periodic motion

    motion%is_free = newton%is_free
    call find_least_period(map, laws, newton, motion%repeats_after, err)
    if (.not. allocated(err)) call check_next_period(map, laws, newton, err)
    if (.not. allocated(err)) call map%evaluate(newton%x, newton%period, err, with_volume=.true.)
    if (.not. allocated(err)) call check_ends(map, newton, err)
    if (allocated(err)) return
    motion%period = newton%period
    motion%is_trivial = all(map%largest_move <= at_rest*map%unit_of_coordinate)
    call find_multipliers(map%monodromy, motion%multipliers)
    motion%growth = newton%size_of_matrix
    ! a small free motion has a multiplier 1, or it is rest but for errors
    if (motion%is_free .and. all(map%largest_move <= sqrt(newton%tolerance)*map%unit_of_coordinate)) &
      motion%is_trivial = motion%is_trivial .or. &
                          all(abs(motion%multipliers - 1.0_wp) > sqrt(newton%tolerance*motion%growth))
    if (motion%is_trivial) motion%repeats_after = 0.0_wp
    motion%cyclic = count(map%goes_on)
    call judge_stability(newton%tolerance*motion%growth, motion)
    motion%product = real(product(motion%multipliers), wp)
    motion%knows_volume = map%volume_is_known
    if (map%volume_is_known) motion%product_by_divergence = exp(map%log_volume)
    motion%q = map%start%q
    motion%dq = map%dq_at_start
    motion%motor = map%motor_states(map%start)
    motion%turns = map%turns
    motion%advance = map%advance()
    where (abs(motion%advance) > 0.0_wp) motion%turns = 0
    motion%residual = map%residual_of_coordinates()
    motion%rate_residual = map%dq_at_end - map%dq_at_start
    motion%signature = map%means
    motion%start_error = max(newton%correction, newton%tolerance)
    motion%iterations = newton%iterations
    motion%evaluations = newton%evaluations
    motion%events = map%events
    motion%coordinate_changes = map%coordinate_changes
    call check_branch(map, newton, err)
  end subroutine take_motion

  !> Find whether the motion repeats within the period. A free motion then has that period; for a driven one it is told.
  subroutine find_least_period(map, laws, newton, repeats_after, err)
    type(period_map_type), intent(inout) :: map          !< the map
    type(law_period_type), intent(in) :: laws            !< the laws of time
    type(newton_type), intent(inout) :: newton           !< the search, converged
    real(wp), intent(out) :: repeats_after               !< the least period of a driven motion; 0: the whole one [s]
    type(error_type), allocatable, intent(out) :: err    !< allocated if the motion failed
    real(wp) :: period
    integer :: i

    period = newton%period
    i = 1
    do while (i <= size(parts))
      if (may_divide(laws, period/parts(i))) then
        call map%evaluate(newton%x, period/parts(i), err)
        if (allocated(err)) return
        newton%evaluations = newton%evaluations + 1
        if (newton%size_of_residual(map) <= of_check*newton%tolerance*newton%size_of_matrix) then
          period = period/parts(i)
          if (period < 1.0e-3_wp*newton%period) exit
          cycle
        end if
      end if
      i = i + 1
    end do
    repeats_after = 0.0_wp
    if (.not. period < newton%period) return
    ! every time is a period where nothing moves
    if (period < 1.0e-3_wp*newton%period) return
    if (newton%is_free) then
      newton%period = period
    else
      repeats_after = period
    end if
  end subroutine find_least_period

  !> Whether a motion may repeat after a time: the laws do.
  pure logical function may_divide(laws, period)
    type(law_period_type), intent(in) :: laws            !< the laws of time
    real(wp), intent(in) :: period                       !< [s]

    may_divide = laws%is_known
    if (may_divide .and. laws%period > 0.0_wp) &
      may_divide = abs(period/laws%period - anint(period/laws%period)) <= 1.0e-9_wp .and. period > 0.5_wp*laws%period
  end function may_divide

  !> Check that the next period is like this one, where whole turns lie between them, or where a law is not known.
  subroutine check_next_period(map, laws, newton, err)
    type(period_map_type), intent(inout) :: map          !< the map
    type(law_period_type), intent(in) :: laws            !< the laws of time
    type(newton_type), intent(inout) :: newton           !< the search, converged
    type(error_type), allocatable, intent(out) :: err    !< allocated if it is not
    real(wp) :: x(size(newton%x)), deviation
    integer :: turns(size(map%turns)), n
    logical :: differs

    call map%evaluate(newton%x, newton%period, err)
    if (allocated(err)) return
    turns = map%turns
    if (all(turns == 0) .and. laws%is_known .and. .not. any(map%goes_on)) return
    n = size(map%free)
    x = newton%x
    x(:n) = x(:n) + merge(map%at_end(:n) - x(:n), turns(map%free)*map%period_of(map%free), map%goes_on)
    call map%evaluate(x, newton%period, err, from=map%from + newton%period)
    if (allocated(err)) return
    deviation = newton%size_of_residual(map)
    differs = any(map%turns(map%free) /= turns(map%free) .and. .not. map%goes_on) .or. &
              deviation > of_check*newton%tolerance*newton%size_of_matrix
    if (.not. differs) return
    if (.not. laws%is_known) then
      call raise(err, exit_assembly, 'the motion comes back after '//to_text(newton%period, 8)//' s, and the next period '// &
                 'differs: the '//trim(laws%unknown)//' has another period', map%model%request%periodic%place)
    else
      call raise(err, exit_assembly, 'the motion comes back but for whole turns, and forces differ there, so that the next '// &
                 'period differs; no periodic motion was found', map%model%request%periodic%place)
    end if
  end subroutine check_next_period

  !> Check that both ends agree, and not only as far as neighbouring motions part within the period.
  subroutine check_ends(map, newton, err)
    type(period_map_type), intent(in) :: map             !< the map, evaluated
    type(newton_type), intent(in) :: newton              !< the search, converged
    type(error_type), allocatable, intent(out) :: err    !< allocated if they do not

    if (newton%size_of_residual(map) <= max(largest_residual, of_check*newton%tolerance)) return
    call raise(err, exit_assembly, 'no periodic motion was found: near a motion of '//to_text(newton%period, 8)//' s '// &
               'neighbours part by '//to_text(newton%size_of_matrix, 2)//' within the period, so that its ends cannot be '// &
               'brought together; give a smaller relative_tolerance in &solver, or another start', map%model%request%periodic%place)
  end subroutine check_ends

  !> Check that dependent coordinates come back, too.
  subroutine check_branch(map, newton, err)
    type(period_map_type), intent(in) :: map             !< the map, evaluated
    type(newton_type), intent(in) :: newton              !< the search, converged
    type(error_type), allocatable, intent(out) :: err    !< allocated if they do not
    real(wp) :: r(size(map%turns))
    integer :: k

    r = map%residual_of_coordinates()/map%unit_of_coordinate
    k = maxloc(abs(r), dim=1)
    if (abs(r(k)) <= 1.0e-3_wp + of_check*newton%tolerance*newton%size_of_matrix) return
    call raise(err, exit_assembly, 'the free coordinates come back after '//to_text(newton%period, 8)//' s, and coordinate '// &
               to_text(k)//' does not: the mechanism is in another assembly there; no periodic motion was found', &
               map%model%request%periodic%place)
  end subroutine check_branch
end module mech9_periodic
