!> The search for the best design: from many starts to the distinct designs, their files and their report.
module mech9_optimum_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, to_text
  use mech9_clock, only: seconds
  use mech9_command_line, only: command_line_type
  use mech9_data_file, only: data_file_type
  use mech9_study_threads, only: threads_for
  use mech9_processes, only: processes_type
  use mech9_search, only: optimum_search_type, check_request
  use mech9_signal_interruption, only: signal_interruption_type
  use mech9_table, only: table_type
  use mech9_starts, only: starts_type
  use mech9_optimum_results, only: open_results, write_results, table_of
  use mech9_optimum_pictures, only: optimum_pictures_type
  use mech9_optimum_words, only: print_differences, print_optimum
  use mech9_json, only: json_type
  use mech9_report_parts, only: begin_report
  use mech9_optimum_report, only: add_optimum
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
    type(optimum_search_type), allocatable, target :: search
    type(starts_type) :: starts
    type(table_type) :: table
    type(optimum_pictures_type) :: pictures
    type(json_type) :: json
    type(signal_interruption_type) :: interruption
    type(error_type), allocatable :: err
    real(wp) :: clock

    reported = .false.
    allocate (search)
    clock = seconds()
    call check_request(given%model, err)
    if (.not. allocated(err)) call refuse_changed_design(options, err)
    if (.not. allocated(err)) call refuse_empty_part(options, given, err)
    if (.not. allocated(err) .and. processes%is_first) call pictures%open(options, given, err)
    if (.not. allocated(err)) then
      call interruption%words%start(given%model%program, 'no result of a run of the search', 'it', options%has('quiet'), &
                                    with_progress=.false.)
      call search%prepare(given%variable, given%model, interruption, err)
    end if
    call processes%agree(err)
    if (.not. allocated(err)) then
      if (processes%is_first) call open_results(options, given, search%synthesis, starts, table, err)
      call processes%agree(err)
    end if
    if (.not. processes%is_first) then
      reported = .true.
      if (.not. allocated(err)) call search%follow(given%model)
      return
    end if
    if (allocated(err)) then
      call given%fail(err)
      return
    end if
    if (.not. options%has('quiet')) call print_differences(error_unit, search)
    call starts%begin_shown(given%model%program, options%has('quiet'))
    call search%make(given%model, processes, threads_of(options, given), starts, err)
    if (.not. options%has('quiet')) call print_optimum(error_unit, given%model, search%synthesis, seconds() - clock)
    call given%fail(err)
    call write_results(options, given, search%synthesis, starts, table)
    call pictures%draw(options, given, search%synthesis)
    if (.not. options%has('report')) return
    call begin_report(json, given%model, given%diagnostics, table_of(options, given))
    call add_optimum(json, given%model, search%synthesis)
    call json%end_object()
    call json%save(options%argument('report'), err)
    reported = .true.
    call given%fail(err)
  end subroutine work_on_optimum

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
