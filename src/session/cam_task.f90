!> The profiles of cams, for --cam: tables, drawings, and a few lines about each.
module mech9_cam_task
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_usage
  use mech9_text, only: string_type, to_text
  use mech9_counted, only: counted
  use mech9_path, only: ending_of
  use mech9_command_line, only: command_line_type
  use mech9_cam_files, only: cam_file_type, read_cam_file
  use mech9_json, only: json_type
  use mech9_data_file, only: data_file_type
  use mech9_recorded_cam, only: recorded_cam_type
  use mech9_answer_files, only: save_table
  use mech9_heading, only: new_heading
  use mech9_cam_picture, only: save_cam_picture
  use mech9_cam_text, only: print_cam, name_of_cam
  use mech9_cam_report, only: add_cam
  use mech9_answer_report, only: begin_answer_report
  implicit none
  private
  public :: work_on_cams

contains

  !> Compute the profiles of all requested cams, and write their files.
  subroutine work_on_cams(options, given, reported, err)
    type(command_line_type), intent(in) :: options      !< the command line
    type(data_file_type), intent(in), target :: given   !< the data file
    logical, intent(out) :: reported                    !< the report is written, or could not be written
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(cam_file_type), allocatable :: files(:)
    type(recorded_cam_type) :: profile
    type(json_type) :: json
    integer :: i, k

    reported = .false.
    call read_files(options, size(given%model%request%cams), files, err)
    if (allocated(err)) return
    call begin_answer_report(json, given, '')
    call json%begin_array('cams')
    do k = 1, size(given%model%request%cams)
      if (.not. any(files%number == k)) cycle
      associate (cam => given%model%request%cams(k))
        call profile%find(given, k, err)
        if (allocated(err)) return
        if (.not. options%has('quiet')) call print_cam(error_unit, given%model, k, profile%cam_profile_type)
        call json%begin_object()
        call add_cam(json, given%model, k, profile%cam_profile_type)
        call json%end_object()
        do i = 1, size(files)
          if (files(i)%number /= k) cycle
          if (files(i)%is_picture) then
            call save_cam_picture(files(i)%path, name_of_cam(given%model, k), given%model, cam, profile%cam_profile_type, err)
          else
            call write_profile(files(i)%path, options, given, profile, err)
          end if
          if (allocated(err)) return
          if (files(i)%path /= '-' .and. .not. options%has('quiet')) &
            write (error_unit, '(4a)') 'cam ', to_text(k), ': ', files(i)%path
        end do
      end associate
    end do
    reported = options%has('report')
    if (.not. reported) return
    call json%end_array()
    call json%end_object()
    call json%save(options%argument('report'), err)
  end subroutine work_on_cams

  !> Read the files of --cam. Cams that do not exist, and files that name no cam where there are several, are errors
  !> (exit_usage).
  subroutine read_files(options, n_cams, files, err)
    type(command_line_type), intent(in) :: options                !< the command line
    integer, intent(in) :: n_cams                                 !< cams of the data file
    type(cam_file_type), allocatable, intent(out) :: files(:)     !< the files, each with the number of its cam
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    type(string_type), allocatable :: requests(:)
    integer :: i

    call options%arguments('cam', requests)
    allocate (files(size(requests)))
    do i = 1, size(requests)
      call read_cam_file(requests(i)%text, files(i))
      associate (file => files(i))
        if (n_cams == 0) then
          call raise(err, exit_usage, '--cam computes a cam that the data file describes in a group &cam, and it has none; '// &
                     '--help-data cam explains the group')
        else if (file%number == 0 .and. n_cams > 1) then
          call raise(err, exit_usage, 'there are '//to_text(n_cams)//' cams; tell which one by its number, as in --cam 1:'// &
                     file%path)
        else if (file%number > n_cams) then
          call raise(err, exit_usage, 'there is no cam '//to_text(file%number)//'; this file has '// &
                     counted(n_cams, 'cam'))
        else if (any(ending_of(file%path) == [character(len=4) :: 'png', 'pdf', 'gif', 'html'])) then
          call raise(err, exit_usage, "a cam is drawn into a file whose name ends in .svg, not '"//file%path//"'")
        end if
        if (allocated(err)) return
        file%number = max(1, file%number)
      end associate
    end do
  end subroutine read_files

  !> Write the table of a profile, with a row for each output at which the follower moves against the cam.
  subroutine write_profile(path, options, given, profile, err)
    character(len=*), intent(in) :: path                !< of the table; '-' is standard output
    type(command_line_type), intent(in) :: options      !< the command line
    type(data_file_type), intent(in) :: given           !< the data file
    type(recorded_cam_type), intent(in) :: profile       !< its profile
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(string_type), allocatable :: names(:), units(:)
    real(wp), allocatable :: rows(:, :)

    call profile%list_rows(given, names, units, rows)
    call save_table(path, options, given, &
                    new_heading(given%model%mechanism%title//new_line('a')//name_of_cam(given%model, profile%number), &
                                names, units), rows, err)
  end subroutine write_profile
end module mech9_cam_task
