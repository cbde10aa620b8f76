!> The equations of motion as the library's users call them: x' = f(x, p, t), with exact derivatives by the state x and the
!> parameters p.
module mech9_motion_equations
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, texts_of_one_length, to_text
  use mech9_result_units, only: unit_of_parameter
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_law_periods, only: law_period_type, find_law_period
  use mech9_state_rates, only: state_rates_type, refuse_jumps
  use mech9_explained_assembly, only: assemble_model
  use mech9_varied_document, only: varied_document_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: motion_equations_type

  !> The state has the free coordinates, then their rates, in SI units. With a clock two numbers follow, the cosine and sine of the
  !> phase of all drives and loads: the equations then do not depend on time, and the pair is drawn to the unit circle. It must not
  !> be copied.
  type :: motion_equations_type
    private
    type(checked_mechanism_type) :: mechanism                        !< as it was at the begin
    type(varied_document_type), pointer :: variable => null()        !< owned: the model as a function of its parameters
    type(state_rates_type), pointer :: rates => null()               !< owned
    real(wp), allocatable :: first_state(:)                          !< at the start of the data file
    real(wp), allocatable :: first_values(:)                         !< of the parameters
    real(wp) :: from = 0.0_wp                                        !< start of the motion [s]
    logical :: has_clock = .false.
    real(wp) :: period = 0.0_wp                                      !< of the clock, at the parameters of the last call [s]
    real(wp), allocatable :: period_change(:)                        !< (P) its derivatives by the parameters
    real(wp), allocatable :: clock_values(:)                         !< (P) parameters at which the period was found
  contains
    procedure :: begin
    procedure :: count_states
    procedure :: count_parameters
    procedure :: name_all
    procedure :: start
    procedure :: take_units
    procedure :: find
    procedure :: close => close_equations
  end type motion_equations_type

  !> Step of the differences by time, in parts of a period: of fourth order, they have errors of about 1e-10.
  real(wp), parameter :: part_of_period = 5.0e-4_wp
  !> Step of the differences of the period, in parts of a parameter.
  real(wp), parameter :: part_of_value = 1.0e-5_wp
  real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)

contains

  !> Begin at the assembled start of a mechanism, or at another position. Fails with exit_data for friction, contacts, rigid stops
  !> and motors with states, and as the start of a motion under forces does; with a clock also where laws have no common period.
  subroutine begin(self, mechanism, err, q, with_clock)
    class(motion_equations_type), intent(inout) :: self          !< the equations; those before are closed
    type(checked_mechanism_type), intent(in) :: mechanism        !< with free coordinates, bodies and loads
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    real(wp), intent(in), optional :: q(:)                       !< (M) coordinates of a closed position [rad, m]; the
                                                                 !< assembled start unless given
    logical, intent(in), optional :: with_clock                  !< the state has a clock; not unless given
    type(model_type) :: model
    integer :: i

    call self%close()
    self%mechanism = mechanism
    allocate (self%variable, self%rates)
    call mechanism%take_request(dynamics, model, err)
    if (.not. allocated(err)) call refuse_jumps(model, err)
    if (.not. allocated(err)) then
      call mechanism%take_variable(dynamics, self%variable)
      self%from = model%request%time%start
      self%first_values = [(model%parameters(i)%value, i=1, size(model%parameters))]
      self%period_change = 0.0_wp*self%first_values
      if (present(with_clock)) self%has_clock = with_clock
      if (self%has_clock) call read_clock(self, model, err)
    end if
    if (.not. allocated(err)) then
      if (present(q)) then
        if (size(q) == size(model%mechanism%pairs)) then
          call begin_at(self, model, q, err)
        else
          call raise(err, exit_usage, 'the position needs '//to_text(size(model%mechanism%pairs))//' coordinates')
        end if
      else
        call begin_at_start(self, model, err)
      end if
    end if
    call mechanism%point_at(err)
    if (allocated(err)) call self%close()
  end subroutine begin

  !> Begin at the assembled start.
  subroutine begin_at_start(self, model, err)
    class(motion_equations_type), intent(inout) :: self          !< the equations
    type(model_type), intent(in) :: model                        !< the model
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed
    type(plan_type) :: plan
    type(state_type) :: state

    call assemble_model(model, plan, state, err)
    if (.not. allocated(err)) call begin_at(self, model, state%q, err)
  end subroutine begin_at_start

  !> Begin at a position.
  subroutine begin_at(self, model, q, err)
    class(motion_equations_type), intent(inout) :: self          !< the equations
    type(model_type), intent(in) :: model                        !< the model
    real(wp), intent(in) :: q(:)                                 !< (M) all coordinates [rad, m]
    type(error_type), allocatable, intent(out) :: err            !< allocated if it failed

    call self%rates%begin(self%variable, model, q, err)
    if (allocated(err)) return
    associate (free => self%rates%free)
      self%first_state = [q(free), model%problem%initial%velocity(free)]
    end associate
    if (self%has_clock) self%first_state = [self%first_state, 1.0_wp, 0.0_wp]
  end subroutine begin_at

  !> Number of states; 0 before the begin.
  pure integer function count_states(self)
    class(motion_equations_type), intent(in) :: self   !< the equations

    count_states = 0
    if (allocated(self%first_state)) count_states = size(self%first_state)
  end function count_states

  !> Number of parameters; 0 before the begin.
  pure integer function count_parameters(self)
    class(motion_equations_type), intent(in) :: self   !< the equations

    count_parameters = 0
    if (allocated(self%first_state)) count_parameters = size(self%first_values)
  end function count_parameters

  !> Names and units of the states, then of the parameters. States are in SI units, parameters in those of the data file.
  subroutine name_all(self, names, units)
    class(motion_equations_type), intent(in) :: self               !< the equations
    character(len=:), allocatable, intent(out) :: names(:)         !< (states + parameters) q1 ..., dq1 ..., cosine, sine, F ...
    character(len=:), allocatable, intent(out) :: units(:)         !< (states + parameters)
    type(string_type) :: all_names(self%count_states() + self%count_parameters())
    type(string_type) :: all_units(self%count_states() + self%count_parameters())
    integer :: i, k, n

    if (size(all_names) > 0) then
      n = size(self%rates%free)
      do i = 1, n
        k = self%rates%free(i)
        all_names(i)%text = 'q'//to_text(k)
        all_names(n + i)%text = 'dq'//to_text(k)
        all_units(i)%text = trim(merge('rad', 'm  ', self%rates%model%mechanism%pairs(k)%pair%angular))
        all_units(n + i)%text = all_units(i)%text//'/s'
      end do
      if (self%has_clock) then
        all_names(2*n + 1)%text = 'cosine'
        all_names(2*n + 2)%text = 'sine'
        all_units(2*n + 1)%text = '1'
        all_units(2*n + 2)%text = '1'
      end if
      do i = 1, self%count_parameters()
        associate (parameter => self%rates%model%parameters(i), at => self%count_states() + i)
          all_names(at)%text = parameter%name
          all_units(at)%text = trim(unit_of_parameter(self%rates%model%mechanism, parameter))
        end associate
      end do
    end if
    call texts_of_one_length(all_names, names)
    call texts_of_one_length(all_units, units)
  end subroutine name_all

  !> The state at which the equations began, with the initial rates, and the values of the parameters in the data file.
  subroutine start(self, x, values)
    class(motion_equations_type), intent(in) :: self   !< the equations
    real(wp), allocatable, intent(out) :: x(:)         !< (states) in SI units
    real(wp), allocatable, intent(out) :: values(:)    !< (parameters) in the units of the data file

    allocate (x(0), values(0))
    if (.not. allocated(self%first_state)) return
    x = self%first_state
    values = self%first_values
  end subroutine start

  !> Sizes of the states that are as large as a radian: the mechanism's size for lengths, per second for rates.
  subroutine take_units(self, unit)
    class(motion_equations_type), intent(in) :: self   !< the equations
    real(wp), allocatable, intent(out) :: unit(:)      !< (states) in SI units

    allocate (unit(self%count_states()), source=1.0_wp)
    if (size(unit) > 0) unit(:2*size(self%rates%free)) = [self%rates%unit, self%rates%unit]
  end subroutine take_units

  !> Find the rates of a state and their derivatives. Closed chains follow the state from call to call. Fails with exit_assembly
  !> where they do not close, with exit_singular where the free coordinates do not determine the motion, with exit_usage for arrays
  !> of other sizes, and as forces do; another state can be asked for then.
  subroutine find(self, x, values, f, err, by_state, by_parameters, t)
    class(motion_equations_type), intent(inout) :: self              !< the equations, begun
    real(wp), intent(in) :: x(:)                                     !< (states) in SI units
    real(wp), intent(in) :: values(:)                                !< (parameters) in the units of the data file
    real(wp), intent(out) :: f(:)                                    !< (states) the rates, in SI units
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    real(wp), intent(out), optional :: by_state(:, :)                !< (states,states) derivatives, a column for each state
    real(wp), intent(out), optional :: by_parameters(:, :)           !< (states,parameters)
    real(wp), intent(in), optional :: t                              !< time [s]; the start of the motion unless given
    real(wp) :: slopes(size(x), size(x)), by_values(size(x), size(values)), at
    integer :: order

    f = 0.0_wp
    slopes = 0.0_wp
    by_values = 0.0_wp
    order = 0
    if (present(by_state)) order = 1
    if (present(by_parameters)) order = 2
    at = self%from
    if (present(t)) at = t
    if (size(x) /= self%count_states() .or. size(values) /= self%count_parameters() .or. size(f) /= size(x) .or. size(x) == 0) then
      call raise(err, exit_usage, 'equations of motion need '//to_text(self%count_states())//' states and '// &
                 to_text(self%count_parameters())//' parameters')
    else if (.not. (all(abs(x) <= huge(1.0_wp)) .and. all(abs(values) <= huge(1.0_wp)))) then
      call raise(err, exit_usage, 'states and parameters of equations of motion must be numbers')
    else if (self%has_clock) then
      call find_with_clock(self, order, x, values, f, slopes, by_values, err)
    else
      call find_to_order(self, order, x, values, at, f, slopes, by_values, err)
    end if
    if (present(by_state)) by_state = slopes
    if (present(by_parameters)) by_parameters = by_values
    call self%mechanism%point_at(err)
  end subroutine find

  !> The rates of a state without a clock, with the derivatives that are wanted.
  subroutine find_to_order(self, order, x, values, t, f, by_state, by_parameters, err)
    class(motion_equations_type), intent(inout) :: self              !< the equations, begun
    integer, intent(in) :: order                                     !< 0: rates alone; 1: derivatives by the state; 2: all
    real(wp), intent(in) :: x(:)                                     !< (2n) in SI units
    real(wp), intent(in) :: values(:)                                !< (parameters) in the units of the data file
    real(wp), intent(in) :: t                                        !< time [s]
    real(wp), intent(out) :: f(:)                                    !< (2n) the rates, in SI units
    real(wp), intent(inout) :: by_state(:, :)                        !< (2n,2n) gets derivatives, where they are wanted
    real(wp), intent(inout) :: by_parameters(:, :)                   !< (2n,parameters) gets derivatives, where they are wanted
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed

    if (order == 0) then
      call self%rates%find(x, values, t, f, err)
    else if (order == 1) then
      call self%rates%find(x, values, t, f, err, by_state)
    else
      call self%rates%find(x, values, t, f, err, by_state, by_parameters)
    end if
  end subroutine find_to_order

  !> The rates of a state with a clock: the phase grows with the frequency, and the radius is drawn to 1.
  subroutine find_with_clock(self, order, x, values, f, by_state, by_parameters, err)
    class(motion_equations_type), intent(inout) :: self              !< the equations, begun
    integer, intent(in) :: order                                     !< 0: rates alone; 1: derivatives by the state; 2: all
    real(wp), intent(in) :: x(:)                                     !< (states) in SI units
    real(wp), intent(in) :: values(:)                                !< (parameters) in the units of the data file
    real(wp), intent(out) :: f(:)                                    !< (states) the rates, in SI units
    real(wp), intent(inout) :: by_state(:, :)                        !< (states,states) gets derivatives, where they are wanted
    real(wp), intent(inout) :: by_parameters(:, :)                   !< (states,parameters) gets derivatives, where they are wanted
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    real(wp) :: phase, t, frequency, by_time(size(x) - 2), r2
    integer :: m, p

    m = size(x) - 2
    f = 0.0_wp
    call self%rates%take_values(values, self%from, err)
    if (.not. allocated(err)) call set_clock(self, values, err)
    if (allocated(err)) return
    frequency = turn/self%period
    phase = atan2(x(m + 2), x(m + 1))
    t = self%from + phase/frequency
    by_time = 0.0_wp
    if (order > 0) call differ_by_time(self, x(:m), values, t, by_time, err)
    if (.not. allocated(err)) &
      call find_to_order(self, order, x(:m), values, t, f(:m), by_state(:m, :m), by_parameters(:m, :), err)
    if (allocated(err)) return
    call turn_clock(x(m + 1), x(m + 2), frequency, f(m + 1:), by_state(m + 1:, m + 1:))
    r2 = x(m + 1)**2 + x(m + 2)**2
    if (r2 > 0.0_wp) then
      by_state(:m, m + 1) = -by_time*(x(m + 2)/(r2*frequency))
      by_state(:m, m + 2) = by_time*(x(m + 1)/(r2*frequency))
    end if
    do p = 1, size(values)
      by_parameters(:m, p) = by_parameters(:m, p) + by_time*(phase/turn*self%period_change(p))
      ! all rates of the clock are proportional to the frequency
      by_parameters(m + 1:, p) = -f(m + 1:)*(self%period_change(p)/self%period)
    end do
  end subroutine find_with_clock

  !> The rates of the clock and their derivatives.
  pure subroutine turn_clock(c, s, frequency, f, slopes)
    real(wp), intent(in) :: c               !< the first number, a cosine
    real(wp), intent(in) :: s               !< the second number, a sine
    real(wp), intent(in) :: frequency       !< [rad/s]
    real(wp), intent(out) :: f(2)           !< their rates
    real(wp), intent(out) :: slopes(2, 2)   !< derivatives of these by the numbers
    real(wp) :: pull

    pull = frequency/turn
    f(1) = -frequency*s + pull*c*(1.0_wp - c**2 - s**2)
    f(2) = frequency*c + pull*s*(1.0_wp - c**2 - s**2)
    slopes(:, 1) = [pull*(1.0_wp - 3.0_wp*c**2 - s**2), frequency - 2.0_wp*pull*c*s]
    slopes(:, 2) = [-frequency - 2.0_wp*pull*c*s, pull*(1.0_wp - c**2 - 3.0_wp*s**2)]
  end subroutine turn_clock

  !> The derivative of the rates by time, by differences of fourth order.
  subroutine differ_by_time(self, x, values, t, by_time, err)
    class(motion_equations_type), intent(inout) :: self    !< the equations
    real(wp), intent(in) :: x(:)                           !< (2n) state without the clock
    real(wp), intent(in) :: values(:)                      !< (parameters) in the units of the data file
    real(wp), intent(in) :: t                              !< the time [s]
    real(wp), intent(out) :: by_time(:)                    !< (2n) the derivative
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    real(wp), parameter :: weights(-2:2) = [1.0_wp, -8.0_wp, 0.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
    real(wp) :: f(size(x)), step
    integer :: i

    step = part_of_period*self%period
    by_time = 0.0_wp
    do i = -2, 2
      if (i == 0) cycle
      call self%rates%find(x, values, t + i*step, f, err)
      if (allocated(err)) return
      by_time = by_time + weights(i)*f/step
    end do
  end subroutine differ_by_time

  !> Set the clock for some values of the parameters.
  subroutine set_clock(self, values, err)
    class(motion_equations_type), intent(inout) :: self    !< the equations, at these values
    real(wp), intent(in) :: values(:)                      !< (parameters) in the units of the data file
    type(error_type), allocatable, intent(out) :: err      !< allocated if the laws have no common period
    class(model_type), allocatable :: beside
    type(law_period_type) :: laws
    real(wp) :: moved(size(values)), periods(2), step
    integer :: p, side

    if (allocated(self%clock_values)) then
      if (.not. any(abs(values - self%clock_values) > 0.0_wp)) return
    end if
    call read_clock(self, self%rates%model, err)
    do p = 1, size(values)
      step = part_of_value*max(abs(values(p)), tiny(step)/epsilon(step))
      do side = 1, 2
        if (allocated(err)) return
        moved = values
        moved(p) = values(p) + (2*side - 3)*step
        allocate (beside)
        call self%variable%at(moved, beside, err)
        if (.not. allocated(err)) call find_law_period(beside, laws, err)
        deallocate (beside)
        periods(side) = laws%period
      end do
      self%period_change(p) = 0.0_wp
      ! equal periods differ by round-off
      if (abs(periods(2) - periods(1)) > 8.0_wp*spacing(self%period) .and. laws%is_known) &
        self%period_change(p) = (periods(2) - periods(1))/(2.0_wp*step)
    end do
    if (.not. allocated(err)) self%clock_values = values
  end subroutine set_clock

  !> Read the period of the clock: that of the laws, or the one of &periodic where it is not known.
  subroutine read_clock(self, model, err)
    class(motion_equations_type), intent(inout) :: self    !< the equations; get the period
    class(model_type), intent(in) :: model                 !< the model
    type(error_type), allocatable, intent(out) :: err      !< allocated if the laws have no common period
    type(law_period_type) :: laws

    call find_law_period(model, laws, err)
    if (allocated(err)) return
    self%period = laws%period
    if (.not. laws%is_known) self%period = model%request%periodic%period
    if (.not. (laws%follows_time .and. self%period > 0.0_wp)) &
      call raise(err, exit_usage, 'no drive, load or motor has a known period, so that the equations need no clock')
  end subroutine read_clock

  !> Free all memory. Another mechanism can then be begun.
  subroutine close_equations(self)
    class(motion_equations_type), intent(inout) :: self   !< the equations

    if (associated(self%rates)) deallocate (self%rates)
    if (associated(self%variable)) deallocate (self%variable)
    if (allocated(self%first_state)) deallocate (self%first_state)
    if (allocated(self%clock_values)) deallocate (self%clock_values)
    self%has_clock = .false.
  end subroutine close_equations
end module mech9_motion_equations
