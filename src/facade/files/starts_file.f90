!> The starts of a synthesis in its HDF5 file. It has a place for every start from the beginning. The place is empty,
!> with the count -1, until the start is made. A program that is killed at any moment thus leaves a file whose starts
!> are either whole or not made.
module mech9_starts_file
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_error, only: error_type
  use mech9_data_file, only: data_file_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_column_sets, only: new_column_set
  use mech9_hdf5_series, only: hdf5_series_type
  use mech9_hdf5_reading, only: open_existing, read_text, read_texts, read_integer, has_data_set
  use mech9_hdf5_copying, only: extents_of
  use mech9_structure_layout, only: write_coordinates, write_coordinates_in
  use mech9_study_filling, only: fill_rows
  use mech9_study_definition, only: digest_of, tell_difference
  use mech9_design_search, only: found_design_type, most_assemblies
  use mech9_synthesis, only: synthesis_type
  use mech9_start_rows, only: start_row_type, row_of_synthesis, not_made
  use mech9_search_starts, only: start_type
  implicit none
  private
  public :: starts_file_type, starts_layout_type, find_layout, read_starts

  !> Names and extents of what the file of a search holds, from its model or from a file.
  type :: starts_layout_type
    character(len=:), allocatable :: definition    !< text that determines the search but for the number of starts
    integer :: seed = 0                            !< of the starts
    integer :: wanted = 0                          !< starts for which the file has places
    type(string_type), allocatable :: names(:)     !< of the parameters that are varied
    type(start_row_type) :: row                    !< the designs of a start
  end type starts_layout_type

  type :: starts_file_type
    type(hdf5_file_type) :: file
    type(hdf5_series_type), private :: series
    type(starts_layout_type) :: layout
    real(wp), allocatable, private :: row(:)      !< of a start
    logical, private :: reported = .false.        !< whether the failure of the file was reported
  contains
    procedure :: create
    procedure :: create_like
    procedure :: open => open_file
    procedure :: read_all
    procedure :: publish
    procedure :: is_open
    procedure :: write_start
    procedure :: close => close_file
    procedure :: tell
  end type starts_file_type

contains

  !> Form the layout of a search.
  subroutine find_layout(given, synthesis, definition, layout)
    type(data_file_type), intent(in) :: given             !< the data file
    type(synthesis_type), intent(in) :: synthesis         !< prepared
    character(len=*), intent(in) :: definition            !< text that determines the search but for the number of starts
    type(starts_layout_type), intent(out) :: layout       !< names and extents
    integer :: i

    layout%definition = definition
    layout%seed = given%model%request%optimum%seed
    layout%wanted = given%model%request%optimum%starts
    layout%row = row_of_synthesis(synthesis)
    allocate (layout%names(layout%row%parameters))
    do i = 1, size(layout%names)
      layout%names(i)%text = given%model%parameters(synthesis%space%varied(i))%name
    end do
  end subroutine find_layout

  !> Create the file with all its places. It gets its name with `publish`; a file of that name stays until then.
  subroutine create(self, path, given, layout, at_end, err)
    class(starts_file_type), intent(out) :: self        !< the file
    character(len=*), intent(in) :: path                !< of the file
    type(data_file_type), intent(in) :: given           !< the data file
    type(starts_layout_type), intent(in) :: layout      !< of the search
    logical, intent(in) :: at_end                       !< the search is over
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call begin_file(self, path, layout, err)
    if (allocated(err)) return
    call write_coordinates(self%file, given%model)
    call complete_file(self, at_end, err)
  end subroutine create

  !> Create the file of a whole search with all its places, for starts that files of parts have.
  subroutine create_like(self, path, part, wanted, err)
    class(starts_file_type), intent(out) :: self        !< the file
    character(len=*), intent(in) :: path                !< of the file
    type(starts_file_type), intent(inout) :: part       !< the open file of a part
    integer, intent(in) :: wanted                       !< starts of the whole search
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(starts_layout_type) :: layout
    type(string_type), allocatable :: units(:)

    call read_texts(part%file, 'coordinate_unit', units)
    call part%tell(err)
    if (allocated(err)) return
    layout = part%layout
    layout%wanted = wanted
    call begin_file(self, path, layout, err)
    if (allocated(err)) return
    call write_coordinates_in(self%file, units)
    call complete_file(self, .true., err)
  end subroutine create_like

  !> Begin a file with the data sets of its starts.
  subroutine begin_file(self, path, layout, err)
    class(starts_file_type), intent(inout) :: self      !< the file
    character(len=*), intent(in) :: path                !< of the file
    type(starts_layout_type), intent(in) :: layout      !< of the search
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    self%layout = layout
    call self%file%create(path, err)
    if (allocated(err)) return
    call begin_series(self%series, layout)
    allocate (self%row(layout%row%length()), source=0.0_wp)
    call self%series%create(self%file)
  end subroutine begin_file

  !> Write what the file has beside its starts and the scale of coordinates.
  subroutine complete_file(self, at_end, err)
    class(starts_file_type), intent(inout) :: self      !< the file, begun
    logical, intent(in) :: at_end                       !< the search is over
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    associate (layout => self%layout)
      call write_scales(self%file, layout)
      call self%series%attach(self%file)
      call fill_rows(self%series, self%file, size(self%row), layout%wanted, not_made, at_end)
      call self%file%put('optimum/definition', layout%definition, 'text that determines the search but for the number of starts')
      call self%file%put('optimum/digest', digest_of(layout%definition), 'cyclic redundancy check of the definition')
      call self%file%put('optimum/seed', layout%seed, 'seed of the starts')
      call self%file%put('optimum/wanted', layout%wanted, 'starts for which the file has places')
      call self%file%put('optimum/varied', layout%names, 'names of the parameters that are varied')
      call self%file%make_scale('optimum/varied')
    end associate
    call self%tell(err)
    if (allocated(err)) call self%file%close()
  end subroutine complete_file

  !> Add the data sets of the starts; the number of designs is written last.
  subroutine begin_series(series, layout)
    type(hdf5_series_type), intent(inout) :: series     !< gets the data sets
    type(starts_layout_type), intent(in) :: layout      !< of the search
    character(len=11), parameter :: of_design(2) = [character(len=11) :: '/start', '/assembly']
    integer :: i

    associate (row => layout%row)
      call series%start_fixed(row%parameters + 4, row%length(), layout%wanted, .false.)
      call series%add(new_column_set('starts/value', row%columns(0, 1), [most_assemblies], &
                                     'value of a design to which the start led', '', of_design))
      do i = 1, row%parameters
        call series%add(new_column_set('starts/parameters/'//layout%names(i)%text, row%columns(i, 1), [most_assemblies], &
                                       'parameter '//layout%names(i)%text, '', of_design))
      end do
      call series%add(new_column_set('starts/coordinates', row%columns(1 + row%parameters, row%coordinates), &
                                     [row%coordinates, most_assemblies], 'coordinates of its assembly at the start of the run', &
                                     'rad,m', [of_design, '/coordinate']))
      if (row%targets > 0) &
        call series%add(new_column_set('starts/times', row%columns(1 + row%parameters + row%coordinates, row%targets), &
                                       [row%targets, most_assemblies], 'times of its targets', 's', [of_design, '/target    ']))
      call series%add(new_column_set('starts/found', [row%length()], [integer ::], &
                                     'number of designs to which the start led; -1: not made yet', '1', of_design(:1), &
                                     whole=.true.))
    end associate
  end subroutine begin_series

  !> Write the scales of the dimensions: start, assembly, target.
  subroutine write_scales(file, layout)
    type(hdf5_file_type), intent(inout) :: file         !< the file
    type(starts_layout_type), intent(in) :: layout      !< of the search
    integer :: i

    call file%put('start', [(i, i=1, layout%wanted)], 'number of the start')
    call file%make_scale('start')
    call file%put('assembly', [(i, i=1, most_assemblies)], 'number of the design among those to which one start led')
    call file%make_scale('assembly')
    if (layout%row%targets == 0) return
    call file%put('target', [(i, i=1, layout%row%targets)], 'number of the target, in the order of objectives and files')
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

    if (.not. self%is_open()) return
    call self%layout%row%pack(found, self%row)
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

  !> Open the file of a search that is there, for reading. It is a failure of the file where it is none, or has another form.
  subroutine open_file(self, path, err)
    class(starts_file_type), intent(out) :: self        !< the file
    character(len=*), intent(in) :: path                !< of the file
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed

    call open_existing(path, .false., self%file, err)
    if (allocated(err)) return
    call read_layout(self%file, self%layout)
    if (.not. allocated(self%file%failure)) then
      call begin_series(self%series, self%layout)
      call self%series%open(self%file)
    end if
    call self%tell(err)
    if (allocated(err)) call self%file%close()
  end subroutine open_file

  !> Read names and extents of what the file of a search holds.
  subroutine read_layout(file, layout)
    type(hdf5_file_type), intent(inout) :: file         !< the open file
    type(starts_layout_type), intent(out) :: layout     !< names and extents
    integer, allocatable :: extents(:)

    if (.not. has_data_set(file, 'optimum/definition')) then
      call file%fail('it is not the file of a search by --optimize')
      return
    end if
    call read_text(file, 'optimum/definition', layout%definition)
    call read_integer(file, 'optimum/seed', layout%seed)
    call read_integer(file, 'optimum/wanted', layout%wanted)
    call read_texts(file, 'optimum/varied', layout%names)
    if (.not. allocated(file%failure) .and. layout%wanted < 1) call file%fail('its number of starts makes no sense')
    if (allocated(file%failure)) return
    layout%row%parameters = size(layout%names)
    call extents_of(file, 'coordinate', extents)
    if (size(extents) == 1) layout%row%coordinates = extents(1)
    if (.not. has_data_set(file, 'target')) return
    call extents_of(file, 'target', extents)
    if (size(extents) == 1) layout%row%targets = extents(1)
  end subroutine read_layout

  !> Read the starts of an existing file. Fail with exit_file where it is not the file of a search, is that of another
  !> problem, or has too many starts.
  subroutine read_starts(path, layout, starts, err)
    character(len=*), intent(in) :: path                    !< of the file
    type(starts_layout_type), intent(in) :: layout          !< of the search that is continued
    type(start_type), intent(inout) :: starts(:)            !< gets those that were made
    type(error_type), allocatable, intent(out) :: err       !< allocated if it failed
    type(starts_file_type) :: there
    type(error_type), allocatable :: at_close

    call there%open(path, err)
    if (allocated(err)) return
    call judge_layout(there%file, there%layout, layout)
    if (.not. allocated(there%file%failure)) call there%read_all(starts(:there%layout%wanted))
    call there%tell(err)
    call there%close(at_close)
    if (.not. allocated(err)) call move_alloc(at_close, err)
  end subroutine read_starts

  !> Let the file fail where it is not one of this problem, or has more starts than are wanted.
  subroutine judge_layout(file, there, here)
    type(hdf5_file_type), intent(inout) :: file             !< the open file
    type(starts_layout_type), intent(in) :: there           !< its layout
    type(starts_layout_type), intent(in) :: here            !< of the search that is continued
    character(len=:), allocatable :: difference

    call tell_difference(there%definition, here%definition, difference, 'there', 'here')
    if (difference /= '') then
      call file%fail('it is of another search: '//difference//'; continue it with the data file, the files that '// &
                     'this names and the changes by --set that made it, or make a new one by --hdf5')
    else if (there%wanted > here%wanted) then
      call file%fail('it has '//to_text(there%wanted)//' starts, and the data file asks for '//to_text(here%wanted)// &
                     '; give at least as many by starts= in &optimum')
    end if
  end subroutine judge_layout

  !> Read the starts that were made.
  subroutine read_all(self, starts)
    class(starts_file_type), intent(inout) :: self          !< the open file
    type(start_type), intent(inout) :: starts(:)            !< gets them
    real(wp) :: row(self%layout%row%length(), 1)
    logical :: sound
    integer :: i

    do i = 1, size(starts)
      call self%series%read_rows(self%file, i, row)
      if (allocated(self%file%failure)) return
      call self%layout%row%unpack(row(:, 1), starts(i)%found, sound)
      if (sound) cycle
      call self%file%fail('the number of designs of start '//to_text(i)//' makes no sense')
      return
    end do
  end subroutine read_all
end module mech9_starts_file
