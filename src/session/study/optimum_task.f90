!> The search for the best design: from many starts to the distinct designs, their files and their report.
module mech9_optimum_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, to_text
  use mech9_clock, only: seconds
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_kept_files, only: kept_files_type
  use mech9_kept_study, only: processes_type, threads_for
  use mech9_kept_search, only: kept_search_type
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_written_files, only: find_kept_files, standard_output_path
  use mech9_text_file, only: replace_text
  use mech9_optimum_pictures, only: optimum_pictures_type
  use mech9_optimum_words, only: print_differences, print_optimum
  implicit none
  private
  public :: work_on_optimum

contains

  !> Carry out the search that a data file describes.
  subroutine work_on_optimum(options, given, reported, processes)
    type(command_line_type), intent(in) :: options                  !< the command line
    type(data_file_type), intent(inout), target :: given            !< the data file; it gets the errors
    logical, intent(out) :: reported                                !< a report was asked for, and it is written
    type(processes_type), intent(inout) :: processes                !< those that make the starts together
    class(kept_search_type), allocatable, target :: found
    type(kept_files_type) :: wanted
    type(optimum_pictures_type) :: pictures
    type(signal_interruption_type) :: interruption
    type(error_type), allocatable :: err
    real(wp) :: clock

    reported = .false.
    allocate (found)
    clock = seconds()
    call found%check(given, err)
    if (.not. allocated(err)) call refuse_changed_design(options, err)
    if (.not. allocated(err)) call refuse_empty_part(options, given, err)
    if (.not. allocated(err) .and. processes%is_first) call pictures%open(options, given, err)
    if (.not. allocated(err)) then
      call interruption%words%start(given%model%program, 'no result of a run of the search', 'it', options%has('quiet'), &
                                    with_progress=.false.)
      call found%prepare(given, interruption, err)
    end if
    call processes%agree(err)
    if (.not. allocated(err)) then
      call find_kept_files(options, given, wanted)
      if (processes%is_first) call found%open(wanted, given, err)
      call processes%agree(err)
    end if
    if (.not. processes%is_first) then
      reported = .true.
      if (.not. allocated(err)) call found%follow(given)
      return
    end if
    if (allocated(err)) then
      call given%fail(err)
      return
    end if
    if (.not. options%has('quiet')) call print_differences(error_unit, found%search)
    call found%make(given, processes, threads_of(options, given), err)
    if (.not. options%has('quiet')) call print_optimum(error_unit, given%model, found%search%synthesis, seconds() - clock)
    call given%fail(err)
    call write_results(options, given, found)
    call pictures%draw(options, given, found)
    if (.not. options%has('report')) return
    call found%save_report(options%argument('report'), given, err)
    reported = .true.
    call given%fail(err)
  end subroutine work_on_optimum

  !> Write the table and the HDF5 data of the distinct designs, and the data file of the best one.
  subroutine write_results(options, given, found)
    type(command_line_type), intent(in) :: options          !< the command line
    type(data_file_type), intent(inout) :: given            !< the data file; it gets the errors
    type(kept_search_type), intent(inout) :: found          !< made; its files are closed on return
    character(len=:), allocatable :: text
    type(error_type), allocatable :: err
    logical :: has_hdf5

    call found%write_table(given, err)
    call tell(err, 'table', found%wanted%table)
    has_hdf5 = found%has_hdf5()
    call found%write_hdf5(given, err)
    if (has_hdf5) call tell(err, 'HDF5 file', found%wanted%hdf5)
    if (.not. options%has('out') .or. size(found%search%synthesis%optima) == 0) return
    call found%take_best(given, text)
    call replace_text(options%argument('out'), text, err)
    call tell(err, 'best design', options%argument('out'))
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

  !> How many threads make the starts.
  integer function threads_of(options, given) result(threads)
    type(command_line_type), intent(in) :: options        !< the command line
    type(data_file_type), intent(in) :: given             !< the data file

    threads = options%number('threads', threads_for(given%model))
  end function threads_of

  !> Refuse a part that has no starts.
  subroutine refuse_empty_part(options, given, err)
    type(command_line_type), intent(in) :: options        !< the command line
    type(data_file_type), intent(in) :: given             !< the data file
    type(error_type), allocatable, intent(out) :: err     !< allocated if it has none
    integer :: part(2)

    part = options%part()
    if (part(1) > given%model%request%optimum%starts) &
      call raise(err, exit_usage, '--part '//options%argument('part')//' has no starts: the search has '// &
                 to_text(given%model%request%optimum%starts)//'; give fewer parts, or more starts in &optimum')
  end subroutine refuse_empty_part

  !> Refuse to write a data file that would not have the changes by --set.
  subroutine refuse_changed_design(options, err)
    type(command_line_type), intent(in) :: options        !< the command line
    type(error_type), allocatable, intent(out) :: err     !< allocated if --out would

    if (options%has('out') .and. changes_design(options)) &
      call raise(err, exit_usage, '--out writes the data file with the best values, and would not have the changes by --set; '// &
                 'write them into the data file, or leave --out out')
  end subroutine refuse_changed_design

  !> Whether --set changes anything but the search itself.
  logical function changes_design(options)
    type(command_line_type), intent(in) :: options        !< the command line
    type(string_type), allocatable :: settings(:)
    integer :: i

    call options%arguments('set', settings)
    changes_design = .false.
    do i = 1, size(settings)
      if (index(adjustl(settings(i)%text), 'optimum') /= 1) changes_design = .true.
    end do
  end function changes_design
end module mech9_optimum_task
