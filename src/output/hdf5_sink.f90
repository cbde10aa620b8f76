!> Results as an HDF5 file; docs/reference/results.md describes its content.
module mech9_hdf5_sink
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_clock, only: pacer_type
  use mech9_request, only: request_type
  use mech9_mechanism, only: mechanism_type
  use mech9_columns, only: columns_type
  use mech9_result_sink, only: result_sink_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_series, only: hdf5_series_type
  use mech9_column_sets, only: column_set_list_type
  use mech9_row_layout, only: list_row_sets, put_row_scales, list_change_sets, put_change_scales, most_changes
  implicit none
  private
  public :: hdf5_sink_type

  !> Longest time after which readers of the file see new rows [s].
  real(wp), parameter :: longest_wait = 1.0_wp

  type, extends(result_sink_type) :: hdf5_sink_type
    type(hdf5_file_type) :: file
    type(hdf5_series_type), private :: series
    type(hdf5_series_type), private :: changes
    logical, private :: begun = .false.  !< whether rows were written
    type(pacer_type), private :: pacer
    logical, private :: reported = .false.  !< whether the failure of the file was reported
  contains
    procedure :: open => open_sink
    procedure :: write_rows
    procedure :: flush => flush_sink
    procedure :: close => close_sink
    procedure :: words
    procedure :: begin_changes
    procedure :: write_changes
    procedure :: tell
  end type hdf5_sink_type

contains

  !> Create the file with all its quantities, without rows.
  subroutine open_sink(self, path, mechanism, request, columns, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    character(len=*), intent(in) :: path               !< path of the file
    type(mechanism_type), intent(in) :: mechanism      !< the mechanism
    type(request_type), intent(in) :: request          !< the times of the rows, and the compression
    type(columns_type), intent(in) :: columns          !< columns of the rows to come
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed
    type(column_set_list_type) :: list

    call self%file%create(path, err)
    if (allocated(err)) return
    self%takes_poses = .true.
    call list_row_sets(mechanism, columns, list)
    call self%series%start(list%count, columns%width(), request%time%intervals + 1, request%output%compression)
    call self%series%add_all(list)
    call self%series%create(self%file)
    call put_row_scales(self%file, mechanism, columns, list)
    call self%pacer%start(longest_wait)
    call self%tell(err)
  end subroutine open_sink

  !> Make data sets for the changes of coordinates of a run: the times at which other coordinates became independent, and their numbers.
  subroutine begin_changes(self, n_independent)
    class(hdf5_sink_type), intent(inout) :: self  !< the HDF5 sink
    integer, intent(in) :: n_independent          !< how many coordinates are independent
    type(column_set_list_type) :: list

    call list_change_sets(n_independent, list)
    call self%changes%start(list%count, 1 + 2*n_independent, most_changes, 0)
    call self%changes%add_all(list)
    call self%changes%create(self%file)
    call put_change_scales(self%file, n_independent, list)
  end subroutine begin_changes

  !> Write the changes of coordinates of the run.
  subroutine write_changes(self, rows)
    class(hdf5_sink_type), intent(inout) :: self     !< the HDF5 sink
    real(wp), intent(in), contiguous :: rows(:, :)   !< (columns, changes) as take_changes gives them

    call self%changes%append_rows(self%file, rows)
  end subroutine write_changes

  !> Append rows. They are flushed about once a second, and the first ones at once, because the first flush
  !> determines where the later data stand in the file.
  subroutine write_rows(self, rows, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    real(wp), intent(in), contiguous :: rows(:, :)     !< (columns, rows) numbers of the rows
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    call self%series%append_rows(self%file, rows)
    if (self%pacer%due() .or. .not. self%begun) then
      self%begun = .true.
      call self%series%hand_over(self%file)
      call self%file%flush()
    end if
    call self%tell(err)
  end subroutine write_rows

  !> Write all rows to the file.
  subroutine flush_sink(self, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    call self%series%hand_over(self%file, at_end=.true.)
    call self%file%flush()
    call self%tell(err)
  end subroutine flush_sink

  !> Write all rows and close the file.
  subroutine close_sink(self, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    if (.not. self%file%is_open()) return
    call self%series%close(self%file)
    call self%changes%close(self%file)
    call self%file%close()
    call self%tell(err)
  end subroutine close_sink

  !> The path of the file in words.
  function words(self)
    class(hdf5_sink_type), intent(in) :: self  !< the HDF5 sink
    character(len=:), allocatable :: words

    words = 'HDF5 file: '//self%file%path
  end function words

  !> Return the first failure of the file, only once.
  subroutine tell(self, err)
    class(hdf5_sink_type), intent(inout) :: self       !< the HDF5 sink
    type(error_type), allocatable, intent(out) :: err  !< allocated if it failed

    if (self%reported .or. .not. allocated(self%file%failure)) return
    self%reported = .true.
    err = self%file%failure
  end subroutine tell
end module mech9_hdf5_sink
