!> All columns of the runs of a study in its HDF5 file, over the runs and time. They have the names of the columns of a
!> single run.
!>
!> A row of the data sets is a run with the columns of all its times, one time after the other. Rows are written one by one, so that
!> a run is in the file before its exit code is.
module mech9_study_columns
  use mech9_kinds, only: wp
  use mech9_text, only: string_type
  use mech9_error, only: error_type, raise, exit_data
  use mech9_data_file, only: data_file_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_column_sets, only: column_set_list_type, new_column_set, scale_length
  use mech9_hdf5_series, only: hdf5_series_type
  use mech9_column_layout, only: column_layout_type
  use mech9_scale_layout, only: put_scales, names_of_scales
  use mech9_hdf5_copying, only: copy_data_sets, extents_of, scales_of, read_attribute
  use mech9_study_filling, only: fill_rows
  implicit none
  private
  public :: study_columns_type, refuse_varied_times

  type :: study_columns_type
    private
    type(hdf5_series_type) :: series
    integer :: numbers = 0                      !< of a run; 0: the file has no columns
    integer :: runs = 0                         !< how many the file has
  contains
    procedure :: create
    procedure :: create_like
    procedure :: open => open_columns
    procedure :: open_unknown
    procedure :: are_there
    procedure :: numbers_of_run
    procedure :: write_run
    procedure :: read_run
    procedure :: close => close_columns
    procedure, private :: begin
    procedure, private :: begin_from
  end type study_columns_type

contains

  !> Fail with exit_data where the runs of a study do not have the same times, because a parameter sets these.
  subroutine refuse_varied_times(given, err)
    type(data_file_type), intent(in) :: given           !< the data file
    type(error_type), allocatable, intent(out) :: err   !< allocated if a parameter does so
    integer :: i, k

    do i = 1, size(given%model%parameters)
      associate (parameter => given%model%parameters(i))
        do k = 1, size(parameter%targets)
          if (parameter%targets(k)%group /= 'time') cycle
          call raise(err, exit_data, "parameter '"//parameter%name//"' sets "//trim(parameter%targets(k)%name)// &
                     ', and hdf5_runs=.true. in &output records all runs at the same times; leave one of them out', parameter%place)
          return
        end do
      end associate
    end do
  end subroutine refuse_varied_times

  !> Whether the file has columns.
  pure logical function are_there(self)
    class(study_columns_type), intent(in) :: self   !< the columns

    are_there = self%numbers > 0
  end function are_there

  !> How many numbers a run has in all its columns.
  pure integer function numbers_of_run(self)
    class(study_columns_type), intent(in) :: self   !< the columns

    numbers_of_run = self%numbers
  end function numbers_of_run

  !> Make the data sets for the runs of a model in a new file, with their scales; all numbers are NaN.
  subroutine create(self, file, given, runs)
    class(study_columns_type), intent(inout) :: self   !< the columns
    type(hdf5_file_type), intent(inout) :: file        !< the open file, with the scale `run`
    type(data_file_type), intent(in) :: given          !< the data file
    integer, intent(in) :: runs                        !< how many the file has
    type(string_type), allocatable :: names(:)
    integer :: i

    call self%begin(given, runs)
    call self%series%create(file)
    associate (time => given%model%request%time)
      call file%put('time', [(time%time(i), i=0, time%intervals)], 'time', given%run_columns%units(1)%text)
    end associate
    call file%make_scale('time')
    call put_scales(file, given%model%mechanism, given%run_columns)
    call self%series%attach(file)
    call self%series%list_names(names)
    call file%put('study/columns', names, 'data sets over the runs and time')
    call fill_rows(self%series, file, self%numbers, runs)
  end subroutine create

  !> Make the data sets that another file has, for other runs, with their scales; all numbers are NaN.
  subroutine create_like(self, file, names, other, runs)
    class(study_columns_type), intent(inout) :: self   !< the columns
    type(hdf5_file_type), intent(inout) :: file        !< the open file, with the scale `run`
    type(string_type), intent(in) :: names(:)          !< paths of the data sets
    type(hdf5_file_type), intent(inout) :: other       !< the open file that has them
    integer, intent(in) :: runs                        !< how many the new file has

    call self%begin_from(other, names, runs)
    if (allocated(other%failure)) then
      call file%fail("the columns in '"//other%path//"' cannot be read")
      return
    end if
    call self%series%create(file)
    call copy_data_sets(other, file, [character(len=scale_length) :: 'time', names_of_scales])
    call self%series%attach(file)
    call file%put('study/columns', names, 'data sets over the runs and time')
    call fill_rows(self%series, file, self%numbers, runs)
  end subroutine create_like

  !> Open the data sets of a file that is continued. It is a failure of the file where they are not those of the runs of
  !> the model.
  subroutine open_columns(self, file, given, runs)
    class(study_columns_type), intent(inout) :: self   !< the columns
    type(hdf5_file_type), intent(inout) :: file        !< the open file
    type(data_file_type), intent(in) :: given          !< the data file
    integer, intent(in) :: runs                        !< how many the file has

    call self%begin(given, runs)
    call self%series%open(file)
  end subroutine open_columns

  !> Open the data sets of a file for reading, whatever they are.
  subroutine open_unknown(self, file, names, runs)
    class(study_columns_type), intent(inout) :: self   !< the columns
    type(hdf5_file_type), intent(inout) :: file        !< the open file
    type(string_type), intent(in) :: names(:)          !< paths of the data sets
    integer, intent(in) :: runs                        !< how many the file has

    if (size(names) == 0) return
    call self%begin_from(file, names, runs)
    call self%series%open(file)
  end subroutine open_unknown

  !> Prepare the data sets of a model.
  subroutine begin(self, given, runs)
    class(study_columns_type), intent(inout) :: self   !< the columns
    type(data_file_type), intent(in) :: given          !< the data file
    integer, intent(in) :: runs                        !< how many the file has
    type(column_layout_type) :: layout
    type(column_set_list_type) :: list

    layout%times = given%model%request%time%intervals + 1
    self%numbers = given%run_columns%width()*layout%times
    self%runs = runs
    call layout%add(list, given%model%mechanism, given%run_columns)
    call self%series%start_fixed(list%count, self%numbers, runs, .true.)
    call self%series%add_all(list)
  end subroutine begin

  !> Prepare the data sets that a file has. Their numbers stand in a row one data set after the other.
  subroutine begin_from(self, file, names, runs)
    class(study_columns_type), intent(inout) :: self   !< the columns
    type(hdf5_file_type), intent(inout) :: file        !< the open file that has them
    type(string_type), intent(in) :: names(:)          !< paths of the data sets
    integer, intent(in) :: runs                        !< how many the data sets are to have
    integer, allocatable :: extents(:)
    type(string_type), allocatable :: scales(:)
    character(len=scale_length), allocatable :: paths(:)
    character(len=:), allocatable :: meaning, unit
    integer :: n, i, k

    self%runs = runs
    call self%series%start_fixed(size(names), 1, runs, .true.)
    do i = 1, size(names)
      call extents_of(file, names(i)%text, extents)
      call scales_of(file, names(i)%text, [character(len=scale_length) :: 'run', 'time', names_of_scales], scales)
      if (allocated(file%failure)) return
      allocate (paths(size(scales)))
      do k = 1, size(scales)
        paths(k) = scales(k)%text
      end do
      ! the last extent is that of the runs
      n = product(extents(:size(extents) - 1))
      call read_attribute(file, names(i)%text, 'long_name', meaning)
      call read_attribute(file, names(i)%text, 'units', unit)
      call self%series%add(new_column_set(names(i)%text, [(self%numbers + k, k=1, n)], extents(:size(extents) - 1), meaning, &
                                          unit, paths))
      self%numbers = self%numbers + n
      deallocate (paths)
    end do
  end subroutine begin_from

  !> Write the columns of a run.
  subroutine write_run(self, file, place, numbers)
    class(study_columns_type), intent(inout) :: self   !< the columns
    type(hdf5_file_type), intent(inout) :: file        !< the open file
    integer, intent(in) :: place                       !< of the run in the part, from 1
    real(wp), intent(in) :: numbers(self%numbers)      !< of the run, one time after the other

    call self%series%write_row_at(file, place, numbers)
  end subroutine write_run

  !> Read the columns of a run.
  subroutine read_run(self, file, place, numbers)
    class(study_columns_type), intent(in) :: self      !< the columns
    type(hdf5_file_type), intent(inout) :: file        !< the open file
    integer, intent(in) :: place                       !< of the run in the part, from 1
    real(wp), intent(inout) :: numbers(:, :)           !< (numbers_of_run,1) one time after the other

    call self%series%read_rows(file, place, numbers)
  end subroutine read_run

  !> Close the data sets.
  subroutine close_columns(self, file)
    class(study_columns_type), intent(inout) :: self   !< the columns
    type(hdf5_file_type), intent(inout) :: file        !< the open file

    if (self%are_there()) call self%series%close(file)
    self%numbers = 0
  end subroutine close_columns
end module mech9_study_columns
