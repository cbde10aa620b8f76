!> The tree of an XML document: relatives of elements, attributes, texts, places, and the insertion of another document.
module test_xml_tree
  use mech9_error, only: error_type, exit_data, exit_file
  use mech9_text, only: to_text
  use mech9_xml_tree, only: xml_tree_type
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('relatives')) call relatives(tester)
    if (tester%runs('attributes_and_texts')) call attributes_and_texts(tester)
    if (tester%runs('growth')) call growth(tester)
    if (tester%runs('failures')) call failures(tester)
    if (tester%runs('insertion')) call insertion(tester)
    if (tester%runs('empty_insertion')) call empty_insertion(tester)
  end subroutine run

  !> <root><a/><b><a/></b><a/></root>, with the numbers 1 to 5.
  subroutine small_tree(tree)
    type(xml_tree_type), intent(out) :: tree   !< the document

    call tree%begin('file.xml')
    call tree%add_element(0, 'root', 1, 1)
    call tree%add_element(1, 'a', 2, 3)
    call tree%add_element(1, 'b', 3, 3)
    call tree%add_element(3, 'a', 4, 5)
    call tree%add_element(1, 'a', 5, 7)
  end subroutine small_tree

  subroutine relatives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree

    call small_tree(tree)
    call tester%is_true(tree%count == 5 .and. tree%name(3) == 'b', 'elements are counted in the order in which they begin')
    call tester%is_true(all([tree%parent(1), tree%parent(4), tree%parent(5)] == [0, 3, 1]), 'parents')
    call tester%is_true(all([tree%first_child(1), tree%first_child(3), tree%first_child(2), tree%first_child(0)] == [2, 4, 0, 0]), &
                        'first elements in others')
    call tester%is_true(all([tree%next_sibling(2), tree%next_sibling(3), tree%next_sibling(5)] == [3, 5, 0]), 'next elements')
    call tester%is_true(all([tree%child(1, 'a'), tree%child(1, 'b'), tree%child(1, 'c'), tree%child(0, 'a')] == [2, 3, 0, 0]), &
                        'first elements of a name')
    call tester%is_true(all([tree%next_named(2, 'a'), tree%next_named(5, 'a')] == [5, 0]), 'next elements of a name')
    call tester%is_true(tree%child(1, 'a ') == 0, 'a blank at the end of a name counts')
    call tester%is_true(all([tree%depth(1), tree%depth(3), tree%depth(4)] == [1, 2, 3]), 'depths')
    call tester%is_true(tree%line_place(4) == 'file.xml:4' .and. tree%place(4) == 'file.xml:4:5', 'places')
  end subroutine relatives

  subroutine attributes_and_texts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree

    call tree%begin('file.xml')
    call tree%add_element(0, 'root', 1, 1)
    call tree%add_attribute('size', '3')
    call tree%add_attribute('siz', '')
    call tree%add_text(1, achar(10)//'  one')
    call tree%add_text(1, ' two '//achar(9))
    call tree%add_element(1, 'a', 2, 1)
    call tree%add_attribute('other', 'x')
    call tree%add_text(1, 'behind')
    call tester%is_true(tree%attribute(1, 'size') == '3', 'the value of an attribute')
    call tester%is_true(tree%has(1, 'siz') .and. tree%attribute(1, 'siz') == '', 'an attribute may be empty')
    call tester%is_true(.not. tree%has(1, 'size ') .and. .not. tree%has(1, 'other'), 'names count to their ends, in one element')
    call tester%is_true(.not. tree%has(0, 'size') .and. tree%attribute(0, 'size') == '', 'no element has no attributes')
    call tester%is_true(tree%content(1) == 'one two', 'pieces of text are joined, blanks around them are left out')
    call tester%is_true(tree%content(2) == '', 'an element may have no text')
  end subroutine attributes_and_texts

  !> Lists grow: every element keeps its own name and attribute.
  subroutine growth(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    integer, parameter :: n = 1500
    type(xml_tree_type) :: tree
    logical :: right
    integer :: i

    call tree%begin('file.xml')
    call tree%add_element(0, 'root', 1, 1)
    do i = 2, n
      call tree%add_element(1, 'element_'//to_text(i), i, 1)
      call tree%add_attribute('number', 'the number '//to_text(i))
    end do
    right = tree%count == n
    do i = 2, n
      right = right .and. tree%name(i) == 'element_'//to_text(i) .and. tree%attribute(i, 'number') == 'the number '//to_text(i)
    end do
    call tester%is_true(right, 'a long document keeps all names and values')
  end subroutine growth

  subroutine failures(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err

    call small_tree(tree)
    call tree%fail(5, 'is wrong', err)
    call tester%has_error(err, exit_data, 'a failure is one of the data')
    if (allocated(err)) call tester%is_true(err%message == 'file.xml:5:7: is wrong', 'it has the place of its element')
    call tree%fail(2, 'is wrong too', err, exit_file)
    if (allocated(err)) call tester%is_true(err%message == 'file.xml:5:7: is wrong', 'an earlier failure stays')
    deallocate (err)
    call tree%fail(2, 'cannot be read', err, exit_file)
    call tester%has_error(err, exit_file, 'a failure has the code that is given')
    deallocate (err)
    call tree%fail(2, 'the word '//repeat('x', 100000)//' ends', err)
    call tester%is_true(len(err%message) < 300, 'a word of a hostile file is shortened')
    call tester%is_true(index(err%message, 'the word x') > 0 .and. index(err%message, 'x ends') > 0, 'the words around it stay')
  end subroutine failures

  !> The elements of the other document stand between the neighbours of the element that they replace.
  subroutine insertion(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree, other
    integer :: e

    call small_tree(tree)
    call other%begin('other.xml')
    call other%add_element(0, 'root', 1, 1)
    call other%add_attribute('of', 'the root')
    call other%add_element(1, 'first', 2, 2)
    call other%add_attribute('size', '7')
    call other%add_text(2, 'words')
    call other%add_element(2, 'inner', 3, 4)
    call other%add_element(1, 'second', 4, 2)
    call tree%insert(3, other)
    e = tree%next_sibling(2)
    call tester%is_true(tree%name(e) == 'first' .and. tree%parent(e) == 1, 'the first one follows the element before')
    call tester%is_true(tree%attribute(e, 'size') == '7' .and. tree%content(e) == 'words', 'it keeps attribute and text')
    call tester%is_true(tree%place(e) == 'other.xml:2:2' .and. tree%depth(e) == 2 .and. tree%file(e) == 2, 'it keeps its place')
    call tester%is_true(tree%name(tree%first_child(e)) == 'inner' .and. tree%depth(tree%first_child(e)) == 3, 'and its elements')
    e = tree%next_sibling(e)
    call tester%is_true(tree%name(e) == 'second' .and. tree%next_sibling(e) == 5, 'the second one precedes the element behind')
    call tester%is_true(tree%place(5) == 'file.xml:5:7', 'the other elements keep their places')
    call tree%insert(5, other)
    e = tree%next_named(2, 'second')
    call tester%is_true(tree%name(tree%next_sibling(e)) == 'first', 'a document may replace the last element')
    e = tree%next_named(e, 'second')
    call tester%is_true(e > 0 .and. tree%next_sibling(e) == 0, 'its last element is then the last one')
    call tree%add_element(1, 'end', 9, 1)
    call tester%is_true(tree%next_sibling(e) == tree%count, 'a further element stands behind it')
  end subroutine insertion

  subroutine empty_insertion(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree, other

    call small_tree(tree)
    call other%begin('empty.xml')
    call other%add_element(0, 'root', 1, 1)
    call tree%insert(3, other)
    call tester%is_true(tree%next_sibling(2) == 5 .and. tree%child(1, 'b') == 0, 'an empty document takes the element out')
    call tree%insert(5, other)
    call tester%is_true(tree%next_sibling(2) == 0, 'the last element is taken out')
    call tree%insert(2, other)
    call tester%is_true(tree%first_child(1) == 0, 'the only element is taken out')
    call tree%add_element(1, 'new', 8, 1)
    call tester%is_true(tree%first_child(1) == tree%count, 'a new element is then the only one')
  end subroutine empty_insertion
end module test_xml_tree
