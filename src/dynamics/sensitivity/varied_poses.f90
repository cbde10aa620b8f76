!> The exact derivatives of the poses of links by all parameters.
module mech9_varied_poses
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross
  use mech9_frame_motion, only: link_motion
  use mech9_twists, only: shift_at
  use mech9_varied_motion, only: varied_motion_type, link_twists
  implicit none
  private
  public :: find_varied_poses

contains

  !> Find the derivatives of the first links' origins, then those of their rotations by rows, in the system of link 1.
  subroutine find_varied_poses(motion, changes)
    type(varied_motion_type), intent(in) :: motion     !< derivatives of the motion
    real(wp), intent(out) :: changes(:, :)             !< (P,12 links) [m, 1]
    real(wp) :: twists(motion%n_parameters, 6, 0:2), r(3, 3), p(3), omega(3), v(3), turned(3, 3)
    integer :: links, link, i, j, at

    links = size(changes, 2)/12
    do link = 1, links
      call link_twists(motion, link, twists)
      call link_motion(motion%plan, motion%state, link, r, p, omega, v)
      at = 3*links + 9*(link - 1)
      do i = 1, motion%n_parameters
        changes(i, 3*link - 2:3*link) = shift_at(twists(i, :, 0), p - motion%plan%origin)
        do j = 1, 3
          turned(:, j) = cross(twists(i, 1:3, 0), r(:, j))
        end do
        changes(i, at + 1:at + 9) = reshape(transpose(turned), [9])
      end do
    end do
  end subroutine find_varied_poses
end module mech9_varied_poses
