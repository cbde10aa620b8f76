!> Articulated bodies of a closed cluster in planar arithmetic. The formulas are those of mech9_cluster_bodies, with motions and
!> wrenches of three numbers in the plane's axes, as in mech9_planar_articulated.
module mech9_planar_cluster
  use mech9_kinds, only: wp
  use mech9_cluster_bodies, only: cluster_work_type, divide_columns
  use mech9_frame_columns, only: frame_entries_type
  use mech9_planar_articulated, only: articulated_plate_type, add_to_parent
  use mech9_tree_stages, only: stage_type
  implicit none
  private
  public :: eliminate_cluster, move_cluster, add_column, add_products

contains

  !> Eliminate the accelerations of a cluster; what is left passes to its base. `found` is false where A is not positive definite
  !> beyond round-off.
  pure subroutine eliminate_cluster(stage, entries, s, f, plates, cluster, found)
    type(stage_type), intent(in) :: stage                        !< the cluster; nothing passes to frame 0
    type(frame_entries_type), intent(in) :: entries              !< of all frames
    real(wp), intent(in) :: s(3, *)                              !< (3,entries) columns of the frames, relative to the base, the plane's axes [1, m/rad]
    real(wp), intent(in) :: f(4, 0:*)                            !< pose of each frame: cosine, sine, origin [m]
    type(articulated_plate_type), intent(inout) :: plates(0:*)   !< each frame with all links beyond it outside the cluster
    type(cluster_work_type), intent(inout) :: cluster            !< with Q in `rest`; gets L, Y, z
    logical, intent(out) :: found                                !< whether the coordinates have inertia
    integer :: n

    n = size(stage%places)
    call add_frames(entries%first, entries%local, plates, cluster%factors, cluster%column, cluster%rest, cluster%rigid)
    call divide_columns(size(entries%support), 3, stage%held, cluster, found)
    if (stage%base > 0 .and. found) call pass_to_base(n, cluster%column, cluster%rest, plates(stage%base))

  contains

    !> Sum A, U and Q - S^T p over the frames, and add these to what the base carries, from plain arrays.
    pure subroutine add_frames(first, local, plates, factors, column, rest, rigid)
      integer, intent(in) :: first(0:*)                            !< first entry of each frame
      integer, intent(in) :: local(*)                              !< (entries) place of the coordinate in the cluster
      type(articulated_plate_type), intent(inout) :: plates(0:*)   !< each frame with all links beyond it outside the cluster
      real(wp), intent(out) :: factors(n, n)                       !< (n,n) A, lower triangle [kg m^2, kg m, kg]
      real(wp), intent(out) :: column(3, n)                        !< (3,n) U, the plane's axes [kg m^2, kg m, kg]
      real(wp), intent(inout) :: rest(n)                           !< (n) Q in, Q - S^T p out [N m, N]
      real(wp), intent(out) :: rigid(n)                            !< (n) bound of the diagonal of A, if all links beyond were rigid [kg m^2, kg]
      real(wp) :: arm(2), u(3)
      integer :: base, i, k, e, j

      factors = 0.0_wp
      column = 0.0_wp
      rigid = 0.0_wp
      base = stage%base
      do i = 1, size(stage%frames)
        k = stage%frames(i)
        arm = f(3:4, k) - f(3:4, base)
        do e = first(k), first(k + 1) - 1
          j = local(e)
          call add_column(s(:, e), plates(k), arm, u, column(:, j), rest(j), rigid(j))
          call add_products(first(k + 1) - e, local(e), s(1, e), u, factors(:, j))
        end do
        if (base > 0) call add_to_parent(arm, plates(k), plates(base))
      end do
    end subroutine add_frames
  end subroutine eliminate_cluster

  !> Take from the base of a cluster what the cluster's own motion gives way.
  pure subroutine pass_to_base(n, column, rest, plate)
    integer, intent(in) :: n                               !< number of independent coordinates of the cluster
    real(wp), intent(in) :: column(3, n)                   !< (3,n) Y, by which accelerations of the base act [1, rad/m, m/rad]
    real(wp), intent(in) :: rest(n)                        !< (n) z, accelerations where the base has none [rad/s^2, m/s^2]
    type(articulated_plate_type), intent(inout) :: plate   !< the base with all links beyond it
    integer :: j

    do j = 1, n
      plate%inertia(1:3) = plate%inertia(1:3) - column(1, j)*column(:, j)
      plate%inertia(4) = plate%inertia(4) - column(2, j)*column(2, j)
      plate%inertia(5) = plate%inertia(5) - column(2, j)*column(3, j)
      plate%inertia(6) = plate%inertia(6) - column(3, j)*column(3, j)
      plate%wrench = plate%wrench + column(:, j)*rest(j)
    end do
  end subroutine pass_to_base

  !> Add what a frame contributes to U, Q - S^T p and the bound for one coordinate of its cluster.
  pure subroutine add_column(s, plate, arm, u, column, rest, rigid)
    real(wp), intent(in) :: s(3)                        !< (3) column of the frame, relative to the base, the plane's axes [1, m/rad]
    type(articulated_plate_type), intent(in) :: plate   !< the frame with all links beyond it outside the cluster
    real(wp), intent(in) :: arm(2)                      !< from the base's origin to the frame's [m]
    real(wp), intent(out) :: u(3)                       !< (3) wrench on the frame per unit acceleration of the coordinate, the plane's axes [kg m^2, kg m]
    real(wp), intent(inout) :: column(3)                !< (3) U of the coordinate, the plane's axes [kg m^2, kg m]
    real(wp), intent(inout) :: rest                     !< Q - S^T p of the coordinate [N m, N]
    real(wp), intent(inout) :: rigid                    !< bound of A_jj as if rigid [kg m^2, kg]

    u(1) = plate%inertia(1)*s(1) + plate%inertia(2)*s(2) + plate%inertia(3)*s(3)
    u(2) = plate%inertia(2)*s(1) + plate%inertia(4)*s(2) + plate%inertia(5)*s(3)
    u(3) = plate%inertia(3)*s(1) + plate%inertia(5)*s(2) + plate%inertia(6)*s(3)
    rest = rest - s(1)*plate%wrench(1) - s(2)*plate%wrench(2) - s(3)*plate%wrench(3)
    rigid = rigid + plate%amount(4)*s(1)**2 + plate%amount(1)*(s(2)**2 + s(3)**2) &
            + 2.0_wp*abs(s(1)*(plate%amount(2)*s(3) - plate%amount(3)*s(2)))
    column(1) = column(1) + u(1) + arm(1)*u(3) - arm(2)*u(2)
    column(2) = column(2) + u(2)
    column(3) = column(3) + u(3)
  end subroutine add_column

  !> Add what a frame contributes to the column of A of one coordinate of its cluster, by its entries from that of the coordinate
  !> on.
  pure subroutine add_products(count, local, s, u, factors)
    integer, intent(in) :: count             !< number of these entries
    integer, intent(in) :: local(count)      !< places of their coordinates in the cluster
    real(wp), intent(in) :: s(3, count)      !< (3,count) their columns, relative to the base, the plane's axes [1, m/rad]
    real(wp), intent(in) :: u(3)             !< (3) wrench on the frame per unit acceleration of the coordinate, the plane's axes [kg m^2, kg m]
    real(wp), intent(inout) :: factors(*)    !< (count) column of A [kg m^2, kg m, kg]
    integer :: d

    do d = 1, count
      factors(local(d)) = factors(local(d)) + s(1, d)*u(1) + s(2, d)*u(2) + s(3, d)*u(3)
    end do
  end subroutine add_products

  !> Move the frames of a cluster on which others stand by the accelerations of its base and of its coordinates.
  pure subroutine move_cluster(stage, entries, s, f, ddq, motion)
    type(stage_type), intent(in) :: stage             !< the cluster
    type(frame_entries_type), intent(in) :: entries   !< of all frames
    real(wp), intent(in) :: s(3, *)                   !< (3,entries) columns of the frames, relative to the base, the plane's axes [1, m/rad]
    real(wp), intent(in) :: f(4, 0:*)                 !< pose of each frame: cosine, sine, origin [m]
    real(wp), intent(in) :: ddq(*)                    !< accelerations of the cluster's independent coordinates [rad/s^2, m/s^2]
    real(wp), intent(inout) :: motion(3, 0:*)   !< (3,0:M) accelerations less those that rates alone give, the plane's axes; gets those of these frames [rad/s^2, m/s^2]
    real(wp) :: d(3)
    integer :: i, k, e

    do i = 1, size(stage%feet)
      k = stage%feet(i)
      d = motion(:, stage%base)
      d(2) = d(2) - d(1)*(f(4, k) - f(4, stage%base))
      d(3) = d(3) + d(1)*(f(3, k) - f(3, stage%base))
      do e = entries%first(k), entries%first(k + 1) - 1
        d = d + ddq(entries%local(e))*s(:, e)
      end do
      motion(:, k) = d
    end do
  end subroutine move_cluster
end module mech9_planar_cluster
