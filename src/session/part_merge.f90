!> The files of parts, joined to one file of the whole study or search.
module mech9_part_merge
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: program_names
  use mech9_text, only: string_type
  use mech9_error, only: error_type, exit_done
  use mech9_command_line, only: command_line_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: open_existing, has_data_set
  use mech9_overwriting, only: refuse_overwriting
  use mech9_study_merge, only: merge_studies
  use mech9_starts_merge, only: merge_searches
  implicit none
  private
  public :: merge_parts

contains

  !> Join the files that --merge names, to the file that --hdf5 names and a table; `code` is the exit code of the program.
  subroutine merge_parts(options, code)
    type(command_line_type), intent(in) :: options   !< the command line
    integer, intent(out) :: code                     !< exit code
    type(string_type), allocatable :: paths(:)
    type(error_type), allocatable :: err
    logical :: are_searches

    call options%arguments('merge', paths)
    call refuse_overwriting(options, paths, err)
    if (.not. allocated(err)) call judge_first(paths(1)%text, are_searches, err)
    if (.not. allocated(err)) then
      if (are_searches) then
        call merge_searches(options, paths, err)
      else
        call merge_studies(options, paths, err)
      end if
    end if
    code = exit_done
    if (.not. allocated(err)) return
    code = err%code
    write (error_unit, '(3a)') program_names(options%program), ': ', err%message
  end subroutine merge_parts

  !> Find out whether the first file is that of a search.
  subroutine judge_first(path, is_search, err)
    character(len=*), intent(in) :: path                !< of the file
    logical, intent(out) :: is_search                   !< it is
    type(error_type), allocatable, intent(out) :: err   !< allocated if it is no file of HDF5
    type(hdf5_file_type) :: file

    is_search = .false.
    call open_existing(path, .false., file, err)
    if (allocated(err)) return
    is_search = has_data_set(file, 'optimum/definition')
    call file%close()
  end subroutine judge_first
end module mech9_part_merge
