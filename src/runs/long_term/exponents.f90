!> Lyapunov exponents of a free motion: means over time of the rates at which neighbouring motions part.
!>
!> Directions are integrated with the motion by its exact variational equations, those of the derivatives by parameters: each direction is
!> the derivative by a parameter that sets no number. They are made orthonormal again and again; the logarithms of what this takes off
!> are summed (Benettin, Galgani, Giorgilli and Strelcyn; Shimada and Nagashima in docs/reference/bibliography.md). Directions are compared
!> by all coordinates and their rates, each in its unit, so that a change of independent coordinates does not change them. The sum of all
!> exponents is held against the mean divergence, which comes from directions of its own (mech9_orbit_divergence). Events carry
!> them on by their derivatives (mech9_event_variation). Where a stop or friction holds a coordinate, neighbouring motions become the same:
!> directions are lost for good, whose exponents are minus infinity.
module mech9_exponents
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_negative_inf, ieee_quiet_nan
  use mech9_failure_units, only: tell_in_units
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_data, exit_interrupted
  use mech9_text, only: to_text
  use mech9_random, only: random_type
  use mech9_model, only: model_type
  use mech9_partition, only: free_coordinate
  use mech9_variable_model, only: variable_model_type
  use mech9_directed_motion, only: set_directions, explain_refusal
  use mech9_simulation, only: interruption_type
  use mech9_sensitivity, only: sensitivity_type
  use mech9_motion_sensitivity, only: motion_sensitivity_type
  use mech9_held_directions, only: hold_directions
  use mech9_free_simulation, only: free_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_orbit_divergence, only: orbit_divergence_type
  implicit none
  private
  public :: exponents_found_type, find_exponents, refuse_exponents, count_states

  !> Times at which the running means are kept, and blocks of time for standard errors.
  integer, parameter :: kept_times = 200, blocks = 20
  !> Directions are made orthonormal about so often in each of these times, and before logarithms differ by more than the second number
  !> or so: their angles are then well above round-off.
  integer, parameter :: least_in_each = 2
  real(wp), parameter :: largest_spread = 2.0_wp
  !> So many steps lie between two sets where nothing else asks for more of them: the integration begins anew at each.
  real(wp), parameter :: least_steps = 4.0_wp
  !> Growth of the time between two orthonormal sets: local rates change with the motion.
  real(wp), parameter :: growth = 1.5_wp
  !> Beyond this difference directions that were integrated since the last time are parallel within the tolerances.
  real(wp), parameter :: parallel = 18.0_wp
  !> A direction is lost at an event where less than this part of it is left across those before: round-off, far below what parallel ones
  !> have.
  real(wp), parameter :: lost_part = 1.0e-11_wp

  !> The exponents and how they were found.
  type :: exponents_found_type
    real(wp), allocatable :: exponents(:)     !< (K) largest first [1/s]
    real(wp), allocatable :: errors(:)        !< (K) their standard errors, from means over blocks of time [1/s]
    real(wp), allocatable :: changes(:)       !< (K) what the means changed by in the second half of the time [1/s]
    real(wp), allocatable :: times(:)         !< (n) times of the running means [s]
    real(wp), allocatable :: history(:, :)    !< (K,n) the means from the end of the transient up to these times [1/s]
    real(wp) :: from = 0.0_wp                 !< end of the transient [s]
    real(wp) :: to = 0.0_wp                   !< end of the sums [s]
    logical :: knows_divergence = .false.     !< all exponents were found, and none was lost
    real(wp) :: divergence = 0.0_wp           !< mean divergence along the motion, with which their sum agrees [1/s]
    integer :: states = 0                     !< dimension of the state without time: so many exponents there are
    integer :: orthonormalised = 0            !< how often directions were made orthonormal
    integer :: coordinate_changes = 0         !< of the independent coordinates
    integer :: lost = 0                       !< directions that were lost at events; the exponents of so many are minus infinity
  end type exponents_found_type

  !> Sums of logarithms at the times at which directions were made orthonormal.
  type :: log_sums_type
    integer :: count = 0                      !< how many times
    real(wp), allocatable :: lost_at(:)       !< (K) times at which directions were lost; huge: they were not [s]
    real(wp), allocatable :: times(:)         !< the times, then room for more [s]
    real(wp), allocatable :: sums(:, :)       !< (K,times) since the end of the transient
  contains
    procedure :: add
    procedure :: at
  end type log_sums_type

  !> A model that does not depend on its parameters.
  type, extends(variable_model_type) :: constant_model_type
    type(model_type), pointer :: model => null()   !< not owned
  contains
    procedure :: at => same_model
  end type constant_model_type

contains

  !> The dimension of the state without time: free coordinates, their rates, and states of motors.
  pure integer function count_states(model) result(states)
    type(model_type), intent(in) :: model   !< the model
    integer :: i

    states = 2*count(model%problem%partition%kind == free_coordinate)
    do i = 1, size(model%mechanism%motors)
      if (model%mechanism%motors(i)%motor%has_state()) states = states + 1
    end do
  end function count_states

  !> Find the first exponents of a model. Fails with exit_data where nothing is free to move, or where contacts do not allow them, with exit_usage where there are not so many, and as a motion does. Where the user interrupts, means up to there are found.
  subroutine find_exponents(given, count, found, err, interruption)
    type(model_type), intent(in) :: given                            !< the model
    integer, intent(in) :: count                                     !< how many exponents are found
    type(exponents_found_type), intent(out) :: found                 !< the exponents
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop
    type(model_type), pointer :: model
    type(model_motion_type), pointer :: motion
    type(constant_model_type), pointer :: variable

    found%states = count_states(given)
    call refuse_exponents(given, count, err)
    if (allocated(err)) return
    allocate (model, source=given)
    allocate (motion, variable)
    call set_directions(count, model)
    variable%model => model
    call motion%assemble(model, err)
    if (.not. allocated(err)) call motion%prepare(model, err)
    if (.not. allocated(err)) call follow(motion%free(), variable, count, found, err, interruption)
    call explain_refusal(err, 'exponents', 'exponents')
    call motion%close()
    deallocate (motion, variable, model)
  end subroutine find_exponents

  !> Fail where exponents do not exist or are not known.
  subroutine refuse_exponents(model, count, err)
    type(model_type), intent(in) :: model               !< the model
    integer, intent(in) :: count                        !< how many exponents are wanted
    type(error_type), allocatable, intent(out) :: err   !< allocated where they are refused
    integer :: states

    states = count_states(model)
    if (model%is_driven()) then
      call raise(err, exit_data, 'every independent coordinate is driven, so that no exponent exists; leave out a &drive')
      if (size(model%problem%drives) > 0) err%place = model%problem%drives(1)%drive%place
    else if (count > states) then
      call raise(err, exit_usage, 'there are '//to_text(states)//' exponents: one for each free coordinate, rate and state of '// &
                 'a motor; ask for '//to_text(states)//' at most')
    else if (model%request%exponents%transient >= abs(model%request%time%end - model%request%time%start) .and. &
             .not. model%request%exponents%time > 0.0_wp) then
      call raise(err, exit_data, 'the transient of the exponents ends after the motion; give a later end= in &time, or time= '// &
                 'in &exponents', model%request%exponents%place)
    end if
  end subroutine refuse_exponents

  !> The model, whatever its parameters.
  subroutine same_model(self, values, model, err)
    class(constant_model_type), intent(inout) :: self      !< the model as a function
    real(wp), intent(in) :: values(:)                   !< of all parameters
    type(model_type), intent(out) :: model              !< the model
    type(error_type), allocatable, intent(out) :: err   !< never allocated

    model = self%model
  end subroutine same_model

  !> Follow the motion with its directions.
  subroutine follow(simulation, variable, count, found, err, interruption)
    type(free_simulation_type), intent(inout) :: simulation          !< the motion, prepared
    class(variable_model_type), intent(inout), target :: variable    !< the model, whatever its parameters; outlives the motion
    integer, intent(in) :: count                                     !< how many directions there are
    type(exponents_found_type), intent(inout) :: found               !< gets the exponents
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop
    type(sensitivity_type) :: unused
    type(log_sums_type) :: sums
    type(orbit_divergence_type) :: divergence
    real(wp) :: logs(count), start, direction, longest
    logical :: holds

    associate (request => simulation%model%request)
      start = request%time%start
      direction = sign(1.0_wp, request%time%end - start)
      found%from = start + direction*request%exponents%transient
      found%to = request%time%end
      if (request%exponents%time > 0.0_wp) found%to = found%from + direction*request%exponents%time
    end associate
    ! directions are set before the integration begins
    call simulation%begin_sensitivity(variable, 2, unused, err)
    if (allocated(err)) return
    call set_start(simulation)
    allocate (sums%lost_at(count), source=huge(start))
    call simulation%start(err, interruption)
    if (.not. allocated(err)) call orthonormalise(simulation, 0.0_wp, .true., sums%lost_at, logs, err)
    longest = (found%to - found%from)/(kept_times*least_in_each)
    if (.not. allocated(err)) call advance(simulation, found%from, longest, found, sums, err)
    if (allocated(err)) return
    sums%count = 0
    call sums%add(found%from, 0.0_wp*logs)
    holds = count == found%states
    if (holds) call begin_divergence(simulation, divergence, err)
    if (allocated(err)) return
    if (holds) then
      call advance(simulation, found%to, longest, found, sums, err, divergence)
    else
      call advance(simulation, found%to, longest, found, sums, err)
    end if
    if (allocated(err)) then
      if (err%code /= exit_interrupted .or. sums%count < 2) return
      found%to = sums%times(sums%count)
    else if (holds) then
      call end_divergence(simulation, divergence, found, err)
      if (allocated(err)) return
    end if
    call evaluate(sums, found)
    found%lost = count_lost(sums)
    found%coordinate_changes = size(simulation%coordinate_changes)
  end subroutine follow

  !> Begin to integrate the divergence, with orthonormal directions. The volume that is summed is that of all coordinates: that of the
  !> directions, over their volume in the free coordinates.
  subroutine begin_divergence(simulation, divergence, err)
    type(free_simulation_type), intent(inout) :: simulation      !< the motion, with orthonormal directions
    type(orbit_divergence_type), intent(inout) :: divergence     !< begins
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    real(wp) :: log_volume
    integer :: i

    ! half the cost; a step of the method of order 8 changes little between two points
    divergence%takes_two = .true.
    associate (motors => simulation%model%mechanism%motors)
      call divergence%begin(simulation, pack([(i, i=1, size(motors))], [(motors(i)%motor%has_state(), i=1, size(motors))]), err)
    end associate
    if (.not. allocated(err)) call divergence%log_determinant_here(simulation, log_volume, err)
    divergence%log_volume = log_volume
  end subroutine begin_divergence

  !> Find the mean divergence, with orthonormal directions.
  subroutine end_divergence(simulation, divergence, found, err)
    type(free_simulation_type), intent(inout) :: simulation      !< the motion, with orthonormal directions
    type(orbit_divergence_type), intent(inout) :: divergence     !< up to here
    type(exponents_found_type), intent(inout) :: found           !< gets the mean
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    real(wp) :: log_volume

    found%knows_divergence = divergence%is_known
    if (.not. divergence%is_known) return
    call simulation%stand_at_step(err)
    if (.not. allocated(err)) call divergence%log_determinant_here(simulation, log_volume, err)
    if (.not. allocated(err)) found%divergence = (divergence%log_volume - log_volume)/abs(found%to - found%from)
  end subroutine end_divergence

  !> Let the directions begin at random, so that none is left out.
  subroutine set_start(simulation)
    type(free_simulation_type), intent(inout) :: simulation   !< the motion, with room for directions
    type(random_type) :: random
    integer :: p, i, order

    associate (sensitivity => simulation%motion%system%sensitivity, plan => simulation%motion%system%plan)
      do p = 1, size(sensitivity%values, 1)
        do order = 0, 1
          do i = 1, size(plan%free)
            sensitivity%values(p, i, order) = random%symmetric()*plan%unit_of(plan%free(i))
          end do
        end do
        do i = 1, size(sensitivity%motors, 2)
          if (simulation%model%mechanism%motors(i)%motor%has_state()) sensitivity%motors(p, i, 0) = random%symmetric()
        end do
      end do
    end associate
  end subroutine set_start

  !> Go on to a time, by steps that end there, and sum the logarithms on the way.
  subroutine advance(simulation, t, longest, found, sums, err, divergence)
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, started
    real(wp), intent(in) :: t                                   !< the time [s]
    real(wp), intent(in) :: longest                             !< longest time between two orthonormal sets [s]
    type(exponents_found_type), intent(inout) :: found          !< counts them
    type(log_sums_type), intent(inout) :: sums                  !< gets the sums
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(orbit_divergence_type), intent(inout), optional :: divergence   !< is integrated, too; not unless given
    real(wp) :: logs(found_size(simulation)), from, to, since, interval, spread
    logical :: at_joint, passed

    passed = .false.
    simulation%end = t
    since = simulation%motion%t
    to = since
    interval = 0.0_wp
    do while (abs(t - to) > 0.0_wp)
      call simulation%stride(t, from, to, at_joint, err)
      call tell_in_units(err, simulation%model%mechanism)
      if (allocated(err)) return
      passed = passed .or. at_joint
      if (present(divergence)) then
        call divergence%add_step(simulation, from, to, err)
        if (at_joint .and. .not. allocated(err)) call divergence%pass(simulation, err)
        if (allocated(err)) return
      end if
      if (abs(t - to) > 0.0_wp .and. (at_joint .or. abs(to - since) < interval)) cycle
      if (at_joint) call simulation%leave_joint(err)
      if (allocated(err)) return
      call orthonormalise(simulation, to - from, passed, sums%lost_at, logs, err)
      if (allocated(err)) return
      passed = .false.
      found%orthonormalised = found%orthonormalised + 1
      spread = 0.0_wp
      if (count_lost(sums) < size(logs)) spread = maxval(logs, mask=sums%lost_at >= huge(to)) &
                                                  - minval(logs, mask=sums%lost_at >= huge(to))
      if (spread > parallel .and. size(logs) > 1) then
        call raise(err, exit_data, 'the directions become parallel within one step; ask for fewer exponents, or for a smaller '// &
                   'relative_tolerance in &solver')
        return
      end if
      call sums%add(to, logs)
      associate (start => simulation%model%request%time%start)
        call simulation%tell_share((to - start)/(found%to - start))
      end associate
      spread = max(spread, maxval(abs(logs)))
      interval = min(max(abs(longest), least_steps*abs(to - from)), growth*abs(to - since))
      if (spread > largest_spread) interval = min(interval, abs(to - since)*largest_spread/spread)
      since = to
    end do
  end subroutine advance

  !> Number of directions.
  pure integer function found_size(simulation)
    type(free_simulation_type), intent(in) :: simulation   !< the motion with its directions

    found_size = size(simulation%motion%system%sensitivity%values, 1)
  end function found_size

  !> Make the directions orthonormal at the end of a step, each one to those before it, and go on from there.
  subroutine orthonormalise(simulation, step, passed, lost_at, logs, err)
    type(free_simulation_type), intent(inout) :: simulation   !< the motion at the end of a step
    real(wp), intent(in) :: step                              !< length of this step [s]
    logical, intent(in) :: passed                             !< events were passed since the last time
    real(wp), intent(inout) :: lost_at(:)                     !< (K) times at which directions were lost; huge: they were not [s]
    real(wp), intent(out) :: logs(:)                          !< (K) logarithms of the lengths that the directions had across those before
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    real(wp), allocatable :: directions(:, :)
    real(wp) :: along, length, before
    integer :: p, r, again

    logs = 0.0_wp
    call simulation%stand_at_step(err)
    if (.not. allocated(err)) call simulation%motion%system%show_sensitivity(err)
    if (allocated(simulation%motion%system%contact) .and. .not. allocated(err)) &
      call hold_directions(simulation%motion%system, simulation%motion%contacts%ends, err)
    if (allocated(err)) return
    call take_directions(simulation, directions)
    do p = 1, size(logs)
      if (lost_at(p) < huge(length)) cycle
      ! directions had the length 1; round-off is measured against that
      before = max(1.0_wp, norm2(directions(:, p)))
      ! twice is enough against round-off
      do again = 1, 2
        do r = 1, p - 1
          along = dot_product(directions(:, r), directions(:, p))
          directions(:, p) = directions(:, p) - along*directions(:, r)
          call combine(simulation%motion%system%sensitivity, p, 1.0_wp, r, -along)
        end do
      end do
      length = norm2(directions(:, p))
      if (passed .and. length <= lost_part*before) then
        lost_at(p) = simulation%motion%t
        directions(:, p) = 0.0_wp
        call combine(simulation%motion%system%sensitivity, p, 0.0_wp, p, 0.0_wp)
        cycle
      end if
      logs(p) = log(length)
      directions(:, p) = directions(:, p)/length
      call combine(simulation%motion%system%sensitivity, p, 1.0_wp/length, p, 0.0_wp)
    end do
    call simulation%motion%restart((simulation%motion%t), simulation%motion%system%vector(), err, step)
  end subroutine orthonormalise

  !> Replace a direction by a sum of two, in all that is integrated and held.
  pure subroutine combine(sensitivity, p, factor, r, other_factor)
    type(motion_sensitivity_type), intent(inout) :: sensitivity   !< the directions
    integer, intent(in) :: p                                      !< number of the direction
    real(wp), intent(in) :: factor                                !< of itself
    integer, intent(in) :: r                                      !< number of the other one
    real(wp), intent(in) :: other_factor                          !< of the other one

    associate (values => sensitivity%values, motors => sensitivity%motors)
      values(p, :, :) = factor*values(p, :, :) + other_factor*values(r, :, :)
      motors(p, :, :) = factor*motors(p, :, :) + other_factor*motors(r, :, :)
      if (.not. allocated(sensitivity%motion%held)) return
      associate (held => sensitivity%motion%held)
        held(p, :, :) = factor*held(p, :, :) + other_factor*held(r, :, :)
      end associate
    end associate
  end subroutine combine

  !> How many directions were lost.
  pure integer function count_lost(sums)
    type(log_sums_type), intent(in) :: sums   !< the sums

    count_lost = count(sums%lost_at < huge(sums%lost_at))
  end function count_lost

  !> Take the directions by all coordinates and rates, in their units, and the states of motors.
  subroutine take_directions(simulation, directions)
    type(free_simulation_type), intent(in) :: simulation       !< the motion, with the derivatives of all coordinates
    real(wp), allocatable, intent(out) :: directions(:, :)     !< (2M + motors,K)
    integer :: k, n, p

    associate (sensitivity => simulation%motion%system%sensitivity, plan => simulation%motion%system%plan)
      n = plan%n_coordinates
      allocate (directions(2*n + size(sensitivity%motors, 2), size(sensitivity%values, 1)))
      do p = 1, size(directions, 2)
        do k = 1, n
          directions(k, p) = sensitivity%motion%q(p, 0, k)/plan%unit_of(k)
          directions(n + k, p) = sensitivity%motion%q(p, 1, k)/plan%unit_of(k)
        end do
        directions(2*n + 1:, p) = sensitivity%motors(p, :, 0)
      end do
    end associate
  end subroutine take_directions

  !> Add logarithms at a time to the sums.
  pure subroutine add(self, t, logs)
    class(log_sums_type), intent(inout) :: self   !< the sums
    real(wp), intent(in) :: t                     !< the time [s]
    real(wp), intent(in) :: logs(:)               !< (K) logarithms since the time before
    real(wp), allocatable :: times(:), sums(:, :)

    if (.not. allocated(self%times)) allocate (self%times(1024), self%sums(size(logs), 1024))
    if (self%count == size(self%times)) then
      allocate (times(2*self%count), sums(size(logs), 2*self%count))
      times(:self%count) = self%times
      sums(:, :self%count) = self%sums
      call move_alloc(times, self%times)
      call move_alloc(sums, self%sums)
    end if
    self%count = self%count + 1
    self%times(self%count) = t
    self%sums(:, self%count) = logs
    if (self%count > 1) self%sums(:, self%count) = self%sums(:, self%count) + self%sums(:, self%count - 1)
  end subroutine add

  !> The sums at a time, on a straight line between the times at which they are known.
  pure function at(self, t) result(sums)
    class(log_sums_type), intent(in) :: self      !< the sums
    real(wp), intent(in) :: t                     !< the time [s]
    real(wp) :: sums(size(self%sums, 1))
    integer :: before, behind, middle

    before = 1
    behind = self%count
    do while (behind - before > 1)
      middle = (before + behind)/2
      if (abs(self%times(middle) - self%times(1)) <= abs(t - self%times(1))) then
        before = middle
      else
        behind = middle
      end if
    end do
    sums = self%sums(:, before) + (self%sums(:, behind) - self%sums(:, before)) &
           *(t - self%times(before))/(self%times(behind) - self%times(before))
  end function at

  !> Means, running means, and standard errors from the sums.
  subroutine evaluate(sums, found)
    type(log_sums_type), intent(in) :: sums                 !< the sums
    type(exponents_found_type), intent(inout) :: found      !< with its times; gets the exponents
    real(wp) :: whole, means(size(sums%sums, 1), blocks)
    real(wp), allocatable :: unordered(:)
    integer, allocatable :: order(:)
    integer :: i, k

    whole = abs(found%to - found%from)
    unordered = sums%sums(:, sums%count)/whole
    do i = 1, blocks
      means(:, i) = (sums%at(found%from + (found%to - found%from)*real(i, wp)/blocks) &
                     - sums%at(found%from + (found%to - found%from)*real(i - 1, wp)/blocks))*blocks/whole
    end do
    allocate (found%errors(size(unordered)), found%changes(size(unordered)))
    allocate (found%times(kept_times), found%history(size(unordered), kept_times))
    do i = 1, kept_times
      found%times(i) = found%from + (found%to - found%from)*real(i, wp)/kept_times
      if (i == kept_times) found%times(i) = found%to
      found%history(:, i) = sums%at(found%times(i))/abs(found%times(i) - found%from)
    end do
    do k = 1, size(unordered)
      if (sums%lost_at(k) >= huge(whole)) cycle
      unordered(k) = ieee_value(whole, ieee_negative_inf)
      where (abs(found%times - found%from) >= (sums%lost_at(k) - found%from)*sign(1.0_wp, found%to - found%from)) &
        found%history(k, :) = unordered(k)
    end do
    ! exponents that are nearly equal may stand in the other order
    allocate (order(size(unordered)))
    do k = 1, size(unordered)
      order(k) = maxloc(unordered, dim=1, mask=[(all(order(:k - 1) /= i), i=1, size(unordered))])
    end do
    found%exponents = unordered(order)
    found%history = found%history(order, :)
    found%errors = ieee_value(whole, ieee_quiet_nan)
    found%changes = found%errors
    do k = 1, size(unordered)
      if (sums%lost_at(order(k)) < huge(whole)) cycle
      found%changes(k) = found%history(k, kept_times) - found%history(k, kept_times/2)
      found%errors(k) = sqrt(sum((means(order(k), :) - sum(means(order(k), :))/blocks)**2)/(blocks - 1)/blocks)
    end do
  end subroutine evaluate
end module mech9_exponents
