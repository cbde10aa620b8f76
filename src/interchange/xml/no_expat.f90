!> The reader of XML of a build without expat: it says that it cannot read.
module mech9_no_expat
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_xml_tree, only: xml_tree_type
  implicit none
  private
  public :: read_xml

contains

  !> Always fails, with the remedy.
  subroutine read_xml(path, tree, err)
    character(len=*), intent(in) :: path               !< path of the file
    type(xml_tree_type), intent(out) :: tree           !< stays empty
    type(error_type), allocatable, intent(out) :: err  !< always allocated

    call tree%begin(path)
    call raise(err, exit_usage, "'"//path//"' cannot be read: this program was built without expat, the library that "// &
               'reads XML; install it (Debian: libexpat1-dev) and build the program again')
  end subroutine read_xml
end module mech9_no_expat
