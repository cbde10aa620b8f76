!> The files of a synthesis: a table of the distinct designs, an HDF5 file of starts and designs, and the best design's
!> data file.
module mech9_optimum_results
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_version, only: name_and_version
  use mech9_command_line, only: command_line_type
  use mech9_text, only: string_type
  use mech9_data_file, only: data_file_type
  use mech9_table, only: table_type
  use mech9_heading, only: new_heading
  use mech9_text_file, only: replace_text
  use mech9_written_files, only: result_paths_type, find_result_paths, standard_output_path
  use mech9_hdf5_reading, only: read_text
  use mech9_hdf5_record, only: write_provenance
  use mech9_study_definition, only: define_study
  use mech9_synthesis, only: synthesis_type
  use mech9_starts, only: starts_type
  use mech9_starts_file, only: starts_layout_type, find_layout, read_starts
  use mech9_optimum_layout, only: write_optima
  use mech9_best_design, only: text_of_best
  implicit none
  private
  public :: open_results, write_results, table_of

contains

  !> Open the files of a search, before it begins.
  subroutine open_results(options, given, synthesis, starts, table, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    type(synthesis_type), intent(in) :: synthesis           !< prepared
    type(starts_type), intent(inout) :: starts              !< gets room, and the open file
    type(table_type), intent(inout) :: table                !< is open, if one is requested
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: at_close

    call open_starts(options, given, synthesis, starts, err)
    if (allocated(err) .or. table_of(options, given) == '') return
    call open_table(table_of(options, given), given, table, err)
    if (allocated(err)) call starts%file%close(at_close)
  end subroutine open_results

  !> Make room for all starts, read those that were made before, and open the HDF5 file, where one is requested. A file
  !> that is continued is written anew, with all places and with the starts that it has. Until that is done it stays as
  !> it is.
  subroutine open_starts(options, given, synthesis, starts, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    type(synthesis_type), intent(in) :: synthesis           !< prepared
    type(starts_type), intent(inout) :: starts              !< gets room, and the open file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(result_paths_type) :: paths
    type(error_type), allocatable :: at_close
    type(starts_layout_type) :: layout
    character(len=:), allocatable :: definition

    allocate (starts%made(given%model%request%optimum%starts))
    starts%part = options%part()
    call find_result_paths(options, paths, given)
    if (paths%hdf5 == '') return
    call define_study(given, definition, err)
    if (allocated(err)) return
    call find_layout(given, synthesis, definition, layout)
    if (options%has('continue')) call read_starts(paths%hdf5, layout, starts%made, err)
    if (.not. allocated(err)) call starts%file%create(paths%hdf5, given, layout, .false., err)
    if (allocated(err)) return
    call write_provenance(starts%file%file, options, given)
    call write_made(starts)
    call starts%file%publish(err)
    if (.not. allocated(err)) return
    call starts%file%close(at_close)
  end subroutine open_starts

  !> Write all starts that are made.
  subroutine write_made(starts)
    type(starts_type), intent(inout) :: starts   !< with the open file
    integer :: i

    do i = 1, size(starts%made)
      if (allocated(starts%made(i)%found)) call starts%file%write_start(i, starts%made(i)%found)
    end do
  end subroutine write_made

  !> Write the file anew, with the designs, and close it. Where that fails, as on a full disk, the file stays as it is,
  !> with all starts. The search can then be continued.
  subroutine write_whole_file(options, given, synthesis, starts, err)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(in) :: given               !< the data file
    type(synthesis_type), intent(in) :: synthesis           !< with its optima, best first
    type(starts_type), intent(inout) :: starts              !< with the open file, which is closed
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: at_close
    type(starts_layout_type) :: layout
    character(len=:), allocatable :: path, created

    path = starts%file%file%path
    layout = starts%file%layout
    call read_text(starts%file%file, 'provenance/created', created)
    call starts%file%close(err)
    if (.not. allocated(err)) call starts%file%create(path, given, layout, .true., err)
    if (allocated(err)) return
    call write_provenance(starts%file%file, options, given, created)
    call write_made(starts)
    call write_optima(starts%file%file, given%model, synthesis)
    call starts%file%publish(err)
    call starts%file%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine write_whole_file

  !> The path of the table; '-' is standard output; empty: no table.
  function table_of(options, given) result(path)
    type(command_line_type), intent(in) :: options   !< the command line
    type(data_file_type), intent(in) :: given        !< the data file
    character(len=:), allocatable :: path
    type(result_paths_type) :: paths

    call find_result_paths(options, paths, given)
    path = paths%table
  end function table_of

  !> Write the table and the HDF5 data of the distinct designs, and the data file of the best one.
  subroutine write_results(options, given, synthesis, starts, table)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout) :: given            !< the data file; it gets the errors
    type(synthesis_type), intent(in) :: synthesis           !< with its optima, best first
    type(starts_type), intent(inout) :: starts              !< with the open file, which is closed
    type(table_type), intent(inout) :: table                !< the open table, which is closed
    character(len=:), allocatable :: path, text
    type(error_type), allocatable :: err

    path = table_of(options, given)
    if (path /= '') call write_table(table, given, synthesis, err)
    call tell(err, 'table', path)
    path = ''
    if (starts%file%is_open()) path = starts%file%file%path
    if (path /= '') call write_whole_file(options, given, synthesis, starts, err)
    call tell(err, 'HDF5 file', path)
    if (.not. options%has('out') .or. size(synthesis%optima) == 0) return
    call text_of_best(given%document, given%model, synthesis, text)
    path = options%argument('out')
    call replace_text(path, text, err)
    call tell(err, 'best design', path)
  contains
    !> Tell where a result is, or add the error.
    subroutine tell(failure, name, place)
      type(error_type), allocatable, intent(inout) :: failure   !< allocated if it could not be written; not on return
      character(len=*), intent(in) :: name                      !< of the result
      character(len=*), intent(in) :: place                     !< its path; empty where there is none

      if (allocated(failure)) then
        call given%fail(failure)
        deallocate (failure)
      else if (place /= '' .and. place /= standard_output_path .and. .not. options%has('quiet')) then
        write (error_unit, '(3a)') name, ': ', place
      end if
    end subroutine tell
  end subroutine write_results

  !> Open the table of the distinct designs.
  subroutine open_table(path, given, table, err)
    character(len=*), intent(in) :: path                    !< of the table; '-' is standard output
    type(data_file_type), intent(in) :: given               !< the data file
    type(table_type), intent(inout) :: table                !< the table
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(string_type), allocatable :: parameters(:), their_units(:)
    type(string_type), allocatable :: names(:), units(:)
    integer :: i, n

    call given%list_parameters(parameters, their_units)
    n = size(parameters)
    allocate (names(n + 2), units(n + 2))
    names(1)%text = 'value'
    units(1)%text = ''
    do i = 1, n
      names(1 + i)%text = parameters(i)%text
      units(1 + i)%text = their_units(i)%text
    end do
    names(n + 2)%text = 'starts'
    units(n + 2)%text = ''
    call table%open(path, new_heading(given%model%mechanism%title, names, units), name_and_version(given%model%program), err)
  end subroutine open_table

  !> Write a row for each distinct design, best first, and close the table.
  subroutine write_table(table, given, synthesis, err)
    type(table_type), intent(inout) :: table                !< the open table
    type(data_file_type), intent(in) :: given               !< the data file
    type(synthesis_type), intent(in) :: synthesis           !< with its optima, best first
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: at_close
    real(wp) :: row(size(given%model%parameters) + 2)
    integer :: i, n

    n = size(given%model%parameters)
    do i = 1, size(synthesis%optima)
      row(1) = synthesis%optima(i)%value
      row(2:n + 1) = synthesis%values_of(i)
      row(n + 2) = synthesis%optima(i)%starts
      call table%write_row(row, err)
      if (allocated(err)) exit
    end do
    call table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine write_table
end module mech9_optimum_results
