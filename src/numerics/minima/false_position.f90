!> The zero of a function between two places at which it has different signs, by false position with halved values (Illinois; Dowell
!> and Jarratt in docs/reference/bibliography.md). Whoever searches evaluates the function at the places that are asked for.
module mech9_false_position
  use mech9_kinds, only: wp
  implicit none
  private
  public :: false_position_type, new_false_position

  !> A place before the zero, where the function is below zero, and one behind it.
  type :: false_position_type
    real(wp) :: before = 0.0_wp            !< the place before
    real(wp) :: behind = 0.0_wp            !< the place behind
    real(wp), private :: value_before = 0.0_wp, value_behind = 0.0_wp   !< there, halved where one side stays
    integer, private :: side = 0           !< of the last trial: 1 behind, -1 before
  contains
    procedure :: next
    procedure :: take
  end type false_position_type

contains

  !> The search from two places and the values there, below zero and above it.
  pure function new_false_position(before, value_before, behind, value_behind) result(search)
    real(wp), intent(in) :: before         !< the place before the zero
    real(wp), intent(in) :: value_before   !< the function there
    real(wp), intent(in) :: behind         !< the place behind it
    real(wp), intent(in) :: value_behind   !< the function there
    type(false_position_type) :: search

    search = false_position_type(before, behind, value_before, value_behind, 0)
  end function new_false_position

  !> Find the place to be tried next. The search ends where none lies between the others.
  pure subroutine next(self, place, found)
    class(false_position_type), intent(in) :: self   !< the search
    real(wp), intent(inout) :: place                 !< the place; as before where both others are one within round-off
    logical, intent(out) :: found                    !< there is one

    found = .false.
    if (self%value_before >= 0.0_wp .or. abs(self%behind - self%before) <= 4.0_wp*spacing(self%behind)) return
    place = self%behind - self%value_behind*(self%behind - self%before)/(self%value_behind - self%value_before)
    found = (place - self%before)*(self%behind - place) > 0.0_wp
  end subroutine next

  !> Take the function at a place that was tried.
  pure subroutine take(self, place, value)
    class(false_position_type), intent(inout) :: self   !< the search
    real(wp), intent(in) :: place                       !< the place
    real(wp), intent(in) :: value                       !< the function there

    if (value > 0.0_wp) then
      self%behind = place
      self%value_behind = value
      if (self%side > 0) self%value_before = 0.5_wp*self%value_before
      self%side = 1
    else
      self%before = place
      self%value_before = value
      if (self%side < 0) self%value_behind = 0.5_wp*self%value_behind
      self%side = -1
    end if
  end subroutine take
end module mech9_false_position
