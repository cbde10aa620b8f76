!> Articulated bodies of a closed cluster whose links move in one plane, while the plane moves in space with the base of the
!> cluster.
!>
!> Columns, the coefficients A and the forces on the coordinates are those of mech9_planar_cluster. Wrenches out of the
!> plane act on the base alone: the inertia of all bodies together, as one rigid body, and the torque by which each
!> column tilts the plane. All vectors are in the plane's axes, the third of which is the normal, and are turned into
!> fixed axes for the base.
module mech9_moving_plane
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back
  use mech9_articulated_bodies, only: body_wrench, set_rigid_body, in_fixed_axes
  use mech9_planar_cluster, only: add_column
  implicit none
  private
  public :: plane_body_type, plane_motion_type, add_to_plane, seen_motion, gather_bodies

  !> The bodies of one frame together, in its planar frame.
  type :: plane_body_type
    real(wp) :: mass = 0.0_wp          !< [kg]
    real(wp) :: moment(3) = 0.0_wp     !< mass times centre, from the frame's origin [kg m]
    real(wp) :: tensor(3, 3) = 0.0_wp  !< inertia about the frame's origin [kg m^2]
  end type plane_body_type

  !> The motion of a plane, which is that of its base, in its own axes; accelerations are those that rates alone give.
  type :: plane_motion_type
    real(wp) :: axes(3, 3) = 0.0_wp   !< turns components in the plane's axes into those in fixed axes
    real(wp) :: omega(3) = 0.0_wp     !< angular velocity [rad/s]
    real(wp) :: alpha(3) = 0.0_wp     !< angular acceleration [rad/s^2]
    real(wp) :: proper(3) = 0.0_wp    !< proper acceleration of the plane's origin: less that of free fall [m/s^2]
  end type plane_motion_type

contains

  !> Add a body to those of its frame.
  pure subroutine add_to_plane(total, mass, centre, inertia)
    type(plane_body_type), intent(inout) :: total   !< the bodies of the frame
    real(wp), intent(in) :: mass                    !< of the body [kg]
    real(wp), intent(in) :: centre(3)               !< mass centre, from the frame's origin, in the planar frame's axes [m]
    real(wp), intent(in) :: inertia(3, 3)           !< tensor about the centre, in the planar frame's axes [kg m^2]
    integer :: i

    total%mass = total%mass + mass
    total%moment = total%moment + mass*centre
    do i = 1, 3
      total%tensor(:, i) = total%tensor(:, i) + inertia(:, i) - mass*centre*centre(i)
      total%tensor(i, i) = total%tensor(i, i) + mass*dot_product(centre, centre)
    end do
  end subroutine add_to_plane

  !> The motion of a plane in its own axes, from that of its base in fixed axes.
  pure function seen_motion(axes, omega, alpha, a, gravity) result(plane)
    real(wp), intent(in) :: axes(3, 3)   !< axes of the plane, in fixed axes
    real(wp), intent(in) :: omega(3)     !< angular velocity of its base, fixed axes [rad/s]
    real(wp), intent(in) :: alpha(3)     !< angular acceleration of the base that rates alone give, fixed axes [rad/s^2]
    real(wp), intent(in) :: a(3)         !< acceleration of the plane's origin that rates alone give, fixed axes [m/s^2]
    real(wp), intent(in) :: gravity(3)   !< acceleration of free fall, fixed axes [m/s^2]
    type(plane_motion_type) :: plane

    plane%axes = axes
    plane%omega = turn_back(axes, omega)
    plane%alpha = turn_back(axes, alpha)
    plane%proper = turn_back(axes, a - gravity)
  end function seen_motion

  !> Begin the sums of mech9_cluster_bodies with the bodies of those frames of a cluster that carry nothing else, and add these
  !> bodies to the inertia and the wrench of its base.
  pure subroutine gather_bodies(n, n_frames, frames, bodies, plane, base, place, m, n_entries, first, local, s, f, height, v, &
                                a, inertia, wrench, amount, factors, column, rest, rigid)
    integer, intent(in) :: n                              !< number of independent coordinates of the cluster
    integer, intent(in) :: n_frames                       !< number of these frames
    integer, intent(in) :: frames(n_frames)               !< these frames
    type(plane_body_type), intent(in) :: bodies(n_frames) !< their bodies
    type(plane_motion_type), intent(in) :: plane          !< the motion of the plane
    integer, intent(in) :: base                           !< frame on which the cluster stands; nothing passes to frame 0
    integer, intent(in) :: place                          !< the number of that frame in the plane, 0 for the base of the plane
    integer, intent(in) :: m                              !< number of steps of the plan
    integer, intent(in) :: n_entries                      !< number of entries of all frames
    integer, intent(in) :: first(0:m + 1)                 !< first entry of each frame
    integer, intent(in) :: local(n_entries)               !< place of each entry's coordinate in the cluster
    real(wp), intent(in) :: s(3, n_entries)               !< angular velocity, velocity of the origin per unit rate, relative to it
    real(wp), intent(in) :: f(4, 0:m)                     !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: height(0:m)                   !< of each frame's origin above that of the plane [m]
    real(wp), intent(in) :: v(3, 0:m)                     !< velocity of each frame in the plane [rad/s, m/s]
    real(wp), intent(in) :: a(3, 0:m)                     !< acceleration in the plane that rates alone give [rad/s^2, m/s^2]
    real(wp), intent(inout) :: inertia(3, 9)              !< J, H, M of the base, fixed axes
    real(wp), intent(inout) :: wrench(6)                  !< torque and force on the base, fixed axes [N m, N]
    real(wp), intent(inout) :: amount(5)                  !< mass, moment and sum of m r^2 of the base, fixed axes
    real(wp), intent(inout) :: factors(n, n)              !< A, lower triangle
    real(wp), intent(inout) :: column(6, n)               !< zero in; U out, fixed axes
    real(wp), intent(inout) :: rest(n)                    !< Q - S^T p
    real(wp), intent(inout) :: rigid(n)                   !< bound of the diagonal of A, as if rigid
    type(plane_body_type) :: total
    real(wp) :: h(3), j(3, 3), required(6), resultant(6), in_plane(6), extent(4), mass, x, y, z
    integer :: i, k, e, c

    resultant = 0.0_wp
    do i = 1, n_frames
      k = frames(i)
      mass = bodies(i)%mass
      call carry_body(bodies(i), plane, f(:, k), height(k), v(:, k), a(:, k), h, j, required)
      in_plane = [j(3, 3), -h(2), h(1), mass, 0.0_wp, mass]
      extent = [mass, h(1), h(2), j(3, 3)]
      x = f(3, k) - f(3, place)
      y = f(4, k) - f(4, place)
      z = height(k) - height(place)
      do e = first(k), first(k + 1) - 1
        c = local(e)
        call add_column(n, c, e, first(k + 1) - 1, n_entries, local, s, in_plane, required(3:5), extent, x, y, factors, &
                        column(3:5, c), rest(c), rigid(c))
        column(1, c) = column(1, c) + j(1, 3)*s(1, e) - h(3)*s(3, e) - z*(mass*s(3, e) + h(1)*s(1, e))
        column(2, c) = column(2, c) + j(2, 3)*s(1, e) + h(3)*s(2, e) + z*(mass*s(2, e) - h(2)*s(1, e))
      end do
      if (base == 0) cycle
      call add_as_rigid(mass, h, j, [x, y, z], total)
      resultant(1) = resultant(1) + required(1) + y*required(6) - z*required(5)
      resultant(2) = resultant(2) + required(2) + z*required(4) - x*required(6)
      resultant(3) = resultant(3) + required(3) + x*required(5) - y*required(4)
      resultant(4:6) = resultant(4:6) + required(4:6)
    end do
    if (base > 0) call pass_to_base(n, plane%axes, total, resultant, inertia, wrench, amount, column)
  end subroutine gather_bodies

  !> Add the inertia and the wrench of the bodies to those of the base, in fixed axes.
  pure subroutine pass_to_base(n, axes, total, resultant, inertia, wrench, amount, column)
    integer, intent(in) :: n                      !< number of independent coordinates of the cluster
    real(wp), intent(in) :: axes(3, 3)            !< axes of the plane, in fixed axes
    type(plane_body_type), intent(in) :: total    !< the bodies together, about the base's origin, in the plane's axes
    real(wp), intent(in) :: resultant(6)          !< their wrench about that origin, in the plane's axes [N m, N]
    real(wp), intent(inout) :: inertia(3, 9)      !< J, H, M of the base, fixed axes
    real(wp), intent(inout) :: wrench(6)          !< torque and force on the base, fixed axes [N m, N]
    real(wp), intent(inout) :: amount(5)          !< mass, moment and sum of m r^2 of the base, fixed axes
    real(wp), intent(inout) :: column(6, n)       !< U in the plane's axes in, in fixed axes out
    real(wp) :: rigid(3, 9), extent(5)
    integer :: c

    do c = 1, n
      column(1:3, c) = turn(axes, column(1:3, c))
      column(4:6, c) = column(4, c)*axes(:, 1) + column(5, c)*axes(:, 2)
    end do
    wrench(1:3) = wrench(1:3) + turn(axes, resultant(1:3))
    wrench(4:6) = wrench(4:6) + turn(axes, resultant(4:6))
    call set_rigid_body(total%mass, turn(axes, total%moment), in_fixed_axes(axes, total%tensor), rigid, extent)
    inertia = inertia + rigid
    amount = amount + extent
  end subroutine pass_to_base

  !> Mass moment and inertia of the bodies of a frame, and the wrench that they require for the motion by rates alone, less their
  !> weight, about the origin of the frame, in the plane's axes.
  pure subroutine carry_body(body, plane, f, height, v, a, h, j, wrench)
    type(plane_body_type), intent(in) :: body      !< the bodies
    type(plane_motion_type), intent(in) :: plane   !< the motion of the plane
    real(wp), intent(in) :: f(4)                   !< pose of the frame: cosine, sine, origin [m]
    real(wp), intent(in) :: height                 !< of its origin above that of the plane [m]
    real(wp), intent(in) :: v(3)                   !< velocity of the frame in the plane [rad/s, m/s]
    real(wp), intent(in) :: a(3)                   !< its acceleration in the plane that rates alone give [rad/s^2, m/s^2]
    real(wp), intent(out) :: h(3)                  !< mass moment [kg m]
    real(wp), intent(out) :: j(3, 3)               !< inertia [kg m^2]
    real(wp), intent(out) :: wrench(6)             !< torque and force [N m, N]
    real(wp) :: omega(3), alpha(3), proper(3), slip(3), square, double, mixed

    associate (c => f(1), s => f(2), t => body%tensor)
      h(1) = c*body%moment(1) - s*body%moment(2)
      h(2) = s*body%moment(1) + c*body%moment(2)
      h(3) = body%moment(3)
      square = s*s
      double = 2.0_wp*c*s*t(2, 1)
      mixed = square*(t(2, 2) - t(1, 1)) - double
      j(1, 1) = t(1, 1) + mixed
      j(2, 2) = t(2, 2) - mixed
      j(2, 1) = c*s*(t(1, 1) - t(2, 2)) + (1.0_wp - 2.0_wp*square)*t(2, 1)
      j(3, 1) = c*t(3, 1) - s*t(3, 2)
      j(3, 2) = s*t(3, 1) + c*t(3, 2)
      j(3, 3) = t(3, 3)
      j(1, 2) = j(2, 1)
      j(1, 3) = j(3, 1)
      j(2, 3) = j(3, 2)
    end associate
    associate (turning => plane%omega)
      omega = [turning(1), turning(2), turning(3) + v(1)]
      alpha = [plane%alpha(1) + v(1)*turning(2), plane%alpha(2) - v(1)*turning(1), plane%alpha(3) + a(1)]
      slip(1) = turning(2)*height - turning(3)*f(4) + 2.0_wp*v(2)
      slip(2) = turning(3)*f(3) - turning(1)*height + 2.0_wp*v(3)
      slip(3) = turning(1)*f(4) - turning(2)*f(3)
      proper(1) = plane%proper(1) + a(2) + plane%alpha(2)*height - plane%alpha(3)*f(4) + turning(2)*slip(3) - turning(3)*slip(2)
      proper(2) = plane%proper(2) + a(3) + plane%alpha(3)*f(3) - plane%alpha(1)*height + turning(3)*slip(1) - turning(1)*slip(3)
      proper(3) = plane%proper(3) + plane%alpha(1)*f(4) - plane%alpha(2)*f(3) + turning(1)*slip(2) - turning(2)*slip(1)
    end associate
    call body_wrench(body%mass, h, j, omega, alpha, proper, wrench)
  end subroutine carry_body

  !> Add the bodies of a frame to a rigid body with another origin: J' = J + (2 h . arm + m arm^2) 1 - h arm^T - arm h^T - m arm arm^T.
  pure subroutine add_as_rigid(mass, h, j, arm, total)
    real(wp), intent(in) :: mass                    !< of the bodies [kg]
    real(wp), intent(in) :: h(3)                    !< their mass moment about the frame's origin [kg m]
    real(wp), intent(in) :: j(3, 3)                 !< their inertia about the frame's origin [kg m^2]
    real(wp), intent(in) :: arm(3)                  !< from the other origin to that of the frame [m]
    type(plane_body_type), intent(inout) :: total   !< the rigid body
    real(wp) :: mean(3), moment(3), diagonal
    integer :: i, k

    moment = h + mass*arm
    ! h arm^T + arm h^T + m arm arm^T is the symmetric product of 2 h + m arm and arm
    mean = h + 0.5_wp*mass*arm
    diagonal = 2.0_wp*dot_product(mean, arm)
    do k = 1, 3
      do i = 1, 3
        total%tensor(i, k) = total%tensor(i, k) + j(i, k) - mean(i)*arm(k) - arm(i)*mean(k)
      end do
      total%tensor(k, k) = total%tensor(k, k) + diagonal
    end do
    total%mass = total%mass + mass
    total%moment = total%moment + moment
  end subroutine add_as_rigid
end module mech9_moving_plane
