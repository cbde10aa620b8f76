!> The profile of a cam as the library's users find it.
module mech9_recorded_cam
  use mech9_program_kind, only: kinematics
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_usage
  use mech9_text, only: string_type, texts_of_one_length, to_text
  use mech9_counted, only: counted
  use mech9_json, only: json_type
  use mech9_model, only: model_type
  use mech9_cam_profile, only: cam_profile_type, find_profile
  use mech9_cam_rows, only: list_cam_rows
  use mech9_cam_text, only: judge_cam
  use mech9_report_parts, only: add_part_names
  use mech9_cam_report, only: add_cam
  use mech9_model_motion, only: model_motion_type
  use mech9_data_file, only: data_file_type
  use mech9_checked_mechanism, only: checked_mechanism_type
  implicit none
  private
  public :: find_cam, recorded_cam_type

  !> The profile of a cam of a data file.
  type, extends(cam_profile_type) :: recorded_cam_type
    integer :: number = 0    !< of the cam, in the order of the groups
  contains
    procedure :: find
    procedure :: list_rows
  end type recorded_cam_type

contains

  !> Find the profile of a cam: the rows of its table, and its entry in a report. Fails with exit_usage where there is no such cam,
  !> with exit_data where there is no profile, and as a driven run does.
  subroutine find_cam(mechanism, number, names, units, rows, report, err)
    type(checked_mechanism_type), intent(in) :: mechanism          !< with drives and groups &cam
    integer, intent(in) :: number                                  !< of the cam, in the order of the groups
    character(len=:), allocatable, intent(out) :: names(:)         !< (columns) as --cam writes them
    character(len=:), allocatable, intent(out) :: units(:)         !< (columns)
    real(wp), allocatable, intent(out) :: rows(:, :)               !< (columns,rows); none after a failure
    character(len=:), allocatable, intent(out) :: report           !< JSON, as in the list `cams` of a report, with names
    type(error_type), allocatable, intent(out) :: err              !< allocated if it failed
    type(model_type), target :: model
    type(model_motion_type), target :: motion
    type(cam_profile_type) :: profile
    type(string_type), allocatable :: texts(:), of_units(:)
    type(json_type) :: json

    report = ''
    call mechanism%take_request(kinematics, model, err)
    if (.not. allocated(err)) then
      if (number < 1 .or. number > size(model%request%cams)) call raise(err, exit_usage, 'there is no cam '//to_text(number)// &
        '; this mechanism has '//counted(size(model%request%cams), 'cam')//' (groups &cam)')
    end if
    if (.not. allocated(err)) call motion%assemble(model, err)
    if (.not. allocated(err)) then
      call find_profile(model, motion%plan, motion%start, model%request%cams(number), profile, err)
      if (.not. allocated(err)) call judge_cam(model, number, profile, err)
      call add_place(err, place=model%request%cams(number)%place)
    end if
    if (allocated(err)) then
      allocate (texts(0), of_units(0), rows(0, 0))
    else
      call list_cam_rows(model%mechanism, model%request%cams(number), profile, texts, of_units, rows)
      call json%begin_object()
      call add_part_names(json, model)
      call add_cam(json, model, number, profile)
      call json%end_object()
      call json%take_text(report)
    end if
    call texts_of_one_length(texts, names)
    call texts_of_one_length(of_units, units)
    call mechanism%point_at(err)
  end subroutine find_cam

  !> Find the profile of a cam. Fails with exit_data where there is none, and as a driven run does.
  subroutine find(self, given, number, err)
    class(recorded_cam_type), intent(inout) :: self        !< gets the profile
    class(data_file_type), intent(in), target :: given     !< the data file, with its motion assembled
    integer, intent(in) :: number                          !< of the cam, which there is
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed

    self%number = number
    associate (cam => given%model%request%cams(number), motion => given%run%motion)
      call find_profile(given%model, motion%plan, motion%start, cam, self%cam_profile_type, err)
      if (.not. allocated(err)) call judge_cam(given%model, number, self%cam_profile_type, err)
      call add_place(err, place=cam%place)
    end associate
  end subroutine find

  !> List the rows of its table, with a row for each output at which the follower moves against the cam.
  subroutine list_rows(self, given, names, units, rows)
    class(recorded_cam_type), intent(in) :: self               !< the profile
    class(data_file_type), intent(in) :: given                 !< the data file
    type(string_type), allocatable, intent(out) :: names(:)    !< (columns)
    type(string_type), allocatable, intent(out) :: units(:)    !< (columns)
    real(wp), allocatable, intent(out) :: rows(:, :)           !< (columns,rows)

    call list_cam_rows(given%model%mechanism, given%model%request%cams(self%number), self%cam_profile_type, names, units, rows)
  end subroutine list_rows
end module mech9_recorded_cam
