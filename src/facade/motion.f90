!> A motion as the library's users run it: started, advanced from time to time, and asked for its coordinates, points and energies.
module mech9_motion
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_error, only: error_type, raise, exit_usage, exit_singular, exit_interrupted
  use mech9_partition, only: free_coordinate
  use mech9_model, only: model_type
  use mech9_point, only: point_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: point_motion
  use mech9_simulation, only: simulation_type, simulation_statistics_type, interruption_type, &
    coordinate_change_type, judge_error
  use mech9_motion_event, only: motion_event_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_motion_coefficients, only: find_coefficients
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan, is_made_for
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  use mech9_explanation, only: explain
  use mech9_model_motion, only: model_motion_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  use mech9_changed_loads, only: changed_loads_type
  implicit none
  private
  public :: motion_type

  !> It must not be copied.
  type :: motion_type
    private
    type(checked_mechanism_type) :: mechanism               !< as it was at the start
    type(changed_loads_type) :: loads                       !< with the numbers that were set since then
    integer :: program = kinematics                         !< or dynamics
    type(model_type), pointer :: model => null()            !< owned; the simulation refers to it
    class(simulation_type), allocatable :: simulation
    integer, allocatable :: independent(:)                  !< the independent coordinates of the mechanism
    logical :: has_failed = .false.                         !< the motion cannot go on
    integer :: n_free = 0                                   !< how many of them have no drive
    type(reaction_plan_type) :: reaction_plan               !< of forces, once they are asked for
    class(reactions_type), allocatable :: reactions         !< of the last position whose forces were asked for
    integer :: planned = -1                                 !< plans of the motion before the one for which it was made; -1: none was
  contains
    procedure :: start_kinematics
    procedure :: start_dynamics
    procedure :: advance
    procedure :: t
    procedure :: coordinates
    procedure :: q
    procedure :: dq
    procedure :: ddq
    procedure :: take_coordinates
    procedure :: set
    procedure :: take_equations
    procedure :: take_state
    procedure :: go_to_state
    procedure :: free_coordinates
    procedure :: unit
    procedure :: point
    procedure :: coupling_force
    procedure :: energies
    procedure :: closure
    procedure :: coordinate_changes
    procedure :: events
    procedure :: statistics
    procedure :: close => close_motion
  end type motion_type

  !> Largest number of a state; data files have none that are larger [SI units].
  real(wp), parameter :: largest_number = 1.0e100_wp

contains

  !> Start a driven motion: plan, assemble, and work out the position at the start. Fails with exit_data for a missing drive,
  !> with exit_structure or exit_assembly where the mechanism cannot be put together, with exit_singular at a singular position.
  subroutine start_kinematics(self, mechanism, err, interruption)
    class(motion_type), intent(inout) :: self                        !< the motion; one that it held is closed
    type(checked_mechanism_type), intent(in) :: mechanism            !< with a drive for each independent coordinate
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop

    call start_motion(self, mechanism, kinematics, err, interruption)
  end subroutine start_kinematics

  !> Start a motion under forces from the initial positions and rates of the free coordinates. Those with drives move as these
  !> say; where all are driven nothing is integrated. Fails as start_kinematics does, with exit_data also where a free coordinate
  !> has no initial position.
  subroutine start_dynamics(self, mechanism, err, interruption)
    class(motion_type), intent(inout) :: self                        !< the motion; one that it held is closed
    type(checked_mechanism_type), intent(in) :: mechanism            !< with bodies, loads and gravity
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop

    call start_motion(self, mechanism, dynamics, err, interruption)
  end subroutine start_dynamics

  !> Start a motion of a program.
  subroutine start_motion(self, mechanism, program, err, interruption)
    class(motion_type), intent(inout) :: self                        !< the motion; one that it held is closed
    type(checked_mechanism_type), intent(in) :: mechanism            !< the mechanism
    integer, intent(in) :: program                                   !< kinematics or dynamics
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop
    type(model_type), pointer :: model

    call self%close()
    allocate (model)
    self%model => model
    self%mechanism = mechanism
    call self%loads%begin(mechanism)
    self%program = program
    call mechanism%take(program, self%model, err)
    if (.not. allocated(err)) call start_model(self, err, interruption)
    call mechanism%point_at(err)
    if (allocated(err)) call self%close()
  end subroutine start_motion

  !> Assemble the model and start its motion.
  subroutine start_model(self, err, interruption, motors)
    class(motion_type), intent(inout) :: self                        !< the motion, with its model
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop
    real(wp), intent(in), optional :: motors(:)                      !< (2 motors) their states, and their limits
    type(model_motion_type) :: motion
    integer :: n

    call motion%assemble(self%model, err)
    if (present(motors) .and. .not. allocated(err)) then
      n = size(motors)/2
      if (n > 0) then
        motion%start%motor = motors(:n)
        motion%start%motor_rate = 0.0_wp*motors(:n)
        motion%start%limited = nint(max(-1.0_wp, min(1.0_wp, motors(n + 1:))))
      end if
    end if
    if (.not. allocated(err)) call motion%prepare(self%model, err, pictures=.true.)
    if (.not. allocated(err)) call take_accuracy(motion, self%model, err, interruption)
    if (.not. allocated(err)) call motion%simulation%start(err, interruption)
    if (allocated(err)) then
      call motion%close()
    else
      self%independent = motion%plan%independent
      self%has_failed = .false.
      self%n_free = 0
      if (.not. self%model%is_driven()) self%n_free = size(motion%plan%free)
      call move_alloc(motion%simulation, self%simulation)
    end if
  end subroutine start_model

  !> Find the tolerances for an accuracy, if one is asked for. It holds at the outputs of &time, and times between them have
  !> errors like theirs. Fails where it cannot be had.
  subroutine take_accuracy(motion, model, err, interruption)
    type(model_motion_type), intent(inout) :: motion                 !< prepared; its positions are not judged any more
    type(model_type), intent(inout) :: model                         !< its model; gets the tolerances; the accuracy is met then
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the runs shall stop
    class(interruption_type), allocatable :: asked
    integer :: i

    if (.not. motion%simulation%with_error) return
    if (present(interruption)) allocate (asked, source=interruption)
    call motion%find_tolerances(model, err, .true., asked)
    if (allocated(err)) return
    associate (errors => motion%simulation%errors)
      do i = 1, size(errors%at)
        call judge_error(model%request%time%time(i - 1), errors%at(i), errors, err)
        if (allocated(err)) return
      end do
    end associate
    motion%simulation%with_error = .false.
    model%request%solver%accuracy = 0.0_wp
  end subroutine take_accuracy

  !> Go on to a time. Times come in the direction of the mechanism's end. Fails with exit_singular where the motion cannot go on,
  !> with exit_integrator where the integration cannot, and with exit_usage for a motion that does not run or a time before the
  !> present one. A motion that cannot go on stays at the last time that it reached.
  subroutine advance(self, t, err)
    class(motion_type), intent(inout) :: self           !< the motion, started
    real(wp), intent(in) :: t                           !< time to go to [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(error_type), allocatable :: unused

    if (.not. allocated(self%simulation)) then
      call raise(err, exit_usage, 'a motion must be started before it can advance')
    else if (self%has_failed) then
      call raise(err, exit_usage, 'this motion cannot go on; start it anew, or go to another state')
    else
      call self%simulation%advance(t, err)
    end if
    if (.not. allocated(err)) return
    call explain(err)
    if (err%code == exit_usage) return
    self%has_failed = err%code /= exit_interrupted
    select type (simulation => self%simulation)
    type is (free_simulation_type)
      call simulation%stand_at_step(unused)
    end select
  end subroutine advance

  !> The present time [s]; not a number where no motion is started.
  real(wp) function t(self)
    class(motion_type), intent(in), target :: self   !< the motion
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    t = ieee_value(t, ieee_quiet_nan)
    if (.not. allocated(self%simulation)) return
    call self%simulation%present(plan, state)
    t = state%t
  end function t

  !> Number of coordinates; 0 where no motion is started.
  integer function coordinates(self)
    class(motion_type), intent(in), target :: self   !< the motion
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    coordinates = 0
    if (.not. allocated(self%simulation)) return
    call self%simulation%present(plan, state)
    coordinates = plan%n_coordinates
  end function coordinates

  !> Number of free coordinates, whose motion follows from forces; 0 where no motion is started.
  pure integer function free_coordinates(self)
    class(motion_type), intent(in) :: self   !< the motion

    free_coordinates = 0
    if (allocated(self%simulation)) free_coordinates = self%n_free
  end function free_coordinates

  !> Coordinate k [rad, m]; not a number where there is none.
  real(wp) function q(self, k)
    class(motion_type), intent(in) :: self   !< the motion
    integer, intent(in) :: k                 !< number of the coordinate

    q = derivative(self, k, 0)
  end function q

  !> Rate of coordinate k [rad/s, m/s]; not a number where there is none.
  real(wp) function dq(self, k)
    class(motion_type), intent(in) :: self   !< the motion
    integer, intent(in) :: k                 !< number of the coordinate

    dq = derivative(self, k, 1)
  end function dq

  !> Second time derivative of coordinate k [rad/s^2, m/s^2]; not a number where there is none.
  real(wp) function ddq(self, k)
    class(motion_type), intent(in) :: self   !< the motion
    integer, intent(in) :: k                 !< number of the coordinate

    ddq = derivative(self, k, 2)
  end function ddq

  !> Coordinate k or a time derivative of it.
  real(wp) function derivative(self, k, order)
    class(motion_type), intent(in), target :: self   !< the motion
    integer, intent(in) :: k                 !< number of the coordinate
    integer, intent(in) :: order             !< of the derivative, 0 to 2
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    derivative = ieee_value(derivative, ieee_quiet_nan)
    if (.not. allocated(self%simulation)) return
    call self%simulation%present(plan, state)
    if (k < 1 .or. k > plan%n_coordinates) return
    select case (order)
    case (0)
      derivative = state%q(k)
    case (1)
      derivative = state%dq(k)
    case (2)
      derivative = state%ddq(k)
    end select
  end function derivative

  !> Take all coordinates and their derivatives; not numbers where no motion is started.
  subroutine take_coordinates(self, q, dq, ddq)
    class(motion_type), intent(in), target :: self   !< the motion
    real(wp), intent(out) :: q(:)                    !< (M) [rad, m]
    real(wp), intent(out), optional :: dq(:)         !< (M) rates [rad/s, m/s]
    real(wp), intent(out), optional :: ddq(:)        !< (M) second time derivatives [rad/s^2, m/s^2]
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    q = ieee_value(1.0_wp, ieee_quiet_nan)
    if (present(dq)) dq = ieee_value(1.0_wp, ieee_quiet_nan)
    if (present(ddq)) ddq = ieee_value(1.0_wp, ieee_quiet_nan)
    if (.not. allocated(self%simulation)) return
    call self%simulation%present(plan, state)
    q = state%q
    if (present(dq)) dq = state%dq
    if (present(ddq)) ddq = state%ddq
  end subroutine take_coordinates

  !> Size of the unit that coordinate k has in the data file [rad, m]; not a number where there is none.
  real(wp) function unit(self, k, of_rate)
    class(motion_type), intent(in), target :: self   !< the motion
    integer, intent(in) :: k                         !< number of the coordinate
    logical, intent(in), optional :: of_rate         !< the unit is that of its rate; not unless given
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    unit = ieee_value(unit, ieee_quiet_nan)
    if (.not. allocated(self%simulation)) return
    call self%simulation%present(plan, state)
    if (k < 1 .or. k > plan%n_coordinates) return
    unit = plan%result_unit(k)
    if (present(of_rate)) unit = merge(plan%rate_unit(k), unit, of_rate)
  end function unit

  !> Give a number of a load or a motor another value, from the present time on. The motion stays as it is where this fails: with
  !> exit_usage where no motion under forces is started, or for a number of another group, with exit_data for a name that is not known
  !> or a value out of its range.
  subroutine set(self, name, value, err)
    class(motion_type), intent(inout) :: self              !< the motion
    character(len=*), intent(in) :: name                   !< of the number, as load(1).force(2)
    real(wp), intent(in) :: value                          !< in the unit of the data file
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp), allocatable :: present(:)
    logical :: other_loads_act

    if (.not. allocated(self%simulation)) then
      call raise(err, exit_usage, 'a motion must be started before its forces are changed')
    else if (self%model%is_driven()) then
      call raise(err, exit_usage, 'drives determine this motion; no force changes it')
    end if
    if (allocated(err)) return
    call self%loads%change(name, value, self%model, other_loads_act, err)
    if (allocated(err)) return
    if (other_loads_act) then
      ! the plan of the motion leaves idle loads out
      call self%take_state(present)
      call self%go_to_state(present, err)
      return
    end if
    select type (simulation => self%simulation)
    type is (free_simulation_type)
      call simulation%take_changes(err)
    end select
    if (allocated(err)) call explain(err)
  end subroutine set

  !> Take the equations of motion of the free coordinates in the present position, inertia ddq + bias = 0, in SI units. Fails with
  !> exit_usage where no motion is started, and with exit_singular while other coordinates are integrated near a singular position.
  subroutine take_equations(self, coordinates, inertia, bias, err)
    class(motion_type), intent(in), target :: self             !< the motion
    integer, allocatable, intent(out) :: coordinates(:)        !< (n) the free coordinates, in the order of cq
    real(wp), allocatable, intent(out) :: inertia(:, :)        !< (n,n) mass matrix [kg m^2, kg m, kg]
    real(wp), allocatable, intent(out) :: bias(:)              !< (n) forces of inertia at rest of the accelerations, less loads [N m, N]
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    real(wp), allocatable :: found(:, :)
    integer, allocatable :: order(:)
    integer :: i, k, n

    allocate (coordinates(0), inertia(0, 0), bias(0))
    if (.not. allocated(self%simulation)) then
      call raise(err, exit_usage, 'a motion must be started before its equations are known')
      return
    end if
    call self%simulation%present(plan, state)
    if (size(plan%independent) /= size(self%independent)) then
      call raise(err, exit_singular, 'other coordinates are integrated in this position')
    else if (any(plan%independent /= self%independent)) then
      call raise(err, exit_singular, 'other coordinates than those of cq are integrated, near a singular position or while a '// &
                 'stop or friction holds one of them')
    end if
    if (.not. allocated(err)) call find_coefficients(self%model%mechanism, plan, state, found, err)
    if (allocated(err)) then
      call explain(err)
      return
    end if
    ! a closed stop holds a coordinate that is free all the same: its force is a part of the bias
    associate (kind => self%model%problem%partition%kind)
      coordinates = pack([(k, k=1, size(kind))], kind == free_coordinate)
    end associate
    call self%mechanism%order_as_given(coordinates)
    n = size(coordinates)
    order = [(findloc(plan%independent, coordinates(i), dim=1), i=1, n)]
    deallocate (inertia, bias)
    allocate (inertia(n, n), bias(n))
    do k = 1, n
      do i = 1, n
        inertia(i, k) = found(max(order(i), order(k)), min(order(i), order(k)))
      end do
    end do
    bias = -matmul(inertia, state%ddq(coordinates))
  end subroutine take_equations

  !> Take the present state: the time, coordinates and rates of all pairs, and states of motors, in SI units. It is empty where no
  !> motion is started.
  subroutine take_state(self, numbers)
    class(motion_type), intent(in), target :: self             !< the motion
    real(wp), allocatable, intent(out) :: numbers(:)           !< (1 + 2M + 2 motors) the state
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    allocate (numbers(0))
    if (.not. allocated(self%simulation)) return
    call self%simulation%present(plan, state)
    numbers = [state%t, state%q, state%dq]
    if (allocated(state%motor)) numbers = [numbers, state%motor, real(state%limited, wp)]
  end subroutine take_state

  !> Go to a state that take_state gave, perhaps of another motion of the same mechanism: the motion starts there anew. Fails with
  !> exit_usage where it is no such state, else as start_dynamics does; the motion then
  !> stays where it was.
  subroutine go_to_state(self, numbers, err)
    class(motion_type), intent(inout) :: self              !< the motion, started
    real(wp), intent(in) :: numbers(:)                     !< (1 + 2M + 2 motors) the state
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(error_type), allocatable :: unused
    real(wp), allocatable :: present(:)

    call self%take_state(present)
    if (size(present) == 0) then
      call raise(err, exit_usage, 'a motion must be started before it can go to another state')
    else if (size(numbers) /= size(present) .or. .not. all(abs(numbers) <= largest_number)) then
      call raise(err, exit_usage, 'this is no state of this mechanism')
    end if
    if (allocated(err)) return
    call start_at(self, numbers, err)
    if (.not. allocated(err)) return
    ! back to the state before
    call start_at(self, present, unused)
    if (allocated(unused)) call self%close()
  end subroutine go_to_state

  !> Start the motion anew at a state.
  subroutine start_at(self, numbers, err)
    class(motion_type), intent(inout) :: self              !< the motion
    real(wp), intent(in) :: numbers(:)                     !< (1 + 2M + 2 motors) the state
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp) :: span
    integer :: m

    m = size(self%model%mechanism%pairs)
    if (allocated(self%simulation)) then
      call self%simulation%close()
      deallocate (self%simulation)
    end if
    self%planned = -1
    associate (initial => self%model%problem%initial, time => self%model%request%time)
      initial%position = numbers(2:m + 1)
      initial%velocity = numbers(m + 2:2*m + 1)
      initial%position_given = .true.
      initial%velocity_given = .true.
      span = time%end - time%start
      time%start = numbers(1)
      time%end = numbers(1) + span
    end associate
    call start_model(self, err, motors=numbers(2*m + 2:))
    call self%mechanism%point_at(err)
  end subroutine start_at

  !> Motion of a named point, in the system of link 1. Fails with exit_usage for a name that is not known.
  subroutine point(self, name, err, position, velocity, acceleration)
    class(motion_type), intent(in), target :: self         !< the motion
    character(len=*), intent(in) :: name                   !< of the point
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp), intent(out), optional :: position(3)         !< [m]
    real(wp), intent(out), optional :: velocity(3)         !< [m/s]
    real(wp), intent(out), optional :: acceleration(3)     !< [m/s^2]
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state
    type(point_type), pointer :: points(:)
    real(wp) :: p(3), v(3), a(3)
    integer :: i

    p = ieee_value(p, ieee_quiet_nan)
    v = p
    a = p
    if (allocated(self%simulation)) then
      call self%simulation%present(plan, state)
      points => self%model%mechanism%points
      do i = 1, size(points)
        if (points(i)%name == name) exit
      end do
      if (i > size(points)) then
        call raise(err, exit_usage, 'the mechanism has no point '''//name//'''')
      else
        call point_motion(plan, state, points(i)%link, points(i)%position, p, v, a)
      end if
    else
      call raise(err, exit_usage, 'a motion must be started before its points are known')
    end if
    if (present(position)) position = p
    if (present(velocity)) velocity = v
    if (present(acceleration)) acceleration = a
  end subroutine point

  !> Force of a coupling on the second of its coordinates [N m, N]. Fails with exit_usage where there is no such coupling, or where
  !> the mechanism does not ask for forces (&output reactions=.true.), with exit_singular where no finite forces balance the links.
  subroutine coupling_force(self, number, force, err)
    class(motion_type), intent(inout), target :: self      !< the motion
    integer, intent(in) :: number                          !< of the coupling, in the order of the groups
    real(wp), intent(out) :: force                         !< not a number after a failure [N m, N]
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    force = ieee_value(force, ieee_quiet_nan)
    if (.not. allocated(self%simulation)) then
      call raise(err, exit_usage, 'a motion must be started before its forces are known')
      return
    end if
    call self%simulation%present_for_forces(plan, state)
    if (number < 1 .or. number > size(plan%couplings)) then
      call raise(err, exit_usage, 'the mechanism has no coupling '//to_text(number))
    else if (.not. self%model%request%output%reactions) then
      call raise(err, exit_usage, 'forces are known only where they are asked for; give &output reactions=.true. /')
    end if
    if (allocated(err)) return
    if (self%planned /= self%simulation%plans() .or. .not. is_made_for(self%reaction_plan, plan)) then
      call make_reaction_plan(self%model%mechanism, plan, self%reaction_plan)
      if (allocated(self%reactions)) deallocate (self%reactions)
      allocate (self%reactions, source=new_reactions(plan, self%reaction_plan))
      self%planned = self%simulation%plans()
    end if
    call find_reactions(self%model%mechanism, plan, self%reaction_plan, state, self%reactions, err)
    if (allocated(err)) then
      call explain(err)
    else
      force = self%reactions%couplings%values(number)
    end if
  end subroutine coupling_force

  !> Energies of the present position; not numbers where no motion is started.
  subroutine energies(self, kinetic, potential)
    class(motion_type), intent(inout) :: self   !< the motion
    real(wp), intent(out) :: kinetic            !< of all bodies [J]
    real(wp), intent(out) :: potential          !< of gravity and springs [J]

    kinetic = ieee_value(kinetic, ieee_quiet_nan)
    potential = kinetic
    if (allocated(self%simulation)) call self%simulation%energies(kinetic, potential)
  end subroutine energies

  !> Largest closure error of the present position [m]; not a number where no motion is started.
  real(wp) function closure(self)
    class(motion_type), intent(in) :: self   !< the motion

    closure = ieee_value(closure, ieee_quiet_nan)
    if (allocated(self%simulation)) closure = self%simulation%closure
  end function closure

  !> The changes of the independent coordinates so far, in the order of time.
  subroutine coordinate_changes(self, list)
    class(motion_type), intent(in) :: self                                !< the motion
    type(coordinate_change_type), allocatable, intent(out) :: list(:)     !< none of a driven motion

    if (allocated(self%simulation)) then
      list = self%simulation%coordinate_changes
    else
      allocate (list(0))
    end if
  end subroutine coordinate_changes

  !> The impacts so far, the stops that closed and opened, and the pairs that stuck and slipped, in the order of time.
  subroutine events(self, list)
    class(motion_type), intent(in) :: self                             !< the motion
    type(motion_event_type), allocatable, intent(out) :: list(:)       !< none of a driven motion
    integer :: n

    n = 0
    if (allocated(self%simulation)) n = self%simulation%events%count
    allocate (list(n))
    if (n > 0) list = self%simulation%events%items(:n)
  end subroutine events

  !> The work that the motion took so far.
  function statistics(self)
    class(motion_type), intent(inout) :: self         !< the motion
    type(simulation_statistics_type) :: statistics

    if (allocated(self%simulation)) statistics = self%simulation%statistics()
  end function statistics

  !> End the motion and free its memory. A motion can then be started again.
  subroutine close_motion(self)
    class(motion_type), intent(inout) :: self   !< the motion

    if (allocated(self%simulation)) then
      call self%simulation%close()
      deallocate (self%simulation)
    end if
    if (associated(self%model)) deallocate (self%model)
    self%planned = -1
  end subroutine close_motion
end module mech9_motion
