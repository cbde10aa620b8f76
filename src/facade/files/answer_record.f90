!> HDF5 files of answers in place of a run, with the origin of their numbers.
module mech9_answer_record
  use mech9_error, only: error_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_structure_layout, only: write_structure, write_coordinates
  use mech9_branches_layout, only: write_branches
  use mech9_equilibrium_layout, only: put_rows, put_forces, put_energy_shares
  use mech9_linear_layout, only: put_linear_system, put_linear_motion
  use mech9_data_file, only: data_file_type
  use mech9_recorded_branches, only: recorded_branches_type
  use mech9_recorded_linear, only: recorded_linear_motion_type
  use mech9_recorded_rest, only: rest_of_file_type
  use mech9_hdf5_record, only: write_provenance
  implicit none
  private
  public :: save_branches, save_rest, save_linear_rest, save_linear_motion

contains

  !> Save branches over a parameter.
  subroutine save_branches(path, given, found, err)
    character(len=*), intent(in) :: path                      !< of the file
    type(data_file_type), intent(in) :: given                 !< the data file
    type(recorded_branches_type), intent(in) :: found         !< the branches
    type(error_type), allocatable, intent(out) :: err         !< allocated if the file cannot be written
    type(hdf5_file_type) :: file

    call begin_file(path, given, file, err)
    if (allocated(err)) return
    call write_branches(found%branches_found_type, file)
    call end_file(file, err)
  end subroutine save_branches

  !> Save the rows of equilibria, or of the modes of the first one.
  subroutine save_rest(path, given, rest, with_modes, err)
    character(len=*), intent(in) :: path                      !< of the file
    type(data_file_type), intent(in) :: given                 !< the data file
    type(rest_of_file_type), intent(in) :: rest               !< the equilibria; the first one has the modes
    logical, intent(in) :: with_modes                         !< rows are those of modes
    type(error_type), allocatable, intent(out) :: err         !< allocated if the file cannot be written
    type(hdf5_file_type) :: file

    call begin_file(path, given, file, err)
    if (allocated(err)) return
    if (with_modes) then
      call put_rows(file, rest%columns, rest%rows, 6, size(given%model%mechanism%pairs), ['_re', '_im'])
      call put_energy_shares(file, rest%equilibria(1))
    else
      call put_rows(file, rest%columns, rest%rows, 2, size(given%model%mechanism%pairs), [''])
      call put_forces(file, given%model%mechanism, rest%columns, rest%rows, rest%forces)
    end if
    call end_file(file, err)
  end subroutine save_rest

  !> Save the matrices of the linearised equations of motion at the first equilibrium.
  subroutine save_linear_rest(path, given, rest, err)
    character(len=*), intent(in) :: path                      !< of the file
    type(data_file_type), intent(in) :: given                 !< the data file
    type(rest_of_file_type), intent(inout) :: rest            !< its first equilibrium is linearised
    type(error_type), allocatable, intent(out) :: err         !< allocated if the file cannot be written
    type(hdf5_file_type) :: file

    call begin_file(path, given, file, err)
    if (allocated(err)) return
    call put_linear_system(file, given%model, rest%equilibria(1))
    call end_file(file, err)
  end subroutine save_linear_rest

  !> Save the matrices of the linearised equations along a motion.
  subroutine save_linear_motion(path, given, found, err)
    character(len=*), intent(in) :: path                      !< of the file
    type(data_file_type), intent(in) :: given                 !< the data file
    type(recorded_linear_motion_type), intent(inout) :: found !< the matrices
    type(error_type), allocatable, intent(out) :: err         !< allocated if the file cannot be written
    type(hdf5_file_type) :: file

    call begin_file(path, given, file, err)
    if (allocated(err)) return
    call put_linear_motion(file, given%model, found%linear_motion_type)
    call end_file(file, err)
  end subroutine save_linear_motion

  !> Create an HDF5 file with the origin of its numbers, the structure and the coordinates.
  subroutine begin_file(path, given, file, err)
    character(len=*), intent(in) :: path                !< of the file
    type(data_file_type), intent(in) :: given           !< the data file
    type(hdf5_file_type), intent(inout) :: file         !< the open file
    type(error_type), allocatable, intent(out) :: err   !< allocated if the file cannot be written

    call file%create(path, err)
    if (allocated(err)) return
    call write_coordinates(file, given%model)
    call write_provenance(file, given)
    call write_structure(file, given%model)
  end subroutine begin_file

  !> Write all to the file and close it.
  subroutine end_file(file, err)
    type(hdf5_file_type), intent(inout) :: file         !< the open file
    type(error_type), allocatable, intent(out) :: err   !< the first failure of the file

    call file%flush()
    call file%close()
    if (allocated(file%failure)) err = file%failure
  end subroutine end_file
end module mech9_answer_record
