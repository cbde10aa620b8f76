!> A description in XDMF of the moving links in an HDF5 file, for ParaView and similar programs.
!>
!> Each output is a grid of lines between vertices. The numbers stay in the HDF5 file, which must stand beside the
!> description.
module mech9_xdmf
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: to_text
  use mech9_path, only: name_of, with_ending
  use mech9_result_sink, only: result_sink_type
  use mech9_page, only: page_type
  use mech9_xml_text, only: xml_text
  implicit none
  private
  public :: xdmf_type, new_xdmf, xdmf_path

  !> The largest number of outputs that are shown. If there are more they are thinned out evenly.
  integer, parameter :: most_steps = 2000

  !> A sink that counts the rows, and writes the description when it is closed.
  type, extends(result_sink_type) :: xdmf_type
    private
    character(len=:), allocatable :: path        !< file of the description
    character(len=:), allocatable :: data_name   !< name of the HDF5 file, without its folder
    character(len=:), allocatable :: title
    real(wp), allocatable :: times(:)            !< (outputs) [s]
    integer :: n_vertices = 0, n_lines = 0
    integer :: rows = 0
    logical :: is_open = .false.
  contains
    procedure :: write_rows
    procedure :: close => save_description
    procedure :: words
  end type xdmf_type

contains

  !> The description of an HDF5 file that will be written. It has the name of this file with the ending .xdmf.
  pure function new_xdmf(hdf5_path, title, times, n_vertices, n_lines) result(sink)
    character(len=*), intent(in) :: hdf5_path      !< name of the HDF5 file
    character(len=*), intent(in) :: title          !< title of the mechanism
    real(wp), intent(in) :: times(:)               !< (outputs) times of the results [s]
    integer, intent(in) :: n_vertices              !< vertices that show the links
    integer, intent(in) :: n_lines                 !< lines between them
    type(xdmf_type) :: sink

    sink%data_name = name_of(hdf5_path)
    sink%path = xdmf_path(hdf5_path)
    sink%title = title
    sink%times = times
    sink%n_vertices = n_vertices
    sink%n_lines = n_lines
    sink%is_open = .true.
  end function new_xdmf

  !> The file of the description; it stands beside the HDF5 file.
  pure function xdmf_path(hdf5_path) result(path)
    character(len=*), intent(in) :: hdf5_path  !< name of the HDF5 file
    character(len=:), allocatable :: path

    path = with_ending(hdf5_path, 'xdmf')
  end function xdmf_path

  !> Count rows of results.
  subroutine write_rows(self, rows, err)
    class(xdmf_type), intent(inout) :: self            !< names, counts and times for the description
    real(wp), intent(in), contiguous :: rows(:, :)     !< (columns,rows) rows of the results, which are only counted
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    self%rows = self%rows + size(rows, 2)
  end subroutine write_rows

  !> Write the description when the results are complete. Errors are exit_file.
  subroutine save_description(self, err)
    class(xdmf_type), intent(inout) :: self            !< names, counts and times for the description
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(page_type) :: page
    integer :: i

    if (.not. self%is_open) return
    self%is_open = .false.
    call page%line('<?xml version="1.0" encoding="UTF-8"?>')
    call page%line('<Xdmf Version="3.0">')
    call page%line('<Domain>')
    call page%line('<Grid Name="'//xml_text(self%title)//'" GridType="Collection" CollectionType="Temporal">')
    do i = 1, self%rows, 1 + (self%rows - 1)/most_steps
      call put_step(self, i - 1, page)
    end do
    call page%line('</Grid>')
    call page%line('</Domain>')
    call page%line('</Xdmf>')
    call page%save(self%path, err)
  end subroutine save_description

  !> Append one output: lines between vertices, and the link of each line.
  subroutine put_step(self, row, page)
    type(xdmf_type), intent(in) :: self     !< names, counts and times for the description
    integer, intent(in) :: row              !< number of the row in the HDF5 file, from 0
    type(page_type), intent(inout) :: page  !< text to which the page is appended
    character(len=:), allocatable :: vertices, lines

    vertices = to_text(self%n_vertices)//' 3'
    lines = to_text(self%n_lines)
    call page%line('<Grid Name="links"><Time Value="'//to_text(self%times(row + 1), 17)//'"/>')
    call page%line('<Topology TopologyType="Polyline" NodesPerElement="2" NumberOfElements="'//lines//'">'// &
                   item(self, lines//' 2', 'Int', 'shape/line')//'</Topology>')
    call page%line('<Geometry GeometryType="XYZ"><DataItem ItemType="HyperSlab" Dimensions="'//vertices//'">'// &
                   '<DataItem Dimensions="3 3" NumberType="Int" Format="XML">'//to_text(row)//' 0 0 1 1 1 1 '// &
                   vertices//'</DataItem>')
    call page%line(item(self, to_text(self%rows)//' '//vertices, 'Float', 'vertex')//'</DataItem></Geometry>')
    call page%line('<Attribute Name="link" AttributeType="Scalar" Center="Cell">'// &
                   item(self, lines, 'Int', 'shape/line_link')//'</Attribute></Grid>')
  end subroutine put_step

  !> A reference to numbers in the HDF5 file.
  pure function item(self, dimensions, type, data_set) result(text)
    type(xdmf_type), intent(in) :: self         !< names, counts and times for the description
    character(len=*), intent(in) :: dimensions  !< numbers of entries along each dimension
    character(len=*), intent(in) :: type        !< Int or Float
    character(len=*), intent(in) :: data_set    !< path of the data set in the HDF5 file
    character(len=:), allocatable :: text

    text = '<DataItem Dimensions="'//dimensions//'" NumberType="'//type//'" Precision="'// &
           merge('8', '4', type == 'Float')//'" Format="HDF">'//xml_text(self%data_name)//':/'//data_set//'</DataItem>'
  end function item

  !> The line for the user after the description is written.
  function words(self)
    class(xdmf_type), intent(in) :: self  !< names, counts and times for the description
    character(len=:), allocatable :: words

    words = 'for ParaView: '//self%path
  end function words
end module mech9_xdmf
