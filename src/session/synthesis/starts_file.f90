!> The starts of a synthesis in its HDF5 file. It has a place for every start from the beginning. The place is empty,
!> with the count -1, until the start is made. A program that is killed at any moment thus leaves a file whose starts
!> are either whole or not made.
module mech9_starts_file
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_column_sets, only: new_column_set
  use mech9_hdf5_series, only: hdf5_series_type
  use mech9_hdf5_reading, only: open_existing, read_text, read_integer, has_data_set
  use mech9_structure_layout, only: write_coordinates
  use mech9_study_filling, only: fill_rows
  use mech9_study_definition, only: digest_of, tell_difference
  use mech9_design_search, only: found_design_type, most_assemblies
  use mech9_synthesis, only: synthesis_type
  use mech9_search_starts, only: start_type
  implicit none
  private
  public :: starts_file_type, read_starts

  !> Extents of the designs of one start, and their places in its row. The row has for each design its value,
  !> parameters, coordinates and times, one design behind the other, and their number at the end.
  type :: layout_type
    integer :: parameters = 0
    integer :: coordinates = 0
    integer :: targets = 0
  contains
    procedure :: width
    procedure :: columns
  end type layout_type

  type :: starts_file_type
    type(hdf5_file_type) :: file
    type(hdf5_series_type), private :: series
    type(layout_type), private :: layout
    real(wp), allocatable, private :: row(:)      !< of a start
    logical, private :: reported = .false.        !< whether the failure of the file was reported
  contains
    procedure :: create
    procedure :: publish
    procedure :: is_open
    procedure :: write_start
    procedure :: close => close_file
    procedure :: tell
  end type starts_file_type

  integer, parameter :: not_made = -1   !< count of the designs of a start that is not made yet

contains

  !> The numbers of one design.
  pure integer function width(self)
    class(layout_type), intent(in) :: self   !< the layout

    width = 1 + self%parameters + self%coordinates + self%targets
  end function width

  !> The columns of some numbers of all designs.
  pure function columns(self, before, n) result(list)
    class(layout_type), intent(in) :: self   !< the layout
    integer, intent(in) :: before            !< numbers of a design before these
    integer, intent(in) :: n                 !< how many they are
    integer :: list(n*most_assemblies)
    integer :: i, k

    list = [(((k - 1)*self%width() + before + i, i=1, n), k=1, most_assemblies)]
  end function columns

  !> The layout of the starts of a synthesis.
  pure function layout_of(synthesis) result(layout)
    type(synthesis_type), intent(in) :: synthesis   !< prepared
    type(layout_type) :: layout

    layout = layout_type(size(synthesis%space%varied), synthesis%space%plan%n_coordinates, size(synthesis%targets))
  end function layout_of

  !> Create the file with all its places. It gets its name with `publish`; a file of that name stays until then.
  subroutine create(self, path, model, synthesis, definition, at_end, err)
    class(starts_file_type), intent(out) :: self        !< the file
    character(len=*), intent(in) :: path                !< of the file
    type(model_type), intent(in) :: model               !< the model
    type(synthesis_type), intent(in) :: synthesis       !< prepared
    character(len=*), intent(in) :: definition          !< text that determines the search but for the number of starts
    logical, intent(in) :: at_end                       !< the search is over
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    self%layout = layout_of(synthesis)
    call self%file%create(path, err)
    if (allocated(err)) return
    call begin_series(self%series, self%layout, model, synthesis, model%request%optimum%starts)
    allocate (self%row(most_assemblies*self%layout%width() + 1), source=0.0_wp)
    call self%series%create(self%file)
    call write_scales(self%file, model, self%layout)
    call self%series%attach(self%file)
    call fill_rows(self%series, self%file, size(self%row), model%request%optimum%starts, not_made, at_end)
    call self%file%put('optimum/definition', definition, 'text that determines the search but for the number of starts')
    call self%file%put('optimum/digest', digest_of(definition), 'cyclic redundancy check of the definition')
    call self%file%put('optimum/seed', model%request%optimum%seed, 'seed of the starts')
    call self%file%put('optimum/wanted', model%request%optimum%starts, 'starts for which the file has places')
    call self%tell(err)
    if (allocated(err)) call self%file%close()
  end subroutine create

  !> Add the data sets of the starts; the number of designs is written last.
  subroutine begin_series(series, layout, model, synthesis, starts)
    type(hdf5_series_type), intent(inout) :: series     !< gets the data sets
    type(layout_type), intent(in) :: layout             !< of a start
    type(model_type), intent(in) :: model               !< the model
    type(synthesis_type), intent(in) :: synthesis       !< prepared
    integer, intent(in) :: starts                       !< how many there are
    character(len=11), parameter :: of_design(2) = [character(len=11) :: '/start', '/assembly']
    integer :: i, n

    n = most_assemblies*layout%width() + 1
    call series%start_fixed(layout%parameters + 4, n, starts, .false.)
    call series%add(new_column_set('starts/value', layout%columns(0, 1), [most_assemblies], &
                                   'value of a design to which the start led', '', of_design))
    do i = 1, layout%parameters
      associate (name => model%parameters(synthesis%space%varied(i))%name)
        call series%add(new_column_set('starts/parameters/'//name, layout%columns(i, 1), [most_assemblies], 'parameter '//name, &
                                       '', of_design))
      end associate
    end do
    call series%add(new_column_set('starts/coordinates', layout%columns(1 + layout%parameters, layout%coordinates), &
                                   [layout%coordinates, most_assemblies], 'coordinates of its assembly at the start of the run', &
                                   'rad,m', [of_design, '/coordinate']))
    if (layout%targets > 0) &
      call series%add(new_column_set('starts/times', layout%columns(1 + layout%parameters + layout%coordinates, layout%targets), &
                                     [layout%targets, most_assemblies], 'times of its targets', 's', [of_design, '/target    ']))
    call series%add(new_column_set('starts/found', [n], [integer ::], &
                                   'number of designs to which the start led; -1: not made yet', '1', of_design(:1), whole=.true.))
  end subroutine begin_series

  !> Write the scales of the dimensions: start, assembly, coordinate, target.
  subroutine write_scales(file, model, layout)
    type(hdf5_file_type), intent(inout) :: file   !< the file
    type(model_type), intent(in) :: model         !< the model
    type(layout_type), intent(in) :: layout       !< of a start
    integer :: i

    call file%put('start', [(i, i=1, model%request%optimum%starts)], 'number of the start')
    call file%make_scale('start')
    call file%put('assembly', [(i, i=1, most_assemblies)], 'number of the design among those to which one start led')
    call file%make_scale('assembly')
    call write_coordinates(file, model)
    if (layout%targets == 0) return
    call file%put('target', [(i, i=1, layout%targets)], 'number of the target, in the order of objectives and files')
    call file%make_scale('target')
  end subroutine write_scales

  !> Give a file that was created its name.
  subroutine publish(self, err)
    class(starts_file_type), intent(inout) :: self      !< the file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call self%file%flush()
    call self%tell(err)
  end subroutine publish

  !> Whether there is a file.
  pure logical function is_open(self)
    class(starts_file_type), intent(in) :: self   !< the file

    is_open = self%file%is_open()
  end function is_open

  !> Write a start that is made; it is in the file at once.
  subroutine write_start(self, number, found)
    class(starts_file_type), intent(inout) :: self      !< the file
    integer, intent(in) :: number                       !< of the start, from 1
    type(found_design_type), intent(in) :: found(:)     !< designs to which it led
    integer :: i, n, at

    if (.not. self%is_open()) return
    n = 0
    self%row = ieee_value(self%row, ieee_quiet_nan)
    do i = 1, size(found)
      if (.not. found(i)%found) cycle
      at = n*self%layout%width()
      self%row(at + 1:at + self%layout%width()) = [found(i)%value, found(i)%x, found(i)%q, found(i)%times]
      n = n + 1
    end do
    self%row(size(self%row)) = n
    call self%series%write_row_at(self%file, number, self%row)
    call self%series%hand_over(self%file)
  end subroutine write_start

  !> Close the file. Do nothing to a file that is not open.
  subroutine close_file(self, err)
    class(starts_file_type), intent(inout) :: self      !< the file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it cannot be written

    if (.not. self%is_open()) return
    call self%series%close(self%file)
    call self%file%close()
    call self%tell(err)
  end subroutine close_file

  !> Return the first failure of the file, only once.
  subroutine tell(self, err)
    class(starts_file_type), intent(inout) :: self      !< the file
    type(error_type), allocatable, intent(out) :: err   !< the failure

    if (self%reported .or. .not. allocated(self%file%failure)) return
    self%reported = .true.
    err = self%file%failure
  end subroutine tell

  !> Read the starts of an existing file. Fail with exit_file where it is not the file of a search, is that of another
  !> problem, or has too many starts.
  subroutine read_starts(path, model, synthesis, definition, starts, err)
    character(len=*), intent(in) :: path                    !< of the file
    type(model_type), intent(in) :: model                   !< the model
    type(synthesis_type), intent(in) :: synthesis           !< prepared
    character(len=*), intent(in) :: definition              !< text that determines the search but for the number of starts
    type(start_type), intent(inout) :: starts(:)            !< gets those that were made
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(hdf5_file_type) :: file
    type(hdf5_series_type) :: series
    integer :: wanted

    call open_existing(path, .false., file, err)
    if (allocated(err)) return
    call judge_definition(file, definition, size(starts), wanted)
    if (.not. allocated(file%failure)) then
      call begin_series(series, layout_of(synthesis), model, synthesis, wanted)
      call series%open(file)
      call take_starts(file, series, layout_of(synthesis), starts(:wanted))
      call series%close(file)
    end if
    call file%close()
    if (allocated(file%failure)) err = file%failure
  end subroutine read_starts

  !> Let the file fail where it is not one of this problem, or has more starts than are wanted.
  subroutine judge_definition(file, definition, most, wanted)
    type(hdf5_file_type), intent(inout) :: file             !< the open file
    character(len=*), intent(in) :: definition              !< text that determines the search but for the number of starts
    integer, intent(in) :: most                             !< starts that are wanted now
    integer, intent(out) :: wanted                          !< starts for which the file has places
    character(len=:), allocatable :: text, difference

    wanted = 0
    if (.not. has_data_set(file, 'optimum/definition')) then
      call file%fail('it is not the file of a search by --optimize')
      return
    end if
    call read_text(file, 'optimum/definition', text)
    call read_integer(file, 'optimum/wanted', wanted)
    if (allocated(file%failure)) return
    call tell_difference(text, definition, difference, 'there', 'here')
    if (difference /= '') then
      call file%fail('it is of another search: '//difference//'; continue it with the data file, the files that '// &
                     'this names and the changes by --set that made it, or make a new one by --hdf5')
    else if (wanted < 1) then
      call file%fail('its number of starts makes no sense')
    else if (wanted > most) then
      call file%fail('it has '//to_text(wanted)//' starts, and the data file asks for '//to_text(most)// &
                     '; give at least as many by starts= in &optimum')
    end if
  end subroutine judge_definition

  !> Take the starts that were made.
  subroutine take_starts(file, series, layout, starts)
    type(hdf5_file_type), intent(inout) :: file             !< the open file
    type(hdf5_series_type), intent(in) :: series            !< its data sets
    type(layout_type), intent(in) :: layout                 !< of a start
    type(start_type), intent(inout) :: starts(:)            !< gets those that were made
    real(wp) :: row(most_assemblies*layout%width() + 1, 1)
    integer :: i, k, n, at

    do i = 1, size(starts)
      call series%read_rows(file, i, row)
      if (allocated(file%failure)) return
      n = nint(row(size(row), 1))
      if (n == not_made) cycle
      if (n < 0 .or. n > most_assemblies) then
        call file%fail('the number of designs of start '//to_text(i)//' makes no sense')
        return
      end if
      allocate (starts(i)%found(n))
      do k = 1, n
        at = (k - 1)*layout%width() + 1
        associate (found => starts(i)%found(k))
          found%found = .true.
          found%value = row(at, 1)
          found%x = row(at + 1:at + layout%parameters, 1)
          at = at + layout%parameters
          found%q = row(at + 1:at + layout%coordinates, 1)
          at = at + layout%coordinates
          found%times = row(at + 1:at + layout%targets, 1)
        end associate
      end do
    end do
  end subroutine take_starts
end module mech9_starts_file
