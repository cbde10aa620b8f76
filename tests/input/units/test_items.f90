!> Items of a data file one by one: values that are merged and checked, names of numbers, rows of matrices, and look-ups with their
!> defaults.
module test_items
  use mech9_kinds, only: wp
  use mech9_checker, only: check_document
  use mech9_diagnostics, only: diagnostics_type
  use mech9_document, only: document_type, group_type, item_type, value_type, value_integer
  use mech9_item_check, only: is_sensible
  use mech9_item_merge, only: merge_items, expand_repeats
  use mech9_lookup, only: groups_named, group_or_empty, has_group, has_name, get_integer, get_integers, get_real, get_reals, &
    get_logical, get_text, count_values
  use mech9_matrix_items, only: matrix_type, read_matrix
  use mech9_name_check, only: check_name
  use mech9_named_number, only: number_name_type, number_place_type, read_name, find_number
  use mech9_parser, only: parse_document
  use mech9_scanner, only: skip_blanks, next_is_name, scan_word, is_letter
  use mech9_source, only: source_from_text, span_type
  use mech9_checks, only: near_vector
  use mech9_small_models, only: eol
  use mech9_text_models, only: document_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('scanning')) call scanning(tester)
    if (tester%runs('merging')) call merging(tester)
    if (tester%runs('contradictions')) call contradictions(tester)
    if (tester%runs('look_ups')) call look_ups(tester)
    if (tester%runs('names_of_numbers')) call names_of_numbers(tester)
    if (tester%runs('places_of_numbers')) call places_of_numbers(tester)
    if (tester%runs('matrices')) call matrices(tester)
    if (tester%runs('bad_matrices')) call bad_matrices(tester)
    if (tester%runs('names')) call names(tester)
  end subroutine run

  !> The only message of diagnostics; the number of them where there are several.
  function only_message(diagnostics) result(message)
    type(diagnostics_type), intent(in) :: diagnostics   !< with errors or without
    character(len=:), allocatable :: message
    type(span_type) :: span

    message = achar(48 + min(9, diagnostics%count))//' messages'
    if (diagnostics%count == 1) call diagnostics%get(1, message, span)
  end function only_message

  subroutine scanning(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: text = '  ! words = 1'//eol//' point (1,:) =2'
    integer :: at

    at = 1
    call skip_blanks(text, at)
    call tester%is_true(text(at:at) == 'p', 'comments are blanks')
    call tester%is_true(next_is_name(text, at), 'a name with subscripts before =')
    call scan_word(text, at)
    call tester%is_true(text(at:) == ' (1,:) =2', 'a word ends at a blank')
    call tester%is_true(.not. next_is_name(text, len(text)) .and. .not. next_is_name('a b = 1', 1), 'no names')
    call tester%is_true(is_letter('aZ_', 2) .and. .not. is_letter('aZ_', 3) .and. .not. is_letter('a', 2), 'letters')
  end subroutine scanning

  !> The merged values of `dh` in a group of a pair.
  subroutine merge(tester, items, merged, diagnostics)
    type(tester_type), intent(inout) :: tester            !< counts the checks
    character(len=*), intent(in) :: items                 !< of the group
    type(item_type), intent(out) :: merged                !< the item with all values
    type(diagnostics_type), intent(out) :: diagnostics    !< gets the errors
    type(document_type) :: document
    integer :: number

    call document_from_text(tester, '&pair '//items//' /'//eol, document)
    call diagnostics%add_source(document%source, number)
    call merge_items(document%groups(1)%items, 'dh', merged, diagnostics)
  end subroutine merge

  subroutine merging(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call gives('dh=1,2*3,4', [1, 3, 3, 4])
    call gives('dh(3)=7 dh(1:2)=5,6', [5, 6, 7])
    call gives('dh(2)=8 axis=1,0,0 dh(1)=9', [9, 8])
    call gives('dh=4*0', [0, 0, 0, 0])
  contains
    subroutine gives(items, numbers)
      character(len=*), intent(in) :: items   !< of the group
      integer, intent(in) :: numbers(:)       !< the right values
      type(item_type) :: merged
      type(value_type), allocatable :: values(:)
      type(diagnostics_type) :: diagnostics

      call merge(tester, items, merged, diagnostics)
      call tester%is_true(diagnostics%count == 0, 'items that go together: '//items)
      call expand_repeats(merged, values, diagnostics)
      call tester%is_true(size(values) == size(numbers), 'how many values '//items//' gives')
      if (size(values) == size(numbers)) &
        call tester%is_true(all(values%whole == numbers) .and. all(values%kind == value_integer), 'values of '//items)
    end subroutine gives
  end subroutine merging

  subroutine contradictions(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call says('dh=1 dh=2', "'dh' is given twice in this group; it stands in line 1 already")
    call says('dh(1)=1 dh(1)=2', "'dh(1)' is given twice in this group")
    call says('dh(1)=1 dh(3)=2', "'dh(2)' is missing")
    call says('dh(1:2)=1,2,3', "3 values for 'dh' where its subscripts mean 2")
    call says('dh(1,2)=1', "'dh' is a list and takes one subscript, as in dh(2)")
    call says('dh(99999999)=1', "the subscript of 'dh' is too large")
    call says('dh=20000000*1', "there are too many values for 'dh'")
  contains
    subroutine says(items, message)
      character(len=*), intent(in) :: items     !< of the group
      character(len=*), intent(in) :: message   !< the right message
      type(item_type) :: merged
      type(diagnostics_type) :: diagnostics

      call merge(tester, items, merged, diagnostics)
      call tester%is_true(only_message(diagnostics) == message, items//': '//only_message(diagnostics))
    end subroutine says
  end subroutine contradictions

  !> Values of a checked document, and those that the grammar gives in their place.
  subroutine look_ups(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(document_type) :: document
    type(group_type) :: m, o, p, t
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('a.nml', "&mechanism title='A Title', links=2, coordinates=1 /"//eol// &
      "&point name='P', link=2, position=1,2.5,3 /"//eol//"&point name='Q', link=1 /"//eol// &
      '&output reactions=T, coordinates=1 /'//eol), document, diagnostics)
    call check_document(document, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'a document without errors')
    call tester%is_true(size(groups_named(document, 'point')) == 2 .and. has_group(document, 'output') .and. &
                        .not. has_group(document, 'time'), 'groups by name')
    m = group_or_empty(document, 'mechanism')
    o = group_or_empty(document, 'output')
    p = document%groups(2)
    t = group_or_empty(document, 'time')
    call tester%is_true(get_text(m, 'title') == 'A Title' .and. get_integer(m, 'links') == 2, 'a text and a whole number')
    call tester%is_true(get_text(m, 'angle_unit') == 'rad' .and. .not. has_name(m, 'angle_unit'), 'a default that is a text')
    call near_vector(tester, get_reals(p, 'position'), [1.0_wp, 2.5_wp, 3.0_wp], 0.0_wp, 'numbers')
    call tester%is_true(get_logical(o, 'reactions') .and. .not. get_logical(o, 'drive_forces'), 'a logical and a default')
    call tester%is_true(all(get_integers(o, 'coordinates') == [1]) .and. count_values(o, 'coordinates') == 1, 'a list')
    call tester%is_true(count_values(o, 'reaction_pairs') == 0, 'a list that is not given')
    call tester%near(get_real(t, 'start'), 0.0_wp, 0.0_wp, 'a default of a group that is not there')
    call near_vector(tester, get_reals(document%groups(3), 'position'), [0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp, 'three default numbers')
    call tester%is_true(is_sensible(0.0_wp) .and. is_sensible(-1.0e100_wp) .and. .not. is_sensible(1.0e101_wp) .and. &
                        .not. is_sensible(1.0e-101_wp), 'numbers whose squares are numbers')
  end subroutine look_ups

  subroutine names_of_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=16), parameter :: bad(8) = [character(len=16) :: '', 'pair', 'pair.', '.point', 'pair(0).point', 'pair(1:2).dh', &
                                              'pair(2)point', 'pair(1,2).dh']
    type(number_name_type) :: name
    logical :: ok
    integer :: i

    call read_name(' Pair( 2 ).Point(3) ', name, ok)
    call tester%is_true(ok .and. name%group == 'pair' .and. name%item == 'point' .and. name%number == 2 .and. name%position == 3, &
                        'a whole name')
    call read_name('time.end', name, ok)
    call tester%is_true(ok .and. name%group == 'time' .and. name%number == 0 .and. name%position == 0, 'a name without numbers')
    do i = 1, size(bad)
      call read_name(trim(bad(i)), name, ok)
      call tester%is_true(.not. ok, 'no name: '//bad(i))
    end do
  end subroutine names_of_numbers

  !> Names of numbers in a document with two pairs and one time.
  subroutine places_of_numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call found('pair(2).point(3)', 2, 3)
    call found('time.end', 3, 1)
    call found('time.start', 3, 1)
    call refused('pair.point(1)', 'there are 2 groups &pair; say which one: pair(2).point(1)')
    call refused('pair(3).point(1)', 'this file has 2 groups &pair only')
    call refused('pair(2).point', "'point' has 3 numbers; say which one: 'point(2)'")
    call refused('pair(2).point(4)', "'point' has 3 numbers only")
    call refused('pair(2).coordinate', "'coordinate' takes whole numbers, and a parameter is a real number")
    call refused('pair(2).kind', "'kind' is a word, and a parameter is a real number")
    call refused('pair(2).pitch', "'pitch' does not belong to this kind of &pair")
    call refused('pair(2).piont(1)', "unknown name 'piont' in &pair; did you mean 'point'?")
    call refused('tmie.end', "unknown group 'tmie'; did you mean 'time'?")
    call refused('gravity.acceleration(1)', 'there is no &gravity in this file')
    call refused('study.seed', 'a parameter sets numbers of the mechanism and its motion, not of &study')
    call refused('time', 'write the name of a number as group.name, or group(2).name(3) for the third number in the second '// &
                 'group of this name')
  contains
    subroutine find(text, place, diagnostics)
      character(len=*), intent(in) :: text                 !< the name
      type(number_place_type), intent(out) :: place        !< of the number
      type(diagnostics_type), intent(out) :: diagnostics   !< gets the errors
      type(document_type) :: document

      call parse_document(source_from_text('a.nml', &
        "&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=1,2,3 /"//eol// &
        "&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=4,5,6 /"//eol//'&time end=2 /'//eol), document, &
        diagnostics)
      call check_document(document, diagnostics)
      call diagnostics%clear()
      document%groups%sound = .true.
      call find_number(document, text, span_type(), .false., place, diagnostics)
    end subroutine find

    subroutine found(text, group, position)
      character(len=*), intent(in) :: text   !< the name
      integer, intent(in) :: group           !< the right group
      integer, intent(in) :: position        !< the right position
      type(number_place_type) :: place
      type(diagnostics_type) :: diagnostics

      call find(text, place, diagnostics)
      call tester%is_true(diagnostics%count == 0 .and. place%group == group .and. place%value == position, 'the place of '//text)
    end subroutine found

    subroutine refused(text, message)
      character(len=*), intent(in) :: text      !< the name
      character(len=*), intent(in) :: message   !< the right message
      type(number_place_type) :: place
      type(diagnostics_type) :: diagnostics

      call find(text, place, diagnostics)
      call tester%is_true(place%group == 0 .and. only_message(diagnostics) == message, text//': '//only_message(diagnostics))
    end subroutine refused
  end subroutine places_of_numbers

  !> The matrix of a chain of three links, by rows, by columns, by elements and as a whole.
  subroutine matrices(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: chain(3, 3) = reshape([0, 1, 0, 1, 0, 2, 0, 2, 0], [3, 3])

    call gives('c(1,:)=0,1,0 c(2,:)=1,0,2 c(3,:)=0,2,0')
    call gives('c(:,1)=0,1,0 c(:,2)=1,0,2 c(:,3)=0,2,0')
    call gives('c(1,2)=1 c(2,1)=1 c(2,3)=2 c(3,2)=2')
    call gives('c=0,1,0,1,0,2,0,2,0')
    call gives('c(1,:)=0,1,0 c(2,1:2)=1,0 c(2,3)=2 c(3,:)=0,2,0')
  contains
    subroutine gives(items)
      character(len=*), intent(in) :: items   !< of &structure
      type(document_type) :: document
      type(diagnostics_type) :: diagnostics
      type(matrix_type) :: matrix
      logical :: ok

      call document_from_text(tester, '&structure '//items//' /'//eol, document)
      call read_matrix(document%groups(1), 0, matrix, ok, diagnostics)
      call tester%is_true(ok .and. diagnostics%count == 0, 'a matrix: '//items)
      if (ok) call tester%is_true(all(shape(matrix%c) == [3, 3]), 'its size')
      if (ok) call tester%is_true(all(matrix%c == chain), 'its elements')
    end subroutine gives
  end subroutine matrices

  subroutine bad_matrices(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call says('c(1,:)=0,1,0 c(3,:)=0,2,0', 'row 2 of c is missing')
    call says('c(1,:)=0,1 c(2,:)=1,0,2 c(3,:)=0,2,0', 'row 1 of c has 2 values where 3 links need 3')
    call says('c(1,:)=0,1,0 c(2,:)=1,0,2 c(3,:)=0,2,0 c(1,2)=1', 'c(1,2) is given twice')
    call says('c(1)=0', "'c' takes two subscripts: write its row 1 as c(1,:) = ...")
    call says('c(4,1)=1', "the subscripts of 'c' go beyond the 3 links")
    call says('c(1,:)=0,1,0 c(2,1:2)=1,0 c(3,:)=0,2,0', 'c(2,3) is missing')
  contains
    subroutine says(items, message)
      character(len=*), intent(in) :: items     !< of &structure
      character(len=*), intent(in) :: message   !< the right message
      type(document_type) :: document
      type(diagnostics_type) :: diagnostics
      type(matrix_type) :: matrix
      logical :: ok

      call document_from_text(tester, '&structure '//items//' /'//eol, document)
      call read_matrix(document%groups(1), 3, matrix, ok, diagnostics)
      call tester%is_true(.not. ok .and. only_message(diagnostics) == message, items//': '//only_message(diagnostics))
    end subroutine says
  end subroutine bad_matrices

  subroutine names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call judge('P_1', .true.)
    call judge(repeat('x', 40), .true.)
    call judge(repeat('x', 41), .false.)
    call judge('', .false.)
    call judge('P.x', .false.)
    call judge('P Q', .false.)
  contains
    subroutine judge(name, good)
      character(len=*), intent(in) :: name   !< of a point
      logical, intent(in) :: good            !< names may be so
      type(document_type) :: document
      type(diagnostics_type) :: diagnostics

      call document_from_text(tester, "&point name='"//name//"', link=1 /"//eol, document)
      call check_name(document%groups(1), name, diagnostics)
      call tester%is_true((diagnostics%count == 0) .eqv. good, 'the name '''//name//'''')
    end subroutine judge
  end subroutine names
end module test_items
