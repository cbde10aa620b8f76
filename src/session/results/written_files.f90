!> All files that a run or an answer will write, with those made beside them: one list, known before any file is opened.
module mech9_written_files
  use mech9_text, only: string_type
  use mech9_part_names, only: part_names_type, number_columns
  use mech9_replacement, only: path_of_part
  use mech9_plot, only: picture_of_plot
  use mech9_plot_drawing, only: script_of_plot
  use mech9_mechanism_pictures, only: kind_of_picture
  use mech9_mp4_film, only: frames_of_video
  use mech9_structure_graph, only: text_of_graph
  use mech9_xdmf, only: xdmf_path
  use mech9_data_file, only: data_file_type
  use mech9_kept_files, only: kept_files_type
  use mech9_command_line, only: command_line_type
  use mech9_cam_files, only: cam_file_type, read_cam_file
  implicit none
  private
  public :: result_paths_type, written_file_type, find_result_paths, find_kept_files, list_written_files, standard_output_path, &
            list_plot_requests

  !> The name that stands for standard output.
  character, parameter :: standard_output_path = '-'

  !> The paths of the results of a run; an empty path means that there is no such result.
  type :: result_paths_type
    character(len=:), allocatable :: table        !< '-' is standard output
    character(len=:), allocatable :: hdf5
    character(len=:), allocatable :: sketch
    type(string_type), allocatable :: animations(:)   !< moving pictures; no element: none
  end type result_paths_type

  !> A file that is going to be written.
  type :: written_file_type
    character(len=:), allocatable :: what         !< in words of the command line or of the data file
    character(len=:), allocatable :: path         !< '-' is standard output
  end type written_file_type

contains

  !> Choose the paths of the results of a run: the command line comes before the data file. If no result is requested,
  !> the table is written to standard output.
  pure subroutine find_result_paths(options, paths, given)
    type(command_line_type), intent(in) :: options               !< the command line
    type(result_paths_type), intent(out) :: paths                !< of table, HDF5 file and others
    class(data_file_type), intent(in), optional :: given         !< the data file; without one the options alone name results

    if (present(given)) then
      associate (output => given%model%request%output)
        paths%table = output%table
        paths%hdf5 = output%hdf5
        paths%sketch = output%sketch
        allocate (paths%animations(merge(1, 0, output%animation /= '')))
        if (output%animation /= '') paths%animations(1)%text = output%animation
      end associate
    else
      paths%table = ''
      paths%hdf5 = ''
      paths%sketch = ''
      allocate (paths%animations(0))
    end if
    call choose(options, 'table', paths%table)
    call choose(options, 'hdf5', paths%hdf5)
    call choose(options, 'continue', paths%hdf5)
    call choose(options, 'sketch', paths%sketch)
    if (options%has('animate')) call options%arguments('animate', paths%animations)
    if (options%has('study') .or. options%has('branch')) then
      ! they draw no pictures of the mechanism
      paths%sketch = ''
      paths%animations = paths%animations(:0)
    end if
    if (options%has('no-write')) then
      paths%table = ''
      paths%hdf5 = ''
    else if (paths%table == '' .and. paths%hdf5 == '' .and. &
             .not. (options%has('plot') .or. options%has('sketch') .or. options%has('animate'))) then
      paths%table = standard_output_path
    end if
  end subroutine find_result_paths

  !> Find the files that keep a study or a search.
  pure subroutine find_kept_files(options, given, files)
    type(command_line_type), intent(in) :: options      !< the command line
    class(data_file_type), intent(in) :: given          !< the data file
    type(kept_files_type), intent(out) :: files         !< table and HDF5 file, and the part that they get
    type(result_paths_type) :: paths

    call find_result_paths(options, paths, given)
    files%table = paths%table
    files%hdf5 = paths%hdf5
    files%continues = options%has('continue')
    files%part = options%part()
    files%part_words = options%argument('part')
    files%quiet = options%has('quiet')
  end subroutine find_kept_files

  !> Take the path that an option names, in place of that of the data file.
  pure subroutine choose(options, option, path)
    type(command_line_type), intent(in) :: options                  !< the command line
    character(len=*), intent(in) :: option                          !< without the dashes
    character(len=:), allocatable, intent(inout) :: path            !< of the data file; of the option where it is given

    if (options%has(option)) path = options%argument(option)
  end subroutine choose

  !> List the files. Where a data file is neither read nor needed, only a report is written.
  pure subroutine list_written_files(options, files, given)
    type(command_line_type), intent(in) :: options                  !< the command line
    type(written_file_type), allocatable, intent(out) :: files(:)   !< all files that are going to be written
    class(data_file_type), intent(in), optional :: given            !< the data file, once it is understood

    allocate (files(0))
    if ((present(given) .and. (options%answer() == '' .or. options%has('branch'))) .or. options%has('merge')) then
      call list_results(options, files, given)
      if (present(given) .and. .not. any([options%has('study'), options%has('optimize'), options%has('branch'), &
                                          options%has('no-write')])) &
        call append(files, '&section table', given%model%request%section%table)
    else if (present(given)) then
      call list_answers(options, files)
    end if
    if (options%has('report')) call append(files, '--report', options%argument('report'))
  end subroutine list_written_files

  !> Add the files that a run writes, or the parts of a study or a search that are merged.
  pure subroutine list_results(options, files, given)
    type(command_line_type), intent(in) :: options                    !< the command line
    type(written_file_type), allocatable, intent(inout) :: files(:)   !< gets the results
    class(data_file_type), intent(in), optional :: given              !< the data file
    type(result_paths_type) :: paths
    logical :: has_poses
    integer :: i

    call find_result_paths(options, paths, given)
    if (paths%table == standard_output_path) then
      call append(files, 'the table', paths%table)
    else
      call append(files, name_of(options, 'table', 'table'), paths%table)
    end if
    if (options%has('optimize')) call append(files, '--out', options%argument('out'))
    if (options%has('continue')) then
      call append(files, '--continue', paths%hdf5)
    else
      call append(files, name_of(options, 'hdf5', 'hdf5'), paths%hdf5)
    end if
    if (paths%hdf5 /= '') call append(files, 'the beginning of the HDF5 file', path_of_part(paths%hdf5))
    has_poses = .false.
    if (present(given)) has_poses = given%model%request%output%poses
    if (paths%hdf5 /= '' .and. has_poses) &
      call append(files, 'the description for ParaView beside the HDF5 file', xdmf_path(paths%hdf5))
    call list_plots(options, paths%table, files)
    call append(files, name_of(options, 'sketch', 'sketch'), paths%sketch)
    do i = 1, size(paths%animations)
      call append(files, name_of(options, 'animate', 'animation'), paths%animations(i)%text)
      if (kind_of_picture(paths%animations(i)%text) == 'mp4') &
        call append(files, 'the frames of an MP4', frames_of_video(paths%animations(i)%text))
    end do
  end subroutine list_results

  !> Add plots, each with its script.
  pure subroutine list_plots(options, table, files)
    type(command_line_type), intent(in) :: options                    !< the command line
    character(len=*), intent(in) :: table                             !< file of the table
    type(written_file_type), allocatable, intent(inout) :: files(:)   !< gets plots and scripts
    type(string_type), allocatable :: requests(:)
    character(len=:), allocatable :: picture
    integer :: i

    call options%arguments('plot', requests)
    do i = 1, size(requests)
      call picture_of_plot(requests(i)%text, table, options%file, i, picture)
      call append(files, '--plot', picture)
      if (picture /= standard_output_path) call append(files, 'the script of --plot', script_of_plot(picture))
    end do
  end subroutine list_plots

  !> List the arguments of --plot, with numbers in place of the names of links and pairs.
  pure subroutine list_plot_requests(options, names, requests)
    type(command_line_type), intent(in) :: options                  !< the command line
    type(part_names_type), intent(in) :: names                      !< of links and pairs
    type(string_type), allocatable, intent(out) :: requests(:)      !< in the order in which they were given
    integer :: i

    call options%arguments('plot', requests)
    do i = 1, size(requests)
      call number_columns(names, requests(i)%text)
    end do
  end subroutine list_plot_requests

  !> Add the files that are written without a run.
  pure subroutine list_answers(options, files)
    type(command_line_type), intent(in) :: options                    !< the command line
    type(written_file_type), allocatable, intent(inout) :: files(:)   !< gets the files of answers
    character(len=*), parameter :: printed(*) = [character(len=9) :: 'structure', 'check', 'plan', 'branches', 'range']
    type(string_type), allocatable :: paths(:)
    character(len=:), allocatable :: graph
    integer :: i

    do i = 1, size(printed)
      if (options%has(trim(printed(i)))) call append(files, '--'//trim(printed(i)), standard_output_path)
    end do
    if (options%has('structure')) return
    call options%arguments('dakota', paths)
    if (size(paths) == 2) call append(files, 'the results of --dakota', paths(2)%text)
    if (options%has('equilibrium') .or. options%has('modes') .or. options%has('linear') .or. options%has('exponents')) then
      call list_of_equilibrium(options, files)
      return
    end if
    call append(files, '--sketch', options%argument('sketch'))
    call list_cams(options, files)
    if (.not. options%has('graph')) return
    graph = options%argument('graph')
    call append(files, '--graph', graph)
    if (text_of_graph(graph) /= graph) call append(files, 'the text of --graph', text_of_graph(graph))
  end subroutine list_answers

  !> Add the files of --cam.
  pure subroutine list_cams(options, files)
    type(command_line_type), intent(in) :: options                    !< the command line
    type(written_file_type), allocatable, intent(inout) :: files(:)   !< gets the files
    type(string_type), allocatable :: requests(:)
    type(cam_file_type) :: file
    integer :: i

    call options%arguments('cam', requests)
    do i = 1, size(requests)
      call read_cam_file(requests(i)%text, file)
      call append(files, '--cam', file%path)
    end do
  end subroutine list_cams

  !> Add the files of --equilibrium, --modes and --linear.
  pure subroutine list_of_equilibrium(options, files)
    type(command_line_type), intent(in) :: options                    !< the command line
    type(written_file_type), allocatable, intent(inout) :: files(:)   !< gets the files
    type(string_type), allocatable :: films(:)
    integer :: i

    if (options%has('table')) then
      call append(files, '--table', options%argument('table'))
    else
      call append(files, 'the table', options%table_of_answer())
    end if
    call append(files, '--hdf5', options%argument('hdf5'))
    if (options%has('hdf5')) call append(files, 'the beginning of the HDF5 file', path_of_part(options%argument('hdf5')))
    call append(files, '--linear', options%argument('linear'))
    if (options%has('linear')) call append(files, 'the beginning of --linear', path_of_part(options%argument('linear')))
    call options%arguments('animate', films)
    do i = 1, size(films)
      call append(files, '--animate', films(i)%text)
    end do
  end subroutine list_of_equilibrium

  !> Append a file; none where the path is empty.
  pure subroutine append(files, what, path)
    type(written_file_type), allocatable, intent(inout) :: files(:)   !< gets one file more
    character(len=*), intent(in) :: what                              !< its kind in words
    character(len=*), intent(in) :: path                              !< its name
    type(written_file_type), allocatable :: longer(:)
    integer :: i

    if (path == '') return
    allocate (longer(size(files) + 1))
    do i = 1, size(files)
      call move_alloc(files(i)%what, longer(i)%what)
      call move_alloc(files(i)%path, longer(i)%path)
    end do
    longer(size(longer))%what = what
    longer(size(longer))%path = path
    call move_alloc(longer, files)
  end subroutine append

  !> Name of a result in a message: its option, or its name in the data file.
  pure function name_of(options, option, in_data_file) result(name)
    type(command_line_type), intent(in) :: options   !< the command line
    character(len=*), intent(in) :: option           !< without the dashes
    character(len=*), intent(in) :: in_data_file          !< the name in &output
    character(len=:), allocatable :: name

    name = '&output '//in_data_file
    if (options%has(option)) name = '--'//option
  end function name_of
end module mech9_written_files
