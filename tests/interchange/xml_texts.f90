!> XML documents from lines of text, for the tests of readers.
module xml_texts
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_reader, only: read_xml
  use mech9_testing, only: tester_type
  use mech9_test_files, only: save_lines, remove_file
  implicit none
  private
  public :: read_lines, symmetric

contains

  !> Read lines as a document. Its places begin with the path, which no other suite may use at the same time.
  subroutine read_lines(tester, path, lines, tree)
    type(tester_type), intent(inout) :: tester    !< counts the checks
    character(len=*), intent(in) :: path          !< file that is written, read and removed
    character(len=*), intent(in) :: lines(:)      !< the document
    type(xml_tree_type), intent(out) :: tree      !< its elements
    type(error_type), allocatable :: err

    call save_lines(tester, path, lines)
    call read_xml(path, tree, err)
    call tester%no_error(err, 'the document of the case is XML')
    call remove_file(path)
  end subroutine read_lines

  !> The symmetric tensor of its components xx, yy, zz, xy, xz, yz.
  pure function symmetric(j) result(tensor)
    real(wp), intent(in) :: j(6)   !< components [kg m^2]
    real(wp) :: tensor(3, 3)

    tensor = reshape([j(1), j(4), j(5), j(4), j(2), j(6), j(5), j(6), j(3)], [3, 3])
  end function symmetric
end module xml_texts
