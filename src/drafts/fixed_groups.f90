!> The groups of a data file that make the mechanism, as text: times, tolerances, results and what parameters set are left out. By it a
!> program that was made for one mechanism knows that mechanism.
module mech9_fixed_groups
  use mech9_text, only: to_text
  use mech9_source, only: source_type
  use mech9_document, only: document_type, group_type, item_type, value_word
  use mech9_document_text, only: text_of_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_checker, only: check_document
  use mech9_parameter, only: parameter_type, parameter_target_type
  use mech9_parameter_reader, only: read_parameters
  use mech9_formula_parameters, only: formula_parameters_type
  implicit none
  private
  public :: fixed_groups, first_difference

  !> Groups that may change.
  character(len=*), parameter :: variable_groups(*) = [character(len=9) :: 'time', 'solver', 'output', 'study', 'objective', &
    'limit', 'optimum', 'section', 'quantity', 'exponents', 'periodic', 'branch', 'cam', 'point']
  !> Names of &parameter that may change; the title of &mechanism may, too.
  character(len=*), parameter :: variable_names(*) = [character(len=12) :: 'value', 'low', 'high', 'count', 'spread', &
    'distribution']

contains

  !> Form the text. It is empty where the document has errors, which its reader tells.
  subroutine fixed_groups(document, sources, text)
    type(document_type), intent(in) :: document                !< the data file as groups and items, with the changes by --set
    type(source_type), intent(in) :: sources(:)                !< the texts that it comes from
    character(len=:), allocatable, intent(out) :: text         !< a line for each name, under that of its group
    type(document_type) :: fixed
    type(diagnostics_type) :: diagnostics
    type(parameter_type), allocatable :: parameters(:)
    type(formula_parameters_type) :: formulas
    integer :: i

    text = ''
    fixed = document
    diagnostics%sources = sources
    call check_document(fixed, diagnostics)
    if (.not. diagnostics%failed()) call read_parameters(fixed, parameters, diagnostics, formulas)
    if (diagnostics%failed()) return
    do i = 1, size(parameters)
      call blank_targets(parameters(i)%targets, fixed)
    end do
    do i = 1, size(formulas%results)
      call blank_targets(formulas%results(i)%targets, fixed)
    end do
    call leave_out_variable(fixed)
    call text_of_document(fixed, text)
  end subroutine fixed_groups

  !> Replace numbers that a parameter sets by a word.
  subroutine blank_targets(targets, document)
    type(parameter_target_type), intent(in) :: targets(:)      !< the numbers
    type(document_type), intent(inout) :: document             !< checked
    integer :: i

    do i = 1, size(targets)
      associate (values => document%groups(targets(i)%group_place)%items(targets(i)%item_place)%values)
        if (targets(i)%position > size(values)) cycle
        values(targets(i)%position)%kind = value_word
        values(targets(i)%position)%text = 'variable'
      end associate
    end do
  end subroutine blank_targets

  !> Leave out groups and names that may change.
  subroutine leave_out_variable(document)
    type(document_type), intent(inout) :: document             !< checked
    type(group_type), allocatable :: kept(:)
    integer :: i, n

    allocate (kept(size(document%groups)))
    n = 0
    do i = 1, size(document%groups)
      if (any(variable_groups == document%groups(i)%name)) cycle
      n = n + 1
      kept(n) = document%groups(i)
      if (kept(n)%name == 'parameter') call leave_out_items(variable_names, kept(n))
      if (kept(n)%name == 'mechanism') call leave_out_items(['title'], kept(n))
      call sort_items(kept(n))
    end do
    deallocate (document%groups)
    allocate (document%groups(n))
    do i = 1, n
      document%groups(i) = kept(i)
    end do
  end subroutine leave_out_variable

  !> Put the names of a group into alphabetic order: that in which they are written, or changed by --set, does not matter.
  subroutine sort_items(group)
    type(group_type), intent(inout) :: group        !< the group
    type(item_type) :: moved
    integer :: i, j

    do i = 2, size(group%items)
      do j = i, 2, -1
        if (.not. group%items(j)%name < group%items(j - 1)%name) exit
        moved = group%items(j)
        group%items(j) = group%items(j - 1)
        group%items(j - 1) = moved
      end do
    end do
  end subroutine sort_items

  !> Leave names out of a group.
  subroutine leave_out_items(names, group)
    character(len=*), intent(in) :: names(:)        !< the names
    type(group_type), intent(inout) :: group        !< the group
    type(item_type), allocatable :: kept(:)
    integer :: i, n

    allocate (kept(count_others()))
    n = 0
    do i = 1, size(group%items)
      if (any(names == group%items(i)%name)) cycle
      n = n + 1
      kept(n) = group%items(i)
    end do
    call move_alloc(kept, group%items)

  contains

    !> Number of the other names.
    pure integer function count_others()
      integer :: k

      count_others = 0
      do k = 1, size(group%items)
        if (all(names /= group%items(k)%name)) count_others = count_others + 1
      end do
    end function count_others
  end subroutine leave_out_items

  !> Find the first lines by which two texts differ, and the group in which they stand.
  subroutine first_difference(one, other, group, line_of_one, line_of_other)
    character(len=*), intent(in) :: one                               !< a text of fixed_groups
    character(len=*), intent(in) :: other                             !< another one
    character(len=:), allocatable, intent(out) :: group               !< name and number, as '&pair 2'; empty: they are equal
    character(len=:), allocatable, intent(out) :: line_of_one         !< of one; empty: it has none there
    character(len=:), allocatable, intent(out) :: line_of_other       !< of the other
    character(len=:), allocatable :: name
    integer :: at(2), i, number

    group = ''
    name = ''
    at = 1
    do while (at(1) <= len(one) .or. at(2) <= len(other))
      call next_line(one, at(1), line_of_one)
      call next_line(other, at(2), line_of_other)
      if (index(line_of_one, '&') == 1) name = line_of_one(2:)
      if (line_of_one /= line_of_other .or. len(line_of_one) /= len(line_of_other)) exit
    end do
    if (line_of_one == line_of_other) return
    if (index(line_of_other, '&') == 1 .and. index(line_of_one, '&') /= 1) name = line_of_other(2:)
    number = 0
    do i = 1, min(at(1), len(one)) - 1
      if (one(i:i) == '&' .and. index(one(i:), '&'//name//new_line('a')) == 1) number = number + 1
    end do
    group = '&'//name
    if (number > 0) group = group//' '//to_text(number)
  end subroutine first_difference

  !> Take the next line of a text, without the blanks at its beginning.
  subroutine next_line(text, at, line)
    character(len=*), intent(in) :: text                       !< the text
    integer, intent(inout) :: at                               !< place of the first letter of the line; of the next one afterwards
    character(len=:), allocatable, intent(out) :: line         !< without its end; empty at the end of the text
    integer :: length

    line = ''
    if (at > len(text)) return
    length = index(text(at:)//new_line('a'), new_line('a')) - 1
    line = trim(adjustl(text(at:at + length - 1)))
    at = at + length + 1
  end subroutine next_line
end module mech9_fixed_groups
