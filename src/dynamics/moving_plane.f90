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
  use mech9_state, only: planar_motion_type
  use mech9_articulated_bodies, only: rigid_body_type, articulated_body_type, body_wrench, set_rigid_body, in_fixed_axes
  use mech9_cluster_bodies, only: cluster_work_type
  use mech9_frame_columns, only: frame_entries_type
  use mech9_planar_articulated, only: articulated_plate_type
  use mech9_planar_cluster, only: add_column, add_products
  use mech9_tree_stages, only: stage_type, plane_body_type
  implicit none
  private
  public :: plane_motion_type, seen_motion, gather_bodies

  !> The motion of a plane, which is that of its base, in its own axes; accelerations are those that rates alone give.
  type :: plane_motion_type
    real(wp) :: axes(3, 3) = 0.0_wp   !< turns components in the plane's axes into those in fixed axes
    real(wp) :: omega(3) = 0.0_wp     !< angular velocity [rad/s]
    real(wp) :: alpha(3) = 0.0_wp     !< angular acceleration [rad/s^2]
    real(wp) :: proper(3) = 0.0_wp    !< proper acceleration of the plane's origin: less that of free fall [m/s^2]
  end type plane_motion_type

  !> Bodies together about the origin of a frame, and the wrench that they require for the motion by rates alone, less their weight,
  !> in the plane's axes.
  type :: carried_bodies_type
    type(rigid_body_type) :: together     !< mass moment and inertia about that origin
    real(wp) :: wrench(6) = 0.0_wp        !< torque and force [N m, N]
  end type carried_bodies_type

contains

  !> The motion of a plane in its own axes, from that of its base in fixed axes.
  pure function seen_motion(axes, omega, alpha, a, gravity) result(plane)
    real(wp), intent(in) :: axes(3, 3)   !< (3,3) axes of the plane, as columns in fixed axes [1]
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
  !> bodies to what its base carries.
  pure subroutine gather_bodies(stage, entries, s, plane, motion, base, cluster)
    type(stage_type), intent(in) :: stage                !< the cluster; nothing passes to frame 0
    type(frame_entries_type), intent(in) :: entries      !< of all frames
    real(wp), intent(in) :: s(3, *)                      !< (entries) columns of the frames in the plane, relative to the base
    type(plane_motion_type), intent(in) :: plane         !< the motion of the plane
    type(planar_motion_type), intent(in) :: motion       !< of the frames in the plane, with accelerations that rates alone give
    type(articulated_body_type), intent(inout) :: base   !< the base of the cluster with links beyond it, fixed axes
    type(cluster_work_type), intent(inout) :: cluster    !< Q - S^T p and zero in; A, U in fixed axes and the bound out
    type(carried_bodies_type) :: all
    integer :: n

    n = size(stage%places)
    call gather_each(entries%first, entries%local, cluster%factors, cluster%column, cluster%rest, cluster%rigid, all)
    if (stage%base > 0) call pass_to_base(n, plane%axes, all, cluster%column, base)

  contains

    !> The sums over the frames from plain arrays, with U in the plane's axes, and all bodies together about the base's origin.
    pure subroutine gather_each(first, local, factors, column, rest, rigid, all)
      integer, intent(in) :: first(0:*)                !< first entry of each frame
      integer, intent(in) :: local(*)                  !< (entries) place of the coordinate in the cluster
      real(wp), intent(inout) :: factors(n, n)         !< (n,n) A, lower triangle [kg m^2, kg m, kg]
      real(wp), intent(inout) :: column(6, n)          !< (6,n) U, the plane's axes [kg m^2, kg m, kg]
      real(wp), intent(inout) :: rest(n)               !< (n) Q - S^T p [N m, N]
      real(wp), intent(inout) :: rigid(n)              !< (n) bound of the diagonal of A, as if rigid [kg m^2, kg]
      type(carried_bodies_type), intent(inout) :: all  !< the bodies grow
      type(carried_bodies_type) :: carried
      type(articulated_plate_type) :: plate
      real(wp) :: arm(3), u(3)
      integer :: i, k, e, c

      do i = 1, size(stage%flat)
        k = stage%flat(i)%frame
        call carry_body(stage%flat(i), plane, motion%pose(:, k), motion%velocity(:, k), motion%acceleration(:, k), carried)
        associate (body => carried%together)
          plate%inertia = [body%tensor(3, 3), -body%moment(2), body%moment(1), body%mass, 0.0_wp, body%mass]
          plate%wrench = carried%wrench(3:5)
          plate%amount = [body%mass, body%moment(1), body%moment(2), body%tensor(3, 3)]
          arm(1:2) = motion%pose(3:4, k) - motion%pose(3:4, stage%place)
          arm(3) = stage%flat(i)%height - stage%height
          do e = first(k), first(k + 1) - 1
            c = local(e)
            call add_column(s(:, e), plate, arm(1:2), u, column(3:5, c), rest(c), rigid(c))
            call add_products(first(k + 1) - e, local(e), s(1, e), u, factors(:, c))
            column(1, c) = column(1, c) + body%tensor(1, 3)*s(1, e) - body%moment(3)*s(3, e) &
                           - arm(3)*(body%mass*s(3, e) + body%moment(1)*s(1, e))
            column(2, c) = column(2, c) + body%tensor(2, 3)*s(1, e) + body%moment(3)*s(2, e) &
                           + arm(3)*(body%mass*s(2, e) - body%moment(2)*s(1, e))
          end do
        end associate
        if (stage%base > 0) call add_as_rigid(carried, arm, all)
      end do
    end subroutine gather_each
  end subroutine gather_bodies

  !> Add the inertia and the wrench of the bodies to those of the base, in fixed axes.
  pure subroutine pass_to_base(n, axes, all, column, base)
    integer, intent(in) :: n                             !< number of independent coordinates of the cluster
    real(wp), intent(in) :: axes(3, 3)                   !< (3,3) axes of the plane, as columns in fixed axes [1]
    type(carried_bodies_type), intent(in) :: all         !< the bodies about the base's origin, in the plane's axes
    real(wp), intent(inout) :: column(6, n)              !< (6,n) U in the plane's axes in, in fixed axes out [kg m^2, kg m, kg]
    type(articulated_body_type), intent(inout) :: base   !< the base with links beyond it, fixed axes
    type(articulated_body_type) :: rigid
    integer :: c

    do c = 1, n
      column(1:3, c) = turn(axes, column(1:3, c))
      column(4:6, c) = column(4, c)*axes(:, 1) + column(5, c)*axes(:, 2)
    end do
    base%wrench(1:3) = base%wrench(1:3) + turn(axes, all%wrench(1:3))
    base%wrench(4:6) = base%wrench(4:6) + turn(axes, all%wrench(4:6))
    call set_rigid_body(all%together%mass, turn(axes, all%together%moment), in_fixed_axes(axes, all%together%tensor), &
                        rigid%inertia, rigid%amount)
    base%inertia = base%inertia + rigid%inertia
    base%amount = base%amount + rigid%amount
  end subroutine pass_to_base

  !> The bodies of a frame with the wrench that they require, about the origin of the frame.
  pure subroutine carry_body(body, plane, f, v, a, carried)
    type(plane_body_type), intent(in) :: body           !< the bodies
    type(plane_motion_type), intent(in) :: plane        !< the motion of the plane
    real(wp), intent(in) :: f(4)                        !< pose of the frame: cosine, sine, origin [m]
    real(wp), intent(in) :: v(3)                        !< velocity of the frame in the plane [rad/s, m/s]
    real(wp), intent(in) :: a(3)                        !< its acceleration in the plane that rates alone give [rad/s^2, m/s^2]
    type(carried_bodies_type), intent(inout) :: carried !< gets the bodies
    real(wp) :: omega(3), alpha(3), proper(3), slip(3), square, double, mixed

    associate (c => f(1), s => f(2), own => body%together, turned => carried%together)
      turned%mass = own%mass
      turned%moment(1) = c*own%moment(1) - s*own%moment(2)
      turned%moment(2) = s*own%moment(1) + c*own%moment(2)
      turned%moment(3) = own%moment(3)
      square = s*s
      double = 2.0_wp*c*s*own%tensor(2, 1)
      mixed = square*(own%tensor(2, 2) - own%tensor(1, 1)) - double
      turned%tensor(1, 1) = own%tensor(1, 1) + mixed
      turned%tensor(2, 2) = own%tensor(2, 2) - mixed
      turned%tensor(2, 1) = c*s*(own%tensor(1, 1) - own%tensor(2, 2)) + (1.0_wp - 2.0_wp*square)*own%tensor(2, 1)
      turned%tensor(3, 1) = c*own%tensor(3, 1) - s*own%tensor(3, 2)
      turned%tensor(3, 2) = s*own%tensor(3, 1) + c*own%tensor(3, 2)
      turned%tensor(3, 3) = own%tensor(3, 3)
      turned%tensor(1, 2) = turned%tensor(2, 1)
      turned%tensor(1, 3) = turned%tensor(3, 1)
      turned%tensor(2, 3) = turned%tensor(3, 2)
    end associate
    associate (turning => plane%omega, height => body%height)
      omega = [turning(1), turning(2), turning(3) + v(1)]
      alpha = [plane%alpha(1) + v(1)*turning(2), plane%alpha(2) - v(1)*turning(1), plane%alpha(3) + a(1)]
      slip(1) = turning(2)*height - turning(3)*f(4) + 2.0_wp*v(2)
      slip(2) = turning(3)*f(3) - turning(1)*height + 2.0_wp*v(3)
      slip(3) = turning(1)*f(4) - turning(2)*f(3)
      proper(1) = plane%proper(1) + a(2) + plane%alpha(2)*height - plane%alpha(3)*f(4) + turning(2)*slip(3) - turning(3)*slip(2)
      proper(2) = plane%proper(2) + a(3) + plane%alpha(3)*f(3) - plane%alpha(1)*height + turning(3)*slip(1) - turning(1)*slip(3)
      proper(3) = plane%proper(3) + plane%alpha(1)*f(4) - plane%alpha(2)*f(3) + turning(1)*slip(2) - turning(2)*slip(1)
    end associate
    call body_wrench(carried%together%mass, carried%together%moment, carried%together%tensor, omega, alpha, proper, carried%wrench)
  end subroutine carry_body

  !> Add the bodies of a frame, and their wrench, to those about another origin:
  !> J' = J + (2 h . arm + m arm^2) 1 - h arm^T - arm h^T - m arm arm^T.
  pure subroutine add_as_rigid(carried, arm, all)
    type(carried_bodies_type), intent(in) :: carried   !< the bodies of the frame
    real(wp), intent(in) :: arm(3)                     !< from the other origin to that of the frame [m]
    type(carried_bodies_type), intent(inout) :: all    !< those about the other origin
    real(wp) :: mean(3), moment(3), diagonal
    integer :: i, k

    associate (body => carried%together, total => all%together)
      moment = body%moment + body%mass*arm
      ! h arm^T + arm h^T + m arm arm^T is the symmetric product of 2 h + m arm and arm
      mean = body%moment + 0.5_wp*body%mass*arm
      diagonal = 2.0_wp*dot_product(mean, arm)
      do k = 1, 3
        do i = 1, 3
          total%tensor(i, k) = total%tensor(i, k) + body%tensor(i, k) - mean(i)*arm(k) - arm(i)*mean(k)
        end do
        total%tensor(k, k) = total%tensor(k, k) + diagonal
      end do
      total%mass = total%mass + body%mass
      total%moment = total%moment + moment
    end associate
    all%wrench(1) = all%wrench(1) + carried%wrench(1) + arm(2)*carried%wrench(6) - arm(3)*carried%wrench(5)
    all%wrench(2) = all%wrench(2) + carried%wrench(2) + arm(3)*carried%wrench(4) - arm(1)*carried%wrench(6)
    all%wrench(3) = all%wrench(3) + carried%wrench(3) + arm(1)*carried%wrench(5) - arm(2)*carried%wrench(4)
    all%wrench(4:6) = all%wrench(4:6) + carried%wrench(4:6)
  end subroutine add_as_rigid
end module mech9_moving_plane
