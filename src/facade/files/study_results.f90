!> The files of a study: a table with a row for each run, and an HDF5 file with a place for each.
module mech9_study_results
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_file
  use mech9_text, only: string_type, to_text
  use mech9_program_kind, only: program_names
  use mech9_version, only: name_and_version
  use mech9_data_file, only: data_file_type
  use mech9_table, only: table_type
  use mech9_progress, only: progress_type
  use mech9_heading, only: new_heading
  use mech9_kept_files, only: kept_files_type
  use mech9_run_maker, only: made_run_type
  use mech9_study_sink, only: study_sink_type
  use mech9_study_sums, only: study_sums_type
  use mech9_study_definition, only: define_study
  use mech9_study_file, only: study_file_type, not_made
  use mech9_study_layout, only: study_layout_type, layout_of
  use mech9_hdf5_record, only: write_provenance
  use mech9_study_section, only: begin_section, add_points
  use mech9_section_layout, only: write_section
  implicit none
  private
  public :: study_results_type

  type, extends(study_sink_type) :: study_results_type
    type(kept_files_type) :: wanted                 !< the files that are asked for
    type(table_type), private :: table
    type(study_file_type), private :: file          !< of HDF5
    type(progress_type), private :: progress        !< shown on a terminal
    real(wp), allocatable, private :: row(:)        !< of the table
  contains
    procedure :: open => open_results
    procedure :: is_made
    procedure :: read_run
    procedure :: write_run
    procedure :: show_run
    procedure :: tell_progress
    procedure :: close => close_results
  end type study_results_type

contains

  !> Open the files that are asked for. After an error none is open, and none has changed where the other one cannot be opened.
  subroutine open_results(self, wanted, given, err)
    class(study_results_type), intent(out) :: self            !< the files
    type(kept_files_type), intent(in) :: wanted               !< the files that are asked for
    type(data_file_type), intent(in) :: given                 !< the data file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(string_type), allocatable :: names(:), units(:)
    type(error_type), allocatable :: at_close
    type(study_layout_type) :: layout
    character(len=:), allocatable :: definition

    self%wanted = wanted
    self%part = wanted%part
    call begin_section(given%model, self%section, err)
    if (allocated(err)) return
    if (self%wanted%hdf5 /= '') then
      call define_study(given, definition, err)
      if (allocated(err)) return
      if (wanted%continues) then
        call continue_file(self, definition, err)
      else
        call layout_of(given, definition, self%part, layout)
        call self%file%create(self%wanted%hdf5, layout, err)
        if (.not. allocated(err)) call write_provenance(self%file%file, given)
      end if
      if (.not. allocated(err) .and. given%model%request%output%hdf5_runs) call begin_columns(self, given, err)
      if (allocated(err)) then
        call self%close(at_close)
        return
      end if
    end if
    call list_columns(given, names, units)
    allocate (self%row(size(names)), source=0.0_wp)
    if (self%wanted%table /= '') &
      call self%table%open(self%wanted%table, new_heading(given%model%mechanism%title, names, units), &
                           name_and_version(given%model%program), err)
    if (.not. allocated(err) .and. self%wanted%hdf5 /= '' .and. .not. wanted%continues) call self%file%publish(err)
    if (allocated(err)) then
      call self%close(at_close)
    else
      call self%progress%start(program_names(given%model%program), wanted%quiet)
    end if
  end subroutine open_results

  !> Begin the columns of all runs in the HDF5 file, which is new or continued.
  subroutine begin_columns(self, given, err)
    class(study_results_type), intent(inout) :: self          !< the files
    type(data_file_type), intent(in) :: given                 !< the data file
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed

    if (self%wanted%continues) then
      call self%file%open_columns(given, err)
    else
      call self%file%create_columns(given, err)
    end if
  end subroutine begin_columns

  !> Open the file to be continued, for the part of the study that is noted in it.
  subroutine continue_file(self, definition, err)
    class(study_results_type), intent(inout) :: self          !< the files
    character(len=*), intent(in) :: definition                !< text that determines the numbers of the study
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(error_type), allocatable :: at_close

    call self%file%open(self%wanted%hdf5, .true., definition, err)
    if (allocated(err)) return
    self%part = self%file%layout%part
    if (self%wanted%part_words == '' .or. all(self%wanted%part == self%part)) return
    call raise(err, exit_file, "'"//self%wanted%hdf5//"' is of part "//to_text(self%part(1))//'/'//to_text(self%part(2))// &
               ', and --part '//self%wanted%part_words//' is another one; leave out --part to continue the part of the file')
    call self%file%close(at_close)
  end subroutine continue_file

  !> Names and units of the columns of the table of a study.
  pure subroutine list_columns(given, names, units)
    type(data_file_type), intent(in) :: given                  !< the data file
    type(string_type), allocatable, intent(out) :: names(:)    !< (columns)
    type(string_type), allocatable, intent(out) :: units(:)    !< (columns)
    type(string_type), allocatable :: parameters(:), their_units(:)
    integer :: i, n

    call given%list_parameters(parameters, their_units)
    n = size(parameters)
    allocate (names(n + size(given%model%request%quantities) + 2))
    allocate (units(size(names)))
    names(1)%text = 'run'
    units(1)%text = ''
    do i = 1, n
      names(1 + i)%text = parameters(i)%text
      units(1 + i)%text = their_units(i)%text
    end do
    do i = 1, size(given%model%request%quantities)
      names(1 + n + i)%text = given%model%request%quantities(i)%name
      units(1 + n + i)%text = given%quantities%unit_of(i)
    end do
    names(size(names))%text = 'exit_code'
    units(size(names))%text = ''
  end subroutine list_columns

  !> Whether a run was made before, and is in the file that is continued.
  logical function is_made(self, place)
    class(study_results_type), intent(inout) :: self       !< the files
    integer, intent(in) :: place                           !< of the run in the part, from 1

    is_made = .false.
    if (self%file%is_open()) is_made = self%file%code_of(place) /= not_made
  end function is_made

  !> Read a run that was made before.
  subroutine read_run(self, place, run)
    class(study_results_type), intent(inout) :: self       !< the files
    integer, intent(in) :: place                           !< of the run in the part, from 1
    type(made_run_type), intent(inout) :: run              !< gets its numbers; its arrays are allocated

    call self%file%read_run(place, run)
  end subroutine read_run

  !> Keep a run that is made now, in the HDF5 file.
  subroutine write_run(self, place, run, err)
    class(study_results_type), intent(inout) :: self       !< the files
    integer, intent(in) :: place                           !< of the run in the part, from 1
    type(made_run_type), intent(in) :: run                 !< the run
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    if (self%file%is_open()) call self%file%write_run(place, run, err)
  end subroutine write_run

  !> Write the row of a run in the table. Runs come in the order of their numbers.
  subroutine show_run(self, run, err)
    class(study_results_type), intent(inout) :: self       !< the files
    type(made_run_type), intent(in) :: run                 !< the run
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    integer :: n

    if (allocated(self%section)) call add_points(self%section, run)
    ! the class is known only now
    if (allocated(run%cycle) .and. self%file%is_open()) call self%file%write_outcome(run%number, run, err)
    if (allocated(err)) return
    if (self%wanted%table == '') return
    n = 1 + size(run%values)
    self%row(1) = run%number
    self%row(2:n) = run%values
    self%row(n + 1:n + size(run%quantities)) = run%quantities
    self%row(size(self%row)) = run%exit_code
    call self%table%write_row(self%row, err)
  end subroutine show_run

  !> Show how far the study is, and how many of its runs failed.
  subroutine tell_progress(self, done, read, sums)
    class(study_results_type), intent(inout) :: self       !< the files
    real(wp), intent(in) :: done                           !< share of the runs that are shown, up to 1
    real(wp), intent(in) :: read                           !< share of the runs that were made before
    type(study_sums_type), intent(in) :: sums              !< over the runs that are shown
    character(len=:), allocatable :: failed

    call count_failed(sums, failed)
    call self%progress%update(done, failed, read)
  end subroutine tell_progress

  !> Tell how many runs failed so far, by their codes.
  pure subroutine count_failed(sums, words)
    type(study_sums_type), intent(in) :: sums                  !< over the runs
    character(len=:), allocatable, intent(out) :: words        !< empty where none failed
    integer :: i

    words = ''
    do i = 1, sums%n_codes
      if (i == 1) words = 'failed '
      if (i > 1) words = words//', '
      words = words//to_text(sums%failed(i))//' (code '//to_text(sums%codes(i))//')'
    end do
  end subroutine count_failed

  !> Close the files.
  subroutine close_results(self, err)
    class(study_results_type), intent(inout) :: self     !< the files
    type(error_type), allocatable, intent(out) :: err    !< allocated if rows could not be written
    type(error_type), allocatable :: of_table

    call self%progress%finish()
    if (allocated(self%section) .and. self%file%is_open()) call write_section(self%section, self%file%file)
    call self%file%close(err)
    call self%table%close(of_table)
    if (.not. allocated(err)) call move_alloc(of_table, err)
  end subroutine close_results
end module mech9_study_results
