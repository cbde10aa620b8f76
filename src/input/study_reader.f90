!> The study that the group &study of a checked document describes.
module mech9_study_reader
  use mech9_kinds, only: wp, long
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_error, only: error_type
  use mech9_number_file, only: number_file_type, read_number_file
  use mech9_document, only: document_type, group_type
  use mech9_lookup, only: groups_named, has_name, has_unsound, get_integer, get_logical, get_text, span_of
  use mech9_diagnostics, only: diagnostics_type, printable
  use mech9_table_file, only: beside
  use mech9_sobol, only: most_sobol_dimensions
  use mech9_parameter, only: parameter_type
  use mech9_parameter_reader, only: groups_of_parameters
  use mech9_study, only: study_type
  implicit none
  private
  public :: read_study

  !> Most sets of values with which two runs are made.
  integer, parameter :: most_sets = 1000000000

contains

  !> Read the study, and hold the parameters against what it needs of them. Without a group &study its kind stays empty.
  subroutine read_study(document, parameters, study, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(parameter_type), intent(in) :: parameters(:)     !< the parameters
    type(study_type), intent(out) :: study                !< of use only where nothing is reported
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)

    numbers = groups_named(document, 'study')
    if (size(numbers) == 0) return
    associate (group => document%groups(numbers(1)))
      study%kind = get_text(group, 'kind')
      study%place = diagnostics%place(group%span)
      if (has_unsound(document, 'parameter')) return     ! the number of parameters is not known
      if (size(parameters) == 0) then
        call diagnostics%add(group%span, 'a study needs at least one &parameter')
        return
      end if
      call check_headings(document, diagnostics)
      if (has_name(group, 'runs')) study%runs = get_integer(group, 'runs')
      if (has_name(group, 'seed')) study%seed = get_integer(group, 'seed')
      select case (study%kind)
      case ('grid')
        call count_grid(document, group, parameters, study%runs, diagnostics)
      case ('list')
        call read_list(document, group, size(parameters), study, diagnostics)
      case default
        call check_spreads(document, parameters, diagnostics)
        if (study%kind == 'sobol' .and. size(parameters) > most_sobol_dimensions) &
          call diagnostics%add(span_of(group, 'kind', 1), 'sobol is for at most '//to_text(most_sobol_dimensions)// &
                               ' parameters, and there are '//to_text(size(parameters))//'; latin is for any number')
      end select
      study%sets = study%runs
      if (has_name(group, 'classes')) study%classes = get_logical(group, 'classes')
      if (has_name(group, 'exponents')) study%exponents = get_integer(group, 'exponents')
      if (has_name(group, 'carry')) study%carry = get_text(group, 'carry')
      if (study%carry == 'both') then
        if (study%sets > most_sets) call diagnostics%add(group%span, 'there are too many runs to make each twice')
        study%runs = 2*min(study%sets, most_sets)
      end if
    end associate
  end subroutine read_study

  !> Report names of parameters and quantities that two columns of the study's table would have.
  pure subroutine check_headings(document, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: parameters(:), groups(:)
    character(len=40) :: name, other       ! longer names are refused
    integer :: i, j

    parameters = groups_named(document, 'parameter')
    groups = [parameters, groups_named(document, 'quantity')]
    do i = 1, size(groups)
      associate (group => document%groups(groups(i)))
        name = get_text(group, 'name')
        if (any(name == [character(len=9) :: 'run', 'exit_code', 'class'])) call diagnostics%add(span_of(group, 'name', 1), &
          'the table of a study has a column '''//trim(name)//''' already; choose another name')
        if (i <= size(parameters)) cycle          ! two parameters of one name are reported already
        do j = 1, size(parameters)
          other = get_text(document%groups(parameters(j)), 'name')
          if (other == name) call diagnostics%add(span_of(group, 'name', 1), 'a parameter has the name '''//trim(name)// &
                                                  ''' too; each column of the study''s table needs a name of its own')
        end do
      end associate
    end do
  end subroutine check_headings

  !> Count the runs of a grid; report parameters without low, high or count.
  pure subroutine count_grid(document, group, parameters, runs, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< group of the study
    type(parameter_type), intent(in) :: parameters(:)     !< the parameters
    integer, intent(out) :: runs                          !< how many points the grid has
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    character(len=:), allocatable :: missing
    integer(long) :: product
    integer :: i

    numbers = groups_of_parameters(document)
    product = 1
    runs = 0
    do i = 1, size(parameters)
      call find_missing_names(document%groups(numbers(i)), missing)
      if (missing /= '') call diagnostics%add(document%groups(numbers(i))%span, 'parameter '''//parameters(i)%name// &
                                              ''' needs '//missing//' for a study on a grid')
      product = product*max(1, parameters(i)%count)
      if (product > huge(1)) then
        call diagnostics%add(group%span, 'this grid has more than '//to_text(huge(1))//' points')
        return
      end if
    end do
    runs = int(product)
  end subroutine count_grid

  !> The names that a parameter lacks for a grid, in words; empty where it has all of them.
  pure subroutine find_missing_names(group, words)
    type(group_type), intent(in) :: group                        !< group of the parameter
    character(len=:), allocatable, intent(out) :: words          !< the names, in apostrophes
    character(len=*), parameter :: names(3) = [character(len=5) :: 'low', 'high', 'count']
    integer, allocatable :: missing(:)
    integer :: i

    missing = pack([1, 2, 3], [(.not. has_name(group, trim(names(i))), i=1, 3)])
    words = ''
    do i = 1, size(missing)
      if (i > 1 .and. i == size(missing)) then
        words = words//' and '
      else if (i > 1) then
        words = words//', '
      end if
      words = words//''''//trim(names(missing(i)))//''''
    end do
  end subroutine find_missing_names

  !> Report parameters without a spread and without a range, from which no values can be drawn.
  pure subroutine check_spreads(document, parameters, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(parameter_type), intent(in) :: parameters(:)     !< the parameters
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    integer, allocatable :: numbers(:)
    integer :: i

    numbers = groups_of_parameters(document)
    do i = 1, size(parameters)
      if (parameters(i)%spread > 0.0_wp .or. parameters(i)%has_range) cycle
      call diagnostics%add(document%groups(numbers(i))%span, 'parameter '''//parameters(i)%name//''' needs ''spread'', or '// &
                           '''low'' and ''high'', for a study that draws its values')
    end do
  end subroutine check_spreads

  !> Read the values of a list: a line for each run, with the values of all parameters.
  subroutine read_list(document, group, n_parameters, study, diagnostics)
    type(document_type), intent(in) :: document           !< the data file as groups and items
    type(group_type), intent(in) :: group                 !< group of the study
    integer, intent(in) :: n_parameters                   !< how many parameters there are
    type(study_type), intent(inout) :: study              !< gets its values and the number of its runs
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    type(number_file_type) :: lines
    type(error_type), allocatable :: err
    integer :: i, found

    found = diagnostics%count
    call read_number_file(beside(document%source%name, get_text(group, 'file')), n_parameters, lines, diagnostics, err)
    if (allocated(err)) then
      call diagnostics%add(span_of(group, 'file', 1), 'the list '''//printable(get_text(group, 'file'))//''': '//err%message, &
                           err%code)
      return
    end if
    do i = 1, size(lines%counts)
      if (lines%counts(i) /= n_parameters) &
        call diagnostics%add(lines%spans(i), trim(merge('there is ', 'there are', n_parameters == 1))//' '// &
                             counted(n_parameters, 'parameter')//', and this line has '//counted(lines%counts(i), 'value'))
    end do
    study%list = lines%numbers
    study%runs = size(lines%counts)
    if (study%runs == 0 .and. diagnostics%count == found) &
      call diagnostics%add(span_of(group, 'file', 1), 'this file has no values')
  end subroutine read_list
end module mech9_study_reader
