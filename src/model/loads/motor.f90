!> Motors on coordinates: loads with a state of their own, which is integrated along with the motion.
module mech9_motor
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_motion_view, only: motion_view_type, unlocked
  use mech9_motion_change, only: motion_change_type
  use mech9_force_sum, only: force_sum_type
  use mech9_load, only: load_type
  implicit none
  private
  public :: motor_type, motor_slot_type, motor_motion_type, motor_action_type, motor_change_type, motor_state_type, motion_of_motor

  !> The motion of a motor's coordinate, and the motor's own state.
  type :: motor_motion_type
    real(wp) :: t = 0.0_wp          !< time [s]
    real(wp) :: q = 0.0_wp          !< the coordinate [rad, m]
    real(wp) :: dq = 0.0_wp         !< its rate [rad/s, m/s]
    real(wp) :: ddq = 0.0_wp        !< its acceleration, where `second` and `demand_rate` are asked for [rad/s^2, m/s^2]
    real(wp) :: x = 0.0_wp          !< the variable of its law, where this is not the time [unit of the data file]
    real(wp) :: dx = 0.0_wp         !< its derivative in time
    real(wp) :: ddx = 0.0_wp        !< its second derivative, where the acceleration counts
    real(wp) :: value = 0.0_wp      !< the state: current [A], or integral of the deviation [rad s, m s]
    integer :: limited = unlocked   !< the limit at which the motor works: -1, 0 for none, 1; `unlocked`: it is found
    logical :: steady = .false.     !< the state has come to rest: `value` does not count
  end type motor_motion_type

  !> The action of a motor in such a motion, with its derivatives.
  type :: motor_action_type
    real(wp) :: force = 0.0_wp            !< on the coordinate [N m, N]
    real(wp) :: value = 0.0_wp            !< the state as it is shown: the current without inductance, too
    real(wp) :: rate = 0.0_wp             !< derivative of the state in time
    real(wp) :: second = 0.0_wp           !< second derivative of the state in time
    real(wp) :: demand = 0.0_wp           !< the force without its limit, in parts of the limit; 0 without a limit
    real(wp) :: demand_rate = 0.0_wp      !< its derivative in time [1/s]
    real(wp) :: force_by_q = 0.0_wp       !< derivatives of the force by coordinate, rate, state, and input
    real(wp) :: force_by_dq = 0.0_wp
    real(wp) :: force_by_value = 0.0_wp
    real(wp) :: force_by_input = 0.0_wp
    real(wp) :: rate_by_q = 0.0_wp        !< derivatives of the rate of the state by the same
    real(wp) :: rate_by_dq = 0.0_wp
    real(wp) :: rate_by_value = 0.0_wp
    real(wp) :: rate_by_input = 0.0_wp
    real(wp) :: rate_by_x = 0.0_wp        !< and by the variable of its law and its rate, where this is not the time
    real(wp) :: rate_by_dx = 0.0_wp
  end type motor_action_type

  !> The derivative of the action of a motor by a parameter.
  type :: motor_change_type
    real(wp) :: force = 0.0_wp      !< of the force on the coordinate
    real(wp) :: value = 0.0_wp      !< of the state as it is shown
    real(wp) :: rate = 0.0_wp       !< of the derivative of the state in time
  end type motor_change_type

  !> The meaning of the state of a kind of motors, for the names of results.
  type :: motor_state_type
    character(len=8) :: name = ''         !< in the names of columns
    character(len=30) :: meaning = ''     !< in a few words
    character(len=1) :: unit = ''         !< its unit, or what is multiplied by that of the coordinate
    logical :: by_coordinate = .false.    !< the unit is multiplied by that of the coordinate
  end type motor_state_type

  !> A motor of any kind. Its work counts as put in.
  type, abstract, extends(load_type) :: motor_type
    integer :: coordinate = 0   !< number of the coordinate on which it acts
    integer :: number = 0       !< its number, in the order of the data file
  contains
    procedure(act_interface), deferred :: act
    procedure(vary_act_interface), deferred :: vary_act
    procedure(answer_interface), deferred :: has_state
    procedure(answer_interface), deferred :: has_limit
    procedure(answer_interface), deferred :: has_input
    procedure(kind_of_state_interface), deferred :: kind_of_state
    procedure :: holds_setpoint
    procedure :: state_for
    procedure :: excess_of
    procedure, non_overridable :: find_law
    procedure, non_overridable :: vary_law
    procedure, non_overridable :: change_of_motion
    procedure, non_overridable :: add_shift
    procedure :: mark_links
    procedure :: mark_coordinates
    procedure :: apply
    procedure :: potential
    procedure :: vary
    procedure :: vary_numbers
  end type motor_type

  !> One of several motors of different kinds.
  type :: motor_slot_type
    class(motor_type), allocatable :: motor
  end type motor_slot_type

  abstract interface
    !> The action of the motor. Fails where its law of time has no value.
    subroutine act_interface(self, motion, action, err)
      import :: motor_type, motor_motion_type, motor_action_type, error_type
      class(motor_type), intent(in) :: self                !< the motor
      type(motor_motion_type), intent(in) :: motion        !< of its coordinate, and its state
      type(motor_action_type), intent(out) :: action       !< its force, the rate of its state, and derivatives
      type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    end subroutine act_interface

    !> The derivative of the action by a parameter on which the motion depends, and perhaps the numbers of the motor and of its law, in
    !> the order of `constants`. Fails where its law of time has no value.
    subroutine vary_act_interface(self, motion, moved, numbers, change, err)
      import :: motor_type, motor_motion_type, motor_change_type, error_type, wp
      class(motor_type), intent(in) :: self                !< the motor
      type(motor_motion_type), intent(in) :: motion        !< of its coordinate, and its state
      type(motor_motion_type), intent(in) :: moved         !< derivatives of coordinate, rate and state
      real(wp), intent(in) :: numbers(:)                   !< derivatives of its numbers; of size 0: all are zero
      type(motor_change_type), intent(out) :: change       !< the derivative
      type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    end subroutine vary_act_interface

    !> A property of the motor: its state changes in time; its force has a limit; its voltage is an input of linearised equations.
    pure logical function answer_interface(self)
      import :: motor_type
      class(motor_type), intent(in) :: self   !< the motor
    end function answer_interface

    !> The meaning of the state of this kind of motors.
    pure function kind_of_state_interface(self) result(kind)
      import :: motor_type, motor_state_type
      class(motor_type), intent(in) :: self   !< the motor
      type(motor_state_type) :: kind
    end function kind_of_state_interface
  end interface

contains

  !> The motion of the motor's coordinate, as loads read it. The acceleration is left out.
  pure function motion_of_motor(self, view) result(motion)
    class(motor_type), intent(in) :: self         !< the motor
    type(motion_view_type), intent(in) :: view    !< present motion of links and coordinates
    type(motor_motion_type) :: motion

    motion%t = view%t
    motion%q = view%q(self%coordinate)
    motion%dq = view%dq(self%coordinate)
    if (allocated(self%over)) call self%over%find_motion(view, motion%x, motion%dx)
    motion%steady = .not. allocated(view%motor)
    if (motion%steady) return
    motion%value = view%motor(self%number)
    motion%limited = view%limited(self%number)
  end function motion_of_motor

  !> Whether the motor is at rest at the value of its law only, with the force that holds its coordinate there. This procedure is for
  !> kinds that are not.
  pure logical function holds_setpoint(self)
    class(motor_type), intent(in) :: self   !< the motor

    holds_setpoint = .false.
  end function holds_setpoint

  !> The state in which the motor exerts a force at its setpoint. This procedure is for kinds without setpoint.
  pure real(wp) function state_for(self, force) result(value)
    class(motor_type), intent(in) :: self   !< the motor
    real(wp), intent(in) :: force           !< on the coordinate [N m, N]

    value = 0.0_wp
  end function state_for

  !> How far a force is beyond what the motor can exert [N m, N]. This procedure is for kinds without limit.
  pure real(wp) function excess_of(self, force) result(excess)
    class(motor_type), intent(in) :: self   !< the motor
    real(wp), intent(in) :: force           !< on the coordinate, beyond the limit [N m, N]

    excess = 0.0_wp
  end function excess_of

  !> Mark the link of the point on which its law depends. The motor itself acts on a coordinate.
  pure subroutine mark_links(self, needed)
    class(motor_type), intent(in) :: self   !< the motor
    logical, intent(inout) :: needed(:)     !< (N) becomes true for this link; others stay

    if (allocated(self%over)) call self%over%mark_links(needed)
  end subroutine mark_links

  !> The law of the motor, with its derivatives in time: 1 where it has none. Fails where the law has no value.
  subroutine find_law(self, motion, value, rate, second, slope, bending, err)
    class(motor_type), intent(in) :: self                !< the motor
    type(motor_motion_type), intent(in) :: motion        !< with time and variable
    real(wp), intent(out) :: value                       !< the law
    real(wp), intent(out) :: rate                        !< its derivative in time
    real(wp), intent(out) :: second                      !< its second derivative in time
    real(wp), intent(out) :: slope                       !< its derivative by its variable; 0 for a law of time
    real(wp), intent(out) :: bending                     !< its second derivative by its variable; 0 for a law of time
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    value = 1.0_wp
    rate = 0.0_wp
    second = 0.0_wp
    slope = 0.0_wp
    bending = 0.0_wp
    if (allocated(self%law)) then
      call self%law%evaluate(motion%t, value, rate, second, err)
    else if (allocated(self%over)) then
      call self%over%law%evaluate(motion%x, value, slope, bending, err)
      rate = slope*motion%dx
      second = bending*motion%dx**2 + slope*motion%ddx
    end if
  end subroutine find_law

  !> The derivatives of the law and of its rate by a parameter on which its variable depends, and perhaps its numbers. Fails where
  !> the law has no value.
  subroutine vary_law(self, motion, moved, numbers, value, rate, err)
    class(motor_type), intent(in) :: self                !< the motor
    type(motor_motion_type), intent(in) :: motion        !< with time and variable
    type(motor_motion_type), intent(in) :: moved         !< derivatives of the variable and of its rate
    real(wp), intent(in) :: numbers(:)                   !< (numbers) derivatives by one parameter of the numbers of the law, those of its point first;
                                                         !< these count in `moved`; of size 0: all are zero
    real(wp), intent(out) :: value                       !< derivative of the law
    real(wp), intent(out) :: rate                        !< derivative of its rate in time
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    real(wp) :: law, unused, slope, bending, by_numbers, slope_by_numbers

    value = 0.0_wp
    rate = 0.0_wp
    if (allocated(self%law)) then
      if (size(numbers) > 0) call self%law%vary(numbers, motion%t, value, rate, unused)
    else if (allocated(self%over)) then
      call self%find_law(motion, law, rate, unused, slope, bending, err)
      if (allocated(err)) return
      value = slope*moved%x
      rate = bending*motion%dx*moved%x + slope*moved%dx
      if (size(numbers) == 0) return
      call self%over%law%vary(numbers(self%over%own_numbers() + 1:), motion%x, by_numbers, slope_by_numbers, unused)
      value = value + by_numbers
      rate = rate + slope_by_numbers*motion%dx
    end if
  end subroutine vary_law

  !> The derivative of the motion of the motor's coordinate, of its state and of the variable of its law, from those of all
  !> coordinates and of the links on whose motion the law depends.
  pure function change_of_motion(self, state, change) result(moved)
    class(motor_type), intent(in) :: self            !< the motor
    type(motion_view_type), intent(in) :: state      !< present motion of links and coordinates
    type(motion_change_type), intent(in) :: change   !< derivative of the motion by a parameter
    type(motor_motion_type) :: moved

    moved%q = change%q(self%coordinate)
    moved%dq = change%dq(self%coordinate)
    if (allocated(change%motor)) moved%value = change%motor(self%number)
    if (allocated(self%over)) call self%over%change_of_motion(state, change, moved%x, moved%dx)
  end function change_of_motion

  !> Add the derivative of the variable of the motor's law by a parameter on which the place of its point depends.
  pure subroutine add_shift(self, state, numbers, moved)
    class(motor_type), intent(in) :: self              !< the motor
    type(motion_view_type), intent(in) :: state        !< present motion of links and coordinates
    real(wp), intent(in) :: numbers(:)                 !< (numbers) derivatives of its numbers by one parameter, as of `constants`
    type(motor_motion_type), intent(inout) :: moved    !< gets it
    real(wp), allocatable :: own(:)
    real(wp) :: x, dx

    if (.not. allocated(self%over)) return
    call self%numbers(own)
    call self%over%change_by_shift(state, numbers(size(own) + 1:), x, dx)
    moved%x = moved%x + x
    moved%dx = moved%dx + dx
  end subroutine add_shift

  !> Mark its coordinate, and that on which its law depends, where this is one.
  pure subroutine mark_coordinates(self, needed)
    class(motor_type), intent(in) :: self   !< the motor
    logical, intent(inout) :: needed(:)     !< (M) becomes true for both coordinates; others stay

    needed(self%coordinate) = .true.
    if (allocated(self%over)) call self%over%mark_coordinates(needed)
  end subroutine mark_coordinates

  !> Add the generalized force on the coordinate.
  subroutine apply(self, state, sum, err)
    class(motor_type), intent(in) :: self               !< the motor
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates, with the motors' states
    type(force_sum_type), intent(inout) :: sum          !< forces so far; that of the motor is added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(motor_action_type) :: action

    call self%act(motion_of_motor(self, state), action, err)
    if (.not. allocated(err)) call sum%add_generalized(self%coordinate, action%force)
  end subroutine apply

  !> Add the derivative of the generalized force by a parameter on which the motion depends. The motor's state is held unless it is
  !> steady, or its change is given.
  subroutine vary(self, state, change, changes, err)
    class(motor_type), intent(in) :: self               !< the motor
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates, with the motors' states
    type(motion_change_type), intent(in) :: change      !< derivative of the motion by the parameter
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the motor are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(motor_motion_type) :: moved
    type(motor_change_type) :: motor_change

    moved = self%change_of_motion(state, change)
    call self%vary_act(motion_of_motor(self, state), moved, [real(wp) ::], motor_change, err)
    if (.not. allocated(err)) call changes%add_generalized(self%coordinate, motor_change%force)
  end subroutine vary

  !> Add the derivative of the generalized force by a parameter on which the numbers of the motor or those of its law depend, for
  !> the present motion.
  subroutine vary_numbers(self, change, state, changes, err)
    class(motor_type), intent(in) :: self               !< the motor
    real(wp), intent(in) :: change(:)                   !< derivatives of its numbers, then of those of its law
    type(motion_view_type), intent(in) :: state         !< present motion of links and coordinates, with the motors' states
    type(force_sum_type), intent(inout) :: changes      !< derivatives of forces so far; those of the motor are added
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(motor_motion_type) :: moved
    type(motor_change_type) :: motor_change

    call self%add_shift(state, change, moved)
    call self%vary_act(motion_of_motor(self, state), moved, change, motor_change, err)
    if (.not. allocated(err)) call changes%add_generalized(self%coordinate, motor_change%force)
  end subroutine vary_numbers

  !> Motors store no energy of the mechanism.
  pure real(wp) function potential(self, state)
    class(motor_type), intent(in) :: self         !< the motor
    type(motion_view_type), intent(in) :: state   !< present motion of links and coordinates

    potential = 0.0_wp
  end function potential
end module mech9_motor
