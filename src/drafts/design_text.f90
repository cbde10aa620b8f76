!> The data file of a design: the text of the data file with other values of the parameters, and with the assembly of its start.
module mech9_design_text
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: get_integer, has_name
  use mech9_part_names, only: part_names_type
  use mech9_part_name_check, only: find_part_names, number_references
  use mech9_diagnostics, only: diagnostics_type
  use mech9_changed_text, only: set_number, full_number
  use mech9_coupling, only: coupling_type
  use mech9_linear_coupling, only: linear_coupling_type
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of
  implicit none
  private
  public :: text_of_design

  character, parameter :: line_end = achar(10)

contains

  !> Form the text of the data file with other values of its parameters, and with the coordinates of an assembly at its
  !> start.
  pure subroutine text_of_design(document, model, values, q, history, text)
    type(document_type), intent(in) :: document            !< the data file, without changes by --set
    type(model_type), intent(in) :: model                  !< the model of the design
    real(wp), intent(in) :: values(:)                      !< of all parameters
    real(wp), intent(in) :: q(:)                           !< (M) coordinates at the start [rad, m]
    character(len=*), intent(in) :: history                !< comments for its beginning, as whole lines
    character(len=:), allocatable, intent(out) :: text     !< of the design's data file
    type(document_type) :: numbered
    type(part_names_type) :: names
    type(diagnostics_type) :: ignored
    logical :: given(size(q))
    integer :: i, k, c, group

    text = document%source%text
    if (text(len(text):) /= line_end) text = text//line_end
    given = model%problem%partition%independent()
    numbered = document
    call find_part_names(numbered, names)
    call number_references(numbered, names, .false., ignored)
    i = size(values) + 1
    c = 1
    if (allocated(model%mechanism%couplings)) c = size(model%mechanism%couplings) + 1
    ! from the end on, so that places before it stay right
    do group = size(document%groups), 1, -1
      if (document%groups(group)%name == 'parameter') then
        if (has_name(document%groups(group), 'formula')) cycle
        i = i - 1
        call set_number(document%groups(group), 'value', values(i), text)
      else if (document%groups(group)%name == 'coupling') then
        c = c - 1
        call keep_phase(document%groups(group), model, model%mechanism%couplings(c)%coupling, text)
      else if (document%groups(group)%name == 'initial') then
        k = get_integer(numbered%groups(group), 'coordinate')
        if (given(k)) cycle
        given(k) = .true.
        call set_number(document%groups(group), 'position', q(k)/unit_of(model%mechanism, k), text)
      end if
    end do
    do k = 1, size(q)
      if (.not. given(k)) text = text//'&initial coordinate='//to_text(k)//', position='// &
                                 full_number(q(k)/unit_of(model%mechanism, k))//' /'//line_end
    end do
    text = history//text
  end subroutine text_of_design

  !> Give a coupling its constant where this would follow from the positions in &initial, which are others now.
  pure subroutine keep_phase(group, model, coupling, text)
    type(group_type), intent(in) :: group                      !< the group of the coupling
    type(model_type), intent(in) :: model                      !< the model of the design
    class(coupling_type), intent(in) :: coupling               !< the coupling
    character(len=:), allocatable, intent(inout) :: text       !< of the data file

    select type (coupling)
    type is (linear_coupling_type)
      if (coupling%name == 'linear' .or. has_name(group, 'phase')) return
      call set_number(group, 'phase', coupling%constant/unit_of(model%mechanism, coupling%coordinates(2)), text)
    end select
  end subroutine keep_phase
end module mech9_design_text
