!> XML files read by expat: elements with their places, and the refusals of other files.
module test_expat_reader
  use mech9_error, only: error_type, exit_data, exit_file
  use mech9_expat_reader, only: read_xml
  use mech9_xml_tree, only: xml_tree_type, deepest_element
  use mech9_testing, only: tester_type
  use mech9_checks, only: has_message
  use mech9_test_files, only: save_lines, remove_file
  use xml_texts, only: read_lines
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_expat_reader.xml'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('document')) call document(tester)
    if (tester%runs('refusals')) call refusals(tester)
    if (tester%runs('depth')) call depth(tester)
  end subroutine run

  subroutine document(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree

    call read_lines(tester, path, [character(len=60) :: '<?xml version="1.0"?>', '<!-- words -->', &
                                   '<a one="1&lt;2" two=''"''>', '  te<!-- hidden -->xt &amp; <![CDATA[<more>]]>', &
                                   '  <b/><c>&#65;</c>', 'behind</a>'], tree)
    call tester%is_true(tree%count == 3, 'a document of three elements')
    if (tree%count /= 3) return
    call tester%is_true(tree%attribute(1, 'one') == '1<2' .and. tree%attribute(1, 'two') == '"', 'values of attributes')
    call tester%is_true(tree%content(1) == 'text & <more>', 'text without comments, up to the first element')
    call tester%is_true(tree%name(3) == 'c' .and. tree%parent(3) == 1 .and. tree%content(3) == 'A', 'a number of a letter')
    call tester%is_true(tree%place(1) == path//':3:1' .and. tree%place(3) == path//':5:7', 'places')
  end subroutine document

  !> Each of these documents fails with the place that is told.
  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err

    call refused([character(len=40) :: '<a>', '  <b></a>'], ':2:', 'this is not well-formed XML')
    call refused([character(len=40) :: ''], ':', 'this is not well-formed XML')
    call refused([character(len=40) :: '<a/>', '<b/>'], ':2:1: ', 'this is not well-formed XML')
    call refused([character(len=40) :: '<a b="1" b="2"/>'], ':1:', 'this is not well-formed XML')
    call refused([character(len=40) :: '', '<!DOCTYPE a [<!ENTITY b "c">]>', '<a>&b;</a>'], ':2:', 'a document type declaration')
    call read_xml('there_is_no_such_file.xml', tree, err)
    call has_message(tester, err, exit_file, 'there_is_no_such_file.xml: cannot be read: there is no such file', 'no file')
  contains
    subroutine refused(lines, place, reason)
      character(len=*), intent(in) :: lines(:)   !< the document
      character(len=*), intent(in) :: place      !< its part behind the path
      character(len=*), intent(in) :: reason     !< words of the message

      call save_lines(tester, path, lines)
      call read_xml(path, tree, err)
      call has_message(tester, err, exit_data, path//place, 'the place of a refusal')
      call has_message(tester, err, exit_data, reason, 'the reason of a refusal')
      call remove_file(path)
    end subroutine refused
  end subroutine refusals

  !> The deepest element is read, one below it is refused.
  subroutine depth(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err

    call read_lines(tester, path, [repeat('<a>', deepest_element)//repeat('</a>', deepest_element)], tree)
    call tester%is_true(tree%count == deepest_element, 'the greatest depth is read')
    call save_lines(tester, path, [repeat('<a>', deepest_element + 1)//repeat('</a>', deepest_element + 1)])
    call read_xml(path, tree, err)
    call has_message(tester, err, exit_data, 'elements are nested more than', 'a greater depth is refused')
    call remove_file(path)
  end subroutine depth
end module test_expat_reader
