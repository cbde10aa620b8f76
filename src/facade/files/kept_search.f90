!> A search for the best design as a program carries it out: its starts, kept in an HDF5 file as they are made, the distinct
!> designs as a table, and the data file, the motion and the report of the best one.
module mech9_kept_search
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_version, only: name_and_version
  use mech9_text, only: string_type
  use mech9_simulation, only: interruption_type
  use mech9_processes, only: processes_type
  use mech9_search, only: optimum_search_type, check_request
  use mech9_best_design, only: text_of_best
  use mech9_design_motion, only: design_motion_type, new_design_motion
  use mech9_table, only: table_type
  use mech9_heading, only: new_heading
  use mech9_json, only: json_type
  use mech9_hdf5_reading, only: read_text
  use mech9_optimum_layout, only: write_optima
  use mech9_report_parts, only: begin_report
  use mech9_optimum_report, only: add_optimum
  use mech9_data_file, only: data_file_type
  use mech9_study_definition, only: define_study
  use mech9_kept_files, only: kept_files_type
  use mech9_hdf5_record, only: write_provenance
  use mech9_starts, only: starts_type
  use mech9_starts_file, only: starts_layout_type, find_layout, read_starts
  implicit none
  private
  public :: kept_search_type

  type :: kept_search_type
    type(kept_files_type) :: wanted                          !< the files that are asked for
    type(optimum_search_type), allocatable :: search         !< with the distinct designs, once it is made
    class(design_motion_type), allocatable :: best           !< of the best design, once it is moved
    type(starts_type), private :: starts
    type(table_type), private :: table
  contains
    procedure, nopass :: check
    procedure :: prepare
    procedure :: open => open_files
    procedure :: make
    procedure :: follow
    procedure :: write_table
    procedure :: write_hdf5
    procedure :: has_hdf5
    procedure :: take_best
    procedure :: move_best
    procedure :: save_report
  end type kept_search_type

contains

  !> Fail where the data file describes no search.
  subroutine check(given, err)
    type(data_file_type), intent(in) :: given               !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if no search can be made

    call check_request(given%model, err)
  end subroutine check

  !> Prepare the search: its first position, its targets and its limits. Fails where none can be made.
  subroutine prepare(self, given, interruption, err)
    class(kept_search_type), intent(inout), target :: self     !< a new one
    type(data_file_type), intent(inout), target :: given       !< the data file, with its variable model
    class(interruption_type), intent(in) :: interruption       !< is asked whether a run for quantities shall stop
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed

    allocate (self%search)
    call self%search%prepare(given%variable, given%model, interruption, err)
  end subroutine prepare

  !> Open the files, before the search begins.
  subroutine open_files(self, wanted, given, err)
    class(kept_search_type), intent(inout) :: self          !< prepared
    type(kept_files_type), intent(in) :: wanted             !< the files that are asked for
    type(data_file_type), intent(in) :: given               !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: at_close

    self%wanted = wanted
    call open_starts(self, given, err)
    if (allocated(err) .or. wanted%table == '') return
    call open_table(wanted%table, given, self%table, err)
    if (allocated(err)) call self%starts%file%close(at_close)
  end subroutine open_files

  !> Make room for all starts, read those that were made before, and open the HDF5 file, where one is requested. A file
  !> that is continued is written anew, with all places and with the starts that it has. Until that is done it stays as
  !> it is.
  subroutine open_starts(self, given, err)
    class(kept_search_type), intent(inout) :: self          !< prepared; its starts get room, and the open file
    type(data_file_type), intent(in) :: given               !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: at_close
    type(starts_layout_type) :: layout
    character(len=:), allocatable :: definition

    associate (starts => self%starts, wanted => self%wanted)
      allocate (starts%made(given%model%request%optimum%starts))
      starts%part = wanted%part
      if (wanted%hdf5 == '') return
      call define_study(given, definition, err)
      if (allocated(err)) return
      call find_layout(given, self%search%synthesis, definition, layout)
      if (wanted%continues) call read_starts(wanted%hdf5, layout, starts%made, err)
      if (.not. allocated(err)) call starts%file%create(wanted%hdf5, given, layout, .false., err)
      if (allocated(err)) return
      call write_provenance(starts%file%file, given)
      call write_made(starts)
      call starts%file%publish(err)
      if (.not. allocated(err)) return
      call starts%file%close(at_close)
    end associate
  end subroutine open_starts

  !> Write all starts that are made.
  subroutine write_made(starts)
    type(starts_type), intent(inout) :: starts   !< with the open file
    integer :: i

    do i = 1, size(starts%made)
      if (allocated(starts%made(i)%found)) call starts%file%write_start(i, starts%made(i)%found)
    end do
  end subroutine write_made

  !> Make the starts that are missing, and find the distinct designs. Fails where no start leads to a design, and where the
  !> search is stopped.
  subroutine make(self, given, processes, threads, err)
    class(kept_search_type), intent(inout), target :: self   !< with its open files
    type(data_file_type), intent(in) :: given                !< the data file
    type(processes_type), intent(in) :: processes            !< those that make the starts together; this one is the first of them
    integer, intent(in) :: threads                           !< how many make the starts where there is one process
    type(error_type), allocatable, intent(out) :: err        !< allocated if it failed

    call self%starts%begin_shown(given%model%program, self%wanted%quiet)
    call self%search%make(given%model, processes, threads, self%starts, err)
  end subroutine make

  !> Make starts that the first of several processes hands out.
  subroutine follow(self, given)
    class(kept_search_type), intent(in), target :: self      !< prepared
    type(data_file_type), intent(in) :: given                !< the data file

    call self%search%follow(given%model)
  end subroutine follow

  !> Whether the search has an HDF5 file that is open.
  pure logical function has_hdf5(self)
    class(kept_search_type), intent(in) :: self              !< the search

    has_hdf5 = self%starts%file%is_open()
  end function has_hdf5

  !> Write the HDF5 file anew, with the designs, and close it. Where that fails, as on a full disk, the file stays as it is,
  !> with all starts. The search can then be continued.
  subroutine write_hdf5(self, given, err)
    class(kept_search_type), intent(inout) :: self          !< made; its HDF5 file is open, and closed on return
    type(data_file_type), intent(in) :: given               !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: at_close
    type(starts_layout_type) :: layout
    character(len=:), allocatable :: path, created

    if (.not. self%has_hdf5()) return
    associate (file => self%starts%file)
      path = file%file%path
      layout = file%layout
      call read_text(file%file, 'provenance/created', created)
      call file%close(err)
      if (.not. allocated(err)) call file%create(path, given, layout, .true., err)
      if (allocated(err)) return
      call write_provenance(file%file, given, created)
      call write_made(self%starts)
      call write_optima(file%file, given%model, self%search%synthesis)
      call file%publish(err)
      call file%close(at_close)
      if (.not. allocated(err)) call move_alloc(at_close, err)
    end associate
  end subroutine write_hdf5

  !> The data file of the best design.
  subroutine take_best(self, given, text)
    class(kept_search_type), intent(in) :: self             !< made, with a design
    type(data_file_type), intent(in) :: given               !< the data file
    character(len=:), allocatable, intent(out) :: text      !< of the data file

    call text_of_best(given%document, given%model, self%search%synthesis, text)
  end subroutine take_best

  !> Assemble the best design, so that it can be moved.
  subroutine move_best(self, given, err)
    class(kept_search_type), intent(inout), target :: self     !< made, with a design
    type(data_file_type), intent(inout), target :: given       !< the data file, with its variable model
    type(error_type), allocatable, intent(out) :: err          !< allocated if it failed

    allocate (self%best)
    associate (synthesis => self%search%synthesis)
      call new_design_motion(given%variable, synthesis%space%model, synthesis%values_of(1), synthesis%optima(1)%q, self%best, err)
    end associate
  end subroutine move_best

  !> Save the report.
  subroutine save_report(self, path, given, err)
    class(kept_search_type), intent(in) :: self             !< made
    character(len=*), intent(in) :: path                    !< of the report
    type(data_file_type), intent(in) :: given               !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it cannot be written
    type(json_type) :: json

    call begin_report(json, given%model, given%diagnostics, self%wanted%table)
    call add_optimum(json, given%model, self%search%synthesis)
    call json%end_object()
    call json%save(path, err)
  end subroutine save_report

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
  subroutine write_table(self, given, err)
    class(kept_search_type), intent(inout) :: self          !< made, with the open table
    type(data_file_type), intent(in) :: given               !< the data file
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(error_type), allocatable :: at_close
    real(wp) :: row(size(given%model%parameters) + 2)
    integer :: i, n

    if (self%wanted%table == '') return
    n = size(given%model%parameters)
    associate (synthesis => self%search%synthesis)
      do i = 1, size(synthesis%optima)
        row(1) = synthesis%optima(i)%value
        row(2:n + 1) = synthesis%values_of(i)
        row(n + 2) = synthesis%optima(i)%starts
        call self%table%write_row(row, err)
        if (allocated(err)) exit
      end do
    end associate
    call self%table%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine write_table
end module mech9_kept_search
