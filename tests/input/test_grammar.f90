!> Every row of the table of names: it is consistent, its example and default are accepted, and a value of
!> another type, a value too many and a value out of range are refused at their place.
module test_grammar
  use mech9_source, only: source_from_text
  use mech9_program_kind, only: kinematics, dynamics, both_programs
  use mech9_grammar, only: group_table, item_table, item_row_type, unlimited, find_group_row, words_of, for_forces
  use mech9_item_rows, only: find_item_rows, takes_kind
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_checker, only: check_document
  use mech9_testing, only: tester_type
  use mech9_input_support, only: printed
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('groups')) call groups(tester)
    if (tester%runs('items')) call items(tester)
  end subroutine run

  subroutine groups(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: i

    do i = 1, size(group_table)
      call check_group_row(tester, i)
    end do
  end subroutine groups

  subroutine items(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer :: i, j

    do i = 1, size(item_table)
      call check_item_row(tester, item_table(i))
      do j = 1, i - 1
        call tester%is_true(apart(item_table(i), item_table(j)), label(item_table(i))//': the name has one meaning for each kind')
      end do
    end do
  end subroutine items

  subroutine check_group_row(tester, row)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, intent(in) :: row                   !< number of the row among the groups

    associate (group => group_table(row))
      call tester%is_true(find_group_row(group%name) == row, trim(group%name)//': the group is found under its name')
      call tester%is_true(any(item_table%group == group%name), trim(group%name)//': the group has names')
      call tester%is_true(count(item_table%group == group%name) == findloc(item_table%group, group%name, dim=1, back=.true.) - &
                          findloc(item_table%group, group%name, dim=1) + 1, trim(group%name)//': its names stand together')
      call tester%is_true(all(len_trim([character(len=12) :: group%name, group%key]) < [len(group%name), len(group%key)]), &
                          trim(group%name)//': its words fit their fields')
      call tester%is_true(any(group%program == [both_programs, kinematics, dynamics, for_forces]), &
                          trim(group%name)//': the group is for a program that exists')
      call tester%is_true(group%help /= '' .and. len_trim(group%help) < len(group%help), &
                          trim(group%name)//': the help fits its field')
      if (group%key /= '') &
        call tester%is_true(group%repeats .and. size(find_item_rows(group%name, group%key)) == 1, &
                            trim(group%name)//': a group that repeats has one key')
    end associate
  end subroutine check_group_row

  !> Two rows share no name, or no kind.
  logical function apart(a, b)
    type(item_row_type), intent(in) :: a   !< first row
    type(item_row_type), intent(in) :: b   !< second row
    character(len=len(a%kinds)), allocatable :: kinds(:)
    integer :: k

    apart = a%group /= b%group .or. a%name /= b%name
    if (apart .or. a%kinds == '' .or. b%kinds == '') return
    kinds = words_of(a%kinds)
    apart = .true.
    do k = 1, size(kinds)
      if (takes_kind(b, trim(kinds(k)))) apart = .false.
    end do
  end function apart

  function label(row)
    type(item_row_type), intent(in) :: row   !< of the grammar
    character(len=:), allocatable :: label

    label = trim(row%group)//'.'//trim(row%name)
  end function label

  subroutine check_item_row(tester, row)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(item_row_type), intent(in) :: row       !< of the grammar
    character(len=:), allocatable :: wrong

    call tester%is_true(find_group_row(row%group) > 0, label(row)//': the name belongs to a group')
    call tester%is_true(row%low >= 1 .and. row%high >= row%low, label(row)//': the bounds of the number of values are right')
    call tester%is_true(row%help /= '' .and. len_trim(row%help) < len(row%help), label(row)//': the help fits its field')
    call tester%is_true(len_trim(row%default) < len(row%default) .and. len_trim(row%example) < len(row%example), &
                        label(row)//': default and example fit their fields')
    call tester%is_true(all(len_trim([character(len=21) :: row%group, row%name, row%type, row%unit, row%range]) < &
                            [len(row%group), len(row%name), len(row%type), len(row%unit), len(row%range)]), &
                        label(row)//': group, name, type, unit and range fit their fields')
    call tester%is_true(len_trim(row%words) < len(row%words) .and. len_trim(row%kinds) < len(row%kinds), &
                        label(row)//': words and kinds fit their fields')
    call tester%is_true(.not. (row%needed .and. row%default /= ''), label(row)//': a name that is needed has no default')
    call tester%is_true(row%needed .or. row%default /= '', label(row)//': a name that is not needed has a default')
    if (row%kinds /= '') call check_kinds(tester, row)
    call check_words(tester, row)

    call accepted(tester, row, example(row), 'its example')
    if (row%default /= '' .and. row%default(1:1) /= '(') call accepted(tester, row, assignment_of(row, trim(row%default)), &
                                                                       'its default')
    wrong = "'text'"
    if (row%type == 'text') wrong = '17'
    call refused(tester, row, assignment_of(row, wrong), 'a value of another type')
    call refused(tester, row, assignment_of(row, 'NaN'), 'NaN')
    if (row%type == 'integer') call refused(tester, row, assignment_of(row, '1.0'), 'a real number for a whole one')
    if (row%type == 'integer' .and. row%range /= '') call refused(tester, row, assignment_of(row, '-1'), 'a number out of range')
    if (row%type == 'real' .and. row%range /= '') call refused(tester, row, assignment_of(row, '-1.0'), 'a number out of range')
    if (row%high < unlimited) call refused(tester, row, example(row)//', '//example_value(row), 'a value too many')
    if (row%low > 1) call refused(tester, row, assignment_of(row, '1'), 'a value too few')
    if (row%words /= '') call refused(tester, row, assignment_of(row, "'no such word'"), 'a word that is not allowed')
  end subroutine check_item_row

  !> The kinds or laws of time a name belongs to are kinds or laws that the group has.
  subroutine check_kinds(tester, row)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(item_row_type), intent(in) :: row       !< of the grammar
    character(len=len(row%kinds)), allocatable :: kinds(:)
    character(len=:), allocatable :: word
    integer, allocatable :: rows(:)
    integer :: k

    kinds = words_of(row%kinds)
    do k = 1, size(kinds)
      word = merge('law ', 'kind', is_law(kinds(k)))
      rows = find_item_rows(row%group, trim(word))
      call tester%is_true(size(rows) == 1, label(row)//': the group of the name has a '//trim(word))
      if (size(rows) /= 1) cycle
      call tester%is_true(any(words_of(item_table(rows(1))%words) == without_law(kinds(k))), &
                          label(row)//': the group has the '//trim(word)//' '//trim(without_law(kinds(k))))
    end do
  end subroutine check_kinds

  !> Whether a word among the kinds of a name is a law of time.
  pure logical function is_law(kind)
    character(len=*), intent(in) :: kind   !< word among the kinds of a name, as 'revolute' or 'law:harmonic'

    is_law = index(kind, 'law:') == 1
  end function is_law

  !> The kind or law that a word among the kinds of a name stands for.
  pure function without_law(kind) result(word)
    character(len=*), intent(in) :: kind   !< word among the kinds of a name, as 'revolute' or 'law:harmonic'
    character(len=len(kind)) :: word

    word = kind
    if (is_law(kind)) word = kind(len('law:') + 1:)
  end function without_law

  subroutine check_words(tester, row)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(item_row_type), intent(in) :: row       !< of the grammar
    character(len=len(row%words)), allocatable :: words(:)
    integer :: k

    words = words_of(row%words)
    call tester%is_true(size(words) > 0 .eqv. row%words /= '', label(row)//': the words are told apart')
    do k = 1, size(words)
      call accepted(tester, row, assignment_of(row, "'"//trim(words(k))//"'"), 'the word '//trim(words(k)))
    end do
  end subroutine check_words

  !> "name = value", or the example where it names itself.
  function example(row) result(text)
    type(item_row_type), intent(in) :: row   !< of the grammar
    character(len=:), allocatable :: text

    text = assignment_of(row, trim(row%example))
    if (index(row%example, '=') > 0) text = trim(row%example)
  end function example

  function example_value(row) result(text)
    type(item_row_type), intent(in) :: row   !< of the grammar
    character(len=:), allocatable :: text

    text = trim(row%example(:index(trim(row%example)//',', ',') - 1))
  end function example_value

  !> "name = value value ...": one value stands for as many as are needed.
  function assignment_of(row, value) result(text)
    type(item_row_type), intent(in) :: row   !< of the grammar
    character(len=*), intent(in) :: value    !< as the data file writes it
    character(len=:), allocatable :: text
    integer :: k

    text = trim(row%name)//' = '//value
    if (index(value, ',') > 0 .or. value == '1') return
    do k = 2, row%low
      text = text//', '//value
    end do
  end function assignment_of

  !> A data file of one group with this item, of a kind that has it.
  subroutine check_text(row, assignment, errors, text)
    type(item_row_type), intent(in) :: row               !< of the grammar
    character(len=*), intent(in) :: assignment           !< text within the group
    integer, intent(out) :: errors                       !< number of errors that name this item or stand in its place
    character(len=:), allocatable, intent(out) :: text   !< text that is printed
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics
    character(len=:), allocatable :: kind
    character(len=len(row%kinds)), allocatable :: kinds(:)

    kind = ''
    kinds = words_of(row%kinds)
    if (size(kinds) > 0) then
      kind = "kind='"//trim(kinds(1))//"' "
      if (is_law(kinds(1))) kind = "kind='torque' law='"//trim(without_law(kinds(1)))//"' "
    end if
    call parse_document(source_from_text('test.nml', '&'//trim(row%group)//' '//kind//new_line('a')//assignment// &
                                         new_line('a')//'/'), document, diagnostics)
    call check_document(document, diagnostics)
    text = printed(diagnostics)
    errors = merge(1, 0, index(text, 'test.nml:2:') > 0)
  end subroutine check_text

  subroutine accepted(tester, row, assignment, what)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(item_row_type), intent(in) :: row       !< of the grammar
    character(len=*), intent(in) :: assignment   !< text within the group
    character(len=*), intent(in) :: what         !< name of the trial, for the report of a failure
    character(len=:), allocatable :: text
    integer :: errors

    call check_text(row, assignment, errors, text)
    call tester%is_true(errors == 0, label(row)//': '//what//' is accepted: '//assignment)
    if (errors > 0) print '(a)', text
  end subroutine accepted

  subroutine refused(tester, row, assignment, what)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(item_row_type), intent(in) :: row       !< of the grammar
    character(len=*), intent(in) :: assignment   !< text within the group
    character(len=*), intent(in) :: what         !< name of the trial, for the report of a failure
    character(len=:), allocatable :: text
    integer :: errors

    call check_text(row, assignment, errors, text)
    call tester%is_true(errors == 1, label(row)//': '//what//' is refused: '//assignment)
  end subroutine refused
end module test_grammar
