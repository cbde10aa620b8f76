!> Parameters whose values are formulas of others: their formulas, the order in which they follow from each other, and their values
!> with derivatives.
module mech9_formula_parameters
  use mech9_kinds, only: wp, radians_per_degree
  use mech9_text, only: nearest_name
  use mech9_formula, only: formula_type, formula_problem_type, parse_formula
  use mech9_formula_value, only: evaluate_formula
  use mech9_source, only: span_type
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: find_item, get_text, span_of, group_or_empty, has_unsound
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parameter, only: formula_result_type
  implicit none
  private
  public :: formula_parameters_type, read_formulas, evaluate_formulas, angle_unit_of

  !> One formula with the places of its variables.
  type :: bound_formula_type
    type(formula_type) :: formula
    integer, allocatable :: from(:)       !< of each variable: number of a parameter, or of a formula, which is negative
    character(len=:), allocatable :: name !< of the parameter that has this formula
    integer :: length = 0                 !< bytes of the formula's text
    type(span_type) :: span               !< of the formula in the data file
  end type bound_formula_type

  !> All formulas of a data file.
  type :: formula_parameters_type
    private
    type(bound_formula_type), allocatable :: bound(:)               !< in the order of the file
    integer, allocatable :: order(:)                                !< in which they are evaluated
    real(wp) :: angle_unit = 1.0_wp                                 !< of the data file [rad]
    logical, allocatable, public :: depends(:, :)                   !< (formulas, parameters) whether it has a part in the formula
    type(formula_result_type), allocatable, public :: results(:)    !< their values and the numbers that they set
  end type formula_parameters_type

contains

  !> Read the formulas of the groups &parameter that have one. Formulas may name parameters and each other, in any order.
  pure subroutine read_formulas(document, groups, is_formula, formulas, diagnostics)
    type(document_type), intent(in) :: document                    !< checked
    integer, intent(in) :: groups(:)                               !< positions of all sound groups &parameter
    logical, intent(in) :: is_formula(:)                           !< true for those with a formula
    type(formula_parameters_type), intent(out) :: formulas         !< of use only where nothing is reported
    type(diagnostics_type), intent(inout) :: diagnostics           !< gets the errors
    integer :: i, j, found

    formulas%angle_unit = angle_unit_of(document)
    allocate (formulas%bound(count(is_formula)), formulas%order(0), formulas%results(count(is_formula)))
    allocate (formulas%depends(count(is_formula), count(.not. is_formula)), source=.false.)
    found = diagnostics%count
    j = 0
    do i = 1, size(groups)
      if (any(is_formula) .and. get_text(document%groups(groups(i)), 'name') == 'pi') &
        call diagnostics%add(span_of(document%groups(groups(i)), 'name', 1), 'pi is a number in formulas; give the parameter '// &
                             'another name')
      if (.not. is_formula(i)) cycle
      j = j + 1
      call read_one(document, document%groups(groups(i)), groups, is_formula, formulas%bound(j), diagnostics)
    end do
    if (diagnostics%count == found) call put_in_order(formulas, diagnostics)
  end subroutine read_formulas

  !> Read one formula and find its variables.
  pure subroutine read_one(document, group, groups, is_formula, bound, diagnostics)
    type(document_type), intent(in) :: document            !< checked
    type(group_type), intent(in) :: group                  !< with the formula
    integer, intent(in) :: groups(:)                       !< positions of all sound groups &parameter
    logical, intent(in) :: is_formula(:)                   !< true for those with a formula
    type(bound_formula_type), intent(inout) :: bound       !< gets the formula
    type(diagnostics_type), intent(inout) :: diagnostics   !< gets the errors
    type(formula_problem_type) :: problem
    character(len=40) :: names(size(groups)), hint
    integer :: i, k

    associate (value => group%items(find_item(group, 'formula'))%values(1))
      bound%name = get_text(group, 'name')
      bound%length = len(value%text)
      bound%span = value%span
      call parse_formula(value%text, bound%formula, problem)
    end associate
    if (allocated(problem%words)) then
      call diagnostics%add(formula_span(bound%span, bound%length, problem%first, problem%last), problem%words)
      return
    end if
    do i = 1, size(groups)
      names(i) = get_text(document%groups(groups(i)), 'name')
    end do
    allocate (bound%from(size(bound%formula%names)), source=0)
    do i = 1, size(bound%from)
      associate (name => bound%formula%names(i), first => bound%formula%name_first(i))
        k = findloc(names, name, dim=1)
        if (k > 0) then
          bound%from(i) = merge(-count(is_formula(:k)), count(.not. is_formula(:k)), is_formula(k))
        else if (.not. has_unsound(document, 'parameter')) then
          hint = nearest_name(trim(name), [character(len=40) :: names, 'pi'])
          if (hint /= '') hint = '; did you mean '''//trim(hint)//'''?'
          call diagnostics%add(formula_span(bound%span, bound%length, first, first + len_trim(name) - 1), &
                               'there is no parameter '''//trim(name)//''''//trim(hint))
        end if
      end associate
    end do
  end subroutine read_one

  !> The place of a part of a formula.
  pure type(span_type) function formula_span(span, length, first, last) result(part)
    type(span_type), intent(in) :: span      !< of the whole formula, with its quotes or without
    integer, intent(in) :: length            !< bytes of its text
    integer, intent(in) :: first             !< first byte of the part in the text
    integer, intent(in) :: last              !< last byte
    integer :: before

    part = span
    before = (span%last - span%first + 1 - length)/2
    if (before > 1 .or. 2*before /= span%last - span%first + 1 - length) return    ! quotes within it are doubled
    part%first = span%first + before + first - 1
    part%last = span%first + before + last - 1
  end function formula_span

  !> Put the formulas into an order in which each follows from those before it. Formulas that need themselves are reported.
  pure subroutine put_in_order(formulas, diagnostics)
    type(formula_parameters_type), intent(inout) :: formulas     !< gets the order and the dependencies
    type(diagnostics_type), intent(inout) :: diagnostics         !< gets the errors
    logical :: done(size(formulas%bound))
    integer :: i, k, ready

    done = .false.
    do
      ready = 0
      do i = 1, size(done)
        if (done(i)) cycle
        if (any(is_waiting(formulas%bound(i)%from, done))) cycle
        ready = i
        exit
      end do
      if (ready == 0) exit
      done(ready) = .true.
      formulas%order = [formulas%order, ready]
      do i = 1, size(formulas%bound(ready)%from)
        k = formulas%bound(ready)%from(i)
        if (k > 0) formulas%depends(ready, k) = .true.
        if (k < 0) formulas%depends(ready, :) = formulas%depends(ready, :) .or. formulas%depends(-k, :)
      end do
    end do
    if (.not. all(done)) call report_cycle(formulas%bound, done, diagnostics)
  end subroutine put_in_order

  !> Whether each variable is a formula that has no place in the order yet.
  pure function is_waiting(from, done) result(waiting)
    integer, intent(in) :: from(:)       !< of the variables
    logical, intent(in) :: done(:)       !< true for formulas that have their place
    logical :: waiting(size(from))
    integer :: i

    do i = 1, size(from)
      waiting(i) = .false.
      if (from(i) < 0) waiting(i) = .not. done(-from(i))
    end do
  end function is_waiting

  !> Report formulas that need themselves, as a way from one of them back to it.
  pure subroutine report_cycle(bound, done, diagnostics)
    type(bound_formula_type), intent(in) :: bound(:)         !< the formulas
    logical, intent(in) :: done(:)                           !< true for those with a place in the order
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets the error
    integer :: way(size(bound) + 1), i, j, first, variable
    character(len=:), allocatable :: words

    way(1) = findloc(done, .false., dim=1)
    do i = 1, size(bound)
      variable = findloc(is_waiting(bound(way(i))%from, done), .true., dim=1)
      way(i + 1) = -bound(way(i))%from(variable)
      first = findloc(way(:i), way(i + 1), dim=1)
      if (first > 0) exit
    end do
    words = ''''//bound(way(first))%name//''''
    do j = first + 1, i + 1
      words = words//' needs '''//bound(way(j))%name//''''
      if (j <= i) words = words//', which'
    end do
    associate (one => bound(way(first)))
      variable = findloc(is_waiting(one%from, done), .true., dim=1)
      j = one%formula%name_first(variable)
      call diagnostics%add(formula_span(one%span, one%length, j, j + len_trim(one%formula%names(variable)) - 1), &
                           'this formula needs its own value: '//words)
    end associate
  end subroutine report_cycle

  !> Evaluate all formulas. With `number`, along the tangent at the values of the parameters: their values where this parameter is
  !> larger by `distance`, to first order. Formulas without a value, or without a derivative, are reported.
  pure subroutine evaluate_formulas(values, formulas, diagnostics, number, distance)
    real(wp), intent(in) :: values(:)                            !< of the parameters without formulas, in the units of the data file
    type(formula_parameters_type), intent(inout) :: formulas     !< get their values
    type(diagnostics_type), intent(inout) :: diagnostics         !< gets the errors
    integer, intent(in), optional :: number                      !< of a parameter
    real(wp), intent(in), optional :: distance                   !< by which it is larger
    real(wp) :: slopes(size(formulas%bound)), found(size(formulas%bound))
    integer :: i, j

    slopes = 0.0_wp
    found = 0.0_wp
    do i = 1, size(formulas%order)
      j = formulas%order(i)
      if (present(number)) then
        call evaluate_one(formulas%bound(j), values, formulas%angle_unit, found, slopes, diagnostics, j, number)
      else
        call evaluate_one(formulas%bound(j), values, formulas%angle_unit, found, slopes, diagnostics, j)
      end if
    end do
    formulas%results%value = found
    if (present(distance)) formulas%results%value = found + distance*slopes
  end subroutine evaluate_formulas

  !> Evaluate one formula, with its derivative by a parameter where one is asked for.
  pure subroutine evaluate_one(bound, values, angle_unit, found, slopes, diagnostics, own, number)
    type(bound_formula_type), intent(in) :: bound            !< the formula
    real(wp), intent(in) :: values(:)                        !< of the parameters
    real(wp), intent(in) :: angle_unit                       !< of the data file [rad]
    real(wp), intent(inout) :: found(:)                      !< (formulas) values of those before; gets its own
    real(wp), intent(inout) :: slopes(:)                     !< (formulas) derivatives of those before; gets its own
    type(diagnostics_type), intent(inout) :: diagnostics     !< gets an error
    integer, intent(in) :: own                               !< number of the formula
    integer, intent(in), optional :: number                  !< of the parameter by which it is differentiated
    type(formula_problem_type) :: problem
    real(wp) :: variables(size(bound%from)), direction(size(bound%from))
    integer :: i

    direction = 0.0_wp
    do i = 1, size(bound%from)
      if (bound%from(i) > 0) then
        variables(i) = values(bound%from(i))
        if (present(number)) direction(i) = merge(1.0_wp, 0.0_wp, bound%from(i) == number)
      else
        variables(i) = found(-bound%from(i))
        direction(i) = slopes(-bound%from(i))
      end if
    end do
    if (any(abs(direction) > 0.0_wp)) then
      call evaluate_formula(bound%formula, variables, angle_unit, found(own), problem, direction, slopes(own))
    else
      call evaluate_formula(bound%formula, variables, angle_unit, found(own), problem)
    end if
    if (allocated(problem%words)) &
      call diagnostics%add(formula_span(bound%span, bound%length, problem%first, problem%last), &
                           'the formula of parameter '''//bound%name//''' fails: '//problem%words)
  end subroutine evaluate_one

  !> One unit of angle of a checked data file [rad].
  pure real(wp) function angle_unit_of(document)
    type(document_type), intent(in) :: document     !< the data file

    angle_unit_of = 1.0_wp
    if (get_text(group_or_empty(document, 'mechanism'), 'angle_unit') == 'deg') angle_unit_of = radians_per_degree
  end function angle_unit_of
end module mech9_formula_parameters
