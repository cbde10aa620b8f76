!> A cam in the report of a run, for programs: the values that the lines about its profile tell, and more of their digits.
module mech9_cam_report
  use mech9_kinds, only: wp
  use mech9_json, only: json_type
  use mech9_model, only: model_type
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning
  use mech9_request, only: cam_request_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_cam_contact, only: cam_contact_type
  use mech9_cam_profile, only: cam_profile_type
  implicit none
  private
  public :: add_cam

contains

  !> Add the values of a cam to an object. Values that it does not have are left out: a radius where no part is convex, a contact without a face.
  subroutine add_cam(json, model, number, profile)
    type(json_type), intent(inout) :: json          !< the report, in the object of this cam
    type(model_type), intent(in) :: model           !< the model
    integer, intent(in) :: number                   !< of the cam
    type(cam_profile_type), intent(in) :: profile   !< its profile
    integer :: i

    associate (cam => model%request%cams(number), contacts => profile%contacts, length => model%mechanism%units%length)
      call json%add('cam', number)
      call json%add('link', cam%link)
      call json%add('follower', cam%follower)
      if (.not. cam%flat) call json%add('roller', cam%roller/length)
      call json%add('coordinate', cam%coordinate)
      call json%add('coordinate_unit', trim(unit_name(model%mechanism, cam%coordinate)))
      if (model%mechanism%units%length_name /= 'm') call json%add('length_unit', trim(model%mechanism%units%length_name))
      call json%add('angle_unit', model%mechanism%units%angle_name)
      call json%add('points', count(profile%at_output .and. contacts%known))
      call json%add('closed', profile%closed)
      call json%add('outputs_at_rest', profile%resting)
      call add_pitch(json, model, cam, profile)
      if (profile%has_pressure) call add_extreme('greatest_pressure_angle', contacts(profile%pressure), &
                                                 contacts(profile%pressure)%pressure/model%mechanism%units%angle)
      if (profile%convex > 0) &
        call add_extreme('least_convex_radius', contacts(profile%convex), contacts(profile%convex)%radius/length)
      if (profile%concave > 0) &
        call add_extreme('least_concave_radius', contacts(profile%concave), abs(contacts(profile%concave)%radius)/length)
      if (cam%flat) call json%add('contact_on_face', [minval(contacts%offset, contacts%known), &
                                                      maxval(contacts%offset, contacts%known)]/length)
      call json%begin_array('undercut')
      do i = 1, size(profile%undercut, 2)
        call json%begin_object()
        call add_place('from', contacts(profile%undercut(1, i)))
        call add_place('to', contacts(profile%undercut(2, i)))
        call json%end_object()
      end do
      call json%end_array()
    end associate
  contains
    !> Add an extreme value with its place.
    subroutine add_extreme(name, contact, value)
      character(len=*), intent(in) :: name              !< name in the report
      type(cam_contact_type), intent(in) :: contact     !< the contact with this value
      real(wp), intent(in) :: value                     !< [m or unit of angles]; infinite where all is straight, null in the report

      call json%begin_object(name)
      call json%add('value', value)
      call add_position(contact)
      call json%end_object()
    end subroutine add_extreme

    !> Add a place along the profile.
    subroutine add_place(name, contact)
      character(len=*), intent(in) :: name              !< name in the report
      type(cam_contact_type), intent(in) :: contact     !< the contact

      call json%begin_object(name)
      call add_position(contact)
      call json%end_object()
    end subroutine add_place

    !> Add the coordinate of the cam and the time.
    subroutine add_position(contact)
      type(cam_contact_type), intent(in) :: contact     !< the contact

      call json%add('q', contact%angle/unit_of(model%mechanism, model%request%cams(number)%coordinate))
      call json%add('t', contact%t)
    end subroutine add_position
  end subroutine add_cam

  !> Add the least and the largest distance of the pitch curve from the axis about which the cam turns.
  subroutine add_pitch(json, model, cam, profile)
    type(json_type), intent(inout) :: json          !< the report
    type(model_type), intent(in) :: model           !< the model
    type(cam_request_type), intent(in) :: cam       !< the cam
    type(cam_profile_type), intent(in) :: profile   !< its profile
    type(pair_axes_type), allocatable :: axes(:)
    real(wp) :: distances(size(profile%contacts)), arm(3)
    integer :: i

    axes = pair_axes(model%mechanism%pairs)
    associate (pair => axes(cam%coordinate))
      if (cam%flat .or. pair%kind /= turning) return
      do i = 1, size(distances)
        arm = profile%contacts(i)%pitch - pair%points(:, merge(1, 2, pair%links(1) == cam%link))
        distances(i) = norm2(arm - dot_product(arm, cam%axis)*cam%axis)
      end do
    end associate
    call json%begin_object('pitch_curve')
    call json%add('least_distance', minval(distances)/model%mechanism%units%length)
    call json%add('largest_distance', maxval(distances)/model%mechanism%units%length)
    call json%end_object()
  end subroutine add_pitch
end module mech9_cam_report
