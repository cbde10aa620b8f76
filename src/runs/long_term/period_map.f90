!> The map of a free motion over a time: the state at the end as a function of the state at the start and of the time, with its exact
!> derivatives.
!>
!> The state has the free coordinates of the data file, their rates, and the states of motors. Its derivatives by that at the start, the
!> monodromy matrix of a periodic motion, come from the variational equations, which are integrated with the motion; events on the way
!> change them as the simulation does. Changes of independent coordinates do not matter: both ends are shown in the free coordinates.
!> Parameters of the model may follow, by which the state at the end has derivatives, too.
!>
!> Cyclic coordinates may be left out of the comparison of both ends: they keep their start, and go on by any amount.
module mech9_period_map
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_parameter, only: parameter_type
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_state, only: state_type, copy_state
  use mech9_frame_motion, only: place_all
  use mech9_branch_stepping, only: set_inputs
  use mech9_motor_states, only: start_motors
  use mech9_motion_view, only: unlocked
  use mech9_nearby_position, only: find_nearby_position
  use mech9_sensitivity, only: sensitivity_type
  use mech9_simulation, only: interruption_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_other_angles, only: take_shown, take_shown_changes, set_shown_directions
  use mech9_model_motion, only: model_motion_type
  use mech9_cyclic_coordinates, only: find_cyclic
  use mech9_directed_motion, only: set_directions, set_unit_directions
  use mech9_orbit_divergence, only: orbit_divergence_type
  implicit none
  private
  public :: period_map_type

  !> Turns beyond this number do not count as such.
  real(wp), parameter :: most_turns = 1.0e9_wp

  !> A model with directions, which set nothing, before its own parameters.
  type, extends(variable_model_type) :: directed_model_type
    type(model_type), pointer :: model => null()                  !< with directions alone; not owned
    class(variable_model_type), pointer :: variable => null()     !< by its own parameters; null: there are none; not owned
    integer :: directions = 0                                     !< how many directions there are
  contains
    procedure :: at
    procedure :: along
  end type directed_model_type

  !> It must not be copied.
  type :: period_map_type
    type(model_type), pointer :: model => null()                          !< owned: the model with directions
    type(model_motion_type), pointer, private :: motion => null()         !< owned: of the last evaluation
    type(directed_model_type), pointer, private :: variable => null()     !< owned
    class(interruption_type), allocatable, private :: interruption
    real(wp) :: from = 0.0_wp                     !< time of the start [s]
    integer, allocatable :: free(:)               !< free coordinates at the start
    integer, allocatable :: motors(:)             !< numbers of the motors with a state
    logical :: has_chains = .false.               !< chains are closed, which limit coordinates
    integer :: states = 0                         !< length of a state
    integer :: parameters = 0                     !< how many parameters have derivatives
    real(wp), allocatable :: unit_of(:)           !< (states) unit of each coordinate and rate; 1 of motors [rad, m, per s]
    real(wp), allocatable :: unit_of_coordinate(:)   !< (M) unit of each coordinate [rad, m]
    real(wp), allocatable :: period_of(:)         !< (M) change of a coordinate that leads to the same position; 0: none [rad, m]
    logical, allocatable :: may_go_on(:)          !< (free) the coordinate is cyclic
    logical, allocatable :: goes_on(:)            !< (free) it is, and both ends are not compared in it; set by the user of the map
    type(state_type) :: start                     !< the closed position at the start of the last evaluation
    real(wp), allocatable :: at_start(:)          !< (states) the state there
    real(wp), allocatable :: rate_at_start(:)     !< (states) its derivative in time
    real(wp), allocatable :: at_end(:)            !< (states) the state at the end
    real(wp), allocatable :: rate_at_end(:)       !< (states) its derivative in time: that of the end by the period
    real(wp), allocatable :: monodromy(:, :)      !< (states,states) derivatives of the end by the start
    real(wp), allocatable :: by_parameters(:, :)  !< (states,parameters) derivatives of the end by parameters, with the start held
    real(wp), allocatable :: dq_at_start(:)       !< (M) rates of all coordinates at the start [rad/s, m/s]
    real(wp), allocatable :: q_at_end(:)          !< (M) all coordinates at the end [rad, m]
    real(wp), allocatable :: dq_at_end(:)         !< (M) their rates [rad/s, m/s]
    integer, allocatable :: turns(:)              !< (M) whole periods by which coordinates differ at both ends
    real(wp), allocatable :: largest_move(:)      !< (M) largest distance from the start on the way, where it was followed [rad, m]
    real(wp), allocatable :: means(:, :)          !< (3,M) means along it, where it was followed; see mech9_orbit_divergence
    real(wp) :: log_volume = 0.0_wp               !< integral of the divergence, where it was followed; see mech9_orbit_divergence
    logical :: volume_is_known = .false.          !< it was followed up to the end
    integer :: events = 0                         !< impacts and other events on the way
    integer :: coordinate_changes = 0             !< of the independent coordinates
  contains
    procedure :: begin
    procedure :: state_at_start
    procedure :: evaluate
    procedure :: sample
    procedure :: go_on
    procedure :: residual
    procedure :: residual_of_coordinates
    procedure :: difference
    procedure :: jacobian
    procedure :: advance
    procedure :: state_of
    procedure :: motor_states
    procedure :: close => close_map
  end type period_map_type

contains

  !> Begin: assemble the model at its start. Fails as a motion does.
  subroutine begin(self, given, err, interruption, variable)
    class(period_map_type), intent(inout) :: self                    !< the map
    type(model_type), intent(in) :: given                            !< the model
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether motions shall stop
    class(variable_model_type), intent(inout), optional, target :: variable   !< the model by its parameters, where their derivatives
                                                                     !< are wanted; outlives the map
    logical, allocatable :: is_cyclic(:)
    integer :: i

    call self%close()
    allocate (self%model, source=given)
    allocate (self%motion, self%variable)
    if (present(interruption)) allocate (self%interruption, source=interruption)
    self%from = given%request%time%start
    self%motors = pack([(i, i=1, size(given%mechanism%motors))], &
                       [(given%mechanism%motors(i)%motor%has_state(), i=1, size(given%mechanism%motors))])
    call self%motion%assemble(self%model, err)
    if (allocated(err)) return
    associate (plan => self%motion%plan)
      self%free = plan%free
      call find_cyclic(given, is_cyclic)
      self%may_go_on = is_cyclic(plan%free)
      self%goes_on = self%may_go_on .and. .false.
      self%has_chains = size(plan%closures) > 0
      self%states = 2*size(plan%free) + size(self%motors)
      allocate (self%unit_of(self%states), source=1.0_wp)
      self%unit_of(:2*size(plan%free)) = [plan%unit_of(plan%free), plan%unit_of(plan%free)]
      self%unit_of_coordinate = plan%unit_of
      self%period_of = [(plan%steps(plan%step_of(i))%period, i=1, plan%n_coordinates)]
    end associate
    call copy_state(self%motion%start, self%start)
    call start_motors(given%mechanism, self%start)
    self%variable%directions = self%states
    self%variable%model => self%model
    call set_directions(self%states, self%model)
    if (present(variable)) then
      self%variable%variable => variable
      self%parameters = size(given%parameters)
      call append_parameters(given, self%model)
    end if
  end subroutine begin

  !> Append the parameters of a model. By hand: an array constructor would leak (gfortran 12).
  subroutine append_parameters(given, model)
    type(model_type), intent(in) :: given       !< with the parameters
    type(model_type), intent(inout) :: model    !< gets them behind its own
    type(parameter_type), allocatable :: all(:)
    integer :: i, n

    n = size(model%parameters)
    allocate (all(n + size(given%parameters)))
    do i = 1, size(all)
      if (i <= n) all(i) = model%parameters(i)
      if (i > n) all(i) = given%parameters(i - n)
    end do
    call move_alloc(all, model%parameters)
  end subroutine append_parameters

  !> The state at the start of the data file, or of the last evaluation.
  function state_at_start(self) result(x)
    class(period_map_type), intent(in) :: self   !< the map
    real(wp), allocatable :: x(:)                !< (states)

    x = self%state_of(self%start%q, self%start%dq, self%motor_states(self%start))
  end function state_at_start

  !> The state of a motion in the free coordinates of the start.
  pure function state_of(self, q, dq, motor) result(x)
    class(period_map_type), intent(in) :: self   !< the map
    real(wp), intent(in) :: q(:)                 !< (M) coordinates [rad, m]
    real(wp), intent(in) :: dq(:)                !< (M) rates [rad/s, m/s]
    real(wp), intent(in) :: motor(:)             !< (motors) their states
    real(wp) :: x(self%states)

    x = [q(self%free), dq(self%free), motor(self%motors)]
  end function state_of

  !> Follow the motion from a state over a time, with its derivatives. Fails where the chains do not close there on the same branch, and
  !> as a motion does.
  subroutine evaluate(self, x, period, err, from, with_volume)
    class(period_map_type), intent(inout) :: self       !< the map
    real(wp), intent(in) :: x(:)                        !< (states) the state at the start
    real(wp), intent(in) :: period                      !< the time, above 0 [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp), intent(in), optional :: from              !< time of the start; that of the data file unless given [s]
    logical, intent(in), optional :: with_volume        !< the divergence and the way are followed, too; not unless given
    type(free_simulation_type), pointer :: simulation
    type(sensitivity_type) :: unused
    logical :: follows

    follows = .false.
    if (present(with_volume)) follows = with_volume
    self%from = self%model%request%time%start
    associate (time => self%model%request%time)
      if (present(from)) time%start = from
      time%end = time%start + period
      call place_start(self, x, time%start, err)
      if (.not. allocated(err)) call copy_state(self%start, self%motion%start)
      if (.not. allocated(err)) call self%motion%prepare(self%model, err)
      if (.not. allocated(err)) then
        simulation => self%motion%free()
        call simulation%begin_sensitivity(self%variable, 2, unused, err)
      end if
      if (.not. allocated(err)) call set_unit_directions(simulation, self%unit_of(:size(self%free)), self%motors)
      if (.not. allocated(err)) call set_shown_directions(simulation%motion%system, simulation%motion%angles, err)
      if (.not. allocated(err)) call begin_motion(self, simulation, err)
      if (.not. allocated(err)) call simulation%motion%show_angles(err)
      if (.not. allocated(err)) call take_start(self, simulation)
      if (.not. allocated(err)) call follow(self, simulation, follows, err)
      if (.not. allocated(err)) call simulation%motion%system%show_sensitivity(err)
      if (.not. allocated(err)) call take_end(self, simulation, err)
      time%start = self%from
    end associate
  end subroutine evaluate

  !> Follow the motion from a state without derivatives, and take the states at some times.
  subroutine sample(self, x, times, states, rate, err)
    class(period_map_type), intent(inout) :: self       !< the map
    real(wp), intent(in) :: x(:)                        !< (states) the state at the start
    real(wp), intent(in) :: times(:)                    !< (n) from the start on, increasing [s]
    real(wp), intent(out) :: states(:, :)               !< (states,n) the states, as far as the motion went
    real(wp), intent(out) :: rate(:)                    !< (states) the derivative in time at the start
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(free_simulation_type), pointer :: simulation
    real(wp) :: rate_here(self%states)
    integer :: i

    states = 0.0_wp
    rate = 0.0_wp
    associate (time => self%model%request%time)
      time%end = time%start + times(size(times))
      call place_start(self, x, time%start, err)
      if (.not. allocated(err)) call copy_state(self%start, self%motion%start)
      if (.not. allocated(err)) call self%motion%prepare(self%model, err)
      if (allocated(err)) return
      simulation => self%motion%free()
      call begin_motion(self, simulation, err)
      if (.not. allocated(err)) call simulation%motion%show_angles(err)
      if (.not. allocated(err)) call take_motion(self, simulation, states(:, 1), rate)
      do i = 1, size(times)
        if (.not. allocated(err)) call simulation%advance(time%start + times(i), err)
        if (allocated(err)) return
        call take_motion(self, simulation, states(:, i), rate_here)
      end do
    end associate
  end subroutine sample

  !> Let the start be the end of the last evaluation, but for whole turns, in the assembly that the mechanism has there.
  subroutine go_on(self, err)
    class(period_map_type), intent(inout) :: self       !< the map, evaluated
    type(error_type), allocatable, intent(out) :: err   !< allocated if the position does not exist

    self%start%q = self%q_at_end - self%turns*self%period_of
    call place_start(self, self%at_start + self%residual(), self%from, err)
  end subroutine go_on

  !> Start the motion, which the user may stop.
  subroutine begin_motion(self, simulation, err)
    class(period_map_type), intent(inout) :: self               !< the map
    type(free_simulation_type), intent(inout) :: simulation     !< the motion, prepared
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed

    if (allocated(self%interruption)) then
      call simulation%start(err, self%interruption)
    else
      call simulation%start(err)
    end if
  end subroutine begin_motion

  !> Move the closed position to other values of the free coordinates, on its branch, with the given rates.
  subroutine place_start(self, x, t, err)
    class(period_map_type), intent(inout) :: self       !< the map; its start changes where nothing fails
    real(wp), intent(in) :: x(:)                        !< (states) the state
    real(wp), intent(in) :: t                           !< time [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if the chains do not close there
    type(state_type) :: moved
    real(wp) :: q(size(self%start%q))
    integer :: n

    n = size(self%free)
    associate (plan => self%motion%plan)
      call find_nearby_position(self%model%problem%drives, plan, self%start, self%free, x(:n), t, &
                                'the chains do not close at a start that the search for a periodic motion tries', q, err)
      if (allocated(err)) return
      call copy_state(self%start, moved)
      moved%q = q
      moved%t = t
      moved%dq(self%free) = x(n + 1:2*n)
      if (size(self%motors) > 0) moved%motor(self%motors) = x(2*n + 1:)
      call set_inputs(self%model%problem%drives, t, moved%q, moved%dq, moved%ddq, err)
      if (.not. allocated(err)) call place_all(plan, moved, err)
      if (allocated(moved%limited)) moved%limited = unlocked
      if (.not. allocated(err)) call copy_state(moved, self%start)
    end associate
  end subroutine place_start

  !> Take the state at the start and its derivative in time.
  subroutine take_start(self, simulation)
    class(period_map_type), intent(inout) :: self               !< the map
    type(free_simulation_type), intent(in) :: simulation        !< the motion at its start
    real(wp), dimension(self%states) :: x, rate
    real(wp), dimension(size(self%start%q)) :: q, dq, ddq

    call take_motion(self, simulation, x, rate)
    self%at_start = x
    self%rate_at_start = rate
    call take_shown(simulation%motion%system, simulation%motion%angles, q, dq, ddq)
    self%dq_at_start = dq
  end subroutine take_start

  !> Take the state of the present motion and its derivative in time, in the angles of the data file.
  subroutine take_motion(self, simulation, x, rate)
    class(period_map_type), intent(in) :: self               !< the map
    type(free_simulation_type), intent(in) :: simulation     !< the motion
    real(wp), intent(out) :: x(:)                            !< (states) the state
    real(wp), intent(out) :: rate(:)                         !< (states) its derivative in time
    real(wp), dimension(size(self%start%q)) :: q, dq, ddq

    associate (system => simulation%motion%system)
      call take_shown(system, simulation%motion%angles, q, dq, ddq)
      x = self%state_of(q, dq, self%motor_states(system%state))
      if (size(self%motors) > 0) then
        rate = self%state_of(dq, ddq, system%state%motor_rate)
      else
        rate = [dq(self%free), ddq(self%free)]
      end if
    end associate
  end subroutine take_motion

  !> States of motors; empty where there are none.
  pure function motor_states(self, state) result(motor)
    class(period_map_type), intent(in) :: self   !< the map
    type(state_type), intent(in) :: state        !< of the motion
    real(wp) :: motor(size(self%model%mechanism%motors))

    motor = 0.0_wp
    if (allocated(state%motor)) motor = state%motor
  end function motor_states

  !> Go on to the end.
  subroutine follow(self, simulation, follows, err)
    class(period_map_type), intent(inout) :: self               !< the map
    type(free_simulation_type), intent(inout) :: simulation     !< the motion at its start
    logical, intent(in) :: follows                              !< the divergence and the way are followed, too
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(orbit_divergence_type) :: divergence

    self%volume_is_known = .false.
    if (follows) then
      call divergence%follow(simulation, self%motors, err)
      if (allocated(err)) return
      self%volume_is_known = divergence%is_known
      self%log_volume = divergence%log_volume
      self%largest_move = divergence%largest_move
      self%means = divergence%means
    else
      call simulation%advance(simulation%end, err)
    end if
  end subroutine follow

  !> Take the state at the end with its derivatives. Fails in gimbal lock, where these do not exist.
  subroutine take_end(self, simulation, err)
    class(period_map_type), intent(inout) :: self               !< the map
    type(free_simulation_type), intent(in) :: simulation        !< the motion at its end
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    real(wp) :: rows(self%states, self%states + self%parameters), x(self%states), rate(self%states)
    real(wp), dimension(size(self%start%q)) :: q, dq, ddq
    real(wp) :: changes(self%states + self%parameters, 0:2, size(self%start%q))
    integer :: i, j, n

    n = size(self%free)
    associate (system => simulation%motion%system, angles => simulation%motion%angles)
      call take_shown_changes(system, angles, changes, err)
      if (allocated(err)) return
      do j = 1, size(rows, 2)
        rows(:n, j) = changes(j, 0, self%free)
        rows(n + 1:2*n, j) = changes(j, 1, self%free)
        do i = 1, size(self%motors)
          rows(2*n + i, j) = system%sensitivity%motors(j, self%motors(i), 0)
        end do
        if (j <= self%states) rows(:, j) = rows(:, j)/self%unit_of(j)
      end do
      self%monodromy = rows(:, :self%states)
      self%by_parameters = rows(:, self%states + 1:)
      do i = 1, n
        if (self%goes_on(i)) self%by_parameters(i, :) = 0.0_wp
      end do
      call take_shown(system, angles, q, dq, ddq)
      call take_motion(self, simulation, x, rate)
    end associate
    self%q_at_end = q
    self%dq_at_end = dq
    self%at_end = x
    self%rate_at_end = rate
    if (allocated(self%turns)) deallocate (self%turns)
    allocate (self%turns(size(self%q_at_end)), source=0)
    where (self%period_of > 0.0_wp) &
      self%turns = nint(max(-most_turns, min(most_turns, (self%q_at_end - self%start%q)/self%period_of)))
    self%events = simulation%events%count
    self%coordinate_changes = size(simulation%coordinate_changes)
  end subroutine take_end

  !> The difference of the state at the end from that at the start, but for whole turns.
  pure function residual(self) result(r)
    class(period_map_type), intent(in) :: self   !< the map, evaluated
    real(wp) :: r(self%states)
    integer :: n

    n = size(self%free)
    r = self%at_end - self%at_start
    r(:n) = r(:n) - self%turns(self%free)*self%period_of(self%free)
    where (self%goes_on) r(:n) = 0.0_wp
  end function residual

  !> The difference of a state from another one, but for whole turns.
  pure function difference(self, a, b) result(r)
    class(period_map_type), intent(in) :: self   !< the map
    real(wp), intent(in) :: a(:)                 !< (states) the state
    real(wp), intent(in) :: b(:)                 !< (states) the other one
    real(wp) :: r(self%states), period
    integer :: i

    r = a - b
    do i = 1, size(self%free)
      period = self%period_of(self%free(i))
      if (period > 0.0_wp) r(i) = r(i) - period*anint(r(i)/period)
      if (self%goes_on(i)) r(i) = 0.0_wp
    end do
  end function difference

  !> The differences of all coordinates at both ends, but for whole turns.
  pure function residual_of_coordinates(self) result(r)
    class(period_map_type), intent(in) :: self   !< the map, evaluated
    real(wp) :: r(size(self%start%q))            !< (M) of coordinates [rad, m]

    r = self%q_at_end - self%start%q - self%turns*self%period_of
    r(pack(self%free, self%goes_on)) = 0.0_wp
  end function residual_of_coordinates

  !> The ways by which cyclic coordinates go on that are not compared; zero for all others.
  pure function advance(self) result(ways)
    class(period_map_type), intent(in) :: self   !< the map, evaluated
    real(wp) :: ways(size(self%start%q))         !< (M) [rad, m]
    integer :: i

    ways = 0.0_wp
    do i = 1, size(self%free)
      if (self%goes_on(i)) ways(self%free(i)) = self%q_at_end(self%free(i)) - self%start%q(self%free(i))
    end do
  end function advance

  !> The derivatives of the residual by the state at the start and by the period.
  pure subroutine jacobian(self, by_state, by_period)
    class(period_map_type), intent(in) :: self            !< the map, evaluated
    real(wp), allocatable, intent(out) :: by_state(:, :)  !< (states,states) by the state at the start
    real(wp), allocatable, intent(out) :: by_period(:)    !< (states) by the period, with the laws of time as they are [per s]
    integer :: i

    by_state = self%monodromy
    do i = 1, self%states
      by_state(i, i) = by_state(i, i) - 1.0_wp
    end do
    by_period = self%rate_at_end
    ! a coordinate that goes on keeps its start
    do i = 1, size(self%free)
      if (.not. self%goes_on(i)) cycle
      by_state(i, :) = 0.0_wp
      by_state(i, i) = 1.0_wp
      by_period(i) = 0.0_wp
    end do
  end subroutine jacobian

  !> Free the memory of the map.
  subroutine close_map(self)
    class(period_map_type), intent(inout) :: self   !< the map

    if (associated(self%motion)) then
      call self%motion%close()
      deallocate (self%motion)
    end if
    if (associated(self%variable)) deallocate (self%variable)
    if (associated(self%model)) deallocate (self%model)
    if (allocated(self%interruption)) deallocate (self%interruption)
    if (allocated(self%unit_of)) deallocate (self%unit_of)
    self%parameters = 0
  end subroutine close_map

  !> The model with other values of its own parameters, which stand behind the directions.
  subroutine at(self, values, model, err)
    class(directed_model_type), intent(inout) :: self   !< the model as a function
    real(wp), intent(in) :: values(:)                   !< of directions, then of all parameters
    type(model_type), intent(out) :: model              !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (associated(self%variable)) then
      call self%variable%at(values(self%directions + 1:), model, err)
    else
      model = self%model
    end if
  end subroutine at

  !> The model where one direction or parameter is larger.
  subroutine along(self, values, number, distance, model, err)
    class(directed_model_type), intent(inout) :: self   !< the model as a function
    real(wp), intent(in) :: values(:)                   !< of directions, then of all parameters
    integer, intent(in) :: number                       !< of the direction or parameter
    real(wp), intent(in) :: distance                    !< by which its value is larger
    type(model_type), intent(out) :: model              !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (number > self%directions) then
      call self%variable%along(values(self%directions + 1:), number - self%directions, distance, model, err)
    else
      call self%at(values, model, err)
    end if
  end subroutine along
end module mech9_period_map
