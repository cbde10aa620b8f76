!> A data file as a program carries it out: its groups, the errors in them, its model, and the model as a function of its parameters.
module mech9_data_file
  use mech9_program_kind, only: kinematics
  use mech9_error, only: error_type, exit_file
  use mech9_text, only: string_type
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_source, only: source_from_text
  use mech9_parser, only: read_document, parse_document
  use mech9_setting, only: apply_setting
  use mech9_drive_reader, only: files_of_groups
  use mech9_reader, only: read_model
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_force_record, only: reacting_pairs
  use mech9_columns, only: columns_type
  use mech9_quantity_record, only: quantity_record_type
  use mech9_design_run, only: columns_of_runs
  use mech9_study_check, only: check_study
  use mech9_run, only: run_type
  use mech9_run_outcome, only: run_outcome_type
  use mech9_periodic, only: periodic_found_type, find_periodic
  use mech9_periodic_run, only: take_periodic, start_periodic
  use mech9_simulation, only: interruption_type
  use mech9_law_times, only: check_times_of_laws
  use mech9_choice_check, only: judge_choice_of
  use mech9_made_check, only: refuse_other_mechanism
  use mech9_result_units, only: name_parameters
  use mech9_model, only: model_type
  implicit none
  private
  public :: data_file_type

  !> It must not be copied.
  type :: data_file_type
    character(len=:), allocatable :: path          !< of the file, as the command line names it
    character(len=:), allocatable :: command_line  !< of the program that carries it out, behind the program's name
    type(document_type) :: document          !< its groups and items, with the changes by --set
    type(diagnostics_type) :: diagnostics    !< the errors, and the texts that they stand in; the first text is the data file
    type(diagnostics_type) :: choice         !< errors of the choice of independent coordinates, where the model cannot be read
    type(model_type) :: model                !< of use only without errors
    type(varied_document_type) :: variable   !< the model as a function of its parameters, once it is prepared
    class(run_type), allocatable :: run      !< its run, which refers to the model; not allocated before it begins
    type(run_outcome_type) :: outcome        !< rows of the run, and the time for them
    type(periodic_found_type), allocatable :: periodic   !< periodic motions, of which the run records the first one
    type(quantity_record_type) :: quantities   !< those of the runs of a study, with their columns, once it is judged
    type(columns_type) :: run_columns          !< of the runs of a study, once these are found
  contains
    procedure :: open => open_file
    procedure :: read => read_whole
    procedure :: read_text
    procedure :: assemble
    procedure :: prepare_variable
    procedure :: check_times
    procedure :: close_run
    procedure :: judge_study
    procedure :: find_periodic => find_periodic_motions
    procedure :: fail
    procedure :: failed
    procedure :: code
    procedure :: list_files
    procedure :: list_parameters
    procedure :: reacting_pairs => pairs_of_forces
    procedure :: report
    procedure :: report_failure
  end type data_file_type

contains

  !> Read the groups of a file, and change them by settings. Errors are kept.
  subroutine open_file(self, path, program, settings)
    class(data_file_type), intent(inout) :: self    !< a new one
    character(len=*), intent(in) :: path            !< of the file
    integer, intent(in) :: program                  !< kinematics or dynamics
    type(string_type), intent(in) :: settings(:)    !< arguments of --set
    integer :: i

    self%model%program = program
    self%path = path
    call read_document(path, self%document, self%diagnostics)
    if (self%diagnostics%code() == exit_file) return
    do i = 1, size(settings)
      call apply_setting(self%document, settings(i)%text, self%diagnostics)
    end do
  end subroutine open_file

  !> Read the model. Errors are kept; where a driven mechanism has some, its choice of independent coordinates is judged all the same.
  subroutine read_whole(self)
    class(data_file_type), intent(inout) :: self    !< the file
    logical :: legible
    integer :: program

    legible = .not. self%failed()
    program = self%model%program
    call read_model(self%document, program, self%model, self%diagnostics)
    if (.not. self%failed()) call refuse_other_mechanism(self%document, self%diagnostics)
    if (self%failed() .and. legible .and. program == kinematics) &
      call judge_choice_of(self%document, self%diagnostics, self%choice)
  end subroutine read_whole

  !> Read the model of a text that has the form of a data file. Errors are kept.
  subroutine read_text(self, name, text, program)
    class(data_file_type), intent(inout) :: self    !< a new one
    character(len=*), intent(in) :: name            !< of the file that the text may become: files that it names are sought beside it
    character(len=*), intent(in) :: text            !< its groups
    integer, intent(in) :: program                  !< kinematics or dynamics

    call parse_document(source_from_text(name, text), self%document, self%diagnostics)
    call read_model(self%document, program, self%model, self%diagnostics)
  end subroutine read_text

  !> Assemble the mechanism at the start of its run, which begins with that. Fails where it cannot be closed.
  subroutine assemble(self, err)
    class(data_file_type), intent(inout) :: self         !< the file, read without errors
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    allocate (self%run)
    call self%run%motion%assemble(self%model, err)
  end subroutine assemble

  !> Prepare the model as a function of its parameters.
  subroutine prepare_variable(self)
    class(data_file_type), intent(inout) :: self    !< the file, read without errors

    call new_varied_document(self%document, self%diagnostics%sources, self%model%program, self%variable)
  end subroutine prepare_variable

  !> Keep an error for each law of time that has no value at the start or at the end of the run.
  subroutine check_times(self, with_loads)
    class(data_file_type), intent(inout) :: self    !< the file, read without errors
    logical, intent(in) :: with_loads               !< loads and motors act in this run, too

    call check_times_of_laws(self%model, with_loads, self%diagnostics)
  end subroutine check_times

  !> Find periodic motions, and begin a run over one period of the first one, which is then assembled. Fails with exit_data where there
  !> can be none, with exit_assembly where none was found; motions that were found before an interruption are kept.
  subroutine find_periodic_motions(self, interruption, err)
    class(data_file_type), intent(inout), target :: self     !< the file, read without errors
    class(interruption_type), intent(in) :: interruption     !< is asked whether the search shall stop
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed

    allocate (self%run, self%periodic)
    call find_periodic(self%model, self%periodic, err, interruption)
    if (allocated(err)) return
    call take_periodic(self%periodic%motions(1), self%model)
    call self%run%motion%assemble(self%model, err)
    if (.not. allocated(err)) call start_periodic(self%periodic%motions(1), self%model, self%run%motion, err)
  end subroutine find_periodic_motions

  !> Judge whether a study can be carried out, and find the columns of its quantities. Fails as check_study does.
  subroutine judge_study(self, err)
    class(data_file_type), intent(inout) :: self         !< the file, read without errors
    type(error_type), allocatable, intent(out) :: err    !< allocated if it cannot

    call check_study(self%model, self%quantities, err)
    if (.not. allocated(err) .and. self%model%request%output%hdf5_runs) call columns_of_runs(self%model, self%run_columns)
  end subroutine judge_study

  !> End the run, if there is one.
  subroutine close_run(self)
    class(data_file_type), intent(inout) :: self    !< the file

    if (.not. allocated(self%run)) return
    call self%run%close()
    deallocate (self%run)
  end subroutine close_run

  !> Keep an error, if there is one.
  subroutine fail(self, err)
    class(data_file_type), intent(inout) :: self          !< the file
    type(error_type), allocatable, intent(in) :: err      !< nothing happens where it is not allocated

    if (allocated(err)) call self%diagnostics%add_error(err)
  end subroutine fail

  !> Whether there are errors.
  pure logical function failed(self)
    class(data_file_type), intent(in) :: self    !< the file

    failed = self%diagnostics%failed()
  end function failed

  !> The exit code of the program.
  pure integer function code(self)
    class(data_file_type), intent(in) :: self    !< the file

    code = self%diagnostics%code()
    if (self%choice%failed()) code = self%choice%code()
  end function code

  !> List the files that are read: those that groups name.
  pure subroutine list_files(self, paths)
    class(data_file_type), intent(in) :: self                !< the file
    type(string_type), allocatable, intent(out) :: paths(:)  !< as the programs know them

    call files_of_groups(self%document, paths)
  end subroutine list_files

  !> List names and units of the parameters.
  pure subroutine list_parameters(self, names, units)
    class(data_file_type), intent(in) :: self                  !< the file, read without errors
    type(string_type), allocatable, intent(out) :: names(:)    !< (parameters)
    type(string_type), allocatable, intent(out) :: units(:)    !< (parameters) empty where none is known

    call name_parameters(self%model%mechanism, self%model%parameters, names, units)
  end subroutine list_parameters

  !> The pairs whose forces are recorded. The first coordinate of a joint with several freedoms stands for it.
  pure function pairs_of_forces(self) result(reacting)
    class(data_file_type), intent(in) :: self               !< the file, read without errors
    logical :: reacting(size(self%model%mechanism%pairs))

    reacting = reacting_pairs(self%model)
  end function pairs_of_forces

  !> Print all errors.
  subroutine report(self, unit)
    class(data_file_type), intent(in) :: self    !< the file
    integer, intent(in) :: unit                  !< Fortran unit to write to

    call self%choice%report(unit)
    call self%diagnostics%report(unit)
  end subroutine report

  !> Print an error that is not kept, with its place in the file.
  subroutine report_failure(self, err, unit)
    class(data_file_type), intent(in) :: self    !< the file
    type(error_type), intent(in) :: err          !< the error
    integer, intent(in) :: unit                  !< Fortran unit to write to
    type(diagnostics_type) :: own

    own%sources = self%diagnostics%sources
    call own%add_error(err)
    call own%report(unit)
  end subroutine report_failure
end module mech9_data_file
