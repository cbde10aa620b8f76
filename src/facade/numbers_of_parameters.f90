!> Numbers that follow the values of parameters: nothing else may set them.
module mech9_numbers_of_parameters
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: to_text
  use mech9_source, only: source_type
  use mech9_document, only: document_type
  use mech9_named_number, only: number_place_type
  use mech9_lookup, only: has_name, groups_named
  use mech9_checker, only: check_document
  use mech9_parameter, only: parameter_type, parameter_target_type
  use mech9_formula_parameters, only: formula_parameters_type
  use mech9_parameter_reader, only: read_parameters, groups_of_parameters
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: refuse_set_by_parameter, refuse_override, find_unwritten_value

contains

  !> Refuse to set a number that follows the value of a parameter.
  subroutine refuse_set_by_parameter(document, sources, name, place, err)
    type(document_type), intent(in) :: document            !< checked, with the number
    type(source_type), intent(in) :: sources(:)            !< the texts that it comes from
    character(len=*), intent(in) :: name                   !< of the number
    type(number_place_type), intent(in) :: place           !< of the number
    type(error_type), allocatable, intent(out) :: err      !< allocated if a parameter with a value or a formula sets it
    type(document_type) :: placed
    type(parameter_type), allocatable :: parameters(:)
    type(formula_parameters_type) :: formulas
    type(diagnostics_type) :: diagnostics
    integer, allocatable :: groups(:)
    integer :: i

    placed = document
    diagnostics%sources = sources
    call read_parameters(placed, parameters, diagnostics, formulas)
    do i = 1, size(formulas%results)
      if (.not. is_among(place, formulas%results(i)%targets)) cycle
      call raise(err, exit_usage, 'the formula of parameter '''//formulas%results(i)%name//''' sets '//trim(name)// &
                 '; set parameter('//to_text(formulas%results(i)%number)//').formula, or a parameter that it names')
      return
    end do
    groups = groups_of_parameters(placed)
    do i = 1, size(parameters)
      if (.not. has_name(placed%groups(groups(i)), 'value')) cycle
      if (.not. is_among(place, parameters(i)%targets)) cycle
      call raise(err, exit_usage, 'parameter '''//parameters(i)%name//''' sets '//trim(name)//'; set parameter('// &
                 to_text(count(groups_named(placed, 'parameter') <= groups(i)))//').value in its place')
      return
    end do
  end subroutine refuse_set_by_parameter

  !> Whether a number is one of those that a parameter sets.
  pure logical function is_among(place, targets)
    type(number_place_type), intent(in) :: place             !< of the number
    type(parameter_target_type), intent(in) :: targets(:)    !< numbers that the parameter sets

    is_among = any(targets%group_place == place%group .and. targets%item_place == place%item .and. targets%position == place%value)
  end function is_among

  !> Refuse a setting of a number that follows the value of a parameter.
  subroutine refuse_override(document, sources, err)
    type(document_type), intent(in) :: document            !< with the setting
    type(source_type), intent(in) :: sources(:)            !< the texts that it comes from
    type(error_type), allocatable, intent(out) :: err      !< allocated if a parameter with a value sets the number
    type(document_type) :: placed
    type(parameter_type), allocatable :: parameters(:)
    type(formula_parameters_type) :: formulas
    type(diagnostics_type) :: diagnostics
    integer, allocatable :: groups(:)
    integer :: i

    placed = document
    diagnostics%sources = sources
    call check_document(placed, diagnostics)
    call read_parameters(placed, parameters, diagnostics, formulas)
    do i = 1, size(parameters)
      if (.not. parameters(i)%is_overruled) cycle
      groups = groups_of_parameters(placed)
      call raise(err, exit_usage, 'parameter '''//parameters(i)%name//''' sets this number; set parameter('// &
                 to_text(count(groups_named(placed, 'parameter') <= groups(i)))//').value in its place')
      return
    end do
    do i = 1, size(formulas%results)
      if (.not. formulas%results(i)%is_overruled) cycle
      call raise(err, exit_usage, 'the formula of parameter '''//formulas%results(i)%name//''' sets this number; set parameter('// &
                 to_text(formulas%results(i)%number)//').formula, or a parameter that it names')
      return
    end do
  end subroutine refuse_override

  !> Find the value of a parameter whose group gives none: that of the number which it sets.
  subroutine find_unwritten_value(document, place, diagnostics, value, err)
    type(document_type), intent(in) :: document                 !< checked; an item of the name was added at the end of its group
    type(number_place_type), intent(in) :: place                !< of that item
    type(diagnostics_type), intent(in) :: diagnostics           !< with the sources
    real(wp), intent(inout) :: value                            !< in the unit of the data file; unchanged where it is no such value
    type(error_type), allocatable, intent(inout) :: err         !< not allocated on return where it is found
    type(document_type) :: written
    type(parameter_type), allocatable :: parameters(:)
    type(diagnostics_type) :: none_found
    integer, allocatable :: groups(:)
    integer :: i

    associate (group => document%groups(place%group))
      if (group%name /= 'parameter') return
      if (group%items(place%item)%name /= 'value') return
    end associate
    written = document
    associate (group => written%groups(place%group))
      group%items = group%items(:size(group%items) - 1)
    end associate
    none_found%sources = diagnostics%sources
    groups = groups_of_parameters(written)
    call read_parameters(written, parameters, none_found)
    if (none_found%failed()) return
    do i = 1, size(groups)
      if (groups(i) /= place%group) cycle
      value = parameters(i)%value
      if (allocated(err)) deallocate (err)
    end do
  end subroutine find_unwritten_value
end module mech9_numbers_of_parameters
