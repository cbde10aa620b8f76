!> The model of a data file as a function of its parameters: the file is read and checked once, and its numbers change in memory.
!>
!> The model is kept. Where other values of the parameters change few groups of the document, only these are read again; the result
!> has the same bits as reading all, and where a number is wrong all is read, so that the message is the same, too.
module mech9_varied_document
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise
  use mech9_source, only: source_type, span_type
  use mech9_document, only: document_type
  use mech9_checker, only: check_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parameter, only: parameter_type
  use mech9_parameter_reader, only: read_parameters, place_parameters
  use mech9_formula_parameters, only: formula_parameters_type
  use mech9_reader, only: read_checked
  use mech9_rod_holding, only: hold_idle_rods
  use mech9_changed_groups, only: group_map_type, map_groups, read_changed
  use mech9_model, only: model_type
  use mech9_variable_model, only: variable_model_type
  implicit none
  private
  public :: varied_document_type, new_varied_document

  type, extends(variable_model_type) :: varied_document_type
    private
    type(document_type) :: document                       !< checked, with an item for each target
    type(group_map_type) :: map                           !< of its groups
    type(diagnostics_type) :: diagnostics                 !< with the texts that the document comes from; without errors
    type(parameter_type), allocatable :: parameters(:)
    type(formula_parameters_type) :: formulas             !< parameters whose values follow from these
    integer :: program = kinematics                       !< or dynamics
    type(model_type), allocatable :: kept                 !< of the present document, without held rods; only where it is right
  contains
    procedure :: at
    procedure :: along => document_along
  end type varied_document_type

contains

  !> Prepare a document that has been read without errors.
  subroutine new_varied_document(document, sources, program, varied)
    type(document_type), intent(in) :: document           !< the data file as groups and items, with the changes by --set
    type(source_type), intent(in) :: sources(:)           !< the texts that it comes from, for messages: those of its diagnostics
    integer, intent(in) :: program                        !< kinematics, where every independent coordinate must be driven, or dynamics
    type(varied_document_type), intent(out) :: varied     !< the model as a function of the parameters

    varied%document = document
    varied%program = program
    varied%diagnostics%sources = sources
    call check_document(varied%document, varied%diagnostics)
    call read_parameters(varied%document, varied%parameters, varied%diagnostics, varied%formulas)
    call varied%diagnostics%clear()
    call map_groups(varied%document, varied%map)
  end subroutine new_varied_document

  !> The model with other values of its parameters. Fails with the first error that a data file with these numbers would have.
  subroutine at(self, values, model, err)
    class(varied_document_type), intent(inout) :: self   !< the model as a function; it keeps these values
    real(wp), intent(in) :: values(:)                    !< of all parameters, in their order, in the units of the data file
    type(model_type), intent(out) :: model               !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    self%parameters%value = values
    call give(self, model, err)
  end subroutine at

  !> The model where one parameter has a larger value, and formulas follow it along their tangents at the values. Fails as `at`, and
  !> where a formula has no derivative there.
  subroutine document_along(self, values, number, distance, model, err)
    class(varied_document_type), intent(inout) :: self   !< the model as a function; it keeps these values
    real(wp), intent(in) :: values(:)                    !< of all parameters, in their order, in the units of the data file
    integer, intent(in) :: number                        !< of the parameter
    real(wp), intent(in) :: distance                     !< by which its value is larger
    type(model_type), intent(out) :: model               !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed

    self%parameters%value = values
    call give(self, model, err, number, distance)
    if (.not. allocated(err)) model%parameters(number)%value = values(number) + distance
  end subroutine document_along

  !> The model at the values of the parameters, or along the tangents of formulas.
  subroutine give(self, model, err, along, distance)
    type(varied_document_type), intent(inout) :: self    !< the model as a function, with the values
    type(model_type), intent(inout) :: model             !< of use only where nothing failed
    type(error_type), allocatable, intent(out) :: err    !< allocated if it failed
    integer, intent(in), optional :: along               !< number of a parameter
    real(wp), intent(in), optional :: distance           !< by which its value is larger

    if (allocated(self%kept)) call follow(self, along, distance)
    if (.not. allocated(self%kept)) call read_all(self, err, along, distance)
    if (allocated(err)) return
    model = self%kept
    model%parameters = self%parameters
    model%formulas = self%formulas%results
    call hold_idle_rods(model)
  end subroutine give

  !> Let the kept model follow the values of the parameters. It is given up where the whole document must be read, or a number is
  !> wrong.
  subroutine follow(self, along, distance)
    type(varied_document_type), intent(inout) :: self   !< the model as a function
    integer, intent(in), optional :: along              !< number of a parameter
    real(wp), intent(in), optional :: distance          !< by which its value is larger
    logical :: changed(size(self%document%groups))

    changed = .false.
    call place_parameters(self%document, self%parameters, self%formulas, self%diagnostics, changed, along, distance)
    if (all(self%map%is_alone .or. .not. changed) .and. .not. self%diagnostics%failed()) then
      call read_changed(self%document, changed, self%map, self%kept, self%diagnostics)
      if (.not. self%diagnostics%failed()) return
    end if
    deallocate (self%kept)
    call self%diagnostics%clear()
  end subroutine follow

  !> Read the whole document. Fails with its first error; then no model is kept.
  subroutine read_all(self, err, along, distance)
    type(varied_document_type), intent(inout) :: self   !< the model as a function
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    integer, intent(in), optional :: along              !< number of a parameter
    real(wp), intent(in), optional :: distance          !< by which its value is larger
    character(len=:), allocatable :: text
    type(span_type) :: span

    allocate (self%kept)
    call place_parameters(self%document, self%parameters, self%formulas, self%diagnostics, along=along, distance=distance)
    self%kept%program = self%program
    self%kept%parameters = self%parameters
    if (.not. self%diagnostics%failed() .or. size(self%formulas%results) == 0) &
      call read_checked(self%document, self%kept, self%diagnostics)
    if (.not. self%diagnostics%failed()) return
    call self%diagnostics%get(1, text, span)
    call raise(err, self%diagnostics%code(), text, self%diagnostics%place(span))
    deallocate (self%kept)
    call self%diagnostics%clear()
  end subroutine read_all
end module mech9_varied_document
