!> Elements <include> of MJCF: the elements in the root of another file take the place of the element that names this file.
module mech9_mjcf_includes
  use mech9_error, only: error_type, exit_file
  use mech9_text, only: to_text
  use mech9_path, only: folder_of
  use mech9_same_file, only: file_place_type, find_place, same_place, is_regular
  use mech9_xml_tree, only: xml_tree_type, deepest_element
  use mech9_xml_reader, only: read_xml
  use mech9_xml_values, only: needed_attribute
  implicit none
  private
  public :: follow_includes

  !> No model has more files, or more elements in all of them.
  integer, parameter :: most_files = 200, most_elements = 2000000

contains

  !> Follow all elements <include> of a document, and those of the files that they name.
  subroutine follow_includes(tree, err)
    type(xml_tree_type), intent(inout) :: tree         !< the document; gets the elements of the other files
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(file_place_type) :: places(most_files)
    integer :: includer(most_files), e

    includer(1) = 0
    call find_place(tree%files(1)%text, places(1))
    e = 1
    do while (e < tree%count .and. .not. allocated(err))
      e = e + 1
      if (tree%name(e) == 'include') call follow(tree, e, places, includer, err)
    end do
  end subroutine follow_includes

  !> Put the elements of a file in the place of an element <include>.
  subroutine follow(tree, element, places, includer, err)
    type(xml_tree_type), intent(inout) :: tree             !< the document
    integer, intent(in) :: element                         !< number of the element <include>
    type(file_place_type), intent(inout) :: places(:)      !< (most_files) of the files in the file system
    integer, intent(inout) :: includer(:)                  !< (most_files) number of the file that names each file; 0: none
    type(error_type), allocatable, intent(inout) :: err    !< the failure
    type(xml_tree_type) :: other
    character(len=:), allocatable :: path, problem
    integer :: n, e

    path = needed_attribute(tree, element, 'file', err)
    if (path == '') call tree%fail(element, '<include> names no file', err)
    if (index(path, '/') /= 1) path = folder_of(tree%files(1)%text)//path
    n = size(tree%files) + 1
    if (n > most_files) call tree%fail(element, 'the model has more than '//to_text(most_files)//' files, which are too many', err)
    if (allocated(err)) return
    call find_place(path, places(n))
    call refuse_known_file(tree, element, path, places(:n), includer, err)
    if (allocated(err)) return
    call read_xml(path, other, err)
    if (allocated(err)) then
      if (err%code /= exit_file) return
      problem = err%message
      deallocate (err)
      call tree%fail(element, problem, err, exit_file)
      return
    end if
    if (tree%count + other%count > most_elements) &
      call tree%fail(element, 'the files of the model have too many elements: more than '//to_text(most_elements), err)
    do e = 1, other%count
      if (other%depth(e) + tree%depth(element) - 2 <= deepest_element) cycle
      call other%fail(e, 'elements are nested more than '//to_text(deepest_element)//' deep, which no robot needs', err)
      exit
    end do
    if (allocated(err)) return
    includer(n) = tree%file(element)
    call tree%insert(element, other)
  end subroutine follow

  !> Fail where an element <include> names a file that is read already, or no file but a pipe or device.
  subroutine refuse_known_file(tree, element, path, places, includer, err)
    type(xml_tree_type), intent(in) :: tree                !< the document
    integer, intent(in) :: element                         !< number of the element <include>
    character(len=*), intent(in) :: path                   !< the file that it names
    type(file_place_type), intent(in) :: places(:)         !< of all files in the file system, with the new one at the end
    integer, intent(in) :: includer(:)                     !< number of the file that names each file; 0: none
    type(error_type), allocatable, intent(inout) :: err    !< the failure
    integer :: known, above, new

    new = size(places)
    if (.not. places(new)%exists) return
    if (.not. is_regular(places(new))) call tree%fail(element, "'"//path//"' is not a file that can be included", err)
    do known = 1, new - 1
      if (same_place(places(known), places(new))) exit
    end do
    if (known == new) return
    above = tree%file(element)
    do while (above > 0)
      if (above == known) call tree%fail(element, "'"//path//"' includes itself, directly or by way of other files; take "// &
                                         'this <include> out', err)
      above = includer(above)
    end do
    call tree%fail(element, "'"//path//"' is included a second time; a model may include each file once", err)
  end subroutine refuse_known_file
end module mech9_mjcf_includes
