!> Writing of the files for AUTO-07p, a part of mech9-link --auto: its arguments are the data file, the folder and the name of the files.
program mech9_auto
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use mech9, only: mechanism_type, error_type, read_file
  use mech9_auto_files, only: write_auto_files
  use mech9_system, only: exit_program, take_argument
  implicit none
  type(mechanism_type) :: mechanism
  type(error_type), allocatable :: err
  character(len=:), allocatable :: path, folder, name, files

  call take_argument(1, path)
  call take_argument(2, folder)
  call take_argument(3, name)
  call read_file(path, mechanism, err)
  if (.not. allocated(err)) call write_auto_files(mechanism, path, folder, name, files, err)
  if (allocated(err)) then
    write (error_unit, '(a)') err%message
    call exit_program(err%code)
  end if
  write (output_unit, '(a)') files
end program mech9_auto
