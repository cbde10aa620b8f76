!> A motion in time, driven or free, behind one interface: it starts, advances from time to time, and shows its present position.
module mech9_simulation
  use mech9_kinds, only: wp, long
  use mech9_stop_request, only: stop_request_type
  use mech9_error, only: error_type, raise, add_place, exit_usage, exit_data, exit_integrator, exit_interrupted
  use mech9_simulation_failures, only: failure_not_started, failure_backwards, failure_interrupted, failure_accuracy, &
    failure_friction_sensitivity
  use mech9_failure_units, only: tell_in_units
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_requested, only: requested_type
  use mech9_closure_guard, only: check_closure
  use mech9_motion_event, only: motion_events_type
  use mech9_impact_watcher, only: impact_watcher_type
  use mech9_variable_model, only: variable_model_type
  use mech9_batch_products, only: batch_size
  use mech9_sensitivity, only: sensitivity_type, new_sensitivity, take_position
  use mech9_varied_motion, only: varied_motion_type, new_varied_motion, find_varied_motion
  implicit none
  private
  public :: simulation_type, interruption_type, simulation_statistics_type, coordinate_change_type
  public :: estimated_errors_type, judge_error, standing_type, refuse_frictions

  !> Answers whether a motion shall stop. It is asked before each time, before each step of an integrator, and after many steps of a
  !> driven motion.
  type, abstract, extends(stop_request_type) :: interruption_type
  contains
    procedure :: begin_run => begin_nothing
    procedure :: watch => watch_nothing
    procedure :: tell => tell_nothing
  end type interruption_type

  !> The work that a motion took since its start. Driven motions have no evaluations, free ones no halvings and crossings.
  type :: simulation_statistics_type
    integer(long) :: positions = 0           !< positions that were worked out, the start included
    integer(long) :: steps = 0               !< of the integrator, or of branch stepping
    integer(long) :: evaluations = 0         !< of the accelerations by an integrator
    integer(long) :: newton_iterations = 0   !< of all blocks
    integer(long) :: halvings = 0            !< steps of branch stepping that were too long
    integer(long) :: crossings = 0           !< singular positions that were crossed
  end type simulation_statistics_type

  !> The place of a motion between two outputs, and reasons for short steps.
  type :: standing_type
    real(wp) :: t = 0.0_wp              !< end of the last step [s]
    real(wp) :: step = 0.0_wp           !< its length [s]; 0: not known
    integer :: fastest = 0              !< the coordinate that moves fastest in its unit; 0: not known
    real(wp) :: rate = 0.0_wp           !< its rate [rad/s, m/s]
    real(wp) :: conditioning = 1.0_wp   !< least pivot ratio of all blocks
  end type standing_type

  !> A change of the independent coordinates, or of the angles that are integrated for ball joints.
  type :: coordinate_change_type
    real(wp) :: t = 0.0_wp                   !< time of the change [s]
    integer, allocatable :: independent(:)   !< the independent coordinates from then on, ascending
    integer, allocatable :: replaced(:)      !< of these, angles for which others are integrated from then on, near gimbal lock
  end type coordinate_change_type

  !> Errors at the outputs of a motion, estimated from other runs of it (mech9_accuracy).
  type :: estimated_errors_type
    real(wp) :: allowed = 0.0_wp              !< largest error that is allowed [unit of the file]
    real(wp) :: tolerance = 0.0_wp            !< of the motion, relative and absolute [rad, m, per s]
    character(len=:), allocatable :: method   !< of the motion
    !> Steps of bdf have these errors, and prince-dormand would take more than so many times their number; 0: it was not tried.
    integer :: limit_of_steps = 0
    real(wp), allocatable :: at(:)            !< at the outputs, from the start on, as far as these runs led [unit of the file]
    type(error_type), allocatable :: failure  !< of one of these runs, which ended before the last output
    integer :: runs = 0                       !< how many they were
    integer(long) :: evaluations = 0          !< of the accelerations in these runs
  end type estimated_errors_type

  !> Counts and largest numbers of a motion over its positions, up to one of them.
  type :: position_counts_type
    integer(long) :: positions = 0                 !< positions that were worked out
    real(wp) :: worst_closure = 0.0_wp             !< largest closure error [m]
    real(wp) :: largest_error = 0.0_wp             !< largest estimated error [unit of the file]
    real(wp) :: largest_energy_change = 0.0_wp     !< of the sum of energies, against the start [J]
  end type position_counts_type

  !> A motion. Times are given in order, from the mechanism's start in the direction of its end. It must not be copied.
  type, abstract :: simulation_type
    type(model_type), pointer :: model => null()   !< constant: the mechanism, its problem, and the request for results
    type(requested_type) :: requested              !< the part of the motion that is worked out
    logical :: with_energies = .false.             !< the energies are worked out at each time
    logical :: with_conditioning = .false.         !< the conditioning is worked out at each time
    logical :: with_error = .false.                !< each position is judged by its estimated error
    logical :: started = .false.                   !< the position at the start is worked out
    real(wp) :: t = 0.0_wp                         !< time of the present position [s]
    real(wp) :: closure = 0.0_wp                   !< largest closure error of the present position [m]
    real(wp) :: worst_closure = 0.0_wp             !< largest closure error of all positions [m]
    real(wp) :: least_conditioning = 1.0_wp        !< least singular value of the present position, with_conditioning
    type(estimated_errors_type) :: errors          !< of the positions; times are then those of the outputs
    real(wp) :: error = 0.0_wp                     !< estimated for the present position, with_error [unit of the file]
    real(wp) :: largest_error = 0.0_wp             !< estimated, of all positions, with_error [unit of the file]
    real(wp) :: kinetic_energy = 0.0_wp            !< of the present position, with_energies [J]
    real(wp) :: potential_energy = 0.0_wp          !< of gravity and springs, with_energies [J]
    real(wp) :: energy_at_start = 0.0_wp           !< sum of both energies, with_energies [J]
    real(wp) :: largest_energy_change = 0.0_wp     !< of this sum, against the start, with_energies [J]
    type(coordinate_change_type), allocatable :: coordinate_changes(:)   !< those of the independent coordinates so far
    type(motion_events_type) :: events             !< impacts, and stops that closed and opened so far
    class(impact_watcher_type), allocatable :: impacts   !< keeps the impulses of pairs, where they are wanted
    integer(long), private :: positions = 0        !< positions that were worked out
    type(position_counts_type), private :: kept(batch_size)   !< of positions that wait for their derivatives
    real(wp), private :: direction = 1.0_wp        !< 1, or -1 where time runs backwards
    type(varied_motion_type), allocatable, private :: varied   !< derivatives of all frames by the parameters, where they are wanted
    class(interruption_type), allocatable, private :: interruption
  contains
    procedure :: start
    procedure :: advance
    procedure :: visit
    procedure :: stop_if_interrupted
    procedure :: tell_share
    procedure :: stride => stride_at_once
    procedure :: end_of_stride => same_end
    procedure :: leave_joint => leave_nothing
    procedure :: may_jump => never_jumps
    procedure :: look_at
    procedure :: note_numbers
    procedure :: note_output => note_no_output
    procedure :: statistics
    procedure :: standing => standing_at_output
    procedure :: plans => no_other_plans
    procedure :: keep_counts
    procedure :: return_to_counts
    procedure :: keep_work => keep_no_work
    procedure :: return_to_work => keep_no_work
    procedure :: close => close_nothing
    procedure :: present_for_forces => present_as_shown
    procedure :: begin_sensitivity
    procedure :: show_sensitivity
    procedure :: begin_varied_motion
    procedure :: show_varied_motion
    procedure(position_interface), deferred :: begin
    procedure(position_interface), deferred :: go_to
    procedure(present_interface), deferred :: present
    procedure(closure_interface), deferred :: present_closure
    procedure(look_interface), deferred :: watch_conditioning
    procedure(energies_interface), deferred :: energies
    procedure(count_interface), deferred :: count_work
  end type simulation_type

  abstract interface
    !> The position at time t, with its velocities and accelerations: the first one by `begin`, the others by `go_to`.
    subroutine position_interface(self, t, err)
      import :: simulation_type, error_type, wp
      class(simulation_type), intent(inout) :: self       !< the simulation
      real(wp), intent(in) :: t                           !< time of the position [s]
      type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    end subroutine position_interface

    !> The present plan and state. They change with the next time, and with a change of coordinates.
    subroutine present_interface(self, plan, state)
      import :: simulation_type, plan_type, state_type
      class(simulation_type), intent(in), target :: self       !< the simulation
      type(plan_type), pointer, intent(out) :: plan            !< the plan that is executed
      type(state_type), pointer, intent(out) :: state          !< the present position, velocities and accelerations
    end subroutine present_interface

    !> Largest closure error of the present position [m].
    real(wp) function closure_interface(self)
      import :: simulation_type, wp
      class(simulation_type), intent(in) :: self   !< the simulation
    end function closure_interface

    !> Take the conditioning of the present position into account, where `always` is false only if it may be the worst.
    subroutine look_interface(self, always)
      import :: simulation_type
      class(simulation_type), intent(inout) :: self   !< the simulation
      logical, intent(in) :: always                   !< work it out in any case, into `least_conditioning`
    end subroutine look_interface

    !> Energies of the present position.
    subroutine energies_interface(self, kinetic, potential)
      import :: simulation_type, wp
      class(simulation_type), intent(inout) :: self   !< the simulation
      real(wp), intent(out) :: kinetic                !< of all bodies [J]
      real(wp), intent(out) :: potential              !< of gravity and springs [J]
    end subroutine energies_interface

    !> Add the work that was done to the statistics.
    subroutine count_interface(self, statistics)
      import :: simulation_type, simulation_statistics_type
      class(simulation_type), intent(inout) :: self                 !< the simulation
      type(simulation_statistics_type), intent(inout) :: statistics !< its positions are counted already
    end subroutine count_interface
  end interface

contains

  !> The position at the mechanism's start. With `interruption` the motion can be stopped from outside, by an error with the
  !> code exit_interrupted.
  subroutine start(self, err, interruption)
    class(simulation_type), intent(inout) :: self                    !< the simulation, as it was made
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop

    if (present(interruption)) then
      if (allocated(self%interruption)) deallocate (self%interruption)
      allocate (self%interruption, source=interruption)
    end if
    self%direction = sign(1.0_wp, self%model%request%time%end - self%model%request%time%start)
    self%t = self%model%request%time%start
    call self%stop_if_interrupted(self%t, err)
    if (.not. allocated(err)) call self%begin((self%t), err)
    if (.not. allocated(err)) call arrive(self, (self%t), err)
    if (.not. allocated(err)) self%started = .true.
    call tell_in_units(err, self%model%mechanism)
  end subroutine start

  !> Go on to time t. Fails with exit_singular where the motion cannot go on or its chains come open, with exit_integrator where
  !> the integration cannot, and with exit_usage for a time before the present one.
  subroutine advance(self, t, err)
    class(simulation_type), intent(inout) :: self       !< the simulation, started
    real(wp), intent(in) :: t                           !< time to go to, not before the present one [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (.not. self%started) then
      call raise(err, exit_usage, failure_not_started)
    else if (.not. (t - self%t)*self%direction >= 0.0_wp) then
      call raise(err, exit_usage, failure_backwards)
      err%failure%t = self%t
      err%failure%t_stop = t
    else
      call self%stop_if_interrupted(t, err)
    end if
    if (.not. allocated(err)) call self%go_to(t, err)
    if (.not. allocated(err)) call arrive(self, t, err)
    call tell_in_units(err, self%model%mechanism)
  end subroutine advance

  !> Go on to a time between two of the results, or stand at one within the last stride. The position is neither counted nor judged, but
  !> for its closure. Fails as advance does.
  subroutine visit(self, t, in_stride, err)
    class(simulation_type), intent(inout), target :: self   !< the simulation, started
    real(wp), intent(in) :: t                               !< time to go to [s]
    logical, intent(in) :: in_stride                        !< it lies within the last stride; otherwise not before the present time
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    call self%stop_if_interrupted(t, err)
    if (allocated(err)) then
      continue
    else if (in_stride) then
      call self%look_at(t, err)
    else
      call self%go_to(t, err)
    end if
    if (.not. allocated(err)) then
      self%t = t
      self%closure = self%present_closure()
      call self%present(plan, state)
      call check_closure(plan, t, self%closure, err)
    end if
    call tell_in_units(err, self%model%mechanism)
    if (allocated(err)) return
    if (self%with_conditioning) call self%watch_conditioning(.true.)
    if (self%with_energies) call self%energies(self%kinetic_energy, self%potential_energy)
  end subroutine visit

  !> Make a stride towards a time: the motion is then known from its start to its end, at any time between, and stands at the end.
  !> This procedure, for simulations that do not say otherwise, goes to the time.
  subroutine stride_at_once(self, t, from, to, at_joint, err)
    class(simulation_type), intent(inout) :: self       !< the simulation, started
    real(wp), intent(in) :: t                           !< time to go towards [s]
    real(wp), intent(out) :: from                       !< start of the stride [s]
    real(wp), intent(inout) :: to                       !< end of the stride before; then of this one, perhaps beyond t [s]
    logical, intent(out) :: at_joint                    !< rates may jump at its end, or the equations of motion change
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    at_joint = .false.
    from = to
    to = t
    call self%go_to(t, err)
  end subroutine stride_at_once

  !> The end of the last stride, which may have been changed since then [s].
  pure real(wp) function same_end(self, known)
    class(simulation_type), intent(in) :: self   !< the simulation, started
    real(wp), intent(in) :: known                !< the end of the last stride as it was [s]

    same_end = known
  end function same_end

  !> Pass what ended the last stride, and stand behind it. Nothing ends one unless a simulation says so.
  subroutine leave_nothing(self, err)
    class(simulation_type), intent(inout) :: self       !< the simulation, started
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

  end subroutine leave_nothing

  !> Whether rates or accelerations may jump at times that are not known before. They do not unless a simulation says so.
  pure logical function never_jumps(self) result(jumps)
    class(simulation_type), intent(in) :: self   !< the simulation

    jumps = .false.
  end function never_jumps

  !> Stand at a time within the last stride, before what ended it.
  subroutine look_at(self, t, err)
    class(simulation_type), intent(inout) :: self       !< the simulation, started
    real(wp), intent(in) :: t                           !< the time [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%go_to(t, err)
  end subroutine look_at

  !> Note the closure, and what else is wanted at each time, of the present position, which is neither counted nor judged.
  subroutine note_numbers(self)
    class(simulation_type), intent(inout) :: self       !< the simulation

    self%closure = self%present_closure()
    if (self%with_conditioning) call self%watch_conditioning(.true.)
    if (self%with_energies) call self%energies(self%kinetic_energy, self%potential_energy)
  end subroutine note_numbers

  !> Judge and count the position that was reached.
  subroutine arrive(self, t, err)
    class(simulation_type), intent(inout), target :: self   !< the simulation
    real(wp), intent(in) :: t                           !< time of the position [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    self%t = t
    self%closure = self%present_closure()
    call self%present(plan, state)
    call check_closure(plan, t, self%closure, err)
    if (.not. allocated(err) .and. self%with_error) call take_error(self, err)
    if (allocated(err)) return
    self%positions = self%positions + 1
    call self%note_output()
    self%worst_closure = max(self%worst_closure, self%closure)
    call self%watch_conditioning(self%with_conditioning)
    if (self%with_energies) call follow_energies(self)
  end subroutine arrive

  !> Note the position that was reached, which is one of the results. There is nothing to note unless a simulation says so.
  subroutine note_no_output(self)
    class(simulation_type), intent(inout) :: self       !< the simulation
  end subroutine note_no_output

  !> Keep the estimated error of the position that was reached, and judge it. Fails also where the error is not known, since one
  !> of the runs that estimate the errors could not go on.
  subroutine take_error(self, err)
    class(simulation_type), intent(inout) :: self       !< the simulation, at its next output
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (.not. allocated(self%errors%at)) return
    if (self%positions == size(self%errors%at)) then
      err = self%errors%failure
      return
    end if
    self%error = self%errors%at(self%positions + 1)
    call judge_error(self%t, self%error, self%errors, err)
    if (.not. allocated(err)) self%largest_error = max(self%largest_error, self%error)
  end subroutine take_error

  !> Fail where an error is larger than is allowed.
  pure subroutine judge_error(t, error, errors, err)
    real(wp), intent(in) :: t                             !< time of the position [s]
    real(wp), intent(in) :: error                         !< its estimated error [unit of the file]
    type(estimated_errors_type), intent(in) :: errors     !< of the motion, with the allowed one
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed

    if (error <= errors%allowed) return
    call raise(err, exit_integrator, failure_accuracy)
    err%failure%t = t
    err%failure%deviation = error
    err%failure%tolerance = errors%allowed
    err%failure%name = errors%method
    err%failure%values = reshape([errors%tolerance], [1, 1])
    err%failure%limit = errors%limit_of_steps
  end subroutine judge_error

  !> Keep the energies of the present position, and how far their sum goes from the start.
  subroutine follow_energies(self)
    class(simulation_type), intent(inout) :: self   !< the simulation
    real(wp) :: total

    call self%energies(self%kinetic_energy, self%potential_energy)
    total = self%kinetic_energy + self%potential_energy
    if (.not. self%started) self%energy_at_start = total
    self%largest_energy_change = max(self%largest_energy_change, abs(total - self%energy_at_start))
  end subroutine follow_energies

  !> Fail with exit_interrupted where the motion shall stop.
  subroutine stop_if_interrupted(self, t, err)
    class(simulation_type), intent(inout) :: self       !< the simulation
    real(wp), intent(in) :: t                           !< time that comes next [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (.not. allocated(self%interruption)) return
    call self%interruption%watch(self)
    if (.not. self%interruption%is_wanted()) return
    call raise(err, exit_interrupted, failure_interrupted)
    err%failure%t = t
  end subroutine stop_if_interrupted

  !> Tell who may interrupt the motion how far the answer is that needs it.
  subroutine tell_share(self, share)
    class(simulation_type), intent(inout) :: self   !< the simulation
    real(wp), intent(in) :: share                   !< part that is done, from 0 to 1

    if (allocated(self%interruption)) call self%interruption%tell(share)
  end subroutine tell_share

  !> Learn that a run begins, which may need several motions. Interruptions do nothing then unless they say so.
  subroutine begin_nothing(self, number)
    class(interruption_type), intent(inout) :: self   !< the interruption
    integer, intent(in), optional :: number           !< of the run in a study
  end subroutine begin_nothing

  !> See where a motion stands, before it is asked whether it shall stop. Interruptions look at nothing unless they say so.
  subroutine watch_nothing(self, simulation)
    class(interruption_type), intent(inout) :: self         !< the interruption
    class(simulation_type), intent(inout) :: simulation     !< the motion
  end subroutine watch_nothing

  !> Learn how far a call is that makes a motion, or many. Interruptions do not listen unless they say so.
  subroutine tell_nothing(self, share)
    class(interruption_type), intent(inout) :: self         !< the interruption
    real(wp), intent(in) :: share                           !< of the call that is done, from 0 to 1
  end subroutine tell_nothing

  !> The work done so far.
  function statistics(self)
    class(simulation_type), intent(inout) :: self   !< the simulation
    type(simulation_statistics_type) :: statistics

    statistics%positions = self%positions
    call self%count_work(statistics)
  end function statistics

  !> The place of the motion: its present position, unless a simulation knows more.
  type(standing_type) function standing_at_output(self) result(standing)
    class(simulation_type), intent(inout) :: self   !< the simulation

    standing%t = self%t
  end function standing_at_output

  !> How many plans the motion had before the present one. It has one, unless a simulation says otherwise.
  pure integer function no_other_plans(self) result(plans)
    class(simulation_type), intent(in) :: self   !< the simulation

    plans = 0
  end function no_other_plans

  !> Keep the counts of the present position, which is one of several that wait for their derivatives.
  subroutine keep_counts(self, place)
    class(simulation_type), intent(inout) :: self   !< the simulation
    integer, intent(in) :: place                    !< number of the position among those that wait

    self%kept(place) = position_counts_type(self%positions, self%worst_closure, self%largest_error, self%largest_energy_change)
    call self%keep_work(place)
  end subroutine keep_counts

  !> Return to the counts of one of these positions, because the motion ends there: positions after it do not count.
  subroutine return_to_counts(self, place)
    class(simulation_type), intent(inout) :: self   !< the simulation
    integer, intent(in) :: place                    !< number of the position among those that waited

    associate (kept => self%kept(place))
      self%positions = kept%positions
      self%worst_closure = kept%worst_closure
      self%largest_error = kept%largest_error
      self%largest_energy_change = kept%largest_energy_change
    end associate
    call self%return_to_work(place)
  end subroutine return_to_counts

  !> Keep, or return to, the counts of the work done. There are none unless a simulation says so: its positions do not wait.
  subroutine keep_no_work(self, place)
    class(simulation_type), intent(inout) :: self   !< the simulation
    integer, intent(in) :: place                    !< number of a position among those that wait
  end subroutine keep_no_work

  !> Prepare the derivatives of the motion by all parameters, before the start. Fails where they do not exist. This procedure is for
  !> motions that drives determine.
  subroutine begin_sensitivity(self, variable, highest, sensitivity, err)
    class(simulation_type), intent(inout) :: self                      !< the simulation
    class(variable_model_type), intent(inout), target :: variable      !< the model as a function of its parameters; outlives it
    integer, intent(in) :: highest                                     !< order of the highest derivative in time
    type(sensitivity_type), intent(out) :: sensitivity                 !< prepared
    type(error_type), allocatable, intent(out) :: err                  !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    if (self%model%request%output%with_forces()) call refuse_frictions(self%model, err)
    if (allocated(err)) return
    call self%present(plan, state)
    call new_sensitivity(variable, self%model, plan, highest, sensitivity, err)
  end subroutine begin_sensitivity

  !> Fail where pairs have friction, with which derivatives by parameters are not known.
  subroutine refuse_frictions(model, err)
    type(model_type), intent(in) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated where there is friction

    if (.not. model%mechanism%has_frictions()) return
    call raise(err, exit_data, failure_friction_sensitivity)
    err%failure%number = 1
    call add_place(err, place=model%mechanism%frictions(1)%place)
  end subroutine refuse_frictions

  !> Let the present motion wait for its derivatives by all parameters, which are found for several positions at once.
  subroutine show_sensitivity(self, sensitivity, err)
    class(simulation_type), intent(inout) :: self            !< the simulation
    type(sensitivity_type), intent(inout) :: sensitivity     !< gets the motion
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    call self%present(plan, state)
    call take_position(self%model, state, sensitivity, err)
  end subroutine show_sensitivity

  !> Prepare the derivatives of all frames by all parameters, from which those of energies and forces follow, after
  !> begin_sensitivity. Fails as this does. This procedure is for motions that drives determine.
  subroutine begin_varied_motion(self, variable, err)
    class(simulation_type), intent(inout) :: self                      !< the simulation
    class(variable_model_type), intent(inout), target :: variable      !< the model as a function of its parameters; outlives it
    type(error_type), allocatable, intent(out) :: err                  !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    call self%present(plan, state)
    allocate (self%varied)
    call new_varied_motion(variable, self%model, plan, self%varied, err)
  end subroutine begin_varied_motion

  !> Find the derivatives of all frames in the present motion, after show_sensitivity for it.
  subroutine show_varied_motion(self, motion, err)
    class(simulation_type), intent(inout), target :: self            !< the simulation
    type(varied_motion_type), pointer, intent(out) :: motion         !< the derivatives; they change with the next time
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    call self%present(plan, state)
    call find_varied_motion(self%model, state, self%varied, err)
    motion => self%varied
  end subroutine show_varied_motion

  !> The plan and the state from which forces in the pairs are found. They are those that are presented, unless angles of ball
  !> joints are singular in these.
  subroutine present_as_shown(self, plan, state)
    class(simulation_type), intent(in), target :: self   !< the simulation
    type(plan_type), pointer, intent(out) :: plan        !< the plan
    type(state_type), pointer, intent(out) :: state      !< the present position, velocities and accelerations

    call self%present(plan, state)
  end subroutine present_as_shown

  !> Free the memory beside the simulation's own components. There is none unless a simulation says so.
  subroutine close_nothing(self)
    class(simulation_type), intent(inout) :: self   !< the simulation

    self%started = .false.
  end subroutine close_nothing
end module mech9_simulation
