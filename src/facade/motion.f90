!> A motion as the library's users run it: started, advanced from time to time, and asked for its coordinates, points and energies.
module mech9_motion
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_model, only: model_type
  use mech9_point, only: point_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: point_motion
  use mech9_simulation, only: simulation_type, simulation_statistics_type, interruption_type, &
    coordinate_change_type, judge_error
  use mech9_reaction_plan, only: reaction_plan_type, make_reaction_plan, is_made_for
  use mech9_reactions, only: reactions_type, new_reactions, find_reactions
  use mech9_explanation, only: explain
  use mech9_model_motion, only: model_motion_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: motion_type

  !> It must not be copied.
  type :: motion_type
    private
    type(model_type), pointer :: model => null()            !< owned; the simulation refers to it
    class(simulation_type), allocatable :: simulation
    type(reaction_plan_type) :: reaction_plan               !< of forces, once they are asked for
    class(reactions_type), allocatable :: reactions         !< of the last position whose forces were asked for
    integer :: planned = -1                                 !< changes of coordinates until the plan was made; -1: never
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
    procedure :: unit
    procedure :: point
    procedure :: coupling_force
    procedure :: energies
    procedure :: closure
    procedure :: events
    procedure :: statistics
    procedure :: close => close_motion
  end type motion_type

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
    type(model_motion_type) :: motion

    call self%close()
    allocate (self%model)
    call mechanism%take(program, self%model, err)
    if (.not. allocated(err)) call motion%assemble(self%model, err)
    if (.not. allocated(err)) call motion%prepare(self%model, err, pictures=.true.)
    if (.not. allocated(err)) call take_accuracy(motion, self%model, err, interruption)
    if (.not. allocated(err)) call motion%simulation%start(err, interruption)
    call mechanism%point_at(err)
    if (allocated(err)) then
      call motion%close()
      call self%close()
    else
      call move_alloc(motion%simulation, self%simulation)
    end if
  end subroutine start_motion

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
  !> present one.
  subroutine advance(self, t, err)
    class(motion_type), intent(inout) :: self           !< the motion, started
    real(wp), intent(in) :: t                           !< time to go to [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (allocated(self%simulation)) then
      call self%simulation%advance(t, err)
      if (allocated(err)) call explain(err)
    else
      call raise(err, exit_usage, 'a motion must be started before it can advance')
    end if
  end subroutine advance

  !> The present time [s]; not a number where no motion is started.
  real(wp) function t(self)
    class(motion_type), intent(in) :: self   !< the motion

    t = ieee_value(t, ieee_quiet_nan)
    if (allocated(self%simulation)) t = self%simulation%t
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
  real(wp) function unit(self, k)
    class(motion_type), intent(in), target :: self   !< the motion
    integer, intent(in) :: k                         !< number of the coordinate
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    unit = ieee_value(unit, ieee_quiet_nan)
    if (.not. allocated(self%simulation)) return
    call self%simulation%present(plan, state)
    if (k >= 1 .and. k <= plan%n_coordinates) unit = plan%result_unit(k)
  end function unit

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
    if (self%planned /= size(self%simulation%events) .or. .not. is_made_for(self%reaction_plan, plan)) then
      call make_reaction_plan(self%model%mechanism, plan, self%reaction_plan)
      if (allocated(self%reactions)) deallocate (self%reactions)
      allocate (self%reactions, source=new_reactions(plan, self%reaction_plan))
      self%planned = size(self%simulation%events)
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
  subroutine events(self, list)
    class(motion_type), intent(in) :: self                                !< the motion
    type(coordinate_change_type), allocatable, intent(out) :: list(:)     !< none of a driven motion

    if (allocated(self%simulation)) then
      list = self%simulation%events
    else
      allocate (list(0))
    end if
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
