!> A run as the library's users make it: the rows of its outputs as arrays, its quantities and their derivatives.
module mech9_recorded_run
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_file, exit_interrupted
  use mech9_text, only: string_type, texts_of_one_length
  use mech9_model, only: model_type
  use mech9_simulation, only: interruption_type
  use mech9_explanation, only: explain
  use mech9_clock, only: seconds
  use mech9_diagnostics, only: diagnostics_type
  use mech9_facts, only: facts_type
  use mech9_json, only: json_type
  use mech9_run, only: run_type
  use mech9_periodic, only: periodic_found_type, find_periodic
  use mech9_periodic_run, only: take_periodic, start_periodic
  use mech9_run_outcome, only: run_outcome_type
  use mech9_run_facts, only: list_run_facts
  use mech9_whole_report, only: compose_report
  use mech9_provenance_layout, only: origin_type, set_present_time
  use mech9_data_set_table, only: data_set_table_type
  use mech9_run_layout, only: lay_out_run
  use mech9_mechanism_pictures, only: mechanism_pictures_type
  use mech9_varied_document, only: varied_document_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: recorded_run_type

  !> Name of the library in files of results, in place of a program.
  character(len=*), parameter :: library_name = 'libmech9'

  !> It must not be copied.
  type :: recorded_run_type
    private
    type(model_type), pointer :: model => null()                 !< owned; the run refers to it
    type(varied_document_type), pointer :: variable => null()    !< owned; the run refers to it
    class(run_type), pointer :: run => null()                    !< owned; null where none is begun
    class(interruption_type), pointer :: interruption => null()  !< owned; null where the run cannot be stopped
    type(diagnostics_type) :: diagnostics                        !< gets the failure of the run
    type(run_outcome_type) :: outcome                            !< rows that were taken, and the time for them
    integer :: next = 0                                          !< number of the next output, from 0 on
    logical :: has_failed = .false.                              !< the run ended before its last output
    character(len=:), allocatable :: began                       !< time when the run began
    type(periodic_found_type), allocatable :: periodic           !< periodic motions, of which the run records the first one
  contains
    procedure :: begin_kinematics
    procedure :: begin_dynamics
    procedure :: begin_periodic
    procedure :: begin_film
    procedure :: draw
    procedure :: outputs
    procedure :: columns
    procedure :: pose_columns
    procedure :: take_rows
    procedure :: quantities
    procedure :: gradients
    procedure :: section
    procedure :: report
    procedure :: lay_out
    procedure :: close => close_run
  end type recorded_run_type

contains

  !> Begin a driven run over the outputs of &time: plan, assemble, and find the columns. Fails with exit_data for a missing drive,
  !> with exit_structure or exit_assembly where the mechanism cannot be put together.
  subroutine begin_kinematics(self, mechanism, err, interruption)
    class(recorded_run_type), intent(inout) :: self                  !< the run; one that it held is closed
    type(checked_mechanism_type), intent(in) :: mechanism            !< with a drive for each independent coordinate
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the run shall stop

    call begin(self, mechanism, kinematics, err, interruption)
  end subroutine begin_kinematics

  !> Begin a run under forces over the outputs of &time. Fails as begin_kinematics does.
  subroutine begin_dynamics(self, mechanism, err, interruption)
    class(recorded_run_type), intent(inout) :: self                  !< the run; one that it held is closed
    type(checked_mechanism_type), intent(in) :: mechanism            !< with bodies, loads and gravity
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the run shall stop

    call begin(self, mechanism, dynamics, err, interruption)
  end subroutine begin_dynamics

  !> Begin a run that will be drawn. Fails as begin_kinematics does.
  subroutine begin_film(self, mechanism, program, err, interruption)
    class(recorded_run_type), intent(inout) :: self                  !< the run; one that it held is closed
    type(checked_mechanism_type), intent(in) :: mechanism            !< the mechanism
    integer, intent(in) :: program                                   !< kinematics or dynamics
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the run shall stop

    call begin(self, mechanism, program, err, interruption, pictures=.true.)
    if (.not. allocated(err)) call self%run%record_film(self%model)
  end subroutine begin_film

  !> Draw the positions that were taken so far. Fails with exit_file.
  subroutine draw(self, pictures, err)
    class(recorded_run_type), intent(in) :: self             !< the run, begun by begin_film
    type(mechanism_pictures_type), intent(in) :: pictures    !< the pictures that are wanted
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed

    if (.not. associated(self%run)) return
    if (allocated(self%run%source%film)) call pictures%save(self%model, self%run%source%film, err)
  end subroutine draw

  !> Find a periodic motion under forces, and begin a run over one period of it. Fails with exit_data where there can be none, with
  !> exit_assembly where none was found, and as a run under forces does.
  subroutine begin_periodic(self, mechanism, err, interruption)
    class(recorded_run_type), intent(inout) :: self                  !< the run; one that it held is closed
    type(checked_mechanism_type), intent(in) :: mechanism            !< with free coordinates, bodies and loads
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether search and run shall stop

    call begin(self, mechanism, dynamics, err, interruption, periodic=.true.)
  end subroutine begin_periodic

  !> Begin a run of a program.
  subroutine begin(self, mechanism, program, err, interruption, pictures, periodic)
    class(recorded_run_type), intent(inout) :: self                  !< the run; one that it held is closed
    type(checked_mechanism_type), intent(in) :: mechanism            !< the mechanism
    integer, intent(in) :: program                                   !< kinematics or dynamics
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the run shall stop
    logical, intent(in), optional :: pictures                        !< the run is drawn; not unless given
    logical, intent(in), optional :: periodic                        !< a periodic motion is found first; not unless given

    call self%close()
    call set_present_time(self%began)
    allocate (self%model, self%variable, self%run)
    if (present(interruption)) allocate (self%interruption, source=interruption)
    call mechanism%begin_diagnostics(self%diagnostics)
    call mechanism%take_request(program, self%model, err)
    if (.not. allocated(err)) then
      if (self%model%request%output%with_derivatives()) call mechanism%take_variable(program, self%variable)
      if (present(periodic)) allocate (self%periodic)
      if (allocated(self%periodic)) call find_periodic(self%model, self%periodic, err, interruption)
      if (allocated(self%periodic) .and. .not. allocated(err)) call take_periodic(self%periodic%motions(1), self%model)
      if (.not. allocated(err)) call self%run%motion%assemble(self%model, err)
      if (allocated(self%periodic) .and. .not. allocated(err)) &
        call start_periodic(self%periodic%motions(1), self%model, self%run%motion, err)
      if (allocated(err)) call explain(err)
    end if
    if (.not. allocated(err)) call self%run%prepare(self%model, err, self%variable, pictures)
    if (.not. allocated(err)) call self%run%source%begin_section(err)
    if (.not. allocated(err)) call find_tolerances(self, err, pictures)
    call mechanism%point_at(err)
    if (allocated(err)) call self%close()
  end subroutine begin

  !> Find the tolerances for an accuracy, if one is asked for.
  subroutine find_tolerances(self, err, pictures)
    type(recorded_run_type), intent(inout) :: self         !< the run, prepared
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    logical, intent(in), optional :: pictures              !< the run is drawn; not unless given

    if (associated(self%interruption)) then
      call self%run%motion%find_tolerances(self%model, err, pictures, self%interruption)
      self%run%source%interruption => self%interruption
    else
      call self%run%motion%find_tolerances(self%model, err, pictures)
    end if
  end subroutine find_tolerances

  !> Number of outputs of the whole run; 0 where none is begun.
  pure integer function outputs(self)
    class(recorded_run_type), intent(in) :: self   !< the run

    outputs = 0
    if (associated(self%run)) outputs = self%model%request%time%intervals + 1
  end function outputs

  !> Names and units of the columns, the time first. There are none where no run is begun.
  pure subroutine columns(self, names, units)
    class(recorded_run_type), intent(in) :: self                        !< the run
    character(len=:), allocatable, intent(out) :: names(:)              !< (columns) as the programs write them
    character(len=:), allocatable, intent(out), optional :: units(:)    !< (columns)
    type(string_type) :: none(0)

    if (associated(self%run)) then
      associate (found => self%run%source%columns)
        call texts_of_one_length(found%names(:found%count), names)
        if (present(units)) call texts_of_one_length(found%units(:found%count), units)
      end associate
    else
      call texts_of_one_length(none, names)
      if (present(units)) call texts_of_one_length(none, units)
    end if
  end subroutine columns

  !> Number of the columns behind those of the table that only an HDF5 file has: of poses, and of their derivatives.
  pure integer function pose_columns(self)
    class(recorded_run_type), intent(in) :: self   !< the run

    pose_columns = 0
    if (associated(self%run)) then
      associate (found => self%run%source%columns)
        pose_columns = found%width() - found%count - found%unrecorded
      end associate
    end if
  end function pose_columns

  !> Take the next rows. Fewer rows than there is room for are the last ones. Fails with exit_singular where the motion cannot go
  !> on, with exit_integrator where the integration cannot, and with exit_usage where no run is begun or the run failed before. The
  !> rows before the failure are then there. An interrupted run goes on with the next call.
  subroutine take_rows(self, rows, count, err, poses)
    class(recorded_run_type), intent(inout) :: self       !< the run
    real(wp), intent(inout) :: rows(:, :)                 !< (columns,most rows) in the units of the columns
    integer, intent(out) :: count                         !< rows that were taken
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    real(wp), intent(inout), optional :: poses(:, :)      !< (pose_columns,most rows) gets the columns of poses of these rows
    real(wp), allocatable :: whole(:, :)
    real(wp) :: began
    integer :: taken, status

    count = 0
    if (.not. associated(self%run)) then
      call raise(err, exit_usage, 'a run must be begun before its rows are taken')
    else if (self%has_failed) then
      call raise(err, exit_usage, 'this run has failed; begin it anew')
    else if (size(rows, 1) /= self%run%source%columns%count) then
      call raise(err, exit_usage, 'the first dimension of the array for the rows is not the number of columns')
    end if
    if (allocated(err)) return
    associate (source => self%run%source, time => self%model%request%time)
      ! rows of the engine may end with derivatives that only quantities need
      allocate (whole(source%columns%width(), min(size(rows, 2), time%intervals + 1 - self%next)), stat=status)
      if (status /= 0) then
        call raise(err, exit_file, 'there is not enough memory for all rows; take fewer at a time')
        return
      end if
      whole = 0.0_wp
      ! a run that was stopped goes on
      call self%diagnostics%clear()
      began = seconds()
      do taken = 1, size(whole, 2)
        call source%add_row(time%time(self%next), whole, count, err)
        if (allocated(err)) exit
        self%next = self%next + 1
        if (associated(self%interruption)) call self%interruption%tell(real(self%next, wp)/(time%intervals + 1))
      end do
      if (.not. allocated(err)) call source%complete(whole, count, err)
      rows(:, :count) = whole(:size(rows, 1), :count)
      if (present(poses)) poses(:, :count) = whole(size(rows, 1) + 1:size(rows, 1) + size(poses, 1), :count)
      self%outcome%rows = self%outcome%rows + count
      self%outcome%seconds_solving = self%outcome%seconds_solving + seconds() - began
    end associate
    call finish(self, err)
  end subroutine take_rows

  !> End with a failure, or finish the quantities after the last row.
  subroutine finish(self, err)
    type(recorded_run_type), intent(inout) :: self          !< the run
    type(error_type), allocatable, intent(inout) :: err     !< allocated if its rows failed; gets its sentence

    if (allocated(err)) then
      self%has_failed = err%code /= exit_interrupted
      call self%diagnostics%add_error(err)
      call explain(err)
      return
    end if
    associate (found => self%run%source%quantities)
      if (self%next > self%model%request%time%intervals .and. .not. (found%is_empty() .or. found%is_finished)) call found%finish()
    end associate
  end subroutine finish

  !> The quantities of the run. They are not numbers before its last row is taken.
  subroutine quantities(self, names, values, units)
    class(recorded_run_type), intent(in) :: self                        !< the run
    character(len=:), allocatable, intent(out) :: names(:)              !< (quantities)
    real(wp), allocatable, intent(out) :: values(:)                     !< (quantities) in their units
    character(len=:), allocatable, intent(out), optional :: units(:)    !< (quantities)
    type(string_type), allocatable :: texts(:), of_units(:)
    integer :: i, n

    n = 0
    if (associated(self%run)) then
      if (allocated(self%model%request%quantities)) n = size(self%model%request%quantities)
    end if
    allocate (texts(n), of_units(n))
    allocate (values(n), source=ieee_value(1.0_wp, ieee_quiet_nan))
    do i = 1, n
      texts(i)%text = self%model%request%quantities(i)%name
      of_units(i)%text = self%run%source%quantities%unit_of(i)
      values(i) = self%run%source%quantities%numbers(i)
    end do
    call texts_of_one_length(texts, names)
    if (present(units)) call texts_of_one_length(of_units, units)
  end subroutine quantities

  !> The derivatives of the quantities by the parameters, where &output requests them. They are not numbers before the last row is
  !> taken, and where a quantity has no derivative.
  subroutine gradients(self, values)
    class(recorded_run_type), intent(in) :: self           !< the run
    real(wp), allocatable, intent(out) :: values(:, :)     !< (parameters,quantities) in units of the data file

    if (associated(self%run)) then
      if (allocated(self%run%source%quantities%gradient)) values = self%run%source%quantities%gradient
    end if
    if (.not. allocated(values)) allocate (values(0, 0))
  end subroutine gradients

  !> The points of the section so far, where the data file requests one: columns point, t and those of the run. There are no columns
  !> without a section.
  subroutine section(self, names, points, units)
    class(recorded_run_type), intent(in) :: self                        !< the run
    character(len=:), allocatable, intent(out) :: names(:)              !< (columns)
    real(wp), allocatable, intent(out) :: points(:, :)                  !< (columns,points) in the units of the columns
    character(len=:), allocatable, intent(out), optional :: units(:)    !< (columns)
    type(string_type) :: none(0)

    if (associated(self%run)) then
      if (allocated(self%run%source%section)) then
        associate (found => self%run%source%section)
          points = found%points(:, :found%count)
          names = found%names
          if (present(units)) units = found%units
        end associate
      end if
    end if
    if (allocated(points)) return
    allocate (points(0, 0))
    call texts_of_one_length(none, names)
    if (present(units)) call texts_of_one_length(none, units)
  end subroutine section

  !> The report of the run as JSON, as --report writes it: how it ended, and the work that it took. It is empty where no run is begun.
  subroutine report(self, text)
    class(recorded_run_type), intent(inout) :: self              !< the run
    character(len=:), allocatable, intent(out) :: text           !< the report
    type(facts_type) :: facts
    type(json_type) :: json

    text = ''
    if (.not. associated(self%run)) return
    call judge_forces(self)
    call list_run_facts(self%run%motion, self%outcome, facts)
    call compose_report(json, self%model, self%diagnostics, '', facts, self%run, self%periodic)
    call json%take_text(text)
  end subroutine report

  !> Find which forces equilibrium determines, where reactions are recorded.
  subroutine judge_forces(self)
    type(recorded_run_type), intent(inout) :: self   !< the run

    associate (run => self%run)
      if (.not. allocated(run%source%forces%unique)) call run%source%forces%judge(self%model, run%motion%plan, run%motion%start)
    end associate
  end subroutine judge_forces

  !> Lay out the run as the data sets of an HDF5 file, in the form of the programs. There are none where no run is begun.
  subroutine lay_out(self, mechanism, table)
    class(recorded_run_type), intent(inout) :: self              !< the run, over
    type(checked_mechanism_type), intent(in) :: mechanism        !< of the run
    type(data_set_table_type), intent(out) :: table              !< the data sets
    type(facts_type) :: facts
    type(origin_type) :: origin
    type(string_type), allocatable :: files(:)

    if (.not. associated(self%run)) return
    call judge_forces(self)
    origin%program = library_name
    origin%command_line = ''
    call mechanism%list_files(files)
    origin%data_file = files(1)%text
    call mechanism%text(origin%data)
    origin%began = self%began
    origin%storage = ''
    call list_run_facts(self%run%motion, self%outcome, facts)
    call lay_out_run(self%model, self%run, facts, self%diagnostics%code(), origin, table)
  end subroutine lay_out

  !> End the run and free its memory. Another one can then be begun.
  subroutine close_run(self)
    class(recorded_run_type), intent(inout) :: self   !< the run

    if (associated(self%run)) then
      call self%run%close()
      deallocate (self%run)
    end if
    if (associated(self%variable)) deallocate (self%variable)
    if (allocated(self%periodic)) deallocate (self%periodic)
    if (associated(self%model)) deallocate (self%model)
    if (associated(self%interruption)) deallocate (self%interruption)
    self%next = 0
    self%has_failed = .false.
    self%outcome = run_outcome_type()
  end subroutine close_run
end module mech9_recorded_run
