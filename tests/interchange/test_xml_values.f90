!> Numbers and words in attributes and texts of XML elements, and the refusals of others.
module test_xml_values
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, exit_data
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_values, only: get_numbers, get_number, get_list, needed_attribute, numbers_in, get_content, get_content_number, &
    is_true, place_in, one_of
  use mech9_testing, only: tester_type
  use mech9_checks, only: has_message
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('numbers')) call numbers(tester)
    if (tester%runs('extremes')) call extremes(tester)
    if (tester%runs('refusals')) call refusals(tester)
    if (tester%runs('texts')) call texts(tester)
    if (tester%runs('words')) call words(tester)
  end subroutine run

  !> A document of one element with one attribute `a`.
  subroutine with_attribute(value, tree)
    character(len=*), intent(in) :: value      !< value of the attribute
    type(xml_tree_type), intent(out) :: tree   !< the document

    call tree%begin('v.xml')
    call tree%add_element(0, 'e', 7, 9)
    call tree%add_attribute('a', value)
  end subroutine with_attribute

  subroutine numbers(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err
    real(wp) :: three(3), one
    real(wp), allocatable :: list(:)

    call with_attribute(achar(10)//' 1'//achar(9)//'-2.5e1  .5 ', tree)
    three = 0.0_wp
    call get_numbers(tree, 1, 'a', three, err)
    call tester%no_error(err, 'blanks of all kinds divide numbers')
    call tester%is_true(all(abs(three - [1.0_wp, -25.0_wp, 0.5_wp]) <= 0.0_wp), 'three numbers')
    call get_list(tree, 1, 'a', list, err)
    call tester%is_true(size(list) == 3, 'a list takes as many numbers as there are')
    call get_list(tree, 1, 'b', list, err)
    call tester%is_true(size(list) == 0, 'and none where there is no attribute')
    one = 4.0_wp
    call get_number(tree, 1, 'b', one, err)
    call get_number(tree, 0, 'a', one, err)
    call tester%is_true(abs(one - 4.0_wp) <= 0.0_wp .and. .not. allocated(err), 'a default stays where nothing is given')
  end subroutine numbers

  !> Data files hold numbers from 1e-100 to 1e100.
  subroutine extremes(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err
    real(wp) :: three(3)

    call with_attribute('1e-101 -1e100 1e-100', tree)
    call get_numbers(tree, 1, 'a', three, err)
    call tester%no_error(err, 'the largest number is read')
    call tester%is_true(.not. abs(three(1)) > 0.0_wp, 'a smaller number counts as zero')
    call tester%is_true(three(2) < -0.9e100_wp .and. three(3) > 0.0_wp, 'the limits themselves stay')
    call with_attribute('1e101', tree)
    call get_number(tree, 1, 'a', three(1), err)
    call has_message(tester, err, exit_data, "v.xml:7:9: 'a': '1e101' is too large", 'a larger number is refused')
  end subroutine extremes

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err
    real(wp) :: two(2)
    real(wp), allocatable :: list(:)

    two = 3.0_wp
    call with_attribute('1 2 3', tree)
    call get_numbers(tree, 1, 'a', two, err)
    call has_message(tester, err, exit_data, "'a' must hold 2 numbers, not 3", 'another number of numbers is refused')
    call tester%is_true(all(abs(two - 3.0_wp) <= 0.0_wp), 'the numbers stay as they are')
    call with_attribute('1 nan', tree)
    call get_numbers(tree, 1, 'a', two, err)
    call has_message(tester, err, exit_data, 'must hold 2 numbers, not 3', 'the first failure stays')
    deallocate (err)
    call get_numbers(tree, 1, 'a', two, err)
    call has_message(tester, err, exit_data, "'nan'", 'what is no finite number is refused')
    deallocate (err)
    call with_attribute(repeat('1 ', 1001), tree)
    call get_list(tree, 1, 'a', list, err)
    call has_message(tester, err, exit_data, 'more than 1000 numbers', 'a list of more than 1000 numbers is refused')
  end subroutine refusals

  subroutine texts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err
    character(len=:), allocatable :: value
    real(wp) :: two(2), one

    call tree%begin('v.xml')
    call tree%add_element(0, 'e', 1, 1)
    call tree%add_element(1, 'p', 2, 1)
    call tree%add_text(2, ' 1 2 ')
    call tree%add_element(1, 'empty', 3, 1)
    call get_content(tree, 1, 'p', two, err)
    call tester%is_true(all(abs(two - [1.0_wp, 2.0_wp]) <= 0.0_wp), 'numbers in the text of an element')
    one = 5.0_wp
    call get_content_number(tree, 1, 'q', one, err)
    call tester%is_true(abs(one - 5.0_wp) <= 0.0_wp, 'a default stays where there is no element')
    call numbers_in(tree, 2, '3 4', 'the text', two, err)
    call tester%is_true(all(abs(two - [3.0_wp, 4.0_wp]) <= 0.0_wp), 'numbers in a text')
    call tester%no_error(err, 'all of these are good')
    call get_content_number(tree, 1, 'empty', one, err)
    call has_message(tester, err, exit_data, 'v.xml:3:1: <empty> must hold 1 numbers, not 0', 'an empty element is refused')
    deallocate (err)
    value = needed_attribute(tree, 2, 'name', err)
    call has_message(tester, err, exit_data, "v.xml:2:1: <p> needs 'name'", 'an attribute that is needed')
  end subroutine texts

  subroutine words(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=5), parameter :: list(3) = [character(len=5) :: 'one', 'two', 'three']

    call tester%is_true(all([place_in(list, 'two'), place_in(list, 'four'), place_in(list, 'thre')] == [2, 0, 0]), 'places')
    call tester%is_true(one_of(list) == 'the types are one, two and three', 'a remedy lists three words')
    call tester%is_true(one_of(list(:2)) == 'the types are one and two', 'a remedy lists two words')
    call tester%is_true(is_true('true') .and. is_true('1') .and. .not. (is_true('false') .or. is_true('') .or. is_true('yes')), &
                        'words that say yes')
  end subroutine words
end module test_xml_values
