!> A mechanism as the library's users hold it: groups of a data file, which are read, added and changed in memory.
!>
!> Each group is held against the grammar when it comes. Its sense beside the other groups is judged by read_file, read_text and
!> set; a mechanism of parse_file or parse_text is judged by its first answer, so that groups can be added to it until then.
module mech9_checked_mechanism
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use, intrinsic :: iso_c_binding, only: c_funptr, c_ptr
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage, exit_data
  use mech9_text, only: string_type, to_text, exact_digits, lower
  use mech9_model, only: model_type
  use mech9_registered_procedures, only: registered_procedure_type
  use mech9_explanation, only: explain
  use mech9_source, only: source_type, span_type, source_from_text
  use mech9_document, only: document_type, group_type
  use mech9_document_text, only: text_of_document
  use mech9_design_text, only: text_of_design
  use mech9_fixed_groups, only: fixed_groups
  use mech9_setting, only: apply_setting
  use mech9_named_number, only: number_place_type, find_number, set_number
  use mech9_lookup, only: has_name, groups_named, get_integers, get_text
  use mech9_checker, only: check_document, check_alone
  use mech9_parameter, only: parameter_type
  use mech9_parameter_reader, only: read_parameters, groups_of_parameters
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_findings, only: finding_type, fail_as
  use mech9_numbers_of_parameters, only: refuse_set_by_parameter, refuse_override, find_unwritten_value
  use mech9_parser, only: read_document, parse_document
  use mech9_drive_reader, only: files_of_groups
  use mech9_reader, only: read_model
  implicit none
  private
  public :: checked_mechanism_type, read_file, read_text, parse_file, parse_text

  type :: checked_mechanism_type
    private
    type(document_type) :: document
    type(source_type), allocatable :: sources(:)   !< the texts that its places point into; the first one is the data file
    logical :: is_read = .false.                   !< the document is without errors
    logical :: is_whole = .false.                  !< its groups make sense together
  contains
    procedure :: add
    procedure :: remove
    procedure :: apply
    procedure :: register
    procedure :: set
    procedure :: put_number
    procedure :: number
    procedure :: text
    procedure :: text_of_fixed
    procedure :: list_files
    procedure :: list_findings
    procedure :: find_error_place
    procedure :: order_as_given
    procedure :: list_parameters
    procedure :: take_design
    procedure :: judge_drives
    procedure :: take
    procedure :: take_request
    procedure :: take_standing
    procedure :: take_variable
    procedure :: point_at
    procedure :: begin_diagnostics
  end type checked_mechanism_type

contains

  !> Read a data file. Fails with exit_file, exit_data or exit_structure; the message holds all errors, each with its line.
  subroutine read_file(path, mechanism, err)
    character(len=*), intent(in) :: path                        !< of the data file
    type(checked_mechanism_type), intent(out) :: mechanism      !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(diagnostics_type) :: diagnostics

    call read_document(path, mechanism%document, diagnostics)
    call take_whole(mechanism, diagnostics, err)
  end subroutine read_file

  !> Read a text that has the form of a data file. Fails as read_file does.
  subroutine read_text(text, mechanism, err)
    character(len=*), intent(in) :: text                        !< groups of the data file
    type(checked_mechanism_type), intent(out) :: mechanism      !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('text', text), mechanism%document, diagnostics)
    call take_whole(mechanism, diagnostics, err)
  end subroutine read_text

  !> Read a data file, and hold each group against the grammar alone. Fails with exit_file or exit_data.
  subroutine parse_file(path, mechanism, err, findings)
    character(len=*), intent(in) :: path                                           !< of the data file
    type(checked_mechanism_type), intent(out) :: mechanism                         !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err                              !< allocated if it failed
    type(finding_type), allocatable, intent(out), optional :: findings(:)          !< all errors, by place
    type(diagnostics_type) :: diagnostics

    call read_document(path, mechanism%document, diagnostics)
    call take_parsed(mechanism, diagnostics, err, findings)
  end subroutine parse_file

  !> Read a text that has the form of a data file, and hold each group against the grammar alone. An empty text is a mechanism
  !> without groups. Fails with exit_data.
  subroutine parse_text(text, mechanism, err, findings)
    character(len=*), intent(in) :: text                                           !< groups of the data file
    type(checked_mechanism_type), intent(out) :: mechanism                         !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err                              !< allocated if it failed
    type(finding_type), allocatable, intent(out), optional :: findings(:)          !< all errors, by place
    type(diagnostics_type) :: diagnostics

    if (len_trim(text) > 0) then
      call parse_document(source_from_text('text', text), mechanism%document, diagnostics)
    else
      mechanism%document%source = source_from_text('text', '', is_file=.false.)
      diagnostics%sources = [mechanism%document%source]
      allocate (mechanism%document%groups(0))
    end if
    call take_parsed(mechanism, diagnostics, err, findings)
  end subroutine parse_text

  !> Take a document whose groups must make sense together.
  subroutine take_whole(mechanism, diagnostics, err)
    type(checked_mechanism_type), intent(inout) :: mechanism    !< with its document
    type(diagnostics_type), intent(inout) :: diagnostics        !< errors of reading the document
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed

    mechanism%is_whole = .true.
    mechanism%sources = diagnostics%sources
    call check(mechanism, diagnostics, err)
  end subroutine take_whole

  !> Take a document whose groups need not make sense together yet.
  subroutine take_parsed(mechanism, diagnostics, err, findings)
    type(checked_mechanism_type), intent(inout) :: mechanism                       !< with its document
    type(diagnostics_type), intent(inout) :: diagnostics                           !< errors of reading the document
    type(error_type), allocatable, intent(out) :: err                              !< allocated if it failed
    type(finding_type), allocatable, intent(out), optional :: findings(:)          !< all errors, by place

    mechanism%sources = diagnostics%sources
    call check(mechanism, diagnostics, err, findings)
  end subroutine take_parsed

  !> Hold a document against the grammar, and against everything else that the reader checks where it shall make sense.
  subroutine check(mechanism, diagnostics, err, findings)
    type(checked_mechanism_type), intent(inout) :: mechanism                       !< with its document
    type(diagnostics_type), intent(inout) :: diagnostics                           !< errors of reading the document
    type(error_type), allocatable, intent(out) :: err                              !< allocated if it failed
    type(finding_type), allocatable, intent(out), optional :: findings(:)          !< all errors, by place
    type(model_type) :: unused
    type(document_type) :: checked

    if (mechanism%is_whole) then
      call read_groups(mechanism, dynamics, unused, diagnostics)
    else
      checked = mechanism%document
      call check_alone(checked, mechanism%document%groups, diagnostics)
    end if
    call fail_as(diagnostics, err, findings)
    mechanism%is_read = .not. allocated(err)
  end subroutine check

  !> Read the model of a mechanism. All errors are collected in the diagnostics.
  subroutine read_groups(mechanism, program, model, diagnostics)
    class(checked_mechanism_type), intent(in) :: mechanism   !< with its document
    integer, intent(in) :: program                           !< kinematics or dynamics
    type(model_type), intent(out) :: model                   !< of use only without errors
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the errors

    if (size(mechanism%document%groups) == 0 .and. .not. diagnostics%failed()) &
      call diagnostics%add(span_type(), 'this mechanism has no groups; add &structure and a &pair for each pair')
    call read_model(mechanism%document, program, model, diagnostics)
  end subroutine read_groups

  !> Add groups, as a text that has the form of a data file. Each is held against the grammar; the mechanism stays as it was where
  !> this fails. Fails with exit_data.
  subroutine add(self, text, err, findings)
    class(checked_mechanism_type), intent(inout) :: self                           !< the mechanism
    character(len=*), intent(in) :: text                                           !< groups of the data file
    type(error_type), allocatable, intent(out) :: err                              !< allocated if it failed
    type(finding_type), allocatable, intent(out), optional :: findings(:)          !< all errors, by place
    type(document_type) :: added, checked
    type(diagnostics_type) :: diagnostics

    call require(self, err)
    if (allocated(err)) return
    diagnostics%sources = self%sources
    call parse_document(source_from_text('added groups', text, is_file=.false.), added, diagnostics)
    checked = added
    call check_alone(checked, [self%document%groups, added%groups], diagnostics)
    call fail_as(diagnostics, err, findings)
    if (allocated(err)) return
    self%document%groups = [self%document%groups, added%groups]
    self%sources = diagnostics%sources
    self%is_whole = .false.
  end subroutine add

  !> Remove all groups of a name; there may be none. What is left need not make sense together.
  pure subroutine remove(self, name)
    class(checked_mechanism_type), intent(inout) :: self   !< the mechanism
    character(len=*), intent(in) :: name                   !< of the groups
    type(group_type), allocatable :: kept(:)
    integer :: i, n

    if (.not. self%is_read) return
    allocate (kept(size(self%document%groups)))
    n = 0
    do i = 1, size(kept)
      if (self%document%groups(i)%name == lower(name)) cycle
      n = n + 1
      kept(n) = self%document%groups(i)
    end do
    if (n == size(kept)) return
    self%document%groups = kept(:n)
    self%is_whole = .false.
  end subroutine remove

  !> Register a procedure of the user, a function of C as include/mech9.h declares it, for all groups of a name whose kind is 'user'.
  !> It takes the place of one that is linked. Fails with exit_usage where no such groups have procedures.
  pure subroutine register(self, name, function, data, err)
    class(checked_mechanism_type), intent(inout) :: self   !< the mechanism
    character(len=*), intent(in) :: name                   !< of the groups: pair, drive, coupling or load
    type(c_funptr), intent(in) :: function                 !< address of the function; null takes back the one that was registered
    type(c_ptr), intent(in) :: data                        !< is given to each call
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    associate (procedures => self%document%procedures, given => registered_procedure_type(function, data))
      select case (name)
      case ('pair')
        procedures%pair = given
      case ('drive')
        procedures%drive = given
      case ('coupling')
        procedures%coupling = given
      case ('load')
        procedures%force = given
      case default
        call raise(err, exit_usage, 'procedures are registered for the groups pair, drive, coupling and load, not for '//name)
      end select
    end associate
    self%is_whole = .false.
  end subroutine register

  !> Give names other values, as an option --set does: time.intervals=200, pair(3).axis=1,0,0. A group or a name that is missing is
  !> added. The mechanism stays as it was where this fails. Fails with exit_data.
  subroutine apply(self, setting, err, findings)
    class(checked_mechanism_type), intent(inout) :: self                           !< the mechanism
    character(len=*), intent(in) :: setting                                        !< group.name=value
    type(error_type), allocatable, intent(out) :: err                              !< allocated if it failed
    type(finding_type), allocatable, intent(out), optional :: findings(:)          !< all errors, by place
    type(checked_mechanism_type) :: candidate
    type(diagnostics_type) :: diagnostics

    call require(self, err)
    if (allocated(err)) return
    candidate%document = self%document
    candidate%is_whole = self%is_whole
    diagnostics%sources = self%sources
    call apply_setting(candidate%document, setting, diagnostics)
    call check(candidate, diagnostics, err, findings)
    if (.not. allocated(err)) call refuse_override(candidate%document, diagnostics%sources, err)
    if (allocated(err)) return
    self%document = candidate%document
    self%sources = diagnostics%sources
  end subroutine apply

  !> List the errors that keep a mechanism from its answers, by place. There are none where its groups make sense together.
  subroutine list_findings(self, program, findings)
    class(checked_mechanism_type), intent(in) :: self                    !< the mechanism
    integer, intent(in) :: program                                       !< kinematics or dynamics
    type(finding_type), allocatable, intent(out) :: findings(:)          !< the errors
    type(diagnostics_type) :: diagnostics
    type(model_type) :: unused
    type(error_type), allocatable :: err

    allocate (findings(0))
    if (.not. self%is_read) return
    diagnostics%sources = self%sources
    call read_groups(self, program, unused, diagnostics)
    call fail_as(diagnostics, err, findings)
  end subroutine list_findings

  !> Give a number another value, by the name that --set has for it, such as pair(2).point(1). The mechanism stays as it was where
  !> this fails: with exit_data for a name that is not known or a value out of its range, with exit_usage where a parameter sets the
  !> number.
  subroutine set(self, name, value, err, found)
    class(checked_mechanism_type), intent(inout) :: self   !< the mechanism
    character(len=*), intent(in) :: name                   !< of the number: group.name, or group(2).name(3)
    real(wp), intent(in) :: value                          !< in the unit of the data file
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(number_place_type), intent(out), optional :: found   !< the place of the number
    type(number_place_type) :: place
    type(checked_mechanism_type) :: candidate
    type(diagnostics_type) :: diagnostics
    type(span_type) :: span
    character(len=:), allocatable :: digits
    integer :: source

    if (.not. abs(value) <= huge(value)) then
      call raise(err, exit_data, 'the value for '//trim(name)//' is no finite number')
      return
    end if
    call find_named(self, name, .true., candidate%document, place, diagnostics, err)
    if (.not. allocated(err)) call refuse_set_by_parameter(candidate%document, self%sources, name, place, err)
    if (allocated(err)) return
    call set_number(candidate%document, place, value)
    candidate%is_whole = self%is_whole
    associate (changed => candidate%document%groups(place%group)%items(place%item)%values(place%value))
      ! messages of this call show the new number
      span = changed%span
      digits = to_text(value, exact_digits(value))
      call diagnostics%add_source(source_from_text('the value for '//trim(name), digits, is_file=.false.), source)
      changed%span = span_type(source, 1, len(digits))
      call check(candidate, diagnostics, err)
      changed%span = span
    end associate
    if (present(found)) found = place
    if (.not. allocated(err)) self%document = candidate%document
  end subroutine set

  !> Give a number that `set` has found before a value that it may have.
  pure subroutine put_number(self, place, value)
    class(checked_mechanism_type), intent(inout) :: self   !< the mechanism
    type(number_place_type), intent(in) :: place           !< of the number
    real(wp), intent(in) :: value                          !< in the unit of the data file

    call set_number(self%document, place, value)
  end subroutine put_number

  !> A number by its name, in the unit of the data file; its default where the mechanism does not give it. Fails with exit_data
  !> where there is no such number.
  subroutine number(self, name, value, err)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    character(len=*), intent(in) :: name                   !< of the number, as for set
    real(wp), intent(out) :: value                         !< not a number after a failure
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(document_type) :: document
    type(parameter_type), allocatable :: parameters(:)
    type(number_place_type) :: place
    type(diagnostics_type) :: diagnostics, anew
    type(error_type), allocatable :: of_place

    value = ieee_value(value, ieee_quiet_nan)
    call find_named(self, name, .false., document, place, diagnostics, err)
    if (allocated(err)) then
      call find_named(self, name, .true., document, place, anew, of_place)
      if (.not. allocated(of_place)) call find_unwritten_value(document, place, anew, value, err)
      return
    end if
    ! a parameter may set the number to another one than the file gives
    call read_parameters(document, parameters, diagnostics)
    value = document%groups(place%group)%items(place%item)%values(place%value)%number
  end subroutine number

  !> Find a number by its name.
  subroutine find_named(self, name, alone, document, place, diagnostics, err)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    character(len=*), intent(in) :: name                   !< of the number
    logical, intent(in) :: alone                           !< the only number of a name is added where it has no default
    type(document_type), intent(out) :: document           !< checked, with the number
    type(number_place_type), intent(out) :: place          !< of the number
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the sources
    type(error_type), allocatable, intent(out) :: err      !< allocated if it was not found
    integer :: source

    call require(self, err)
    if (allocated(err)) return
    document = self%document
    diagnostics%sources = self%sources
    call diagnostics%add_source(source_from_text('the name', name, is_file=.false.), source)
    if (self%is_whole) then
      call check_document(document, diagnostics)
    else
      call check_alone(document, self%document%groups, diagnostics)
    end if
    call find_number(document, name, span_type(source, 1, max(1, len_trim(name))), alone, place, diagnostics, any_number=.true.)
    call fail_as(diagnostics, err)
  end subroutine find_named

  !> The mechanism as the text of a data file, without comments; empty where there is no mechanism.
  subroutine text(self, written)
    class(checked_mechanism_type), intent(in) :: self         !< the mechanism
    character(len=:), allocatable, intent(out) :: written     !< read_text makes the same mechanism of it

    written = ''
    if (self%is_read) call text_of_document(self%document, written)
  end subroutine text

  !> The text of what must not change where code was made for the mechanism; empty where its groups make no sense.
  subroutine text_of_fixed(self, text)
    class(checked_mechanism_type), intent(in) :: self        !< the mechanism
    character(len=:), allocatable, intent(out) :: text       !< a line for each name, under that of its group

    call fixed_groups(self%document, self%sources, text)
  end subroutine text_of_fixed

  !> List the files that the mechanism reads: the data file first, empty where there is none, and those that its groups name.
  subroutine list_files(self, paths)
    class(checked_mechanism_type), intent(in) :: self         !< the mechanism
    type(string_type), allocatable, intent(out) :: paths(:)   !< as the programs know them
    type(string_type), allocatable :: of_groups(:)
    integer :: i

    call files_of_groups(self%document, of_groups)
    allocate (paths(1 + size(of_groups)))
    paths(1)%text = ''
    if (self%is_read) then
      if (self%document%source%is_file) paths(1)%text = self%document%source%name
    end if
    do i = 1, size(of_groups)
      paths(1 + i)%text = of_groups(i)%text
    end do
  end subroutine list_files

  !> Fail where there is no mechanism.
  subroutine require(self, err)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    type(error_type), allocatable, intent(out) :: err      !< allocated if there is none

    if (.not. self%is_read) &
      call raise(err, exit_usage, 'there is no mechanism: read one, or finish a design, before its motion is started')
  end subroutine require

  !> The model of a driven or of a free motion, with all coordinates and their derivatives requested. Fails with exit_data
  !> where drives are missing for the former.
  subroutine take(self, program, model, err)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    integer, intent(in) :: program                         !< kinematics, where all independent coordinates have drives, or dynamics
    type(model_type), intent(out) :: model                 !< in m, rad, kg, s
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    call self%take_request(program, model, err)
    if (allocated(err)) return
    if (allocated(model%request%output%coordinates)) deallocate (model%request%output%coordinates)
    model%request%output%derivatives = 2
  end subroutine take

  !> The model of a driven or of a free motion, with the results that the mechanism requests. Fails as take does.
  subroutine take_request(self, program, model, err)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    integer, intent(in) :: program                         !< kinematics, where all independent coordinates have drives, or dynamics
    type(model_type), intent(out) :: model                 !< in m, rad, kg, s
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(diagnostics_type) :: diagnostics

    call require(self, err)
    if (allocated(err)) return
    diagnostics%sources = self%sources
    call read_groups(self, program, model, diagnostics)
    call fail_as(diagnostics, err)
  end subroutine take_request

  !> The model for answers about positions alone. A free coordinate without an initial position starts at zero. Fails as take does.
  subroutine take_standing(self, model, err)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    type(model_type), intent(out) :: model                 !< in m, rad, kg, s
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    call self%take_request(dynamics, model, err)
    if (.not. allocated(err)) model%problem%initial%position_given = .true.
  end subroutine take_standing

  !> The model as a function of its parameters.
  subroutine take_variable(self, program, variable)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    integer, intent(in) :: program                         !< kinematics or dynamics
    type(varied_document_type), intent(out) :: variable    !< the function

    call new_varied_document(self%document, self%sources, program, variable)
  end subroutine take_variable

  !> Complete the message of an error, with the line of the data file where it knows its place.
  subroutine point_at(self, err)
    class(checked_mechanism_type), intent(in) :: self             !< the mechanism
    type(error_type), allocatable, intent(inout) :: err           !< nothing happens where it is not allocated
    type(diagnostics_type) :: diagnostics

    if (.not. allocated(err)) return
    call explain(err)
    if (err%place%line == 0 .or. .not. allocated(self%sources)) return
    call self%begin_diagnostics(diagnostics)
    call diagnostics%add_error(err)
    call diagnostics%render(1, err%message)
  end subroutine point_at

  !> Make diagnostics without errors, which know the texts of the groups.
  pure subroutine begin_diagnostics(self, diagnostics)
    class(checked_mechanism_type), intent(in) :: self          !< the mechanism
    type(diagnostics_type), intent(out) :: diagnostics         !< get errors with places in these texts

    if (allocated(self%sources)) diagnostics%sources = self%sources
  end subroutine begin_diagnostics

  !> Find the file, line and column of a failure of an answer; the file is empty and the line is 0 where it has no place.
  subroutine find_error_place(self, err, file, line, column)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    type(error_type), intent(in) :: err                    !< the failure
    character(len=:), allocatable, intent(out) :: file     !< path of the data file
    integer, intent(out) :: line                           !< in the file
    integer, intent(out) :: column                         !< in the line

    file = ''
    line = 0
    column = 0
    if (err%place%line == 0 .or. .not. allocated(self%sources)) return
    if (.not. self%sources(err%place%source)%is_file) return
    file = self%sources(err%place%source)%name
    line = err%place%line
    column = err%place%column
  end subroutine find_error_place

  !> The groups of a mechanism with their rows in the grammar; none where there is no mechanism.
  pure subroutine check_again(self, checked)
    class(checked_mechanism_type), intent(in) :: self    !< the mechanism
    type(document_type), intent(out) :: checked          !< its groups, checked
    type(diagnostics_type) :: none_found

    if (.not. self%is_read) then
      allocate (checked%groups(0))
      return
    end if
    checked = self%document
    none_found%sources = self%sources
    call check_document(checked, none_found)
  end subroutine check_again

  !> List the names of the parameters without formulas, in the order of their groups.
  subroutine list_parameters(self, names)
    class(checked_mechanism_type), intent(in) :: self        !< the mechanism
    type(string_type), allocatable, intent(out) :: names(:)  !< (P) the names; empty where a group has none
    type(document_type) :: checked
    integer, allocatable :: groups(:)
    integer :: i

    call check_again(self, checked)
    groups = groups_of_parameters(checked)
    allocate (names(size(groups)))
    do i = 1, size(groups)
      names(i)%text = trim(get_text(checked%groups(groups(i)), 'name'))
    end do
  end subroutine list_parameters

  !> The mechanism with other values of its parameters, and with the coordinates of an assembly at its start.
  subroutine take_design(self, program, values, q, design, err)
    class(checked_mechanism_type), intent(in) :: self          !< the mechanism
    integer, intent(in) :: program                             !< kinematics or dynamics
    real(wp), intent(in) :: values(:)                          !< of all parameters, in the units of the data file
    real(wp), intent(in) :: q(:)                               !< (M) coordinates at the start [rad, m]
    type(checked_mechanism_type), intent(out) :: design        !< the mechanism of the design
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed
    type(varied_document_type) :: variable
    type(document_type) :: written
    type(diagnostics_type) :: diagnostics
    type(model_type) :: model
    character(len=:), allocatable :: text, changed

    call self%take_variable(program, variable)
    call variable%at(values, model, err)
    if (allocated(err)) return
    call self%text(text)
    call parse_document(source_from_text('text', text), written, diagnostics)
    call text_of_design(written, model, values, q, '', changed)
    ! the files that it names are found beside the data file
    diagnostics%sources = diagnostics%sources(:0)
    call parse_document(source_from_text(self%sources(1)%name, changed, is_file=.false.), design%document, diagnostics)
    design%document%procedures = self%document%procedures
    call take_parsed(design, diagnostics, err)
  end subroutine take_design

  !> Judge whether drives move all independent coordinates. Fails with exit_data or exit_structure.
  subroutine judge_drives(self, all_driven, err)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    logical, intent(out) :: all_driven                     !< nothing moves by forces
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(model_type) :: model

    all_driven = .false.
    call self%take_request(dynamics, model, err)
    if (.not. allocated(err)) all_driven = model%is_driven()
  end subroutine judge_drives

  !> Put independent coordinates into the order in which cq names them, where the data file has it.
  pure subroutine order_as_given(self, coordinates)
    class(checked_mechanism_type), intent(in) :: self   !< the mechanism
    integer, intent(inout) :: coordinates(:)            !< their numbers
    type(document_type) :: checked
    integer, allocatable :: groups(:), cq(:)
    integer :: i

    call check_again(self, checked)
    groups = groups_named(checked, 'structure')
    if (size(groups) == 0) return
    associate (group => checked%groups(groups(1)))
      if (.not. has_name(group, 'cq')) return
      cq = get_integers(group, 'cq')
    end associate
    coordinates = pack(cq, [(any(coordinates == cq(i)), i=1, size(cq))])
  end subroutine order_as_given
end module mech9_checked_mechanism
