!> Derivatives of a motion in other angles of its ball joints.
module mech9_varied_angles
  use mech9_kinds, only: wp
  use mech9_three_turns, only: three_turns_type
  use mech9_varied_turns, only: carry_changes
  use mech9_ball_angles, only: ball_angles_type
  use mech9_state, only: state_type
  implicit none
  private
  public :: carry_to_angles, carry_given_angles

contains

  !> Carry derivatives of all coordinates and rates over to the angles in which another system moves the same joints at the same time.
  subroutine carry_to_angles(angles, state, other_angles, other, changes)
    class(ball_angles_type), intent(in) :: angles         !< of the system in whose coordinates they are known
    class(state_type), intent(in) :: state                !< its state
    class(ball_angles_type), intent(in) :: other_angles   !< of the other system
    class(state_type), intent(in) :: other                !< its state
    real(wp), intent(inout) :: changes(:, 0:, :)          !< (P,0:2,M) the derivatives; those of accelerations stay
    integer :: i

    do i = 1, size(angles%joints)
      if (.not. angles%replaced(i)) cycle
      associate (joint => angles%joints(i))
        if (.not. replaces(other_angles, joint%coordinates)) &
          call carry(joint%coordinates, joint%substitute, state, joint%given, other, changes)
      end associate
    end do
    do i = 1, size(other_angles%joints)
      if (.not. other_angles%replaced(i)) cycle
      associate (joint => other_angles%joints(i))
        if (.not. replaces(angles, joint%coordinates)) &
          call carry(joint%coordinates, joint%given, state, joint%substitute, other, changes)
      end associate
    end do
  end subroutine carry_to_angles

  !> Carry derivatives of all coordinates and rates over to the angles of the data file, in which the motion was shown last, or back from
  !> these. No joint may stand in gimbal lock.
  subroutine carry_given_angles(angles, state, to_given, changes)
    class(ball_angles_type), intent(in) :: angles     !< of the system, with the state in the angles of the data file
    class(state_type), intent(in) :: state            !< of the system
    logical, intent(in) :: to_given                   !< over to these angles; else from them to those of the system
    real(wp), intent(inout) :: changes(:, 0:, :)      !< (P,0:2,M) the derivatives; those of accelerations stay
    integer :: i

    if (.not. angles%in_use()) return
    do i = 1, size(angles%joints)
      if (.not. angles%replaced(i)) cycle
      associate (joint => angles%joints(i))
        if (to_given) then
          call carry(joint%coordinates, joint%substitute, state, joint%given, angles%state, changes)
        else
          call carry(joint%coordinates, joint%given, angles%state, joint%substitute, state, changes)
        end if
      end associate
    end do
  end subroutine carry_given_angles

  !> Whether other angles move the joint with these coordinates.
  pure logical function replaces(angles, coordinates)
    class(ball_angles_type), intent(in) :: angles   !< the angles
    integer, intent(in) :: coordinates(3)           !< of the joint
    integer :: i

    replaces = .false.
    do i = 1, size(angles%joints)
      if (angles%replaced(i)) replaces = replaces .or. all(angles%joints(i)%coordinates == coordinates)
    end do
  end function replaces

  !> Carry the derivatives of one joint over.
  pure subroutine carry(k, from, state, to, other, changes)
    integer, intent(in) :: k(3)                    !< coordinates of the joint
    type(three_turns_type), intent(in) :: from     !< its turns in the one state
    class(state_type), intent(in) :: state         !< the state
    type(three_turns_type), intent(in) :: to       !< its turns in the other state
    class(state_type), intent(in) :: other         !< the other state, in which the joint moves likewise
    real(wp), intent(inout) :: changes(:, 0:, :)   !< (P,0:2,M) derivatives by the one; then by the other
    real(wp) :: of_joint(size(changes, 1), 0:1, 3)

    of_joint = changes(:, 0:1, k)
    call carry_changes(from, reshape([state%q(k), state%dq(k)], [3, 2]), to, reshape([other%q(k), other%dq(k)], [3, 2]), of_joint)
    changes(:, 0:1, k) = of_joint
  end subroutine carry
end module mech9_varied_angles
