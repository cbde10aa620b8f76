!> The drawing of a cam in its own system. It shows the profile, the pitch curve, and the circle about the axis that the
!> profile does not enter. It shows the follower where the motion begins, and the places of extreme values. Parts that
!> are undercut are red.
module mech9_cam_picture
  use mech9_units, only: units_type
  use mech9_result_units, only: length_text
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_text, only: string_type, to_text
  use mech9_rotation, only: cross
  use mech9_pose, only: default_zero
  use mech9_pair_axes, only: pair_axes_type, pair_axes, turning
  use mech9_request, only: cam_request_type
  use mech9_model, only: model_type
  use mech9_cam_profile, only: cam_profile_type
  use mech9_page, only: page_type
  use mech9_picture_style, only: style_sheet, dark_colours, light_colours, colour_of
  use mech9_title_lines, only: title_lines
  use mech9_xml_text, only: xml_text, decimal
  implicit none
  private
  public :: save_cam_picture

  !> From the plane of the cam to the page.
  type :: sheet_type
    real(wp) :: x(3) = 0.0_wp        !< direction to the right, in the cam's system
    real(wp) :: y(3) = 0.0_wp        !< direction upwards
    real(wp) :: middle(2) = 0.0_wp   !< place in the middle of the drawing, by these directions [m]
    real(wp) :: scale = 1.0_wp       !< [px/m]
  end type sheet_type

  real(wp), parameter :: width = 640.0_wp, height = 680.0_wp   !< of the page [px]
  real(wp), parameter :: margin = 56.0_wp, top = 40.0_wp       !< around the drawing, and more above it for the title [px]
  integer, parameter :: most_corners = 3000                    !< of a curve
  integer, parameter :: longest_line = 70                      !< letters of the title's lines

contains

  !> Draw a profile. Errors are exit_file.
  subroutine save_cam_picture(path, name, model, cam, profile, err)
    character(len=*), intent(in) :: path                !< of the picture
    character(len=*), intent(in) :: name                !< the cam and its follower in words
    type(model_type), intent(in) :: model               !< the model
    type(cam_request_type), intent(in) :: cam           !< the cam
    type(cam_profile_type), intent(in) :: profile       !< its profile
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    type(page_type) :: page
    type(sheet_type) :: sheet
    type(pair_axes_type), allocatable :: axes(:)
    real(wp) :: centre(3)
    logical :: turns

    axes = pair_axes(model%mechanism%pairs)
    associate (pair => axes(cam%coordinate))
      turns = pair%kind == turning
      centre = pair%points(:, merge(1, 2, pair%links(1) == cam%link))
    end associate
    call fit_sheet(cam, profile, centre, turns, sheet)
    call page%line('<?xml version="1.0" encoding="UTF-8"?>')
    call page%line('<svg xmlns="http://www.w3.org/2000/svg" class="mech9" viewBox="0 0 '//decimal(width)//' '//decimal(height)// &
                   '" width="'//decimal(width)//'" height="'//decimal(height)//'">')
    call page%line('<title>'//xml_text(model%mechanism%title//' - '//name)//'</title>')
    call page%put('<style>'//new_line('a')//style_sheet(1.0_wp))
    call page%line('</style>')
    call page%line('<rect width="100%" height="100%" fill="#ffffff"/>')
    call put_cam(cam, profile, sheet, page)
    call put_follower(cam, profile, sheet, page)
    if (turns) call put_axis(profile, centre, sheet, page)
    call put_extremes(model, profile, sheet, page)
    call put_title(model%mechanism%title, name, page)
    call put_scale(model%mechanism%units, sheet, page)
    call page%line('</svg>')
    call page%save(path, err)
  end subroutine save_cam_picture

  !> Choose the part of the plane that is drawn.
  subroutine fit_sheet(cam, profile, centre, turns, sheet)
    type(cam_request_type), intent(in) :: cam       !< the cam
    type(cam_profile_type), intent(in) :: profile   !< its profile
    real(wp), intent(in) :: centre(3)               !< a point of its axis, in its system [m]
    logical, intent(in) :: turns                    !< it turns about this axis
    type(sheet_type), intent(out) :: sheet          !< from the plane to the page
    real(wp) :: low(2), high(2), places(2, 2)
    integer :: i

    sheet%y = cross(cam%axis, default_zero(cam%axis))
    sheet%y = sheet%y/norm2(sheet%y)
    sheet%x = cross(sheet%y, cam%axis)
    low = huge(1.0_wp)
    high = -low
    do i = 1, size(profile%contacts)
      if (.not. profile%contacts(i)%known) cycle
      places(:, 1) = in_plane(sheet, profile%contacts(i)%profile)
      places(:, 2) = places(:, 1)
      if (.not. cam%flat) places(:, 2) = in_plane(sheet, profile%contacts(i)%pitch)
      low = min(low, places(:, 1), places(:, 2) - cam%roller)
      high = max(high, places(:, 1), places(:, 2) + cam%roller)
    end do
    if (turns) then
      low = min(low, in_plane(sheet, centre))
      high = max(high, in_plane(sheet, centre))
    end if
    sheet%middle = 0.5_wp*(low + high)
    sheet%scale = min((width - 2.0_wp*margin)/max(high(1) - low(1), tiny(1.0_wp)), &
                      (height - 2.0_wp*margin - top)/max(high(2) - low(2), tiny(1.0_wp)))
  end subroutine fit_sheet

  !> A point by the directions of the sheet [m].
  pure function in_plane(sheet, point) result(place)
    type(sheet_type), intent(in) :: sheet   !< from the plane to the page
    real(wp), intent(in) :: point(3)        !< in the cam's system [m]
    real(wp) :: place(2)

    place = [dot_product(sheet%x, point), dot_product(sheet%y, point)]
  end function in_plane

  !> A point as text for a path: "120.5 80".
  pure function on_page(sheet, point) result(text)
    type(sheet_type), intent(in) :: sheet   !< from the plane to the page
    real(wp), intent(in) :: point(3)        !< in the cam's system [m]
    character(len=:), allocatable :: text
    real(wp) :: place(2)

    place = sheet%scale*(in_plane(sheet, point) - sheet%middle)
    text = decimal(0.5_wp*width + place(1))//' '//decimal(0.5_wp*(height + top) - place(2))
  end function on_page

  !> Draw the profile, its undercut parts, and the pitch curve of a roller.
  subroutine put_cam(cam, profile, sheet, page)
    type(cam_request_type), intent(in) :: cam       !< the cam
    type(cam_profile_type), intent(in) :: profile   !< its profile
    type(sheet_type), intent(in) :: sheet           !< from the plane to the page
    type(page_type), intent(inout) :: page          !< gets the curves
    character(len=:), allocatable :: fill
    integer :: i, last

    last = size(profile%contacts)
    fill = 'none'
    if (profile%closed .and. .not. cam%outer) fill = light_colours(colour_of(cam%link))
    call page%put('<path id="profile" style="fill:'//fill//';stroke:'//dark_colours(colour_of(cam%link))//';stroke-width:2" d="')
    call put_curve(profile, sheet, 1, last, .false., page)
    call page%line(trim(merge('Z', ' ', profile%closed))//'"/>')
    do i = 1, size(profile%undercut, 2)
      call page%put('<path class="undercut" style="stroke:#c00000;stroke-width:3" d="')
      call put_curve(profile, sheet, profile%undercut(1, i), profile%undercut(2, i), .false., page)
      call page%line('"/>')
    end do
    if (cam%flat) return
    call page%put('<path id="pitch" style="stroke:#555555;stroke-width:1;stroke-dasharray:9 3 2 3" d="')
    call put_curve(profile, sheet, 1, last, .true., page)
    call page%line('"/>')
  end subroutine put_cam

  !> Append the corners of a part of the profile, or of the pitch curve.
  subroutine put_curve(profile, sheet, first, last, pitch, page)
    type(cam_profile_type), intent(in) :: profile   !< the profile
    type(sheet_type), intent(in) :: sheet           !< from the plane to the page
    integer, intent(in) :: first                    !< first contact of the part
    integer, intent(in) :: last                     !< its last contact
    logical, intent(in) :: pitch                    !< the pitch curve; else the profile
    type(page_type), intent(inout) :: page          !< gets the corners
    integer :: i, stride
    character :: letter

    stride = 1 + (last - first)/most_corners
    letter = 'M'
    do i = first, last
      if (.not. profile%contacts(i)%known .or. (mod(i - first, stride) > 0 .and. i < last)) cycle
      if (pitch) then
        call page%put(letter//on_page(sheet, profile%contacts(i)%pitch))
      else
        call page%put(letter//on_page(sheet, profile%contacts(i)%profile))
      end if
      letter = 'L'
    end do
  end subroutine put_curve

  !> Draw the roller, or the flat face as far as it is used, at the first contact.
  subroutine put_follower(cam, profile, sheet, page)
    type(cam_request_type), intent(in) :: cam       !< the cam
    type(cam_profile_type), intent(in) :: profile   !< its profile
    type(sheet_type), intent(in) :: sheet           !< from the plane to the page
    type(page_type), intent(inout) :: page          !< gets the follower
    character(len=:), allocatable :: colour, place
    real(wp) :: along(3), reach
    integer :: i

    colour = dark_colours(colour_of(cam%follower))
    do i = 1, size(profile%contacts)
      if (profile%contacts(i)%known) exit
    end do
    associate (contact => profile%contacts(i))
      if (cam%flat) then
        along = cross(cam%axis, contact%normal)
        reach = 0.1_wp*(maxval(profile%contacts%offset) - minval(profile%contacts%offset))
        call page%line('<path id="follower" style="stroke:'//colour//';stroke-width:3" d="M'// &
                       on_page(sheet, contact%pitch + (minval(profile%contacts%offset) - reach)*along)//'L'// &
                       on_page(sheet, contact%pitch + (maxval(profile%contacts%offset) + reach)*along)//'"/>')
        return
      end if
      place = on_page(sheet, contact%pitch)
      call page%line('<g id="follower" transform="translate('//place//')"><circle r="'// &
                     decimal(max(3.0_wp, sheet%scale*cam%roller))//'" style="fill:'//light_colours(colour_of(cam%follower))// &
                     ';stroke:'//colour//';stroke-width:1.5"/><circle r="2" style="fill:'//colour//'"/></g>')
    end associate
  end subroutine put_follower

  !> Draw the axis of the cam, and the circle about it that touches the profile from inside.
  subroutine put_axis(profile, centre, sheet, page)
    type(cam_profile_type), intent(in) :: profile   !< the profile
    real(wp), intent(in) :: centre(3)               !< a point of the axis, in the cam's system [m]
    type(sheet_type), intent(in) :: sheet           !< from the plane to the page
    type(page_type), intent(inout) :: page          !< gets the axis
    real(wp) :: radius
    integer :: i

    radius = huge(1.0_wp)
    do i = 1, size(profile%contacts)
      if (profile%contacts(i)%known) &
        radius = min(radius, norm2(in_plane(sheet, profile%contacts(i)%profile - centre)))
    end do
    call page%line('<g id="axis" transform="translate('//on_page(sheet, centre)//')"><circle r="'//decimal(sheet%scale*radius)// &
                   '" style="fill:none;stroke:#555555;stroke-dasharray:3 3"/><circle class="w" r="5"/></g>')
  end subroutine put_axis

  !> Draw dots at the greatest pressure angle and at the least radii of curvature, with their values.
  subroutine put_extremes(model, profile, sheet, page)
    type(model_type), intent(in) :: model           !< the model
    type(cam_profile_type), intent(in) :: profile   !< the profile
    type(sheet_type), intent(in) :: sheet           !< from the plane to the page
    type(page_type), intent(inout) :: page          !< gets the dots

    if (profile%has_pressure) &
      call put_dot(profile%pressure, 'pressure angle '// &
                   to_text(profile%contacts(profile%pressure)%pressure/model%mechanism%units%angle, 4)//' '// &
                   model%mechanism%units%angle_name, '-8')
    if (profile%convex > 0) &
      call put_dot(profile%convex, 'radius '//trim(length_text(model%mechanism, profile%contacts(profile%convex)%radius, 4)), '16')
    if (profile%concave > 0) then
      if (abs(profile%contacts(profile%concave)%radius) <= huge(1.0_wp)) &
        call put_dot(profile%concave, 'radius '// &
                     trim(length_text(model%mechanism, profile%contacts(profile%concave)%radius, 4)), '28')
    end if
  contains
    !> Draw one dot with its words.
    subroutine put_dot(number, words, dy)
      integer, intent(in) :: number           !< of the contact
      character(len=*), intent(in) :: words   !< the value there
      character(len=*), intent(in) :: dy      !< of the words below the dot [px]

      call page%line('<g transform="translate('//on_page(sheet, profile%contacts(number)%profile)// &
                     ')"><circle class="k" r="3"/><text class="small" style="stroke:#ffffff" text-anchor="middle" x="0" y="'// &
                     dy//'">'//words//'</text></g>')
    end subroutine put_dot
  end subroutine put_extremes

  !> Write the title of the mechanism, and the cam below it.
  subroutine put_title(title, name, page)
    character(len=*), intent(in) :: title    !< title of the mechanism, any text
    character(len=*), intent(in) :: name     !< the cam and its follower in words
    type(page_type), intent(inout) :: page   !< gets the lines
    type(string_type), allocatable :: lines(:)

    lines = title_lines(title, longest_line, 1)
    call page%line('<text class="title" x="14" y="24">'//xml_text(lines(1)%text)//'</text>')
    call page%line('<text class="small" x="14" y="42">'//xml_text(name)//'</text>')
  end subroutine put_title

  !> Draw a bar of a round length.
  subroutine put_scale(units, sheet, page)
    type(units_type), intent(in) :: units    !< of the data file, in which the length is round
    type(sheet_type), intent(in) :: sheet    !< from the plane to the page
    type(page_type), intent(inout) :: page   !< gets the bar
    real(wp) :: length, wanted

    wanted = 100.0_wp/sheet%scale/units%length
    length = 10.0_wp**floor(log10(wanted))
    if (5.0_wp*length <= wanted) then
      length = 5.0_wp*length
    else if (2.0_wp*length <= wanted) then
      length = 2.0_wp*length
    end if
    call page%line('<g id="scale"><path stroke="#222" stroke-width="1.5" d="M14 '//decimal(height - 22.0_wp)//'v5h'// &
                   decimal(length*units%length*sheet%scale)//'v-5"/><text class="small" x="'// &
                   decimal(22.0_wp + length*units%length*sheet%scale)// &
                   '" y="'//decimal(height - 14.0_wp)//'">'//to_text(length)//' '//trim(units%length_name)//'</text></g>')
  end subroutine put_scale
end module mech9_cam_picture
