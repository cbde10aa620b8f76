!> The origin of results in an HDF5 file that a program writes, or joins of parts.
module mech9_hdf5_record
  use mech9_program_kind, only: program_names
  use mech9_data_file, only: data_file_type
  use mech9_provenance_layout, only: origin_type, write_origin, set_present_time
  use mech9_hdf5_file, only: hdf5_file_type, hdf5_version
  use mech9_hdf5_reading, only: read_text
  implicit none
  private
  public :: write_provenance, copy_provenance

contains

  !> Write the origin of the results, with all data that are needed to compute them again.
  subroutine write_provenance(file, given, created)
    type(hdf5_file_type), intent(inout) :: file      !< the open file
    type(data_file_type), intent(in) :: given        !< the data file
    character(len=*), intent(in), optional :: created   !< time when the run began; the present time unless it is given
    type(origin_type) :: origin

    call set_present_time(origin%began)
    if (present(created)) origin%began = created
    origin%program = program_names(given%model%program)
    origin%command_line = program_names(given%model%program)
    origin%data_file = ''
    if (allocated(given%command_line)) origin%command_line = origin%command_line//' '//given%command_line
    if (allocated(given%path)) origin%data_file = given%path
    origin%data = given%document%source%text
    origin%storage = trim(hdf5_version())
    call write_origin(file, given%model%mechanism%title, origin)
  end subroutine write_provenance

  !> Copy the origin of the first part.
  subroutine copy_provenance(from, to)
    type(hdf5_file_type), intent(inout) :: from   !< the file of the part
    type(hdf5_file_type), intent(inout) :: to     !< the file of the whole study or search
    character(len=*), parameter :: names(*) = [character(len=12) :: 'program', 'version', 'revision', 'compiler', 'libraries', &
                                               'created', 'command_line', 'data_file', 'data']
    character(len=:), allocatable :: text
    integer :: i

    do i = 1, size(names)
      call read_text(from, 'provenance/'//trim(names(i)), text)
      call to%put('provenance/'//trim(names(i)), text, 'of the first part')
    end do
    if (allocated(from%failure)) call to%fail("the origin in '"//from%path//"' cannot be read")
  end subroutine copy_provenance
end module mech9_hdf5_record
