!> The groups &parameter of a checked document, and the numbers of the document that they set.
module mech9_parameter_reader
  use mech9_kinds, only: wp, long
  use mech9_text, only: to_text
  use mech9_source, only: span_type
  use mech9_grammar, only: item_table
  use mech9_document, only: document_type, group_type, value_real
  use mech9_item_units, only: scale_items
  use mech9_lookup, only: groups_named, find_item, has_name, count_values, get_integer, get_real, get_reals, get_text, span_of
  use mech9_item_check, only: is_in_range, is_sensible
  use mech9_named_number, only: number_place_type, find_number
  use mech9_name_check, only: check_name
  use mech9_diagnostics, only: diagnostics_type
  use mech9_formula_parameters, only: formula_parameters_type, read_formulas, evaluate_formulas
  use mech9_parameter, only: parameter_type, parameter_target_type
  implicit none
  private
  public :: read_parameters, place_parameters, groups_of_parameters

  !> A unit among others, of which none is named.
  character(len=*), parameter :: unknown_unit = '1 or another'

contains

  !> Read all groups &parameter, and set the numbers of the document that they name. A number and the value of its parameter may
  !> both come from --set: the later one then decides.
  pure subroutine read_parameters(document, parameters, diagnostics, formulas)
    type(document_type), intent(inout) :: document                     !< checked; gets the numbers that the parameters set
    type(parameter_type), allocatable, intent(out) :: parameters(:)    !< one for each sound group without a formula, in their order
    type(diagnostics_type), intent(inout) :: diagnostics               !< gets the errors
    type(formula_parameters_type), intent(out), optional :: formulas   !< those with a formula
    type(parameter_type), allocatable :: all(:)
    type(formula_parameters_type) :: bound
    logical, allocatable :: is_formula(:)
    integer, allocatable :: numbers(:), free(:)
    integer :: i, found

    numbers = groups_named(document, 'parameter')
    allocate (all(size(numbers)), is_formula(size(numbers)))
    found = diagnostics%count
    do i = 1, size(numbers)
      is_formula(i) = has_name(document%groups(numbers(i)), 'formula')
      call read_settings(document%groups(numbers(i)), all(i), diagnostics)
      call read_targets(document, numbers(i), all(i), diagnostics)
      call check_targets(document, all(:i), numbers(i), diagnostics)
      if (diagnostics%count > found) cycle
      if (is_formula(i)) then
        call leave_overruled(document, numbers(i), all(i), diagnostics)
      else
        call find_value(document, numbers(i), all(i), diagnostics)
      end if
    end do
    call scale_items(document)      ! of numbers that have their defaults, too
    call read_formulas(document, numbers, is_formula, bound, diagnostics)
    free = pack([(i, i=1, size(numbers))], .not. is_formula)
    allocate (parameters(size(free)))
    do i = 1, size(free)
      parameters(i) = all(free(i))
    end do
    call join_formulas(all, is_formula, parameters, bound)
    if (diagnostics%count == found) call check_use(document, numbers(free), parameters, bound, diagnostics)
    if (diagnostics%count == found) call place_parameters(document, parameters, bound, diagnostics)
    if (present(formulas)) formulas = bound
  end subroutine read_parameters

  !> Give formulas the numbers that they set, and tell parameters which numbers are set by formulas in which they have a part.
  pure subroutine join_formulas(all, is_formula, parameters, formulas)
    type(parameter_type), intent(in) :: all(:)                  !< of all groups
    logical, intent(in) :: is_formula(:)                        !< true for those with a formula
    type(parameter_type), intent(inout) :: parameters(:)        !< those without a formula
    type(formula_parameters_type), intent(inout) :: formulas    !< those with one
    integer :: i, j

    j = 0
    do i = 1, size(all)
      if (.not. is_formula(i)) cycle
      j = j + 1
      associate (result => formulas%results(j))
        result%name = all(i)%name
        result%text = all(i)%formula
        result%targets = all(i)%targets
        result%note = all(i)%note
        result%is_overruled = all(i)%is_overruled
        result%number = i
      end associate
    end do
    do i = 1, size(parameters)
      allocate (parameters(i)%through(0))
      do j = 1, size(formulas%results)
        if (formulas%depends(j, i)) parameters(i)%through = [parameters(i)%through, formulas%results(j)%targets]
      end do
    end do
  end subroutine join_formulas

  !> Report parameters that set no number and stand in no formula.
  pure subroutine check_use(document, groups, parameters, formulas, diagnostics)
    type(document_type), intent(in) :: document                 !< checked
    integer, intent(in) :: groups(:)                            !< positions of the groups of the parameters
    type(parameter_type), intent(in) :: parameters(:)           !< those without a formula
    type(formula_parameters_type), intent(in) :: formulas       !< those with one
    type(diagnostics_type), intent(inout) :: diagnostics        !< gets the errors
    integer :: i

    do i = 1, size(parameters)
      if (parameters(i)%is_overruled .or. size(parameters(i)%targets) > 0 .or. any(formulas%depends(:, i))) cycle
      call diagnostics%add(document%groups(groups(i))%span, 'parameter '''//parameters(i)%name//''' sets no number, and no '// &
                           'formula names it; give ''sets''')
    end do
  end subroutine check_use

  !> Positions of the groups of parameters without a formula, in the order of the file.
  pure function groups_of_parameters(document) result(numbers)
    type(document_type), intent(in) :: document    !< checked
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_named(document, 'parameter')
    numbers = pack(numbers, [(.not. has_name(document%groups(numbers(i)), 'formula'), i=1, size(numbers))])
  end function groups_of_parameters

  !> Read the name and the numbers of a parameter.
  pure subroutine read_settings(group, parameter, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(parameter_type), intent(inout) :: parameter      !< gets the names and numbers of the group
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    character(len=12), parameter :: of_values(6) = [character(len=12) :: 'value', 'low', 'high', 'count', 'spread', 'distribution']
    integer :: i

    parameter%name = get_text(group, 'name')
    call check_name(group, parameter%name, diagnostics)
    parameter%note = ''
    parameter%place = diagnostics%place(group%span)
    parameter%has_range = has_name(group, 'low') .and. has_name(group, 'high')
    if (has_name(group, 'low') .neqv. has_name(group, 'high')) &
      call diagnostics%add(group%span, 'a parameter has both ''low'' and ''high'', or neither')
    if (parameter%has_range) then
      parameter%low = get_real(group, 'low')
      parameter%high = get_real(group, 'high')
      if (parameter%low >= parameter%high) &
        call diagnostics%add(span_of(group, 'high', 1), '''high'' must be greater than ''low''')
    end if
    if (has_name(group, 'count')) parameter%count = get_integer(group, 'count')
    if (has_name(group, 'spread')) parameter%spread = get_real(group, 'spread')
    parameter%uniform = get_text(group, 'distribution') == 'uniform'
    if (.not. has_name(group, 'formula')) return
    parameter%formula = get_text(group, 'formula')
    do i = 1, size(of_values)
      if (has_name(group, trim(of_values(i)))) &
        call diagnostics%add(span_of(group, trim(of_values(i))), ''''//trim(of_values(i))//''' does not belong to a parameter '// &
                             'with a formula: its value follows from those of others')
    end do
  end subroutine read_settings

  !> Find the numbers that a parameter sets.
  pure subroutine read_targets(document, number, parameter, diagnostics)
    type(document_type), intent(inout) :: document        !< checked; gets items for defaults
    integer, intent(in) :: number                         !< position of the parameter's group
    type(parameter_type), intent(inout) :: parameter      !< gets its targets
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(number_place_type) :: place
    type(group_type) :: group
    integer :: i

    group = document%groups(number)
    if (.not. has_name(group, 'sets')) then
      allocate (parameter%targets(0))
      if (.not. has_name(group, 'value') .and. .not. has_name(group, 'formula')) &
        call diagnostics%add(group%span, 'parameter '''//parameter%name//''' needs ''sets'', or for formulas alone its ''value''')
      return
    end if
    associate (names => group%items(find_item(group, 'sets'))%values)
      allocate (parameter%targets(size(names)))
      do i = 1, size(names)
        call find_number(document, names(i)%text, names(i)%span, has_name(group, 'value') .or. has_name(group, 'formula'), place, &
                         diagnostics)
        associate (name => place%name)
          parameter%targets(i) = parameter_target_type(names(i)%text, name%group, name%number, name%item, name%position, &
                                                       group_place=place%group, item_place=place%item)
        end associate
        if (place%group == 0) cycle
        document%groups(place%group)%items(place%item)%row = place%row
        parameter%targets(i)%unit = item_table(place%row)%unit
        if (follows_variable(document%groups(place%group), item_table(place%row)%name)) parameter%targets(i)%unit = unknown_unit
        if (has_name(document%groups(place%group), 'coordinate')) &
          parameter%targets(i)%coordinate = get_integer(document%groups(place%group), 'coordinate')
      end do
    end associate
    call read_each(group, 'factors', parameter%targets%factor, diagnostics)
    call read_each(group, 'terms', parameter%targets%term, diagnostics)
    do i = 1, size(parameter%targets)
      if (abs(parameter%targets(i)%factor) > 0.0_wp) cycle
      call diagnostics%add(span_of(group, 'factors', min(i, count_values(group, 'factors'))), 'a factor of 0 takes the effect '// &
                           'from the parameter; give another one')
      exit
    end do
  end subroutine read_targets

  !> Whether the unit of a number contains that of the variable of a law, where this is not the time.
  pure logical function follows_variable(group, name)
    type(group_type), intent(in) :: group      !< the group of the number
    character(len=*), intent(in) :: name       !< of the item

    follows_variable = .false.
    if (all(group%name /= [character(len=5) :: 'load', 'motor'])) return
    if (any(name == [character(len=17) :: 'coefficients', 'angular_frequency', 'times', 'period'])) &
      follows_variable = has_name(group, 'over')
  end function follows_variable

  !> Read one number for each target; a single one holds for all.
  pure subroutine read_each(group, name, numbers, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the parameter
    character(len=*), intent(in) :: name                  !< of the item
    real(wp), intent(inout) :: numbers(:)                 !< one for each target
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp), allocatable :: given(:)

    given = get_reals(group, name)
    if (size(given) == 1) then
      numbers = given(1)
    else if (size(given) == size(numbers)) then
      numbers = given
    else
      call diagnostics%add(span_of(group, name), '''sets'' names '//to_text(size(numbers))//' numbers, and '''//name// &
                           ''' has '//to_text(size(given))//'; give one for each, or one for all')
    end if
  end subroutine read_each

  !> Report numbers that this parameter or one before sets too.
  pure subroutine check_targets(document, parameters, number, diagnostics)
    type(document_type), intent(in) :: document           !< checked
    type(parameter_type), intent(in) :: parameters(:)     !< the parameters that have been read; the last one is checked
    integer, intent(in) :: number                         !< position of its group
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer :: i, j, k, last

    last = size(parameters)
    do i = 1, size(parameters(last)%targets)
      do j = 1, last
        do k = 1, size(parameters(j)%targets)
          if (j == last .and. k >= i) exit
          if (.not. is_same(parameters(j)%targets(k), parameters(last)%targets(i))) cycle
          if (j == last) then
            call diagnostics%add(span_of(document%groups(number), 'sets', i), 'this number is named twice')
          else
            call diagnostics%add(span_of(document%groups(number), 'sets', i), 'parameter '''//parameters(j)%name// &
                                 ''' sets this number already; one parameter is enough')
          end if
        end do
      end do
    end do
  end subroutine check_targets

  !> Whether two targets are the same number of the document.
  pure logical function is_same(a, b)
    type(parameter_target_type), intent(in) :: a   !< a target
    type(parameter_target_type), intent(in) :: b   !< another one

    is_same = a%group_place > 0 .and. a%group_place == b%group_place .and. a%item_place == b%item_place .and. &
              a%position == b%position
  end function is_same

  !> Determine the value of a parameter: that of the file or of --set, or the one that its only target has. A target that a later
  !> --set has set keeps its number, and the parameter takes its value from it where it sets nothing else.
  pure subroutine find_value(document, number, parameter, diagnostics)
    type(document_type), intent(in) :: document           !< checked
    integer, intent(in) :: number                         !< position of the parameter's group
    type(parameter_type), intent(inout) :: parameter      !< gets its value
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical, allocatable :: later(:)

    associate (group => document%groups(number))
      if (any(parameter%targets%group_place == 0)) return   ! the group of a target has errors
      if (.not. has_name(group, 'value')) then
        if (size(parameter%targets) > 1) then
          call diagnostics%add(group%span, 'parameter '''//parameter%name//''' sets '//to_text(size(parameter%targets))// &
                               ' numbers; give its ''value''')
        else
          parameter%value = value_of_target(document, parameter%targets(1))
        end if
        return
      end if
      parameter%value = get_real(group, 'value')
      call find_later(document, span_of(group, 'value', 1), parameter, later, diagnostics)
    end associate
    if (.not. any(later)) return
    if (size(later) == 1) then
      parameter%value = value_of_target(document, parameter%targets(1))
      parameter%note = parameter%note//', whose value is now '//to_text(parameter%value, 12)
    else if (all(later)) then
      call diagnostics%add(document%groups(number)%span, 'each --set for a number that parameter '''//parameter%name// &
                           ''' sets takes it from the parameter, and none is left')
    else
      parameter%targets = pack(parameter%targets, .not. later)
    end if
  end subroutine find_value

  !> Take from a formula the numbers that a later --set has set.
  pure subroutine leave_overruled(document, number, parameter, diagnostics)
    type(document_type), intent(in) :: document           !< checked
    integer, intent(in) :: number                         !< position of the parameter's group
    type(parameter_type), intent(inout) :: parameter      !< with a formula
    type(diagnostics_type), intent(in) :: diagnostics     !< knows the settings
    logical, allocatable :: later(:)

    if (any(parameter%targets%group_place == 0)) return   ! the group of a target has errors
    call find_later(document, span_of(document%groups(number), 'formula', 1), parameter, later, diagnostics)
    parameter%targets = pack(parameter%targets, .not. later)
  end subroutine leave_overruled

  !> Mark the targets of a parameter that a later --set has set, and note which of both decides.
  pure subroutine find_later(document, from, parameter, later, diagnostics)
    type(document_type), intent(in) :: document             !< checked
    type(span_type), intent(in) :: from                     !< place of the parameter's value or formula
    type(parameter_type), intent(inout) :: parameter        !< gets the note
    logical, allocatable, intent(out) :: later(:)           !< (targets) a later --set decides
    type(diagnostics_type), intent(in) :: diagnostics       !< knows the settings
    type(span_type) :: own
    integer :: i

    allocate (later(size(parameter%targets)))
    do i = 1, size(later)
      own = span_of_target(document, parameter%targets(i))
      later(i) = own%source > from%source .and. diagnostics%is_setting(own)
      if (diagnostics%is_setting(own) .and. .not. later(i)) &
        parameter%note = '--set '//diagnostics%sources(from%source)%text//' stands after --set '// &
                         diagnostics%sources(own%source)%text//' and decides'
      if (later(i)) &
        parameter%note = '--set '//diagnostics%sources(own%source)%text//' decides, not parameter '''//parameter%name//''''
    end do
    parameter%is_overruled = any(later)
  end subroutine find_later

  !> The value of a parameter with which a target has its present number.
  pure real(wp) function value_of_target(document, target) result(value)
    type(document_type), intent(in) :: document           !< checked
    type(parameter_target_type), intent(in) :: target     !< the number of the document that it sets

    associate (item => document%groups(target%group_place)%items(target%item_place))
      value = (item%values(target%position)%number - target%term)/target%factor
    end associate
  end function value_of_target

  !> Place of the number that a target has in the file or in --set.
  pure type(span_type) function span_of_target(document, target) result(span)
    type(document_type), intent(in) :: document           !< checked
    type(parameter_target_type), intent(in) :: target     !< the number of the document that it sets

    span = document%groups(target%group_place)%items(target%item_place)%values(target%position)%span
  end function span_of_target

  !> Set the numbers of a document that parameters and formulas set to their values. Numbers outside the range of their names, and
  !> formulas without a value, are reported. With `along`, the value of this parameter is larger by `distance`, and formulas follow
  !> it along their tangents.
  pure subroutine place_parameters(document, parameters, formulas, diagnostics, changed, along, distance)
    type(document_type), intent(inout) :: document              !< checked, with an item for each target
    type(parameter_type), intent(in) :: parameters(:)           !< all parameters without formulas, with their values
    type(formula_parameters_type), intent(inout) :: formulas    !< those with formulas; they get their values
    type(diagnostics_type), intent(inout) :: diagnostics        !< gets the errors
    logical, intent(inout), optional :: changed(:)              !< (groups) set where numbers change; others are not checked again
    integer, intent(in), optional :: along                      !< number of a parameter
    real(wp), intent(in), optional :: distance                  !< by which its value is larger
    logical :: marks(size(document%groups))
    real(wp) :: value
    integer :: i, found

    found = diagnostics%count
    marks = .false.
    do i = 1, size(parameters)
      value = parameters(i)%value
      if (present(along)) value = merge(value + distance, value, i == along)
      call place_numbers(document, parameters(i)%targets, value, parameters(i)%name, present(changed), marks, diagnostics)
    end do
    if (size(formulas%results) > 0) then
      call evaluate_formulas(parameters%value, formulas, diagnostics, along, distance)
      if (diagnostics%count > found) return
      do i = 1, size(formulas%results)
        associate (result => formulas%results(i))
          call place_numbers(document, result%targets, result%value, result%name, present(changed), marks, diagnostics)
        end associate
      end do
    end if
    if (present(changed)) changed = changed .or. marks
  end subroutine place_parameters

  !> Set the numbers of a document that follow the value of a parameter.
  pure subroutine place_numbers(document, targets, value_of, name, only_changes, marks, diagnostics)
    type(document_type), intent(inout) :: document              !< checked, with an item for each target
    type(parameter_target_type), intent(in) :: targets(:)       !< the numbers
    real(wp), intent(in) :: value_of                            !< value of the parameter
    character(len=*), intent(in) :: name                        !< of the parameter
    logical, intent(in) :: only_changes                         !< numbers that stay are not checked
    logical, intent(inout) :: marks(:)                          !< (groups) set where such numbers change
    type(diagnostics_type), intent(inout) :: diagnostics        !< gets the errors
    real(wp) :: number
    integer :: j

    do j = 1, size(targets)
      associate (target => targets(j))
        if (target%group_place == 0) cycle
        number = target%factor*value_of + target%term
        associate (value => document%groups(target%group_place)%items(target%item_place)%values(target%position), &
                   row => document%groups(target%group_place)%items(target%item_place)%row)
          if (only_changes) then
            if (same_bits(value%number, number)) cycle
            marks(target%group_place) = .true.
          end if
          value%kind = value_real
          value%number = number
          if (.not. is_sensible(number)) then
            call diagnostics%add(value%span, 'parameter '''//name//''' sets this number to '//to_text(number)// &
                                 ', which is too large or too small')
          else if (.not. is_in_range(number, item_table(row))) then
            call diagnostics%add(value%span, 'parameter '''//name//''' sets '//trim(target%name)//' to '//to_text(number)// &
                                 ', and '''//trim(target%item)//''' must be '//trim(item_table(row)%range))
          end if
        end associate
      end associate
    end do
  end subroutine place_numbers

  !> Whether two numbers are the same, the sign of a zero included.
  pure logical function same_bits(a, b)
    real(wp), intent(in) :: a   !< a number
    real(wp), intent(in) :: b   !< another one

    same_bits = transfer(a, 1_long) == transfer(b, 1_long)
  end function same_bits
end module mech9_parameter_reader
