!> Whether a mechanism rests in the same position twice.
!>
!> Coordinates decide this, but for those of joints that are made of several pairs: the posture decides whether they are the same position
!> in another setting (mech9_posture). Coordinates that differ by whole turns alone are another position, because forces may depend on
!> turns.
module mech9_same_position
  use mech9_kinds, only: wp, pi
  use mech9_mechanism, only: mechanism_type
  use mech9_posture, only: posture_type
  use mech9_resting_mechanism, only: resting_type
  implicit none
  private
  public :: is_same_position, same_position

  !> Coordinates and numbers of a posture that differ by less are the same, in their units.
  real(wp), parameter :: same_position = 1.0e-5_wp

contains

  !> Whether the links stand alike in two positions.
  pure logical function is_same_position(mechanism, posture, a, b, numbers_of_a, numbers_of_b) result(same)
    type(mechanism_type), intent(in) :: mechanism   !< the mechanism
    type(posture_type), intent(in) :: posture       !< the quantities that make its posture
    type(resting_type), intent(in) :: a             !< at rest in one position
    type(resting_type), intent(in) :: b             !< at rest in the other one
    real(wp), intent(in) :: numbers_of_a(:)         !< numbers of the posture in the first position
    real(wp), intent(in) :: numbers_of_b(:)         !< and in the second one
    real(wp) :: turns
    logical :: whole_turns
    integer :: k

    same = .false.
    whole_turns = .true.
    do k = 1, size(a%state%q)
      if (abs(a%state%q(k) - b%state%q(k)) <= same_position*a%plan%unit_of(k)) cycle
      ! between other links a coordinate has one value only, up to turns
      associate (pair => mechanism%pairs(k)%pair)
        if (.not. any(posture%unseen == pair%reference .or. posture%unseen == pair%moving)) return
      end associate
      turns = (a%state%q(k) - b%state%q(k))/(2.0_wp*pi)
      whole_turns = whole_turns .and. abs(turns - anint(turns)) <= same_position
      same = .true.
    end do
    ! no coordinate differs
    if (.not. same) then
      same = .true.
      return
    end if
    same = .not. whole_turns .and. all(abs(numbers_of_a - numbers_of_b) <= same_position)
  end function is_same_position
end module mech9_same_position
