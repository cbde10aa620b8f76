!> The axes of pairs in both of their links, as the data file gives them.
module mech9_pair_axes
  use mech9_kinds, only: wp
  use mech9_pose, only: pose_type, compose, inverse, transformed, pose_from_dh
  use mech9_pair, only: pair_slot_type, pair_guide_type, screw_factors_type
  implicit none
  private
  public :: pair_axes_type, pair_axes, turning, sliding, screwing, free

  !> The motion that a pair allows: it turns about its axis, slides along it, does both as a screw, or moves along a curve or as
  !> its user's procedure says.
  integer, parameter :: turning = 1, sliding = 2, screwing = 3, free = 4

  !> One pair. Side 1 is its reference link, side 2 its moving link; each vector is in that link's system.
  type :: pair_axes_type
    integer :: kind = turning           !< turning, sliding, screwing or free
    integer :: links(2) = 0             !< numbers of the reference link and of the moving link; 0 for a pair that is missing
    real(wp) :: points(3, 2) = 0.0_wp   !< of the axis [m]; of a free pair that of the moving link that is led (side 2)
    real(wp) :: axes(3, 2) = 0.0_wp     !< its direction, of length 1; zero for a free pair
    real(wp) :: tangent(3) = 0.0_wp     !< direction in the moving link that follows the tangent of a curve; zero: none does
    real(wp) :: sides(3, 2) = 0.0_wp    !< directions in the moving link that keep parallel to the plane of a curve; zero: none do
    type(pose_type) :: home             !< pose of the moving link in the reference link at q = 0; not known for a free pair
    real(wp), allocatable :: guide(:, :)   !< (3,n) places of the curve along which it leads, in the reference link [m]; none: n = 0
  end type pair_axes_type

contains

  !> The axes of all pairs. A pair that is missing is a free one without links.
  pure function pair_axes(pairs) result(all)
    type(pair_slot_type), intent(in) :: pairs(:)   !< (M)
    type(pair_axes_type), allocatable :: all(:)    !< (M)
    type(screw_factors_type) :: factors
    type(pair_guide_type) :: guide
    type(pose_type) :: in_moving
    logical :: is_screw
    integer :: k, i

    allocate (all(size(pairs)))
    do k = 1, size(all)
      all(k)%kind = free
      allocate (all(k)%guide(3, 0))
      if (.not. allocated(pairs(k)%pair)) cycle
      all(k)%links = [pairs(k)%pair%reference, pairs(k)%pair%moving]
      call pairs(k)%pair%as_screw(factors, is_screw)
      in_moving = inverse(factors%after)
      all(k)%points(:, 2) = in_moving%p
      if (.not. is_screw) then
        call pairs(k)%pair%guide(guide)
        all(k)%guide = guide%points
        if (guide%turns) then
          all(k)%tangent = in_moving%r(:, 1)
        else if (size(guide%points, 2) > 0) then
          all(k)%sides = in_moving%r(:, :2)
        end if
        do i = 1, size(guide%points, 2)
          all(k)%guide(:, i) = transformed(factors%before, guide%points(:, i))
        end do
        if (size(guide%points, 2) > 0) all(k)%points(:, 1) = all(k)%guide(:, 1)
        cycle
      end if
      all(k)%kind = turning
      all(k)%home = compose(compose(factors%before, pose_from_dh(0.0_wp, 0.0_wp, factors%slide*factors%offset, &
                                                                 factors%turn*factors%offset)), factors%after)
      all(k)%points(:, 1) = factors%before%p
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
