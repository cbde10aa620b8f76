!> The files about the programs that are installed beside them: manual pages and completions.
module mech9_pages
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: program_names
  use mech9_error, only: error_type, exit_done
  use mech9_text_file, only: save_text
  use mech9_system, only: exit_program
  use mech9_manual_page, only: manual_page
  use mech9_bash_completion, only: bash_completion
  implicit none
  private
  public :: write_pages


contains

  !> Write the files into the current folder, as PROGRAM.1 and PROGRAM.bash, and end the program.
  subroutine write_pages()
    type(error_type), allocatable :: err
    integer :: i

    do i = 1, size(program_names)
      call save_text(program_names(i)//'.1', manual_page(i), err)
      if (.not. allocated(err)) call save_text(program_names(i)//'.bash', bash_completion(i), err)
      if (allocated(err)) then
        write (error_unit, '(a)') err%message
        call exit_program(err%code)
      end if
    end do
    call exit_program(exit_done)
  end subroutine write_pages
end module mech9_pages
