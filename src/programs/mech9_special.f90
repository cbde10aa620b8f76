!> Writing of code for one mechanism, a part of mech9-link --specialise: its arguments are the data file and the file of the code.
program mech9_special
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use mech9, only: mechanism_type, error_type, read_file
  use mech9_made_code, only: write_made_code
  use mech9_system, only: exit_program, take_argument
  implicit none
  type(mechanism_type) :: mechanism
  type(error_type), allocatable :: err
  character(len=:), allocatable :: path, file, told

  call take_argument(1, path)
  call take_argument(2, file)
  call read_file(path, mechanism, err)
  if (.not. allocated(err)) call write_made_code(mechanism, path(index(path, '/', back=.true.) + 1:), file, told, err)
  if (allocated(err)) then
    write (error_unit, '(a)') err%message
    call exit_program(err%code)
  end if
  write (output_unit, '(a)') told
end program mech9_special
