!> The axes of pairs in both of their links, as the data file gives them. Uses kinds, pose, pair, mechanism.
module mech9_pair_axes
  use mech9_kinds, only: wp
  use mech9_pose, only: pose_type, inverse
  use mech9_pair, only: screw_factors_type
  use mech9_mechanism, only: mechanism_type
  implicit none
  private
  public :: pair_axes_type, pair_axes, turning, sliding, screwing, free

  !> How a pair looks: it turns about its axis, slides along it, does both as a screw, or moves as its
  !> user likes.
  integer, parameter :: turning = 1, sliding = 2, screwing = 3, free = 4

  !> One pair. Side 1 is its reference link, side 2 its moving link; each vector is in that link's system.
  type :: pair_axes_type
    integer :: kind = turning
    integer :: links(2) = 0
    real(wp) :: points(3, 2) = 0.0_wp   !< of the axis [m]; of a free pair the moving link's origin (side 2)
    real(wp) :: axes(3, 2) = 0.0_wp     !< its direction; zero for a free pair
  end type pair_axes_type

contains

  !> The axes of all pairs.
  pure function pair_axes(mechanism) result(all)
    type(mechanism_type), intent(in) :: mechanism
    type(pair_axes_type), allocatable :: all(:)
    type(screw_factors_type) :: factors
    type(pose_type) :: in_moving
    logical :: is_screw
    integer :: k

    allocate (all(size(mechanism%pairs)))
    do k = 1, size(all)
      associate (pair => mechanism%pairs(k)%pair)
        all(k)%links = [pair%reference, pair%moving]
        call pair%as_screw(factors, is_screw)
      end associate
      if (.not. is_screw) then
        all(k)%kind = free
        cycle
      end if
      in_moving = inverse(factors%after)
      all(k)%points(:, 1) = factors%before%p
      all(k)%points(:, 2) = in_moving%p
      all(k)%axes(:, 1) = factors%before%r(:, 3)
      all(k)%axes(:, 2) = in_moving%r(:, 3)
      if (abs(factors%turn) <= 0.0_wp) then
        all(k)%kind = sliding
      else if (abs(factors%slide) > 0.0_wp) then
        all(k)%kind = screwing
      end if
    end do
  end function pair_axes
end module mech9_pair_axes
