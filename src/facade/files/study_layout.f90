!> Names and units of what the file of a study holds, from its model or from a file.
module mech9_study_layout
  use mech9_text, only: string_type
  use mech9_data_file, only: data_file_type
  use mech9_hdf5_file, only: hdf5_file_type
  use mech9_hdf5_reading, only: read_text, read_texts, read_integer, has_data_set
  implicit none
  private
  public :: study_layout_type, layout_of, write_layout, read_layout

  type :: study_layout_type
    character(len=:), allocatable :: title               !< of the mechanism
    character(len=:), allocatable :: kind                !< of the study: grid, list, random, latin or sobol
    character(len=:), allocatable :: definition          !< text that determines the numbers of the study
    integer :: runs = 0                                  !< of the whole study
    integer :: part(2) = 1                               !< number of the part, and how many parts there are
    type(string_type), allocatable :: parameters(:)      !< their names
    type(string_type), allocatable :: quantities(:)      !< their names
    type(string_type), allocatable :: units(:)           !< (quantities)
    type(string_type), allocatable :: parameter_units(:) !< (parameters) empty where none is known
    type(string_type), allocatable :: meanings(:)        !< (quantities) a few words that describe each
    type(string_type), allocatable :: columns(:)         !< paths of the data sets over runs and time; none: the file has none
  contains
    procedure :: runs_of_part
  end type study_layout_type

contains

  !> How many runs the part has.
  pure integer function runs_of_part(self) result(n)
    class(study_layout_type), intent(in) :: self   !< the layout

    n = 0
    if (self%part(1) <= self%runs) n = 1 + (self%runs - self%part(1))/self%part(2)
  end function runs_of_part

  !> Form the layout of a study.
  subroutine layout_of(given, definition, part, layout)
    type(data_file_type), intent(in) :: given                 !< the data file
    character(len=*), intent(in) :: definition                !< text that determines the numbers of the study
    integer, intent(in) :: part(2)                            !< number of the part, and how many parts there are
    type(study_layout_type), intent(out) :: layout            !< names and units
    integer :: i

    layout%title = given%model%mechanism%title
    layout%kind = trim(given%model%request%study%kind)
    layout%definition = definition
    layout%runs = given%model%request%study%runs
    layout%part = part
    allocate (layout%columns(0))
    call given%list_parameters(layout%parameters, layout%parameter_units)
    associate (requested => given%model%request%quantities)
      allocate (layout%quantities(size(requested)), layout%units(size(requested)), layout%meanings(size(requested)))
      do i = 1, size(requested)
        layout%quantities(i)%text = requested(i)%name
        layout%units(i)%text = given%quantities%unit_of(i)
        layout%meanings(i)%text = trim(requested(i)%take)//' of '//requested(i)%column
        if (requested(i)%take == 'exponent') layout%meanings(i)%text = 'Lyapunov exponent, largest first'
        if (requested(i)%take == 'error') layout%meanings(i)%text = 'standard error of an exponent'
        if (requested(i)%take == 'class') layout%meanings(i)%text = 'class of what the motion goes to'
      end do
    end associate
  end subroutine layout_of

  !> Write a layout to the file of a study.
  subroutine write_layout(file, layout)
    type(hdf5_file_type), intent(inout) :: file          !< the open file
    type(study_layout_type), intent(in) :: layout        !< names and units

    call file%put('study/title', layout%title, 'title of the mechanism')
    call file%put('study/kind', layout%kind, 'kind of the study')
    call file%put('study/definition', layout%definition, 'text that determines the numbers of the study')
    call file%put('study/runs', layout%runs, 'runs of the whole study')
    call file%put('study/part', layout%part(1), 'number of the part of the study that this file has')
    call file%put('study/parts', layout%part(2), 'how many parts there are')
    call file%put('study/parameters', layout%parameters, 'names of the parameters in their order')
    call file%put('study/parameter_units', layout%parameter_units, 'unit of each parameter; empty where none is known')
    call file%put('study/quantities', layout%quantities, 'names of the quantities in their order')
    call file%put('study/units', layout%units, 'unit of each quantity')
    call file%put('study/meanings', layout%meanings, 'meaning of each quantity')
  end subroutine write_layout

  !> Read the layout of the file of a study. It is a failure of the file where it has none, or one that makes no sense.
  subroutine read_layout(file, layout)
    type(hdf5_file_type), intent(inout) :: file          !< the open file
    type(study_layout_type), intent(out) :: layout       !< names and units

    call read_text(file, 'study/definition', layout%definition)
    call read_text(file, 'study/title', layout%title)
    call read_text(file, 'study/kind', layout%kind)
    call read_integer(file, 'study/runs', layout%runs)
    call read_integer(file, 'study/part', layout%part(1))
    call read_integer(file, 'study/parts', layout%part(2))
    call read_texts(file, 'study/parameters', layout%parameters)
    call read_texts(file, 'study/quantities', layout%quantities)
    call read_texts(file, 'study/units', layout%units)
    call read_texts(file, 'study/meanings', layout%meanings)
    ! files of earlier versions have no such units
    if (has_data_set(file, 'study/parameter_units')) then
      call read_texts(file, 'study/parameter_units', layout%parameter_units)
    else
      allocate (layout%parameter_units(size(layout%parameters)), source=string_type(''))
    end if
    allocate (layout%columns(0))
    if (has_data_set(file, 'study/columns')) call read_texts(file, 'study/columns', layout%columns)
    if (allocated(file%failure)) return
    if (layout%runs < 0 .or. any(layout%part < 1) .or. layout%part(1) > layout%part(2)) &
      call file%fail('the numbers of its runs and parts make no sense')
    if (size(layout%parameter_units) /= size(layout%parameters)) call file%fail('the units of its parameters make no sense')
    if (size(layout%units) /= size(layout%quantities) .or. size(layout%meanings) /= size(layout%quantities)) &
      call file%fail('the units of its quantities make no sense')
  end subroutine read_layout
end module mech9_study_layout
