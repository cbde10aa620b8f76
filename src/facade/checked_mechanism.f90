!> A mechanism as the library's users hold it: read from a data file or a text of the same form, and checked.
module mech9_checked_mechanism
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_program_kind, only: dynamics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_explanation, only: explain
  use mech9_source, only: source_type, span_type, source_from_text
  use mech9_document, only: document_type
  use mech9_document_text, only: text_of_document
  use mech9_named_number, only: number_place_type, find_number, set_number
  use mech9_lookup, only: has_name, groups_named
  use mech9_checker, only: check_document
  use mech9_parameter, only: parameter_type
  use mech9_parameter_reader, only: read_parameters
  use mech9_varied_document, only: varied_document_type, new_varied_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: read_document, parse_document
  use mech9_reader, only: read_model
  implicit none
  private
  public :: checked_mechanism_type, read_file, read_text

  type :: checked_mechanism_type
    private
    type(document_type) :: document
    logical :: is_read = .false.      !< the document is without errors
  contains
    procedure :: set
    procedure :: number
    procedure :: text
    procedure :: take
    procedure :: take_request
    procedure :: take_variable
    procedure :: point_at
  end type checked_mechanism_type

  !> Errors that are told together.
  integer, parameter :: most_told = 20

contains

  !> Read a data file. Fails with exit_file, exit_data or exit_structure; the message holds all errors, each with its line.
  subroutine read_file(path, mechanism, err)
    character(len=*), intent(in) :: path                        !< of the data file
    type(checked_mechanism_type), intent(out) :: mechanism      !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(diagnostics_type) :: diagnostics

    call read_document(path, mechanism%document, diagnostics)
    call check(mechanism, diagnostics, err)
  end subroutine read_file

  !> Read a text that has the form of a data file. Fails as read_file does.
  subroutine read_text(text, mechanism, err)
    character(len=*), intent(in) :: text                        !< groups of the data file
    type(checked_mechanism_type), intent(out) :: mechanism      !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(diagnostics_type) :: diagnostics
    type(source_type) :: source

    source = source_from_text('text', text)
    call parse_document(source, mechanism%document, diagnostics)
    call check(mechanism, diagnostics, err)
  end subroutine read_text

  !> Hold a document against everything that the reader checks.
  subroutine check(mechanism, diagnostics, err)
    type(checked_mechanism_type), intent(inout) :: mechanism    !< with its document
    type(diagnostics_type), intent(inout) :: diagnostics        !< errors of reading the document
    type(error_type), allocatable, intent(out) :: err           !< allocated if it failed
    type(model_type) :: unused

    call read_model(mechanism%document, dynamics, unused, diagnostics)
    call fail_as(diagnostics, err)
    mechanism%is_read = .not. allocated(err)
  end subroutine check

  !> Give a number another value, by the name that --set has for it, such as pair(2).point(1). The mechanism stays as it was where
  !> this fails: with exit_data for a name that is not known or a value out of its range, with exit_usage where a parameter sets the
  !> number.
  subroutine set(self, name, value, err)
    class(checked_mechanism_type), intent(inout) :: self   !< the mechanism
    character(len=*), intent(in) :: name                   !< of the number: group.name, or group(2).name(3)
    real(wp), intent(in) :: value                          !< in the unit of the data file
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(number_place_type) :: place
    type(checked_mechanism_type) :: candidate
    type(diagnostics_type) :: diagnostics

    call find_named(self, name, .true., candidate%document, place, diagnostics, err)
    if (.not. allocated(err)) call refuse_set_by_parameter(candidate%document, name, place, err)
    if (allocated(err)) return
    call set_number(candidate%document, place, value)
    call check(candidate, diagnostics, err)
    if (.not. allocated(err)) self%document = candidate%document
  end subroutine set

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
    type(diagnostics_type) :: diagnostics

    value = ieee_value(value, ieee_quiet_nan)
    call find_named(self, name, .false., document, place, diagnostics, err)
    if (allocated(err)) return
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
    call diagnostics%add_source(document%source, source)
    call diagnostics%add_source(source_from_text('the name', name, is_file=.false.), source)
    call check_document(document, diagnostics)
    call find_number(document, name, span_type(source, 1, max(1, len_trim(name))), alone, place, diagnostics, any_number=.true.)
    call fail_as(diagnostics, err)
  end subroutine find_named

  !> Refuse to set a number that follows the value of a parameter.
  subroutine refuse_set_by_parameter(document, name, place, err)
    type(document_type), intent(in) :: document            !< checked, with the number
    character(len=*), intent(in) :: name                   !< of the number
    type(number_place_type), intent(in) :: place           !< of the number
    type(error_type), allocatable, intent(out) :: err      !< allocated if a parameter with a value sets it
    type(document_type) :: placed
    type(parameter_type), allocatable :: parameters(:)
    type(diagnostics_type) :: diagnostics
    integer, allocatable :: groups(:)
    integer :: i, source

    placed = document
    call diagnostics%add_source(placed%source, source)
    call read_parameters(placed, parameters, diagnostics)
    groups = groups_named(placed, 'parameter')
    do i = 1, size(parameters)
      if (.not. has_name(placed%groups(groups(i)), 'value')) cycle
      associate (targets => parameters(i)%targets)
        if (.not. any(targets%group_place == place%group .and. targets%item_place == place%item .and. &
                      targets%position == place%value)) cycle
      end associate
      call raise(err, exit_usage, 'parameter '''//parameters(i)%name//''' sets '//trim(name)//'; set parameter('//to_text(i)// &
                 ').value in its place')
      return
    end do
  end subroutine refuse_set_by_parameter

  !> The mechanism as the text of a data file, without comments; empty where there is no mechanism.
  subroutine text(self, written)
    class(checked_mechanism_type), intent(in) :: self         !< the mechanism
    character(len=:), allocatable, intent(out) :: written     !< read_text makes the same mechanism of it

    written = ''
    if (self%is_read) call text_of_document(self%document, written)
  end subroutine text

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
    integer :: source

    call require(self, err)
    if (allocated(err)) return
    call diagnostics%add_source(self%document%source, source)
    call read_model(self%document, program, model, diagnostics)
    call fail_as(diagnostics, err)
  end subroutine take_request

  !> The model as a function of its parameters.
  subroutine take_variable(self, program, variable)
    class(checked_mechanism_type), intent(in) :: self      !< the mechanism
    integer, intent(in) :: program                         !< kinematics or dynamics
    type(varied_document_type), intent(out) :: variable    !< the function
    type(diagnostics_type) :: diagnostics
    integer :: source

    call diagnostics%add_source(self%document%source, source)
    call new_varied_document(self%document, diagnostics%sources, program, variable)
  end subroutine take_variable

  !> Complete the message of an error, with the line of the data file where it knows its place.
  subroutine point_at(self, err)
    class(checked_mechanism_type), intent(in) :: self             !< the mechanism
    type(error_type), allocatable, intent(inout) :: err           !< nothing happens where it is not allocated
    type(diagnostics_type) :: diagnostics
    integer :: source

    if (.not. allocated(err)) return
    call explain(err)
    if (err%place%line == 0) return
    call diagnostics%add_source(self%document%source, source)
    call diagnostics%add_error(err)
    call diagnostics%render(1, err%message)
  end subroutine point_at

  !> All errors of reading as one failure; none where there are none.
  subroutine fail_as(diagnostics, err)
    type(diagnostics_type), intent(in) :: diagnostics   !< the errors, and the texts that they stand in
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is an error
    character(len=:), allocatable :: text, message
    integer :: i

    if (.not. diagnostics%failed()) return
    message = ''
    do i = 1, min(diagnostics%known(), most_told)
      call diagnostics%render(i, text)
      if (i > 1) message = message//new_line('a')
      message = message//text
    end do
    call raise(err, diagnostics%code(), message)
  end subroutine fail_as
end module mech9_checked_mechanism
