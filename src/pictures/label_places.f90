!> Where labels stand so that they can be read: the number of a link on it, the name of a coordinate beside its
!> joint where bars cover it least. Uses kinds, rotation.
module mech9_label_places
  use mech9_kinds, only: wp
  use mech9_rotation, only: cross, unit
  implicit none
  private
  public :: number_place, name_shift

  !> A name of small letters: width of one, and how far they reach above and below their line [px].
  real(wp), parameter :: letter = 6.0_wp, above = 8.0_wp, below = 2.0_wp
  !> How far a bar reaches to both sides of its middle line [px].
  real(wp), parameter :: half_bar = 5.0_wp

contains

  !> Where the number of a link stands: in the middle of its points, or where they lie in a line, between the
  !> neighbours that are farthest apart; there not quite in the middle, where the mass centre is often.
  pure function number_place(points, tolerance) result(place)
    real(wp), intent(in) :: points(:, :)          !< (3,n) two or more, no two of which are the same
    real(wp), intent(in) :: tolerance             !< points that near to a line lie in it
    real(wp) :: place(3)
    real(wp) :: along(3), s(size(points, 2)), off(size(points, 2)), widest
    integer :: i, next

    along = unit(points(:, 2) - points(:, 1))
    do i = 1, size(s)
      s(i) = dot_product(along, points(:, i) - points(:, 1))
      off(i) = norm2(cross(along, points(:, i) - points(:, 1)))
    end do
    place = sum(points, 2)/size(s)
    if (maxval(off) > tolerance) return
    widest = 0.0_wp
    do i = 1, size(s)
      next = minloc(s, dim=1, mask=s > s(i))
      if (next == 0) cycle
      ! of gaps that are as wide the first one, whatever round-off makes of them
      if (s(next) - s(i) <= widest + tolerance) cycle
      widest = s(next) - s(i)
      place = 0.6_wp*points(:, i) + 0.4_wp*points(:, next)
    end do
  end function number_place

  !> Where the name of a joint's coordinates ends, from the joint to the right and down [px]: to the left and
  !> above where nothing is in the way; on the frame on the side where the stand is not.
  pure function name_shift(at, letters, stands, hangs, bars) result(shift)
    real(wp), intent(in) :: at(2)                 !< the joint on the page [px]
    integer, intent(in) :: letters                !< of the name
    logical, intent(in) :: stands                 !< it is a joint of the frame
    logical, intent(in) :: hangs                  !< its stand is above
    real(wp), intent(in) :: bars(:, :, :)         !< (2,2,n) the ends of all bars [px]
    real(wp) :: shift(2)
    real(wp) :: places(2, 3), covered(3), width, low(2), high(2)
    integer :: i, j

    width = letter*letters
    places = reshape([-8.0_wp, -8.0_wp, -8.0_wp, 16.0_wp, 8.0_wp + width, 16.0_wp], [2, 3])
    shift = places(:, merge(2, 1, hangs))
    if (stands) return
    covered = 0.0_wp
    do i = 1, 3
      low = at + places(:, i) - [width, above] - half_bar
      high = at + places(:, i) + [0.0_wp, below] + half_bar
      do j = 1, size(bars, 3)
        covered(i) = covered(i) + length_within(bars(:, 1, j), bars(:, 2, j), low, high)
      end do
    end do
    ! whole px, so that round-off does not choose
    shift = places(:, minloc(nint(covered), dim=1))
  end function name_shift

  !> Length of the part of a line that lies within a box.
  pure real(wp) function length_within(from, to, low, high) result(length)
    real(wp), intent(in) :: from(2), to(2), low(2), high(2)
    real(wp) :: first, last, ends(2)
    integer :: i

    length = 0.0_wp
    first = 0.0_wp
    last = 1.0_wp
    do i = 1, 2
      if (abs(to(i) - from(i)) > 1.0e-6_wp) then
        ends = [low(i) - from(i), high(i) - from(i)]/(to(i) - from(i))
        first = max(first, minval(ends))
        last = min(last, maxval(ends))
      else if (from(i) < low(i) .or. from(i) > high(i)) then
        return
      end if
    end do
    length = max(0.0_wp, last - first)*norm2(to - from)
  end function length_within
end module mech9_label_places
