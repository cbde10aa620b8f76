!> A study as the library's users make it: the values of its parameters and its quantities as arrays over its runs.
module mech9_recorded_study
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, texts_of_one_length
  use mech9_result_units, only: name_parameters
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_run_maker, only: made_run_type
  use mech9_study_sums, only: study_sums_type
  use mech9_study_sink, only: study_sink_type
  use mech9_study_check, only: check_study
  use mech9_study_runs, only: study_runs_type
  use mech9_section_record, only: section_record_type
  use mech9_study_section, only: begin_section, add_points
  use mech9_study_threads, only: make_in_threads
  use mech9_varied_document, only: varied_document_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: recorded_study_type

  !> Runs that one thread may make before one that takes long is taken.
  integer, parameter :: runs_ahead = 64
  integer, parameter :: most_threads = 1024   !< the system may refuse more

  !> All runs of a study, in the order of their numbers.
  type :: recorded_study_type
    character(len=:), allocatable :: parameter_names(:)   !< (parameters)
    character(len=:), allocatable :: quantity_names(:)    !< (quantities)
    character(len=:), allocatable :: parameter_units(:)   !< (parameters) blank where none is known
    character(len=:), allocatable :: quantity_units(:)    !< (quantities)
    real(wp), allocatable :: parameters(:, :)             !< (parameters,runs) in the units of the data file
    real(wp), allocatable :: quantities(:, :)             !< (quantities,runs) in their units; not numbers where the run failed
    integer, allocatable :: exit_codes(:)                 !< (runs) 0, or the code with which the run failed
    class(section_record_type), allocatable, private :: points_of_runs   !< of the section; not allocated: there is none
  contains
    procedure :: section
    procedure :: make_kinematics
    procedure :: make_dynamics
  end type recorded_study_type

  !> Takes the runs of a study into memory.
  type, extends(study_sink_type) :: memory_sink_type
    type(recorded_study_type), pointer :: study => null()   !< gets the runs; not owned
    class(interruption_type), allocatable :: interruption   !< learns how far the study is
    integer :: taken = 0                                    !< runs that were taken
  contains
    procedure :: is_made
    procedure :: read_run
    procedure :: write_run
    procedure :: show_run
    procedure :: tell_progress
    procedure :: close => close_sink
  end type memory_sink_type

  !> Asked for by a study that nobody can stop.
  type, extends(interruption_type) :: no_interruption_type
  contains
    procedure :: is_wanted => never
  end type no_interruption_type

contains

  !> Make the study of a driven mechanism. A run that fails is no failure of the study. Fails with exit_usage where the mechanism
  !> has no &study, and with exit_interrupted where it is stopped; the arrays then have the runs that were made before.
  subroutine make_kinematics(self, mechanism, threads, err, interruption)
    class(recorded_study_type), intent(inout), target :: self        !< the study, made anew
    type(checked_mechanism_type), intent(in) :: mechanism            !< with parameters, quantities and a study
    integer, intent(in) :: threads                                   !< how many make the runs
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether it shall stop; each thread has a copy

    call make(self, mechanism, kinematics, threads, err, interruption)
  end subroutine make_kinematics

  !> Make the study of a mechanism that moves under forces. It fails as make_kinematics does.
  subroutine make_dynamics(self, mechanism, threads, err, interruption)
    class(recorded_study_type), intent(inout), target :: self        !< the study, made anew
    type(checked_mechanism_type), intent(in) :: mechanism            !< with parameters, quantities and a study
    integer, intent(in) :: threads                                   !< how many make the runs
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether it shall stop; each thread has a copy

    call make(self, mechanism, dynamics, threads, err, interruption)
  end subroutine make_dynamics

  !> Make the study of a program.
  subroutine make(self, mechanism, program, threads, err, interruption)
    type(recorded_study_type), intent(inout), target :: self         !< the study, made anew
    type(checked_mechanism_type), intent(in) :: mechanism            !< with parameters, quantities and a study
    integer, intent(in) :: program                                   !< kinematics or dynamics
    integer, intent(in) :: threads                                   !< how many make the runs
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether it shall stop; each thread has a copy
    type(model_type) :: model
    type(varied_document_type) :: variable
    type(quantity_record_type) :: quantities
    integer :: makers

    call allocate_arrays(self, model, 0)
    call mechanism%take_request(program, model, err)
    if (allocated(err)) return
    ! no file gets the columns of the runs
    model%request%output%hdf5_runs = .false.
    call check_study(model, quantities, err)
    if (.not. allocated(err)) then
      call mechanism%take_variable(program, variable)
      call allocate_arrays(self, model, model%request%study%runs)
      call take_units(self, model, quantities)
      makers = max(1, min(threads, model%request%study%runs, most_threads))
      if (model%request%study%carries()) makers = 1
      call begin_section(model, self%points_of_runs, err)
      if (present(interruption)) then
        call make_runs(self, model, variable, makers, interruption, err)
      else
        call make_runs(self, model, variable, makers, no_interruption_type(), err)
      end if
    end if
    call mechanism%point_at(err)
  end subroutine make

  !> Make all runs.
  subroutine make_runs(self, model, variable, threads, interruption, err)
    type(recorded_study_type), intent(inout), target :: self         !< the study, with room for its runs
    type(model_type), intent(in) :: model                            !< the model with the values of the data file
    type(varied_document_type), intent(in) :: variable               !< the model as a function of its parameters
    integer, intent(in) :: threads                                   !< how many make the runs
    class(interruption_type), intent(in) :: interruption             !< is asked whether the study shall stop
    type(error_type), allocatable, intent(out) :: err                !< allocated if it was stopped
    type(memory_sink_type), target :: sink
    type(study_runs_type) :: runs

    sink%study => self
    allocate (sink%interruption, source=interruption)
    call runs%begin(model, sink, runs_ahead*threads, .false., interruption)
    call make_in_threads(model, variable, threads, interruption, runs)
    call runs%finish(err)
    self%parameters = self%parameters(:, :sink%taken)
    self%quantities = self%quantities(:, :sink%taken)
    self%exit_codes = self%exit_codes(:sink%taken)
  end subroutine make_runs

  !> Make room for runs.
  subroutine allocate_arrays(self, model, runs)
    type(recorded_study_type), intent(inout) :: self       !< the study
    type(model_type), intent(in) :: model                  !< with parameters and quantities
    integer, intent(in) :: runs                            !< how many
    type(string_type), allocatable :: parameters(:), quantities(:)
    integer :: i, n_parameters, n_quantities

    n_parameters = 0
    n_quantities = 0
    if (allocated(model%parameters)) n_parameters = size(model%parameters)
    if (allocated(model%request%quantities)) n_quantities = size(model%request%quantities)
    allocate (parameters(n_parameters), quantities(n_quantities))
    do i = 1, n_parameters
      parameters(i)%text = model%parameters(i)%name
    end do
    do i = 1, n_quantities
      quantities(i)%text = model%request%quantities(i)%name
    end do
    call texts_of_one_length(parameters, self%parameter_names)
    call texts_of_one_length(quantities, self%quantity_names)
    self%parameter_units = spread(' ', 1, n_parameters)
    self%quantity_units = spread(' ', 1, n_quantities)
    if (allocated(self%parameters)) deallocate (self%parameters, self%quantities, self%exit_codes)
    allocate (self%parameters(n_parameters, runs), self%quantities(n_quantities, runs), self%exit_codes(runs))
    self%parameters = ieee_value(1.0_wp, ieee_quiet_nan)
    self%quantities = ieee_value(1.0_wp, ieee_quiet_nan)
    self%exit_codes = 0
  end subroutine allocate_arrays

  !> Take the units of parameters and quantities.
  subroutine take_units(self, model, quantities)
    type(recorded_study_type), intent(inout) :: self         !< the study
    type(model_type), intent(in) :: model                    !< with parameters
    type(quantity_record_type), intent(in) :: quantities     !< knows the units of their columns
    type(string_type), allocatable :: parameters(:), parameter_units(:)
    type(string_type) :: quantity_units(size(self%quantity_units))
    integer :: i

    call name_parameters(model%mechanism, model%parameters, parameters, parameter_units)
    do i = 1, size(quantity_units)
      quantity_units(i)%text = trim(quantities%unit_of(i))
    end do
    call texts_of_one_length(parameter_units, self%parameter_units)
    call texts_of_one_length(quantity_units, self%quantity_units)
  end subroutine take_units

  !> The points of the sections of all runs, where the mechanism has a group &section: columns run, those of the parameters, point, t and
  !> those of the runs. There are no columns without a section.
  subroutine section(self, names, points, units)
    class(recorded_study_type), intent(in) :: self                      !< the study
    character(len=:), allocatable, intent(out) :: names(:)              !< (columns)
    real(wp), allocatable, intent(out) :: points(:, :)                  !< (columns,points) in the units of the columns
    character(len=:), allocatable, intent(out), optional :: units(:)    !< (columns)
    type(string_type) :: none(0)

    if (allocated(self%points_of_runs)) then
      points = self%points_of_runs%points(:, :self%points_of_runs%count)
      names = self%points_of_runs%names
      if (present(units)) units = self%points_of_runs%units
    else
      allocate (points(0, 0))
      call texts_of_one_length(none, names)
      if (present(units)) call texts_of_one_length(none, units)
    end if
  end subroutine section

  !> No run was made before.
  logical function is_made(self, place)
    class(memory_sink_type), intent(inout) :: self         !< takes the runs
    integer, intent(in) :: place                           !< unused

    is_made = .false.
  end function is_made

  !> No run was made before.
  subroutine read_run(self, place, run)
    class(memory_sink_type), intent(inout) :: self         !< takes the runs
    integer, intent(in) :: place                           !< unused
    type(made_run_type), intent(inout) :: run              !< unchanged
  end subroutine read_run

  !> Runs are taken when their turn comes.
  subroutine write_run(self, place, run, err)
    class(memory_sink_type), intent(inout) :: self         !< takes the runs
    integer, intent(in) :: place                           !< unused
    type(made_run_type), intent(in) :: run                 !< unused
    type(error_type), allocatable, intent(out) :: err      !< never allocated
  end subroutine write_run

  !> Take the next run.
  subroutine show_run(self, run, err)
    class(memory_sink_type), intent(inout) :: self         !< takes the runs
    type(made_run_type), intent(in) :: run                 !< the run
    type(error_type), allocatable, intent(out) :: err      !< never allocated

    self%taken = self%taken + 1
    self%study%parameters(:, self%taken) = run%values
    self%study%quantities(:, self%taken) = run%quantities
    self%study%exit_codes(self%taken) = run%exit_code
    if (allocated(self%study%points_of_runs)) call add_points(self%study%points_of_runs, run)
  end subroutine show_run

  !> Tell how far the study is.
  subroutine tell_progress(self, done, read, sums)
    class(memory_sink_type), intent(inout) :: self         !< takes the runs
    real(wp), intent(in) :: done                           !< share of the runs that are made, from 0 to 1
    real(wp), intent(in) :: read                           !< unused
    type(study_sums_type), intent(in) :: sums              !< unused

    call self%interruption%tell(done)
  end subroutine tell_progress

  !> Nothing is to be closed.
  subroutine close_sink(self, err)
    class(memory_sink_type), intent(inout) :: self         !< takes the runs
    type(error_type), allocatable, intent(out) :: err      !< never allocated
  end subroutine close_sink

  !> A stop is never wanted.
  logical function never(self)
    class(no_interruption_type), intent(in) :: self   !< the interruption

    never = .false.
  end function never
end module mech9_recorded_study
