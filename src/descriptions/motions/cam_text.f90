!> Cams in words: the lines about a profile, and the reasons why there is none.
module mech9_cam_text
  use mech9_named_words, only: with_names, named_number
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_data
  use mech9_text, only: to_text
  use mech9_counted, only: counted
  use mech9_model, only: model_type
  use mech9_result_units, only: unit_of, unit_name, length_text
  use mech9_cam_contact, only: cam_contact_type
  use mech9_cam_profile, only: cam_profile_type
  use mech9_law_notes, only: print_jumps
  implicit none
  private
  public :: print_cam, judge_cam, name_of_cam

  integer, parameter :: digits = 7        !< significant digits of extreme values
  integer, parameter :: most_ranges = 6   !< ranges of undercut that are listed

contains

  !> A cam and its follower: "cam 1: link 2, and a roller of radius 0.01 m on link 3".
  function name_of_cam(model, number) result(name)
    type(model_type), intent(in) :: model   !< the model
    integer, intent(in) :: number           !< of the cam
    character(len=:), allocatable :: name

    associate (cam => model%request%cams(number))
      name = 'cam '//to_text(number)//': link '//to_text(cam%link)
      if (cam%flat) then
        name = name//', and a flat face on link '
      else if (cam%roller > 0.0_wp) then
        name = name//', and a roller of radius '//to_text(cam%roller/model%mechanism%units%length)//' '// &
               trim(model%mechanism%units%length_name)//' on link '
      else
        name = name//', and an edge on link '
      end if
      name = with_names(model%mechanism%names, name//to_text(cam%follower))
    end associate
  end function name_of_cam

  !> Fail where the motion of the follower determines no profile (exit_data).
  subroutine judge_cam(model, number, profile, err)
    type(model_type), intent(in) :: model               !< the model
    integer, intent(in) :: number                       !< of the cam
    type(cam_profile_type), intent(in) :: profile       !< its profile
    type(error_type), allocatable, intent(out) :: err   !< allocated if there is none
    character(len=:), allocatable :: cam, motion

    cam = 'cam '//to_text(number)
    if (profile%off_plane > 0) then
      associate (contact => profile%contacts(profile%off_plane))
        if (profile%deviation > 0.0_wp) then
          call raise(err, exit_data, cam//' is not plane: its follower moves by '// &
                     trim(length_text(model%mechanism, profile%deviation, 3))// &
                     ' along the axis of the cam up to t = '//to_text(contact%t)//' s; check ''axis'' and ''point'' of the cam')
        else
          call raise(err, exit_data, cam//' is not plane: the flat face of its follower is not parallel to the axis of the cam '// &
                     'at t = '//to_text(contact%t)//' s; check ''axis'' and ''face'' of the cam')
        end if
      end associate
    else if (.not. any(profile%contacts%known)) then
      associate (request => model%request%cams(number))
        if (request%flat) then
          motion = 'the flat face of link '//to_text(request%follower)//' does not turn'
        else if (request%roller > 0.0_wp) then
          motion = 'the centre of the roller on link '//to_text(request%follower)//' does not move'
        else
          motion = 'the edge on link '//to_text(request%follower)//' does not move'
        end if
        call raise(err, exit_data, cam//' has no profile: '//motion//' against the cam, which is link '//to_text(request%link)// &
                   '; check ''link'', ''follower'', ''point'' and the drives of both links')
      end associate
    end if
  end subroutine judge_cam

  !> Write the lines about a profile.
  subroutine print_cam(unit, model, number, profile)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    type(model_type), intent(in) :: model           !< the model
    integer, intent(in) :: number                   !< of the cam
    type(cam_profile_type), intent(in) :: profile   !< its profile
    integer :: n

    n = count(profile%at_output .and. profile%contacts%known)
    write (unit, '(a)') name_of_cam(model, number)
    write (unit, '(a)') '  profile: '//counted(n, 'point')//', '//trim(merge('closed', 'open  ', profile%closed))
    if (profile%resting > 0) &
      write (unit, '(a)') '  at '//counted(profile%resting, 'output')//' the follower rests against the cam; no points there'
    if (profile%has_pressure) then
      write (unit, '(a)') '  greatest pressure angle: '// &
        angle_of(profile%contacts(profile%pressure)%pressure)//place_of(profile%contacts(profile%pressure))
    else
      write (unit, '(a)') '  pressure angle: not known, since no pair alone guides the follower; ''guide'' can name one'
    end if
    if (profile%convex > 0) call print_radius('convex', profile%contacts(profile%convex))
    if (profile%concave > 0) call print_radius('concave', profile%contacts(profile%concave))
    if (model%request%cams(number)%flat) &
      write (unit, '(a)') '  contact on the face: from '// &
        to_text(minval(profile%contacts%offset, profile%contacts%known)/model%mechanism%units%length, digits)//' to '// &
        trim(length_text(model%mechanism, maxval(profile%contacts%offset, profile%contacts%known), digits))//' from its point'
    call print_undercut(unit, model, number, profile)
    call print_jumps(unit, model)
  contains
    !> Print the least radius of curvature of one kind.
    subroutine print_radius(kind, contact)
      character(len=*), intent(in) :: kind              !< convex or concave
      type(cam_contact_type), intent(in) :: contact     !< the contact with this radius

      if (abs(contact%radius) <= huge(1.0_wp)) then
        write (unit, '(a)') '  least radius of curvature, '//kind//': '// &
          trim(length_text(model%mechanism, abs(contact%radius), digits))//place_of(contact)
      else
        write (unit, '(a)') '  no '//trim(merge('convex', 'curved', profile%concave > 0))//' part: the profile is straight'// &
          trim(merge(' or concave', '           ', profile%concave > 0))
      end if
    end subroutine print_radius

    !> An angle in the unit of the data file.
    function angle_of(angle) result(text)
      real(wp), intent(in) :: angle   !< [rad]
      character(len=:), allocatable :: text

      text = to_text(angle/model%mechanism%units%angle, digits)//' '//model%mechanism%units%angle_name
    end function angle_of

    !> The position of a contact: " at q1 = 1.5 rad (t = 0.2 s)".
    function place_of(contact) result(text)
      type(cam_contact_type), intent(in) :: contact   !< the contact
      character(len=:), allocatable :: text

      associate (k => model%request%cams(number)%coordinate)
        text = ' at q'//named_number(model%mechanism%names%coordinates, k)//' = '// &
               to_text(contact%angle/unit_of(model%mechanism, k))//' '// &
               trim(unit_name(model%mechanism, k))//' (t = '//to_text(contact%t)//' s)'
      end associate
    end function place_of
  end subroutine print_cam

  !> Write whether and where the profile is undercut.
  subroutine print_undercut(unit, model, number, profile)
    integer, intent(in) :: unit                     !< Fortran unit to write to
    type(model_type), intent(in) :: model           !< the model
    integer, intent(in) :: number                   !< of the cam
    type(cam_profile_type), intent(in) :: profile   !< its profile
    integer :: i

    if (size(profile%undercut, 2) == 0) then
      write (unit, '(a)') '  undercut: none'
      return
    end if
    do i = 1, min(size(profile%undercut, 2), most_ranges)
      call print_range(profile%contacts(profile%undercut(1, i)), profile%contacts(profile%undercut(2, i)))
    end do
    if (size(profile%undercut, 2) > most_ranges) &
      write (unit, '(a)') '  undercut: in '//counted(size(profile%undercut, 2) - most_ranges, 'further range')
    write (unit, '(a)') '  a cam cut by such a '//trim(merge('flat tool', 'roller   ', model%request%cams(number)%flat))// &
      ' does not move its follower as asked: take a larger base circle'// &
      trim(merge(' or a smaller roller', '                    ', model%request%cams(number)%roller > 0.0_wp))
  contains
    !> Print one range.
    subroutine print_range(first, last)
      type(cam_contact_type), intent(in) :: first   !< its first contact
      type(cam_contact_type), intent(in) :: last    !< its last contact

      associate (k => model%request%cams(number)%coordinate)
        write (unit, '(a)') '  undercut: from q'//named_number(model%mechanism%names%coordinates, k)//' = '// &
          to_text(first%angle/unit_of(model%mechanism, k))//' to '// &
          to_text(last%angle/unit_of(model%mechanism, k))//' '//trim(unit_name(model%mechanism, k))//' (t = '// &
          to_text(first%t)//' to '//to_text(last%t)//' s)'
      end associate
    end subroutine print_range
  end subroutine print_undercut
end module mech9_cam_text
