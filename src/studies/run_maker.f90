!> Runs of a study, made from their numbers. A maker shares nothing with others: each thread and each process has its own. Runs that
!> can be made side by side always are, one of them alone, too, so that a run has the same bits in any company.
module mech9_run_maker
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_done, exit_singular
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_parameter, only: parameter_type
  use mech9_study, only: study_type
  use mech9_variable_model, only: variable_model_type
  use mech9_study_values, only: values_of_run
  use mech9_simulation, only: interruption_type
  use mech9_columns, only: columns_type
  use mech9_design_run, only: run_design, run_ending_type, columns_of_runs
  use mech9_exponents, only: exponents_found_type, find_exponents
  use mech9_end_class, only: find_cycle, find_rest
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning
  use mech9_lane_group, only: lanes
  use mech9_lane_runs, only: lane_runs_type, lane_failure_type
  implicit none
  private
  public :: made_run_type, run_maker_type, most_runs

  !> Runs that are made at once at most.
  integer, parameter :: most_runs = lanes

  !> A run that is made.
  type :: made_run_type
    integer :: number = 0                           !< in the whole study, from 1
    real(wp), allocatable :: values(:)              !< (parameters) in the units of the file
    real(wp), allocatable :: quantities(:)          !< (quantities) NaN where the run failed
    real(wp), allocatable :: rows(:, :)             !< (columns,outputs) where they are kept; NaN from a failure on
    real(wp), allocatable :: points(:, :)           !< (columns,points) of the section, where there is one
    real(wp) :: range(2) = [huge(1.0_wp), -huge(1.0_wp)]   !< least and greatest difference from the value of the section
    real(wp), allocatable :: cycle(:, :)            !< (2 M,points) of the motion to which it goes, where classes are wanted [rad, m]
    real(wp), allocatable :: unit(:)                !< (2 M) that counts as one of its numbers [rad, m]
    logical, allocatable :: turns(:)                !< (2 M) an angle of which whole turns do not count
    integer :: exit_code = exit_done                !< with which a single run of these values ends
    type(error_type), allocatable :: failure        !< of a run that failed; not explained yet
  end type made_run_type

  type :: run_maker_type
    private
    type(study_type) :: study
    type(parameter_type), allocatable :: parameters(:)
    class(variable_model_type), allocatable :: varied            !< the model as a function of its parameters
    integer :: n_quantities = 0
    integer :: n_taken = 0                                       !< of these, the first ones: those that the motion itself has
    logical :: makes_motion = .true.                             !< something is wanted of the motion beside its exponents
    integer :: n_columns = 0                                     !< of the rows that are kept; 0: none are kept
    integer :: n_outputs = 0                                     !< rows of a run
    type(run_ending_type) :: ending                              !< of the last run, where it may be carried on
    type(lane_runs_type), allocatable :: side_by_side            !< makes several runs at once, where it is allocated
  contains
    procedure :: begin
    procedure :: make
    procedure :: make_several
    procedure :: at_once
    procedure :: made_at_once
    procedure :: shape_of_rows
  end type run_maker_type

contains

  !> Prepare a maker for the runs of a study.
  subroutine begin(self, model, varied, one_by_one)
    class(run_maker_type), intent(out) :: self              !< the maker
    type(model_type), intent(in) :: model                   !< the model with the values of the data file
    class(variable_model_type), intent(in) :: varied        !< the model as a function of its parameters; copied
    logical, intent(in), optional :: one_by_one             !< each run is followed alone, for comparison; not unless given
    type(columns_type) :: columns
    logical :: alone

    self%study = model%request%study
    self%parameters = model%parameters
    self%n_quantities = size(model%request%quantities)
    self%n_taken = self%n_quantities - merge(1, 0, self%study%classes) - 2*self%study%exponents
    self%makes_motion = self%study%exponents == 0 .or. self%n_taken > 0 .or. self%study%classes .or. self%study%carries() .or. &
                        model%request%section%is_wanted .or. model%request%output%hdf5_runs
    allocate (self%varied, source=varied)
    alone = self%study%exponents > 0 .or. self%study%carries() .or. self%study%classes .or. model%request%section%is_wanted .or. &
            model%request%output%hdf5_runs
    if (present(one_by_one)) alone = alone .or. one_by_one
    if (.not. alone) then
      allocate (self%side_by_side)
      call self%side_by_side%begin(model)
      if (.not. self%side_by_side%used) deallocate (self%side_by_side)
    end if
    if (.not. model%request%output%hdf5_runs) return
    call columns_of_runs(model, columns)
    self%n_columns = columns%width()
    self%n_outputs = model%request%time%intervals + 1
  end subroutine begin

  !> How many columns and outputs the rows of a run have; 0 where they are not kept.
  pure function shape_of_rows(self)
    class(run_maker_type), intent(in) :: self   !< the maker
    integer :: shape_of_rows(2)

    shape_of_rows = [self%n_columns, self%n_outputs]
  end function shape_of_rows

  !> How many runs are made at once at most.
  pure integer function at_once(self)
    class(run_maker_type), intent(in) :: self   !< the maker

    at_once = merge(most_runs, 1, allocated(self%side_by_side))
  end function at_once

  !> How many runs were made side by side so far.
  pure integer function made_at_once(self)
    class(run_maker_type), intent(in) :: self   !< the maker

    made_at_once = 0
    if (allocated(self%side_by_side)) made_at_once = self%side_by_side%made
  end function made_at_once

  !> Make a run. Its numbers depend on the number of the run alone, unless the study carries states on: then the runs before it were made
  !> by this maker, and it begins where the last one ended; after a failure it begins as the data file says.
  subroutine make(self, number, run, interruption)
    class(run_maker_type), intent(inout) :: self   !< the maker
    integer, intent(in) :: number                  !< of the run in the whole study, from 1
    type(made_run_type), intent(out) :: run        !< the run, which may have failed
    class(interruption_type), intent(inout), optional :: interruption   !< is asked whether the run shall stop
    type(made_run_type) :: runs(1)

    call self%make_several([number], runs, interruption)
    run = runs(1)
  end subroutine make

  !> Make runs: side by side as far as this is possible, the others one by one.
  subroutine make_several(self, numbers, runs, interruption)
    class(run_maker_type), intent(inout) :: self       !< the maker
    integer, intent(in) :: numbers(:)                  !< of the runs in the whole study, from 1; at most `at_once`
    type(made_run_type), intent(inout) :: runs(:)      !< get the runs, which may have failed
    class(interruption_type), intent(inout), optional :: interruption   !< is asked whether the runs shall stop
    logical :: done(size(numbers))
    integer :: i

    done = .false.
    if (allocated(self%side_by_side)) call make_side_by_side(self, numbers, runs, done, interruption)
    do i = 1, size(numbers)
      if (.not. done(i)) call make_alone(self, numbers(i), runs(i), interruption)
    end do
  end subroutine make_several

  !> Make runs side by side, as far as this is possible.
  subroutine make_side_by_side(self, numbers, runs, done, interruption)
    class(run_maker_type), intent(inout) :: self       !< the maker
    integer, intent(in) :: numbers(:)                  !< of the runs in the whole study, from 1
    type(made_run_type), intent(inout) :: runs(:)      !< get the runs that are made
    logical, intent(out) :: done(:)                    !< the run is made, or has failed
    class(interruption_type), intent(inout), optional :: interruption   !< is asked whether the runs shall stop
    type(model_type), allocatable :: models(:)
    type(lane_failure_type) :: failures(size(numbers))
    type(error_type), allocatable :: err
    real(wp) :: values(size(self%parameters), size(numbers)), quantities(self%n_quantities, size(numbers))
    integer :: i

    allocate (models(size(numbers)))
    do i = 1, size(numbers)
      if (present(interruption)) call interruption%begin_run(numbers(i))
      call values_of_run(self%study, self%parameters, numbers(i), values(:, i))
      call self%varied%at(values(:, i), models(i), err)
      done(i) = .not. allocated(err)
    end do
    call self%side_by_side%make(models, quantities, done, failures, interruption)
    do i = 1, size(numbers)
      if (allocated(failures(i)%err)) quantities(:, i) = ieee_value(1.0_wp, ieee_quiet_nan)
      if (.not. (done(i) .or. allocated(failures(i)%err))) cycle
      call take_made(numbers(i), values(:, i), quantities(:, i), runs(i))
      if (done(i)) cycle
      runs(i)%exit_code = failures(i)%err%code
      call move_alloc(failures(i)%err, runs(i)%failure)
      done(i) = .true.
    end do
  end subroutine make_side_by_side

  !> Take a run that was made beside others.
  subroutine take_made(number, values, quantities, run)
    integer, intent(in) :: number              !< of the run in the whole study, from 1
    real(wp), intent(in) :: values(:)          !< (parameters) in the units of the file
    real(wp), intent(in) :: quantities(:)      !< (quantities) in their units
    type(made_run_type), intent(out) :: run    !< the run

    run%number = number
    run%values = values
    run%quantities = quantities
  end subroutine take_made

  !> Make a run by itself.
  subroutine make_alone(self, number, run, interruption)
    class(run_maker_type), intent(inout) :: self   !< the maker
    integer, intent(in) :: number                  !< of the run in the whole study, from 1
    type(made_run_type), intent(out) :: run        !< the run, which may have failed
    class(interruption_type), intent(inout), optional :: interruption   !< is asked whether the run shall stop
    class(model_type), allocatable, target :: model

    allocate (model)
    run%number = number
    if (present(interruption)) call interruption%begin_run(number)
    allocate (run%values(size(self%parameters)))
    allocate (run%quantities(self%n_quantities), source=ieee_value(1.0_wp, ieee_quiet_nan))
    call values_of_run(self%study, self%parameters, number, run%values)
    if (self%n_columns > 0) &
      allocate (run%rows(self%n_columns, self%n_outputs), source=ieee_value(1.0_wp, ieee_quiet_nan))
    call self%varied%at(run%values, model, run%failure)
    if (.not. allocated(run%failure)) then
      if (self%study%carries()) call begin_at_ending(self%ending, model)
      if (self%study%exponents > 0) call take_exponents(self, model, run, interruption)
      if (self%makes_motion .and. .not. allocated(run%failure)) &
        call run_design(model, run%quantities(:self%n_taken), run%failure, run%rows, interruption, self%ending)
    end if
    if (.not. allocated(run%failure)) then
      if (self%study%classes) call find_end(self%ending, model, run)
      if (allocated(self%ending%points)) call move_alloc(self%ending%points, run%points)
      run%range = self%ending%range
      return
    end if
    self%ending = run_ending_type()
    run%exit_code = run%failure%code
    run%quantities = ieee_value(1.0_wp, ieee_quiet_nan)
  end subroutine make_alone

  !> Take the exponents of a motion. A run without one of them fails.
  subroutine take_exponents(self, model, run, interruption)
    class(run_maker_type), intent(in) :: self       !< the maker
    type(model_type), intent(in) :: model           !< the model of the run
    type(made_run_type), intent(inout) :: run       !< gets them, or a failure
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the run shall stop
    type(exponents_found_type) :: found

    call find_exponents(model, self%study%exponents, found, run%failure, interruption)
    if (allocated(run%failure)) return
    associate (count => self%study%exponents, before => self%n_taken)
      run%quantities(before + 1:before + count) = found%exponents
      run%quantities(before + count + 1:before + 2*count) = found%errors
      if (found%lost > 0) call raise(run%failure, exit_singular, 'exponent '//to_text(count - found%lost + 1)//' is minus '// &
                                     'infinity, since events make neighbouring motions the same; ask for fewer of them')
    end associate
  end subroutine take_exponents

  !> Find to what a motion goes.
  subroutine find_end(ending, model, run)
    type(run_ending_type), intent(in) :: ending    !< of the run
    type(model_type), intent(in) :: model          !< its model
    type(made_run_type), intent(inout) :: run      !< gets the cycle
    type(pair_axes_type), allocatable :: axes(:)
    integer :: m

    m = size(ending%position)
    axes = pair_axes(model%mechanism%pairs)
    run%unit = ending%unit
    allocate (run%turns(2*m), source=.false.)
    run%turns(:m) = axes%kind == turning
    if (size(ending%states, 2) > 1) then
      call find_cycle(ending%states, ending%unit, run%turns, run%cycle)
    else
      call find_rest(ending%states(:m, 1), ending%states(m + 1:, 1), ending%unit(:m), run%cycle)
    end if
  end subroutine find_end

  !> Let a model begin in the state in which the last run ended, if there was one.
  subroutine begin_at_ending(ending, model)
    type(run_ending_type), intent(in) :: ending    !< of the last run
    type(model_type), intent(inout) :: model       !< gets it as its start

    if (.not. allocated(ending%position)) return
    associate (initial => model%problem%initial, independent => model%problem%partition%independent())
      initial%position = ending%position
      initial%position_given = .true.
      initial%velocity = merge(ending%velocity, initial%velocity, independent)
      initial%velocity_given = initial%velocity_given .or. independent
    end associate
  end subroutine begin_at_ending
end module mech9_run_maker
