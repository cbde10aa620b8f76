!> The profile of a cam as rows of a table.
module mech9_cam_rows
  use mech9_kinds, only: wp
  use mech9_text, only: string_type, to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_request, only: cam_request_type
  use mech9_result_units, only: unit_of, unit_name
  use mech9_cam_profile, only: cam_profile_type
  implicit none
  private
  public :: list_cam_rows

  character, parameter :: directions(3) = ['x', 'y', 'z']

contains

  !> List the columns of a profile, and a row for each output at which the follower moves against the cam.
  subroutine list_cam_rows(mechanism, cam, profile, names, units, rows)
    type(mechanism_type), intent(in) :: mechanism             !< the mechanism
    type(cam_request_type), intent(in) :: cam                 !< the cam
    type(cam_profile_type), intent(in) :: profile             !< its profile
    type(string_type), allocatable, intent(out) :: names(:)   !< (columns) headings
    type(string_type), allocatable, intent(out) :: units(:)   !< (columns) their units
    real(wp), allocatable, intent(out) :: rows(:, :)          !< (columns,rows)
    integer, allocatable :: shown(:)
    integer :: i, n

    call list_columns(mechanism, cam, profile%has_pressure, names, units)
    shown = pack([(i, i=1, size(profile%contacts))], profile%at_output .and. profile%contacts%known)
    allocate (rows(size(names), size(shown)))
    do i = 1, size(shown)
      associate (contact => profile%contacts(shown(i)), length => mechanism%units%length)
        rows(:10, i) = [contact%t, contact%angle/unit_of(mechanism, cam%coordinate), contact%profile/length, contact%pitch/length, &
                        contact%radius/length, merge(1.0_wp, 0.0_wp, contact%undercut)]
        n = 10
        if (profile%has_pressure) then
          n = n + 1
          rows(n, i) = contact%pressure/mechanism%units%angle
        end if
        if (cam%flat) rows(n + 1, i) = contact%offset/length
      end associate
    end do
  end subroutine list_cam_rows

  !> List the columns of the table.
  subroutine list_columns(mechanism, cam, has_pressure, names, units)
    type(mechanism_type), intent(in) :: mechanism             !< the mechanism
    type(cam_request_type), intent(in) :: cam                 !< the cam
    logical, intent(in) :: has_pressure                       !< the pressure angles are known
    type(string_type), allocatable, intent(out) :: names(:)   !< headings of the columns
    type(string_type), allocatable, intent(out) :: units(:)   !< their units
    integer :: i, n

    allocate (names(10 + count([has_pressure, cam%flat])), units(10 + count([has_pressure, cam%flat])))
    do i = 1, size(units)
      units(i)%text = trim(mechanism%units%length_name)
    end do
    names(1)%text = 't'
    units(1)%text = 's'
    names(2)%text = 'q'//to_text(cam%coordinate)
    units(2)%text = trim(unit_name(mechanism, cam%coordinate))
    do i = 1, 3
      names(2 + i)%text = 'profile.'//directions(i)
      names(5 + i)%text = 'pitch.'//directions(i)
    end do
    names(9)%text = 'radius'
    names(10)%text = 'undercut'
    units(10)%text = ''
    n = 10
    if (has_pressure) then
      n = n + 1
      names(n)%text = 'pressure_angle'
      units(n)%text = mechanism%units%angle_name
    end if
    if (cam%flat) names(n + 1)%text = 'offset'
  end subroutine list_columns
end module mech9_cam_rows
