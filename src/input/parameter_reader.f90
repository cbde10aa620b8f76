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
  use mech9_parameter, only: parameter_type, parameter_target_type
  implicit none
  private
  public :: read_parameters, place_parameters

contains

  !> Read all groups &parameter, and set the numbers of the document that they name. A number and the value of its parameter may
  !> both come from --set: the later one then decides.
  pure subroutine read_parameters(document, parameters, diagnostics)
    type(document_type), intent(inout) :: document                     !< checked; gets the numbers that the parameters set
    type(parameter_type), allocatable, intent(out) :: parameters(:)    !< one for each sound group, in their order
    type(diagnostics_type), intent(inout) :: diagnostics               !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i, found

    numbers = groups_named(document, 'parameter')
    allocate (parameters(size(numbers)))
    if (size(numbers) == 0) return
    found = diagnostics%count
    do i = 1, size(numbers)
      call read_settings(document%groups(numbers(i)), parameters(i), diagnostics)
      call read_targets(document, numbers(i), parameters(i), diagnostics)
      call check_targets(document, parameters(:i), numbers(i), diagnostics)
      if (diagnostics%count == found) call find_value(document, numbers(i), parameters(i), diagnostics)
    end do
    call scale_items(document)      ! of numbers that have their defaults, too
    if (diagnostics%count == found) call place_parameters(document, parameters, diagnostics)
  end subroutine read_parameters

  !> Read the name and the numbers of a parameter.
  pure subroutine read_settings(group, parameter, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(parameter_type), intent(inout) :: parameter      !< gets the names and numbers of the group
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors

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
    associate (names => group%items(find_item(group, 'sets'))%values)
      allocate (parameter%targets(size(names)))
      do i = 1, size(names)
        call find_number(document, names(i)%text, names(i)%span, has_name(group, 'value'), place, diagnostics)
        associate (name => place%name)
          parameter%targets(i) = parameter_target_type(names(i)%text, name%group, name%number, name%item, name%position, &
                                                       group_place=place%group, item_place=place%item)
        end associate
        if (place%group == 0) cycle
        document%groups(place%group)%items(place%item)%row = place%row
        parameter%targets(i)%unit = item_table(place%row)%unit
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
    type(span_type) :: from, own
    integer :: i

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
      from = span_of(group, 'value', 1)
    end associate
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

  !> Set the numbers of a document that parameters set to their values. Numbers outside the range of their names are reported.
  pure subroutine place_parameters(document, parameters, diagnostics, changed)
    type(document_type), intent(inout) :: document        !< checked, with an item for each target
    type(parameter_type), intent(in) :: parameters(:)     !< all parameters, with their values
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical, intent(inout), optional :: changed(:)        !< (groups) set where numbers change; others are not checked again
    integer :: i, j
    real(wp) :: number

    do i = 1, size(parameters)
      do j = 1, size(parameters(i)%targets)
        associate (target => parameters(i)%targets(j))
          if (target%group_place == 0) cycle
          number = target%factor*parameters(i)%value + target%term
          associate (value => document%groups(target%group_place)%items(target%item_place)%values(target%position), &
                     row => document%groups(target%group_place)%items(target%item_place)%row)
            if (present(changed)) then
              if (same_bits(value%number, number)) cycle
              changed(target%group_place) = .true.
            end if
            value%kind = value_real
            value%number = number
            if (.not. is_sensible(number)) then
              call diagnostics%add(value%span, 'parameter '''//parameters(i)%name//''' sets this number to '// &
                                   to_text(number)//', which is too large or too small')
            else if (.not. is_in_range(number, item_table(row))) then
              call diagnostics%add(value%span, 'parameter '''//parameters(i)%name//''' sets '//trim(target%name)//' to '// &
                                   to_text(number)//', and '''//trim(target%item)//''' must be '//trim(item_table(row)%range))
            end if
          end associate
        end associate
      end do
    end do
  end subroutine place_parameters

  !> Whether two numbers are the same, the sign of a zero included.
  pure logical function same_bits(a, b)
    real(wp), intent(in) :: a   !< a number
    real(wp), intent(in) :: b   !< another one

    same_bits = transfer(a, 1_long) == transfer(b, 1_long)
  end function same_bits
end module mech9_parameter_reader
