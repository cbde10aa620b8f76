!> The equations of motion of a model as a function: x' = f(x, p, t), with exact derivatives by the state x and the parameters p.
!>
!> The state has the free coordinates of the data file, then their rates. With the forces F(q, dq, ddq, p, t) that a motion requires
!> beyond its loads, the accelerations are -M^-1 F(q, dq, 0, p, t), M the derivatives of F by them, and the derivatives of f follow
!> from those of F (mech9_linearisation, mech9_varied_forces). Closed chains follow the state from one evaluation to the next one;
!> independent coordinates are those of the data file all the time, so that the function ends at their singular positions.
module mech9_state_rates
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data, exit_assembly, exit_singular
  use mech9_simulation_failures, only: failure_gimbal_lock
  use mech9_cholesky, only: cholesky_factorize, cholesky_solve
  use mech9_partition, only: free_coordinate
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_frame_motion, only: place_all
  use mech9_branch_stepping, only: set_inputs
  use mech9_motor_states, only: start_motors
  use mech9_motion_view, only: unlocked
  use mech9_nearby_position, only: find_nearby_position
  use mech9_resting_plan, only: plan_by_geometry
  use mech9_planning, only: planning_settings_type, make_plan
  use mech9_motion_in_space, only: refuse_singular_chains
  use mech9_linearisation, only: linearisation_type, new_linearisation, find_forces, find_matrix, by_position, by_rate, &
    by_acceleration
  use mech9_known_derivatives, only: check_known
  use mech9_varied_motion, only: varied_motion_type, new_varied_motion, find_varied_motion
  use mech9_varied_forces, only: varied_forces_type, new_varied_forces, find_varied_forces
  implicit none
  private
  public :: state_rates_type, refuse_jumps

  !> It must not be copied. Parts are polymorphic, which keeps the code of copies small.
  type :: state_rates_type
    integer, allocatable :: free(:)                               !< (n) numbers of the free coordinates, ascending
    real(wp), allocatable :: values(:)                            !< (P) present parameters, in the units of the data file
    real(wp), allocatable :: unit(:)                              !< (n) of the free coordinates: rad, or the size [rad, m]
    class(model_type), allocatable :: model                       !< at these values
    class(plan_type), allocatable, private :: plan                !< in space, in the coordinates of the data file
    class(state_type), allocatable, private :: state              !< the last closed position
    class(linearisation_type), allocatable, private :: linear
    class(varied_motion_type), allocatable, private :: varied     !< by parameters, once it is asked for at these values
    class(variable_model_type), pointer, private :: variable => null()   !< the model as a function of its parameters; not owned
  contains
    procedure :: begin
    procedure :: find
    procedure :: take_values
  end type state_rates_type

  !> Largest part of a parameter's range by which it changes at once, and the least part of this.
  real(wp), parameter :: part_of_range = 0.02_wp, least_step = 1.0e-3_wp
  !> Steps in which parameters and coordinates change together, where they cannot change one after the other.
  integer, parameter :: steps_together = 40
  !> A position that moves further than this at once has left its branch [rad, sizes of the mechanism].
  real(wp), parameter :: largest_move = 0.2_wp

contains

  !> Fail with exit_data where the equations of motion are no smooth function of the state: with friction, contacts, rigid stops,
  !> and motors that have states.
  subroutine refuse_jumps(model, err)
    type(model_type), intent(in) :: model               !< the model
    type(error_type), allocatable, intent(out) :: err   !< allocated where it has such parts
    integer :: i

    if (.not. any(model%problem%partition%kind == free_coordinate)) then
      call raise(err, exit_data, 'every independent coordinate is driven, so that there are no equations of motion; leave out '// &
                 'a &drive')
      if (size(model%problem%drives) > 0) err%place = model%problem%drives(1)%drive%place
    else if (model%mechanism%has_frictions()) then
      call raise(err, exit_data, 'equations of motion by the state are not known with dry friction, whose force jumps; leave '// &
                 'the group out, or use a damping of &load in its place', model%mechanism%frictions(1)%place)
    else if (model%mechanism%has_contacts()) then
      call raise(err, exit_data, 'equations of motion by the state are not known where links may touch each other; leave the '// &
                 'group &contact out', model%mechanism%contacts(1)%place)
    else if (model%mechanism%has_rigid_ends()) then
      do i = 1, size(model%mechanism%stops)
        if (model%mechanism%stops(i)%is_rigid) exit
      end do
      call raise(err, exit_data, 'equations of motion by the state are not known with a rigid stop; give it a stiffness, '// &
                 'or leave the group out', model%mechanism%stops(i)%place)
    end if
    if (allocated(err)) return
    do i = 1, size(model%mechanism%motors)
      associate (motor => model%mechanism%motors(i)%motor)
        if (.not. (motor%has_state() .or. motor%holds_setpoint())) cycle
        call raise(err, exit_data, 'equations of motion by the state are not known with a motor that has a state '// &
                   'of its own, a current or an integral; use a &load in its place', motor%place)
        return
      end associate
    end do
  end subroutine refuse_jumps

  !> Begin at a position. Fails as refuse_jumps does, and where the chains do not close near by.
  subroutine begin(self, variable, model, q, err)
    class(state_rates_type), intent(inout) :: self                !< the function
    class(variable_model_type), intent(in), target :: variable    !< the model by its parameters; outlives the function
    type(model_type), intent(in) :: model                         !< the model at the start
    real(wp), intent(in) :: q(:)                                  !< (M) coordinates, a closed position [rad, m]
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    integer :: i

    call refuse_jumps(model, err)
    if (allocated(err)) return
    self%variable => variable
    allocate (self%model, source=model)
    allocate (self%plan, self%state)
    self%values = [(model%parameters(i)%value, i=1, size(model%parameters))]
    call make_plan(model%mechanism, model%problem%partition, q, self%plan, self%state, err, planning_settings_type(in_space=.true.))
    if (allocated(err)) return
    associate (independent => self%plan%independent, kind => model%problem%partition%kind)
      self%free = pack([(i, i=1, size(kind))], kind == free_coordinate .and. [(any(independent == i), i=1, size(kind))])
    end associate
    self%unit = self%plan%unit_of(self%free)
    call settle(self)
  end subroutine begin

  !> Prepare what belongs to a new plan.
  subroutine settle(self)
    class(state_rates_type), intent(inout) :: self      !< the function, with plan and state

    if (allocated(self%linear)) deallocate (self%linear)
    if (allocated(self%varied)) deallocate (self%varied)
    allocate (self%linear)
    call new_linearisation(self%model%mechanism, self%plan, self%linear)
    call start_motors(self%model%mechanism, self%state)
  end subroutine settle

  !> Find the rates of the state, and their derivatives. Fails with exit_assembly where the chains do not close, with exit_singular
  !> where the free coordinates do not determine the motion or a ball joint is in gimbal lock, and as loads do. The function can be
  !> asked at another state afterwards.
  subroutine find(self, x, values, t, f, err, by_state, by_parameters)
    class(state_rates_type), intent(inout) :: self                     !< the function
    real(wp), intent(in) :: x(:)                                       !< (2n) free coordinates, then their rates [rad, m, per s]
    real(wp), intent(in) :: values(:)                                  !< (P) parameters, in the units of the data file
    real(wp), intent(in) :: t                                          !< time of the drives and loads [s]
    real(wp), intent(out) :: f(:)                                      !< (2n) rates, then accelerations [per s]
    type(error_type), allocatable, intent(out) :: err                  !< allocated if it failed
    real(wp), intent(out), optional :: by_state(:, :)                  !< (2n,2n) derivatives of f, a column for each component of x
    real(wp), intent(out), optional :: by_parameters(:, :)             !< (2n,P) per unit of the data file
    real(wp), dimension(size(self%free), size(self%free)) :: factors
    integer :: n

    n = size(self%free)
    f = 0.0_wp
    call go_to(self, x(:n), values, t, err)
    if (.not. allocated(err)) call set_rates(self, x(n + 1:), t, err)
    if (.not. allocated(err)) call find_accelerations(self, factors, err)
    if (allocated(err)) return
    f(:n) = x(n + 1:)
    f(n + 1:) = self%state%ddq(self%free)
    if (present(by_state)) call vary_by_state(self, factors, by_state, err)
    if (allocated(err)) return
    if (present(by_parameters)) call vary_by_parameters(self, factors, by_parameters, err)
  end subroutine find

  !> Go to other values of parameters and free coordinates: first the parameters, and where this way is blocked both together.
  subroutine go_to(self, free, values, t, err)
    class(state_rates_type), intent(inout) :: self      !< the function
    real(wp), intent(in) :: free(:)                     !< (n) the free coordinates [rad, m]
    real(wp), intent(in) :: values(:)                   !< (P) parameters, in the units of the data file
    real(wp), intent(in) :: t                           !< time of the drives [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: first_free(size(free)), first_values(size(values)), part
    integer :: i

    first_free = self%state%q(self%free)
    first_values = self%values
    call step_in_order(self, .true., free, values, t, err)
    if (.not. allocated(err) .or. size(self%plan%closures) == 0) return
    call step_in_order(self, .false., first_free, first_values, t, err)
    do i = 1, steps_together
      if (allocated(err)) return
      part = real(i, wp)/steps_together
      call step_in_order(self, .false., first_free + part*(free - first_free), first_values + part*(values - first_values), t, err)
      if (allocated(err)) &
        call step_in_order(self, .true., first_free + part*(free - first_free), first_values + part*(values - first_values), t, err)
    end do
    if (.not. allocated(err)) call step_in_order(self, .true., free, values, t, err)
  end subroutine go_to

  !> Change parameters and free coordinates one after the other.
  subroutine step_in_order(self, values_first, free, values, t, err)
    class(state_rates_type), intent(inout) :: self      !< the function
    logical, intent(in) :: values_first                 !< the parameters come first
    real(wp), intent(in) :: free(:)                     !< (n) the free coordinates [rad, m]
    real(wp), intent(in) :: values(:)                   !< (P) parameters, in the units of the data file
    real(wp), intent(in) :: t                           !< time of the drives [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    if (values_first) then
      call self%take_values(values, t, err)
      if (.not. allocated(err)) call move_to(self, free, t, err)
    else
      call move_to(self, free, t, err)
      if (.not. allocated(err)) call self%take_values(values, t, err)
    end if
  end subroutine step_in_order

  !> Take other values of the parameters, in steps in which the independent coordinates keep their values and the others stay near
  !> by.
  subroutine take_values(self, values, t, err)
    class(state_rates_type), intent(inout) :: self      !< the function
    real(wp), intent(in) :: values(:)                   !< (P) in the units of the data file
    real(wp), intent(in) :: t                           !< time of the drives [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: from(size(values)), done, step
    logical :: near

    if (.not. any(abs(values - self%values) > 0.0_wp)) return
    from = self%values
    done = 0.0_wp
    step = 1.0_wp/max(1.0_wp, maxval(abs(values - from)/(part_of_range*ranges(self))))
    if (size(self%plan%closures) == 0) step = 1.0_wp
    do while (done < 1.0_wp)
      step = min(step, 1.0_wp - done)
      if (done + step >= 1.0_wp) then
        call step_to(self, values, t, near, err)
      else
        call step_to(self, from + (done + step)*(values - from), t, near, err)
      end if
      if (near) then
        done = done + step
      else
        step = 0.5_wp*step
        if (step*maxval(abs(values - from)/ranges(self)) >= least_step*part_of_range) cycle
        if (.not. allocated(err)) &
          call raise(err, exit_assembly, 'the chains do not close near by when the parameters change to these values')
        return
      end if
    end do
  end subroutine take_values

  !> Sizes by which changes of parameters are small or large.
  function ranges(self) result(sizes)
    class(state_rates_type), intent(in) :: self         !< the function
    real(wp) :: sizes(size(self%values))
    integer :: i

    do i = 1, size(sizes)
      associate (parameter => self%model%parameters(i))
        sizes(i) = max(abs(parameter%value), abs(self%values(i)))
        if (parameter%has_range) sizes(i) = parameter%high - parameter%low
      end associate
      if (.not. sizes(i) > 0.0_wp) sizes(i) = 1.0_wp
    end do
  end function ranges

  !> Take values of the parameters near the present ones. Where the position does not stay near by everything is as it was.
  subroutine step_to(self, values, t, near, err)
    class(state_rates_type), intent(inout) :: self      !< the function
    real(wp), intent(in) :: values(:)                   !< (P) in the units of the data file
    real(wp), intent(in) :: t                           !< time of the drives [s]
    logical, intent(out) :: near                        !< the values are taken
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is no such model, or the chains do not close
    class(model_type), allocatable :: model
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: state

    near = .false.
    allocate (model, plan, state)
    call self%variable%at(values, model, err)
    if (.not. allocated(err)) &
      call plan_by_geometry(model%mechanism, model%problem%partition, self%plan, self%state%q, plan, state, err)
    if (allocated(err)) return
    near = all(abs(state%q - self%state%q) <= largest_move*plan%unit_of)
    if (.not. near) return
    state%t = t
    call move_alloc(model, self%model)
    call move_alloc(plan, self%plan)
    call move_alloc(state, self%state)
    self%values = values
    call settle(self)
  end subroutine step_to

  !> Move the closed position to other values of the free coordinates and of the drives, on a straight line.
  subroutine move_to(self, free, t, err)
    class(state_rates_type), intent(inout) :: self      !< the function; its position changes where nothing fails
    real(wp), intent(in) :: free(:)                     !< (n) the free coordinates [rad, m]
    real(wp), intent(in) :: t                           !< time of the drives [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if the chains do not close
    real(wp) :: q(size(self%state%q))

    call find_nearby_position(self%model%problem%drives, self%plan, self%state, self%free, free, t, &
                              'the chains do not close on the way to this position, or become singular in the independent '// &
                              'coordinates; other ones in &structure cq may serve', q, err)
    if (allocated(err)) return
    self%state%q = q
    self%state%t = t
    call place_all(self%plan, self%state, err)
  end subroutine move_to

  !> Set the rates of the independent coordinates; the free ones have no accelerations yet.
  subroutine set_rates(self, rates, t, err)
    class(state_rates_type), intent(inout) :: self      !< the function, in its position
    real(wp), intent(in) :: rates(:)                    !< (n) of the free coordinates [rad/s, m/s]
    real(wp), intent(in) :: t                           !< time of the drives [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated if a law has no value

    associate (state => self%state)
      state%dq = 0.0_wp
      state%ddq = 0.0_wp
      call set_inputs(self%model%problem%drives, t, state%q, state%dq, state%ddq, err)
      if (allocated(err)) return
      state%dq(self%free) = rates
      if (allocated(state%limited)) state%limited = unlocked
    end associate
  end subroutine set_rates

  !> Find the accelerations, and stand with them.
  subroutine find_accelerations(self, factors, err)
    class(state_rates_type), intent(inout) :: self      !< the function, with position and rates
    real(wp), intent(out) :: factors(:, :)              !< (n,n) Cholesky factors of the inertia, in units of the plan
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: accelerations(size(self%free)), magnitude
    integer :: failed_at, n

    n = size(self%free)
    associate (mechanism => self%model%mechanism, plan => self%plan, state => self%state, linear => self%linear)
      call find_forces(mechanism, plan, self%state, self%linear, err)
      if (.not. allocated(err)) call refuse_singular_chains(plan, self%state, self%linear, err)
      if (allocated(err)) return
      accelerations = -linear%forces(self%free)*self%unit
      call find_matrix(mechanism, plan, self%state, by_acceleration, self%free, self%linear, factors, magnitude, err)
      if (allocated(err)) return
      factors = 0.5_wp*(factors + transpose(factors))
      call cholesky_factorize(n, factors, failed_at)
      if (failed_at > 0) then
        call raise(err, exit_singular, failure_gimbal_lock)
        err%failure%coordinates = [self%free(failed_at)]
        err%failure%t = state%t
        return
      end if
      call cholesky_solve(n, factors, accelerations)
      state%ddq(self%free) = accelerations*self%unit
      call find_forces(mechanism, plan, self%state, self%linear, err)
    end associate
  end subroutine find_accelerations

  !> The derivatives by the state.
  subroutine vary_by_state(self, factors, by_state, err)
    class(state_rates_type), intent(inout) :: self      !< the function, at the motion
    real(wp), intent(in) :: factors(:, :)               !< (n,n) of the inertia
    real(wp), intent(out) :: by_state(:, :)             !< (2n,2n) the derivatives
    type(error_type), allocatable, intent(out) :: err   !< allocated if a load failed
    real(wp), dimension(size(self%free), size(self%free)) :: matrix
    real(wp) :: magnitude
    integer :: j, n, order

    n = size(self%free)
    by_state = 0.0_wp
    do order = 0, 1
      call find_matrix(self%model%mechanism, self%plan, self%state, merge(by_position, by_rate, order == 0), self%free, &
                       self%linear, matrix, magnitude, err)
      if (allocated(err)) return
      do j = 1, n
        call cholesky_solve(n, factors, matrix(:, j))
        by_state(n + 1:, order*n + j) = -matrix(:, j)*self%unit/self%unit(j)
      end do
    end do
    do j = 1, n
      by_state(j, n + j) = 1.0_wp
    end do
  end subroutine vary_by_state

  !> The derivatives by the parameters.
  subroutine vary_by_parameters(self, factors, by_parameters, err)
    class(state_rates_type), intent(inout) :: self      !< the function, at the motion
    real(wp), intent(in) :: factors(:, :)               !< (n,n) of the inertia
    real(wp), intent(out) :: by_parameters(:, :)        !< (2n,P) the derivatives
    type(error_type), allocatable, intent(out) :: err   !< allocated if they are not known
    type(varied_forces_type) :: forces
    real(wp) :: change(size(self%free))
    integer :: p, n

    n = size(self%free)
    by_parameters = 0.0_wp
    if (size(self%values) == 0) return
    if (.not. allocated(self%varied)) then
      allocate (self%varied)
      call new_varied_motion(self%variable, self%model, self%plan, self%varied, err)
      if (.not. allocated(err)) call check_known(self%model, self%varied%tangents, err)
      if (allocated(err)) then
        deallocate (self%varied)
        return
      end if
    end if
    self%varied%given = 0.0_wp
    call find_varied_motion(self%model, self%state, self%varied, err)
    if (allocated(err)) return
    call new_varied_forces(self%model, self%varied, forces)
    call find_varied_forces(self%model, self%varied, forces, err)
    if (allocated(err)) return
    do p = 1, size(by_parameters, 2)
      change = -forces%changes(p, self%free)*self%unit
      call cholesky_solve(n, factors, change)
      by_parameters(n + 1:, p) = change*self%unit
    end do
  end subroutine vary_by_parameters
end module mech9_state_rates
