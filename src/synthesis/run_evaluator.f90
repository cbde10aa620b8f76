!> The quantities of a design from a run, with their derivatives: exact where they are known, otherwise by differences of runs.
module mech9_run_evaluator
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_is_finite, ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_objective, only: quantity_objective, quantity_limit
  use mech9_variable_model, only: variable_model_type
  use mech9_simulation, only: interruption_type
  use mech9_design_run, only: run_design, find_design_gradient
  implicit none
  private
  public :: run_evaluator_type, new_run_evaluator, used_quantities

  !> Makes the runs of designs.
  type :: run_evaluator_type
    private
    class(variable_model_type), allocatable :: variable   !< the model as a function of its parameters
    integer, allocatable :: used(:)                       !< numbers of the quantities of objectives and limits
    integer, allocatable :: varied(:)                     !< numbers of the parameters that are varied
    real(wp), allocatable :: low(:)                       !< least value of each
    real(wp), allocatable :: high(:)                      !< largest value of each
    class(interruption_type), allocatable :: interruption !< is asked whether a run shall stop
  contains
    procedure :: find_numbers
    procedure :: find_gradient
    procedure :: judge_gradient
  end type run_evaluator_type

  !> Step of differences, as a part of the range of a parameter: round-off and truncation are then about equal.
  real(wp), parameter :: step_part = 3.0e-5_wp

contains

  !> Prepare an evaluator. It has a copy of the model, so that each thread can have a copy.
  subroutine new_run_evaluator(variable, model, interruption, evaluator)
    class(variable_model_type), intent(in) :: variable      !< the model as a function of its parameters; copied
    type(model_type), intent(in) :: model                   !< the model with its objectives and limits
    class(interruption_type), intent(in) :: interruption    !< is asked whether a run shall stop; copied
    type(run_evaluator_type), intent(out) :: evaluator      !< ready
    integer :: i

    allocate (evaluator%variable, source=variable)
    allocate (evaluator%interruption, source=interruption)
    evaluator%used = used_quantities(model)
    evaluator%varied = pack([(i, i=1, size(model%parameters))], model%parameters%has_range)
    evaluator%low = model%parameters(evaluator%varied)%low
    evaluator%high = model%parameters(evaluator%varied)%high
  end subroutine new_run_evaluator

  !> The numbers of the quantities that objectives and limits name.
  pure function used_quantities(model) result(used)
    type(model_type), intent(in) :: model   !< the model
    integer, allocatable :: used(:)
    integer :: i

    associate (objectives => model%request%objectives, limits => model%request%limits)
      used = pack([(i, i=1, size(model%request%quantities))], &
                  [(any(objectives%kind == quantity_objective .and. objectives%quantity == i) .or. &
                    any(limits%kind == quantity_limit .and. limits%quantity == i), i=1, size(model%request%quantities))])
    end associate
  end function used_quantities

  !> The quantities of a design over a run that starts in an assembly.
  subroutine find_numbers(self, values, q, numbers, has_value)
    class(run_evaluator_type), intent(inout) :: self   !< makes the run
    real(wp), intent(in) :: values(:)                  !< of all parameters, in the units of the data file
    real(wp), intent(in) :: q(:)                       !< (M) coordinates at the start of the run [rad, m]
    real(wp), intent(out) :: numbers(:)                !< (quantities) in the units of the results; 0 where nothing uses them
    logical, intent(out) :: has_value                  !< all numbers exist
    real(wp) :: taken(size(self%used))

    numbers = 0.0_wp
    call take_numbers(self, values, q, taken, has_value)
    if (has_value) numbers(self%used) = taken
  end subroutine find_numbers

  !> The derivatives of the quantities of a design by all parameters. Those that are not known are differences of runs.
  subroutine find_gradient(self, values, q, gradient, has_value)
    class(run_evaluator_type), intent(inout) :: self   !< makes the runs
    real(wp), intent(in) :: values(:)                  !< of all parameters, in the units of the data file
    real(wp), intent(in) :: q(:)                       !< (M) coordinates at the start of the run [rad, m]
    real(wp), intent(out) :: gradient(:, :)            !< (parameters,quantities) 0 where nothing uses them, and for parameters held
    logical, intent(out) :: has_value                  !< all derivatives exist
    real(wp) :: slopes(size(values), size(self%used))
    type(error_type), allocatable :: failure
    logical :: unknown(size(values))

    gradient = 0.0_wp
    call take_gradient(self, values, q, slopes, failure)
    unknown = any(ieee_is_nan(slopes), dim=2)
    has_value = .true.
    if (any(unknown(self%varied))) call take_differences(self, values, q, unknown, slopes, has_value)
    where (ieee_is_nan(slopes)) slopes = 0.0_wp
    gradient(:, self%used) = slopes
  end subroutine find_gradient

  !> Find whether derivatives of the quantities are known. Fails with the reason where a design has quantities, and its run with
  !> derivatives fails.
  subroutine judge_gradient(self, values, q, known, err)
    class(run_evaluator_type), intent(inout) :: self    !< makes the runs
    real(wp), intent(in) :: values(:)                   !< of all parameters, in the units of the data file
    real(wp), intent(in) :: q(:)                        !< (M) coordinates at the start of the run [rad, m]
    logical, intent(out) :: known                       !< the derivatives by all varied parameters, or the design has no quantities
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    real(wp) :: slopes(size(values), size(self%used)), numbers(size(self%used))
    logical :: has_value

    call take_gradient(self, values, q, slopes, err)
    known = .not. any(ieee_is_nan(slopes(self%varied, :)))
    if (.not. allocated(err)) return
    call take_numbers(self, values, q, numbers, has_value)
    known = .not. has_value
    if (known) deallocate (err)
  end subroutine judge_gradient

  !> The model of a design that starts in an assembly.
  subroutine make_model(self, values, q, model, made)
    class(run_evaluator_type), intent(inout) :: self   !< makes the run
    real(wp), intent(in) :: values(:)                  !< of all parameters
    real(wp), intent(in) :: q(:)                       !< (M) coordinates at the start [rad, m]
    type(model_type), intent(out) :: model             !< gets the start, and the quantities that are used
    logical, intent(out) :: made                       !< there is such a model
    type(error_type), allocatable :: err

    call self%variable%at(values, model, err)
    made = .not. allocated(err)
    if (.not. made) return
    model%request%quantities = model%request%quantities(self%used)
    model%request%output%sensitivities = .false.
    model%request%output%gradients = .false.
    associate (given => model%problem%partition%independent())
      where (.not. given) model%problem%initial%position = q
      model%problem%initial%position_given = model%problem%initial%position_given .or. .not. given
    end associate
  end subroutine make_model

  !> The quantities of a design.
  subroutine take_numbers(self, values, q, numbers, has_value)
    class(run_evaluator_type), intent(inout) :: self   !< makes the run
    real(wp), intent(in) :: values(:)                  !< of all parameters
    real(wp), intent(in) :: q(:)                       !< (M) coordinates at the start [rad, m]
    real(wp), intent(out) :: numbers(:)                !< (used) the quantities
    logical, intent(out) :: has_value                  !< they exist
    type(model_type), target :: model
    type(error_type), allocatable :: err

    numbers = 0.0_wp
    call make_model(self, values, q, model, has_value)
    if (.not. has_value) return
    call run_design(model, numbers, err, interruption=self%interruption)
    has_value = .not. allocated(err)
    if (has_value) has_value = all(ieee_is_finite(numbers))
  end subroutine take_numbers

  !> The derivatives of the quantities as far as they are known.
  subroutine take_gradient(self, values, q, slopes, failure)
    class(run_evaluator_type), intent(inout) :: self   !< makes the run
    real(wp), intent(in) :: values(:)                  !< of all parameters
    real(wp), intent(in) :: q(:)                       !< (M) coordinates at the start [rad, m]
    real(wp), intent(out) :: slopes(:, :)              !< (parameters,used) NaN where a derivative is not known
    type(error_type), allocatable, intent(out) :: failure   !< of the run with derivatives, if it failed
    type(model_type), target :: model
    real(wp) :: numbers(size(self%used))
    logical :: made

    slopes = ieee_value(1.0_wp, ieee_quiet_nan)
    call make_model(self, values, q, model, made)
    if (.not. made) return
    model%request%output%gradients = .true.
    call find_design_gradient(model, self%variable, numbers, slopes, failure, self%interruption)
    if (allocated(failure)) slopes = ieee_value(1.0_wp, ieee_quiet_nan)
  end subroutine take_gradient

  !> Differences of the quantities by the varied parameters whose derivatives are not known.
  subroutine take_differences(self, values, q, unknown, slopes, has_value)
    class(run_evaluator_type), intent(inout) :: self   !< makes the runs
    real(wp), intent(in) :: values(:)                  !< of all parameters
    real(wp), intent(in) :: q(:)                       !< (M) coordinates at the start [rad, m]
    logical, intent(in) :: unknown(:)                  !< (parameters) a derivative by this parameter is not known
    real(wp), intent(inout) :: slopes(:, :)            !< (parameters,used) gets the differences
    logical, intent(out) :: has_value                  !< they exist
    real(wp) :: step, moved(size(values))
    real(wp), dimension(size(self%used)) :: numbers, difference
    real(wp) :: beside(size(self%used), 2)
    integer :: i, k
    logical :: one_sided

    call take_numbers(self, values, q, numbers, has_value)
    if (.not. has_value) return
    do i = 1, size(self%varied)
      k = self%varied(i)
      if (.not. unknown(k)) cycle
      step = step_part*(self%high(i) - self%low(i))
      ! values stay in their range
      one_sided = values(k) - step < self%low(i) .or. values(k) + step > self%high(i)
      if (values(k) + 2.0_wp*step > self%high(i)) step = -step
      moved = values
      moved(k) = values(k) + step
      call take_numbers(self, moved, q, beside(:, 1), has_value)
      moved(k) = merge(values(k) + 2.0_wp*step, values(k) - step, one_sided)
      if (has_value) call take_numbers(self, moved, q, beside(:, 2), has_value)
      if (.not. has_value) return
      difference = (beside(:, 1) - beside(:, 2))/(2.0_wp*step)
      if (one_sided) difference = (4.0_wp*beside(:, 1) - 3.0_wp*numbers - beside(:, 2))/(2.0_wp*step)
      where (ieee_is_nan(slopes(k, :))) slopes(k, :) = difference
    end do
  end subroutine take_differences
end module mech9_run_evaluator
