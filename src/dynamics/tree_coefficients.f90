!> Coefficients of motion and forces on independent coordinates of a tree of clusters, by sums over the frames.
!>
!> A column of the coefficients is the set of generalized forces that accelerate one independent coordinate alone, without other
!> motion: the columns of the frames give the accelerations of all links outward, and collect the wrenches that these require
!> inward. Each column goes through the frames within reach of its coordinate only. In a chain of n links all columns cost n^2;
!> accelerations do not require them.
module mech9_tree_coefficients
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, turn_back, cross
  use mech9_articulated_bodies, only: articulated_body_type, articulated_work_type
  use mech9_frame_columns, only: frame_entries_type
  use mech9_planar_articulated, only: articulated_plate_type, planar_work_type
  implicit none
  private
  public :: find_reach, accelerate_in_space, collect_in_space, accelerate_in_plane, collect_in_plane

contains

  !> The frames within reach of each independent coordinate: its first frame, and the last frame that stands on one of its frames.
  pure subroutine find_reach(entries, reach)
    type(frame_entries_type), intent(in) :: entries   !< of all frames
    integer, intent(out) :: reach(:, :)               !< (2,n) first and last frame of each; an empty range where it moves none
    integer :: last(0:size(entries%support)), s, e, k, m

    m = size(entries%support)
    last = [(s, s=0, m)]
    reach(1, :) = m + 1
    reach(2, :) = 0
    do s = m, 1, -1
      k = entries%support(s)
      last(k) = max(last(k), last(s))
      do e = entries%first(s), entries%first(s + 1) - 1
        reach(1, entries%column(e)) = s
        reach(2, entries%column(e)) = max(reach(2, entries%column(e)), last(s))
      end do
    end do
  end subroutine find_reach

  !> The wrench that each frame's own bodies require for the acceleration 1 of one independent coordinate. Vectors are in fixed
  !> axes.
  pure subroutine accelerate_in_space(place, reach, entries, w, v, p, work)
    integer, intent(in) :: place                         !< place of the coordinate among the independent ones
    integer, intent(in) :: reach(2)                      !< first and last frame within its reach
    type(frame_entries_type), intent(in) :: entries      !< of all frames
    real(wp), intent(in) :: w(3, *)                      !< (3,entries) angular velocity per unit rate, relative to the support, fixed axes [1, rad/m]
    real(wp), intent(in) :: v(3, *)                      !< (3,entries) velocity of the origin per unit rate, relative to the support, fixed axes [m/rad, 1]
    real(wp), intent(in) :: p(3, 0:*)                    !< origin of each frame [m]
    type(articulated_work_type), intent(inout) :: work   !< with zero motion of all frames before these; gets motion and wrenches

    call accelerate(entries%first, entries%column, entries%support, work%bodies, work%motion)

  contains

    !> The same from plain arrays.
    pure subroutine accelerate(first, column, support, bodies, motion)
      integer, intent(in) :: first(0:*)                           !< first entry of each frame
      integer, intent(in) :: column(*)                            !< (entries) place of the coordinate among the independent ones
      integer, intent(in) :: support(*)                           !< frame on which the cluster of each step stands
      type(articulated_body_type), intent(inout) :: bodies(0:*)   !< each frame's own bodies; gets the wrenches
      real(wp), intent(inout) :: motion(6, 0:*)                   !< (dimensions,0:M) gets the accelerations of these frames [rad/s^2, m/s^2]
      real(wp) :: dw(3), dv(3)
      integer :: s, e

      do s = reach(1), reach(2)
        dw = motion(1:3, support(s))
        dv = motion(4:6, support(s)) + cross(dw, p(:, s) - p(:, support(s)))
        do e = first(s), first(s + 1) - 1
          if (column(e) /= place) cycle
          dw = dw + w(:, e)
          dv = dv + v(:, e)
        end do
        motion(1:3, s) = dw
        motion(4:6, s) = dv
        associate (body => bodies(s))
          body%wrench(1:3) = turn(body%inertia(:, 1:3), dw) + turn(body%inertia(:, 4:6), dv)
          body%wrench(4:6) = turn_back(body%inertia(:, 4:6), dw) + turn(body%inertia(:, 7:9), dv)
        end associate
      end do
    end subroutine accelerate
  end subroutine accelerate_in_space

  !> The generalized forces on the independent coordinates by the wrenches on some frames. Vectors are in fixed axes.
  pure subroutine collect_in_space(reach, entries, w, v, p, bodies, values)
    integer, intent(in) :: reach(2)                             !< first and last of these frames; no other frame stands on them
    type(frame_entries_type), intent(in) :: entries             !< of all frames
    real(wp), intent(in) :: w(3, *)                             !< (3,entries) angular velocity per unit rate, relative to the support, fixed axes [1, rad/m]
    real(wp), intent(in) :: v(3, *)                             !< (3,entries) velocity of the origin per unit rate, relative to the support, fixed axes [m/rad, 1]
    real(wp), intent(in) :: p(3, 0:*)                           !< origin of each frame [m]
    type(articulated_body_type), intent(inout) :: bodies(0:*)   !< with wrenches on the frames; then on all links beyond, too
    real(wp), intent(out), contiguous :: values(:)              !< generalized forces on the independent coordinates [N m or N]

    values = 0.0_wp
    if (reach(1) > reach(2)) return
    call collect(entries%first, entries%column, entries%support, bodies, values)

  contains

    !> The same from plain arrays.
    pure subroutine collect(first, column, support, bodies, values)
      integer, intent(in) :: first(0:*)                           !< first entry of each frame
      integer, intent(in) :: column(*)                            !< (entries) place of the coordinate among the independent ones
      integer, intent(in) :: support(*)                           !< frame on which the cluster of each step stands
      type(articulated_body_type), intent(inout) :: bodies(0:*)   !< with wrenches on the frames
      real(wp), intent(inout) :: values(*)                        !< (n) get their generalized forces [N m, N]
      integer :: s, e, f

      ! frames on which these stand have no wrenches of their own; link 1 keeps its wrench, which nothing reads
      s = support(reach(1))
      do while (s > 0)
        bodies(s)%wrench = 0.0_wp
        s = support(s)
      end do
      ! the frames within reach, then those on which they stand
      s = reach(2)
      do while (s > 0)
        do e = first(s), first(s + 1) - 1
          values(column(e)) = values(column(e)) + dot_product(w(:, e), bodies(s)%wrench(1:3)) &
                              + dot_product(v(:, e), bodies(s)%wrench(4:6))
        end do
        f = support(s)
        bodies(f)%wrench(1:3) = bodies(f)%wrench(1:3) + bodies(s)%wrench(1:3) + cross(p(:, s) - p(:, f), bodies(s)%wrench(4:6))
        bodies(f)%wrench(4:6) = bodies(f)%wrench(4:6) + bodies(s)%wrench(4:6)
        s = merge(s - 1, support(s), s > reach(1))
      end do
    end subroutine collect
  end subroutine collect_in_space

  !> The wrench that each frame's own bodies require for the acceleration 1 of one independent coordinate. Vectors are in the
  !> plane's axes.
  pure subroutine accelerate_in_plane(place, reach, entries, columns, f, work)
    integer, intent(in) :: place                      !< place of the coordinate among the independent ones
    integer, intent(in) :: reach(2)                   !< first and last frame within its reach
    type(frame_entries_type), intent(in) :: entries   !< of all frames
    real(wp), intent(in) :: columns(3, *)             !< (entries) columns of the frames, relative to the support
    real(wp), intent(in) :: f(4, 0:*)                 !< pose of each frame: cosine, sine, origin [m]
    type(planar_work_type), intent(inout) :: work     !< with zero motion of all frames before these; gets motion and wrenches

    call accelerate(entries%first, entries%column, entries%support, work%bodies, work%motion)

  contains

    !> The same from plain arrays.
    pure subroutine accelerate(first, column, support, plates, motion)
      integer, intent(in) :: first(0:*)                            !< first entry of each frame
      integer, intent(in) :: column(*)                             !< (entries) place of the coordinate among the independent ones
      integer, intent(in) :: support(*)                            !< frame on which the cluster of each step stands
      type(articulated_plate_type), intent(inout) :: plates(0:*)   !< each frame's own bodies; gets the wrenches
      real(wp), intent(inout) :: motion(3, 0:*)                    !< (dimensions,0:M) gets the accelerations of these frames [rad/s^2, m/s^2]
      real(wp) :: d(3)
      integer :: s, e, k

      do s = reach(1), reach(2)
        k = support(s)
        d = motion(:, k)
        d(2) = d(2) - d(1)*(f(4, s) - f(4, k))
        d(3) = d(3) + d(1)*(f(3, s) - f(3, k))
        do e = first(s), first(s + 1) - 1
          if (column(e) == place) d = d + columns(:, e)
        end do
        motion(:, s) = d
        associate (plate => plates(s))
          plate%wrench(1) = plate%inertia(1)*d(1) + plate%inertia(2)*d(2) + plate%inertia(3)*d(3)
          plate%wrench(2) = plate%inertia(2)*d(1) + plate%inertia(4)*d(2) + plate%inertia(5)*d(3)
          plate%wrench(3) = plate%inertia(3)*d(1) + plate%inertia(5)*d(2) + plate%inertia(6)*d(3)
        end associate
      end do
    end subroutine accelerate
  end subroutine accelerate_in_plane

  !> The generalized forces on the independent coordinates by the wrenches on some frames. Vectors are in the plane's axes.
  pure subroutine collect_in_plane(reach, entries, columns, f, plates, values)
    integer, intent(in) :: reach(2)                              !< first and last of these frames; no other frame stands on them
    type(frame_entries_type), intent(in) :: entries              !< of all frames
    real(wp), intent(in) :: columns(3, *)                        !< (entries) columns of the frames, relative to the support
    real(wp), intent(in) :: f(4, 0:*)                            !< pose of each frame: cosine, sine, origin [m]
    type(articulated_plate_type), intent(inout) :: plates(0:*)   !< with wrenches on the frames; then on all links beyond, too
    real(wp), intent(out), contiguous :: values(:)               !< generalized forces on the independent coordinates [N m or N]

    values = 0.0_wp
    if (reach(1) > reach(2)) return
    call collect(entries%first, entries%column, entries%support, plates, values)

  contains

    !> The same from plain arrays.
    pure subroutine collect(first, column, support, plates, values)
      integer, intent(in) :: first(0:*)                            !< first entry of each frame
      integer, intent(in) :: column(*)                             !< (entries) place of the coordinate among the independent ones
      integer, intent(in) :: support(*)                            !< frame on which the cluster of each step stands
      type(articulated_plate_type), intent(inout) :: plates(0:*)   !< with wrenches on the frames
      real(wp), intent(inout) :: values(*)                         !< (n) get their generalized forces [N m, N]
      integer :: s, e, k

      ! frames on which these stand have no wrenches of their own; link 1 keeps its wrench, which nothing reads
      s = support(reach(1))
      do while (s > 0)
        plates(s)%wrench = 0.0_wp
        s = support(s)
      end do
      ! the frames within reach, then those on which they stand
      s = reach(2)
      do while (s > 0)
        do e = first(s), first(s + 1) - 1
          values(column(e)) = values(column(e)) + dot_product(columns(:, e), plates(s)%wrench)
        end do
        k = support(s)
        plates(k)%wrench(1) = plates(k)%wrench(1) + plates(s)%wrench(1) + (f(3, s) - f(3, k))*plates(s)%wrench(3) &
                              - (f(4, s) - f(4, k))*plates(s)%wrench(2)
        plates(k)%wrench(2:3) = plates(k)%wrench(2:3) + plates(s)%wrench(2:3)
        s = merge(s - 1, support(s), s > reach(1))
      end do
    end subroutine collect
  end subroutine collect_in_plane
end module mech9_tree_coefficients
