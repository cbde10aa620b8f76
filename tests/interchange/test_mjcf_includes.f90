!> Elements <include> of MJCF: the contents of files in their places, and files that include themselves or come twice.
module test_mjcf_includes
  use mech9_error, only: error_type, exit_data, exit_file
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_reader, only: read_xml
  use mech9_mjcf_includes, only: follow_includes
  use mech9_testing, only: tester_type
  use mech9_checks, only: has_message
  use mech9_test_files, only: save_lines, remove_file
  implicit none
  private
  public :: run

  character(len=*), parameter :: main = 'test_mjcf_includes.xml', part = 'test_mjcf_includes_part.xml', &
                                 inner = 'test_mjcf_includes_inner.xml'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('places')) call places(tester)
    if (tester%runs('circles')) call circles(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  !> Write three files and follow the includes of the first one.
  subroutine follow(tester, of_main, of_part, of_inner, tree, err)
    type(tester_type), intent(inout) :: tester           !< counts the checks
    character(len=*), intent(in) :: of_main              !< contents of the root of the first file
    character(len=*), intent(in) :: of_part              !< contents of the root of the second file
    character(len=*), intent(in) :: of_inner             !< contents of the root of the third file
    type(xml_tree_type), intent(out) :: tree             !< the document
    type(error_type), allocatable, intent(out) :: err    !< the failure

    call save_lines(tester, main, [character(len=120) :: '<mujoco>', of_main, '</mujoco>'])
    call save_lines(tester, part, [character(len=120) :: '<mujocoinclude>', of_part, '</mujocoinclude>'])
    call save_lines(tester, inner, [character(len=120) :: '<mujocoinclude>', of_inner, '</mujocoinclude>'])
    call read_xml(main, tree, err)
    if (.not. allocated(err)) call follow_includes(tree, err)
    call remove_file(main)
    call remove_file(part)
    call remove_file(inner)
  end subroutine follow

  subroutine places(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err
    character(len=4) :: names
    integer :: e, i

    call follow(tester, '<a/><include file="'//part//'"/><d/>', '<b/><include file="'//inner//'"/>', '<c/>', tree, err)
    call tester%no_error(err, 'a file that includes one that includes one')
    names = ''
    e = tree%first_child(1)
    do i = 1, 4
      if (e == 0) exit
      names(i:i) = tree%name(e)
      if (tree%name(e) == 'c') call tester%is_true(tree%place(e) == inner//':2:1', 'an element keeps its place')
      e = tree%next_sibling(e)
    end do
    call tester%is_true(names == 'abcd' .and. e == 0, 'the elements stand in order')
    call tester%is_true(size(tree%files) == 3, 'three files were read')
  end subroutine places

  subroutine circles(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err

    call follow(tester, '<include file="'//main//'"/>', '', '', tree, err)
    call has_message(tester, err, exit_data, main//":2:1: '"//main//"' includes itself", 'a file that includes itself')
    call follow(tester, '<include file="'//part//'"/>', '<include file="./'//part//'"/>', '', tree, err)
    call has_message(tester, err, exit_data, part//':2:1: ', 'the place of a file under another name')
    call has_message(tester, err, exit_data, 'includes itself', 'a file that includes itself under another name')
    call follow(tester, '<include file="'//part//'"/>', '<include file="'//inner//'"/>', '<include file="'//main//'"/>', tree, err)
    call has_message(tester, err, exit_data, inner//':2:1: ', 'the place of a circle')
    call has_message(tester, err, exit_data, 'includes itself', 'a circle of three files')
    call follow(tester, '<include file="'//part//'"/><include file="'//part//'"/>', '<b/>', '', tree, err)
    call has_message(tester, err, exit_data, "'"//part//"' is included a second time", 'a file that comes twice')
  end subroutine circles

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(xml_tree_type) :: tree
    type(error_type), allocatable :: err

    call follow(tester, '<include/>', '', '', tree, err)
    call has_message(tester, err, exit_data, main//":2:1: <include> needs 'file'", 'no name')
    call follow(tester, '<include file=""/>', '', '', tree, err)
    call has_message(tester, err, exit_data, '<include> names no file', 'an empty name')
    call follow(tester, '<include file="."/>', '', '', tree, err)
    call has_message(tester, err, exit_data, 'is not a file that can be included', 'a folder')
    call follow(tester, '<include file="there_is_none.xml"/>', '', '', tree, err)
    call has_message(tester, err, exit_file, main//':2:1: there_is_none.xml: cannot be read', 'a file that is not there')
    call follow(tester, '<include file="'//part//'"/>', '<b>', '', tree, err)
    call has_message(tester, err, exit_data, part//':3:', 'a file that is not XML')
  end subroutine refusals
end module test_mjcf_includes
