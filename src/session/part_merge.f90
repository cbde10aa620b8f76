!> The files of parts, joined to one file of the whole study or search.
module mech9_part_merge
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: program_names
  use mech9_text, only: string_type, to_text
  use mech9_counted, only: counted
  use mech9_error, only: error_type, raise, exit_done, exit_usage
  use mech9_command_line, only: command_line_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: open_existing, has_data_set
  use mech9_overwriting, only: refuse_overwriting
  use mech9_kept_files, only: kept_files_type
  use mech9_study_merge, only: merge_studies, merged_study_type
  use mech9_starts_merge, only: merge_searches, merged_search_type
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
        call join_searches(options, paths, err)
      else
        call join_studies(options, paths, err)
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

  !> Join the runs of a study to the file that --hdf5 names and a table.
  subroutine join_studies(options, paths, err)
    type(command_line_type), intent(in) :: options        !< the command line
    type(string_type), intent(in) :: paths(:)             !< of the files
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(kept_files_type) :: wanted
    type(merged_study_type) :: merged

    wanted%table = options%argument('table')
    wanted%hdf5 = options%argument('hdf5')
    call merge_studies(options%program, paths, wanted, merged, err)
    if (.not. (allocated(err) .or. options%has('quiet'))) call print_study(options, paths, merged)
  end subroutine join_studies

  !> Join the starts of a search to the file that --hdf5 names.
  subroutine join_searches(options, paths, err)
    type(command_line_type), intent(in) :: options        !< the command line
    type(string_type), intent(in) :: paths(:)             !< of the files
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(merged_search_type) :: merged

    if (options%has('table')) then
      call raise(err, exit_usage, '--merge of a search writes no table, since designs are compared by their data file; leave '// &
                 '--table out, and give it to --optimize --continue of the whole file')
      return
    end if
    call merge_searches(paths, options%argument('hdf5'), merged, err)
    if (.not. (allocated(err) .or. options%has('quiet'))) call print_search(options, size(paths), merged)
  end subroutine join_searches

  !> Tell which runs the whole study has, which it lacks, and which more than one part had.
  subroutine print_study(options, paths, merged)
    type(command_line_type), intent(in) :: options     !< the command line
    type(string_type), intent(in) :: paths(:)          !< of the files
    type(merged_study_type), intent(in) :: merged      !< the runs that the files have
    integer :: i

    associate (runs => merged%runs, sums => merged%sums, overlap => merged%overlap)
      write (error_unit, '(a)') counted(sums%made(), 'run')//' of '//to_text(runs)//' from '//counted(size(paths), 'file')
      do i = 1, sums%n_codes
        write (error_unit, '(a)') counted(sums%failed(i), 'run')//' failed with exit code '//to_text(sums%codes(i))// &
          ', the first one is run '//to_text(sums%first_failed(i))
      end do
      if (overlap%runs > 0) &
        write (error_unit, '(a)') 'note: '//counted(overlap%runs, 'run')//' stood in more than one file, with the same numbers; '&
        //'first of them run '//to_text(overlap%first)//" in '"//paths(overlap%files(1))%text//"' and '"// &
        paths(overlap%files(2))%text//"'"
      if (sums%made() < runs) &
        write (error_unit, '(a)') 'note: '//counted(runs - sums%made(), 'run')// &
        ' of the study are not made yet; --study --continue makes them'
    end associate
    if (options%has('table') .and. options%argument('table') /= '-') write (error_unit, '(2a)') 'table: ', options%argument('table')
    if (options%has('hdf5')) write (error_unit, '(2a)') 'HDF5 file: ', options%argument('hdf5')
  end subroutine print_study

  !> Tell which starts the whole file has, which it lacks, and which more than one part had.
  subroutine print_search(options, n_files, merged)
    type(command_line_type), intent(in) :: options     !< the command line
    integer, intent(in) :: n_files                     !< how many files were joined
    type(merged_search_type), intent(in) :: merged     !< the starts that the files have

    write (error_unit, '(a)') counted(merged%made, 'start')//' of '//to_text(merged%starts)//' from '//counted(n_files, 'file')
    if (merged%repeated > 0) write (error_unit, '(a)') 'note: '//counted(merged%repeated, 'start')// &
      ' stood in more than one file, with the same designs'
    if (merged%made < merged%starts) &
      write (error_unit, '(a)') 'note: '//counted(merged%starts - merged%made, 'start')//' are not made yet'
    write (error_unit, '(a)') 'note: --optimize --continue '//options%argument('hdf5')//' finds the distinct designs'
    write (error_unit, '(2a)') 'HDF5 file: ', options%argument('hdf5')
  end subroutine print_search
end module mech9_part_merge
