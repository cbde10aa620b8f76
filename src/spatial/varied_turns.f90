!> Changes of the motion of a ball joint, in the angles of one triple of turns or of another.
!>
!> Changes of three angles turn the link that moves by a small vector, and change its angular velocity. Both are the same in all triples
!> that give the same motion. So changes of the angles of one triple, and of their rates, follow from those of another.
module mech9_varied_turns
  use mech9_kinds, only: wp
  use mech9_rotation, only: turn, cross
  use mech9_three_turns, only: three_turns_type
  implicit none
  private
  public :: carry_changes

contains

  !> Carry changes over from the angles of a triple to those of another one, which gives the same motion and is not in gimbal lock.
  pure subroutine carry_changes(from, motion, to, motion_to, changes)
    type(three_turns_type), intent(in) :: from      !< the triple in whose angles the changes are known
    real(wp), intent(in) :: motion(3, 0:1)          !< its coordinates and their rates [rad, rad/s]
    type(three_turns_type), intent(in) :: to        !< the other triple
    real(wp), intent(in) :: motion_to(3, 0:1)       !< its coordinates and their rates [rad, rad/s]
    real(wp), intent(inout) :: changes(:, 0:, :)    !< (n,0:1,3) of coordinates and rates; those of the other triple on return
    real(wp), dimension(3, 3) :: axes, axes_to
    real(wp) :: turned(3), change_of_velocity(3)
    integer :: i

    axes = axes_of(from, motion(:, 0))
    axes_to = axes_of(to, motion_to(:, 0))
    do i = 1, size(changes, 1)
      turned = matmul(axes, changes(i, 0, :))
      change_of_velocity = matmul(axes, changes(i, 1, :)) + by_turned_axes(axes, motion(:, 1), changes(i, 0, :))
      changes(i, 0, :) = components(axes_to, turned)
      changes(i, 1, :) = components(axes_to, change_of_velocity - by_turned_axes(axes_to, motion_to(:, 1), changes(i, 0, :)))
    end do
  end subroutine carry_changes

  !> The axes about which the link turns by each coordinate, in the frame before the first turn.
  pure function axes_of(turns, q) result(axes)
    type(three_turns_type), intent(in) :: turns   !< the triple
    real(wp), intent(in) :: q(3)                  !< coordinates [rad]
    real(wp) :: axes(3, 3), angle(2)

    angle = turns%sign(:2)*q(:2) + turns%shift(:2)
    associate (f => angle(1), g => angle(2))
      axes(:, 1) = turn(turns%base, [0.0_wp, 0.0_wp, turns%sign(1)])
      axes(:, 2) = turn(turns%base, turns%sign(2)*[cos(f), sin(f), 0.0_wp])
      axes(:, 3) = turn(turns%base, turns%sign(3)*[-sin(f)*cos(g), cos(f)*cos(g), sin(g)])
    end associate
  end function axes_of

  !> The change of the angular velocity where changes of the coordinates turn the axes, with the rates as they are.
  pure function by_turned_axes(axes, dq, changes) result(change)
    real(wp), intent(in) :: axes(3, 3)     !< axes of the turns
    real(wp), intent(in) :: dq(3)          !< rates [rad/s]
    real(wp), intent(in) :: changes(3)     !< of the coordinates [rad]
    real(wp) :: change(3), turned(3)

    turned = axes(:, 1)*changes(1)
    change = dq(2)*cross(turned, axes(:, 2))
    turned = turned + axes(:, 2)*changes(2)
    change = change + dq(3)*cross(turned, axes(:, 3))
  end function by_turned_axes

  !> Components of a vector along axes that are not at right angles.
  pure function components(axes, vector)
    real(wp), intent(in) :: axes(3, 3)     !< the axes
    real(wp), intent(in) :: vector(3)      !< the vector
    real(wp) :: components(3), volume

    volume = dot_product(axes(:, 1), cross(axes(:, 2), axes(:, 3)))
    components(1) = dot_product(vector, cross(axes(:, 2), axes(:, 3)))/volume
    components(2) = dot_product(vector, cross(axes(:, 3), axes(:, 1)))/volume
    components(3) = dot_product(vector, cross(axes(:, 1), axes(:, 2)))/volume
  end function components
end module mech9_varied_turns
