!> What a run is going to write, held against what it reads and against itself, before anything is lost.
!> Uses error, text, same_file, source, settings, command_line.
module mech9_overwriting
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: starts_with
  use mech9_same_file, only: same_file
  use mech9_source, only: source_type
  use mech9_settings, only: output_settings_type
  use mech9_command_line, only: command_line_type
  implicit none
  private
  public :: refuse_overwriting

  !> The options that name files to be written whose names may end in anything.
  character(len=*), parameter :: written(*) = [character(len=6) :: 'table', 'hdf5', 'graph', 'report']

contains

  !> Fails with exit_usage where a file of the input, or another result, would be written over.
  subroutine refuse_overwriting(options, sources, err, output)
    type(command_line_type), intent(in) :: options
    type(source_type), intent(in) :: sources(:)                    !< texts that were read
    type(error_type), allocatable, intent(out) :: err
    type(output_settings_type), intent(in), optional :: output     !< what the data file says, once it is known
    character(len=:), allocatable :: path, other
    integer :: i, k

    do i = 1, size(written)
      call find_path(options, trim(written(i)), output, path)
      if (path == '' .or. path == '-' .or. starts_with(path, '/dev/')) cycle
      do k = 1, size(sources)
        if (.not. sources(k)%is_file) cycle
        if (same_file(path, sources(k)%name)) call raise(err, exit_usage, what(options, trim(written(i)))//" would overwrite '"// &
                                                         sources(k)%name//"', which is read; give it another name")
        if (allocated(err)) return
      end do
      do k = 1, i - 1
        call find_path(options, trim(written(k)), output, other)
        if (path == other) &
          call raise(err, exit_usage, what(options, trim(written(k)))//' and '//what(options, trim(written(i)))// &
                     " cannot both be '"//path//"'")
        if (allocated(err)) return
      end do
    end do
  end subroutine refuse_overwriting

  !> Where a kind of results goes: the command line comes before the data file; empty if nowhere.
  pure subroutine find_path(options, option, output, path)
    type(command_line_type), intent(in) :: options
    character(len=*), intent(in) :: option         !< without the dashes
    type(output_settings_type), intent(in), optional :: output
    character(len=:), allocatable, intent(out) :: path
    logical :: of_runs

    path = ''
    of_runs = option == 'table' .or. option == 'hdf5'
    if (of_runs .and. (options%has('no-write') .or. options%answer() /= '')) return
    if (options%has(option) .or. .not. (of_runs .and. present(output))) then
      path = options%argument(option)
    else if (option == 'hdf5') then
      path = output%hdf5
    else
      path = output%table
    end if
  end subroutine find_path

  !> How results are called in a message: by their option, or by their name in the data file.
  pure function what(options, option) result(name)
    type(command_line_type), intent(in) :: options
    character(len=*), intent(in) :: option
    character(len=:), allocatable :: name

    name = '&output '//option
    if (options%has(option)) name = '--'//option
  end function what
end module mech9_overwriting
